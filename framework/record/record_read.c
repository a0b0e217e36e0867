/* Result files: written whole, read with their schema checked, merged.
 *
 * What is read may be truncated or hostile: every field that the report uses is checked for its
 * type here, once, so that what comes after need not.
 */
#include "framework/base/file.h"
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A result file of a million rows is some 1.5 GB; nobody reads such a report. */
enum { RESULTS_BYTES_MAX = 256 << 20, BUILDS_MAX = 1 << 20 };

const char *bb_json_text(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsString(item) ? item->valuestring : "";
}

double bb_json_number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

bool bb_json_true(const cJSON *object, const char *name)
{
    return cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(object, name));
}

cJSON *bb_results_scene(const bb_results *results, const char *name)
{
    cJSON *scene;
    cJSON_ArrayForEach(scene, cJSON_GetObjectItemCaseSensitive(results->root, "scenes"))
    {
        if (strcmp(bb_json_text(scene, "name"), name) == 0)
            return scene;
    }
    return NULL;
}

cJSON *bb_results_build(const bb_results *results, uint32_t id)
{
    cJSON *build;
    cJSON_ArrayForEach(build, cJSON_GetObjectItemCaseSensitive(results->root, "builds"))
    {
        if (bb_json_number(build, "id") == (double)id)
            return build;
    }
    return NULL;
}

/* ---- writing ---- */

/* cJSON takes 15 digits where they are right to within a rounding error; here a number is printed
 * with as many as give the same double back. */
static bool exact_numbers(cJSON *item)
{
    for (; item != NULL; item = item->next) {
        if (item->child != NULL && !exact_numbers(item->child))
            return false;
        if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
            continue;
        char text[40];
        for (int digits = 15; digits <= 17; digits++) {
            snprintf(text, sizeof text, "%.*g", digits, item->valuedouble);
            if (strtod(text, NULL) == item->valuedouble)
                break;
        }
        item->valuestring = cJSON_malloc(strlen(text) + 1);
        if (item->valuestring == NULL)
            return false;
        memcpy(item->valuestring, text, strlen(text) + 1);
        item->type = cJSON_Raw;
    }
    return true;
}

char *bb_results_print(const bb_results *results, bool formatted)
{
    cJSON *copy = cJSON_Duplicate(results->root, 1);
    char *text = NULL;
    if (copy != NULL && exact_numbers(copy))
        text = formatted ? cJSON_Print(copy) : cJSON_PrintUnformatted(copy);
    cJSON_Delete(copy);
    return text;
}

bb_status bb_results_write(const bb_results *results, const char *path)
{
    char *text = bb_results_print(results, true);
    if (text == NULL)
        return bb_fail(BB_FAILED, "result file %s: no memory", path);
    size_t size = strlen(text);
    text[size] = '\n'; /* in place of the 0: bb_file_write() takes a size */
    bb_status status = bb_file_write(path, text, size + 1, "result file");
    cJSON_free(text);
    return status;
}

/* ---- reading ---- */

/* Types of a field. */
enum {
    TEXT = 1 << 0,
    NUMBER = 1 << 1,
    BOOLEAN = 1 << 2,
    OBJECT = 1 << 3,
    NUMBERS = 1 << 4, /* array of numbers or nulls */
    TEXTS = 1 << 5,   /* array of strings */
    FIGURES = 1 << 6, /* object of numbers or nulls */
    NONE = 1 << 7,    /* null or absent */
};

typedef struct field {
    const char *name;
    unsigned types;
} field;

static const field context_fields[] = {
    {"date", TEXT | NONE},
    {"revision", TEXT | NONE},
    {"version", TEXT | NONE},
    {"host", TEXT | NONE},
    {"cpu", TEXT | NONE},
    {"cpu_threads", NUMBER | NONE},
    {"load", NUMBERS | NUMBER | NONE},
    {"device", TEXT | NONE},
    {"driver", TEXT | NONE},
    {"opencl", TEXT | NONE},
    {"compute_units", NUMBER | NONE},
    {"float_config", TEXTS | NONE},
    {"embree", OBJECT | NONE},
    {"kernels", TEXT | NONE},
    {"build_flags", TEXT | NONE},
    {"seed", NUMBER | TEXT | NONE},
    {"command", TEXT | NONE},
    {NULL, 0},
};

static const field scene_fields[] = {
    {"name", TEXT},
    {"kind", TEXT | NONE},
    {"source", TEXT | NONE},
    {"prims", NUMBER},
    {"hash", TEXT | NONE},
    {"profile", OBJECT | NONE},
    {"bounds", OBJECT | NONE},
    {"views", TEXTS | NONE},
    {NULL, 0},
};

static const field build_fields[] = {
    {"id", NUMBER},
    {"scene", TEXT},
    {"builder", TEXT},
    {"params", OBJECT | NONE},
    {"status", TEXT},
    {"reason", TEXT | NONE},
    {"build_ms", NUMBERS | NONE},
    {"build_ms_median", NUMBER | NONE},
    {"build_ms_lo", NUMBER | NONE},
    {"build_ms_hi", NUMBER | NONE},
    {"build_ms_least", NUMBER | NONE},
    {"build_ms_most", NUMBER | NONE},
    {"mprims_s", NUMBER | NONE},
    {"cold_ms", NUMBER | NONE},
    {"stages_ms", FIGURES | NONE},
    {"phases_ms", FIGURES | NONE},
    {"boxes_ms", NUMBER | NONE},
    {"prepare_ms", NUMBER | NONE},
    {"restore_ms", NUMBER | NONE},
    {"outside_ms", NUMBER | NONE},
    {"inputs", TEXT | NONE},
    {"transfer_ms", NUMBER | NONE},
    {"layouts_ms", FIGURES | NONE},
    {"layouts_sah", FIGURES | NONE},
    {"tree", OBJECT | NONE},
    {"bytes_native", NUMBER | NONE},
    {"about", TEXT | NONE},
    {"reference", BOOLEAN | NONE},
    {"run", NUMBER | NONE},
    {NULL, 0},
};

static const field tree_fields[] = {
    {"nodes", NUMBER | NONE},
    {"leaves", NUMBER | NONE},
    {"refs", NUMBER | NONE},
    {"arity", NUMBER | NONE},
    {"depth", NUMBER | NONE},
    {"bytes_tree", NUMBER | NONE},
    {"bytes_peak", NUMBER | NONE},
    {"sah", NUMBER | NONE},
    {"epo", NUMBER | NONE},
    {"epo_half", NUMBER | NONE},
    {NULL, 0},
};

static const field trace_fields[] = {
    {"build", NUMBER},
    {"scene", TEXT},
    {"view", TEXT | NONE},
    {"builder", TEXT},
    {"kernel", TEXT},
    {"layout", TEXT | NONE},
    {"native", BOOLEAN | NONE},
    {"intersector", TEXT | NONE},
    {"rays", TEXT},
    {"rays_source", TEXT | NONE},
    {"query", TEXT | NONE},
    {"count", NUMBER},
    {"rays_hash", TEXT | NONE},
    {"group_size", NUMBER | NONE},
    {"stack_size", NUMBER | NONE},
    {"status", TEXT},
    {"reason", TEXT | NONE},
    {"ms", NUMBERS | NONE},
    {"ms_median", NUMBER | NONE},
    {"event_ms", NUMBER | NONE},
    {"cpu_ms", NUMBER | NONE},
    {"mrays_s", NUMBER | NONE},
    {"mrays_s_lo", NUMBER | NONE},
    {"mrays_s_hi", NUMBER | NONE},
    {"mrays_s_least", NUMBER | NONE},
    {"mrays_s_most", NUMBER | NONE},
    {"mrays_s_given", BOOLEAN | NONE},
    {"node_tests_per_ray", NUMBER | NONE},
    {"prim_tests_per_ray", NUMBER | NONE},
    {"counted", NUMBER | NONE},
    {"counts_for_exit", BOOLEAN | NONE},
    {"accuracy", OBJECT | NONE},
    {"unlike", NUMBER | NONE},
    {"unlike_whom", TEXT | NONE},
    {"wrong", BOOLEAN | NONE},
    {"reference", BOOLEAN | NONE},
    {"run", NUMBER | NONE},
    {NULL, 0},
};

static const field accuracy_fields[] = {
    {"checked", NUMBER},
    {"wrong_ppm", NUMBER | NONE},
    {"missed", NUMBER | NONE},
    {"false", NUMBER | NONE},
    {"wrong_t", NUMBER | NONE},
    {"ties", NUMBER | NONE},
    {"margin_limited", NUMBER | NONE},
    {"t_off", NUMBER | NONE},
    {"oracle_wrong", NUMBER | NONE},
    {"forgiven", NUMBER | NONE},
    {"unwritten", NUMBER | NONE},
    {"t_ulp_max", NUMBER | NONE},
    {"t_ulp_p99", NUMBER | NONE},
    {"overflowed", NUMBER | NONE},
    {NULL, 0},
};

static const field skipped_fields[] = {
    {"scene", TEXT},         {"rays", TEXT},         {"view", TEXT | NONE},
    {"reason", TEXT | NONE}, {"run", NUMBER | NONE}, {NULL, 0},
};

static const field picture_fields[] = {
    {"scene", TEXT | NONE},
    {"view", TEXT | NONE},
    {"caption", TEXT | NONE},
    {"path", TEXT},
    {NULL, 0},
};

/* A paper reproduced: tables of its figures and ours, and what was claimed. */
static const field reproduction_fields[] = {
    {"name", TEXT},
    {"title", TEXT | NONE},
    {NULL, 0},
};

static const field paper_table_fields[] = {
    {"title", TEXT | NONE},
    {"columns", TEXTS},
    {NULL, 0},
};

static const field claim_fields[] = {
    {"claim", TEXT},
    {"held", BOOLEAN | NONE},
    {"paper", TEXT | NONE},
    {"ours", TEXT | NONE},
    {"why", TEXT | NONE},
    {"verdict", TEXT | NONE},
    {NULL, 0},
};

static bool all_numbers(const cJSON *item)
{
    const cJSON *child;
    cJSON_ArrayForEach(child, item)
    {
        if (!cJSON_IsNumber(child) && !cJSON_IsNull(child))
            return false;
    }
    return true;
}

static bool all_texts(const cJSON *item)
{
    const cJSON *child;
    cJSON_ArrayForEach(child, item)
    {
        if (!cJSON_IsString(child))
            return false;
    }
    return true;
}

static bool has_type(const cJSON *item, unsigned types)
{
    if (item == NULL || cJSON_IsNull(item))
        return (types & NONE) != 0;
    return ((types & TEXT) && cJSON_IsString(item)) || ((types & NUMBER) && cJSON_IsNumber(item)) ||
           ((types & BOOLEAN) && cJSON_IsBool(item)) ||
           ((types & OBJECT) && cJSON_IsObject(item)) ||
           ((types & FIGURES) && cJSON_IsObject(item) && all_numbers(item)) ||
           ((types & NUMBERS) && cJSON_IsArray(item) && all_numbers(item)) ||
           ((types & TEXTS) && cJSON_IsArray(item) && all_texts(item));
}

/* `index` < 0: `object` is no element of an array. */
static bb_status check_fields(const char *path, const char *section, int index, const cJSON *object,
                              const field *fields)
{
    char place[64];
    snprintf(place, sizeof place, index < 0 ? "%s" : "%s[%d]", section, index);
    if (!cJSON_IsObject(object))
        return bb_fail(BB_INVALID, "result file %s: %s is not an object", path, place);
    for (const field *f = fields; f->name != NULL; f++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, f->name);
        if (!has_type(item, f->types))
            return bb_fail(BB_INVALID, "result file %s: %s: \"%s\" %s", path, place, f->name,
                           item == NULL ? "is missing" : "has the wrong type");
    }
    return BB_OK;
}

/* Each element of the array `section`, and its inner object if it has one and `inner_fields` is not
 * NULL. */
static bb_status check_section(const char *path, const cJSON *root, const char *section,
                               bool required, const field *fields, const char *inner,
                               const field *inner_fields)
{
    const cJSON *array = cJSON_GetObjectItemCaseSensitive(root, section);
    if (array == NULL && !required)
        return BB_OK;
    if (!cJSON_IsArray(array))
        return bb_fail(BB_INVALID, "result file %s: \"%s\" is %s", path, section,
                       array == NULL ? "missing" : "not an array");
    const cJSON *item;
    int index = 0;
    cJSON_ArrayForEach(item, array)
    {
        BB_TRY(check_fields(path, section, index, item, fields));
        const cJSON *part =
            inner_fields != NULL ? cJSON_GetObjectItemCaseSensitive(item, inner) : NULL;
        if (cJSON_IsObject(part)) {
            char place[64];
            snprintf(place, sizeof place, "%s[%d].%s", section, index, inner);
            BB_TRY(check_fields(path, place, -1, part, inner_fields));
        }
        index++;
    }
    return BB_OK;
}

/* Rows of numbers, texts and nulls, as many as there are columns. */
static bb_status check_rows(const char *path, const cJSON *root)
{
    const cJSON *reproduction, *table, *row, *item;
    cJSON_ArrayForEach(reproduction, cJSON_GetObjectItemCaseSensitive(root, "reproductions"))
    {
        cJSON_ArrayForEach(table, cJSON_GetObjectItemCaseSensitive(reproduction, "tables"))
        {
            const cJSON *rows = cJSON_GetObjectItemCaseSensitive(table, "rows");
            int columns = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(table, "columns"));
            bool ok = cJSON_IsArray(rows);
            cJSON_ArrayForEach(row, rows)
            {
                ok = ok && cJSON_IsArray(row) && cJSON_GetArraySize(row) == columns;
                cJSON_ArrayForEach(item, row)
                {
                    ok = ok && (cJSON_IsNumber(item) || cJSON_IsString(item) || cJSON_IsNull(item));
                }
            }
            if (!ok)
                return bb_fail(BB_INVALID,
                               "result file %s: reproductions: a table of %s has no \"rows\", or "
                               "one that is not of %d numbers and texts",
                               path, bb_json_text(reproduction, "name"), columns);
        }
    }
    return BB_OK;
}

static bb_status check_reproductions(const char *path, const cJSON *root)
{
    BB_TRY(check_section(path, root, "reproductions", false, reproduction_fields, "", NULL));
    const cJSON *reproduction;
    cJSON_ArrayForEach(reproduction, cJSON_GetObjectItemCaseSensitive(root, "reproductions"))
    {
        BB_TRY(check_section(path, reproduction, "tables", false, paper_table_fields, "", NULL));
        BB_TRY(check_section(path, reproduction, "claims", false, claim_fields, "", NULL));
    }
    return check_rows(path, root);
}

/* Ids are 0, 1, 2 ... below 2^20 and given once; every trace names one that exists. */
static bb_status check_ids(const char *path, const cJSON *root)
{
    bool *known = calloc(BUILDS_MAX, sizeof *known);
    if (known == NULL)
        return bb_fail(BB_FAILED, "result file %s: no memory", path);
    bb_status status = BB_OK;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, "builds"))
    {
        double id = cJSON_GetObjectItemCaseSensitive(item, "id")->valuedouble;
        if (!(id >= 0 && id < BUILDS_MAX && id == floor(id)) || known[(uint32_t)id]) {
            status = bb_fail(BB_INVALID, "result file %s: build id %g is given twice or no id",
                             path, id);
            goto out;
        }
        known[(uint32_t)id] = true;
    }
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, "traces"))
    {
        double id = cJSON_GetObjectItemCaseSensitive(item, "build")->valuedouble;
        if (!(id >= 0 && id < BUILDS_MAX && id == floor(id)) || !known[(uint32_t)id]) {
            status = bb_fail(BB_INVALID, "result file %s: a trace names build %g, which is missing",
                             path, id);
            goto out;
        }
    }
out:
    free(known);
    return status;
}

static bb_status check_document(const char *path, const cJSON *root)
{
    const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
    if (!cJSON_IsString(schema))
        return bb_fail(BB_INVALID, "result file %s: no \"schema\": it is not from bvhbench", path);
    if (strcmp(schema->valuestring, BB_RESULTS_SCHEMA) != 0)
        return bb_fail(BB_INVALID, "result file %s: schema \"%.40s\", this program reads \"%s\"",
                       path, schema->valuestring, BB_RESULTS_SCHEMA);
    BB_TRY(check_fields(path, "context", -1, cJSON_GetObjectItemCaseSensitive(root, "context"),
                        context_fields));
    BB_TRY(check_section(path, root, "scenes", true, scene_fields, "", NULL));
    BB_TRY(check_section(path, root, "builds", true, build_fields, "tree", tree_fields));
    BB_TRY(check_section(path, root, "traces", true, trace_fields, "accuracy", accuracy_fields));
    BB_TRY(check_section(path, root, "skipped", false, skipped_fields, "", NULL));
    BB_TRY(check_section(path, root, "pictures", false, picture_fields, "", NULL));
    BB_TRY(check_section(path, root, "merged", false, context_fields, "", NULL));
    BB_TRY(check_reproductions(path, root));
    static const char *const times[] = {"steps_ms", "time_ms"};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        if (!has_type(cJSON_GetObjectItemCaseSensitive(root, times[i]), FIGURES | NONE))
            return bb_fail(BB_INVALID, "result file %s: \"%s\" has the wrong type", path, times[i]);
    }
    return check_ids(path, root);
}

/* Later code appends to these, so they exist. Intervals are drawn anew from the samples: those of
 * files of earlier versions were bootstrapped, from however few rounds. */
static bool complete(bb_results *results)
{
    cJSON *root = results->root;
    static const char *const arrays[] = {"skipped", "pictures"};
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) {
        if (cJSON_GetObjectItemCaseSensitive(root, arrays[i]) == NULL &&
            cJSON_AddArrayToObject(root, arrays[i]) == NULL)
            return false;
    }
    if (cJSON_IsNull(cJSON_GetObjectItemCaseSensitive(root, "steps_ms")))
        cJSON_DeleteItemFromObjectCaseSensitive(root, "steps_ms");
    if (cJSON_GetObjectItemCaseSensitive(root, "steps_ms") == NULL &&
        cJSON_AddObjectToObject(root, "steps_ms") == NULL)
        return false;
    return bb_results_put_spreads(results);
}

bb_status bb_results_read(const char *path, bb_results **out)
{
    *out = NULL;
    char *text = NULL;
    size_t size = 0;
    BB_TRY(bb_file_read(path, RESULTS_BYTES_MAX, "result file", &text, &size));
    bb_status status = BB_OK;
    const char *end = NULL;
    bb_results *results = calloc(1, sizeof *results);
    if (results == NULL) {
        status = bb_fail(BB_FAILED, "result file %s: no memory", path);
        goto out;
    }
    results->root = cJSON_ParseWithLengthOpts(text, size, &end, 0);
    if (results->root != NULL)
        end += strspn(end, " \t\r\n");
    if (results->root == NULL || end != text + size) {
        status = bb_fail(BB_INVALID, "result file %s is not JSON or truncated: error at byte %zu",
                         path, end != NULL ? (size_t)(end - text) : 0);
        goto out;
    }
    status = check_document(path, results->root);
    if (status == BB_OK && !complete(results))
        status = bb_fail(BB_FAILED, "result file %s: no memory", path);
    if (status != BB_OK)
        goto out;
    *out = results;
    results = NULL;
out:
    bb_results_destroy(results);
    free(text);
    return status;
}
