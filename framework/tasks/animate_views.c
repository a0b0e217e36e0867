/* What is shown of an animation's table. */
#include "framework/tasks/animate.h"

static const bb_axes over_frames = {BB_DRAW_LINES, "frame", "update, ms", false, true};
static const bb_axes costs = {BB_DRAW_LINES, "frame", "SAH / fresh", false, true};
static const bb_axes over_rays = {BB_DRAW_LINES, "rays per frame", "time of a frame, ms", true,
                                  true};

enum {
    METHOD_IN_FRAME = BB_SET(BB_FRAME) | BB_SET(BB_BUILDER),
    NO_PART = BB_SET(BB_QUESTION) | BB_SET(BB_MAKER) | BB_SET(BB_INTERSECTOR),
};

static const bb_table_view views[] = {
    {.caption = "Methods: means of all frames but the first",
     .with = BB_SET(BB_BUILDER),
     .without = BB_SET(BB_FRAME) | BB_SET(BB_QUESTION) | BB_SET(BB_INTERSECTOR),
     .rows = BB_SET(BB_BUILDER),
     .across = BB_SET(BB_MAKER),
     .columns = {{{"update_ms"}, NULL, false},
                 {{"worst_update_ms"}, NULL, false},
                 {{"worst_frame"}, NULL, false},
                 {{"transfer_ms"}, NULL, false},
                 {{"sah_over_best"}, NULL, false},
                 {{"sah_over_best_most"}, NULL, false},
                 {{"drift_per_frame"}, NULL, false},
                 {{"sah_over_fresh_most"}, NULL, false},
                 {{"bytes"}, NULL, false},
                 {{"wrong_answers"}, NULL, false},
                 {{"frames_kept"}, NULL, false},
                 {{"frames_updated"}, NULL, false},
                 {{"frames_rebuilt"}, NULL, false},
                 {{"status"}, NULL, false},
                 {{"refused"}, NULL, false}}},
    {.caption = "Kernels: means of all frames but the first",
     .with = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .without = BB_SET(BB_FRAME) | BB_SET(BB_MAKER),
     .rows = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .across = BB_SET(BB_QUESTION),
     .columns = {{{"layout_ms"}, NULL, false},
                 {{"in_place"}, NULL, false},
                 {{"mrays_per_s"}, NULL, false},
                 {{"wrong_answers"}, NULL, false}}},
    {.caption = "Who is fastest",
     .with = BB_SET(BB_FRAME) | BB_SET(BB_QUESTION),
     .without = BB_SET(BB_BUILDER) | BB_SET(BB_MAKER) | BB_SET(BB_INTERSECTOR),
     .rows = BB_SET(BB_FRAME) | BB_SET(BB_QUESTION),
     .columns = {{{"least_frame_ms"}, NULL, false},
                 {{"fastest"}, NULL, false},
                 {{"as_fast"}, NULL, false}}},
    {.caption = "Rays per frame for which a method is faster than rebuilding each frame",
     .with = BB_SET(BB_QUESTION) | BB_SET(BB_BUILDER),
     .without = BB_SET(BB_FRAME) | BB_SET(BB_MAKER) | BB_SET(BB_INTERSECTOR),
     .rows = BB_SET(BB_BUILDER),
     .across = BB_SET(BB_QUESTION),
     .columns = {{{"faster_for"}, "", false}}},
    {.caption = "Simulated: neither measured nor validated; first and last frame",
     .with = BB_SET(BB_BUILDER) | BB_SET(BB_MAKER) | BB_SET(BB_INTERSECTOR),
     .rows = BB_SET(BB_FRAME) | BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .across = BB_SET(BB_QUESTION),
     .each = BB_SET(BB_MAKER),
     .columns = {{{"simt_mrays_s"}, "bound", false},
                 {{"simt_binds"}, "by", false},
                 {{"simt_efficiency"}, "SIMT efficiency", false},
                 {{"simt_memory_bytes"}, "memory B", false},
                 {{"simt_unsimulated"}, "not simulated", false}}},
    {.caption = "Time of a frame",
     .with = METHOD_IN_FRAME | BB_SET(BB_QUESTION),
     .without = BB_SET(BB_MAKER) | BB_SET(BB_INTERSECTOR),
     .rows = BB_SET(BB_FRAME),
     .across = BB_SET(BB_BUILDER),
     .each = BB_SET(BB_QUESTION),
     .columns = {{{"frame_ms"}, "", false}},
     .axes = &over_rays},
    {.caption = "Updates",
     .with = METHOD_IN_FRAME,
     .without = NO_PART,
     .rows = BB_SET(BB_FRAME),
     .across = BB_SET(BB_BUILDER),
     .columns = {{{"update_ms"}, "", false}},
     .axes = &over_frames},
    {.caption = "Costs",
     .with = METHOD_IN_FRAME,
     .without = NO_PART,
     .rows = BB_SET(BB_FRAME),
     .across = BB_SET(BB_BUILDER),
     .columns = {{{"sah_over_best"}, "", false}},
     .axes = &costs},
    {.caption = "Frames",
     .with = BB_SET(BB_FRAME),
     .without = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .rows = BB_SET(BB_FRAME),
     .across = BB_SET(BB_QUESTION) | BB_SET(BB_MAKER),
     .columns = {{{"primitives"}, NULL, false},
                 {{"moved_percent"}, NULL, false},
                 {{"moved_by"}, NULL, false},
                 {{"rays"}, NULL, false},
                 {{"sah_fresh"}, NULL, false},
                 {{"sah_fresh_best"}, NULL, false},
                 {{"oracle_ms"}, NULL, false},
                 {{"judge_ms"}, NULL, false}}},
    {.caption = "Updates, ms; of the first frame, builds",
     .with = METHOD_IN_FRAME,
     .without = NO_PART,
     .rows = BB_SET(BB_FRAME),
     .across = BB_SET(BB_BUILDER),
     .columns = {{{"update_ms", "build_ms"}, "", false}}},
    {.caption = "SAH / fresh",
     .with = METHOD_IN_FRAME,
     .without = NO_PART,
     .rows = BB_SET(BB_FRAME),
     .across = BB_SET(BB_BUILDER),
     .columns = {{{"sah_over_best"}, "", false}}},
};

enum { VIEWS = sizeof views / sizeof views[0], BRIEF_VIEWS = 5 };

#define OUTLINE                                                                                    \
    .command = "animate", .title = "bvhbench: moving scenes", .views = views, .wrong = "wrong",    \
    .well = "All answers in all frames are right.", .ill = "answers are wrong."

const bb_page_outline bb_animate_outline = {
    OUTLINE,
    .view_count = VIEWS,
    .note = "The first frame is a build for all. ms: medians of the rounds. SAH / fresh: surface "
            "area heuristic of the tree over that of the best tree made for the same frame; most: "
            "in the worst frame; drift: its slope, per frame. in place: frames whose layout "
            "followed without being numbered anew. M/s: millions of rays per second. Time of a "
            "frame: update, transfer, layout and "
            "tracing by the best kernel. Faster: by more than 5 % in the medians, and in every "
            "round. What gives wrong answers is not among the fastest. A tree that is kept takes "
            "no time, and has no point in a chart. Marked: the best, and those tied with it.",
};
const bb_page_outline bb_animate_outline_briefly = {OUTLINE, .view_count = BRIEF_VIEWS};
