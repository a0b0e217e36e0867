/* A comparison as JSON: README.md has the schema. */
#include "framework/dvr/dvr.h"

#include "framework/record/put.h"

static bool put_samples(cJSON *object, const char *name, const bb_samples *samples)
{
    bb_estimate e = bb_samples_estimate(samples);
    cJSON *figure = cJSON_CreateObject();
    return bb_put(object, name, figure) && bb_put_number(figure, "median", e.value) &&
           bb_put_number(figure, "lo", e.low) && bb_put_number(figure, "hi", e.high) &&
           bb_put_numbers(figure, "samples", samples->values, samples->count);
}

static bool put_ratio(cJSON *object, const char *name, bb_estimate e)
{
    cJSON *figure = cJSON_CreateObject();
    return bb_put(object, name, figure) && bb_put_number(figure, "median", e.value) &&
           bb_put_number(figure, "lo", e.low) && bb_put_number(figure, "hi", e.high);
}

static bool put_phases(cJSON *object, const bb_dvr_way *way)
{
    cJSON *phases = cJSON_CreateObject();
    bool put = bb_put(object, "phases_ms", phases);
    for (uint32_t p = 0; p < way->phase_count && put; p++)
        put = put_samples(phases, way->phases[p].name, &way->phases[p].ms);
    return put;
}

static bool put_way(cJSON *list, const bb_dvr_result *result, const bb_dvr_way *way)
{
    cJSON *entry = cJSON_CreateObject();
    if (entry == NULL || !cJSON_AddItemToArray(list, entry)) {
        cJSON_Delete(entry);
        return false;
    }
    if (!bb_put_text(entry, "builder", way->builder) || !bb_put_text(entry, "kernel", way->kernel))
        return false;
    if (way->refused[0] != '\0')
        return bb_put_text(entry, "refused", way->refused);
    bool put = put_samples(entry, "picture_ms", &way->march) &&
               put_samples(entry, "picture_cpu_ms", &way->march_cpu) &&
               bb_put_number(entry, "samples_per_ray", way->samples);
    if (way->builder[0] == '\0' || !put)
        return put;
    return put_samples(entry, "build_ms", &way->build) &&
           put_samples(entry, "layout_ms", &way->layout) && put_phases(entry, way) &&
           put_ratio(entry, "picture_ratio", bb_dvr_ratio(result, way, false)) &&
           put_ratio(entry, "all_ratio", bb_dvr_ratio(result, way, true)) &&
           bb_put_number(entry, "references", way->references) &&
           bb_put_number(entry, "tree_bytes", (double)way->tree_bytes) &&
           bb_put_number(entry, "nodes", way->nodes) &&
           bb_put_number(entry, "leaves", way->leaves) &&
           bb_put_number(entry, "bytes", (double)way->bytes) &&
           bb_put_number(entry, "largest_difference", way->most) &&
           bb_put_number(entry, "largest_difference_8_bits", way->most_8) &&
           bb_put_number(entry, "pixels_that_differ", (double)way->differ);
}

static bool put_error(cJSON *list, const bb_dvr_error *error)
{
    cJSON *entry = cJSON_CreateObject();
    if (entry == NULL || !cJSON_AddItemToArray(list, entry)) {
        cJSON_Delete(entry);
        return false;
    }
    return bb_put_number(entry, "step", error->step) && bb_put_number(entry, "most", error->most) &&
           bb_put_number(entry, "rms", error->rms) &&
           bb_put_number(entry, "samples_per_ray", error->samples) &&
           put_samples(entry, "picture_ms", &error->march);
}

static bool put_scene(cJSON *root, const bb_dvr_result *r)
{
    const double dims[3] = {r->dims[0], r->dims[1], r->dims[2]};
    if (r->tets > 0)
        return bb_put_number(root, "tetrahedra", r->tets) &&
               bb_put_number(root, "vertices", r->vertices) &&
               bb_put_number(root, "boundary_tetrahedra", r->boundary) &&
               bb_put_text(root, "field", r->field);
    return bb_put_numbers(root, "voxels", dims, 3) && bb_put_number(root, "bits", 8 * r->bytes) &&
           bb_put_number(root, "brick_side", r->brick_side) &&
           bb_put_number(root, "bricks", r->bricks) &&
           bb_put_number(root, "bricks_seen", r->seen) &&
           bb_put_number(root, "volume_bytes", (double)r->volume_bytes) &&
           put_samples(root, "copy_ms", &r->copy);
}

static bool put_result(cJSON *root, const bb_dvr_result *r)
{
    cJSON *ways = cJSON_CreateArray(), *errors = NULL;
    bool put = bb_put_text(root, "scene", r->scene) && bb_put_text(root, "transfer", r->transfer) &&
               put_scene(root, r) && bb_put_number(root, "pictures", r->pictures) &&
               bb_put_number(root, "pixels", (double)r->pixels);
    put = bb_put(root, "ways", ways) && put;
    for (uint32_t w = 0; w < r->way_count && put; w++)
        put = put_way(ways, r, &r->ways[w]);
    errors = cJSON_CreateArray();
    put = bb_put(root, "accuracy", errors) && put;
    for (uint32_t i = 0; i < r->error_count && put; i++)
        put = put_error(errors, &r->errors[i]);
    return put && (r->error_count == 0 || bb_put_number(root, "converged_to", r->converged));
}

cJSON *bb_dvr_json(const bb_dvr_result *result)
{
    cJSON *root = cJSON_CreateObject();
    if (root != NULL && put_result(root, result))
        return root;
    cJSON_Delete(root);
    return NULL;
}
