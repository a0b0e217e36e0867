/* Host side of links.cl. */
#include "builders/common/links.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64, STATE_BYTES = 16, ROUNDS_MAX = 32 };

struct bb_links {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel start, jump, arity, write;
    bb_buffer states[2];
    bb_buffer changed;
};

static bb_status get_kernels(bb_links *links)
{
    BB_TRY(bb_program_build(links->device, bb_source_find("links.cl"), "", &links->program));
    BB_TRY(bb_kernel_get(links->program, "links_start", &links->start));
    BB_TRY(bb_kernel_get(links->program, "links_jump", &links->jump));
    BB_TRY(bb_kernel_get(links->program, "links_arity", &links->arity));
    return bb_kernel_get(links->program, "links_write", &links->write);
}

bb_status bb_links_create(bb_device *device, bb_account *account, bb_links **out)
{
    bb_links *links = calloc(1, sizeof *links);
    if (links == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    links->device = device;
    links->account = account;
    bb_status status = get_kernels(links);
    if (status == BB_OK)
        status = bb_buffer_reserve(device, account, sizeof(uint32_t), "links: whether they changed",
                                   &links->changed);
    if (status != BB_OK) {
        bb_links_destroy(links);
        return status;
    }
    *out = links;
    return BB_OK;
}

void bb_links_destroy(bb_links *links)
{
    if (links == NULL)
        return;
    bb_buffer_release(&links->states[0]);
    bb_buffer_release(&links->states[1]);
    bb_buffer_release(&links->changed);
    bb_kernel_release(links->start);
    bb_kernel_release(links->jump);
    bb_kernel_release(links->arity);
    bb_kernel_release(links->write);
    bb_program_release(links->program);
    free(links);
}

bb_status bb_links_reserve(bb_links *links, size_t nodes)
{
    for (int i = 0; i < 2; i++)
        BB_TRY(bb_buffer_reserve(links->device, links->account, nodes * STATE_BYTES,
                                 "links: states", &links->states[i]));
    return BB_OK;
}

/* Jumps until nothing changes; *last is the list that has the result. */
static bb_status jump(bb_links *links, uint32_t count, uint32_t *last)
{
    uint32_t changed = 1;
    *last = 0;
    for (uint32_t round = 0; round < ROUNDS_MAX && changed != 0; round++) {
        BB_TRY(bb_buffer_fill(&links->changed, sizeof changed, 0));
        BB_TRY(bb_launch(links->device, links->jump, count, GROUP_SIZE, BB_VALUE(count),
                         BB_MEM(links->states[*last]), BB_MEM(links->states[1 - *last]),
                         BB_MEM(links->changed)));
        BB_TRY(bb_buffer_read(&links->changed, 0, sizeof changed, &changed));
        *last = 1 - *last;
    }
    return BB_OK;
}

bb_status bb_links_finish_device(bb_links *links, const bb_tree_info *known, bb_tree *tree)
{
    bb_device *device = links->device;
    uint32_t count = known->node_count, last;
    const bb_tree_info info = {
        .root = known->root, .node_count = count, .ref_count = known->ref_count};
    BB_TRY(bb_links_reserve(links, count));
    BB_TRY(bb_buffer_write(&tree->d_info, 0, sizeof info, &info));
    BB_TRY(bb_launch(device, links->start, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_VALUE(known->root), BB_MEM(links->states[0])));
    BB_TRY(bb_launch(device, links->arity, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_MEM(tree->d_info)));
    BB_TRY(jump(links, count, &last));
    return bb_launch(device, links->write, count, GROUP_SIZE, BB_MEM(links->states[last]),
                     BB_VALUE(count), BB_MEM(tree->d_nodes), BB_MEM(tree->d_info));
}
