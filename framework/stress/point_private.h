/* Shared by the files that measure and keep points. */
#ifndef BB_POINT_PRIVATE_H
#define BB_POINT_PRIVATE_H

#include "framework/bench/bench.h"
#include "framework/stress/point.h"
#include "framework/table/table.h"

/* The work of a child. */
typedef struct bb_point_work {
    bb_points *points;
    bb_wish *wishes;
    uint32_t count;
    bool again;       /* measures again, though there may be a file */
    const char *path; /* the file to write */
} bb_point_work;

/* Called in the child: opens the device, measures, and writes the file. Returns 0, or 1 without a
 * file. */
int bb_point_child(void *work);

/* The comparison that measures a value of the axis. It must not be copied, since it points into
 * itself. */
typedef struct bb_point_request {
    bb_bench_request bench; /* without a device */
    const bb_points *points;
    const bool *wanted; /* one per method */
    char scene[2 * BB_AXIS_TEXT];
    char rays[BB_AXIS_RAYS_MAX][2 * BB_AXIS_TEXT];
    char *scenes[1], *ray_sets[BB_AXIS_RAYS_MAX];
    char *builders[BB_METHODS_MAX + 1], *kernels[BB_METHODS_MAX + 1];
    char *intersectors[BB_METHODS_MAX + 1];
} bb_point_request;

/* Fills the request for the value x. BB_INVALID: a text of the axis is too long at x. */
bb_status bb_point_request_make(const bb_points *points, double x, const bool *wanted,
                                bb_point_request *out);

/* Measures a wish on an open device. Failures become outcomes. */
void bb_point_bench(const bb_points *points, bb_device *device, bb_wish *wish);

/* Does the same for an axis with frames (framework/tasks). */
void bb_point_frames(const bb_points *points, bb_device *device, bb_wish *wish);

/* Sets a failure as the outcome of one method. */
void bb_point_end(bb_point_figures *figures, bb_outcome outcome, const char *reason);

/* Returns the cell of a method at a value of an axis. `axis` and `value` may be NULL. */
bb_cell bb_method_row(const bb_method *method, const char *axis, const char *value);
/* Puts figures into the row of a cell, and each simulation into one with its name as the maker.
 * Returns the cell's row. */
uint32_t bb_figures_put(bb_table *table, bb_cell cell, const bb_points *points,
                        const bb_point_figures *figures);

/* Writes the file, a table with a row for each wish and method. `device` may be NULL. */
bb_status bb_point_write(const bb_point_work *work, const bb_device *device);
/* Fills the wishes from the file. BB_INVALID: bb_point_write() did not write it for these wishes.
 */
bb_status bb_point_read(const bb_point_work *work);

#endif
