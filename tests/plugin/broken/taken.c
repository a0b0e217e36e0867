/* A plug-in whose name a built-in builder has. */
#include "framework/builder/builder.h"

static bb_status create(const bb_builder_context *context, void **self)
{
    (void)context;
    *self = NULL;
    return BB_OK;
}

static bb_status build(void *self, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)self, (void)scene, (void)input, (void)tree, (void)phases;
    return BB_OK;
}

static void destroy(void *self)
{
    (void)self;
}

static const bb_builder builder = {
    .abi_version = BB_ABI_VERSION,
    .name = "sah",
    .summary = "has a name that is taken",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .create = create,
    .build = build,
    .destroy = destroy,
};
BB_PLUGIN(builder);
