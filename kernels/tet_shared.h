/* What host and device say of tetrahedra alike. */
#ifndef BB_TET_SHARED_H
#define BB_TET_SHARED_H

#include "bb_shared.h"

/* Flags of a tetrahedron. The first four: of face f, which has all corners but the f-th, not both
 * sides have a tetrahedron with a volume that has the same face, by its indices. So those beside
 * one without a volume, or beside vertices that only lie at one place, are flagged too. */
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

/* A slice: voxels between planes lo + i * step on two axes, the last being hi; and between two
 * planes on the third. */
typedef struct bb_slice_args {
    float lo[2], hi[2], step[2]; /* of the two other axes, in ascending order */
    bb_u32 size[2];              /* voxels along them */
    bb_u32 axis;                 /* across the slice */
    float below, above;
    float field_lo, field_hi; /* of the mesh */
} bb_slice_args;

/* A voxel of a slice. */
typedef struct bb_sliced {
    bb_u32 prim; /* the tetrahedron whose field it has; BB_NONE: no material */
    float value;
    bb_u32 inside; /* 1: the tetrahedron holds its centre */
} bb_sliced;

/* What a march along a ray through tetrahedra is told. */
typedef struct bb_tet_march_args {
    float lo[3]; /* of all of them */
    float hi[3];
    float field_lo;
    float per_field; /* entries of the transfer function's table per unit of the field */
    float step;      /* distance of samples, in scene units */
    float cutoff;    /* it ends where less than this is left of the light behind; 0: never */
} bb_tet_march_args;

#ifndef __OPENCL_VERSION__
BB_STATIC_ASSERT(sizeof(bb_located) == 8, "bb_located");
BB_STATIC_ASSERT(sizeof(bb_locate_args) == 20, "bb_locate_args");
BB_STATIC_ASSERT(sizeof(bb_slice_args) == 52, "bb_slice_args");
BB_STATIC_ASSERT(sizeof(bb_sliced) == 12, "bb_sliced");
BB_STATIC_ASSERT(sizeof(bb_tet_march_args) == 40, "bb_tet_march_args");
#endif

#endif
