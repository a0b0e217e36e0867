/* Slices of a mesh of tetrahedra, filled conservatively: kernels/slice_tets.cl. */
#ifndef BB_SLICE_H
#define BB_SLICE_H

#include "framework/bench/tet_search.h"

/* Slices lie one on the other about the middle of the mesh's bounds. */
typedef struct bb_slice_plan {
    uint32_t axis;          /* across which: 0, 1, 2 */
    uint32_t width, height; /* voxels, along the two other axes in ascending order */
    uint32_t count;
    double thickness; /* scene units */
} bb_slice_plan;

/* Checks the plan; a thickness of 0 becomes that with which the slices fill the mesh's bounds.
 * BB_INVALID if planes of neighbouring voxels or slices are the same number, BB_UNSUPPORTED if the
 * scene has no tetrahedra. */
bb_status bb_slice_plan_check(const bb_scene *scene, bb_slice_plan *plan);

/* Slice `i` of the plan, from below. */
bb_slice_args bb_slice_at(const bb_scene *scene, const bb_slice_plan *plan, uint32_t i);

/* Variants of the kernel, none compiled yet; to be released. */
extern const bb_tet_kernels bb_slice_kernels;

/* Enqueues the slice; does not wait. `by_boundary`: the search for what meets a voxel goes to cells
 * of the boundary only, BB_UNSUPPORTED without cells. `voxels` gets bb_sliced, row by row, the
 * first axis fastest; `counts`, if not NULL, bb_count. */
bb_status bb_slice(bb_tet_kernels *kernels, const bb_tet_search *search, bool by_boundary,
                   const bb_slice_args *args, bb_buffer *voxels, bb_buffer *counts);

#endif
