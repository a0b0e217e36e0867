/* bvhbench-gmsh FILE: reads a mesh with Gmsh's library, and writes its tetrahedra to standard
 * output (gmsh_stream.h). Gmsh is under the GPL; nothing but this program is linked with it.
 *
 * Vertices without a tetrahedron are left out. Of tetrahedra of 10 nodes the corners are used. The
 * field is the first post-processing view with one value per node. */
#include "scenes/gmsh/gmsh_stream.h"

#include <gmshc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct mesh {
    bb_gmsh_head head;
    size_t *nodes; /* tags, and three coordinates each */
    size_t node_count;
    double *coordinates;
    uint32_t *number_of; /* by tag: number of its vertex, from 1; 0: no tetrahedron has it */
    size_t tag_max;
    uint32_t *tets;
    float *vertices, *field;
} mesh;

/* Sets the message to the first line of Gmsh's. */
static void complain(mesh *m, const char *what, const char *gmsh)
{
    snprintf(m->head.message, sizeof m->head.message, "%s%s%.160s", what,
             gmsh != NULL && gmsh[0] != '\0' ? ": " : "", gmsh != NULL ? gmsh : "");
    m->head.message[strcspn(m->head.message, "\r\n")] = '\0';
}

static int failed(mesh *m, const char *what, int error)
{
    char *said = NULL;
    if (error == 0)
        return 0;
    gmshLoggerGetLastError(&said, &error);
    complain(m, what, said);
    return 1;
}

static int read_nodes(mesh *m)
{
    double *parametric = NULL;
    size_t coordinates, parameters;
    int error;
    gmshModelMeshGetNodes(&m->nodes, &m->node_count, &m->coordinates, &coordinates, &parametric,
                          &parameters, -1, -1, 0, 0, &error);
    if (failed(m, "its nodes", error))
        return 1;
    for (size_t i = 0; i < m->node_count; i++)
        m->tag_max = m->nodes[i] > m->tag_max ? m->nodes[i] : m->tag_max;
    if (coordinates != 3 * m->node_count || m->node_count > 0x7FFFFFFF || m->tag_max > 0xFFFFFFFF) {
        complain(m, "has too many nodes, or too large node numbers", NULL);
        return 1;
    }
    m->number_of = calloc(m->tag_max + 1, sizeof *m->number_of);
    if (m->number_of == NULL)
        complain(m, "no memory for its nodes", NULL);
    return m->number_of == NULL;
}

/* Appends the corners, as tags, of all elements of a type that has `nodes` each. */
static int add_tets(mesh *m, int type, size_t nodes)
{
    size_t *tags = NULL, *corners = NULL, count, corner_count;
    int error;
    gmshModelMeshGetElementsByType(type, &tags, &count, &corners, &corner_count, -1, 0, 1, &error);
    if (failed(m, "its tetrahedra", error))
        return 1;
    if (count == 0)
        return 0;
    uint32_t *grown = realloc(m->tets, (m->head.tets + count) * 4 * sizeof *grown);
    if (grown == NULL || corner_count != nodes * count) {
        complain(m, grown == NULL ? "no memory for its tetrahedra" : "its tetrahedra", NULL);
        return 1;
    }
    m->tets = grown;
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 4; c++) {
            size_t tag = corners[nodes * i + c];
            if (tag > m->tag_max) {
                complain(m, "a tetrahedron has an unknown node", NULL);
                return 1;
            }
            m->tets[4 * (m->head.tets + i) + c] = (uint32_t)tag;
            m->number_of[tag] = 1;
        }
    m->head.tets += count;
    return 0;
}

static int count_others(mesh *m)
{
    int *types = NULL, error;
    size_t count;
    gmshModelMeshGetElementTypes(&types, &count, 3, -1, &error);
    if (failed(m, "its elements", error))
        return 1;
    for (size_t i = 0; i < count; i++) {
        size_t *tags = NULL, *corners = NULL, tag_count, corner_count;
        if (types[i] == BB_GMSH_TET_4 || types[i] == BB_GMSH_TET_10)
            continue;
        gmshModelMeshGetElementsByType(types[i], &tags, &tag_count, &corners, &corner_count, -1, 0,
                                       1, &error);
        if (failed(m, "its elements", error))
            return 1;
        m->head.others += tag_count;
    }
    return 0;
}

/* Numbers the vertices that tetrahedra have, in the file's order. */
static int number_vertices(mesh *m)
{
    m->vertices = malloc((3 * m->node_count + 1) * sizeof *m->vertices);
    if (m->vertices == NULL) {
        complain(m, "no memory for its nodes", NULL);
        return 1;
    }
    for (size_t i = 0; i < m->node_count; i++) {
        uint32_t *number = &m->number_of[m->nodes[i]];
        if (*number != 1)
            continue; /* without a tetrahedron, or listed before */
        for (size_t k = 0; k < 3; k++)
            m->vertices[3 * m->head.vertices + k] = (float)m->coordinates[3 * i + k];
        *number = (uint32_t)(2 + m->head.vertices++);
    }
    for (size_t i = 0; i < 4 * m->head.tets; i++) {
        uint32_t number = m->number_of[m->tets[i]];
        if (number < 2) {
            complain(m, "a tetrahedron has an unknown node", NULL);
            return 1;
        }
        m->tets[i] = number - 2;
    }
    return 0;
}

/* Returns true if the view has one value per node. Missing values stay 0. */
static int take_view(mesh *m, int view)
{
    int error;
    char *type = NULL;
    size_t *tags = NULL, tag_count, value_count;
    double *values = NULL, time;
    int components;
    gmshViewGetHomogeneousModelData(view, 0, &type, &tags, &tag_count, &values, &value_count, &time,
                                    &components, &error);
    if (error != 0 || components != 1 || strcmp(type, "NodeData") != 0 || value_count != tag_count)
        return 0;
    for (size_t i = 0; i < tag_count; i++)
        if (tags[i] <= m->tag_max && m->number_of[tags[i]] >= 2)
            m->field[m->number_of[tags[i]] - 2] = (float)values[i];
    m->head.fielded = 1;
    return 1;
}

static int read_field(mesh *m)
{
    int *views = NULL, error;
    size_t view_count;
    gmshViewGetTags(&views, &view_count, &error);
    if (error != 0 || view_count == 0)
        return 0;
    m->field = calloc(m->head.vertices + 1, sizeof *m->field);
    if (m->field == NULL) {
        complain(m, "no memory for its field", NULL);
        return 1;
    }
    for (size_t i = 0; i < view_count && !take_view(m, views[i]); i++)
        continue;
    return 0;
}

static int read_mesh(mesh *m, const char *path)
{
    int error;
#if GMSH_API_VERSION_MINOR > 8
    gmshInitialize(0, NULL, 0, 0, &error);
#else
    gmshInitialize(0, NULL, 0, &error);
#endif
    if (failed(m, "Gmsh does not start", error))
        return 1;
    gmshOptionSetNumber("General.Terminal", 0, &error);
    gmshOptionSetNumber("General.AbortOnError", 2, &error); /* errors become return values of the
                                                             * calls */
    gmshMerge(path, &error);
    if (failed(m, "Gmsh cannot read it", error))
        return 1;
    if (read_nodes(m) || add_tets(m, BB_GMSH_TET_4, 4) || add_tets(m, BB_GMSH_TET_10, 10) ||
        count_others(m) || number_vertices(m))
        return 1;
    return read_field(m);
}

int main(int argc, char **argv)
{
    mesh m = {.head = {.magic = {'B', 'V', 'H', 'B', 'G', 'M', 'S', 'H'}}};
    if (argc != 2) {
        fprintf(stderr, "usage: bvhbench-gmsh FILE\n");
        return 2;
    }
    /* Gmsh's output must not get between the data */
    int out = dup(STDOUT_FILENO);
    if (out < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
        return 2;
    FILE *stream = fdopen(out, "wb");
    if (stream == NULL)
        return 2;
    int bad = read_mesh(&m, argv[1]);
    int written = fwrite(&m.head, sizeof m.head, 1, stream) == 1;
    if (!bad) {
        fwrite(m.vertices, 3 * sizeof(float), m.head.vertices, stream);
        if (m.head.fielded)
            fwrite(m.field, sizeof(float), m.head.vertices, stream);
        fwrite(m.tets, 4 * sizeof(uint32_t), m.head.tets, stream);
    }
    written = fclose(stream) == 0 && written;
    _exit(written ? 0 : 2); /* Gmsh's own shutdown is useless, and may fail on the mesh */
}
