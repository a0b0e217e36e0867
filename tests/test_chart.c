/* What the charts show: Pareto front, who wins for how many rays, cells over
 * several views, and the pictures.
 */
#include "framework/base/file.h"
#include "framework/report/chart_script.h"
#include "framework/report/report.h"
#include "tests/record_fixture.h"

enum { SEED = 23 };

static void near(double value, double expected)
{
    if (!(fabs(value - expected) <= 1e-9 * fabs(expected)))
        fail_msg("%.17g, expected %.17g", value, expected);
}

/* ---- Pareto front ---- */

static bool beats(bb_chart_point a, bb_chart_point b)
{
    return a.cost <= b.cost && a.gain >= b.gain && (a.cost < b.cost || a.gain > b.gain);
}

static void front_is_what_none_beats(void **state)
{
    (void)state;
    enum { POINTS = 40 };
    bb_random random = bb_random_make(SEED, 0);
    for (int round = 0; round < 500; round++) {
        bb_chart_point points[POINTS];
        uint32_t front[POINTS], count = bb_random_below(&random, POINTS + 1);
        /* few values, so that many are equal */
        for (uint32_t i = 0; i < count; i++)
            points[i] = (bb_chart_point){bb_random_below(&random, 8), bb_random_below(&random, 8)};
        uint32_t found = bb_pareto_front(points, count, front);
        for (uint32_t i = 0; i < count; i++) {
            bool expected = true, on = false;
            for (uint32_t k = 0; k < count; k++)
                expected = expected && !beats(points[k], points[i]) &&
                           !(k < i && points[k].cost == points[i].cost &&
                             points[k].gain == points[i].gain);
            for (uint32_t k = 0; k < found; k++)
                on = on || front[k] == i;
            if (on != expected)
                fail_msg("seed %d, round %d, point %u: on the front %d", SEED, round, i, on);
        }
        for (uint32_t k = 1; k < found; k++)
            assert_true(points[front[k - 1]].cost < points[front[k]].cost);
    }
}

/* ---- time to n rays ---- */

static double time_of(const bb_time_line *line, double n)
{
    return line->fixed_ms + n * line->ms_per_ray;
}

static void winners_are_the_fastest(void **state)
{
    (void)state;
    enum { LINES = 12 };
    bb_random random = bb_random_make(SEED, 1);
    for (int round = 0; round < 500; round++) {
        bb_time_line lines[LINES];
        bb_winner winners[LINES];
        uint32_t count = 1 + bb_random_below(&random, LINES);
        for (uint32_t i = 0; i < count; i++)
            lines[i] = (bb_time_line){bb_random_below(&random, 10), bb_random_below(&random, 5)};
        uint32_t found = bb_time_winners(lines, count, winners);
        assert_in_range(found, 1, count);
        assert_true(winners[0].from == 0);
        for (double n = 0; n < 20; n += 0.125) {
            uint32_t at = 0;
            while (at + 1 < found && winners[at + 1].from <= n)
                at++;
            for (uint32_t i = 0; i < count; i++)
                if (time_of(&lines[i], n) < time_of(&lines[winners[at].line], n) - 1e-9)
                    fail_msg("seed %d, round %d: line %u is faster at n = %g", SEED, round, i, n);
        }
        for (uint32_t i = 1; i < found; i++) {
            assert_true(winners[i].from >= winners[i - 1].from);
            assert_true(lines[winners[i].line].ms_per_ray < lines[winners[i - 1].line].ms_per_ray);
        }
    }
    bb_winner none;
    assert_int_equal(bb_time_winners(NULL, 0, &none), 0);
}

/* By hand: 10 + 3n, 40 + 1n meet at 15; 25 + 2n passes through the same point and never wins
 * alone. */
static void crossings_are_where_lines_meet(void **state)
{
    (void)state;
    static const bb_time_line lines[] = {{25, 2}, {40, 1}, {10, 3}, {100, 1}};
    bb_winner winners[4];
    assert_int_equal(bb_time_winners(lines, 4, winners), 2);
    assert_int_equal(winners[0].line, 2);
    assert_int_equal(winners[1].line, 1);
    assert_true(winners[1].from == 15);
}

/* ---- cells ---- */

static const bb_chart_set *find_set(const bb_charts *charts, const char *scene, const char *rays,
                                    const char *view)
{
    for (uint32_t i = 0; i < charts->set_count; i++) {
        const bb_chart_set *set = &charts->sets[i];
        if (strcmp(set->scene, scene) == 0 && strcmp(set->rays, rays) == 0 &&
            (view == NULL ? set->view == NULL : set->view != NULL && strcmp(set->view, view) == 0))
            return set;
    }
    fail_msg("no set %s, %s, %s", scene, rays, view != NULL ? view : "all views");
    return NULL;
}

static bb_charts charts_of(bb_results *results)
{
    bb_charts charts;
    assert_int_equal(bb_charts_make(results, &charts), BB_OK);
    return charts;
}

static double number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

static void views_are_added_up(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_charts charts = charts_of(results);
    /* per scene: primary of two views, together and each; diffuse and ao */
    assert_int_equal(charts.set_count, SAMPLE_SCENES * 5);
    const bb_chart_set *all = find_set(&charts, "coffee", "primary", NULL);
    const bb_chart_set *front = find_set(&charts, "coffee", "primary", "front");
    const bb_chart_set *corner = find_set(&charts, "coffee", "primary", "corner");
    assert_int_equal(all->views, 2);
    assert_int_equal(all->cell_count, 17); /* 5 builders with 3 cells each, and 2 references */
    assert_int_equal(front->cell_count, 17);
    assert_int_equal(all->incomplete, 0);
    for (uint32_t i = 0; i < all->cell_count; i++) {
        const bb_chart_cell *cell = &all->cells[i], *a = &front->cells[i], *b = &corner->cells[i];
        assert_ptr_equal(cell->trace, a->trace);
        near(a->mrays_s, bb_get_number(a->trace, BB_F_TRACE_RATE));
        near(a->mrays_s_lo, bb_get_number(a->trace, BB_F_TRACE_RATE_LO));
        near(a->ms, bb_get_number(a->trace, BB_F_TRACE_MS_MEDIAN));
        near(cell->ms, a->ms + b->ms);
        near(cell->mrays_s, 2 * 262144 / (a->ms + b->ms) / 1e3);
        assert_true(cell->mrays_s_lo <= cell->mrays_s && cell->mrays_s <= cell->mrays_s_hi);
        near(a->mrays_s_most, bb_get_number(a->trace, BB_F_TRACE_RATE_MOST));
        near(cell->mrays_s_least,
             262144 / (262144 / a->mrays_s_least + 262144 / b->mrays_s_least) * 2);
        assert_true(cell->mrays_s_least <= cell->mrays_s_lo &&
                    cell->mrays_s_hi <= cell->mrays_s_most);
        near(cell->checked, 2 * 262144);
        near(cell->wrong_rays, a->wrong_rays + b->wrong_rays);
        near(cell->wrong_rays, cell->missed + cell->false_hits + cell->wrong_t);
        near(a->wrong_rays, round(bb_get_number(a->trace, BB_F_ACCURACY_WRONG_PPM) * 262144 / 1e6));
        assert_ptr_equal(cell->trace, entry_at(results, BB_TRACES, (int)cell->trace_index));
        assert_ptr_equal(cell->build, bb_build_of(cell->trace));
    }
    bb_charts_free(&charts);
    bb_results_destroy(results);
}

/* Of three rounds a range, of one neither; of several views the same as of each. */
static void too_few_rounds_have_no_interval(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_charts charts = charts_of(results);
    for (uint32_t i = 0; i < charts.set_count; i++) {
        int rounds = 0;
        for (uint32_t s = 0; s < SAMPLE_SCENES; s++)
            if (strcmp(charts.sets[i].scene, sample_scenes[s].name) == 0)
                rounds = sample_scenes[s].rounds;
        assert_true(rounds > 0);
        for (uint32_t k = 0; k < charts.sets[i].cell_count; k++) {
            const bb_chart_cell *cell = &charts.sets[i].cells[k];
            assert_true(isnan(cell->mrays_s_lo) == (rounds < 6));
            assert_true(isnan(cell->mrays_s_hi) == (rounds < 6));
            assert_true(isnan(cell->mrays_s_least) == (rounds < 2));
            assert_true(isnan(cell->mrays_s_most) == (rounds < 2));
        }
    }
    bb_charts_free(&charts);
    bb_results_destroy(results);
}

/* NAN counts as nothing. */
static double or_nothing(double value)
{
    return isfinite(value) ? value : 0;
}

/* Boxes, build, transfer and layout of the cell's own layout; references have no layout, no SAH. */
static void costs_and_measures_are_the_layouts(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_charts charts = charts_of(results);
    const bb_chart_set *set = find_set(&charts, "coffee", "diffuse", NULL);
    uint32_t references = 0;
    for (uint32_t i = 0; i < set->cell_count; i++) {
        const bb_chart_cell *cell = &set->cells[i];
        double build = bb_get_number(cell->build, BB_F_BUILD_MS_MEDIAN);
        references += cell->reference;
        if (cell->reference) {
            near(cell->fixed_ms, build);
            assert_true(isnan(cell->metrics[bb_metric_find("sah")]) && cell->usable);
            continue;
        }
        const char *layout = bb_get_text(cell->trace, BB_F_TRACE_LAYOUT);
        const char *intersector = bb_get_text(cell->trace, BB_F_TRACE_INTERSECTOR);
        near(cell->fixed_ms, build + bb_get_number(cell->build, BB_F_BUILD_BOXES_MS) +
                                 or_nothing(bb_get_number(cell->build, BB_F_BUILD_TRANSFER_MS)) +
                                 bb_get_named(cell->build, BB_F_BUILD_LAYOUTS_MS, layout));
        near(cell->metrics[bb_metric_find("sah")],
             bb_get_named(cell->build, BB_F_BUILD_LAYOUTS_SAH, layout));
        assert_true(cell->usable == (strcmp(intersector, "exact") == 0));
    }
    assert_int_equal(references, 2);
    /* a cell above the limit is not to be recommended */
    set = find_set(&charts, "coffee", "ao", NULL);
    uint32_t unusable = 0;
    for (uint32_t i = 0; i < set->cell_count; i++)
        unusable += !set->cells[i].usable;
    assert_int_equal(unusable, 5 + 1);
    bb_charts_free(&charts);
    bb_results_destroy(results);
}

/* A cell that failed in one view would look faster, or slower, than it is. */
static void cells_that_lack_a_view_stay_out(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_put_text(entry_at(results, BB_TRACES, 0), BB_F_TRACE_STATUS, "no");
    bb_charts charts = charts_of(results);
    const bb_chart_set *all = find_set(&charts, "coffee", "primary", NULL);
    assert_int_equal(all->cell_count, 16);
    assert_int_equal(all->incomplete, 1);
    assert_int_equal(find_set(&charts, "coffee", "primary", "front")->cell_count, 16);
    assert_int_equal(find_set(&charts, "coffee", "primary", "corner")->cell_count, 17);
    bb_charts_free(&charts);
    bb_results_destroy(results);
}

static char *script_of(bb_results *results, uint32_t *pictures)
{
    static char *text; /* static: gcc 12 takes the stream's buffer for the variable's address */
    static size_t size;
    bb_charts charts = charts_of(results);
    FILE *out = open_memstream(&text, &size);
    assert_int_equal(bb_charts_script(&charts, NULL, out, pictures), BB_OK);
    fclose(out);
    bb_charts_free(&charts);
    return text;
}

/* A picture says how many cells it does not show. */
static void pictures_say_what_is_left_out(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    uint32_t pictures;
    char *text = script_of(results, &pictures);
    assert_null(strstr(text, "not drawn"));
    free(text);
    bb_put_text(entry_at(results, BB_TRACES, 0), BB_F_TRACE_STATUS, "no");
    bb_put_number(entry_at(results, BB_TRACES, 1), BB_F_ACCURACY_CHECKED, NAN);
    text = script_of(results, &pictures);
    assert_int_equal(pictures, SAMPLE_SCENES * 3 * 6);
    assert_non_null(strstr(text, "in a view: 2 cells\"")); /* one failed, one was not checked */
    assert_non_null(strstr(text, "in a view: 1 cells\""));
    free(text);
    bb_results_destroy(results);
}

/* Brute force traces only the first rays of a set. */
static void sets_keep_their_size(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_put_number(entry_at(results, BB_TRACES, 0), BB_F_TRACE_COUNT, 1234);
    bb_charts charts = charts_of(results);
    const bb_chart_set *set = find_set(&charts, "coffee", "primary", "front");
    near(set->cells[0].count, 1234);
    near(set->cells[0].rays, 262144);
    bb_charts_free(&charts);
    bb_results_destroy(results);
}

static void merged_runs_stay_apart(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL), *other = sample_results(NULL);
    assert_int_equal(bb_results_merge(results, other), BB_OK);
    bb_charts charts = charts_of(results);
    const bb_chart_set *set = find_set(&charts, "coffee", "primary", NULL);
    assert_int_equal(set->cell_count, 2 * 17);
    char name[64];
    bb_chart_builder_name(&set->cells[17], true, name, sizeof name);
    assert_string_equal(name, "sah (run 2)");
    bb_charts_free(&charts);
    bb_results_destroy(other);
    bb_results_destroy(results);
}

static void the_page_gets_the_same_cells(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_charts charts = charts_of(results);
    char *text = bb_charts_json(&charts);
    cJSON *sets = cJSON_Parse(text);
    assert_int_equal(cJSON_GetArraySize(sets), charts.set_count);
    for (uint32_t i = 0; i < charts.set_count; i++) {
        const cJSON *set = cJSON_GetArrayItem(sets, (int)i);
        const cJSON *cells = cJSON_GetObjectItem(set, "cells");
        assert_int_equal(cJSON_GetArraySize(cells), charts.sets[i].cell_count);
        assert_true(cJSON_IsNull(cJSON_GetObjectItem(set, "view")) ==
                    (charts.sets[i].view == NULL));
        for (uint32_t k = 0; k < charts.sets[i].cell_count; k++) {
            const cJSON *cell = cJSON_GetArrayItem(cells, (int)k);
            near(number(cell, "ppm_hi"), charts.sets[i].cells[k].wrong.high);
            near(number(cell, "trace"), charts.sets[i].cells[k].trace_index);
            if (charts.sets[i].cells[k].reference)
                assert_true(
                    cJSON_IsNull(cJSON_GetObjectItem(cJSON_GetObjectItem(cell, "metrics"), "sah")));
        }
    }
    cJSON_Delete(sets);
    cJSON_free(text);
    bb_charts_free(&charts);
    bb_results_destroy(results);
}

/* ---- pictures ---- */

/* Accuracy, builders, time and each metric of each scene and rays. */
static void each_scene_and_rays_has_its_pictures(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    uint32_t pictures;
    char *text = script_of(results, &pictures);
    assert_int_equal(pictures, SAMPLE_SCENES * 3 * 6);
    static const char *const names[] = {
        "coffee_primary_accuracy.svg", "coffee_diffuse_builders.png", "coffee_ao_time.svg",
        "interior-n-200000-seed-7_primary_sah.png", "spheres-n-1000000-state-settled_ao_epo.svg"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        assert_non_null(strstr(text, names[i]));
    /* none found: the arrow; the reference rows by name */
    assert_non_null(strstr(text, "R2  embree-native:quality=medium,mode=fast'"));
    assert_non_null(strstr(text, "title 'Pareto front'"));
    free(text);
    bb_results_destroy(results);
}

/* The picture's part of the script, from its name to the next one's; for free(). */
static char *picture_of(const char *script, const char *name)
{
    const char *start = strstr(script, name);
    assert_non_null(start);
    const char *end = strstr(start, "\nreset\n");
    return end != NULL ? strndup(start, (size_t)(end - start)) : strdup(start);
}

/* What the upright lines are stands in the legend: nobody takes a range for an interval. */
static void pictures_tell_ranges_from_intervals(void **state)
{
    (void)state;
    static const struct {
        const char *picture;
        bool interval, range;
    } cases[] = {{"coffee_primary_accuracy.svg", true, false},
                 {"coffee_primary_sah.svg", true, false},
                 {"interior-n-200000-seed-7_ao_accuracy.svg", false, true},
                 {"interior-n-200000-seed-7_ao_sah.svg", false, true},
                 {"spheres-n-1000000-state-settled_ao_accuracy.svg", false, false},
                 {"coffee_primary_builders.svg", false, false}};
    bb_results *results = sample_results(NULL);
    uint32_t pictures;
    char *text = script_of(results, &pictures);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *picture = picture_of(text, cases[i].picture);
        bool interval = strstr(picture, "upright: 95 % interval") != NULL;
        bool range = strstr(picture, "upright, dotted: range of the rounds") != NULL;
        if (interval != cases[i].interval || range != cases[i].range)
            fail_msg("%s: interval %d, range %d", cases[i].picture, interval, range);
        free(picture);
    }
    free(text);
    bb_results_destroy(results);
}

static void an_empty_document_has_none(void **state)
{
    (void)state;
    bb_results *results = NULL;
    bb_context context = {NULL, 1, NULL};
    uint32_t pictures;
    assert_int_equal(bb_results_create(&context, &results), BB_OK);
    free(script_of(results, &pictures));
    assert_int_equal(pictures, 0);
    char folder[600];
    snprintf(folder, sizeof folder, "%s/charts", sample_folder("charts_empty"));
    assert_int_equal(bb_report_charts(results, folder, &pictures), BB_OK);
    bb_results_destroy(results);
}

static size_t file_size(const char *folder, const char *name, const char *magic)
{
    char path[1200], *data = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(bb_file_read(path, 1 << 24, "picture", &data, &size), BB_OK);
    assert_true(size > strlen(magic) && memcmp(data, magic, strlen(magic)) == 0);
    free(data);
    return size;
}

/* The results with one scene of this name, and with other names in its builds and traces. */
static bool rename_cell(void *name, const bb_table *to, const bb_table *from, uint32_t row,
                        bb_target *target)
{
    static char kernel[160], builder[160];
    const char **names = target->cell.names;
    (void)to;
    if (names[BB_SCENE] == NULL)
        return true;
    if (strcmp(names[BB_SCENE], sample_scenes[0].name) != 0)
        return false; /* else there were three of one name */
    names[BB_SCENE] = name;
    if (names[BB_BUILDER] == NULL)
        return true;
    snprintf(builder, sizeof builder, "%s%s", (const char *)name, names[BB_BUILDER]);
    names[BB_BUILDER] = builder;
    if (names[BB_QUESTION] == NULL)
        return true;
    /* still one name for each layout: the key knows a layout by its kernel */
    snprintf(kernel, sizeof kernel, "%s%s", (const char *)name,
             bb_table_get_text(from, row, "layout"));
    names[BB_KERNEL] = kernel;
    if (names[BB_INTERSECTOR] != NULL && strcmp(names[BB_INTERSECTOR], "exact") == 0)
        names[BB_INTERSECTOR] = "@a ^{b} _c %d \xC3\xA9";
    return true;
}

/* The results written and read again, with other names, and keys that follow these. */
static bb_results *named_anew(bb_results *results, char *name)
{
    char path[600];
    bb_results *again = NULL;
    ASSERT_OK(bb_results_make(&again));
    ASSERT_OK(bb_results_copy(again, results, rename_cell, name));
    bb_results_replace(results, again);
    snprintf(path, sizeof path, "%s/anew.json", sample_folder("charts_anew"));
    for (bb_entry *trace = entry_at(results, BB_TRACES, 0); trace != NULL; trace = trace->next) {
        bb_put_text(trace, BB_F_TRACE_CELL, "");
        bb_put_missing_key(trace);
    }
    ASSERT_OK(bb_results_write(results, path));
    bb_results_destroy(results);
    ASSERT_OK(bb_results_read(path, &again));
    return again;
}

/* Names from a file are shown, not run; and what gnuplot draws is there, with no complaint. */
static void names_are_text_to_gnuplot(void **state)
{
    (void)state;
    if (!bb_report_can_draw())
        skip(); /* gnuplot is not installed */
    char folder[600], path[700], command[1600], name[64];
    snprintf(folder, sizeof folder, "%s/charts", sample_folder("charts_hostile"));
    bb_results *results = sample_results(NULL);
    snprintf(name, sizeof name, "x'.system('touch ran').`touch ran`\"\n$a\\");
    results = named_anew(results, name);
    uint32_t pictures;
    snprintf(path, sizeof path, "%s/ran", folder);
    unlink(path);
    bb_status status = bb_report_charts(results, folder, &pictures);
    if (status != BB_OK)
        fail_msg("%s", bb_message());
    assert_int_equal(pictures, 3 * 6);
    assert_int_equal(access(path, F_OK), -1);
    static const char stem[] = "x-.system--touch-ran--.-touch-ran----a-_primary_accuracy";
    snprintf(path, sizeof path, "%s.png", stem);
    assert_true(file_size(folder, path, "\x89PNG\r\n\x1a\n") > 5000);
    snprintf(path, sizeof path, "%s.svg", stem);
    assert_true(file_size(folder, path, "<?xml") > 5000);
    /* no warnings either */
    snprintf(command, sizeof command,
             "cd '%s' && test -z \"$(LC_ALL=C.UTF-8 gnuplot -d charts.gp 2>&1)\"", folder);
    assert_int_equal(system(command), 0);
    bb_results_destroy(results);
}

static void charts_lie_beside_their_page(void **state)
{
    (void)state;
    char folder[64];
    assert_int_equal(bb_report_charts_folder("out/report.html", folder, sizeof folder), BB_OK);
    assert_string_equal(folder, "out/report-charts");
    assert_int_equal(bb_report_charts_folder("a.page", folder, sizeof folder), BB_OK);
    assert_string_equal(folder, "a.page-charts");
    assert_int_equal(bb_report_charts_folder("out/report.html", folder, 17), BB_INVALID);
}

static void what_cannot_be_drawn_is_said(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    uint32_t pictures;
    assert_int_equal(bb_report_charts(results, "/nonexistent/charts", &pictures), BB_INVALID);
    assert_non_null(strstr(bb_message(), "/nonexistent/charts"));

    /* a gnuplot that fails, and none at all */
    char folder[600], program[700], path[700];
    snprintf(folder, sizeof folder, "%s", sample_folder("charts_failing"));
    snprintf(program, sizeof program, "%s/gnuplot", folder);
    FILE *file = fopen(program, "w");
    fputs("#!/bin/sh\necho \"no such\tterminal in $LC_ALL\" >&2\nexit 3\n", file);
    fclose(file);
    chmod(program, 0755);
    char *search = strdup(getenv("PATH"));
    snprintf(path, sizeof path, "%s:/bin:/usr/bin", folder);
    setenv("PATH", path, 1);
    assert_true(bb_report_can_draw());
    setenv("LC_ALL", "C", 1); /* whatever the user's is, gnuplot's has UTF-8 */
    assert_int_equal(bb_report_charts(results, folder, &pictures), BB_FAILED);
    assert_non_null(strstr(bb_message(), "no such terminal in C.UTF-8"));

    /* one that ends well and has left half a picture, as on a full disk */
    file = fopen(program, "w");
    fputs("#!/bin/sh\necho '<svg>' >half.svg\n", file);
    fclose(file);
    assert_int_equal(bb_report_charts(results, folder, &pictures), BB_FAILED);
    assert_non_null(strstr(bb_message(), "half.svg is not whole"));
    snprintf(path, sizeof path, "%s/half.svg", folder);
    assert_int_equal(access(path, F_OK), -1);
    snprintf(path, sizeof path, "%s.part", folder);
    assert_int_equal(access(path, F_OK), -1);
    unlink(program);
    setenv("PATH", folder, 1);
    assert_false(bb_report_can_draw());
    assert_int_equal(bb_report_charts(results, folder, &pictures), BB_FAILED);
    assert_non_null(strstr(bb_message(), "gnuplot"));
    setenv("PATH", search, 1);
    unsetenv("LC_ALL");
    free(search);
    bb_results_destroy(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(front_is_what_none_beats),
        cmocka_unit_test(winners_are_the_fastest),
        cmocka_unit_test(crossings_are_where_lines_meet),
        cmocka_unit_test(views_are_added_up),
        cmocka_unit_test(too_few_rounds_have_no_interval),
        cmocka_unit_test(costs_and_measures_are_the_layouts),
        cmocka_unit_test(cells_that_lack_a_view_stay_out),
        cmocka_unit_test(pictures_say_what_is_left_out),
        cmocka_unit_test(sets_keep_their_size),
        cmocka_unit_test(merged_runs_stay_apart),
        cmocka_unit_test(the_page_gets_the_same_cells),
        cmocka_unit_test(each_scene_and_rays_has_its_pictures),
        cmocka_unit_test(pictures_tell_ranges_from_intervals),
        cmocka_unit_test(an_empty_document_has_none),
        cmocka_unit_test(names_are_text_to_gnuplot),
        cmocka_unit_test(charts_lie_beside_their_page),
        cmocka_unit_test(what_cannot_be_drawn_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
