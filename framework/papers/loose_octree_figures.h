/* What the tables and the claims of the loose octrees share: the builders' names, and figures of
 * them. */
#ifndef BB_LOOSE_OCTREE_FIGURES_H
#define BB_LOOSE_OCTREE_FIGURES_H

#include "framework/papers/reproduce.h"

#include <math.h>
#include <stdio.h>

#define STACK "stack"
#define STACKLESS "stackless"
#define LBVH30 "lbvh:bits=30"
#define LLBVH30 "llbvh:bits=30"
/* The paper's LOBVH is ordered by the view that is traced, always. */
#define LOBVH6 "lobvh:levels=6,view=0"
#define LOBVH7 "lobvh:levels=7,view=0"
#define LOBVH8 "lobvh:levels=8,view=0"
#define LOBVH_AUTO "lobvh:levels=auto,view=0"
#define LOBVH_VIEWLESS "lobvh:levels=auto"
#define RIVALS LBVH30 "," LLBVH30 "," LOBVH6 "," LOBVH7 "," LOBVH8 "," LOBVH_AUTO

#define SMALLEST LLBVH30 ",side=smallest"
#define LARGEST LLBVH30 ",side=largest"
#define MEAN LLBVH30 ",side=mean"
#define VOLUME LLBVH30 ",side=volume"
#define UNFITTED LLBVH30 ",side=smallest,fit=no"
#define EVEN LLBVH30 ",side=smallest,sizes=yes"
#define SIZE_VARIANTS SMALLEST "," LARGEST "," MEAN "," VOLUME "," UNFITTED "," EVEN

/* Experiments, in order. */
enum { OF_SPHERES, OF_TRIANGLES, OF_SIZES, OF_VIEWS };
enum { RIVAL_COUNT = 6, LEVELS = 3, FIRST_LEVEL = 6, SIZE_VARIANT_COUNT = 6, VIEWS = 3 };

static const char *const rivals[RIVAL_COUNT] = {LBVH30, LLBVH30, LOBVH6,
                                                LOBVH7, LOBVH8,  LOBVH_AUTO};
static const char *const lobvh_levels[LEVELS] = {LOBVH6, LOBVH7, LOBVH8};
static const char *const size_variants[SIZE_VARIANT_COUNT] = {SMALLEST, LARGEST,  MEAN,
                                                              VOLUME,   UNFITTED, EVEN};
static const char *const ordered[3] = {LBVH30, LLBVH30, LOBVH_VIEWLESS};

/* Build and trace of one frame; NAN if one of them was not measured. */
static inline double frame_ms(const bb_findings *f, const char *scene, const char *builder,
                              const char *kernel)
{
    return bb_found_build_ms(f, scene, builder) +
           bb_found_trace_ms(f, (bb_selection){scene, builder, kernel, NULL});
}

/* LOBVH of the level with the shortest frame. */
static inline const char *best_lobvh(const bb_findings *f, const char *scene)
{
    const char *best = lobvh_levels[0];
    for (uint32_t i = 1; i < LEVELS; i++) {
        double ms = frame_ms(f, scene, lobvh_levels[i], STACKLESS);
        double known = frame_ms(f, scene, best, STACKLESS);
        if (ms < known || (isnan(known) && !isnan(ms)))
            best = lobvh_levels[i];
    }
    return best;
}

static inline int level_of(const char *lobvh)
{
    int level = FIRST_LEVEL;
    while (level < FIRST_LEVEL + LEVELS - 1 && lobvh_levels[level - FIRST_LEVEL] != lobvh)
        level++;
    return level;
}

/* The builder with the order by view `by`. */
static inline void name_ordered(const char *builder, int by, char name[128])
{
    snprintf(name, 128, "%s,view=%d", builder, by);
}

/* Rays per second on view `v` of a tree ordered by view `by`, over those without an order. */
static inline bb_estimate view_factor(const bb_findings *f, const char *scene, const char *builder,
                                      const char *kernel, int v, int by)
{
    char with[128];
    name_ordered(builder, by, with);
    const char *view = bb_found_view(f, scene, v);
    return bb_found_ratio(f, BB_TRACE_TIME, (bb_selection){scene, builder, kernel, view},
                          (bb_selection){scene, with, kernel, view});
}

/* The claims: all of them, and those on the order by the view, of which `f` is the experiment. */
void bb_loose_octree_claims(const bb_findings *all, bb_reproduction *r);
void bb_loose_octree_order_claims(const bb_findings *f, bb_reproduction *r);

#endif
