/* What a builder's specification names: one builder, with a splitter before it or optimisers after
 * it, `presplit:budget=2+sah+rotate:passes=2`. How a `+` separates stages: bb_spec_stages().
 */
#ifndef BB_PIPELINE_H
#define BB_PIPELINE_H

#include "framework/builder/builder.h"

typedef struct bb_pipeline_stage {
    const bb_builder *builder;
    bb_spec spec;   /* its own; validated */
    char label[48]; /* the builder's name; "rotate#2" for the second of one name */
} bb_pipeline_stage;

typedef struct bb_pipeline {
    char text[512]; /* as given: what records and tables show */
    uint32_t count;
    bb_pipeline_stage stages[BB_STAGES_MAX];
} bb_pipeline;

/* Parses `text`, finds the builders, checks their parameters and their order: a splitter or none, a
 * builder, optimisers or none. BB_INVALID with one line that says what to write. */
bb_status bb_pipeline_parse(const char *text, bb_pipeline *pipeline);

/* The builder that is taken where one is needed and none is named: of those that `run` compares by
 * default and that read no geometry, the one that takes most of these kinds of primitives; of
 * several, the one that declares itself the usual one, else the first. NULL: none takes any. */
const bb_builder *bb_usual_builder(uint32_t kinds);

/* `text` as it is, in whatever order its stages are; but a splitter or an optimiser alone gets the
 * usual builder of its kinds beside it. *completed says whether that was needed (may be NULL).
 * BB_INVALID if there is no such builder, the text is unknown, or has no room. */
bb_status bb_pipeline_complete(const char *text, char *whole, size_t capacity, bool *completed);

/* How many of its stages are on the device. */
uint32_t bb_pipeline_on_device(const bb_pipeline *pipeline);

#endif
