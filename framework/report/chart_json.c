/* The charts' cells as JSON, for the report's page. */
#include "framework/base/json.h"
#include "framework/report/chart.h"

static void put_cell(bb_json *json, const bb_charts *charts, const bb_chart_cell *cell)
{
    const struct {
        const char *name;
        double value;
    } members[] = {
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
    bb_json_object(json, NULL);
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
        bb_json_add_number(json, members[i].name, members[i].value);
    bb_json_add_bool(json, "reference", cell->reference);
    bb_json_add_bool(json, "usable", cell->usable);
    bb_json_object(json, "metrics");
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        bb_json_add_number(json, bb_metrics[i]->name, cell->metrics[i]);
    bb_json_add_number(json, bb_fields[BB_F_TRACE_WORK].name, cell->work);
    for (uint32_t i = 0; i < charts->simulation_count; i++)
        bb_json_add_number(json, charts->simulations[i], cell->simulated[i]);
    bb_json_end_object(json);
    bb_json_end_object(json);
}

char *bb_charts_json(const bb_charts *charts)
{
    bb_json json = {0};
    bb_json_array(&json, NULL);
    for (const bb_chart_set *set = charts->sets; set < charts->sets + charts->set_count; set++) {
        bb_json_object(&json, NULL);
        bb_json_add_text(&json, "scene", set->scene);
        bb_json_add_text(&json, "rays", set->rays);
        bb_json_add_text(&json, "view", set->view);
        bb_json_add_number(&json, "views", set->views);
        bb_json_add_number(&json, "incomplete", set->incomplete);
        bb_json_array(&json, "cells");
        for (uint32_t i = 0; i < set->cell_count; i++)
            put_cell(&json, charts, &set->cells[i]);
        bb_json_end_array(&json);
        bb_json_end_object(&json);
    }
    bb_json_end_array(&json);
    return bb_json_take(&json);
}
