/* TetGen's .node and .ele: vertices and tetrahedra in two files of one name, either of which may be
 * given. The first attribute of the vertices, if there is one, is the scalar field. Boundary
 * markers, regions, and the nodes on edges of tetrahedra of 10 nodes are ignored. Si 2015 ("TetGen,
 * a Delaunay-Based Quality Tetrahedral Mesh Generator"), manual, section 5.
 */
#include "framework/base/memory.h"
#include "framework/scene/tets.h"
#include "scenes/text_table.h"

#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { COUNT_MAX = 0x7FFFFFFF };

typedef struct tetgen {
    char node_path[PATH_MAX], ele_path[PATH_MAX];
    bb_text_table nodes, elements;
    uint64_t vertices, tets, attributes;
    uint64_t first; /* number of the first vertex: 0 or 1 */
} tetgen;

/* Finds FILE.node.zst for FILE.ele.zst, and the other way round; FILE.NODE for FILE.ELE. */
static bb_status find_both(const char *path, tetgen *t)
{
    static const char *const endings[] = {".node", ".ele", ".node.zst", ".ele.zst"};
    size_t length = strlen(path);
    for (int i = 0; i < 4; i++) {
        size_t ending = strlen(endings[i]);
        if (length <= ending || strcasecmp(path + length - ending, endings[i]) != 0)
            continue;
        int stem = (int)(length - ending);
        char *given = i % 2 == 0 ? t->node_path : t->ele_path;
        char *other = i % 2 == 0 ? t->ele_path : t->node_path;
        if (length + strlen(endings[2]) >= PATH_MAX)
            return bb_fail(BB_INVALID, "%.80s...: the path is too long", path);
        snprintf(given, PATH_MAX, "%s", path);
        snprintf(other, PATH_MAX, "%.*s%s", stem, path, endings[i ^ 1]);
        for (char *c = other + stem; isupper((unsigned char)path[stem + 1]) && *c != '\0'; c++)
            *c = (char)toupper((unsigned char)*c);
        return BB_OK;
    }
    return bb_fail(BB_INVALID, "%s: ends neither in .node nor in .ele", path);
}

static bb_status read_heads(tetgen *t)
{
    double n[4] = {0};
    uint32_t count;
    uint64_t dimension, corners;
    BB_TRY(bb_text_table_next(&t->nodes, "the line that counts vertices", 1, 4, n, &count));
    BB_TRY(
        bb_text_table_whole(&t->nodes, n[0], "the number of vertices", 1, COUNT_MAX, &t->vertices));
    BB_TRY(bb_text_table_whole(&t->nodes, count > 1 ? n[1] : 3, "the dimension", 3, 3, &dimension));
    BB_TRY(bb_text_table_whole(&t->nodes, count > 2 ? n[2] : 0, "the number of attributes", 0, 1000,
                               &t->attributes));
    BB_TRY(bb_text_table_next(&t->elements, "the line that counts tetrahedra", 1, 3, n, &count));
    BB_TRY(bb_text_table_whole(&t->elements, n[0], "the number of tetrahedra", 1, COUNT_MAX,
                               &t->tets));
    BB_TRY(bb_text_table_whole(&t->elements, count > 1 ? n[1] : 4, "nodes per tetrahedron", 4, 10,
                               &corners));
    return corners == 4 || corners == 10
               ? BB_OK
               : bb_fail(BB_INVALID, "%s: has elements of %d nodes: they must have 4 or 10",
                         t->elements.path, (int)corners);
}

static bb_status read_vertices(tetgen *t, bb_scene *scene, float *field)
{
    double n[5];
    uint32_t count;
    uint64_t number;
    for (uint64_t i = 0; i < t->vertices; i++) {
        BB_TRY(
            bb_text_table_next(&t->nodes, "all its vertices", field != NULL ? 5 : 4, 5, n, &count));
        BB_TRY(bb_text_table_whole(&t->nodes, n[0], "the vertex's number",
                                   i == 0 ? 0 : t->first + i, i == 0 ? 1 : t->first + i, &number));
        if (i == 0)
            t->first = number;
        for (int k = 0; k < 3; k++)
            scene->vertices[3 * i + (uint64_t)k] = (float)n[k + 1];
        if (field != NULL)
            field[i] = (float)n[4];
    }
    return BB_OK;
}

static bb_status read_tets(tetgen *t, bb_scene *scene)
{
    uint32_t *tets = (uint32_t *)scene->prims[BB_TETRAHEDRON].data, count;
    double n[5];
    uint64_t vertex;
    for (uint64_t i = 0; i < t->tets; i++) {
        BB_TRY(bb_text_table_next(&t->elements, "all its tetrahedra", 5, 5, n, &count));
        for (int c = 0; c < 4; c++) {
            BB_TRY(bb_text_table_whole(&t->elements, n[c + 1], "a vertex", t->first,
                                       t->first + t->vertices - 1, &vertex));
            tets[4 * i + (uint64_t)c] = (uint32_t)(vertex - t->first);
        }
    }
    return BB_OK;
}

static bb_status read_both(tetgen *t, bb_scene *scene)
{
    float *field = NULL;
    BB_TRY(read_heads(t));
    /* a number and a separator each: files that are too short are refused before memory is
     * reserved */
    uint64_t least = 2 * 4 * t->vertices, has = (uint64_t)(t->nodes.end - t->nodes.text);
    if (has < least)
        return bb_fail(BB_INVALID, "%s: has %llu bytes, too few for %llu vertices", t->nodes.path,
                       (unsigned long long)has, (unsigned long long)t->vertices);
    least = 2 * 5 * t->tets;
    has = (uint64_t)(t->elements.end - t->elements.text);
    if (has < least)
        return bb_fail(BB_INVALID, "%s: has %llu bytes, too few for %llu tetrahedra",
                       t->elements.path, (unsigned long long)has, (unsigned long long)t->tets);
    BB_TRY(bb_scene_reserve(scene, t->vertices,
                            &(bb_prim_counts){.of = {[BB_TETRAHEDRON] = t->tets}}));
    if (t->attributes > 0)
        BB_TRY(bb_scene_reserve_field(scene, "attribute 1", &field));
    BB_TRY(read_vertices(t, scene, field));
    return read_tets(t, scene);
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    (void)spec;
    tetgen t = {.first = 0};
    BB_TRY(find_both(path, &t));
    uint64_t room = bb_host_limit();
    BB_TRY(bb_text_table_open(t.node_path, &room, &t.nodes));
    bb_status status = bb_text_table_open(t.ele_path, &room, &t.elements);
    if (status == BB_OK)
        status = read_both(&t, scene);
    bb_text_table_close(&t.nodes);
    bb_text_table_close(&t.elements);
    return status;
}

static const char *const endings[] = {".node", ".ele", ".node.zst", ".ele.zst", NULL};

extern const bb_scene_format bb_scene_format_tetgen;
const bb_scene_format bb_scene_format_tetgen = {
    .name = "tetgen",
    .endings = endings,
    .load = load,
};
