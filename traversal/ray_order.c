#include "traversal/ray_order.h"

#include "framework/device/primitives.h"
#include "kernels/ray_order_shared.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_ray_order {
    bb_ray_order *next;
    bb_device *device;
    bb_primitives *primitives;
    cl_program program;
    cl_kernel get_keys;
    bb_buffer keys, ids; /* u32 per ray */
    const void *whose;   /* whoever may take the order; NULL: it is taken, or there is none */
    uint32_t count;      /* rays of the last order */
};

static bb_ray_order *all;

static bb_status start(bb_ray_order *self)
{
    BB_TRY(bb_program_build(self->device, bb_source_find("ray_order.cl"), "", &self->program));
    BB_TRY(bb_kernel_get(self->program, "ray_order_keys", &self->get_keys));
    return bb_primitives_create(self->device, NULL, &self->primitives);
}

static void release(bb_ray_order *self)
{
    bb_buffer_release(&self->keys);
    bb_buffer_release(&self->ids);
    bb_primitives_destroy(self->primitives);
    bb_kernel_release(self->get_keys);
    bb_program_release(self->program);
    free(self);
}

bb_status bb_ray_order_of(bb_device *device, bb_ray_order **out)
{
    for (*out = all; *out != NULL && (*out)->device != device;)
        *out = (*out)->next;
    if (*out != NULL)
        return BB_OK;
    bb_ray_order *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    self->device = device;
    bb_status status = start(self);
    if (status != BB_OK) {
        release(self);
        return status;
    }
    self->next = all;
    *out = all = self;
    return BB_OK;
}

void bb_ray_order_clear(bb_device *device)
{
    bb_ray_order **link = &all;
    while (*link != NULL && (*link)->device != device)
        link = &(*link)->next;
    bb_ray_order *self = *link;
    if (self == NULL)
        return;
    *link = self->next;
    release(self);
}

bb_status bb_ray_order_make(bb_ray_order *self, const void *whose, const bb_box *box,
                            const bb_buffer *rays, uint32_t count)
{
    bb_device *device = self->device;
    const size_t bytes = count * sizeof(uint32_t);
    cl_float4 lo = {{0}}, cells = {{0}};
    for (int axis = 0; axis < 3; axis++) {
        const float side = box->hi[axis] - box->lo[axis];
        lo.s[axis] = box->lo[axis];
        cells.s[axis] = side > 0 ? (float)(1 << BB_RAY_CELL_BITS) / side : 0;
    }
    self->whose = NULL;
    BB_TRY(bb_buffer_reserve(device, NULL, bytes, "keys of rays", &self->keys));
    BB_TRY(bb_buffer_reserve(device, NULL, bytes, "order of rays", &self->ids));
    BB_TRY(bb_launch(device, self->get_keys, count, GROUP_SIZE, BB_MEM(*rays), BB_VALUE(count),
                     BB_VALUE(lo), BB_VALUE(cells), BB_MEM(self->keys), BB_MEM(self->ids)));
    BB_TRY(bb_sort_u32(self->primitives, &self->keys, &self->ids, count, BB_RAY_KEY_BITS));
    self->whose = whose;
    self->count = count;
    return BB_OK;
}

bb_status bb_ray_order_take(bb_ray_order *self, const void *whose, uint32_t count,
                            const bb_buffer **ids)
{
    if (self->whose != whose || self->count != count)
        return bb_fail(BB_FAILED, "%u rays are to be traced that were not sorted", count);
    self->whose = NULL;
    *ids = &self->ids;
    return BB_OK;
}
