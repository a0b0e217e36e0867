/* Claims of Gu, Jendersie, Grosch 2018. */
#include "framework/papers/loose_octree.h"

#include <math.h>
#include <string.h>

/* ---- figures ---- */

#define RATIO(what_) .what = what_, .base = "=", .mean = BB_MEAN_OF_ROUNDS

/* Of a row over its base. */
static const bb_figure build_ratio = {RATIO("build_ms")}, trace_ratio = {RATIO("trace_ms")},
                       frame_ratio = {RATIO(FRAME)}, boxes_ratio = {RATIO("node_tests_per_ray")},
                       tests_ratio = {RATIO("prim_tests_per_ray")},
                       bytes_ratio = {RATIO("bytes_tree")}, peak_ratio = {RATIO("bytes_peak")};
static const bb_figure nodes = {.what = "nodes"}, base_nodes = {.what = "nodes", .builder = "="},
                       leaves = {.what = "leaves"},
                       base_leaves = {.what = "leaves", .builder = "="};

#define ORDER(builder_)                                                                            \
    .what = "trace_ms", .builder = builder_, .base = builder_ ",view=%", .kernel = STACKLESS,      \
    .base_kernel = STACKLESS, .mean = BB_MEAN_OF_ROUNDS, .views = VIEWS
static const bb_figure lbvh_order = {ORDER(LBVH30)}, llbvh_order = {ORDER(LLBVH30)};
static const bb_figure order_boxes = {
    .what = "node_tests_per_ray", .builder = "$,view=%", .base = "$", .views = VIEWS};
/* Of the first view. */
static const bb_figure unordered_boxes = {.what = "node_tests_per_ray", .builder = "$", .views = 1},
                       ordered_boxes = {.what = "node_tests_per_ray",
                                        .builder = "$,view=%",
                                        .views = 1},
                       stack_boxes = {.what = "node_tests_per_ray",
                                      .builder = "$",
                                      .kernel = STACK,
                                      .views = 1};

/* ---- claims ---- */

#define PAIR(builder_, kernel_, base_, base_kernel_)                                               \
    (const bb_paper_entrant[])                                                                     \
    {                                                                                              \
        {.name = "",                                                                               \
         .builder = builder_,                                                                      \
         .kernel = kernel_,                                                                        \
         .base = base_,                                                                            \
         .base_kernel = base_kernel_},                                                             \
        {                                                                                          \
            .name = NULL                                                                           \
        }                                                                                          \
    }
#define LLBVH_TO_LBVH PAIR(LLBVH30, STACK, LBVH30, STACK)
#define BEST_TO_LBVH PAIR(LOBVH_BEST, STACKLESS, LBVH30, STACK)

/* Where the time of a frame goes, and the tests per ray behind it: figures 2 to 6. */
#define OF_FRAME &build_ratio, &trace_ratio, &boxes_ratio, &tests_ratio, &base_trace_share
#define SAY_FRAME                                                                                  \
    .each = true,                                                                                  \
    .text = "{scene}: build {2.2} times as long, trace {3.2} times with {4%0} box tests and "      \
            "{5%0} primitive tests per ray",                                                       \
    .also = " (the base traces this frame in less than a fifth of its build time: few rays for "   \
            "such a scene)",                                                                       \
    .also_when = &(const bb_test)                                                                  \
    {                                                                                              \
        .figure = 6, .side = BB_BELOW, .bound = 0.2, .untimed = true                               \
    }
static const bb_figure base_trace_share = {
    .what = "trace_ms", .per = "build_ms", .builder = "=", .unpaired = true};

#define FASTER                                                                                     \
    &(const bb_test)                                                                               \
    {                                                                                              \
        .figure = 0, .side = BB_BELOW, .bound = 1, .untimed = true                                 \
    }
/* The row's tree is smaller than its base's on more than half of the scenes. */
#define OF_MEMORY                                                                                  \
    .figures = {&bytes_ratio, &nodes, &base_nodes, &leaves, &base_leaves},                         \
    .tests = {{.over = BB_MOST_OF, .side = BB_BELOW, .bound = 1}},                                 \
    .ours = {{.text = "bytes of the tree {0~}; less on {0<1} of {0#} scenes"}},                    \
    .why = {{.each = true,                                                                         \
             .always = true,                                                                       \
             BB_WHEN(0, BB_AT_LEAST, 1),                                                           \
             .text = "{scene}: {1.0} nodes against {2.0}, {3.0} leaves against {4.0}"}}

static bool is_hair(const bb_findings *f, const char *scene)
{
    (void)f;
    return strstr(scene, "hair") != NULL;
}

static bool is_no_hair(const bb_findings *f, const char *scene)
{
    return !is_hair(f, scene);
}

static bool is_initial(const bb_findings *f, const char *scene)
{
    (void)f;
    return strstr(scene, "state=initial") != NULL;
}

static const bb_figure to_smallest = {.what = "trace_ms",
                                      .base = SMALLEST,
                                      .mean = BB_MEAN_OF_ROUNDS},
                       best_to_llbvh = {.what = FRAME, .base = LLBVH30, .base_kernel = STACK},
                       initial_cost = {.what = "sah", .base = "=", .only = is_initial},
                       hair_frame = {.what = FRAME, .base = "=", .only = is_hair},
                       other_frame = {.what = FRAME, .base = "=", .only = is_no_hair};

/* What LOBVH's builder says of each level. */
static void say_levels(bb_paper_place at, bb_words *why)
{
    static const char *const levels[] = {LOBVH("6"), LOBVH("7"), LOBVH("8")};
    for (int i = 0; i < 3; i++)
        bb_say(why, "%s%s", i == 0 ? "The builder says: " : "; ",
               bb_found_text(at.all, at.all->scenes[0], levels[i], "about"));
}

static void judge_memory(bb_paper_place at, bb_said *said)
{
    static const bb_figure peaks[] = {
        {.what = "bytes_peak", .builder = LOBVH("6"), .scale = MIB},
        {.what = "bytes_peak", .builder = LOBVH("7"), .scale = MIB},
        {.what = "bytes_peak", .builder = LOBVH("8"), .scale = MIB},
    };
    bb_claim_verdict each[BB_SERIES_MAX];
    for (size_t s = 0; s < at.all->scene_count; s++) {
        double peak_of[3];
        at.scene = at.all->scenes[s];
        for (int i = 0; i < 3; i++)
            peak_of[i] = bb_value_at(at, &peaks[i]);
        bb_estimate growth = {.value = (peak_of[2] - peak_of[1]) / (peak_of[1] - peak_of[0])};
        growth.low = growth.high = growth.least = growth.most = (double)NAN;
        each[s] = bb_verdict_at(growth, false, BB_EQUAL, 1, 8);
        bb_say_claimed(&said->claimed, at.scene, 8, growth);
        bb_say(&said->ours, "%s%s: peaks of %.0f, %.0f and %.0f MiB, steps that grow %.1f times",
               s > 0 ? "; " : "", at.scene, peak_of[0], peak_of[1], peak_of[2], growth.value);
    }
    said->verdict = bb_all(each, at.all->scene_count);
    if (said->verdict != BB_HELD && at.all->scene_count > 0)
        say_levels(at, &said->why);
}

/* Why another size traces faster: tests per ray, and where the two put the primitives. */
static void say_other_sizes(bb_paper_place at, bb_said *said)
{
    static const bb_figure over[] = {{.what = "trace_ms", .base = SMALLEST},
                                     {.what = "sah", .base = SMALLEST},
                                     {.what = "node_tests_per_ray", .base = SMALLEST},
                                     {.what = "prim_tests_per_ray", .base = SMALLEST}};
    static const bb_figure *const figures[] = {&over[0], &over[1], &over[2], &over[3]};
    for (int i = 1; i <= 3; i++)
        for (size_t s = 0; s < at.all->scene_count; s++) {
            at.row = &bb_box_sizes[i];
            at.scene = at.all->scenes[s];
            if (!(bb_value_at(at, figures[0]) < 0.98))
                continue;
            bb_say(&said->why, "%s", said->why.length > 0 ? "; " : "");
            bb_say_text(&said->why,
                        "{row} on {scene}: trace {0.3}, cost {1.3}, box tests {2%0}, primitive "
                        "tests {3%0}",
                        at, figures);
            const char *about = bb_found_text(at.all, at.scene, bb_box_sizes[i].builder, "about");
            if (about[0] != '\0')
                bb_say(&said->why, " (%s; with the smallest side %s)", about,
                       bb_found_text(at.all, at.scene, SMALLEST, "about"));
        }
}

static void count_apart(bb_paper_place at, bb_said *said)
{
    uint32_t apart = 0, count = 0;
    for (int i = 0; i <= 2; i += 2) {
        at.row = &bb_view_ordered[i];
        const bb_paper_series s = bb_figure_series(at, &bb_order_factor);
        for (size_t k = 0; k < s.count; k++) {
            count += !isnan(s.each[k].value);
            apart += bb_verdict_at(s.each[k], s.timed, BB_EQUAL, 0, 1) == BB_NOT_HELD;
        }
    }
    bb_say(&said->ours, "; of %u scenes and views, %u are surely off by more than %g %%", count,
           apart, 100 * BB_CLAIM_MARGIN);
}

const bb_paper_claim bb_loose_octree_claims[] = {
    {.text = "On mixtures of spheres LOBVH has the shortest build + trace (1, 4.1)",
     .paper = "shortest, both states",
     .rows = BEST_TO_LBVH,
     .figures = {&frame_ratio, &best_to_llbvh, OF_FRAME},
     .tests = {BB_TEST_EACH(0, BB_BELOW, 1), BB_TEST_EACH(1, BB_BELOW, 1)},
     .ours = {{.each = true, .text = "{scene}: level {0=}, to LBVH {0}, to LLBVH {1}"}},
     .why = {{SAY_FRAME, .unless = true}}},
    {.text = "A seventh level makes LOBVH's build longer and leaves its trace (4.1)",
     .paper = "build +70 %, similar tracing times",
     .rows = PAIR(LOBVH("7"), STACKLESS, LOBVH("6"), STACKLESS),
     .figures = {&build_ratio, &trace_ratio, &base_nodes, &nodes, &boxes_ratio, &tests_ratio},
     .tests = {{.over = BB_EACH, .side = BB_ABOVE, .bound = 1, .claimed = 1.7},
               {.figure = 1, .over = BB_EACH, .side = BB_EQUAL, .claimed = 1}},
     .ours = {{.text = "build {0~}, round by round {0}; trace {1~}, round by round {1}"}},
     .why = {{.each = true,
              .text = "{scene}: {2.0} nodes on level 6 and {3.0} on level 7, {4%0} box tests and "
                      "{5%0} primitive tests per ray"}}},
    {.text = "Each further level takes eight times the memory (4.1)",
     .paper = "8 times, about 400 MB at level 7",
     .judge = judge_memory},
    {.text = "On spheres LOBVH of level 6 needs less memory than the binary trees (4.1)",
     .paper = "they have more inner nodes",
     .rows = PAIR(LOBVH("6"), NULL, LBVH30, NULL),
     OF_MEMORY},
    {.text = "Against LBVH, LLBVH's build gets longer by more than its trace gets shorter (4.1)",
     .paper = "in both states",
     .rows = LLBVH_TO_LBVH,
     .figures = {&frame_ratio, NULL, OF_FRAME},
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     .ours = {{.text = "build + trace {0~}, round by round {0}"}},
     .why = {{SAY_FRAME}}},
    {.text = "In the initial state LLBVH's hierarchy is slightly better than LBVH's (4.1)",
     .paper = "slightly better",
     .rows = LLBVH_TO_LBVH,
     .figures = {&initial_cost, NULL, OF_FRAME},
     .tests = {BB_TEST_EACH(0, BB_BELOW, 1)},
     .ours = {{.each = true, .text = "cost {0.3}, trace time {3}"}},
     .why = {{SAY_FRAME, .unless = true}}},
    {.text = "On triangles LLBVH's build is often slower than LBVH's (4.2)",
     .paper = "often",
     .of = OF_TRIANGLES,
     .rows = LLBVH_TO_LBVH,
     .figures = {&build_ratio},
     .tests = {{.over = BB_MOST_OF, .side = BB_ABOVE, .bound = 1}},
     .ours = {{.text = "build time to LBVH's {0~}, round by round {0}"}}},
    {.text = "LLBVH traces triangles hardly faster than LBVH on average, at times slower (4.2)",
     .paper = "minimal, if at all; 4 % on hairball",
     .of = OF_TRIANGLES,
     .rows = LLBVH_TO_LBVH,
     .figures = {&trace_ratio, NULL, OF_FRAME},
     .tests = {BB_TEST_CLAIMED(0, BB_AT_LEAST, 0, 1)},
     .ours = {{.text = "trace time to LBVH's {0~}, round by round {0}"}},
     .why = {{SAY_FRAME, .when = FASTER}}},
    {.text = "On triangles LOBVH is slower than LBVH, but for hairball (4.2)",
     .paper = "much slower in most cases",
     .of = OF_TRIANGLES,
     .rows = BEST_TO_LBVH,
     .figures = {&other_frame, NULL, OF_FRAME},
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     .ours = {{.each = true, .before = ", ", .text = "{scene} {0} (level {0=})"}},
     .why = {{SAY_FRAME, .unless = true}}},
    {.text = "On hairball LOBVH is faster than LBVH (4.2)",
     .paper = "faster than both others",
     .of = OF_TRIANGLES,
     .rows = BEST_TO_LBVH,
     .figures = {&hair_frame, NULL, OF_FRAME},
     .tests = {BB_TEST_EACH(0, BB_BELOW, 1)},
     .ours = {{.each = true, .before = ", ", .text = "{scene} {0} (level {0=})"}},
     .why = {{SAY_FRAME, .unless = true}}},
    {.text = "On triangles LLBVH often needs less memory than LBVH (4.2)",
     .paper = "often better",
     .of = OF_TRIANGLES,
     .rows = LLBVH_TO_LBVH,
     OF_MEMORY},
    {.text = "With 8 levels instead of 7 LOBVH often traces faster, but the build gets much longer "
             "(4.2)",
     .paper = "often; the build grows by a factor like that of the memory, about 8",
     .of = OF_TRIANGLES,
     .rows = PAIR(LOBVH("8"), STACKLESS, LOBVH("7"), STACKLESS),
     .figures = {&trace_ratio, &build_ratio, &peak_ratio, &boxes_ratio, &tests_ratio},
     .tests = {{.figure = 0, .over = BB_MOST_OF, .side = BB_BELOW, .bound = 1},
               BB_TEST_CLAIMED(1, BB_ABOVE, 1, 8)},
     .ours = {{.text = "trace {0~}, round by round {0}; build {1~}, round by round {1}"}},
     .why = {{.each = true,
              .text = "{scene}: build {1.2}, peak memory {2.2}, box tests per ray {3%0}, primitive "
                      "tests {4%0}"}}},
    {.text = "Levels from the smallest side of the box trace faster than from the largest, the "
             "mean side or the root of the volume (3.1)",
     .paper = "all others inferior",
     .of = OF_SIZES,
     .rows = bb_box_sizes,
     .which = OTHER_SIDES,
     .together = true,
     .figures = {&to_smallest},
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     .ours = {{.each = true,
               .first = "mean trace time with another size, to that with the smallest side: ",
               .before = ", ",
               .text = "{row} {0}"}},
     .judge = say_other_sizes},
    {.text = "Size told every two levels only does not improve build + trace on average (2)",
     .paper = "not improved",
     .of = OF_SIZES,
     .rows = PAIR(SMALLEST ",sizes=yes", STACK, SMALLEST, STACK),
     .figures = {&frame_ratio, NULL, OF_FRAME},
     .tests = {BB_TEST_CLAIMED(0, BB_AT_LEAST, 0, 1)},
     .ours = {{.text = "build + trace, with them to without {0~}, round by round {0}"}},
     .why = {{SAY_FRAME, .when = FASTER}}},
    {.text = "The order by the view makes the stackless traversal of LOBVH faster by an order of "
             "magnitude on average (3.4)",
     .paper = "an order of magnitude",
     .of = OF_VIEWS,
     .rows = bb_view_ordered,
     .which = LOBVH_STACKLESS,
     .figures = {&bb_order_factor, &lbvh_order, &llbvh_order, &unordered_boxes, &ordered_boxes,
                 &stack_boxes},
     .tests = {BB_TEST_CLAIMED(0, BB_ABOVE, 1, 10)},
     .ours = {{.text = "LOBVH {0/}; " LBVH30 " {1/}; " LLBVH30 " {2/}"}},
     .why = {{.each = true,
              .of = 3,
              .text = "{scene}, view {view}: {3.0} box tests per ray without an order, {4.0} with "
                      "it, where the stack kernel, which goes to the nearer child first on each "
                      "ray, needs {5.0}"}}},
    {.text = "On the binary trees, traced with a stack, the order by the view does almost nothing "
             "on average (3.4)",
     .paper = "almost non-existent",
     .of = OF_VIEWS,
     .rows = bb_view_ordered,
     .which = BINARY_BY_STACK,
     .together = true,
     .figures = {&bb_order_factor, &order_boxes},
     .tests = {{.over = BB_EACH, .side = BB_EQUAL, .claimed = 1}},
     .ours = {{.each = true, .text = "{row} {0/}"}},
     .why = {{.each = true, .text = "{row}: box tests per ray change by {1!} at most"}},
     .judge = count_apart},
    {.text = NULL},
};
