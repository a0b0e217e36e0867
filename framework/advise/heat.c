/* From contenders to a comparison and back. */
#include "framework/advise/heat.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bb_status bb_entered_make(bb_contender *who, uint32_t count, bb_entered *field)
{
    *field = (bb_entered){.who = who, .count = count};
    field->racers = calloc(count + 1, sizeof *field->racers);
    field->figures = calloc(count + 1, sizeof *field->figures);
    if (who == NULL || field->racers == NULL || field->figures == NULL) {
        bb_entered_free(field);
        return bb_fail(BB_FAILED, "out of memory");
    }
    for (uint32_t i = 0; i < count; i++)
        field->racers[i] = (bb_racer){.behind = BB_NO_RACER, .ratio = bb_not_measured};
    return BB_OK;
}

void bb_entered_free(bb_entered *field)
{
    free(field->who);
    free(field->racers);
    free(field->figures);
    *field = (bb_entered){0};
}

/* Names of those in the race, once each. They belong to the contenders. */
typedef struct names {
    char *items[BB_TRIED_MAX];
    uint32_t count;
} names;

static void add_name(names *n, const char *name)
{
    for (uint32_t i = 0; i < n->count; i++)
        if (strcmp(n->items[i], name) == 0)
            return;
    if (n->count < BB_TRIED_MAX) /* there are no more in the lists */
        n->items[n->count++] = (char *)name;
}

static bool takes(const void *user, const char *builder, const char *kernel,
                  const char *intersector)
{
    const bb_entered *field = user;
    for (uint32_t i = 0; i < field->count; i++)
        if (field->racers[i].state == BB_RACING && bb_bench_fits(builder, field->who[i].builder) &&
            bb_bench_fits(kernel, field->who[i].kernel) &&
            bb_bench_fits(intersector, field->who[i].intersector))
            return true;
    return false;
}

static bool too_wrong(const bb_tried_figures *f, double limit, bool last)
{
    const bb_wrong_rate rate = bb_wrong_rate_of(f->wrong, f->checked);
    return f->unlike > 0 || rate.low > limit || (last && f->wrong > limit * f->checked / 1e6);
}

static void read_field(const bb_advise_request *request, const bb_results *results, bool last,
                       bb_entered *field)
{
    const cJSON *scene = cJSON_GetArrayItem(bb_results_section(results, "scenes"), 0);
    const bb_image image = {results, bb_get_text(scene, BB_F_SCENE_NAME), request->image_rays};
    for (uint32_t i = 0; i < field->count; i++) {
        bb_racer *racer = &field->racers[i];
        bb_tried_figures *f = &field->figures[i];
        if (racer->state != BB_RACING)
            continue;
        bb_tried_read(&image, &field->who[i], f);
        f->extent.place = i;
        racer->cost = f->cost;
        if (!f->measured)
            racer->state = BB_NOT_RUN;
        else if (too_wrong(f, request->max_wrong_ppm, last))
            racer->state = BB_TOO_WRONG;
    }
}

bb_status bb_heat_run(const bb_advise_request *request, const bb_heat *heat, bb_entered *field,
                      bb_results *results, bb_bench_outcome *outcome)
{
    names builders = {.count = 0}, kernels = {.count = 0}, intersectors = {.count = 0};
    char *scene = (char *)request->scene;
    for (uint32_t i = 0; i < field->count; i++) {
        if (field->racers[i].state != BB_RACING)
            continue;
        add_name(&builders, field->who[i].builder);
        add_name(&kernels, field->who[i].kernel);
        add_name(&intersectors, field->who[i].intersector);
    }
    const bb_bench_request bench = {.device = request->device,
                                    .scenes = &scene,
                                    .scene_count = 1,
                                    .builders = builders.items,
                                    .builder_count = builders.count,
                                    .kernels = kernels.items,
                                    .kernel_count = kernels.count,
                                    .intersectors = intersectors.items,
                                    .intersector_count = intersectors.count,
                                    .workloads = request->rays,
                                    .workload_count = request->ray_count,
                                    .width = heat->width,
                                    .height = heat->height,
                                    .max_rays = heat->max_rays,
                                    .max_views = request->max_views,
                                    .repeats = heat->repeats,
                                    .seed = request->seed,
                                    .max_wrong_ppm = request->max_wrong_ppm,
                                    .takes = takes,
                                    .user = field,
                                    .uncounted = true,
                                    .quiet = true};
    if (builders.count == 0)
        return BB_OK;
    BB_TRY(bb_bench_run(&bench, results, outcome));
    read_field(request, results, heat->last, field);
    return BB_OK;
}
