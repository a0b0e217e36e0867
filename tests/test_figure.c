/* Figures for print: `report --figure`. */
#include "framework/base/file.h"
#include "framework/record/record_private.h"
#include "framework/report/report.h"
#include "tests/fixture.h"
#include "tests/program_fixture.h"
#include "tests/report_sample.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char name[] = "coffee_primary_time";

/* Reads what was drawn; for free(). */
static char *contents(const char *path, size_t *size)
{
    static char *data; /* static: gcc 12 takes what it points to for the variable's address */
    data = NULL;
    ASSERT_OK(bb_file_read(path, 1 << 24, "figure", &data, size));
    return data;
}

static const char *draw(bb_results *results, const char *figure, double width_mm, const char *file)
{
    static char path[700];
    snprintf(path, sizeof path, "%s/%s", sample_folder("figures"), file);
    unlink(path);
    ASSERT_OK(bb_report_figure(results, figure, width_mm, path));
    return path;
}

static void is_absent(const char *svg, const char *what)
{
    if (strstr(svg, what) != NULL)
        fail_msg("the figure has %s", what);
}

/* As wide as asked for; builders by name, no run's number, no title, no ground, and nothing whose
 * red, green and blue differ but the lines that the screen has, too, which are nearly grey. */
static void a_figure_is_for_print(void **state)
{
    (void)state;
    if (!bb_report_can_draw())
        skip(); /* gnuplot is not installed */
    bb_results *results = sample_results(NULL);
    size_t size;
    char *svg = contents(draw(results, name, 84, "wide.svg"), &size);
    const char *width = strstr(svg, "width=\"");
    assert_non_null(width);
    assert_int_equal(atoi(width + 7), 317); /* 84 mm of 96 to the inch */
    assert_non_null(strstr(svg, "embree:low"));
    is_absent(svg, "(run 1)");
    is_absent(svg, "time to n rays");
    is_absent(svg, "fill=\"#ffffff\"");
    for (const char *at = svg; (at = strstr(at, "rgb(")) != NULL; at++) {
        int red, green, blue;
        if (sscanf(at, "rgb( %d, %d, %d)", &red, &green, &blue) == 3 && abs(red - blue) > 0x20)
            fail_msg("a colour: %.20s", at);
    }
    free(svg);
    bb_results_destroy(results);
}

/* Each kind in each format, whole. */
static void every_chart_can_be_a_figure(void **state)
{
    (void)state;
    static const char *const kinds[] = {"accuracy", "builders", "time", "sah", "epo_quick"};
    static const struct {
        const char *file, *magic;
    } formats[] = {{"f.pdf", "%PDF-"}, {"f.png", "\x89PNG"}, {"f.svg", "<?xml"}};
    if (!bb_report_can_draw())
        skip();
    bb_results *results = sample_results(NULL);
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        for (size_t f = 0; f < sizeof formats / sizeof formats[0]; f++) {
            char figure[64];
            size_t size;
            snprintf(figure, sizeof figure, "coffee_primary_%s", kinds[k]);
            char *data = contents(draw(results, figure, 170, formats[f].file), &size);
            assert_true(size > 2000);
            assert_memory_equal(data, formats[f].magic, strlen(formats[f].magic));
            free(data);
        }
    bb_results_destroy(results);
}

/* What was there before stays, and nothing lies beside it. */
static void a_failure_changes_nothing(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char path[700], list[900];
    size_t size;
    snprintf(path, sizeof path, "%s/kept.svg", sample_folder("figures"));
    ASSERT_OK(bb_file_write(path, "kept", 4, "figure"));
    assert_int_equal(bb_report_figure(results, "coffee_primary_x", 84, path), BB_INVALID);
    assert_non_null(strstr(bb_message(), "SET one of coffee_primary, "));
    assert_non_null(strstr(bb_message(), "time"));
    char *search = strdup(getenv("PATH"));
    setenv("PATH", "/nonexistent", 1);
    assert_int_equal(bb_report_figure(results, name, 84, path), BB_FAILED);
    setenv("PATH", search, 1);
    free(search);
    char *data = contents(path, &size);
    assert_int_equal(size, 4);
    assert_memory_equal(data, "kept", 4);
    free(data);
    snprintf(list, sizeof list, "test -z \"$(find '%s' -name 'kept.svg.*')\"",
             sample_folder("figures"));
    assert_int_equal(system(list), 0);
    bb_results_destroy(results);
}

/* The results with a builder whose name is a command to whoever does not quote it. */
static bool rename_builders(void *unused, const bb_table *to, const bb_table *from, uint32_t row,
                            bb_target *target)
{
    static char builder[200];
    const char **names = target->cell.names;
    (void)unused, (void)to, (void)from, (void)row;
    if (names[BB_BUILDER] == NULL || strncmp(names[BB_BUILDER], "sah", 3) != 0)
        return true;
    snprintf(builder, sizeof builder, "x'.system('touch ran').'`touch ran`\n!touch ran\n$a\\");
    names[BB_BUILDER] = builder;
    return true;
}

/* Neither names from a file nor the name of the figure are commands, or other files. */
static void names_are_no_commands(void **state)
{
    (void)state;
    static const char *const kinds[] = {"accuracy", "builders", "time", "sah"};
    if (!bb_report_can_draw())
        skip();
    bb_results *results = sample_results(NULL), *renamed = NULL;
    ASSERT_OK(bb_results_make(&renamed));
    ASSERT_OK(bb_results_copy(renamed, results, rename_builders, NULL));
    bb_results_destroy(results);
    char ran[700], here[] = "ran";
    snprintf(ran, sizeof ran, "%s/ran", sample_folder("figures"));
    unlink(ran), unlink(here);
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        char figure[64];
        size_t size;
        snprintf(figure, sizeof figure, "coffee_primary_%s", kinds[k]);
        free(contents(draw(renamed, figure, 84, "|touch ran;'\n\xe9.svg"), &size));
        assert_true(size > 2000);
    }
    assert_int_equal(access(ran, F_OK), -1);
    assert_int_equal(access(here, F_OK), -1);
    bb_results_destroy(renamed);
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *options, *why;
    } cases[] = {
        {"--figure x", "a figure needs --out FILE.pdf, FILE.svg or FILE.png"},
        {"--figure x --out a.html", "a figure needs --out FILE.pdf, FILE.svg or FILE.png"},
        {"--figure x --out a.pdf --width 84", "--width is '84', must be from 30mm to 500mm"},
        {"--figure x --out a.pdf --width 8m", "--width is '8m', must be from 30mm to 500mm"},
        {"--figure x --out a.pdf --width 1mm", "--width is '1mm', must be from 30mm to 500mm"},
        {"--width 84mm", "--width needs --figure"},
        {"--figure x --csv", "--figure"},
    };
    bb_results *results = sample_results(NULL);
    char path[700], command[1200];
    snprintf(path, sizeof path, "%s/results.json", sample_folder("figures"));
    ASSERT_OK(bb_results_write(results, path));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        snprintf(command, sizeof command, "report %s %s", path, cases[i].options);
        refuses("", command, cases[i].why);
    }
    bb_results_destroy(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_figure_is_for_print),     cmocka_unit_test(every_chart_can_be_a_figure),
        cmocka_unit_test(a_failure_changes_nothing), cmocka_unit_test(names_are_no_commands),
        cmocka_unit_test(bad_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
