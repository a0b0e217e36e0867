/* Extended Morton codes: figures of one code over another. */
#include "framework/papers/emc_figures.h"

const bb_emc_equal bb_emc_equals[EMC_EQUALS] = {{EMC_SORT64, EMC_MC64},
                                                {EMC_VAR64, EMC_MC64},
                                                {EMC_CELL64, EMC_MC64},
                                                {EMC_SORT32, EMC_MC32},
                                                {EMC_VAR32, EMC_MC32}};
const double bb_emc_build_target = 1.05;

double bb_emc_cost_ratio(const bb_findings *all, const char *scene, const char *builder,
                         const char *base)
{
    return bb_found_sah(&all[EMC_VARIED], scene, builder) /
           bb_found_sah(&all[EMC_VARIED], scene, base);
}

bb_paper_figures bb_emc_costs(const bb_findings *all, const char *builder, const char *base)
{
    bb_paper_figures s = {.f = &all[EMC_VARIED]};
    for (size_t i = 0; i < s.f->scene_count; i++)
        s.values[i] = bb_emc_cost_ratio(all, s.f->scenes[i], builder, base);
    return s;
}

bb_estimate bb_emc_speed_ratio(const bb_findings *all, const char *scene, const char *builder,
                               const char *base)
{
    return bb_found_ratio(&all[EMC_TRACED], BB_TRACE_TIME,
                          (bb_selection){scene, base, "stack", NULL},
                          (bb_selection){scene, builder, "stack", NULL});
}

bb_estimate bb_emc_build_ratio(const bb_findings *all, const char *scene, const char *builder,
                               const char *base)
{
    return bb_found_ratio(&all[EMC_BUILT], BB_BUILD_TIME,
                          (bb_selection){scene, builder, NULL, NULL},
                          (bb_selection){scene, base, NULL, NULL});
}
