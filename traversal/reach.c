/* Reach of nodes: host side of kernels/reach.cl. */
#include "traversal/reach.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_reach {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel parents_kernel, climb;
    bb_buffer parents; /* u32 per node */
    bb_buffer reach;   /* float per node */
};

static bb_status get_kernels(bb_reach *self)
{
    BB_TRY(bb_program_build(self->device, bb_source_find("reach.cl"), "", &self->program));
    BB_TRY(bb_kernel_get(self->program, "reach_parents", &self->parents_kernel));
    return bb_kernel_get(self->program, "reach_climb", &self->climb);
}

bb_status bb_reach_create(bb_device *device, bb_account *account, bb_reach **out)
{
    bb_reach *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    self->device = device;
    self->account = account;
    bb_status status = get_kernels(self);
    if (status != BB_OK) {
        bb_reach_destroy(self);
        return status;
    }
    *out = self;
    return BB_OK;
}

void bb_reach_destroy(bb_reach *self)
{
    if (self == NULL)
        return;
    bb_buffer_release(&self->parents);
    bb_buffer_release(&self->reach);
    bb_kernel_release(self->parents_kernel);
    bb_kernel_release(self->climb);
    bb_program_release(self->program);
    free(self);
}

bb_status bb_reach_make(bb_reach *self, const bb_scene *scene, const bb_tree *tree,
                        const bb_buffer **out)
{
    bb_device *device = self->device;
    uint32_t count = tree->info.node_count;
    size_t bytes = count * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "reach: parents", &self->parents));
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "reach of nodes", &self->reach));
    BB_TRY(bb_launch(device, self->parents_kernel, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_VALUE(tree->info.root), BB_MEM(self->parents),
                     BB_MEM(self->reach)));
    *out = &self->reach;
    return bb_launch(device, self->climb, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_MEM(scene->on_device.boxes), BB_VALUE(count),
                     BB_MEM(self->parents), BB_MEM(self->reach));
}
