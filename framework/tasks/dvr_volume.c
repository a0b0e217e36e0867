/* Pictures of volumes, by kernels that trace their bricks, and without a tree. */
#include "framework/device/stopwatch.h"
#include "framework/tasks/dvr_private.h"

#include <stdio.h>
#include <xxhash.h>

static bb_traverser_request request_of(const bb_dvr *dvr, const bb_contest_runner *runner)
{
    bb_traverser_request request = {
        .kernel = runner->kernel, .spec = runner->spec, .intersector = &bb_intersectors[0]};
    bb_march_traverser_request(dvr->marcher, &request);
    return request;
}

static bb_status get_traverser(const bb_dvr *dvr, const bb_contest_runner *runner, bool counting,
                               bool recording, bb_traverser **traverser)
{
    bb_traverser_request request = request_of(dvr, runner);
    request.counting = counting;
    request.recording = recording;
    return bb_traverser_get(dvr->device, &request, runner->data[0], traverser);
}

static bb_status compile(void *self, bb_contest_runner *runner)
{
    for (int counting = 0; counting < 2; counting++)
        BB_TRY(get_traverser(self, runner, counting != 0, false, &runner->traversers[counting]));
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
                            answers.counts, answers.recording);
    bb_pass pass = {.traverser = runner->traversers[counting],
                    .layout = runner->data[0],
                    .rays = &dvr->rays.on_device,
                    .results = answers.items,
                    .counts = answers.counts,
                    .recording = answers.recording};
    if (answers.recording != NULL)
        BB_TRY(get_traverser(dvr, runner, true, true, &pass.traverser));
    bb_march_pass(dvr->marcher, &pass);
    return bb_pass_launch(&pass, dvr->pixels);
}

/* What steps read: of the layout, if there is a tree, and of the volume. */
static bb_status code_of(void *self, const bb_contest_runner *runner, bb_simulated_code *code)
{
    const bb_dvr *dvr = self;
    const bb_volume *volume = dvr->scene->volume;
    const uint32_t row = volume->grid.side + 1;
    bb_footing *f = &code->footing;
    if (bb_volume_bytes(volume) / volume->bytes > BB_STEP_INDEX_MASK)
        return bb_fail(BB_UNSUPPORTED, "the volume has more voxels than steps can name");
    if (runner->without) {
        snprintf(code->program, sizeof code->program, "march_all.cl");
        code->kernel = "march_all";
        *f = (bb_footing){.control = BB_WHILE_WHILE,
                          .group = BB_MARCH_GROUP,
                          .item_bytes = sizeof(bb_ray),
                          .result_bytes = sizeof(bb_light)};
    } else {
        const bb_traverser_request request = request_of(dvr, runner);
        if (!bb_kernel_records(request.kernel, request.query))
            return bb_fail(BB_UNSUPPORTED, "its steps are not recorded");
        snprintf(code->program, sizeof code->program, "march/%.500s", runner->spec->text);
        code->kernel = "trace";
        *f = bb_footing_of(&request, runner->data[0]);
    }
    f->voxel_bytes = volume->bytes;
    f->row = row;
    f->slice = row * row;
    f->entry_bytes = sizeof(bb_transfer_entry);
    return BB_OK;
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
    dvr->task.code = code_of;
    dvr->task.check = check;
    dvr->task.time = time_copy;
    BB_TRY(bb_marcher_create(dvr->scene, NULL, &dvr->marcher));
    bb_status room =
        bb_buffer_reserve(dvr->device, NULL, (size_t)bb_volume_bytes(dvr->scene->volume),
                          "a copy of the bricks", &dvr->copy);
    return room == BB_REFUSED ? BB_OK : room;
}
