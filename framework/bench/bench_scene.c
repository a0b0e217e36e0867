/* One scene of the comparison: loading, oracle, builds, ray sets, traces, pictures. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"
#include "framework/picture/picture.h"
#include "framework/workload/workload.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Measures the making of the primitives' boxes. They are the input of all builders and no builder's
 * work. */
static bb_status measure_boxes(bb_bench *bench, bb_samples *ms)
{
    char what[256];
    bb_step step = bb_bench_begin(bench);
    snprintf(what, sizeof what, "boxes of %.200s", bench->scene->name);
    for (int i = 0; i <= 5; i++) { /* the first time does not enter the median */
        bb_stopwatch watch;
        bb_timing timing;
        BB_TRY(bb_stopwatch_start(bench->device, &watch));
        BB_TRY(bb_stopwatch_stop(&watch, bb_scene_make_boxes(bench->scene), &timing));
        bb_audit_timing(&bench->outcome->audit, what, &timing, true);
        bb_samples_add(ms, timing.ms);
    }
    return bb_bench_end(bench, step, "make boxes", BB_OK);
}

static bb_status load_scene(bb_bench *bench, const char *name)
{
    bench->scene_text = name;
    bb_progress_stage(bench->progress, 0, "%s: loading", name);
    bb_step step = bb_bench_begin(bench);
    bench->scene = bench->first;
    bench->first = NULL;
    if (bench->scene == NULL)
        BB_TRY(bb_scene_load(name, &bench->scene));
    BB_TRY(bb_bench_end(bench, step, "load and profile scenes", BB_OK));
    step = bb_bench_begin(bench);
    BB_TRY(bb_scene_upload(bench->scene, bench->device));
    BB_TRY(bb_bench_end(bench, step, "upload scenes", BB_OK));
    step = bb_bench_begin(bench);
    bench->oracle = bench->request->oracle;
    if (bench->oracle == NULL)
        BB_TRY(bb_oracle_create(bench->scene, bb_host_threads(bench->device), &bench->oracle));
    BB_TRY(bb_bench_end(bench, step, "oracle: build", BB_OK));
    step = bb_bench_begin(bench);
    if (bench->request->workload_count > 0) /* before trees can fill the memory */
        BB_TRY(bb_oracle_prepare(bench->oracle));
    BB_TRY(bb_bench_end(bench, step, "oracle: prepare", BB_OK));
    memset(&bench->boxes_ms, 0, sizeof bench->boxes_ms);
    BB_TRY(measure_boxes(bench, &bench->boxes_ms));
    if (bench->scene->out_of_range > 0)
        bb_progress_note(bench->progress,
                         "%s: %u of %u primitives are too small beside the scene for floats: they "
                         "may be missed",
                         name, bench->scene->out_of_range, bench->scene->prim_count);
    return bb_results_add_scene(bench->results, bench->scene, &bench->boxes_ms);
}

/* Puts the parameters of a builder, or of all its stages, into its record. */
static void start_pipeline(bb_entrant *entrant, const char *text)
{
    bb_build_record *record = &entrant->record;
    const bb_pipeline *pipeline = &entrant->pipeline;
    bb_pipeline_parse(text, &entrant->pipeline); /* checked by bb_bench_check() */
    if (pipeline->count == 1) {
        bb_spec_parse(pipeline->stages[0].spec.text, &entrant->spec);
        record->options = pipeline->stages[0].builder->options;
        return;
    }
    snprintf(entrant->spec.text, sizeof entrant->spec.text, "%s", text);
    record->stage_count = pipeline->count;
    for (uint32_t i = 0; i < pipeline->count; i++) {
        record->stages[i].label = pipeline->stages[i].label;
        record->stages[i].spec = &pipeline->stages[i].spec;
        record->stages[i].options = pipeline->stages[i].builder->options;
    }
}

static void start_entrant(bb_bench *bench, bb_entrant *entrant, const char *text)
{
    entrant->text = text;
    entrant->resident = &bench->residency.items[bench->residency.count++];
    *entrant->resident = (bb_resident){.text = text, .scene = bench->scene};
    entrant->tracer = bb_tracer_of(text);
    bb_build_record *record = &entrant->record;
    bb_build_record_init(record);
    record->reference = entrant->tracer != NULL;
    snprintf(record->scene, sizeof record->scene, "%s", bench->scene->name);
    bb_cell_parts cell = bb_bench_cell(bench);
    snprintf(cell.builder, sizeof cell.builder, "%s", text);
    bb_bench_key(&cell, record->cell);
    record->spec = &entrant->spec;
    if (entrant->tracer != NULL) {
        bb_spec_parse(text, &entrant->spec); /* checked by bb_bench_check() */
        record->options = entrant->tracer->options;
        for (bb_entrant *e = bench->entrants; e < entrant && entrant->tree_of == NULL; e++)
            if (bb_tracer_same_tree(e->tracer, &e->spec, entrant->tracer, &entrant->spec))
                entrant->tree_of = e;
    } else {
        start_pipeline(entrant, text);
    }
}

static bb_status start_entrants(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bench->entrants = calloc(request->builder_count, sizeof *bench->entrants);
    bench->residency.items = calloc(request->builder_count, sizeof *bench->residency.items);
    if (bench->entrants == NULL || bench->residency.items == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bench->entrant_count = 0;
    for (uint32_t i = 0; i < request->builder_count; i++) {
        bb_cell_parts parts = bb_bench_cell(bench);
        snprintf(parts.builder, sizeof parts.builder, "%s", request->builders[i]);
        if (bb_bench_wants(bench, &parts))
            start_entrant(bench, &bench->entrants[bench->entrant_count++], request->builders[i]);
    }
    return BB_OK;
}

static bool built_any(const bb_bench *bench)
{
    bool any = false;
    for (uint32_t i = 0; i < bench->entrant_count; i++)
        any = any || bench->entrants[i].record.status == BB_OK;
    return any;
}

/* Returns whether a row has what was asked of it, or lacks it for no fault of its own: a library
 * without packets, a tracer without room beside builders. */
static bool is_excused(const bb_entrant *entrant, bool others)
{
    const bb_status status = entrant->record.status;
    return status == BB_OK || (entrant->tracer != NULL &&
                               (status == BB_UNSUPPORTED || (status == BB_REFUSED && others)));
}

static bb_status record_builds(bb_bench *bench)
{
    const bool others = built_any(bench);
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *entrant = &bench->entrants[i];
        bool measured = entrant->record.build_ms.count > 0 || entrant->record.unmeasured;
        if (entrant->record.status == BB_OK && !measured)
            continue; /* the run was interrupted before its turn */
        if (strcmp(bb_status_word(entrant->record.status), "failed") == 0)
            bench->outcome->wrong++;
        for (uint32_t b = 0; b < bench->request->builder_count; b++)
            if (entrant->text == bench->request->builders[b] && is_excused(entrant, others))
                bench->built[b] = true;
        BB_TRY(bb_results_add_build(bench->results, &entrant->record));
    }
    return BB_OK;
}

/* Leaves a set of rays out, with the reason that was given. */
static bb_status skip_rays(bb_bench *bench, const bb_spec *spec, const bb_view *view)
{
    bb_progress_note(bench->progress, "%s: %s skipped: %s", bench->scene->name, spec->text,
                     bb_message());
    return bb_results_add_skipped(bench->results, bench->scene->name, spec->text,
                                  view != NULL ? view->name : "", bb_message());
}

static bb_status make_and_trace(bb_bench *bench, const bb_spec *spec, const bb_view *view)
{
    const bb_bench_request *request = bench->request;
    bb_rays_request wanted = {
        spec, view, request->width, request->height, request->max_rays, request->seed};
    bb_rays *rays = NULL;
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_rays_make(bench->scene, bench->oracle, &wanted, &rays);
    status = bb_bench_end(bench, step, "make rays", status);
    if (status == BB_UNSUPPORTED)
        return skip_rays(bench, spec, view);
    if (status == BB_OK)
        status = bb_bench_traces(bench, rays);
    if (status == BB_OK)
        status = bb_device_check(bench->device); /* else all further rows would fail one by one */
    bb_rays_free(rays);
    return status;
}

static bb_status trace_rays(bb_bench *bench, const bb_spec *spec, const bb_view *view)
{
    bb_cell_parts parts = bb_bench_cell(bench);
    snprintf(parts.rays, sizeof parts.rays, "%s", spec->text);
    snprintf(parts.view, sizeof parts.view, "%s", view != NULL ? view->name : "");
    if (!bb_bench_wants(bench, &parts) || !bb_bench_owns(bench, bench->set++))
        return BB_OK;
    bench->traced_sets++;
    bb_host_unbook(bench->kept_for_rays);
    bb_status status = bb_bench_ready_oracle(bench, bench->kept_for_rays);
    status = status == BB_REFUSED ? skip_rays(bench, spec, view)
             : status == BB_OK    ? make_and_trace(bench, spec, view)
                                  : status;
    bb_host_book(bench->kept_for_rays);
    return status;
}

/* Tries all workloads, so that wrong parameters are found before the builds. */
static bb_status try_workloads(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bb_step step = bb_bench_begin(bench);
    for (uint32_t w = 0; w < request->workload_count; w++) {
        bb_spec spec;
        const bb_workload *workload;
        bb_rays *rays = NULL;
        BB_TRY(bb_workload_parse(request->workloads[w], &spec, &workload));
        bb_rays_request wanted = {
            &spec, workload->per_view ? &bench->scene->views[0] : NULL, 8,
            8,     request->max_rays < 1024 ? request->max_rays : 1024, request->seed};
        bb_status status = bb_rays_make(bench->scene, bench->oracle, &wanted, &rays);
        bb_rays_free(rays);
        if (status == BB_INVALID)
            return status;
    }
    return bb_bench_end(bench, step, "make rays", BB_OK);
}

static bb_status trace_workloads(bb_bench *bench)
{
    for (uint32_t w = 0; w < bench->request->workload_count && !bb_interrupted(); w++) {
        bb_spec spec;
        const bb_workload *workload;
        BB_TRY(bb_workload_parse(bench->request->workloads[w], &spec, &workload));
        if (!workload->per_view)
            BB_TRY(trace_rays(bench, &spec, NULL));
        uint32_t views = bench->scene->view_count, most = bench->request->max_views;
        views = most > 0 && most < views ? most : views;
        for (uint32_t v = 0; workload->per_view && v < views && !bb_interrupted(); v++)
            BB_TRY(trace_rays(bench, &spec, &bench->scene->views[v]));
    }
    return BB_OK;
}

/* Makes one picture per view, of the surface normals that the oracle sees. */
static bb_status make_pictures(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    if (request->picture_folder == NULL || bb_interrupted() || !bb_bench_owns_builds(bench))
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    for (uint32_t v = 0; v < bench->scene->view_count; v++) {
        const bb_view *view = &bench->scene->views[v];
        bb_status status =
            bb_picture_of_view(bench->scene, bench->oracle, view, request->width, request->height,
                               request->picture_folder, bench->results);
        if (status == BB_OK)
            continue;
        /* no picture is worth losing the measurements */
        bb_progress_note(bench->progress, "%s: no picture of %s: %s", bench->scene->name,
                         view->name, bb_message());
        BB_TRY(bb_results_add_skipped(bench->results, bench->scene->name, "picture", view->name,
                                      bb_message()));
    }
    return bb_bench_end(bench, step, "pictures", BB_OK);
}

static void end_scene(bb_bench *bench)
{
    bench->outcome->bytes_held = bench->residency.bytes_held;
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_resident_evict(bench->entrants[i].resident);
        if (bench->entrants[i].tree_of == NULL)
            bb_tracing_destroy(bench->entrants[i].tracing);
    }
    free(bench->residency.items);
    bench->residency.items = NULL;
    bench->residency.count = 0;
    free(bench->entrants);
    bench->entrants = NULL;
    bench->entrant_count = 0;
    bb_disguise_end(&bench->disguise);
    if (bench->oracle != bench->request->oracle)
        bb_oracle_destroy(bench->oracle);
    bench->oracle = NULL;
    if (bench->scene != bench->request->scene)
        bb_scene_free(bench->scene);
    bench->scene = NULL;
    (void)bb_bench_end(bench, step, "free scenes", BB_OK);
}

static bb_status run_scene(bb_bench *bench, const char *name)
{
    BB_TRY(load_scene(bench, name));
    BB_TRY(try_workloads(bench));
    BB_TRY(start_entrants(bench));
    bb_warn_of_bystanders(&bench->bystanders, bench->device, bench->progress);
    BB_TRY(bb_bench_builds(bench));
    BB_TRY(record_builds(bench));
    BB_TRY(bb_device_check(bench->device));
    bench->judged = bench->traced_sets = 0;
    BB_TRY(trace_workloads(bench));
    bool own_sets = bench->request->shard == NULL || bench->traced_sets > 0;
    bool traced = bench->request->workload_count > 0 && own_sets && !bb_interrupted();
    if (traced && bench->judged == 0) {
        bench->outcome->unjudged++;
        bb_progress_note(bench->progress, "%s: no answer was judged", name);
    }
    return make_pictures(bench);
}

bb_status bb_bench_scene(bb_bench *bench, const char *name)
{
    bb_status status = run_scene(bench, name);
    end_scene(bench);
    return status;
}
