/* The table of results: cells and columns in memory, JSON and CSV there and back, files that are
 * refused; numbers as text. */
#include "framework/base/random.h"
#include "framework/table/figure.h"
#include "framework/table/table.h"
#include "tests/program_fixture.h"

#include <math.h>

static const bb_column column_build = {
    "build_ms",       "build",        "ms",           "Building the tree.",
    BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS, 2};
static const bb_column column_nodes = {
    "nodes", "nodes", "", "Of the tree.", BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_LESS, 0};
static const bb_column column_note = {
    "note", "", "", "Why there is nothing.", BB_COLUMN_TEXT, BB_SENSE_EXACT, BB_BETTER_NEITHER, 0};

static const bb_cell of_lbvh = {{[BB_SCENE] = "cube", [BB_BUILDER] = "lbvh"}};
static const bb_cell of_sah = {
    {[BB_SCENE] = "cube", [BB_BUILDER] = "sah,\"quoted\"", [BB_FRAME] = ""}};
static const bb_cell of_all = {{NULL}};

static bb_table *new_table(void)
{
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    return table;
}

static bb_table *sample_table(void)
{
    bb_table *table = new_table();
    const bb_samples rounds = {.count = 3, .values = {9, 0.1, 0.3}};
    const uint32_t lbvh = bb_table_row(table, of_lbvh), sah = bb_table_row(table, of_sah);
    bb_table_set_rounds(table, lbvh, &column_build, &rounds);
    bb_table_set_number(table, lbvh, &column_nodes, 12345);
    bb_table_set_number(table, sah, &column_nodes, -0.1);
    bb_table_set_text(table, sah, &column_note, "a\xff\n\"b\" \xc3\xa9\x01");
    bb_table_set_number(table, bb_table_row(table, of_all), &column_nodes, 1e300);
    ASSERT_OK(bb_table_status(table));
    return table;
}

/* ---- in memory ---- */

static void a_cell_has_one_row(void **state)
{
    (void)state;
    bb_table *table = new_table();
    char copy[] = "lbvh";
    assert_int_equal(bb_table_find(table, of_lbvh), BB_NO_ROW);
    assert_int_equal(bb_table_row(table, of_lbvh), 0);
    assert_int_equal(bb_table_row(table, of_all), 1);
    assert_int_equal(bb_table_row(table, of_sah), 2);
    const bb_cell same = {{[BB_SCENE] = "cube", [BB_BUILDER] = copy, [BB_MAKER] = ""}};
    assert_int_equal(bb_table_row(table, same), 0);
    const bb_cell maker = {{[BB_SCENE] = "cube", [BB_MAKER] = copy}};
    assert_int_equal(bb_table_find(table, maker), BB_NO_ROW);
    assert_int_equal(bb_table_row(table, maker), 3);
    copy[0] = 'x'; /* it was copied */
    assert_int_equal(bb_table_find(table, of_lbvh), 0);
    assert_int_equal(bb_table_row_count(table), 4);
    assert_string_equal(bb_table_name(table, 0, BB_BUILDER), "lbvh");
    assert_string_equal(bb_table_name(table, 1, BB_SCENE), "");
    assert_string_equal(bb_table_name(table, 3, BB_MAKER), "lbvh");
    assert_string_equal(bb_table_command(table), "slice");
    bb_table_free(table);
    bb_table_free(NULL);
}

static void values_are_there_or_not(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    assert_int_equal(bb_table_column_count(table), 3);
    assert_ptr_equal(bb_table_column(table, 0), &column_build);
    assert_ptr_equal(bb_table_column_named(table, "note"), &column_note);
    assert_null(bb_table_column_named(table, "layout_ms"));
    assert_int_equal(bb_table_get_rounds(table, 0, "build_ms")->count, 3);
    ASSERT_NEAR(bb_table_get_number(table, 0, "build_ms"), 0.2, 1e-15); /* not of round 0 */
    ASSERT_NEAR(bb_table_get_number(table, 1, "nodes"), -0.1, 0);
    assert_null(bb_table_get_rounds(table, 1, "build_ms"));
    assert_true(isnan(bb_table_get_number(table, 1, "build_ms")));
    assert_true(isnan(bb_table_get_number(table, 1, "note")));
    assert_true(isnan(bb_table_get_number(table, 1, "layout_ms")));
    assert_true(isnan(bb_table_get_number(table, BB_NO_ROW, "nodes")));
    assert_string_equal(bb_table_get_text(table, 0, "note"), "");
    assert_string_equal(bb_table_get_text(table, 1, "nodes"), "");
    assert_string_equal(bb_table_get_text(table, 1, "note"), "a%FF\n\"b\" \xc3\xa9\x01");
    bb_table_free(table);
}

static void what_is_no_value_takes_one_away(void **state)
{
    (void)state;
    const bb_samples broken = {.count = 2, .values = {1, INFINITY}}, none = {0};
    bb_table *table = new_table();
    const uint32_t row = bb_table_row(table, of_lbvh);
    bb_table_set_number(table, row, &column_nodes, NAN);
    bb_table_set_text(table, row, &column_note, "");
    bb_table_set_text(table, row, &column_note, NULL);
    bb_table_set_rounds(table, row, &column_build, &none);
    bb_table_set_rounds(table, row, &column_build, &broken);
    assert_int_equal(bb_table_column_count(table), 0);
    bb_table_free(table);

    table = sample_table();
    bb_table_set_number(table, 0, &column_nodes, 7);
    ASSERT_NEAR(bb_table_get_number(table, 0, "nodes"), 7, 0);
    bb_table_set_number(table, 0, &column_nodes, INFINITY);
    bb_table_set_text(table, 1, &column_note, NULL);
    bb_table_set_rounds(table, 0, &column_build, &none);
    assert_true(isnan(bb_table_get_number(table, 0, "nodes")));
    assert_string_equal(bb_table_get_text(table, 1, "note"), "");
    assert_null(bb_table_get_rounds(table, 0, "build_ms"));
    bb_table_free(table);
}

static void two_columns_of_one_name_are_a_mistake(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    const bb_column other = column_nodes;
    bb_table_set_number(table, 0, &other, 1);
    assert_int_equal(bb_table_status(table), BB_INVALID);
    assert_non_null(strstr(bb_message(), "nodes"));
    ASSERT_NEAR(bb_table_get_number(table, 0, "nodes"), 12345, 0);
    assert_int_equal(bb_table_row(table, of_lbvh), BB_NO_ROW);
    bb_table_free(table);
}

/* ---- files ---- */

static bb_table *parse(const char *json)
{
    bb_table *table;
    ASSERT_OK(bb_table_parse(json, "a file", &table));
    return table;
}

/* Whatever a table takes, its file is read again; what it does not take, it says. */
static void faulty_declarations_are_refused(void **state)
{
    (void)state;
    static const bb_column faulty[] = {
        {.name = "scene", .heading = "", .unit = "", .help = ""},
        {.name = "Build", .heading = "", .unit = "", .help = ""},
        {.name = "build ms", .heading = "", .unit = "", .help = ""},
        {.name = "", .heading = "", .unit = "", .help = ""},
        {.name = NULL, .heading = "", .unit = "", .help = ""},
        {.name = "nodes", .heading = "", .unit = NULL, .help = ""},
        {.name = "nodes", .heading = "", .unit = "", .help = "", .decimals = 16},
    };
    for (size_t i = 0; i < sizeof faulty / sizeof faulty[0]; i++) {
        bb_table *table;
        ASSERT_OK(bb_table_create("slice", &table));
        bb_table_set_number(table, bb_table_row(table, (bb_cell){{"a"}}), &faulty[i], 1);
        assert_int_equal(bb_table_status(table), BB_INVALID);
        assert_non_null(strstr(bb_message(), "of a table: "));
        bb_table_free(table);
    }
    bb_table *none;
    assert_int_equal(bb_table_create("Slice", &none), BB_INVALID);
    assert_int_equal(bb_table_create("", &none), BB_INVALID);
    assert_null(none);
}

static void names_that_are_no_utf8_are_found(void **state)
{
    (void)state;
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    assert_int_equal(bb_table_row(table, (bb_cell){{"a\xff"}}), 0);
    assert_int_equal(bb_table_find(table, (bb_cell){{"a\xff"}}), 0);
    assert_int_equal(bb_table_find(table, (bb_cell){{"a%FF"}}), 0);
    assert_int_equal(bb_table_find(table, (bb_cell){{"a\xfe"}}), BB_NO_ROW);
    bb_table_free(table);
}

static void rounds_may_be_put_where_they_came_from(void **state)
{
    (void)state;
    static const bb_column ms = {"ms",           "", "ms", "", BB_COLUMN_ROUNDS, BB_SENSE_TIMED,
                                 BB_BETTER_LESS, 2};
    bb_samples samples = {0};
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    bb_samples_add(&samples, 7);
    const uint32_t row = bb_table_row(table, (bb_cell){{"a"}});
    bb_table_set_rounds(table, row, &ms, &samples);
    bb_table_set_rounds(table, row, &ms, bb_table_get_rounds(table, row, "ms"));
    assert_true(bb_table_get_number(table, row, "ms") == 7);
    bb_table_free(table);
}

/* A few bytes for each row and column would else ask for as much memory as they like. */
static void too_many_values_are_refused(void **state)
{
    (void)state;
    enum { COLUMNS = 10000, ROWS = 10000 };
    const size_t room = COLUMNS * 160 + ROWS * 32 + 256;
    char *json = malloc(room), *at = json;
    at += sprintf(at, "{\"schema\":\"bvhbench-table/1\",\"command\":\"slice\",\"columns\":[");
    for (int c = 0; c < COLUMNS; c++)
        at += sprintf(at,
                      "%s{\"name\":\"c%d\",\"heading\":\"\",\"unit\":\"\",\"help\":\"\","
                      "\"kind\":\"number\",\"sense\":\"exact\",\"better\":\"less\","
                      "\"decimals\":0}",
                      c > 0 ? "," : "", c);
    at += sprintf(at, "],\"rows\":[");
    for (int r = 0; r < ROWS; r++)
        at += sprintf(at, "%s{\"scene\":\"%d\"}", r > 0 ? "," : "", r);
    sprintf(at, "]}");
    bb_table *table;
    assert_int_equal(bb_table_parse(json, "t.json", &table), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "make 100000000 values, at most 67108864 are read"));
    free(json);
}

static void same_text(const bb_table *table)
{
    char *text = bb_table_json(table);
    assert_non_null(text);
    bb_table *again = parse(text);
    char *twice = bb_table_json(again);
    assert_string_equal(text, twice);
    bb_table_free(again);
    free(text);
    free(twice);
}

static void files_read_are_written_the_same(void **state)
{
    (void)state;
    bb_table *table = sample_table(), *empty = new_table();
    same_text(table);
    same_text(empty);
    char *text = bb_table_json(table);
    bb_table *again = parse(text);
    const bb_column *build = bb_table_column_named(again, "build_ms");
    assert_string_equal(build->heading, "build");
    assert_string_equal(build->unit, "ms");
    assert_string_equal(build->help, "Building the tree.");
    assert_string_equal(bb_table_column_named(again, "note")->heading, "");
    assert_true(build->kind == BB_COLUMN_ROUNDS && build->sense == BB_SENSE_TIMED &&
                build->better == BB_BETTER_LESS && build->decimals == 2);
    ASSERT_NEAR(bb_table_get_rounds(again, 0, "build_ms")->values[1], 0.1, 0);
    ASSERT_NEAR(bb_table_get_number(again, bb_table_find(again, of_all), "nodes"), 1e300, 0);
    assert_int_equal(bb_table_find(again, of_sah), 1);
    assert_string_equal(bb_table_get_text(again, 1, "note"), "a%FF\n\"b\" \xc3\xa9\x01");
    free(text);
    bb_table_free(table);
    bb_table_free(empty);
    bb_table_free(again);
}

/* Any doubles, many rows and names. */
static void large_tables_stay_the_same(void **state)
{
    (void)state;
    bb_table *table = new_table();
    bb_random random = bb_random_make(seed_or(1), 0);
    char scene[32];
    for (int i = 0; i < 20000; i++) {
        snprintf(scene, sizeof scene, "scene %d", i);
        const bb_cell cell = {{[BB_SCENE] = scene, [BB_BUILDER] = i % 3 ? "lbvh" : "sah"}};
        const double value = ldexp(bb_random_unit(&random) - 0.5, i % 2000 - 1000);
        bb_table_set_number(table, bb_table_row(table, cell), &column_nodes, value);
    }
    ASSERT_OK(bb_table_status(table));
    assert_int_equal(bb_table_row_count(table), 20000);
    const bb_cell cell = {{[BB_SCENE] = "scene 19999", [BB_BUILDER] = "lbvh"}};
    assert_int_equal(bb_table_find(table, cell), 19999);
    same_text(table);
    bb_table_free(table);
}

static void the_layout_of_files_is_as_published(void **state)
{
    (void)state;
    static const char expected[] =
        "{\"schema\":\"bvhbench-table/1\",\"command\":\"slice\",\n\"columns\":[\n"
        "{\"name\":\"build_ms\",\"heading\":\"build\",\"unit\":\"ms\",\"help\":\"Building the "
        "tree.\",\"kind\":\"rounds\",\"sense\":\"timed\",\"better\":\"less\",\"decimals\":2},\n"
        "{\"name\":\"nodes\",\"heading\":\"nodes\",\"unit\":\"\",\"help\":\"Of the "
        "tree.\",\"kind\":\"number\",\"sense\":\"exact\",\"better\":\"less\",\"decimals\":0},\n"
        "{\"name\":\"note\",\"heading\":\"\",\"unit\":\"\",\"help\":\"Why there is "
        "nothing.\",\"kind\":\"text\",\"sense\":\"exact\",\"better\":\"neither\",\"decimals\":0}],"
        "\n"
        "\"rows\":[\n"
        "{\"scene\":\"cube\",\"builder\":\"lbvh\",\"build_ms\":[9,0.1,0.3],\"nodes\":12345},\n"
        "{\"scene\":\"cube\",\"builder\":\"sah,\\\"quoted\\\"\",\"nodes\":-0.1,\"note\":"
        "\"a%FF\\n\\\"b\\\" \xc3\xa9\\u0001\"},\n"
        "{\"nodes\":1e+300}]}";
    bb_table *table = sample_table();
    char *text = bb_table_json(table);
    assert_string_equal(text, expected);
    free(text);
    bb_table_free(table);
}

/* A sound file in which `old` is replaced; one line must hold `words`. */
static void refuses_change(const char *old, const char *new, const char *words)
{
    bb_table *table = sample_table(), *out;
    char *text = bb_table_json(table), changed[8192];
    const char *at = strstr(text, old);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
    const bb_status status = bb_table_parse(changed, "a file", &out);
    if (status != BB_INVALID || strstr(bb_message(), words) == NULL ||
        strncmp(bb_message(), "table a file", 12) != 0 || strpbrk(bb_message(), "\r\n") != NULL)
        fail_msg("%s -> %s: status %d, '%s', expected '%s'", old, new, status, bb_message(), words);
    assert_null(out);
    free(text);
    bb_table_free(table);
}

static void damaged_files_are_refused(void **state)
{
    (void)state;
    refuses_change("bvhbench-table/1", "bvhbench-slice/1",
                   "its schema is \"bvhbench-slice/1\", this program reads \"bvhbench-table/1\"");
    refuses_change("bvhbench-table/1", "bvhbench-table/2", "bvhbench-table/2");
    refuses_change("\"schema\":\"bvhbench-table/1\",", "", "no \"schema\"");
    refuses_change("{", "{\"schema\":\"bvhbench-table/1\",", "it has twice a member \"schema\"");
    refuses_change("{", "{\"context\": 1,", "it has an unknown member \"context\"");
    refuses_change("\"command\":\"slice\",", "", "it has no \"command\"");
    refuses_change("\"slice\"", "7", "\"command\" is no lower-case word");
    refuses_change("\"slice\"", "\"../Slice\"", "\"command\" is no lower-case word");
    refuses_change("\"columns\":[", "\"columns\":[7,", "columns[0] is no object");
    refuses_change("\"heading\":\"build\",", "", "columns[0] has no \"heading\"");
    refuses_change("\"heading\":\"build\"", "\"heading\":1", "\"heading\" has the wrong type");
    refuses_change("\"heading\":\"build\"", "\"unit\":\"ms\"",
                   "columns[0] has twice a member \"unit\"");
    refuses_change("\"heading\":\"build\"", "\"Heading\":\"\"", "unknown member \"Heading\"");
    refuses_change("\"name\":\"build_ms\"", "\"name\":\"nodes\"",
                   "columns[1]: there are two of that name");
    refuses_change("\"name\":\"build_ms\"", "\"name\":\"maker\"",
                   "columns[0]: its name is that of a cell's dimension");
    refuses_change("\"name\":\"build_ms\"", "\"name\":\"\"", "its name is no lower-case word");
    refuses_change("\"kind\":\"rounds\"", "\"kind\":\"round\"", "\"kind\" is none of its words");
    refuses_change("\"sense\":\"timed\"", "\"sense\":null", "\"sense\" is none of its words");
    refuses_change("\"better\":\"less\"", "\"better\":\"worse\"", "\"better\" is none");
    refuses_change("\"decimals\":2", "\"decimals\":2.5", "decimals are not -1 to 15");
    refuses_change("\"decimals\":2", "\"decimals\":99", "decimals are not -1 to 15");
    refuses_change("\"columns\":[", "\"columns\": {}, \"x\": [", "unknown member \"x\"");
}

static void damaged_rows_are_refused(void **state)
{
    (void)state;
    refuses_change("\"rows\":[", "\"rows\":[[],", "rows[0] is no object");
    refuses_change("\"nodes\":12345", "\"leaves\":12345", "rows[0] has no column for \"leaves\"");
    refuses_change("\"nodes\":12345", "\"nodes\":1,\"nodes\":1",
                   "rows[0] has twice a member \"nodes\"");
    refuses_change("\"scene\":\"cube\"", "\"scene\":\"a\",\"scene\":\"b\"",
                   "twice a member \"scene\"");
    refuses_change("\"scene\":\"cube\"", "\"scene\":\"\"", "\"scene\" has the wrong type");
    refuses_change("\"scene\":\"cube\"", "\"scene\":null", "\"scene\" has the wrong type");
    refuses_change("\"nodes\":12345", "\"nodes\":\"12345\"", "\"nodes\" has the wrong type");
    refuses_change("\"nodes\":12345", "\"nodes\":null", "\"nodes\" has the wrong type");
    refuses_change("\"nodes\":12345", "\"nodes\":[1]", "\"nodes\" has the wrong type");
    refuses_change("\"nodes\":12345", "\"nodes\":1e999", "\"nodes\" has the wrong type");
    refuses_change("\"note\":\"a", "\"note\":\"\",\"x\":\"a", "\"note\" has the wrong type");
    refuses_change("[9,0.1,0.3]", "9", "\"build_ms\" is no list of 1 to 256 numbers");
    refuses_change("[9,0.1,0.3]", "[]", "\"build_ms\" is no list");
    refuses_change("[9,0.1,0.3]", "[9,null]", "\"build_ms\" is no list");
    refuses_change("[9,0.1,0.3]", "[[9]]", "\"build_ms\" is no list");
    refuses_change("\"rows\":[", "\"rows\":[{\"nodes\":1},",
                   "rows[3] is of the same cell as rows[0]");
    refuses_change("%FF", "\xff", "is not UTF-8");
    refuses_change("%FF", "\\u0000", "\\u0000");
    refuses_change("]}", "",
                   "is not JSON, is truncated, or is too large for the memory left: error at byte");
    refuses_change("]}", "]} 7", "is not JSON, is truncated");
    refuses_change("{\"schema\"", "\xef\xbb\xbf{\"schema\"", "error at byte 0");
    static const char *const numbers[] = {"01", "-01", "1.", "1.e3", "-.5", "00"};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        char member[64];
        snprintf(member, sizeof member, "\"nodes\":%s", numbers[i]);
        refuses_change("\"nodes\":12345", member, "is not JSON");
    }
    char many[2000] = "[1";
    for (int i = 0; i < 256; i++)
        strcat(many, ",1");
    strcat(many, "]");
    refuses_change("[9,0.1,0.3]", many, "\"build_ms\" is no list of 1 to 256 numbers");
}

/* A backslash before u0000 makes it a text of six letters. */
static void a_backslash_is_no_zero(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_table_set_text(table, 1, &column_note, "\\u0000");
    same_text(table);
    bb_table_free(table);
}

/* Each beginning of a file is refused, from a path too. */
static void truncated_files_are_refused(void **state)
{
    (void)state;
    bb_table *table = sample_table(), *out;
    char *text = bb_table_json(table), path[1024];
    const size_t length = strlen(text);
    snprintf(path, sizeof path, "%s/table.json", folder);
    for (size_t size = 0; size + 2 < length; size += size + 40 < length ? 13 : 1) {
        write_file("table.json", text, size);
        assert_int_equal(bb_table_read(path, &out), BB_INVALID);
        assert_non_null(strstr(bb_message(), "table.json"));
    }
    write_file("table.json", text, length);
    ASSERT_OK(bb_table_read(path, &out));
    bb_table_free(out);
    write_file("table.json", text, length + 1); /* with the 0 */
    assert_int_equal(bb_table_read(path, &out), BB_INVALID);
    assert_non_null(strstr(bb_message(), "is 0: it is no text"));
    assert_int_equal(bb_table_read(folder, &out), BB_INVALID);
    free(text);
    bb_table_free(table);
}

static void csv_has_a_line_for_each_row(void **state)
{
    (void)state;
    bb_table *table = sample_table();
    bb_samples rounds = {.count = 0};
    for (int i = 0; i < 12; i++)
        bb_samples_add(&rounds, 1);
    bb_table_set_rounds(table, 2, &column_build, &rounds);
    char *text = bb_table_csv(table);
    assert_string_equal(text,
                        "scene,builder,build_ms,build_ms.low,build_ms.high,nodes,note\r\n"
                        "cube,lbvh,0.2,,,12345,\r\n"
                        "cube,\"sah,\"\"quoted\"\"\",,,,-0.1,\"a%FF\n\"\"b\"\" \xc3\xa9\x01\"\r\n"
                        ",,1,1,1,1e+300,\r\n");
    free(text);
    bb_table_free(table);
}

/* ---- numbers ---- */

static void shows(double value, int decimals, const char *text)
{
    char out[BB_FIGURE_MAX];
    assert_string_equal(bb_figure(out, value, decimals), text);
}

static void numbers_are_short_and_clear(void **state)
{
    (void)state;
    shows(1.005, 1, "1.0");
    shows(1234567, 0, "1,234,567");
    shows(-1234, 0, "-1,234");
    shows(-123, 0, "-123");
    shows(12345.678, 2, "12345.68");
    shows(0, -1, "0");
    shows(0.001234, -1, "0.00123");
    shows(0.01234, -1, "0.0123");
    shows(0.1234, -1, "0.123");
    shows(1.234, -1, "1.23");
    shows(-12.34, -1, "-12.3");
    shows(123.4, -1, "123");
    shows(12345.6, -1, "12,346");
    shows(1.234e8, -1, "1.23e+08");
    shows(1.234e-5, -1, "1.23e-05");
    shows(1.234e20, 2, "1.23e+20");
    shows(-1e300, 0, "-1e+300");
    shows(NAN, 2, "-");
    shows(-INFINITY, -1, "-");
    shows(999999999999999, 15, "999999999999999.000000000000000");
}

static void intervals_and_bytes_are_clear(void **state)
{
    (void)state;
    char out[BB_FIGURE_MAX];
    const bb_estimate e = {.value = 1.03, .low = 1.009, .high = 1.051};
    assert_string_equal(bb_figure_interval(out, e, 2), "1.03 [1.01, 1.05]");
    assert_string_equal(bb_figure_interval(out, bb_not_measured, 2), "-");
    const bb_estimate alone = {.value = 12, .low = NAN, .high = NAN};
    assert_string_equal(bb_figure_interval(out, alone, 1), "12.0");
    const bb_estimate wide = {.value = -9e14, .low = -9e14, .high = 9e14};
    assert_string_equal(bb_figure_interval(out, wide, 0),
                        "-900,000,000,000,000 [-900,000,000,000,000, 900,000,000,000,000]");
    assert_string_equal(bb_figure_bytes(out, 1023), "1,023 B");
    assert_string_equal(bb_figure_bytes(out, 3.25 * 1048576), "3.25 MiB");
    assert_string_equal(bb_figure_bytes(out, 32.5 * 1024), "32.5 KiB");
    assert_string_equal(bb_figure_bytes(out, ldexp(1, 60)), "1,048,576 TiB");
    assert_string_equal(bb_figure_bytes(out, NAN), "-");
    assert_string_equal(bb_figure_bytes(out, 0), "0 B");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cell_has_one_row),
        cmocka_unit_test(values_are_there_or_not),
        cmocka_unit_test(what_is_no_value_takes_one_away),
        cmocka_unit_test(two_columns_of_one_name_are_a_mistake),
        cmocka_unit_test(faulty_declarations_are_refused),
        cmocka_unit_test(names_that_are_no_utf8_are_found),
        cmocka_unit_test(rounds_may_be_put_where_they_came_from),
        cmocka_unit_test(too_many_values_are_refused),
        cmocka_unit_test(files_read_are_written_the_same),
        cmocka_unit_test(large_tables_stay_the_same),
        cmocka_unit_test(the_layout_of_files_is_as_published),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(damaged_rows_are_refused),
        cmocka_unit_test(a_backslash_is_no_zero),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(csv_has_a_line_for_each_row),
        cmocka_unit_test(numbers_are_short_and_clear),
        cmocka_unit_test(intervals_and_bytes_are_clear),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
