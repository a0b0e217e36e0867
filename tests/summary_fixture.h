/* Documents with times that are known, and what their summaries say. */
#ifndef BB_TEST_SUMMARY_FIXTURE_H
#define BB_TEST_SUMMARY_FIXTURE_H

#include "framework/compare/summary.h"
#include "tests/document_fixture.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 7, LAYOUT_MS = 10 }; /* of the rounds the first counts for nothing */

/* `ms` is the median, the others in turn above and below it by `spread`; sample 0 is far off. */
static inline bb_samples samples(double ms, double spread)
{
    bb_samples list = {.count = 0};
    for (int i = 0; i < ROUNDS; i++)
        bb_samples_add(&list, i == 0                      ? 50 * ms
                              : i == 1 || i == ROUNDS - 1 ? ms
                                                          : ms * (1 + (i % 2 ? spread : -spread)));
    return list;
}

static inline bb_entry *add_build(bb_results *d, const char *scene, const char *builder, double ms,
                                  bool reference)
{
    bb_entry *build = new_build(d, scene, builder);
    const bb_samples rounds = samples(ms, 0.01), layout = {1, {LAYOUT_MS}};
    bb_put_rounds(build, BB_F_BUILD_MS, &rounds);
    bb_put_flag(build, BB_F_BUILD_REFERENCE, reference);
    if (!reference)
        bb_put_rounds(bb_results_part(d, build, "pair"), BB_F_BUILD_LAYOUTS_MS, &layout);
    return build;
}

typedef struct traced {
    const char *scene, *builder, *rays, *kernel, *intersector, *layout;
    double ms, spread, wrong_ppm, unlike;
    bool reference;
} traced;

static inline bb_entry *add_trace(bb_results *d, const traced *t)
{
    bool exact = strcmp(t->intersector, "exact") == 0;
    bb_entry *trace = new_trace(d, t->scene, t->builder, t->rays, t->kernel, t->intersector);
    const bb_samples rounds = samples(t->ms, t->spread);
    bb_put_text(trace, BB_F_TRACE_LAYOUT, t->layout != NULL ? t->layout : "pair");
    bb_put_rounds(trace, BB_F_TRACE_MS, &rounds);
    bb_put_flag(trace, BB_F_TRACE_COUNTS, exact && !t->reference);
    bb_put_flag(trace, BB_F_TRACE_WRONG, t->wrong_ppm > 0);
    bb_put_flag(trace, BB_F_TRACE_REFERENCE, t->reference);
    if (t->unlike > 0)
        bb_put_number(trace, BB_F_TRACE_UNLIKE, t->unlike);
    bb_put_number(trace, BB_F_ACCURACY_CHECKED, 1e6);
    bb_put_number(trace, BB_F_ACCURACY_WRONG_PPM, t->wrong_ppm);
    return trace;
}

static inline const bb_summary_row *row_of(const bb_summary *s, const char *builder)
{
    for (uint32_t i = 0; i < s->row_count; i++)
        if (strcmp(s->rows[i].builder, builder) == 0)
            return &s->rows[i];
    fail_msg("no row of %s", builder);
    return NULL;
}

static inline const char *sentence_of(const bb_summary *s, const char *label)
{
    for (uint32_t i = 0; i < s->sentence_count; i++)
        if (strcmp(s->sentences[i].label, label) == 0)
            return s->sentences[i].text;
    return "";
}

static inline void expect_words(const bb_summary *s, const char *label, const char *words)
{
    if (strstr(sentence_of(s, label), words) == NULL)
        fail_msg("%s: expected '%s' in '%s'", label, words, sentence_of(s, label));
}

#define assert_near(value, expected) assert_true(fabs((value) / (expected)-1) < 1e-9)

/* Two scenes of a million primitives, one set of rays each; a reference at 100 ms for them. Slow to
 * build and fast to trace, the other way round, and one that can't be told from the first. */
static inline bb_results *three_builders(void)
{
    static const char *const scenes[] = {"a", "b"};
    static const struct {
        const char *builder;
        double build, trace[2], spread;
    } builders[] = {{"slow", 1000, {100, 50}, 0.001},
                    {"fast", 10, {400, 100}, 0.001},
                    {"alike", 1000, {101, 50}, 0.05}};
    bb_results *d = empty_document();
    for (int s = 0; s < 2; s++) {
        add_scene(d, scenes[s], 1e6);
        for (int b = 0; b < 3; b++) {
            traced t = {.scene = scenes[s],
                        .builder = builders[b].builder,
                        .rays = "random",
                        .kernel = "stack",
                        .intersector = "exact",
                        .ms = builders[b].trace[s],
                        .spread = builders[b].spread};
            add_build(d, scenes[s], t.builder, builders[b].build, false);
            add_trace(d, &t);
            t.kernel = "slower";
            t.ms *= 3;
            add_trace(d, &t);
        }
        traced t = {.scene = scenes[s],
                    .builder = "embree-native:mode=fast",
                    .rays = "random",
                    .kernel = "own",
                    .intersector = "own",
                    .ms = 100,
                    .reference = true};
        add_build(d, scenes[s], t.builder, 100, true);
        add_trace(d, &t);
    }
    return d;
}

#endif
