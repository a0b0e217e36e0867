/* Builders and searches against each other in finding where two meshes overlap: `bvhbench overlap`.
 */
#ifndef BB_OVERLAP_CONTEST_H
#define BB_OVERLAP_CONTEST_H

#include "framework/bench/contest.h"
#include "framework/table/outline.h"
#include "framework/tasks/overlap.h"

/* Both scenes are on the device, and may be one; each builder builds both trees. Each asks the
 * other; times are of both directions together. Puts figures into the table; nothing after a
 * failure. What a builder or search cannot do is said in its row. `folder` gets PNG files of both
 * meshes without what meets the other, from outside, whose failure is returned when all else is in
 * the table; NULL: none. */
bb_status bb_overlap_run(const bb_contest_request *request, bb_scene *const scenes[2],
                         const char *folder, bb_table *table);

extern const bb_page_outline bb_overlap_outline, bb_overlap_outline_briefly;

#endif
