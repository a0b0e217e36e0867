/* What the tables and the claims of the extended Morton codes share: the codes, the builders that
 * sort by them, and figures of the one over the other. */
#ifndef BB_EMC_H
#define BB_EMC_H

#include "framework/papers/reproduce.h"

/* The paper cuts the scene's box into cells (algorithm 1), not that of the centroids. */
#define EMC_MC64 "emc:code=mc64,box=scene"
#define EMC_MC32 "emc:code=mc32,box=scene"
#define EMC_SORT64 "emc:code=emc64-sort,box=scene"
#define EMC_SORT32 "emc:code=emc32-sort,box=scene"
#define EMC_VAR64 "emc:code=emc64-var,box=scene"
#define EMC_VAR32 "emc:code=emc32-var,box=scene"
#define EMC_CELL64 "emc:code=emc64-cell,box=scene" /* not in the paper */
#define EMC_ORDER EMC_MC64 ",axes=extent"
#define EMC_ORDER_COUNT EMC_ORDER ",count=variable"
#define EMC_SIZES EMC_MC64 ",bits=64,every=4,size-bits=16"
#define EMC_FEWER_SIZES EMC_MC64 ",bits=64,every=7,size-bits=6,size=root"
#define EMC_VAR64_ALL_SIZES EMC_VAR64 ",every=4,size-bits=16,size=linear"
#define EMC_VAR64_CELL_ALL EMC_VAR64 ",every=4,size-bits=16,size=cell"
#define EMC_VAR64_CELL_TEN EMC_VAR64 ",every=4,size-bits=10,size=cell"
#define EMC_VAR64_NINE EMC_VAR64 ",size-bits=9"
#define EMC_VAR32_ALL_SIZES EMC_VAR32 ",every=4,size-bits=8,size=linear"
#define EMC_VAR64_AREA EMC_VAR64 ",measure=area"
/* By look-up tables (section 4.5). */
#define EMC_MC64_TABLES EMC_MC64 ",expand=tables"
#define EMC_VAR64_TABLES EMC_VAR64 ",expand=tables"
#define EMC_SWEEP "sah:method=sweep"
#define EMC_ATRBVH_OF(code) "emc:code=" code ",box=scene+atrbvh:rounds=2"
#define EMC_HLBVH_MC64 "hlbvh:code=mc64,box=scene"
#define EMC_PLOC_CENTRED "ploc:code=mc64,box=centroids"

/* What stands for '$' in the builders below. Where cells begin is a matter of chance, and so are
 * some percent of a tree's cost, so that costs are compared in the box of the centroids, too. */
#define EMC_PLAIN "mc64,box=scene"
#define EMC_VAR "emc64-var,box=scene"
#define EMC_PLAIN_CENTRED "mc64,box=centroids"
#define EMC_VAR_CENTRED "emc64-var,box=centroids"

/* Experiments, in order. */
enum {
    EMC_TRACED,
    EMC_BUILT,
    EMC_VARIED,
    EMC_SIZED,
    EMC_INSIDE,
    EMC_CENTRED,
    EMC_LARGE,
    EMC_TABLED
};

/* The builders, in order. */
enum {
    EMC_LBVH,
    EMC_HLBVH,
    EMC_AAC_HQ, /* the paper does not say which AAC it has */
    EMC_AAC_FAST,
    EMC_PLOC,
    EMC_HPLOC,
    EMC_TRBVH,
    EMC_ATRBVH,
    EMC_REINSERTION,
    EMC_METHODS
};
extern const bb_paper_entrant bb_emc_methods[EMC_METHODS + 1];
/* PLOC, whose radius is 8, with others. */
extern const bb_paper_entrant bb_emc_radii[];

/* Codes of which one ingredient is another; note: what the paper has. */
extern const bb_paper_entrant bb_emc_ingredients[];

/* Codes and the plain ones of equal length, as bases. */
enum { EMC_EQUAL_CELL64 = 2, EMC_EQUALS = 5 };
extern const bb_paper_entrant bb_emc_equals[EMC_EQUALS + 1];

/* Codes by look-up tables; as bases, the same codes by shifts. */
extern const bb_paper_entrant bb_emc_tabled[];
/* Times of the codes alone, and of the build. */
extern const bb_figure bb_emc_tabled_codes, bb_emc_tabled_build;

/* Of a row's EMC-64-var over its plain code, and of its plain code over LBVH's: cost, then counted
 * work and time per ray of each kind, and the build. Means of times are geometric. */
enum { EMC_KINDS = 4 };
enum { EMC_COST, EMC_WORK, EMC_TIME = EMC_WORK + EMC_KINDS, EMC_BUILD = EMC_TIME + EMC_KINDS };
extern const bb_figure bb_emc_inside[EMC_BUILD + 1], bb_emc_beside[EMC_BUILD + 1];
/* The rays of these kinds, and their names. */
#define EMC_RAYS "primary,diffuse,shadow,random"
extern const char *const bb_emc_rays[EMC_KINDS];

/* In the box of the centroids; and the plain code's cost there over that in the scene's. */
extern const bb_figure bb_emc_centred, bb_emc_placement;
/* Costs over those of a full sweep. */
extern const bb_figure bb_emc_plain_over_sweep, bb_emc_var_over_sweep;
/* Build times of the equals. */
extern const bb_figure bb_emc_build_ratio;
/* Of the scene. */
extern const bb_figure bb_emc_flatness, bb_emc_spread;

#define EMC_PER_SCENE(text_)                                                                       \
    {                                                                                              \
        .each = true, .first = "per scene: ", .before = ", ", .text = text_, BB_MEASURED(0)        \
    }
#define EMC_PAIRED "geometric mean of the scenes' paired ratios: "

/* Below this, two costs, or two works, are the same. */
#define EMC_SAME 0.0005

/* Our scenes, and the paper's for which they stand. */
extern const bb_paper_column bb_emc_scenes[];

extern const bb_paper_table bb_emc_tables[];
/* On LBVH, and on other builders. */
extern const bb_paper_claim bb_emc_claims[], bb_emc_other_claims[];

#endif
