/* Numbers as text. */
#include "framework/table/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void add_commas(char out[BB_FIGURE_MAX])
{
    char digits[BB_FIGURE_MAX];
    const size_t length = strlen(out), sign = out[0] == '-';
    memcpy(digits, out, length + 1);
    char *to = out + sign;
    for (size_t i = sign; i < length; i++) {
        if (i > sign && (length - i) % 3 == 0)
            *to++ = ',';
        *to++ = digits[i];
    }
    *to = '\0';
}

static int decimals_of_three_digits(double size)
{
    return size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4;
}

const char *bb_figure(char out[BB_FIGURE_MAX], double value, int decimals)
{
    const double size = fabs(value);
    if (!isfinite(value))
        return strcpy(out, "-");
    if (size >= 1e15 || (decimals < 0 && value != 0 && (size < 1e-2 || size >= 1e7))) {
        snprintf(out, BB_FIGURE_MAX, "%.3g", value);
        return out;
    }
    if (decimals < 0)
        decimals = value == 0 ? 0 : decimals_of_three_digits(size);
    snprintf(out, BB_FIGURE_MAX, "%.*f", decimals < 15 ? decimals : 15, value);
    if (decimals == 0)
        add_commas(out);
    return out;
}

const char *bb_figure_interval(char out[BB_FIGURE_MAX], bb_estimate estimate, int decimals)
{
    char value[BB_FIGURE_MAX], low[BB_FIGURE_MAX], high[BB_FIGURE_MAX];
    bb_figure(value, estimate.value, decimals);
    if (!isfinite(estimate.low) || !isfinite(estimate.high))
        return strcpy(out, value);
    bb_figure(low, estimate.low, decimals);
    bb_figure(high, estimate.high, decimals);
    snprintf(out, BB_FIGURE_MAX, "%.36s [%.36s, %.36s]", value, low, high);
    return out;
}

const char *bb_figure_bytes(char out[BB_FIGURE_MAX], double bytes)
{
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    char value[BB_FIGURE_MAX];
    unsigned unit = 0;
    for (; fabs(bytes) >= 1024 && unit < 4; unit++)
        bytes /= 1024;
    if (!isfinite(bytes))
        return strcpy(out, "-");
    snprintf(out, BB_FIGURE_MAX, "%.40s %s", bb_figure(value, bytes, unit == 0 ? 0 : -1),
             units[unit]);
    return out;
}
