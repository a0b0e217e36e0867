#include "framework/simulate/steps.h"

typedef struct recorder {
    bb_device *device;
    bb_recorded_launch launch;
    void *self;
    uint32_t count;
    uint32_t *all; /* per item: its steps, then where they end */
    bool *taken;   /* per item: it is of the sample */
    bb_recording recording;
} recorder;

/* Without room for steps a launch counts them. */
static bb_status count_steps(recorder *r)
{
    const size_t bytes = r->count * sizeof *r->all;
    BB_TRY(bb_buffer_reserve(r->device, NULL, bytes, "ends of steps", &r->recording.ends));
    BB_TRY(bb_buffer_reserve(r->device, NULL, bytes, "counts of steps", &r->recording.counts));
    BB_TRY(bb_buffer_reserve(r->device, NULL, sizeof *r->all, "steps", &r->recording.steps));
    BB_TRY(bb_host_alloc(NULL, bytes, "ends of steps", &r->all));
    BB_TRY(bb_buffer_fill(&r->recording.ends, bytes, 0));
    BB_TRY(r->launch(r->self, &r->recording));
    return bb_buffer_read(&r->recording.counts, 0, bytes, r->all);
}

/* Gives room to the items of the sample alone, and turns counts into ends. */
static bb_status give_room(recorder *r, bb_steps *steps, uint32_t *words)
{
    uint32_t end = 0, n = 0;
    BB_TRY(bb_host_alloc(NULL, steps->rays * sizeof *steps->ends, "ends of steps", &steps->ends));
    for (uint32_t i = 0; i < r->count; i++) {
        end += r->taken[i] ? r->all[i] : 0;
        r->all[i] = end;
        if (r->taken[i])
            steps->ends[n++] = end;
    }
    *words = end;
    return BB_OK;
}

static bb_status record(recorder *r, bb_sample_size size, bb_steps *steps)
{
    uint32_t words = 0;
    BB_TRY(count_steps(r));
    BB_TRY(bb_host_alloc(NULL, r->count * sizeof *r->taken, "a sample", &r->taken));
    BB_TRY(bb_sample_take(r->all, r->count, size, BB_STEPS_MOST, r->taken, &steps->rays));
    BB_TRY(give_room(r, steps, &words));
    const size_t bytes = words * sizeof *steps->words;
    if (words > 0)
        BB_TRY(bb_buffer_reserve(r->device, NULL, bytes, "steps", &r->recording.steps));
    BB_TRY(bb_buffer_write(&r->recording.ends, 0, r->count * sizeof *r->all, r->all));
    BB_TRY(r->launch(r->self, &r->recording));
    BB_TRY(bb_host_alloc(NULL, bytes, "steps", &steps->words));
    return bb_buffer_read(&r->recording.steps, 0, bytes, steps->words);
}

bb_status bb_steps_record(bb_device *device, bb_recorded_launch launch, void *self, uint32_t count,
                          bb_sample_size size, bb_steps *steps)
{
    recorder r = {.device = device, .launch = launch, .self = self, .count = count};
    *steps = (bb_steps){.rays = 0};
    bb_status status = record(&r, size, steps);
    bb_host_free(r.all);
    bb_host_free(r.taken);
    bb_buffer_release(&r.recording.ends);
    bb_buffer_release(&r.recording.steps);
    bb_buffer_release(&r.recording.counts);
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
