/* A page on the terminal, and as Markdown. */
#include "framework/base/steering.h"
#include "framework/table/figure.h"
#include "framework/table/page.h"

#include <math.h>
#include <string.h>

enum { COLUMNS_MAX = 100, WIDE_MAX = 160 };

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

/* Lines after the first are indented by the width of `before`. */
static void print_paragraph(const char *before, const char *text, FILE *out)
{
    const int indent = (int)strlen(before);
    int column = indent;
    fputs(before, out);
    while (*text != '\0') {
        const size_t length = strcspn(text, " \n");
        const int width = width_of(text, length);
        const bool fits = column > indent && column + 1 + width <= COLUMNS_MAX;
        if (column > indent)
            fprintf(out, fits ? " " : "\n%*s", fits ? 0 : indent, "");
        column = fits ? column + 1 + width : indent + width;
        for (const char *at = text; at < text + length;)
            print_letter(&at, out);
        text += length + strspn(text + length, " \n");
    }
    fputc('\n', out);
}

/* `gap` blanks follow; the last text of a line ends there. */
static void print_entry(const char *text, int width, bool left, int gap, FILE *out)
{
    const int blanks = width - width_of(text, strlen(text));
    fprintf(out, "%*s", left ? 0 : blanks, "");
    print_calm(text, out);
    fprintf(out, "%*s", gap + (left && gap > 0 ? blanks : 0), "");
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
             c->marked ? (char[]){item->mark != 0 ? item->mark : ' ', '\0'} : "");
    return out;
}

enum { HEADING_MAX = 80 };

/* The last line of a heading, or what stands above it. */
static const char *line_of(char out[HEADING_MAX], const bb_head *head, bool last)
{
    const char *end = strchr(head->heading, '\n');
    if (last)
        return end != NULL ? end + 1 : head->heading;
    snprintf(out, HEADING_MAX, "%.*s", end != NULL ? (int)(end - head->heading) : 0, head->heading);
    return out;
}

static column measure_column(const bb_block *block, uint32_t i)
{
    const bb_head *head = &block->heads[i];
    column c = {0, is_text(block, i), false};
    for (int last = 0; last < 2; last++) {
        char text[HEADING_MAX];
        const char *line = line_of(text, head, last);
        const int width = width_of(line, strlen(line));
        c.width = width > c.width ? width : c.width;
    }
    for (uint32_t k = i; k < block->item_count; k += block->head_count)
        c.marked = c.marked || block->items[k].mark != 0;
    for (uint32_t k = i; k < block->item_count; k += block->head_count) {
        char text[BB_FIGURE_MAX + 2];
        const char *shown = marked(text, &c, head, &block->items[k]);
        const int width = width_of(shown, strlen(shown));
        c.width = width > c.width ? width : c.width;
    }
    return c;
}

/* Columns of a grid that stand side by side: its names, and those from `begin` to before `end`,
 * with `gap` blanks between them. */
typedef struct part {
    uint32_t names, begin, end;
    int gap;
} part;

static bool is_empty(const bb_item *item)
{
    return item->text != NULL ? item->text[0] == '\0' : !isfinite(item->figure.value);
}

/* Row `items` of the grid; if that is NULL, a line of its headings. */
static void print_row(const bb_block *block, const column *columns, part p, const bb_item *items,
                      bool last, FILE *out)
{
    for (uint32_t i = 0; i < p.end; i++) {
        const column *c = &columns[i];
        const bb_head *head = &block->heads[i];
        char text[BB_FIGURE_MAX + 2];
        if (i < p.names || i >= p.begin)
            print_entry(items == NULL ? line_of(text, head, last)
                                      : marked(text, c, head, &items[i]),
                        c->width, c->left, i + 1 < p.end ? p.gap : 0, out);
    }
    fputc('\n', out);
}

static bool has_two_lines(const bb_block *block)
{
    uint32_t i = 0;
    while (i < block->head_count && strchr(block->heads[i].heading, '\n') == NULL)
        i++;
    return i < block->head_count;
}

/* The first part has all rows, others those that have something there. */
static bool has_row(const bb_block *block, part p, uint32_t first_item)
{
    uint32_t i = p.begin;
    while (p.begin > p.names && i < p.end && is_empty(&block->items[first_item + i]))
        i++;
    return i < p.end;
}

static void print_part(const bb_block *block, const column *columns, part p, FILE *out)
{
    uint32_t first = 0;
    while (first < block->item_count && !has_row(block, p, first))
        first += block->head_count;
    if (first >= block->item_count && p.begin > p.names)
        return;
    fputs(p.begin > p.names ? "\n" : "", out);
    if (has_two_lines(block))
        print_row(block, columns, p, NULL, false, out);
    print_row(block, columns, p, NULL, true, out);
    for (uint32_t k = 0; k < block->item_count; k += block->head_count) {
        if (has_row(block, p, k))
            print_row(block, columns, p, &block->items[k], true, out);
    }
}

/* Blanks between columns: two, or one if that makes room for all of them. */
static int gap_of(const column *columns, uint32_t count, int limit)
{
    int width = 0;
    for (uint32_t i = 0; i < count; i++)
        width += columns[i].width;
    return width + 2 * (int)(count - 1) > limit && width + (int)(count - 1) <= limit ? 1 : 2;
}

/* Texts on the left are the names of rows. A grid that is too wide goes on below, under the same
 * names, unless these leave no room. */
static void print_grid(const bb_block *block, int limit, FILE *out)
{
    const uint32_t count = block->head_count;
    column columns[BB_HEADS_MAX];
    part p = {0, 0, 0, 0};
    int names = 0;
    if (block->text[0] != '\0')
        print_paragraph("", block->text, out);
    for (uint32_t i = 0; i < count; i++)
        columns[i] = measure_column(block, i);
    p.gap = gap_of(columns, count, limit);
    for (; p.names + 1 < count && columns[p.names].left; p.names++)
        names += columns[p.names].width + p.gap;
    for (p.begin = p.names; p.begin < count; p.begin = p.end) {
        int width = names + columns[p.begin].width;
        for (p.end = p.begin + 1; p.end < count; p.end++) {
            width += p.gap + columns[p.end].width;
            if (width > limit && names < limit)
                break;
        }
        print_part(block, columns, p, out);
    }
}

/* Notes that follow each other are one list. */
static bool goes_on(const bb_page *page, uint32_t i)
{
    return bb_page_block(page, i)->kind == BB_BLOCK_NOTE && i + 1 < bb_page_block_count(page) &&
           bb_page_block(page, i + 1)->kind == BB_BLOCK_NOTE;
}

void bb_page_print(const bb_page *page, FILE *out)
{
    for (uint32_t i = 0; i < bb_page_block_count(page); i++) {
        const bb_block *block = bb_page_block(page, i);
        if (block->kind == BB_BLOCK_GRID)
            print_grid(block, bb_page_is_wide(page) ? WIDE_MAX : COLUMNS_MAX, out);
        else if (block->kind <= BB_BLOCK_VERDICT)
            print_paragraph(block->kind == BB_BLOCK_NOTE ? "- " : "", block->text, out);
        else
            continue;
        if (block->kind != BB_BLOCK_HEADING && !goes_on(page, i))
            fputc('\n', out);
    }
}

/* ---- Markdown ---- */

/* Whether it holds an address, a mention, a formula or a reference (#1), which no escape prevents.
 */
static bool needs_code(const char *text)
{
    for (const char *at = strchr(text, '#'); at != NULL; at = strchr(at + 1, '#'))
        if (at[1] >= '0' && at[1] <= '9')
            return true;
    return strpbrk(text, "@$") != NULL || strstr(text, "://") != NULL ||
           strstr(text, "www.") != NULL;
}

/* What is markup is escaped, or stands in a span of code. Lines are joined. */
static void mark_down(const char *text, FILE *out)
{
    const char *begin = text;
    const bool code = needs_code(text);
    fputs(code ? "`" : "", out);
    while (*text != '\0') {
        const char *markup = text == begin ? "\\`*_[]<>|&~#+-" : "\\`*_[]<>|&~#";
        if (!code && strchr(markup, *text) != NULL)
            fputc('\\', out);
        if (*text == '\n' || (code && strchr("`|", *text) != NULL))
            fputc(*text++ == '\n' ? ' ' : '?', out);
        else
            print_letter(&text, out);
    }
    fputs(code ? "`" : "", out);
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
        const char *around = item->mark == '*' ? "**" : "";
        const uint32_t column = k % block->head_count;
        fprintf(out, "%s%s", column == 0 ? "|\n| " : "| ", around);
        mark_down(text_of(figure, &block->heads[column], item), out);
        fprintf(out, "%s ", item->mark == '~' ? " \\~" : item->mark == '!' ? " !" : around);
    }
    fputc('|', out);
}

void bb_page_markdown(const bb_page *page, FILE *out)
{
    fputs("# ", out);
    mark_down(bb_page_title(page), out);
    for (uint32_t i = 0; i < bb_page_block_count(page); i++) {
        static const char *const around[][2] = {
            {"\n\n## ", ""}, {"\n\n", ""}, {"\n\n- ", ""}, {"\n\n**", "**"}};
        const bb_block *block = bb_page_block(page, i);
        if (block->kind == BB_BLOCK_GRID) {
            fputs("\n\n", out);
            mark_down_grid(block, out);
        } else if (block->kind <= BB_BLOCK_VERDICT) {
            fputs(around[block->kind][0] + (i > 0 && goes_on(page, i - 1)), out);
            mark_down(block->text, out);
            fputs(around[block->kind][1], out);
        }
    }
    fputc('\n', out);
}
