#include "framework/bench/resident.h"

#include "framework/scene/seal.h"

bool bb_resident_free_tree(bb_resident *resident)
{
    const bool had = resident->instance.pipeline.count > 0;
    if (had) {
        bb_instance_destroy(&resident->instance);
        bb_scene_put_back(resident->scene); /* no row is left to fail */
    }
    resident->built = false;
    return had;
}

bool bb_resident_evict(bb_resident *resident)
{
    bool had = bb_resident_free_tree(resident);
    for (uint32_t k = 0; k < BB_LAYOUTS_MAX; k++) {
        had = had || resident->has_layout[k];
        bb_layout_data_release(&resident->layouts[k]);
        resident->has_layout[k] = false;
    }
    return had;
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

/* Makes room by evicting others' trees, then all layouts but those of one kind (BB_NONE: all), with
 * their scratch. They are made again when needed. Returns false if there was nothing to free. */
static bool make_room(bb_residency *all, const bb_resident *keep, uint32_t layout)
{
    bool freed = false;
    for (uint32_t i = 0; i < all->count; i++) {
        bb_resident *resident = &all->items[i];
        if (resident != keep && !resident->pinned)
            freed = bb_resident_evict(resident) || freed;
        for (uint32_t k = 0; k < all->layout_count; k++) {
            if (k == layout || !resident->has_layout[k])
                continue;
            bb_layout_data_release(&resident->layouts[k]);
            resident->has_layout[k] = false;
            freed = true;
        }
    }
    for (uint32_t k = 0; k < all->layout_count; k++) {
        if (k == layout)
            continue;
        freed = freed || all->layouts[k].maker.layout != NULL;
        bb_layout_maker_destroy(&all->layouts[k].maker);
    }
    return freed || (all->give_up != NULL && all->give_up(all->whom));
}

bool bb_residency_make_room(bb_residency *all, const bb_resident *keep)
{
    return make_room(all, keep, BB_NONE);
}

void bb_residency_pin(bb_residency *all, bb_resident *first, uint32_t count)
{
    for (uint32_t i = 0; i < all->count; i++)
        all->items[i].pinned = false;
    for (uint32_t i = 0; i < count; i++)
        first[i].pinned = true;
}

/* An attempt begins: what others lacked before is no reason to give up anything for it. */
static void begin_attempt(void)
{
    (void)bb_host_missing();
}

static bb_status create_and_build(bb_residency *all, bb_resident *resident, double *ms)
{
    bb_build_timing timing;
    begin_attempt();
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
    bb_pipeline pipeline;
    BB_TRY(bb_pipeline_parse(resident->text, &pipeline));
    if (!resident->compiled && bb_pipeline_on_device(&pipeline) > 0) {
        BB_TRY(create_and_build(all, resident, cold_ms));
        bb_resident_evict(resident);
    }
    resident->compiled = true;
    BB_TRY(create_and_build(all, resident, cold_ms));
    resident->built = true;
    return BB_OK;
}

bb_status bb_resident_tree(bb_residency *all, bb_resident *resident)
{
    if (resident->built)
        return BB_OK;
    double cold_ms = 0;
    bb_status status = first_build(all, resident, &cold_ms);
    while (status == BB_REFUSED && make_room(all, resident, BB_NONE)) {
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

bb_status bb_resident_build_once(bb_resident *resident, bb_build_timing *timing)
{
    begin_attempt();
    const bb_status status = bb_instance_build(&resident->instance, resident->scene, false, timing);
    if (status != BB_OK)
        bb_resident_evict(resident);
    return status;
}

bb_status bb_resident_build(bb_residency *all, bb_resident *resident, bool exact,
                            bb_build_timing *timing)
{
    BB_TRY(bb_resident_tree(all, resident));
    bb_instance *instance = &resident->instance;
    begin_attempt();
    bb_status status = bb_instance_build(instance, resident->scene, exact, timing);
    while (status == BB_REFUSED && make_room(all, resident, BB_NONE))
        status = bb_instance_build(instance, resident->scene, exact, timing);
    if (status != BB_OK)
        bb_resident_evict(resident);
    return status;
}

bb_status bb_resident_upload(bb_residency *all, bb_resident *resident, double *ms)
{
    bb_tree *tree = &resident->instance.tree;
    bb_status status = bb_tree_upload(tree, all->device, ms);
    while (status == BB_REFUSED && make_room(all, resident, BB_NONE))
        status = bb_tree_upload(tree, all->device, ms);
    return status;
}

/* ---- layouts ---- */

/* Creates the layout's maker, unless it is there. */
static bb_status ready_maker(bb_residency *all, bb_layout_choice *choice)
{
    if (choice->maker.layout != NULL)
        return BB_OK;
    BB_TRY(bb_layout_maker_create(choice->layout, all->device, &choice->maker));
    choice->maker.wish = choice->wish;
    return BB_OK;
}

bb_status bb_residency_layout(bb_residency *all, const bb_layout *layout,
                              const bb_layout_wish *wish, uint32_t leaf, uint32_t format,
                              uint32_t *index)
{
    for (uint32_t i = 0; i < all->layout_count; i++) {
        const bb_layout_choice *l = &all->layouts[i];
        if (l->layout == layout && l->format == format && l->leaf == leaf &&
            bb_layout_wish_is(&l->wish, wish)) {
            *index = i;
            return BB_OK;
        }
    }
    if (all->layout_count == BB_LAYOUTS_MAX)
        return bb_fail(BB_INVALID, "at most %d layouts at once", BB_LAYOUTS_MAX);
    *index = all->layout_count++;
    bb_layout_choice *wanted = &all->layouts[*index];
    *wanted = (bb_layout_choice){.layout = layout, .wish = *wish, .leaf = leaf, .format = format};
    return ready_maker(all, wanted);
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
    begin_attempt();
    BB_TRY(ready_maker(all, choice));
    BB_TRY(bb_tree_upload(tree, all->device, NULL));
    return bb_layout_maker_make(&choice->maker, resident->scene, tree, choice->leaf, choice->format,
                                data);
}

/* Makes the layout beside what is there, else in the room of others. */
static bb_status make_layout_fit(bb_residency *all, bb_resident *resident, uint32_t layout)
{
    bb_status status = make_layout(all, resident, layout);
    while (status == BB_REFUSED && make_room(all, resident, layout))
        status = make_layout(all, resident, layout);
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
