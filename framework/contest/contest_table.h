/* What a contest measured, as rows of a table: of each way, each tree and each phase of its build.
 */
#ifndef BB_CONTEST_TABLE_H
#define BB_CONTEST_TABLE_H

#include "framework/contest/contest.h"
#include "framework/show/outline.h"

enum { BB_CONTEST_VIEWS = 8, BB_CONTEST_VIEWS_BRIEF = 6 };

/* Views of all contests, for bb_page_outline; the last ones are those of trees and phases. */
extern const bb_table_view bb_contest_views[BB_CONTEST_VIEWS];

/* Meshes of tetrahedra; picture: the path of a PNG file from the table's folder. */
extern const bb_column bb_column_tetrahedra, bb_column_boundary, bb_column_field, bb_column_picture;

/* Adds the ways. `items`: how many an answer has, such as voxels of a slice. `primitives`: of the
 * scene, which references are counted by; 0: they are not. */
void bb_contest_fill(bb_table *table, const char *scene, const bb_contest_way *ways, uint32_t count,
                     double items, double primitives);

/* The row of a way. */
uint32_t bb_contest_row(bb_table *table, const char *scene, const bb_contest_way *way);

#endif
