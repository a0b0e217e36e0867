/* Pages of results: blocks on the terminal, as Markdown and as HTML; views of tables.
 *
 *   test_page --write FOLDER      writes page.html, which is looked at in a browser
 */
#include "framework/base/file.h"
#include "framework/base/steering.h"
#include "framework/table/figure.h"
#include "framework/table/outline.h"
#include "tests/program_fixture.h"

#include <limits.h>
#include <math.h>

static const bb_column column_build = {
    "build_ms",       "build",        "ms",           "Building the tree.",
    BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS, 2};
static const bb_column column_answer = {
    "answer_ms", "answer", "ms", "Answering.", BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS, 2};
static const bb_column column_note = {"refused",      "refused",         "", "Why.", BB_COLUMN_TEXT,
                                      BB_SENSE_EXACT, BB_BETTER_NEITHER, 0};
static const bb_column column_status = BB_TEXT_COLUMN("status", "status", "How it went.");
static const bb_column column_side = {
    "side", "side", "", "Of the mesh.", BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_NEITHER, 0};

static const char hostile[] = "</script><b>|`*x*\x1b[31m\xff";

/* ---- what is tested ---- */

/* Answers of `first`, then of twice, three times that: 7 rounds that count. */
static void add_way(bb_table *table, const char *scene, const char *builder, double first,
                    bool tree)
{
    const bb_cell cell = {{[BB_SCENE] = scene, [BB_BUILDER] = builder, [BB_INTERSECTOR] = "skip"}};
    const uint32_t row = bb_table_row(table, cell);
    bb_samples rounds = {0};
    for (int i = 0; i < 8; i++)
        bb_samples_add(&rounds, first * (1 + i));
    bb_table_set_rounds(table, row, &column_answer, &rounds);
    if (tree)
        bb_table_set_rounds(table, row, &column_build, &rounds);
}

static bb_table *sample_table(void)
{
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    for (int s = 0; s < 2; s++) {
        const char *scene = s == 0 ? "a" : "b";
        const uint32_t row = bb_table_row(table, (bb_cell){{[BB_SCENE] = scene}});
        bb_table_set_number(table, row, &column_side, 4 + s);
        add_way(table, scene, "lbvh", 1 + s, false);
        add_way(table, scene, "sah", s == 0 ? 2 : 16, true);
    }
    const bb_cell refused = {{[BB_SCENE] = "b", [BB_BUILDER] = hostile, [BB_INTERSECTOR] = "skip"}};
    bb_table_set_text(table, bb_table_row(table, refused), &column_note, "has no octree");
    ASSERT_OK(bb_table_status(table));
    return table;
}

static const bb_table_view ways = {
    .caption = "Ways",
    .with = BB_SET(BB_INTERSECTOR),
    .rows = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
    .columns = {{{"build_ms"}, NULL, false},
                {{"answer_ms"}, NULL, false},
                {{"answer_ms"}, "answer / first", true},
                {{"build_ms", "answer_ms"}, "all / first", true},
                {{"nodes"}, NULL, false},
                {{"refused"}, NULL, false}},
};

static bb_page *new_page(void)
{
    bb_page *page;
    ASSERT_OK(bb_page_create("bvhbench: a title", &page));
    return page;
}

static bb_page *view_page(const bb_table_view *view, bb_table *table, const char *scene)
{
    bb_page *page = new_page();
    bb_view_show(view, table, (bb_cell){{[BB_SCENE] = scene}}, page);
    ASSERT_OK(bb_page_status(page));
    return page;
}

static char *text_of(const bb_page *page, void (*print)(const bb_page *, FILE *))
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    print(page, out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void expect_text(bb_page *page, void (*print)(const bb_page *, FILE *), const char *expected)
{
    char *text = text_of(page, print);
    assert_string_equal(text, expected);
    free(text);
    bb_page_free(page);
}

/* Entry (row, column) of the grid that is the page's first block. */
static const bb_item *item_of(const bb_page *page, uint32_t row, const char *heading)
{
    const bb_block *block = bb_page_block(page, 0);
    for (uint32_t i = 0; i < block->head_count; i++)
        if (strcmp(block->heads[i].heading, heading) == 0)
            return &block->items[row * block->head_count + i];
    fail_msg("there is no column '%s'", heading);
    return NULL;
}

static void assert_figure(const bb_page *page, uint32_t row, const char *heading, double expected)
{
    const bb_item *item = item_of(page, row, heading);
    assert_null(item->text);
    assert_true(isnan(expected) ? isnan(item->figure.value)
                                : fabs(item->figure.value - expected) < 1e-12 * fabs(expected));
}

/* ---- views ---- */

static void ratios_are_to_the_first_row(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_page *page = view_page(&ways, table, "a");
    assert_figure(page, 0, "answer ms", 5);
    assert_figure(page, 0, "answer / first", 1);
    assert_figure(page, 1, "answer / first", 2);
    assert_figure(page, 1, "all / first", 4); /* the first has no build */
    assert_true(isfinite(item_of(page, 1, "all / first")->figure.low));
    assert_figure(page, 0, "build ms", NAN);
    assert_string_equal(item_of(page, 1, "builder")->text, "sah");
    bb_page_free(page);
    bb_table_free(table);
}

/* No column for nodes, which nobody has; of scene b one for refusals. */
static void empty_columns_are_left_out(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_page *page = view_page(&ways, table, "a");
    assert_int_equal(bb_page_block(page, 0)->head_count, 6);
    bb_page_free(page);
    page = view_page(&ways, table, "b");
    assert_int_equal(bb_page_block(page, 0)->head_count, 7);
    assert_string_equal(item_of(page, 2, "refused")->text, "has no octree");
    assert_figure(page, 2, "answer ms", NAN);
    bb_page_free(page);
    page = view_page(&ways, table, "c");
    assert_int_equal(bb_page_block_count(page), 0);
    bb_page_free(page);
    bb_table_free(table);
}

static void rows_of_several_scenes_are_geometric_means(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_page *page = view_page(&ways, table, NULL);
    assert_figure(page, 0, "answer ms", 5 * sqrt(2));
    assert_figure(page, 1, "answer / first", 4); /* of 2 and 8 */
    assert_figure(page, 2, "answer / first", NAN);
    bb_page_free(page);
    bb_table_free(table);
}

static void rows_are_ordered_the_best_first(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_table_view view = ways;
    view.rows |= BB_SET(BB_SCENE);
    view.order = "answer_ms";
    bb_page *page = view_page(&view, table, NULL);
    static const char *const scenes[] = {"a", "a", "b", "b", "b"};
    static const double answers[] = {5, 10, 10, 80, NAN};
    for (uint32_t i = 0; i < 5; i++) {
        assert_string_equal(item_of(page, i, "scene")->text, scenes[i]);
        assert_figure(page, i, "answer ms", answers[i]);
    }
    bb_page_free(page);
    bb_table_free(table);
}

static void rows_are_chosen_by_question_and_text(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_table_view view = ways;
    view.having = "refused";
    bb_page *page = view_page(&view, table, "b");
    assert_int_equal(bb_page_block(page, 0)->item_count, bb_page_block(page, 0)->head_count);
    assert_string_equal(item_of(page, 0, "refused")->text, "has no octree");
    bb_page_free(page);
    view.having = NULL;
    view.question = "z";
    page = view_page(&view, table, "b");
    assert_int_equal(bb_page_block_count(page), 0);
    bb_page_free(page);
    const bb_cell cell = {
        {[BB_SCENE] = "b", [BB_QUESTION] = "z", [BB_BUILDER] = "aac", [BB_INTERSECTOR] = "skip"}};
    bb_table_set_text(table, bb_table_row(table, cell), &column_note, "asked");
    page = view_page(&view, table, "b");
    assert_string_equal(item_of(page, 0, "builder")->text, "aac");
    bb_page_free(page);
    bb_table_free(table);
}

static void more_rows_are_counted(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_table_view view = ways;
    for (view.most = 1; view.most <= 4; view.most++) {
        bb_page *page = view_page(&view, table, "b");
        const uint32_t shown = view.most < 3 ? view.most : 3;
        assert_int_equal(bb_page_block(page, 0)->item_count,
                         shown * bb_page_block(page, 0)->head_count);
        assert_int_equal(bb_page_block_count(page), shown < 3 ? 2 : 1);
        if (view.most == 2)
            assert_string_equal(bb_page_block(page, 1)->text, "and 1 more");
        bb_page_free(page);
    }
    bb_table_free(table);
}

/* Those whose interval includes the best value are best, too. */
static void ties_are_marked(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    add_way(table, "a", "tied", 1.1, false);
    bb_page *page = view_page(&ways, table, "a");
    assert_true(item_of(page, 0, "answer ms")->mark == '*');
    assert_true(item_of(page, 2, "answer ms")->mark == '*');
    assert_false(item_of(page, 1, "answer / first")->mark == '*');
    assert_false(item_of(page, 1, "build ms")->mark == '*'); /* nobody else has it */
    bb_page_free(page);
    bb_table_free(table);
}

static void dimensions_choose_rows(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_table_view view = {.caption = "Scenes",
                          .with = BB_SET(BB_SCENE),
                          .without = BB_SET(BB_BUILDER),
                          .rows = BB_SET(BB_SCENE),
                          .columns = {{{"side"}, NULL, false}}};
    expect_text(view_page(&view, table, NULL), bb_page_print,
                "Scenes\nscene  side\na         4\nb         5\n\n");
    bb_page *page = new_page();
    bb_view_say(table, (bb_cell){{[BB_SCENE] = "b"}}, page);
    bb_view_say(table, (bb_cell){{[BB_SCENE] = "c"}}, page);
    expect_text(page, bb_page_print, "side 5\n\n");
    bb_table_free(table);
}

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

/* Times of frames 1 and 2 of two builders by two searches: 1 to 8. */
static bb_table *frames_table(void)
{
    bb_table *table;
    ASSERT_OK(bb_table_create("animate", &table));
    for (int i = 0; i < 8; i++) {
        const bb_cell cell = {{[BB_SCENE] = "a",
                               [BB_FRAME] = i < 4 ? "9 rays" : "10 rays",
                               [BB_BUILDER] = i % 4 < 2 ? "lbvh" : "sah",
                               [BB_INTERSECTOR] = i % 2 == 0 ? "skip" : "stack"}};
        bb_table_set_number(table, bb_table_row(table, cell), &column_side, 1 + i);
    }
    bb_table_set_text(table, 0, &column_note, "why");
    ASSERT_OK(bb_table_status(table));
    return table;
}

static const bb_table_view by_frame = {
    .caption = "Sides",
    .with = BB_SET(BB_FRAME),
    .rows = BB_SET(BB_FRAME),
    .across = BB_SET(BB_BUILDER),
    .each = BB_SET(BB_INTERSECTOR),
    .columns = {{{"side"}, NULL, false}, {{"refused"}, "", false}}};

static void names_make_columns_and_grids(void **state)
{
    (void)state;
    bb_table *table = frames_table();
    expect_text(view_page(&by_frame, table, "a"), bb_page_print,
                "Sides, skip\n"
                "frame    lbvh side  sah side  lbvh\n"
                "9 rays           1         3  why\n"
                "10 rays          5         7  \n\n"
                "Sides, stack\n"
                "frame    lbvh side  sah side\n"
                "9 rays           2         4\n"
                "10 rays          6         8\n\n");
    bb_table_free(table);
}

/* A curve for each name across, over the numbers with which the names of rows begin. */
static void names_make_curves(void **state)
{
    (void)state;
    static const bb_axes axes = {BB_DRAW_LINES, "rays", "side", true, true};
    bb_table *table = frames_table();
    bb_table_view view = by_frame;
    view.axes = &axes;
    view.columns[1].parts[0] = NULL;
    bb_page *page = view_page(&view, table, "a");
    assert_int_equal(bb_page_block_count(page), 2);
    assert_string_equal(bb_page_block(page, 1)->text, "Sides, stack");
    assert_figure(page, 0, "frame", 9);
    assert_figure(page, 1, "frame", 10);
    assert_figure(page, 1, "sah side", 7);
    bb_page_free(page);
    view.rows = BB_SET(BB_BUILDER); /* which are no numbers; but there is a first column */
    view.across = BB_SET(BB_FRAME);
    page = view_page(&view, table, "a");
    assert_string_equal(item_of(page, 1, "builder")->text, "sah");
    assert_figure(page, 1, "10 rays side", 7);
    bb_page_free(page);
    bb_table_free(table);
}

/* Between frames there is no best one; between builders there is. */
static void frames_do_not_compete(void **state)
{
    (void)state;
    bb_table *table = frames_table();
    bb_column less = column_side;
    bb_table *better;
    less.better = BB_BETTER_LESS;
    ASSERT_OK(bb_table_create("animate", &better));
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        bb_cell cell;
        for (int d = 0; d < BB_DIMENSIONS; d++)
            cell.names[d] = bb_table_name(table, row, (bb_dimension)d);
        bb_table_set_number(better, bb_table_row(better, cell), &less, 1 + row);
    }
    bb_table_view view = by_frame;
    bb_page *page = view_page(&view, better, "a");
    assert_false(item_of(page, 0, "lbvh side")->mark == '*');
    bb_page_free(page);
    view.rows = BB_SET(BB_BUILDER);
    view.across = BB_SET(BB_FRAME);
    page = view_page(&view, better, "a");
    assert_true(item_of(page, 0, "9 rays side")->mark == '*');
    assert_false(item_of(page, 1, "9 rays side")->mark == '*');
    bb_page_free(page);
    bb_table_free(better);
    bb_table_free(table);
}

/* A grid has at most BB_HEADS_MAX columns: those of other names make another one. */
static void many_names_make_another_grid(void **state)
{
    (void)state;
    bb_table *table;
    uint32_t heads = 0;
    ASSERT_OK(bb_table_create("animate", &table));
    for (int i = 0; i < 2 * BB_HEADS_MAX; i++) {
        char name[16];
        snprintf(name, sizeof name, "b%d", i);
        const bb_cell cell = {{[BB_SCENE] = "a", [BB_FRAME] = "1", [BB_BUILDER] = name}};
        bb_table_set_number(table, bb_table_row(table, cell), &column_side, i);
    }
    bb_page *page = view_page(&by_frame, table, "a");
    assert_true(bb_page_block_count(page) > 2);
    for (uint32_t i = 0; i < bb_page_block_count(page); i++)
        heads += bb_page_block(page, i)->head_count - 1; /* without the frame */
    assert_int_equal(heads, 2 * BB_HEADS_MAX);
    bb_page_free(page);
    bb_table_free(table);
}

/* Without its x a curve would show one of its other columns by another. */
static void plots_need_their_x(void **state)
{
    (void)state;
    static const bb_axes axes = {BB_DRAW_LINES, "nodes", "ms", true, true};
    bb_table *table = sample_table();
    bb_table_view view = ways;
    view.axes = &axes;
    bb_page *page = view_page(&view, table, "b");
    assert_int_equal(bb_page_block_count(page), 1);
    bb_page_free(page);
    view.columns[0].parts[0] = "nodes";
    page = view_page(&view, table, "b");
    assert_int_equal(bb_page_block_count(page), 0);
    bb_page_free(page);
    bb_table_free(table);
}

static void expect_verdict(const bb_table *table, bool good, const char *text)
{
    static const bb_page_outline outline = {
        .title = "", .wrong = "side", .well = "All are the same.", .ill = "differ."};
    bb_page *page;
    ASSERT_OK(bb_outline_page(&outline, table, &page));
    const bb_block *block = bb_page_block(page, 0);
    assert_int_equal(block->kind, BB_BLOCK_VERDICT);
    assert_int_equal(block->good, good);
    assert_string_equal(block->text, text);
    bb_page_free(page);
}

/* All is well only if something was compared; a table from a file may have numbers below 0. */
static void verdicts_need_answers(void **state)
{
    (void)state;
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    expect_verdict(table, false, "No answer was compared.");
    const uint32_t a = bb_table_row(table, (bb_cell){{[BB_SCENE] = "a"}});
    const uint32_t b = bb_table_row(table, (bb_cell){{[BB_SCENE] = "b"}});
    bb_table_set_number(table, a, &column_side, 0);
    expect_verdict(table, true, "All are the same.");
    bb_table_set_number(table, a, &column_side, -1);
    bb_table_set_number(table, b, &column_side, 1);
    expect_verdict(table, false, "2 differ.");
    bb_table_set_number(table, a, &column_side, 0);
    bb_table_set_number(table, b, &column_side, 0);
    const bb_cell sah = {{[BB_SCENE] = "a", [BB_BUILDER] = "sah"}};
    bb_table_set_text(table, bb_table_row(table, sah), &column_status, "refused");
    bb_table_set_text(table, bb_table_row(table, sah), &column_note, "it is broken");
    expect_verdict(table, true, "All are the same.");
    bb_table_set_text(table, bb_table_row(table, sah), &column_status, "failed");
    expect_verdict(table, false, "sah failed: it is broken");
    bb_table_free(table);
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
        cmocka_unit_test(ratios_are_to_the_first_row),
        cmocka_unit_test(empty_columns_are_left_out),
        cmocka_unit_test(rows_of_several_scenes_are_geometric_means),
        cmocka_unit_test(rows_are_ordered_the_best_first),
        cmocka_unit_test(rows_are_chosen_by_question_and_text),
        cmocka_unit_test(more_rows_are_counted),
        cmocka_unit_test(ties_are_marked),
        cmocka_unit_test(dimensions_choose_rows),
        cmocka_unit_test(a_page_is_text),
        cmocka_unit_test(a_page_is_markdown),
        cmocka_unit_test(notes_and_marks),
        cmocka_unit_test(what_is_long_is_fitted),
        cmocka_unit_test(wide_pages_have_wide_grids),
        cmocka_unit_test(paragraphs_end_at_100_columns),
        cmocka_unit_test(names_make_columns_and_grids),
        cmocka_unit_test(names_make_curves),
        cmocka_unit_test(frames_do_not_compete),
        cmocka_unit_test(many_names_make_another_grid),
        cmocka_unit_test(plots_need_their_x),
        cmocka_unit_test(verdicts_need_answers),
        cmocka_unit_test(wide_grids_go_on_below),
        cmocka_unit_test(pages_are_utf8_that_no_name_ends),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
