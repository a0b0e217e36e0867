/* The header of a PLY file: its format, elements and their properties. */
#include "scenes/ply.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS_MAX = 8, LINE_BYTES_MAX = 1024 };

static const ply_type types[] = {
    {"char", "int8", 1, true, true},       {"uchar", "uint8", 1, true, false},
    {"short", "int16", 2, true, true},     {"ushort", "uint16", 2, true, false},
    {"int", "int32", 4, true, true},       {"uint", "uint32", 4, true, false},
    {"float", "float32", 4, false, false}, {"double", "float64", 8, false, false},
};

static const ply_type *find_type(const char *name)
{
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (strcmp(types[i].name, name) == 0 || strcmp(types[i].alias, name) == 0)
            return &types[i];
    return NULL;
}

static bb_status bad_header(const ply *ply, const char *what)
{
    return bb_fail(BB_INVALID, "%s: line %" PRIu64 " of its header %s", ply->path, ply->line, what);
}

/* Gets the words of the next line; a comment has none. */
static bb_status next_line(ply *ply, char text[LINE_BYTES_MAX], char *words[WORDS_MAX],
                           uint32_t *count)
{
    const char *line_end = memchr(ply->at, '\n', (size_t)(ply->end - ply->at));
    ply->line++;
    *count = 0;
    if (line_end == NULL)
        return bb_fail(BB_INVALID, "%s: is truncated: its header has no end_header", ply->path);
    const char *line = ply->at;
    size_t length = (size_t)(line_end - line);
    ply->at = line_end + 1;
    if ((length >= 7 && memcmp(line, "comment", 7) == 0) ||
        (length >= 8 && memcmp(line, "obj_info", 8) == 0))
        return BB_OK;
    if (length >= LINE_BYTES_MAX)
        return bad_header(ply, "is too long");
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)line[i];
        if ((c < ' ' && c != '\t' && c != '\r') || c == 127)
            return bad_header(ply, "is not text");
        text[i] = line[i];
    }
    text[length] = '\0';
    char *rest = NULL;
    for (char *word = strtok_r(text, " \t\r", &rest); word != NULL && *count < WORDS_MAX;
         word = strtok_r(NULL, " \t\r", &rest))
        words[(*count)++] = word;
    return BB_OK;
}

static bb_status take_format(ply *ply, char **words, uint32_t count)
{
    static const char *const names[] = {[PLY_ASCII] = "ascii",
                                        [PLY_LITTLE_ENDIAN] = "binary_little_endian",
                                        [PLY_BIG_ENDIAN] = "binary_big_endian"};
    if (count == 3 && strcmp(words[2], "1.0") == 0 && ply->encoding == PLY_NONE)
        for (ply_encoding i = PLY_ASCII; i <= PLY_BIG_ENDIAN; i++)
            if (strcmp(words[1], names[i]) == 0)
                ply->encoding = i;
    if (ply->encoding == PLY_NONE)
        return bad_header(ply, "must be format ascii 1.0, format binary_little_endian 1.0 or "
                               "format binary_big_endian 1.0");
    return BB_OK;
}

static bb_status take_element(ply *ply, char **words, uint32_t count)
{
    char *end = NULL;
    errno = 0;
    if (count != 3 || !isdigit((unsigned char)words[2][0]))
        return bad_header(ply, "must be element NAME COUNT");
    unsigned long long rows = strtoull(words[2], &end, 10);
    if (*end != '\0' || errno != 0)
        return bad_header(ply, "has a bad count of rows");
    if (ply->element_count == PLY_ELEMENTS_MAX)
        return bad_header(ply, "exceeds the limit of 32 elements");
    ply_element *element = &ply->elements[ply->element_count++];
    *element = (ply_element){.rows = rows,
                             .first = ply->property_count,
                             .is_vertex = strcmp(words[1], "vertex") == 0,
                             .is_face = strcmp(words[1], "face") == 0};
    snprintf(element->name, sizeof element->name, "%s", words[1]);
    for (uint32_t i = 0; i + 1 < ply->element_count; i++)
        if (strcmp(ply->elements[i].name, element->name) == 0)
            return bad_header(ply, "repeats an element");
    return BB_OK;
}

static ply_role find_role(const ply_element *element, const char *name, bool is_list)
{
    if (element->is_face && is_list &&
        (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0))
        return PLY_CORNERS;
    if (element->is_vertex && !is_list && name[0] >= 'x' && name[0] <= 'z' && name[1] == '\0')
        return (ply_role)(PLY_X + (name[0] - 'x'));
    return PLY_OTHER;
}

static bb_status take_property(ply *ply, char **words, uint32_t count)
{
    bool is_list = count > 1 && strcmp(words[1], "list") == 0;
    if (count != (is_list ? 5 : 3))
        return bad_header(ply, "must be property TYPE NAME or property list TYPE TYPE NAME");
    if (ply->element_count == 0)
        return bad_header(ply, "is a property before the first element");
    if (ply->property_count == PLY_PROPERTIES_MAX)
        return bad_header(ply, "exceeds the limit of 512 properties");
    ply_element *element = &ply->elements[ply->element_count - 1];
    ply_property *property = &ply->properties[ply->property_count++];
    property->type = find_type(words[is_list ? 3 : 1]);
    property->count = is_list ? find_type(words[2]) : NULL;
    property->role = find_role(element, words[count - 1], is_list);
    if (property->type == NULL || (is_list && property->count == NULL))
        return bad_header(ply, "has an unknown type");
    if (is_list && !property->count->is_whole)
        return bad_header(ply, "has a list count of no integer type");
    if (property->role == PLY_CORNERS && !property->type->is_whole)
        return bad_header(ply, "has indices of no integer type");
    for (uint32_t i = element->first; i + 1 < ply->property_count; i++)
        if (property->role != PLY_OTHER && ply->properties[i].role == property->role)
            return bad_header(ply, "repeats a property");
    element->properties++;
    const ply_type *first = is_list ? property->count : property->type;
    element->least += ply->encoding == PLY_ASCII ? 1 : first->size;
    return BB_OK;
}

static bb_status take_line(ply *ply, char **words, uint32_t count)
{
    if (strcmp(words[0], "format") == 0)
        return take_format(ply, words, count);
    if (ply->encoding == PLY_NONE)
        return bad_header(ply, "comes before the format");
    if (strcmp(words[0], "element") == 0)
        return take_element(ply, words, count);
    if (strcmp(words[0], "property") == 0)
        return take_property(ply, words, count);
    return bad_header(ply, "must be format, element, property, comment, obj_info or end_header");
}

const ply_element *bb_ply_find(const ply *ply, const char *name)
{
    for (uint32_t i = 0; i < ply->element_count; i++)
        if (strcmp(ply->elements[i].name, name) == 0)
            return &ply->elements[i];
    return NULL;
}

static bool has_role(const ply *ply, const ply_element *element, ply_role role)
{
    for (uint32_t i = 0; i < element->properties; i++)
        if (ply->properties[element->first + i].role == role)
            return true;
    return false;
}

/* Checks that the header describes triangles. */
static bb_status check_header(const ply *ply)
{
    const ply_element *vertex = bb_ply_find(ply, "vertex"), *face = bb_ply_find(ply, "face");
    if (vertex == NULL || vertex->rows == 0)
        return bb_fail(BB_INVALID, "%s: has no vertices", ply->path);
    if (!has_role(ply, vertex, PLY_X) || !has_role(ply, vertex, PLY_Y) ||
        !has_role(ply, vertex, PLY_Z))
        return bb_fail(BB_INVALID, "%s: its vertices have no x, y and z", ply->path);
    if ((face == NULL || face->rows == 0) && bb_ply_find(ply, "tristrips") != NULL)
        return bb_fail(BB_UNSUPPORTED,
                       "%s: holds triangle strips, which are not read: save it with faces",
                       ply->path);
    if (face == NULL || face->rows == 0)
        return bb_fail(BB_INVALID, "%s: holds points only: %" PRIu64 " vertices and no face",
                       ply->path, vertex->rows);
    if (!has_role(ply, face, PLY_CORNERS))
        return bb_fail(BB_INVALID, "%s: its faces have no list vertex_indices or vertex_index",
                       ply->path);
    return BB_OK;
}

bb_status bb_ply_read_header(ply *ply)
{
    char text[LINE_BYTES_MAX], *words[WORDS_MAX];
    uint32_t count;
    size_t size = (size_t)(ply->end - ply->data);
    if (size == 0)
        return bb_fail(BB_INVALID, "%s: is empty", ply->path);
    if (size < 4 || memcmp(ply->data, "ply", 3) != 0 || strchr("\r\n", ply->data[3]) == NULL)
        return bb_fail(BB_INVALID, "%s: is not PLY: its first line is not 'ply'", ply->path);
    BB_TRY(next_line(ply, text, words, &count));
    for (;;) {
        BB_TRY(next_line(ply, text, words, &count));
        if (count == 1 && strcmp(words[0], "end_header") == 0)
            break;
        if (count > 0)
            BB_TRY(take_line(ply, words, count));
    }
    ply->body = ply->at;
    ply->body_line = ply->line;
    return check_header(ply);
}
