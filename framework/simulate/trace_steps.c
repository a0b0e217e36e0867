#include "framework/simulate/trace_steps.h"

#include "traversal/pass.h"

/* What a launch needs, on the device. */
typedef struct tracing {
    bb_pass pass;
    bb_buffer rays, results, tests;
    uint32_t count;
} tracing;

static void release(tracing *t)
{
    bb_buffer_release(&t->rays);
    bb_buffer_release(&t->results);
    bb_buffer_release(&t->tests);
}

static bb_status prepare(tracing *t, bb_device *device, const bb_traverser_request *request,
                         const bb_layout_data *layout, const bb_ray *rays)
{
    bb_traverser *traverser;
    const size_t count = t->count;
    BB_TRY(bb_traverser_get(device, request, layout, &traverser));
    BB_TRY(bb_buffer_reserve(device, NULL, count * sizeof *rays, "rays to record", &t->rays));
    BB_TRY(bb_buffer_reserve(device, NULL, count * request->query->result_bytes,
                             "answers to recorded rays", &t->results));
    BB_TRY(bb_buffer_reserve(device, NULL, count * sizeof(bb_count), "counts of tests", &t->tests));
    t->pass = (bb_pass){.query = request->query,
                        .traverser = traverser,
                        .layout = layout,
                        .rays = &t->rays,
                        .results = &t->results,
                        .counts = &t->tests};
    return bb_buffer_write(&t->rays, 0, count * sizeof *rays, rays);
}

static bb_status launch(void *self, const bb_recording *recording)
{
    tracing *t = self;
    t->pass.recording = recording;
    return bb_pass_launch(&t->pass, t->count);
}

bb_status bb_trace_steps(bb_device *device, const bb_traverser_request *request,
                         const bb_layout_data *layout, const bb_ray *rays, uint32_t count,
                         bb_sample_size size, bb_steps *steps)
{
    bb_traverser_request recording = *request;
    recording.recording = true;
    tracing t = {.count = count};
    *steps = (bb_steps){.rays = 0};
    bb_status status = prepare(&t, device, &recording, layout, rays);
    if (status == BB_OK)
        status = bb_steps_record(device, launch, &t, count, size, steps);
    release(&t);
    return status;
}
