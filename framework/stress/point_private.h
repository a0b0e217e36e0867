/* A point on its way: point.c, and what its child does, point_bench.c. */
#ifndef BB_POINT_PRIVATE_H
#define BB_POINT_PRIVATE_H

#include "framework/bench/bench.h"
#include "framework/stress/point.h"
#include "framework/table/table.h"

/* What the child is to do. */
typedef struct bb_point_work {
    bb_points *points;
    bb_wish *wishes;
    uint32_t count;
    bool again;       /* a second measurement of what there may be a file of already */
    const char *path; /* of the file that it writes */
} bb_point_work;

/* In the child: opens the device, measures, writes the file. 0, or 1 if there is no file. */
int bb_point_child(void *work);

/* The comparison that measures a value of the axis. Points into itself: not to be copied. */
typedef struct bb_point_request {
    bb_bench_request bench; /* without a device */
    const bb_points *points;
    const bool *wanted; /* of the methods */
    char scene[2 * BB_AXIS_TEXT];
    char rays[BB_AXIS_RAYS_MAX][2 * BB_AXIS_TEXT];
    char *scenes[1], *ray_sets[BB_AXIS_RAYS_MAX];
    char *builders[BB_METHODS_MAX + 1], *kernels[BB_METHODS_MAX + 1];
    char *intersectors[BB_METHODS_MAX + 1];
} bb_point_request;

/* What points->axis, methods, n, max_rays, repeats and seed ask for. BB_INVALID where a text of the
 * axis is too long at x. */
bb_status bb_point_request_make(const bb_points *points, double x, const bool *wanted,
                                bb_point_request *out);

/* Measures a wish on an open device. Never fails as a whole: what goes wrong is an outcome. */
void bb_point_bench(const bb_points *points, bb_device *device, bb_wish *wish);

/* The same of an axis with frames: all methods go through them (framework/animate). */
void bb_point_frames(const bb_points *points, bb_device *device, bb_wish *wish);

/* What went wrong, as a verdict on one method. */
void bb_point_end(bb_point_figures *figures, bb_outcome outcome, const char *reason);

/* The row of a method at a value of an axis; NULL: of no axis, or of no value. */
bb_cell bb_method_row(const bb_method *method, const char *axis, const char *value);
void bb_figures_put(bb_table *table, uint32_t row, const bb_point_figures *figures);

/* The file: a table with a row for each wish and method; `device` may be NULL. */
bb_status bb_point_write(const bb_point_work *work, const bb_device *device);
/* Fills the wishes. BB_INVALID if it is no file that bb_point_write() has written for these. */
bb_status bb_point_read(const bb_point_work *work);

#endif
