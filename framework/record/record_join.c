/* Joins the shards of one run. Unlike merging (record_merge.c), runs are not numbered. If one shard
 * measured a build and others only needed it, the measured one stays.
 */
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_status no_memory(void)
{
    return bb_fail(BB_FAILED, "joining shards: no memory");
}

static cJSON *copy_to(cJSON *array, const cJSON *item)
{
    cJSON *copy = cJSON_Duplicate(item, 1);
    if (copy != NULL && cJSON_AddItemToArray(array, copy))
        return copy;
    cJSON_Delete(copy);
    return NULL;
}

/* ---- whether they are shards of one run ---- */

static bb_status check_contexts(const cJSON *a, const cJSON *b)
{
    static const bb_field_id alike[] = {
        BB_F_CONTEXT_REVISION, BB_F_CONTEXT_VERSION, BB_F_CONTEXT_CPU,
        BB_F_CONTEXT_DEVICE,   BB_F_CONTEXT_DRIVER,  BB_F_CONTEXT_FLAGS,
        BB_F_CONTEXT_KERNELS,  BB_F_CONTEXT_SEED,    BB_F_CONTEXT_EMBREE};
    for (size_t i = 0; i < sizeof alike / sizeof alike[0]; i++) {
        const cJSON *x = bb_get(a, alike[i]), *y = bb_get(b, alike[i]);
        if ((x == NULL || cJSON_IsNull(x)) && (y == NULL || cJSON_IsNull(y)))
            continue;
        if (!cJSON_Compare(x, y, 1))
            return bb_fail(BB_INVALID,
                           "shards of one run have the same %s, these have not (%.100s, %.100s): "
                           "bvhbench report makes one report of several runs",
                           bb_fields[alike[i]].name, cJSON_IsString(x) ? x->valuestring : "?",
                           cJSON_IsString(y) ? y->valuestring : "?");
    }
    return BB_OK;
}

/* Checks that both shards are of the same request: else their parts would not make up the whole. */
static bb_status check_requests(const cJSON *a, const cJSON *b)
{
    const char *x = bb_get_text(a, BB_F_CONTEXT_SHARD_OF),
               *y = bb_get_text(b, BB_F_CONTEXT_SHARD_OF);
    if (strcmp(x, y) == 0)
        return BB_OK;
    return bb_fail(BB_INVALID, "shards of one run are made with the same options, these are not "
                               "(see \"command\" in the files): run them alike but for --shard and "
                               "--out");
}

static bb_status check_scenes(const bb_results *a, const bb_results *b)
{
    const cJSON *scene;
    cJSON_ArrayForEach(scene, bb_results_section(b, BB_SCENES))
    {
        const cJSON *known = bb_results_scene(a, bb_get_text(scene, BB_F_SCENE_NAME));
        if (known != NULL && !bb_same_text(known, scene, BB_F_SCENE_HASH))
            return bb_fail(BB_INVALID, "scene %s has other geometry in another shard",
                           bb_get_text(scene, BB_F_SCENE_NAME));
    }
    return BB_OK;
}

static int by_text(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Returns the keys of all traces, sorted; from malloc. */
static const char **keys_of(const bb_results *results, size_t *count)
{
    const cJSON *traces = bb_results_section(results, BB_TRACES), *trace;
    const char **keys = malloc(((size_t)cJSON_GetArraySize(traces) + 1) * sizeof *keys);
    *count = 0;
    cJSON_ArrayForEach(trace, traces)
    {
        if (keys != NULL)
            keys[(*count)++] = bb_get_text(trace, BB_F_TRACE_CELL);
    }
    if (keys != NULL)
        qsort(keys, *count, sizeof *keys, by_text);
    return keys;
}

static bb_status check_traces(const bb_results *a, const bb_results *b)
{
    size_t count;
    const char **keys = keys_of(a, &count);
    bb_status status = keys != NULL ? BB_OK : no_memory();
    const cJSON *trace;
    cJSON_ArrayForEach(trace, bb_results_section(b, BB_TRACES))
    {
        const char *key = bb_get_text(trace, BB_F_TRACE_CELL);
        if (status == BB_OK && bsearch(&key, keys, count, sizeof *keys, by_text) != NULL)
            status =
                bb_fail(BB_INVALID,
                        "cell %.400s is in two of the files: they are no shards of one run", key);
    }
    free(keys);
    return status;
}

/* ---- builds ---- */

/* Returns whether both builds gave the same tree: not all builders are deterministic. */
static bool same_tree(const cJSON *a, const cJSON *b)
{
    static const bb_field_id shape[] = {BB_F_TREE_NODES, BB_F_TREE_LEAVES, BB_F_TREE_REFS,
                                        BB_F_TREE_DEPTH};
    if (!bb_same_text(a, b, BB_F_BUILD_STATUS))
        return false;
    for (size_t i = 0; i < sizeof shape / sizeof shape[0]; i++) {
        double x = bb_get_number(a, shape[i]), y = bb_get_number(b, shape[i]);
        if (x != y && (x == x || y == y))
            return false;
    }
    return true;
}

static cJSON *find_build(const bb_results *results, const cJSON *like)
{
    cJSON *build;
    const char *key = bb_get_text(like, BB_F_BUILD_CELL);
    cJSON_ArrayForEach(build, bb_results_section(results, BB_BUILDS))
    {
        if (key[0] != '\0' && strcmp(bb_get_text(build, BB_F_BUILD_CELL), key) == 0 &&
            same_tree(build, like))
            return build;
    }
    return NULL;
}

/* Joins a build. *id is its id in `a`. */
static bb_status join_build(bb_results *a, const cJSON *build, double *id)
{
    cJSON *known = find_build(a, build);
    cJSON *builds = cJSON_GetObjectItemCaseSensitive(a->root, "builds");
    const bool unmeasured = bb_get_true(build, BB_F_BUILD_UNMEASURED);
    if (known != NULL && !unmeasured && !bb_get_true(known, BB_F_BUILD_UNMEASURED))
        return bb_fail(BB_INVALID,
                       "build %.400s was measured in two of the files: they are no shards of one "
                       "run",
                       bb_get_text(build, BB_F_BUILD_CELL));
    *id = known != NULL ? bb_get_number(known, BB_F_BUILD_ID) : bb_results_next_build(a);
    if (known != NULL && unmeasured)
        return BB_OK;
    cJSON *copy = cJSON_Duplicate(build, 1);
    if (copy == NULL)
        return no_memory();
    cJSON_SetNumberHelper(cJSON_GetObjectItemCaseSensitive(copy, bb_fields[BB_F_BUILD_ID].name),
                          *id);
    if (known != NULL ? cJSON_ReplaceItemViaPointer(builds, known, copy)
                      : cJSON_AddItemToArray(builds, copy))
        return BB_OK;
    cJSON_Delete(copy);
    return no_memory();
}

static bb_status join_builds_and_traces(bb_results *a, const bb_results *b)
{
    const cJSON *builds = bb_results_section(b, BB_BUILDS), *item;
    cJSON *to = cJSON_GetObjectItemCaseSensitive(a->root, "traces");
    uint32_t most = bb_results_next_build(b);
    double *ids = calloc((size_t)most + 1, sizeof *ids);
    bb_status status = ids != NULL ? BB_OK : no_memory();
    cJSON_ArrayForEach(item, builds)
    {
        if (status == BB_OK)
            status = join_build(a, item, &ids[(uint32_t)bb_get_number(item, BB_F_BUILD_ID)]);
    }
    cJSON_ArrayForEach(item, bb_results_section(b, BB_TRACES))
    {
        cJSON *copy = status == BB_OK ? copy_to(to, item) : NULL;
        if (status == BB_OK && copy == NULL)
            status = no_memory();
        if (copy != NULL)
            cJSON_SetNumberHelper(
                cJSON_GetObjectItemCaseSensitive(copy, bb_fields[BB_F_TRACE_BUILD].name),
                ids[(uint32_t)bb_get_number(item, BB_F_TRACE_BUILD)]);
    }
    free(ids);
    return status;
}

/* ---- the rest ---- */

static bb_status join_lists(bb_results *a, const bb_results *b)
{
    static const char *const lists[] = {"skipped", "pictures", "scenes"};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        cJSON *to = cJSON_GetObjectItemCaseSensitive(a->root, lists[i]);
        const cJSON *item;
        cJSON_ArrayForEach(item, bb_results_member(b, lists[i]))
        {
            bool known = i == 2 && bb_results_scene(a, bb_get_text(item, BB_F_SCENE_NAME)) != NULL;
            if (!known && copy_to(to, item) == NULL)
                return no_memory();
        }
    }
    return BB_OK;
}

static bb_status join_times(bb_results *a, const bb_results *b)
{
    const cJSON *x = cJSON_GetObjectItemCaseSensitive(a->root, "time_ms");
    const cJSON *y = cJSON_GetObjectItemCaseSensitive(b->root, "time_ms"), *step;
    cJSON_ArrayForEach(step, bb_results_section(b, BB_STEPS))
    {
        if (cJSON_IsNumber(step))
            BB_TRY(bb_results_add_step(a, step->string, step->valuedouble));
    }
    if (!cJSON_IsObject(x) || !cJSON_IsObject(y)) {
        cJSON_DeleteItemFromObjectCaseSensitive(a->root, "time_ms");
        return BB_OK;
    }
    return bb_results_set_total(a, bb_json_number(x, "build") + bb_json_number(y, "build"),
                                bb_json_number(x, "trace") + bb_json_number(y, "trace"),
                                bb_json_number(x, "total") + bb_json_number(y, "total"));
}

/* Adds "2/8 on HOST, DATE" to the list of shards in `context`. */
static bb_status note_shard(cJSON *context, const cJSON *of)
{
    char text[400];
    const char *name = bb_fields[BB_F_CONTEXT_SHARDS].name;
    cJSON *list = cJSON_GetObjectItemCaseSensitive(context, name);
    if (!cJSON_IsArray(list)) {
        cJSON_DeleteItemFromObjectCaseSensitive(context, name);
        list = cJSON_AddArrayToObject(context, name);
    }
    snprintf(text, sizeof text, "%.20s on %.200s, %.32s", bb_get_text(of, BB_F_CONTEXT_SHARD),
             bb_get_text(of, BB_F_CONTEXT_HOST), bb_get_text(of, BB_F_CONTEXT_DATE));
    cJSON *item = list != NULL ? cJSON_CreateString(text) : NULL;
    if (item != NULL && cJSON_AddItemToArray(list, item))
        return BB_OK;
    cJSON_Delete(item);
    return no_memory();
}

bb_status bb_results_join(bb_results *a, const bb_results *b)
{
    cJSON *context = cJSON_GetObjectItemCaseSensitive(a->root, "context");
    const cJSON *other = bb_results_context(b);
    const double others[] = {bb_get_number(context, BB_F_CONTEXT_OTHERS),
                             bb_get_number(other, BB_F_CONTEXT_OTHERS)};
    BB_TRY(check_contexts(context, other));
    BB_TRY(check_requests(context, other));
    BB_TRY(check_scenes(a, b));
    BB_TRY(check_traces(a, b));
    bb_results_clear_predictions(a);
    if (bb_get(context, BB_F_CONTEXT_SHARDS) == NULL)
        BB_TRY(note_shard(context, context));
    BB_TRY(note_shard(context, other));
    BB_TRY(join_lists(a, b));
    BB_TRY(join_builds_and_traces(a, b));
    if (bb_get_true(other, BB_F_CONTEXT_INTERRUPTED))
        BB_TRY(bb_results_set_interrupted(a));
    if (others[1] > others[0])
        BB_TRY(bb_results_set_others(a, others[1]));
    return join_times(a, b);
}

void bb_results_end_join(bb_results *results)
{
    cJSON *context = cJSON_GetObjectItemCaseSensitive(results->root, "context");
    cJSON_DeleteItemFromObjectCaseSensitive(context, bb_fields[BB_F_CONTEXT_SHARD].name);
    cJSON_DeleteItemFromObjectCaseSensitive(context, bb_fields[BB_F_CONTEXT_SHARD_OF].name);
}
