/* The fit of costs of trees to the time of rays, on cells whose mix is planted; and what a document
 * makes of it: which cells enter, how they are grouped, what is written and read back. */
#include "framework/base/random.h"
#include "framework/compare/prediction.h"
#include "framework/compare/summary.h"
#include "tests/document_fixture.h"

#include <math.h>
#include <string.h>

enum { SCENES = 4, TREES = 6, CELLS = SCENES * TREES };

#define assert_close(value, expected, by)                                                          \
    do {                                                                                           \
        if (!(fabs((value) - (expected)) <= (by)))                                                 \
            fail_msg("%s is %.9g, expected %.9g", #value, (double)(value), (double)(expected));    \
    } while (0)

static const double costs[TREES][2] = {{30, 2}, {34, 9}, {41, 3}, {28, 7}, {55, 4}, {37, 1}};

/* A scene is a group and a fold; each has its own factor. `noise`: of each time, at most. */
static void plant(bb_fit_cell cells[CELLS], double alpha, double noise)
{
    bb_random random = bb_random_make(7, 0);
    for (uint32_t i = 0; i < CELLS; i++) {
        uint32_t scene = i / TREES, tree = i % TREES;
        double a = costs[tree][0] * (1 + 0.1 * scene),
               b = costs[tree][1] * (1 + 0.3 * scene * tree);
        double factor = pow(10, scene), off = bb_random_range(&random, -noise, noise);
        cells[i] =
            (bb_fit_cell){scene, scene, a, b, factor * ((1 - alpha) * a + alpha * b) * (1 + off)};
    }
}

static void a_planted_mix_is_found(void **state)
{
    (void)state;
    static const double planted[] = {0, 0.01, 0.3, 0.71, 0.995, 1};
    for (size_t i = 0; i < sizeof planted / sizeof planted[0]; i++) {
        bb_fit_cell cells[CELLS];
        plant(cells, planted[i], 0);
        double alpha = bb_fit_alpha(cells, CELLS, BB_FIT_ALL);
        assert_close(alpha, planted[i], 1e-6);
        bb_fit fit = bb_fit_of(cells, CELLS, alpha, 1);
        assert_close(fit.error, 0, 1e-5);
        assert_close(fit.correlation, 1, 1e-9);
        bb_fit_spread spread = bb_fit_folds(cells, CELLS, SCENES);
        assert_close(spread.least, planted[i], 1e-6);
        assert_close(spread.most, planted[i], 1e-6);
        assert_close(spread.unseen, 0, 1e-5);
    }
}

/* Noise of 5 % at most has a typical size of 0.05 / sqrt(3) = 2.9 %; the same cells give the same
 * figures again. */
static void noise_is_what_the_error_says(void **state)
{
    (void)state;
    bb_fit_cell cells[CELLS];
    plant(cells, 0.4, 0.05);
    double alpha = bb_fit_alpha(cells, CELLS, BB_FIT_ALL);
    assert_close(alpha, 0.4, 0.05);
    bb_fit mix = bb_fit_of(cells, CELLS, alpha, 1), first = bb_fit_of(cells, CELLS, 0, 0);
    assert_close(mix.error, 0.029, 0.01);
    assert_true(mix.correlation > 0.95 && mix.correlation < 1);
    assert_true(first.error > 2 * mix.error && first.correlation < mix.correlation);
    bb_fit_spread spread = bb_fit_folds(cells, CELLS, SCENES);
    assert_true(spread.least <= alpha && alpha <= spread.most);
    assert_true(spread.most - spread.least > 0 && spread.most - spread.least < 0.1);
    assert_true(spread.unseen > 0.8 * mix.error && spread.unseen < 2 * mix.error);
    assert_true(bb_fit_alpha(cells, CELLS, BB_FIT_ALL) == alpha);
}

/* One scene of another mix: leaving it out is what moves alpha. */
static void folds_are_left_out(void **state)
{
    (void)state;
    bb_fit_cell cells[CELLS], other[CELLS];
    plant(cells, 0.2, 0);
    plant(other, 0.9, 0);
    memcpy(cells + 2 * TREES, other + 2 * TREES, TREES * sizeof *cells);
    assert_close(bb_fit_alpha(cells, CELLS, 2), 0.2, 1e-6);
    bb_fit_spread spread = bb_fit_folds(cells, CELLS, SCENES);
    assert_close(spread.least, 0.2, 1e-6);
    assert_true(spread.most > 0.25);
    bb_fit fit = bb_fit_of(cells, CELLS, bb_fit_alpha(cells, CELLS, BB_FIT_ALL), 1);
    assert_true(spread.unseen > fit.error && fit.error > 0.02);
}

static void what_cannot_be_known_is_not_said(void **state)
{
    (void)state;
    bb_fit_cell cells[CELLS];
    plant(cells, 0.5, 0.1);
    bb_fit_spread two = bb_fit_folds(cells, 2 * TREES, 2);
    assert_true(isnan(two.least) && isnan(two.most) && isnan(two.unseen));
    /* as many figures as cells leave no error: two cells, a factor and alpha */
    assert_true(isnan(bb_fit_of(cells, 2, 0.5, 1).error));
    assert_true(isnan(bb_fit_of(cells, CELLS, NAN, 1).error));
    for (uint32_t i = 0; i < CELLS; i++)
        cells[i].b = 0.25 * cells[i].a; /* in proportion: every alpha predicts alike */
    assert_true(isnan(bb_fit_alpha(cells, CELLS, BB_FIT_ALL)));
    bb_fit_spread all = bb_fit_folds(cells, CELLS, SCENES);
    assert_true(isnan(all.least) && isnan(all.unseen));
    for (uint32_t i = 0; i < CELLS; i++)
        cells[i].a = 3;
    assert_true(isnan(bb_fit_of(cells, CELLS, 0, 0).correlation));
    assert_true(bb_fit_of(cells, CELLS, 0, 0).error > 0.1);
}

/* The definition, written out: each group has its own factor, which is free. */
static double plain_squares(const bb_fit_cell *cells, uint32_t count, double alpha,
                            uint32_t without)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        double mean = 0, same = 0;
        for (uint32_t k = 0; k < count; k++)
            if (cells[k].group == cells[i].group) {
                mean += log(cells[k].y / ((1 - alpha) * cells[k].a + alpha * cells[k].b));
                same++;
            }
        double off =
            log(cells[i].y / ((1 - alpha) * cells[i].a + alpha * cells[i].b)) - mean / same;
        sum += cells[i].fold == without ? 0 : off * off;
    }
    return sum;
}

/* Random cells, several groups in a fold: no alpha of a fine grid is better than the one found, and
 * errors are those of the definition. */
static void no_other_alpha_is_better(void **state)
{
    (void)state;
    enum { FOLDS = 5, GRID = 5000 };
    for (uint32_t run = 0; run < 10; run++) {
        bb_random random = bb_random_make(11, run);
        bb_fit_cell cells[FOLDS * 3 * 4];
        uint32_t count = 0, groups = 0;
        double unseen = 0;
        for (uint32_t fold = 0; fold < FOLDS; fold++)
            for (uint32_t g = 0; g < 1 + fold % 3; g++, groups++)
                for (uint32_t i = 0, size = 2 + bb_random_below(&random, 3); i < size; i++)
                    cells[count++] = (bb_fit_cell){groups, fold, bb_random_range(&random, 1, 99),
                                                   bb_random_range(&random, 0.1, 20),
                                                   exp(bb_random_range(&random, -3, 3))};
        for (uint32_t without = 0; without <= FOLDS; without++) {
            const uint32_t left_out = without < FOLDS ? without : BB_FIT_ALL;
            const double alpha = bb_fit_alpha(cells, count, left_out);
            const double least = plain_squares(cells, count, alpha, left_out);
            for (int i = 0; i <= GRID; i++)
                if (plain_squares(cells, count, (double)i / GRID, left_out) < least * (1 - 1e-9))
                    fail_msg("run %u without %u: %g is better than %g", run, without,
                             (double)i / GRID, alpha);
            if (without == FOLDS)
                assert_close(bb_fit_of(cells, count, alpha, 1).error,
                             exp(sqrt(least / (count - groups - 1))) - 1, 1e-9);
            else
                unseen += plain_squares(cells, count, alpha, BB_FIT_ALL) -
                          plain_squares(cells, count, alpha, without);
        }
        assert_close(bb_fit_folds(cells, count, FOLDS).unseen,
                     exp(sqrt(unseen / (count - groups))) - 1, 1e-9);
    }
}

/* ---- of a document ---- */

static bb_entry *add_build(bb_results *d, const char *scene, const char *builder, double sah,
                           double epo)
{
    bb_entry *build = new_build(d, scene, builder);
    bb_put_number(build, BB_F_TREE_NODES, 99);
    bb_table_set_number(d->table, build->row, bb_metric_column(&bb_metric_sah, false), sah);
    if (epo > 0)
        bb_table_set_number(d->table, build->row,
                            bb_metric_column(bb_metrics[bb_metric_find("epo_quick")], false), epo);
    return build;
}

static bb_entry *add_trace(bb_results *d, const char *scene, const char *builder, const char *rays,
                           const char *kernel, double ns, double work)
{
    bb_entry *trace = new_trace(d, scene, builder, rays, kernel, "exact");
    bb_put_number(trace, BB_F_TRACE_RATE_GIVEN, 1e3 / ns);
    bb_put_flag(trace, BB_F_TRACE_COUNTS, true);
    bb_put_number(trace, BB_F_TRACE_NODE_TESTS, (work - 1) / 0.6);
    bb_put_number(trace, BB_F_TRACE_PRIM_TESTS, 1);
    return trace;
}

/* Each builder on each scene, by two kernels on two kinds of rays: `primary` of alpha 0.3,
 * `diffuse` of 0.8; the work is in proportion to the time. Without `epo` nobody measured
 * it. */
static bb_results *make_document(int scenes, bool epo)
{
    bb_results *d = empty_document();
    for (int s = 0; s < scenes; s++) {
        char scene[16];
        snprintf(scene, sizeof scene, "scene%d", s);
        add_scene(d, scene, 1000);
        for (int b = 0; b < TREES; b++) {
            char builder[16];
            double x = costs[b][0] * (1 + 0.2 * s), y = costs[b][1] * (1 + 0.1 * s * b);
            snprintf(builder, sizeof builder, "b%d", b);
            add_build(d, scene, builder, x, epo ? y : 0);
            for (int k = 0; k < 4; k++) {
                double alpha = k < 2 ? 0.3 : 0.8, cost = (1 - alpha) * x + alpha * y;
                add_trace(d, scene, builder, k < 2 ? "primary" : "diffuse",
                          k % 2 == 0 ? "stack" : "stack8", cost * (k % 2 == 0 ? 9 : 4) * (1 + s),
                          1 + cost);
            }
        }
    }
    return d;
}

static void a_document_is_fitted_by_kind_of_rays(void **state)
{
    (void)state;
    bb_results *d = make_document(3, true);
    bb_results *results = read_back(d);
    bb_predictions made;
    ASSERT_OK(bb_predictions_make(results, &made));
    assert_int_equal(made.count, 2);
    for (int i = 0; i < 2; i++) {
        const bb_prediction_record *r = &made.kinds[i].record;
        assert_string_equal(r->rays, i == 0 ? "primary" : "diffuse");
        assert_int_equal(r->cells, 3 * TREES * 2);
        assert_int_equal(r->groups, 6);
        assert_int_equal(r->trees, 3 * TREES);
        assert_int_equal(r->scenes, 3);
        assert_close(r->alpha, i == 0 ? 0.3 : 0.8, 1e-5);
        assert_close(r->alpha_least, r->alpha, 1e-5);
        assert_close(r->alpha_most, r->alpha, 1e-5);
        assert_close(r->mix_error, 0, 1e-4);
        assert_close(r->unseen_error, 0, 1e-4);
        assert_true(r->sah_error > 0.02 && r->epo_error > 0.2);
        assert_true(r->work_error < 0.05 && r->work_correlation > 0.999);
        for (uint32_t k = 0; k < r->cells; k++)
            assert_close(made.kinds[i].points[k].mix / made.kinds[i].points[k].time, 1, 1e-4);
    }
    bb_predictions_free(&made);
    bb_summary summary;
    ASSERT_OK(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &summary));
    const char *said = "";
    for (uint32_t i = 0; i < summary.sentence_count; i++)
        if (strcmp(summary.sentences[i].label, "Trees to speed") == 0)
            said = summary.sentences[i].text;
    if (strstr(said, "a = 0.30 (0.30 to 0.30) for primary, a = 0.80") == NULL)
        fail_msg("'%s'", said);
    bb_summary_free(&summary);
    bb_results_destroy(results);
}

/* Rays of the same name that are others, as from another seed, take another time: a group of their
 * own. */
static void other_rays_are_another_group(void **state)
{
    (void)state;
    bb_results *d = make_document(1, true);
    for (int b = 0; b < TREES; b++) {
        char builder[16];
        snprintf(builder, sizeof builder, "other%d", b);
        const double cost = 0.7 * costs[b][0] + 0.3 * costs[b][1];
        add_build(d, "scene0", builder, costs[b][0], costs[b][1]);
        bb_entry *trace = add_trace(d, "scene0", builder, "primary", "stack", 50 * cost, 1 + cost);
        bb_put_text(trace, BB_F_TRACE_RAYS_HASH, "others");
    }
    bb_results *results = read_back(d);
    bb_predictions made;
    ASSERT_OK(bb_predictions_make(results, &made));
    assert_int_equal(made.kinds[0].record.cells, 3 * TREES);
    assert_int_equal(made.kinds[0].record.groups, 3);
    assert_close(made.kinds[0].record.alpha, 0.3, 1e-5);
    assert_close(made.kinds[0].record.mix_error, 0, 1e-4);
    bb_predictions_free(&made);
    bb_results_destroy(results);
}

/* Returns the only trace of a builder of its own, on the rays and by the kernel of all others. */
static bb_entry *add_odd(bb_results *d, const char *builder)
{
    add_build(d, "scene0", builder, 40, 3);
    return add_trace(d, "scene0", builder, "primary", "stack", 5, 9);
}

/* Wrong answers, references, single leaves and cells that are alone on their rays say nothing. */
static void only_sound_cells_enter(void **state)
{
    (void)state;
    bb_results *d = make_document(1, true);
    bb_put_number(add_build(d, "scene0", "leaf", 1e5, 3), BB_F_TREE_NODES, 1);
    add_trace(d, "scene0", "leaf", "primary", "stack", 1e6, 1e5);
    bb_put_flag(add_odd(d, "uncounted"), BB_F_TRACE_COUNTS, false);
    bb_put_flag(add_odd(d, "wrong"), BB_F_TRACE_WRONG, true);
    bb_put_flag(add_odd(d, "reference"), BB_F_TRACE_REFERENCE, true);
    bb_put_flag(add_odd(d, "embree"), BB_F_TRACE_REFERENCE, true); /* one would be alone */
    add_trace(d, "scene0", "b1", "primary", "trail", 5, 9);        /* alone */
    add_trace(d, "scene0", "b1", "rare", "stack", 5, 9);           /* two trees are too few */
    add_trace(d, "scene0", "b2", "rare", "stack", 6, 9);
    bb_results *results = read_back(d);
    bb_predictions made;
    ASSERT_OK(bb_predictions_make(results, &made));
    assert_int_equal(made.count, 2);
    assert_int_equal(made.kinds[0].record.cells, 2 * TREES);
    assert_close(made.kinds[0].record.alpha, 0.3, 1e-5);
    assert_true(isnan(made.kinds[0].record.alpha_least)); /* of one scene */
    bb_predictions_free(&made);
    bb_results_destroy(results);
}

static void without_epo_sah_and_work_are_judged(void **state)
{
    (void)state;
    bb_results *d = make_document(3, false);
    bb_results *results = read_back(d);
    bb_predictions made;
    ASSERT_OK(bb_predictions_make(results, &made));
    assert_int_equal(made.count, 2);
    const bb_prediction_record *r = &made.kinds[0].record;
    assert_true(isnan(r->alpha) && isnan(r->mix_error) && isnan(r->epo_error));
    assert_true(r->sah_error > 0.02 && r->work_error < 0.05);
    assert_true(isnan(made.kinds[0].points[0].overlap));
    bb_predictions_free(&made);
    bb_results_destroy(results);
}

/* What follows from a document is no part of the one that it becomes part of. */
static void it_is_recorded_once(void **state)
{
    (void)state;
    bb_results *d = make_document(3, true), *e = make_document(3, true);
    bb_results *results = read_back(d), *more = read_back(e);
    ASSERT_OK(bb_predictions_record(results));
    ASSERT_OK(bb_predictions_record(results));
    const bb_section *list = bb_results_section(results, BB_PREDICTIONS);
    assert_int_equal(bb_section_count(list), 2);
    assert_close(bb_get_number(bb_first(list), BB_F_PREDICTION_ALPHA), 0.3, 1e-5);
    assert_true(bb_get_number(bb_first(list), BB_F_PREDICTION_UNSEEN) >= 0);
    bb_results *read = read_back(results);
    assert_close(
        bb_get_number(bb_first(bb_results_section(read, BB_PREDICTIONS)), BB_F_PREDICTION_ALPHA),
        0.3, 1e-5);
    ASSERT_OK(bb_results_merge(read, more));
    bb_each(prediction, bb_results_section(read, BB_PREDICTIONS))
        assert_true(isnan(bb_get_number(prediction, BB_F_PREDICTION_CELLS)));
    ASSERT_OK(bb_predictions_record(read));
    list = bb_results_section(read, BB_PREDICTIONS);
    assert_int_equal(bb_section_count(list), 2);
    assert_true(bb_get_number(bb_first(list), BB_F_PREDICTION_GROUPS) == 12); /* of two runs */
    bb_results_destroy(read);
    bb_results_destroy(more);
}

/* ---- trees that cost too much ---- */

static void expect_warning(bb_results *d, const char *words)
{
    char text[BB_IMPLAUSIBLE];
    bb_results *results = read_back(d);
    bool warned = bb_summary_implausible(results, text);
    if (warned != (words != NULL) || (warned && strstr(text, words) == NULL))
        fail_msg("'%s', expected '%s'", warned ? text : "no warning", words != NULL ? words : "");
    bb_results_destroy(results);
}

/* The costs are 28 to 55. The sweep is what a tree is held to, where it is there; a cheaper one, as
 * splits may give, is not. */
static void a_tree_of_three_times_the_sweep_is_named(void **state)
{
    (void)state;
    bb_results *d = make_document(2, true);
    expect_warning(d, NULL);
    d = make_document(2, true);
    add_build(d, "scene1", "broken", 101, 3); /* the least on scene1 is 33.6 */
    expect_warning(d, "broken on scene1 has 3.01 times that of b3");
    d = make_document(2, true);
    add_build(d, "scene1", "broken", 101, 3);
    add_build(d, "scene1", "sah", 34, 3);
    expect_warning(d, NULL);
    d = make_document(2, true);
    add_build(d, "scene1", "broken", 101, 3);
    add_build(d, "scene1", "sah:method=binned", 30, 3);
    const bb_entry *sweep = add_build(d, "scene1", "sah:method=sweep", 33, 3);
    bb_put_text(bb_results_part(d, sweep, "method"), BB_F_BUILD_PARAMS, "sweep");
    expect_warning(d, "broken on scene1 has 3.06 times that of sah:method=sweep");
    d = make_document(2, true); /* neither is the reference: the cheapest is taken */
    add_build(d, "scene1", "broken", 101, 3);
    add_build(d, "scene1", "presplit+sah", 34, 3);
    add_build(d, "scene1", "sahara", 34, 3);
    expect_warning(d, "broken on scene1 has 3.01 times that of b3");
    d = make_document(2, true);
    bb_put_number(add_build(d, "scene1", "one-leaf", 1e5, 0), BB_F_TREE_NODES, 1);
    expect_warning(d, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_planted_mix_is_found),
        cmocka_unit_test(noise_is_what_the_error_says),
        cmocka_unit_test(folds_are_left_out),
        cmocka_unit_test(no_other_alpha_is_better),
        cmocka_unit_test(what_cannot_be_known_is_not_said),
        cmocka_unit_test(a_document_is_fitted_by_kind_of_rays),
        cmocka_unit_test(other_rays_are_another_group),
        cmocka_unit_test(only_sound_cells_enter),
        cmocka_unit_test(without_epo_sah_and_work_are_judged),
        cmocka_unit_test(it_is_recorded_once),
        cmocka_unit_test(a_tree_of_three_times_the_sweep_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
