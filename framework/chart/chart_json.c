/* The charts' cells as JSON, for the report's page. */
#include "framework/base/json.h"
#include "framework/chart/chart.h"

#include <cjson/cJSON.h>
#include <math.h>

typedef struct named_number {
    const char *name;
    double value;
} named_number;

static bool put_numbers(cJSON *object, const named_number *members, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        cJSON *added = isfinite(members[i].value)
                           ? cJSON_AddNumberToObject(object, members[i].name, members[i].value)
                           : cJSON_AddNullToObject(object, members[i].name);
        if (added == NULL)
            return false;
    }
    return true;
}

static bool put_cell(cJSON *array, const bb_chart_cell *cell)
{
    const named_number members[] = {
        {"trace", cell->trace_index},
        {"views", cell->views},
        {"count", cell->count},
        {"rays", cell->rays},
        {"ms", cell->ms},
        {"mrays_s", cell->mrays_s},
        {"mrays_s_lo", cell->mrays_s_lo},
        {"mrays_s_hi", cell->mrays_s_hi},
        {"mrays_s_least", cell->mrays_s_least},
        {"mrays_s_most", cell->mrays_s_most},
        {"checked", cell->checked},
        {"wrong_rays", cell->wrong_rays},
        {"missed", cell->missed},
        {"false", cell->false_hits},
        {"wrong_t", cell->wrong_t},
        {"ppm", cell->wrong.ppm},
        {"ppm_lo", cell->wrong.low},
        {"ppm_hi", cell->wrong.high},
        {"fixed_ms", cell->fixed_ms},
    };
    cJSON *object = cJSON_CreateObject();
    bool ok = object != NULL && put_numbers(object, members, sizeof members / sizeof members[0]) &&
              cJSON_AddBoolToObject(object, "reference", cell->reference) != NULL &&
              cJSON_AddBoolToObject(object, "usable", cell->usable) != NULL;
    cJSON *metrics = ok ? cJSON_AddObjectToObject(object, "metrics") : NULL;
    for (uint32_t i = 0; i < bb_metric_count() && ok; i++) {
        const named_number metric = {bb_metrics[i]->name, cell->metrics[i]};
        ok = metrics != NULL && put_numbers(metrics, &metric, 1);
    }
    if (ok && cJSON_AddItemToArray(array, object))
        return true;
    cJSON_Delete(object);
    return false;
}

static bool put_set(cJSON *array, const bb_chart_set *set)
{
    const named_number members[] = {{"views", set->views}, {"incomplete", set->incomplete}};
    cJSON *object = cJSON_CreateObject();
    if (object == NULL || !cJSON_AddItemToArray(array, object)) {
        cJSON_Delete(object);
        return false;
    }
    bool ok = cJSON_AddStringToObject(object, "scene", set->scene) != NULL &&
              cJSON_AddStringToObject(object, "rays", set->rays) != NULL &&
              (set->view != NULL ? cJSON_AddStringToObject(object, "view", set->view)
                                 : cJSON_AddNullToObject(object, "view")) != NULL &&
              put_numbers(object, members, sizeof members / sizeof members[0]);
    cJSON *cells = ok ? cJSON_AddArrayToObject(object, "cells") : NULL;
    ok = cells != NULL;
    for (uint32_t i = 0; ok && i < set->cell_count; i++)
        ok = put_cell(cells, &set->cells[i]);
    return ok;
}

char *bb_charts_json(const bb_charts *charts)
{
    cJSON *sets = cJSON_CreateArray();
    bool ok = sets != NULL;
    for (uint32_t i = 0; ok && i < charts->set_count; i++)
        ok = put_set(sets, &charts->sets[i]);
    char *json = ok ? bb_json_print(sets, false) : NULL;
    cJSON_Delete(sets);
    return json;
}
