/* Vinkler, Bittner, Havran: Extended Morton Codes for High Performance Bounding Volume Hierarchy
 * Construction. HPG 2017.
 *
 * Table 2 (cost, trace performance, build time, with LBVH and ATRBVH), the influence of each
 * ingredient (section 5.3) and other builders (section 5.4), as ratios to the plain code of 63 bits
 * on the same builder; then builders of which nobody has published it. The cost's constants are the
 * paper's. With LBVH, codes are compared on the builder `emc`: nothing but the code differs.
 */
#include "framework/papers/emc_methods.h"

#include <math.h>
#include <string.h>

#define SCENES                                                                                     \
    "coffee,mountain,scorpion,city:n=1000000,terrain:n=200000,hairball:n=200000,interior:n=200000" \
    ",spheres:n=200000"
#define QUICK_SCENES "city:n=10000,hairball:n=1000,interior:n=2000"

/* Of builders that take many times as long as LBVH: smaller, and none of spheres, which the paper
 * has nothing like. */
#define INSIDE_SCENES                                                                              \
    "coffee,mountain,scorpion,city:n=200000,terrain:n=100000,hairball:n=100000,interior:n=200000"
#define INSIDE_QUICK_SCENES "city:n=10000,interior:n=2000"

/* The ingredients, in the table's order: builder, what it is, the paper's figures. */
#define INGREDIENTS(ROW)                                                                           \
    ROW(EMC_ORDER, "axes by extent", "0.88 pompeii, 0.85 city, 1.00 others")                       \
    ROW(EMC_ORDER_COUNT, "axes by extent, variable count", "0.56 pompeii, 0.51 city")              \
    ROW(EMC_SIZES, "size every 4th bit", "0.77 to 0.90")                                           \
    ROW(EMC_FEWER_SIZES, "size every 7th bit, 6 bits", "")                                         \
    ROW(EMC_SORT64, "EMC-64-sort", "0.78 to 0.99, mean 0.88")                                      \
    ROW(EMC_VAR64, "EMC-64-var", "0.48 to 1.00, mean 0.80")                                        \
    ROW(EMC_CELL64, "EMC-64-cell (not in the paper)", "")                                          \
    ROW(EMC_CELL64_SIDE, "the same, size by the longest side", "")                                 \
    ROW(EMC_VAR64_ALL_SIZES, "EMC-64-var, size every 4th bit", "")                                 \
    ROW("emc:code=emc64-var,box=scene,size=cell", "EMC-64-var, size against the cell", "")         \
    ROW(EMC_VAR64_CELL_ALL, "the same, every 4th bit", "")                                         \
    ROW(EMC_VAR64_CELL_TEN, "the same, 10 bits", "")                                               \
    ROW("emc:code=emc64-var,box=scene,every=3,size-bits=16,size=cell", "the same, every 3rd bit",  \
        "")                                                                                        \
    ROW(EMC_VAR64_NINE, "EMC-64-var, 9 size bits (algorithm 2)", "")                               \
    ROW("emc:code=mc64,box=centroids", "MC-64, box of the centroids", "")                          \
    ROW("emc:code=emc64-var,box=centroids", "EMC-64-var, box of the centroids", "")                \
    ROW(EMC_VAR64_AREA, "EMC-64-var, size by area", "slightly worse")                              \
    ROW(EMC_SORT64_AREA, "EMC-64-sort, size by area", "slightly worse")                            \
    ROW(EMC_MC32, "MC-32", "")                                                                     \
    ROW(EMC_SORT32, "EMC-32-sort", "")                                                             \
    ROW(EMC_VAR32, "EMC-32-var", "")                                                               \
    ROW(EMC_VAR32_ALL_SIZES, "EMC-32-var, size every 4th bit", "")                                 \
    ROW(EMC_SWEEP, "full sweep SAH, for comparison", "0.67")
#define BUILDER_OF(builder, what, paper) "," builder
#define ROW_OF(builder, what, paper) {builder, what, paper},

static const struct {
    const char *builder, *what, *paper;
} ingredients[] = {INGREDIENTS(ROW_OF)};
enum { INGREDIENT_COUNT = sizeof ingredients / sizeof ingredients[0] };

/* An experiment that traces nothing. */
#define BUILDS_ALONE .kernels = "", .rays = "", .width = 1, .height = 1, .max_rays = 1

static const bb_experiment experiments[] = {
    [EMC_TRACED] = {.name = "codes, traced",
                    .builders = EMC_CODES,
                    .kernels = "stack",
                    .rays = "diffuse",
                    .scenes = SCENES,
                    .quick_scenes = QUICK_SCENES,
                    .takes_scenes = true,
                    .width = 512,
                    .height = 512,
                    .max_rays = 1 << 19,
                    .repeats = BB_INTERVAL_ROUNDS},
    [EMC_BUILT] = {.name = "codes, build times",
                   .builders = EMC_CODES,
                   BUILDS_ALONE,
                   .scenes = SCENES,
                   .quick_scenes = QUICK_SCENES,
                   .takes_scenes = true,
                   .repeats = 40},
    [EMC_VARIED] = {.name = "influence of each ingredient",
                    .builders = EMC_MC64 INGREDIENTS(BUILDER_OF),
                    BUILDS_ALONE,
                    .scenes = SCENES,
                    .quick_scenes = QUICK_SCENES,
                    .takes_scenes = true,
                    .repeats = 1}, /* its costs are compared, not its times */
    [EMC_SIZED] = {.name = "number of primitives",
                   .builders = EMC_CODES,
                   BUILDS_ALONE,
                   .scenes = "random:n=#",
                   .quick_scenes = "random:n=#",
                   .repeats = 9},
    [EMC_INSIDE] = {.name = "codes inside other builders",
                    .builders = EMC_INSIDE_BUILDERS,
                    .optional_builders = true,
                    .kernels = "stack",
                    .rays = EMC_INSIDE_RAYS,
                    .scenes = INSIDE_SCENES,
                    .quick_scenes = INSIDE_QUICK_SCENES,
                    .takes_scenes = true,
                    .width = 256,
                    .height = 256,
                    .max_rays = 1 << 16,
                    .max_views = 2,
                    .repeats = BB_INTERVAL_ROUNDS},
    [EMC_CENTRED] = {.name = "the same in the box of the centroids, and a full sweep",
                     .builders = EMC_CENTRED_BUILDERS,
                     .optional_builders = true,
                     BUILDS_ALONE,
                     .scenes = INSIDE_SCENES,
                     .quick_scenes = INSIDE_QUICK_SCENES,
                     .takes_scenes = true,
                     .repeats = 1}, /* its costs alone */
    {.name = NULL},
};

/* ---- the paper's table 2, LBVH: MC-64 as it is, then the ratios of EMC-64-sort and EMC-64-var
 * ---- */

typedef enum figure { COST, SPEED, BUILD } figure;
static const struct {
    const char *name;
    double prims, figures[3][3];
} paper_rows[] = {
    {"sponza", 76e3, {{97, .88, .96}, {75, 1.01, .95}, {5.1, 1.02, 1.00}}},
    {"conference", 331e3, {{65, .78, .78}, {80, 1.17, 1.23}, {13.0, .97, 1.01}}},
    {"sodahall", 2169e3, {{101, .91, .94}, {113, 1.01, .99}, {65.3, .99, .99}}},
    {"hairball", 2880e3, {{542, .99, 1.00}, {7, 1.02, 1.01}, {88.5, .99, 1.02}}},
    {"pompeii", 5646e3, {{180, .84, .53}, {19, 1.11, 1.47}, {158.5, 1.00, 1.03}}},
    {"san-miguel", 7880e3, {{94, .87, .82}, {19, 1.12, 1.17}, {234.4, .96, .99}}},
    {"city", 8737e3, {{121, .83, .48}, {30, 1.18, 2.01}, {261.4, .98, .99}}},
    {"powerplant", 12759e3, {{49, .90, .91}, {25, 1.13, 1.09}, {355.3, 1.00, .99}}},
};
enum { PAPER_ROWS = sizeof paper_rows / sizeof paper_rows[0] };
static const double paper_means[3][2] = {{.88, .80}, {1.09, 1.24}, {.99, 1.00}};

/* ---- our figures ---- */

static double absolute_of(const bb_findings *all, figure what, const char *scene)
{
    switch (what) {
    case COST:
        return bb_found_sah(&all[EMC_VARIED], scene, EMC_MC64);
    case SPEED:
        return bb_found_mrays(&all[EMC_TRACED], (bb_selection){scene, EMC_MC64, "stack", NULL});
    default:
        return bb_found_build_ms(&all[EMC_BUILT], scene, EMC_MC64);
    }
}

static double ratio_of(const bb_findings *all, figure what, const char *scene, const char *builder)
{
    switch (what) {
    case COST:
        return bb_emc_cost_ratio(all, scene, builder, EMC_MC64);
    case SPEED:
        return bb_emc_speed_ratio(all, scene, builder, EMC_MC64).value;
    default:
        return bb_emc_build_ratio(all, scene, builder, EMC_MC64).value;
    }
}

/* ---- tables ---- */

static const struct {
    const char *name, *builder;
} compared[] = {{"EMC-64-sort", EMC_SORT64}, {"EMC-64-var", EMC_VAR64},
                {"EMC-64-cell", EMC_CELL64}, {"MC-32", EMC_MC32},
                {"EMC-32-sort", EMC_SORT32}, {"EMC-32-var", EMC_VAR32}};
enum { COMPARED = sizeof compared / sizeof compared[0], IN_PAPER = 2 };

static void add_averages(const bb_findings *all, bb_reproduction *r, figure what)
{
    const bb_findings *f = &all[EMC_TRACED];
    bb_paper_row(r);
    bb_paper_text(r, "average (paper)");
    for (int i = 0; i < 3; i++)
        bb_paper_number(r, NAN, 0);
    for (int i = 0; i < COMPARED; i++)
        bb_paper_number(r, i < IN_PAPER ? paper_means[what][i] : (double)NAN, 2);
    bb_paper_row(r);
    bb_paper_text(r, "average (here)");
    for (int i = 0; i < 3; i++)
        bb_paper_number(r, NAN, 0);
    for (int i = 0; i < COMPARED; i++) {
        double values[BB_FIGURES_MAX];
        for (size_t s = 0; s < f->scene_count; s++)
            values[s] = ratio_of(all, what, f->scenes[s], compared[i].builder);
        bb_paper_number(r, bb_mean(values, f->scene_count), 2);
    }
}

static void add_table2(const bb_findings *all, bb_reproduction *r, figure what, const char *title,
                       const char *unit)
{
    const char *columns[4 + COMPARED + 1] = {"scene", "primitives", "flatness", unit};
    for (int i = 0; i < COMPARED; i++)
        columns[4 + i] = compared[i].name;
    const bb_findings *f = &all[EMC_TRACED];
    bb_paper_table(r, title, columns);
    for (int i = 0; i < PAPER_ROWS; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s (paper)", paper_rows[i].name);
        bb_paper_row(r);
        bb_paper_text(r, name);
        bb_paper_number(r, paper_rows[i].prims, 0);
        bb_paper_number(r, NAN, 0);
        bb_paper_number(r, paper_rows[i].figures[what][0], 1);
        for (int k = 0; k < COMPARED; k++)
            bb_paper_number(r, k < IN_PAPER ? paper_rows[i].figures[what][1 + k] : (double)NAN, 2);
    }
    for (size_t s = 0; s < f->scene_count; s++) {
        bb_paper_row(r);
        bb_paper_text(r, f->scenes[s]);
        bb_paper_number(r, bb_found_scene(f, f->scenes[s], BB_F_SCENE_PRIMS), 0);
        bb_paper_number(r, bb_found_scene(f, f->scenes[s], BB_F_PROFILE_FLATNESS), 3);
        bb_paper_number(r, absolute_of(all, what, f->scenes[s]), 1);
        for (int k = 0; k < COMPARED; k++)
            bb_paper_number(r, ratio_of(all, what, f->scenes[s], compared[k].builder), 2);
    }
    add_averages(all, r, what);
}

static void add_ingredients(const bb_findings *all, bb_reproduction *r)
{
    const bb_findings *f = &all[EMC_VARIED];
    const char *columns[BB_FIGURES_MAX + 4] = {"ingredient"};
    size_t count = 1, best = 0;
    double best_mean = INFINITY;
    for (size_t s = 0; s < f->scene_count && count < 24; s++)
        columns[count++] = f->scenes[s];
    columns[count++] = "average";
    columns[count++] = "paper";
    for (size_t i = 0; i < INGREDIENT_COUNT; i++) {
        bb_paper_figures s = bb_emc_costs(all, ingredients[i].builder, EMC_MC64);
        if (strcmp(ingredients[i].builder, EMC_SWEEP) != 0 && bb_figures_mean(&s) < best_mean) {
            best_mean = bb_figures_mean(&s);
            best = i;
        }
    }
    bb_words title = {0};
    bb_paper_figures var = bb_emc_costs(all, EMC_VAR64, EMC_MC64);
    bb_say(&title,
           "Influence of each ingredient (section 5.3, and beyond): cost as a ratio to MC-64. Best "
           "code on average: %s, %.3f; EMC-64-var: %.3f",
           ingredients[best].builder, best_mean, bb_figures_mean(&var));
    bb_paper_table(r, title.text, columns);
    for (size_t i = 0; i < INGREDIENT_COUNT; i++) {
        bb_paper_figures s = bb_emc_costs(all, ingredients[i].builder, EMC_MC64);
        bb_paper_row(r);
        bb_paper_text(r, ingredients[i].what);
        for (size_t k = 0; k + 3 < count; k++)
            bb_paper_number(r, s.values[k], 3);
        bb_paper_number(r, bb_figures_mean(&s), 3);
        bb_paper_text(r, ingredients[i].paper);
    }
}

static void add_build_ratio(bb_reproduction *r, const char *scene, int pair, bb_estimate e)
{
    bb_paper_row(r);
    bb_paper_text(r, scene);
    bb_paper_text(r, bb_emc_equals[pair].builder);
    bb_paper_text(r, bb_emc_equals[pair].plain);
    bb_paper_number(r, e.value, 3);
    bb_paper_number(r, e.low, 3);
    bb_paper_number(r, e.high, 3);
    bb_paper_number(r, bb_emc_build_target, 2);
    bb_claim_verdict within = bb_below(e, bb_emc_build_target);
    bb_paper_text(r, within == BB_HELD       ? "yes"
                     : within == BB_NOT_HELD ? "no"
                                             : bb_verdict_words(within));
}

static void add_build_ratios(const bb_findings *all, bb_reproduction *r)
{
    static const char *const columns[] = {"scene", "code",   "against",   "ratio", "95 % from",
                                          "to",    "target", "within it", NULL};
    const bb_findings *f = &all[EMC_BUILT];
    bb_paper_table(
        r,
        "Build time of each extended code against the plain code of equal length: median of "
        "the ratios of paired builds",
        columns);
    for (int i = 0; i < EMC_EQUALS; i++) {
        for (size_t s = 0; s < f->scene_count; s++)
            add_build_ratio(r, f->scenes[s], i,
                            bb_emc_build_ratio(all, f->scenes[s], bb_emc_equals[i].builder,
                                               bb_emc_equals[i].plain));
        add_build_ratio(r, "all scenes (geometric)", i,
                        bb_found_build_ratios(f, bb_emc_equals[i].builder, bb_emc_equals[i].plain));
    }
}

static void add_sizes(const bb_findings *all, bb_reproduction *r)
{
    static const char *const builders[] = {EMC_MC32,   EMC_SORT32, EMC_VAR32, EMC_MC64,
                                           EMC_SORT64, EMC_VAR64,  EMC_CELL64};
    static const char *const columns[] = {"primitives", "MC-32",       "EMC-32-sort",
                                          "EMC-32-var", "MC-64",       "EMC-64-sort",
                                          "EMC-64-var", "EMC-64-cell", NULL};
    const bb_findings *f = &all[EMC_SIZED];
    bb_paper_table(r, "Build rate over the number of primitives (random triangles), Mprims/s",
                   columns);
    for (size_t s = 0; s < f->scene_count; s++) {
        double prims = bb_found_scene(f, f->scenes[s], BB_F_SCENE_PRIMS);
        bb_paper_row(r);
        bb_paper_number(r, prims, 0);
        for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++)
            bb_paper_number(r, prims / bb_found_build_ms(f, f->scenes[s], builders[i]) / 1e3, 2);
    }
}

static void evaluate(const bb_findings *all, const void *measured, bb_reproduction *r)
{
    (void)measured;
    add_table2(all, r, COST, "LBVH, cost (SAH): of MC-64, and ratios to it", "MC-64");
    add_table2(all, r, SPEED,
               "LBVH, trace performance of diffuse rays: Mrays/s of MC-64, and ratios",
               "MC-64 Mrays/s");
    add_table2(all, r, BUILD, "LBVH, build time: ms of MC-64, and ratios to it", "MC-64 ms");
    add_build_ratios(all, r);
    add_ingredients(all, r);
    add_sizes(all, r);
    bb_emc_scenes(all, r);
    bb_emc_others(all, r);
    bb_emc_builders(all, r);
    bb_emc_inside(all, r);
    bb_emc_claims(all, r);
    bb_emc_other_claims(all, r);
    bb_emc_inside_claims(all, r);
    bb_emc_builder_claims(all, r);
}

extern const bb_paper bb_paper_emc;
const bb_paper bb_paper_emc = {
    .name = "emc",
    .title = "Vinkler, Bittner, Havran 2017: Extended Morton Codes for High Performance Bounding "
             "Volume Hierarchy Construction",
    .experiments = experiments,
    .evaluate = evaluate,
};
