/* Pictures of volumes, by kernels that trace their bricks, and without a tree. */
#include "framework/device/stopwatch.h"
#include "framework/dvr/dvr_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <xxhash.h>

typedef struct volume_renderer {
    bb_scene *scene;
    bb_device *device;
    bb_marcher *marcher;
    bb_buffer copy; /* room for the bricks once more; empty: there is none */
} volume_renderer;

static void describe(const void *opaque, bb_dvr_result *result)
{
    const volume_renderer *self = opaque;
    const bb_volume *volume = self->scene->volume;
    snprintf(result->transfer, sizeof result->transfer, "%s", volume->transfer.name);
    for (int k = 0; k < 3; k++)
        result->dims[k] = volume->grid.cells[k] + 1;
    result->bytes = volume->bytes;
    result->brick_side = volume->grid.side;
    result->bricks = volume->brick_count;
    result->seen = self->scene->prim_count;
    result->volume_bytes = bb_volume_bytes(volume);
}

static bb_status make(void *opaque, const char *text, bb_tree *const *trees,
                      bb_contest_runner *runner)
{
    volume_renderer *self = opaque;
    const bb_kernel *kernel;
    bb_spec spec;
    uint64_t leaf;
    BB_TRY(bb_kernel_parse(text, &spec, &kernel));
    BB_TRY(bb_spec_u64(&spec, bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf));
    runner->leaf = (uint32_t)leaf;
    BB_TRY(
        bb_layout_maker_create(bb_layout_find(kernel->layout), self->device, &runner->makers[0]));
    runner->makers[0].wish = bb_kernel_wish(&spec);
    BB_TRY(bb_layout_maker_make(&runner->makers[0], self->scene, trees[0], runner->leaf,
                                BB_FORMAT_VERTICES, &runner->layouts[0]));
    for (int counting = 0; counting < 2; counting++) {
        bb_tracer_request request = {.kernel = kernel,
                                     .spec = &spec,
                                     .intersector = &bb_intersectors[0],
                                     .counting = counting != 0};
        bb_march_tracer_request(self->marcher, &request);
        BB_TRY(
            bb_tracer_get(self->device, &request, &runner->layouts[0], &runner->tracers[counting]));
    }
    return BB_OK;
}

static bb_status set(void *opaque, const bb_march_settings *settings)
{
    volume_renderer *self = opaque;
    return bb_marcher_set(self->marcher, settings);
}

static bb_status launch(void *opaque, const bb_contest_runner *runner, bb_dvr_pictures *p,
                        bool counting)
{
    volume_renderer *self = opaque;
    bb_buffer *counts = counting ? &p->counts : NULL;
    if (runner == NULL)
        return bb_march_all(self->marcher, &p->rays.on_device, p->pixels, &p->lights, counts);
    bb_pass pass = {.tracer = runner->tracers[counting],
                    .layout = &runner->layouts[0],
                    .rays = &p->rays.on_device,
                    .results = &p->lights,
                    .counts = counts};
    bb_march_pass(self->marcher, &pass);
    return bb_pass_launch(&pass, p->pixels);
}

/* Whether the bricks on the device are still those that were loaded: builders are handed them, and
 * a picture of others would be the same with any tree. */
static bb_status check(void *opaque)
{
    const volume_renderer *self = opaque;
    const bb_volume *volume = self->scene->volume;
    const bb_buffer *bricks = &self->scene->on_device.bricks;
    void *mapped;
    BB_TRY(bb_buffer_map(bricks, false, &mapped));
    bool same = XXH3_64bits(mapped, (size_t)bb_volume_bytes(volume)) == volume->bricks_hash;
    BB_TRY(bb_buffer_unmap(bricks, mapped));
    return same ? BB_OK
                : bb_fail(BB_FAILED, "%s: a builder has changed the volume on the device",
                          self->scene->name);
}

/* What votes are compared with: how fast memory is. */
static bb_status time_copy(void *opaque, bb_dvr_result *result)
{
    volume_renderer *self = opaque;
    bb_stopwatch watch;
    bb_timing timing;
    if (self->copy.mem == NULL)
        return BB_OK;
    BB_TRY(bb_stopwatch_start(self->device, &watch));
    bb_status status = bb_buffer_copy(&self->scene->on_device.bricks, &self->copy,
                                      (size_t)bb_volume_bytes(self->scene->volume));
    bb_status stopped = bb_stopwatch_stop(&watch, &timing);
    BB_TRY(status);
    BB_TRY(stopped);
    bb_samples_add(&result->copy, timing.ms);
    return BB_OK;
}

static void destroy(void *opaque)
{
    volume_renderer *self = opaque;
    if (self == NULL)
        return;
    bb_marcher_destroy(self->marcher);
    bb_buffer_release(&self->copy);
    free(self);
}

bb_status bb_dvr_render_volume(bb_scene *scene, bb_dvr_renderer *renderer)
{
    volume_renderer *self = calloc(1, sizeof *self);
    *renderer = (bb_dvr_renderer){.self = self,
                                  .without = true,
                                  .unit = bb_volume_voxel(scene->volume),
                                  .describe = describe,
                                  .make = make,
                                  .set = set,
                                  .launch = launch,
                                  .check = check,
                                  .time = time_copy,
                                  .destroy = destroy};
    if (self == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    self->scene = scene;
    self->device = scene->on_device.device;
    BB_TRY(bb_marcher_create(scene, NULL, &self->marcher));
    bb_status room = bb_buffer_reserve(self->device, NULL, (size_t)bb_volume_bytes(scene->volume),
                                       "a copy of the bricks", &self->copy);
    return room == BB_REFUSED ? BB_OK : room;
}
