/* Whole numbers as people write them, and words that are nearly known. */
#include "framework/base/number.h"
#include "framework/base/suggest.h"
#include "tests/fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void whole_numbers_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint64_t value;
    } cases[] = {
        {"0", 0},
        {"7", 7},
        {"064", 64},
        {"1000000", 1000000},
        {"1_000_000", 1000000},
        {"1e6", 1000000},
        {"1E+6", 1000000},
        {"1M", 1000000},
        {"1.5M", 1500000},
        {"1.50k", 1500},
        {"2.0", 2},
        {"20K", 20000},
        {"3G", 3000000000},
        {"0.001k", 1},
        {"1_5.2_5e2", 1525},
        {"0e99", 0},
        {"18446744073709551615", UINT64_MAX},
        {"1844674407370955161.5e1", UINT64_MAX},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint64_t value = 1;
        if (!bb_read_whole(cases[i].text, &value) || value != cases[i].value)
            fail_msg("'%s' is %llu", cases[i].text, (unsigned long long)value);
    }
}

static void what_is_no_whole_number_is_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",    " 1", "1 ",  "-1",     "+1",      "x",    "1x",  "0x10", "_1",    "1_",   "1__0",
        ".5M", "1.", "1.k", "1.5",    "1.2345k", "1e-3", "1e",  "1e+",  "1e 3",  "1e6k", "1kk",
        "1m",  "1g", "1Ki", "1.2.3M", "1_.5M",   "nan",  "inf", "1e20", "1e100", "20e",  "100G9"};
    static const char *const large[] = {"18446744073709551616", "18446744073.709551616G",
                                        "99999999999999999999", "18446744074G", "1e99"};
    uint64_t value = 42;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        if (bb_read_whole(bad[i], &value))
            fail_msg("'%s' was taken", bad[i]);
    for (size_t i = 0; i < sizeof large / sizeof large[0]; i++)
        if (bb_read_whole(large[i], &value))
            fail_msg("'%s' was taken", large[i]);
    assert_int_equal(value, 42);
}

static void real_numbers_are_read(void **state)
{
    (void)state;
    double value = 0;
    assert_true(bb_read_real("1.25", &value) && value == 1.25);
    assert_true(bb_read_real("-1e-3", &value) && value == -1e-3);
    assert_true(bb_read_real("1e30", &value) && value == 1e30);
    assert_true(bb_read_time("90", &value) && value == 90);
    assert_true(bb_read_time("90s", &value) && value == 90);
    assert_true(bb_read_time("2.5min", &value) && value == 150);
    assert_true(bb_read_time("1h", &value) && value == 3600);
    static const char *const no_times[] = {"",    "0",   "0s",  "min",  "5 min", "5m",
                                           "-5s", "1e3", "inf", "1..5", "5min5", "."};
    for (size_t i = 0; i < sizeof no_times / sizeof no_times[0]; i++)
        assert_false(bb_read_time(no_times[i], &value));
    assert_true(bb_read_real("2k", &value) && value == 2000);
    assert_true(bb_read_real("9007199254740993", &value) && value == 9007199254740992.0);
    assert_true(bb_read_real("inf", &value) && isinf(value));
    assert_false(bb_read_real("nan", &value));
    assert_false(bb_read_real("", &value));
    assert_false(bb_read_real("1.25k5", &value));
}

static void ranges_are_said_without_what_is_no_limit(void **state)
{
    (void)state;
    char text[BB_RANGE_TEXT];
    assert_string_equal(bb_range_of_whole(1, 255, text), "a whole number from 1 to 255");
    assert_string_equal(bb_range_of_whole(1, UINT64_MAX, text), "a whole number of at least 1");
    assert_string_equal(bb_range_of_whole(0, UINT64_MAX, text), "a whole number below 2^64");
}

static void nearly_known_words_are_found(void **state)
{
    (void)state;
    static const char *const known[] = {"coffee", "mountain", "cube",    "spheres", "sphere-mesh",
                                        "lbvh",   "llbvh",    "primary", "ao",      "run"};
    static const char *const cases[][2] = {{"cofee", "coffee"},
                                           {"mountian", "mountain"},
                                           {"coffees", "coffee"},
                                           {"cub", "cube"},
                                           {"sphere", "spheres"},
                                           {"sphere-", "spheres"},
                                           {"lbv", "lbvh"},
                                           {"lvbh", "lbvh"},
                                           {"primry", "primary"},
                                           {"prim", "primary"},
                                           {"runn", "run"},
                                           {"ru", "run"},
                                           {"Coffee", "coffee"},
                                           {"nothing", ""},
                                           {"x", ""},
                                           {"", ""},
                                           {"teapot", ""},
                                           {"ring", ""},
                                           {"a", ""},
                                           {"oa", "ao"},
                                           {"conference-room-of-more-than-forty-letters", ""}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_suggestion meant = {.word = cases[i][0]};
        char wanted[96] = "";
        for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
            bb_suggest(&meant, known[k]);
        if (cases[i][1][0] != '\0')
            snprintf(wanted, sizeof wanted, " (did you mean '%s'?)", cases[i][1]);
        if (strcmp(bb_suggested(&meant), wanted) != 0)
            fail_msg("'%s':%s, not%s", cases[i][0], bb_suggested(&meant), wanted);
    }
    bb_suggestion option = {.word = "scen", .prefix = "--"};
    bb_suggest(&option, "scene");
    assert_string_equal(bb_suggested(&option), " (did you mean '--scene'?)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_numbers_are_read),
        cmocka_unit_test(what_is_no_whole_number_is_refused),
        cmocka_unit_test(real_numbers_are_read),
        cmocka_unit_test(ranges_are_said_without_what_is_no_limit),
        cmocka_unit_test(nearly_known_words_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
