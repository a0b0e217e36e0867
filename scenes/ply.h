/* A PLY file as its header describes it: ply_header.c reads the header, format_ply.c the rows. */
#ifndef BB_PLY_H
#define BB_PLY_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum { PLY_ELEMENTS_MAX = 32, PLY_PROPERTIES_MAX = 512 };

typedef enum ply_encoding { PLY_NONE, PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN } ply_encoding;

typedef struct ply_type {
    const char *name, *alias;
    uint32_t size;
    bool is_whole, is_signed;
} ply_type;

/* How a number is used. */
typedef enum ply_role { PLY_X, PLY_Y, PLY_Z, PLY_CORNERS, PLY_OTHER } ply_role;

typedef struct ply_property {
    const ply_type *type;
    const ply_type *count; /* of a list; NULL: one number */
    ply_role role;
} ply_property;

typedef struct ply_element {
    char name[32];
    uint64_t rows;
    uint32_t first, properties;
    uint64_t least; /* bytes of a row */
    bool is_vertex, is_face;
} ply_element;

typedef struct ply {
    const char *path;
    char *data; /* a 0 byte follows the last one */
    const char *body, *end;
    ply_encoding encoding;
    ply_element elements[PLY_ELEMENTS_MAX];
    uint32_t element_count;
    ply_property properties[PLY_PROPERTIES_MAX];
    uint32_t property_count;
    uint64_t body_line;

    /* current position */
    const char *at;
    uint64_t line;
    const ply_element *element;
    uint64_t row;

    /* current row */
    double position[3];
    uint32_t *corners;
    uint64_t corner_count, corner_room;

    uint64_t triangles, ignored;
} ply;

/* Reads the header of the file in data..end and moves `at` behind it. BB_INVALID if it is invalid,
 * or has no triangles. */
bb_status bb_ply_read_header(ply *ply);

/* Returns the element of that name; NULL if there is none. */
const ply_element *bb_ply_find(const ply *ply, const char *name);

#endif
