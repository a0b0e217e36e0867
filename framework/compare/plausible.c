/* Warns if a tree costs far more than one by a builder that looks at costs. On ordinary scenes, no
 * builder by Morton codes comes near three times the sweep's SAH. If one does, the tree or the
 * metric has a bug, or the scene is made to defeat it.
 *
 * The trees of all builders are checked, however they are built, except trees of one leaf.
 */
#include "framework/builder/registry.h"
#include "framework/compare/summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double implausible_ratio = 3;
enum { NAMED = 4 };

static double sah_of(const bb_entry *build)
{
    bool tree = bb_is_ok(build) && !bb_get_true(build, BB_F_BUILD_REFERENCE) &&
                bb_get_number(build, BB_F_TREE_NODES) > 1;
    return tree ? bb_get_metric(build, bb_metrics[bb_metric_of_layouts()]) : (double)NAN;
}

/* Returns whether the build has the parameters of the specification. Others do not matter. */
static bool has_params(const bb_entry *build, const bb_spec *spec)
{
    for (uint32_t i = 0; i < spec->param_count; i++)
        if (strcmp(bb_get_named_text(build, BB_F_BUILD_PARAMS, spec->keys[i]), spec->values[i]) !=
            0)
            return false;
    return true;
}

/* Returns how near a builder is to the reference of costs (BB_ROLE_COST_REFERENCE): 2 for this
 * variant itself, 1 for other variants of its builder, 0 for other builders, whose cheapest tree is
 * taken if there is nothing nearer. */
static int nearness(const bb_entry *build)
{
    bb_spec stages[BB_STAGES_MAX], reference;
    uint32_t count;
    if (bb_spec_stages(bb_get_text(build, BB_F_BUILD_BUILDER), stages, BB_STAGES_MAX, &count) !=
            BB_OK ||
        count != 1)
        return 0;
    const bb_builder *builder = bb_builder_find(stages[0].name);
    const char *held_to =
        builder != NULL ? bb_builder_variants(builder, BB_ROLE_COST_REFERENCE) : NULL;
    if (held_to == NULL)
        return 0;
    bool parsed = bb_spec_parse(held_to, &reference) == BB_OK;
    return parsed && has_params(build, &reference) ? 2 : 1;
}

/* Returns the build with which trees of the scene of `like` are compared; NULL if there is none.
 * Runs of a merged document have the same scenes. */
static const bb_entry *yardstick(const bb_section *builds, const bb_entry *like)
{
    const bb_entry *best = NULL;
    bb_each(build, builds)
    {
        double sah = sah_of(build);
        if (!(sah > 0) || !bb_same_text(build, like, BB_F_BUILD_SCENE))
            continue;
        int nearer = best != NULL ? nearness(build) - nearness(best) : 1;
        if (nearer > 0 || (nearer == 0 && sah < sah_of(best)))
            best = build;
    }
    return best;
}

bool bb_summary_implausible(const bb_results *results, char text[BB_IMPLAUSIBLE])
{
    const bb_section *builds = bb_results_section(results, BB_BUILDS);
    uint32_t found = 0;
    size_t length = 0;
    text[0] = '\0';
    bb_each(build, builds)
    {
        double sah = sah_of(build);
        const bb_entry *best = sah > 0 ? yardstick(builds, build) : NULL;
        if (best == NULL || !(sah > implausible_ratio * sah_of(best)))
            continue;
        if (found++ < NAMED && length < BB_IMPLAUSIBLE)
            length +=
                (size_t)snprintf(text + length, BB_IMPLAUSIBLE - length,
                                 "%s%.60s on %.60s has %.3g times that of %.40s",
                                 found > 1 ? "; " : "SAH: ", bb_get_text(build, BB_F_BUILD_BUILDER),
                                 bb_get_text(build, BB_F_BUILD_SCENE), sah / sah_of(best),
                                 bb_get_text(best, BB_F_BUILD_BUILDER));
    }
    if (found > NAMED && length < BB_IMPLAUSIBLE)
        length += (size_t)snprintf(text + length, BB_IMPLAUSIBLE - length, "; and %u more",
                                   found - NAMED);
    if (found > 0 && length < BB_IMPLAUSIBLE)
        snprintf(
            text + length, BB_IMPLAUSIBLE - length,
            ": above 3 times, the tree or the metric is wrong, or the scene defeats the method");
    return found > 0;
}
