/* What the tables and the claims of the extended Morton codes share: the codes' names, and figures
 * of them. */
#ifndef BB_EMC_FIGURES_H
#define BB_EMC_FIGURES_H

#include "framework/papers/reproduce.h"

/* The paper cuts the scene's box into cells (algorithm 1), not that of the centroids. */
#define MC64 "emc:code=mc64,box=scene"
#define MC32 "emc:code=mc32,box=scene"
#define SORT64 "emc:code=emc64-sort,box=scene"
#define SORT32 "emc:code=emc32-sort,box=scene"
#define VAR64 "emc:code=emc64-var,box=scene"
#define VAR32 "emc:code=emc32-var,box=scene"
#define CELL64 "emc:code=emc64-cell,box=scene" /* not in the paper */
#define CELL64_SIDE CELL64 ",measure=side"
#define CODES MC64 "," SORT64 "," VAR64 "," CELL64 "," MC32 "," SORT32 "," VAR32
#define ORDER "emc:code=mc64,box=scene,axes=extent"
#define ORDER_COUNT "emc:code=mc64,box=scene,axes=extent,count=variable"
#define SIZES "emc:code=mc64,box=scene,bits=64,every=4,size-bits=16"
#define FEWER_SIZES "emc:code=mc64,box=scene,bits=64,every=7,size-bits=6,size=root"
#define VAR64_ALL_SIZES "emc:code=emc64-var,box=scene,every=4,size-bits=16,size=linear"
#define VAR64_CELL_ALL "emc:code=emc64-var,box=scene,every=4,size-bits=16,size=cell"
#define VAR64_CELL_TEN "emc:code=emc64-var,box=scene,every=4,size-bits=10,size=cell"
#define VAR64_NINE "emc:code=emc64-var,box=scene,size-bits=9"
#define VAR32_ALL_SIZES "emc:code=emc32-var,box=scene,every=4,size-bits=8,size=linear"
#define VAR64_AREA "emc:code=emc64-var,box=scene,measure=area"
#define SORT64_AREA "emc:code=emc64-sort,box=scene,measure=area"
#define SWEEP "sah:method=sweep"

/* Experiments, in order. */
enum { TRACED, BUILT, VARIED, SIZED, INSIDE, CENTRED };

/* Codes and the plain ones of equal length. */
static const struct {
    const char *builder, *plain;
} equals[] = {{SORT64, MC64}, {VAR64, MC64}, {CELL64, MC64}, {SORT32, MC32}, {VAR32, MC32}};
enum { EQUALS = sizeof equals / sizeof equals[0] };
/* of the ratio of their build times */
static const double build_target = 1.05;

/* Cost over that of `base`. */
static inline double cost_ratio(const bb_findings *all, const char *scene, const char *builder,
                                const char *base)
{
    return bb_found_sah(&all[VARIED], scene, builder) / bb_found_sah(&all[VARIED], scene, base);
}

/* The same for each scene. */
static inline bb_figures costs(const bb_findings *all, const char *builder, const char *base)
{
    bb_figures s = {.f = &all[VARIED]};
    for (size_t i = 0; i < s.f->scene_count; i++)
        s.values[i] = cost_ratio(all, s.f->scenes[i], builder, base);
    return s;
}

/* Rays per second over those of `base`. */
static inline bb_estimate speed_ratio(const bb_findings *all, const char *scene,
                                      const char *builder, const char *base)
{
    return bb_found_ratio(&all[TRACED], BB_TRACE_TIME, (bb_selection){scene, base, "stack", NULL},
                          (bb_selection){scene, builder, "stack", NULL});
}

/* Build time over that of `base`. */
static inline bb_estimate build_ratio(const bb_findings *all, const char *scene,
                                      const char *builder, const char *base)
{
    return bb_found_ratio(&all[BUILT], BB_BUILD_TIME, (bb_selection){scene, builder, NULL, NULL},
                          (bb_selection){scene, base, NULL, NULL});
}

/* The claims on LBVH. */
void bb_emc_claims(const bb_findings *all, bb_reproduction *r);

#endif
