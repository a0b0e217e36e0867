/* What the parts of a comparison of pictures share. */
#ifndef BB_DVR_PRIVATE_H
#define BB_DVR_PRIVATE_H

#include "framework/dvr/dvr.h"

#include <math.h>

/* Rays and pictures, one view after the other. */
typedef struct bb_dvr_pictures {
    bb_view views[BB_DVR_PICTURES_MAX];
    uint32_t count;
    uint32_t width, height, pixels; /* of one */
    bb_rays rays;                   /* of one view */
    bb_buffer lights, counts;
} bb_dvr_pictures;

/* Views of the request. BB_INVALID if there is no such view. */
bb_status bb_dvr_choose_views(const bb_dvr_request *request, const bb_scene *scene,
                              bb_dvr_pictures *pictures);
bb_status bb_dvr_reserve(const bb_dvr_request *request, bb_dvr_pictures *pictures);
void bb_dvr_release(bb_dvr_pictures *pictures);

/* Rays of view `i`, on the device. */
bb_status bb_dvr_take_view(const bb_scene *scene, bb_dvr_pictures *pictures, uint32_t i,
                           bb_device *device);

/* The larger of a difference so far and a new one; a NaN stays. */
static inline double bb_dvr_most(double most, double apart)
{
    return isnan(most) || most >= apart ? most : apart;
}

/* The shortest step of the study of errors, in scene units: the reference's. */
float bb_dvr_finest_step(const bb_dvr_request *request, const bb_scene *scene);

/* Step against error. `pass` is one way's, complete but for its results; NULL: without a tree. */
bb_status bb_dvr_measure_errors(const bb_dvr_request *request, const bb_scene *scene,
                                bb_marcher *marcher, const bb_pass *pass, bb_dvr_pictures *pictures,
                                bb_dvr_result *result);

#endif
