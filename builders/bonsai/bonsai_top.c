/* Host side of bonsai_top.cl. */
#include "bonsai_top.h"

#include "framework/base/arithmetic.h"

#include <stdio.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(bonsai_top);

enum {
    GROUP_SIZE = 64,
    TOP_GROUP_SIZE = 256,
    REST_GROUPS = 64, /* work-groups of the second launch */
    REST_LEAST = 256, /* see rest_of(): fewer items are not worth the second launch */
    AXIS_BITS = 34,   /* of a sort key: a centroid and its axis */
};

struct bn_top {
    bb_device *device;
    bb_account *account;
    bool by_prims;
    uint32_t group; /* work-items that share a node */
    cl_program program;
    cl_kernel items_kernel, top_kernel, rest_kernel;
    bb_buffer boxes, keys, sort_keys, orders, right, spans, splits, weights, tasks, waiting;
};

static bb_status get_kernels(bn_top *top)
{
    char defines[32];
    snprintf(defines, sizeof defines, "-DBN_LANES=%u", top->group);
    BB_TRY(bb_program_build(top->device, &bb_source_bonsai_top, defines, &top->program));
    BB_TRY(bb_kernel_get(top->program, "bn_items", &top->items_kernel));
    BB_TRY(bb_kernel_get(top->program, "bn_top", &top->top_kernel));
    return bb_kernel_get(top->program, "bn_rest", &top->rest_kernel);
}

bb_status bn_top_create(bb_device *device, bb_account *account, bool by_prims, bn_top **out)
{
    bn_top *top = calloc(1, sizeof *top);
    if (top == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    top->device = device;
    top->account = account;
    top->by_prims = by_prims;
    top->group = bb_cpu_form(device)                       ? 1
                 : device->max_group_size < TOP_GROUP_SIZE ? GROUP_SIZE
                                                           : TOP_GROUP_SIZE;
    bb_status status = get_kernels(top);
    if (status != BB_OK) {
        bn_top_destroy(top);
        return status;
    }
    *out = top;
    return BB_OK;
}

void bn_top_destroy(bn_top *top)
{
    if (top == NULL)
        return;
    bb_buffer *const buffers[] = {&top->boxes, &top->keys,   &top->sort_keys, &top->orders,
                                  &top->right, &top->spans,  &top->splits,    &top->weights,
                                  &top->tasks, &top->waiting};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    bb_kernel_release(top->items_kernel);
    bb_kernel_release(top->top_kernel);
    bb_kernel_release(top->rest_kernel);
    bb_program_release(top->program);
    free(top);
}

bb_status bn_top_reserve(bn_top *top, uint32_t items)
{
    const size_t n = items;
    const struct {
        bb_buffer *buffer;
        size_t bytes;
        const char *what;
    } wanted[] = {
        {&top->boxes, n * sizeof(cl_float8), "bonsai: boxes of the top tree"},
        {&top->keys, 3 * n * sizeof(uint32_t), "bonsai: centroids of the top tree"},
        {&top->sort_keys, 3 * n * sizeof(uint64_t), "bonsai: sort keys of the top tree"},
        {&top->orders, 6 * n * sizeof(uint32_t), "bonsai: orders of the top tree"},
        {&top->right, n * sizeof(cl_float4), "bonsai: costs of the top tree"},
        {&top->spans, 2 * n * sizeof(bn_top_span), "bonsai: nodes of the top tree"},
        {&top->splits, n * sizeof(bn_split), "bonsai: splits of the top tree"},
        {&top->weights, n * sizeof(uint32_t), "bonsai: weights of the top tree"},
        {&top->tasks, BN_SPANS(n) * sizeof(bn_task), "bonsai: tasks of the top tree"},
        {&top->waiting, sizeof(uint32_t), "bonsai: tasks of the top tree"},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++)
        BB_TRY(bb_buffer_reserve(top->device, top->account, wanted[i].bytes, wanted[i].what,
                                 wanted[i].buffer));
    return BB_OK;
}

static bb_status gather(bn_top *top, const bn_leaves *leaves, bb_tree *tree)
{
    const uint32_t prims_weigh = top->by_prims;
    return bb_launch(top->device, top->items_kernel, leaves->count, GROUP_SIZE,
                     BB_MEM(*leaves->items), BB_VALUE(leaves->count), BB_VALUE(leaves->refs),
                     BB_VALUE(prims_weigh), BB_MEM(top->boxes), BB_MEM(top->keys),
                     BB_MEM(top->sort_keys), BB_MEM(top->orders), BB_MEM(top->weights),
                     BB_MEM(tree->d_info), BB_MEM(top->waiting));
}

/* Returns the largest node, in items, that the first launch leaves to the second. */
static uint32_t rest_of(uint32_t items)
{
    return bb_max_u32(items / REST_GROUPS, REST_LEAST);
}

bb_status bn_top_make(bn_top *top, bb_primitives *primitives, const bn_leaves *leaves,
                      bb_tree *tree)
{
    bb_device *device = top->device;
    const uint32_t most = rest_of(leaves->count);
    const size_t group = top->group;
    BB_TRY(gather(top, leaves, tree));
    BB_TRY(bb_sort_u64(primitives, &top->sort_keys, &top->orders, 3 * leaves->count, AXIS_BITS));
#define TOP_BUFFERS                                                                                \
    BB_MEM(*leaves->items), BB_VALUE(leaves->count), BB_VALUE(leaves->refs),                       \
        BB_VALUE(leaves->unit), BB_MEM(top->boxes), BB_MEM(top->keys), BB_MEM(top->orders),        \
        BB_MEM(top->right), BB_MEM(top->spans), BB_MEM(top->splits), BB_MEM(top->weights),         \
        BB_MEM(*leaves->levels), BB_MEM(tree->d_nodes), BB_MEM(tree->d_info), BB_MEM(top->tasks),  \
        BB_MEM(top->waiting)
    BB_TRY(bb_launch(device, top->top_kernel, group, group, TOP_BUFFERS, BB_VALUE(most)));
    return bb_launch(device, top->rest_kernel, REST_GROUPS * group, group, TOP_BUFFERS);
#undef TOP_BUFFERS
}
