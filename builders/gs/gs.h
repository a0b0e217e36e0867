/* The tree of gs: what its parts share, and what tests look at.
 *
 *   gs_tree.c    nodes and links; boxes and counts after what was linked or unlinked
 *   gs_order.c   in which order objects are inserted
 *   gs_insert.c  where a box costs least
 *   gs_update.c  objects that moved
 *   gs_thin.c    nodes that have become too large for what they hold
 *   gs_emit.c    the common tree
 *
 * At all times each box is the union of the children's, bit for bit, and an inner node has two
 * children or more. Nodes are numbered as in the common tree, but for slots that are free while the
 * tree changes.
 */
#ifndef BB_GS_H
#define BB_GS_H

#include "framework/builder/builder.h"

typedef struct bb_gs_box {
    float lo[3], hi[3];
} bb_gs_box;

/* 64 bytes: one line of the cache, since each child that a search looks at is one of these. */
typedef struct bb_gs_node {
    bb_gs_box box;
    uint32_t parent;   /* BB_NONE: the root, or what hangs nowhere */
    uint32_t first;    /* child; of a leaf BB_LEAF_BIT | object */
    uint32_t next;     /* sibling; BB_NONE for the last; of a free slot the next free one */
    uint32_t prev;     /* sibling; of the first child the last one */
    uint32_t children; /* 0: a leaf */
    uint32_t objects;  /* leaves below; 1 for a leaf */
    double area;       /* half of the box's */
    double q_init;     /* area / objects when the node was made, or all of the tree */
} bb_gs_node;

/* What is to be done about a node. */
enum {
    BB_GS_BOX = 1,        /* emit box and first child */
    BB_GS_SKIP = 2,       /* emit the skip, also of those below that end with it */
    BB_GS_HEIGHT = 4,     /* another set of children: the height may differ */
    BB_GS_TOUCHED = 8,    /* area or objects differ: look whether it is thinned */
    BB_GS_CANDIDATE = 16, /* it was thinned when the phase began */
    BB_GS_FREE = 32,
};

typedef struct bb_gs_rules {
    bool binary;           /* two children at most */
    uint32_t max_children; /* 0: any number */
    bool whole;            /* search the whole tree, not one path */
    bool from_root;        /* what is inserted again starts at the root */
    double tau;            /* 0: nothing is thinned */
    bool least_q;          /* q_init follows when it falls */
    uint32_t thin_budget;  /* nodes per update; 0: all */
} bb_gs_rules;

typedef enum bb_gs_order { BB_GS_AS_IN_FILE, BB_GS_SHUFFLED, BB_GS_ROUNDS } bb_gs_order;

/* A node that the search of the whole tree may go on to. */
typedef struct bb_gs_step {
    double inherited;
    uint32_t node;
} bb_gs_step;

typedef struct bb_gs_tree {
    bb_gs_rules rules;
    uint32_t capacity; /* objects */
    uint32_t object_count;
    bb_gs_node *nodes;   /* 2 capacity - 1 */
    uint8_t *marks;      /* a byte per node, filled up to a multiple of 8 */
    uint32_t *heights;   /* per node; right after bb_gs_emit() */
    uint32_t *scratch;   /* 2 per object */
    uint32_t *leaf_of;   /* per object */
    bb_gs_box *boxes;    /* per object, as last seen: one after the other, which leaves are not */
    uint32_t *widths;    /* [k]: how many nodes have k children */
    bb_gs_step *queue;   /* of the search of the whole tree, per object */
    uint32_t count;      /* slots, free ones too */
    uint32_t free, root; /* BB_NONE: none */
    uint32_t arity;
    uint32_t reinserted, thinned; /* in the last update */
} bb_gs_tree;

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

/* The next slot from `i` on with a mark of `which`; tree->count if there is none. */
uint32_t bb_gs_next_marked(const bb_gs_tree *tree, uint32_t i, uint8_t which);

/* ---- gs_tree.c ---- */

bb_status bb_gs_reserve(bb_gs_tree *tree, bb_account *account, uint32_t objects);
void bb_gs_release(bb_gs_tree *tree);

/* Empty, for so many objects, at most as many as were reserved. */
void bb_gs_clear(bb_gs_tree *tree, uint32_t objects);

/* A leaf that hangs nowhere yet. */
uint32_t bb_gs_make_leaf(bb_gs_tree *tree, uint32_t object, const bb_gs_box *box);
void bb_gs_set_box(bb_gs_tree *tree, uint32_t n, const bb_gs_box *box);
void bb_gs_free_node(bb_gs_tree *tree, uint32_t n);

/* `beside`: a new node takes the place of `node`, over it and x; else x becomes its child. Boxes
 * grow as far up as they have to. `above`: counts of objects grow below this ancestor of `node`;
 * BB_NONE for all of them. */
void bb_gs_attach(bb_gs_tree *tree, uint32_t x, uint32_t node, bool beside, uint32_t above);

/* Unlinks x, which is not the root, with all below. A parent left with one child is replaced by it;
 * if it is *start, then its own parent becomes that (of the root: the child). Counts of objects
 * fall up to and including *start, an ancestor of x: whoever attaches x again from there need not
 * go farther. Boxes shrink, from the parent up to the first that does not. */
void bb_gs_detach(bb_gs_tree *tree, uint32_t x, uint32_t *start);

/* The slots from 0 on become the nodes: no free ones are left. */
void bb_gs_compact(bb_gs_tree *tree);

/* ---- gs_order.c ---- */

/* Of the first `count` of scratch; another one for each stream. */
void bb_gs_put_in_order(bb_gs_tree *tree, bb_gs_order order, uint32_t count, uint64_t seed,
                        uint64_t stream);

/* ---- gs_insert.c ---- */

/* Where x goes, and how much that adds to the sum of children(n) area(n) over the inner nodes from
 * `start` down. */
typedef struct bb_gs_choice {
    double cost;
    uint32_t node;
    bool beside;
    uint32_t objects; /* of the node; of equal choices the one with fewer wins */
} bb_gs_choice;

bb_gs_choice bb_gs_find(bb_gs_tree *tree, uint32_t start, uint32_t x);

/* Finds and attaches. *start may be the root, which this may change: it is the new one then. An
 * empty tree gets its root; *start is not looked at. */
void bb_gs_insert(bb_gs_tree *tree, uint32_t *start, uint32_t x);

/* A new object, from the root down. */
void bb_gs_add(bb_gs_tree *tree, uint32_t object, const bb_gs_box *box);

/* ---- gs_update.c, gs_thin.c ---- */

/* The first ancestor of n whose box contains `box`; the root if there is none. */
uint32_t bb_gs_enclosing(const bb_gs_tree *tree, uint32_t n, const bb_gs_box *box);

/* The objects whose boxes differ from those last seen, into scratch; returns how many. */
uint32_t bb_gs_detect(bb_gs_tree *tree, const bb_box *boxes);

/* Moves those of scratch, in this order. */
void bb_gs_move(bb_gs_tree *tree, const bb_box *boxes, uint32_t moved);

/* Sets q_init of all nodes. */
void bb_gs_start_q(bb_gs_tree *tree);

void bb_gs_thin(bb_gs_tree *tree);

/* ---- gs_emit.c ---- */

/* Into `out`, which has room. `whole`: all nodes, numbered anew in preorder; else those that
 * changed since the last time, where they are, unless these are many. */
void bb_gs_emit(bb_gs_tree *tree, bool whole, bb_tree *out);

#endif
