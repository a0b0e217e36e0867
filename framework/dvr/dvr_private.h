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

/* What makes pictures of one kind of scene. */
typedef struct bb_dvr_renderer {
    void *self;
    bool without; /* there is a way without a tree, the first: launch() with NULL */
    double unit;  /* of steps, in scene units */
    /* Fills result->transfer and what else tells of the scene. */
    void (*describe)(const void *self, bb_dvr_result *result);
    /* Makes layout and programs of a way, whose tree is on the device. */
    bb_status (*make)(void *self, const char *kernel, bb_tree *const *trees,
                      bb_contest_runner *runner);
    bb_status (*set)(void *self, const bb_march_settings *settings);
    /* Enqueues the picture; with `counting`, its counts too. */
    bb_status (*launch)(void *self, const bb_contest_runner *runner, bb_dvr_pictures *pictures,
                        bool counting);
    /* Whether what builders were handed is as it was. Optional. */
    bb_status (*check)(void *self);
    /* Measures in each round what belongs to no way. Optional. */
    bb_status (*time)(void *self, bb_dvr_result *result);
    void (*destroy)(void *self); /* NULL is allowed */
} bb_dvr_renderer;

/* For a scene that is on the device. Owned by the caller, also after a failure. */
bb_status bb_dvr_render_volume(bb_scene *scene, bb_dvr_renderer *renderer);
bb_status bb_dvr_render_tets(const bb_dvr_request *request, bb_scene *scene,
                             bb_dvr_renderer *renderer);

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
float bb_dvr_finest_step(const bb_dvr_request *request, double unit);

/* Step against error, by one way; `runner` NULL: without a tree, as the reference is where there is
 * such a way. */
bb_status bb_dvr_measure_errors(const bb_dvr_request *request, const bb_scene *scene,
                                const bb_dvr_renderer *renderer, const bb_contest_runner *runner,
                                bb_dvr_pictures *pictures, bb_dvr_result *result);

#endif
