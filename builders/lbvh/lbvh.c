/* LBVH: the binary radix tree over Morton codes of the primitives' centroids, on the device.
 *
 * Lauterbach et al. 2009 (the idea), Karras 2012 (the tree; equal codes are told apart by their index), Apetrei 2014 (linking
 * and boxes in one bottom-up pass). One primitive per leaf.
 */
#include "builders/common/radix_tree.h"
#include "framework/builder.h"

#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(lbvh);

enum { GROUP_SIZE = 64 };

static const bb_option options[] = {
    {"bits", "30", "30|63", "bits of the Morton code: 10 or 21 per axis"},
    {"link", "apetrei", "apetrei|karras", "how the tree is linked; the tree is the same"},
    {.name = NULL},
};

typedef struct lbvh {
    bb_device *device;
    bb_account *account;
    uint32_t bits;
    uint32_t key_bytes;
    bb_primitives *primitives;
    bb_radix_tree *radix;
    cl_program program;
    cl_kernel codes;
    bb_buffer bounds; /* two bb_box: of the boxes, of the centroids */
    bb_buffer keys;
    bb_buffer values;
} lbvh;

static void destroy(void *opaque)
{
    lbvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->bounds);
    bb_buffer_release(&self->keys);
    bb_buffer_release(&self->values);
    bb_kernel_release(self->codes);
    bb_program_release(self->program);
    bb_radix_tree_destroy(self->radix);
    bb_primitives_destroy(self->primitives);
    free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    lbvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    bool wide = bb_spec_is(context->spec, options, "bits", "63");
    bool karras = bb_spec_is(context->spec, options, "link", "karras");
    self->bits = wide ? 63 : 30;
    self->key_bytes = wide ? 8 : 4;
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    bb_radix_kind kind = {.key_bytes = self->key_bytes,
                          .linking = karras ? BB_LINK_KARRAS : BB_LINK_APETREI};
    BB_TRY(bb_radix_tree_create(self->device, self->account, kind, &self->radix));
    BB_TRY(
        bb_program_build(self->device, &bb_source_lbvh, wide ? "-DBB_KEY64" : "", &self->program));
    return bb_kernel_get(self->program, "lbvh_codes", &self->codes);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    lbvh *self = opaque;
    size_t count = scene->prim_count;
    BB_TRY(bb_buffer_reserve(self->device, self->account, 2 * sizeof(bb_box), "lbvh: bounds",
                             &self->bounds));
    BB_TRY(bb_buffer_reserve(self->device, self->account, count * self->key_bytes, "lbvh: codes",
                             &self->keys));
    BB_TRY(bb_buffer_reserve(self->device, self->account, count * sizeof(uint32_t), "lbvh: indices",
                             &self->values));
    BB_TRY(bb_primitives_reserve(self->primitives, scene->prim_count, self->key_bytes));
    return bb_radix_tree_reserve(self->radix, scene->prim_count, tree);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    lbvh *self = opaque;
    const bb_buffer *boxes = &scene->on_device.boxes;
    uint32_t count = scene->prim_count;

    BB_TRY(bb_phase(phases, "bounds"));
    BB_TRY(bb_reduce_boxes(self->primitives, boxes, count, &self->bounds));
    BB_TRY(bb_phase(phases, "codes"));
    BB_TRY(bb_launch(self->device, self->codes, count, GROUP_SIZE, BB_MEM(*boxes),
                     BB_MEM(self->bounds), BB_VALUE(count), BB_MEM(self->keys),
                     BB_MEM(self->values)));
    BB_TRY(bb_phase(phases, "sort"));
    if (self->key_bytes == 8)
        BB_TRY(bb_sort_u64(self->primitives, &self->keys, &self->values, count, self->bits));
    else
        BB_TRY(bb_sort_u32(self->primitives, &self->keys, &self->values, count, self->bits));
    BB_TRY(bb_phase(phases, "link"));
    BB_TRY(bb_radix_tree_link(self->radix, &self->keys, NULL, &self->values, boxes, count, tree));
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_lbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "lbvh",
    .summary = "binary radix tree over Morton codes",
    .paper = "Karras 2012, sections 3-4; Apetrei 2014; Lauterbach et al. 2009",
    .kinds = BB_TRIANGLES | BB_SPHERES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .compared = "lbvh,lbvh:bits=63",
    .create = create,
    .prepare = prepare,
    .build = build,
    .destroy = destroy,
};
