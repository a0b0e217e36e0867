/* The hooks of builders that are refused: none is ever called. */
#ifndef BB_TEST_BROKEN_H
#define BB_TEST_BROKEN_H

#include "framework/builder/builder.h"

static bb_status create(const bb_builder_context *context, void **self)
{
    (void)context;
    *self = NULL;
    return BB_OK;
}

static inline bb_status build(void *self, const bb_scene *scene, const bb_tree *input,
                              bb_tree *tree, bb_phases *phases)
{
    (void)self, (void)scene, (void)input, (void)tree, (void)phases;
    return BB_OK;
}

static void destroy(void *self)
{
    (void)self;
}

/* A builder that is in order but for what is wrong with it. */
#define BROKEN_BUILDER(name_, build_)                                                              \
    {                                                                                              \
        .abi_version = BB_ABI_VERSION, .name = (name_), .summary = "is refused", .paper = "none",  \
        .kinds = BB_TRIANGLES, .inputs = BB_INPUT_BOXES, .place = BB_ON_HOST,                      \
        .deterministic = true, .create = create, .build = (build_), .destroy = destroy,            \
    }

#endif
