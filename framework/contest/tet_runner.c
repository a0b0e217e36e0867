#include "framework/contest/tet_runner.h"

bb_status bb_tet_runner_make(bb_scene *const *scenes, uint32_t scene_count, const char *search,
                             bb_tree *const *trees, bb_contest_runner *runner)
{
    bb_spec spec;
    BB_TRY(bb_tet_search_parse(search, &spec));
    runner->leaf = 1;
    runner->by_boundary = bb_tet_search_by_boundary(&spec);
    for (uint32_t s = 0; s < scene_count; s++) {
        BB_TRY(bb_layout_maker_create(bb_layout_find(spec.name), scenes[s]->on_device.device,
                                      &runner->makers[s]));
        BB_TRY(bb_layout_maker_make(&runner->makers[s], scenes[s], trees[s], 1, BB_FORMAT_VERTICES,
                                    &runner->layouts[s]));
    }
    return BB_OK;
}

bb_status bb_tet_runner_search(const bb_contest_runner *runner, const bb_scene *scene,
                               uint32_t number, const bb_buffer *list, bb_tet_search *search)
{
    if (runner != NULL)
        return bb_tet_search_by(scene, runner->makers[number].layout, &runner->layouts[number],
                                search);
    bb_tet_search_all(scene, list, search);
    return BB_OK;
}
