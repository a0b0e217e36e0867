/* Views of tables: which rows and columns they show, what is best, verdicts. */
#include "framework/table/outline.h"
#include "tests/page_fixture.h"

static const bb_column column_status = BB_TEXT_COLUMN("status", "status", "How it went.");

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

/* ---- names that make columns ---- */

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

/* ---- verdicts ---- */

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ratios_are_to_the_first_row),
        cmocka_unit_test(empty_columns_are_left_out),
        cmocka_unit_test(rows_of_several_scenes_are_geometric_means),
        cmocka_unit_test(rows_are_ordered_the_best_first),
        cmocka_unit_test(rows_are_chosen_by_question_and_text),
        cmocka_unit_test(more_rows_are_counted),
        cmocka_unit_test(ties_are_marked),
        cmocka_unit_test(dimensions_choose_rows),
        cmocka_unit_test(names_make_columns_and_grids),
        cmocka_unit_test(names_make_curves),
        cmocka_unit_test(frames_do_not_compete),
        cmocka_unit_test(many_names_make_another_grid),
        cmocka_unit_test(plots_need_their_x),
        cmocka_unit_test(verdicts_need_answers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
