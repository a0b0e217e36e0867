#include "framework/tasks/slice.h"

#include <math.h>

enum { VOXELS_MAX = 1 << 27 };

const bb_tet_kernels bb_slice_kernels = {
    .source = "slice_tets.cl", .name = "slice_tets", .option = "BB_WALK_BOUNDARY"};

/* The two axes along a slice. */
static void axes_of(uint32_t axis, uint32_t along[2])
{
    along[0] = axis == 0 ? 1 : 0;
    along[1] = axis == 2 ? 1 : 2;
}

static double middle(const bb_scene *scene, uint32_t axis)
{
    return ((double)scene->bounds.lo[axis] + (double)scene->bounds.hi[axis]) / 2;
}

/* Where slice `i` begins. */
static float plane(const bb_scene *scene, const bb_slice_plan *plan, uint32_t i)
{
    return (float)(middle(scene, plan->axis) + (i - plan->count / 2.0) * plan->thickness);
}

bb_slice_args bb_slice_at(const bb_scene *scene, const bb_slice_plan *plan, uint32_t i)
{
    uint32_t along[2];
    axes_of(plan->axis, along);
    bb_slice_args args = {
        .size = {plan->width, plan->height},
        .axis = plan->axis,
        .below = plane(scene, plan, i),
        .above = plane(scene, plan, i + 1),
        .field_lo = scene->tets->field_lo,
        .field_hi = scene->tets->field_hi,
    };
    for (int k = 0; k < 2; k++) {
        args.lo[k] = scene->bounds.lo[along[k]];
        args.hi[k] = scene->bounds.hi[along[k]];
        args.step[k] = (float)(((double)args.hi[k] - (double)args.lo[k]) / args.size[k]);
    }
    return args;
}

/* Whether all planes lo + i * step are different numbers: those furthest from 0 come closest. */
static bool are_apart(float lo, float hi, float step)
{
    float far = fmaxf(fabsf(lo), fabsf(hi));
    return isfinite(step) && step > far * 0x1p-22f;
}

bb_status bb_slice_plan_check(const bb_scene *scene, bb_slice_plan *plan)
{
    static const char *const names = "xyz";
    const double side = (double)scene->bounds.hi[plan->axis] - (double)scene->bounds.lo[plan->axis];
    uint32_t along[2];
    if (scene->tets == NULL)
        return bb_fail(BB_UNSUPPORTED, "%s: has no tetrahedra to be sliced", scene->name);
    axes_of(plan->axis, along);
    const uint64_t voxels = (uint64_t)plan->width * plan->height;
    if (voxels == 0 || voxels > VOXELS_MAX || plan->count == 0)
        return bb_fail(BB_INVALID,
                       "%s: %u slices of %u x %u voxels: at least one of each, and at "
                       "most 2^27 voxels in a slice",
                       scene->name, plan->count, plan->width, plan->height);
    if (plan->thickness == 0)
        plan->thickness = side / plan->count;
    const bb_slice_args args = bb_slice_at(scene, plan, 0);
    for (int k = 0; k < 2; k++)
        if (!are_apart(args.lo[k], args.hi[k], args.step[k]))
            return bb_fail(BB_INVALID,
                           "%s: %u voxels along %c, from %.9g to %.9g, are closer than floats can "
                           "tell: take fewer, or another axis",
                           scene->name, args.size[k], names[along[k]], (double)args.lo[k],
                           (double)args.hi[k]);
    float below = args.below, above = plane(scene, plan, plan->count);
    const double farthest = fmax(fabs((double)below), fabs((double)above));
    /* lengths of layouts are to be at most 2^60 (bb_scene_choose_scale()) */
    if (!(farthest * (double)scene->scale < 0x1p60) ||
        !are_apart(below, above, (float)plan->thickness))
        return bb_fail(
            BB_INVALID,
            "%s: slices of thickness %g along %c, about %.9g, are closer than floats can "
            "tell, or beyond them: take fewer, or another thickness",
            scene->name, plan->thickness, names[plan->axis], middle(scene, plan->axis));
    return BB_OK;
}

bb_status bb_slice(bb_tet_kernels *kernels, const bb_tet_search *search, bool by_boundary,
                   const bb_slice_args *slice, bb_buffer *voxels, bb_buffer *counts)
{
    const bb_scene_device *there = &search->scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(search->scene);
    const size_t count = (size_t)slice->size[0] * slice->size[1];
    bb_arg args[BB_TET_SEARCH_ARGS + 6 + BB_TET_COUNT_ARGS];
    cl_kernel kernel;
    if (by_boundary && !bb_tet_search_has_boundary(search->way))
        return bb_fail(BB_UNSUPPORTED, "there are no cells with flags of the boundary to slice by");
    BB_TRY(bb_tet_kernels_get(kernels, there->device, search->way, by_boundary,
                              bb_tet_counting_for(search, counts), &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->vertices);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_VALUE(*slice);
    args[n++] = BB_MEM(*voxels);
    n += bb_tet_count_args(search, counts, args + n);
    return bb_launch_args(there->device, kernel, count, BB_TET_GROUP, args, n);
}
