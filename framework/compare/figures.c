#include "framework/compare/figures.h"

#include "framework/record/schema.h"

#include <stdio.h>
#include <string.h>

static const bb_field_id costs[] = {BB_F_TREE_BYTES, BB_F_TREE_BYTES_PEAK, BB_F_TRACE_NODE_TESTS,
                                    BB_F_TRACE_PRIM_TESTS};
static const bb_field_id wrongs[] = {BB_F_TRACE_UNLIKE,       BB_F_ACCURACY_MISSED,
                                     BB_F_ACCURACY_FALSE,     BB_F_ACCURACY_WRONG_T,
                                     BB_F_ACCURACY_UNWRITTEN, BB_F_ACCURACY_OVERFLOWED};

static const bb_field_id judgements[] = {BB_F_ACCURACY_CHECKED, BB_F_ACCURACY_MISSED,
                                         BB_F_ACCURACY_FALSE, BB_F_ACCURACY_WRONG_T,
                                         BB_F_ACCURACY_UNWRITTEN};

static bool is_one_of(const char *name, const bb_field_id *fields, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(name, bb_fields[fields[i]].name) == 0)
            return true;
    return false;
}

bool bb_figure_is_wrong(const char *name)
{
    return is_one_of(name, wrongs, sizeof wrongs / sizeof wrongs[0]);
}

bool bb_figure_is_judgement(const char *name)
{
    return is_one_of(name, judgements, sizeof judgements / sizeof judgements[0]);
}

bool bb_figure_is_judged(const char *name)
{
    return is_one_of(name, judgements, 1);
}

/* Metrics of trees are costs; those of layouts have the layout's name after a blank. */
bb_figure_sense bb_figure_sense_of(const char *name)
{
    if (bb_figure_is_wrong(name) || is_one_of(name, costs, sizeof costs / sizeof costs[0]))
        return BB_FIGURE_LESS_BETTER;
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        char layouts[BB_METRIC_FIELD + 1];
        snprintf(layouts, sizeof layouts, "layouts_%.50s ", bb_metrics[i]->name);
        if (strcmp(name, bb_metrics[i]->name) == 0 || strncmp(name, layouts, strlen(layouts)) == 0)
            return BB_FIGURE_LESS_BETTER;
    }
    return BB_FIGURE_NEUTRAL;
}
