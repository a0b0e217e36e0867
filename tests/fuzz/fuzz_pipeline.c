/* What names a builder of several stages; kernels, intersectors and rays are named likewise. */
#include "framework/bench/bench_private.h"
#include "framework/builder/pipeline.h"
#include "framework/builder/registry.h"
#include "framework/workload/workload.h"
#include "tests/fuzz/fuzz.h"
#include "traversal/traversal.h"

static void check_status(bb_status status)
{
    if (status != BB_OK)
        fuzz_refused(status);
}

static void check_pipeline(const char *text)
{
    static bb_pipeline pipeline, again;
    char whole[sizeof pipeline.text];
    bool completed = false;
    bb_status status = bb_pipeline_parse(text, &pipeline);
    check_status(status);
    if (status == BB_OK) {
        FUZZ_CHECK(strcmp(pipeline.text, text) == 0);
        FUZZ_CHECK(pipeline.count > 0 && pipeline.count <= BB_STAGES_MAX);
        FUZZ_CHECK(bb_pipeline_on_device(&pipeline) <= pipeline.count);
        for (uint32_t i = 0; i < pipeline.count; i++)
            FUZZ_CHECK(pipeline.stages[i].builder != NULL && pipeline.stages[i].label[0] != '\0');
    }
    bb_status made = bb_pipeline_complete(text, whole, sizeof whole, &completed);
    check_status(made);
    if (made == BB_OK) {
        FUZZ_CHECK(completed == (strcmp(whole, text) != 0));
        FUZZ_CHECK(!completed || bb_pipeline_parse(whole, &again) == BB_OK);
    }
    FUZZ_CHECK(status != BB_OK || (made == BB_OK && !completed));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static bb_kernel_choice kernel;
    char *text = fuzz_text(data, size);
    bb_intersector intersector;
    bb_spec spec;
    const bb_tracer *tracer;
    check_pipeline(text);
    check_status(bb_bench_parse_kernel(text, &kernel));
    check_status(bb_intersector_parse(text, &intersector));
    check_status(bb_workload_check(text, 1000));
    check_status(bb_tracer_parse(text, &tracer, &spec));
    free(text);
    return 0;
}
