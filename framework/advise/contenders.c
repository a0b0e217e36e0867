/* Lists of contenders from the tables of builders, kernels and intersectors. */
#include "framework/advise/contenders.h"

#include "framework/builder/pipeline.h"
#include "framework/builder/registry.h"
#include "framework/record/cell.h"
#include "framework/simulate/simulate.h"
#include "traversal/traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bb_tried_free(bb_tried *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->items[i]);
    list->count = 0;
}

bb_status bb_tried_add(bb_tried *list, const char *text)
{
    for (size_t i = 0; i < list->count; i++)
        if (strcmp(list->items[i], text) == 0)
            return BB_OK;
    if (list->count == BB_TRIED_MAX)
        return bb_fail(BB_INVALID, "advise: more than %d names, up to '%.80s'", BB_TRIED_MAX, text);
    list->items[list->count] = strdup(text);
    if (list->items[list->count] == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    list->count++;
    return BB_OK;
}

static bb_status add_list(bb_tried *list, const char *texts)
{
    char *items[BB_TRIED_MAX] = {NULL};
    size_t count = 0;
    if (texts == NULL)
        return BB_OK;
    bb_status status = bb_spec_list(texts, items, BB_TRIED_MAX, &count);
    for (size_t i = 0; i < count; i++) {
        if (status == BB_OK)
            status = bb_tried_add(list, items[i]);
        free(items[i]);
    }
    return status;
}

bb_status bb_tried_builders(bb_tried *list)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *builder = bb_builder_at(i);
        const bool stage = bb_is_splitter(builder) || bb_is_optimiser(builder);
        if (builder->variants == NULL && !stage)
            BB_TRY(bb_tried_add(list, builder->name));
        BB_TRY(add_list(list, bb_builder_variants(builder, BB_ROLE_COMPARED)));
        BB_TRY(add_list(list, bb_builder_variants(builder, BB_ROLE_TRIED)));
        BB_TRY(add_list(list, bb_builder_variants(builder, BB_ROLE_LEAST)));
    }
    return BB_OK;
}

bb_status bb_tried_kernels(bb_tried *list, uint32_t device)
{
    static const char *const roles[] = {BB_ROLE_COMPARED, BB_ROLE_TRIED};
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        for (size_t r = 0; r < sizeof roles / sizeof roles[0]; r++)
            for (const bb_variants *v = (*k)->variants;
                 (v = bb_variants_of(v, roles[r], device)) != NULL; v++)
                BB_TRY(add_list(list, v->specs));
    return BB_OK;
}

bb_status bb_tried_intersectors(bb_tried *list)
{
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        BB_TRY(bb_tried_add(list, i->name));
    return BB_OK;
}

bb_status bb_tried_bounded(const bb_tried *kernels, bb_tried *list)
{
    for (size_t i = 0; i < kernels->count; i++) {
        bb_spec spec;
        const bb_kernel *kernel;
        BB_TRY(bb_kernel_parse(kernels->items[i], &spec, &kernel));
        if (bb_simulates_bounds(kernel, BB_TRIANGLES))
            BB_TRY(bb_tried_add(list, kernels->items[i]));
    }
    return BB_OK;
}

const char *bb_tried_exact(const bb_tried *intersectors)
{
    for (size_t i = 0; i < intersectors->count; i++) {
        bb_intersector intersector;
        if (bb_intersector_parse(intersectors->items[i], &intersector) == BB_OK &&
            bb_intersector_is_exact(&intersector))
            return intersectors->items[i];
    }
    return NULL;
}

bb_contender *bb_contenders_make(const bb_tried *builders, const bb_tried *kernels,
                                 const bb_tried *intersectors, uint32_t *count)
{
    size_t most = builders->count * kernels->count * intersectors->count;
    bb_contender *all = calloc(most + 1, sizeof *all);
    *count = 0;
    for (size_t b = 0; all != NULL && b < builders->count; b++)
        for (size_t k = 0; k < kernels->count; k++)
            for (size_t i = 0; i < intersectors->count; i++)
                all[(*count)++] =
                    (bb_contender){builders->items[b], kernels->items[k], intersectors->items[i]};
    return all;
}

size_t bb_tried_scout(const bb_tried *builders)
{
    for (size_t i = 0; i < builders->count; i++) {
        bb_pipeline pipeline;
        if (bb_pipeline_parse(builders->items[i], &pipeline) == BB_OK &&
            bb_pipeline_on_device(&pipeline) == pipeline.count)
            return i;
    }
    return 0;
}

uint32_t bb_intersector_doubt(const char *intersector)
{
    uint32_t place = 0;
    size_t length = strcspn(intersector, ":");
    while (bb_intersectors[place].name != NULL &&
           (strlen(bb_intersectors[place].name) != length ||
            strncmp(bb_intersectors[place].name, intersector, length) != 0))
        place++;
    return place;
}

size_t bb_tried_careful(const bb_tried *intersectors)
{
    size_t careful = 0;
    for (size_t i = 1; i < intersectors->count; i++)
        if (bb_intersector_doubt(intersectors->items[i]) <
            bb_intersector_doubt(intersectors->items[careful]))
            careful = i;
    return careful;
}

bool bb_generous_builder(const char *builder, char *text, size_t capacity)
{
    bb_pipeline pipeline;
    bb_spec own, generous;
    if (bb_pipeline_parse(builder, &pipeline) != BB_OK || pipeline.count != 1)
        return false;
    const char *declared = bb_builder_variants(pipeline.stages[0].builder, BB_ROLE_GENEROUS);
    if (declared == NULL || bb_spec_parse(declared, &generous) != BB_OK ||
        bb_spec_parse(builder, &own) != BB_OK)
        return false;
    bool has_them = true;
    for (uint32_t i = 0; i < generous.param_count; i++)
        has_them = has_them && bb_spec_is(&own, NULL, generous.keys[i], generous.values[i]);
    size_t length = (size_t)snprintf(text, capacity, "%s", declared);
    for (uint32_t i = 0; i < own.param_count && length < capacity; i++)
        if (strcmp(own.values[i], "auto") != 0 &&
            bb_spec_value(&generous, NULL, own.keys[i]) == NULL)
            length +=
                (size_t)snprintf(text + length, capacity - length, "%c%s=%s",
                                 strchr(text, ':') != NULL ? ',' : ':', own.keys[i], own.values[i]);
    return length < capacity && !has_them;
}
