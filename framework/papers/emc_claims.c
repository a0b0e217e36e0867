/* Claims of Vinkler, Bittner, Havran 2017 on LBVH (sections 4.1, 5.2 to 5.4). */
#include "framework/papers/emc.h"

#include <math.h>
#include <string.h>

/* ---- figures ---- */

/* A scene is flat here if its shortest side is less than a quarter of its longest: what the paper
 * calls terrain-like, and four splits come before the first of that side. */
static bool is_flat(const bb_findings *f, const char *scene)
{
    return bb_find(f, &(bb_cell){{[BB_SCENE] = scene, [BB_BUILDER] = ""}}, "flatness").number <
           0.25;
}

static bool is_not_flat(const bb_findings *f, const char *scene)
{
    return !is_flat(f, scene);
}

#define COST(builder_, base_) .what = "sah", .builder = builder_, .base = base_
static const bb_figure sort = {COST(EMC_SORT64, EMC_MC64)}, var = {COST(EMC_VAR64, EMC_MC64)},
                       order = {COST(EMC_ORDER, EMC_MC64)},
                       order_count = {COST(EMC_ORDER_COUNT, EMC_MC64)},
                       sizes = {COST(EMC_SIZES, EMC_MC64)},
                       fewer = {COST(EMC_FEWER_SIZES, EMC_MC64)},
                       fewer32 = {COST(EMC_VAR32, EMC_VAR32_ALL_SIZES)},
                       fewer64 = {COST(EMC_VAR64, EMC_VAR64_ALL_SIZES)},
                       nine = {COST(EMC_VAR64_NINE, EMC_VAR64)},
                       ten = {COST(EMC_VAR64_CELL_TEN, EMC_VAR64_CELL_ALL)},
                       diagonal = {COST(EMC_VAR64, EMC_VAR64_AREA)},
                       var_sweep = {COST(EMC_VAR64, EMC_SWEEP)},
                       plain_sweep = {COST(EMC_MC64, EMC_SWEEP)},
                       sizes_order = {COST(EMC_SIZES, EMC_ORDER_COUNT), .only = is_not_flat},
                       flat_var = {COST(EMC_VAR64, EMC_MC64), .only = is_flat},
                       other_var = {COST(EMC_VAR64, EMC_MC64), .only = is_not_flat},
                       flat_order = {COST(EMC_ORDER, EMC_MC64), .only = is_flat},
                       other_order = {COST(EMC_ORDER, EMC_MC64), .only = is_not_flat},
                       flat_count = {COST(EMC_ORDER_COUNT, EMC_MC64), .only = is_flat},
                       other_count = {COST(EMC_ORDER_COUNT, EMC_MC64), .only = is_not_flat};
static const bb_figure prims = {.what = "prims"}, overlap = {.what = "overlap"};

/* Of traced rays, from the experiment that traces them; the cost from the one that varies. */
static const bb_figure speed = {.what = "trace_ms",
                                .builder = EMC_VAR64,
                                .base = EMC_MC64,
                                .inverse = true,
                                .mean = BB_MEAN_OF_ROUNDS},
                       traced_cost = {COST(EMC_VAR64, EMC_MC64), .of = EMC_VARIED},
                       boxes = {.what = "node_tests_per_ray",
                                .builder = EMC_VAR64,
                                .base = EMC_MC64},
                       tests = {
                           .what = "prim_tests_per_ray", .builder = EMC_VAR64, .base = EMC_MC64};
static const bb_figure short_cost = {COST(EMC_VAR32, EMC_VAR64), .of = EMC_VARIED - EMC_BUILT},
                       short_build = {.what = "build_ms",
                                      .builder = EMC_VAR32,
                                      .base = EMC_VAR64,
                                      .mean = BB_MEAN_OF_ROUNDS};

/* ---- words that no row says ---- */

static const bb_figure *const traced[] = {&speed, &traced_cost, &boxes, &tests};

static void say_tests(bb_paper_place at, bb_words *why)
{
    const double more_boxes = bb_value_at(at, &boxes), more_tests = bb_value_at(at, &tests);
    bb_say_text(why, "box tests per ray {2%1}, primitive tests {3%1}", at, traced);
    if (more_boxes > 1 && more_tests > 1)
        bb_say(why, ": these rays meet more, whatever the cost expects");
    else if (more_boxes < 1 && more_tests < 1)
        bb_say(why, ": fewer tests, and yet slower");
}

static void say_slower(bb_paper_place at, bb_said *said)
{
    const bb_paper_series s = bb_figure_series(at, &speed);
    for (size_t i = 0; i < s.count; i++) {
        if (bb_verdict_at(s.each[i], true, BB_BELOW, 1, 0) != BB_HELD)
            continue;
        bb_say(&said->why, "%s", said->why.length > 0 ? "; " : "");
        bb_say_text(&said->why, "{scene} {0} at a cost of {1.2}: ", s.places[i], traced);
        say_tests(s.places[i], &said->why);
    }
}

/* Each scene whose cost is off by more than 3 % has to be faster or slower as its cost says. */
static void judge_speed(bb_paper_place at, bb_said *said)
{
    const bb_paper_series s = bb_figure_series(at, &speed);
    bb_claim_verdict each[BB_SERIES_MAX];
    size_t count = 0, agree = 0;
    for (size_t i = 0; i < s.count; i++) {
        const double cost = bb_value_at(s.places[i], &traced_cost);
        if (!(fabs(cost - 1) > 0.03) || isnan(s.each[i].value))
            continue;
        each[count] = bb_verdict_at(s.each[i], true, cost < 1 ? BB_ABOVE : BB_BELOW, 1, 0);
        agree += each[count] == BB_HELD;
        if (each[count++] == BB_HELD)
            continue;
        bb_say(&said->why, "%s", said->why.length > 0 ? "; " : "");
        bb_say_text(&said->why, "{scene}: cost {1.2}, speed {0}, ", s.places[i], traced);
        say_tests(s.places[i], &said->why);
    }
    bb_say(&said->ours,
           "speed is surely on the side that the cost says on %zu of %zu scenes whose cost is off "
           "by more than 3 %%",
           agree, count);
    said->verdict = bb_all(each, count);
}

/* The phase that adds most to the build time against the plain code. */
static void say_phase(const bb_findings *f, const char *scene, const bb_paper_entrant *row,
                      bb_words *why)
{
    bb_cell cell = {{[BB_SCENE] = scene, [BB_BUILDER] = row->builder}}, plain = cell;
    double own = 0, other = 0;
    const char *worst = NULL;
    plain.names[BB_BUILDER] = row->base;
    for (uint32_t i = 0; i < bb_table_row_count(f->table); i++) {
        const char *phase = bb_table_name(f->table, i, BB_MAKER);
        if (phase[0] == '\0' || strcmp(bb_table_name(f->table, i, BB_SCENE), scene) != 0 ||
            strcmp(bb_table_name(f->table, i, BB_BUILDER), row->builder) != 0)
            continue;
        cell.names[BB_MAKER] = plain.names[BB_MAKER] = phase;
        const double ms = bb_find(f, &cell, "phase_ms").number;
        const double plain_ms = bb_find(f, &plain, "phase_ms").number;
        if (!(ms - plain_ms > own - other))
            continue;
        own = ms;
        other = plain_ms;
        worst = phase;
    }
    if (worst != NULL)
        bb_say(why, ", where phase %s takes %.2f ms instead of %.2f ms", worst, own, other);
}

/* Where codes are farthest off the plain ones, and in which phase. */
static void say_farthest(bb_paper_place at, bb_said *said)
{
    for (int k = 0; k < EMC_EQUALS; k++) {
        at.row = &bb_emc_equals[k];
        const bb_paper_series s = bb_figure_series(at, &bb_emc_build_ratio);
        size_t worst = 0;
        if (k == EMC_EQUAL_CELL64 || bb_verdict_at(s.mean, true, BB_AT_MOST, 0, 1) == BB_HELD)
            continue;
        for (size_t i = 1; i < s.count; i++)
            if (!(s.each[i].value <= s.each[worst].value))
                worst = i;
        if (s.count == 0 || isnan(s.each[worst].value))
            continue;
        bb_say(&said->why, "%s%s most on %s: ", said->why.length > 0 ? "; " : "", at.row->name,
               s.places[worst].scene);
        bb_say_estimate(&said->why, s.each[worst]);
        say_phase(at.all, s.places[worst].scene, at.row, &said->why);
    }
    if (said->verdict == BB_OPEN)
        bb_say(&said->why, ". More rounds, or a machine without other work, would tell");
}

static void say_same(bb_paper_place at, bb_said *said)
{
    (void)at;
    if (strstr(said->ours.text, "lower on 0 scenes, higher on 0") != NULL)
        bb_say(&said->why, "no scene tells the two apart");
}

/* Of fewer size bits: is it their number that matters, or how often they come? */
static void say_fewer(bb_paper_place at, bb_said *said)
{
    const double by_nine = bb_value_at(at, &nine), by_ten = bb_value_at(at, &ten);
    if (said->verdict == BB_HELD)
        return;
    bb_say(
        &said->why,
        "9 bits every 7th instead of 6 change the cost by %+.1f %% on average, 10 bits every 4th "
        "instead of 16 by %+.1f %% (there compared with the cell), 16 every 4th instead of 6 "
        "every 7th by %+.1f %%",
        100 * (by_nine - 1), 100 * (by_ten - 1), 100 * (1 / bb_value_at(at, &fewer64) - 1));
    if (fabs(by_nine - 1) < 0.01 && fabs(by_ten - 1) < 0.01)
        bb_say(&said->why,
               ": it is not their number that matters on these scenes, but how often they come");
}

/* ---- claims ---- */

/* Flat scenes gain as much as claimed, and more than others; what else is tested of these. */
#define ON_FLAT(flat, others, all, claimed_, ...)                                                  \
    .of = EMC_VARIED, .figures = {&flat, &others, &all, &bb_emc_flatness},                         \
    .tests = {BB_TEST_CLAIMED(0, BB_BELOW, 1, claimed_),                                           \
              {.figure = 0, .side = BB_BELOW, .than = 2},                                          \
              __VA_ARGS__},                                                                        \
    .ours = {{.text = "{0.3} on flat scenes (shortest side below 1/4 of the longest), {1.3} on "   \
                      "others"}},                                                                  \
    .why = {{.each = true,                                                                         \
             .of = 2,                                                                              \
             .first = "per scene: ",                                                               \
             .before = ", ",                                                                       \
             .text = "{scene} (flatness {3.3}) {2.3}"}}

/* One code costs less than another on more scenes than it costs more. */
#define ON_MOST(figure_)                                                                           \
    .of = EMC_VARIED, .figures = {&figure_, &bb_emc_spread, &overlap},                             \
    .tests = {{.over = BB_MORE, .side = BB_BELOW, .bound = 1 - EMC_SAME}},                         \
    .ours = {{.text = "ratio of the two {0~}; lower on {0<0.9995} scenes, higher on {0>1.0005}"}}, \
    .why = {{.each = true,                                                                         \
             .first = "higher on: ",                                                               \
             .before = ", ",                                                                       \
             .text = "{scene} {0.3} (largest over median primitive {1.0}, mean overlap {2.1})",    \
             BB_WHEN(0, BB_ABOVE, 1 + EMC_SAME)}},                                                 \
    .judge = say_same

const bb_paper_claim bb_emc_claims[] = {
    {.text = "EMC-64-var lowers the cost of LBVH on average, and raises it nowhere (5.2)",
     .paper = "0.80 on average, 0.48 to 1.00",
     .of = EMC_VARIED,
     .figures = {&var, &sort, &order, &order_count, &sizes, &fewer, &bb_emc_flatness,
                 &bb_emc_spread},
     .tests = {BB_TEST_CLAIMED(0, BB_BELOW, 1, 0.80), BB_TEST_EACH(0, BB_AT_MOST, 1.005)},
     .ours = {{.text = "EMC-64-sort {1~}; EMC-64-var {0~}"}},
     .why = {{.each = true,
              .text = "{scene}: EMC-64-var {0.3}; by themselves, the order of the axes gives "
                      "{2.3}, with variable counts {3.3}, size bits every 4th {4.3}, 6 size bits "
                      "every 7th {5.3} (flatness {6.3}, largest over median primitive {7.0})",
              BB_WHEN(0, BB_ABOVE, 1.005)}}},
    {.text = "The best costs are those of EMC-64-var, before EMC-64-sort (5.2)",
     .paper = "0.80 and 0.88",
     .of = EMC_VARIED,
     .figures = {&var, &sort, &order_count},
     .tests = {{.figure = 0, .side = BB_BELOW, .than = 2}},
     .ours = {{.text = "EMC-64-var {0.3}, EMC-64-sort {1.3} on average"}},
     .why = {{.each = true,
              .text = "{scene}: var {0.2}, sort {1.2}, order and counts without sizes {2.2}"}}},
    {.text = "The gain of EMC-64-var is highest on flat scenes (5.2)",
     .paper = "0.48 and 0.53 on the two flat scenes, 0.90 on the others",
     ON_FLAT(flat_var, other_var, var, 0.505, )},
    {.text = "EMC-64-var traces diffuse rays faster than MC-64 on average (5.2)",
     .paper = "1.24 times the rays per second on average, 0.95 to 2.01",
     .figures = {&speed},
     .tests = {BB_TEST_CLAIMED(0, BB_ABOVE, 1, 1.24)},
     .ours = {{.text = "EMC-64-var {0~}; mean of the scenes round by round {0}"}},
     .judge = say_slower},
    {.text = "Ray tracing performance follows the cost (5.2)",
     .paper = "closely",
     .judge = judge_speed},
    {.text = "Extended codes do not increase the build time against plain codes of equal length "
             "(5.2)",
     .paper = "0.99 and 1.00 of MC-64 on average",
     .of = EMC_BUILT,
     .rows = bb_emc_equals, /* but for the code that is not in the paper */
     .which = ((1 << EMC_EQUALS) - 1) & ~(1 << EMC_EQUAL_CELL64),
     .together = true,
     .figures = {&bb_emc_build_ratio},
     .tests = {{.over = BB_EACH, .side = BB_AT_MOST, .claimed = 1}},
     .ours = {{.each = true, .first = EMC_PAIRED, .before = ", ", .text = "{row} {0}"}},
     .judge = say_farthest},
    {.text = "Codes are computed fastest by look-up tables (4.5; here: builds are)",
     .paper = "no figures",
     .of = EMC_TABLED,
     .rows = bb_emc_tabled,
     .together = true,
     .figures = {&bb_emc_tabled_codes, &bb_emc_tabled_build}, /* phases have no intervals */
     .tests = {{.figure = 1, .over = BB_EACH, .side = BB_BELOW, .bound = 1}},
     .ours = {{.each = true,
               .first = "over those by shifts, codes and build: ",
               .before = ", ",
               .text = "{row} {0.2}, {1}"}}},
    {.text = "EMC-32-var is nearly as good as EMC-64-var and built faster (5.2)",
     .paper = "performs very well, lower build times; up to some 100k triangles",
     .of = EMC_BUILT,
     .figures = {&short_cost, &short_build, &prims},
     .tests = {BB_TEST_CLAIMED(0, BB_AT_MOST, 0, 1), BB_TEST(1, BB_BELOW, 1)},
     .ours = {{.text = "cost against EMC-64-var {0~}; build time {1~}, round by round {1}"}},
     .why = {{.each = true,
              .of = 1,
              .text = "{scene} ({2.0} primitives): cost {0.3}, build {1.2}"}}},
    {.text = "The order of the axes alone gains on flat scenes, and nothing elsewhere (5.3)",
     .paper = "0.88 and 0.85 on the two flat scenes",
     ON_FLAT(flat_order, other_order, order, 0.865, BB_TEST_CLAIMED(1, BB_AT_LEAST, 0, 1))},
    {.text = "Order and variable counts together gain more on flat scenes, and nothing elsewhere "
             "(5.3)",
     .paper = "0.56 and 0.51 on the two flat scenes",
     ON_FLAT(flat_count, other_count, order_count, 0.535, BB_TEST_CLAIMED(1, BB_AT_LEAST, 0, 1))},
    {.text = "Size bits lower the cost on every scene (5.3)",
     .paper = "0.77 to 0.90",
     .of = EMC_VARIED,
     .figures = {&sizes, &bb_emc_spread},
     .tests = {{.over = BB_EACH, .side = BB_AT_MOST, .bound = 1 - EMC_SAME, .claimed = 0.90}},
     .ours = {{.text = "size every 4th bit {0~}"}},
     .why = {{.each = true,
              .first = "not lower on: ",
              .text = "{scene} {0.4}, its largest primitive {1.1} times its median one",
              .also = ": there is little to tell apart",
              .also_when = &(const bb_test)BB_TEST(1, BB_BELOW, 8),
              BB_WHEN(0, BB_ABOVE, 1 - EMC_SAME)}}},
    {.text = "Where a scene is not flat, size bits gain more than the order of the axes (5.3)",
     .paper = "in most scenes",
     .of = EMC_VARIED,
     .figures = {&sizes_order, &sizes, &order_count, &bb_emc_spread},
     .tests = {{.over = BB_MOST_OF, .side = BB_BELOW, .bound = 1}},
     .ours = {{.text = "on {0<1} of {0#} scenes that are not flat"}},
     .why = {{.each = true,
              .text = "{scene}: sizes {1.3}, order and counts {2.3} (largest over median primitive "
                      "{3.0})"}}},
    {.text = "In 32 bits, fewer size bits are better on most scenes (5.3)",
     .paper = "in the majority",
     ON_MOST(fewer32)},
    {.text = "In 64 bits with the variable order, fewer size bits lower the cost further (5.3)",
     .paper = "further, except on sponza, conference and powerplant",
     .of = EMC_VARIED,
     .figures = {&fewer64},
     .tests = {BB_TEST(0, BB_BELOW, 1)},
     .ours = {{.text = "6 bits every 7th against 16 every 4th {0~}"}},
     .judge = say_fewer},
    {.text = "The diagonal as size is slightly better than the area (4.1)",
     .paper = "slightly better overall",
     ON_MOST(diagonal)},
    {.text = "LBVH with EMC-64-var costs just 20 % more than a full sweep by SAH (5.4)",
     .paper = "1.20 on average",
     .of = EMC_VARIED,
     .figures = {&var_sweep, &plain_sweep},
     .tests = {BB_TEST_CLAIMED(0, BB_AT_MOST, 0, 1.20)},
     .ours = {{.text = "EMC-64-var {0~}; MC-64 {1~}"}},
     .why = {EMC_PER_SCENE("{scene} {0.2} (MC-64 {1.2})")}},
    {.text = NULL},
};
