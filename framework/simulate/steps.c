#include "framework/simulate/steps.h"

#include <string.h>

typedef struct recorder {
    bb_device *device;
    bb_recorded_launch launch;
    void *self;
    uint32_t count;
    uint32_t *all;  /* per item: its steps */
    uint32_t *ends; /* per item: where its steps end, of those that a launch records */
    bool *taken;    /* per item: it is of the sample */
    bb_recording recording;
} recorder;

/* Without room for steps a launch counts them. */
static bb_status count_steps(recorder *r)
{
    const size_t bytes = r->count * sizeof *r->all;
    BB_TRY(bb_buffer_reserve(r->device, NULL, bytes, "ends of steps", &r->recording.ends));
    BB_TRY(bb_buffer_reserve(r->device, NULL, bytes, "counts of steps", &r->recording.counts));
    BB_TRY(bb_buffer_reserve(r->device, NULL, sizeof *r->all, "steps", &r->recording.steps));
    BB_TRY(bb_host_alloc(NULL, bytes, "counts of steps", &r->all));
    BB_TRY(bb_buffer_fill(&r->recording.ends, bytes, 0));
    BB_TRY(r->launch(r->self, &r->recording));
    return bb_buffer_read(&r->recording.counts, 0, bytes, r->all);
}

/* Finds where the steps of each item of the sample end. */
static bb_status find_ends(const recorder *r, bb_steps *steps, uint32_t *words)
{
    uint32_t n = 0;
    *words = 0;
    BB_TRY(bb_host_alloc(NULL, steps->rays * sizeof *steps->ends, "ends of steps", &steps->ends));
    for (uint32_t i = 0; i < r->count; i++)
        if (r->taken[i])
            steps->ends[n++] = *words += r->all[i];
    return BB_OK;
}

/* Gives room to the items of the sample from `first` on, as far as `room` words go. Returns their
 * words, and in *next the first item that has none. */
static uint32_t give_room(recorder *r, uint32_t first, uint32_t room, uint32_t *next)
{
    uint32_t end = 0, i = first;
    memset(r->ends, 0, first * sizeof *r->ends);
    for (; i < r->count && (!r->taken[i] || r->all[i] <= room - end); i++)
        r->ends[i] = end += r->taken[i] ? r->all[i] : 0;
    *next = i;
    for (; i < r->count; i++)
        r->ends[i] = end;
    return end;
}

/* Where the device has no buffer of all steps, it takes as many launches as these need buffers. */
static bb_status record_steps(recorder *r, uint32_t words, bb_steps *steps)
{
    const uint64_t most = r->device->largest_allocation / sizeof *steps->words;
    const uint32_t room = most < words ? (uint32_t)most : words;
    uint32_t recorded = 0, next = 0;
    if (room > 0)
        BB_TRY(bb_buffer_reserve(r->device, NULL, room * sizeof *steps->words, "steps",
                                 &r->recording.steps));
    while (next < r->count) {
        const uint32_t first = next, part = give_room(r, first, room, &next);
        if (next == first)
            return bb_fail(BB_REFUSED, "the device has no room for the %u steps of one item",
                           r->all[first]);
        BB_TRY(bb_buffer_write(&r->recording.ends, 0, r->count * sizeof *r->ends, r->ends));
        BB_TRY(r->launch(r->self, &r->recording));
        BB_TRY(bb_buffer_read(&r->recording.steps, 0, part * sizeof *steps->words,
                              steps->words + recorded));
        recorded += part;
    }
    return BB_OK;
}

static bb_status record(recorder *r, bb_sample_size size, bb_steps *steps)
{
    uint32_t words;
    BB_TRY(count_steps(r));
    BB_TRY(bb_host_alloc(NULL, r->count * sizeof *r->taken, "a sample", &r->taken));
    BB_TRY(bb_host_alloc(NULL, r->count * sizeof *r->ends, "ends of steps", &r->ends));
    BB_TRY(bb_sample_take(r->all, r->count, size, BB_STEPS_MOST, r->taken, &steps->rays));
    BB_TRY(find_ends(r, steps, &words));
    BB_TRY(bb_host_alloc(NULL, words * sizeof *steps->words, "steps", &steps->words));
    return record_steps(r, words, steps);
}

bb_status bb_steps_record(bb_device *device, bb_recorded_launch launch, void *self, uint32_t count,
                          bb_sample_size size, bb_steps *steps)
{
    recorder r = {.device = device, .launch = launch, .self = self, .count = count};
    *steps = (bb_steps){.set_rays = count};
    bb_status status = record(&r, size, steps);
    bb_host_free(r.all);
    bb_host_free(r.ends);
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
