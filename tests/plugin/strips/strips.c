/* strips: triangles in runs of 64, in the order of their numbers; a tree of two levels. An example
 * of a builder with several device files, a header that host and device share, and primitives that
 * it does not take.
 */
#include "framework/builder/builder.h"
#include "strips_shared.h"

#include <string.h>

BB_DEVICE_SOURCE(strips);
BB_DEVICE_SOURCE(strips_leaves);

enum { GROUP_SIZE = 64 };

typedef struct strips {
    bb_device *device;
    cl_program leaves_program, program;
    cl_kernel leaves, inner, root;
} strips;

static void destroy(void *opaque)
{
    strips *self = opaque;
    if (self == NULL)
        return;
    bb_kernel_release(self->leaves);
    bb_kernel_release(self->inner);
    bb_kernel_release(self->root);
    bb_program_release(self->leaves_program);
    bb_program_release(self->program);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    strips *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "strips: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->device = context->device;
    BB_TRY(bb_program_build(self->device, &bb_source_strips_leaves, "", &self->leaves_program));
    BB_TRY(bb_program_build(self->device, &bb_source_strips, "", &self->program));
    BB_TRY(bb_kernel_get(self->leaves_program, "strips_leaves", &self->leaves));
    BB_TRY(bb_kernel_get(self->program, "strips_inner", &self->inner));
    return bb_kernel_get(self->program, "strips_root", &self->root);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    strips *self = opaque;
    uint32_t count = scene->prim_count, strip_count = STRIPS_COUNT(count);
    BB_TRY(
        bb_tree_reserve(tree, self->device, BB_ON_DEVICE, 1 + strip_count + (size_t)count, count));
    BB_TRY(bb_phase(phases, "leaves"));
    BB_TRY(bb_launch(self->device, self->leaves, count, GROUP_SIZE, BB_MEM(scene->on_device.boxes),
                     BB_VALUE(count), BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs)));
    BB_TRY(bb_phase(phases, "strips"));
    BB_TRY(bb_launch(self->device, self->inner, strip_count, GROUP_SIZE, BB_VALUE(count),
                     BB_MEM(tree->d_nodes)));
    BB_TRY(bb_launch(self->device, self->root, 1, 1, BB_VALUE(count), BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_info)));
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_strips = {
    .abi_version = BB_ABI_VERSION,
    .name = "strips",
    .summary = "runs of 64 triangles in the order of their numbers",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .create = create,
    .build = build,
    .destroy = destroy,
};
