/* Makes the comparison that measures a point. Each method is combined with the other parts of the
 * axis only. */
#include "framework/stress/point_private.h"

#include "traversal/traversal.h"

#include <string.h>

/* bb_bench_request.takes */
static bool takes(const void *user, const char *builder, const char *kernel,
                  const char *intersector)
{
    const bb_point_request *request = user;
    const bb_points *points = request->points;
    for (uint32_t m = 0; m < points->method_count; m++) {
        const char *parts[BB_METHOD_PARTS];
        bb_method_cell(points->axis, &points->methods[m], parts);
        if (request->wanted[m] && bb_bench_fits(builder, parts[BB_A_BUILDER]) &&
            bb_bench_fits(kernel, parts[BB_A_KERNEL]) &&
            bb_bench_fits(intersector, parts[BB_AN_INTERSECTOR]))
            return true;
    }
    return false;
}

/* Lists the distinct specifications of a part of the wanted methods. Returns their number. */
static uint32_t list_part(const bb_point_request *request, bb_method_part part, char **list)
{
    const bb_points *points = request->points;
    uint32_t count = 0;
    for (uint32_t m = 0; m < points->method_count; m++) {
        const char *parts[BB_METHOD_PARTS];
        uint32_t at = 0;
        bb_method_cell(points->axis, &points->methods[m], parts);
        while (at < count && strcmp(list[at], parts[part]) != 0)
            at++;
        if (request->wanted[m] && at == count)
            list[count++] = (char *)parts[part];
    }
    return count;
}

const char *bb_method_part_word(bb_method_part part)
{
    static const char *const words[BB_METHOD_PARTS] = {"builder", "kernel", "intersector"};
    return words[part];
}

void bb_method_cell(const bb_axis *axis, const bb_method *method,
                    const char *parts[BB_METHOD_PARTS])
{
    parts[BB_A_BUILDER] = axis->builder;
    parts[BB_A_KERNEL] = axis->kernel;
    parts[BB_AN_INTERSECTOR] = bb_intersectors[0].name;
    parts[method->part] = method->text;
}

bb_status bb_point_request_make(const bb_points *points, double x, const bool *wanted,
                                bb_point_request *out)
{
    const bb_axis *axis = points->axis;
    uint32_t side = 1;
    while (side * side < points->max_rays)
        side++;
    out->points = points;
    out->wanted = wanted;
    BB_TRY(bb_axis_fill(axis->scene, x, points->n, out->scene, sizeof out->scene));
    out->scenes[0] = out->scene;
    for (uint32_t i = 0; i < axis->ray_count; i++) {
        BB_TRY(bb_axis_fill(axis->rays[i], x, points->n, out->rays[i], sizeof out->rays[i]));
        out->ray_sets[i] = out->rays[i];
    }
    out->bench = (bb_bench_request){
        .scenes = out->scenes,
        .scene_count = 1,
        .builders = out->builders,
        .builder_count = list_part(out, BB_A_BUILDER, out->builders),
        .kernels = out->kernels,
        .kernel_count = list_part(out, BB_A_KERNEL, out->kernels),
        .intersectors = out->intersectors,
        .intersector_count = list_part(out, BB_AN_INTERSECTOR, out->intersectors),
        .workloads = out->ray_sets,
        .workload_count = axis->ray_count,
        .width = side,
        .height = side,
        .max_rays = points->max_rays,
        .metrics = points->metrics,
        .metric_count = points->simt_count,
        .max_views = 1,
        .repeats = points->repeats,
        .seed = points->seed,
        .takes = takes,
        .user = out,
        .quiet = true,
    };
    return BB_OK;
}
