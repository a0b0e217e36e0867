/* Parsing of the command line and its help. */
#include "framework/cli/cli.h"

#include "framework/scene/camera.h"

#include "framework/base/options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const char bb_build_version[], bb_build_revision[];

static int find(const bb_command *command, const char *name)
{
    for (int i = 0; command->options[i].name != NULL; i++)
        if (strcmp(command->options[i].name, name) == 0)
            return i;
    return -1;
}

const char *bb_cli_value(const bb_cli *cli, const char *name)
{
    int i = find(cli->command, name);
    return i >= 0 && cli->counts[i] > 0 ? cli->values[i][cli->counts[i] - 1] : NULL;
}

char *const *bb_cli_values(const bb_cli *cli, const char *name, uint32_t *count)
{
    int i = find(cli->command, name);
    *count = i >= 0 ? cli->counts[i] : 0;
    return i >= 0 ? cli->values[i] : NULL;
}

bb_status bb_cli_u64(const bb_cli *cli, const char *name, uint64_t fallback, uint64_t low,
                     uint64_t high, uint64_t *out)
{
    const char *value = bb_cli_value(cli, name);
    *out = fallback;
    if (value == NULL)
        return BB_OK;
    char *end;
    errno = 0;
    unsigned long long number = strtoull(value, &end, 10);
    if (value[0] < '0' || value[0] > '9' || *end != '\0' || errno != 0 || number < low ||
        number > high)
        return bb_fail(BB_INVALID, "--%s is '%s', must be a whole number from %llu to %llu", name,
                       value, (unsigned long long)low, (unsigned long long)high);
    *out = number;
    return BB_OK;
}

bb_status bb_cli_double(const bb_cli *cli, const char *name, double fallback, double low,
                        double high, double *out)
{
    const char *value = bb_cli_value(cli, name);
    *out = fallback;
    if (value == NULL)
        return BB_OK;
    char *end;
    double number = strtod(value, &end);
    if (end == value || *end != '\0' || isnan(number) || number < low || number > high)
        return bb_fail(BB_INVALID, "--%s is '%s', must be a number from %g to %g", name, value, low,
                       high);
    *out = number;
    return BB_OK;
}

bb_status bb_cli_size(const bb_cli *cli, const char *name, uint32_t *width, uint32_t *height)
{
    const char *value = bb_cli_value(cli, name);
    if (value == NULL)
        return BB_OK;
    unsigned w = 0, h = 0;
    char rest;
    if (sscanf(value, "%5ux%5u%c", &w, &h, &rest) != 2 || w < 1 || h < 1 || w > 65536 || h > 65536)
        return bb_fail(BB_INVALID, "--%s is '%s', must be WIDTHxHEIGHT, such as 512x512", name,
                       value);
    if ((uint64_t)w * h > BB_PIXELS_MAX)
        return bb_fail(BB_INVALID, "--%s is '%s': at most %u pixels in all", name, value,
                       (unsigned)BB_PIXELS_MAX);
    *width = w;
    *height = h;
    return BB_OK;
}

char *bb_cli_command_line(const bb_cli *cli)
{
    size_t length = 1;
    for (int i = 0; i < cli->argc; i++)
        length += strlen(cli->argv[i]) + 1;
    char *text = calloc(1, length);
    for (int i = 0; text != NULL && i < cli->argc; i++) {
        strcat(text, i > 0 ? " " : "");
        strcat(text, i > 0 ? cli->argv[i] : "bvhbench");
    }
    return text;
}

/* ---- help ---- */

static void print_help(const bb_command *command)
{
    printf("usage: bvhbench %s [options]%s%s\n\n%s\n\noptions:\n", command->name,
           command->arguments != NULL ? " " : "",
           command->arguments != NULL ? command->arguments : "", command->summary);
    for (const bb_cli_option *o = command->options; o->name != NULL; o++) {
        char left[48];
        snprintf(left, sizeof left, "--%s%s%s", o->name, o->argument != NULL ? " " : "",
                 o->argument != NULL ? o->argument : "");
        printf("  %-24s %s%s\n", left, o->help, o->list ? " (may be repeated)" : "");
    }
    printf("  %-24s %s\n", "--help", "this text");
    if (command->details != NULL)
        printf("\n%s\n", command->details);
    if (command->more_help != NULL)
        command->more_help(stdout);
}

static void print_overview(const bb_command *const *commands)
{
    printf("usage: bvhbench COMMAND [options]\n\n"
           "Compares builders of bounding volume hierarchies: build speed, trace speed, tree\n"
           "quality, memory, and how often the answer is wrong.\n\ncommands:\n");
    for (const bb_command *const *c = commands; *c != NULL; c++)
        printf("  %-10s %s\n", (*c)->name, (*c)->summary);
    printf(
        "\n`bvhbench COMMAND --help` shows a command's options; `bvhbench --version` the version.\n"
        "exit status: 0 done, nothing wrong; 1 done, but a check or comparison failed;\n"
        "2 it could not be done (one line on standard error says why); 130 interrupted\n"
        "environment: BVHBENCH_PLUGINS=A.so:B.so loads builders for every command;\n"
        "BVHBENCH_SCENES=DIR is the folder of the shipped scenes\n");
}

/* ---- parsing ---- */

static bb_status add_value(bb_cli *cli, int option, const char *text)
{
    const bb_cli_option *declared = &cli->command->options[option];
    if (declared->list == BB_CLI_LIST) {
        size_t count = cli->counts[option];
        BB_TRY(bb_spec_list(text, cli->values[option], BB_CLI_VALUES_MAX, &count));
        cli->counts[option] = (uint32_t)count;
        return BB_OK;
    }
    if (cli->counts[option] > 0 && declared->list == BB_CLI_ONCE)
        return bb_fail(BB_INVALID, "--%s is given twice", declared->name);
    if (cli->counts[option] == BB_CLI_VALUES_MAX)
        return bb_fail(BB_INVALID, "--%s is given more than %d times", declared->name,
                       BB_CLI_VALUES_MAX);
    cli->values[option][cli->counts[option]++] = strdup(text);
    return BB_OK;
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
    optind = 1;
    int index, got;
    while ((got = getopt_long(argc, argv, ":", table, &index)) != -1) {
        const char *given = argv[optind - 1];
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
            return bb_fail(BB_INVALID, "%s: unknown option '%s': see `bvhbench %s --help`",
                           command->name, given, command->name);
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
    for (uint32_t i = 0; i < BB_CLI_OPTIONS_MAX; i++)
        for (uint32_t k = 0; k < cli->counts[i]; k++)
            free(cli->values[i][k]);
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
    if (status == BB_OK && fflush(stdout) != 0)
        status = bb_fail(BB_FAILED, "cannot write to standard output: %s", strerror(errno));
    if (status != BB_OK) {
        fprintf(stderr, "bvhbench: %s\n", bb_message());
        return BB_EXIT_CANNOT;
    }
    return exit_status;
}

int bb_main(int argc, char **argv)
{
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
        print_overview(bb_commands);
        return argc < 2 ? BB_EXIT_CANNOT : BB_EXIT_OK;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("bvhbench %s (%s)\n", bb_build_version, bb_build_revision);
        return BB_EXIT_OK;
    }
    for (const bb_command *const *command = bb_commands; *command != NULL; command++)
        if (strcmp((*command)->name, argv[1]) == 0)
            return run_command(*command, argc, argv);
    fprintf(stderr, "bvhbench: unknown command '%s': see `bvhbench --help`\n", argv[1]);
    return BB_EXIT_CANNOT;
}
