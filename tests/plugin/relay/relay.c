/* relay: an optimiser on the device that leaves the tree as it is. For the tests of what stages
 * hand over to each other, and of builds that are simulated.
 */
#include "framework/builder/builder.h"

#include <string.h>

BB_DEVICE_SOURCE(relay);

static const bb_option options[] = {
    {"form", "any", "any|cpu", "cpu: it cannot be made in the form for GPUs"},
    {.name = NULL},
};

enum { GROUP_SIZE = 64 };

typedef struct relay {
    bb_device *device;
    cl_program program;
    cl_kernel copy;
} relay;

static void destroy(void *opaque)
{
    relay *self = opaque;
    if (self == NULL)
        return;
    bb_kernel_release(self->copy);
    bb_program_release(self->program);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    relay *self = NULL;
    if (context->device->form == BB_FORM_GPU && bb_spec_is(context->spec, options, "form", "cpu"))
        return bb_fail(BB_FAILED, "relay: has no form for GPUs");
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "relay: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->device = context->device;
    BB_TRY(bb_program_build(self->device, &bb_source_relay, "", &self->program));
    return bb_kernel_get(self->program, "relay_copy", &self->copy);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)scene;
    relay *self = opaque;
    uint32_t nodes = input->info.node_count, refs = input->info.ref_count;
    uint32_t items = nodes > refs ? nodes : refs;
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_DEVICE, nodes, refs));
    tree->duplicated = input->duplicated;
    tree->disjoint = input->disjoint;
    BB_TRY(bb_phase(phases, "copy"));
    BB_TRY(bb_launch(self->device, self->copy, items, GROUP_SIZE, BB_MEM(input->d_nodes),
                     BB_VALUE(nodes), BB_MEM(input->d_refs), BB_VALUE(refs), BB_MEM(input->d_info),
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(tree->d_info)));
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_relay = {
    .abi_version = BB_ABI_VERSION,
    .name = "relay",
    .summary = "hands on the tree that it gets; for tests",
    .paper = "none",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_TREE,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .create = create,
    .build = build,
    .destroy = destroy,
};
