/* Stroeter, Mueller-Roemer, Stork, Fellner: OLBVH: octree linear bounding volume hierarchy for
 * volumetric meshes. The Visual Computer 36, 2020.
 *
 * Meshes (table 1), memory and build (table 2, figure 6), volume rendering (figure 7) with and
 * without the boundary's flags (table 3), slices (figure 8) and overlaps (figure 10) by OLBVH,
 * alpha 0 to 2, and by the LBVH of the same tetrahedra. OLBVH is searched in three ways: as
 * published (`olbvh`: algorithm 3 on the paper's arrays), by our descent by octants (`octree`),
 * and as any tree (`skip`). Points are also located by the paper's rival, the nearest face on a ray
 * (Wald et al. 2019): in our kernels over faces built by two builders, and in Embree. The figures'
 * bars have no numbers in the text; of the paper there are table 2 and the ranges of its words. Its
 * meshes are not to be had: here a ball, a regular block (as "Jets"), a shell (as "Part" and "Pot")
 * and a block whose cubes grow (as those with large variance), or what is asked for.
 */
#include "framework/papers/olbvh.h"

/* ---- figures: of trees those in volume rendering ---- */

#define OVER(what_, builder_, base_) .what = what_, .builder = builder_, .base = base_
#define SPEED .what = "answer_ms", .base = LBVH, .base_kernel = "skip", .inverse = true
static const bb_figure bytes[] = {{OVER("array_bytes", ALPHA0, LBVH)},
                                  {OVER("array_bytes", ALPHA1, LBVH)},
                                  {OVER("array_bytes", ALPHA2, LBVH)}},
                       build = {.what = "build_ms", .base = LBVH, .base_kernel = "skip"},
                       speed = {SPEED}, speedup = {SPEED, .builder = ALPHA0, .kernel = "olbvh"},
                       by_octants = {SPEED, .builder = ALPHA0, .kernel = "octree"};
/* Of points, over the rival's: by our kernels over trees of two builders, and by Embree. */
#define OVER_FACES(builder_, search)                                                               \
    {                                                                                              \
        .what = "answer_ms", .builder = ALPHA0, .kernel = "olbvh", .base = builder_,               \
        .base_kernel = search, .inverse = true                                                     \
    }
static const bb_figure over_ploc8 = OVER_FACES(FACES_PLOC, "stack8"),
                       over_ploc = OVER_FACES(FACES_PLOC, "stack"),
                       over_lbvh8 = OVER_FACES(FACES_LBVH, "stack8"),
                       over_lbvh = OVER_FACES(FACES_LBVH, "stack"),
                       over_embree = OVER_FACES(FACES_EMBREE, "packet8"),
                       nodes_faces = {
                           .what = "nodes_per_item", .builder = FACES_PLOC, .kernel = "stack8"};
#define NODES(builder_, search)                                                                    \
    {                                                                                              \
        .what = "nodes_per_item", .builder = builder_, .kernel = search                            \
    }
static const bb_figure nodes_lbvh = NODES(LBVH, "skip"), nodes_published = NODES(ALPHA0, "olbvh"),
                       nodes_octants = NODES(ALPHA0, "octree");
/* Of one alpha over the one before. */
static const bb_figure less1 = {OVER("array_bytes", ALPHA1, ALPHA0)},
                       less2 = {OVER("array_bytes", ALPHA2, ALPHA1)};
static const bb_figure references = {.what = "references_per_primitive", .builder = ALPHA0};

/* ---- tables ---- */

/* Table 2: tetrahedra, memory in MiB of LBVH and of OLBVH with each alpha. */
static const bb_paper_numbers memory[] = {
    {"Bunny", {32.0e3, 2.07, 1.83, 0.57, 0.27}}, {"Dragon", {824.8e3, 53.5, 52.9, 15.9, 7.41}},
    {"Part", {1.1e6, 71.3, 28.4, 12.3, 7.22}},   {"Fusion", {3.0e6, 195, 116, 45.2, 24.6}},
    {"Jets", {12.3e6, 797, 433, 164, 91.2}},     {.name = NULL},
};

#define MIB(heading_, paper_, ...)                                                                 \
    {                                                                                              \
        .heading = heading_, .decimals = 3, .paper = paper_, .figure = &(const bb_figure)          \
        {                                                                                          \
            .scale = 1.0 / (1 << 20), __VA_ARGS__                                                  \
        }                                                                                          \
    }
#define TREE(builder_) .what = "tree_bytes", .builder = builder_
#define ARRAYS(builder_) .what = "array_bytes", .builder = builder_
#define OVER_LBVH(heading_, alpha)                                                                 \
    {                                                                                              \
        .heading = heading_, .decimals = 3, .paper = 3 + alpha, .paper_over = 2,                   \
        .figure = &bytes[alpha]                                                                    \
    }
#define MESH BB_COLUMN_OF("mesh", BB_SHOW_SCENE)
static const bb_paper_column memory_columns[] = {
    MESH,
    {.heading = "tetrahedra", .figure = &(const bb_figure){.what = "tetrahedra"}, .paper = 1},
    MIB("LBVH MiB", 2, TREE(LBVH)),
    MIB("arrays, 0", 3, ARRAYS(ALPHA0)),
    MIB("arrays, 1", 4, ARRAYS(ALPHA1)),
    MIB("arrays, 2", 5, ARRAYS(ALPHA2)),
    MIB("alpha 0", 0, TREE(ALPHA0)),
    MIB("alpha 1", 0, TREE(ALPHA1)),
    MIB("alpha 2", 0, TREE(ALPHA2)),
    OVER_LBVH("/LBVH, 0", 0),
    OVER_LBVH("/LBVH, 1", 1),
    OVER_LBVH("/LBVH, 2", 2),
    {.heading = NULL},
};

/* Table 1: ratio of volumes; inradius over circumradius, least (1e-9: printed as 0.000), median,
 * most. */
static const bb_paper_numbers shapes[] = {
    {"Bar", {1, 0.233, 0.233, 0.233}},       {"Bunny", {5.5e5, 0.005, 0.126, 0.331}},
    {"Cube", {183, 0.043, 0.268, 0.333}},    {"Cylinder", {693, 0.059, 0.259, 0.333}},
    {"Die", {2.5e4, 0.002, 0.256, 0.333}},   {"Dragon", {2.6e11, 0.011, 0.258, 0.333}},
    {"Fusion", {128, 0.007, 0.054, 0.196}},  {"Gargoyle", {5.2e11, 1e-9, 0.195, 0.333}},
    {"Jets", {1, 0.239, 0.239, 0.239}},      {"Part", {4.4e3, 0.003, 0.266, 0.333}},
    {"Pot", {586, 0.022, 0.259, 0.333}},     {"Tardis", {1.2e8, 0.011, 0.258, 0.333}},
    {"Wrench", {2.5e6, 1e-9, 0.197, 0.333}}, {.name = NULL},
};

#define SHAPE(heading_, what_, paper_, decimals_)                                                  \
    {                                                                                              \
        .heading = heading_, .decimals = decimals_, .paper = paper_, .figure = &(const bb_figure)  \
        {                                                                                          \
            .what = what_                                                                          \
        }                                                                                          \
    }
static const bb_paper_column shape_columns[] = {
    MESH,
    {.heading = "tetrahedra", .figure = &(const bb_figure){.what = "tetrahedra"}},
    SHAPE("volume ratio", "volume_ratio", 1, 0),
    SHAPE("aspect min", "aspect_min", 2, 3),
    SHAPE("median", "aspect_median", 3, 3),
    SHAPE("max", "aspect_max", 4, 3),
    {.heading = NULL},
};

/* Table 3: the time of the search for intervals by the boundary's flags, in ms, is not apart here;
 * what it gains or costs is. */
static const bb_figure marked_ms = {.what = "answer_ms", .kernel = "olbvh"},
                       unmarked_ms = {.what = "answer_ms", .kernel = "olbvh:boundary=no"},
                       marked = {.what = "answer_ms",
                                 .kernel = "olbvh",
                                 .base_kernel = "olbvh:boundary=no"};
static const bb_paper_column marker_columns[] = {
    MESH,
    BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    {.heading = "ms with flags", .decimals = 2, .figure = &marked_ms},
    {.heading = "without", .decimals = 2, .figure = &unmarked_ms},
    BB_COLUMN_INTERVAL("with / without", &marked),
    {.heading = NULL},
};

static const bb_paper_column build_columns[] = {
    MESH,
    BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    BB_COLUMN_AS("references/tet", 2, .what = "references_per_primitive"),
    BB_COLUMN_AS("nodes", 0, .what = "nodes"),
    BB_COLUMN_AS("build ms", 2, .what = "build_ms"),
    BB_COLUMN_INTERVAL("over LBVH", &build),
    BB_COLUMN_AS("layout ms", 2, .what = "layout_ms"),
    {.heading = NULL},
};

static const bb_paper_column task_columns[] = {
    MESH,
    BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    BB_COLUMN_OF("search", BB_SHOW_KERNEL),
    BB_COLUMN_AS("ms", 2, .what = "answer_ms"),
    BB_COLUMN_INTERVAL("speed/LBVH", &speed),
    BB_COLUMN_AS("nodes", 1, .what = "nodes_per_item"),
    BB_COLUMN_AS("tests", 2, .what = "tests_per_item"),
    BB_COLUMN_AS("restarts", 2, .what = "restarts_per_item"),
    BB_COLUMN_AS("MiB to query", 2, .what = "query_bytes", .scale = 1.0 / (1 << 20)),
    BB_COLUMN_AS("wrong", 0, .what = "differ"),
    BB_COLUMN_OF("paper", BB_SHOW_NOTE),
    {.heading = NULL},
};

#define WAY(builder_, search, note_)                                                               \
    {                                                                                              \
        .name = builder_, .builder = builder_, .kernel = search, .note = note_, .optional = true   \
    }
static const bb_paper_entrant trees[] = {
    WAY(LBVH, "skip", NULL),
    WAY(ALPHA0, "octree", NULL),
    WAY(ALPHA1, "octree", NULL),
    WAY(ALPHA2, "octree", NULL),
    {.name = NULL},
};
static const bb_paper_entrant alphas[] = {
    WAY(ALPHA0, NULL, NULL),
    WAY(ALPHA1, NULL, NULL),
    WAY(ALPHA2, NULL, NULL),
    {.name = NULL},
};
/* The paper's ranges of speeds over LBVH's, for each alpha. */
#define OF_ALPHA(alpha, note)                                                                      \
    WAY(alpha, "olbvh", note), WAY(alpha, "octree", NULL), WAY(alpha, "skip", NULL)
#define WAYS(alpha0, alpha1, alpha2)                                                               \
    {                                                                                              \
        WAY(LBVH, "skip", NULL), OF_ALPHA(ALPHA0, alpha0), OF_ALPHA(ALPHA1, alpha1),               \
            OF_ALPHA(ALPHA2, alpha2),                                                              \
        {                                                                                          \
            .name = NULL                                                                           \
        }                                                                                          \
    }
static const bb_paper_entrant rendering[] = WAYS("2 to 13", "above LBVH's", "");
static const bb_paper_entrant slicing[] = WAYS("3 to 25", "3 to 25", "");
static const bb_paper_entrant locating[] = {
    WAY(LBVH, "skip", NULL),
    OF_ALPHA(ALPHA0, "up to 8.4 times the rival's"),
    OF_ALPHA(ALPHA1, ""),
    OF_ALPHA(ALPHA2, ""),
    WAY(FACES_LBVH, "stack", "Wald et al. 2019"),
    WAY(FACES_LBVH, "stack8", NULL),
    WAY(FACES_PLOC, "stack", NULL),
    WAY(FACES_PLOC, "stack8", NULL),
    WAY(FACES_EMBREE, "single", "trace alone"),
    WAY(FACES_EMBREE, "packet8", NULL),
    WAY(FACES_EMBREE, "packet16", NULL),
    WAY(FACES_EMBREE, "stream", NULL),
    {.name = NULL},
};
static const bb_paper_entrant overlapping[] = WAYS("5 to 52", "significant", "significant");

static void say_side(bb_paper_place at, const char *what, int paper, bb_words *title)
{
    const bb_cell first = {{[BB_SCENE] = at.all->scene_count > 0 ? at.all->scenes[0] : ""}};
    const double side = bb_find(at.all, &first, "side").number;
    bb_say(title, "%s of %g x %g pixels (paper: %d x %d)", what, side, side, paper, paper);
}

static void say_picture(bb_paper_place at, bb_words *title)
{
    say_side(at, "pictures", BB_OLBVH_PICTURE, title);
}

static void say_slice(bb_paper_place at, bb_words *title)
{
    say_side(at, "slices", BB_OLBVH_SLICE, title);
}

static void say_refused(bb_paper_place at, bb_words *title)
{
    for (size_t s = 0; s < at.all->scene_count; s++) {
        const char *why = bb_found_text(at.all, at.all->scenes[s], NULL, "refused");
        bb_say(title, "%s%s", why[0] != '\0' ? "; refused: " : "", why);
    }
}

static const bb_figure answer_ms = {.what = "answer_ms"};
#define OF_TASK(task, rows_)                                                                       \
    .of = task, .columns = task_columns, .rows = rows_, .by_scene = true, .needs = &answer_ms
static const bb_paper_table tables[] = {
    {.title =
         "Meshes: volume of the largest tetrahedron over the smallest's, aspect ratios (table 1)",
     .columns = shape_columns,
     .by_scene = true,
     .paper = shapes,
     .paper_last = true},
    {.title = "Memory, MiB: LBVH, the paper's six arrays for alpha 0 to 2, the same as a tree "
              "here, and the arrays over LBVH (table 2)",
     .columns = memory_columns,
     .by_scene = true,
     .paper = memory,
     .paper_last = true},
    {.title = "Build (figure 6)",
     .columns = build_columns,
     .rows = trees,
     .by_scene = true,
     .needs = &answer_ms},
    {.title = "volume rendering: speed over that of LBVH (figure 7); ",
     .title_words = say_picture,
     OF_TASK(BB_OLBVH_RENDERING, rendering)},
    {.title = "volume rendering as published, with and without the boundary's flags (table 3)",
     .of = BB_OLBVH_RENDERING,
     .columns = marker_columns,
     .rows = alphas,
     .by_scene = true,
     .needs = &answer_ms},
    {.title = "slice: speed over that of LBVH (figure 8); ",
     .title_words = say_slice,
     OF_TASK(BB_OLBVH_SLICES, slicing)},
    {.title = "overlap: speed over that of LBVH (figure 10)",
     OF_TASK(BB_OLBVH_OVERLAPS, overlapping)},
    {.title = "points located: speed over that of LBVH; by faces: the nearest on a ray from the "
              "point says where it is (the rival of figure 7)",
     .title_words = say_refused,
     OF_TASK(BB_OLBVH_LOCATION, locating)},
    {.title = NULL},
};

/* ---- claims ---- */

#define OF_MEMORY                                                                                  \
    .ours = {{.each = true, .text = "{scene}: {0.2}, {1.2}, {2.2}"}},                              \
    .why = {{.each = true, .always = true, .text = "{scene}: {3.1} references a tetrahedron"}}
#define FASTER(task, claimed_)                                                                     \
    .of = task, .figures = {&speedup, &by_octants, &nodes_lbvh, &nodes_published, &nodes_octants}, \
    .tests = {{.over = BB_MOST_OF, .side = BB_ABOVE, .bound = 1, .claimed = claimed_}},            \
    .ours = {{.each = true, .text = "{scene}: {0}, by octants {1}"}},                              \
    .why = {{.each = true,                                                                         \
             .always = true,                                                                       \
             .text = "{scene}: {2.0} nodes by LBVH, {3.0} as published, {4.0} by octants"}}

#define OF_BUILDS(which_)                                                                          \
    .rows = trees, .which = which_, .together = true, .of_scenes = true, .figures = {&build}
static const bb_paper_claim claims[] = {
    {.text = "OLBVH takes less memory than LBVH for most meshes, alpha 0",
     .paper = "0.40 to 0.99 of it",
     .figures = {&bytes[0], &bytes[1], &bytes[2], &references},
     .tests = {{.over = BB_MOST_OF, .side = BB_BELOW, .bound = 1}},
     OF_MEMORY},
    {.text = "A larger alpha saves much memory: alpha 1, and still more alpha 2",
     .paper = "0.17 to 0.30, 0.10 to 0.14",
     .figures = {&bytes[0], &bytes[1], &bytes[2], &references, &less1, &less2},
     .tests = {{.figure = 1, .over = BB_EACH, .side = BB_BELOW, .bound = 1, .claimed = 0.30},
               {.figure = 2, .over = BB_EACH, .side = BB_BELOW, .bound = 1, .claimed = 0.14},
               BB_TEST_EACH(4, BB_BELOW, 1),
               BB_TEST_EACH(5, BB_BELOW, 1)},
     OF_MEMORY},
    {.text = "With alpha 0 the build is slower than LBVH's",
     .paper = "section 4.1",
     OF_BUILDS(1 << 1),
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     .ours = {{.each = true, .text = "{scene}: {0}"}}},
    {.text = "With alpha 1 and 2 it matches or beats LBVH's in many cases (here: in most)",
     .paper = "section 4.1",
     OF_BUILDS(1 << 2 | 1 << 3),
     .tests = {{.over = BB_MOST_OF, .side = BB_AT_MOST, .claimed = 1}},
     .ours = {{.each = true, .text = "{scene}, {row}: {0}"}}},
    {.text = "Volume rendering with alpha 0 is at least twice as fast as by LBVH",
     .paper = "2 to 13 times",
     FASTER(BB_OLBVH_RENDERING, 2)},
    {.text = "Without hardware that traces rays, samples are located faster than by tracing faces "
             "(Wald et al. 2019; here: points inside of the mesh, faces traced by our kernels, "
             "whichever tree and kernel)",
     .paper = "up to 8.4 times the sampling rate, with empty space skipped before",
     .of = BB_OLBVH_LOCATION,
     .figures = {&over_ploc8, &over_ploc, &over_lbvh8, &over_lbvh, &over_embree, &nodes_published,
                 &nodes_faces},
     .tests = {{.over = BB_MOST_OF, .side = BB_ABOVE, .bound = 1},
               {.figure = 1, .over = BB_MOST_OF, .side = BB_ABOVE, .bound = 1},
               {.figure = 2, .over = BB_MOST_OF, .side = BB_ABOVE, .bound = 1},
               {.figure = 3, .over = BB_MOST_OF, .side = BB_ABOVE, .bound = 1}},
     .ours = {{.each = true,
               .text = "{scene}: {0} over PLOC's faces of eight children, {1} of two; {2} and {3} "
                       "over LBVH's; {4} over Embree's packets"}},
     .why = {{.each = true,
              .always = true,
              .text = "{scene}: {5.0} nodes as published, {6.0} of eight children by faces"}}},
    {.text = "Slices with alpha 0 are at least three times as fast as by LBVH",
     .paper = "3 to 25 times",
     FASTER(BB_OLBVH_SLICES, 3)},
    {.text = "Overlaps with alpha 0 are at least five times as fast as by LBVH",
     .paper = "5 to 52 times",
     FASTER(BB_OLBVH_OVERLAPS, 5)},
    {.text = NULL},
};

extern const bb_paper bb_paper_olbvh;
const bb_paper bb_paper_olbvh = {
    .name = "olbvh",
    .title = "Stroeter, Mueller-Roemer, Stork, Fellner 2020: OLBVH: octree linear bounding volume "
             "hierarchy for volumetric meshes",
    .builders = LBVH "," ALPHA0 "," ALPHA1 "," ALPHA2 ",ploc",
    .measure = bb_olbvh_measure,
    .tables = tables,
    .claims = {claims},
};
