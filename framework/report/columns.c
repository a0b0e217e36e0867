#include "framework/report/columns.h"

#include "framework/base/steering.h"

#include <math.h>
#include <string.h>

int bb_larger(int a, int b)
{
    return a > b ? a : b;
}

void bb_text_field(char entry[BB_ENTRY], const bb_entry *row, bb_field_id field)
{
    double value = bb_get_number(row, field);
    switch (bb_fields[field].format) {
    case BB_AS_WHOLE:
        bb_figure(entry, value, 0);
        break;
    case BB_AS_BYTES:
        bb_figure_bytes(entry, value);
        break;
    default:
        bb_figure(entry, value, -1);
    }
}

int bb_print_letter(FILE *out, const char *text)
{
    bool calm;
    const int length = bb_letter(text, &calm);
    if (calm)
        fwrite(text, 1, (size_t)length, out);
    else
        fputc('?', out);
    return length;
}

void bb_print_text(FILE *out, const char *text, int width)
{
    int printed = 0;
    for (; *text != '\0'; printed++)
        text += bb_print_letter(out, text);
    for (; printed < width; printed++)
        fputc(' ', out);
}

/* ---- medians ---- */

static bb_spread spread_of(const bb_entry *row, bb_field_id low, double *from, double *to)
{
    static const bb_spread kinds[] = {BB_INTERVAL, BB_RANGE};
    for (unsigned i = 0; i < 2; i++) {
        *from = bb_get_number(row, low + 2 * i);
        *to = bb_get_number(row, low + 2 * i + 1);
        if (isfinite(*from) && isfinite(*to))
            return kinds[i];
    }
    return BB_NO_SPREAD;
}

/* Writes "41.2 [40.1, 43.0]", or "41.2". */
static bb_spread with_spread(char entry[BB_ENTRY], const bb_medians *c, const bb_entry *row)
{
    char middle[BB_ENTRY], left[BB_ENTRY], right[BB_ENTRY];
    double from, to;
    bb_spread kind = spread_of(row, c->low, &from, &to);
    bb_figure(middle, bb_get_number(row, c->median), -1);
    bb_figure(left, from, -1);
    bb_figure(right, to, -1);
    if (kind == BB_NO_SPREAD)
        snprintf(entry, BB_ENTRY, "%s", middle);
    else
        snprintf(entry, BB_ENTRY, "%.16s [%.16s, %.16s]", middle, left, right);
    return kind;
}

void bb_medians_take(bb_medians *c, const bb_entry *row)
{
    char entry[BB_ENTRY];
    bb_spread kind = with_spread(entry, c, row);
    c->widths[kind] = bb_larger(c->widths[kind], (int)strlen(entry));
}

void bb_medians_finish(bb_medians *c)
{
    bool intervals = c->widths[BB_INTERVAL] > 0, ranges = c->widths[BB_RANGE] > 0;
    snprintf(c->heading, BB_ENTRY, "%.40s%s", bb_fields[c->median].heading,
             intervals ? " [95 %]"
             : ranges  ? " [range]"
                       : "");
    int range = c->widths[BB_RANGE] + (intervals && ranges ? (int)strlen(" range") : 0);
    c->width =
        bb_larger((int)strlen(c->heading),
                  bb_larger(range, bb_larger(c->widths[BB_NO_SPREAD], c->widths[BB_INTERVAL])));
}

void bb_medians_text(char entry[BB_ENTRY], const bb_medians *c, const bb_entry *row)
{
    bb_spread kind = with_spread(entry, c, row);
    if (kind == BB_RANGE && c->widths[BB_INTERVAL] > 0)
        strncat(entry, " range", BB_ENTRY - strlen(entry) - 1);
}
