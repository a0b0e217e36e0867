/* Specifications: `name:key=value,key=value`, and the options that plug-ins declare. */
#ifndef BB_OPTIONS_H
#define BB_OPTIONS_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* A declared option. An array of options ends with {.name = NULL}. */
typedef struct bb_option {
    const char *name;
    const char *default_value; /* NULL: no value unless given */
    const char *values;        /* "a|b|c": one of these words; NULL: any value */
    const char *help;          /* one line, with the unit */
} bb_option;

enum { BB_PARAMS_MAX = 24 };

/* A parsed specification. Strings live in `text`. */
typedef struct bb_spec {
    char text[512];   /* the specification as given, shown in records and tables */
    char buffer[512]; /* storage of the strings below */
    const char *name;
    uint32_t param_count;
    const char *keys[BB_PARAMS_MAX];
    const char *values[BB_PARAMS_MAX];
} bb_spec;

/* Splits `text`. BB_INVALID if a name, key or value is missing, a key is repeated, or the text is
 * too long. */
bb_status bb_spec_parse(const char *text, bb_spec *spec);

/* Splits `text` at each `+` into the specifications of stages, and parses each like
 * bb_spec_parse(): "presplit:budget=2+sah+rotate". A `+` before a digit belongs to a number (1e+5),
 * a `+` after a backslash to a value (file=a\+b). Fills stages[0..*count); the `text` of each is
 * its own part, without backslashes. BB_INVALID on an empty stage or more than `capacity`. */
bb_status bb_spec_stages(const char *text, bb_spec *stages, uint32_t capacity, uint32_t *count);

/* Checks the keys and values of `spec` against the declared `options`. `what` (such as "builder
 * lbvh") starts the message, which lists the existing options. */
bb_status bb_spec_validate(const bb_spec *spec, const bb_option *options, const char *what);

/* Returns the value of `key`: the given one, else its declared default, else NULL. */
const char *bb_spec_value(const bb_spec *spec, const bb_option *options, const char *key);

/* Returns whether `spec` itself gives `key`. */
bool bb_spec_gives(const bb_spec *spec, const char *key);

/* Read a number and check its range; whole numbers may be written 1e6, 20k, 1.5M or 1_000_000.
 * BB_INVALID names the option, its value and the range. */
bb_status bb_spec_u64(const bb_spec *spec, const bb_option *options, const char *key, uint64_t low,
                      uint64_t high, uint64_t *out);
bb_status bb_spec_double(const bb_spec *spec, const bb_option *options, const char *key, double low,
                         double high, double *out);
/* Returns whether the value of `key` equals `word`. */
bool bb_spec_is(const bb_spec *spec, const bb_option *options, const char *key, const char *word);

/* Splits a list of specifications at commas. A comma starts a new item unless `key=value` follows,
 * with no `:` before the `=`. A text that names an existing file is one item. Appends malloc'ed
 * strings, which the caller frees, to items[*count]. */
bb_status bb_spec_list(const char *text, char **items, size_t capacity, size_t *count);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
