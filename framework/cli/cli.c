/* Parsing of the command line and its help. */
#include "framework/cli/cli.h"

#include "framework/base/interrupt.h"
#include "framework/base/options.h"
#include "framework/base/suggest.h"
#include "framework/cli/out_option.h"

#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const char bb_build_version[], bb_build_revision[];

/* ---- help ---- */

static void print_help(const bb_command *command)
{
    printf("usage: bvhbench %s [options]%s%s\n\n%s\n\noptions:\n", command->name,
           command->arguments != NULL ? " " : "",
           command->arguments != NULL ? command->arguments : "", command->summary);
    for (const bb_cli_option *o = command->options; o->name != NULL; o++) {
        char left[48];
        if (o->help == NULL)
            continue;
        snprintf(left, sizeof left, "--%s%s%s", o->name, o->argument != NULL ? " " : "",
                 o->argument != NULL ? o->argument : "");
        printf("  %-24s %s%s\n", left, o->help, o->list ? " (may be repeated)" : "");
    }
    printf("  %-24s %s\n", "-h, --help", "this text");
    if (command->details != NULL)
        printf("\n%s\n", command->details);
    if (command->more_help != NULL)
        command->more_help(stdout);
}

static void print_overview(FILE *out)
{
    fputs("usage: bvhbench COMMAND [options]\n\n"
          "Compares builders of bounding volume hierarchies: build speed, trace speed, tree\n"
          "quality, memory, and how often the answer is wrong.\n\ncommands:\n",
          out);
    for (const bb_command *const *c = bb_commands; *c != NULL; c++)
        fprintf(out, "  %-10s %s\n", (*c)->name, (*c)->summary);
    fprintf(out, "  %-10s %s\n  %-10s %s\n", "help", "this text, or with COMMAND what it takes",
            "version", "version and revision");
    fputs("\n`bvhbench COMMAND --help` shows a command's options. Options are written in full;\n"
          "whole numbers also as 1e6, 20k, 1.5M or 1_000_000.\n"
          "exit status: 0 done, nothing wrong; 1 done, but a check or comparison failed;\n"
          "2 it could not be done (one line on standard error says why); 130 interrupted;\n"
          "141 nobody read the output to its end, and all else was done\n"
          "environment: BVHBENCH_PLUGINS=A.so:B.so loads builders for every command;\n"
          "BVHBENCH_SCENES=DIR is the folder of the shipped scenes\n",
          out);
}

/* ---- parsing ---- */

static bb_status add_value(bb_cli *cli, int option, const char *text)
{
    const bb_cli_option *declared = &cli->command->options[option];
    if (declared->argument != NULL && text[0] == '\0')
        return bb_fail(BB_INVALID, "--%s is empty: give it a value, or leave it out",
                       declared->name);
    if (declared->list == BB_CLI_LIST) {
        size_t count = cli->counts[option];
        bb_status status = bb_spec_list(text, cli->values[option], BB_CLI_VALUES_MAX, &count);
        cli->counts[option] = (uint32_t)count;
        return status == BB_OK ? BB_OK : bb_fail(status, "--%s: %s", declared->name, bb_message());
    }
    if (cli->counts[option] > 0 && declared->list == BB_CLI_ONCE)
        return bb_fail(BB_INVALID, "--%s is given twice", declared->name);
    if (cli->counts[option] == BB_CLI_VALUES_MAX)
        return bb_fail(BB_INVALID, "--%s is given more than %d times", declared->name,
                       BB_CLI_VALUES_MAX);
    char *value = strdup(text);
    if (value == NULL)
        return bb_fail(BB_FAILED, "--%s: no memory", declared->name);
    cli->values[option][cli->counts[option]++] = value;
    return BB_OK;
}

/* `given` begins with two dashes. */
static bb_status unknown_option(const bb_command *command, const char *given)
{
    char word[64];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(given + 2, "="), given + 2);
    bb_suggestion meant = {.word = word, .prefix = "--"};
    for (const bb_cli_option *o = command->options; o->name != NULL; o++)
        if (o->help != NULL)
            bb_suggest(&meant, o->name);
    bb_suggest(&meant, "help");
    return bb_fail(BB_INVALID, "%s: unknown option '%s'%s: see `bvhbench %s --help`", command->name,
                   given, bb_suggested(&meant), command->name);
}

/* getopt_long() also takes a beginning of a name, which would mean another option, or none, as soon
 * as there is one more. */
static bool is_cut(const char *given, const char *name)
{
    return strcspn(given + 2, "=") < strlen(name);
}

static bb_status parse(bb_cli *cli, int argc, char **argv, bool *help)
{
    const bb_command *command = cli->command;
    struct option table[BB_CLI_OPTIONS_MAX + 2] = {0};
    int count = 0;
    for (; command->options[count].name != NULL; count++)
        table[count] = (struct option){
            command->options[count].name,
            command->options[count].argument != NULL ? required_argument : no_argument, NULL, 256};
    table[count] = (struct option){"help", no_argument, NULL, 256};

    opterr = 0;
    optind = 0; /* from the beginning, wherever a call before this one has stopped */
    int index, got;
    while ((got = getopt_long(argc, argv, ":h", table, &index)) != -1) {
        const char *given = argv[optind - 1];
        if (got == 'h') {
            *help = true;
            return BB_OK;
        }
        if (got == ':')
            return bb_fail(BB_INVALID, "%s: %s needs a value: see `bvhbench %s --help`",
                           command->name, given, command->name);
        if (got == '?' && optopt > 0 && given[0] == '-' && given[1] == '-')
            return bb_fail(BB_INVALID,
                           "%s: '%s': this option does not take a value: see `bvhbench %s --help`",
                           command->name, given, command->name);
        if (got == '?' && optopt > 0)
            return bb_fail(BB_INVALID, "%s: unknown option '-%c': see `bvhbench %s --help`",
                           command->name, optopt, command->name);
        if (got == '?')
            return unknown_option(command, given);
        if (optarg == given)
            given = argv[optind - 2];
        if (is_cut(given, table[index].name))
            return unknown_option(command, given);
        if (index == count) {
            *help = true;
            return BB_OK;
        }
        BB_TRY(add_value(cli, index, optarg != NULL ? optarg : ""));
    }
    cli->positional = argv + optind;
    cli->positional_count = (uint32_t)(argc - optind);
    if (command->arguments == NULL && cli->positional_count > 0)
        return bb_fail(BB_INVALID, "%s: unexpected argument '%s': see `bvhbench %s --help`",
                       command->name, cli->positional[0], command->name);
    return BB_OK;
}

static void free_values(bb_cli *cli)
{
    for (uint32_t i = 0; i < BB_CLI_OPTIONS_MAX; i++) {
        for (uint32_t k = 0; k < cli->counts[i]; k++)
            free(cli->values[i][k]);
        cli->counts[i] = 0;
    }
}

/* ---- the program ---- */

/* What was written may still be on its way, or have been lost on the way: that is a failure too. If
 * nobody reads it any more, nobody reads why it failed either. */
static bb_status flush_output(bb_status status)
{
    bool lost = ferror(stdout) != 0;
    errno = 0;
    lost = fflush(stdout) != 0 || lost;
    const int error = errno;
    if (lost)
        bb_pipe_end();
    if (status != BB_OK || !lost)
        return status;
    return bb_fail(BB_FAILED, "cannot write to standard output: %s",
                   error != 0 ? strerror(error) : "not all of it was taken");
}

static int end(bb_status status, int exit_status)
{
    if (flush_output(status) == BB_OK)
        return exit_status;
    fprintf(stderr, "bvhbench: %s\n", bb_message());
    return BB_EXIT_CANNOT;
}

static int run_command(const bb_command *command, int argc, char **argv)
{
    static bb_cli cli;
    bool help = false;
    int exit_status = BB_EXIT_OK;
    cli.command = command;
    cli.argc = argc;
    cli.argv = argv;
    bb_status status = parse(&cli, argc - 1, argv + 1, &help);
    if (status == BB_OK && help)
        print_help(command);
    else if (status == BB_OK)
        status = command->run(&cli, &exit_status);
    free_values(&cli);
    bb_out_tidy();
    return end(status, exit_status);
}

static bb_status find_command(const char *name, const bb_command **command)
{
    bb_suggestion meant = {.word = name};
    for (const bb_command *const *c = bb_commands; *c != NULL; c++) {
        *command = *c;
        if (strcmp(name, (*c)->name) == 0)
            return BB_OK;
        bb_suggest(&meant, (*c)->name);
    }
    static const char *const own[] = {"help", "version", "--help", "--version"};
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++)
        bb_suggest(&meant, own[i]);
    return bb_fail(BB_INVALID, "unknown command '%s'%s: see `bvhbench --help`", name,
                   bb_suggested(&meant));
}

static bool is_help(const char *word)
{
    return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0;
}

static int help(const char *name)
{
    const bb_command *command;
    if (name == NULL || is_help(name)) {
        print_overview(stdout);
        return end(BB_OK, BB_EXIT_OK);
    }
    bb_status status = find_command(name, &command);
    if (status == BB_OK)
        print_help(command);
    return end(status, BB_EXIT_OK);
}

/* A standard file that the caller has closed would come back as the first file that is opened, and
 * what is meant for a terminal would be written into it. Of this one, writing fails. */
static void keep_standard_files(void)
{
    for (int file = 0; file <= 2; file++)
        if (fcntl(file, F_GETFD) < 0)
            (void)!open("/dev/null", O_RDONLY);
}

/* Numbers are written and read with a point, whatever locale a plug-in sets: a thread's own is not
 * changed by setlocale(). */
static void keep_locale(void)
{
    uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0));
}

int bb_main(int argc, char **argv)
{
    const bb_command *command;
    keep_standard_files();
    keep_locale();
    bb_pipe_catch();
    if (argc < 2) {
        print_overview(stderr);
        return BB_EXIT_CANNOT;
    }
    if (strcmp(argv[1], "help") == 0)
        return help(argv[2]);
    if (is_help(argv[1]))
        return help(NULL);
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "version") == 0) {
        printf("bvhbench %s (%s)\n", bb_build_version, bb_build_revision);
        return end(BB_OK, BB_EXIT_OK);
    }
    bb_status status = find_command(argv[1], &command);
    return status == BB_OK ? run_command(command, argc, argv) : end(status, BB_EXIT_CANNOT);
}
