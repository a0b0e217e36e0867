/* Embree with its own trees, with which all others are compared (framework/judge/embree.h). */
#include "framework/builder/tracer.h"
#include "framework/judge/embree.h"

#include <stdio.h>
#include <string.h>

static bb_status create(const bb_tracer_context *context, void **self)
{
    bb_embree *embree;
    BB_TRY(bb_embree_create(context->scene, context->spec, context->threads, &embree));
    *self = embree;
    return BB_OK;
}

static bb_status build(void *self, bb_phases *phases)
{
    (void)phases; /* Embree does not say */
    return bb_embree_build(self);
}

static bb_status pass(void *self, const bb_spec *spec)
{
    return bb_embree_pass(self, spec);
}

static bb_status trace(void *self, const bb_ray *rays, uint32_t count, bool any, bb_hit *hits)
{
    return bb_embree_trace(self, rays, count, any, hits);
}

static uint64_t bytes(void *self)
{
    return bb_embree_bytes(self);
}

static bb_status describe(void *self, char *text, size_t capacity)
{
    char version[32];
    (void)self;
    BB_TRY(bb_embree_version(version, sizeof version));
    snprintf(text, capacity, "Embree %s", version);
    return BB_OK;
}

static void destroy(void *self)
{
    bb_embree_destroy(self);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED,
     "embree-native:quality=medium,mode=robust,"
     "embree-native:quality=medium,mode=fast,"
     "embree-native:quality=high,mode=fast,"
     "embree-native:quality=high,mode=fast,query=packet8,"
     "embree-native:quality=high,mode=fast,query=packet16,"
     "embree-native:quality=high,mode=fast,query=stream"},
    {.devices = 0},
};

extern const bb_tracer bb_tracer_embree_native;
const bb_tracer bb_tracer_embree_native = {
    .abi_version = BB_TRACER_ABI_VERSION,
    .name = "embree-native",
    .summary = "reference: Embree tracing with its own trees",
    .paper = "Wald et al. 2014",
    .kinds = BB_ALL_KINDS,
    .options = bb_embree_options,
    .passing = BB_EMBREE_PASSING,
    .exactness = "mode",
    .code = "embree",
    .variants = variants,
    .create = create,
    .build = build,
    .pass = pass,
    .trace = trace,
    .bytes = bytes,
    .describe = describe,
    .destroy = destroy,
};
