/* The program: help, and the command that is run. */
#include "framework/cli/cli.h"

#include "framework/base/interrupt.h"
#include "framework/base/suggest.h"
#include "framework/builder/guard.h"
#include "framework/cli/out_option.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const char bb_build_version[], bb_build_revision[];

/* ---- help ---- */

static void print_row(FILE *out, const bb_cli_option *o)
{
    const char *value = o->words != NULL ? o->words : o->argument;
    const bool list = o->kind == BB_CLI_LIST || o->kind == BB_CLI_EACH;
    const int used =
        fprintf(out, "  --%s%s%s", o->name, value != NULL ? " " : "", value != NULL ? value : "");
    fprintf(out, "%*s %s%s", used < 32 ? 32 - used : 0, "", o->help, o->needed ? "; needed" : "");
    for (const char *const *p = o->presets; p != NULL && *p != NULL; p += 2)
        fprintf(out, "%s --%s %s", p == o->presets ? "; changes defaults to" : "", p[0], p[1]);
    if (o->fallback != NULL)
        fprintf(out, "; default: %s", o->fallback);
    fputs(list ? " (may be repeated)\n" : "\n", out);
}

bb_status bb_cli_help(const bb_command *command, FILE *out)
{
    static bb_cli cli;
    char *no_words[] = {"bvhbench", NULL};
    bool help = true;
    bb_status status = bb_cli_parse(&cli, command, 1, no_words, &help);
    if (status == BB_OK) {
        fprintf(out, "usage: bvhbench %s [options]%s%s\n\n%s\n\noptions:\n", command->name,
                command->arguments != NULL ? " " : "",
                command->arguments != NULL ? command->arguments : "", command->summary);
        for (uint32_t i = 0; i < cli.row_count; i++)
            print_row(out, cli.rows[i].option);
        fprintf(out, "  %-30s %s\n", "-h, --help", "this text");
        if (command->details != NULL)
            fprintf(out, "\n%s\n", command->details);
        if (command->more_help != NULL)
            command->more_help(out);
    }
    bb_cli_free(&cli);
    return status;
}

static void print_overview(FILE *out)
{
    fputs("usage: bvhbench COMMAND [options]\n\n"
          "Compares builders of bounding volume hierarchies: build speed, trace speed, tree\n"
          "quality, memory, and how often the answer is wrong.\n\ncommands:\n",
          out);
    for (const bb_command *const *c = bb_commands; *c != NULL; c++)
        fprintf(out, "  %-10s %s\n", (*c)->name, (*c)->summary);
    fprintf(out, "  %-10s %s\n  %-10s %s\n", "help", "this text; with COMMAND, its options",
            "version", "version and revision");
    fputs("\n"
          "`bvhbench COMMAND --help` shows a command's options. Options are written in full;\n"
          "whole numbers also as 1e6, 20k, 1.5M or 1_000_000.\n"
          "exit status: 0 done, nothing wrong; 1 done, but a check or comparison failed;\n"
          "2 it could not be done (one line on standard error says why); 130 interrupted;\n"
          "141 the output was not read to its end; all else was done\n"
          "environment: BVHBENCH_PLUGINS=A.so:B.so loads builders for every command;\n"
          "BVHBENCH_SCENES=DIR is the folder of the shipped scenes;\n"
          "BVHBENCH_GUARD=no works in this process, for debuggers: a builder's death is its own "
          "then\n",
          out);
}

/* ---- the program ---- */

/* Flushes standard output. Output that is lost is a failure too. If the reader of a pipe has gone
 * away, the program ends here without a message. */
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
    bb_guard_end(status == BB_OK ? exit_status : BB_EXIT_CANNOT);
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
    bb_status status = bb_cli_parse(&cli, command, argc, argv, &help);
    if (status == BB_OK && help) {
        status = bb_cli_help(command, stdout);
    } else if (status == BB_OK) {
        bb_guard_start(command->goes_on, BB_EXIT_WRONG, BB_EXIT_CANNOT);
        status = command->run(&cli, cli.values, &exit_status);
        if (command->release != NULL)
            command->release(cli.values);
    }
    bb_cli_free(&cli);
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

/* `argv`: the words after "help". */
static int help(char **argv)
{
    const bb_command *command;
    const char *name = argv[0];
    if (name != NULL && argv[1] != NULL)
        return end(bb_fail(BB_INVALID, "help: leave '%.80s' out: one command at a time", argv[1]),
                   BB_EXIT_CANNOT);
    if (name == NULL || is_help(name)) {
        print_overview(stdout);
        return end(BB_OK, BB_EXIT_OK);
    }
    bb_status status = find_command(name, &command);
    if (status == BB_OK)
        status = bb_cli_help(command, stdout);
    return end(status, BB_EXIT_OK);
}

/* Opens /dev/null in place of standard files that the caller has closed. Otherwise the next file to
 * be opened would get their number, and messages would be written into it. Writing to this one
 * fails. */
static void keep_standard_files(void)
{
    for (int file = 0; file <= 2; file++)
        if (fcntl(file, F_GETFD) < 0)
            (void)!open("/dev/null", O_RDONLY);
}

/* Gives this thread a locale of its own, which setlocale() in a plug-in does not change, so that
 * numbers always have a decimal point. */
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
        return help(argv + 2);
    if (is_help(argv[1]))
        return help(argv + argc);
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "version") == 0) {
        printf("bvhbench %s (%s)\n", bb_build_version, bb_build_revision);
        return end(BB_OK, BB_EXIT_OK);
    }
    bb_status status = find_command(argv[1], &command);
    return status == BB_OK ? run_command(command, argc, argv) : end(status, BB_EXIT_CANNOT);
}
