/* A builder's specification names one builder, with a splitter before it or optimisers after it:
 * `presplit:budget=2+sah+rotate:passes=2`. bb_spec_stages() documents how `+` separates stages.
 */
#ifndef BB_PIPELINE_H
#define BB_PIPELINE_H

#include "framework/builder/builder.h"

typedef struct bb_pipeline_stage {
    const bb_builder *builder;
    bb_spec spec;   /* the stage's own; validated */
    char label[48]; /* the builder's name; "rotate#2" for its second stage of that name */
} bb_pipeline_stage;

typedef struct bb_pipeline {
    char text[512]; /* as given; shown in records and tables */
    uint32_t count;
    bb_pipeline_stage stages[BB_STAGES_MAX];
} bb_pipeline;

/* Parses `text`, finds the builders, checks their parameters and their order: an optional splitter,
 * a builder, optional optimisers. BB_INVALID with one line that says what to write. */
bb_status bb_pipeline_parse(const char *text, bb_pipeline *pipeline);

/* The builder that is used where one is needed and none is named. Candidates are the builders that
 * `run` compares by default and that read no geometry; the one that takes most of these kinds of
 * primitives is chosen. Among equals it is the one that declares itself the usual one, else the
 * first. NULL if none takes any of these kinds. */
const bb_builder *bb_usual_builder(uint32_t kinds);

/* Copies `text` unchanged if it names a builder, whatever the order of its stages; a splitter or an
 * optimiser alone gets the usual builder of its kinds added. *completed (may be NULL) says whether
 * one was added. BB_INVALID if there is no such builder, the text is unknown, or has no room. */
bb_status bb_pipeline_complete(const char *text, char *whole, size_t capacity, bool *completed);

/* Number of its stages that are on the device. */
uint32_t bb_pipeline_on_device(const bb_pipeline *pipeline);

#endif
