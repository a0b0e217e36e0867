/* Gu, Jendersie, Grosch: Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees. VMV 2018.
 *
 * Build, trace and build + trace of one frame of primary rays, and memory, of LBVH, LLBVH and
 * LOBVH, on mixtures of spheres (section 4.1, figure 5) and on triangles (section 4.2, figure 6);
 * the size that a box's level is taken from (section 3.1), and the order by the view's direction
 * (section 3.4). The figures' bars have no numbers in the text: of the paper there are its words,
 * and their ratios where it gives some. As there, codes have 30 bits, LOBVH is ordered by the view
 * that is traced, and is traced without a stack, the binary trees with one. The frame has 1024x768
 * pixels, from each scene's first view.
 */
#include "framework/papers/loose_octree_figures.h"

#include <math.h>
#include <stdio.h>

#define SPHERES "spheres:n=1000000,state=initial,spheres:n=1000000,state=settled"
#define QUICK_SPHERES "spheres:n=2000,state=initial,spheres:n=2000,state=settled"
#define TRIANGLES "coffee,mountain,scorpion,city:n=200000,hairball:n=1000000,interior:n=200000"
#define QUICK_TRIANGLES "hairball:n=2000,interior:n=2000"
/* What experiments share: these scenes, or those asked for; the paper's frame. */
#define ON_TRIANGLES .scenes = TRIANGLES, .quick_scenes = QUICK_TRIANGLES, .takes_scenes = true
#define ONE_FRAME .width = 1024, .height = 768, .max_rays = 1, .max_views = 1
#define VIEWS_OF(builder) builder "," builder ",view=0," builder ",view=1," builder ",view=2"

static const bb_experiment experiments[] = {
    [OF_SPHERES] = {.name = "mixtures of spheres",
                    .builders = RIVALS,
                    .kernels = STACK,
                    .native = true,
                    .rays = "primary",
                    .scenes = SPHERES,
                    .quick_scenes = QUICK_SPHERES,
                    ONE_FRAME,
                    .repeats = 7},
    [OF_TRIANGLES] = {.name = "triangles",
                      .builders = RIVALS,
                      .kernels = STACK,
                      .native = true,
                      .rays = "primary",
                      ON_TRIANGLES,
                      ONE_FRAME,
                      .repeats = BB_INTERVAL_ROUNDS},
    [OF_SIZES] = {.name = "the size of a box",
                  .builders = SIZE_VARIANTS,
                  .kernels = STACK,
                  .rays = "primary",
                  ON_TRIANGLES,
                  ONE_FRAME,
                  .repeats = BB_INTERVAL_ROUNDS},
    [OF_VIEWS] =
        {.name = "order by the view",
         .builders = VIEWS_OF(LBVH30) "," VIEWS_OF(LLBVH30) "," VIEWS_OF(LOBVH_VIEWLESS),
         .kernels = STACK "," STACKLESS,
         .rays = "primary:tmin=0", /* the default, but not the set of the frames above */
         .scenes = SPHERES,
         .quick_scenes = QUICK_SPHERES,
         .takes_scenes = true,
         .width =
             256, /* without an order, a ray of the stackless kernel may meet thousands of boxes */
         .height = 192,
         .max_rays = 1,
         .max_views = VIEWS,
         .repeats = BB_INTERVAL_ROUNDS},
    {.name = NULL},
};

/* ---- tables ---- */

static const double mib = 1.0 / (1 << 20);

static void add_frame(const bb_findings *f, bb_reproduction *r, bb_selection cell)
{
    const char *scene = cell.scene, *builder = cell.builder;
    double ms = bb_found_build_ms(f, scene, builder) + bb_found_trace_ms(f, cell);
    bb_paper_row(r);
    bb_paper_text(r, scene);
    bb_paper_number(r, bb_found_scene(f, scene, BB_F_SCENE_PRIMS), 0);
    bb_paper_text(r, builder);
    bb_paper_text(r, cell.kernel);
    bb_paper_number(r, bb_found_build_ms(f, scene, builder), 2);
    bb_paper_number(r, bb_found_trace_ms(f, cell), 2);
    bb_paper_number(r, ms, 2);
    bb_paper_number(r, ms / frame_ms(f, scene, LBVH30, STACK), 3);
    bb_paper_number(r, bb_found_sah(f, scene, builder), 1);
    bb_paper_number(r, bb_found_tests(f, cell, BB_F_TRACE_NODE_TESTS), 1);
    bb_paper_number(r, bb_found_tests(f, cell, BB_F_TRACE_PRIM_TESTS), 1);
    bb_paper_number(r, bb_found_tree(f, scene, builder, BB_F_TREE_BYTES) * mib, 1);
    bb_paper_number(r, bb_found_tree(f, scene, builder, BB_F_TREE_BYTES_PEAK) * mib, 1);
}

/* A builder that was refused has one row without times; a pair that is no part of the comparison
 * has none. */
static void add_frames(const bb_findings *f, bb_reproduction *r, const char *title)
{
    static const char *const columns[] = {
        "scene",   "primitives", "builder",   "kernel",    "build ms", "trace ms", "both ms",
        "to LBVH", "SAH",        "boxes/ray", "prims/ray", "tree MiB", "peak MiB", NULL};
    bb_paper_table(r, title, columns);
    for (size_t s = 0; s < f->scene_count; s++)
        for (uint32_t i = 0; i < RIVAL_COUNT; i++) {
            bb_selection stack = {f->scenes[s], rivals[i], STACK, NULL};
            bb_selection stackless = {f->scenes[s], rivals[i], STACKLESS, NULL};
            add_frame(f, r, stack);
            if (!isnan(bb_found_trace_ms(f, stackless)))
                add_frame(f, r, stackless);
        }
}

/* What each method's frame takes in the paper's configuration, as ratios to LBVH: per scene and on
 * average. */
static void add_averages(const bb_findings *all, bb_reproduction *r)
{
    static const char *const columns[] = {
        "scene", "LBVH ms", "LLBVH", "LOBVH, best of 6 to 8", "its level", "LOBVH, auto", NULL};
    bb_paper_table(
        r,
        "Build + trace of a frame in the paper's configuration (binary trees with the stack "
        "kernel, LOBVH with the stackless one), ratios to LBVH",
        columns);
    double ratios[3][BB_FIGURES_MAX];
    for (int e = OF_SPHERES; e <= OF_TRIANGLES; e++) {
        const bb_findings *f = &all[e];
        for (size_t s = 0; s < f->scene_count; s++) {
            const char *scene = f->scenes[s], *best = best_lobvh(f, scene);
            double base = frame_ms(f, scene, LBVH30, STACK);
            ratios[0][s] = frame_ms(f, scene, LLBVH30, STACK) / base;
            ratios[1][s] = frame_ms(f, scene, best, STACKLESS) / base;
            ratios[2][s] = frame_ms(f, scene, LOBVH_AUTO, STACKLESS) / base;
            bb_paper_row(r);
            bb_paper_text(r, scene);
            bb_paper_number(r, base, 2);
            bb_paper_number(r, ratios[0][s], 3);
            bb_paper_number(r, ratios[1][s], 3);
            bb_paper_number(r, level_of(best), 0);
            bb_paper_number(r, ratios[2][s], 3);
        }
        bb_paper_row(r);
        bb_paper_text(r, e == OF_SPHERES ? "average, spheres (here)" : "average, triangles (here)");
        bb_paper_number(r, NAN, 0);
        bb_paper_number(r, bb_mean(ratios[0], f->scene_count), 3);
        bb_paper_number(r, bb_mean(ratios[1], f->scene_count), 3);
        bb_paper_number(r, NAN, 0);
        bb_paper_number(r, bb_mean(ratios[2], f->scene_count), 3);
        bb_paper_row(r);
        bb_paper_text(r, e == OF_SPHERES ? "spheres (paper)" : "triangles (paper)");
        bb_paper_number(r, NAN, 0);
        bb_paper_text(r, e == OF_SPHERES ? "above 1" : "about 1, 0.96 on hairball");
        bb_paper_text(r, e == OF_SPHERES ? "below 1" : "above 1, below on hairball");
        bb_paper_text(r, e == OF_SPHERES ? "6" : "6 or 7");
        bb_paper_number(r, NAN, 0);
    }
}

static void add_sizes(const bb_findings *all, bb_reproduction *r)
{
    static const char *const columns[] = {"scene", "builder",   "build ms",  "trace ms", "both ms",
                                          "SAH",   "boxes/ray", "prims/ray", "tree MiB", NULL};
    const bb_findings *f = &all[OF_SIZES];
    bb_paper_table(r, "LLBVH: the size that a box's level is taken from, fit test, size bits",
                   columns);
    for (size_t s = 0; s < f->scene_count; s++)
        for (uint32_t i = 0; i < SIZE_VARIANT_COUNT; i++) {
            const char *scene = f->scenes[s], *builder = size_variants[i];
            bb_selection cell = {scene, builder, STACK, NULL};
            bb_paper_row(r);
            bb_paper_text(r, scene);
            bb_paper_text(r, builder);
            bb_paper_number(r, bb_found_build_ms(f, scene, builder), 2);
            bb_paper_number(r, bb_found_trace_ms(f, cell), 2);
            bb_paper_number(r, frame_ms(f, scene, builder, STACK), 2);
            bb_paper_number(r, bb_found_sah(f, scene, builder), 2);
            bb_paper_number(r, bb_found_tests(f, cell, BB_F_TRACE_NODE_TESTS), 1);
            bb_paper_number(r, bb_found_tests(f, cell, BB_F_TRACE_PRIM_TESTS), 1);
            bb_paper_number(r, bb_found_tree(f, scene, builder, BB_F_TREE_BYTES) * mib, 1);
        }
}

static void add_views(const bb_findings *all, bb_reproduction *r)
{
    static const char *const columns[] = {"scene",  "builder",   "kernel", "view",
                                          "factor", "95 % from", "to",     "worst other order",
                                          NULL};
    const bb_findings *f = &all[OF_VIEWS];
    bb_paper_table(
        r,
        "Order by the view that is traced: rays per second over those without an order, and "
        "with the order of another view",
        columns);
    for (size_t s = 0; s < f->scene_count; s++)
        for (uint32_t i = 0; i < 3; i++)
            for (uint32_t k = 0; k < 2; k++)
                for (int v = 0; v < VIEWS; v++) {
                    const char *kernel = k == 0 ? STACK : STACKLESS;
                    bb_estimate e = view_factor(f, f->scenes[s], ordered[i], kernel, v, v);
                    double worst = NAN;
                    for (int other = 0; other < VIEWS; other++)
                        if (other != v)
                            worst = fmin(
                                worst,
                                view_factor(f, f->scenes[s], ordered[i], kernel, v, other).value);
                    bb_paper_row(r);
                    bb_paper_text(r, f->scenes[s]);
                    bb_paper_text(r, ordered[i]);
                    bb_paper_text(r, kernel);
                    bb_paper_text(r, bb_found_view(f, f->scenes[s], v));
                    bb_paper_number(r, e.value, 3);
                    bb_paper_number(r, e.low, 3);
                    bb_paper_number(r, e.high, 3);
                    bb_paper_number(r, worst, 3);
                }
}

static void evaluate(const bb_findings *all, const void *measured, bb_reproduction *r)
{
    (void)measured;
    add_averages(all, r);
    add_frames(&all[OF_SPHERES], r, "A frame of mixtures of spheres (section 4.1, figure 5)");
    add_frames(&all[OF_TRIANGLES], r, "A frame of triangles (section 4.2, figure 6)");
    add_sizes(all, r);
    add_views(all, r);
    bb_loose_octree_claims(all, r);
}

extern const bb_paper bb_paper_loose_octree;
const bb_paper bb_paper_loose_octree = {
    .name = "loose-octree",
    .title =
        "Gu, Jendersie, Grosch 2018: Fast and Dynamic Construction of Bounding Volume Hierarchies "
        "based on Loose Octrees",
    .experiments = experiments,
    .evaluate = evaluate,
};
