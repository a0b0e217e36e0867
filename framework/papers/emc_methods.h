/* Extended Morton codes inside other builders: the builders, each with the plain code of 63 bits
 * and with EMC-64-var, and what was measured of the one over the other.
 *
 * The paper has ATRBVH (table 2), and of HLBVH and AAC mean costs (section 5.4). Nobody has
 * published them inside PLOC, H-PLOC, TRBVH and reinsertion, or of HLBVH and AAC more than costs.
 */
#ifndef BB_EMC_METHODS_H
#define BB_EMC_METHODS_H

#include "framework/papers/emc_figures.h"

/* BUILDER:code=CODE,box=BOX OPTIONS. As in emc_figures.h, the scene's box is cut into cells; but
 * where cells begin is a matter of chance, and so are some percent of a tree's cost, so that costs
 * are compared in the box of the centroids, too. */
#define EMC_WITH_BOX(builder, code, box, rest) builder ":code=" code ",box=" box rest
#define EMC_WITH_CODE(builder, code, rest) EMC_WITH_BOX(builder, code, "scene", rest)
/* Two rounds, as Domingues and Pedrini have it, whose settings the paper takes over. */
#define EMC_AFTER_ATRBVH "+atrbvh:rounds=2"

/* Identifier, name, builder, what follows the code's options. The paper does not say which AAC it
 * has: AAC-HQ is compared with it here. */
#define EMC_METHODS(ROW)                                                                           \
    ROW(EMC_LBVH, "LBVH", "emc", "")                                                               \
    ROW(EMC_HLBVH, "HLBVH", "hlbvh", "")                                                           \
    ROW(EMC_AAC_HQ, "AAC-HQ", "aac", ",variant=hq")                                                \
    ROW(EMC_AAC_FAST, "AAC-Fast", "aac", ",variant=fast")                                          \
    ROW(EMC_PLOC, "PLOC", "ploc", "")                                                              \
    ROW(EMC_HPLOC, "H-PLOC", "hploc", "")                                                          \
    ROW(EMC_TRBVH, "LBVH + TRBVH", "emc", "+trbvh")                                                \
    ROW(EMC_ATRBVH, "LBVH + ATRBVH", "emc", EMC_AFTER_ATRBVH)                                      \
    ROW(EMC_REINSERTION, "LBVH + reinsertion", "emc", "+reinsert:passes=3")
#define EMC_METHOD_ID(id, name, builder, rest) id,
#define EMC_BOTH_CODES(id, name, builder, rest)                                                    \
    "," EMC_WITH_CODE(builder, "mc64", rest) "," EMC_WITH_CODE(builder, "emc64-var", rest)

#define EMC_BOTH_CENTRED(id, name, builder, rest)                                                  \
    "," EMC_WITH_BOX(builder, "mc64", "centroids", rest) "," EMC_WITH_BOX(builder, "emc64-var",    \
                                                                          "centroids", rest)

#define EMC_ATRBVH_SORT64 EMC_WITH_CODE("emc", "emc64-sort", EMC_AFTER_ATRBVH)
#define EMC_INSIDE_BUILDERS EMC_ATRBVH_SORT64 EMC_METHODS(EMC_BOTH_CODES)
/* PLOC, whose radius is 8, with others. */
#define EMC_PLOC_RADIUS(radius) EMC_WITH_BOX("ploc", "mc64", "centroids", ",radius=" radius)
#define EMC_CENTRED_BUILDERS                                                                       \
    EMC_SWEEP "," EMC_PLOC_RADIUS("16") "," EMC_PLOC_RADIUS("32") EMC_METHODS(EMC_BOTH_CENTRED)

enum { EMC_METHODS(EMC_METHOD_ID) EMC_METHOD_COUNT };

typedef struct bb_emc_method {
    const char *name, *plain, *var;
    const char *centred_plain, *centred_var; /* with the box of the centroids */
} bb_emc_method;

extern const bb_emc_method bb_emc_methods[EMC_METHOD_COUNT];

/* Rays of the experiment INSIDE. */
#define EMC_INSIDE_RAYS "primary,diffuse,shadow,random"
enum { EMC_INSIDE_KINDS = 4 };
extern const char *const bb_emc_rays[EMC_INSIDE_KINDS];

/* Of what: cost (SAH), counted work and time per ray, build time. Of the second and third, of which
 * rays. */
typedef enum bb_emc_what { EMC_COST, EMC_WORK, EMC_TIME, EMC_BUILD } bb_emc_what;
typedef struct bb_emc_figure {
    bb_emc_what what;
    const char *rays; /* NULL: it is not of rays */
} bb_emc_figure;

/* The builder's figure over that of `base`. Costs and work are without noise, and have no interval.
 */
bb_estimate bb_emc_ratio(const bb_findings *all, bb_emc_figure figure, const char *scene,
                         const char *builder, const char *base);
/* Mean over the scenes: arithmetic, as in the paper; of times geometric and in each round, since
 * noise pushes an arithmetic mean of ratios up. */
bb_estimate bb_emc_mean(const bb_findings *all, bb_emc_figure figure, const char *builder,
                        const char *base);
/* One per scene. */
bb_paper_figures bb_emc_ratios(const bb_findings *all, bb_emc_figure figure, const char *builder,
                               const char *base);
/* The ratio of a method's costs in the box of the centroids, and how much that box alone changes
 * the cost with MC-64. One per scene. */
bb_paper_figures bb_emc_centred(const bb_findings *all, int method);
bb_paper_figures bb_emc_placement(const bb_findings *all, int method);
/* Cost over that of a full sweep. */
bb_paper_figures bb_emc_over_sweep(const bb_findings *all, const char *builder);

/* Is the figure, or its interval, below `bound`? */
bb_claim_verdict bb_emc_below(bb_emc_figure figure, bb_estimate e, double bound);

/* Says "no such builder: atrbvh" if one of its stages is not registered; after "; " if there is
 * something before it. */
bool bb_emc_missing(const char *builder, bb_words *words);

/* Tables and claims: which scene stands in for which, of the paper's other builders, and of those
 * that are in no paper. */
void bb_emc_scenes(const bb_findings *all, bb_reproduction *r);
void bb_emc_others(const bb_findings *all, bb_reproduction *r);
void bb_emc_other_claims(const bb_findings *all, bb_reproduction *r);
void bb_emc_inside(const bb_findings *all, bb_reproduction *r);
void bb_emc_inside_claims(const bb_findings *all, bb_reproduction *r);
/* All figures of all methods, means of the scenes: with EMC-64-var over MC-64, or (`beside`) with
 * MC-64 over LBVH's. */
void bb_emc_summary(const bb_findings *all, bb_reproduction *r, const char *title, bool beside);
/* The builders beside each other, with the plain code. */
void bb_emc_builders(const bb_findings *all, bb_reproduction *r);
void bb_emc_builder_claims(const bb_findings *all, bb_reproduction *r);

#endif
