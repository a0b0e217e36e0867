#include "framework/bench/resident.h"

void bb_resident_evict(bb_resident *resident)
{
    for (uint32_t k = 0; k < BB_LAYOUTS_MAX; k++) {
        bb_layout_data_release(&resident->layouts[k]);
        resident->has_layout[k] = false;
    }
    bb_instance_destroy(&resident->instance);
    resident->built = false;
}

void bb_residency_note(bb_residency *all)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < all->count; i++) {
        const bb_resident *resident = &all->items[i];
        bytes += resident->instance.account.peak;
        for (uint32_t k = 0; k < all->layout_count; k++)
            bytes += resident->has_layout[k] ? resident->layouts[k].bytes : 0;
    }
    if (bytes > all->bytes_held)
        all->bytes_held = bytes;
}

/* Frees what all residents but `keep` have in memory. Returns false if they had nothing. */
static bool evict_others(bb_residency *all, const bb_resident *keep)
{
    bool freed = false;
    for (uint32_t i = 0; i < all->count; i++) {
        bb_resident *other = &all->items[i];
        if (other == keep || other->instance.pipeline.count == 0)
            continue;
        bb_resident_evict(other);
        freed = true;
    }
    return freed;
}

static bb_status create_and_build(bb_residency *all, bb_resident *resident, double *ms)
{
    bb_build_timing timing;
    if (resident->instance.pipeline.count == 0)
        BB_TRY(bb_instance_create(all->device, resident->text, resident->scene, all->seed,
                                  &resident->instance));
    BB_TRY(bb_instance_build(&resident->instance, resident->scene, false, &timing));
    *ms = timing.timing.ms;
    return BB_OK;
}

/* Makes the first build, on fresh memory. Drivers may compile a kernel when it is first enqueued.
 * The very first build on a device is therefore thrown away with its memory, so that compiling is
 * no part of the cold time. */
static bb_status first_build(bb_residency *all, bb_resident *resident, double *cold_ms)
{
    bb_status status = BB_OK;
    bb_pipeline pipeline;
    BB_TRY(bb_pipeline_parse(resident->text, &pipeline));
    if (!resident->compiled && bb_pipeline_on_device(&pipeline) > 0) {
        status = create_and_build(all, resident, cold_ms);
        bb_resident_evict(resident);
    }
    resident->compiled = true;
    if (status == BB_OK)
        status = create_and_build(all, resident, cold_ms);
    resident->built = status == BB_OK;
    return status;
}

bb_status bb_resident_tree(bb_residency *all, bb_resident *resident)
{
    if (resident->built)
        return BB_OK;
    double cold_ms = 0;
    bb_status status = first_build(all, resident, &cold_ms);
    if (status == BB_REFUSED && evict_others(all, resident)) {
        bb_resident_evict(resident);
        status = first_build(all, resident, &cold_ms);
    }
    if (status != BB_OK) {
        bb_resident_evict(resident);
        return status;
    }
    if (resident->cold_ms == 0)
        resident->cold_ms = cold_ms;
    return BB_OK;
}

bb_status bb_resident_upload(bb_residency *all, bb_resident *resident, double *ms)
{
    bb_tree *tree = &resident->instance.tree;
    bb_status status = bb_tree_upload(tree, all->device, ms);
    if (status == BB_REFUSED && evict_others(all, resident))
        status = bb_tree_upload(tree, all->device, ms);
    return status;
}

/* ---- layouts ---- */

bb_status bb_residency_layout(bb_residency *all, const bb_layout *layout,
                              const bb_layout_wish *wish, uint32_t leaf, uint32_t format,
                              uint32_t *index)
{
    for (uint32_t i = 0; i < all->layout_count; i++) {
        const bb_layout_choice *l = &all->layouts[i];
        if (l->maker.layout == layout && l->format == format && l->leaf == leaf &&
            bb_layout_wish_is(&l->maker.wish, wish)) {
            *index = i;
            return BB_OK;
        }
    }
    if (all->layout_count == BB_LAYOUTS_MAX)
        return bb_fail(BB_INVALID, "at most %d layouts at once", BB_LAYOUTS_MAX);
    *index = all->layout_count++;
    bb_layout_choice *wanted = &all->layouts[*index];
    wanted->leaf = leaf;
    wanted->format = format;
    BB_TRY(bb_layout_maker_create(layout, all->device, &wanted->maker));
    wanted->maker.wish = *wish;
    return BB_OK;
}

void bb_residency_end(bb_residency *all)
{
    for (uint32_t i = 0; i < all->layout_count; i++)
        bb_layout_maker_destroy(&all->layouts[i].maker);
    all->layout_count = 0;
}

static bb_status make_layout(bb_residency *all, bb_resident *resident, uint32_t layout)
{
    bb_layout_choice *choice = &all->layouts[layout];
    bb_layout_data *data = &resident->layouts[layout];
    bb_tree *tree = &resident->instance.tree;
    BB_TRY(bb_tree_upload(tree, all->device, NULL));
    return bb_layout_maker_make(&choice->maker, resident->scene, tree, choice->leaf, choice->format,
                                data);
}

/* Makes room for one layout by evicting other builders' trees, then the resident's other layouts
 * with their scratch. They are made again when needed. */
static bb_status make_room(bb_residency *all, bb_resident *resident, uint32_t layout)
{
    evict_others(all, resident);
    for (uint32_t k = 0; k < all->layout_count; k++) {
        bb_layout_data_release(&resident->layouts[k]);
        resident->has_layout[k] = false;
        bb_layout_maker *maker = &all->layouts[k].maker;
        const bb_layout *made = maker->layout;
        const bb_layout_wish wish = maker->wish;
        if (k == layout || made == NULL)
            continue;
        bb_layout_maker_destroy(maker);
        BB_TRY(bb_layout_maker_create(made, all->device, maker));
        maker->wish = wish;
    }
    return BB_OK;
}

/* Makes the layout beside what is there, else in the room of others. */
static bb_status make_layout_fit(bb_residency *all, bb_resident *resident, uint32_t layout)
{
    bb_status status = make_layout(all, resident, layout);
    if (status == BB_REFUSED) {
        status = make_room(all, resident, layout);
        if (status == BB_OK)
            status = make_layout(all, resident, layout);
    }
    resident->has_layout[layout] = status == BB_OK;
    if (status != BB_OK)
        bb_layout_data_release(&resident->layouts[layout]);
    return status;
}

bb_status bb_resident_layout(bb_residency *all, bb_resident *resident, uint32_t layout)
{
    if (resident->has_layout[layout])
        return BB_OK;
    bb_status status = bb_resident_tree(all, resident);
    const bb_tree_info *info = &resident->instance.tree.info;
    if (status == BB_OK && resident->checked &&
        (info->node_count != resident->tree.node_count || info->depth != resident->tree.depth))
        status =
            bb_fail(BB_FAILED, "built again, the tree has %u nodes and depth %u, not %u and %u",
                    info->node_count, info->depth, resident->tree.node_count, resident->tree.depth);
    if (status == BB_OK)
        status = make_layout_fit(all, resident, layout);
    if (status != BB_OK)
        return status;
    bb_residency_note(all);
    resident->keeps_shape[layout] = resident->layouts[layout].keeps_shape;
    return BB_OK;
}

bb_status bb_resident_check(bb_resident *resident)
{
    bb_tree *tree = &resident->instance.tree;
    BB_TRY(bb_tree_download(tree, NULL));
    BB_TRY(bb_tree_check(tree, resident->scene));
    resident->checked = true;
    resident->tree = tree->info;
    return BB_OK;
}

bb_status bb_resident_layout_again(bb_residency *all, bb_resident *resident, uint32_t layout)
{
    BB_TRY(bb_resident_tree(all, resident));
    return make_layout_fit(all, resident, layout);
}
