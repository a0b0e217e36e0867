/* Pictures of volumes, by kernels that trace their bricks, and without a tree. */
#include "framework/device/stopwatch.h"
#include "framework/tasks/dvr_private.h"

#include <xxhash.h>

static bb_status compile(void *self, const bb_kernel *kernel, const bb_spec *spec,
                         bb_contest_runner *runner)
{
    const bb_dvr *dvr = self;
    for (int counting = 0; counting < 2; counting++) {
        bb_traverser_request request = {.kernel = kernel,
                                        .spec = spec,
                                        .intersector = &bb_intersectors[0],
                                        .counting = counting != 0};
        bb_march_traverser_request(dvr->marcher, &request);
        BB_TRY(bb_traverser_get(dvr->device, &request, runner->data[0],
                                &runner->traversers[counting]));
    }
    return BB_OK;
}

static bb_status set(bb_dvr *dvr, const bb_march_settings *settings)
{
    return bb_marcher_set(dvr->marcher, settings);
}

static bb_status ask(void *self, const bb_contest_runner *runner, bb_contest_answers answers)
{
    const bb_dvr *dvr = self;
    const bool counting = answers.counts != NULL;
    if (runner->without)
        return bb_march_all(dvr->marcher, &dvr->rays.on_device, dvr->pixels, answers.items,
                            answers.counts);
    bb_pass pass = {.traverser = runner->traversers[counting],
                    .layout = runner->data[0],
                    .rays = &dvr->rays.on_device,
                    .results = answers.items,
                    .counts = answers.counts};
    bb_march_pass(dvr->marcher, &pass);
    return bb_pass_launch(&pass, dvr->pixels);
}

/* Whether the bricks on the device are still those that were loaded: builders are handed them, and
 * a picture of others would be the same with any tree. */
static bb_status check(void *self)
{
    const bb_dvr *dvr = self;
    const bb_volume *volume = dvr->scene->volume;
    const bb_buffer *bricks = &dvr->scene->on_device.bricks;
    void *mapped;
    BB_TRY(bb_buffer_map(bricks, false, &mapped));
    bool same = XXH3_64bits(mapped, (size_t)bb_volume_bytes(volume)) == volume->bricks_hash;
    BB_TRY(bb_buffer_unmap(bricks, mapped));
    return same ? BB_OK
                : bb_fail(BB_FAILED, "%s: a builder has changed the volume on the device",
                          dvr->scene->name);
}

/* What votes are compared with: how fast memory is. */
static bb_status time_copy(void *self)
{
    bb_dvr *dvr = self;
    bb_stopwatch watch;
    bb_timing timing;
    if (dvr->copy.mem == NULL)
        return BB_OK;
    BB_TRY(bb_stopwatch_start(dvr->device, &watch));
    bb_status status = bb_buffer_copy(&dvr->scene->on_device.bricks, &dvr->copy,
                                      (size_t)bb_volume_bytes(dvr->scene->volume));
    BB_TRY(bb_stopwatch_stop(&watch, status, &timing));
    bb_samples_add(&dvr->copy_ms, timing.ms);
    return BB_OK;
}

bb_status bb_dvr_of_volume(bb_dvr *dvr)
{
    dvr->unit = bb_volume_voxel(dvr->scene->volume);
    dvr->set = set;
    dvr->task.compile = compile;
    dvr->task.ask = ask;
    dvr->task.check = check;
    dvr->task.time = time_copy;
    BB_TRY(bb_marcher_create(dvr->scene, NULL, &dvr->marcher));
    bb_status room =
        bb_buffer_reserve(dvr->device, NULL, (size_t)bb_volume_bytes(dvr->scene->volume),
                          "a copy of the bricks", &dvr->copy);
    return room == BB_REFUSED ? BB_OK : room;
}
