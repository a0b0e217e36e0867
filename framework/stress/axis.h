/* An axis is a seeded family of scenes and rays whose parameter x drives methods into failure. Each
 * is a JSON file. Those of framework/stress/axes/ are built in, others are given by path.
 * framework/stress/README.md describes the members.
 */
#ifndef BB_AXIS_H
#define BB_AXIS_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    BB_AXIS_TEXT = 512,
    BB_AXIS_RAYS_MAX = 8,
    BB_AXIS_POINTS_MAX = 24,
    BB_AXIS_FRAMES_MAX = 64,
};

typedef enum bb_axis_steps {
    BB_STEPS_LOG,    /* equal ratios */
    BB_STEPS_LINEAR, /* equal differences */
    BB_STEPS_WHOLE,  /* equal ratios, rounded to whole numbers */
    BB_STEPS_COUNT,  /* equal differences, rounded to whole numbers */
} bb_axis_steps;

typedef struct bb_axis {
    char name[64];                /* on the command line */
    char title[BB_AXIS_TEXT];     /* a heading */
    char parameter[BB_AXIS_TEXT]; /* what x is */
    char why[BB_AXIS_TEXT];       /* what fails, and why */
    char known[BB_AXIS_TEXT];     /* where wrong answers are documented as a limit; "": nowhere */
    char scene[BB_AXIS_TEXT];     /* with {x} and {n} */
    char rays[BB_AXIS_RAYS_MAX][128]; /* with {x} and {n} */
    uint32_t ray_count;
    char builder[BB_AXIS_TEXT], kernel[BB_AXIS_TEXT]; /* used by methods that have none */
    double from, to; /* x of the normal and of the worst case; from > to descends */
    bb_axis_steps steps;
    uint32_t intervals; /* between from and to, measured first */
    double also[4];     /* more values beyond `to`, such as 0 */
    uint32_t also_count;
    uint64_t n, quick_n; /* values of {n} */
    uint32_t frames;     /* measured frames of the scene; 0: the scene stands still */
    char *text;          /* the file's text, from malloc */
} bb_axis;

/* A built-in axis: its name and the text of its file. */
typedef struct bb_axis_source {
    const char *name;
    const char *text;
} bb_axis_source;
extern const bb_axis_source bb_axis_sources[]; /* generated; ends with name NULL */

/* Loads a built-in axis by name, or a file by path. BB_INVALID: there is neither, or the file is no
 * axis; the message names the member. Release the axis with bb_axis_free(). */
bb_status bb_axis_load(const char *name_or_path, bb_axis *axis);
/* Does the same from a text. Messages call it `name`. */
bb_status bb_axis_parse(const char *text, const char *name, bb_axis *axis);
void bb_axis_free(bb_axis *axis); /* a zeroed axis is allowed */

/* Fills the values to measure first, in order from `from`: at most `intervals` + 1 values, and
 * `also`. Returns their number, at most BB_AXIS_POINTS_MAX. */
uint32_t bb_axis_values(const bb_axis *axis, uint32_t intervals, double *values);

/* Sets *middle to the value halfway from a to b, rounded to three digits or to a whole number.
 * Returns false if no value lies between them. */
bool bb_axis_middle(const bb_axis *axis, double a, double b, double *middle);

/* Writes x as in names of rows and scenes. */
enum { BB_AXIS_VALUE = 32 };
void bb_axis_value(double x, char out[BB_AXIS_VALUE]);

/* Copies `text` with {x} and {n} replaced. BB_INVALID if `out` is too small. */
bb_status bb_axis_fill(const char *text, double x, uint64_t n, char *out, size_t capacity);

#endif
