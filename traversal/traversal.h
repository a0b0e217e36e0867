/* Layouts (a tree prepared for a kernel), kernels (OpenCL traversals) and intersectors: constant
 * structs; CMake generates the tables from layout_*.c and kernel_*.c in this folder.
 */
#ifndef BB_TRAVERSAL_H
#define BB_TRAVERSAL_H

#include "framework/base/decision.h"
#include "framework/base/options.h"
#include "framework/base/variants.h"
#include "framework/device/device.h"
#include "framework/device/stopwatch.h"
#include "framework/rays/rays.h"
#include "framework/scene/scene.h"
#include "framework/tree/tree.h"

enum {
    BB_LAYOUT_BUFFERS_MAX = 4,
    BB_MORE_ARGS_MAX = 4, /* of a query's own */
    BB_TRAIL_MAX =
        1 << 14, /* levels: 4 KiB of private memory per ray with 2 children, 8 KiB with 8 */
};

/* What a kernel asks of its layout beside what it asks for the scene. */
typedef struct bb_layout_wish {
    uint32_t kinds;   /* of primitives that records shall have room for, beside the scene's */
    bool octants;     /* children of nodes of 8 in places by the octant that they lie in */
    bool greedy;      /* wide nodes by the largest box, not by the plan of least area */
    double node_cost; /* in blocks of primitives, for leaf collapse; 0: bb_collapse_node_cost() */
} bb_layout_wish;

/* What a layout is made of. */
typedef struct bb_layout_source {
    const bb_scene *scene;
    const bb_tree *tree; /* on the device */
    const bb_buffer
        *reach;      /* float per node: the longest side of the primitives below it; NULL: the
                               node's box holds them whole, and has their longest side */
    uint32_t kinds;  /* of primitives that records have room for: the scene's at least */
    bool octants;    /* bb_layout_wish */
    bool greedy;     /* bb_layout_wish */
    float traversal; /* what leaf collapse takes a pair of children to cost */
    uint32_t leaf;   /* references that make() may gather in a leaf; 0: collapse has been there */
    const bb_buffer *array; /* the side array that the layout asks for; NULL if none */
    /* The object's last make() was of this tree, with the same links: its numbering is still in
     * scratch, and good; boxes and primitives are not. */
    bool same_links;
} bb_layout_source;

/* A tree in the form that a kernel reads, on the device. Lengths are those of the scene times
 * `scale`. Boxes are padded (kernels/ERROR_BUDGET.md). */
typedef struct bb_layout_data {
    uint32_t buffer_count;
    bb_buffer buffers[BB_LAYOUT_BUFFERS_MAX]; /* the kernel's first arguments, in this order */
    bb_u32 root;                              /* link to start from, as the kernel reads links */
    bb_prim_ends ends;                        /* of the scene's kinds */
    uint32_t kinds;                           /* of primitives that it is laid out for */
    bb_u32 format;                            /* of triangles: BB_FORMAT_... */
    uint32_t lanes;      /* primitives side by side in a record: the layout's `block`, or 1 */
    float scale;         /* the scene's */
    uint32_t stack_need; /* entries that an ordered traversal needs */
    uint32_t levels; /* inner nodes on the longest path, as the kernel sees them; an upper bound */
    uint64_t bytes;
    /* the nodes traced are the tree's own: its SAH is also the layout's; the row is native */
    bool keeps_shape;
    double sah;       /* of the layout as traced; NAN: not known here */
    bb_timing timing; /* of making it, leaf collapse included */
    char name[96];    /* as recorded: "pair", "pair:leaf=4", "pair:leaf=4,triangles=affine" */
} bb_layout_data;

typedef struct bb_layout {
    const char *name;
    const char *summary;
    uint32_t width;    /* most children of a node; 2 if there is no limit. Required */
    uint32_t block;    /* number of primitives that its kernels test at once. Required */
    uint32_t leaf_max; /* most references of a leaf: larger ones are divided; 0: any number */
    /* The side array of the tree that make() reads (bb_tree_reserve_array()): trees without one of
     * this name and format are refused. Optional. */
    struct {
        const char *name;
        bool per_reference;
        uint32_t stride;
    } array;
    /* Compiles and allocates what does not depend on a tree. Both outlive the object; all memory is
     * booked on `account`. If it fails, *self goes to destroy(), as it was set until then. */
    bb_status (*create)(bb_device *device, bb_account *account, void **self);
    /* Makes the layout of `source`, with triangles in data->format and lengths multiplied by
     * data->scale: sets buffers, root, stack_need, levels, keeps_shape, and lanes if they are
     * fewer than a block's; adds to data->bytes. May
     * enqueue and return. bb_layout_maker_make() does the rest. */
    bb_status (*make)(void *self, const bb_layout_source *source, bb_layout_data *data);
    /* Whether make() itself collapses the leaves of this tree, as source->leaf asks; else they are
     * collapsed already. Optional: never. */
    bool (*collapses)(const void *self, const bb_tree *tree);
    void (*destroy)(void *self); /* whatever create() made, even if it failed; NULL is allowed */
} bb_layout;

extern const bb_layout *const bb_layouts[];        /* generated; ends with NULL */
const bb_layout *bb_layout_find(const char *name); /* NULL if there is none */
/* The most that `leaf` may be. */
uint32_t bb_layout_leaf_max(const bb_layout *layout);
void bb_layout_data_release(bb_layout_data *data); /* a zeroed one is allowed */

/* A layout in use on a device. It must not be moved: the account is in it. */
typedef struct bb_layout_maker {
    const bb_layout *layout;
    bb_device *device;
    bb_account account; /* also of the layouts made, which are released first */
    void *self;
    bb_layout_wish wish;          /* zeroed: nothing; set after creation */
    struct bb_collapse *collapse; /* NULL until leaves are asked for */
    struct bb_reach *reach;       /* NULL until a tree needs it */
    /* What the last layout was made of, for bb_layout_maker_follow(). */
    uint64_t links; /* of the tree; 0: nothing to follow from */
    uint32_t leaf;
} bb_layout_maker;

/* Compiles what the layout needs on the device, which outlives the maker. After a failure the maker
 * is zeroed, and there is nothing to destroy. */
bb_status bb_layout_maker_create(const bb_layout *layout, bb_device *device,
                                 bb_layout_maker *maker);
void bb_layout_maker_destroy(bb_layout_maker *maker); /* a zeroed one is allowed */

/* Makes the layout of `tree` on the device, with leaves of up to `leaf` references (1: the tree's
 * own leaves) and triangles in `format` (BB_FORMAT_...). Waits for it, and times it. `data` may
 * hold an earlier layout, whose memory is reused. BB_INVALID for a `leaf` beyond
 * bb_layout_leaf_max(). */
bb_status bb_layout_maker_make(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                               uint32_t leaf, uint32_t format, bb_layout_data *data);

/* Brings `data`, the last that this maker made, up to date after an update of its tree: in place,
 * with the numbering and the shape of its nodes as they were, if only boxes of the tree have
 * changed; else makes it anew. `in_place` says which. Timed like a making. `leaf` and `format` are
 * those of that making. */
bb_status bb_layout_maker_follow(bb_layout_maker *maker, const bb_scene *scene, bb_tree *tree,
                                 uint32_t leaf, uint32_t format, bb_layout_data *data,
                                 bool *in_place);

/* An intersector: the tests of rays against triangles and boxes, and their rounding rules. A preset
 * of bb_intersector_options, each of which a specification may override: "exact:slab=sign". */
typedef struct bb_intersector {
    const char *name;
    const char *summary;
    char triangle[12], slab[8], contract[4];
} bb_intersector;

extern const bb_intersector
    bb_intersectors[]; /* from exact to careless; ends with name NULL; the first is the default */
extern const bb_option bb_intersector_options[]; /* the defaults are those of each preset */
const bb_intersector *bb_intersector_find(const char *name); /* NULL if there is none */

/* The preset that `text` names, with its options applied. BB_INVALID for an unknown name, option or
 * value. */
bb_status bb_intersector_parse(const char *text, bb_intersector *intersector);

/* The format of triangles that it reads: BB_FORMAT_... */
bb_u32 bb_intersector_format(const bb_intersector *intersector);

/* Whether it must never be wrong: then it counts for the exit status of `run`. */
bool bb_intersector_is_exact(const bb_intersector *intersector);

/* Its options as -D definitions for kernels/intersect.clh: less than 128 characters. */
void bb_intersector_defines(const bb_intersector *intersector, char *text, size_t capacity);

typedef struct bb_kernel {
    const char *name;
    const char *summary;
    const char *paper;
    const char *layout;  /* the layout that it reads */
    const char *source;  /* its file in kernels/ */
    const char *defines; /* -D for every variant; NULL: none */
    uint32_t queries;    /* those it answers: BB_ALONG_RAYS */
    bool ordered;        /* visits children near to far */
    /* Which of its variants are compared and tried where no kernel is named, on which devices.
     * NULL: none. */
    const bb_variants *variants;
    /* Its layout keeps the shape of any tree: by default it is compared on trees whose shape no
     * compared kernel keeps. */
    bool native;
    bool batched;   /* one work-item traces all rays of a group: gets their number as BB_BATCH */
    bool stackless; /* needs no stack of the tree's size: gets no BB_STACK_SIZE */
    /* Keeps a bit trail: gets BB_LEVELS, and refuses trees with more levels than this; 0: keeps
     * none. */
    uint32_t trail_max;
    /* Its own options: the value of `name` reaches the kernel as -DBB_NAME=value, so each must list
     * its `values`. Common to all kernels: `leaf`, `group`, `stack`, `kinds`, `plan`,
     * `node`, `persistent`. */
    const bb_option *options;
} bb_kernel;

extern const bb_kernel *const bb_kernels[];        /* generated; ends with NULL */
const bb_kernel *bb_kernel_find(const char *name); /* NULL if there is none */
/* The first whose layout takes leaves of any size, and so a tree of one leaf as it is. */
const bb_kernel *bb_kernel_for_any_leaf(void);
extern const bb_option bb_kernel_common_options[];
/* Whether all variants that are taken by default are for CPUs alone. */
bool bb_kernel_is_for_cpus(const bb_kernel *kernel);
/* Checks the parameters of a kernel's specification: its own options and the common ones.
 * BB_INVALID names the one that it does not take. */
bb_status bb_kernel_validate(const bb_kernel *kernel, const bb_spec *spec);
/* Its group, in rays: as given, or what the device allows of the default. BB_INVALID if what is
 * given is more than the device's groups have; those of a batched kernel are not the device's. */
bb_status bb_kernel_group_of(const bb_kernel *kernel, const bb_spec *spec, const bb_device *device,
                             uint64_t *group);
/* Whether both are of one layout. */
bool bb_layout_wish_is(const bb_layout_wish *a, const bb_layout_wish *b);
/* What the kernel's parameters ask for: for bb_layout_maker.wish. */
bb_layout_wish bb_kernel_wish(const bb_spec *spec);
/* The kernel that `text` names, and its specification, checked. BB_INVALID for an unknown name,
 * option or value. */
bb_status bb_kernel_parse(const char *text, bb_spec *spec, const bb_kernel **kernel);

/* A kernel compiled for an intersector, a query, and what a layout needs. */
typedef struct bb_tracer bb_tracer;

typedef struct bb_tracer_request {
    const bb_kernel *kernel;
    const bb_spec *spec;
    const bb_intersector *intersector;
    const bb_query *query;
    bool counting;       /* the variant that counts tests, and overflow */
    const char *defines; /* what the query needs besides; NULL: nothing */
} bb_tracer_request;

/* A tracer for layouts that need no more than this one: primitive kinds, stack entries (rounded up
 * to 16, 32, 64 ...), levels of a trail (64, 128, 256 ...). Taken from a cache of the device, so
 * that equal requests compile once; owned by the cache, until bb_tracers_clear(). BB_UNSUPPORTED if
 * the kernel does not answer the query, or not for these primitives, or if its trail is too short
 * for the tree; BB_REFUSED if the device has no room for a stack that is given (stack_room.h);
 * BB_FAILED if it does not compile, or its definitions are too long. */
bb_status bb_tracer_get(bb_device *device, const bb_tracer_request *request,
                        const bb_layout_data *layout, bb_tracer **tracer);
/* What was decided for such a tracer: stack, levels of the trail, kinds. */
bb_status bb_tracer_decide(const bb_device *device, const bb_tracer_request *request,
                           const bb_layout_data *layout, bb_decisions *decisions);
/* Releases all tracers of the device: before it is closed, and when nobody uses one any more. */
void bb_tracers_clear(bb_device *device);
/* Rays of a work-group: fewer than asked for if the device runs the compiled kernel in smaller ones
 * only. */
uint32_t bb_tracer_group_size(const bb_tracer *tracer);
uint32_t
bb_tracer_stack_size(const bb_tracer *tracer); /* 0: it needs no stack of the tree's size */
/* Private memory of a work-item: its stacks alone, and, if the driver tells, all of it. */
uint64_t bb_tracer_stack_bytes(const bb_tracer *tracer);
bool bb_tracer_private_bytes(const bb_tracer *tracer, uint64_t *bytes);
uint64_t bb_tracer_launched(const bb_tracer *tracer); /* rays, in all its launches */

/* Enqueues the traversal of rays[0..count); does not wait. The layout has the format of triangles
 * that the intersector reads. `counts` (bb_count[count]) only for counting tracers, else NULL.
 * `more`: arguments that the query's kernels take besides, at most BB_MORE_ARGS_MAX; may be NULL.
 */
bb_status bb_tracer_launch(bb_tracer *tracer, const bb_layout_data *layout, const bb_buffer *rays,
                           uint32_t count, bb_buffer *results, bb_buffer *counts,
                           const bb_arg *more, uint32_t more_count);

#endif
