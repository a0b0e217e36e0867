/* The table of fields as data, and look-ups in the document. */
#include "framework/record/schema.h"

#include "framework/base/json.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The short forms of fields.h. */
enum {
    TEXT = BB_JSON_TEXT,
    NUMBER = BB_JSON_NUMBER,
    BOOLEAN = BB_JSON_BOOLEAN,
    OBJECT = BB_JSON_OBJECT,
    NUMBERS = BB_JSON_NUMBERS,
    TEXTS = BB_JSON_TEXTS,
    FIGURES = BB_JSON_FIGURES,
    NONE = BB_JSON_NONE,
};

const bb_field bb_fields[BB_FIELDS] = {
#define FIELD(id, part, name, unit, types, writer, format, heading, help)                          \
    [BB_F_##id] = {BB_IN_##part, name, unit, types, BB_##format, heading, help},
#include "framework/record/fields.h"
};

/* ---- types ---- */

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

bool bb_json_is(const cJSON *item, unsigned types)
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

/* ---- entries ---- */

const bb_entry *bb_first(const bb_section *section)
{
    return section != NULL ? section->child : NULL;
}

const bb_entry *bb_next(const bb_entry *entry)
{
    return entry->next;
}

uint32_t bb_section_count(const bb_section *section)
{
    return (uint32_t)cJSON_GetArraySize(section);
}

const char *bb_part_name(const bb_entry *part)
{
    return part->string;
}

double bb_part_number(const bb_entry *part)
{
    return cJSON_IsNumber(part) ? part->valuedouble : (double)NAN;
}

const bb_entry *bb_first_part(const bb_entry *entry, bb_field_id field)
{
    return bb_first(bb_get(entry, field));
}

/* ---- look-ups ---- */

const cJSON *bb_get(const cJSON *entry, bb_field_id field)
{
    static const bb_field_id outer[BB_PARTS] = {[BB_IN_PROFILE] = BB_F_SCENE_PROFILE,
                                                [BB_IN_TREE] = BB_F_BUILD_TREE,
                                                [BB_IN_ACCURACY] = BB_F_TRACE_ACCURACY};
    const bb_field *f = &bb_fields[field];
    if (outer[f->part] != 0)
        entry = cJSON_GetObjectItemCaseSensitive(entry, bb_fields[outer[f->part]].name);
    return cJSON_GetObjectItemCaseSensitive(entry, f->name);
}

const char *bb_get_text(const cJSON *entry, bb_field_id field)
{
    const cJSON *item = bb_get(entry, field);
    return cJSON_IsString(item) ? item->valuestring : "";
}

double bb_get_number(const cJSON *entry, bb_field_id field)
{
    const cJSON *item = bb_get(entry, field);
    return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

bool bb_get_true(const cJSON *entry, bb_field_id field)
{
    return cJSON_IsTrue(bb_get(entry, field));
}

double bb_get_named(const cJSON *entry, bb_field_id field, const char *name)
{
    return bb_json_number(bb_get(entry, field), name);
}

const char *bb_get_named_text(const bb_entry *entry, bb_field_id field, const char *name)
{
    return bb_json_text(bb_get(entry, field), name);
}

double bb_first_ray_ms(const cJSON *build, const char *layout)
{
    double boxes = bb_get_number(build, BB_F_BUILD_BOXES_MS);
    double transfer = bb_get_number(build, BB_F_BUILD_TRANSFER_MS);
    double layout_ms = bb_get_true(build, BB_F_BUILD_REFERENCE)
                           ? 0
                           : bb_get_named(build, BB_F_BUILD_LAYOUTS_MS, layout);
    return bb_get_number(build, BB_F_BUILD_MS_MEDIAN) + layout_ms + (isfinite(boxes) ? boxes : 0) +
           (isfinite(transfer) ? transfer : 0);
}

bool bb_get_samples(const cJSON *entry, bb_field_id field, bb_samples *samples)
{
    const cJSON *array = bb_get(entry, field), *item;
    int count = cJSON_GetArraySize(array);
    *samples = (bb_samples){0};
    if (count < 1 || count > BB_SAMPLES_MAX)
        return false;
    cJSON_ArrayForEach(item, array)
    {
        if (!cJSON_IsNumber(item))
            return false;
        bb_samples_add(samples, item->valuedouble);
    }
    return true;
}

/* Finds a decision. Builds, traces and scenes use the same field name. */
static const cJSON *decision(const bb_entry *entry, const char *what)
{
    const cJSON *all = bb_get(entry, BB_F_BUILD_DECISIONS);
    return cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(all, what), "value");
}

const char *bb_get_decision(const bb_entry *entry, const char *what)
{
    const cJSON *value = decision(entry, what);
    return cJSON_IsString(value) ? value->valuestring : "";
}

double bb_get_decided(const bb_entry *entry, const char *what)
{
    const cJSON *value = decision(entry, what);
    return cJSON_IsNumber(value) ? value->valuedouble : (double)NAN;
}

bool bb_same_text(const cJSON *a, const cJSON *b, bb_field_id field)
{
    return strcmp(bb_get_text(a, field), bb_get_text(b, field)) == 0;
}

/* Builds and traces use the same field name. */
bool bb_is_ok(const cJSON *entry)
{
    return strcmp(bb_get_text(entry, BB_F_TRACE_STATUS), "ok") == 0;
}

double bb_run_of(const cJSON *entry)
{
    double run = bb_get_number(entry, BB_F_TRACE_RUN);
    return isfinite(run) ? run : 0;
}

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

/* ---- metrics of trees ---- */

void bb_metric_half_name(const bb_metric *metric, char name[BB_METRIC_FIELD])
{
    snprintf(name, BB_METRIC_FIELD, "%s_half", metric->name);
}

double bb_get_metric(const cJSON *build, const bb_metric *metric)
{
    return bb_get_named(build, BB_F_BUILD_TREE, metric->name);
}

double bb_get_metric_traced(const cJSON *build, const bb_metric *metric, const char *layout)
{
    char layouts[BB_METRIC_FIELD];
    snprintf(layouts, sizeof layouts, "layouts_%s", metric->name);
    double traced = metric->of_layouts
                        ? bb_json_number(cJSON_GetObjectItemCaseSensitive(build, layouts), layout)
                        : (double)NAN;
    return isfinite(traced) ? traced : bb_get_metric(build, metric);
}

bool bb_metric_measured(const cJSON *builds, const bb_metric *metric)
{
    bb_each(build, builds) if (isfinite(bb_get_metric(build, metric))) return true;
    return false;
}

/* ---- for the page ---- */

static const char *const part_names[BB_PARTS] = {
    [BB_IN_CONTEXT] = "context",   [BB_IN_SCENE] = "scene",
    [BB_IN_PROFILE] = "profile",   [BB_IN_BUILD] = "build",
    [BB_IN_TREE] = "tree",         [BB_IN_TRACE] = "trace",
    [BB_IN_ACCURACY] = "accuracy", [BB_IN_SKIPPED] = "skipped",
    [BB_IN_PICTURE] = "picture",   [BB_IN_PREDICTION] = "prediction",
    [BB_IN_PAPER] = "paper",       [BB_IN_TABLE] = "table",
    [BB_IN_CLAIM] = "claim"};
static const char *const format_names[] = {[BB_AS_TEXT] = "text",
                                           [BB_AS_FIGURE] = "figure",
                                           [BB_AS_WHOLE] = "whole",
                                           [BB_AS_BYTES] = "bytes",
                                           [BB_AS_PAIRS] = "pairs"};

static bool add_field(cJSON *root, const bb_field *f)
{
    cJSON *part = cJSON_GetObjectItemCaseSensitive(root, part_names[f->part]);
    if (part == NULL)
        part = cJSON_AddObjectToObject(root, part_names[f->part]);
    cJSON *field = part != NULL ? cJSON_AddObjectToObject(part, f->name) : NULL;
    return field != NULL && cJSON_AddStringToObject(field, "heading", f->heading) != NULL &&
           cJSON_AddStringToObject(field, "unit", f->unit) != NULL &&
           cJSON_AddStringToObject(field, "format", format_names[f->format]) != NULL &&
           (f->help == NULL || cJSON_AddStringToObject(field, "help", f->help) != NULL);
}

static bool add_metric(cJSON *list, const bb_metric *metric)
{
    char half[BB_METRIC_FIELD];
    bb_metric_half_name(metric, half);
    cJSON *entry = cJSON_CreateObject();
    if (entry != NULL && cJSON_AddStringToObject(entry, "name", metric->name) != NULL &&
        cJSON_AddStringToObject(entry, "title", metric->title) != NULL &&
        cJSON_AddStringToObject(entry, "full_title", metric->full_title) != NULL &&
        cJSON_AddStringToObject(entry, "unit", metric->unit) != NULL &&
        cJSON_AddStringToObject(entry, "summary", metric->summary) != NULL &&
        cJSON_AddBoolToObject(entry, "on_request", metric->on_request) != NULL &&
        cJSON_AddBoolToObject(entry, "of_layouts", metric->of_layouts) != NULL &&
        (!metric->sampled || cJSON_AddStringToObject(entry, "half", half) != NULL) &&
        cJSON_AddItemToArray(list, entry))
        return true;
    cJSON_Delete(entry);
    return false;
}

char *bb_schema_json(void)
{
    cJSON *root = cJSON_CreateObject();
    bool ok = root != NULL;
    for (size_t i = 0; i < BB_FIELDS && ok; i++)
        ok = bb_fields[i].heading == NULL || add_field(root, &bb_fields[i]);
    cJSON *metrics = ok ? cJSON_AddArrayToObject(root, "metrics") : NULL;
    for (uint32_t i = 0; i < bb_metric_count() && ok; i++)
        ok = metrics != NULL && add_metric(metrics, bb_metrics[i]);
    char *json = ok ? bb_json_print(root, false) : NULL;
    cJSON_Delete(root);
    return json;
}
