/* The JSON writer: what it writes is valid, the same as cJSON's, and exact. */
#include "tests/fixture.h"

#include "framework/base/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void write_document(bb_json *json)
{
    static const double numbers[] = {0,   -1.5,  1e300,    5e-324, 0.1 + 0.2,
                                     NAN, 65536, INFINITY, 1.0 / 3};
    bb_json_object(json, NULL);
    bb_json_add_text(json, "text", "a \"quoted\" \\ line\n\ttab \x01 \xc3\xa9");
    bb_json_add_text(json, "none", NULL);
    bb_json_add_bool(json, "yes", true);
    bb_json_array(json, "numbers");
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        bb_json_add_number(json, NULL, numbers[i]);
    bb_json_end_array(json);
    bb_json_array(json, "lists");
    bb_json_array(json, NULL);
    bb_json_end_array(json);
    bb_json_object(json, NULL);
    bb_json_add_text(json, "x", "");
    bb_json_end_object(json);
    bb_json_end_array(json);
    bb_json_end_object(json);
}

static void cjson_reads_it_and_prints_the_same(void **state)
{
    (void)state;
    for (int formatted = 0; formatted < 2; formatted++) {
        bb_json json = {.formatted = formatted};
        write_document(&json);
        char *text = bb_json_take(&json);
        assert_non_null(text);
        cJSON *read = cJSON_Parse(text);
        assert_non_null(read);
        const cJSON *numbers = cJSON_GetObjectItem(read, "numbers");
        assert_true(cJSON_GetArrayItem(numbers, 4)->valuedouble == 0.1 + 0.2);
        assert_true(cJSON_GetArrayItem(numbers, 3)->valuedouble == 5e-324);
        assert_true(cJSON_IsNull(cJSON_GetArrayItem(numbers, 5)));
        assert_true(cJSON_IsNull(cJSON_GetArrayItem(numbers, 7)));
        assert_string_equal(cJSON_GetObjectItem(read, "text")->valuestring,
                            "a \"quoted\" \\ line\n\ttab \x01 \xc3\xa9");
        /* numbers aside, of which cJSON prints fewer digits than give them back */
        cJSON_DeleteItemFromObject(read, "numbers");
        char *printed = bb_json_print(read, formatted);
        char *from = strstr(text, formatted ? "\t\"numbers\"" : "\"numbers\""),
             *to = strstr(text, formatted ? "\t\"lists\"" : "\"lists\"");
        memmove(from, to, strlen(to) + 1);
        assert_string_equal(text, printed);
        free(printed);
        free(text);
        cJSON_Delete(read);
    }
}

static void bytes_that_are_no_utf8_are_escaped(void **state)
{
    (void)state;
    bb_json json = {0};
    bb_json_array(&json, NULL);
    bb_json_add_text(&json, NULL, "a\xff");
    bb_json_end_array(&json);
    char *text = bb_json_take(&json);
    assert_string_equal(text, "[\"a%FF\"]");
    free(text);
}

static void what_was_lost_is_remembered(void **state)
{
    (void)state;
    bb_json json = {.lost = true};
    write_document(&json);
    assert_null(bb_json_take(&json));
    write_document(&json);
    char *text = bb_json_take(&json);
    assert_non_null(text); /* taking it made the writer empty, and sound */
    free(text);
    assert_null(bb_json_take(&json)); /* nothing was written */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cjson_reads_it_and_prints_the_same),
        cmocka_unit_test(bytes_that_are_no_utf8_are_escaped),
        cmocka_unit_test(what_was_lost_is_remembered),
    };
    return cmocka_run_group_tests_name("json", tests, NULL, NULL);
}
