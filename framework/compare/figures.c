#include "framework/compare/figures.h"

#include <string.h>

static const bb_field_id costs[] = {BB_F_TREE_BYTES,        BB_F_TREE_BYTES_PEAK,
                                    BB_F_BUILD_LAYOUTS_SAH, BB_F_BUILD_LAYOUTS_BYTES,
                                    BB_F_TRACE_NODE_TESTS,  BB_F_TRACE_PRIM_TESTS};
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

bb_better bb_field_better(bb_field_id field)
{
    const char *name = bb_fields[field].name;
    static const struct {
        bb_field_id field;
        bb_better better;
    } simulated[] = {
#define SIMT(id, member, name, unit, better, heading, help) {BB_F_SIMT_##id, BB_BETTER_##better},
#include "framework/simulate/simt_figures.h"
#define SIMT_BUILD(id, member, name, unit, better, heading, help)                                  \
    {BB_F_SIMT_BUILD_##id, BB_BETTER_##better},
#include "framework/simulate/simt_build_figures.h"
    };
    for (size_t i = 0; i < sizeof simulated / sizeof simulated[0]; i++)
        if (simulated[i].field == field)
            return simulated[i].better;
    return bb_figure_is_wrong(name) || is_one_of(name, costs, sizeof costs / sizeof costs[0])
               ? BB_BETTER_LESS
               : BB_BETTER_NEITHER;
}
