/* Trees and layouts of entrants on the device. They are made on demand, and evicted if they do not
 * fit beside each other. A trace asks for a layout; only this file knows that it may need a build.
 */
#include "framework/bench/bench_private.h"

#include <math.h>

void bb_resident_evict(bb_entrant *entrant)
{
    for (uint32_t k = 0; k < BB_LAYOUTS_MAX; k++) {
        bb_layout_data_release(&entrant->layouts[k]);
        entrant->has_layout[k] = false;
    }
    bb_instance_destroy(&entrant->instance);
    entrant->built = false;
}

void bb_resident_note(bb_bench *bench)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        const bb_entrant *entrant = &bench->entrants[i];
        bytes += entrant->instance.account.peak;
        for (uint32_t k = 0; k < bench->layout_count; k++)
            bytes += entrant->has_layout[k] ? entrant->layouts[k].bytes : 0;
    }
    if (bytes > bench->outcome->bytes_held)
        bench->outcome->bytes_held = bytes;
}

/* Frees what all entrants but `keep` have in memory. Returns false if they had nothing. */
static bool evict_others(bb_bench *bench, const bb_entrant *keep)
{
    bool freed = false;
    for (uint32_t i = 0; i < bench->entrant_count; i++) {
        bb_entrant *other = &bench->entrants[i];
        if (other == keep || other->instance.pipeline.count == 0)
            continue;
        bb_resident_evict(other);
        freed = true;
    }
    return freed;
}

static bb_status create_and_build(bb_bench *bench, bb_entrant *entrant, double *ms)
{
    bb_build_timing timing;
    if (entrant->instance.pipeline.count == 0)
        BB_TRY(bb_instance_create(bench->device, entrant->text, bench->scene, bench->request->seed,
                                  &entrant->instance));
    BB_TRY(bb_instance_build(&entrant->instance, bench->scene, false, &timing));
    *ms = timing.timing.ms;
    return BB_OK;
}

/* Makes the first build, on fresh memory. Drivers may compile a kernel when it is first enqueued.
 * The very first build on a device is therefore thrown away with its memory, so that compiling is
 * no part of the cold time. */
static bb_status first_build(bb_bench *bench, bb_entrant *entrant, double *cold_ms)
{
    bb_step step = bb_bench_begin(bench);
    bb_status status = BB_OK;
    if (!entrant->compiled && bb_pipeline_on_device(&entrant->pipeline) > 0) {
        status = create_and_build(bench, entrant, cold_ms);
        bb_resident_evict(entrant);
    }
    entrant->compiled = true;
    if (status == BB_OK)
        status = create_and_build(bench, entrant, cold_ms);
    entrant->built = status == BB_OK;
    return bb_bench_end(bench, step, "compile, allocate, first builds", status);
}

bb_status bb_resident_tree(bb_bench *bench, bb_entrant *entrant)
{
    if (entrant->built)
        return BB_OK;
    double cold_ms = NAN;
    bb_status status = first_build(bench, entrant, &cold_ms);
    if (status == BB_REFUSED && evict_others(bench, entrant)) {
        bb_resident_evict(entrant);
        status = first_build(bench, entrant, &cold_ms);
    }
    if (status != BB_OK) {
        bb_resident_evict(entrant);
        return status;
    }
    if (isnan(entrant->record.cold_ms))
        entrant->record.cold_ms = cold_ms;
    return BB_OK;
}

/* ---- layouts ---- */

static bb_status make_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    bb_layout_choice *choice = &bench->layouts[layout];
    bb_layout_data *data = &entrant->layouts[layout];
    bb_tree *tree = &entrant->instance.tree;
    BB_TRY(bb_tree_upload(tree, bench->device, NULL));
    return bb_layout_maker_make(&choice->maker, bench->scene, tree, choice->leaf, choice->format,
                                data);
}

/* Makes room for one layout by evicting other builders' trees, then the entrant's other layouts
 * with their scratch. They are made again when needed. */
static bb_status make_room(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    evict_others(bench, entrant);
    for (uint32_t k = 0; k < bench->layout_count; k++) {
        bb_layout_data_release(&entrant->layouts[k]);
        entrant->has_layout[k] = false;
        bb_layout_maker *maker = &bench->layouts[k].maker;
        const bb_layout *made = maker->layout;
        const bb_layout_wish wish = maker->wish;
        if (k == layout || made == NULL)
            continue;
        bb_layout_maker_destroy(maker);
        BB_TRY(bb_layout_maker_create(made, bench->device, maker));
        maker->wish = wish;
    }
    return BB_OK;
}

bb_status bb_resident_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    if (entrant->has_layout[layout])
        return BB_OK;
    bb_step step = bb_bench_begin(bench);
    bb_status status = bb_resident_tree(bench, entrant);
    const bb_tree_info *info = &entrant->instance.tree.info;
    if (status == BB_OK && entrant->record.has_tree &&
        (info->node_count != entrant->record.tree.node_count ||
         info->depth != entrant->record.tree.depth))
        status =
            bb_fail(BB_FAILED, "built again, the tree has %u nodes and depth %u, not %u and %u",
                    info->node_count, info->depth, entrant->record.tree.node_count,
                    entrant->record.tree.depth);
    if (status == BB_OK)
        status = make_layout(bench, entrant, layout);
    if (status == BB_REFUSED) {
        status = make_room(bench, entrant, layout);
        if (status == BB_OK)
            status = make_layout(bench, entrant, layout);
    }
    status = bb_bench_end(bench, step, "layouts", status);
    if (status != BB_OK) {
        bb_layout_data_release(&entrant->layouts[layout]);
        return status;
    }
    entrant->has_layout[layout] = true;
    bb_resident_note(bench);
    entrant->keeps_shape[layout] = entrant->layouts[layout].keeps_shape;
    return BB_OK;
}

bb_status bb_resident_layout_again(bb_bench *bench, bb_entrant *entrant, uint32_t layout)
{
    bb_status status = make_layout(bench, entrant, layout);
    if (status == BB_OK)
        return BB_OK;
    bb_layout_data_release(&entrant->layouts[layout]);
    entrant->has_layout[layout] = false;
    return status;
}
