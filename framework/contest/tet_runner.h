/* Ways that search tetrahedra: "skip", "octree" (framework/locate/tet_search.h). */
#ifndef BB_TET_RUNNER_H
#define BB_TET_RUNNER_H

#include "framework/contest/contest.h"
#include "framework/locate/tet_search.h"

/* What a task's make() does for such ways: layouts of each scene's tree. */
bb_status bb_tet_runner_make(bb_scene *const *scenes, uint32_t scene_count, const char *search,
                             bb_tree *const *trees, bb_contest_runner *runner);

/* The search of one of the scenes, by the layouts that the runner has now; `runner` NULL: of its
 * list, without a tree. */
bb_status bb_tet_runner_search(const bb_contest_runner *runner, const bb_scene *scene,
                               uint32_t number, const bb_buffer *list, bb_tet_search *search);

#endif
