/* median: halves the primitives at their median along the longest axis of their centroids, on the
 * host; the centroids come from the device. An example of a builder outside of bvhbench's tree.
 *
 *   take a range off the stack, make its node; stop at one primitive
 *   sort the range by (centroid on the longest axis, index); push the right half, then the left
 *
 * A subtree of k primitives has 2k - 1 nodes, so links are known as soon as a node is made.
 */
#include "framework/builder/builder.h"

#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(median);

enum { GROUP_SIZE = 64, STACK_MAX = 64 };

typedef struct median {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel kernel;
    bb_buffer d_centroids;
    float *centroids; /* x y z per primitive */
    uint32_t *order;  /* primitives in the order of the leaves */
    uint64_t *keys;   /* to sort by: centroid, index */
} median;

static void destroy(void *opaque)
{
    median *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->d_centroids);
    bb_host_free(self->centroids);
    bb_host_free(self->order);
    bb_host_free(self->keys);
    bb_kernel_release(self->kernel);
    bb_program_release(self->program);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    median *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "median: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->device = context->device;
    self->account = context->account;
    BB_TRY(bb_program_build(self->device, &bb_source_median, "", &self->program));
    return bb_kernel_get(self->program, "median_centroids", &self->kernel);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    median *self = opaque;
    size_t count = scene->prim_count;
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_HOST, 2 * count - 1, count));
    BB_TRY(bb_buffer_reserve(self->device, self->account, 3 * count * sizeof(float),
                             "median: centroids", &self->d_centroids));
    BB_TRY(bb_host_alloc(self->account, 3 * count * sizeof(float), "median: centroids",
                         &self->centroids));
    BB_TRY(bb_host_alloc(self->account, count * sizeof(uint32_t), "median: order", &self->order));
    return bb_host_alloc(self->account, count * sizeof(uint64_t), "median: keys", &self->keys);
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* An integer that sorts like the float. */
static uint64_t sortable(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & 0x80000000u ? (uint32_t)~bits : bits | 0x80000000u;
}

static int longest_axis(const median *self, uint32_t begin, uint32_t end)
{
    int longest = 0;
    float extent = -1.0f;
    for (int axis = 0; axis < 3; axis++) {
        float lo = self->centroids[3 * (size_t)self->order[begin] + axis], hi = lo;
        for (uint32_t i = begin + 1; i < end; i++) {
            float c = self->centroids[3 * (size_t)self->order[i] + axis];
            lo = c < lo ? c : lo;
            hi = c > hi ? c : hi;
        }
        if (0.5f * hi - 0.5f * lo > extent) {
            extent = 0.5f * hi - 0.5f * lo;
            longest = axis;
        }
    }
    return longest;
}

static void sort_range(median *self, uint32_t begin, uint32_t end)
{
    int axis = longest_axis(self, begin, end);
    for (uint32_t i = begin; i < end; i++) {
        uint32_t prim = self->order[i];
        self->keys[i] = sortable(self->centroids[3 * (size_t)prim + axis]) << 32 | prim;
    }
    qsort(self->keys + begin, end - begin, sizeof *self->keys, compare_keys);
    for (uint32_t i = begin; i < end; i++)
        self->order[i] = (uint32_t)self->keys[i];
}

typedef struct range {
    uint32_t begin, end, node, skip, depth;
} range;

static void build_nodes(median *self, const bb_scene *scene, bb_tree *tree)
{
    range stack[STACK_MAX] = {{0, scene->prim_count, 0, BB_NONE, 0}}; /* halving: 32 deep at most */
    for (uint32_t top = 1; top > 0;) {
        range r = stack[--top];
        bb_node *node = &tree->nodes[r.node];
        const bb_box *first = &scene->boxes[self->order[r.begin]];
        memcpy(node->lo, first->lo, sizeof node->lo);
        memcpy(node->hi, first->hi, sizeof node->hi);
        for (uint32_t i = r.begin + 1; i < r.end; i++)
            for (int axis = 0; axis < 3; axis++) {
                const bb_box *box = &scene->boxes[self->order[i]];
                node->lo[axis] = box->lo[axis] < node->lo[axis] ? box->lo[axis] : node->lo[axis];
                node->hi[axis] = box->hi[axis] > node->hi[axis] ? box->hi[axis] : node->hi[axis];
            }
        node->skip = r.skip;
        if (r.end - r.begin == 1) {
            node->first = BB_LEAF_BIT | r.begin;
            tree->refs[r.begin] = self->order[r.begin] | BB_LAST_BIT;
            tree->info.depth = r.depth > tree->info.depth ? r.depth : tree->info.depth;
            continue;
        }
        sort_range(self, r.begin, r.end);
        uint32_t middle = r.begin + (r.end - r.begin) / 2;
        uint32_t left = r.node + 1, right = r.node + 2 * (middle - r.begin);
        node->first = left;
        stack[top++] = (range){middle, r.end, right, r.skip, r.depth + 1};
        stack[top++] = (range){r.begin, middle, left, right, r.depth + 1};
    }
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    median *self = opaque;
    uint32_t count = scene->prim_count;
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_HOST, 2 * (size_t)count - 1, count));

    BB_TRY(bb_phase(phases, "centroids"));
    BB_TRY(bb_launch(self->device, self->kernel, count, GROUP_SIZE, BB_MEM(scene->on_device.boxes),
                     BB_VALUE(count), BB_MEM(self->d_centroids)));
    BB_TRY(
        bb_buffer_read(&self->d_centroids, 0, 3 * (size_t)count * sizeof(float), self->centroids));
    BB_TRY(bb_phase(phases, "split"));
    for (uint32_t i = 0; i < count; i++)
        self->order[i] = i;
    tree->info = (bb_tree_info){.node_count = 2 * count - 1,
                                .leaf_count = count,
                                .ref_count = count,
                                .arity = count > 1 ? 2 : 0};
    build_nodes(self, scene, tree);
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_median = {
    .abi_version = BB_ABI_VERSION,
    .name = "median",
    .summary = "object median along the longest axis; an example plug-in",
    .paper = "none",
    .kinds = BB_TRIANGLES | BB_SPHERES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .create = create,
    .prepare = prepare,
    .build = build,
    .destroy = destroy,
};
