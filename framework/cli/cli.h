/* The command line: commands with declared options, parsed by getopt_long; help is made from the
 * same table. */
#ifndef BB_CLI_H
#define BB_CLI_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { BB_CLI_OPTIONS_MAX = 32, BB_CLI_VALUES_MAX = 256 };

/* The program's exit statuses. */
enum {
    BB_EXIT_OK = 0,            /* done and nothing wrong */
    BB_EXIT_WRONG = 1,         /* done, and a check or comparison failed */
    BB_EXIT_CANNOT = 2,        /* it could not be done */
    BB_EXIT_INTERRUPTED = 130, /* by Ctrl-C; what was measured is written */
};

typedef struct bb_cli_option {
    const char *name;
    const char *argument; /* NULL: a flag; else what the help calls it */
    const char *help;     /* NULL: an old name, which is taken and not shown */
    enum { BB_CLI_ONCE, BB_CLI_LIST, BB_CLI_REPEATED } list; /* by commas too; each by itself */
} bb_cli_option;

typedef struct bb_cli bb_cli;

typedef struct bb_command {
    const char *name;
    const char *summary;
    const char *arguments; /* of the positional ones, for the usage line; NULL: none are taken */
    const char *details;   /* further lines of help */
    void (*more_help)(FILE *out); /* what generated tables add to it; NULL: nothing */
    const bb_cli_option *options; /* ends with name NULL */
    /* Anything but BB_OK ends the program with its message and BB_EXIT_CANNOT; else *exit_status
     * does. */
    bb_status (*run)(const bb_cli *cli, int *exit_status);
} bb_command;

struct bb_cli {
    const bb_command *command;
    int argc;
    char **argv; /* as the program got them */
    uint32_t counts[BB_CLI_OPTIONS_MAX];
    char *values[BB_CLI_OPTIONS_MAX][BB_CLI_VALUES_MAX];
    uint32_t positional_count;
    char **positional;
};

/* The last value of option `name`, or NULL; flags give "". */
const char *bb_cli_value(const bb_cli *cli, const char *name);
/* All values of a list option; *count may be 0. */
char *const *bb_cli_values(const bb_cli *cli, const char *name, uint32_t *count);
/* A whole number within [low, high], also written as 1e6 or 20k (framework/base/number.h);
 * `fallback` if the option is not given. */
bb_status bb_cli_u64(const bb_cli *cli, const char *name, uint64_t fallback, uint64_t low,
                     uint64_t high, uint64_t *out);
bb_status bb_cli_double(const bb_cli *cli, const char *name, double fallback, double low,
                        double high, double *out);
/* "WxH"; both at least 1 and at most 65536, BB_PIXELS_MAX together. */
bb_status bb_cli_size(const bb_cli *cli, const char *name, uint32_t *width, uint32_t *height);

/* The command line as a shell takes it, from malloc; NULL if there is no memory. */
char *bb_cli_command_line(const bb_cli *cli);

/* One per cmd_NAME.c. */
extern const bb_command *const bb_commands[]; /* generated; ends with NULL */

/* The program: parses and runs, returns the exit status. All that its main() takes of the
 * library. */
__attribute__((visibility("default"))) int bb_main(int argc, char **argv);

#endif
