/* Parses the command line into a command's struct of values, by the rows of its table. */
#include "framework/base/shell_word.h"
#include "framework/base/suggest.h"
#include "framework/cli/cli.h"

#include <stdlib.h>
#include <string.h>

/* ---- the rows ---- */

const bb_cli_row *bb_cli_find(const bb_cli *cli, const char *name)
{
    for (uint32_t i = 0; i < cli->row_count; i++)
        if (strcmp(cli->rows[i].option->name, name) == 0)
            return &cli->rows[i];
    return NULL;
}

bool bb_cli_given(const bb_cli *cli, const void *place)
{
    for (uint32_t i = 0; i < cli->row_count; i++)
        if (cli->rows[i].place == place)
            return cli->rows[i].count > 0;
    return false;
}

static size_t bytes_of(bb_cli_kind kind)
{
    static const size_t bytes[] = {
        [BB_CLI_FLAG] = sizeof(bool),     [BB_CLI_U32] = sizeof(uint32_t),
        [BB_CLI_U64] = sizeof(uint64_t),  [BB_CLI_DOUBLE] = sizeof(double),
        [BB_CLI_TEXT] = sizeof(char *),   [BB_CLI_SIZE] = 2 * sizeof(uint32_t),
        [BB_CLI_LIST] = sizeof(bb_names), [BB_CLI_EACH] = sizeof(bb_names),
    };
    return bytes[kind];
}

static bool has_wrong_range(const bb_cli_option *o)
{
    const bool wide = o->kind == BB_CLI_U64, number = o->kind == BB_CLI_U32 || wide;
    if (o->words != NULL || (!number && o->kind != BB_CLI_DOUBLE))
        return o->low != 0 || o->high != 0;
    if (number && (o->low < 0 || o->high >= (wide ? 0x1p64 : 0x1p32)))
        return true;
    return o->high > 0 ? o->low > o->high : o->kind == BB_CLI_DOUBLE;
}

/* Returns whether the value would overwrite that of an earlier row. */
static bool is_taken(const bb_cli *cli, size_t offset, size_t bytes)
{
    const char *place = (char *)cli->values + offset;
    for (uint32_t i = 0; i < cli->row_count; i++) {
        const bb_cli_row *row = &cli->rows[i];
        if (place < row->place + bytes_of(row->option->kind) && row->place < place + bytes)
            return true;
    }
    return false;
}

/* Returns what is wrong with a row; NULL: nothing. */
static const char *fault_of(const bb_cli *cli, const bb_cli_option *o, size_t offset)
{
    if (o->kind == BB_CLI_END)
        return "its value is stored nowhere";
    if (bb_cli_find(cli, o->name) != NULL || strcmp(o->name, "help") == 0)
        return "there is another of this name";
    if (cli->row_count == BB_CLI_OPTIONS_MAX)
        return "there are too many";
    if (offset + bytes_of(o->kind) > cli->command->bytes)
        return "its value lies outside of the command's struct";
    if (is_taken(cli, offset, bytes_of(o->kind)))
        return "another option stores its value in the same place";
    if ((o->kind == BB_CLI_FLAG) != (o->argument == NULL && o->words == NULL))
        return "a flag takes no value, and any other option takes one";
    if (o->words != NULL && o->kind != BB_CLI_U32)
        return "the number of a word needs a uint32_t";
    if (has_wrong_range(o))
        return "its range is empty, or its type cannot hold it";
    if (o->fallback != NULL && (o->needed || o->kind == BB_CLI_FLAG))
        return "a flag has no default, nor has an option that is needed";
    return NULL;
}

/* Returns whether a row of the command itself replaces a group's row of this name. */
static bool is_replaced(const bb_command *command, const char *name)
{
    for (const bb_cli_option *o = command->options; o->kind != BB_CLI_END; o++)
        if (o->kind != BB_CLI_GROUP && strcmp(o->name, name) == 0)
            return true;
    return false;
}

static bb_status add_rows(bb_cli *cli, const bb_cli_option *rows, size_t base)
{
    const bb_command *command = cli->command;
    for (const bb_cli_option *o = rows; o->kind != BB_CLI_END || o->name != NULL; o++) {
        if (o->kind == BB_CLI_GROUP) {
            BB_TRY(add_rows(cli, o->group, base + o->offset));
            continue;
        }
        if (rows != command->options && is_replaced(command, o->name))
            continue;
        const char *fault = fault_of(cli, o, base + o->offset);
        if (fault != NULL)
            return bb_fail(BB_INVALID, "%s: the declaration of --%s is wrong: %s", command->name,
                           o->name, fault);
        cli->rows[cli->row_count++] =
            (bb_cli_row){.option = o, .place = (char *)cli->values + base + o->offset};
    }
    return BB_OK;
}

/* ---- what is given ---- */

static bb_status fail(const bb_cli *cli, const char *what, const char *given, const char *meant)
{
    const char *name = cli->command->name;
    return bb_fail(BB_INVALID, "%s: %s '%s'%s: see `bvhbench %s --help`", name, what, given, meant,
                   name);
}

/* Refuses an option. `given` begins with two dashes. */
static bb_status unknown_option(const bb_cli *cli, const char *given)
{
    char word[64];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(given + 2, "="), given + 2);
    bb_suggestion meant = {.word = word, .prefix = "--"};
    for (uint32_t i = 0; i < cli->row_count; i++)
        bb_suggest(&meant, cli->rows[i].option->name);
    bb_suggest(&meant, "help");
    return fail(cli, "unknown option", given, bb_suggested(&meant));
}

static bb_status take(bb_cli_row *row, const char *text)
{
    const bb_cli_option *o = row->option;
    if (o->kind != BB_CLI_FLAG && text[0] == '\0')
        return bb_fail(BB_INVALID, "--%s is empty: give it a value, or leave it out", o->name);
    if (row->count > 0 && o->kind != BB_CLI_LIST && o->kind != BB_CLI_EACH)
        return bb_fail(BB_INVALID, "--%s is given twice", o->name);
    if (row->count == BB_NAMES_MAX)
        return bb_fail(BB_INVALID, "--%s is given more than %d times", o->name, BB_NAMES_MAX);
    row->given[row->count++] = text;
    return BB_OK;
}

/* Takes `--name`, `--name value` or `--name=value`. `next` is the following word, or NULL;
 * *took_next says whether it was the value. */
static bb_status take_option(bb_cli *cli, const char *word, const char *next, bool *took_next)
{
    for (uint32_t i = 0; i < cli->row_count; i++) {
        const bb_cli_option *o = cli->rows[i].option;
        const size_t length = strlen(o->name);
        if (strncmp(word + 2, o->name, length) != 0)
            continue;
        const char *end = word + 2 + length;
        if (*end == '=' && o->kind == BB_CLI_FLAG)
            return bb_fail(BB_INVALID,
                           "%s: '%s': this option does not take a value: see `bvhbench %s --help`",
                           cli->command->name, word, cli->command->name);
        if (*end == '=')
            return take(&cli->rows[i], end + 1);
        if (*end != '\0')
            continue;
        if (o->kind == BB_CLI_FLAG)
            return take(&cli->rows[i], "");
        if (next == NULL)
            return bb_fail(BB_INVALID, "%s: %s needs a value: see `bvhbench %s --help`",
                           cli->command->name, word, cli->command->name);
        *took_next = true;
        return take(&cli->rows[i], next);
    }
    return unknown_option(cli, word);
}

static bb_status take_words(bb_cli *cli, int argc, char **argv, bool *help)
{
    bool options = true;
    for (int i = 2; i < argc; i++) {
        char *word = argv[i];
        bool took_next = false;
        if (!options || word[0] != '-' || word[1] == '\0') {
            cli->positional[cli->positional_count++] = word;
            continue;
        }
        *help = strcmp(word, "-h") == 0 || strcmp(word, "--help") == 0;
        if (*help)
            return BB_OK;
        if (word[1] != '-')
            return fail(cli, "unknown option", word, "");
        options = word[2] != '\0';
        if (options)
            BB_TRY(take_option(cli, word, i + 1 < argc ? argv[i + 1] : NULL, &took_next));
        i += took_next;
    }
    if (cli->command->arguments == NULL && cli->positional_count > 0)
        return fail(cli, "unexpected argument", cli->positional[0], "");
    return BB_OK;
}

/* ---- values ---- */

/* Returns the next of the names between bars, and moves *list behind it; NULL after the last. */
static const char *next_name(const char **list, char name[64])
{
    if (*list == NULL || **list == '\0')
        return NULL;
    const size_t length = strcspn(*list, "|");
    snprintf(name, 64, "%.*s", (int)length, *list);
    *list += length + ((*list)[length] == '|');
    return name;
}

static bb_status undeclared(const bb_cli *cli, const char *option, const char *other)
{
    return bb_fail(BB_INVALID, "%s: the declaration of --%s is wrong: there is no --%s",
                   cli->command->name, option, other);
}

/* Checks `apart`, `with` and `presets` of a row, which name other options. */
static bb_status check_others(const bb_cli *cli, const bb_cli_row *row)
{
    const bb_cli_option *o = row->option;
    const char *command = cli->command->name, *list = o->apart;
    char name[64];
    while (next_name(&list, name) != NULL) {
        const bb_cli_row *other = bb_cli_find(cli, name);
        if (other == NULL)
            return undeclared(cli, o->name, name);
        if (row->count > 0 && other->count > 0)
            return bb_fail(BB_INVALID, "%s: --%s and --%s do not go together: drop one of them",
                           command, o->name, name);
    }
    const bb_cli_row *with = o->with != NULL ? bb_cli_find(cli, o->with) : NULL;
    if (o->with != NULL && with == NULL)
        return undeclared(cli, o->name, o->with);
    if (with != NULL && row->count > 0 && with->count == 0)
        return bb_fail(BB_INVALID, "%s: --%s needs --%s", command, o->name, o->with);
    for (const char *const *p = o->presets; p != NULL && *p != NULL; p += 2)
        if (bb_cli_find(cli, p[0]) == NULL)
            return undeclared(cli, o->name, p[0]);
    return BB_OK;
}

/* Names all options that are needed and not given. */
static bb_status check_needed(const bb_cli *cli)
{
    const char *command = cli->command->name;
    char missing[256] = "";
    for (uint32_t i = 0; i < cli->row_count; i++) {
        const size_t used = strlen(missing);
        if (cli->rows[i].option->needed && cli->rows[i].count == 0)
            snprintf(missing + used, sizeof missing - used, "%s--%s", used > 0 ? " and " : "",
                     cli->rows[i].option->name);
    }
    return missing[0] == '\0' ? BB_OK
                              : bb_fail(BB_INVALID, "%s needs %s: see `bvhbench %s --help`",
                                        command, missing, command);
}

/* Returns the default of an option: that of a flag that is given, else the row's own. */
static const char *default_of(const bb_cli *cli, const bb_cli_option *o)
{
    for (uint32_t i = 0; i < cli->row_count; i++)
        for (const char *const *p = cli->rows[i].option->presets;
             cli->rows[i].count > 0 && p != NULL && *p != NULL; p += 2)
            if (strcmp(p[0], o->name) == 0)
                return p[1];
    return o->fallback;
}

static bb_status store(const bb_cli *cli, const bb_cli_row *row)
{
    const char *usual = default_of(cli, row->option);
    for (uint32_t i = 0; i < row->count; i++)
        BB_TRY(bb_cli_store(row, row->given[i]));
    bb_status status = row->count == 0 && usual != NULL ? bb_cli_store(row, usual) : BB_OK;
    return status == BB_OK ? BB_OK
                           : bb_fail(BB_INVALID, "%s: the default of an option is wrong: %s",
                                     cli->command->name, bb_message());
}

static char *command_line(int argc, char **argv)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        return NULL;
    fputs("bvhbench", out);
    for (int i = 1; i < argc; i++) {
        fputc(' ', out);
        bb_put_shell_word(out, argv[i]);
    }
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}

bb_status bb_cli_parse(bb_cli *cli, const bb_command *command, int argc, char **argv, bool *help)
{
    cli->command = command;
    cli->command_line = command_line(argc, argv);
    cli->values = calloc(1, command->bytes + 1);
    cli->positional = calloc((size_t)argc + 1, sizeof *cli->positional);
    if (cli->command_line == NULL || cli->values == NULL || cli->positional == NULL)
        return bb_fail(BB_FAILED, "%s: no memory for the command line", command->name);
    BB_TRY(add_rows(cli, command->options, 0));
    BB_TRY(take_words(cli, argc, argv, help));
    for (uint32_t i = 0; i < cli->row_count && !*help; i++)
        BB_TRY(check_others(cli, &cli->rows[i]));
    for (uint32_t i = 0; i < cli->row_count && !*help; i++)
        BB_TRY(store(cli, &cli->rows[i]));
    return *help ? BB_OK : check_needed(cli);
}

void bb_cli_free(bb_cli *cli)
{
    for (uint32_t i = 0; i < cli->row_count; i++) {
        const bb_cli_kind kind = cli->rows[i].option->kind;
        if (kind == BB_CLI_LIST || kind == BB_CLI_EACH)
            bb_names_free((bb_names *)(void *)cli->rows[i].place);
    }
    free(cli->values);
    free(cli->positional);
    free(cli->command_line);
    memset(cli, 0, sizeof *cli);
}
