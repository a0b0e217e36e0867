/* A comparison: its pictures are the questions of a contest (framework/bench). */
#include "framework/tasks/dvr_private.h"

#include "framework/picture/exr.h"
#include "framework/picture/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- pictures as answers ---- */

static bb_status take(void *self, uint32_t view, uint32_t *items)
{
    bb_dvr *dvr = self;
    *items = dvr->pixels;
    return bb_dvr_take_view(dvr, view);
}

static uint32_t in_8_bits(float channel)
{
    return (uint32_t)lroundf(fminf(fmaxf(channel, 0), 1) * 255);
}

/* The largest difference of float pictures by OpenImageIO, where it is there; our own beside it,
 * which knows NaN and 8 bits. */
static void compare_by_others(bb_dvr *dvr, const bb_light *first, const bb_light *own,
                              bb_contest_way *way)
{
    bb_exr_difference found;
    for (uint32_t i = 0; i < dvr->pixels; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(first[i].rgb[k]) || !isfinite(own[i].rgb[k]))
                return;
    if (bb_exr_differences((const float *)(const void *)first, (const float *)(const void *)own, 4,
                           dvr->request->width, dvr->request->height, NULL, &found) != BB_OK)
        return;
    dvr->by_others = true;
    way->most = bb_dvr_most(way->most, found.most);
}

static void compare(void *self, const void *first, const void *own, uint32_t items,
                    bb_contest_way *way)
{
    for (uint32_t i = 0; i < items; i++) {
        const bb_light *a = (const bb_light *)first + i, *b = (const bb_light *)own + i;
        const float channels[4][2] = {{a->rgb[0], b->rgb[0]},
                                      {a->rgb[1], b->rgb[1]},
                                      {a->rgb[2], b->rgb[2]},
                                      {a->left, b->left}};
        for (int k = 0; k < 4; k++) {
            double apart = fabs((double)channels[k][0] - (double)channels[k][1]);
            int apart_8 = abs((int)in_8_bits(channels[k][0]) - (int)in_8_bits(channels[k][1]));
            way->most = bb_dvr_most(way->most, apart);
            way->most_8 = (uint32_t)apart_8 > way->most_8 ? (uint32_t)apart_8 : way->most_8;
        }
    }
    compare_by_others(self, first, own, way);
}

static bb_status write_picture(void *self, uint32_t view, const void *first, uint32_t items)
{
    const bb_dvr *dvr = self;
    const bb_dvr_request *request = dvr->request;
    const bb_light *lights = first;
    char path[4096];
    float *rgb = NULL;
    if (request->contest.pictures == NULL || request->turns > 0)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)items * sizeof *rgb, "a picture", &rgb));
    for (uint32_t i = 0; i < items; i++)
        memcpy(rgb + 3 * (size_t)i, lights[i].rgb, 3 * sizeof *rgb);
    snprintf(path, sizeof path, "%s-%s.png", request->contest.pictures, dvr->views[view].name);
    bb_status status = bb_image_write(path, rgb, request->width, request->height);
    bb_host_free(rgb);
    return status;
}

/* ---- all of it ---- */

/* That no march will take more samples than it can. */
static bb_status check_steps(bb_dvr *dvr)
{
    const bb_dvr_request *request = dvr->request;
    for (uint32_t v = 0; v < dvr->task.questions; v++) {
        BB_TRY(bb_dvr_take_view(dvr, v));
        BB_TRY(bb_march_check(dvr->scene, &dvr->rays, (float)(request->step * dvr->unit)));
        if (request->step_count > 0)
            BB_TRY(bb_march_check(dvr->scene, &dvr->rays, bb_dvr_finest_step(dvr)));
    }
    return BB_OK;
}

static bb_status prepare(bb_dvr *dvr)
{
    const bb_dvr_request *request = dvr->request;
    BB_TRY(dvr->scene->volume == NULL ? bb_dvr_of_tets(dvr) : bb_dvr_of_volume(dvr));
    BB_TRY(bb_dvr_choose_views(dvr));
    snprintf(dvr->rays.name, sizeof dvr->rays.name, "picture");
    BB_TRY(bb_rays_reserve(&dvr->rays, dvr->pixels));
    BB_TRY(check_steps(dvr));
    const bb_march_settings settings = {.step = (float)(request->step * dvr->unit),
                                        .cutoff = (float)request->cutoff};
    return dvr->set(dvr, &settings);
}

static bb_status run(bb_dvr *dvr, bb_table *table)
{
    bb_contest_request contest = dvr->request->contest;
    contest.without = dvr->scene->volume != NULL;
    BB_TRY(prepare(dvr));
    BB_TRY(bb_contest_run(&contest, &dvr->task, table));
    bb_dvr_fill_questions(dvr, table);
    return BB_OK;
}

bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_table *table)
{
    static const bb_light blank = {{0, 0, 0}, 1};
    bb_dvr *dvr = calloc(1, sizeof *dvr);
    if (dvr == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    dvr->request = request;
    dvr->scene = scene;
    dvr->device = request->contest.device;
    dvr->pixels = request->width * request->height;
    dvr->task = (bb_contest_task){.self = dvr,
                                  .scenes = &dvr->scene,
                                  .scene_count = 1,
                                  .light = true,
                                  .blank = scene->prim_count == 0,
                                  .blank_answer = &blank,
                                  .answer_bytes = sizeof(bb_light),
                                  .most_items = dvr->pixels,
                                  .take = take,
                                  .compare = compare,
                                  .see = write_picture,
                                  .end = bb_dvr_measure_errors,
                                  .fill = bb_dvr_fill};
    bb_status status = run(dvr, table);
    bb_marcher_destroy(dvr->marcher);
    bb_tet_marcher_destroy(dvr->tet_marcher);
    bb_buffer_release(&dvr->copy);
    bb_host_free(dvr->rays.rays);
    bb_buffer_release(&dvr->rays.on_device);
    free(dvr);
    return status;
}
