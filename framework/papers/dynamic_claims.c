/* Tables and claims of Eisemann, Grosch, Mueller, Magnor 2007: how many times as fast, in the
 * paper's pairing and with like against like. */
#include "framework/papers/dynamic.h"

#include <math.h>
#include <string.h>

/* ---- figures ---- */

#define BOTH "update_ms+trace_ms"
#define PAIR(what_, method, base_) .what = what_, .builder = method, .base = base_, .inverse = true
static const bb_figure update_ratio = {PAIR("update_ms", NULL, "=")},
                       trace_ratio = {PAIR("trace_ms", NULL, "=")},
                       both_ratio = {PAIR(BOTH, NULL, "=")};
static const bb_figure loose_update = {PAIR("update_ms", LOOSE, REBUILT)},
                       loose_update_lbvh = {PAIR("update_ms", LOOSE, LBVH)},
                       refit_update = {PAIR("update_ms", SMALL_REFITTED, SMALL_REBUILT)},
                       refit_trace = {PAIR("trace_ms", SMALL_REFITTED, SMALL_REBUILT)},
                       file_update = {PAIR("update_ms", UPDATED, REBUILT)},
                       shuffled_update = {PAIR("update_ms", UPDATED_SHUFFLED, REBUILT_SHUFFLED)},
                       shuffled_trace = {PAIR("trace_ms", UPDATED_SHUFFLED, REBUILT)},
                       both_paper = {PAIR(BOTH, UPDATED_SHUFFLED, REBUILT)},
                       both_shuffled = {PAIR(BOTH, UPDATED_SHUFFLED, REBUILT_SHUFFLED)},
                       both_file = {PAIR(BOTH, UPDATED, REBUILT)},
                       both_lbvh = {PAIR(BOTH, LBVH, UPDATED_SHUFFLED)};

static bool is_kitchen(const bb_findings *f, const char *scene)
{
    (void)f;
    return strcmp(scene, bb_dynamic_scenes[BB_DYNAMIC_KITCHEN].name) == 0;
}

static bool is_other(const bb_findings *f, const char *scene)
{
    return !is_kitchen(f, scene);
}

static bool is_fall(const bb_findings *f, const char *scene)
{
    (void)f;
    return strcmp(scene, bb_dynamic_scenes[BB_DYNAMIC_FALL].name) == 0;
}

static const bb_figure
    kitchen_update = {PAIR("update_ms", UPDATED_SHUFFLED, REBUILT), .only = is_kitchen},
    kitchen_collections = {PAIR("update_ms", COLLECTIONS, REBUILT), .only = is_kitchen},
    kitchen_listed = {PAIR("update_ms", LISTED, REBUILT), .only = is_kitchen},
    other_update = {PAIR("update_ms", UPDATED_SHUFFLED, REBUILT), .only = is_other},
    other_trace = {PAIR("trace_ms", UPDATED_SHUFFLED, REBUILT), .only = is_other},
    other_shuffled = {PAIR("trace_ms", UPDATED_SHUFFLED, REBUILT_SHUFFLED), .only = is_other},
    kitchen_loose = {PAIR("trace_ms", LOOSE, REBUILT), .only = is_kitchen},
    fall_rebuilt = {PAIR("trace_ms", LOOSE, REBUILT), .only = is_fall},
    fall_updated = {PAIR("trace_ms", LOOSE, UPDATED_SHUFFLED), .only = is_fall},
    fall_shuffled = {PAIR("trace_ms", LOOSE, REBUILT_SHUFFLED), .only = is_fall},
    fall_cube = {PAIR("trace_ms", LOOSE_CUBE, LOOSE), .only = is_fall};

/* Of trees, over the best made for the frame. */
#define COST(method) .what = "sah_mean", .builder = method
static const bb_figure rebuilt_cost = {COST(REBUILT)},
                       rebuilt_shuffled_cost = {COST(REBUILT_SHUFFLED)},
                       updated_cost = {COST(UPDATED)},
                       updated_shuffled_cost = {COST(UPDATED_SHUFFLED)}, loose_cost = {COST(LOOSE)},
                       cube_cost = {COST(LOOSE_CUBE)}, now_cost = {COST(LOOSE_NOW)};
static const bb_figure moved = {.what = "moved", .builder = UPDATED_SHUFFLED},
                       thinned = {.what = "thinned", .builder = UPDATED_SHUFFLED},
                       prims = {.what = "prims"},
                       loose_uneven = {.what = "unevenness", .builder = LOOSE},
                       updated_uneven = {.what = "unevenness", .builder = UPDATED_SHUFFLED};

/* ---- tables ---- */

/* Table 1, of which more than 1 is faster than its rebuild: update, tracing, and both; then the
 * paper's number of triangles. */
static const bb_paper_numbers updated[BB_DYNAMIC_SCENES] = {
    {"kitchen", {103.471, 1.010, 1.295}},
    {"museum", {6.137, 1.489, 1.666}},
    {"museum", {6.137, 1.489, 1.666}},
    {"falling triangles", {8.245, 1.953, 2.416}},
};
static const bb_paper_numbers loose[BB_DYNAMIC_SCENES] = {
    {"kitchen", {11.204, 0.522, 0.662}},
    {"museum", {15.464, 1.147, 1.318}},
    {"museum", {15.464, 1.147, 1.318}},
    {"falling triangles", {18.510, 7.008, 8.303}},
};

static size_t scene_of(bb_paper_place at)
{
    size_t s = 0;
    while (s < BB_DYNAMIC_SCENES && strcmp(at.scene, bb_dynamic_scenes[s].name) != 0)
        s++;
    return s;
}

/* The paper's ratio of the row; `figure` says of which part. */
static double theirs(bb_paper_place at, const bb_figure *figure)
{
    const int part = figure == &update_ratio ? 0 : figure == &trace_ratio ? 1 : 2;
    const size_t scene = scene_of(at);
    return at.row->paper != NULL && scene < BB_DYNAMIC_SCENES ? at.row->paper[scene].numbers[part]
                                                              : (double)NAN;
}

static double their_prims(bb_paper_place at, const bb_figure *figure)
{
    (void)figure;
    const size_t scene = scene_of(at);
    return scene < BB_DYNAMIC_SCENES ? bb_dynamic_scenes[scene].prims : (double)NAN;
}

#define TEXT(heading_, name_) .heading = heading_, .shown = BB_SHOW_TEXT, .note = name_
#define PAPER(heading_, figure_)                                                                   \
    .heading = heading_, .shown = BB_SHOW_NUMBER, .figure = figure_, .decimals = 3, .number = theirs

static const bb_paper_column scenes[] = {
    BB_COLUMN_OF("in place of", BB_SHOW_SCENE),
    {TEXT("scene", "name")},
    BB_COLUMN_AS("triangles", 0, .what = "prims"),
    {.heading = "paper", .shown = BB_SHOW_NUMBER, .number = their_prims},
    BB_COLUMN_AS("frames", 0, .what = "all_frames"),
    BB_COLUMN_AS("moved", 0, .what = "moved", .builder = UPDATED),
    {TEXT("picture", "picture")},
    BB_COLUMN_AS("primary", 0, .what = "primary"),
    BB_COLUMN_AS("diffuse", 0, .what = "diffuse"),
    BB_COLUMN_AS("rounds", 0, .what = "rounds"),
    BB_COLUMN_AS("s", 1, .what = "seconds"),
    {.heading = NULL},
};

static const bb_paper_column table1[] = {
    BB_COLUMN_OF("in place of", BB_SHOW_SCENE),
    BB_COLUMN_OF("method", BB_SHOW_BUILDER),
    {.heading = "faster than",
     .shown = BB_SHOW_BUILDER,
     .figure = &(const bb_figure){.what = "update_ms", .builder = "="}},
    {PAPER("update, paper", &update_ratio)},
    BB_COLUMN_INTERVAL("here", &update_ratio),
    {PAPER("trace, paper", &trace_ratio)},
    BB_COLUMN_INTERVAL("here", &trace_ratio),
    {PAPER("both, paper", &both_ratio)},
    BB_COLUMN_INTERVAL("here", &both_ratio),
    {.heading = NULL},
};

#define FRAME(heading_, what_) BB_COLUMN_AS(heading_, 3, .what = what_, .per = "frames")
static const bb_paper_column methods[] = {
    BB_COLUMN_OF("in place of", BB_SHOW_SCENE),
    BB_COLUMN_OF("method", BB_SHOW_ROW),
    FRAME("update ms", "update_ms"),
    FRAME("trace ms", "trace_ms"),
    FRAME("both ms", BOTH),
    FRAME("transfer ms", "transfer_ms"),
    FRAME("layout ms", "layout_ms"),
    BB_COLUMN_AS("SAH/best", 3, .what = "sah_mean"),
    BB_COLUMN_AS("at worst", 3, .what = "sah_most"),
    BB_COLUMN_AS("inserted", 0, .what = "reinserted"),
    BB_COLUMN_AS("thinned", 0, .what = "thinned"),
    BB_COLUMN_AS("judged", 0, .what = "judged"),
    BB_COLUMN_AS("wrong", 0, .what = "wrong"),
    {TEXT("refused", "refused")},
    {.heading = NULL},
};

#define ROW(method, base_, paper_) .name = method, .builder = method, .base = base_, .paper = paper_
/* The paper's pairings have its figures; then like against like. */
static const bb_paper_entrant pairs[] = {
    {ROW(UPDATED_SHUFFLED, REBUILT, updated)},
    {ROW(UPDATED_SHUFFLED, REBUILT_SHUFFLED, NULL)},
    {ROW(UPDATED, REBUILT, NULL)},
    {ROW(COLLECTIONS, REBUILT, NULL)},
    {ROW(LISTED, REBUILT, NULL)},
    {ROW(LOOSE, REBUILT, loose)},
    {ROW(LOOSE, REBUILT_SHUFFLED, NULL)},
    {ROW(LOOSE_SORTED, REBUILT, NULL)},
    {ROW(LOOSE_CUBE, REBUILT, NULL)},
    {ROW(LOOSE_NOW, LBVH, NULL)},
    {ROW(SMALL_REFITTED, SMALL_REBUILT, NULL)},
    {ROW(LBVH, REBUILT, NULL)},
    {.name = NULL},
};

#define OF_FRAME(heading_, what_, method)                                                          \
    BB_COLUMN_AS(heading_, 2, .what = "frame_" what_ "_ms", .builder = method)
static const bb_paper_column series[] = {
    BB_COLUMN_OF("in place of", BB_SHOW_SCENE),
    BB_COLUMN_OF("frame", BB_SHOW_VIEW),
    OF_FRAME("update ms: G&S", "update", REBUILT),
    OF_FRAME("Dynamic G&S", "update", UPDATED_SHUFFLED),
    OF_FRAME("Loose BVH", "update", LOOSE),
    OF_FRAME("trace ms: G&S", "trace", REBUILT),
    OF_FRAME("Dynamic G&S", "trace", UPDATED_SHUFFLED),
    OF_FRAME("Loose BVH", "trace", LOOSE),
    {.heading = NULL},
};

const bb_paper_table bb_dynamic_tables[] = {
    {.title = "What was traced: means per frame", .columns = scenes, .by_scene = true},
    {.title = "Table 1: how many times as fast as a rebuild: update, tracing, and both (first the "
              "paper's pairing, then both shuffled, or neither)",
     .columns = table1,
     .rows = pairs,
     .by_scene = true},
    {.title = "A frame of each method, and its tree's cost over the least of one made for the "
              "frame (transfer and layout are of this bench; the paper has none); small: in "
              "pictures of an eighth of the side",
     .columns = methods,
     .rows = bb_dynamic_methods,
     .by_scene = true},
    {.title = "Update and tracing, frame by frame (figure 7)",
     .columns = series,
     .by_scene = true,
     .views = BB_DYNAMIC_FRAMES - 1},
    {.title = NULL},
};

/* ---- claims ---- */

/* Faster than its rebuild, and by the factors of the paper: of update, tracing, or both. */
enum { OF_UPDATE, OF_TRACE, OF_BOTH };
#define REACHED(paper_, part)                                                                      \
    {                                                                                              \
        .over = BB_EACH, .side = BB_ABOVE, .bound = 1, .paper = paper_, .number = part             \
    }

#define EACH(text_)                                                                                \
    {                                                                                              \
        .each = true, .always = true, .text = text_                                                \
    }
/* What decides over the update of Dynamic Goldsmith and Salmon: how many are inserted again. */
#define UPDATES_OF(first)                                                                          \
    .figures = {&first, &moved, &prims, &thinned, &file_update, &shuffled_update},                 \
    .ours = {EACH("{scene} {0}")},                                                                 \
    .why = {                                                                                       \
        EACH("{scene}: {1.0} of {2.0} objects move in a frame, {3.0} nodes are thinned; with the " \
             "first tree in the file's order the update is {4} times as fast as such a rebuild, "  \
             "with both shuffled {5}")}
/* The cost of trees over the best made for the frame, in the order of the file and shuffled. */
#define COSTS_OF(first)                                                                            \
    .figures = {&first, &rebuilt_cost, &rebuilt_shuffled_cost, &updated_cost,                      \
                &updated_shuffled_cost},                                                           \
    .ours = {EACH("{scene} {0}")},                                                                 \
    .why = {EACH("{scene}: trees cost, over the best made for the frame, rebuilt {1.2}, shuffled " \
                 "{2.2}; updated {3.2}, shuffled {4.2}")}

const bb_paper_claim bb_dynamic_claims[] = {
    {.text = "Where few objects move, Dynamic G&S updates two orders of magnitude faster than a "
             "rebuild",
     .paper = "kitchen x103.5",
     .tests = {REACHED(&updated[BB_DYNAMIC_KITCHEN], OF_UPDATE)},
     UPDATES_OF(kitchen_update)},
    {.text = "The same where what moves is an object, or five: collections with trees of their own",
     .paper = "sections 3.1 and 4: the toy car is 5 objects; nothing is known of movements",
     .figures = {&kitchen_collections, &kitchen_listed, &kitchen_update},
     .tests = {REACHED(&updated[BB_DYNAMIC_KITCHEN], OF_UPDATE)},
     .ours = {EACH("{scene} {0}; with a list of what moves {1}")},
     .why = {EACH("{scene}: with each triangle as an object {2}")}},
    {.text = "Where most or all objects move, Dynamic G&S still updates six to eight times as fast "
             "as a rebuild",
     .paper = "museum x6.1, falling triangles x8.2",
     .tests = {REACHED(&updated[BB_DYNAMIC_MUSEUM], OF_UPDATE)},
     UPDATES_OF(other_update)},
    {.text = "The Loose BVH updates more than an order of magnitude faster than a rebuild",
     .paper = "kitchen x11.2, museum x15.5, falling triangles x18.5",
     .figures = {&loose_update, &loose_update_lbvh},
     .tests = {REACHED(loose, OF_UPDATE)},
     .ours = {EACH("{scene} {0}")},
     .why = {EACH("{scene}: an LBVH rebuild takes, of its time, {1}")}},
    {.text =
         "The update of the Loose BVH takes almost the same time in all frames (here: the frame "
         "of the longest median as long as the mean)",
     .paper = "section 4, figure 7",
     .figures = {&loose_uneven, &updated_uneven},
     .tests = {{.over = BB_EACH, .side = BB_AT_MOST, .claimed = 1}},
     .ours = {{.each = true, .first = "longest over mean: ", .text = "{scene} {0.2}"}},
     .why = {EACH("{scene}: Dynamic G&S {1.2}")}},
    {.text = "The rendering time after updates by Dynamic G&S remains almost untouched (here: "
             "tracing as fast as after a rebuild)",
     .paper = "kitchen x1.01, museum x1.49, falling triangles x1.95",
     .tests = {{.over = BB_EACH, .side = BB_AT_LEAST, .claimed = 1}},
     COSTS_OF(shuffled_trace)},
    {.text = "After updates by Dynamic G&S tracing is even faster than after a rebuild (the "
             "paper's pairing: only the first tree of the former is shuffled)",
     .paper = "museum x1.49, falling triangles x1.95",
     .tests = {REACHED(&updated[BB_DYNAMIC_MUSEUM], OF_TRACE)},
     COSTS_OF(other_trace)},
    {.text = "The same if the rebuilds are shuffled too",
     .paper = "not measured there",
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     COSTS_OF(other_shuffled)},
    {.text = "In the kitchen, small things in a large room, tracing takes longer with the Loose "
             "BVH than after a rebuild",
     .paper = "x0.52: a teapot in the stadium, 100 primitives per leaf, 1,339 at most",
     .figures = {&kitchen_loose, &loose_cost, &cube_cost, &now_cost, &rebuilt_cost},
     .tests = {{.over = BB_EACH, .side = BB_BELOW, .bound = 1, .claimed = 0.522}},
     .ours = {EACH("{scene} {0}")},
     .why = {EACH(
         "over the best made for the frame its trees cost {1.2}, in a cube {2.2}, with "
         "levels and depth by this builder's defaults {3.2}; those of the rebuild {4.2}")}},
    {.text = "Objects of one size that fall are traced fastest in the Loose BVH",
     .paper = "x7.0 and x3.6",
     .figures = {&fall_rebuilt, &fall_updated, &fall_shuffled, &fall_cube},
     .tests = {REACHED(&loose[BB_DYNAMIC_FALL], OF_TRACE),
               {.figure = 1, .over = BB_EACH, .side = BB_ABOVE, .bound = 1, .claimed = 3.6}},
     .ours = {EACH("{scene}: over a rebuild {0}; {scene}: over Dynamic G&S {1}")},
     .why = {EACH(
         "{scene}: over a rebuild, shuffled, {2}; {scene}: in a cube, over the box, {3}")}},
    {.text = "A simple refit increases the time of tracing drastically for most of the scenes "
             "(here: longer than that of an LBVH rebuilt)",
     .paper = "section 4, without figures",
     .figures = {&refit_trace, &refit_update},
     .tests = {{.over = BB_MOST_OF, .side = BB_BELOW, .bound = 1}},
     .ours = {EACH("{scene} {0}")},
     .why = {EACH("{scene}: update {1}")}},
    {.text = "Update and tracing together, Dynamic G&S is superior to a rebuild in all scenes",
     .paper = "kitchen x1.30, museum x1.67, falling triangles x2.42",
     .figures = {&both_paper, &both_shuffled, &both_file, &both_lbvh},
     .tests = {REACHED(updated, OF_BOTH)},
     .ours = {EACH("{scene} {0}")},
     .why = {EACH("{scene}, both shuffled {1}; {scene}, neither {2}; {scene}, an LBVH rebuilt over "
                  "Dynamic G&S {3}")}},
    {.text = NULL},
};
