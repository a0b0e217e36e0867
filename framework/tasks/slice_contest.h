/* Builders and searches against each other in slicing a mesh: `bvhbench slice`. */
#ifndef BB_SLICE_CONTEST_H
#define BB_SLICE_CONTEST_H

#include "framework/bench/contest.h"
#include "framework/table/outline.h"
#include "framework/tasks/slice.h"

typedef struct bb_slice_request {
    bb_contest_request contest;
    bb_slice_plan plan; /* see bb_slice_plan_check() */
    bool exr;           /* pictures are also written as EXR */
} bb_slice_request;

/* Measures, and puts figures into the table; nothing after a failure. The scene is on the device.
 * What a builder or search cannot do is said in its row. */
bb_status bb_slice_run(const bb_slice_request *request, bb_scene *scene, bb_table *table);

extern const bb_page_outline bb_slice_outline;

#endif
