/* Layouts (a tree prepared for a kernel), kernels (OpenCL traversals) and intersectors: constant
 * structs. CMake generates the tables from layout_*.c and kernel_*.c in this folder.
 */
#ifndef BB_TRAVERSAL_H
#define BB_TRAVERSAL_H

#include "framework/base/decision.h"
#include "framework/base/options.h"
#include "framework/base/variants.h"
#include "framework/builder/tree.h"
#include "framework/device/device.h"
#include "framework/device/stopwatch.h"
#include "framework/judge/rays.h"
#include "framework/scene/scene.h"

enum {
    BB_LAYOUT_BUFFERS_MAX = 6,
    BB_MORE_ARGS_MAX = 4, /* arguments of a query's own */
    BB_TRAIL_MAX =
        1 << 14, /* levels: 4 KiB of private memory per ray with 2 children, 8 KiB with 8 */
};

/* How nodes of more than two children are chosen. */
typedef enum bb_plan {
    BB_PLAN_BY_TREE, /* native if it says so (bb_tree.keep_nodes) and has the arity, else optimal */
    BB_PLAN_OPTIMAL, /* of least area in all */
    BB_PLAN_GREEDY,  /* by opening the largest box */
    BB_PLAN_NATIVE,  /* the tree's own */
} bb_plan;

/* A kernel's requests to its layout, in addition to those of the scene. */
typedef struct bb_layout_wish {
    uint32_t kinds; /* kinds of primitives that records also need room for */
    bool octants;   /* places the children of nodes of 8 by their octant */
    bb_plan plan;
    double node_cost; /* for leaf collapse, in blocks of primitives; 0: bb_collapse_node_cost() */
    bool preorder;    /* numbers the tree in preorder first: equal trees give equal layouts */
} bb_layout_wish;

/* The input of a layout. */
typedef struct bb_layout_source {
    const bb_scene *scene;
    const bb_tree *tree; /* on the device */
    const bb_buffer
        *reach;      /* float per node: longest side of the primitives below it; NULL: each box
                      * contains its primitives whole, so its own longest side is used */
    uint32_t kinds;  /* kinds of primitives that records have room for: at least the scene's */
    bool octants;    /* bb_layout_wish */
    bb_plan plan;    /* not BB_PLAN_BY_TREE */
    float traversal; /* cost of a pair of children in leaf collapse */
    uint32_t leaf;   /* most references of leaves that make() collapses; 0: already done */
    const bb_buffer *array; /* the side array that the layout reads; NULL if none */
    /* The object's last make() had the same tree with the same links: the numbering in scratch is
     * still valid, boxes and primitives are not. */
    bool same_links;
} bb_layout_source;

/* A tree in the form that a kernel reads, on the device. Lengths are the scene's times `scale`.
 * Boxes are padded (kernels/ERROR_BUDGET.md). */
typedef struct bb_layout_data {
    uint32_t buffer_count;
    bb_buffer buffers[BB_LAYOUT_BUFFERS_MAX]; /* the kernel's first arguments, in this order */
    bb_u32 root;                              /* link to start from, in the form that the kernel
                                               * reads */
    bb_prim_ends ends;                        /* of the scene's kinds */
    uint32_t kinds;                           /* kinds of primitives that records have room for */
    bb_u32 format;                            /* of triangles: BB_FORMAT_... */
    uint32_t lanes;      /* primitives side by side in a record: the layout's `block`, or 1 */
    float scale;         /* the scene's */
    bb_box bounds;       /* the scene's, in its own units */
    uint32_t stack_need; /* stack entries that an ordered traversal needs; native nodes: at most */
    uint32_t levels;     /* inner nodes on the longest path, as the kernel counts; an upper bound */
    uint32_t leaves;     /* of the tree, for layouts of which kernels run per leaf */
    uint64_t bytes, prims_bytes; /* in all; of these, of primitives */
    /* the traced nodes are the tree's own: its SAH is also the layout's, and the trace is native */
    bool keeps_shape;
    double sah;       /* of the layout as traced; NAN: not known */
    bb_timing timing; /* of making it, including leaf collapse */
    char name[96];    /* as recorded: "pair", "pair:leaf=4", "pair:leaf=4,triangles=affine" */
} bb_layout_data;

/* How points are located in the tetrahedra of a layout (kernels/locate.clh). */
typedef enum bb_tet_search_way {
    BB_SEARCH_NONE,   /* not at all */
    BB_SEARCH_SKIP,   /* by boxes */
    BB_SEARCH_OCTREE, /* by the octants of cells, which say whether they list a boundary's */
    BB_SEARCH_OLBVH,  /* by the arrays of an OLBVH; its cells say so, too */
    BB_SEARCH_ALL,    /* without a layout: one tetrahedron after the other */
    BB_SEARCH_WAYS
} bb_tet_search_way;

typedef struct bb_layout {
    const char *name;
    const char *summary;
    uint32_t width;      /* most children of a node; 2 if unlimited. Required */
    uint32_t block;      /* number of primitives that its kernels test at once. Required */
    uint32_t node_bytes; /* size of a node in its first buffer; 0: nodes are in several arrays */
    uint32_t leaf_max;   /* most references of a leaf: larger ones are divided; 0: unlimited */
    bool keeps_nodes;    /* has BB_PLAN_NATIVE, for trees of up to `width` children */
    bb_tet_search_way search;
    /* The side array of the tree that make() reads (bb_tree_reserve_array()): trees without an
     * array of this name and format are refused. Optional. */
    struct {
        const char *name;
        bool per_reference;
        uint32_t stride;
    } array;
    /* Compiles, and allocates what does not depend on a tree. `device` and `account` outlive the
     * object; all memory is booked on `account`. If it fails, destroy() gets *self as set so
     * far. */
    bb_status (*create)(bb_device *device, bb_account *account, void **self);
    /* Makes the layout of `source`, with triangles in data->format and lengths multiplied by
     * data->scale. Sets buffers, root, stack_need, levels, keeps_shape, and lanes if they are fewer
     * than a block's; adds to data->bytes. May enqueue and return. bb_layout_maker_make() does the
     * rest. */
    bb_status (*make)(void *self, const bb_layout_source *source, bb_layout_data *data);
    /* Returns whether make() itself collapses the leaves of this tree, by source->leaf; otherwise
     * they are collapsed before. Optional: never. */
    bool (*collapses)(const void *self, const bb_tree *tree);
    void (*destroy)(void *self); /* also after create() has failed; NULL is allowed */
} bb_layout;

extern const bb_layout *const bb_layouts[];        /* generated; ends with NULL */
const bb_layout *bb_layout_find(const char *name); /* NULL if there is none */
/* Returns the most that `leaf` may be. */
uint32_t bb_layout_leaf_max(const bb_layout *layout);
void bb_layout_data_release(bb_layout_data *data); /* a zeroed one is allowed */

/* A layout in use on a device. Must not be moved, since it contains the account. */
typedef struct bb_layout_maker {
    const bb_layout *layout;
    bb_device *device;
    bb_account account; /* also for the layouts made, which are released first */
    void *self;
    bb_layout_wish wish;          /* set after creation; zeroed: none */
    struct bb_collapse *collapse; /* NULL until a layout with collapsed leaves is requested */
    struct bb_reach *reach;       /* NULL until a tree needs it */
    /* The input of the last layout, for bb_layout_maker_follow(). */
    uint64_t links; /* the tree's; 0: nothing to follow from */
    uint32_t leaf;
} bb_layout_maker;

/* Compiles what the layout needs on the device, which must outlive the maker. After a failure the
 * maker is zeroed and need not be destroyed. */
bb_status bb_layout_maker_create(const bb_layout *layout, bb_device *device,
                                 bb_layout_maker *maker);
void bb_layout_maker_destroy(bb_layout_maker *maker); /* a zeroed one is allowed */

/* Makes the layout of `tree` on the device, with leaves of up to `leaf` references (1: the tree's
 * own leaves) and triangles in `format` (BB_FORMAT_...). Waits for it, and times it. `data` may
 * hold an earlier layout, whose memory is reused. BB_INVALID if `leaf` exceeds
 * bb_layout_leaf_max(). */
bb_status bb_layout_maker_make(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                               uint32_t leaf, uint32_t format, bb_layout_data *data);

/* Updates `data`, the last layout that this maker made, after an update of its tree. If only boxes
 * of the tree have changed, it is updated in place, with the same numbers and shape of nodes;
 * otherwise it is made anew. `in_place` says which. Timed like bb_layout_maker_make(), with the
 * same `leaf` and `format` as before. */
bb_status bb_layout_maker_follow(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                                 uint32_t leaf, uint32_t format, bb_layout_data *data,
                                 bool *in_place);

/* An intersector: the tests of rays against triangles and boxes, and their rounding rules. A preset
 * of bb_intersector_options; a specification may override each of them: "exact:slab=sign". */
typedef struct bb_intersector {
    const char *name;
    const char *summary;
    char triangle[12], slab[8], contract[4];
} bb_intersector;

extern const bb_intersector
    bb_intersectors[]; /* from exact to careless; ends with name NULL; the first is the default */
extern const bb_option bb_intersector_options[]; /* the defaults are those of each preset */
const bb_intersector *bb_intersector_find(const char *name); /* NULL if there is none */

/* Finds the preset that `text` names and applies the options in `text`. BB_INVALID for an unknown
 * name, option or value. */
bb_status bb_intersector_parse(const char *text, bb_intersector *intersector);

/* Returns the format of triangles that it reads: BB_FORMAT_... */
bb_u32 bb_intersector_format(const bb_intersector *intersector);

/* Returns whether it must never be wrong: its errors then set the exit status of `run`. */
bool bb_intersector_is_exact(const bb_intersector *intersector);

/* Writes its options as -D definitions for kernels/intersect.clh: less than 128 characters. */
void bb_intersector_defines(const bb_intersector *intersector, char *text, size_t capacity);

/* A kernel's loops, around the steps of its rays (kernels/steps_shared.h): in which order the rays
 * of a group that run in lockstep wait for each other. */
typedef enum bb_control {
    BB_CONTROL_UNKNOWN, /* its steps are not recorded */
    BB_WHILE_WHILE,     /* nodes until none is next, primitives likewise, then pops likewise */
    BB_IF_IF,           /* one node, if it is next; primitives; pops, and so on */
    BB_IF_ELSE,         /* one node, if it is next, and its primitives; or else one pop */
    BB_IF_IF_BY_LEAF, /* BB_IF_IF, where each primitive is a leaf, with all that follows from it */
    /* of each packet a pop; primitives, or a node and its boxes one by one; rays that go on alone,
     * as while-while; and so on */
    BB_PACKETS,
    /* a node, its children's boxes one by one, pushes or a pop, until each has a leaf; one leaf's
     * primitives; and so on */
    BB_UNTIL_LEAF,
} bb_control;

typedef struct bb_kernel {
    const char *name;
    const char *summary;
    const char *paper;
    const char *layout;  /* the layout that it reads */
    const char *source;  /* its file in kernels/ */
    const char *defines; /* -D for every variant; NULL: none */
    uint32_t queries;    /* the queries that it answers: BB_ALONG_RAYS */
    bool ordered;        /* visits children near to far */
    /* The variants that are compared and tried if no kernel is named, and on which devices. NULL:
     * none. */
    const bb_variants *variants;
    /* Its layout keeps the shape of any tree: by default it is compared on trees whose shape no
     * compared kernel keeps. */
    bool native;
    bool batched;   /* one work-item traces all rays of a group; gets their number as BB_BATCH */
    bool stackless; /* needs no stack of the tree's size: gets no BB_STACK_SIZE */
    /* Most levels of its bit trail: gets BB_LEVELS, and refuses deeper trees; 0: no trail. */
    uint32_t trail_max;
    bb_control control;
    /* Its own options: the value of `name` reaches the kernel as -DBB_NAME=value, so each must list
     * its `values`. All kernels also have `leaf`, `group`, `stack`, `kinds`, `plan`, `node`,
     * `persistent`, `sort`. */
    const bb_option *options;
} bb_kernel;

extern const bb_kernel *const bb_kernels[];        /* generated; ends with NULL */
const bb_kernel *bb_kernel_find(const char *name); /* NULL if there is none */
/* Returns the first kernel whose layout accepts leaves of any size, and so any tree of one leaf; if
 * `recorded`, of those whose steps can be, and that are not for CPUs only. */
const bb_kernel *bb_kernel_for_any_leaf(bool recorded);
extern const bb_option bb_kernel_common_options[];
/* Returns the rays of a packet, if its steps are recorded; 1: it traces rays one by one. */
uint32_t bb_kernel_recorded_packet(const bb_kernel *kernel, const bb_spec *spec);
/* Returns whether its steps for this query can be recorded; those of packets for hits alone. */
bool bb_kernel_records(const bb_kernel *kernel, const bb_query *query);
/* Returns whether all its variants that are taken by default are for CPUs only. */
bool bb_kernel_is_for_cpus(const bb_kernel *kernel);
/* Checks a kernel's specification against its own options and the common ones. BB_INVALID names an
 * option that it does not have. */
bb_status bb_kernel_validate(const bb_kernel *kernel, const bb_spec *spec);
/* Returns its group size, in rays: as given, or the default limited by the device. BB_INVALID if
 * the given size exceeds the device's groups; groups of a batched kernel are not limited by the
 * device. */
bb_status bb_kernel_group_of(const bb_kernel *kernel, const bb_spec *spec, const bb_device *device,
                             uint64_t *group);
/* Returns whether both give the same layout. */
bool bb_layout_wish_is(const bb_layout_wish *a, const bb_layout_wish *b);
/* Returns the requests in a kernel's specification, for bb_layout_maker.wish. */
bb_layout_wish bb_kernel_wish(const bb_spec *spec);
/* Finds the kernel that `text` names and checks its specification. BB_INVALID for an unknown name,
 * option or value. */
bb_status bb_kernel_parse(const char *text, bb_spec *spec, const bb_kernel **kernel);

/* A kernel compiled for an intersector, a query, and the needs of a layout. */
typedef struct bb_traverser bb_traverser;

typedef struct bb_traverser_request {
    const bb_kernel *kernel;
    const bb_spec *spec;
    const bb_intersector *intersector;
    const bb_query *query;
    bool counting;       /* the variant that counts tests and overflows */
    bool recording;      /* counting, too: the variant that also records each ray's steps */
    const char *defines; /* additional definitions for the query; NULL: none */
} bb_traverser_request;

/* Buffers of a recording traverser, which the caller owns (kernels/steps.clh). */
typedef struct bb_recording {
    bb_buffer ends;   /* u32 per ray: where its steps end; the first ray's begin at 0 */
    bb_buffer steps;  /* u32: as many as the last end says, and at least one */
    bb_buffer counts; /* u32 per ray: its steps, whether there was room for them or not */
} bb_recording;

/* Gets a traverser for layouts that need no more than this one: kinds of primitives, stack entries
 * (rounded up to 16, 32, 64 ...), levels of a trail (64, 128, 256 ...). A cache of the device owns
 * it until bb_traversers_clear(), so that equal requests compile once. BB_UNSUPPORTED if the kernel
 * does not answer the query, or not for these primitives, or if its trail is too short for the
 * tree, or if its steps cannot be recorded. BB_REFUSED if the device has no room for a given stack
 * (stack_room.h). BB_FAILED if it does not compile, or its definitions are too long. */
bb_status bb_traverser_get(bb_device *device, const bb_traverser_request *request,
                           const bb_layout_data *layout, bb_traverser **traverser);
/* Reports the decisions for such a traverser: stack, levels of the trail, kinds. */
bb_status bb_traverser_decide(const bb_device *device, const bb_traverser_request *request,
                              const bb_layout_data *layout, bb_decisions *decisions);
/* Releases all traversers of the device: before it is closed, and when none is used any more. */
void bb_traversers_clear(bb_device *device);
/* Returns the rays of a work-group: fewer than requested if the device only runs the compiled
 * kernel in smaller ones. */
uint32_t bb_traverser_group_size(const bb_traverser *traverser);
uint32_t
bb_traverser_stack_size(const bb_traverser *traverser); /* 0: no stack of the tree's size */
/* Private memory of a work-item: of its stacks, and, if the driver reports it, in total. */
uint64_t bb_traverser_stack_bytes(const bb_traverser *traverser);
bool bb_traverser_private_bytes(const bb_traverser *traverser, uint64_t *bytes);
uint64_t
bb_traverser_launched(const bb_traverser *traverser); /* number of rays in all its launches */

/* Returns whether it traces rays in an order of its own. */
bool bb_traverser_sorts(const bb_traverser *traverser);
/* Enqueues the sort of rays[0..count), which has to come before each launch of such a traverser
 * (ray_order.h). All traversers of a device share its memory. */
bb_status bb_traverser_sort(bb_traverser *traverser, const bb_layout_data *layout,
                            const bb_buffer *rays, uint32_t count);

/* Enqueues the traversal of rays[0..count); does not wait. The layout's format of triangles must be
 * the intersector's. `counts` (bb_count[count]) for counting traversers, otherwise NULL;
 * `recording` likewise. `more`: additional arguments of the query's kernels, at most
 * BB_MORE_ARGS_MAX; may be NULL. */
bb_status bb_traverser_launch(bb_traverser *traverser, const bb_layout_data *layout,
                              const bb_buffer *rays, uint32_t count, bb_buffer *results,
                              bb_buffer *counts, const bb_recording *recording, const bb_arg *more,
                              uint32_t more_count);

#endif
