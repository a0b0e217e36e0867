/* Walks over the registry: each builder as something that makes a tree. */
#ifndef BB_TEST_REGISTRY_H
#define BB_TEST_REGISTRY_H

#include "framework/builder/pipeline.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* A specification: the builder's name, or, of a splitter or an optimiser, that and a builder beside
 * it. Valid until the next call. */
static inline const char *whole_builder(const bb_builder *builder)
{
    static char whole[512];
    if (bb_pipeline_complete(builder->name, whole, sizeof whole, NULL) != BB_OK)
        fail_msg("%s", bb_message());
    return whole;
}

/* Does it run on the host alone? */
static inline bool is_on_host(const char *specification)
{
    bb_pipeline pipeline;
    bool host = true;
    if (bb_pipeline_parse(specification, &pipeline) != BB_OK)
        fail_msg("%s", bb_message());
    for (uint32_t i = 0; i < pipeline.count; i++)
        host = host && pipeline.stages[i].builder->place == BB_ON_HOST;
    return host;
}

#endif
