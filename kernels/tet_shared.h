/* Types and constants of tetrahedra that host and device share. */
#ifndef BB_TET_SHARED_H
#define BB_TET_SHARED_H

#include "bb_shared.h"

/* Flags of a tetrahedron. Bit f of the first four: face f, which has all corners but the f-th, is
 * on the boundary: there is not a tetrahedron with a volume on both sides that has the same face,
 * by its indices. So faces beside a tetrahedron without volume, or beside vertices that are only at
 * the same position, are flagged too. */
#define BB_TET_BOUNDARY 0xFu
#define BB_TET_FLAT 0x10u     /* its volume is exactly 0: it contains no point */
#define BB_TET_NEGATIVE 0x20u /* its corners have negative orientation */

/* The location of a point: number of the tetrahedron as a primitive, BB_NONE if none contains it,
 * and the scalar field there, else 0. */
typedef struct bb_located {
    bb_u32 prim;
    float value;
} bb_located;

/* Which tetrahedra, counted from 0, are on the sides of a face: above, from where its corners turn
 * to the left, and below. BB_NONE: none. */
typedef struct bb_face_sides {
    bb_u32 above, below;
} bb_face_sides;

/* A layout, in the form for a search for points. */
typedef struct bb_locate_args {
    bb_u32 root;
    bb_u32 first;   /* number of the first tetrahedron */
    bb_u32 words;   /* words of a leaf primitive */
    bb_u32 id_word; /* the word with its number */
    bb_u32 levels;  /* of an OLBVH's arrays, the root's not counted */
    float scale;
} bb_locate_args;

/* The arrays of an OLBVH as published, as the layout `olbvh` has them in its buffers: boxes of
 * nodes, listed primitives, children of inner nodes, lists of nodes, flags of the boundary, and
 * first nodes of levels (layout_olbvh.cl). */
enum {
    BB_OLBVH_BV,
    BB_OLBVH_P,
    BB_OLBVH_CO,
    BB_OLBVH_PO,
    BB_OLBVH_BF,
    BB_OLBVH_NO,
    BB_OLBVH_ARRAYS
};
#define BB_OLBVH_STACK 8u /* entries of its search's short stack */

/* A slice: voxels between planes lo + i * step on two axes, the last plane being hi, and between
 * two planes on the third axis. */
typedef struct bb_slice_args {
    float lo[2], hi[2], step[2]; /* of the two other axes, in ascending order */
    bb_u32 size[2];              /* number of voxels along them */
    bb_u32 axis;                 /* perpendicular to the slice */
    float below, above;
    float field_lo, field_hi; /* of the mesh */
} bb_slice_args;

/* A voxel of a slice. */
typedef struct bb_sliced {
    bb_u32 prim; /* tetrahedron whose field it has; BB_NONE: no material */
    float value;
    bb_u32 inside; /* 1: the tetrahedron contains its centre */
} bb_sliced;

/* Parameters of a march through tetrahedra. */
typedef struct bb_tet_march_args {
    float lo[3]; /* bounds of all tetrahedra */
    float hi[3];
    float field_lo;
    float per_field; /* entries of the transfer function's table per unit of the field */
    float step;      /* distance between samples, in scene units */
    float cutoff;    /* the march ends when less light from behind than this is left; 0: never */
} bb_tet_march_args;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_located) == 8, "bb_located");
BB_STATIC_ASSERT(sizeof(bb_face_sides) == 8, "bb_face_sides");
BB_STATIC_ASSERT(sizeof(bb_locate_args) == 24, "bb_locate_args");
BB_STATIC_ASSERT(sizeof(bb_slice_args) == 52, "bb_slice_args");
BB_STATIC_ASSERT(sizeof(bb_sliced) == 12, "bb_sliced");
BB_STATIC_ASSERT(sizeof(bb_tet_march_args) == 40, "bb_tet_march_args");
#endif

#endif
