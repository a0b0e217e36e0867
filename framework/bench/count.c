#include "framework/bench/count.h"

#include "traversal/pass.h"

bb_status bb_counter_create(bb_device *device, bb_account *account, uint32_t most,
                            bb_counter *counter)
{
    counter->device = device;
    BB_TRY(bb_buffer_reserve(device, account, most * sizeof(bb_ray), "sample of rays",
                             &counter->rays));
    BB_TRY(bb_buffer_reserve(device, account, most * BB_RESULT_BYTES_MAX, "answers to a sample",
                             &counter->answers));
    return bb_buffer_reserve(device, account, most * sizeof(bb_count), "counts of tests",
                             &counter->counts);
}

void bb_counter_release(bb_counter *counter)
{
    bb_buffer_release(&counter->rays);
    bb_buffer_release(&counter->answers);
    bb_buffer_release(&counter->counts);
}

static bb_status load_sample(bb_counter *counter, const bb_rays *rays, uint32_t of, uint32_t count)
{
    bb_ray *sample = NULL;
    BB_TRY(bb_host_alloc(NULL, count * sizeof *sample, "sample of rays", &sample));
    for (uint32_t i = 0; i < count; i++)
        sample[i] = rays->rays[(uint64_t)i * of / count];
    bb_status status = bb_buffer_write(&counter->rays, 0, count * sizeof *sample, sample);
    bb_host_free(sample);
    return status;
}

static bb_status add_counts(bb_counter *counter, uint32_t count, bb_tests *tests)
{
    bb_count *counts = NULL;
    BB_TRY(bb_host_alloc(NULL, count * sizeof *counts, "counts of tests", &counts));
    bb_status status = bb_buffer_read(&counter->counts, 0, count * sizeof *counts, counts);
    for (uint32_t i = 0; i < count && status == BB_OK; i++) {
        tests->nodes += counts[i].nodes;
        tests->prims += counts[i].prims;
        tests->overflowed += counts[i].overflow;
    }
    bb_host_free(counts);
    return status;
}

bb_status bb_count_tests(bb_counter *counter, bb_traverser_request request,
                         const bb_layout_data *layout, const bb_rays *rays, uint32_t of,
                         uint32_t count, bb_tests *tests)
{
    bb_traverser *traverser;
    *tests = (bb_tests){0};
    request.counting = true;
    BB_TRY(bb_traverser_get(counter->device, &request, layout, &traverser));
    BB_TRY(load_sample(counter, rays, of, count));
    const bb_pass pass = {.query = rays->query,
                          .traverser = traverser,
                          .layout = layout,
                          .rays = &counter->rays,
                          .results = &counter->answers,
                          .counts = &counter->counts};
    BB_TRY(bb_pass_launch(&pass, count));
    return add_counts(counter, count, tests);
}
