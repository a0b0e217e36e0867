#include "framework/bench/cost.h"

#include "framework/bench/count.h"

enum { SAMPLE = 256 };

/* By the layout that `maker` makes. */
static bb_status count_all(const bb_kernel *kernel, bb_layout_maker *maker, const bb_scene *scene,
                           bb_tree *tree, const bb_rays *const *sets, uint32_t set_count,
                           double *tests)
{
    bb_layout_data layout = {0};
    bb_counter counter = {0};
    bb_spec spec;
    BB_TRY(bb_spec_parse(kernel->name, &spec));
    bb_status status = bb_layout_maker_make(maker, scene, tree, 1, BB_FORMAT_VERTICES, &layout);
    if (status == BB_OK)
        status = bb_counter_create(maker->device, NULL, SAMPLE, &counter);
    for (uint32_t i = 0; i < set_count && status == BB_OK; i++) {
        const uint32_t count = sets[i]->count < SAMPLE ? sets[i]->count : SAMPLE;
        const bb_traverser_request request = {.kernel = kernel,
                                              .spec = &spec,
                                              .intersector = &bb_intersectors[0],
                                              .query = sets[i]->query};
        bb_tests sums;
        status = bb_count_tests(&counter, request, &layout, sets[i], sets[i]->count, count, &sums);
        tests[i] = ((double)sums.nodes + (double)sums.prims) / count;
    }
    bb_counter_release(&counter);
    bb_layout_data_release(&layout);
    return status;
}

bb_status bb_tests_per_ray(bb_device *device, const bb_scene *scene, bb_tree *tree,
                           const bb_rays *const *sets, uint32_t set_count, double *tests)
{
    const bb_kernel *const *kernel = bb_kernels;
    bb_layout_maker maker;
    for (uint32_t i = 0; i < set_count && tree->info.node_count == 1; i++)
        tests[i] = tree->info.ref_count;
    if (tree->info.node_count == 1)
        return BB_OK;
    while (*kernel != NULL && !(*kernel)->native)
        kernel++;
    if (*kernel == NULL)
        return bb_fail(BB_FAILED, "no kernel takes every tree: nothing counts tests");
    BB_TRY(bb_layout_maker_create(bb_layout_find((*kernel)->layout), device, &maker));
    bb_status status = count_all(*kernel, &maker, scene, tree, sets, set_count, tests);
    bb_layout_maker_destroy(&maker);
    return status;
}
