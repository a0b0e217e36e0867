/* What the tables and the claims of the extended Morton codes share: the codes' names, and figures
 * of them. */
#ifndef BB_EMC_FIGURES_H
#define BB_EMC_FIGURES_H

#include "framework/papers/reproduce.h"

/* The paper cuts the scene's box into cells (algorithm 1), not that of the centroids. */
#define EMC_MC64 "emc:code=mc64,box=scene"
#define EMC_MC32 "emc:code=mc32,box=scene"
#define EMC_SORT64 "emc:code=emc64-sort,box=scene"
#define EMC_SORT32 "emc:code=emc32-sort,box=scene"
#define EMC_VAR64 "emc:code=emc64-var,box=scene"
#define EMC_VAR32 "emc:code=emc32-var,box=scene"
#define EMC_CELL64 "emc:code=emc64-cell,box=scene" /* not in the paper */
#define EMC_CELL64_SIDE EMC_CELL64 ",measure=side"
#define EMC_CODES                                                                                  \
    EMC_MC64 "," EMC_SORT64 "," EMC_VAR64 "," EMC_CELL64 "," EMC_MC32 "," EMC_SORT32 "," EMC_VAR32
#define EMC_ORDER "emc:code=mc64,box=scene,axes=extent"
#define EMC_ORDER_COUNT "emc:code=mc64,box=scene,axes=extent,count=variable"
#define EMC_SIZES "emc:code=mc64,box=scene,bits=64,every=4,size-bits=16"
#define EMC_FEWER_SIZES "emc:code=mc64,box=scene,bits=64,every=7,size-bits=6,size=root"
#define EMC_VAR64_ALL_SIZES "emc:code=emc64-var,box=scene,every=4,size-bits=16,size=linear"
#define EMC_VAR64_CELL_ALL "emc:code=emc64-var,box=scene,every=4,size-bits=16,size=cell"
#define EMC_VAR64_CELL_TEN "emc:code=emc64-var,box=scene,every=4,size-bits=10,size=cell"
#define EMC_VAR64_NINE "emc:code=emc64-var,box=scene,size-bits=9"
#define EMC_VAR32_ALL_SIZES "emc:code=emc32-var,box=scene,every=4,size-bits=8,size=linear"
#define EMC_VAR64_AREA "emc:code=emc64-var,box=scene,measure=area"
#define EMC_SORT64_AREA "emc:code=emc64-sort,box=scene,measure=area"
#define EMC_SWEEP "sah:method=sweep"

/* Experiments, in order. */
enum { EMC_TRACED, EMC_BUILT, EMC_VARIED, EMC_SIZED, EMC_INSIDE, EMC_CENTRED };

/* Codes and the plain ones of equal length. */
typedef struct bb_emc_equal {
    const char *builder, *plain;
} bb_emc_equal;
enum { EMC_EQUALS = 5 };
extern const bb_emc_equal bb_emc_equals[EMC_EQUALS];
/* What the ratio of their build times is to be at most. */
extern const double bb_emc_build_target;

/* Figures of `builder` over those of `base`; NAN, or bb_not_measured, where one is missing. */
double bb_emc_cost_ratio(const bb_findings *all, const char *scene, const char *builder,
                         const char *base);
/* The same for each scene. */
bb_paper_figures bb_emc_costs(const bb_findings *all, const char *builder, const char *base);
/* Rays per second. */
bb_estimate bb_emc_speed_ratio(const bb_findings *all, const char *scene, const char *builder,
                               const char *base);
/* Times. */
bb_estimate bb_emc_build_ratio(const bb_findings *all, const char *scene, const char *builder,
                               const char *base);

/* The claims on LBVH. */
void bb_emc_claims(const bb_findings *all, bb_reproduction *r);

#endif
