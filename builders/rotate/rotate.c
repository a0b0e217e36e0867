/* rotate: an optimiser of binary trees by rotations that lower the surface area heuristic, on the
 * host.
 *
 *   for each pass, until one changes nothing:
 *       for each inner node n with children a, b:
 *           candidates: exchange a with a child of b, b with a child of a, or a child of a with
 *           a child of b; apply the one that shrinks the boxes of a and b most, if any does
 *
 * Kensler 2008 (Tree Rotations for Improving Bounding Volume Hierarchies), hill climbing. The
 * paper's text was not at hand: this was made from what others say of the method, and derived
 * again. A rotation changes only the boxes of a and b, which stay inside of n's. So nodes may be
 * visited in any order, and the cost, which follows from the areas alone, never rises. Leaves stay
 * as they are. Nodes with one child are accepted and left alone; nodes with more than two are
 * refused.
 *
 * Nothing recurses: nodes are visited in the preorder of the input tree.
 */
#include "builders/common/links.h"
#include "framework/base/random.h"
#include "framework/builder/builder.h"

#include <stdio.h>
#include <string.h>

static const bb_option options[] = {
    {"passes", "3", NULL,
     "most passes over all nodes, 1 to 1000; stops when a pass changes nothing"},
    {"order", "up", "up|down|random",
     "order of nodes in a pass: children first, parents first, or random (by the seed)"},
    {.name = NULL},
};

typedef enum rotate_order { UPWARDS, DOWNWARDS, SHUFFLED } rotate_order;

typedef struct rotate {
    bb_account *account;
    uint64_t seed;
    uint32_t passes;
    rotate_order order;
    size_t capacity;         /* nodes that the scratch below has room for */
    uint32_t (*children)[2]; /* of each node; BB_NONE if absent */
    uint32_t *visits;        /* nodes in the order of the passes */
    uint32_t *depths;
    uint32_t rotations, passes_made; /* by the last build */
    double saved;                    /* half areas, relative to the root's */
} rotate;

static void destroy(void *opaque)
{
    rotate *self = opaque;
    if (self == NULL)
        return;
    bb_host_free(self->children);
    bb_host_free(self->visits);
    bb_host_free(self->depths);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    const bb_spec *spec = context->spec;
    uint64_t passes;
    BB_TRY(bb_spec_u64(spec, options, "passes", 1, 1000, &passes));
    rotate *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "rotate: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->account = context->account;
    self->seed = context->seed;
    self->passes = (uint32_t)passes;
    self->order = bb_spec_is(spec, options, "order", "up")     ? UPWARDS
                  : bb_spec_is(spec, options, "order", "down") ? DOWNWARDS
                                                               : SHUFFLED;
    return BB_OK;
}

static bb_status reserve(rotate *self, const bb_tree *input, bb_tree *tree)
{
    const char *what = "rotate: scratch";
    size_t count = input->info.node_count;
    BB_TRY(bb_tree_reserve(tree, NULL, BB_ON_HOST, count, input->info.ref_count));
    if (count <= self->capacity)
        return BB_OK;
    self->capacity = 0;
    BB_TRY(bb_host_alloc(self->account, count * sizeof *self->children, what, &self->children));
    BB_TRY(bb_host_alloc(self->account, count * sizeof(uint32_t), what, &self->visits));
    BB_TRY(bb_host_alloc(self->account, count * sizeof(uint32_t), what, &self->depths));
    self->capacity = count;
    return BB_OK;
}

/* ---- the tree as child pointers ---- */

/* Copies boxes and references, and records each node's children and the preorder. */
static void read_tree(rotate *self, const bb_tree *input, bb_tree *tree)
{
    const bb_tree_info *info = &input->info;
    uint32_t at = 0;
    memcpy(tree->nodes, input->nodes, info->node_count * sizeof *tree->nodes);
    memcpy(tree->refs, input->refs, info->ref_count * sizeof *tree->refs);
    tree->info = *info;
    tree->duplicated = input->duplicated;
    tree->disjoint = false; /* siblings are other nodes than before */
    for (uint32_t n = info->root; n != BB_NONE; at++) {
        const bb_node *node = &input->nodes[n];
        uint32_t *children = self->children[n];
        children[0] = children[1] = BB_NONE;
        self->visits[at] = n;
        if (bb_node_is_leaf(node)) {
            n = node->skip;
            continue;
        }
        uint32_t second = input->nodes[node->first].skip;
        children[0] = node->first;
        children[1] = second != node->skip ? second : BB_NONE;
        n = node->first;
    }
}

static void write_links(const rotate *self, bb_tree *tree)
{
    tree->nodes[tree->info.root].skip = BB_NONE;
    for (uint32_t i = 0; i < tree->info.node_count; i++) {
        const uint32_t *children = self->children[i];
        if (children[0] == BB_NONE)
            continue;
        tree->nodes[i].first = children[0];
        tree->nodes[children[0]].skip = children[1];
        if (children[1] != BB_NONE)
            tree->nodes[children[1]].skip = BB_NONE;
    }
}

/* ---- rotations ---- */

typedef struct box {
    float lo[3], hi[3];
} box;

static box unite(const bb_node *a, const bb_node *b)
{
    box u;
    for (int k = 0; k < 3; k++) {
        u.lo[k] = a->lo[k] < b->lo[k] ? a->lo[k] : b->lo[k];
        u.hi[k] = a->hi[k] > b->hi[k] ? a->hi[k] : b->hi[k];
    }
    return u;
}

static double area_of(const bb_node *node)
{
    return bb_half_area(node->lo, node->hi);
}

static double area_with(const bb_tree *tree, uint32_t a, uint32_t b)
{
    box u = unite(&tree->nodes[a], &tree->nodes[b]);
    return bb_half_area(u.lo, u.hi);
}

/* Exchanges child `from` of node a with child `to` of node b. */
typedef struct rotation {
    uint32_t a, from, b, to;
    double saved;
} rotation;

static bool has_two(const rotate *self, uint32_t n)
{
    return self->children[n][1] != BB_NONE;
}

/* Tries to exchange child `s` of n with each child of its sibling: only the sibling's box
 * changes. */
static void try_uncle(const rotate *self, const bb_tree *tree, uint32_t n, uint32_t s,
                      rotation *best)
{
    uint32_t child = self->children[n][s], sibling = self->children[n][1 - s];
    if (!has_two(self, sibling))
        return;
    double before = area_of(&tree->nodes[sibling]);
    for (uint32_t g = 0; g < 2; g++) {
        double saved = before - area_with(tree, child, self->children[sibling][1 - g]);
        if (saved > best->saved)
            *best = (rotation){n, s, sibling, g, saved};
    }
}

/* Tries to exchange a child of one child with a child of the other: both children's boxes change.
 * Two such exchanges lead to different pairs. */
static void try_cousins(const rotate *self, const bb_tree *tree, uint32_t n, rotation *best)
{
    uint32_t a = self->children[n][0], b = self->children[n][1];
    if (!has_two(self, a) || !has_two(self, b))
        return;
    const uint32_t *in_a = self->children[a], *in_b = self->children[b];
    double before = area_of(&tree->nodes[a]) + area_of(&tree->nodes[b]);
    for (uint32_t g = 0; g < 2; g++) {
        double after = area_with(tree, in_b[g], in_a[1]) + area_with(tree, in_b[1 - g], in_a[0]);
        if (before - after > best->saved)
            *best = (rotation){a, 0, b, g, before - after};
    }
}

static void set_box(const rotate *self, bb_tree *tree, uint32_t n)
{
    const uint32_t *children = self->children[n];
    box u = unite(&tree->nodes[children[0]], &tree->nodes[children[1]]);
    memcpy(tree->nodes[n].lo, u.lo, sizeof u.lo);
    memcpy(tree->nodes[n].hi, u.hi, sizeof u.hi);
}

/* Applies the best rotation at n, if one saves area; returns whether it did. */
static bool rotate_node(rotate *self, bb_tree *tree, uint32_t n)
{
    rotation best = {.saved = 0};
    if (!has_two(self, n))
        return false;
    try_uncle(self, tree, n, 0, &best);
    try_uncle(self, tree, n, 1, &best);
    try_cousins(self, tree, n, &best);
    if (!(best.saved > 0))
        return false;
    uint32_t *from = &self->children[best.a][best.from], *to = &self->children[best.b][best.to];
    uint32_t moved = *from;
    *from = *to;
    *to = moved;
    if (best.a != n)
        set_box(self, tree, best.a);
    set_box(self, tree, best.b);
    self->saved += best.saved;
    return true;
}

/* ---- passes ---- */

/* Turns the preorder into the order of the passes. */
static void order_visits(rotate *self, uint32_t count)
{
    uint32_t *visits = self->visits;
    if (self->order == UPWARDS)
        for (uint32_t i = 0; i < count / 2; i++) {
            uint32_t n = visits[i];
            visits[i] = visits[count - 1 - i];
            visits[count - 1 - i] = n;
        }
    bb_random random = bb_random_make(self->seed, 0);
    for (uint32_t i = count; self->order == SHUFFLED && i > 1; i--) {
        uint32_t k = bb_random_below(&random, i), n = visits[i - 1];
        visits[i - 1] = visits[k];
        visits[k] = n;
    }
}

static void make_passes(rotate *self, bb_tree *tree)
{
    uint32_t count = tree->info.node_count, changed = 1;
    self->rotations = self->passes_made = 0;
    self->saved = 0;
    while (changed > 0 && self->passes_made < self->passes) {
        changed = 0;
        for (uint32_t i = 0; i < count; i++)
            changed += rotate_node(self, tree, self->visits[i]);
        self->rotations += changed;
        self->passes_made++;
    }
    double root = area_of(&tree->nodes[tree->info.root]);
    self->saved = root > 0 ? self->saved / root : 0;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)scene;
    rotate *self = opaque;
    if (input->info.arity > 2)
        return bb_fail(BB_UNSUPPORTED,
                       "rotate takes binary trees, and this one has nodes of %u children",
                       input->info.arity);
    BB_TRY(bb_phase(phases, "read"));
    BB_TRY(reserve(self, input, tree));
    read_tree(self, input, tree);
    order_visits(self, tree->info.node_count);
    BB_TRY(bb_phase(phases, "rotate"));
    make_passes(self, tree);
    BB_TRY(bb_phase(phases, "link"));
    write_links(self, tree);
    BB_TRY(bb_links_finish(tree, self->depths));
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const rotate *self = opaque;
    snprintf(text, capacity, "%u rotations in %u passes, SAH lower by %.4g", self->rotations,
             self->passes_made, BB_COST_TRAVERSAL * self->saved);
    return BB_OK;
}

const bb_builder bb_builder_rotate = {
    .abi_version = BB_ABI_VERSION,
    .name = "rotate",
    .summary = "optimiser: rotates a binary tree to lower its SAH, on the host",
    .paper = "Kensler 2008",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_TREE,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .variants = BB_NO_VARIANTS,
    .create = create,
    .build = build,
    .describe = describe,
    .destroy = destroy,
};
