/* Texts of others: what would steer a terminal, or is no UTF-8, becomes a question mark. */
#include "tests/fixture.h"

#include "framework/base/steering.h"

#include <string.h>

static void expect_calm(const char *text, const char *expected)
{
    char copy[64];
    strcpy(copy, text);
    bb_calm_text(copy);
    assert_string_equal(copy, expected);
    assert_true(bb_is_calm(copy));
    assert_true(bb_is_calm(text) == (strcmp(text, expected) == 0));
}

static void letters_stay(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "",
        "plain ~ !",
        "\xc2\xa0",                           /* U+00A0, the first behind the control characters */
        "\xc3\xa9 \xe2\x82\xac \xef\xbf\xbd", /* two and three bytes */
        "\xed\x9f\xbf \xee\x80\x80",          /* beside the surrogates */
        "\xf0\x9f\x9a\x80 \xf4\x8f\xbf\xbf",  /* four bytes, and the last of all */
        "\xe2\x80\xa9 \xe2\x80\xaf \xe2\x81\xa5 \xe2\x81\xaa", /* beside what turns */
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        expect_calm(texts[i], texts[i]);
}

static void what_steers_goes(void **state)
{
    (void)state;
    expect_calm("a\x1b[2J\nb\tc\x7f", "a?[2J?b?c?");
    expect_calm("\xc2\x80 \xc2\x9f", "? ?");                /* U+0080, U+009F */
    expect_calm("\xe2\x80\xaa\xe2\x80\xae", "??");          /* U+202A, U+202E */
    expect_calm("\xd8\x9c\xe2\x80\x8e\xe2\x80\x8f", "???"); /* U+061C, U+200E, U+200F */
    expect_calm("\xe2\x81\xa6\xe2\x81\xa9", "??");          /* U+2066, U+2069 */
}

static void what_is_no_letter_goes(void **state)
{
    (void)state;
    expect_calm("\x80 \xbf", "? ?"); /* no first byte */
    expect_calm("\xc3", "?");        /* cut off */
    expect_calm("\xe2\x82", "??");
    expect_calm("\xf0\x9f\x9a", "???");
    expect_calm("\xc3z", "?z");
    expect_calm("\xc0\xaf \xc1\xbf", "?? ??"); /* overlong */
    expect_calm("\xe0\x9f\xbf", "???");
    expect_calm("\xf0\x8f\xbf\xbf", "????");
    expect_calm("\xed\xa0\x80", "???");             /* a surrogate */
    expect_calm("\xf4\x90\x80\x80 \xff", "???? ?"); /* behind U+10FFFF */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(letters_stay),
        cmocka_unit_test(what_steers_goes),
        cmocka_unit_test(what_is_no_letter_goes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
