/* The fields of a result file, one row each, in the order in which they are written:
 *
 *   FIELD(id, part, name, unit, kind, writer, format, heading, help)
 *
 * `id` is BB_F_id in C. `part` is the sort of row in which the field stands (schema.h). `kind` says
 * what its values are; a NAME is one of the row's names, PARTS stand in rows of their own, one for
 * each maker, and a DERIVED figure is computed from others when it is asked for (entry.c). `writer`
 * says where the value comes from: a member of the record (scene S, its profile P, build B, trace
 * T, its accuracy A, prediction F), a function (BY), or another field's function or a later step
 * (LATER). All tables use `format`, `heading` and `help`; a field without a heading is in no table.
 *
 * Fields of one name share a column of the file. Metrics of trees are not listed here. Each of them
 * (framework/builder/metric.h) is one or two further columns of a build.
 *
 * This file has no guard: whoever includes it defines FIELD for its own purpose.
 */
/* clang-format off */

/* ---- context ---- */
#define RUN(id, name, unit, kind, sense, format, decimals, heading, help) \
    FIELD(CONTEXT_##id, CONTEXT, name, unit, kind, LATER, format, heading, help)
#include "framework/device/run_fields.h"

/* ---- steps of the run ---- */
FIELD(STEP_NAME, STEP, "name", "", NAME(MAKER), LATER, AS_TEXT, NULL, NULL)
FIELD(STEP_MS, STEP, "step_ms", "ms", NUMBER, LATER, AS_FIGURE, NULL, NULL)
FIELD(STEP_TIME, STEP, "time_ms", "ms", SIGNED | NUMBER, LATER, AS_FIGURE, NULL, NULL)

/* ---- scenes ---- */
FIELD(SCENE_NAME, SCENE, "name", "", NAME(SCENE), LATER, AS_TEXT, "Scene", NULL)
FIELD(SCENE_KIND, SCENE, "kind", "", TEXT, BY(bb_put_kinds), AS_TEXT, "Kind", NULL)
FIELD(SCENE_SOURCE, SCENE, "source", "", TEXT, S(CHARS, source), AS_TEXT, NULL, NULL)
FIELD(SCENE_PRIMS, SCENE, "prims", "", NEEDED | NUMBER, BY(bb_put_prims), AS_WHOLE, "Primitives",
      NULL)
FIELD(SCENE_IGNORED, SCENE, "ignored", "", NUMBER, S(U32, ignored), AS_WHOLE, NULL, NULL)
FIELD(SCENE_LO_X, SCENE, "lo_x", "", NUMBER, S(FLOAT, bounds.lo[0]), AS_FIGURE, NULL, NULL)
FIELD(SCENE_LO_Y, SCENE, "lo_y", "", NUMBER, S(FLOAT, bounds.lo[1]), AS_FIGURE, NULL, NULL)
FIELD(SCENE_LO_Z, SCENE, "lo_z", "", NUMBER, S(FLOAT, bounds.lo[2]), AS_FIGURE, NULL, NULL)
FIELD(SCENE_HI_X, SCENE, "hi_x", "", NUMBER, S(FLOAT, bounds.hi[0]), AS_FIGURE, NULL, NULL)
FIELD(SCENE_HI_Y, SCENE, "hi_y", "", NUMBER, S(FLOAT, bounds.hi[1]), AS_FIGURE, NULL, NULL)
FIELD(SCENE_HI_Z, SCENE, "hi_z", "", NUMBER, S(FLOAT, bounds.hi[2]), AS_FIGURE, NULL, NULL)
FIELD(SCENE_HASH, SCENE, "hash", "", TEXT, S(HASH, hash), AS_TEXT, "Hash", NULL)
FIELD(SCENE_DECISIONS, SCENE, "decision", "", PARTS | TEXT, BY(bb_put_needs), AS_TEXT, "Needs",
      "what the scene asks for, by its profile")
FIELD(SCENE_SCALE, SCENE, "scale", "", NUMBER, S(FLOAT, scale), AS_FIGURE, NULL, NULL)
FIELD(SCENE_OUT_OF_RANGE, SCENE, "out_of_range", "", NUMBER, S(U32, out_of_range), AS_WHOLE, NULL,
      NULL)
FIELD(SCENE_BOXES_MS, SCENE, "boxes_ms", "ms", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(SCENE_BOXES_SAMPLES, SCENE, "scene_boxes_ms", "ms", ROUNDS, BY(bb_put_boxes), AS_FIGURE, NULL,
      NULL)
FIELD(SCENE_VIEWS, SCENE, "views", "", PARTS | NAME(VIEW), BY(bb_put_views), AS_TEXT, "Views", NULL)
FIELD(SCENE_LOAD_MS, SCENE, "load_ms", "ms", NUMBER, S(DOUBLE, load_ms), AS_FIGURE, NULL, NULL)
FIELD(PROFILE_FLATNESS, PROFILE, "flatness", "", NUMBER, P(DOUBLE, flatness), AS_FIGURE, "Flatness",
      "shortest by longest side")
FIELD(PROFILE_SIZE_MIN, PROFILE, "size_min", "", NUMBER, P(DOUBLE, size_min), AS_FIGURE, "Smallest",
      "box diagonal")
FIELD(PROFILE_SIZE_MEDIAN, PROFILE, "size_median", "", NUMBER, P(DOUBLE, size_median), AS_FIGURE,
      "Median", "box diagonal")
FIELD(PROFILE_SIZE_MAX, PROFILE, "size_max", "", NUMBER, P(DOUBLE, size_max), AS_FIGURE, "Largest",
      "box diagonal")
FIELD(PROFILE_SIZE_LOW, PROFILE, "size_low", "", NUMBER, P(DOUBLE, size_low), AS_FIGURE,
      "1 % smaller", "box diagonal")
FIELD(PROFILE_SIZE_HIGH, PROFILE, "size_high", "", NUMBER, P(DOUBLE, size_high), AS_FIGURE,
      "1 % larger", "box diagonal")
FIELD(PROFILE_ZERO_AREA, PROFILE, "zero_area", "", NUMBER, P(U32, zero_area), AS_WHOLE, "Zero area",
      NULL)
FIELD(PROFILE_DUPLICATE_BOXES, PROFILE, "duplicate_boxes", "", NUMBER, P(U32, duplicate_boxes),
      AS_WHOLE, NULL, NULL)
FIELD(PROFILE_DUPLICATE_CENTROIDS, PROFILE, "duplicate_centroids", "", NUMBER,
      P(U32, duplicate_centroids), AS_WHOLE, "Equal centroids", NULL)
FIELD(PROFILE_OVERLAP, PROFILE, "overlap", "", NUMBER, P(DOUBLE, overlap), AS_FIGURE, "Overlap",
      "other boxes that hold a centroid, mean")
FIELD(PROFILE_CLOSED, PROFILE, "closed", "", FLAG, BY(bb_put_closed), AS_TEXT, "Closed", NULL)
FIELD(PROFILE_CODE_BITS, PROFILE, "code_bits", "", NUMBER, P(U32, code_bits), AS_WHOLE, "Code bits",
      "that separate the centroids")
FIELD(PROFILE_OCTREE_DEPTH, PROFILE, "octree_depth", "", NUMBER, P(U32, octree_depth), AS_WHOLE,
      NULL, NULL)
FIELD(PROFILE_BITS_APART, PROFILE, "bits_apart", "", NUMBER, BY(bb_put_bits), AS_WHOLE, NULL, NULL)
FIELD(PROFILE_BITS_USEFUL, PROFILE, "bits_useful", "", NUMBER, P(U32, bits_useful), AS_WHOLE,
      "Useful code bits", "longer codes hardly lower the cost of a tree")

/* ---- builds ---- */
FIELD(BUILD_CELL, BUILD, "cell", "", TEXT, B(CHARS, cell), AS_TEXT, "Key",
      "what `bvhbench run --cell` takes to measure this again")
FIELD(BUILD_SCENE, BUILD, "scene", "", NAME(SCENE), LATER, AS_TEXT, "Scene", NULL)
FIELD(BUILD_BUILDER, BUILD, "builder", "", NAME(BUILDER), LATER, AS_TEXT, "Builder", NULL)
FIELD(BUILD_PARAMS, BUILD, "parameter", "", PARTS | TEXT, BY(bb_put_build_params), AS_PAIRS,
      "Parameters", NULL)
FIELD(BUILD_STATUS, BUILD, "status", "", NEEDED | TEXT, B(STATUS, status), AS_TEXT, "Status", NULL)
FIELD(BUILD_REASON, BUILD, "reason", "", TEXT, B(CHARS, reason), AS_TEXT, NULL, NULL)
FIELD(BUILD_MS, BUILD, "build_ms", "ms", ROUNDS, B(SAMPLES, build_ms), AS_FIGURE, NULL, NULL)
FIELD(BUILD_MS_MEDIAN, BUILD, "build_ms_median", "ms", DERIVED, LATER, AS_FIGURE, "Build ms",
      "median wall clock of the rounds that count")
FIELD(BUILD_MS_LO, BUILD, "build_ms_lo", "ms", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(BUILD_MS_HI, BUILD, "build_ms_hi", "ms", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(BUILD_MS_LEAST, BUILD, "build_ms_least", "ms", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(BUILD_MS_MOST, BUILD, "build_ms_most", "ms", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(BUILD_UNTIMED, BUILD, "untimed_ms", "ms", DERIVED, LATER, AS_FIGURE, "Untimed ms",
      "recurs with each build, outside its clock: restoring, phases that are left out, and what an "
      "unseen input takes longer, if the builder remembers inputs")
FIELD(BUILD_RATE, BUILD, "mprims_s", "Mprims/s", DERIVED, LATER, AS_FIGURE, "Mprims/s",
      "million primitives per second")
FIELD(BUILD_HANDOVER, BUILD, "build_handover", "", TEXT, B(CHARS, handover), AS_TEXT, "Hand-over",
      "how work-groups pass data, of what is built on a device: by a fence, or levels by launches")
FIELD(BUILD_COLD_MS, BUILD, "cold_ms", "ms", NUMBER, B(MEASURED, cold_ms), AS_FIGURE, "Cold ms",
      "first build after allocation")
FIELD(BUILD_STAGES, BUILD, "stage_ms", "ms", PARTS | ROUNDS, BY(bb_put_stages), AS_PAIRS,
      "Stages ms", "of a builder made of several; they add up to build_ms")
FIELD(BUILD_STAGES_SAH, BUILD, "stage_sah", "", PARTS | NUMBER, LATER, AS_PAIRS, "Stages SAH",
      "of the tree after each stage")
FIELD(BUILD_STAGES_BYTES, BUILD, "stage_bytes", "B", PARTS | NUMBER, LATER, AS_PAIRS,
      "Stages bytes", "of the tree, or of the references, that each stage made")
FIELD(BUILD_STAGES_PEAK, BUILD, "stage_bytes_peak", "B", PARTS | NUMBER, LATER, AS_PAIRS,
      "Stages peak",
      "bytes of these, of the stage\xe2\x80\x99s scratch and of its copy of the stage before")
FIELD(BUILD_PHASES, BUILD, "phase_ms", "ms", PARTS | NUMBER, BY(bb_put_phases), AS_PAIRS,
      "Phases ms", NULL)
FIELD(BUILD_EVENT_SAMPLES, BUILD, "event_ms", "ms", ROUNDS, B(SAMPLES, event_ms), AS_FIGURE, NULL,
      NULL)
FIELD(BUILD_CPU_SAMPLES, BUILD, "cpu_ms", "ms", ROUNDS, B(SAMPLES, cpu_ms), AS_FIGURE, NULL, NULL)
FIELD(BUILD_PREPARE_MS, BUILD, "prepare_ms", "ms", NUMBER, B(MEASURED, prepare_ms), AS_FIGURE,
      "Prepare ms", "by the builder, before its first build, outside the clock")
FIELD(BUILD_RESTORE_MS, BUILD, "restore_ms", "ms", ROUNDS, B(SAMPLES, restore_ms), AS_FIGURE,
      "Restore ms", "by the builder, before each build, outside the clock")
FIELD(BUILD_OUTSIDE_MS, BUILD, "outside_ms", "ms", ROUNDS, B(SAMPLES, outside_ms), AS_FIGURE,
      "Outside ms", "on the host, in phases that the clock leaves out")
FIELD(BUILD_UNSEEN_MS, BUILD, "unseen_ms", "ms", ROUNDS, B(SAMPLES, unseen_ms), AS_FIGURE,
      "Unseen ms",
      "to build inputs that the builder had not seen, the scene mirrored and renumbered")
FIELD(BUILD_REMEMBERS, BUILD, "remembers", "", FLAG, B(FLAG, remembers), AS_TEXT, "Remembers",
      "it took more than 1.5 times as long for each of them as for what it had seen")
FIELD(BUILD_INPUTS, BUILD, "inputs", "", TEXT, B(CHARS, inputs), AS_TEXT, "Inputs", NULL)
FIELD(BUILD_BOXES_MS, BUILD, "boxes_ms", "ms", NUMBER, B(MEASURED, boxes_ms), AS_FIGURE, "Boxes ms",
      "to make the input, if it is the primitives\xe2\x80\x99 boxes")
FIELD(BUILD_TRANSFER_MS, BUILD, "transfer_ms", "ms", ROUNDS, B(SAMPLES, transfer_ms), AS_FIGURE,
      "Transfer ms", "of the input to the host, of the tree back")
FIELD(BUILD_LAYOUTS_MS, BUILD, "layout_ms", "ms", PARTS | ROUNDS, BY(bb_put_layouts), AS_PAIRS,
      "Layouts ms", NULL)
FIELD(BUILD_LAYOUTS_SAH, BUILD, "layout_sah", "", PARTS | NUMBER, LATER, AS_PAIRS, "Layouts SAH",
      NULL)
FIELD(BUILD_LAYOUTS_BYTES, BUILD, "layout_bytes", "B", PARTS | NUMBER, LATER, AS_PAIRS, NULL, NULL)
FIELD(BUILD_LAYOUTS_LAUNCHES, BUILD, "first_ray_launches", "", PARTS | NUMBER, LATER, AS_PAIRS,
      "Launches", "kernels, copies and fills that build and layout enqueue, by layout")
FIELD(BUILD_LAYOUTS_FLOOR, BUILD, "first_ray_floor_ms", "ms", PARTS | NUMBER, LATER, AS_PAIRS,
      "Launch floor ms", "what these launches take if they do nothing, by layout")
FIELD(BUILD_FIRST_RAY, BUILD, "first_ray_ms", "ms", PARTS | DERIVED, LATER, AS_PAIRS,
      "First ray ms",
      "what the first ray waits for, by layout: boxes, build, transfer and that layout")
FIELD(SIMT_BUILD_BINDS, BUILD, "simt_build_binds", "", PARTS | TEXT, BY(bb_put_simulated_builds),
      AS_TEXT, NULL, NULL)
#define SIMT_BUILD(id, member, name, unit, better, heading, help) \
    FIELD(SIMT_BUILD_##id, BUILD, name, unit, EXACT | PARTS | NUMBER, LATER, AS_PAIRS, heading, \
          help)
#include "framework/simulate/simt_build_figures.h"
FIELD(BUILD_BYTES_NATIVE, BUILD, "bytes_native", "B", NUMBER, B(DOUBLE, bytes_native), AS_BYTES,
      NULL, NULL)
FIELD(BUILD_REFERENCE, BUILD, "reference", "", FLAG, B(FLAG, reference), AS_TEXT, NULL, NULL)
FIELD(BUILD_ABOUT, BUILD, "about", "", TEXT, B(CHARS, about), AS_TEXT, "About the tree", NULL)
FIELD(BUILD_UNMEASURED, BUILD, "unmeasured", "", FLAG, B(FLAG, unmeasured), AS_TEXT, NULL, NULL)
FIELD(BUILD_DECISIONS, BUILD, "decision", "", PARTS | TEXT, BY(bb_put_build_decisions), AS_TEXT,
      NULL, NULL)
FIELD(DECIDED_BY, BUILD, "decided_by", "", PARTS | TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(DECIDED_FIGURE, BUILD, "decision_figure", "", PARTS | TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(BUILD_RUN, BUILD, "run", "", NAME(RUN), LATER, AS_WHOLE, "Run", NULL)
FIELD(TREE_NODES, TREE, "nodes", "", NUMBER, B(U32, tree.node_count), AS_WHOLE, "Nodes", NULL)
FIELD(TREE_LEAVES, TREE, "leaves", "", NUMBER, B(U32, tree.leaf_count), AS_WHOLE, NULL, NULL)
FIELD(TREE_REFS, TREE, "refs", "", NUMBER, B(U32, tree.ref_count), AS_WHOLE, "References", NULL)
FIELD(TREE_ARITY, TREE, "arity", "", NUMBER, B(U32, tree.arity), AS_WHOLE, "Arity",
      "the most children of a node")
FIELD(TREE_DEPTH, TREE, "depth", "", NUMBER, B(U32, tree.depth), AS_WHOLE, "Depth",
      "edges from the root to the deepest leaf")
FIELD(TREE_BYTES, TREE, "bytes_tree", "B", NUMBER, B(SIZE64, bytes_tree), AS_BYTES, "Tree",
      "bytes of the tree; of embree-native, of what Embree holds")
FIELD(TREE_BYTES_PEAK, TREE, "bytes_peak", "B", NUMBER, B(SIZE64, bytes_peak), AS_BYTES, "Peak",
      "bytes of the tree and all scratch memory")
FIELD(TREE_BYTES_UNBOOKED, TREE, "bytes_unbooked", "B", NUMBER, B(SIZE64, bytes_unbooked), AS_BYTES,
      "Unbooked", "of the peak: resident memory that the builder has not booked")

/* ---- traces ---- */
FIELD(TRACE_CELL, TRACE, "cell", "", NEEDED | TEXT, T(CHARS, cell), AS_TEXT, "Key",
      "what `bvhbench run --cell` takes to measure this again")
FIELD(TRACE_SCENE, TRACE, "scene", "", NAME(SCENE), LATER, AS_TEXT, "Scene", NULL)
FIELD(TRACE_VIEW, TRACE, "view", "", NAME(VIEW), LATER, AS_TEXT, "View", NULL)
FIELD(TRACE_BUILDER, TRACE, "builder", "", NAME(BUILDER), LATER, AS_TEXT, "Builder", NULL)
FIELD(TRACE_KERNEL, TRACE, "kernel", "", NAME(KERNEL), LATER, AS_TEXT, "Kernel", NULL)
FIELD(TRACE_LAYOUT, TRACE, "layout", "", TEXT, T(CHARS, layout), AS_TEXT, "Layout", NULL)
FIELD(TRACE_NATIVE, TRACE, "native", "", FLAG, BY(bb_put_native), AS_TEXT, "Tree",
      "native: the layout keeps the shape of the builder\xe2\x80\x99s own tree")
FIELD(TRACE_INTERSECTOR, TRACE, "intersector", "", NAME(INTERSECTOR), LATER, AS_TEXT, "Intersector",
      NULL)
FIELD(TRACE_RAYS, TRACE, "rays", "", NAME(QUESTION), LATER, AS_TEXT, "Rays", NULL)
FIELD(TRACE_RAYS_SOURCE, TRACE, "rays_source", "", TEXT, BY(bb_put_rays_source), AS_TEXT, NULL,
      NULL)
FIELD(TRACE_QUERY, TRACE, "query", "", TEXT, BY(bb_put_query), AS_TEXT, "Query", NULL)
FIELD(TRACE_COUNT, TRACE, "count", "", NEEDED | NUMBER, T(U32, count), AS_WHOLE, "Rays traced",
      NULL)
FIELD(TRACE_RAYS_HASH, TRACE, "rays_hash", "", TEXT, T(HASH, rays_hash), AS_TEXT, NULL, NULL)
FIELD(TRACE_RAYS_PARAMS, TRACE, "parameter", "", PARTS | TEXT, BY(bb_put_rays_params), AS_PAIRS,
      NULL, NULL)
FIELD(TRACE_GROUP, TRACE, "group_size", "", NUMBER, T(SIZE, group_size), AS_WHOLE, NULL, NULL)
FIELD(TRACE_STACK, TRACE, "stack_size", "", NUMBER, T(SIZE, stack_size), AS_WHOLE, NULL, NULL)
FIELD(TRACE_DECISIONS, TRACE, "decision", "", PARTS | TEXT, BY(bb_put_trace_decisions), AS_TEXT,
      NULL, NULL)
FIELD(TRACE_DECIDED_BY, TRACE, "decided_by", "", PARTS | TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(TRACE_STATUS, TRACE, "status", "", NEEDED | TEXT, T(STATUS, status), AS_TEXT, "Status", NULL)
FIELD(TRACE_REASON, TRACE, "reason", "", TEXT, T(CHARS, reason), AS_TEXT, NULL, NULL)
FIELD(TRACE_LAUNCHES, TRACE, "launches", "", NUMBER, T(SIZE, launches), AS_WHOLE, "Launches",
      "that a round took")
FIELD(TRACE_WARM, TRACE, "warm_rounds", "", NUMBER, T(SIZE, warm_rounds), AS_WHOLE, NULL, NULL)
FIELD(TRACE_MS, TRACE, "ms", "ms", ROUNDS, T(SAMPLES, ms), AS_FIGURE, NULL, NULL)
FIELD(TRACE_MS_MEDIAN, TRACE, "ms_median", "ms", DERIVED, LATER, AS_FIGURE, "ms",
      "median wall clock")
FIELD(TRACE_EVENT_MS, TRACE, "event_ms", "ms", ROUNDS, T(SAMPLES, event_ms), AS_FIGURE, "Event ms",
      "OpenCL profiling")
FIELD(TRACE_CPU_MS, TRACE, "cpu_ms", "ms", ROUNDS, T(SAMPLES, cpu_ms), AS_FIGURE, "CPU ms",
      "process time of all threads")
FIELD(TRACE_SORT_MS, TRACE, "sort_ms", "ms", ROUNDS, T(SAMPLES, sort_ms), AS_FIGURE, "Sort ms",
      "sorting the rays, part of the trace (kernel option sort=yes)")
FIELD(TRACE_RATE, TRACE, "mrays_s", "Mrays/s", DERIVED, LATER, AS_FIGURE, "Mrays/s",
      "million rays per second, by the median wall clock")
FIELD(TRACE_RATE_GIVEN, TRACE, "mrays_s_given", "Mrays/s", NUMBER, BY(bb_put_given), AS_TEXT, NULL,
      NULL)
FIELD(TRACE_RATE_LO, TRACE, "mrays_s_lo", "Mrays/s", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(TRACE_RATE_HI, TRACE, "mrays_s_hi", "Mrays/s", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(TRACE_RATE_LEAST, TRACE, "mrays_s_least", "Mrays/s", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(TRACE_RATE_MOST, TRACE, "mrays_s_most", "Mrays/s", DERIVED, LATER, AS_FIGURE, NULL, NULL)
FIELD(TRACE_NODE_TESTS, TRACE, "node_tests_per_ray", "per ray", NUMBER,
      T(MEASURED, node_tests_per_ray), AS_FIGURE, "Box tests", "per ray")
FIELD(TRACE_PRIM_TESTS, TRACE, "prim_tests_per_ray", "per ray", NUMBER,
      T(MEASURED, prim_tests_per_ray), AS_FIGURE, "Prim. tests", "per ray")
FIELD(TRACE_WORK, TRACE, "work_per_ray", "per ray", DERIVED, LATER, AS_FIGURE, "Work",
      "per ray: 1.2 for each pair of boxes tested, 1 for each primitive, as in SAH")
FIELD(TRACE_COUNTED, TRACE, "counted", "", NUMBER, T(SIZE, counted), AS_WHOLE, "Counted",
      "rays whose tests were counted")
FIELD(SIMT_BINDS, TRACE, "simt_binds", "", PARTS | TEXT, BY(bb_put_simulated), AS_TEXT, NULL, NULL)
#define SIMT(id, member, name, unit, better, heading, help) \
    FIELD(SIMT_##id, TRACE, name, unit, EXACT | PARTS | NUMBER, LATER, AS_PAIRS, heading, help)
#include "framework/simulate/simt_figures.h"
FIELD(TRACE_UNLIKE, TRACE, "unlike", "", NUMBER, BY(bb_put_unlike), AS_WHOLE, NULL, NULL)
FIELD(TRACE_UNLIKE_WHOM, TRACE, "unlike_whom", "", TEXT, T(CHARS, unlike_whom), AS_TEXT, NULL, NULL)
FIELD(TRACE_COUNTS, TRACE, "counts_for_exit", "", FLAG, T(FLAG, counts_for_exit), AS_TEXT, NULL,
      NULL)
FIELD(TRACE_WRONG, TRACE, "wrong", "", FLAG, T(FLAG, wrong), AS_TEXT, NULL, NULL)
FIELD(TRACE_REFERENCE, TRACE, "reference", "", FLAG, T(FLAG, reference), AS_TEXT, NULL, NULL)
FIELD(TRACE_ON, TRACE, "traced_on", "", TEXT, T(CHARS, traced_on), AS_TEXT, "Traced on",
      "what traced, if not the device of the run: references are Embree on the CPU")
FIELD(TRACE_RUN, TRACE, "run", "", NAME(RUN), LATER, AS_WHOLE, "Run", NULL)
FIELD(TRACE_TREE_RUN, TRACE, "tree_run", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(ACCURACY_CHECKED, ACCURACY, "checked", "rays", NUMBER, A(U64, checked), AS_WHOLE, NULL, NULL)
FIELD(ACCURACY_WRONG_PPM, ACCURACY, "wrong_ppm", "ppm", NUMBER, BY(bb_put_wrong_ppm), AS_FIGURE,
      "Wrong ppm", "wrong rays per million")
FIELD(ACCURACY_MISSED, ACCURACY, "missed", "rays", NUMBER, A(U64, missed), AS_WHOLE, "Missed", NULL)
FIELD(ACCURACY_FALSE, ACCURACY, "false", "rays", NUMBER, A(U64, false_hits), AS_WHOLE, "False",
      NULL)
FIELD(ACCURACY_WRONG_T, ACCURACY, "wrong_t", "rays", NUMBER, A(U64, wrong_t), AS_WHOLE, "Wrong t",
      NULL)
FIELD(ACCURACY_UNWRITTEN, ACCURACY, "unwritten", "rays", NUMBER, A(U64, unwritten), AS_WHOLE, NULL,
      NULL)
FIELD(ACCURACY_RIGHT, ACCURACY, "right", "rays", NUMBER, A(U64, right), AS_WHOLE, NULL, NULL)
FIELD(ACCURACY_TIES, ACCURACY, "ties", "rays", NUMBER, A(U64, ties), AS_WHOLE, "Ties", NULL)
FIELD(ACCURACY_MARGIN, ACCURACY, "margin_limited", "rays", NUMBER, A(U64, margin_limited), AS_WHOLE,
      "Margin limited", NULL)
FIELD(ACCURACY_T_OFF, ACCURACY, "t_off", "rays", NUMBER, A(U64, t_off), AS_WHOLE, "t off",
      "right, but the distance is off by more than 1/1024 of it")
FIELD(ACCURACY_ORACLE_WRONG, ACCURACY, "oracle_wrong", "rays", NUMBER, A(U64, oracle_wrong),
      AS_WHOLE, "Oracle wrong", NULL)
FIELD(ACCURACY_FORGIVEN, ACCURACY, "forgiven", "rays", NUMBER, A(U64, forgiven), AS_WHOLE, NULL,
      NULL)
FIELD(ACCURACY_ARBITRATED, ACCURACY, "arbitrated", "rays", NUMBER, A(U64, arbitrated), AS_WHOLE,
      NULL, NULL)
FIELD(ACCURACY_T_ULP_MAX, ACCURACY, "t_ulp_max", "ulp", NUMBER, A(DOUBLE, t_ulp_max), AS_FIGURE,
      "t error max", "units of the last place")
FIELD(ACCURACY_T_ULP_P99, ACCURACY, "t_ulp_p99", "ulp", NUMBER, A(DOUBLE, t_ulp_p99), AS_FIGURE,
      "t error p99", "units of the last place")
FIELD(ACCURACY_OVERFLOWED, ACCURACY, "overflowed", "rays", NUMBER, BY(bb_put_overflowed), AS_WHOLE,
      "Overflowed", "of the counted rays")
FIELD(ACCURACY_FIRST_WRONG, ACCURACY, "first_wrong", "", NUMBER, BY(bb_put_first_wrong), AS_WHOLE,
      NULL, NULL)
FIELD(ACCURACY_JUDGE_MS, ACCURACY, "judge_ms", "ms", NUMBER, A(DOUBLE, judge_ms), AS_FIGURE, NULL,
      NULL)

/* ---- skipped ray sets, pictures ---- */
FIELD(SKIPPED_SCENE, SKIPPED, "scene", "", NAME(SCENE), LATER, AS_TEXT, "Scene", NULL)
FIELD(SKIPPED_RAYS, SKIPPED, "rays", "", NAME(QUESTION), LATER, AS_TEXT, "Rays", NULL)
FIELD(SKIPPED_VIEW, SKIPPED, "view", "", NAME(VIEW), LATER, AS_TEXT, "View", NULL)
FIELD(SKIPPED_REASON, SKIPPED, "reason", "", TEXT, LATER, AS_TEXT, "Reason", NULL)
FIELD(SKIPPED_RUN, SKIPPED, "run", "", NAME(RUN), LATER, AS_WHOLE, "Run", NULL)
FIELD(PICTURE_SCENE, PICTURE, "scene", "", NAME(SCENE), LATER, AS_TEXT, NULL, NULL)
FIELD(PICTURE_VIEW, PICTURE, "view", "", NAME(VIEW), LATER, AS_TEXT, NULL, NULL)
FIELD(PICTURE_CAPTION, PICTURE, "caption", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(PICTURE_FOLDER, PICTURE, "folder", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(PICTURE_PATH, PICTURE, "path", "", NAME(FRAME), LATER, AS_TEXT, NULL, NULL)

/* ---- whether measures of trees predict what rays take, by kind of rays ---- */
FIELD(PREDICTION_RAYS, PREDICTION, "rays", "", NAME(QUESTION), LATER, AS_TEXT, "Rays", NULL)
FIELD(PREDICTION_CELLS, PREDICTION, "cells", "", NUMBER, F(U32, cells), AS_WHOLE, "Cells",
      "`exact`, right, of trees that are more than a leaf")
FIELD(PREDICTION_GROUPS, PREDICTION, "groups", "", NUMBER, F(U32, groups), AS_WHOLE, "Groups",
      "of cells on the same rays by the same kernel: each has a factor of its own")
FIELD(PREDICTION_TREES, PREDICTION, "trees", "", NUMBER, F(U32, trees), AS_WHOLE, "Trees", NULL)
FIELD(PREDICTION_SCENES, PREDICTION, "scenes", "", NUMBER, F(U32, scenes), AS_WHOLE, "Scenes", NULL)
FIELD(PREDICTION_ALPHA, PREDICTION, "alpha", "", NUMBER, F(DOUBLE, alpha), AS_FIGURE, "alpha",
      "of (1 - alpha) SAH + alpha EPO, least squares of logarithms")
FIELD(PREDICTION_ALPHA_LEAST, PREDICTION, "alpha_least", "", NUMBER, F(DOUBLE, alpha_least),
      AS_FIGURE, "least", "of the alphas with one scene left out; of 3 scenes or more")
FIELD(PREDICTION_ALPHA_MOST, PREDICTION, "alpha_most", "", NUMBER, F(DOUBLE, alpha_most), AS_FIGURE,
      "most", "of the alphas with one scene left out")
FIELD(PREDICTION_MIX_ERROR, PREDICTION, "mix_error", "", NUMBER, F(DOUBLE, mix_error), AS_FIGURE,
      "Mix error", "typical deviation of the time per ray from the mix, in parts of it")
FIELD(PREDICTION_UNSEEN, PREDICTION, "unseen_error", "", NUMBER, F(DOUBLE, unseen_error), AS_FIGURE,
      "unseen", "the same on scenes whose cells did not enter alpha")
FIELD(PREDICTION_MIX_R, PREDICTION, "mix_correlation", "", NUMBER, F(DOUBLE, mix_correlation),
      AS_FIGURE, "Mix r", "correlation of logarithms, within groups")
FIELD(PREDICTION_SAH_ERROR, PREDICTION, "sah_error", "", NUMBER, F(DOUBLE, sah_error), AS_FIGURE,
      "SAH error", "of SAH alone")
FIELD(PREDICTION_SAH_R, PREDICTION, "sah_correlation", "", NUMBER, F(DOUBLE, sah_correlation),
      AS_FIGURE, "SAH r", NULL)
FIELD(PREDICTION_EPO_ERROR, PREDICTION, "epo_error", "", NUMBER, F(DOUBLE, epo_error), AS_FIGURE,
      "EPO error", "of EPO alone")
FIELD(PREDICTION_EPO_R, PREDICTION, "epo_correlation", "", NUMBER, F(DOUBLE, epo_correlation),
      AS_FIGURE, "EPO r", NULL)
FIELD(PREDICTION_WORK_ERROR, PREDICTION, "work_error", "", NUMBER, F(DOUBLE, work_error), AS_FIGURE,
      "Work error", "of the counted work alone")
FIELD(PREDICTION_WORK_R, PREDICTION, "work_correlation", "", NUMBER, F(DOUBLE, work_correlation),
      AS_FIGURE, "Work r", NULL)

/* ---- papers reproduced: tables of their figures and ours, and what was claimed ---- */
FIELD(PAPER_NAME, PAPER, "name", "", NAME(QUESTION), LATER, AS_TEXT, NULL, NULL)
FIELD(PAPER_TITLE, PAPER, "title", "", NEEDED | TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(TABLE_TITLE, TABLE, "title", "", NAME(FRAME), LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_CLAIM, CLAIM, "claim", "", NAME(MAKER), LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_HELD, CLAIM, "held", "", FLAG, LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_VERDICT, CLAIM, "verdict", "", NEEDED | TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_SIMULATED, CLAIM, "simulated", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_PAPER, CLAIM, "paper", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_CLAIMED, CLAIM, "claimed", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_OURS, CLAIM, "ours", "", TEXT, LATER, AS_TEXT, NULL, NULL)
FIELD(CLAIM_WHY, CLAIM, "why", "", TEXT, LATER, AS_TEXT, NULL, NULL)

#undef FIELD
/* clang-format on */
