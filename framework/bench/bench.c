/* The comparison, scene by scene: load, oracle, builds, ray sets, traces. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"
#include "framework/base/random.h"
#include "framework/base/threads.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"
#include "framework/picture/picture.h"
#include "framework/workload/workload.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static double booked_ms(const bb_bench *bench)
{
    const bb_bench_times *times = &bench->outcome->times;
    return bench->steps_ms + times->build_ms + times->trace_ms;
}

bb_step bb_bench_begin(const bb_bench *bench)
{
    return (bb_step){bb_wall_ms(), booked_ms(bench)};
}

bb_status bb_bench_end(bb_bench *bench, bb_step step, const char *name, bb_status status)
{
    double ms = bb_wall_ms() - step.start - (booked_ms(bench) - step.booked);
    bench->steps_ms += ms;
    bb_status added = bb_results_add_step(bench->results, name, ms);
    return status != BB_OK ? status : added;
}

void bb_bench_shuffle(bb_bench *bench, uint32_t *order, uint32_t count)
{
    bb_random random = {bench->random};
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = (uint32_t)bb_random_below(&random, i + 1);
        order[i] = order[k];
        order[k] = i;
    }
    bench->random = bb_random_u64(&random);
}

/* ---- what was asked for ---- */

static bb_status parse_reference(const char *text, bb_spec *spec)
{
    BB_TRY(bb_spec_parse(text, spec));
    return bb_spec_validate(spec, bb_embree_options, "builder embree-native");
}

static bb_status parse_kernel(const char *text, bb_kernel_choice *choice)
{
    BB_TRY(bb_spec_parse(text, &choice->spec));
    choice->kernel = bb_kernel_find(choice->spec.name);
    if (choice->kernel == NULL)
        return bb_fail(BB_INVALID, "unknown kernel '%s': `bvhbench list kernels` shows them",
                       choice->spec.name);
    BB_TRY(bb_kernel_validate(choice->kernel, &choice->spec));
    uint64_t leaf, group;
    BB_TRY(bb_spec_u64(&choice->spec, bb_kernel_common_options, "leaf", 1, 64, &leaf));
    BB_TRY(bb_spec_u64(&choice->spec, bb_kernel_common_options, "group", 1, 65536, &group));
    choice->leaf = (uint32_t)leaf;
    return BB_OK;
}

static bb_status parse_workload(const char *text, bb_spec *spec, const bb_workload **workload)
{
    BB_TRY(bb_spec_parse(text, spec));
    *workload = bb_workload_find(spec->name);
    if (*workload == NULL)
        return bb_fail(BB_INVALID, "unknown rays '%s': `bvhbench list rays` shows them",
                       spec->name);
    char what[64];
    snprintf(what, sizeof what, "rays %s", spec->name);
    return bb_spec_validate(spec, (*workload)->options, what);
}

bb_status bb_bench_check(const bb_bench_request *request)
{
    bb_spec spec;
    const bb_workload *workload;
    bb_kernel_choice choice;
    if (request->builder_count > BB_ENTRANTS_MAX)
        return bb_fail(BB_INVALID, "at most %d builders at once", BB_ENTRANTS_MAX);
    if (request->kernel_count > BB_KERNELS_MAX)
        return bb_fail(BB_INVALID, "at most %d kernels at once", BB_KERNELS_MAX);
    for (uint32_t i = 0; i < request->builder_count; i++)
        BB_TRY(bb_is_reference(request->builders[i]) ? parse_reference(request->builders[i], &spec)
                                                     : bb_instance_check(request->builders[i]));
    for (uint32_t i = 0; i < request->kernel_count; i++)
        BB_TRY(parse_kernel(request->kernels[i], &choice));
    for (uint32_t i = 0; i < request->workload_count; i++)
        BB_TRY(parse_workload(request->workloads[i], &spec, &workload));
    bb_intersector intersector;
    for (uint32_t i = 0; i < request->intersector_count; i++)
        BB_TRY(bb_intersector_parse(request->intersectors[i], &intersector));
    for (uint32_t i = 0; i < request->metric_count; i++)
        if (bb_metric_find(request->metrics[i]) == BB_NONE)
            return bb_fail(BB_INVALID, "unknown metric '%s': `bvhbench list metrics` shows them",
                           request->metrics[i]);
    return BB_OK;
}

/* ---- the steps of a scene ---- */

/* The boxes are every builder's input, and no builder's work: what they cost is told apart. */
static bb_status measure_boxes(bb_bench *bench, bb_samples *ms)
{
    char what[256];
    bb_step step = bb_bench_begin(bench);
    snprintf(what, sizeof what, "boxes of %.200s", bench->scene->name);
    for (int i = 0; i <= 5; i++) { /* the first is left out of the median */
        bb_stopwatch watch;
        bb_timing timing;
        BB_TRY(bb_stopwatch_start(bench->device, &watch));
        bb_status status = bb_scene_make_boxes(bench->scene);
        bb_status stopped = bb_stopwatch_stop(&watch, &timing);
        BB_TRY(status);
        BB_TRY(stopped);
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
    BB_TRY(bb_oracle_create(bench->scene, bb_host_threads(bench->device), &bench->oracle));
    BB_TRY(bb_bench_end(bench, step, "oracle: build", BB_OK));
    memset(&bench->boxes_ms, 0, sizeof bench->boxes_ms);
    BB_TRY(measure_boxes(bench, &bench->boxes_ms));
    if (bench->scene->out_of_range > 0)
        bb_progress_note(bench->progress,
                         "%s: %u of %u primitives are too small beside the scene for floats: they "
                         "may be missed",
                         name, bench->scene->out_of_range, bench->scene->prim_count);
    return bb_results_add_scene(bench->results, bench->scene, &bench->boxes_ms);
}

/* What its record says of a builder: its parameters, or those of all its stages. */
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
    entrant->reference = bb_is_reference(text);
    bb_build_record *record = &entrant->record;
    bb_build_record_init(record);
    record->id = bench->next_id++;
    record->reference = entrant->reference;
    snprintf(record->scene, sizeof record->scene, "%s", bench->scene->name);
    bb_cell cell = bb_bench_cell(bench);
    snprintf(cell.builder, sizeof cell.builder, "%s", text);
    bb_bench_key(&cell, record->cell);
    record->spec = &entrant->spec;
    if (entrant->reference) {
        bb_spec_parse(text, &entrant->spec); /* checked by bb_bench_check() */
        record->options = bb_embree_options;
    } else {
        start_pipeline(entrant, text);
    }
}

static bb_status start_entrants(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bench->entrants = calloc(request->builder_count, sizeof *bench->entrants);
    if (bench->entrants == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bench->entrant_count = 0;
    for (uint32_t i = 0; i < request->builder_count; i++) {
        bb_cell parts = bb_bench_cell(bench);
        snprintf(parts.builder, sizeof parts.builder, "%s", request->builders[i]);
        if (bb_bench_wants(bench, &parts))
            start_entrant(bench, &bench->entrants[bench->entrant_count++], request->builders[i]);
    }
    return BB_OK;
}

static bb_status record_builds(bb_bench *bench)
{
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *entrant = &bench->entrants[i];
        if (entrant->record.status == BB_OK && entrant->record.build_ms.count == 0)
            continue; /* its turn had not come when the run was interrupted */
        if (strcmp(bb_status_word(entrant->record.status), "failed") == 0 && !entrant->reference)
            bench->outcome->wrong++;
        for (uint32_t b = 0; b < bench->request->builder_count; b++)
            if (entrant->text == bench->request->builders[b] && entrant->record.status == BB_OK)
                bench->built[b] = true;
        BB_TRY(bb_results_add_build(bench->results, &entrant->record));
    }
    return BB_OK;
}

/* At most: of all kernels, where a tree has no need of some. */
uint32_t bb_bench_cells_of_set(const bb_bench *bench)
{
    uint32_t cells = 0;
    for (uint32_t i = 0; i < bench->request->builder_count; i++)
        cells += bb_is_reference(bench->request->builders[i])
                     ? 1
                     : bench->kernel_count * bench->request->intersector_count;
    return cells;
}

/* Ray sets of a scene with so many views. */
static uint32_t sets_of(const bb_bench *bench, uint32_t views)
{
    const bb_bench_request *request = bench->request;
    uint32_t sets = 0;
    for (uint32_t w = 0; w < request->workload_count; w++) {
        bb_spec spec;
        const bb_workload *workload = NULL;
        if (parse_workload(request->workloads[w], &spec, &workload) != BB_OK)
            continue;
        bool few = request->max_views > 0 && request->max_views < views;
        sets += !workload->per_view ? 1 : few ? request->max_views : views;
    }
    return sets;
}

static bb_status trace_rays(bb_bench *bench, const bb_spec *spec, const bb_view *view)
{
    const bb_bench_request *request = bench->request;
    bb_cell parts = bb_bench_cell(bench);
    snprintf(parts.rays, sizeof parts.rays, "%s", spec->text);
    snprintf(parts.view, sizeof parts.view, "%s", view != NULL ? view->name : "");
    if (!bb_bench_wants(bench, &parts))
        return BB_OK;
    bb_rays_request wanted = {
        spec, view, request->width, request->height, request->max_rays, request->seed};
    bb_rays *rays = NULL;
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_rays_make(bench->scene, bench->oracle, &wanted, &rays);
    status = bb_bench_end(bench, step, "make rays", status);
    if (status == BB_UNSUPPORTED) {
        bb_progress_note(bench->progress, "%s: %s skipped: %s", bench->scene->name, spec->text,
                         bb_message());
        return bb_results_add_skipped(bench->results, bench->scene->name, spec->text,
                                      view != NULL ? view->name : "", bb_message());
    }
    if (status == BB_OK)
        status = bb_bench_traces(bench, rays);
    bb_rays_free(rays);
    return status;
}

/* Parameters of rays that make no sense shall be found out before the builds, not after them. */
static bb_status try_workloads(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bb_step step = bb_bench_begin(bench);
    for (uint32_t w = 0; w < request->workload_count; w++) {
        bb_spec spec;
        const bb_workload *workload;
        bb_rays *rays = NULL;
        BB_TRY(parse_workload(request->workloads[w], &spec, &workload));
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
        BB_TRY(parse_workload(bench->request->workloads[w], &spec, &workload));
        if (!workload->per_view)
            BB_TRY(trace_rays(bench, &spec, NULL));
        uint32_t views = bench->scene->view_count, most = bench->request->max_views;
        views = most > 0 && most < views ? most : views;
        for (uint32_t v = 0; workload->per_view && v < views && !bb_interrupted(); v++)
            BB_TRY(trace_rays(bench, &spec, &bench->scene->views[v]));
    }
    return BB_OK;
}

/* One picture per view, of the surface normals that the oracle sees. */
static bb_status make_pictures(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    if (request->picture_folder == NULL || bb_interrupted())
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
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_resident_evict(&bench->entrants[i]);
        bb_embree_destroy(bench->entrants[i].embree);
    }
    free(bench->entrants);
    bench->entrants = NULL;
    bench->entrant_count = 0;
    bb_oracle_destroy(bench->oracle);
    bench->oracle = NULL;
    bb_scene_free(bench->scene);
    bench->scene = NULL;
    (void)bb_bench_end(bench, step, "free scenes", BB_OK);
}

/* Said before the work, which is then better put off. What is known is from the time of loading and
 * compiling. */
static void warn_of_bystanders(bb_bench *bench)
{
    const bb_bystanders *watch = &bench->bystanders;
    const double share = bb_bystanders_share(watch);
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const double shortest_ms = 200; /* that ticks of 10 ms tell anything of */
    if (bench->warned)
        return;
    bench->warned = true;
    if (bb_wall_ms() - watch->wall_ms > shortest_ms && share > 0.25 * (double)processors)
        bb_progress_note(bench->progress,
                         "WARNING: the machine is busy: other programs keep %.2g of %ld processors "
                         "at work, and times will be noisy",
                         share, processors);
}

static bb_status run_scene(bb_bench *bench, const char *name)
{
    bb_status status = load_scene(bench, name);
    if (status == BB_OK)
        status = try_workloads(bench);
    if (status == BB_OK)
        status = start_entrants(bench);
    if (status == BB_OK) {
        warn_of_bystanders(bench);
        status = bb_bench_builds(bench);
    }
    if (status == BB_OK)
        status = record_builds(bench);
    bench->judged = 0;
    if (status == BB_OK)
        status = trace_workloads(bench);
    bool traced = bench->request->workload_count > 0 && !bb_interrupted();
    if (status == BB_OK && traced && bench->judged == 0) {
        bench->outcome->unjudged++;
        bb_progress_note(bench->progress, "%s: no answer was judged", name);
    }
    if (status == BB_OK)
        status = make_pictures(bench);
    end_scene(bench);
    return status;
}

/* A scene that can't be loaded shall be found out before hours of work, and before minutes of
 * compiling. The first is kept. */
static bb_status try_scenes(bb_bench *bench)
{
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < bench->request->scene_count; i++) {
        bb_scene *scene = NULL;
        bb_progress_stage(bench->progress, 0, "%s: trying", bench->request->scenes[i]);
        BB_TRY(bb_scene_load(bench->request->scenes[i], &scene));
        bb_status status = bb_bench_check_views(bench, scene, bench->request->scenes[i]);
        bench->sets += sets_of(bench, scene->view_count);
        if (i == 0)
            bench->first = scene;
        else
            bb_scene_free(scene);
        BB_TRY(status);
    }
    return bb_bench_end(bench, step, "load and profile scenes", BB_OK);
}

/* The same for parameters of builders: what create() finds wrong is found out now. */
static bb_status try_builders(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    const bb_scene nothing = {.name = "nothing"};
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < request->builder_count; i++) {
        if (bb_is_reference(request->builders[i]))
            continue;
        bb_instance instance;
        bb_status status = bb_instance_create(bench->device, request->builders[i], &nothing,
                                              request->seed, &instance);
        bb_instance_destroy(&instance);
        if (status == BB_INVALID)
            return status;
    }
    return bb_bench_end(bench, step, "compile builders", BB_OK);
}

/* What every trace needs, taken before trees can fill the device. */
static bb_status start_buffers(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    if (request->workload_count == 0)
        return BB_OK;
    uint64_t most = (uint64_t)request->width * request->height;
    most = most > request->max_rays ? most : request->max_rays;
    bench->batch = most < BB_BATCH ? (uint32_t)most : BB_BATCH;
    BB_TRY(bb_buffer_reserve(bench->device, &bench->account, bench->batch * sizeof(bb_ray), "rays",
                             &bench->rays));
    /* the counting variant writes answers too */
    size_t results = bench->batch > BB_COUNTED_RAYS ? bench->batch : BB_COUNTED_RAYS;
    BB_TRY(bb_buffer_reserve(bench->device, &bench->account, results * BB_RESULT_BYTES_MAX,
                             "answers", &bench->answers));
    BB_TRY(bb_buffer_reserve(bench->device, &bench->account, BB_COUNTED_RAYS * sizeof(bb_ray),
                             "sample of rays", &bench->sample));
    return bb_buffer_reserve(bench->device, &bench->account, BB_COUNTED_RAYS * sizeof(bb_count),
                             "counts of tests", &bench->counts);
}

uint32_t bb_bench_layout_of(const bb_bench *bench, uint32_t kernel,
                            const bb_intersector *intersector)
{
    return bench->kernels[kernel].layouts[bb_intersector_format(intersector)];
}

bool bb_bench_takes(const bb_bench *bench, const bb_entrant *entrant, uint32_t kernel)
{
    if (!bench->kernels[kernel].native_only)
        return true;
    for (uint32_t k = 0; k < bench->kernel_count; k++)
        for (uint32_t i = 0; i < bench->request->intersector_count; i++)
            if (!bench->kernels[k].native_only &&
                entrant->keeps_shape[bb_bench_layout_of(bench, k, &bench->intersectors[i])])
                return false;
    return entrant->record.has_tree;
}

/* The layout that the kernel reads, with triangles in `form`: one that is there already, or a new
 * one. */
static bb_status start_layout(bb_bench *bench, bb_kernel_choice *choice, uint32_t format)
{
    const bb_layout *layout = bb_layout_find(choice->kernel->layout);
    for (uint32_t i = 0; i < bench->layout_count; i++) {
        const bb_layout_choice *l = &bench->layouts[i];
        if (l->maker.layout == layout && l->format == format && l->leaf == choice->leaf) {
            choice->layouts[format] = i;
            return BB_OK;
        }
    }
    choice->layouts[format] = bench->layout_count++;
    bb_layout_choice *wanted = &bench->layouts[choice->layouts[format]];
    wanted->leaf = choice->leaf;
    wanted->format = format;
    return bb_layout_maker_create(layout, bench->device, &wanted->maker);
}

static bb_status start_kernel(bb_bench *bench, const char *text, bool native_only)
{
    bb_kernel_choice *choice = &bench->kernels[bench->kernel_count];
    uint64_t group;
    BB_TRY(parse_kernel(text, choice));
    BB_TRY(bb_spec_u64(&choice->spec, bb_kernel_common_options, "group", 1,
                       bench->device->max_group_size, &group));
    choice->native_only = native_only;
    bench->kernel_count++;
    for (uint32_t i = 0; i < bench->request->intersector_count; i++)
        BB_TRY(start_layout(bench, choice, bb_intersector_format(&bench->intersectors[i])));
    return BB_OK;
}

static bb_status start_kernels(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    for (uint32_t i = 0; i < request->kernel_count; i++)
        BB_TRY(start_kernel(bench, request->kernels[i], false));
    for (const bb_kernel *const *k = bb_kernels; request->native && *k != NULL; k++)
        if ((*k)->native && (*k)->compared == NULL && bench->kernel_count < BB_KERNELS_MAX)
            BB_TRY(start_kernel(bench, (*k)->name, true));
    return BB_OK;
}

static bb_status start_intersectors(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bench->intersectors = calloc(request->intersector_count, sizeof *bench->intersectors);
    if (bench->intersectors == NULL && request->intersector_count > 0)
        return bb_fail(BB_FAILED, "out of memory");
    for (uint32_t i = 0; i < request->intersector_count; i++)
        BB_TRY(bb_intersector_parse(request->intersectors[i], &bench->intersectors[i]));
    return BB_OK;
}

static void end_layouts(bb_bench *bench)
{
    for (uint32_t i = 0; i < bench->layout_count; i++)
        bb_layout_maker_destroy(&bench->layouts[i].maker);
}

void bb_bench_outcome_add(bb_bench_outcome *sum, const bb_bench_outcome *more)
{
    sum->wrong += more->wrong;
    sum->unjudged += more->unjudged;
    sum->unbuilt += more->unbuilt;
    sum->times.build_ms += more->times.build_ms;
    sum->times.trace_ms += more->times.trace_ms;
    sum->times.total_ms += more->times.total_ms;
    bb_audit_add(&sum->audit, &more->audit);
}

bb_status bb_bench_run(const bb_bench_request *request, bb_results *results,
                       bb_bench_outcome *outcome)
{
    memset(outcome, 0, sizeof *outcome);
    BB_TRY(bb_bench_check(request));
    bb_progress progress;
    bb_progress_start(&progress, request->quiet);
    bb_bench *bench = calloc(1, sizeof *bench);
    if (bench == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bench->request = request;
    bench->device = request->device;
    bench->results = results;
    bench->outcome = outcome;
    bench->next_id = bb_results_next_build(results);
    bench->random = request->seed;
    bench->progress = &progress;
    bench->start = bb_wall_ms();
    bb_bystanders_start(&bench->bystanders);
    bb_status status = try_scenes(bench);
    if (status == BB_OK)
        status = try_builders(bench);
    bb_step step = bb_bench_begin(bench);
    if (status == BB_OK)
        status = start_buffers(bench);
    if (status == BB_OK)
        status = start_intersectors(bench);
    if (status == BB_OK)
        status = start_kernels(bench);
    status = bb_bench_end(bench, step, "compile kernels", status);
    bench->built = calloc(request->builder_count + 1, sizeof *bench->built);
    if (bench->built == NULL)
        status = bb_fail(BB_FAILED, "out of memory");
    const uint32_t rounds = request->repeats + 1;
    bb_progress_plan(&progress, (double)rounds * (request->scene_count * request->builder_count +
                                                  bench->sets * bb_bench_cells_of_set(bench)));
    for (uint32_t i = 0; i < request->scene_count && status == BB_OK && !bb_interrupted(); i++)
        status = run_scene(bench, request->scenes[i]);
    for (uint32_t i = 0; i < request->builder_count && status == BB_OK && !bb_interrupted(); i++)
        outcome->unbuilt += !bench->built[i];
    free(bench->built);
    bb_scene_free(bench->first);
    bb_progress_end(&progress);
    bb_buffer_release(&bench->rays);
    bb_buffer_release(&bench->answers);
    bb_buffer_release(&bench->counts);
    bb_buffer_release(&bench->sample);
    end_layouts(bench);
    free(bench->intersectors);
    bb_tracers_clear(bench->device);
    outcome->times.total_ms = bb_wall_ms() - bench->start;
    free(bench);
    return status;
}
