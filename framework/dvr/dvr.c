/* A comparison: its pictures are the questions of a contest (framework/contest). */
#include "framework/dvr/dvr.h"

#include "framework/base/interrupt.h"
#include "framework/dvr/dvr_private.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct comparison {
    const bb_dvr_request *request;
    bb_scene *scene;
    bb_device *device;
    bb_dvr_result *result;
    bb_dvr_renderer renderer;
    bb_dvr_pictures pictures;
} comparison;

/* ---- pictures as answers ---- */

static const bb_light blank = {{0, 0, 0}, 1};

static bb_status take(void *self, uint32_t view, uint32_t *items)
{
    comparison *c = self;
    *items = c->pictures.pixels;
    return bb_dvr_take_view(c->scene, &c->pictures, view, c->device);
}

static bb_status make(void *self, const char *kernel, bb_tree *const *trees,
                      bb_contest_runner *runner)
{
    const comparison *c = self;
    return c->renderer.make(c->renderer.self, kernel, trees, runner);
}

static bb_status ask(void *self, const bb_contest_runner *runner, bool counting)
{
    comparison *c = self;
    return c->renderer.launch(c->renderer.self, runner, &c->pictures, counting);
}

static bb_status check(void *self)
{
    const comparison *c = self;
    return c->renderer.check != NULL ? c->renderer.check(c->renderer.self) : BB_OK;
}

static bb_status time_round(void *self)
{
    comparison *c = self;
    return c->renderer.time != NULL ? c->renderer.time(c->renderer.self, c->result) : BB_OK;
}

static uint32_t in_8_bits(float channel)
{
    return (uint32_t)lroundf(fminf(fmaxf(channel, 0), 1) * 255);
}

/* The largest difference of float pictures by OpenImageIO, where it is there; our own beside it,
 * which knows NaN and 8 bits. */
static void compare_by_others(comparison *c, const bb_light *first, const bb_light *own,
                              bb_contest_way *way)
{
    bb_exr_difference found;
    for (uint32_t i = 0; i < c->pictures.pixels; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(first[i].rgb[k]) || !isfinite(own[i].rgb[k]))
                return;
    if (bb_exr_differences((const float *)(const void *)first, (const float *)(const void *)own, 4,
                           c->pictures.width, c->pictures.height, NULL, &found) != BB_OK)
        return;
    c->result->by_others = true;
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
    const comparison *c = self;
    const bb_dvr_pictures *p = &c->pictures;
    const bb_light *lights = first;
    char path[4096];
    float *rgb = NULL;
    if (c->request->pictures == NULL || c->request->turns > 0)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)items * sizeof *rgb, "a picture", &rgb));
    for (uint32_t i = 0; i < items; i++)
        memcpy(rgb + 3 * (size_t)i, lights[i].rgb, 3 * sizeof *rgb);
    snprintf(path, sizeof path, "%s-%s.png", c->request->pictures, p->views[view].name);
    bb_status status = bb_image_write(path, rgb, p->width, p->height);
    bb_host_free(rgb);
    return status;
}

/* ---- all of it ---- */

/* That no march will take more samples than it can. */
static bb_status check_steps(comparison *c)
{
    const bb_dvr_request *request = c->request;
    const double unit = c->renderer.unit;
    for (uint32_t v = 0; v < c->pictures.count; v++) {
        BB_TRY(bb_dvr_take_view(c->scene, &c->pictures, v, c->device));
        BB_TRY(bb_march_check(c->scene, &c->pictures.rays, (float)(request->step * unit)));
        if (request->step_count > 0)
            BB_TRY(bb_march_check(c->scene, &c->pictures.rays, bb_dvr_finest_step(request, unit)));
    }
    return BB_OK;
}

static void describe(const comparison *c)
{
    bb_dvr_result *result = c->result;
    result->pictures = c->pictures.count;
    result->pixels = (uint64_t)c->pictures.count * c->pictures.pixels;
    c->renderer.describe(c->renderer.self, result);
    snprintf(result->scene, sizeof result->scene, "%s, transfer function %s", c->scene->name,
             result->transfer);
    result->view_count = c->request->turns > 0 ? 0 : c->pictures.count;
    for (uint32_t v = 0; v < result->view_count; v++)
        snprintf(result->views[v], sizeof result->views[v], "%s", c->pictures.views[v].name);
}

static bb_status prepare(comparison *c)
{
    const bb_dvr_request *request = c->request;
    BB_TRY(c->scene->volume == NULL ? bb_dvr_render_tets(request, c->scene, &c->renderer)
                                    : bb_dvr_render_volume(c->scene, &c->renderer));
    const bb_march_settings settings = {.step = (float)(request->step * c->renderer.unit),
                                        .cutoff = (float)request->cutoff};
    BB_TRY(bb_dvr_choose_views(request, c->scene, &c->pictures));
    BB_TRY(bb_dvr_reserve(request, &c->pictures));
    describe(c);
    BB_TRY(check_steps(c));
    return c->renderer.set(c->renderer.self, &settings);
}

static bb_status measure(comparison *c)
{
    const bb_dvr_request *request = c->request;
    const bool tets = c->scene->volume == NULL;
    const bb_contest_request entry = {
        .device = c->device,
        .scenes = &c->scene,
        .scene_count = 1,
        .builders = request->builders,
        .builder_count = request->builder_count,
        .searches = tets ? request->searches : request->kernels,
        .search_count = tets ? request->search_count : request->kernel_count,
        .most_items = c->pictures.pixels,
        .repeats = request->repeats,
        .seed = request->seed,
        .quiet = request->quiet,
    };
    const bb_contest_task task = {
        .self = c,
        .without = c->renderer.without,
        .blank = c->scene->prim_count == 0,
        .blank_answer = &blank,
        .answer_bytes = sizeof(bb_light),
        .questions = c->pictures.count,
        .answers = &c->pictures.lights,
        .counts = &c->pictures.counts,
        .take = take,
        .make = make,
        .ask = ask,
        .compare = compare,
        .see = write_picture,
        .check = check,
        .time = time_round,
    };
    bb_contest *contest;
    BB_TRY(bb_contest_create(&entry, &task, c->result->ways, &c->result->way_count, &contest));
    bb_status status = bb_contest_run(contest);
    if (status == BB_OK && request->step_count > 0 && !bb_interrupted())
        status = bb_dvr_measure_errors(request, c->scene, &c->renderer, bb_contest_first(contest),
                                       &c->pictures, c->result);
    bb_contest_destroy(contest);
    return status;
}

bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_dvr_result *result)
{
    memset(result, 0, sizeof *result);
    comparison c = {
        .request = request, .scene = scene, .device = request->device, .result = result};
    bb_status status = prepare(&c);
    if (status == BB_OK)
        status = measure(&c);
    if (c.renderer.destroy != NULL)
        c.renderer.destroy(c.renderer.self);
    bb_dvr_release(&c.pictures);
    return status;
}
