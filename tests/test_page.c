/* Pages of results: blocks on the terminal, as Markdown and as HTML.
 *
 *   test_page --write FOLDER      writes page.html, which is looked at in a browser
 */
#include "framework/base/file.h"
#include "framework/base/steering.h"
#include "tests/page_fixture.h"
#include "tests/program_fixture.h"

#include <limits.h>

/* ---- renderers ---- */

static bb_page *sample_page(void)
{
    bb_page *page = new_page();
    static const bb_axes axes = {BB_DRAW_BARS, "ms", "", false, false};
    bb_page_heading(page, "Scene *a*");
    bb_page_say(page, "%d words: %s", 3, "one two three");
    bb_page_grid(page, "A grid");
    bb_page_column(page, "name", "", "", 0);
    bb_page_column(page, "time", "ms", "How long.", 2);
    bb_page_put_text(page, hostile);
    bb_page_put_figure(page, (bb_estimate){.value = 1.5, .low = 1, .high = 2}, '*');
    bb_page_put_text(page, "\xc3\xa9");
    bb_page_put_figure(page, bb_not_measured, 0);
    bb_page_plot(page, "A plot", &axes);
    bb_page_column(page, "name", "", "", 0);
    bb_page_column(page, "time", "ms", "", 2);
    bb_page_put_text(page, "b");
    bb_page_put_figure(page, (bb_estimate){.value = 3, .low = NAN, .high = NAN}, 0);
    bb_page_picture(page, "none.png", "A picture");
    bb_page_verdict(page, false, "2 answers differ.");
    ASSERT_OK(bb_page_status(page));
    return page;
}

static void a_page_is_text(void **state)
{
    (void)state;
    expect_text(sample_page(), bb_page_print,
                "Scene *a*\n"
                "3 words: one two three\n\n"
                "A grid\n"
                "name                                  time ms\n"
                "</script><b>|`*x*?[31m%FF  1.50 [1.00, 2.00]*\n"
                "\xc3\xa9                                          - \n\n"
                "2 answers differ.\n\n");
}

static void a_page_is_markdown(void **state)
{
    (void)state;
    expect_text(sample_page(), bb_page_markdown,
                "# bvhbench: a title\n\n"
                "## Scene \\*a\\*\n\n"
                "3 words: one two three\n\n"
                "A grid\n\n"
                "| name | time ms |\n"
                "|---|--:|\n"
                "| \\</script\\>\\<b\\>\\|\\`\\*x\\*?\\[31m%FF | **1.50 \\[1.00, 2.00\\]** |\n"
                "| \xc3\xa9 | \\- |\n\n"
                "**2 answers differ.**\n");
}

/* A list, headings of two lines, and figures that are not told from the best. */
static bb_page *marked_page(void)
{
    bb_page *page = new_page();
    bb_page_note(page, "see #12 | `it` at https://e.test");
    bb_page_note(page, "#: rank");
    bb_page_say(page, "after");
    bb_page_grid(page, "");
    bb_page_column(page, "name", "", "", 0);
    bb_page_column(page, "time\nms", "", "", 1);
    bb_page_put_text(page, "a");
    bb_page_put_figure(page, (bb_estimate){.value = 1.5, .low = NAN}, '~');
    bb_page_put_text(page, "b");
    bb_page_put_figure(page, (bb_estimate){.value = 1, .low = NAN}, '*');
    ASSERT_OK(bb_page_status(page));
    return page;
}

static void notes_and_marks(void **state)
{
    (void)state;
    expect_text(marked_page(), bb_page_print,
                "- see #12 | `it` at https://e.test\n"
                "- #: rank\n\n"
                "after\n\n"
                "      time\n"
                "name    ms\n"
                "a     1.5~\n"
                "b     1.0*\n\n");
    expect_text(marked_page(), bb_page_markdown,
                "# bvhbench: a title\n\n"
                "- `see #12 ? ?it? at https://e.test`\n"
                "- \\#: rank\n\n"
                "after\n\n"
                "| name | time ms |\n"
                "|---|--:|\n"
                "| a | 1.5 \\~ |\n"
                "| b | **1.0** |\n");
}

/* A line of a note after the first stands under its words; a grid that is a little too wide loses a
 * blank between columns before it is divided. */
static void what_is_long_is_fitted(void **state)
{
    (void)state;
    char word[49], expected[600];
    bb_page *page = new_page();
    memset(word, 'x', 48);
    word[48] = '\0';
    bb_page_note(page, "%s %s %s", word, word, word);
    bb_page_grid(page, "");
    for (int i = 0; i < 3; i++)
        bb_page_column(page, i == 1 ? "b" : word, "", "", 0);
    for (int i = 0; i < 3; i++)
        bb_page_put_figure(page, (bb_estimate){.value = i, .low = NAN}, 0);
    snprintf(expected, sizeof expected, "- %s %s\n  %s\n\n%s b %s\n%48d 1 %48d\n\n", word, word,
             word, word, word, 0, 2);
    expect_text(page, bb_page_print, expected);
}

static void wide_pages_have_wide_grids(void **state)
{
    (void)state;
    for (int wide = 0; wide < 2; wide++) {
        bb_page *page = new_page();
        if (wide)
            bb_page_widen(page);
        bb_page_grid(page, "");
        for (int i = 0; i < 16; i++)
            bb_page_column(page, "eight...", "", "", 0);
        for (int i = 0; i < 16; i++)
            bb_page_put_figure(page, (bb_estimate){.value = i, .low = NAN}, 0);
        char *text = text_of(page, bb_page_print);
        /* 10 columns each; headings, figures and an empty line, or two times that */
        assert_int_equal(strlen(text), 2 * (16 * 10 - (wide ? 2 : 4)) + (wide ? 3 : 6));
        free(text);
        bb_page_free(page);
    }
}

static void paragraphs_end_at_100_columns(void **state)
{
    (void)state;
    char word[100], expected[320];
    bb_page *page = new_page();
    memset(word, 'x', 99);
    word[99] = '\0';
    bb_page_say(page, "ab %s c  d\ne", word);
    snprintf(expected, sizeof expected, "ab\n%s\nc d e\n\n", word);
    expect_text(page, bb_page_print, expected);
}

static void wide_grids_go_on_below(void **state)
{
    (void)state;
    bb_page *page = new_page();
    bb_page_grid(page, "");
    bb_page_column(page, "name", "", "", 0);
    for (int i = 0; i < 3; i++)
        bb_page_column(page, "a heading of thirty-two letters.", "", "", 0);
    bb_page_column(page, "refused", "", "", 0);
    for (int row = 0; row < 2; row++) {
        bb_page_put_text(page, row == 0 ? "first" : "second");
        for (int i = 0; i < 3; i++) {
            bb_estimate figure = bb_not_measured;
            figure.value = row == 0 ? i : NAN;
            bb_page_put_figure(page, figure, 0);
        }
        bb_page_put_text(page, row == 0 ? "" : "has none");
    }
    expect_text(page, bb_page_print,
                "name    a heading of thirty-two letters.  a heading of thirty-two letters.\n"
                "first                                  0                                 1\n"
                "second                                 -                                 -\n\n"
                "name    a heading of thirty-two letters.  refused\n"
                "first                                  2  \n"
                "second                                 -  has none\n\n");
}

static void pages_are_utf8_that_no_name_ends(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_page *page = sample_page();
    char path[PATH_MAX], *text;
    size_t size;
    snprintf(path, sizeof path, "%s/page.html", folder);
    ASSERT_OK(bb_page_html(page, table, folder, path));
    ASSERT_OK(bb_file_read(path, 1 << 24, "page", &text, &size));
    char *utf8 = bb_utf8_text(text);
    assert_string_equal(utf8, text);
    assert_null(strstr(text, "</script><b>"));
    assert_non_null(strstr(text, "\\u003c/script>\\u003cb>|`*x*\\u001b[31m%FF"));
    assert_non_null(strstr(text, "\"schema\":\"bvhbench-table/1\""));
    free(utf8);
    free(text);
    assert_int_equal(bb_page_html(page, NULL, ".", "/nowhere/all.html"), BB_INVALID);
    bb_page_free(page);
    bb_table_free(table);
}

/* ---- for the browser ---- */

/* Numbers as C writes them beside what the page makes of the same. */
static void add_figures(bb_page *page)
{
    static const double values[] = {
        0,      -0.0,  0.5,     1.5,    2.5,         -2.5,     0.125,    0.375,
        0.15,   1.005, 999.5,   1234.5, 1e6 / 3,     -1e6,     9.995,    0.0095,
        0.0125, 1e-4,  1.25e-5, 1e7,    12250000,    12350000, 1e15,     1.5e300,
        1e-300, 99.95, 99.949,  1e14,   123456789.5, NAN,      INFINITY, 2.0 / 3};
    bb_page_grid(page, "Figures");
    bb_page_column(page, "C", "", "", 0);
    for (int decimals = -1; decimals < 4; decimals++)
        bb_page_column(page, "page", "", "", decimals);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        char all[1024] = "";
        const bb_estimate e = {.value = values[i], .low = values[i] * 0.9, .high = 1 / values[i]};
        for (int decimals = -1; decimals < 4; decimals++) {
            char one[BB_FIGURE_MAX];
            strcat(all, bb_figure_interval(one, e, decimals));
            strcat(all, ";");
        }
        bb_page_put_text(page, all);
        for (int decimals = -1; decimals < 4; decimals++)
            bb_page_put_figure(page, e, 0);
    }
}

static int write_page(const char *to)
{
    static const bb_axes axes = {BB_DRAW_LINES, "nodes", "ms", true, true};
    char path[PATH_MAX];
    bb_page *page = sample_page();
    bb_table *table = sample_table();
    bb_page_plot(page, "Lines", &axes);
    bb_page_column(page, "nodes", "", "", 0);
    bb_page_column(page, "time", "ms", "", 2);
    for (int i = 1; i < 5; i++) {
        bb_page_put_figure(page, (bb_estimate){.value = i, .low = NAN, .high = NAN}, 0);
        bb_page_put_figure(page, (bb_estimate){.value = i * i, .low = NAN, .high = NAN}, 0);
    }
    bb_view_show(&ways, table, (bb_cell){{[BB_SCENE] = "a"}}, page);
    add_figures(page);
    snprintf(path, sizeof path, "%s/page.html", to);
    const bb_status status = bb_page_html(page, table, to, path);
    bb_page_free(page);
    bb_table_free(table);
    return status == BB_OK ? 0 : 1;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_page(argv[2]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_page_is_text),
        cmocka_unit_test(a_page_is_markdown),
        cmocka_unit_test(notes_and_marks),
        cmocka_unit_test(what_is_long_is_fitted),
        cmocka_unit_test(wide_pages_have_wide_grids),
        cmocka_unit_test(paragraphs_end_at_100_columns),
        cmocka_unit_test(wide_grids_go_on_below),
        cmocka_unit_test(pages_are_utf8_that_no_name_ends),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
