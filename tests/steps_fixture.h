/* The steps that a variant of a kernel records, against what another one counts. */
#ifndef BB_TEST_STEPS_FIXTURE_H
#define BB_TEST_STEPS_FIXTURE_H

#include "framework/simulate/steps.h"
#include "tests/fixture.h"

/* Of each kind, the steps of one item. */
typedef struct step_sums {
    uint32_t of[BB_STEP_KINDS];
    uint32_t first_prims; /* primitives before another search */
} step_sums;

/* Adds up each item's steps; the caller frees them. */
static inline step_sums *sum_steps(const bb_steps *steps)
{
    step_sums *sums = calloc(steps->rays + 1, sizeof *sums);
    assert_non_null(sums);
    for (uint32_t i = 0, at = 0; i < steps->rays; i++)
        for (; at < steps->ends[i]; at++) {
            const uint32_t kind = bb_step_kind(steps->words[at]);
            sums[i].of[kind]++;
            sums[i].first_prims += kind == BB_STEP_PRIMS && sums[i].of[BB_STEP_AGAIN] == 0;
        }
    return sums;
}

/* Of a tree in arrays, boxes of a node's children must follow each other, and so must what a leaf
 * lists, after the step to that leaf. */
static inline void expect_lists(const bb_steps *steps)
{
    for (uint32_t i = 0, at = 0; i < steps->rays; i++)
        for (uint32_t before = BB_STEP_AGAIN, last = 0; at < steps->ends[i]; at++) {
            const uint32_t kind = bb_step_kind(steps->words[at]);
            const uint32_t index = bb_step_index(steps->words[at]);
            if (kind == BB_STEP_EXACT || kind == BB_STEP_FURTHER)
                continue;
            if (kind == BB_STEP_PRIMS)
                assert_true(before == BB_STEP_LEAF || (before == kind && index == last + 1));
            if (kind == BB_STEP_BOX && before == kind && index >> 1 != 0)
                assert_int_equal(index >> 1, (last >> 1) + 1);
            before = kind;
            last = index;
        }
}

/* Nodes whose box was tested; where boxes are apart, they have steps of their own. */
static inline uint32_t tested_nodes(const step_sums *sums, bb_control control)
{
    return sums->of[control == BB_UNTIL_LEAF ? BB_STEP_BOX : BB_STEP_NODE];
}

/* A sample must consist of two runs of the steps of all items. */
static inline void expect_sample(const bb_steps *steps, const bb_steps *sample)
{
    assert_int_equal(sample->rays, 2 * BB_STEPS_RUN);
    for (uint32_t run = 0, from = 0; run < 2; run++) {
        const uint32_t end = sample->ends[(run + 1) * BB_STEPS_RUN - 1];
        bool found = false;
        for (uint32_t k = 0; (k + 1) * BB_STEPS_RUN <= steps->rays && !found; k++) {
            const uint32_t first = k > 0 ? steps->ends[k * BB_STEPS_RUN - 1] : 0;
            found = steps->ends[(k + 1) * BB_STEPS_RUN - 1] - first == end - from &&
                    memcmp(steps->words + first, sample->words + from,
                           (end - from) * sizeof(uint32_t)) == 0;
        }
        assert_true(found);
        from = end;
    }
}

#endif
