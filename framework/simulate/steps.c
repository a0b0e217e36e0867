#include "framework/simulate/steps.h"

#include "framework/base/arithmetic.h"
#include "framework/base/random.h"
#include "traversal/pass.h"

#include <string.h>

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

/* Copies the sample to the device: all rays, or some of the runs that the set consists of, one at
 * random in each part of the set: evenly spaced ones would meet the same columns of a picture again
 * and again. */
static bb_status load_sample(launch *l, const bb_ray *rays, uint32_t count, uint32_t taken)
{
    if (taken == count)
        return bb_buffer_write(&l->rays, 0, taken * sizeof *rays, rays);
    const uint32_t runs = taken / BB_STEPS_RUN;
    bb_random random = bb_random_make(1, count);
    const uint32_t whole = count / BB_STEPS_RUN; /* runs that the set has */
    for (uint32_t i = 0; i < runs; i++) {
        const uint32_t part = (uint32_t)((uint64_t)i * whole / runs);
        const uint32_t end = (uint32_t)((uint64_t)(i + 1) * whole / runs);
        const uint64_t first =
            (uint64_t)(part + bb_random_below(&random, end - part)) * BB_STEPS_RUN;
        BB_TRY(bb_buffer_write(&l->rays, i * BB_STEPS_RUN * sizeof *rays,
                               BB_STEPS_RUN * sizeof *rays, rays + first));
    }
    return BB_OK;
}

static bb_status prepare(launch *l, const bb_traverser_request *request,
                         const bb_layout_data *layout, const bb_ray *rays, uint32_t count,
                         uint32_t taken)
{
    bb_traverser *traverser;
    BB_TRY(bb_traverser_get(l->device, request, layout, &traverser));
    BB_TRY(bb_buffer_reserve(l->device, NULL, taken * sizeof *rays, "sample of rays", &l->rays));
    BB_TRY(bb_buffer_reserve(l->device, NULL, taken * BB_RESULT_BYTES_MAX, "answers to a sample",
                             &l->results));
    BB_TRY(
        bb_buffer_reserve(l->device, NULL, taken * sizeof(bb_count), "counts of tests", &l->tests));
    const size_t bytes = taken * sizeof(uint32_t);
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
    return load_sample(l, rays, count, taken);
}

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

/* The first launch has no room for steps, and counts them; the second writes them. */
static bb_status record(launch *l, bb_steps *steps)
{
    const size_t bytes = steps->rays * sizeof(uint32_t);
    uint32_t words = 0;
    BB_TRY(bb_buffer_fill(&l->recording.ends, bytes, 0));
    BB_TRY(bb_pass_launch(&l->pass, steps->rays));
    BB_TRY(bb_host_alloc(NULL, bytes, "ends of steps", &steps->ends));
    BB_TRY(bb_buffer_read(&l->recording.counts, 0, bytes, steps->ends));
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
    bb_status status = prepare(&l, &recording, layout, rays, count, steps->rays);
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
