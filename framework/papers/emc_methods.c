/* Extended Morton codes inside other builders: figures of one code over another. */
#include "framework/papers/emc_methods.h"

#include <math.h>

#define METHOD_OF(id, name, builder, rest)                                                         \
    [id] = {name, EMC_WITH_CODE(builder, "mc64", rest), EMC_WITH_CODE(builder, "emc64-var", rest), \
            EMC_WITH_BOX(builder, "mc64", "centroids", rest),                                      \
            EMC_WITH_BOX(builder, "emc64-var", "centroids", rest)},

const bb_emc_method bb_emc_methods[EMC_METHOD_COUNT] = {EMC_METHODS(METHOD_OF)};
const char *const bb_emc_rays[EMC_INSIDE_KINDS] = {"primary", "diffuse", "shadow", "random"};

/* The experiment, but only the traces that the figure is of. */
static bb_findings findings_of(const bb_findings *all, bb_emc_figure figure)
{
    bb_findings f = all[EMC_INSIDE];
    f.rays = figure.rays;
    return f;
}

static bool is_time(bb_emc_figure figure)
{
    return figure.what == EMC_TIME || figure.what == EMC_BUILD;
}

static bb_times times_of(bb_emc_figure figure)
{
    return figure.what == EMC_BUILD ? BB_BUILD_TIME : BB_TRACE_TIME;
}

static bb_selection cell_of(const char *scene, const char *builder)
{
    return (bb_selection){scene, builder, "stack", NULL};
}

bb_estimate bb_emc_ratio(const bb_findings *all, bb_emc_figure figure, const char *scene,
                         const char *builder, const char *base)
{
    bb_findings f = findings_of(all, figure);
    bb_selection cell = cell_of(scene, builder), other = cell_of(scene, base);
    bb_estimate e = bb_not_measured;
    if (is_time(figure))
        return bb_found_ratio(&f, times_of(figure), cell, other);
    e.value = figure.what == EMC_COST
                  ? bb_found_sah(&f, scene, builder) / bb_found_sah(&f, scene, base)
                  : bb_found_work(&f, cell) / bb_found_work(&f, other);
    return e;
}

bb_paper_figures bb_emc_ratios(const bb_findings *all, bb_emc_figure figure, const char *builder,
                               const char *base)
{
    bb_paper_figures s = {.f = &all[EMC_INSIDE]};
    for (size_t i = 0; i < s.f->scene_count; i++)
        s.values[i] = bb_emc_ratio(all, figure, s.f->scenes[i], builder, base).value;
    return s;
}

bb_estimate bb_emc_mean(const bb_findings *all, bb_emc_figure figure, const char *builder,
                        const char *base)
{
    if (!is_time(figure)) {
        bb_paper_figures s = bb_emc_ratios(all, figure, builder, base);
        bb_estimate e = bb_not_measured;
        e.value = bb_figures_mean(&s);
        return e;
    }
    bb_findings f = findings_of(all, figure);
    return bb_found_mean_ratio(&f, times_of(figure), "stack", builder, base);
}

bb_paper_figures bb_emc_centred(const bb_findings *all, int method)
{
    const bb_emc_method *m = &bb_emc_methods[method];
    bb_paper_figures s = {.f = &all[EMC_CENTRED]};
    for (size_t i = 0; i < s.f->scene_count; i++)
        s.values[i] = bb_found_sah(s.f, s.f->scenes[i], m->centred_var) /
                      bb_found_sah(s.f, s.f->scenes[i], m->centred_plain);
    return s;
}

bb_paper_figures bb_emc_placement(const bb_findings *all, int method)
{
    const bb_emc_method *m = &bb_emc_methods[method];
    bb_paper_figures s = {.f = &all[EMC_CENTRED]};
    for (size_t i = 0; i < s.f->scene_count; i++)
        s.values[i] = bb_found_sah(s.f, s.f->scenes[i], m->centred_plain) /
                      bb_found_sah(&all[EMC_INSIDE], s.f->scenes[i], m->plain);
    return s;
}

bb_paper_figures bb_emc_over_sweep(const bb_findings *all, const char *builder)
{
    bb_paper_figures s = {.f = &all[EMC_INSIDE]};
    for (size_t i = 0; i < s.f->scene_count; i++)
        s.values[i] = bb_found_sah(s.f, s.f->scenes[i], builder) /
                      bb_found_sah(&all[EMC_CENTRED], s.f->scenes[i], EMC_SWEEP);
    return s;
}

bb_claim_verdict bb_emc_below(bb_emc_figure figure, bb_estimate e, double bound)
{
    return is_time(figure) ? bb_below(e, bound) : bb_verdict_of(e.value < bound, e.value, 0);
}

bool bb_emc_missing(const char *builder, bb_words *words)
{
    char name[64];
    if (!bb_missing_stage(builder, name, sizeof name))
        return false;
    bb_say(words, "%sno such builder: %s", words->length > 0 ? "; " : "", name);
    return true;
}
