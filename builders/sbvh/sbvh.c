/* sbvh: a top-down builder with spatial splits, on the host.
 *
 *   pop a node off the stack: its references are the last ones in the list
 *   if it has one, or at most `leaf` and no split is cheaper than a leaf: make it a leaf
 *   else find the best object split (sbvh_object.c)
 *   if the boxes of its sides overlap by more than alpha of the root's area: find the best spatial
 *       split (sbvh_spatial.c), and take it if it is cheaper
 *   the right side's references stay in place, the left side's go behind them; push both
 *
 * Stich, Friedrich, Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies". The paper's
 * text was not at hand: this was made from published code, and derived again. Where this knowingly
 * departs from that code, and what was added:
 *
 * - Object splits are binned, not swept.
 * - There are at most `budget` times as many references as primitives, so that memory is known
 *   beforehand. Each node may add a number of references: its parent's allowance in proportion to
 *   its share of the parent's references, and what the nodes before it left over. Otherwise the
 *   first nodes would use it all.
 * - Spatial splits end at a depth of SPATIAL_DEPTH, as in published code.
 *
 * A node never has two references to one primitive, since the two parts go to different sides. If
 * nothing separates the centroids, the references are halved by their order. Nothing recurses.
 */
#include "builders/common/links.h"
#include "framework/builder/builder.h"
#include "sbvh_split.h"

#include <stdio.h>
#include <string.h>

enum { SPATIAL_DEPTH = 48 };

static const bb_option options[] = {
    {"alpha", "1e-5", NULL,
     "least overlap for a spatial split: area, as a share of the root's, 0 to 1; 1: none"},
    {"bins", "32", NULL, "bins per axis for object splits, 2 to 256"},
    {"slabs", "16", NULL, "slabs per axis for spatial splits, 2 to 256"},
    {"budget", "2", NULL, "most references per primitive of the scene, 1 to 16"},
    {"leaf", "1", NULL, "most references per leaf, used where that is cheaper, 1 to 255"},
    {.name = NULL},
};

typedef struct task {
    uint32_t begin, end;   /* references */
    uint32_t spare;        /* references that may be added below it */
    uint32_t left_sibling; /* node; BB_NONE for the root and for left children */
    uint32_t depth;
} task;

typedef struct sbvh {
    bb_account *account;
    double alpha, budget;
    uint32_t bins, slabs, leaf;
    sb_ref *refs, *scratch;
    size_t ref_capacity, scratch_capacity;
    task *stack;
    size_t stack_count, stack_capacity;
    uint32_t left_over; /* references that finished nodes did not add */
    uint32_t spatial;   /* spatial splits in the last build */
    uint32_t prims, references;
} sbvh;

static void destroy(void *opaque)
{
    sbvh *self = opaque;
    if (self == NULL)
        return;
    bb_host_free(self->refs);
    bb_host_free(self->scratch);
    bb_host_free(self->stack);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    const bb_spec *spec = context->spec;
    uint64_t bins, slabs, leaf;
    double alpha, budget;
    BB_TRY(bb_spec_double(spec, options, "alpha", 0, 1, &alpha));
    BB_TRY(bb_spec_u64(spec, options, "bins", 2, SB_BINS_MAX, &bins));
    BB_TRY(bb_spec_u64(spec, options, "slabs", 2, SB_BINS_MAX, &slabs));
    BB_TRY(bb_spec_double(spec, options, "budget", 1, 16, &budget));
    BB_TRY(bb_spec_u64(spec, options, "leaf", 1, 255, &leaf));
    sbvh *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "sbvh: object", &self));
    *self = (sbvh){.account = context->account,
                   .alpha = alpha,
                   .budget = budget,
                   .bins = (uint32_t)bins,
                   .slabs = (uint32_t)slabs,
                   .leaf = (uint32_t)leaf};
    *out = self;
    return BB_OK;
}

static size_t most_references(const sbvh *self, const bb_scene *scene)
{
    return (size_t)(self->budget * scene->prim_count);
}

static bb_status reserve(sbvh *self, size_t count, sb_ref **refs, size_t *capacity)
{
    if (count <= *capacity)
        return BB_OK;
    *capacity = 0;
    BB_TRY(bb_host_alloc(self->account, count * sizeof **refs, "sbvh: references", refs));
    *capacity = count;
    return BB_OK;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    sbvh *self = opaque;
    const size_t most = most_references(self, scene);
    BB_TRY(bb_tree_reserve(tree, NULL, BB_ON_HOST, 2 * most - 1, most));
    BB_TRY(reserve(self, most, &self->refs, &self->ref_capacity));
    return reserve(self, scene->prim_count, &self->scratch, &self->scratch_capacity);
}

static bb_status push(sbvh *self, task item)
{
    if (self->stack_count == self->stack_capacity) {
        size_t capacity = self->stack_capacity == 0 ? 128 : 2 * self->stack_capacity;
        task *stack = NULL;
        BB_TRY(bb_host_alloc(self->account, capacity * sizeof *stack, "sbvh: stack", &stack));
        if (self->stack_count > 0)
            memcpy(stack, self->stack, self->stack_count * sizeof *stack);
        bb_host_free(self->stack);
        self->stack = stack;
        self->stack_capacity = capacity;
    }
    self->stack[self->stack_count++] = item;
    return BB_OK;
}

/* Makes the node of a task and links it to its left sibling; returns its number. A left child
 * directly follows its parent. */
static uint32_t make_node(const sbvh *self, const task *item, bb_tree *tree, sb_bounds *box)
{
    uint32_t index = tree->info.node_count++;
    bb_node *node = &tree->nodes[index];
    *box = sb_nothing();
    for (uint32_t i = item->begin; i < item->end; i++)
        sb_grow(box, &self->refs[i].box);
    memcpy(node->lo, box->lo, sizeof node->lo);
    memcpy(node->hi, box->hi, sizeof node->hi);
    node->skip = BB_NONE;
    if (item->left_sibling != BB_NONE)
        tree->nodes[item->left_sibling].skip = index;
    return index;
}

static void make_leaf(sbvh *self, const task *item, uint32_t index, bb_tree *tree)
{
    bb_tree_info *info = &tree->info;
    tree->nodes[index].first = BB_LEAF_BIT | info->ref_count;
    for (uint32_t i = item->begin; i < item->end; i++)
        tree->refs[info->ref_count++] = self->refs[i].prim;
    tree->refs[info->ref_count - 1] |= BB_LAST_BIT;
    info->depth = item->depth > info->depth ? item->depth : info->depth;
    self->left_over = item->spare;
}

static double overlap(const sb_split *split)
{
    sb_bounds both;
    for (int k = 0; k < 3; k++) {
        const sb_bounds *a = &split->sides[0], *b = &split->sides[1];
        both.lo[k] = a->lo[k] > b->lo[k] ? a->lo[k] : b->lo[k];
        both.hi[k] = a->hi[k] < b->hi[k] ? a->hi[k] : b->hi[k];
        if (both.lo[k] > both.hi[k])
            return 0;
    }
    return bb_half_area(both.lo, both.hi);
}

/* Splits the references of a node; returns their numbers on both sides. left = 0: make a leaf. */
static sb_split divide(sbvh *self, const bb_scene *scene, const task *item, const sb_bounds *box,
                       double root_area)
{
    sb_ref *refs = self->refs + item->begin;
    const uint32_t count = item->end - item->begin;
    const double area = sb_area(box);
    sb_split object = {.left = 0}, space = {.left = 0};
    if (count == 1)
        return object;
    object = sb_find_object(refs, count, self->bins);
    if (item->spare > 0 && item->depth < SPATIAL_DEPTH && self->alpha < 1 &&
        (object.left == 0 || overlap(&object) > self->alpha * root_area))
        space = sb_find_spatial(scene, refs, count, box, self->slabs, item->spare);
    double halves = object.left > 0 ? object.cost : area * count;
    const bool spatial = space.left > 0 && space.cost < halves;
    halves = spatial ? space.cost : halves;
    if (count <= self->leaf && BB_COST_INTERSECTION * area * count <=
                                   BB_COST_TRAVERSAL * area + BB_COST_INTERSECTION * halves)
        return (sb_split){.left = 0};
    if (spatial) {
        sb_part_spatial(scene, refs, count, item->spare, &space, self->scratch);
        self->spatial += space.left > 0 && space.right > 0;
        if (space.left > 0 && space.right > 0)
            return space;
    }
    if (object.left > 0)
        sb_part_object(refs, count, &object, self->bins, self->scratch);
    else
        object = (sb_split){.left = count - count / 2, .right = count / 2};
    return object;
}

/* Divides the remaining allowance between the sides by their numbers of references, and pushes
 * both. */
static bb_status push_sides(sbvh *self, const task *item, const sb_split *split, uint32_t node)
{
    const uint32_t sum = split->left + split->right;
    const uint32_t spare = item->spare - (sum - (item->end - item->begin));
    const uint32_t of_left = (uint32_t)((uint64_t)spare * split->left / sum);
    const uint32_t middle = item->begin + split->right;
    BB_TRY(push(self, (task){item->begin, middle, spare - of_left, node + 1, item->depth + 1}));
    return push(self, (task){middle, middle + split->left, of_left, BB_NONE, item->depth + 1});
}

static bb_status build_nodes(sbvh *self, const bb_scene *scene, bb_tree *tree)
{
    const uint32_t count = scene->prim_count;
    const uint32_t spare = (uint32_t)(most_references(self, scene) - count);
    double root_area = 0;
    self->stack_count = 0;
    self->spatial = self->left_over = 0;
    BB_TRY(push(self, (task){0, count, spare, BB_NONE, 0}));
    while (self->stack_count > 0) {
        task item = self->stack[--self->stack_count];
        sb_bounds box;
        item.spare += self->left_over;
        self->left_over = 0;
        const uint32_t index = make_node(self, &item, tree, &box);
        root_area = index == 0 ? sb_area(&box) : root_area;
        const sb_split split = divide(self, scene, &item, &box, root_area);
        if (split.left == 0) {
            make_leaf(self, &item, index, tree);
            continue;
        }
        tree->nodes[index].first = index + 1;
        BB_TRY(push_sides(self, &item, &split, index));
    }
    return bb_links_finish(tree, NULL);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    sbvh *self = opaque;
    BB_TRY(prepare(self, scene, tree));
    BB_TRY(bb_phase(phases, "split"));
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        const bb_box *box = &scene->boxes[i];
        self->refs[i] = (sb_ref){
            {{box->lo[0], box->lo[1], box->lo[2]}, {box->hi[0], box->hi[1], box->hi[2]}}, i};
    }
    BB_TRY(build_nodes(self, scene, tree));
    self->prims = scene->prim_count;
    self->references = tree->info.ref_count;
    tree->duplicated = self->references > self->prims;
    BB_TRY(bb_event(phases, "spatial", self->spatial));
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const sbvh *self = opaque;
    snprintf(text, capacity, "%u references to %u primitives by %u spatial splits",
             self->references, self->prims, self->spatial);
    return BB_OK;
}

const bb_builder bb_builder_sbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "sbvh",
    .summary = "top-down by SAH with spatial splits, on the host",
    .paper = "Stich, Friedrich, Dietrich 2009",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_GEOMETRY,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .variants = BB_NO_VARIANTS,
    .create = create,
    .prepare = prepare,
    .build = build,
    .describe = describe,
    .destroy = destroy,
};
