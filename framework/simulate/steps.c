#include "framework/simulate/steps.h"

#include "framework/base/arithmetic.h"
#include "traversal/pass.h"

#include <stdlib.h>
#include <string.h>

enum { PIECE = 1 << 18 }; /* rays at a time, whole runs, while steps are counted */

/* What a launch needs, on the device. */
typedef struct launch {
    bb_device *device;
    bb_pass pass;
    bb_buffer rays, results, tests;
    bb_recording recording;
} launch;

static void release(launch *l)
{
    bb_buffer_release(&l->rays);
    bb_buffer_release(&l->results);
    bb_buffer_release(&l->tests);
    bb_buffer_release(&l->recording.ends);
    bb_buffer_release(&l->recording.steps);
    bb_buffer_release(&l->recording.counts);
}

static bb_status prepare(launch *l, const bb_traverser_request *request,
                         const bb_layout_data *layout, uint32_t most)
{
    bb_traverser *traverser;
    BB_TRY(bb_traverser_get(l->device, request, layout, &traverser));
    BB_TRY(bb_buffer_reserve(l->device, NULL, most * sizeof(bb_ray), "sample of rays", &l->rays));
    BB_TRY(bb_buffer_reserve(l->device, NULL, most * BB_RESULT_BYTES_MAX, "answers to a sample",
                             &l->results));
    BB_TRY(
        bb_buffer_reserve(l->device, NULL, most * sizeof(bb_count), "counts of tests", &l->tests));
    const size_t bytes = most * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(l->device, NULL, bytes, "ends of steps", &l->recording.ends));
    BB_TRY(bb_buffer_reserve(l->device, NULL, bytes, "counts of steps", &l->recording.counts));
    BB_TRY(bb_buffer_reserve(l->device, NULL, sizeof(uint32_t), "steps", &l->recording.steps));
    l->pass = (bb_pass){.query = request->query,
                        .traverser = traverser,
                        .layout = layout,
                        .rays = &l->rays,
                        .results = &l->results,
                        .counts = &l->tests,
                        .recording = &l->recording};
    return BB_OK;
}

/* ---- a sample ---- */

/* Counts the steps of rays that are on the device: a launch without room for them. */
static bb_status count_steps(launch *l, uint32_t rays, uint32_t *counts)
{
    const size_t bytes = rays * sizeof(uint32_t);
    BB_TRY(bb_buffer_fill(&l->recording.ends, bytes, 0));
    BB_TRY(bb_pass_launch(&l->pass, rays));
    return bb_buffer_read(&l->recording.counts, 0, bytes, counts);
}

/* Counts the steps of each run, piece by piece. */
static bb_status count_runs(launch *l, const bb_ray *rays, uint32_t count, uint32_t *counts,
                            bb_sample_run *runs)
{
    for (uint32_t first = 0; first < count; first += PIECE) {
        const uint32_t piece = bb_min_u32(count - first, PIECE);
        BB_TRY(bb_buffer_write(&l->rays, 0, piece * sizeof *rays, rays + first));
        BB_TRY(count_steps(l, piece, counts));
        bb_sample_add(counts, first, piece, runs);
    }
    return BB_OK;
}

/* Copies the sample to the device: all rays, or some of the whole runs that the set consists of. */
static bb_status load_sample(launch *l, const bb_ray *rays, uint32_t count, uint32_t taken)
{
    if (taken == count)
        return bb_buffer_write(&l->rays, 0, taken * sizeof *rays, rays);
    const uint32_t wanted = taken / BB_STEPS_RUN;
    uint32_t *counts = NULL;
    bb_sample_run *runs = calloc((size_t)count / BB_STEPS_RUN + 1, sizeof *runs);
    bb_ray *sample = NULL;
    bb_status status = runs != NULL ? BB_OK : bb_fail(BB_REFUSED, "no memory for runs of rays");
    if (status == BB_OK)
        status = bb_host_alloc(NULL, PIECE * sizeof *counts, "counts of steps", &counts);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, taken * sizeof *sample, "sample of rays", &sample);
    if (status == BB_OK)
        status = count_runs(l, rays, count, counts, runs);
    if (status == BB_OK) {
        bb_sample_choose(runs, count / BB_STEPS_RUN, wanted);
        for (uint32_t i = 0; i < wanted; i++)
            memcpy(sample + (size_t)i * BB_STEPS_RUN, rays + (size_t)runs[i].number * BB_STEPS_RUN,
                   BB_STEPS_RUN * sizeof *rays);
        status = bb_buffer_write(&l->rays, 0, taken * sizeof *sample, sample);
    }
    bb_host_free(counts);
    bb_host_free(sample);
    free(runs);
    return status;
}

/* ---- recording ---- */

/* Turns counts into ends. */
static bb_status sum_up(uint32_t *counts, uint32_t rays, uint32_t *sum)
{
    uint64_t end = 0;
    for (uint32_t i = 0; i < rays; i++) {
        end += counts[i];
        if (end > BB_STEPS_MOST)
            return bb_fail(BB_REFUSED,
                           "more than %u steps of %u rays: there is no room to record them",
                           (unsigned)BB_STEPS_MOST, rays);
        counts[i] = (uint32_t)end;
    }
    *sum = (uint32_t)end;
    return BB_OK;
}

/* A first launch counts the steps of the rays on the device; the second writes them. */
static bb_status record(launch *l, bb_steps *steps)
{
    const size_t bytes = steps->rays * sizeof(uint32_t);
    uint32_t words = 0;
    BB_TRY(bb_host_alloc(NULL, bytes, "ends of steps", &steps->ends));
    BB_TRY(count_steps(l, steps->rays, steps->ends));
    BB_TRY(sum_up(steps->ends, steps->rays, &words));
    if (words > 0)
        BB_TRY(bb_buffer_reserve(l->device, NULL, words * sizeof(uint32_t), "steps",
                                 &l->recording.steps));
    BB_TRY(bb_buffer_write(&l->recording.ends, 0, bytes, steps->ends));
    BB_TRY(bb_pass_launch(&l->pass, steps->rays));
    BB_TRY(bb_host_alloc(NULL, words * sizeof(uint32_t), "steps", &steps->words));
    return bb_buffer_read(&l->recording.steps, 0, words * sizeof(uint32_t), steps->words);
}

bb_status bb_steps_record(bb_device *device, const bb_traverser_request *request,
                          const bb_layout_data *layout, const bb_ray *rays, uint32_t count,
                          uint32_t most, bb_steps *steps)
{
    bb_traverser_request recording = *request;
    recording.recording = true;
    launch l = {.device = device};
    *steps = (bb_steps){.rays = bb_min_u32(count, most)};
    bb_status status =
        prepare(&l, &recording, layout, bb_max_u32(steps->rays, bb_min_u32(count, PIECE)));
    if (status == BB_OK)
        status = load_sample(&l, rays, count, steps->rays);
    if (status == BB_OK)
        status = record(&l, steps);
    release(&l);
    if (status != BB_OK)
        bb_steps_release(steps);
    return status;
}

void bb_steps_release(bb_steps *steps)
{
    bb_host_free(steps->ends);
    bb_host_free(steps->words);
    *steps = (bb_steps){0};
}
