/* Loose BVH as published: all nodes of a complete binary tree in an array that is allocated
 * beforehand, on the host, by one thread.
 *
 * Eisemann, Grosch, Mueller, Magnor 2007 (Automatic Creation of Object Hierarchies for Ray Tracing
 * of Dynamic Scenes), section 3.2. The tree is that of `loose-bvh:deeper=0`, whose file says what
 * the paper leaves open. Each build is algorithm 2:
 *
 *   empty    takes the objects out of the nodes at which they were inserted last
 *   insert   for each object: its level by equation 3, its cell by equation 4, the node by a
 *            look-up table over these; adds it to the node's list
 *   refit    all nodes in reversed order, children before parents: box, whether it is empty, skip
 *            index: a node without objects and with a single child that is not empty is passed over
 *   write    the nodes that skip indices lead to, in the common format: no step of the paper's,
 *            which traces the array itself
 *
 * 2^(3 levels + 1) - 1 nodes of 32 bytes: 16 MiB at 6 levels (the paper's depth 18), 1 GiB at 8.
 */
#include "framework/builder/builder.h"

#include <math.h>
#include <string.h>

enum { LEVELS_MAX = 8 };

static const bb_option options[] = {
    {"levels", "6", "1|2|3|4|5|6|7|8", "the deepest cells are 2^levels per axis"},
    {"root", "box", "cube|box", "root cell: a cube as long as the scene, or the scene's box"},
    {.name = NULL},
};

typedef struct loose_node {
    float lo[3], hi[3];
    uint32_t objects; /* first of the list; BB_NONE: none */
    uint32_t skip;    /* itself, or the node below that stands for it; BB_NONE: empty */
} loose_node;

typedef struct loose_array {
    bb_account *account;
    uint32_t levels;
    bool cube;
    uint32_t node_count;
    loose_node *nodes; /* children of k: 2k + 1, 2k + 2 */
    uint32_t *table;   /* node of a cell: of level l from first_cell(l) on, x slowest */
    uint32_t *next;    /* per object: the next one at its node */
    uint32_t *place;   /* per object: its node */
    uint32_t inserted; /* objects that are in lists now */
} loose_array;

static void destroy(void *opaque)
{
    loose_array *self = opaque;
    if (self == NULL)
        return;
    bb_host_free(self->nodes);
    bb_host_free(self->table);
    bb_host_free(self->next);
    bb_host_free(self->place);
    bb_host_free(self);
}

/* Returns the number of cells above `level`. */
static uint32_t first_cell(uint32_t level)
{
    return ((1u << 3 * level) - 1) / 7;
}

/* Returns the node of a cell: its path from the root is a bit of x, y, z in turn, from the top. */
static uint32_t node_of_cell(uint32_t level, const uint32_t cell[3])
{
    uint32_t node = 0;
    for (uint32_t bit = level; bit-- > 0;)
        for (int axis = 0; axis < 3; axis++)
            node = 2 * node + 1 + (cell[axis] >> bit & 1);
    return node;
}

static void fill_table(loose_array *self)
{
    for (uint32_t level = 0; level <= self->levels; level++)
        for (uint32_t i = 0; i < 1u << 3 * level; i++) {
            const uint32_t last = (1u << level) - 1;
            const uint32_t cell[3] = {i >> 2 * level, i >> level & last, i & last};
            self->table[first_cell(level) + i] = node_of_cell(level, cell);
        }
}

static bb_status create(const bb_builder_context *context, void **out)
{
    loose_array *self = NULL;
    uint64_t levels;
    BB_TRY(bb_spec_u64(context->spec, options, "levels", 1, LEVELS_MAX, &levels));
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "loose-bvh-array: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->account = context->account;
    self->levels = (uint32_t)levels;
    self->cube = bb_spec_is(context->spec, options, "root", "cube");
    self->node_count = (1u << (3 * self->levels + 1)) - 1;
    BB_TRY(bb_host_alloc(self->account, self->node_count * sizeof *self->nodes,
                         "loose-bvh-array: nodes", &self->nodes));
    BB_TRY(bb_host_alloc(self->account, first_cell(self->levels + 1) * sizeof *self->table,
                         "loose-bvh-array: look-up table", &self->table));
    for (uint32_t i = 0; i < self->node_count; i++)
        self->nodes[i].objects = BB_NONE;
    fill_table(self);
    return BB_OK;
}

/* ---- algorithm 2 ---- */

static void empty(loose_array *self)
{
    for (uint32_t i = 0; i < self->inserted; i++)
        self->nodes[self->place[i]].objects = BB_NONE;
    self->inserted = 0;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    loose_array *self = opaque;
    const size_t count = scene->prim_count;
    empty(self);
    BB_TRY(bb_host_alloc(self->account, count * sizeof *self->next, "loose-bvh-array: lists",
                         &self->next));
    BB_TRY(bb_host_alloc(self->account, count * sizeof *self->place, "loose-bvh-array: places",
                         &self->place));
    return bb_tree_reserve(tree, NULL, BB_ON_HOST, 2 * count - 1, count);
}

static void start_box(float lo[3], float hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = INFINITY;
        hi[axis] = -INFINITY;
    }
}

static void join_box(float lo[3], float hi[3], const float more_lo[3], const float more_hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = more_lo[axis] < lo[axis] ? more_lo[axis] : lo[axis];
        hi[axis] = more_hi[axis] > hi[axis] ? more_hi[axis] : hi[axis];
    }
}

/* The root cell: its low corner and its sides, both halved, so that no difference overflows. */
typedef struct root_cell {
    float low[3], whole[3];
} root_cell;

static root_cell enclose(const loose_array *self, const bb_scene *scene)
{
    root_cell root;
    float lo[3], hi[3], longest = 0;
    start_box(lo, hi);
    for (uint32_t i = 0; i < scene->prim_count; i++)
        join_box(lo, hi, scene->boxes[i].lo, scene->boxes[i].hi);
    for (int axis = 0; axis < 3; axis++) {
        root.low[axis] = 0.5f * lo[axis];
        root.whole[axis] = 0.5f * hi[axis] - root.low[axis];
        longest = root.whole[axis] > longest ? root.whole[axis] : longest;
    }
    for (int axis = 0; axis < 3 && self->cube; axis++)
        root.whole[axis] = longest;
    return root;
}

/* floor(log2(whole / part)) of positive floats: the difference of their bits, cut to the
 * exponent. */
static int octaves_of(float whole, float part, int none)
{
    int32_t bits[2];
    memcpy(&bits[0], &whole, sizeof whole);
    memcpy(&bits[1], &part, sizeof part);
    return bits[1] != 0 ? (bits[0] - bits[1]) >> 23 : none;
}

/* Equations 3 and 4, and the table. An axis without extent sets no limit and has one cell. */
static uint32_t node_of(const loose_array *self, const root_cell *root, const bb_box *box)
{
    const int last = (int)self->levels;
    const float cells = (float)(1u << self->levels);
    uint32_t cell[3] = {0};
    int level = last;
    for (int axis = 0; axis < 3; axis++) {
        const float whole = root->whole[axis], lo = 0.5f * box->lo[axis], hi = 0.5f * box->hi[axis];
        if (!(whole > 0))
            continue;
        const int octaves = octaves_of(whole, hi - lo, last);
        level = octaves < level ? octaves : level;
        float at = (0.5f * lo + 0.5f * hi - root->low[axis]) / whole * cells;
        at = at < cells - 1 ? at : cells - 1;
        at = at > 0 ? at : 0; /* halves of denormals may be below the corner */
        cell[axis] = (uint32_t)(int)at;
    }
    const uint32_t l = level > 0 ? (uint32_t)level : 0, dropped = self->levels - l;
    return self->table[first_cell(l) + (cell[0] >> dropped << 2 * l) + (cell[1] >> dropped << l) +
                       (cell[2] >> dropped)];
}

/* The last object first, so that lists are in ascending order. */
static void insert(loose_array *self, const bb_scene *scene)
{
    const root_cell root = enclose(self, scene);
    for (uint32_t i = scene->prim_count; i-- > 0;) {
        loose_node *node = &self->nodes[self->place[i] = node_of(self, &root, &scene->boxes[i])];
        self->next[i] = node->objects;
        node->objects = i;
    }
    self->inserted = scene->prim_count;
}

static void join_objects(const loose_array *self, const bb_scene *scene, uint32_t node, float lo[3],
                         float hi[3])
{
    for (uint32_t i = self->nodes[node].objects; i != BB_NONE; i = self->next[i])
        join_box(lo, hi, scene->boxes[i].lo, scene->boxes[i].hi);
}

static void refit(loose_array *self, const bb_scene *scene)
{
    loose_node *nodes = self->nodes;
    for (uint32_t k = self->node_count; k-- > 0;) {
        uint32_t children = 0, only = BB_NONE;
        start_box(nodes[k].lo, nodes[k].hi);
        join_objects(self, scene, k, nodes[k].lo, nodes[k].hi);
        for (uint32_t c = 2 * k + 1; c <= 2 * k + 2 && c < self->node_count; c++) {
            if (nodes[c].skip == BB_NONE)
                continue;
            join_box(nodes[k].lo, nodes[k].hi, nodes[c].lo, nodes[c].hi);
            only = nodes[c].skip;
            children++;
        }
        const bool objects = nodes[k].objects != BB_NONE;
        nodes[k].skip = !objects && children == 0 ? BB_NONE : !objects && children == 1 ? only : k;
    }
}

/* ---- the common format ---- */

typedef struct writer {
    const loose_array *self;
    const bb_scene *scene;
    bb_tree *tree;
    bb_tree_info info;
} writer;

static void write_box(bb_node *node, const float lo[3], const float hi[3])
{
    memcpy(node->lo, lo, sizeof node->lo);
    memcpy(node->hi, hi, sizeof node->hi);
}

/* A leaf of a node's own objects. */
static void write_leaf(writer *w, uint32_t k)
{
    bb_node *leaf = &w->tree->nodes[w->info.node_count++];
    float lo[3], hi[3];
    start_box(lo, hi);
    join_objects(w->self, w->scene, k, lo, hi);
    write_box(leaf, lo, hi);
    leaf->first = BB_LEAF_BIT | w->info.ref_count;
    leaf->skip = w->info.node_count;
    for (uint32_t i = w->self->nodes[k].objects; i != BB_NONE; i = w->self->next[i])
        w->tree->refs[w->info.ref_count++] = i;
    w->tree->refs[w->info.ref_count - 1] |= BB_LAST_BIT;
    w->info.leaf_count++;
}

/* Writes node k, which is not empty and passes over nothing, and all below it, in preorder: a
 * node's skip is the place behind all of these. At most 3 levels + 1 calls within each other.
 * Returns the height. */
static uint32_t write_node(writer *w, uint32_t k)
{
    const loose_node *nodes = w->self->nodes;
    uint32_t below[2], count = 0, height = 0;
    for (uint32_t c = 2 * k + 1; c <= 2 * k + 2 && c < w->self->node_count; c++)
        if (nodes[c].skip != BB_NONE)
            below[count++] = nodes[c].skip;
    if (count == 0) {
        write_leaf(w, k);
        return 0;
    }
    bb_node *node = &w->tree->nodes[w->info.node_count++];
    const uint32_t own = nodes[k].objects != BB_NONE ? 1 : 0;
    write_box(node, nodes[k].lo, nodes[k].hi);
    node->first = w->info.node_count;
    w->info.arity = count + own > w->info.arity ? count + own : w->info.arity;
    if (own != 0)
        write_leaf(w, k);
    for (uint32_t c = 0; c < count; c++) {
        const uint32_t own_height = write_node(w, below[c]);
        height = own_height > height ? own_height : height;
    }
    node->skip = w->info.node_count;
    return height + 1;
}

static void write(const loose_array *self, const bb_scene *scene, bb_tree *tree)
{
    writer w = {.self = self, .scene = scene, .tree = tree, .info = {.root = 0}};
    w.info.depth = write_node(&w, self->nodes[0].skip);
    for (uint32_t i = 0; i < w.info.node_count; i++)
        if (tree->nodes[i].skip == w.info.node_count)
            tree->nodes[i].skip = BB_NONE;
    tree->info = w.info;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    loose_array *self = opaque;
    BB_TRY(bb_phase(phases, "empty"));
    empty(self);
    BB_TRY(bb_phase(phases, "insert"));
    insert(self, scene);
    BB_TRY(bb_phase(phases, "refit"));
    refit(self, scene);
    BB_TRY(bb_phase(phases, "write"));
    write(self, scene, tree);
    bb_tree_changed(tree);
    return bb_phase(phases, NULL);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_STRESSED, "loose-bvh-array"},
    {0},
};

const bb_builder bb_builder_loose_bvh_array = {
    .abi_version = BB_ABI_VERSION,
    .name = "loose-bvh-array",
    .summary = "the tree of loose-bvh as published, in an array of all nodes, on the host",
    .paper = "Eisemann, Grosch, Mueller, Magnor 2007, section 3.2",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .prepare = prepare,
    .build = build,
    .destroy = destroy,
};
