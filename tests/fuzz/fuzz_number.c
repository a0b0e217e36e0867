/* Numbers as people write them: what is read is the number that its plain spelling gives. */
#include "framework/base/number.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>

static void check_whole(const char *text)
{
    char plain[32];
    uint64_t number = 77, again;
    if (!bb_read_whole(text, &number)) {
        FUZZ_CHECK(number == 77); /* left alone */
        return;
    }
    snprintf(plain, sizeof plain, "%llu", (unsigned long long)number);
    FUZZ_CHECK(bb_read_whole(plain, &again) && again == number);
    double real;
    FUZZ_CHECK(bb_read_real(text, &real) && real == (double)number);
}

static void check_real(const char *text)
{
    char plain[64];
    double number = 77, again;
    if (!bb_read_real(text, &number)) {
        FUZZ_CHECK(number == 77);
        return;
    }
    FUZZ_CHECK(!isnan(number));
    snprintf(plain, sizeof plain, "%.17g", number);
    FUZZ_CHECK(bb_read_real(plain, &again) && memcmp(&again, &number, sizeof again) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_text(data, size), range[BB_RANGE_TEXT];
    uint64_t low = 0, high = 0;
    check_whole(text);
    check_real(text);
    memcpy(&low, data, size < sizeof low ? size : sizeof low);
    if (size > sizeof low)
        memcpy(&high, data + sizeof low,
               size - sizeof low < sizeof high ? size - sizeof low : sizeof high);
    FUZZ_CHECK(bb_range_of_whole(low, high, range) == range);
    FUZZ_CHECK(strlen(range) < BB_RANGE_TEXT && strncmp(range, "a whole number", 14) == 0);
    free(text);
    return 0;
}
