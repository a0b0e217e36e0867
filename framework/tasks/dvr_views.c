/* The pictures that are made of a volume. */
#include "framework/tasks/dvr_private.h"

#include "framework/scene/camera.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double radian = 3.14159265358979323846 / 180;

/* Section 4: parallel projection, the whole extent visible; turned about one axis. The eye goes
 * round instead of the volume. */
static bb_view turned_view(const bb_scene *scene, uint32_t width, uint32_t height, uint32_t axis,
                           double degrees)
{
    bb_view view = {.parallel = true};
    double diagonal = 0, angle = degrees * radian;
    for (int k = 0; k < 3; k++) {
        double side = (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k];
        diagonal += side * side;
        view.target[k] = ((double)scene->bounds.lo[k] + (double)scene->bounds.hi[k]) / 2;
    }
    diagonal = sqrt(diagonal);
    /* looking along -z, up is y, both turned about the axis; about z it is up that turns */
    double forward[3] = {0, 0, -1}, up[3] = {0, 1, 0};
    uint32_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int i = 0; i < 2; i++) {
        double *v = i == 0 ? forward : up, x = v[a], y = v[b];
        v[a] = x * cos(angle) - y * sin(angle);
        v[b] = x * sin(angle) + y * cos(angle);
    }
    for (int k = 0; k < 3; k++) {
        view.eye[k] = view.target[k] - diagonal * forward[k];
        view.up[k] = up[k];
    }
    view.fov_y = diagonal * (width < height ? (double)height / width : 1);
    snprintf(view.name, sizeof view.name, "%c%03.0f", "xyz"[axis], degrees);
    return view;
}

bb_status bb_dvr_choose_views(bb_dvr *dvr)
{
    const bb_dvr_request *request = dvr->request;
    const bb_scene *scene = dvr->scene;
    uint32_t *count = &dvr->task.questions;
    /* from half a step on: not turned at all, the three axes would give one picture */
    for (uint32_t i = 0; i < 3 * request->turns; i++)
        dvr->views[(*count)++] =
            turned_view(scene, request->width, request->height, i / request->turns,
                        360 * (i % request->turns + 0.5) / request->turns);
    if (request->turns > 0)
        return BB_OK;
    for (uint32_t i = 0; i < scene->view_count; i++)
        if (request->view == NULL || strcmp(request->view, scene->views[i].name) == 0)
            dvr->views[(*count)++] = scene->views[i];
    return *count > 0 ? BB_OK
                      : bb_fail(BB_INVALID, "%s: has no view '%s'", scene->name,
                                request->view != NULL ? request->view : "");
}

bb_status bb_dvr_take_view(bb_dvr *dvr, uint32_t i)
{
    bb_camera camera;
    bb_rays *rays = &dvr->rays;
    const uint32_t width = dvr->request->width, height = dvr->request->height;
    BB_TRY(bb_camera_make(&dvr->views[i], width, height, &camera));
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            bb_camera_ray(&camera, x, y, &rays->rays[y * width + x]);
    BB_TRY(bb_rays_check(dvr->scene, rays));
    const size_t bytes = rays->count * sizeof *rays->rays;
    BB_TRY(bb_buffer_reserve(dvr->device, NULL, bytes, "rays", &rays->on_device));
    return bb_buffer_write(&rays->on_device, 0, bytes, rays->rays);
}
