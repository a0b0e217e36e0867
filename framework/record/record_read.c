/* Writes result files, and reads them with all checks of the schema.
 *
 * A file may be truncated or hostile. The type of every field that the report uses is checked here,
 * once, so that no other code has to.
 */
#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A result file of a million rows has about 1.5 GB: too many for a report. */
enum { RESULTS_BYTES_MAX = 256 << 20, BUILDS_MAX = 1 << 20 };

/* ---- writing ---- */

/* Rewrites numbers with as many digits as give the same double back. cJSON itself takes 15 digits
 * if they are right to within a rounding error. */
static bool exact_numbers(cJSON *item)
{
    for (; item != NULL; item = item->next) {
        if (item->child != NULL && !exact_numbers(item->child))
            return false;
        if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
            continue;
        char text[BB_JSON_DIGITS];
        bb_json_digits(text, item->valuedouble);
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
        text = bb_json_print(copy, formatted);
    cJSON_Delete(copy);
    return text;
}

bb_status bb_results_write(const bb_results *results, const char *path)
{
    char *text = bb_results_print(results, true);
    if (text == NULL)
        return bb_fail(BB_FAILED, "result file %s: no memory", path);
    size_t size = strlen(text);
    text[size] = '\n'; /* replaces the 0: bb_file_write() takes a size */
    bb_status status = bb_file_write(path, text, size + 1, "result file");
    cJSON_free(text);
    return status;
}

/* ---- reading ---- */

static bool has_negative(const cJSON *item)
{
    const cJSON *child;
    if (cJSON_IsNumber(item) && item->valuedouble < 0)
        return true;
    cJSON_ArrayForEach(child, item)
    {
        if (has_negative(child))
            return true;
    }
    return false;
}

/* Returns whether the field is a time or a rate, which must not be negative. */
static bool is_time(const bb_field *field)
{
    size_t length = strlen(field->unit);
    return strcmp(field->unit, "ms") == 0 ||
           (length > 2 && strcmp(field->unit + length - 2, "/s") == 0);
}

/* Checks the fields of an object. `index` < 0: it is no element of an array. */
static bb_status check_fields(const char *path, const char *section, int index, const cJSON *object,
                              bb_field_part part)
{
    char place[64];
    snprintf(place, sizeof place, index < 0 ? "%s" : "%s[%d]", section, index);
    if (!cJSON_IsObject(object))
        return bb_fail(BB_INVALID, "result file %s: %s is not an object", path, place);
    for (const bb_field *f = bb_fields; f < bb_fields + BB_FIELDS; f++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, f->name);
        if (f->part == part && !bb_json_is(item, f->types))
            return bb_fail(BB_INVALID, "result file %s: %s: \"%s\" %s", path, place, f->name,
                           item == NULL ? "is missing" : "has the wrong type");
        if (f->part == part && is_time(f) && has_negative(item))
            return bb_fail(BB_INVALID, "result file %s: %s: \"%s\" is negative", path, place,
                           f->name);
    }
    return BB_OK;
}

/* Checks a metric's figures, if the file has them. */
static bb_status check_metrics(const char *path, const char *place, const cJSON *tree)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        char half[BB_METRIC_FIELD];
        bb_metric_half_name(bb_metrics[i], half);
        const char *const names[] = {bb_metrics[i]->name, half};
        for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
            if (!bb_json_is(cJSON_GetObjectItemCaseSensitive(tree, names[k]),
                            BB_JSON_NUMBER | BB_JSON_NONE))
                return bb_fail(BB_INVALID, "result file %s: %s: \"%s\" has the wrong type", path,
                               place, names[k]);
    }
    return BB_OK;
}

/* Checks each element of the array `section`, and its member `inner` ("": none) if that is an
 * object.
 */
static bb_status check_section(const char *path, const cJSON *root, const char *section,
                               bool required, bb_field_part part, const char *inner,
                               bb_field_part inner_part)
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
        BB_TRY(check_fields(path, section, index, item, part));
        const cJSON *object = cJSON_GetObjectItemCaseSensitive(item, inner);
        if (cJSON_IsObject(object)) {
            char place[64];
            snprintf(place, sizeof place, "%s[%d].%s", section, index, inner);
            BB_TRY(check_fields(path, place, -1, object, inner_part));
            if (inner_part == BB_IN_TREE)
                BB_TRY(check_metrics(path, place, object));
        }
        index++;
    }
    return BB_OK;
}

/* Checks that rows have numbers, texts and nulls, one for each column. */
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
                               path, bb_get_text(reproduction, BB_F_PAPER_NAME), columns);
        }
    }
    return BB_OK;
}

static bb_status check_reproductions(const char *path, const cJSON *root)
{
    BB_TRY(check_section(path, root, "reproductions", false, BB_IN_PAPER, "", 0));
    const cJSON *reproduction;
    cJSON_ArrayForEach(reproduction, cJSON_GetObjectItemCaseSensitive(root, "reproductions"))
    {
        BB_TRY(check_section(path, reproduction, "tables", false, BB_IN_TABLE, "", 0));
        BB_TRY(check_section(path, reproduction, "claims", false, BB_IN_CLAIM, "", 0));
    }
    return check_rows(path, root);
}

/* Checks that ids of builds are below 2^20 and unique, and that every trace names an existing one.
 */
static bb_status check_ids(const char *path, const cJSON *root)
{
    bool *known = calloc(BUILDS_MAX, sizeof *known);
    if (known == NULL)
        return bb_fail(BB_FAILED, "result file %s: no memory", path);
    bb_status status = BB_OK;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, "builds"))
    {
        double id = bb_get_number(item, BB_F_BUILD_ID);
        if (!(id >= 0 && id < BUILDS_MAX && id == floor(id)) || known[(uint32_t)id]) {
            status = bb_fail(BB_INVALID, "result file %s: build id %g is given twice or no id",
                             path, id);
            goto out;
        }
        known[(uint32_t)id] = true;
    }
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, "traces"))
    {
        double id = bb_get_number(item, BB_F_TRACE_BUILD);
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

/* Checks that the file has the scene of each build and each trace. */
static bb_status check_scene_names(const char *path, const bb_results *results)
{
    static const struct {
        const char *section;
        bb_field_id scene;
    } parts[] = {{"builds", BB_F_BUILD_SCENE}, {"traces", BB_F_TRACE_SCENE}};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const cJSON *item;
        int index = 0;
        cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(results->root, parts[i].section))
        {
            const char *scene = bb_get_text(item, parts[i].scene);
            if (bb_results_scene(results, scene) == NULL)
                return bb_fail(BB_INVALID,
                               "result file %s: %s[%d] names scene '%.100s', which is missing",
                               path, parts[i].section, index, scene);
            index++;
        }
    }
    return BB_OK;
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
                        BB_IN_CONTEXT));
    BB_TRY(check_section(path, root, "scenes", true, BB_IN_SCENE, "profile", BB_IN_PROFILE));
    BB_TRY(check_section(path, root, "builds", true, BB_IN_BUILD, "tree", BB_IN_TREE));
    BB_TRY(check_section(path, root, "traces", true, BB_IN_TRACE, "accuracy", BB_IN_ACCURACY));
    BB_TRY(check_section(path, root, "skipped", true, BB_IN_SKIPPED, "", 0));
    BB_TRY(check_section(path, root, "pictures", true, BB_IN_PICTURE, "", 0));
    BB_TRY(check_section(path, root, "predictions", false, BB_IN_PREDICTION, "", 0));
    BB_TRY(check_section(path, root, "merged", false, BB_IN_CONTEXT, "", 0));
    BB_TRY(check_reproductions(path, root));
    static const struct {
        const char *name;
        unsigned types;
    } times[] = {{"steps_ms", BB_JSON_FIGURES}, {"time_ms", BB_JSON_FIGURES | BB_JSON_NONE}};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        if (!bb_json_is(cJSON_GetObjectItemCaseSensitive(root, times[i].name), times[i].types))
            return bb_fail(BB_INVALID, "result file %s: \"%s\" is missing or has the wrong type",
                           path, times[i].name);
    }
    return check_ids(path, root);
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
    const char *fault = results->root != NULL ? bb_json_fault(text) : NULL;
    end = fault != NULL ? fault : end;
    if (results->root == NULL || end != text + size) {
        status = bb_fail(BB_INVALID, "result file %s is not JSON or truncated: error at byte %zu",
                         path, end != NULL ? (size_t)(end - text) : 0);
        goto out;
    }
    status = check_document(path, results->root);
    if (status == BB_OK)
        status = check_scene_names(path, results);
    if (status != BB_OK)
        goto out;
    *out = results;
    results = NULL;
out:
    bb_results_destroy(results);
    free(text);
    return status;
}
