/* Measures values of an axis in a child process and keeps them in files, so that an interrupted run
 * can resume. */
#ifndef BB_POINT_H
#define BB_POINT_H

#include "framework/device/device.h"
#include "framework/stress/child.h"
#include "framework/stress/search.h"

/* The part that a method varies. Its other parts are those of the axis and the first intersector.
 */
typedef enum bb_method_part {
    BB_A_BUILDER,
    BB_A_KERNEL,
    BB_AN_INTERSECTOR,
    BB_METHOD_PARTS
} bb_method_part;

/* "builder", "kernel", "intersector" */
const char *bb_method_part_word(bb_method_part part);

typedef struct bb_method {
    bb_method_part part;
    const char *text; /* a specification */
    bool exact;       /* must never be wrong, except within documented limits of an axis */
} bb_method;

/* Sets builder, kernel and intersector of a method on an axis. A reference has only a builder; the
 * other parts are to be ignored. */
void bb_method_cell(const bb_axis *axis, const bb_method *method,
                    const char *parts[BB_METHOD_PARTS]);

typedef struct bb_points {
    const bb_axis *axis;
    const bb_method *methods;
    uint32_t method_count;
    uint64_t n;        /* primitives */
    uint32_t max_rays; /* of each set */
    uint32_t repeats;  /* rounds that count */
    uint64_t seed;
    char *const *metrics; /* simulations of all traces, and the same, read */
    const bb_simt *simts;
    uint32_t simt_count;
    bb_child_limits limits; /* for one value */
    const char *folder;     /* of the files; must exist */
    uint64_t identity;      /* hash of the program, its plug-ins and the device; files of another
                           identity are ignored */
    bb_status (*open_device)(void *user, bb_device **device); /* called in the child */
    void *user;
    /* out */
    uint32_t measured, taken_over; /* values */
    char mishap[512]; /* the first process that died with several methods of which none dies alone;
                         "": none */
    char device[256], driver[256]; /* "": not known yet */
} bb_points;

/* A bb_measure_fn whose `user` is a bb_points. If the process dies, each value is measured in its
 * own process, and if that dies too, each method. */
bb_status bb_point_measure(void *points, bb_wish *wishes, uint32_t count, bool again);

#endif
