/* Common to all layouts: leaf collapse, the clock, the name. */
#include "traversal/traversal.h"

#include "traversal/collapse.h"
#include "traversal/reach.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const bb_layout *bb_layout_find(const char *name)
{
    for (const bb_layout *const *l = bb_layouts; *l != NULL; l++)
        if (strcmp((*l)->name, name) == 0)
            return *l;
    return NULL;
}

uint32_t bb_layout_leaf_max(const bb_layout *layout)
{
    return layout->leaf_max > 0 ? layout->leaf_max : BB_LEAF_MAX;
}

bb_status bb_layout_maker_create(const bb_layout *layout, bb_device *device, bb_layout_maker *maker)
{
    *maker = (bb_layout_maker){.layout = layout, .device = device};
    bb_status status = layout->create(device, &maker->account, &maker->self);
    if (status != BB_OK)
        bb_layout_maker_destroy(maker);
    return status;
}

void bb_layout_maker_destroy(bb_layout_maker *maker)
{
    if (maker->layout != NULL)
        maker->layout->destroy(maker->self);
    bb_collapse_destroy(maker->collapse);
    bb_reach_destroy(maker->reach);
    *maker = (bb_layout_maker){0};
}

/* Sets the name, as recorded: lists what differs from the tree's own leaves and vertices. */
static void name(const bb_layout_maker *maker, bb_plan plan, uint32_t leaf, uint32_t format,
                 bool more_kinds, bb_layout_data *data)
{
    const size_t capacity = sizeof data->name;
    char leaves[24], node[24];
    snprintf(leaves, sizeof leaves, "leaf=%u", leaf);
    snprintf(node, sizeof node, "node=%g", maker->wish.node_cost);
    const struct {
        bool is;
        const char *text;
    } parts[] = {{leaf > 1, leaves},
                 {format == BB_FORMAT_AFFINE, "triangles=affine"},
                 {more_kinds, "kinds=all"},
                 {maker->wish.octants, "places=octant"},
                 {plan == BB_PLAN_GREEDY, "plan=greedy"},
                 {plan == BB_PLAN_NATIVE, "plan=native"},
                 {leaf > 1 && maker->wish.node_cost > 0, node},
                 {maker->wish.preorder, "preorder"}};
    int length = snprintf(data->name, capacity, "%s", maker->layout->name);
    char separator = ':';
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (parts[i].is) {
            length += snprintf(data->name + length, capacity - (size_t)length, "%c%s", separator,
                               parts[i].text);
            separator = ',';
        }
}

/* Finds the side array that the layout reads; NULL if it reads none. */
static bb_status find_array(const bb_layout *layout, const bb_tree *tree, const bb_buffer **array)
{
    const char *name = layout->array.name;
    *array = NULL;
    if (name == NULL)
        return BB_OK;
    const bb_tree_array *found = bb_tree_find_array(tree, name);
    if (found == NULL)
        return bb_fail(BB_UNSUPPORTED,
                       "layout %s reads the side array '%s', which this tree does not have",
                       layout->name, name);
    if (found->per_reference != layout->array.per_reference ||
        found->stride != layout->array.stride)
        return bb_fail(BB_UNSUPPORTED,
                       "layout %s reads '%s' as %u bytes per %s, this tree has %u bytes per %s",
                       layout->name, name, layout->array.stride,
                       layout->array.per_reference ? "reference" : "node", found->stride,
                       found->per_reference ? "reference" : "node");
    *array = &found->buffer;
    return BB_OK;
}

/* Returns the plan for this tree. */
static bb_plan plan_of(const bb_layout_maker *maker, const bb_tree *tree)
{
    const bb_layout *layout = maker->layout;
    if (maker->wish.plan != BB_PLAN_BY_TREE)
        return maker->wish.plan;
    return tree->keep_nodes && layout->keeps_nodes && tree->info.arity <= layout->width
               ? BB_PLAN_NATIVE
               : BB_PLAN_OPTIMAL;
}

/* Returns whether leaves are collapsed, or large ones divided, before the layout is made. */
static bool collapses_first(const bb_layout_maker *maker, const bb_tree *tree, bb_plan plan,
                            uint32_t leaf)
{
    const bb_layout *layout = maker->layout;
    if (layout->leaf_max > 0 && tree->info.leaf_count != tree->info.ref_count)
        return true;
    if (plan == BB_PLAN_NATIVE)
        return leaf > 1;
    return leaf > 1 && !(layout->collapses != NULL && layout->collapses(maker->self, tree));
}

/* Returns Ct of a pair of children. */
static float traversal_of(const bb_layout_maker *maker)
{
    uint32_t width = maker->layout->width;
    double wish = maker->wish.node_cost;
    return bb_collapse_traversal(wish > 0 ? wish : bb_collapse_node_cost(width), width);
}

/* The part that is timed. *traced: the tree with the layout's leaves: the collapsed one, or
 * `tree`. */
static bb_status make(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree, bb_plan plan,
                      uint32_t leaf, bool same_links, bb_layout_data *data, bb_tree **traced)
{
    const bb_layout *layout = maker->layout;
    bb_layout_source source = {.scene = scene,
                               .kinds = data->kinds,
                               .octants = maker->wish.octants,
                               .plan = plan,
                               .traversal = traversal_of(maker),
                               .leaf = collapses_first(maker, tree, plan, leaf) ? 0 : leaf,
                               .same_links = same_links};
    *traced = tree;
    if (plan == BB_PLAN_NATIVE && !layout->keeps_nodes)
        return bb_fail(BB_UNSUPPORTED, "layout %s has no plan=native: leave it out", layout->name);
    if (leaf > bb_layout_leaf_max(layout))
        return bb_fail(BB_INVALID, "layout %s takes leaf=%u at most, not leaf=%u", layout->name,
                       bb_layout_leaf_max(layout), leaf);
    if (leaf > 1 && layout->array.name != NULL)
        return bb_fail(BB_UNSUPPORTED,
                       "layout %s reads the side array '%s', which leaf collapse leaves behind: "
                       "take leaf=1",
                       layout->name, layout->array.name);
    if (collapses_first(maker, tree, plan, leaf))
        BB_TRY(same_links
                   ? bb_collapse_again(maker->collapse, tree, traced)
                   : bb_collapse_make(maker->collapse, tree, scene->scale, leaf, source.traversal,
                                      layout->block, layout->leaf_max, traced));
    source.tree = *traced;
    BB_TRY(find_array(layout, *traced, &source.array));
    if (tree->duplicated)
        BB_TRY(bb_reach_make(maker->reach, scene, *traced, &source.reach));
    return layout->make(maker->self, &source, data);
}

static bb_status make_timed(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                            uint32_t leaf, uint32_t format, bool same_links, bb_layout_data *data)
{
    const bb_plan plan = plan_of(maker, tree);
    const uint32_t asked = leaf;
    if (plan != maker->wish.plan && plan == BB_PLAN_NATIVE)
        leaf = 1; /* the tree's leaves are kept, too */
    maker->links = 0;
    if (collapses_first(maker, tree, plan, leaf) && maker->collapse == NULL)
        BB_TRY(bb_collapse_create(maker->device, &maker->account, &maker->collapse));
    if (tree->duplicated && maker->reach == NULL)
        BB_TRY(bb_reach_create(maker->device, &maker->account, &maker->reach));
    data->bytes = data->prims_bytes = 0;
    data->ends = bb_scene_ends(scene);
    data->kinds = scene->kinds | maker->wish.kinds;
    data->format = format;
    data->lanes = maker->layout->block;
    data->scale = scene->scale;
    data->bounds = scene->bounds;
    bb_tree *traced;
    bb_stopwatch watch;
    BB_TRY(bb_stopwatch_start(maker->device, &watch));
    bb_status status = make(maker, scene, tree, plan, leaf, same_links, data, &traced);
    BB_TRY(bb_stopwatch_stop(&watch, status, &data->timing));
    data->bytes += data->prims_bytes;
    data->sah = NAN;
    if (leaf > 1) {
        if (data->keeps_shape) { /* outside the clock */
            BB_TRY(bb_tree_download(traced, NULL));
            data->sah = bb_tree_sah(traced);
        }
        data->keeps_shape = false;
    }
    name(maker, plan, leaf, scene->prims[BB_TRIANGLE].count > 0 ? data->format : BB_FORMAT_VERTICES,
         data->kinds != scene->kinds, data);
    maker->links = tree->links;
    maker->leaf = asked;
    return BB_OK;
}

/* Makes it of a copy of the tree in preorder, which is gone then. */
static bb_status make_in_preorder(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                                  uint32_t leaf, uint32_t format, bb_layout_data *data)
{
    const bool copied = tree->copied;
    bb_tree ordered;
    bb_tree_init(&ordered, &maker->account);
    ordered.copy_account = &maker->account;
    bb_status status = bb_tree_download(tree, NULL);
    if (status == BB_OK)
        status = bb_tree_preorder(tree, &ordered);
    if (!copied && tree->place == BB_ON_DEVICE)
        bb_tree_drop_copy(tree);
    if (status == BB_OK)
        status = bb_tree_upload(&ordered, maker->device, NULL);
    if (status == BB_OK)
        status = make_timed(maker, scene, &ordered, leaf, format, false, data);
    bb_tree_release(&ordered);
    maker->links = 0; /* there is nothing left to follow from */
    return status;
}

bb_status bb_layout_maker_make(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                               uint32_t leaf, uint32_t format, bb_layout_data *data)
{
    return maker->wish.preorder ? make_in_preorder(maker, scene, tree, leaf, format, data)
                                : make_timed(maker, scene, tree, leaf, format, false, data);
}

bb_status bb_layout_maker_follow(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                                 uint32_t leaf, uint32_t format, bb_layout_data *data,
                                 bool *in_place)
{
    *in_place = maker->links != 0 && maker->links == tree->links && maker->leaf == leaf;
    return make_timed(maker, scene, tree, leaf, format, *in_place, data);
}

void bb_layout_data_release(bb_layout_data *data)
{
    for (uint32_t i = 0; i < BB_LAYOUT_BUFFERS_MAX; i++)
        bb_buffer_release(&data->buffers[i]);
    *data = (bb_layout_data){0};
}
