/* Blocks in memory. */
#include "framework/table/page.h"

#include "framework/base/steering.h"

#include <assert.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

struct bb_page {
    bool lost; /* memory ran out */
    bool wide;
    char **texts;
    bb_block *blocks;
    uint32_t text_count, block_count;
};

/* Room for one more in *array, which doubles at powers of 2. */
static bool reserve(bb_page *page, void *array, uint32_t count, size_t item)
{
    void **items = array;
    if (page->lost)
        return false;
    if (count > 0 && (count & (count - 1)) != 0)
        return true;
    void *larger = realloc(*items, (count > 0 ? 2 * (size_t)count : 1) * item);
    page->lost = larger == NULL;
    if (larger != NULL)
        *items = larger;
    return larger != NULL;
}

/* A copy that the page owns; a byte that is no UTF-8 becomes %XX. */
static const char *keep(bb_page *page, const char *text)
{
    if (!reserve(page, &page->texts, page->text_count, sizeof *page->texts))
        return "";
    char *copy = bb_utf8_text(text);
    page->lost = copy == NULL;
    if (copy == NULL)
        return "";
    return page->texts[page->text_count++] = copy;
}

static bb_block *add_block(bb_page *page, bb_block_kind kind, const char *text)
{
    if (!reserve(page, &page->blocks, page->block_count, sizeof *page->blocks))
        return NULL;
    bb_block *block = &page->blocks[page->block_count++];
    *block = (bb_block){.kind = kind, .path = ""};
    block->text = keep(page, text);
    return block;
}

/* The grid or plot that was begun last; NULL if there is no memory. */
static bb_block *present(const bb_page *page)
{
    if (page->lost)
        return NULL;
    assert(page->block_count > 0 && page->blocks[page->block_count - 1].kind >= BB_BLOCK_GRID);
    return &page->blocks[page->block_count - 1];
}

bb_status bb_page_create(const char *title, bb_page **out)
{
    bb_page *page = calloc(1, sizeof *page);
    *out = page;
    if (page != NULL)
        keep(page, title);
    if (page != NULL && !page->lost)
        return BB_OK;
    bb_page_free(page);
    *out = NULL;
    return bb_fail(BB_REFUSED, "no memory for a page");
}

void bb_page_free(bb_page *page)
{
    if (page == NULL)
        return;
    for (uint32_t i = 0; i < page->block_count; i++) {
        free(page->blocks[i].heads);
        free(page->blocks[i].items);
    }
    for (uint32_t i = 0; i < page->text_count; i++)
        free(page->texts[i]);
    free(page->blocks);
    free(page->texts);
    free(page);
}

void bb_page_heading(bb_page *page, const char *text)
{
    add_block(page, BB_BLOCK_HEADING, text);
}

static bb_block *add_formatted(bb_page *page, bb_block_kind kind, const char *format, va_list list)
{
    char *text = NULL;
    if (vasprintf(&text, format, list) < 0) {
        page->lost = true;
        return NULL;
    }
    bb_block *block = add_block(page, kind, text);
    free(text);
    return block;
}

void bb_page_say(bb_page *page, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    add_formatted(page, BB_BLOCK_SAY, format, list);
    va_end(list);
}

void bb_page_note(bb_page *page, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    add_formatted(page, BB_BLOCK_NOTE, format, list);
    va_end(list);
}

void bb_page_verdict(bb_page *page, bool good, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    bb_block *block = add_formatted(page, BB_BLOCK_VERDICT, format, list);
    va_end(list);
    if (block != NULL)
        block->good = good;
}

void bb_page_picture(bb_page *page, const char *path, const char *caption)
{
    bb_block *block = add_block(page, BB_BLOCK_PICTURE, caption);
    if (block != NULL)
        block->path = keep(page, path);
}

void bb_page_grid(bb_page *page, const char *caption)
{
    add_block(page, BB_BLOCK_GRID, caption);
}

void bb_page_plot(bb_page *page, const char *caption, const bb_axes *axes)
{
    bb_block *block = add_block(page, BB_BLOCK_PLOT, caption);
    if (block != NULL)
        block->axes = *axes;
}

void bb_page_column(bb_page *page, const char *heading, const char *unit, const char *help,
                    int decimals)
{
    bb_block *block = present(page);
    char *whole = NULL;
    if (block == NULL || !reserve(page, &block->heads, block->head_count, sizeof *block->heads))
        return;
    assert(block->item_count == 0 && block->head_count < BB_HEADS_MAX);
    if (asprintf(&whole, "%s%s%s", heading, unit[0] != '\0' ? " " : "", unit) < 0) {
        page->lost = true;
        return;
    }
    block->heads[block->head_count++] = (bb_head){keep(page, whole), keep(page, help), decimals};
    free(whole);
}

static void add_item(bb_page *page, bb_item item)
{
    bb_block *block = present(page);
    if (block == NULL || !reserve(page, &block->items, block->item_count, sizeof *block->items))
        return;
    assert(block->head_count > 0);
    block->items[block->item_count++] = item;
}

void bb_page_put_text(bb_page *page, const char *text)
{
    add_item(page, (bb_item){.text = keep(page, text)});
}

void bb_page_put_figure(bb_page *page, bb_estimate figure, char mark)
{
    add_item(page, (bb_item){.figure = figure, .mark = mark});
}

void bb_page_widen(bb_page *page)
{
    page->wide = true;
}

bool bb_page_is_wide(const bb_page *page)
{
    return page->wide;
}

void bb_page_lose(bb_page *page)
{
    page->lost = true;
}

bb_status bb_page_status(const bb_page *page)
{
    return page->lost ? bb_fail(BB_REFUSED, "no memory for a page") : BB_OK;
}

bb_status bb_page_end(bb_page *page, void (*show)(const bb_page *, FILE *), FILE *out)
{
    const bb_status status = bb_page_status(page);
    show(page, out);
    bb_page_free(page);
    return status == BB_OK && ferror(out) ? bb_fail(BB_FAILED, "cannot write the results") : status;
}

const char *bb_page_title(const bb_page *page)
{
    return page->texts[0];
}

uint32_t bb_page_block_count(const bb_page *page)
{
    return page->lost ? 0 : page->block_count;
}

const bb_block *bb_page_block(const bb_page *page, uint32_t index)
{
    return &page->blocks[index];
}
