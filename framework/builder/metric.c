/* The table of metrics. */
#include "framework/builder/metric.h"

#include "framework/base/suggest.h"

#include <math.h>
#include <string.h>

uint32_t bb_metric_count(void)
{
    uint32_t count = 0;
    while (bb_metrics[count] != NULL)
        count++;
    return count < BB_METRICS_MAX ? count : BB_METRICS_MAX;
}

uint32_t bb_metric_find(const char *name)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        if (strcmp(bb_metrics[i]->name, name) == 0)
            return i;
    return BB_NONE;
}

uint32_t bb_metric_of_layouts(void)
{
    uint32_t i = 0;
    while (!bb_metrics[i]->of_layouts)
        i++;
    return i;
}

bb_status bb_metric_check(const char *name)
{
    bb_suggestion meant = {.word = name};
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        bb_suggest(&meant, bb_metrics[i]->name);
    if (bb_metric_find(name) != BB_NONE)
        return BB_OK;
    return bb_fail(BB_INVALID, "unknown metric '%s'%s: `bvhbench list metrics` shows them", name,
                   bb_suggested(&meant));
}

bb_status bb_metric_compute(const bb_metric *metric, const bb_tree *tree, const bb_scene *scene,
                            uint64_t samples, uint64_t seed, bb_metric_value *out)
{
    *out = (bb_metric_value){NAN, NAN};
    if (samples == 0)
        return bb_fail(BB_INVALID, "%s by 0 points: take at least 1", metric->title);
    return metric->compute(tree, scene, samples, seed, &out->value, &out->half);
}
