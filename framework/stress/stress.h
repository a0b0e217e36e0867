/* Finds where builders, kernels and intersectors fail on all axes, and makes the atlas of it. */
#ifndef BB_STRESS_H
#define BB_STRESS_H

#include "framework/stress/point.h"
#include "framework/stress/search.h"
#include "framework/table/outline.h"
#include "framework/table/table.h"

#include <stdio.h>

enum { BB_STRESS_AXES_MAX = 64 };

typedef struct bb_stress_request {
    char *const *axes; /* names or files */
    uint32_t axis_count;
    const bb_method *methods; /* at most BB_METHODS_MAX */
    uint32_t method_count;
    bool quick; /* small scenes, few rays and values; times are not judged */
    bool pictures;
    uint64_t seed;
    char *const *metrics; /* simulations of all traces, and the same, read */
    const bb_simt *simts;
    uint32_t simt_count;
    bb_child_limits limits; /* for one value of an axis */
    const char *folder;     /* must exist; points are kept in its folder `points` */
    uint64_t identity;      /* bb_points.identity */
    bb_status (*open_device)(void *user, bb_device **device);
    void *user;
    bool quiet;
} bb_stress_request;

typedef struct bb_stress_axis {
    bb_axis axis;
    bb_search search;
    uint64_t n;
    char picture[160]; /* relative to the folder; "": none */
    double picture_at; /* the shown value of the axis */
    bool complete;     /* not interrupted */
    char mishap[512];  /* bb_points.mishap */
} bb_stress_axis;

typedef struct bb_stress {
    const bb_stress_request *request;
    uint64_t identity; /* hash of the request's and the device's */
    uint32_t max_rays, repeats;
    uint32_t axis_count; /* of axes that were begun */
    bb_stress_axis *axes;
    char device[256], driver[256];
    uint32_t measured, taken_over; /* points */
    double ms;
} bb_stress;

/* Checks axes and methods before anything runs: axes must be readable, and their builders, kernels,
 * rays and scenes must exist. BB_INVALID names the first fault. */
bb_status bb_stress_check(const bb_stress_request *request);

/* Searches all axes. BB_FAILED or BB_INVALID: the device cannot be opened. Findings before an
 * interruption are kept. Release with bb_stress_free(), also after a failure. */
bb_status bb_stress_run(const bb_stress_request *request, bb_stress *out);
void bb_stress_free(bb_stress *stress);

/* Counts bugs, as opposed to weak spots: crashes, hangs, floods of memory, unexpected failures,
 * methods without a verdict, and wrong answers of exact methods without a documented limit. Writes
 * a line for each unless `out` is NULL. */
uint32_t bb_stress_blame(const bb_stress *stress, FILE *out);

/* ---- the atlas ---- */

/* Prints for each axis and manner which methods fail from which value on. */
bb_status bb_atlas_print(const bb_stress *stress, FILE *out);

/* Makes a table of the atlas with all figures (framework/stress/README.md). `command` is the
 * command line. The caller owns the table. BB_REFUSED: no memory. */
bb_status bb_atlas_table(const bb_stress *stress, const char *command, bb_table **out);

/* How that table is printed later, axis by axis. */
extern const bb_page_outline bb_stress_outline;

#endif
