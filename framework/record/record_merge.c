/* Merges result documents, so that several runs make one report. */
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <string.h>

static bb_status no_memory(void)
{
    return bb_fail(BB_FAILED, "merging results: no memory");
}

/* Checks that scenes of one name have one geometry: else speeds on different geometry would be
 * compared. */
static bb_status check_scenes(const bb_results *a, const bb_results *b)
{
    const cJSON *scene;
    cJSON_ArrayForEach(scene, cJSON_GetObjectItemCaseSensitive(b->root, "scenes"))
    {
        const char *name = bb_get_text(scene, BB_F_SCENE_NAME);
        const cJSON *known = bb_results_scene(a, name);
        if (known != NULL &&
            strcmp(bb_get_text(known, BB_F_SCENE_HASH), bb_get_text(scene, BB_F_SCENE_HASH)) != 0)
            return bb_fail(BB_INVALID,
                           "scene %s has other geometry in the second result file (%s, not %s): "
                           "make separate reports",
                           name, bb_get_text(scene, BB_F_SCENE_HASH),
                           bb_get_text(known, BB_F_SCENE_HASH));
    }
    return BB_OK;
}

/* Checks that both runs are of one device: else devices would be mixed in one ranking. An external
 * tracer's answers have no device. */
static bb_status check_devices(const bb_results *a, const bb_results *b)
{
    const cJSON *one = bb_results_context(a), *other = bb_results_context(b);
    const char *device = bb_get_text(one, BB_F_CONTEXT_DEVICE);
    const char *another = bb_get_text(other, BB_F_CONTEXT_DEVICE);
    return device[0] == '\0' || another[0] == '\0' ||
                   bb_device_is_like(device, bb_get_text(one, BB_F_CONTEXT_DEVICE_TYPE), another,
                                     bb_get_text(other, BB_F_CONTEXT_DEVICE_TYPE))
               ? BB_OK
               : bb_fail(
                     BB_INVALID,
                     "the second result file was measured on %s, the first on %s: make separate "
                     "reports",
                     another, device);
}

/* Appends a copy of `item` to `array`; NULL without memory. */
static cJSON *copy_to(cJSON *array, const cJSON *item)
{
    cJSON *copy = cJSON_Duplicate(item, 1);
    if (copy != NULL && cJSON_AddItemToArray(array, copy))
        return copy;
    cJSON_Delete(copy);
    return NULL;
}

/* Copies all elements of b's array `section`. Adds `first_id` to the id in `id_name`, unless that
 * is NULL, and notes the run. */
static bb_status copy_rows(bb_results *a, const bb_results *b, const char *section,
                           const char *id_name, double first_id, double first_run)
{
    cJSON *to = cJSON_GetObjectItemCaseSensitive(a->root, section);
    const cJSON *from = cJSON_GetObjectItemCaseSensitive(b->root, section);
    const cJSON *row;
    cJSON_ArrayForEach(row, from)
    {
        cJSON *copy = copy_to(to, row);
        if (copy == NULL)
            return no_memory();
        if (id_name != NULL) {
            cJSON *id = cJSON_GetObjectItemCaseSensitive(copy, id_name);
            cJSON_SetNumberHelper(id, id->valuedouble + first_id);
        }
        const cJSON *run = cJSON_GetObjectItemCaseSensitive(row, "run");
        double number = first_run + (cJSON_IsNumber(run) ? run->valuedouble : 0);
        cJSON_DeleteItemFromObjectCaseSensitive(copy, "run");
        if (cJSON_AddNumberToObject(copy, "run", number) == NULL)
            return no_memory();
    }
    return BB_OK;
}

/* Copies all elements of b's array `section` unchanged. Either document may lack the array. */
static bb_status copy_list(bb_results *a, const bb_results *b, const char *section)
{
    const cJSON *from = cJSON_GetObjectItemCaseSensitive(b->root, section), *item;
    cJSON *to = cJSON_GetObjectItemCaseSensitive(a->root, section);
    if (to == NULL && from != NULL)
        to = cJSON_AddArrayToObject(a->root, section);
    cJSON_ArrayForEach(item, from)
    {
        if (to == NULL || copy_to(to, item) == NULL)
            return no_memory();
    }
    return from == NULL || to != NULL ? BB_OK : no_memory();
}

/* Adds b's contexts. *first_run is the number of the first. */
static bb_status copy_contexts(bb_results *a, const bb_results *b, double *first_run)
{
    cJSON *merged = cJSON_GetObjectItemCaseSensitive(a->root, "merged");
    if (merged == NULL)
        merged = cJSON_AddArrayToObject(a->root, "merged");
    if (merged == NULL)
        return no_memory();
    *first_run = cJSON_GetArraySize(merged) + 1;
    if (copy_to(merged, cJSON_GetObjectItemCaseSensitive(b->root, "context")) == NULL)
        return no_memory();
    const cJSON *context;
    cJSON_ArrayForEach(context, cJSON_GetObjectItemCaseSensitive(b->root, "merged"))
    {
        if (copy_to(merged, context) == NULL)
            return no_memory();
    }
    return BB_OK;
}

/* Adds the times, after the steps. If a or b has no total, the result has none: it would be that of
 * the other alone. */
static bb_status add_times(bb_results *a, const bb_results *b)
{
    const cJSON *first = cJSON_GetObjectItemCaseSensitive(a->root, "time_ms");
    const cJSON *second = cJSON_GetObjectItemCaseSensitive(b->root, "time_ms");
    if (!cJSON_IsObject(first) || !cJSON_IsObject(second)) {
        cJSON_DeleteItemFromObjectCaseSensitive(a->root, "time_ms");
        return BB_OK;
    }
    return bb_results_set_total(a, bb_json_number(first, "build") + bb_json_number(second, "build"),
                                bb_json_number(first, "trace") + bb_json_number(second, "trace"),
                                bb_json_number(first, "total") + bb_json_number(second, "total"));
}

bb_status bb_results_merge(bb_results *a, const bb_results *b)
{
    BB_TRY(check_devices(a, b));
    BB_TRY(check_scenes(a, b));
    bb_results_clear_predictions(a);
    double first_id = bb_results_next_build(a), first_run = 1;
    BB_TRY(copy_contexts(a, b, &first_run));

    cJSON *scenes = cJSON_GetObjectItemCaseSensitive(a->root, "scenes");
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(b->root, "scenes"))
    {
        if (bb_results_scene(a, bb_get_text(item, BB_F_SCENE_NAME)) == NULL &&
            copy_to(scenes, item) == NULL)
            return no_memory();
    }
    BB_TRY(copy_rows(a, b, "builds", "id", first_id, first_run));
    BB_TRY(copy_rows(a, b, "traces", "build", first_id, first_run));
    BB_TRY(copy_rows(a, b, "skipped", NULL, 0, first_run));
    BB_TRY(copy_list(a, b, "pictures"));
    BB_TRY(copy_list(a, b, "reproductions"));
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(b->root, "steps_ms"))
    {
        if (cJSON_IsNumber(item))
            BB_TRY(bb_results_add_step(a, item->string, item->valuedouble));
    }
    return add_times(a, b);
}
