/* Rows of options: where each kind stores its value, defaults, groups, rows that name others, and
 * declarations that are wrong. */
#include "framework/cli/cli.h"
#include "tests/fixture.h"

#include <stdlib.h>
#include <string.h>

typedef struct part {
    const char *text;
    uint32_t word;
} part;

typedef struct values {
    bool flag, other, fast;
    uint32_t count, width, height;
    uint64_t wide;
    double real;
    const char *name;
    bb_names list, each;
    part part;
} values;

static const bb_cli_option of_part[] = {
    {"text", "T", "a text of the group", BB_INTO(part, text), .fallback = "usual"},
    {"word", NULL, "a word of the group", BB_INTO(part, word), .words = "one|two|three",
     .fallback = "two"},
    {.name = NULL},
};

static const bb_cli_option rows[] = {
    {"flag", NULL, "a flag", BB_INTO(values, flag)},
    {"other", NULL, "a flag", BB_INTO(values, other), .with = "flag", .apart = "name|real"},
    {"fast", NULL, "changes defaults", BB_INTO(values, fast),
     .presets = (const char *const[]){"count", "2", "size", "3x4", NULL}},
    {"count", "N", "a number", BB_INTO(values, count), .low = 1, .high = 9, .fallback = "7"},
    {"size", "WxH", "a size", BB_INTO_SIZE(values, width), .fallback = "5x6"},
    {"wide", "N", "a wide number", BB_INTO(values, wide)},
    {"real", "X", "a real number", BB_INTO(values, real), .low = -1, .high = 1},
    {"name", "S", "a text", BB_INTO(values, name)},
    {"list", "L", "a list", BB_INTO(values, list), .fallback = "a,b"},
    {"each", "E", "items", BB_INTO_EACH(values, each)},
    BB_GROUP(of_part, values, part),
    {.name = NULL},
};

static bb_status no_run(const bb_cli *cli, void *self, int *exit_status)
{
    (void)cli, (void)self, (void)exit_status;
    return BB_OK;
}

static bb_command command_of(const bb_cli_option *options)
{
    return (bb_command){.name = "try",
                        .summary = "tries rows",
                        .options = options,
                        .bytes = sizeof(values),
                        .run = no_run};
}

static bb_cli cli;
static bb_command command;

/* The values of these words after "bvhbench try"; NULL ends them. */
static bb_status parse(const bb_cli_option *options, const char *const *words)
{
    static char buffers[16][64];
    static char *argv[18];
    int argc = 2;
    bool help = false;
    argv[0] = buffers[0], argv[1] = buffers[1];
    for (; words[argc - 2] != NULL; argc++) {
        argv[argc] = buffers[argc];
        snprintf(buffers[argc], sizeof buffers[argc], "%s", words[argc - 2]);
    }
    bb_cli_free(&cli);
    command = command_of(options);
    return bb_cli_parse(&cli, &command, argc, argv, &help);
}

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static const values *expect_values(const char *const *words)
{
    if (parse(rows, words) != BB_OK)
        fail_msg("%s", bb_message());
    return cli.values;
}

static void expect_refusal(const bb_cli_option *options, const char *const *words,
                           const char *message)
{
    if (parse(options, words) == BB_OK)
        fail_msg("taken, without '%s'", message);
    if (strstr(bb_message(), message) == NULL)
        fail_msg("'%s' has no '%s'", bb_message(), message);
}

static void each_kind_is_stored(void **state)
{
    (void)state;
    const values *v = expect_values(WORDS("--flag", "--count", "3", "--size=16x1k", "--wide",
                                          "18446744073709551615", "--real=-0.5", "--name", "-",
                                          "--text", "t", "--word", "three"));
    assert_true(v->flag && !v->other && !v->fast);
    assert_int_equal(v->count, 3);
    assert_int_equal(v->width, 16);
    assert_int_equal(v->height, 1000);
    assert_true(v->wide == UINT64_MAX && v->real == -0.5);
    assert_string_equal(v->name, "-");
    assert_string_equal(v->part.text, "t");
    assert_int_equal(v->part.word, 2);
    assert_true(bb_cli_given(&cli, &v->count) && !bb_cli_given(&cli, &v->list));
}

static void lists_are_split_and_items_are_not(void **state)
{
    (void)state;
    const values *v =
        expect_values(WORDS("--list", "x,y", "--list=z", "--each", "a,b", "--each", "c"));
    assert_int_equal(v->list.count, 3);
    assert_string_equal(v->list.items[2], "z");
    assert_int_equal(v->each.count, 2);
    assert_string_equal(v->each.items[0], "a,b");
}

static void defaults_are_stored_and_flags_change_them(void **state)
{
    (void)state;
    const values *v = expect_values((const char *const[]){NULL});
    assert_int_equal(v->count, 7);
    assert_int_equal(v->width, 5);
    assert_int_equal(v->list.count, 2);
    assert_null(v->name);
    assert_string_equal(v->part.text, "usual");
    assert_int_equal(v->part.word, 1);
    v = expect_values(WORDS("--fast", "--count", "9"));
    assert_int_equal(v->count, 9);
    assert_int_equal(v->width, 3);
    assert_int_equal(v->height, 4);
}

static void help_is_made_of_the_rows(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    command = command_of(rows);
    assert_int_equal(bb_cli_help(&command, out), BB_OK);
    fclose(out);
    static const char *const lines[] = {
        "  --flag                         a flag\n",
        "  --count N                      a number; default: 7\n",
        "  --fast                         changes defaults; changes defaults to --count 2 --size "
        "3x4\n",
        "  --list L                       a list; default: a,b (may be repeated)\n",
        "  --text T                       a text of the group; default: usual\n",
        "  --word one|two|three           a word of the group; default: two\n",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        if (strstr(text, lines[i]) == NULL)
            fail_msg("no '%s' in %s", lines[i], text);
    free(text);
}

/* However long the words are, all of them are shown. */
static void help_says_what_is_needed_and_is_not_cut(void **state)
{
    (void)state;
    static const bb_cli_option long_words[] = {
        {"word", NULL, "a word", BB_INTO(values, count), .needed = true,
         .words = "a-word-of-some-length|another-word-of-some-length|the-last-word"},
        {.name = NULL},
    };
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    command = command_of(long_words);
    assert_int_equal(bb_cli_help(&command, out), BB_OK);
    fclose(out);
    assert_non_null(strstr(text, "|the-last-word a word; needed\n"));
    free(text);
}

static void words_that_are_no_options_are_positional(void **state)
{
    (void)state;
    bool help = false;
    char *argv[] = {"bvhbench", "try", "a", "--flag", "-", "--", "--count"};
    bb_cli_free(&cli);
    command = command_of(rows);
    command.arguments = "WORDS";
    assert_int_equal(bb_cli_parse(&cli, &command, 7, argv, &help), BB_OK);
    assert_int_equal(cli.positional_count, 3);
    assert_string_equal(cli.positional[1], "-");
    assert_string_equal(cli.positional[2], "--count");
    assert_string_equal(cli.command_line, "bvhbench try a --flag - -- --count");
}

static void bad_values_are_refused(void **state)
{
    (void)state;
    expect_refusal(rows, WORDS("--count", "0"), "--count is '0', must be a whole number from 1");
    expect_refusal(rows, WORDS("--count", "10"), "from 1 to 9");
    expect_refusal(rows, WORDS("--wide", "18446744073709551616"), "below 2^64");
    expect_refusal(rows, WORDS("--real", "1.5"), "must be a number from -1 to 1");
    expect_refusal(rows, WORDS("--size", "3"), "must be WIDTHxHEIGHT");
    expect_refusal(rows, WORDS("--word", "on"), "--word is 'on', must be one, two or three");
    expect_refusal(rows, WORDS("--list", "a,,b"), "--list: empty item");
    expect_refusal(rows, WORDS("--count", "2", "--count=3"), "--count is given twice");
    expect_refusal(rows, WORDS("--flag=1"), "does not take a value");
    expect_refusal(rows, WORDS("--count"), "--count needs a value");
    expect_refusal(rows, WORDS("--cout"), "did you mean '--count'?");
    expect_refusal(rows, WORDS("--flags"), "unknown option '--flags'");
    expect_refusal(rows, WORDS("stray"), "unexpected argument 'stray'");
}

static void options_that_need_or_exclude_others(void **state)
{
    (void)state;
    expect_refusal(rows, WORDS("--other"), "try: --other needs --flag");
    expect_refusal(rows, WORDS("--flag", "--other", "--real", "0"),
                   "--other and --real do not go together");
    expect_values(WORDS("--flag", "--other", "--count", "2"));
    static const bb_cli_option needed[] = {
        {"name", "S", "a text", BB_INTO(values, name), .needed = true},
        {"each", "E", "items", BB_INTO_EACH(values, each), .needed = true},
        {.name = NULL},
    };
    expect_refusal(needed, WORDS("--help-me"), "unknown option");
    expect_refusal(needed, (const char *const[]){NULL}, "try needs --name and --each: see");
    expect_refusal(needed, WORDS("--name", "x"), "try needs --each: see");
}

static void a_row_of_the_command_replaces_one_of_a_group(void **state)
{
    (void)state;
    static const bb_cli_option own[] = {
        BB_GROUP(of_part, values, part),
        {"word", NULL, "another word", BB_INTO(values, count), .words = "four|five"},
        {.name = NULL},
    };
    assert_int_equal(parse(own, WORDS("--word", "five")), BB_OK);
    const values *v = cli.values;
    assert_int_equal(v->count, 1);
    assert_int_equal(v->part.word, 0);
}

/* A table of one wrong row, after one that is right. */
static void expect_fault(bb_cli_option row, const char *message)
{
    const bb_cli_option table[] = {
        {"flag", NULL, "a flag", BB_INTO(values, flag)}, row, {.name = NULL}};
    expect_refusal(table, WORDS("--flag"), message);
    if (strstr(bb_message(), "try: the d") == NULL)
        fail_msg("'%s' blames no declaration", bb_message());
}

static void wrong_declarations_are_refused(void **state)
{
    (void)state;
    const bb_cli_option right = {"n", "N", "", BB_INTO(values, count), .fallback = "1"};
    bb_cli_option row = right;
    row.name = "flag";
    expect_fault(row, "there is another of this name");
    row.name = "help";
    expect_fault(row, "there is another of this name");
    row = right, row.offset = sizeof(values) - 2;
    expect_fault(row, "outside of the command's struct");
    row = right, row.argument = NULL;
    expect_fault(row, "a flag takes no value");
    row = right, row.kind = BB_CLI_FLAG;
    expect_fault(row, "a flag takes no value");
    row = right, row.kind = BB_CLI_U64, row.words = "a|b";
    expect_fault(row, "needs a uint32_t");
    row = right, row.kind = BB_CLI_END;
    expect_fault(row, "its value is stored nowhere");
    row = right, row.offset = offsetof(values, flag);
    expect_fault(row, "in the same place");
    row = right, row.low = 3, row.high = 2;
    expect_fault(row, "its range is empty");
    row = right, row.low = -1, row.high = 2;
    expect_fault(row, "its type cannot hold it");
    row = right, row.high = 0x1p32;
    expect_fault(row, "its type cannot hold it");
    row = right, row.words = "one|two", row.high = 1;
    expect_fault(row, "its type cannot hold it");
    row = right, row.needed = true;
    expect_fault(row, "a flag has no default");
    row = right, row.argument = NULL, row.kind = BB_CLI_FLAG, row.offset = offsetof(values, fast);
    expect_fault(row, "a flag has no default");
    row = right, row.fallback = "many";
    expect_fault(row, "the default of an option is wrong: --n is 'many'");
    row = right, row.with = "nothing";
    expect_fault(row, "there is no --nothing");
    row = right, row.apart = "flag|nothing";
    expect_fault(row, "there is no --nothing");
    row = right, row.presets = (const char *const[]){"nothing", "1", NULL};
    expect_fault(row, "there is no --nothing");
}

/* Only what is missing is refused; `word` NULL: nothing is given. */
static void expect_sound(const bb_command *c, char *word)
{
    char *argv[] = {"bvhbench", "command", word, NULL};
    bool help = false;
    bb_cli_free(&cli);
    if (bb_cli_parse(&cli, c, word != NULL ? 3 : 2, argv, &help) != BB_OK &&
        strstr(bb_message(), " needs --") == NULL)
        fail_msg("%s %s: %s", c->name, word != NULL ? word : "", bb_message());
}

/* All declarations and defaults, and those that flags change. */
static void the_tables_of_all_commands_are_sound(void **state)
{
    (void)state;
    for (const bb_command *const *c = bb_commands; *c != NULL; c++) {
        expect_sound(*c, NULL);
        for (const bb_cli_option *o = (*c)->options; o->kind != BB_CLI_END; o++) {
            char word[64];
            if (o->presets == NULL)
                continue;
            snprintf(word, sizeof word, "--%s", o->name);
            expect_sound(*c, word);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_is_stored),
        cmocka_unit_test(lists_are_split_and_items_are_not),
        cmocka_unit_test(defaults_are_stored_and_flags_change_them),
        cmocka_unit_test(help_is_made_of_the_rows),
        cmocka_unit_test(help_says_what_is_needed_and_is_not_cut),
        cmocka_unit_test(words_that_are_no_options_are_positional),
        cmocka_unit_test(bad_values_are_refused),
        cmocka_unit_test(options_that_need_or_exclude_others),
        cmocka_unit_test(a_row_of_the_command_replaces_one_of_a_group),
        cmocka_unit_test(wrong_declarations_are_refused),
        cmocka_unit_test(the_tables_of_all_commands_are_sound),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    bb_cli_free(&cli);
    return failed;
}
