/* A comparison as JSON: README.md has the schema. */
#include "framework/dvr/dvr.h"

#include "framework/record/put.h"

static bool put_way(cJSON *list, const bb_dvr_result *result, const bb_contest_way *way)
{
    cJSON *entry;
    bool put = bb_contest_put_way(list, bb_contest_base(result->ways, result->way_count), way,
                                  "picture", &entry);
    if (entry == NULL || !put)
        return put;
    put = bb_put_number(entry, "samples_per_ray", way->work);
    if (way->builder[0] == '\0' || !put)
        return put;
    return bb_put_number(entry, "largest_difference", way->most) &&
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
           bb_contest_put_samples(entry, "picture_ms", &error->march);
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
           bb_contest_put_samples(root, "copy_ms", &r->copy);
}

static bool put_result(cJSON *root, const bb_dvr_result *r)
{
    cJSON *ways = cJSON_CreateArray(), *errors = NULL;
    bool put = bb_put_text(root, "scene", r->scene) && bb_put_text(root, "transfer", r->transfer) &&
               put_scene(root, r) && bb_put_number(root, "pictures", r->pictures) &&
               bb_put_number(root, "pixels", (double)r->pixels) &&
               bb_put_text(root, "compared_by", r->by_others ? "OpenImageIO" : "");
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
