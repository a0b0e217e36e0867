/* What the parts of a comparison of pictures share. */
#ifndef BB_DVR_PRIVATE_H
#define BB_DVR_PRIVATE_H

#include "framework/tasks/dvr.h"
#include "framework/tasks/tet_march.h"

#include <math.h>

/* How far a picture is from one with samples so close that more of them change nothing. */
typedef struct bb_dvr_error {
    double step;      /* in voxels */
    double most, rms; /* over all channels and pictures */
    bb_samples march; /* ms, of the first builder and kernel */
    double samples;   /* per ray */
} bb_dvr_error;

/* A comparison of one volume or mesh with one transfer function. */
typedef struct bb_dvr {
    const bb_dvr_request *request;
    bb_scene *scene;
    bb_device *device;
    bb_contest_task task;
    /* pictures, one view after the other */
    bb_view views[BB_DVR_PICTURES_MAX];
    uint32_t pixels; /* of one */
    bb_rays rays;    /* of one view */
    /* what makes them */
    double unit; /* of steps, in scene units */
    bb_status (*set)(struct bb_dvr *dvr, const bb_march_settings *settings);
    bb_marcher *marcher;         /* of a volume */
    bb_tet_marcher *tet_marcher; /* of tetrahedra */
    bb_buffer copy;              /* room for the bricks once more; empty: there is none */
    /* figures beside those of ways */
    bb_samples copy_ms; /* of all bricks from one buffer to another */
    bool by_others;     /* the largest differences are OpenImageIO's, too */
    uint32_t error_count;
    bb_dvr_error errors[BB_DVR_STEPS_MAX];
    double converged; /* difference of the reference from one of twice its step */
} bb_dvr;

/* Prepare pictures of either: what makes them, and hooks of the task. */
bb_status bb_dvr_of_volume(bb_dvr *dvr);
bb_status bb_dvr_of_tets(bb_dvr *dvr);

/* Views of the request. BB_INVALID if there is no such view. */
bb_status bb_dvr_choose_views(bb_dvr *dvr);
/* Rays of view `i`, on the device. */
bb_status bb_dvr_take_view(bb_dvr *dvr, uint32_t i);

/* The larger of a difference so far and a new one; a NaN stays. */
static inline double bb_dvr_most(double most, double apart)
{
    return isnan(most) || most >= apart ? most : apart;
}

/* The shortest step of the study of errors, in scene units: the reference's. */
float bb_dvr_finest_step(const bb_dvr *dvr);

/* Measures step against error, by one way; `runner` NULL: without a tree, as the reference is of
 * volumes. The task's end(). */
bb_status bb_dvr_measure_errors(void *self, const bb_contest_runner *runner,
                                bb_contest_answers answers);

/* Puts figures of the scene into its row; the task's fill(). */
void bb_dvr_fill(void *self, bb_table *table, uint32_t row);
/* Puts the accuracy, and names of pictures, into rows of their own. */
void bb_dvr_fill_questions(const bb_dvr *dvr, bb_table *table);

#endif
