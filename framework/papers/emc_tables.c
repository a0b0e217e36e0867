/* Tables of Vinkler, Bittner, Havran 2017: the paper's, then those of other builders.
 *
 * Of its table 2, each ratio and average was derived again from its absolute figures, and is right
 * within their rounding; that of the abstract, "up to 54 %", is in no row: the least cost is 0.48,
 * and section 5.2 says 52 %.
 */
#include "framework/papers/emc.h"

#include <math.h>
#include <string.h>

/* ---- table 2 ---- */

/* Primitives; of LBVH, then of ATRBVH: cost, Mrays/s and build of MC-64, each followed by the
 * ratios of EMC-64-sort and EMC-64-var. */

enum { PRIMS = 1, LBVH_COST = 2, LBVH_SPEED = 5, LBVH_BUILD = 8, ATRBVH = 9 /* after LBVH's */ };
static const bb_paper_numbers table2[] = {
    {"sponza",
     {76e3, 97, .88, .96, 75, 1.01, .95, 5.1, 1.02, 1.00, 70, 1.00, 1.02, 97, 1.02, .96, 10.7, 1.01,
      .97}},
    {"conference",
     {331e3, 65, .78, .78, 80, 1.17, 1.23, 13.0, .97, 1.01, 37, .98, .98, 123, 1.02, .98, 31.9, .95,
      1.01}},
    {"sodahall",
     {2169e3, 101, .91, .94, 113, 1.01, .99, 65.3, .99, .99, 72, 1.00, 1.00, 144, .89, 1.03, 184.3,
      1.01, .99}},
    {"hairball",
     {2880e3, 542, .99, 1.00, 7, 1.02, 1.01, 88.5, .99, 1.02, 476, 1.00, 1.00, 7, 1.01, 1.00, 242.1,
      1.01, 1.00}},
    {"pompeii",
     {5646e3, 180, .84, .53, 19, 1.11, 1.47, 158.5, 1.00, 1.03, 101, .93, .75, 28, 1.04, 1.23,
      478.5, .99, 1.00}},
    {"san-miguel",
     {7880e3, 94, .87, .82, 19, 1.12, 1.17, 234.4, .96, .99, 60, 1.01, 1.00, 27, 1.02, 1.04, 669.3,
      .99, 1.01}},
    {"city",
     {8737e3, 121, .83, .48, 30, 1.18, 2.01, 261.4, .98, .99, 62, .92, .74, 57, 1.07, 1.31, 750.6,
      .99, .95}},
    {"powerplant",
     {12759e3, 49, .90, .91, 25, 1.13, 1.09, 355.3, 1.00, .99, 35, .98, .99, 37, 1.05, 1.03, 1029.0,
      .99, 1.00}},
    {.name = NULL},
};
static const bb_paper_numbers table2_average = {
    "average",
    {0, 0, .88, .80, 0, 1.09, 1.24, 0, .99, 1.00, 0, .98, .93, 0, 1.01, 1.07, 0, .99, .99}};

#define SCENE BB_COLUMN_OF("scene", BB_SHOW_SCENE)
#define PRIMITIVES                                                                                 \
    {                                                                                              \
        .heading = "primitives", .figure = &(const bb_figure){.what = "prims"}, .paper = PRIMS     \
    }
#define FLATNESS BB_COLUMN("flatness", &bb_emc_flatness, 3)

/* The paper's number `at`, and those after it for two codes. */
#define LBVH_COLUMNS(at, unit, absolute, ...)                                                      \
    {                                                                                              \
        SCENE, PRIMITIVES, FLATNESS,                                                               \
            {.heading = unit, .figure = absolute, .decimals = 1, .paper = at},                     \
            {.heading = "EMC-64-sort", .decimals = 2, .paper = at + 1, CODE(SORT64, __VA_ARGS__)}, \
            {.heading = "EMC-64-var", .decimals = 2, .paper = at + 2, CODE(VAR64, __VA_ARGS__)},   \
            {.heading = "EMC-64-cell", .decimals = 2, CODE(CELL64, __VA_ARGS__)},                  \
            {.heading = "MC-32", .decimals = 2, CODE(MC32, __VA_ARGS__)},                          \
            {.heading = "EMC-32-sort", .decimals = 2, CODE(SORT32, __VA_ARGS__)},                  \
            {.heading = "EMC-32-var", .decimals = 2, CODE(VAR32, __VA_ARGS__)},                    \
        {                                                                                          \
            .heading = NULL                                                                        \
        }                                                                                          \
    }
#define CODE(code, ...)                                                                            \
    .figure = &(const bb_figure)                                                                   \
    {                                                                                              \
        .builder = EMC_##code, .base = EMC_MC64, __VA_ARGS__                                       \
    }

static const bb_figure mc64_cost = {.what = "sah", .of = EMC_VARIED, .builder = EMC_MC64},
                       mc64_speed = {.what = "rays",
                                     .per = "trace_ms",
                                     .scale = 1e-3,
                                     .builder = EMC_MC64},
                       mc64_build = {.what = "build_ms", .of = EMC_BUILT, .builder = EMC_MC64};
static const bb_paper_column lbvh_costs[] =
    LBVH_COLUMNS(LBVH_COST, "MC-64", &mc64_cost, .what = "sah", .of = EMC_VARIED);
static const bb_paper_column lbvh_speeds[] =
    LBVH_COLUMNS(LBVH_SPEED, "MC-64 Mrays/s", &mc64_speed, .what = "trace_ms", .inverse = true);
static const bb_paper_column lbvh_builds[] =
    LBVH_COLUMNS(LBVH_BUILD, "MC-64 ms", &mc64_build, .what = "build_ms", .of = EMC_BUILT);

/* On a scene of the size of the paper's. */
static const bb_figure large_cost = {.what = "sah", .builder = EMC_MC64},
                       large_build = {.what = "build_ms", .builder = EMC_MC64};
static const bb_paper_column large_costs[] = LBVH_COLUMNS(0, "MC-64", &large_cost, .what = "sah"),
                             large_speeds[] = LBVH_COLUMNS(0, "MC-64 Mrays/s", &mc64_speed,
                                                           .what = "trace_ms", .inverse = true),
                             large_builds[] =
                                 LBVH_COLUMNS(0, "MC-64 ms", &large_build, .what = "build_ms");

/* ---- ATRBVH ---- */

static void say_missing_atrbvh(bb_paper_place at, const bb_figure *figure, bb_words *words)
{
    (void)figure;
    if (at.scene == NULL)
        bb_say_missing(bb_emc_methods[EMC_ATRBVH].builder, words);
}

#define ATRBVH_COLUMNS(at, unit, what_, per_, scale_, time, ...)                                   \
    {                                                                                              \
        SCENE, PRIMITIVES,                                                                         \
            {.heading = unit,                                                                      \
             .decimals = 1,                                                                        \
             .paper = at + ATRBVH,                                                                 \
             .figure = &(const bb_figure){.what = what_,                                           \
                                          .per = per_,                                             \
                                          .scale = scale_,                                         \
                                          .builder = EMC_ATRBVH_OF("mc64"),                        \
                                          .rays = "diffuse"}},                                     \
            {.heading = "of LBVH's",                                                               \
             .decimals = 2,                                                                        \
             .paper = at + ATRBVH,                                                                 \
             .paper_over = at,                                                                     \
             OVER("mc64", EMC_MC64, time, __VA_ARGS__)},                                           \
            {.heading = "EMC-64-sort",                                                             \
             .decimals = 2,                                                                        \
             .paper = at + ATRBVH + 1,                                                             \
             OVER("emc64-sort", EMC_ATRBVH_OF("mc64"), time, __VA_ARGS__)},                        \
            {.heading = "EMC-64-var",                                                              \
             .decimals = 2,                                                                        \
             .paper = at + ATRBVH + 2,                                                             \
             OVER("emc64-var", EMC_ATRBVH_OF("mc64"), time, __VA_ARGS__)},                         \
            {.heading = "note",                                                                    \
             .shown = BB_SHOW_WORDS,                                                               \
             .note = "of LBVH's: derived",                                                         \
             .words = say_missing_atrbvh},                                                         \
        {                                                                                          \
            .heading = NULL                                                                        \
        }                                                                                          \
    }
#define OVER(code, base_, what_, ...)                                                              \
    .figure = &(const bb_figure)                                                                   \
    {                                                                                              \
        .what = what_, .rays = "diffuse", .builder = EMC_ATRBVH_OF(code), .base = base_,           \
        __VA_ARGS__                                                                                \
    }
/* Ratios of speeds, not of times, as the paper has it. */
static const bb_paper_column atrbvh_costs[] =
    ATRBVH_COLUMNS(LBVH_COST, "MC-64", "sah", NULL, 0, "sah", .mean = BB_MEAN_OF_SCENES);
static const bb_paper_column atrbvh_speeds[] =
    ATRBVH_COLUMNS(LBVH_SPEED, "MC-64 Mrays/s", "rays", "trace_ms", 1e-3, "trace_ms",
                   .inverse = true, .mean = BB_MEAN_GEOMETRIC);
static const bb_paper_column atrbvh_builds[] = ATRBVH_COLUMNS(
    LBVH_BUILD, "MC-64 ms", "build_ms", NULL, 0, "build_ms", .mean = BB_MEAN_GEOMETRIC);

/* ---- build times of codes ---- */

static double build_target(bb_paper_place at, const bb_figure *figure)
{
    (void)at;
    (void)figure;
    return 1 + BB_CLAIM_MARGIN;
}

static void say_within(bb_paper_place at, const bb_figure *figure, bb_words *words)
{
    bool timed;
    const bb_estimate e = bb_figure_at(at, figure, &timed);
    const bb_claim_verdict within = bb_verdict_at(e, true, BB_AT_MOST, 0, 1);
    bb_say(words, "%s",
           within == BB_HELD       ? "yes"
           : within == BB_NOT_HELD ? "no"
                                   : bb_verdict_words(within));
}

static const bb_paper_column build_ratios[] = {
    SCENE,
    {.heading = "code", .shown = BB_SHOW_BUILDER},
    {.heading = "against",
     .shown = BB_SHOW_BUILDER,
     .figure = &(const bb_figure){.what = "build_ms", .builder = "="}},
    BB_COLUMN_INTERVAL("ratio", NULL),
    {.heading = "target", .shown = BB_SHOW_NUMBER, .decimals = 2, .number = build_target},
    {.heading = "within it", .shown = BB_SHOW_WORDS, .words = say_within},
    {.heading = NULL},
};

static const bb_paper_column tabled[] = {
    SCENE,
    {.heading = "code", .shown = BB_SHOW_BUILDER},
    {.heading = "codes", .figure = &bb_emc_tabled_codes, .decimals = 2},
    BB_COLUMN_INTERVAL("build", &bb_emc_tabled_build),
    {.heading = NULL},
};

#define RATE(heading_, builder_)                                                                   \
    BB_COLUMN_AS(heading_, 2, .what = "prims", .per = "build_ms", .scale = 1e-3,                   \
                 .builder = builder_)
static const bb_paper_column rates[] = {
    BB_COLUMN_AS("primitives", 0, .what = "prims"),
    RATE("MC-32", EMC_MC32),
    RATE("EMC-32-sort", EMC_SORT32),
    RATE("EMC-32-var", EMC_VAR32),
    RATE("MC-64", EMC_MC64),
    RATE("EMC-64-sort", EMC_SORT64),
    RATE("EMC-64-var", EMC_VAR64),
    RATE("EMC-64-cell", EMC_CELL64),
    {.heading = NULL},
};

/* ---- ingredients ---- */

#define INGREDIENT(name_, builder_, paper_)                                                        \
    {                                                                                              \
        .name = name_, .builder = builder_, .note = paper_                                         \
    }
const bb_paper_entrant bb_emc_ingredients[] = {
    INGREDIENT("axes by extent", EMC_ORDER, "0.88 pompeii, 0.85 city, 1.00 others"),
    INGREDIENT("axes by extent, variable count", EMC_ORDER_COUNT, "0.56 pompeii, 0.51 city"),
    INGREDIENT("size every 4th bit", EMC_SIZES, "0.77 to 0.90"),
    INGREDIENT("size every 7th bit, 6 bits", EMC_FEWER_SIZES, ""),
    INGREDIENT("EMC-64-sort", EMC_SORT64, "0.78 to 0.99, mean 0.88"),
    INGREDIENT("EMC-64-var", EMC_VAR64, "0.48 to 1.00, mean 0.80"),
    INGREDIENT("EMC-64-cell (not in the paper)", EMC_CELL64, ""),
    INGREDIENT("the same, size by the longest side", EMC_CELL64 ",measure=side", ""),
    INGREDIENT("EMC-64-var, size every 4th bit", EMC_VAR64_ALL_SIZES, ""),
    INGREDIENT("EMC-64-var, size against the cell", EMC_VAR64 ",size=cell", ""),
    INGREDIENT("the same, every 4th bit", EMC_VAR64_CELL_ALL, ""),
    INGREDIENT("the same, 10 bits", EMC_VAR64_CELL_TEN, ""),
    INGREDIENT("the same, every 3rd bit", EMC_VAR64 ",every=3,size-bits=16,size=cell", ""),
    INGREDIENT("EMC-64-var, 9 size bits (algorithm 2)", EMC_VAR64_NINE, ""),
    INGREDIENT("MC-64, box of the centroids", "emc:code=mc64,box=centroids", ""),
    INGREDIENT("EMC-64-var, box of the centroids", "emc:code=emc64-var,box=centroids", ""),
    INGREDIENT("EMC-64-var, size by area", EMC_VAR64_AREA, "slightly worse"),
    INGREDIENT("EMC-64-sort, size by area", EMC_SORT64 ",measure=area", "slightly worse"),
    INGREDIENT("MC-32", EMC_MC32, ""),
    INGREDIENT("EMC-32-sort", EMC_SORT32, ""),
    INGREDIENT("EMC-32-var", EMC_VAR32, ""),
    INGREDIENT("EMC-32-var, size every 4th bit", EMC_VAR32_ALL_SIZES, ""),
    INGREDIENT("full sweep SAH, for comparison", EMC_SWEEP, "0.67"),
    {.name = NULL},
};
static const bb_figure ingredient = {.what = "sah", .base = EMC_MC64};

static void say_best(bb_paper_place at, bb_words *title)
{
    static const bb_figure var = {.what = "sah", .builder = EMC_VAR64, .base = EMC_MC64};
    static const bb_figure *const figures[] = {&var};
    const bb_paper_entrant *best = &bb_emc_ingredients[0];
    double least = INFINITY;
    for (at.row = best; strcmp(at.row->builder, EMC_SWEEP) != 0; at.row++) {
        const double mean = bb_value_at(at, &ingredient);
        best = mean < least ? at.row : best;
        least = mean < least ? mean : least;
    }
    bb_say(title, "%s, %.3f; EMC-64-var: ", best->builder, least);
    bb_say_text(title, "{0.3}", at, figures);
}

static const bb_paper_column ingredients[] = {
    {.heading = "ingredient", .shown = BB_SHOW_ROW},
    {.heading = "", .shown = BB_SHOW_SCENES, .decimals = 3},
    {.heading = "average", .decimals = 3},
    {.heading = "paper", .shown = BB_SHOW_NOTE},
    {.heading = NULL},
};

/* ---- other builders ---- */

#define BUILDER BB_COLUMN_OF("builder", BB_SHOW_MISSING)
#define NUMBER(heading_, shown_, figure_)                                                          \
    {                                                                                              \
        .heading = heading_, .shown = shown_, .figure = figure_, .decimals = 3                     \
    }
#define FIGURE(heading_, figure_) NUMBER(heading_, BB_SHOW_FIGURE, figure_)

static const bb_paper_column means[] = {
    BUILDER,
    {.heading = "EMC/MC (paper)", .shown = BB_SHOW_PAPER, .paper = 1, .decimals = 2},
    {.heading = "EMC/MC (here)", .figure = &bb_emc_inside[EMC_COST], .decimals = 2},
    {.heading = "MC/sweep (paper, derived)",
     .shown = BB_SHOW_PAPER,
     .paper = 2,
     .paper_over = 1,
     .decimals = 2},
    {.heading = "MC/sweep (here)", .figure = &bb_emc_plain_over_sweep, .decimals = 2},
    {.heading = "EMC/sweep (paper)", .shown = BB_SHOW_PAPER, .paper = 2, .decimals = 2},
    {.heading = "EMC/sweep (here)", .figure = &bb_emc_var_over_sweep, .decimals = 2},
    {.heading = NULL},
};

#define SUMMARY(figures)                                                                           \
    {                                                                                              \
        BUILDER, FIGURE("cost", &figures[EMC_COST]), FIGURE("work primary", &figures[EMC_WORK]),   \
            FIGURE("work diffuse", &figures[EMC_WORK + 1]),                                        \
            FIGURE("work shadow", &figures[EMC_WORK + 2]),                                         \
            FIGURE("work random", &figures[EMC_WORK + 3]),                                         \
            FIGURE("time primary", &figures[EMC_TIME]),                                            \
            FIGURE("time diffuse", &figures[EMC_TIME + 1]),                                        \
            FIGURE("time shadow", &figures[EMC_TIME + 2]),                                         \
            FIGURE("time random", &figures[EMC_TIME + 3]), FIGURE("build", &figures[EMC_BUILD]),   \
        {                                                                                          \
            .heading = NULL                                                                        \
        }                                                                                          \
    }
static const bb_paper_column beside[] = SUMMARY(bb_emc_beside);
static const bb_paper_column inside[] = SUMMARY(bb_emc_inside);

static const bb_paper_column placement[] = {
    BUILDER,
    FIGURE("EMC/MC, scene", &bb_emc_inside[EMC_COST]),
    FIGURE("EMC/MC, centroids", &bb_emc_centred),
    FIGURE("MC, centroids/scene", &bb_emc_placement),
    NUMBER("least", BB_SHOW_LEAST, &bb_emc_placement),
    NUMBER("most", BB_SHOW_MOST, &bb_emc_placement),
    {.heading = NULL},
};

/* "lower (4 of 7 scenes lower, 1 higher)": by intervals, where there are any. */
static void say_which(bb_paper_place at, const bb_figure *figure, bb_words *words)
{
    const bb_paper_series s = bb_figure_series(at, figure);
    const bool exact = figure->mean == BB_MEAN_OF_SCENES;
    const double margin = exact ? EMC_SAME : 0;
    const double low = exact ? s.mean.value : s.mean.low, high = exact ? s.mean.value : s.mean.high;
    uint32_t count = 0, lower = 0, higher = 0;
    if (bb_say_missing(at.row->builder, words))
        return;
    if (isnan(s.mean.value)) {
        bb_say(words, "not measured");
        return;
    }
    for (size_t i = 0; i < s.count; i++) {
        count += !isnan(s.each[i].value);
        lower += (exact ? s.each[i].value : s.each[i].high) < 1 - margin;
        higher += (exact ? s.each[i].value : s.each[i].low) > 1 + margin;
    }
    bb_say(words, "%s",
           isnan(low)          ? bb_verdict_words(BB_TOO_FEW_ROUNDS)
           : high < 1 - margin ? "lower"
           : low > 1 + margin  ? "higher"
           : exact             ? "the same"
                               : bb_verdict_words(BB_OPEN));
    if (!isnan(low))
        bb_say(words, " (%u of %u scenes lower, %u higher)", lower, count, higher);
}

#define EACH BB_COLUMN_OF("builder", BB_SHOW_ROW), NUMBER("", BB_SHOW_SCENES, NULL)
#define WHICH                                                                                      \
    {                                                                                              \
        .heading = "EMC-64-var is", .shown = BB_SHOW_WORDS, .words = say_which                     \
    }
static const bb_paper_column exact[] = {EACH, FIGURE("mean", NULL), WHICH, {.heading = NULL}};
static const bb_paper_column timed[] = {
    EACH, BB_COLUMN_INTERVAL("mean", NULL), WHICH, {.heading = NULL}};

/* ---- all of them ---- */

#define OF_TABLE2(columns_, experiment)                                                            \
    .columns = columns_, .by_scene = true, .of = experiment, .average = "average (here)",          \
    .paper = table2, .paper_average = &table2_average
#define OF_LARGE(columns_) .columns = columns_, .by_scene = true, .of = EMC_LARGE
#define OF_METHODS(columns_) .columns = columns_, .rows = bb_emc_methods, .of = EMC_INSIDE
#define INSIDE "EMC-64-var inside builders: "
#define OF_RAYS(what_, first, columns_, k, kind, after)                                            \
    {                                                                                              \
        .title = INSIDE what_ " per " kind " ray, as a ratio to MC-64" after,                      \
        OF_METHODS(columns_), .figure = &bb_emc_inside[first + k]                                  \
    }
#define OF_ALL_RAYS(what_, first, columns_, after)                                                 \
    OF_RAYS(what_, first, columns_, 0, "primary", after),                                          \
        OF_RAYS(what_, first, columns_, 1, "diffuse", after),                                      \
        OF_RAYS(what_, first, columns_, 2, "shadow", after),                                       \
        OF_RAYS(what_, first, columns_, 3, "random", after)

const bb_paper_table bb_emc_tables[] = {
    {.title = "LBVH, cost (SAH): of MC-64, and ratios to it", OF_TABLE2(lbvh_costs, EMC_TRACED)},
    {.title = "LBVH, trace performance of diffuse rays: Mrays/s of MC-64, and ratios",
     OF_TABLE2(lbvh_speeds, EMC_TRACED)},
    {.title = "LBVH, build time: ms of MC-64, and ratios to it",
     OF_TABLE2(lbvh_builds, EMC_TRACED)},
    {.title = "Build time of each extended code against the plain code of equal length: median of "
              "the ratios of paired builds",
     .columns = build_ratios,
     .figure = &bb_emc_build_ratio,
     .rows = bb_emc_equals,
     .by_scene = true,
     .of = EMC_BUILT,
     .rows_first = true,
     .average = "all scenes (geometric)"},
    {.title = "Time of the codes, and of the build, by look-up tables of 8 bits (section 4.5) as a "
              "ratio to those by shifts: the codes are the same",
     .columns = tabled,
     .rows = bb_emc_tabled,
     .by_scene = true,
     .of = EMC_TABLED,
     .rows_first = true,
     .average = "all scenes"},
    {.title = "LBVH on a large scene, cost (SAH): of MC-64, and ratios to it (paper's city, of 8.7 "
              "million triangles: EMC-64-sort 0.83, EMC-64-var 0.48)",
     OF_LARGE(large_costs)},
    {.title = "LBVH on a large scene, trace performance of diffuse rays: Mrays/s of MC-64, and "
              "ratios (paper's city: 1.18, 2.01)",
     OF_LARGE(large_speeds)},
    {.title = "LBVH on a large scene, build time: ms of MC-64, and ratios to it (paper's city: "
              "0.98, 0.99)",
     OF_LARGE(large_builds)},
    {.title = "Influence of each ingredient (section 5.3, and beyond): cost as a ratio to MC-64. "
              "Best code on average: ",
     .title_words = say_best,
     .columns = ingredients,
     .figure = &ingredient,
     .rows = bb_emc_ingredients,
     .of = EMC_VARIED},
    {.title = "Build rate over the number of primitives (random triangles), Mprims/s",
     .columns = rates,
     .by_scene = true,
     .of = EMC_SIZED},
    {.title = "Scenes of the tables that follow, and the paper's for which they stand. Nothing "
              "here is like san-miguel or powerplant; flatness: shortest over "
              "longest side",
     .columns = bb_emc_scenes,
     .by_scene = true,
     .of = EMC_INSIDE},
    {.title = "ATRBVH (over LBVH), cost (SAH): of MC-64, and ratios to it; absolute costs of "
              "different scenes do not compare",
     OF_TABLE2(atrbvh_costs, EMC_INSIDE)},
    {.title = "ATRBVH, trace performance of diffuse rays: Mrays/s of MC-64, and ratios",
     OF_TABLE2(atrbvh_speeds, EMC_INSIDE)},
    {.title = "ATRBVH, build time with LBVH's: ms of MC-64, and ratios to it",
     OF_TABLE2(atrbvh_builds, EMC_INSIDE)},
    {.title = "Other builders (section 5.4), cost (SAH): EMC-64-var to MC-64, and both to a full "
              "sweep, means of the scenes. The paper has no figures of single scenes",
     OF_METHODS(means)},
    {.title = "Builders with MC-64, as a ratio to LBVH with MC-64 (below 1: better), means of the "
              "scenes",
     OF_METHODS(beside)},
    {.title = "EMC-64-var inside builders, as a ratio to the same builder with MC-64 (below 1: "
              "better), means of the scenes: cost (SAH), counted work (1.2 nodes + primitives) and "
              "time per ray, build. Intervals and scenes: the tables that follow",
     OF_METHODS(inside)},
    {.title = INSIDE "cost (SAH), as a ratio to MC-64",
     OF_METHODS(exact),
     .figure = &bb_emc_inside[EMC_COST]},
    {.title = INSIDE "cost as a ratio to MC-64, with the scene's box divided and with that of the "
                     "centroids; and what that choice alone does to MC-64: a smaller gain than "
                     "that is not surely the code's",
     OF_METHODS(placement)},
    OF_ALL_RAYS("counted work (1.2 nodes + primitives)", EMC_WORK, exact, ""),
    OF_ALL_RAYS("time", EMC_TIME, timed, "; geometric mean"),
    {.title = INSIDE "build time, as a ratio to MC-64; geometric mean",
     OF_METHODS(timed),
     .figure = &bb_emc_inside[EMC_BUILD]},
    {.title = NULL},
};
