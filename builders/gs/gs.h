/* The tree of gs, shared by its source files and examined by tests.
 *
 *   gs_tree.c    nodes and links; boxes and counts after linking and unlinking
 *   gs_order.c   the order of insertion
 *   gs_insert.c  the cheapest place for a box
 *   gs_update.c  objects that moved
 *   gs_thin.c    nodes that have become too large for their objects
 *   gs_groups.c  objects of several primitives
 *   gs_emit.c    writing the common tree
 *
 * Between calls each box is the union of its children's, bit for bit, and an inner node has two or
 * more children. Nodes have the same numbers as in the common tree, except that there are free
 * slots while the tree changes.
 */
#ifndef BB_GS_H
#define BB_GS_H

#include "framework/builder/builder.h"

typedef struct bb_gs_box {
    float lo[3], hi[3];
} bb_gs_box;

/* 64 bytes, one cache line, since a search reads one of these per child. */
typedef struct bb_gs_node {
    bb_gs_box box;
    uint32_t parent;   /* BB_NONE: the root, or an unlinked node */
    uint32_t first;    /* first child; for a leaf BB_LEAF_BIT | object */
    uint32_t next;     /* next sibling, BB_NONE for the last; for a free slot the next free slot */
    uint32_t prev;     /* previous sibling; for the first child the last one */
    uint32_t children; /* number of children; 0: a leaf */
    uint32_t objects;  /* number of leaves below; 1 for a leaf */
    double area;       /* half the area of the box */
    double q_init;     /* area / objects when the node, or the whole tree, was made */
} bb_gs_node;

/* Marks: what is to be done about a node. */
enum {
    BB_GS_BOX = 1,        /* emit box and first child */
    BB_GS_SKIP = 2,       /* emit the skip, also for those below that end with the node */
    BB_GS_HEIGHT = 4,     /* the set of children changed, so the height may */
    BB_GS_TOUCHED = 8,    /* area or objects changed: check whether to thin it */
    BB_GS_CANDIDATE = 16, /* it qualified for thinning when the phase began */
    BB_GS_FREE = 32,
};

typedef struct bb_gs_rules {
    bool binary;           /* at most two children */
    uint32_t max_children; /* 0: any number */
    bool whole;            /* search the whole tree, not one path */
    bool from_root;        /* reinsertion starts at the root */
    double tau;            /* 0: no thinning */
    bool least_q;          /* q_init is lowered to the least q */
    uint32_t thin_budget;  /* most nodes per update; 0: all */
} bb_gs_rules;

typedef enum bb_gs_order { BB_GS_AS_IN_FILE, BB_GS_SHUFFLED, BB_GS_ROUNDS } bb_gs_order;

/* A node that the search of the whole tree may visit. */
typedef struct bb_gs_step {
    double inherited;
    uint32_t node;
} bb_gs_step;

typedef struct bb_gs_tree {
    bb_gs_rules rules;
    uint32_t capacity; /* in objects */
    uint32_t object_count;
    bb_gs_node *nodes;   /* 2 capacity - 1 */
    uint8_t *marks;      /* a byte per node, filled up to a multiple of 8 */
    uint32_t *heights;   /* per node; valid right after bb_gs_emit() */
    uint32_t *scratch;   /* 2 per object */
    uint32_t *leaf_of;   /* per object */
    bb_gs_box *boxes;    /* per object, as last seen; contiguous, unlike the leaves' boxes */
    uint32_t *widths;    /* [k]: how many nodes have k children */
    bb_gs_step *queue;   /* for the search of the whole tree, per object */
    uint32_t count;      /* slots, including free ones */
    uint32_t free, root; /* BB_NONE if there is none */
    uint32_t arity;
    uint32_t reinserted, thinned;      /* by the last update */
    const struct bb_gs_groups *groups; /* NULL: each object is a primitive */
} bb_gs_tree;

/* Objects that are collections of primitives, each with a tree of its own. */
typedef struct bb_gs_groups {
    uint32_t count, capacity;
    const uint32_t *starts; /* the scene's object_starts */
    bb_box *boxes;          /* per object */
    uint32_t *first;        /* per object: its first node in the common tree; and their number */
    uint32_t *heights;      /* per object */
    uint32_t arity;
    bb_gs_order order; /* of insertion */
    uint64_t seed;
    bb_gs_tree one; /* for the tree of one object, and its nodes in the common format */
    bb_node *nodes;
} bb_gs_groups;

/* ---- boxes ---- */

static inline bb_gs_box bb_gs_unite(const bb_gs_box *a, const bb_gs_box *b)
{
    bb_gs_box u;
    for (int k = 0; k < 3; k++) {
        u.lo[k] = a->lo[k] < b->lo[k] ? a->lo[k] : b->lo[k];
        u.hi[k] = a->hi[k] > b->hi[k] ? a->hi[k] : b->hi[k];
    }
    return u;
}

static inline bb_gs_box bb_gs_box_of(const bb_box *box)
{
    return (bb_gs_box){{box->lo[0], box->lo[1], box->lo[2]}, {box->hi[0], box->hi[1], box->hi[2]}};
}

static inline double bb_gs_area(const bb_gs_box *box)
{
    return bb_half_area(box->lo, box->hi);
}

static inline double bb_gs_area_with(const bb_gs_box *a, const bb_gs_box *b)
{
    bb_gs_box u = bb_gs_unite(a, b);
    return bb_gs_area(&u);
}

static inline bool bb_gs_contains(const bb_gs_box *outer, const bb_gs_box *inner)
{
    for (int k = 0; k < 3; k++)
        if (inner->lo[k] < outer->lo[k] || inner->hi[k] > outer->hi[k])
            return false;
    return true;
}

static inline bool bb_gs_is_leaf(const bb_gs_node *node)
{
    return node->children == 0;
}

/* Returns the first slot from `i` on with a mark of `which`; tree->count if there is none. */
uint32_t bb_gs_next_marked(const bb_gs_tree *tree, uint32_t i, uint8_t which);

/* ---- gs_tree.c ---- */

bb_status bb_gs_reserve(bb_gs_tree *tree, bb_account *account, uint32_t objects);
void bb_gs_release(bb_gs_tree *tree);

/* Empties the tree, for `objects` objects, at most as many as were reserved. */
void bb_gs_clear(bb_gs_tree *tree, uint32_t objects);

/* Makes an unlinked leaf. */
uint32_t bb_gs_make_leaf(bb_gs_tree *tree, uint32_t object, const bb_gs_box *box);
void bb_gs_set_box(bb_gs_tree *tree, uint32_t n, const bb_gs_box *box);
void bb_gs_free_node(bb_gs_tree *tree, uint32_t n);

/* Links x. `beside`: a new node over `node` and x takes the place of `node`; otherwise x becomes a
 * child of `node`. Boxes above grow as far up as needed. Object counts grow up to, but not
 * including, `above`, an ancestor of `node`; BB_NONE: up to the root. */
void bb_gs_attach(bb_gs_tree *tree, uint32_t x, uint32_t node, bool beside, uint32_t above);

/* Unlinks x, which is not the root, with its subtree. A parent left with one child is replaced by
 * it; if that parent is *start, *start becomes the parent's parent, or the child if there is none.
 * Object counts fall up to and including *start, an ancestor of x, so attaching x again from there
 * need not go higher. Boxes shrink from the parent up to the first that stays the same. */
void bb_gs_detach(bb_gs_tree *tree, uint32_t x, uint32_t *start);

/* Numbers the nodes from 0 on without gaps; no free slots are left. */
void bb_gs_compact(bb_gs_tree *tree);

/* ---- gs_order.c ---- */

/* Orders the first `count` entries of scratch; each stream gives another order. */
void bb_gs_put_in_order(bb_gs_tree *tree, bb_gs_order order, uint32_t count, uint64_t seed,
                        uint64_t stream);

/* ---- gs_insert.c ---- */

/* A place for x, and how much it adds to the sum of children(n) area(n) over the inner nodes from
 * `start` down. */
typedef struct bb_gs_choice {
    double cost;
    uint32_t node;
    bool beside;
    uint32_t objects; /* number below the node; among equal choices the one with fewer wins */
} bb_gs_choice;

bb_gs_choice bb_gs_find(bb_gs_tree *tree, uint32_t start, uint32_t x);

/* Finds the cheapest place for x and links it there. If *start is the root and the root changes,
 * *start is updated. If the tree is empty, x becomes the root and *start is ignored. */
void bb_gs_insert(bb_gs_tree *tree, uint32_t *start, uint32_t x);

/* Inserts a new object, from the root down. */
void bb_gs_add(bb_gs_tree *tree, uint32_t object, const bb_gs_box *box);

/* ---- gs_update.c, gs_thin.c ---- */

/* Returns the first ancestor of n whose box contains `box`; the root if there is none. */
uint32_t bb_gs_enclosing(const bb_gs_tree *tree, uint32_t n, const bb_gs_box *box);

/* Writes the objects whose boxes differ from those last seen to scratch; returns their number. */
uint32_t bb_gs_detect(bb_gs_tree *tree, const bb_box *boxes);

/* Moves the objects listed in scratch, in this order. */
void bb_gs_move(bb_gs_tree *tree, const bb_box *boxes, uint32_t moved);

/* Sets q_init of all nodes. */
void bb_gs_start_q(bb_gs_tree *tree);

void bb_gs_thin(bb_gs_tree *tree);

/* ---- gs_groups.c ---- */

bb_status bb_gs_groups_reserve(bb_gs_groups *groups, bb_account *account, const bb_scene *scene);
void bb_gs_groups_release(bb_gs_groups *groups);

/* Makes the trees of all objects in `out`, from its first node on. */
void bb_gs_groups_make(bb_gs_groups *groups, const bb_scene *scene, bb_tree *out);

/* Whether the object has nodes of its own below its root: more than one primitive. */
bool bb_gs_is_group(const bb_gs_groups *groups, uint32_t object);

/* Sets what follows after the object's last nodes. */
void bb_gs_groups_end(const bb_gs_groups *groups, uint32_t object, uint32_t skip, bb_tree *out);

/* Makes the boxes of the object's nodes, and its own, from those of its primitives. `skip`: what
 * follows it. */
void bb_gs_groups_refit(bb_gs_groups *groups, uint32_t object, const bb_scene *scene, uint32_t skip,
                        bb_tree *out);

/* ---- gs_emit.c ---- */

/* Writes the tree to `out`, which has room. `whole`: all nodes, numbered anew in preorder.
 * Otherwise only the nodes that changed since the last time, in place, unless they are many. */
void bb_gs_emit(bb_gs_tree *tree, bool whole, bb_tree *out);

#endif
