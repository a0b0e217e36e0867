/* Where methods fail: every builder, kernel and intersector on every axis, and the atlas of what
 * was found. */
#ifndef BB_STRESS_H
#define BB_STRESS_H

#include "framework/stress/point.h"
#include "framework/stress/search.h"
#include "framework/table/table.h"

#include <stdio.h>

enum { BB_STRESS_AXES_MAX = 64 };

typedef struct bb_stress_request {
    char *const *axes; /* names or files */
    uint32_t axis_count;
    const bb_method *methods; /* at most BB_METHODS_MAX */
    uint32_t method_count;
    bool quick; /* small scenes, few rays, few values; judges no times; misses rare failures */
    bool pictures;
    uint64_t seed;
    bb_child_limits limits; /* of one value of an axis */
    const char *folder;     /* must be there; the points lie in its folder `points` */
    uint64_t identity;      /* bb_points.identity */
    bb_status (*open_device)(void *user, bb_device **device);
    void *user;
    bool quiet;
} bb_stress_request;

typedef struct bb_stress_axis {
    bb_axis axis;
    bb_search search;
    uint64_t n;
    char picture[160]; /* relative to the folder; "": there is none */
    double picture_at; /* value of the axis that it shows */
    bool complete;     /* not interrupted */
    char mishap[512];  /* bb_points.mishap */
} bb_stress_axis;

typedef struct bb_stress {
    const bb_stress_request *request;
    uint64_t identity; /* the request's, and the device's */
    uint32_t max_rays, repeats;
    uint32_t axis_count; /* that were begun */
    bb_stress_axis *axes;
    char device[256], driver[256];
    uint32_t measured, taken_over; /* points */
    double ms;
} bb_stress;

/* Checks axes and methods before anything runs: that the axes can be read and name builders,
 * kernels, rays and scenes that there are. BB_INVALID names the first that is not in order. */
bb_status bb_stress_check(const bb_stress_request *request);

/* Searches all axes. BB_FAILED or BB_INVALID if the device cannot be opened. Interrupted, it keeps
 * what it has. Release with bb_stress_free(), also after a failure. */
bb_status bb_stress_run(const bb_stress_request *request, bb_stress *out);
void bb_stress_free(bb_stress *stress);

/* What is a bug, not a weak spot: a crash, a hang, a flood of memory, a failure that nobody
 * foresaw, wrong answers of what must be exact and where the axis says of no limit, a method
 * without a verdict. Returns their number, and writes a line each unless `out` is NULL. */
uint32_t bb_stress_blame(const bb_stress *stress, FILE *out);

/* ---- the atlas ---- */

/* Axis by axis, manner by manner, which methods fail from where on. */
bb_status bb_atlas_print(const bb_stress *stress, FILE *out);

/* The same with all figures (framework/stress/README.md); `command` is the command line. The table
 * is the caller's. BB_REFUSED without memory. */
bb_status bb_atlas_table(const bb_stress *stress, const char *command, bb_table **out);

#endif
