/* Specifications and lists of them. */
#include "framework/base/options.h"
#include "tests/fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const bb_option options[] = {
    {"bits", "30", "30|63", "bits"},
    {"n", "7", NULL, "a number"},
    {"free", NULL, NULL, "anything"},
    {.name = NULL},
};

static void parses_name_and_parameters(void **state)
{
    (void)state;
    bb_spec spec;
    assert_int_equal(bb_spec_parse("lbvh:bits=63,n=12", &spec), BB_OK);
    assert_string_equal(spec.name, "lbvh");
    assert_string_equal(spec.text, "lbvh:bits=63,n=12");
    assert_int_equal(bb_spec_validate(&spec, options, "builder x"), BB_OK);
    assert_string_equal(bb_spec_value(&spec, options, "bits"), "63");
    assert_null(bb_spec_value(&spec, options, "free"));
    uint64_t n;
    assert_int_equal(bb_spec_u64(&spec, options, "n", 1, 12, &n), BB_OK);
    assert_int_equal(n, 12);
    assert_int_equal(bb_spec_u64(&spec, options, "n", 1, 11, &n), BB_INVALID);
}

static void takes_defaults(void **state)
{
    (void)state;
    bb_spec spec;
    double x;
    assert_int_equal(bb_spec_parse("lbvh", &spec), BB_OK);
    assert_true(bb_spec_is(&spec, options, "bits", "30"));
    assert_int_equal(bb_spec_double(&spec, options, "n", 0, 10, &x), BB_OK);
    assert_true(x == 7.0);
}

static void refuses_what_is_malformed(void **state)
{
    (void)state;
    static const char *const bad[] = {"",     ":a=1",   "x:",        "x:a",       "x:=1",
                                      "x:a=", "x:a=1,", "x:a=1,a=2", "x:a=1,,b=2"};
    bb_spec spec;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        if (bb_spec_parse(bad[i], &spec) != BB_INVALID)
            fail_msg("'%s' was taken", bad[i]);
    char *too_long = malloc(2000);
    memset(too_long, 'a', 1999);
    too_long[1999] = '\0';
    assert_int_equal(bb_spec_parse(too_long, &spec), BB_INVALID);
    free(too_long);
}

static void names_unknown_keys_and_values(void **state)
{
    (void)state;
    bb_spec spec;
    assert_int_equal(bb_spec_parse("x:bit=3", &spec), BB_OK);
    assert_int_equal(bb_spec_validate(&spec, options, "builder x"), BB_INVALID);
    assert_non_null(strstr(bb_message(), "'bit'"));
    assert_non_null(strstr(bb_message(), "(did you mean 'bits'?)"));
    assert_non_null(strstr(bb_message(), "bits, n, free"));
    assert_int_equal(bb_spec_parse("x:bits=3", &spec), BB_OK);
    assert_int_equal(bb_spec_validate(&spec, options, "builder x"), BB_INVALID);
    assert_non_null(strstr(bb_message(), "30|63"));
    static const char *const numbers[] = {"x:n=-1", "x:n=1.5", "x:n=99999999999999999999",
                                          "x:n=0x10", "x:n=1 "};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        uint64_t n;
        assert_int_equal(bb_spec_parse(numbers[i], &spec), BB_OK);
        assert_int_equal(bb_spec_u64(&spec, options, "n", 0, UINT64_MAX, &n), BB_INVALID);
    }
}

static void takes_numbers_as_people_write_them(void **state)
{
    (void)state;
    bb_spec spec;
    uint64_t n;
    double x;
    assert_int_equal(bb_spec_parse("x:n=1.5M", &spec), BB_OK);
    assert_int_equal(bb_spec_u64(&spec, options, "n", 0, 2000000, &n), BB_OK);
    assert_int_equal(n, 1500000);
    assert_int_equal(bb_spec_double(&spec, options, "n", 0, 2e6, &x), BB_OK);
    assert_true(x == 1.5e6);
    assert_int_equal(bb_spec_u64(&spec, options, "n", 0, 1000, &n), BB_INVALID);
    assert_non_null(strstr(bb_message(), "must be a whole number from 0 to 1000"));
    assert_int_equal(bb_spec_parse("x:n=0", &spec), BB_OK);
    assert_int_equal(bb_spec_u64(&spec, options, "n", 1, UINT64_MAX, &n), BB_INVALID);
    assert_non_null(strstr(bb_message(), "must be a whole number of at least 1"));
}

static void check_list(const char *text, size_t expected, const char *const *items)
{
    char *found[8];
    size_t count = 0;
    assert_int_equal(bb_spec_list(text, found, 8, &count), BB_OK);
    assert_int_equal(count, expected);
    for (size_t i = 0; i < count; i++) {
        assert_string_equal(found[i], items[i]);
        free(found[i]);
    }
}

static void splits_lists_at_commas_that_start_an_item(void **state)
{
    (void)state;
    check_list("a", 1, (const char *[]){"a"});
    check_list("a,b", 2, (const char *[]){"a", "b"});
    check_list("a:x=1,y=2,b", 2, (const char *[]){"a:x=1,y=2", "b"});
    check_list("a:x=1,b:y=2,z=3,c", 3, (const char *[]){"a:x=1", "b:y=2,z=3", "c"});
    char *items[8];
    size_t count = 0;
    assert_int_equal(bb_spec_list("a,,b", items, 8, &count), BB_INVALID);
    for (size_t i = 0; i < count; i++)
        free(items[i]);
}

static void takes_an_existing_file_whole(void **state)
{
    (void)state;
    char path[] = "/tmp/bvhbench,a=b:cXXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    check_list(path, 1, (const char *[]){path});
    bb_spec spec;
    assert_int_equal(bb_spec_parse(path, &spec), BB_OK);
    assert_string_equal(spec.name, path);
    assert_int_equal(spec.param_count, 0);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parses_name_and_parameters),
        cmocka_unit_test(takes_defaults),
        cmocka_unit_test(refuses_what_is_malformed),
        cmocka_unit_test(names_unknown_keys_and_values),
        cmocka_unit_test(takes_numbers_as_people_write_them),
        cmocka_unit_test(splits_lists_at_commas_that_start_an_item),
        cmocka_unit_test(takes_an_existing_file_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
