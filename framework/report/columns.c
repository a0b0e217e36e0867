#include "framework/report/columns.h"

#include "framework/base/steering.h"

#include <math.h>
#include <string.h>

int bb_larger(int a, int b)
{
    return a > b ? a : b;
}

/* ---- figures ---- */

void bb_text_figure(char entry[BB_ENTRY], double value)
{
    if (!isfinite(value))
        snprintf(entry, BB_ENTRY, "-");
    else if (value != 0 && (fabs(value) < 1e-4 || fabs(value) >= 1e7))
        snprintf(entry, BB_ENTRY, "%.3g", value);
    else
        snprintf(entry, BB_ENTRY, "%.*f",
                 fabs(value) >= 1000   ? 0
                 : fabs(value) >= 100  ? 1
                 : fabs(value) >= 1    ? 2
                 : fabs(value) >= 0.01 ? 3
                                       : 5,
                 value);
}

void bb_text_bytes(char entry[BB_ENTRY], double value)
{
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    if (!isfinite(value)) {
        snprintf(entry, BB_ENTRY, "-");
        return;
    }
    unsigned unit = 0;
    for (; value >= 1024 && unit < 4; unit++)
        value /= 1024;
    snprintf(entry, BB_ENTRY, "%.*f %s", value < 10 && unit > 0 ? 1 : 0, value, units[unit]);
}

void bb_text_whole(char entry[BB_ENTRY], double value)
{
    char digits[BB_ENTRY];
    if (!isfinite(value) || value < 0 || value > 1e15) {
        bb_text_figure(entry, value);
        return;
    }
    int length = snprintf(digits, sizeof digits, "%.0f", value), at = 0;
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            entry[at++] = ',';
        entry[at++] = digits[i];
    }
    entry[at] = '\0';
}

void bb_text_field(char entry[BB_ENTRY], const bb_entry *row, bb_field_id field)
{
    double value = bb_get_number(row, field);
    switch (bb_fields[field].format) {
    case BB_AS_WHOLE:
        bb_text_whole(entry, value);
        break;
    case BB_AS_BYTES:
        bb_text_bytes(entry, value);
        break;
    default:
        bb_text_figure(entry, value);
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

/* "41.2 [40.1, 43.0]", or "41.2" */
static bb_spread with_spread(char entry[BB_ENTRY], const bb_medians *c, const bb_entry *row)
{
    char middle[BB_ENTRY], left[BB_ENTRY], right[BB_ENTRY];
    double from, to;
    bb_spread kind = spread_of(row, c->low, &from, &to);
    bb_text_figure(middle, bb_get_number(row, c->median));
    bb_text_figure(left, from);
    bb_text_figure(right, to);
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
