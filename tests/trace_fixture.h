/* What the tests of traversal share: a scene, a builder's tree of it, the layout that a kernel
 * reads, and traces. */
#ifndef BB_TRACE_FIXTURE_H
#define BB_TRACE_FIXTURE_H

#include "framework/builder/instance.h"
#include "tests/device_fixture.h"
#include "tests/layout_leaf.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct bed {
    bb_scene *scene; /* the bed's own */
    bb_instance instance;
    bb_spec kernel;
    bb_layout_maker maker;
    bb_layout_data layout;
} bed;

/* Makes what this kernel reads, with leaves of up to `leaf`, or as many as fit there; the tree
 * stays. */
static inline void choose_kernel(bed *b, const char *kernel, uint32_t leaf)
{
    bb_layout_data_release(&b->layout);
    bb_layout_maker_destroy(&b->maker);
    check(bb_spec_parse(kernel, &b->kernel), kernel);
    const bb_layout *layout = bb_layout_find(bb_kernel_find(b->kernel.name)->layout);
    check(bb_layout_maker_create(layout, device, &b->maker), kernel);
    check(bb_layout_maker_make(&b->maker, b->scene, &b->instance.tree, leaf_for(layout, leaf),
                               BB_FORMAT_VERTICES, &b->layout),
          kernel);
}

/* Takes the scene, also where the builder does not take its primitives: then there is nothing to
 * close. */
static inline bool open_bed_if_taken(bed *b, bb_scene *scene, const char *builder,
                                     const char *kernel, uint32_t leaf, uint32_t *ran)
{
    memset(b, 0, sizeof *b);
    b->scene = scene;
    check(bb_scene_upload(scene, device), "upload");
    if (!is_taken(bb_instance_create(device, builder, scene, seed, &b->instance), builder, ran)) {
        bb_scene_free(scene);
        return false;
    }
    check(bb_instance_build(&b->instance, scene, false, NULL), builder);
    check(bb_tree_upload(&b->instance.tree, device, NULL), builder);
    choose_kernel(b, kernel, leaf);
    return true;
}

static inline void open_bed(bed *b, bb_scene *scene, const char *builder, const char *kernel,
                            uint32_t leaf)
{
    uint32_t ran = 0;
    if (!open_bed_if_taken(b, scene, builder, kernel, leaf, &ran))
        fail_msg("builder %s does not take the scene: %s", builder, bb_message());
}

static inline void close_bed(bed *b)
{
    bb_layout_data_release(&b->layout);
    bb_layout_maker_destroy(&b->maker);
    bb_instance_destroy(&b->instance);
    bb_scene_free(b->scene);
}

/* Traces with the bed's kernel, for what its layout needs; `counts` may be NULL. */
static inline void trace(const bed *b, const char *intersector, const bb_ray *rays, uint32_t count,
                         const bb_query *query, void *hits, bb_count *counts)
{
    bb_traverser_request request = {
        .kernel = bb_kernel_find(b->kernel.name),
        .spec = &b->kernel,
        .intersector = bb_intersector_find(intersector),
        .query = query,
        .counting = counts != NULL,
    };
    bb_traverser *traverser;
    bb_buffer d_rays = {0}, d_hits = {0}, d_counts = {0};
    check(bb_traverser_get(device, &request, &b->layout, &traverser), "traverser");
    check(bb_buffer_reserve(device, NULL, count * sizeof *rays, "rays", &d_rays), "rays");
    check(bb_buffer_reserve(device, NULL, count * query->result_bytes, "hits", &d_hits), "hits");
    check(bb_buffer_reserve(device, NULL, count * sizeof *counts, "counts", &d_counts), "counts");
    check(bb_buffer_write(&d_rays, 0, count * sizeof *rays, rays), "rays");
    const bb_pass pass = {.query = query,
                          .traverser = traverser,
                          .layout = &b->layout,
                          .rays = &d_rays,
                          .results = &d_hits,
                          .counts = &d_counts};
    check(bb_pass_run(&pass, count, hits, counts), "trace");
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_hits);
    bb_buffer_release(&d_counts);
}

static inline bb_scene *load(const char *name)
{
    bb_scene *scene = NULL;
    check(bb_scene_load(name, &scene), name);
    return scene;
}

#endif
