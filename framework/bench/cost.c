#include "framework/bench/cost.h"

#include "traversal/pass.h"

enum { SAMPLE = 256 };

typedef struct counter {
    bb_device *device;
    const bb_kernel *kernel;
    bb_layout_maker maker;
    bb_layout_data layout;
    bb_buffer rays, answers, counts;
} counter;

static bb_status open_counter(counter *c, const bb_scene *scene, bb_tree *tree)
{
    const bb_kernel *const *kernel = bb_kernels;
    while (*kernel != NULL && !(*kernel)->native)
        kernel++;
    if (*kernel == NULL)
        return bb_fail(BB_FAILED, "no kernel takes every tree: nothing counts tests");
    c->kernel = *kernel;
    BB_TRY(bb_layout_maker_create(bb_layout_find(c->kernel->layout), c->device, &c->maker));
    BB_TRY(bb_layout_maker_make(&c->maker, scene, tree, 1, BB_FORMAT_VERTICES, &c->layout));
    BB_TRY(bb_buffer_reserve(c->device, NULL, SAMPLE * sizeof(bb_ray), "sample", &c->rays));
    BB_TRY(bb_buffer_reserve(c->device, NULL, SAMPLE * BB_RESULT_BYTES_MAX, "sample", &c->answers));
    return bb_buffer_reserve(c->device, NULL, SAMPLE * sizeof(bb_count), "sample", &c->counts);
}

static void close_counter(counter *c)
{
    bb_buffer_release(&c->rays);
    bb_buffer_release(&c->answers);
    bb_buffer_release(&c->counts);
    bb_layout_data_release(&c->layout);
    bb_layout_maker_destroy(&c->maker);
}

static bb_status count_set(counter *c, const bb_rays *set, double *tests)
{
    bb_ray rays[SAMPLE];
    char answers[SAMPLE * BB_RESULT_BYTES_MAX];
    bb_count counts[SAMPLE];
    bb_spec spec;
    bb_tracer *tracer;
    BB_TRY(bb_spec_parse(c->kernel->name, &spec));
    const bb_tracer_request request = {.kernel = c->kernel,
                                       .spec = &spec,
                                       .intersector = &bb_intersectors[0],
                                       .query = set->query,
                                       .counting = true};
    BB_TRY(bb_tracer_get(c->device, &request, &c->layout, &tracer));
    uint32_t count = set->count < SAMPLE ? set->count : SAMPLE;
    for (uint32_t i = 0; i < count; i++)
        rays[i] = set->rays[(uint64_t)i * set->count / count];
    BB_TRY(bb_buffer_write(&c->rays, 0, count * sizeof *rays, rays));
    const bb_pass pass = {.query = set->query,
                          .tracer = tracer,
                          .layout = &c->layout,
                          .rays = &c->rays,
                          .results = &c->answers,
                          .counts = &c->counts};
    BB_TRY(bb_pass_run(&pass, count, answers, counts));
    *tests = 0;
    for (uint32_t i = 0; i < count; i++)
        *tests += ((double)counts[i].nodes + counts[i].prims) / count;
    return BB_OK;
}

bb_status bb_tests_per_ray(bb_device *device, const bb_scene *scene, bb_tree *tree,
                           const bb_rays *const *sets, uint32_t set_count, double *tests)
{
    counter c = {.device = device};
    bool leaf = tree->info.node_count == 1;
    bb_status status = leaf ? BB_OK : open_counter(&c, scene, tree);
    for (uint32_t i = 0; i < set_count && status == BB_OK; i++)
        if (leaf)
            tests[i] = tree->info.ref_count;
        else
            status = count_set(&c, sets[i], &tests[i]);
    close_counter(&c);
    return status;
}
