/* What a contest measured, as rows of a paper's table. */
#ifndef BB_PAPER_CONTESTS_H
#define BB_PAPER_CONTESTS_H

#include "framework/contest/contest.h"
#include "framework/papers/reproduce.h"

/* Builder and search of the way without a tree. */
#define BB_NO_TREE "no tree"

/* Adds the ways that were not refused, as scene, builder, search and task: build_ms, layout_ms,
 * answer_ms, nodes, references, bytes, visits, work, differ; and phase_ms of each phase. Returns
 * whether an answer is wrong. */
bool bb_paper_add_ways(bb_table *table, const char *scene, const char *task,
                       const bb_contest_way *ways, uint32_t count);

#endif
