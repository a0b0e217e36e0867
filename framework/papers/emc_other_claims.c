/* Claims of Vinkler, Bittner, Havran 2017 on other builders (sections 5.2, 5.4), then of builders
 * that are in no paper. That cost (SAH) and what rays meet do not go together for all kinds of
 * builders: Aila, Karras, Laine 2013, On Quality Metrics of Bounding Volume Hierarchies.
 */
#include "framework/papers/emc.h"

#include <math.h>

#define OF_ATRBVH(what_, code, ...)                                                                \
    {                                                                                              \
        .what = what_, .builder = EMC_ATRBVH_OF(code), .base = EMC_ATRBVH_OF("mc64"),              \
        .mean = BB_MEAN_GEOMETRIC, __VA_ARGS__                                                     \
    }
static const bb_figure atrbvh_speed =
                           OF_ATRBVH("trace_ms", "emc64-var", .rays = "diffuse", .inverse = true),
                       atrbvh_sort = OF_ATRBVH("build_ms", "emc64-sort", ),
                       atrbvh_var = OF_ATRBVH("build_ms", "emc64-var", ),
                       lbvh_cost = {.what = "sah", .builder = EMC_VAR64, .base = EMC_MC64},
                       hlbvh_work = {.what = "work",
                                     .rays = "random",
                                     .builder = EMC_HLBVH_MC64,
                                     .base = EMC_MC64},
                       radius_cost = {.what = "sah", .base = EMC_PLOC_CENTRED};

/* ---- words that no row says ---- */

/* On how many scenes EMC-64-var takes a builder from above the sweep's cost to it or below. */
static void judge_bridged(bb_paper_place at, bb_said *said)
{
    static const bb_figure *const figures[] = {&bb_emc_plain_over_sweep, &bb_emc_var_over_sweep};
    uint32_t bridged = 0, above = 0;
    for (int m = EMC_LBVH; m <= EMC_AAC_HQ; m++) {
        at.row = &bb_emc_methods[m];
        const bb_paper_series s = bb_figure_series(at, figures[0]);
        for (size_t i = 0; i < s.count; i++) {
            const double with = bb_value_at(s.places[i], figures[1]);
            above += s.each[i].value > 1 && !isnan(with);
            if (!(s.each[i].value > 1 && with <= 1))
                continue;
            bridged++;
            bb_say(&said->ours, "%s", said->ours.length > 0 ? "; " : "");
            bb_say_text(&said->ours, "{row} on {scene}: {0.2}, {1.2}", s.places[i], figures);
        }
    }
    if (bridged < 2)
        bb_say(&said->why,
               "%u of %u pairs of scene and builder that cost more than the sweep with MC-64",
               bridged, above);
    said->verdict = above == 0 ? BB_NOT_TESTED : bridged >= 2 ? BB_HELD : BB_NOT_HELD;
}

/* Does what is saved in cost show in what rays meet? */
static void judge_work(bb_paper_place at, bb_said *said)
{
    uint32_t pairs = 0, follow = 0;
    for (at.row = bb_emc_methods; at.row->name != NULL; at.row++) {
        const double costs = bb_value_at(at, &bb_emc_inside[EMC_COST]);
        for (int k = 0; k < EMC_KINDS && costs < 1 - EMC_SAME; k++) {
            const double work = bb_value_at(at, &bb_emc_inside[EMC_WORK + k]);
            pairs += !isnan(work);
            follow += work < 1 - EMC_SAME;
            if (work >= 1 - EMC_SAME)
                bb_say(&said->why, "%s%s: cost %.3f, work per %s ray %.3f",
                       said->why.length > 0 ? "; " : "", at.row->name, costs, bb_emc_rays[k], work);
        }
    }
    bb_say(&said->ours,
           "lower in %u of %u pairs of builder and kind of rays, by the means of the scenes",
           follow, pairs);
    said->verdict = pairs == 0 ? BB_NOT_TESTED : follow == pairs ? BB_HELD : BB_NOT_HELD;
}

static void say_missing(bb_paper_place at, bb_said *said)
{
    for (at.row = bb_emc_methods; at.row->name != NULL; at.row++)
        if (at.row != &bb_emc_methods[EMC_LBVH] && at.row != &bb_emc_methods[EMC_ATRBVH])
            bb_say_missing(at.row->builder, &said->why);
}

/* ---- claims ---- */

#define OF_METHODS(which_) .of = EMC_INSIDE, .rows = bb_emc_methods, .which = which_
#define IN_NO_PAPER .paper = "not published"

/* EMC-64-var lowers the mean cost of a builder. */
#define LOWER(method, section, claimed_, paper_)                                                   \
    {                                                                                              \
        .text = "EMC-64-var lowers the cost of {row} on average (" section ")", .paper = paper_,   \
        OF_METHODS(1 << method), .figures = {&bb_emc_inside[EMC_COST]},                            \
        .tests = {BB_TEST_CLAIMED(0, BB_BELOW, 1, claimed_)},                                      \
        .ours = {{.text = "ratio to MC-64 {0~}"}}, .why = {                                        \
            EMC_PER_SCENE("{scene} {0.3}")                                                         \
        }                                                                                          \
    }

#define NEAR_SWEEP(method, more)                                                                   \
    {                                                                                              \
        .text = "{row} with EMC-64-var costs " #more " % more than a full sweep (5.4)",            \
        .paper = #more " % on average", OF_METHODS(1 << method),                                   \
        .figures = {&bb_emc_var_over_sweep, &bb_emc_plain_over_sweep},                             \
        .tests = {BB_TEST_CLAIMED(0, BB_AT_MOST, 0, 1 + more / 100.0)},                            \
        .ours = {{.text = "EMC-64-var {0~}; MC-64 {1~}"}}, .why = {                                \
            EMC_PER_SCENE("{scene} {0.3}")                                                         \
        }                                                                                          \
    }

#define SLOWER_KIND(test, name, work)                                                              \
    {                                                                                              \
        .text = name ": counted work {" work "}", .unless_test = test + 1, BB_MEASURED(test)       \
    }

enum {
    AGGLOMERATIVE = 1 << EMC_AAC_HQ | 1 << EMC_AAC_FAST | 1 << EMC_PLOC | 1 << EMC_HPLOC,
    UNPUBLISHED = 1 << EMC_PLOC | 1 << EMC_HPLOC | 1 << EMC_TRBVH | 1 << EMC_REINSERTION,
    NOT_LBVH = ((1 << EMC_METHODS) - 1) & ~(1 << EMC_LBVH),
};

const bb_paper_claim bb_emc_other_claims[] = {
    LOWER(EMC_ATRBVH, "5.2", 0.93, "0.93 on average, 0.74 to 1.02"),
    {.text = "The impact on ATRBVH is smaller than on LBVH (5.2)",
     .paper = "0.93 and 0.80 on average",
     OF_METHODS(1 << EMC_ATRBVH),
     .figures = {&bb_emc_inside[EMC_COST], &lbvh_cost},
     .tests = {{.side = BB_ABOVE, .than = 2}},
     .ours = {{.text = "ATRBVH {0.3}, LBVH {1.3} on average"}},
     .why = {EMC_PER_SCENE("{scene} {0.3}")}},
    {.text = "EMC-64-var traces diffuse rays faster than MC-64 with ATRBVH, on average (5.2)",
     .paper = "1.07 times the rays per second on average, 0.96 to 1.31",
     OF_METHODS(1 << EMC_ATRBVH),
     .figures = {&atrbvh_speed},
     .tests = {BB_TEST_CLAIMED(0, BB_ABOVE, 1, 1.07)},
     .ours = {{.text = "geometric mean of the scenes round by round {0}"}}},
    {.text = "Extended codes do not increase the build time of ATRBVH (5.2)",
     .paper = "0.99 and 0.99 of MC-64 on average",
     OF_METHODS(1 << EMC_ATRBVH),
     .figures = {&atrbvh_sort, &atrbvh_var},
     .tests = {BB_TEST_CLAIMED(0, BB_AT_MOST, 0, 1), BB_TEST_CLAIMED(1, BB_AT_MOST, 0, 1)},
     .ours = {{.text = EMC_PAIRED "EMC-64-sort {0}, EMC-64-var {1}"}}},
    LOWER(EMC_HLBVH, "5.4", 0.84, "0.84 on average"),
    LOWER(EMC_AAC_HQ, "5.4; the paper does not say which AAC", 0.89, "0.89 on average"),
    NEAR_SWEEP(EMC_HLBVH, 11),
    NEAR_SWEEP(EMC_AAC_HQ, 3),
    {.text = "In a number of scenes, EMC bridges the gap of LBVH, HLBVH or AAC to a full sweep "
             "(5.4); held from two",
     .paper = "in a number of scenes",
     .of = EMC_INSIDE,
     .judge = judge_bridged},

    {.text = "EMC-64-var lowers the cost of {row} on average, whether the box of the scene or of "
             "the centroids is divided",
     IN_NO_PAPER,
     OF_METHODS(UNPUBLISHED),
     .figures = {&bb_emc_inside[EMC_COST], &bb_emc_centred},
     .tests = {BB_TEST(0, BB_BELOW, 1 - EMC_SAME), BB_TEST(1, BB_BELOW, 1 - EMC_SAME)},
     .ours = {{.text = "ratio to MC-64 in the scene's box {0~}; in that of the centroids {1~}"}},
     .why = {{.each = true, .first = "per scene: ", .text = "{scene} {0.3}, {1.3}"}}},
    {.text = "EMC-64-var makes rays of every kind faster with {row}, on average",
     IN_NO_PAPER,
     OF_METHODS(NOT_LBVH),
     .figures = {&bb_emc_inside[EMC_TIME], &bb_emc_inside[EMC_TIME + 1],
                 &bb_emc_inside[EMC_TIME + 2], &bb_emc_inside[EMC_TIME + 3],
                 &bb_emc_inside[EMC_WORK], &bb_emc_inside[EMC_WORK + 1],
                 &bb_emc_inside[EMC_WORK + 2], &bb_emc_inside[EMC_WORK + 3]},
     .tests = {BB_TEST(0, BB_BELOW, 1), BB_TEST(1, BB_BELOW, 1), BB_TEST(2, BB_BELOW, 1),
               BB_TEST(3, BB_BELOW, 1)},
     .ours = {{.text = "time, geometric mean of the scenes round by round: primary {0}, diffuse "
                       "{1}, shadow {2}, random {3}"}},
     .why = {SLOWER_KIND(0, "primary", "4.3"), SLOWER_KIND(1, "diffuse", "5.3"),
             SLOWER_KIND(2, "shadow", "6.3"), SLOWER_KIND(3, "random", "7.3")}},
    {.text = "Where EMC-64-var lowers a builder's mean cost, it lowers the counted work of rays of "
             "every kind",
     IN_NO_PAPER,
     .of = EMC_INSIDE,
     .judge = judge_work},
    {.text = "EMC-64-var does not increase the build time of other builders",
     IN_NO_PAPER,
     OF_METHODS(NOT_LBVH & ~(1 << EMC_ATRBVH)), /* of which the paper says so */
     .together = true,
     .figures = {&bb_emc_inside[EMC_BUILD]},
     .tests = {{.over = BB_EACH, .side = BB_AT_MOST, .claimed = 1}},
     .ours = {{.each = true, .first = EMC_PAIRED, .before = ", ", .text = "{row} {0}"}},
     .judge = say_missing},

    {.text = "Cost (SAH) flatters agglomerative builders: over LBVH, they save less counted work "
             "of random rays than cost",
     .paper = "not of this paper",
     OF_METHODS(AGGLOMERATIVE),
     .together = true,
     .figures = {&bb_emc_beside[EMC_COST], &bb_emc_beside[EMC_WORK + 3]},
     .tests = {{.figure = 1, .over = BB_EACH, .side = BB_ABOVE, .than = 1}},
     .ours = {{.each = true, .text = "{row}: cost {0.3}, work {1.3}", BB_MEASURED(1)}},
     .why = {{.each = true,
              .text = "{row} saves no less work than cost",
              .unless = true,
              BB_MEASURED(1)}}},
    {.text = "HLBVH asks for less counted work of random rays than AAC, PLOC (radius 8) and H-PLOC",
     .paper = "not of this paper",
     OF_METHODS(AGGLOMERATIVE),
     .together = true,
     .figures = {&bb_emc_beside[EMC_WORK + 3], &hlbvh_work},
     .tests = {{.over = BB_EACH, .side = BB_ABOVE, .than = 2}},
     .ours = {{.text = "over LBVH: HLBVH {1.3}", BB_MEASURED(1)},
              {.each = true, .before = ", ", .text = "{row} {0.3}", BB_MEASURED(0)}},
     .why = {{.each = true, .text = "{row} works no more", .unless = true, BB_MEASURED(0)}}},
    {.text = "PLOC's cost hardly changes on average with a radius beyond 8",
     .paper = "not of this paper",
     .of = EMC_CENTRED,
     .rows = bb_emc_radii,
     .together = true,
     .figures = {&radius_cost},
     .tests = {{.over = BB_EACH, .side = BB_EQUAL, .claimed = 1}},
     .ours = {{.each = true, .text = "radius {row} {0~}"}},
     .why = {{.each = true, .text = "radius {row}: {0%1}", .unless = true, BB_MEASURED(0)}}},
    {.text = NULL},
};
