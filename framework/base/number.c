#include "framework/base/number.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Sets value = 10 * value + digit, if that fits. */
static bool append_digit(uint64_t *value, unsigned digit)
{
    return !__builtin_mul_overflow(*value, (uint64_t)10, value) &&
           !__builtin_add_overflow(*value, (uint64_t)digit, value);
}

/* Reads what follows the digits: nothing, k, M, G, or an exponent of at most two digits. */
static bool read_power(const char *text, unsigned *power)
{
    static const char letters[] = "kMG";
    const char *letter = *text == 'K' ? letters : strchr(letters, *text);
    if (*text == '\0') {
        *power = 0;
        return true;
    }
    if (letter != NULL) {
        *power = 3 * (unsigned)(letter - letters + 1);
        return text[1] == '\0';
    }
    if (*text != 'e' && *text != 'E')
        return false;
    text += text[1] == '+' ? 2 : 1;
    size_t digits = strspn(text, "0123456789");
    *power = (unsigned)strtoul(text, NULL, 10);
    return digits >= 1 && digits <= 2 && text[digits] == '\0';
}

bool bb_read_whole(const char *text, uint64_t *out)
{
    uint64_t value = 0;
    unsigned decimals = 0, power;
    bool point = false;
    const char *at = text;
    for (; *at != '\0'; at++) {
        if (is_digit(*at)) {
            if (!append_digit(&value, (unsigned)(*at - '0')))
                return false;
            decimals += point;
            continue;
        }
        bool between = at > text && is_digit(at[-1]) && is_digit(at[1]);
        if (!between || (*at != '_' && (*at != '.' || point)))
            break;
        point = point || *at == '.';
    }
    if (at == text || !read_power(at, &power))
        return false;
    for (; decimals > 0 && value % 10 == 0; decimals--)
        value /= 10;
    if (decimals > power)
        return false;
    for (power -= decimals; power > 0; power--)
        if (!append_digit(&value, 0))
            return false;
    *out = value;
    return true;
}

bool bb_read_real(const char *text, double *out)
{
    uint64_t whole;
    char *end;
    if (bb_read_whole(text, &whole)) {
        *out = (double)whole;
        return true;
    }
    double number = strtod(text, &end);
    if (end == text || *end != '\0' || isnan(number))
        return false;
    *out = number;
    return true;
}

const char *bb_range_of_whole(uint64_t low, uint64_t high, char text[BB_RANGE_TEXT])
{
    if (high < UINT64_MAX)
        snprintf(text, BB_RANGE_TEXT, "a whole number from %" PRIu64 " to %" PRIu64, low, high);
    else if (low > 0)
        snprintf(text, BB_RANGE_TEXT, "a whole number of at least %" PRIu64, low);
    else
        snprintf(text, BB_RANGE_TEXT, "a whole number below 2^64");
    return text;
}

bool bb_read_time(const char *text, double *seconds)
{
    static const struct {
        const char *unit;
        double seconds;
    } units[] = {{"", 1}, {"s", 1}, {"min", 60}, {"h", 3600}};
    const size_t digits = strspn(text, "0123456789.");
    char number[32];
    double value;
    if (digits >= sizeof number)
        return false;
    snprintf(number, sizeof number, "%.*s", (int)digits, text);
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (strcmp(text + digits, units[i].unit) == 0 && bb_read_real(number, &value) &&
            value > 0) {
            *seconds = value * units[i].seconds;
            return true;
        }
    return false;
}

const char *bb_time_words(double seconds, char text[BB_TIME_TEXT])
{
    const double s = fmax(round(seconds), 1);
    if (!isfinite(seconds))
        snprintf(text, BB_TIME_TEXT, "an unknown time");
    else if (s >= 60)
        snprintf(text, BB_TIME_TEXT, "%.0f min %.0f s", floor(s / 60), fmod(s, 60));
    else
        snprintf(text, BB_TIME_TEXT, "%.0f s", s);
    return text;
}
