/* sah: a top-down builder by the surface area heuristic, on the host; the readable reference.
 *
 *   pop a range of primitives off the stack and make its node
 *   if it has one primitive, or at most `leaf` and no split is cheaper than a leaf: make it a leaf
 *   else find the cheapest split (sah_binned.c or sah_sweep.c), partition the range, and push both
 *   halves, the left one on top: nodes come out in preorder
 *
 * A range whose centroids are all equal is halved by index, so that the depth stays logarithmic.
 * Nothing recurses.
 */
#include "builders/common/links.h"
#include "builders/common/refit.h"
#include "framework/builder/builder.h"
#include "sah_split.h"

#include <math.h>
#include <string.h>

static const bb_option options[] = {
    {"method", "binned", "binned|sweep", "candidates: planes between bins, or every position"},
    {"bins", "16", NULL, "binned: number of bins per axis, 2 to 256"},
    {"leaf", "1", NULL, "most primitives per leaf, used where that is cheaper, 1 to 255"},
    BB_UPDATE_OPTION,
    {.name = NULL},
};

typedef struct range {
    uint32_t begin, end;
    uint32_t left_sibling; /* node; BB_NONE for the root and for left children */
    uint32_t depth;
} range;

typedef struct sah {
    bb_account *account;
    bool sweep, refits;
    uint32_t leaf;
    size_t capacity; /* primitives that the scratch below has room for */
    bb_sah_state state;
    uint32_t *nodes; /* for refits: one per node */
    range *stack;
    size_t stack_count, stack_capacity;
} sah;

static void destroy(void *opaque)
{
    sah *self = opaque;
    if (self == NULL)
        return;
    for (int axis = 0; axis < 3; axis++)
        bb_host_free(self->state.order[axis]);
    bb_host_free(self->state.centroids);
    bb_host_free(self->state.scratch);
    bb_host_free(self->state.goes_left);
    bb_host_free(self->state.right_costs);
    bb_host_free(self->nodes);
    bb_host_free(self->stack);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    uint64_t bins, leaf;
    BB_TRY(bb_spec_u64(context->spec, options, "bins", 2, 256, &bins));
    BB_TRY(bb_spec_u64(context->spec, options, "leaf", 1, 255, &leaf));
    sah *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "sah: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->account = context->account;
    self->sweep = bb_spec_is(context->spec, options, "method", "sweep");
    self->refits = bb_spec_is(context->spec, options, "update", "refit");
    self->leaf = (uint32_t)leaf;
    self->state.bins = (uint32_t)bins;
    return BB_OK;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    sah *self = opaque;
    bb_sah_state *state = &self->state;
    bb_account *account = self->account;
    size_t count = scene->prim_count;
    BB_TRY(bb_tree_reserve(tree, NULL, BB_ON_HOST, 2 * count - 1, count));
    if (count <= self->capacity)
        return BB_OK;
    self->capacity = 0;
    const char *what = "sah: scratch";
    BB_TRY(bb_host_alloc(account, 3 * count * sizeof(float), what, &state->centroids));
    BB_TRY(bb_host_alloc(account, count * sizeof(uint32_t), what, &state->scratch));
    for (int axis = 0; axis < (self->sweep ? 3 : 1); axis++)
        BB_TRY(bb_host_alloc(account, count * sizeof(uint32_t), what, &state->order[axis]));
    if (self->sweep) {
        BB_TRY(bb_host_alloc(account, count * sizeof(bool), what, &state->goes_left));
        BB_TRY(bb_host_alloc(account, count * sizeof(double), what, &state->right_costs));
    }
    if (self->refits)
        BB_TRY(bb_host_alloc(account, (2 * count - 1) * sizeof(uint32_t), what, &self->nodes));
    self->capacity = count;
    return BB_OK;
}

static bb_status push(sah *self, range item)
{
    if (self->stack_count == self->stack_capacity) {
        size_t capacity = self->stack_capacity == 0 ? 128 : 2 * self->stack_capacity;
        range *stack = NULL;
        BB_TRY(bb_host_alloc(self->account, capacity * sizeof *stack, "sah: stack", &stack));
        if (self->stack_count > 0)
            memcpy(stack, self->stack, self->stack_count * sizeof *stack);
        bb_host_free(self->stack);
        self->stack = stack;
        self->stack_capacity = capacity;
    }
    self->stack[self->stack_count++] = item;
    return BB_OK;
}

/* Makes the node of a range and links it to its left sibling; returns its number. A left child
 * directly follows its parent. */
static uint32_t make_node(const bb_sah_state *state, const range *item, bb_tree *tree)
{
    uint32_t index = tree->info.node_count++;
    bb_node *node = &tree->nodes[index];
    for (int axis = 0; axis < 3; axis++) {
        node->lo[axis] = INFINITY;
        node->hi[axis] = -INFINITY;
    }
    for (uint32_t i = item->begin; i < item->end; i++) {
        const bb_box *box = &state->boxes[state->order[0][i]];
        bb_sah_grow(node->lo, node->hi, box->lo, box->hi);
    }
    node->skip = BB_NONE;
    if (item->left_sibling != BB_NONE)
        tree->nodes[item->left_sibling].skip = index;
    return index;
}

static void make_leaf(const bb_sah_state *state, const range *item, uint32_t index, bb_tree *tree)
{
    bb_tree_info *info = &tree->info;
    tree->nodes[index].first = BB_LEAF_BIT | item->begin;
    memcpy(tree->refs + item->begin, state->order[0] + item->begin,
           (item->end - item->begin) * sizeof *tree->refs);
    tree->refs[item->end - 1] |= BB_LAST_BIT;
    info->ref_count += item->end - item->begin;
    info->depth = item->depth > info->depth ? item->depth : info->depth;
}

/* Finds the split for the range of node `index` and partitions it; *middle = begin: make a leaf. */
static void divide(sah *self, const range *item, const bb_node *node, uint32_t *middle)
{
    bb_sah_state *state = &self->state;
    uint32_t begin = item->begin, end = item->end, count = end - begin;
    *middle = begin;
    if (count == 1)
        return;
    bb_sah_split split =
        self->sweep ? bb_sah_find_sweep(state, begin, end) : bb_sah_find_binned(state, begin, end);
    double area = bb_half_area(node->lo, node->hi);
    double halves = split.left > 0 ? split.cost : area * count;
    if (count <= self->leaf && BB_COST_INTERSECTION * area * count <=
                                   BB_COST_TRAVERSAL * area + BB_COST_INTERSECTION * halves)
        return;
    if (split.left == 0) {
        *middle = begin + count / 2;
        return;
    }
    if (self->sweep)
        bb_sah_partition_sweep(state, begin, end, &split);
    else
        bb_sah_partition_binned(state, begin, end, &split);
    *middle = begin + split.left;
}

static bb_status build_nodes(sah *self, bb_tree *tree)
{
    bb_sah_state *state = &self->state;
    self->stack_count = 0;
    BB_TRY(push(self, (range){0, state->count, BB_NONE, 0}));
    while (self->stack_count > 0) {
        range item = self->stack[--self->stack_count];
        uint32_t index = make_node(state, &item, tree), middle;
        divide(self, &item, &tree->nodes[index], &middle);
        if (middle == item.begin) {
            make_leaf(state, &item, index, tree);
            continue;
        }
        tree->nodes[index].first = index + 1;
        BB_TRY(push(self, (range){middle, item.end, index + 1, item.depth + 1}));
        BB_TRY(push(self, (range){item.begin, middle, BB_NONE, item.depth + 1}));
    }
    return bb_links_finish(tree, NULL);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    sah *self = opaque;
    bb_sah_state *state = &self->state;
    BB_TRY(prepare(self, scene, tree));

    BB_TRY(bb_phase(phases, "centroids"));
    state->boxes = scene->boxes;
    state->count = scene->prim_count;
    for (uint32_t i = 0; i < state->count; i++) {
        for (int axis = 0; axis < 3; axis++)
            state->centroids[3 * (size_t)i + axis] =
                0.5f * state->boxes[i].lo[axis] + 0.5f * state->boxes[i].hi[axis];
        state->order[0][i] = i;
    }
    if (self->sweep) {
        BB_TRY(bb_phase(phases, "sort"));
        BB_TRY(bb_sah_presort(state, self->account));
    }
    BB_TRY(bb_phase(phases, "split"));
    BB_TRY(build_nodes(self, tree));
    return bb_phase(phases, NULL);
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    sah *self = opaque;
    if (!self->refits || changed != BB_CHANGED_POSITIONS)
        return bb_fail(BB_UNSUPPORTED, "the tree is built again");
    BB_TRY(bb_phase(phases, "refit"));
    BB_TRY(bb_refit(tree, scene->boxes, scene->prim_count, self->nodes));
    return bb_phase(phases, NULL);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "sah,sah:method=sweep"},
    {BB_FOR_ALL, BB_ROLE_YARDSTICK, "sah"},
    {BB_FOR_ALL, BB_ROLE_COST_REFERENCE, "sah:method=sweep"},
    {0},
};

const bb_builder bb_builder_sah = {
    .abi_version = BB_ABI_VERSION,
    .name = "sah",
    .summary = "top-down by the surface area heuristic, on the host: the readable reference",
    .paper = "Wald 2007 (binned); MacDonald and Booth 1990 (sweep)",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .prepare = prepare,
    .build = build,
    .update = update,
    .destroy = destroy,
};
