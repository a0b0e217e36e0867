/* A page on the terminal, and as Markdown. */
#include "framework/base/steering.h"
#include "framework/show/page.h"
#include "framework/table/figure.h"

#include <math.h>
#include <string.h>

enum { COLUMNS_MAX = 100 };

/* Letters of the first `length` bytes. */
static int width_of(const char *text, size_t length)
{
    const char *end = text + length;
    int width = 0;
    bool calm;
    for (; text < end; width++)
        text += bb_letter(text, &calm);
    return width;
}

static const char *text_of(char out[BB_FIGURE_MAX], const bb_head *head, const bb_item *item)
{
    return item->text != NULL ? item->text : bb_figure_interval(out, item->figure, head->decimals);
}

/* A column of texts is on the left, one of numbers on the right. */
static bool is_text(const bb_block *block, uint32_t column)
{
    for (uint32_t i = column; i < block->item_count; i += block->head_count)
        if (block->items[i].text != NULL)
            return true;
    return false;
}

/* ---- the terminal ---- */

static void print_letter(const char **text, FILE *out)
{
    bool calm;
    const int length = bb_letter(*text, &calm);
    if (calm)
        fwrite(*text, 1, (size_t)length, out);
    else
        fputc('?', out);
    *text += length;
}

static void print_calm(const char *text, FILE *out)
{
    while (*text != '\0')
        print_letter(&text, out);
}

static void print_paragraph(const char *text, FILE *out)
{
    int column = 0;
    while (*text != '\0') {
        const size_t length = strcspn(text, " \n");
        const int width = width_of(text, length);
        const bool fits = column > 0 && column + 1 + width <= COLUMNS_MAX;
        if (column > 0)
            fputc(fits ? ' ' : '\n', out);
        column = fits ? column + 1 + width : width;
        for (const char *at = text; at < text + length;)
            print_letter(&at, out);
        text += length + strspn(text + length, " \n");
    }
    fputc('\n', out);
}

/* The last text of a line ends there. */
static void print_entry(const char *text, int width, bool left, bool last, FILE *out)
{
    const int blanks = width - width_of(text, strlen(text));
    fprintf(out, "%*s", left ? 0 : blanks, "");
    print_calm(text, out);
    fprintf(out, "%*s", left && !last ? blanks : 0, "");
    fputs(last ? "\n" : "  ", out);
}

typedef struct column {
    int width;
    bool left, marked; /* marked: the best have a star */
} column;

static const char *marked(char out[BB_FIGURE_MAX + 2], const column *c, const bb_head *head,
                          const bb_item *item)
{
    char figure[BB_FIGURE_MAX];
    if (item->text != NULL)
        return item->text;
    snprintf(out, BB_FIGURE_MAX + 2, "%s%s", text_of(figure, head, item),
             !c->marked   ? ""
             : item->best ? "*"
                          : " ");
    return out;
}

static column measure_column(const bb_block *block, uint32_t i)
{
    const bb_head *head = &block->heads[i];
    column c = {width_of(head->heading, strlen(head->heading)), is_text(block, i), false};
    for (uint32_t k = i; k < block->item_count; k += block->head_count)
        c.marked = c.marked || block->items[k].best;
    for (uint32_t k = i; k < block->item_count; k += block->head_count) {
        char text[BB_FIGURE_MAX + 2];
        const char *shown = marked(text, &c, head, &block->items[k]);
        const int width = width_of(shown, strlen(shown));
        c.width = width > c.width ? width : c.width;
    }
    return c;
}

/* Columns of a grid that stand side by side: its names, and those from `begin` to before `end`. */
typedef struct part {
    uint32_t names, begin, end;
} part;

static bool is_empty(const bb_item *item)
{
    return item->text != NULL ? item->text[0] == '\0' : !isfinite(item->figure.value);
}

/* Row `items` of the grid; its headings, if that is NULL. */
static void print_row(const bb_block *block, const column *columns, part p, const bb_item *items,
                      FILE *out)
{
    for (uint32_t i = 0; i < p.end; i++) {
        const column *c = &columns[i];
        const bb_head *head = &block->heads[i];
        char text[BB_FIGURE_MAX + 2];
        if (i < p.names || i >= p.begin)
            print_entry(items == NULL ? head->heading : marked(text, c, head, &items[i]), c->width,
                        c->left, i + 1 == p.end, out);
    }
}

/* All rows in the first part, in others those that have something there. */
static void print_part(const bb_block *block, const column *columns, part p, FILE *out)
{
    print_row(block, columns, p, NULL, out);
    for (uint32_t k = 0; k < block->item_count; k += block->head_count) {
        const bb_item *items = &block->items[k];
        uint32_t i = p.begin;
        while (p.begin > p.names && i < p.end && is_empty(&items[i]))
            i++;
        if (i < p.end)
            print_row(block, columns, p, items, out);
    }
}

/* Texts on the left are the names of rows. A grid that is too wide goes on below, under the same
 * names, unless these leave no room. */
static void print_grid(const bb_block *block, FILE *out)
{
    const uint32_t count = block->head_count;
    column columns[BB_HEADS_MAX];
    part p = {0, 0, 0};
    int names = 0;
    if (block->text[0] != '\0')
        print_paragraph(block->text, out);
    for (uint32_t i = 0; i < count; i++)
        columns[i] = measure_column(block, i);
    for (; p.names + 1 < count && columns[p.names].left; p.names++)
        names += columns[p.names].width + 2;
    for (p.begin = p.names; p.begin < count; p.begin = p.end) {
        int width = names + columns[p.begin].width;
        for (p.end = p.begin + 1; p.end < count; p.end++) {
            width += 2 + columns[p.end].width;
            if (width > COLUMNS_MAX && names < COLUMNS_MAX)
                break;
        }
        fputs(p.begin > p.names ? "\n" : "", out);
        print_part(block, columns, p, out);
    }
}

void bb_page_print(const bb_page *page, FILE *out)
{
    for (uint32_t i = 0; i < bb_page_block_count(page); i++) {
        const bb_block *block = bb_page_block(page, i);
        if (block->kind == BB_BLOCK_GRID)
            print_grid(block, out);
        else if (block->kind <= BB_BLOCK_VERDICT)
            print_paragraph(block->text, out);
        else
            continue;
        fputs(block->kind == BB_BLOCK_HEADING ? "" : "\n", out);
    }
}

/* ---- Markdown ---- */

/* What is markup is escaped, and lines are joined. */
static void mark_down(const char *text, FILE *out)
{
    const char *begin = text;
    while (*text != '\0') {
        const char *markup = text == begin ? "\\`*_[]<>|&~#+-" : "\\`*_[]<>|&~#";
        if (strchr(markup, *text) != NULL)
            fputc('\\', out);
        if (*text == '\n') {
            fputc(' ', out);
            text++;
        } else {
            print_letter(&text, out);
        }
    }
}

static void mark_down_grid(const bb_block *block, FILE *out)
{
    char figure[BB_FIGURE_MAX];
    if (block->text[0] != '\0') {
        mark_down(block->text, out);
        fputs("\n\n", out);
    }
    for (uint32_t i = 0; i < block->head_count; i++) {
        fputs("| ", out);
        mark_down(block->heads[i].heading, out);
        fputs(i + 1 < block->head_count ? " " : " |\n", out);
    }
    for (uint32_t i = 0; i < block->head_count; i++)
        fputs(is_text(block, i) ? "|---" : "|--:", out);
    for (uint32_t k = 0; k < block->item_count; k++) {
        const bb_item *item = &block->items[k];
        const char *around = item->best ? "**" : "";
        const uint32_t column = k % block->head_count;
        fprintf(out, "%s%s", column == 0 ? "|\n| " : "| ", around);
        mark_down(text_of(figure, &block->heads[column], item), out);
        fprintf(out, "%s ", around);
    }
    fputc('|', out);
}

void bb_page_markdown(const bb_page *page, FILE *out)
{
    fputs("# ", out);
    mark_down(bb_page_title(page), out);
    for (uint32_t i = 0; i < bb_page_block_count(page); i++) {
        static const char *const around[][2] = {{"\n\n## ", ""}, {"\n\n", ""}, {"\n\n**", "**"}};
        const bb_block *block = bb_page_block(page, i);
        if (block->kind == BB_BLOCK_GRID) {
            fputs("\n\n", out);
            mark_down_grid(block, out);
        } else if (block->kind <= BB_BLOCK_VERDICT) {
            fputs(around[block->kind][0], out);
            mark_down(block->text, out);
            fputs(around[block->kind][1], out);
        }
    }
    fputc('\n', out);
}
