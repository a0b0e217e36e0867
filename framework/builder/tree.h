/* The common tree: one node format for all builders, of any arity (bb_node in kernels/bb_shared.h).
 *
 * The harness owns the tree. A builder reserves room, fills in nodes and references, on the host or
 * on the device, and describes the tree by bb_tree_info and the flags.
 */
#ifndef BB_TREE_H
#define BB_TREE_H

#include "framework/base/memory.h"
#include "framework/device/device.h"
#include "framework/scene/scene.h"
#include "kernels/bb_shared.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef enum bb_place { BB_ON_HOST, BB_ON_DEVICE } bb_place;

enum { BB_TREE_ARRAYS_MAX = 4 };

/* A named side array: data per node or per reference that a layout reads (boundary flags, offsets
 * ...). Its elements must not be indices of nodes or references, since these change when the tree
 * is renumbered. */
typedef struct bb_tree_array {
    const char *name;
    bool per_reference; /* else per node */
    uint32_t stride;    /* bytes per element, a multiple of 4 */
    bool current;       /* the tree has it; the next bb_tree_reserve() clears this */
    bb_buffer buffer;
    void *host;
    size_t host_bytes; /* room there */
} bb_tree_array;

typedef struct bb_tree {
    bb_account *account;      /* books what is reserved */
    bb_account *copy_account; /* books copies on the other side; NULL: not booked */
    bb_place place;           /* where the builder left it */
    bb_tree_info info;        /* on the device: valid after bb_tree_fetch_info() */
    bool duplicated;          /* a primitive may be referenced more than once */
    bool disjoint;            /* boxes of siblings share no volume */
    /* Wide layouts of at least its arity take nodes and leaves as they are, unless a kernel's
     * `plan` says otherwise. For builders that make wide nodes on purpose. */
    bool keep_nodes;

    bool copied; /* the other side holds an up-to-date copy */
    /* Changes whenever nodes or references are linked anew: two states with the same number differ
     * only in boxes. 0: there is no tree yet. */
    uint64_t links;
    bool refitted; /* bb_tree_boxes_changed() was called since the harness last checked */

    bb_node *nodes;       /* host side; NULL until reserved there or downloaded */
    uint32_t *refs;       /* primitive, with BB_LAST_BIT on the last of each leaf */
    size_t node_capacity; /* of the host arrays; the device's is in the buffers */
    size_t ref_capacity;

    bb_buffer d_info; /* one bb_tree_info */
    bb_buffer d_nodes;
    bb_buffer d_refs;

    uint32_t array_count;
    bb_tree_array arrays[BB_TREE_ARRAYS_MAX];
} bb_tree;

void bb_tree_init(bb_tree *tree, bb_account *account);
void bb_tree_release(bb_tree *tree); /* frees everything; the tree is then empty and may be used
                                      * again */

/* Reserves room for this many nodes and references at `place`, which becomes the tree's place.
 * Contents are lost if it grows; copies on the other side become stale, and side arrays must be
 * reserved again. On the device, d_info is reserved too. Booked on tree->account; refused if there
 * is not enough memory. A tree has at most 2^31 - 1 nodes and references. */
bb_status bb_tree_reserve(bb_tree *tree, bb_device *device, bb_place place, size_t nodes,
                          size_t refs);

/* Reserves room for a side array, one element for each node or reference that the tree has room
 * for, at the tree's place and on its account; the builder fills `host` or `buffer` of `*array`.
 * `name` is a string constant. Call it after each bb_tree_reserve(); memory is reused. BB_FAILED if
 * there is no tree, or there are already BB_TREE_ARRAYS_MAX others. */
bb_status bb_tree_reserve_array(bb_tree *tree, bb_device *device, const char *name,
                                bool per_reference, uint32_t stride, bb_tree_array **array);

/* Returns the tree's side array of that name; NULL if it has none. */
const bb_tree_array *bb_tree_find_array(const bb_tree *tree, const char *name);

/* Declares that nodes, references or side arrays were rewritten in place: a copy on the other side
 * becomes stale, and so does everything derived from the links. For update() hooks, and for builds
 * that do not reserve. */
void bb_tree_changed(bb_tree *tree);

/* The same if only boxes of nodes were rewritten: everything derived from the links stays valid, so
 * layouts need not be numbered anew. An update() that declares nothing is assumed to have changed
 * everything. */
void bb_tree_boxes_changed(bb_tree *tree);

/* Reads d_info of a tree built on the device; BB_FAILED if it claims more nodes or references than
 * there is room for. Does nothing for a tree on the host. */
bb_status bb_tree_fetch_info(bb_tree *tree);

/* Copies device -> host and host -> device, including side arrays; `ms` gets the wall time (may be
 * NULL). They do nothing if the copy is up to date. Booked on tree->copy_account. */
bb_status bb_tree_download(bb_tree *tree, double *ms);
bb_status bb_tree_upload(bb_tree *tree, bb_device *device, double *ms);

/* Frees the copy on the other side, if there is one. */
void bb_tree_drop_copy(bb_tree *tree);
/* Moves the copy on the host out of a tree on the device, which is not booked there: `*out` becomes
 * a tree on the host. */
void bb_tree_take_copy(bb_tree *tree, bb_tree *out);

/* Copies `from` to `to`, for optimisers that leave a tree unchanged: nodes, references, info and
 * flags. Both are on the device, from->info has been fetched, and `to` has room. Side arrays are
 * not copied. */
bb_status bb_tree_copy(const bb_tree *from, bb_tree *to);

/* Returns the bytes of the nodes, references and side arrays in use. */
uint64_t bb_tree_bytes(const bb_tree *tree);

/* ---- on the host side (downloaded or built there) ---- */

static inline bool bb_node_is_leaf(const bb_node *node)
{
    return (node->first & BB_LEAF_BIT) != 0;
}

/* Ct (per pair of children) and Ci (per reference) in all costs. */
#define BB_COST_TRAVERSAL 1.2
#define BB_COST_INTERSECTION 1.0

/* Returns half the surface area of a box; 0 if it is flat on two axes. */
static inline double bb_half_area(const float lo[3], const float hi[3])
{
    double x = (double)hi[0] - lo[0], y = (double)hi[1] - lo[1], z = (double)hi[2] - lo[2];
    return x * y + y * z + z * x;
}

/* The functions below need the tree on the host (built there or downloaded), and fail with a
 * message if it is not there, or if its links are corrupt. */

/* Renumbers into preorder: nodes 0, 1, 2 ... as visited by first/skip, references in the order of
 * the leaves, side arrays with them. `out` is another tree, initialised; it ends up on the host.
 * Two equal trees give equal bytes. */
bb_status bb_tree_preorder(const bb_tree *tree, bb_tree *out);

/* Computes the XXH3 hash of the preorder form, including side arrays. */
bb_status bb_tree_hash(const bb_tree *tree, uint64_t *hash);

/* Checks everything that "The common tree" in framework/README.md requires; BB_FAILED describes the
 * first violation, with node and primitive numbers. Never loops forever or reads out of bounds on a
 * corrupt tree. */
bb_status bb_tree_check(const bb_tree *tree, const bb_scene *scene);

/* Surface area heuristic, Ct = 1.2, Ci = 1 (metric_sah.c has the definition; further
 * metrics: metric.h); NAN if the root's area is 0 or the links are corrupt. */
double bb_tree_sah(const bb_tree *tree);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
