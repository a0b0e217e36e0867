/* Values of an axis, measured in a process of their own and kept in a file, so that a run that was
 * cut off goes on where it was. */
#ifndef BB_POINT_H
#define BB_POINT_H

#include "framework/device/device.h"
#include "framework/stress/child.h"
#include "framework/stress/search.h"

/* What a method is: the part that changes; the other parts are those of the axis, and the first
 * intersector. */
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
    bool exact;       /* must never be wrong, but where an axis says that nobody promises it */
} bb_method;

/* What traces for a method on an axis, itself included. A reference has no kernel and no
 * intersector: what is said of these is void. */
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
    bb_child_limits limits; /* the time is that of one value */
    const char *folder;     /* for the files; must be there */
    uint64_t identity;      /* hash of the program, its plug-ins and the device asked for: points of
                           another are not taken over */
    bb_status (*open_device)(void *user, bb_device **device); /* called in the child */
    void *user;
    /* out */
    uint32_t measured, taken_over; /* values */
    char mishap[512]; /* the last process that died with several methods, none of which did so by
                         itself; "": there was none */
    char device[256], driver[256]; /* "": not known yet */
} bb_points;

/* A bb_measure_fn, with a bb_points as `user`. If the process dies, each value is measured by
 * itself, and if that dies too, each method, to see which it was. */
bb_status bb_point_measure(void *points, bb_wish *wishes, uint32_t count, bool again);

#endif
