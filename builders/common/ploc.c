#include "builders/common/ploc.h"

/* Floats beyond a plane's end that ploc_list.clh may read: the radius and two vectors. */
enum { BEYOND = BB_PLOC_RADIUS_MAX + 1 + 16 };

bb_status bb_ploc_create(const bb_builder_context *context, bb_ploc *ploc)
{
    uint64_t radius;
    ploc->device = context->device;
    ploc->account = context->account;
    BB_TRY(bb_spec_u64(context->spec, context->options, "radius", 1, BB_PLOC_RADIUS_MAX, &radius));
    ploc->radius = (uint32_t)radius;
    BB_TRY(bb_sorted_codes_create(context, true, &ploc->sorted));
    return bb_pair_tree_create(ploc->device, ploc->account, &ploc->pairs);
}

void bb_ploc_release(bb_ploc *ploc)
{
    for (int i = 0; i < 2; i++) {
        bb_buffer_release(&ploc->lists[i].planes);
        bb_buffer_release(&ploc->lists[i].tags);
    }
    bb_sorted_codes_release(&ploc->sorted);
    bb_pair_tree_destroy(ploc->pairs);
}

bb_status bb_ploc_prepare(bb_ploc *ploc, const bb_scene *scene, uint32_t lists, bb_tree *tree)
{
    bb_device *device = ploc->device;
    bb_account *account = ploc->account;
    const size_t count = scene->prim_count;
    BB_TRY(bb_sorted_codes_prepare(&ploc->sorted, scene, 1));
    ploc->stride = (uint32_t)(count + BEYOND);
    for (uint32_t i = 0; i < lists; i++) {
        bb_ploc_list *list = &ploc->lists[i];
        BB_TRY(bb_buffer_reserve(device, account, (size_t)ploc->stride * 6 * sizeof(float),
                                 "clusters: boxes", &list->planes));
        BB_TRY(bb_buffer_reserve(device, account, count * 4 * sizeof(uint32_t), "clusters: links",
                                 &list->tags));
    }
    return bb_pair_tree_reserve(ploc->pairs, scene->prim_count, tree);
}

bb_status bb_ploc_finish(bb_ploc *ploc, const bb_scene *scene, bb_tree *tree, bb_phases *phases)
{
    BB_TRY(bb_phase(phases, "order"));
    BB_TRY(bb_pair_tree_finish(ploc->pairs, scene->prim_count, tree));
    return bb_phase(phases, NULL);
}
