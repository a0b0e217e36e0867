/* Gu, Jendersie, Grosch: Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees. VMV 2018.
 *
 * Build, trace and build + trace of one frame of primary rays, and memory, of LBVH, LLBVH and
 * LOBVH, on mixtures of spheres (section 4.1, figure 5) and on triangles (section 4.2, figure 6);
 * the size that a box's level is taken from (section 3.1), and the order by the view's direction
 * (section 3.4). The figures' bars have no numbers in the text: of the paper there are its words,
 * and their ratios where it gives some. As there, codes have 30 bits, all root cells are the same
 * cube, LLBVH's leaves have all primitives of a node, LOBVH keeps four arrays of all nodes and
 * nodes with a single child, is ordered by the view that is traced, and is traced without a stack,
 * the binary trees with one. What our defaults gain over that has rows of its own. The frame has
 * 1024x768 pixels, from each scene's first view.
 */
#include "framework/papers/loose_octree.h"

#include <math.h>

#define SPHERES "spheres:n=1000000,state=initial,spheres:n=1000000,state=settled"
#define QUICK_SPHERES "spheres:n=2000,state=initial,spheres:n=2000,state=settled"
#define TRIANGLES "coffee,mountain,scorpion,city:n=200000,hairball:n=1000000,interior:n=200000"
#define QUICK_TRIANGLES "hairball:n=2000,interior:n=2000"
/* What experiments share: these scenes, or those asked for; the paper's frame. */
#define ON_TRIANGLES .scenes = TRIANGLES, .quick_scenes = QUICK_TRIANGLES, .takes_scenes = true
#define ONE_FRAME .width = 1024, .height = 768, .max_rays = 1, .max_views = 1

#define ENTRANT(name_, builder_, kernel_)                                                          \
    {                                                                                              \
        .name = name_, .builder = builder_, .kernel = kernel_                                      \
    }
/* A pair that is no part of the comparison has no row; a builder that was refused has one. */
#define BOTH_KERNELS(builder_)                                                                     \
    ENTRANT(builder_, builder_, STACK),                                                            \
    {                                                                                              \
        .name = builder_, .builder = builder_, .kernel = STACKLESS, .optional = true               \
    }

static const bb_paper_entrant rivals[] = {
    BOTH_KERNELS(LBVH30),         BOTH_KERNELS(LLBVH30),    BOTH_KERNELS(LLBVH30_LINKED),
    BOTH_KERNELS(LLBVH30_SINGLE), BOTH_KERNELS(LLBVH30_64), BOTH_KERNELS(LOBVH("6")),
    BOTH_KERNELS(LOBVH("7")),     BOTH_KERNELS(LOBVH("8")), BOTH_KERNELS(LOBVH_AUTO),
    BOTH_KERNELS(LOBVH_SKIPPING), {.name = NULL},
};

const bb_paper_entrant bb_box_sizes[] = {
    ENTRANT("smallest side", SMALLEST, STACK),
    ENTRANT("largest side", LLBVH30 ",side=largest", STACK),
    ENTRANT("mean side", LLBVH30 ",side=mean", STACK),
    ENTRANT("root of the volume", LLBVH30 ",side=volume", STACK),
    ENTRANT("without the fit test", SMALLEST ",fit=no", STACK),
    ENTRANT("sizes every two levels", SMALLEST ",sizes=yes", STACK),
    {.name = NULL},
};
/* '$' is the order. */
const bb_paper_entrant bb_view_ordered[] = {
    ENTRANT(LBVH30, LBVH30 "$", STACK),
    ENTRANT(LBVH30, LBVH30 "$", STACKLESS),
    ENTRANT(LLBVH30, LLBVH30 "$", STACK),
    ENTRANT(LLBVH30, LLBVH30 "$", STACKLESS),
    ENTRANT("LOBVH", LOBVH_VIEWLESS "$", STACK),
    ENTRANT("LOBVH", LOBVH_VIEWLESS "$", STACKLESS),
    {.name = NULL},
};
static const bb_experiment experiments[] = {
    [OF_SPHERES] = {.name = "mixtures of spheres",
                    .builders = "",
                    .entrants = rivals,
                    .kernels = STACK,
                    .native = true,
                    .rays = "primary",
                    .scenes = SPHERES,
                    .quick_scenes = QUICK_SPHERES,
                    ONE_FRAME,
                    .repeats = 7},
    [OF_TRIANGLES] = {.name = "triangles",
                      .builders = "",
                      .entrants = rivals,
                      .kernels = STACK,
                      .native = true,
                      .rays = "primary",
                      ON_TRIANGLES,
                      ONE_FRAME,
                      .repeats = BB_INTERVAL_ROUNDS},
    [OF_SIZES] = {.name = "the size of a box",
                  .builders = "",
                  .entrants = bb_box_sizes,
                  .kernels = STACK,
                  .rays = "primary",
                  ON_TRIANGLES,
                  ONE_FRAME,
                  .repeats = BB_INTERVAL_ROUNDS},
    [OF_VIEWS] = {.name = "order by the view",
                  .builders = "",
                  .entrants = bb_view_ordered,
                  .fills = " ,view=0 ,view=1 ,view=2",
                  .kernels = STACK "," STACKLESS,
                  .rays = "primary:tmin=0", /* the default, but not the set of the frames above */
                  .scenes = SPHERES,
                  .quick_scenes = QUICK_SPHERES,
                  .takes_scenes = true,
                  /* without an order, a ray of the stackless kernel may meet thousands of boxes */
                  .width = 256,
                  .height = 192,
                  .max_rays = 1,
                  .max_views = VIEWS,
                  .repeats = BB_INTERVAL_ROUNDS},
    {.name = NULL},
};

/* ---- figures ---- */

static const bb_figure prims = {.what = "prims"}, build_ms = {.what = "build_ms"},
                       trace_ms = {.what = "trace_ms"}, frame_ms = {.what = FRAME},
                       cost = {.what = "sah"}, boxes = {.what = "node_tests_per_ray"},
                       tests = {.what = "prim_tests_per_ray"},
                       bytes = {.what = "bytes_tree", .scale = MIB},
                       peak = {.what = "bytes_peak", .scale = MIB};
/* Medians of the paper's configuration, over LBVH's. */
#define OVER_LBVH(builder_, kernel_)                                                               \
    .what = FRAME, .builder = builder_, .kernel = kernel_, .base = LBVH30, .base_kernel = STACK,   \
    .unpaired = true
static const bb_figure lbvh_ms = {.what = FRAME, .builder = LBVH30, .kernel = STACK},
                       to_lbvh = {OVER_LBVH(NULL, NULL)},
                       llbvh_to_lbvh = {OVER_LBVH(LLBVH30, STACK)},
                       best_to_lbvh = {OVER_LBVH(LOBVH_BEST, STACKLESS)},
                       auto_to_lbvh = {OVER_LBVH(LOBVH_AUTO, STACKLESS)};

/* Rays per second with the order of the view that is traced, over those without one. */
const bb_figure bb_order_factor = {.what = "trace_ms",
                                   .builder = "$",
                                   .base = "$,view=%",
                                   .mean = BB_MEAN_OF_ROUNDS,
                                   .views = VIEWS};

/* ---- tables ---- */

static const bb_paper_column averages[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    BB_COLUMN("LBVH ms", &lbvh_ms, 2),
    BB_COLUMN("LLBVH", &llbvh_to_lbvh, 3),
    BB_COLUMN("LOBVH, best of 6 to 8", &best_to_lbvh, 3),
    {.heading = "its level",
     .shown = BB_SHOW_BEST,
     .figure = &(const bb_figure){.what = FRAME, .builder = LOBVH_BEST, .kernel = STACKLESS}},
    BB_COLUMN("LOBVH, auto", &auto_to_lbvh, 3),
    {.heading = NULL},
};

static const bb_paper_column frames[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    BB_COLUMN("primitives", &prims, 0),
    BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    BB_COLUMN_OF("kernel", BB_SHOW_KERNEL),
    BB_COLUMN("build ms", &build_ms, 2),
    BB_COLUMN("trace ms", &trace_ms, 2),
    BB_COLUMN("both ms", &frame_ms, 2),
    BB_COLUMN("to LBVH", &to_lbvh, 3),
    BB_COLUMN("SAH", &cost, 1),
    BB_COLUMN("boxes/ray", &boxes, 1),
    BB_COLUMN("prims/ray", &tests, 1),
    BB_COLUMN("tree MiB", &bytes, 1),
    BB_COLUMN("peak MiB", &peak, 1),
    {.heading = NULL},
};

static const bb_paper_column size_columns[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE), BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    BB_COLUMN("build ms", &build_ms, 2),  BB_COLUMN("trace ms", &trace_ms, 2),
    BB_COLUMN("both ms", &frame_ms, 2),   BB_COLUMN("SAH", &cost, 2),
    BB_COLUMN("boxes/ray", &boxes, 1),    BB_COLUMN("prims/ray", &tests, 1),
    BB_COLUMN("tree MiB", &bytes, 1),     {.heading = NULL},
};

static double worst_other_order(bb_paper_place at, const bb_figure *figure)
{
    static const char *const others[] = {"$,view=0", "$,view=1", "$,view=2"};
    double worst = NAN;
    for (int v = 0; v < VIEWS; v++) {
        bb_figure other = *figure;
        other.base = others[v];
        if (v != at.view)
            worst = fmin(worst, bb_value_at(at, &other));
    }
    return worst;
}

static const bb_paper_column orders[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    BB_COLUMN_OF("kernel", BB_SHOW_KERNEL),
    BB_COLUMN_OF("view", BB_SHOW_VIEW),
    BB_COLUMN_INTERVAL("factor", &bb_order_factor),
    {.heading = "worst other order",
     .shown = BB_SHOW_NUMBER,
     .figure = &bb_order_factor,
     .decimals = 3,
     .number = worst_other_order},
    {.heading = NULL},
};

static const bb_paper_table tables[] = {
    {.title = "Build + trace of a frame in the paper's configuration (binary trees with the stack "
              "kernel, LOBVH with the stackless one), ratios to LBVH",
     .columns = averages,
     .by_scene = true,
     .of = OF_SPHERES,
     .average = "average, spheres (here)",
     .paper_words =
         (const char *const[]){"spheres (paper)", NULL, "above 1", "below 1", "6", NULL}},
    {.title = "",
     .columns = averages,
     .by_scene = true,
     .of = OF_TRIANGLES,
     .average = "average, triangles (here)",
     .paper_words = (const char *const[]){"triangles (paper)", NULL, "about 1, 0.96 on hairball",
                                          "above 1, below on hairball", "6 or 7", NULL}},
    {.title = "A frame of mixtures of spheres (section 4.1, figure 5)",
     .columns = frames,
     .rows = rivals,
     .by_scene = true,
     .of = OF_SPHERES,
     .needs = &trace_ms},
    {.title = "A frame of triangles (section 4.2, figure 6)",
     .columns = frames,
     .rows = rivals,
     .by_scene = true,
     .of = OF_TRIANGLES,
     .needs = &trace_ms},
    {.title = "LLBVH: the size that a box's level is taken from, fit test, size bits",
     .columns = size_columns,
     .rows = bb_box_sizes,
     .by_scene = true,
     .of = OF_SIZES},
    {.title = "Order by the view that is traced: rays per second over those without an order, and "
              "with the order of another view",
     .columns = orders,
     .rows = bb_view_ordered,
     .by_scene = true,
     .of = OF_VIEWS,
     .views = VIEWS},
    {.title = NULL},
};

extern const bb_paper bb_paper_loose_octree;
const bb_paper bb_paper_loose_octree = {
    .name = "loose-octree",
    .title =
        "Gu, Jendersie, Grosch 2018: Fast and Dynamic Construction of Bounding Volume Hierarchies "
        "based on Loose Octrees",
    .experiments = experiments,
    .tables = tables,
    .claims = {bb_loose_octree_claims},
};
