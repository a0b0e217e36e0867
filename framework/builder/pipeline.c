#include "framework/builder/pipeline.h"

#include "framework/base/suggest.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"

#include <stdio.h>
#include <string.h>

static bb_status find_builder(const char *text, bb_pipeline_stage *stage)
{
    const char *name = stage->spec.name;
    stage->builder = bb_builder_find(name);
    if (stage->builder == NULL && bb_tracer_find(name) != NULL)
        return bb_fail(BB_INVALID, "%s traces with its own tree: only `run` takes it%s", name,
                       strchr(text, '+') != NULL ? ", and not as a stage of a builder" : "");
    if (stage->builder == NULL) {
        bb_suggestion meant = {.word = name};
        for (uint32_t i = 0; i < bb_builder_count(); i++)
            bb_suggest(&meant, bb_builder_at(i)->name);
        for (uint32_t i = 0; i < bb_tracer_count(); i++)
            bb_suggest(&meant, bb_tracer_at(i)->name);
        return bb_fail(BB_INVALID, "unknown builder '%s'%s: `bvhbench list builders` shows them",
                       name, bb_suggested(&meant));
    }
    char what[96];
    snprintf(what, sizeof what, "builder %s", name);
    return bb_spec_validate(&stage->spec, stage->builder->options, what);
}

/* A second stage of the same name gets a number. */
static void set_label(bb_pipeline *pipeline, uint32_t i)
{
    bb_pipeline_stage *stage = &pipeline->stages[i];
    uint32_t same = 1;
    for (uint32_t k = 0; k < i; k++)
        same += pipeline->stages[k].builder == stage->builder;
    if (same == 1)
        snprintf(stage->label, sizeof stage->label, "%s", stage->builder->name);
    else
        snprintf(stage->label, sizeof stage->label, "%.40s#%u", stage->builder->name, same);
}

/* Whether `stage` may come after `before` (NULL: as the first). */
static bb_status check_order(const bb_builder *before, const bb_builder *stage)
{
    const char *name = stage->name;
    if (bb_is_optimiser(stage)) {
        if (before == NULL)
            return bb_fail(BB_INVALID, "%s takes another builder's tree: write BUILDER+%s", name,
                           name);
        if (bb_is_splitter(before))
            return bb_fail(BB_INVALID,
                           "%s takes a tree, and %s gives references: write %s+BUILDER+%s", name,
                           before->name, before->name, name);
        return BB_OK;
    }
    if (before == NULL)
        return BB_OK;
    if (bb_is_splitter(stage))
        return bb_fail(BB_INVALID, "%s splits the scene's primitives: it can only come first",
                       name);
    if (!bb_is_splitter(before))
        return bb_fail(BB_INVALID, "%s takes no tree, so it can't come after %s", name,
                       before->name);
    if ((stage->inputs & BB_INPUTS_OF_PRIMITIVES) != 0)
        return bb_fail(BB_INVALID,
                       "%s reads the primitives' geometry: it can't be fed with %s's references",
                       name, before->name);
    return BB_OK;
}

/* Parses everything, without checking that the last stage leaves a tree. */
static bb_status parse_stages(const char *text, bb_pipeline *pipeline)
{
    bb_spec specs[BB_STAGES_MAX];
    memset(pipeline, 0, sizeof *pipeline);
    BB_TRY(bb_spec_stages(text, specs, BB_STAGES_MAX, &pipeline->count));
    snprintf(pipeline->text, sizeof pipeline->text, "%s", text);
    for (uint32_t i = 0; i < pipeline->count; i++) {
        /* a parsed specification points into itself */
        BB_TRY(bb_spec_parse(specs[i].text, &pipeline->stages[i].spec));
        BB_TRY(find_builder(text, &pipeline->stages[i]));
        set_label(pipeline, i);
    }
    return BB_OK;
}

bb_status bb_pipeline_parse(const char *text, bb_pipeline *pipeline)
{
    BB_TRY(parse_stages(text, pipeline));
    for (uint32_t i = 0; i < pipeline->count; i++) {
        const bb_builder *before = i > 0 ? pipeline->stages[i - 1].builder : NULL;
        bb_status status = check_order(before, pipeline->stages[i].builder);
        if (status != BB_OK && pipeline->count == 1)
            return status;
        if (status != BB_OK) {
            char reason[256];
            snprintf(reason, sizeof reason, "%s", bb_message());
            return bb_fail(status, "'%s': %s", text, reason);
        }
    }
    const bb_builder *last = pipeline->stages[pipeline->count - 1].builder;
    if (bb_is_splitter(last))
        return bb_fail(BB_INVALID, "'%s': %s gives references, not a tree: write %s+BUILDER", text,
                       last->name, text);
    return BB_OK;
}

static bool is_usual(const bb_builder *builder)
{
    return bb_builder_variants(builder, BB_ROLE_USUAL) != NULL;
}

const bb_builder *bb_usual_builder(uint32_t kinds)
{
    const bb_builder *best = NULL;
    int most = 0;
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *builder = bb_builder_at(i);
        int taken = __builtin_popcount(kinds & builder->kinds);
        if (!bb_builder_is_compared(builder) || bb_is_splitter(builder) ||
            bb_is_optimiser(builder) || (builder->inputs & BB_INPUTS_OF_PRIMITIVES) != 0 ||
            taken == 0)
            continue;
        if (taken > most || (taken == most && is_usual(builder) && !is_usual(best))) {
            best = builder;
            most = taken;
        }
    }
    return best;
}

bb_status bb_pipeline_complete(const char *text, char *whole, size_t capacity, bool *completed)
{
    bb_pipeline pipeline;
    BB_TRY(parse_stages(text, &pipeline));
    const bb_builder *stage = pipeline.stages[0].builder;
    bool splits = bb_is_splitter(stage), alone = pipeline.count == 1;
    bool lacks = alone && (splits || bb_is_optimiser(stage));
    const bb_builder *beside = lacks ? bb_usual_builder(stage->kinds) : NULL;
    if (lacks && beside == NULL)
        return bb_fail(BB_INVALID, "%s needs a builder beside it, and none takes what it takes",
                       stage->name);
    int length = !lacks   ? snprintf(whole, capacity, "%s", text)
                 : splits ? snprintf(whole, capacity, "%s+%s", text, beside->name)
                          : snprintf(whole, capacity, "%s+%s", beside->name, text);
    if (length < 0 || (size_t)length >= capacity)
        return bb_fail(BB_INVALID, "'%.40s...' is too long", text);
    if (lacks && bb_pipeline_parse(whole, &pipeline) != BB_OK) /* a final "\\" escapes the '+' */
        return bb_fail(BB_INVALID, "'%s' cannot be completed by %s: write all of it", text,
                       beside->name);
    if (completed != NULL)
        *completed = lacks;
    return BB_OK;
}

uint32_t bb_pipeline_on_device(const bb_pipeline *pipeline)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < pipeline->count; i++)
        count += pipeline->stages[i].builder->place == BB_ON_DEVICE;
    return count;
}
