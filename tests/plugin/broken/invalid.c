/* A plug-in without build(). */
#include "framework/builder/builder.h"

static bb_status create(const bb_builder_context *context, void **self)
{
    (void)context;
    *self = NULL;
    return BB_OK;
}

static void destroy(void *self)
{
    (void)self;
}

static const bb_builder builder = {
    .abi_version = BB_ABI_VERSION,
    .name = "invalid",
    .summary = "has no build()",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .create = create,
    .destroy = destroy,
};
BB_PLUGIN(builder);
