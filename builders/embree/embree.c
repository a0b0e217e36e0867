/* Embree's builders (Embree 3 or 4), called through rtcBuildBVH, as an ordinary plug-in.
 *
 *   phase rtcBuildBVH: Embree builds a binary tree, with nodes from its thread-local allocator
 *       quality=low:    Morton codes
 *       quality=medium: binned SAH (Wald 2007)
 *       quality=high:   binned SAH with spatial splits by split_primitive() (Stich, Friedrich,
 *                       Dietrich: Spatial Splits in Bounding Volume Hierarchies, 2009)
 *   phase convert: preorder walk into the common tree; boxes are unions of the leaves' boxes, which
 *       Embree passes to its callbacks
 *
 * rtcBuildBVH permutes its input, so the harness restores it outside the clock. The depth limit is
 * raised: at the default of 32 the Morton builder returns no tree for large scenes, and only the
 * device's error says so.
 */
#include "builders/common/links.h"
#include "framework/builder/builder.h"

#include "framework/judge/embree_api.h"
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct embree {
    bb_builder_context context;
    enum RTCBuildQuality quality;
    uint32_t leaf, block, depth;
    double room; /* size of the input array, in primitives of the scene: leaves room for splits */
    RTCDevice device;
    RTCBVH bvh;
    struct RTCBuildPrimitive *input;
    size_t capacity;
    bool fresh; /* `input` has the scene's primitives in their order */
    const bb_scene *scene;
    _Atomic int error; /* first error that Embree reported since the last check */
    char text[200];
} embree;

static const bb_option options[] = {
    {"quality", "medium", "low|medium|high",
     "Morton codes, binned SAH, or SAH with spatial splits"},
    {"leaf", "1", NULL, "most primitives per leaf, 1 to 32"},
    {"sah-block-size", "1", NULL, "leaf cost counts blocks of this many primitives, 1 to 32"},
    {"splits", "1.2", NULL, "quality=high: most references per primitive of the scene, 1 to 8"},
    {"depth", "512", NULL, "deepest tree allowed, 32 to 2048"},
    {NULL, NULL, NULL, NULL},
};

/* ---- Embree's own tree ---- */

/* A node of Embree's tree, made by the callbacks: a leaf has primitives, an inner node two
 * children. */
typedef struct node {
    uint32_t count; /* number of primitives; 0: inner node */
    union {
        struct node *children[2];
        struct RTCBuildPrimitive *prims;
    } of;
} node;

static void *create_node(RTCThreadLocalAllocator allocator, unsigned int count, void *user)
{
    (void)count;
    (void)user;
    node *made = rtcThreadLocalAlloc(allocator, sizeof *made, 16);
    made->count = 0;
    return made;
}

static void set_children(void *pointer, void **children, unsigned int count, void *user)
{
    (void)user;
    node *parent = pointer;
    for (unsigned int i = 0; i < count && i < 2; i++)
        parent->of.children[i] = children[i];
}

/* Ignored: inner boxes are computed from the leaves, as exact unions in float. */
static void set_bounds(void *pointer, const struct RTCBounds **bounds, unsigned int count,
                       void *user)
{
    (void)pointer;
    (void)bounds;
    (void)count;
    (void)user;
}

static void *create_leaf(RTCThreadLocalAllocator allocator, const struct RTCBuildPrimitive *prims,
                         size_t count, void *user)
{
    (void)user;
    node *leaf = rtcThreadLocalAlloc(allocator, sizeof *leaf, 16);
    leaf->count = (uint32_t)count;
    leaf->of.prims = rtcThreadLocalAlloc(allocator, count * sizeof *prims, 32);
    memcpy(leaf->of.prims, prims, count * sizeof *prims);
    return leaf;
}

/* ---- spatial splits ---- */

static void include(struct RTCBounds *bounds, const float lo[3], const float hi[3])
{
    bounds->lower_x = fminf(bounds->lower_x, lo[0]);
    bounds->lower_y = fminf(bounds->lower_y, lo[1]);
    bounds->lower_z = fminf(bounds->lower_z, lo[2]);
    bounds->upper_x = fmaxf(bounds->upper_x, hi[0]);
    bounds->upper_y = fmaxf(bounds->upper_y, hi[1]);
    bounds->upper_z = fmaxf(bounds->upper_z, hi[2]);
}

static float round_down(double x)
{
    float y = (float)x;
    return (double)y > x ? nextafterf(y, -INFINITY) : y;
}

static float round_up(double x)
{
    float y = (float)x;
    return (double)y < x ? nextafterf(y, INFINITY) : y;
}

/* Computes where the edge a b crosses the plane, as a box that contains the exact point: the
 * interpolation in double is off by less than 2^-48 of the larger coordinate. */
static void cross_plane(const float a[3], const float b[3], unsigned int axis, float plane,
                        float lo[3], float hi[3])
{
    double s = ((double)plane - a[axis]) / ((double)b[axis] - a[axis]);
    for (unsigned int k = 0; k < 3; k++) {
        double at = (double)a[k] + s * ((double)b[k] - (double)a[k]);
        double error = 0x1p-48 * fmax(fabs((double)a[k]), fabs((double)b[k]));
        lo[k] = round_down(at - error);
        hi[k] = round_up(at + error);
    }
    lo[axis] = hi[axis] = plane;
}

/* Computes the boxes of a triangle's parts on both sides of a plane. */
static void split_triangle(const bb_scene *scene, uint32_t triangle, unsigned int axis, float plane,
                           struct RTCBounds *left, struct RTCBounds *right)
{
    for (uint32_t corner = 0; corner < 3; corner++) {
        const float *a = bb_scene_vertex(scene, triangle, corner),
                    *b = bb_scene_vertex(scene, triangle, (corner + 1) % 3);
        if (a[axis] <= plane)
            include(left, a, a);
        if (a[axis] >= plane)
            include(right, a, a);
        if ((a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane)) {
            float lo[3], hi[3];
            cross_plane(a, b, axis, plane, lo, hi);
            include(left, lo, hi);
            include(right, lo, hi);
        }
    }
}

static void whole(struct RTCBounds *bounds, float lower, float upper)
{
    *bounds = (struct RTCBounds){.lower_x = lower,
                                 .lower_y = lower,
                                 .lower_z = lower,
                                 .upper_x = upper,
                                 .upper_y = upper,
                                 .upper_z = upper};
}

/* Clips `side` to the primitive's current box and to [low, high] on the axis. */
static void clip(struct RTCBounds *side, const struct RTCBuildPrimitive *prim, unsigned int axis,
                 float low, float high)
{
    float lo[3] = {fmaxf(side->lower_x, prim->lower_x), fmaxf(side->lower_y, prim->lower_y),
                   fmaxf(side->lower_z, prim->lower_z)};
    float hi[3] = {fminf(side->upper_x, prim->upper_x), fminf(side->upper_y, prim->upper_y),
                   fminf(side->upper_z, prim->upper_z)};
    lo[axis] = fmaxf(lo[axis], low);
    hi[axis] = fminf(hi[axis], high);
    if (lo[0] > hi[0] || lo[1] > hi[1] || lo[2] > hi[2]) {
        /* No part of the primitive is on this side, but Embree wants a box: the smallest, on the
         * plane. */
        const float at[3] = {prim->lower_x, prim->lower_y, prim->lower_z};
        memcpy(lo, at, sizeof lo);
        lo[axis] = low > lo[axis] ? low : fminf(high, lo[axis]);
        memcpy(hi, lo, sizeof hi);
    }
    side->lower_x = lo[0];
    side->lower_y = lo[1];
    side->lower_z = lo[2];
    side->upper_x = hi[0];
    side->upper_y = hi[1];
    side->upper_z = hi[2];
}

/* Splits a primitive by Embree's plane: triangles are clipped, other kinds get halves of their
 * box. */
static void split_primitive(const struct RTCBuildPrimitive *prim, unsigned int axis, float plane,
                            struct RTCBounds *left, struct RTCBounds *right, void *user)
{
    const bb_scene *scene = ((const embree *)user)->scene;
    if (prim->primID < scene->prims[BB_TRIANGLE].count) {
        whole(left, INFINITY, -INFINITY);
        whole(right, INFINITY, -INFINITY);
        split_triangle(scene, prim->primID, axis, plane, left, right);
    } else {
        whole(left, -INFINITY, INFINITY);
        whole(right, -INFINITY, INFINITY);
    }
    clip(left, prim, axis, -INFINITY, plane);
    clip(right, prim, axis, plane, INFINITY);
}

/* ---- conversion ---- */

typedef struct converter {
    bb_tree *tree;
    uint32_t nodes, refs, depth;
} converter;

static void add_box(bb_node *node, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        node->lo[k] = lo[k] < node->lo[k] ? lo[k] : node->lo[k];
        node->hi[k] = hi[k] > node->hi[k] ? hi[k] : node->hi[k];
    }
}

/* Writes a leaf's primitives in the order of their numbers, since Embree's threads may leave them
 * in any order. A split primitive may come twice into one leaf and is listed once. */
static void convert_leaf(converter *to, const node *leaf, bb_node *out)
{
    uint32_t first = to->refs, *refs = to->tree->refs;
    for (uint32_t i = 0; i < leaf->count; i++) {
        const struct RTCBuildPrimitive *prim = &leaf->of.prims[i];
        const float lo[3] = {prim->lower_x, prim->lower_y, prim->lower_z};
        const float hi[3] = {prim->upper_x, prim->upper_y, prim->upper_z};
        add_box(out, lo, hi);
        uint32_t at = to->refs;
        while (at > first && refs[at - 1] > prim->primID)
            at--;
        if (at > first && refs[at - 1] == prim->primID)
            continue;
        memmove(refs + at + 1, refs + at, (to->refs - at) * sizeof *refs);
        refs[at] = prim->primID;
        to->refs++;
    }
    refs[to->refs - 1] |= BB_LAST_BIT;
    out->first = BB_LEAF_BIT | first;
}

/* Converts in preorder and links each child to its sibling. The recursion is as deep as the tree,
 * which the option `depth` bounds. */
static void convert(converter *to, const node *from, uint32_t depth)
{
    bb_node *nodes = to->tree->nodes, *out = &nodes[to->nodes++];
    for (int k = 0; k < 3; k++) {
        out->lo[k] = INFINITY;
        out->hi[k] = -INFINITY;
    }
    out->skip = BB_NONE;
    to->depth = depth > to->depth ? depth : to->depth;
    if (from->count > 0) {
        convert_leaf(to, from, out);
        return;
    }
    out->first = to->nodes;
    for (int i = 0; i < 2; i++) {
        bb_node *child = &nodes[to->nodes];
        if (i > 0)
            nodes[out->first].skip = to->nodes;
        convert(to, from->of.children[i], depth + 1);
        add_box(out, child->lo, child->hi);
    }
}

/* ---- hooks ---- */

static bool book(void *user, ssize_t bytes, bool post)
{
    bb_account *account = user;
    if (!bb_host_follow(bytes, post, "Embree"))
        return false;
    if (bytes > 0)
        bb_account_add(account, (uint64_t)bytes);
    else
        bb_account_subtract(account, (uint64_t)-bytes);
    return true;
}

static void keep_error(void *user, enum RTCError code, const char *text)
{
    embree *self = user;
    int none = RTC_ERROR_NONE;
    if (atomic_compare_exchange_strong(&self->error, &none, (int)code))
        snprintf(self->text, sizeof self->text, "%s", text != NULL ? text : "no text");
}

static void destroy(void *pointer)
{
    embree *self = pointer;
    if (self->bvh != NULL)
        rtcReleaseBVH(self->bvh);
    if (self->device != NULL)
        rtcReleaseDevice(self->device);
    bb_host_free(self->input);
    free(self);
}

static bb_status read_options(embree *self)
{
    const bb_spec *spec = self->context.spec;
    uint64_t leaf, block, depth;
    BB_TRY(bb_spec_u64(spec, options, "leaf", 1, RTC_BUILD_MAX_PRIMITIVES_PER_LEAF, &leaf));
    BB_TRY(bb_spec_u64(spec, options, "sah-block-size", 1, 32, &block));
    BB_TRY(bb_spec_u64(spec, options, "depth", 32, 2048, &depth));
    BB_TRY(bb_spec_double(spec, options, "splits", 1.0, 8.0, &self->room));
    self->quality = bb_spec_is(spec, options, "quality", "low")    ? RTC_BUILD_QUALITY_LOW
                    : bb_spec_is(spec, options, "quality", "high") ? RTC_BUILD_QUALITY_HIGH
                                                                   : RTC_BUILD_QUALITY_MEDIUM;
    if (self->quality != RTC_BUILD_QUALITY_HIGH)
        self->room = 1.0;
    self->leaf = (uint32_t)leaf;
    self->block = (uint32_t)block;
    self->depth = (uint32_t)depth;
    return BB_OK;
}

static bb_status open_device(embree *self)
{
    char config[64];
    snprintf(config, sizeof config, "threads=%u,set_affinity=0", self->context.threads);
    self->device = rtcNewDevice(config);
    if (self->device == NULL)
        return bb_fail(BB_FAILED,
                       "builder embree: no Embree device (error %d): check the installation of "
                       "Embree",
                       (int)rtcGetDeviceError(NULL));
    rtcSetDeviceErrorFunction(self->device, keep_error, self);
    rtcSetDeviceMemoryMonitorFunction(self->device, book, self->context.account);
    self->bvh = rtcNewBVH(self->device);
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    embree *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_REFUSED, "builder embree: the host refused its memory");
    self->context = *context;
    bb_status status = read_options(self);
    if (status == BB_OK)
        status = open_device(self);
    if (status != BB_OK) {
        destroy(self);
        return status;
    }
    *out = self;
    return BB_OK;
}

static bb_status restore(void *pointer, const bb_scene *scene)
{
    embree *self = pointer;
    size_t capacity = (size_t)(self->room * scene->prim_count);
    if (self->capacity < capacity || self->input == NULL) {
        self->capacity = 0;
        BB_TRY(bb_host_alloc(self->context.account, capacity * sizeof *self->input,
                             "input of Embree's builder", &self->input));
        self->capacity = capacity;
    }
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        const bb_box *box = &scene->boxes[i];
        self->input[i] = (struct RTCBuildPrimitive){.lower_x = box->lo[0],
                                                    .lower_y = box->lo[1],
                                                    .lower_z = box->lo[2],
                                                    .upper_x = box->hi[0],
                                                    .upper_y = box->hi[1],
                                                    .upper_z = box->hi[2],
                                                    .geomID = 0,
                                                    .primID = i};
    }
    self->scene = scene;
    self->fresh = true;
    return BB_OK;
}

static bb_status prepare(void *pointer, const bb_scene *scene, bb_tree *tree)
{
    embree *self = pointer;
    BB_TRY(restore(self, scene));
    size_t refs = (size_t)(self->room * scene->prim_count);
    return bb_tree_reserve(tree, self->context.device, BB_ON_HOST, 2 * refs - 1, refs);
}

static bb_status run_embree(embree *self, const bb_scene *scene, node **root)
{
    struct RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.buildQuality = self->quality;
    arguments.maxBranchingFactor = 2;
    arguments.maxDepth = self->depth;
    arguments.sahBlockSize = self->block;
    arguments.minLeafSize = 1;
    arguments.maxLeafSize = self->leaf;
    arguments.traversalCost = 1.2f; /* the same constants as in `sah` */
    arguments.intersectionCost = 1.0f;
    arguments.bvh = self->bvh;
    arguments.primitives = self->input;
    arguments.primitiveCount = scene->prim_count;
    arguments.primitiveArrayCapacity = (size_t)(self->room * scene->prim_count);
    arguments.createNode = create_node;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = set_bounds;
    arguments.createLeaf = create_leaf;
    arguments.splitPrimitive = self->quality == RTC_BUILD_QUALITY_HIGH ? split_primitive : NULL;
    arguments.userPtr = self;
    *root = rtcBuildBVH(&arguments);
    int code = atomic_exchange(&self->error, RTC_ERROR_NONE);
    if (code == RTC_ERROR_NONE && *root != NULL)
        return BB_OK;
    return bb_fail(code == RTC_ERROR_OUT_OF_MEMORY ? BB_REFUSED : BB_FAILED,
                   "builder embree: rtcBuildBVH gave no tree of scene '%s' (%u primitives): %s "
                   "(error %d); option depth is %u",
                   scene->name, scene->prim_count, code != RTC_ERROR_NONE ? self->text : "no error",
                   code, self->depth);
}

static bb_status build(void *pointer, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    embree *self = pointer;
    if (!self->fresh || self->scene != scene)
        BB_TRY(restore(self, scene));
    self->fresh = false;
    size_t refs = (size_t)(self->room * scene->prim_count);
    BB_TRY(bb_tree_reserve(tree, self->context.device, BB_ON_HOST, 2 * refs - 1, refs));
    node *root = NULL;
    BB_TRY(bb_phase(phases, "rtcBuildBVH"));
    BB_TRY(run_embree(self, scene, &root));
    BB_TRY(bb_phase_outside(phases, "convert"));
    converter to = {.tree = tree};
    convert(&to, root, 0);
    tree->info = (bb_tree_info){.node_count = to.nodes, .ref_count = to.refs, .depth = to.depth};
    BB_TRY(bb_links_finish(tree, NULL));
    tree->duplicated = self->quality == RTC_BUILD_QUALITY_HIGH;
    tree->disjoint = false;
    return bb_phase(phases, NULL);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "embree:quality=low,embree:quality=medium"},
    {0},
};

const bb_builder bb_builder_embree = {
    .abi_version = BB_ABI_VERSION,
    .name = "embree",
    .summary = "Embree's builders (rtcBuildBVH): Morton, binned SAH, SAH with spatial splits",
    .paper = "Wald et al., Embree: A Kernel Framework for Efficient CPU Ray Tracing, 2014",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_GEOMETRY,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .prepare = prepare,
    .build = build,
    .restore = restore,
    .destroy = destroy,
};
