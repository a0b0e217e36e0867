/* What host and device say of tetrahedra alike. */
#ifndef BB_TET_SHARED_H
#define BB_TET_SHARED_H

#include "bb_shared.h"

/* Flags of a tetrahedron. The first four: beyond face f, which has all corners but the f-th, there
 * is no tetrahedron. */
#define BB_TET_BOUNDARY 0xFu
#define BB_TET_FLAT 0x10u     /* its volume is exactly 0: no point is in it */
#define BB_TET_NEGATIVE 0x20u /* its corners are listed the other way round */

/* Where a point is: the tetrahedron's number as a primitive, BB_NONE if none holds it, and the
 * scalar field there, else 0. */
typedef struct bb_located {
    bb_u32 prim;
    float value;
} bb_located;

/* A layout, as a search for points wants it. */
typedef struct bb_locate_args {
    bb_u32 root;
    bb_u32 first;   /* tetrahedra are numbered from it on */
    bb_u32 words;   /* of a leaf primitive */
    bb_u32 id_word; /* the one with its number */
    float scale;
} bb_locate_args;

#endif
