/* Axes: seeded families of scenes and rays with one parameter that drives methods into their
 * failures. Each is one JSON file: those of framework/stress/axes/ are built in, any other is given
 * by its path. The members of the file: framework/stress/README.md.
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
    char name[64];                /* as the command takes it */
    char title[BB_AXIS_TEXT];     /* a heading */
    char parameter[BB_AXIS_TEXT]; /* what x is */
    char why[BB_AXIS_TEXT];       /* what fails, and why */
    char known[BB_AXIS_TEXT];     /* of wrong answers that nobody promises to be right: where that
                                           is said; "": there are none */
    char scene[BB_AXIS_TEXT];     /* with {x} and {n} */
    char rays[BB_AXIS_RAYS_MAX][128]; /* likewise */
    uint32_t ray_count;
    char builder[BB_AXIS_TEXT], kernel[BB_AXIS_TEXT]; /* what traces for methods that do not */
    double from, to; /* x where all is normal, and where it is worst; from > to goes down */
    bb_axis_steps steps;
    uint32_t intervals; /* between from and to that are looked at first */
    double also[4];     /* values behind `to`, such as 0, that no bisection leads to */
    uint32_t also_count;
    uint64_t n, quick_n; /* what {n} stands for */
    uint32_t frames;     /* of the scene that are gone through; 0: it is measured as it stands */
    char *text;          /* of the file, from malloc */
} bb_axis;

/* A built-in axis: its name and the text of its file. */
typedef struct bb_axis_source {
    const char *name;
    const char *text;
} bb_axis_source;
extern const bb_axis_source bb_axis_sources[]; /* generated; ends with name NULL */

/* The built-in axis of that name, or the file of that path. BB_INVALID with one line for what is
 * neither, and for a file that is no axis; it names the member. Release with bb_axis_free(). */
bb_status bb_axis_load(const char *name_or_path, bb_axis *axis);
/* The same from the text of a file that is called `name` in messages. */
bb_status bb_axis_parse(const char *text, const char *name, bb_axis *axis);
void bb_axis_free(bb_axis *axis); /* a zeroed one is allowed */

/* The values that are looked at first, in order, `from` first: `intervals` + 1 of them at most, and
 * `also`. Returns their number, at most BB_AXIS_POINTS_MAX. */
uint32_t bb_axis_values(const bb_axis *axis, uint32_t intervals, double *values);

/* The value halfway from a to b, rounded to three digits, or to a whole number. False if there is
 * none between them. */
bool bb_axis_middle(const bb_axis *axis, double a, double b, double *middle);

/* x as names of rows and scenes have it. */
enum { BB_AXIS_VALUE = 32 };
void bb_axis_value(double x, char out[BB_AXIS_VALUE]);

/* `text` with {x} and {n} replaced. BB_INVALID if it has no room. */
bb_status bb_axis_fill(const char *text, double x, uint64_t n, char *out, size_t capacity);

#endif
