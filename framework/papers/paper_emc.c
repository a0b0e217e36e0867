/* Vinkler, Bittner, Havran: Extended Morton Codes for High Performance Bounding Volume Hierarchy
 * Construction. HPG 2017.
 *
 * Table 2 (cost, trace performance, build time, with LBVH and ATRBVH), the influence of each
 * ingredient (section 5.3) and other builders (section 5.4), as ratios to the plain code of 63 bits
 * on the same builder; then builders of which nobody has published it: the paper has ATRBVH (table
 * 2), and of HLBVH and AAC mean costs. The cost's constants are the paper's. With LBVH, codes are
 * compared on the builder `emc`: nothing but the code differs. Codes are also
 * computed by look-up tables (section 4.5), and compared on a scene of the size of the paper's.
 */
#include "framework/papers/emc.h"

#define SCENES                                                                                     \
    "coffee,mountain,scorpion,city:n=1000000,terrain:n=200000,hairball:n=200000,interior:n=200000" \
    ",spheres:n=200000"
#define QUICK_SCENES "city:n=10000,hairball:n=1000,interior:n=2000"

/* Of builders that take many times as long as LBVH: smaller, and none of spheres, which the paper
 * has nothing like. */
#define INSIDE_SCENES                                                                              \
    "coffee,mountain,scorpion,city:n=200000,terrain:n=100000,hairball:n=100000,interior:n=200000"
#define INSIDE_QUICK_SCENES "city:n=10000,interior:n=2000"

#define CODES                                                                                      \
    EMC_MC64 "," EMC_SORT64 "," EMC_VAR64 "," EMC_CELL64 "," EMC_MC32 "," EMC_SORT32 "," EMC_VAR32

/* ---- builders ---- */

#define METHOD(name_, builder_, ...)                                                               \
    {                                                                                              \
        .name = name_, .builder = builder_, .kernel = "stack", __VA_ARGS__                         \
    }
/* Section 5.4: EMC-64-var to MC-64, and over a full sweep. */
#define MEANS(ratio, over_sweep)                                                                   \
    .paper = &(const bb_paper_numbers)                                                             \
    {                                                                                              \
        .numbers = { ratio, over_sweep }                                                           \
    }

/* Two rounds of ATRBVH, as Domingues and Pedrini have it, whose settings the paper takes over. */
const bb_paper_entrant bb_emc_methods[EMC_METHODS + 1] = {
    [EMC_LBVH] = METHOD("LBVH", "emc:code=$", MEANS(.80, 1.20)),
    [EMC_HLBVH] = METHOD("HLBVH", "hlbvh:code=$", MEANS(.84, 1.11)),
    [EMC_AAC_HQ] = METHOD("AAC-HQ", "aac:code=$,variant=hq", MEANS(.89, 1.03)),
    [EMC_AAC_FAST] = METHOD("AAC-Fast", "aac:code=$,variant=fast", ),
    [EMC_PLOC] = METHOD("PLOC", "ploc:code=$", ),
    [EMC_HPLOC] = METHOD("H-PLOC", "hploc:code=$", ),
    [EMC_TRBVH] = METHOD("LBVH + TRBVH", "emc:code=$+trbvh", ),
    [EMC_ATRBVH] = METHOD("LBVH + ATRBVH", "emc:code=$+atrbvh:rounds=2", ),
    [EMC_REINSERTION] = METHOD("LBVH + reinsertion", "emc:code=$+reinsert:passes=3", ),
    {.name = NULL},
};

const bb_paper_entrant bb_emc_radii[] = {
    {.name = "16", .builder = EMC_PLOC_CENTRED ",radius=16"},
    {.name = "32", .builder = EMC_PLOC_CENTRED ",radius=32"},
    {.name = NULL},
};

#define EQUAL(builder_, base_) .name = builder_, .builder = builder_, .base = base_
const bb_paper_entrant bb_emc_equals[EMC_EQUALS + 1] = {
    {EQUAL(EMC_SORT64, EMC_MC64)},
    {EQUAL(EMC_VAR64, EMC_MC64)},
    [EMC_EQUAL_CELL64] = {EQUAL(EMC_CELL64, EMC_MC64)},
    {EQUAL(EMC_SORT32, EMC_MC32)},
    {EQUAL(EMC_VAR32, EMC_MC32)},
    {.name = NULL},
};

const bb_paper_entrant bb_emc_tabled[] = {
    {EQUAL(EMC_MC64_TABLES, EMC_MC64)},
    {EQUAL(EMC_VAR64_TABLES, EMC_VAR64)},
    {.name = NULL},
};

/* ---- figures ---- */

const char *const bb_emc_rays[EMC_KINDS] = {"primary", "diffuse", "shadow", "random"};

#define OVER(what_, rays_, mean_, builder_, base_)                                                 \
    {                                                                                              \
        .what = what_, .rays = rays_, .mean = mean_, .builder = builder_, .base = base_            \
    }
#define OF_KINDS(what_, mean_, builder_, base_)                                                    \
    OVER(what_, "primary", mean_, builder_, base_),                                                \
        OVER(what_, "diffuse", mean_, builder_, base_),                                            \
        OVER(what_, "shadow", mean_, builder_, base_),                                             \
        OVER(what_, "random", mean_, builder_, base_)
#define ALL_FIGURES(builder_, base_)                                                               \
    {                                                                                              \
        OVER("sah", NULL, BB_MEAN_OF_SCENES, builder_, base_),                                     \
            OF_KINDS("work", BB_MEAN_OF_SCENES, builder_, base_),                                  \
            OF_KINDS("trace_ms", BB_MEAN_GEOMETRIC, builder_, base_),                              \
            OVER("build_ms", NULL, BB_MEAN_GEOMETRIC, builder_, base_)                             \
    }
const bb_figure bb_emc_inside[] = ALL_FIGURES("$" EMC_VAR, "$" EMC_PLAIN),
                bb_emc_beside[] = ALL_FIGURES("$" EMC_PLAIN, EMC_MC64);

const bb_figure bb_emc_centred = {.what = "sah",
                                  .of = 1,
                                  .builder = "$" EMC_VAR_CENTRED,
                                  .base = "$" EMC_PLAIN_CENTRED},
                bb_emc_placement = {.what = "sah",
                                    .of = 1,
                                    .builder = "$" EMC_PLAIN_CENTRED,
                                    .base = "$" EMC_PLAIN,
                                    .base_of = -1},
                bb_emc_plain_over_sweep = {.what = "sah",
                                           .builder = "$" EMC_PLAIN,
                                           .base = EMC_SWEEP,
                                           .base_of = 1},
                bb_emc_var_over_sweep = {.what = "sah",
                                         .builder = "$" EMC_VAR,
                                         .base = EMC_SWEEP,
                                         .base_of = 1},
                bb_emc_tabled_codes = {.what = "phase_ms", .phase = "codes", .base = "="},
                bb_emc_tabled_build = {.what = "build_ms", .base = "=", .mean = BB_MEAN_GEOMETRIC},
                bb_emc_build_ratio = {.what = "build_ms", .base = "=", .mean = BB_MEAN_GEOMETRIC},
                bb_emc_flatness = {.what = "flatness"},
                bb_emc_spread = {.what = "size_max", .per = "size_median"};

/* ---- experiments ---- */

/* An experiment that traces nothing. */
#define BUILDS_ALONE .kernels = "", .rays = "", .width = 1, .height = 1, .max_rays = 1
#define ON_SCENES .scenes = SCENES, .quick_scenes = QUICK_SCENES, .takes_scenes = true
#define ON_SMALLER                                                                                 \
    .scenes = INSIDE_SCENES, .quick_scenes = INSIDE_QUICK_SCENES, .takes_scenes = true

static const bb_experiment experiments[] = {
    [EMC_TRACED] = {.name = "codes, traced",
                    .builders = CODES,
                    .kernels = "stack",
                    .rays = "diffuse",
                    ON_SCENES,
                    .width = 512,
                    .height = 512,
                    .max_rays = 1 << 19,
                    .repeats = BB_INTERVAL_ROUNDS},
    [EMC_BUILT] =
        {.name = "codes, build times", .builders = CODES, BUILDS_ALONE, ON_SCENES, .repeats = 40},
    [EMC_VARIED] = {.name = "influence of each ingredient",
                    .builders = EMC_MC64,
                    .entrants = bb_emc_ingredients,
                    BUILDS_ALONE,
                    ON_SCENES,
                    .repeats = 1}, /* its costs are compared, not its times */
    [EMC_SIZED] = {.name = "number of primitives",
                   .builders = CODES,
                   BUILDS_ALONE,
                   .scenes = "random:n=#",
                   .quick_scenes = "random:n=#",
                   .repeats = 9},
    [EMC_INSIDE] = {.name = "codes inside other builders",
                    .builders = EMC_ATRBVH_OF("emc64-sort"),
                    .entrants = bb_emc_methods,
                    .fills = EMC_PLAIN " " EMC_VAR,
                    .optional_builders = true,
                    .kernels = "stack",
                    .rays = EMC_RAYS,
                    ON_SMALLER,
                    .width = 256,
                    .height = 256,
                    .max_rays = 1 << 16,
                    .max_views = 2,
                    .repeats = BB_INTERVAL_ROUNDS},
    [EMC_CENTRED] = {.name = "the same in the box of the centroids, and a full sweep",
                     .builders =
                         EMC_SWEEP "," EMC_PLOC_CENTRED ",radius=16," EMC_PLOC_CENTRED ",radius=32",
                     .entrants = bb_emc_methods,
                     .fills = EMC_PLAIN_CENTRED " " EMC_VAR_CENTRED,
                     .optional_builders = true,
                     BUILDS_ALONE,
                     ON_SMALLER,
                     .repeats = 1}, /* its costs alone */
    /* Of the paper's scenes, four have more than five million triangles. */
    [EMC_LARGE] = {.name = "a large scene",
                   .builders = CODES,
                   .kernels = "stack",
                   .rays = "diffuse",
                   .scenes = "city:n=6000000",
                   .quick_scenes = "city:n=20000",
                   .width = 512,
                   .height = 512,
                   .max_rays = 1 << 17,
                   .max_views = 2,
                   .repeats = BB_INTERVAL_ROUNDS},
    [EMC_TABLED] = {.name = "codes by look-up tables",
                    .builders = EMC_MC64 "," EMC_VAR64,
                    .entrants = bb_emc_tabled,
                    BUILDS_ALONE,
                    ON_SCENES,
                    .repeats = 9},
    {.name = NULL},
};

extern const bb_paper bb_paper_emc;
const bb_paper bb_paper_emc = {
    .name = "emc",
    .title = "Vinkler, Bittner, Havran 2017: Extended Morton Codes for High Performance Bounding "
             "Volume Hierarchy Construction",
    .experiments = experiments,
    .tables = bb_emc_tables,
    .claims = {bb_emc_claims, bb_emc_other_claims},
};
