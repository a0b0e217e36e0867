/* The comparison: tries and compiles all that was requested, then runs it scene by scene. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"
#include "framework/base/random.h"
#include "framework/base/threads.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"
#include "framework/device/launch_cost.h"
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
    const double end = bb_wall_ms(), ms = end - step.start - (booked_ms(bench) - step.booked);
    bb_status added = bb_results_add_step(bench->results, name, ms + bench->booking_ms);
    bench->booking_ms = bb_wall_ms() - end;
    bench->steps_ms += ms + bench->booking_ms;
    return status != BB_OK ? status : added;
}

void bb_bench_show_progress(bb_bench *bench)
{
    bb_step step = bb_bench_begin(bench);
    bb_progress_step(bench->progress);
    (void)bb_bench_end(bench, step, "keep records", BB_OK);
}

bb_status bb_bench_tree(bb_bench *bench, bb_entrant *entrant)
{
    if (entrant->resident->built)
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_resident_tree(&bench->residency, entrant->resident);
    if (status == BB_OK)
        entrant->record.cold_ms = entrant->resident->cold_ms;
    return bb_bench_end(bench, step, "compile, allocate, first builds", status);
}

bb_status bb_bench_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    if (entrant->resident->has_layout[layout])
        return BB_OK;
    BB_TRY(bb_bench_tree(bench, entrant));
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_resident_layout(&bench->residency, entrant->resident, layout);
    if (bench->traces)
        (void)bb_resident_free_tree(entrant->resident);
    return bb_bench_end(bench, step, "layouts", status);
}

/* Loads each scene once, so that a scene that cannot be loaded is found before hours of work. The
 * first scene is kept. */
static bb_status try_scenes(bb_bench *bench)
{
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < bench->request->scene_count; i++) {
        bb_scene *scene = bench->request->scene;
        bb_progress_stage(bench->progress, 0, "%s: trying", bench->request->scenes[i]);
        if (scene == NULL)
            BB_TRY(bb_scene_load(bench->request->scenes[i], &scene));
        bb_status status = bb_bench_check_views(bench, scene, bench->request->scenes[i]);
        if (status == BB_OK) { /* else its message would be lost */
            bench->parts[i] = bb_bench_part_of(bench, scene, bench->request->scenes[i]);
            bench->sets += bench->request->workload_count > 0 ? bench->parts[i].own : 0;
        }
        if (i == 0)
            bench->first = scene;
        else
            bb_scene_free(scene);
        BB_TRY(status);
    }
    return bb_bench_end(bench, step, "load and profile scenes", BB_OK);
}

/* Creates each builder once, so that wrong parameters are found before the work. */
static bb_status try_builders(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bb_step step = bb_bench_begin(bench);
    for (uint32_t i = 0; i < request->builder_count; i++) {
        if (bb_tracer_of(request->builders[i]) == NULL)
            BB_TRY(bb_instance_try(bench->device, request->builders[i], request->seed));
    }
    return bb_bench_end(bench, step, "compile builders", BB_OK);
}

uint64_t bb_bench_most_rays(const bb_bench_request *request)
{
    uint64_t most = 0, rays;
    for (uint32_t w = 0; w < request->workload_count; w++)
        if (bb_workload_most(request->workloads[w], request->width, request->height,
                             request->max_rays, &rays) == BB_OK && /* else it was refused */
            rays > most)
            most = rays;
    return most;
}

/* Allocates the buffers of traces before trees can fill the device. */
static bb_status start_buffers(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    if (request->workload_count == 0)
        return BB_OK;
    const uint64_t most = bb_bench_most_rays(request);
    bench->batch = most < BB_BATCH ? (uint32_t)most : BB_BATCH;
    bench->kept_for_rays = (uint64_t)bench->batch * BB_BYTES_PER_RAY;
    bb_host_book(bench->kept_for_rays);
    BB_TRY(bb_buffer_reserve(bench->device, &bench->account, bench->batch * sizeof(bb_ray), "rays",
                             &bench->rays));
    BB_TRY(bb_buffer_reserve(bench->device, &bench->account,
                             (size_t)bench->batch * BB_RESULT_BYTES_MAX, "answers",
                             &bench->answers));
    return bb_counter_create(bench->device, &bench->account, BB_COUNTED_RAYS, &bench->counter);
}

uint32_t bb_bench_layout_of(const bb_bench *bench, uint32_t kernel,
                            const bb_intersector *intersector)
{
    return bench->kernels[kernel].layouts[bb_intersector_format(intersector)];
}

bool bb_bench_simulates(const bb_bench *bench, uint32_t kernel, const bb_intersector *intersector,
                        uint32_t *layout)
{
    const bb_kernel_choice *choice = &bench->kernels[kernel];
    *layout = choice->simulated[bb_intersector_format(intersector)];
    return bench->simt_count > 0 && choice->kernel->control != BB_CONTROL_UNKNOWN;
}

bool bb_bench_takes(const bb_bench *bench, const bb_entrant *entrant, uint32_t kernel)
{
    if (!bench->kernels[kernel].native_only)
        return true;
    for (uint32_t k = 0; k < bench->kernel_count; k++)
        for (uint32_t i = 0; i < bench->request->intersector_count; i++)
            if (!bench->kernels[k].native_only &&
                entrant->resident
                    ->keeps_shape[bb_bench_layout_of(bench, k, &bench->intersectors[i])])
                return false;
    return entrant->record.has_tree;
}

static bb_status start_kernel(bb_bench *bench, const char *text, bool native_only)
{
    bb_kernel_choice *choice = &bench->kernels[bench->kernel_count];
    uint64_t group;
    BB_TRY(bb_bench_parse_kernel(text, choice));
    BB_TRY(bb_kernel_group_of(choice->kernel, &choice->spec, bench->device, &group));
    choice->native_only = native_only;
    bench->kernel_count++;
    const bb_layout *layout = bb_layout_find(choice->kernel->layout);
    const bb_layout_wish wish = bb_kernel_wish(&choice->spec);
    bb_layout_wish ordered = wish;
    ordered.preorder = true;
    for (uint32_t i = 0; i < bench->request->intersector_count; i++) {
        const uint32_t format = bb_intersector_format(&bench->intersectors[i]);
        BB_TRY(bb_residency_layout(&bench->residency, layout, &wish, choice->leaf, format,
                                   &choice->layouts[format]));
        if (bench->simt_count > 0 && choice->kernel->control != BB_CONTROL_UNKNOWN)
            BB_TRY(bb_residency_layout(&bench->residency, layout, &ordered, choice->leaf, format,
                                       &choice->simulated[format]));
    }
    return BB_OK;
}

static bb_status start_kernels(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    BB_TRY(
        bb_simts_parse(request->metrics, request->metric_count, bench->simts, &bench->simt_count));
    for (uint32_t i = 0; i < request->kernel_count; i++)
        BB_TRY(start_kernel(bench, request->kernels[i], false));
    for (const bb_kernel *const *k = bb_kernels; request->native && *k != NULL; k++)
        if ((*k)->native && bench->kernel_count < BB_KERNELS_MAX &&
            bb_variants_of((*k)->variants, BB_ROLE_COMPARED, bb_device_kind(bench->device)) == NULL)
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

void bb_bench_outcome_add(bb_bench_outcome *sum, const bb_bench_outcome *more)
{
    sum->wrong += more->wrong;
    sum->sets += more->sets;
    sum->cells += more->cells;
    sum->unjudged += more->unjudged;
    sum->unbuilt += more->unbuilt;
    sum->bytes_held = more->bytes_held > sum->bytes_held ? more->bytes_held : sum->bytes_held;
    sum->times.build_ms += more->times.build_ms;
    sum->times.trace_ms += more->times.trace_ms;
    sum->times.total_ms += more->times.total_ms;
    bb_audit_add(&sum->audit, &more->audit);
}

static void free_first(bb_bench *bench)
{
    if (bench->first != bench->request->scene)
        bb_scene_free(bench->first);
    bench->first = NULL;
}

/* Runs a scene, unless all of it belongs to other shards. */
static bb_status run_scene(bb_bench *bench, uint32_t index)
{
    bench->part = &bench->parts[index];
    bench->set = bench->part->first;
    if (bench->part->own > 0)
        return bb_bench_scene(bench, bench->request->scenes[index]);
    if (index == 0)
        free_first(bench);
    return BB_OK;
}

static bb_status compile_kernels(bb_bench *bench)
{
    BB_TRY(start_buffers(bench));
    BB_TRY(start_intersectors(bench));
    return start_kernels(bench);
}

/* Of which builds on the device, of few primitives, mostly consist. */
static bb_status time_launches(bb_bench *bench)
{
    bb_step step = bb_bench_begin(bench);
    double us;
    BB_TRY(bb_launch_cost(bench->device, &us));
    BB_TRY(bb_results_set_number(bench->results, BB_F_CONTEXT_LAUNCH, us));
    return bb_bench_end(bench, step, "time launches", BB_OK);
}

static bb_status prepare(bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bench->built = calloc(request->builder_count + 1, sizeof *bench->built);
    bench->parts = calloc(request->scene_count + 1, sizeof *bench->parts);
    if (bench->built == NULL || bench->parts == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    BB_TRY(try_scenes(bench));
    BB_TRY(try_builders(bench));
    bb_step step = bb_bench_begin(bench);
    BB_TRY(bb_bench_end(bench, step, "compile kernels", compile_kernels(bench)));
    return time_launches(bench);
}

bb_status bb_bench_run(const bb_bench_request *request, bb_results *results,
                       bb_bench_outcome *outcome)
{
    memset(outcome, 0, sizeof *outcome);
    BB_TRY(bb_bench_check(request));
    bb_progress progress;
    bb_progress_start(&progress, request->quiet);
    bb_progress_tell(&progress, request->tell, request->whom);
    bb_bench *bench = calloc(1, sizeof *bench);
    if (bench == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bench->request = request;
    bench->device = bench->residency.device = request->device;
    bench->residency.seed = request->seed;
    bench->residency.give_up = bb_bench_give_up;
    bench->residency.whom = bench;
    bench->results = results;
    bench->outcome = outcome;
    bb_results_begin_run(results);
    bench->random.state = request->seed;
    bench->progress = &progress;
    bench->start = bb_wall_ms();
    bb_bystanders_start(&bench->bystanders);
    bb_status status = prepare(bench);
    const uint32_t rounds = request->repeats + 1;
    bb_progress_plan(&progress, (double)rounds * (request->scene_count * request->builder_count +
                                                  bench->sets * bb_bench_cells_of_set(bench)));
    outcome->sets = bench->sets;
    uint32_t own = 0;
    for (uint32_t i = 0; i < request->scene_count && status == BB_OK && !bb_interrupted(); i++) {
        own += bench->parts[i].own;
        status = run_scene(bench, i);
    }
    for (uint32_t i = 0;
         i < request->builder_count && own > 0 && status == BB_OK && !bb_interrupted(); i++)
        outcome->unbuilt += !bench->built[i];
    free(bench->built);
    free(bench->parts);
    free_first(bench);
    bb_progress_end(&progress);
    bb_host_unbook(bench->kept_for_rays);
    bb_buffer_release(&bench->rays);
    bb_buffer_release(&bench->answers);
    bb_counter_release(&bench->counter);
    bb_residency_end(&bench->residency);
    free(bench->intersectors);
    bb_traversers_clear(bench->device);
    outcome->times.total_ms = bb_wall_ms() - bench->start;
    free(bench);
    return status;
}
