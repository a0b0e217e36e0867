/* What tests of pages and of views share: a table of ways, a view of it, pages as text. */
#ifndef BB_TEST_PAGE_FIXTURE_H
#define BB_TEST_PAGE_FIXTURE_H

#include "framework/table/figure.h"
#include "framework/table/page.h"
#include "framework/table/view.h"
#include "tests/fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const bb_column column_build = {
    "build_ms",       "build",        "ms",           "Building the tree.",
    BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS, 2};
static const bb_column column_answer = {
    "answer_ms", "answer", "ms", "Answering.", BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS, 2};
static const bb_column column_note = {"refused",      "refused",         "", "Why.", BB_COLUMN_TEXT,
                                      BB_SENSE_EXACT, BB_BETTER_NEITHER, 0};
static const bb_column column_side = {
    "side", "side", "", "Of the mesh.", BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_NEITHER, 0};

static const char hostile[] = "</script><b>|`*x*\x1b[31m\xff";

/* Answers of `first`, then of twice, three times that: 7 rounds that count. */
static inline void add_way(bb_table *table, const char *scene, const char *builder, double first,
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

static inline bb_table *sample_table(void)
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

static inline bb_page *new_page(void)
{
    bb_page *page;
    ASSERT_OK(bb_page_create("bvhbench: a title", &page));
    return page;
}

static inline bb_page *view_page(const bb_table_view *view, bb_table *table, const char *scene)
{
    bb_page *page = new_page();
    bb_view_show(view, table, (bb_cell){{[BB_SCENE] = scene}}, page);
    ASSERT_OK(bb_page_status(page));
    return page;
}

static inline char *text_of(const bb_page *page, void (*print)(const bb_page *, FILE *))
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    print(page, out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static inline void expect_text(bb_page *page, void (*print)(const bb_page *, FILE *),
                               const char *expected)
{
    char *text = text_of(page, print);
    assert_string_equal(text, expected);
    free(text);
    bb_page_free(page);
}

/* Entry (row, column) of the grid that is the page's first block. */
static inline const bb_item *item_of(const bb_page *page, uint32_t row, const char *heading)
{
    const bb_block *block = bb_page_block(page, 0);
    for (uint32_t i = 0; i < block->head_count; i++)
        if (strcmp(block->heads[i].heading, heading) == 0)
            return &block->items[row * block->head_count + i];
    fail_msg("there is no column '%s'", heading);
    return NULL;
}

static inline void assert_figure(const bb_page *page, uint32_t row, const char *heading,
                                 double expected)
{
    const bb_item *item = item_of(page, row, heading);
    assert_null(item->text);
    assert_true(isnan(expected) ? isnan(item->figure.value)
                                : fabs(item->figure.value - expected) < 1e-12 * fabs(expected));
}

#endif
