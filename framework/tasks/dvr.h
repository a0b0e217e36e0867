/* Direct volume rendering, compared: builders and kernels against each other and against a march
 * without a tree, in time, in work, and pixel by pixel.
 *
 * The measure is Zellmann, Hellmann, Lang 2019, section 4: build and picture together, since a
 * transfer function that changes asks for another tree.
 */
#ifndef BB_DVR_H
#define BB_DVR_H

#include "framework/bench/contest.h"
#include "framework/tasks/march.h"

enum {
    BB_DVR_STEPS_MAX = 12,
    BB_DVR_PICTURES_MAX = 3 * 180,
};

typedef struct bb_dvr_request {
    bb_contest_request contest;  /* `without` follows from the scene: a volume is marched without */
    const bb_transfer *transfer; /* for tetrahedra; a volume has its own */
    const char *view;            /* NULL: all of the scene's */
    uint32_t turns; /* 0: these. Else pictures of the paper: in parallel, all of the volume in
                         sight, so many while it is turned full circle about each axis */
    uint32_t width, height;
    double step;   /* distance of samples, in voxels; of tetrahedra, bb_tet_march_width() */
    double cutoff; /* see bb_march_settings */
    uint32_t step_count;
    double steps[BB_DVR_STEPS_MAX]; /* for the accuracy, in voxels; descending */
} bb_dvr_request;

/* Measures the scene with the transfer function that it has, and puts figures into the table;
 * nothing after a failure. What a builder or kernel cannot do is said in its row. Interrupted after
 * a round that counts, it ends with the rounds that there are, and without accuracy; before that it
 * fails. The scene is on the device. */
bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_table *table);

/* Briefly: without trees, phases and the note. */
extern const bb_page_outline bb_dvr_outline, bb_dvr_outline_briefly;

#endif
