/* The file of a point: what its child measured. */
#include "framework/stress/point_private.h"

#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/device/device_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_BYTES_MAX = 1 << 24 };

static const struct {
    const char *name;
    size_t offset;
} numbers[] = {
    {"prims", offsetof(bb_point_figures, prims)},
    {"build_ms", offsetof(bb_point_figures, build_ms)},
    {"ray_sets", offsetof(bb_point_figures, ray_sets)},
    {"trace_ms", offsetof(bb_point_figures, trace_ms)},
    {"rays", offsetof(bb_point_figures, rays)},
    {"tests_per_ray", offsetof(bb_point_figures, tests)},
    {"metric", offsetof(bb_point_figures, metric)},
    {"bytes", offsetof(bb_point_figures, bytes)},
    {"wrong", offsetof(bb_point_figures, wrong)},
    {"checked", offsetof(bb_point_figures, checked)},
    {"unlike", offsetof(bb_point_figures, unlike)},
    {"overflowed", offsetof(bb_point_figures, overflowed)},
    {"rebuilt", offsetof(bb_point_figures, rebuilt)},
};

enum { NUMBERS = sizeof numbers / sizeof numbers[0] };

static const double *number_of(const bb_point_figures *f, size_t i)
{
    return (const double *)(const void *)((const char *)f + numbers[i].offset);
}

cJSON *bb_figures_json(const bb_point_figures *f)
{
    cJSON *object = cJSON_CreateObject();
    bool ok = cJSON_AddStringToObject(object, "outcome", bb_outcome_word(f->outcome)) != NULL;
    if (f->outcome != BB_MEASURED)
        ok = ok && cJSON_AddStringToObject(object, "reason", f->reason) != NULL;
    for (size_t i = 0; i < NUMBERS; i++)
        if (isfinite(*number_of(f, i)))
            ok = ok && cJSON_AddNumberToObject(object, numbers[i].name, *number_of(f, i)) != NULL;
    if (ok)
        return object;
    cJSON_Delete(object);
    return NULL;
}

static bool figures_of(const cJSON *object, bb_point_figures *f)
{
    const char *word = cJSON_GetStringValue(cJSON_GetObjectItem(object, "outcome"));
    const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(object, "reason"));
    *f = bb_no_figures(BB_NOT_MEASURED);
    for (uint32_t i = 0; i < BB_OUTCOMES && word != NULL; i++)
        if (strcmp(word, bb_outcome_word((bb_outcome)i)) == 0)
            f->outcome = (bb_outcome)i;
    snprintf(f->reason, sizeof f->reason, "%s", reason != NULL ? reason : "");
    for (size_t i = 0; i < NUMBERS; i++) {
        const cJSON *item = cJSON_GetObjectItem(object, numbers[i].name);
        *(double *)(void *)((char *)f + numbers[i].offset) =
            cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
    }
    return f->outcome != BB_NOT_MEASURED;
}

static cJSON *point_json(const bb_point_work *work, const bb_device *device)
{
    cJSON *root = cJSON_CreateObject();
    bool ok = cJSON_AddStringToObject(root, "device", device != NULL ? device->name : "") != NULL &&
              cJSON_AddStringToObject(root, "driver", device != NULL ? device->driver : "") != NULL;
    cJSON *values = cJSON_AddArrayToObject(root, "values");
    for (uint32_t i = 0; i < work->count && ok; i++) {
        const bb_wish *wish = &work->wishes[i];
        cJSON *methods = cJSON_CreateArray();
        ok = cJSON_AddItemToArray(values, methods);
        for (uint32_t m = 0; m < work->points->method_count && ok; m++)
            if (wish->wanted[m])
                ok = cJSON_AddItemToArray(methods, bb_figures_json(&wish->figures[m]));
    }
    if (ok)
        return root;
    cJSON_Delete(root);
    return NULL;
}

bb_status bb_point_write(const bb_point_work *work, const bb_device *device)
{
    cJSON *root = point_json(work, device);
    char *text = bb_json_print(root, false);
    bb_status status = text == NULL ? bb_fail(BB_FAILED, "point: no memory")
                                    : bb_file_write(work->path, text, strlen(text), "point");
    cJSON_free(text);
    cJSON_Delete(root);
    return status;
}

static bool read_values(const bb_point_work *work, const cJSON *root)
{
    const cJSON *values = cJSON_GetObjectItem(root, "values");
    if (cJSON_GetArraySize(values) != (int)work->count)
        return false;
    for (uint32_t i = 0; i < work->count; i++) {
        const bb_wish *wish = &work->wishes[i];
        const cJSON *item = cJSON_GetArrayItem(values, (int)i);
        item = item != NULL ? item->child : NULL;
        for (uint32_t m = 0; m < work->points->method_count; m++) {
            if (!wish->wanted[m])
                continue;
            if (item == NULL || !figures_of(item, &wish->figures[m]))
                return false;
            item = item->next;
        }
        if (item != NULL)
            return false;
    }
    return true;
}

bb_status bb_point_read(const bb_point_work *work)
{
    char *text;
    size_t size;
    bb_points *p = work->points;
    BB_TRY(bb_file_read(work->path, FILE_BYTES_MAX, "point", &text, &size));
    cJSON *root = cJSON_Parse(text);
    bool whole = read_values(work, root);
    const char *device = cJSON_GetStringValue(cJSON_GetObjectItem(root, "device"));
    const char *driver = cJSON_GetStringValue(cJSON_GetObjectItem(root, "driver"));
    if (whole && device != NULL && driver != NULL && device[0] != '\0') {
        snprintf(p->device, sizeof p->device, "%s", device);
        snprintf(p->driver, sizeof p->driver, "%s", driver);
    }
    cJSON_Delete(root);
    free(text);
    return whole ? BB_OK
                 : bb_fail(BB_INVALID, "point %s: it is damaged: remove it, or its folder",
                           work->path);
}
