/* The command line. Each command has a table of options whose rows say where a value is stored.
 * Parser, defaults, help and messages use these rows. */
#ifndef BB_CLI_H
#define BB_CLI_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { BB_CLI_OPTIONS_MAX = 48, BB_NAMES_MAX = 256 };

/* The program's exit statuses. */
enum {
    BB_EXIT_OK = 0,            /* done and nothing wrong */
    BB_EXIT_WRONG = 1,         /* done, and a check or comparison failed */
    BB_EXIT_CANNOT = 2,        /* it could not be done */
    BB_EXIT_INTERRUPTED = 130, /* by Ctrl-C; what was measured is written */
};

/* A list of texts from malloc. A zeroed one is empty. */
typedef struct bb_names {
    char *items[BB_NAMES_MAX];
    size_t count;
} bb_names;

void bb_names_free(bb_names *names);

typedef enum bb_cli_kind {
    BB_CLI_END,    /* ends the table */
    BB_CLI_GROUP,  /* rows that commands share */
    BB_CLI_FLAG,   /* bool: whether the option is given */
    BB_CLI_U32,    /* a whole number, also written as 1e6 or 20k; or the number of a word */
    BB_CLI_U64,    /* a whole number */
    BB_CLI_DOUBLE, /* a number */
    BB_CLI_TEXT,   /* const char *, NULL if there is none */
    BB_CLI_SIZE,   /* WxH: uint32_t[2], each from 1 to 65536, BB_PIXELS_MAX together */
    BB_CLI_LIST,   /* bb_names, given by commas and by repetition */
    BB_CLI_EACH,   /* bb_names, given by repetition alone */
} bb_cli_kind;

/* A row of the table. BB_INTO() derives the kind from the member that stores the value. */
typedef struct bb_cli_option {
    const char *name;
    const char *argument; /* name of the value in the help; NULL: a flag or `words` */
    const char *help;
    bb_cli_kind kind;
    size_t offset; /* of the value, or of the group's struct, in the command's struct */
    const struct bb_cli_option *group;
    /* The default as a user would write it, which the help shows. NULL: the value stays zeroed. */
    const char *fallback;
    /* "text|github": the words that may be given; the number of the word is stored. */
    const char *words;
    double low, high;  /* range of a number; high 0: no limit */
    bool needed;       /* the command refuses to run without this option */
    const char *with;  /* The option is refused without the option of this name. */
    const char *apart; /* "size|seed": the option is refused beside options of these names. */
    /* A flag changes the defaults of other options: {"size", "64x64", "seed", "2", NULL}. */
    const char *const *presets;
} bb_cli_option;

#define BB_INTO_KIND(type, member, ...)                                                            \
    .kind = _Generic(((type *)NULL)->member, __VA_ARGS__), .offset = offsetof(type, member)

/* The value is stored in this member of the command's struct, or of the group's. */
#define BB_INTO(type, member)                                                                      \
    BB_INTO_KIND(type, member, bool: BB_CLI_FLAG, uint32_t: BB_CLI_U32, uint64_t: BB_CLI_U64,      \
                 double: BB_CLI_DOUBLE, const char *: BB_CLI_TEXT, bb_names: BB_CLI_LIST)
/* The same for a list whose items may contain commas. */
#define BB_INTO_EACH(type, member) BB_INTO_KIND(type, member, bb_names : BB_CLI_EACH)
/* A width, and a height that directly follows it. */
#define BB_INTO_SIZE(type, member) BB_INTO_KIND(type, member, uint32_t : BB_CLI_SIZE)
/* The rows of a group, which store into a member of the command's struct. A row of the command
 * replaces the group's row of the same name. */
#define BB_GROUP(rows, type, member)                                                               \
    {                                                                                              \
        .kind = BB_CLI_GROUP, .group = rows, .offset = offsetof(type, member)                      \
    }

#define BB_SEED_OPTION(type, member)                                                               \
    {                                                                                              \
        "seed", "N", "random seed", BB_INTO(type, member), .fallback = "1"                         \
    }
#define BB_QUIET_OPTION(type, member)                                                              \
    {                                                                                              \
        "quiet", NULL, "do not show progress", BB_INTO(type, member)                               \
    }

typedef struct bb_cli bb_cli;

typedef struct bb_command {
    const char *name;
    const char *summary;
    const char *arguments; /* positional arguments, for the usage line; NULL: none are taken */
    const char *details;   /* further lines of help */
    void (*more_help)(FILE *out); /* prints further help from generated tables; may be NULL */
    const bb_cli_option *options;
    size_t bytes; /* size of the command's struct, which is zeroed before the values are stored */
    /* Runs the command. After BB_OK the program exits with *exit_status, else with BB_EXIT_CANNOT
     * and the message. */
    bb_status (*run)(const bb_cli *cli, void *values, int *exit_status);
    void (*release)(void *values); /* called after run(), whatever it returned; NULL: nothing */
    /* It writes nothing before all is measured, or asks bb_guard_said(): after the death of a
     * builder it is run again without it (framework/builder/guard.h). */
    bool goes_on;
} bb_command;

/* A row with the address of its value. */
typedef struct bb_cli_row {
    const bb_cli_option *option;
    char *place;
    const char *given[BB_NAMES_MAX]; /* texts from the command line */
    uint32_t count;
} bb_cli_row;

struct bb_cli {
    const bb_command *command;
    char *command_line; /* quoted for a shell */
    void *values;       /* the command's struct */
    bb_cli_row rows[BB_CLI_OPTIONS_MAX];
    uint32_t row_count;
    uint32_t positional_count;
    char **positional;
};

/* Parses argv[2] and the following words, and stores all values. If *help is set, it stopped at
 * --help. BB_INVALID: the message says what was given and what it must be, or names a row whose
 * declaration is wrong. `cli` must be zeroed; release it with bb_cli_free(), also after a failure.
 */
bb_status bb_cli_parse(bb_cli *cli, const bb_command *command, int argc, char **argv, bool *help);
void bb_cli_free(bb_cli *cli);

/* Stores a text as the value of a row. */
bb_status bb_cli_store(const bb_cli_row *row, const char *text);

/* Finds the row with this name; NULL if there is none. */
const bb_cli_row *bb_cli_find(const bb_cli *cli, const char *name);
/* Returns whether the command line has the option that stores into `place`. */
bool bb_cli_given(const bb_cli *cli, const void *place);

/* Prints the help of a command. */
bb_status bb_cli_help(const bb_command *command, FILE *out);

/* One per cmd_NAME.c. */
extern const bb_command *const bb_commands[]; /* generated; ends with NULL */

/* Runs the program and returns the exit status. main() uses nothing else of the library. */
__attribute__((visibility("default"))) int bb_main(int argc, char **argv);

#endif
