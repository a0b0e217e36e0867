/* PLY (Turk's polygon file format), ASCII and binary of both byte orders: scenes/README.md lists
 * what is read, and why no library is used. The rows are read twice: to check and count, then to
 * fill the scene. */
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/scene/scene.h"
#include "scenes/ply.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ---- */

/* Describes the current position for messages. */
static const char *place(const ply *ply, char text[64])
{
    if (ply->encoding == PLY_ASCII)
        snprintf(text, 64, "line %" PRIu64, ply->line);
    else
        snprintf(text, 64, "%s %" PRIu64 " (from 0)", ply->element->name, ply->row);
    return text;
}

static bb_status truncated(const ply *ply)
{
    return bb_fail(BB_INVALID, "%s: is truncated: it ends in %s %" PRIu64 " of %" PRIu64, ply->path,
                   ply->element->name, ply->row + 1, ply->element->rows);
}

static uint64_t bytes_left(const ply *ply)
{
    return (uint64_t)(ply->end - ply->at);
}

static bb_status read_bytes(ply *ply, const ply_type *type, double *out)
{
    if (bytes_left(ply) < type->size)
        return truncated(ply);
    uint64_t bits = 0;
    for (uint32_t i = 0; i < type->size; i++) {
        uint32_t byte = ply->encoding == PLY_LITTLE_ENDIAN ? type->size - 1 - i : i;
        bits = bits << 8 | (unsigned char)ply->at[byte];
    }
    ply->at += type->size;
    float single;
    uint32_t low = (uint32_t)bits;
    uint64_t sign = (uint64_t)1 << (8 * type->size - 1);
    if (type->is_whole)
        *out = (double)(int64_t)(type->is_signed ? (bits ^ sign) - sign : bits);
    else if (type->size == 4) {
        memcpy(&single, &low, 4);
        *out = (double)single;
    } else
        memcpy(out, &bits, 8);
    return BB_OK;
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Reads a word of the current line. */
static bb_status read_word(ply *ply, const ply_type *type, double *out)
{
    char text[64], *end = NULL;
    while (ply->at < ply->end && is_space(*ply->at))
        ply->at++;
    if (ply->at == ply->end)
        return truncated(ply);
    if (*ply->at == '\n')
        return bb_fail(BB_INVALID, "%s: %s ends before the numbers of its %s are there", ply->path,
                       place(ply, text), ply->element->name);
    const char *word = ply->at;
    while (ply->at < ply->end && !is_space(*ply->at) && *ply->at != '\n')
        ply->at++;
    *out = strtod(word, &end);
    double bound = ldexp(1, 8 * (int)type->size - (type->is_signed ? 1 : 0));
    bool good = end == ply->at;
    if (good && type->is_whole)
        good = *out < bound && *out >= (type->is_signed ? -bound : 0) && *out == floor(*out);
    for (const char *c = word; good && c < ply->at; c++)
        good = tolower((unsigned char)*c) != 'x'; /* strtod() accepts hexadecimal */
    if (good)
        return BB_OK;
    char quoted[41];
    size_t length = (size_t)(ply->at - word);
    length = length < sizeof quoted - 1 ? length : sizeof quoted - 1;
    for (size_t i = 0; i < length; i++)
        quoted[i] = (char)(isprint((unsigned char)word[i]) ? word[i] : '?');
    quoted[length] = '\0';
    return bb_fail(BB_INVALID, "%s: %s: '%s' is no %s", ply->path, place(ply, text), quoted,
                   type->name);
}

static bb_status read_number(ply *ply, const ply_type *type, double *out)
{
    return ply->encoding == PLY_ASCII ? read_word(ply, type, out) : read_bytes(ply, type, out);
}

/* ---- rows ---- */

static bb_status start_row(ply *ply)
{
    if (ply->encoding != PLY_ASCII)
        return BB_OK;
    while (ply->at < ply->end && (is_space(*ply->at) || *ply->at == '\n'))
        ply->line += *ply->at++ == '\n';
    return ply->at < ply->end ? BB_OK : truncated(ply);
}

static bb_status end_row(ply *ply)
{
    char text[64];
    if (ply->encoding != PLY_ASCII)
        return BB_OK;
    while (ply->at < ply->end && is_space(*ply->at))
        ply->at++;
    if (ply->at < ply->end && *ply->at != '\n')
        return bb_fail(BB_INVALID, "%s: %s has more numbers than its %s needs", ply->path,
                       place(ply, text), ply->element->name);
    return BB_OK;
}

static bb_status take_corner(ply *ply, double index, uint64_t vertices)
{
    char text[64];
    if (index < 0 || index >= (double)vertices)
        return bb_fail(BB_INVALID, "%s: %s: index %.0f names no vertex, there are %" PRIu64,
                       ply->path, place(ply, text), index, vertices);
    if (ply->corner_count == ply->corner_room) {
        uint64_t room = 2 * ply->corner_room + 16;
        uint32_t *corners = realloc(ply->corners, room * sizeof *corners);
        if (corners == NULL)
            return bb_fail(BB_REFUSED, "%s: needs more memory than there is", ply->path);
        ply->corners = corners;
        ply->corner_room = room;
    }
    ply->corners[ply->corner_count++] = (uint32_t)index;
    return BB_OK;
}

static bb_status read_list(ply *ply, const ply_property *property, uint64_t vertices)
{
    char text[64];
    double count, item;
    BB_TRY(read_number(ply, property->count, &count));
    if (count < 0)
        return bb_fail(BB_INVALID, "%s: %s: a list of %.0f", ply->path, place(ply, text), count);
    for (uint64_t i = 0; i < (uint64_t)count; i++) {
        BB_TRY(read_number(ply, property->type, &item));
        if (property->role == PLY_CORNERS)
            BB_TRY(take_corner(ply, item, vertices));
    }
    return BB_OK;
}

static bb_status read_row(ply *ply, uint64_t vertices)
{
    double number;
    ply->corner_count = 0;
    BB_TRY(start_row(ply));
    for (uint32_t i = 0; i < ply->element->properties; i++) {
        const ply_property *property = &ply->properties[ply->element->first + i];
        if (property->count != NULL) {
            BB_TRY(read_list(ply, property, vertices));
            continue;
        }
        BB_TRY(read_number(ply, property->type, &number));
        if (property->role <= PLY_Z)
            ply->position[property->role] = number;
    }
    return end_row(ply);
}

/* Rounds once. */
static bb_status take_vertex(const ply *ply, bb_scene *scene)
{
    char text[64];
    for (int axis = 0; axis < 3; axis++) {
        float x = (float)ply->position[axis];
        if (!isfinite(x))
            return bb_fail(BB_INVALID, "%s: %s: the vertex is not finite: (%g %g %g)", ply->path,
                           place(ply, text), ply->position[0], ply->position[1], ply->position[2]);
        if (scene != NULL)
            scene->vertices[3 * ply->row + (uint64_t)axis] = x;
    }
    return BB_OK;
}

static void take_face(ply *ply, bb_scene *scene)
{
    ply->ignored += ply->corner_count < 3;
    for (uint64_t i = 2; i < ply->corner_count; i++) {
        if (scene != NULL) {
            uint32_t *out = bb_scene_indices(scene) + 3 * ply->triangles;
            out[0] = ply->corners[0];
            out[1] = ply->corners[i - 1];
            out[2] = ply->corners[i];
        }
        ply->triangles++;
    }
}

/* ---- reading the rows ---- */

static bb_status walk_element(ply *ply, uint64_t vertices, bb_scene *scene)
{
    const ply_element *element = ply->element;
    ply->row = 0;
    if (element->rows > 0 && element->properties == 0)
        return bb_fail(BB_INVALID, "%s: its element %s has no property", ply->path, element->name);
    if (element->rows > 0 && element->rows > bytes_left(ply) / element->least)
        return bb_fail(BB_INVALID,
                       "%s: is truncated: %" PRIu64 " of %s take %" PRIu64
                       " bytes each or more, but %" PRIu64 " are left",
                       ply->path, element->rows, element->name, element->least, bytes_left(ply));
    for (; ply->row < element->rows; ply->row++) {
        BB_TRY(read_row(ply, vertices));
        if (element->is_vertex)
            BB_TRY(take_vertex(ply, scene));
        if (element->is_face)
            take_face(ply, scene);
    }
    return BB_OK;
}

/* Checks and counts; fills the scene if it is not NULL. */
static bb_status walk(ply *ply, bb_scene *scene)
{
    uint64_t vertices = bb_ply_find(ply, "vertex")->rows;
    ply->at = ply->body;
    ply->line = ply->body_line + 1;
    ply->triangles = ply->ignored = 0;
    for (uint32_t i = 0; i < ply->element_count; i++) {
        ply->element = &ply->elements[i];
        BB_TRY(walk_element(ply, vertices, scene));
    }
    return BB_OK;
}

static bb_status read_file(ply *ply, bb_scene *scene)
{
    size_t size = 0;
    BB_TRY(bb_file_read(ply->path, (size_t)bb_host_limit(), "scene", &ply->data, &size));
    ply->at = ply->data;
    ply->end = ply->data + size;
    BB_TRY(bb_ply_read_header(ply));
    BB_TRY(walk(ply, NULL));
    if (ply->triangles == 0)
        return bb_fail(BB_INVALID, "%s: holds no face of three corners (%" PRIu64 " of fewer)",
                       ply->path, ply->ignored);
    BB_TRY(bb_scene_reserve_mesh(scene, bb_ply_find(ply, "vertex")->rows, ply->triangles));
    scene->ignored = ply->ignored < UINT32_MAX ? (uint32_t)ply->ignored : UINT32_MAX;
    return walk(ply, scene);
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    (void)spec;
    ply *ply = calloc(1, sizeof *ply);
    if (ply == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory to read it", path);
    ply->path = path;
    bb_status status = read_file(ply, scene);
    free(ply->corners);
    free(ply->data);
    free(ply);
    return status;
}

static const char *const endings[] = {".ply", NULL};

extern const bb_scene_format bb_scene_format_ply;
const bb_scene_format bb_scene_format_ply = {.name = "PLY", .endings = endings, .load = load};
