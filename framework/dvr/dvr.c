/* A comparison: trees and layouts made, pictures compared, then rounds in which all are measured in
 * turns. */
#include "framework/dvr/dvr.h"

#include "framework/base/interrupt.h"
#include "framework/device/stopwatch.h"
#include "framework/dvr/dvr_private.h"
#include "framework/picture/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct entrant {
    bb_instance instance;
    bb_dvr_runner *runners; /* one per kernel */
} entrant;

typedef struct comparison {
    const bb_dvr_request *request;
    bb_scene *scene;
    bb_device *device;
    bb_dvr_result *result;
    bb_dvr_renderer renderer;
    bb_dvr_pictures pictures;
    entrant *entrants;
    bb_dvr_runner *runners; /* of all ways */
    const char *const *kernels;
    uint32_t kernel_count;
    uint32_t first; /* way with a tree */
    bb_light *without, *with;
    bb_count *counts;
} comparison;

/* ---- making ---- */

static bool is_blank(const comparison *c)
{
    return c->scene->prim_count == 0;
}

/* What a builder or a kernel can't do is the way's, all else ends the comparison. */
static bb_status note(bb_dvr_way *way, bb_status status)
{
    if (status != BB_UNSUPPORTED && status != BB_REFUSED)
        return status;
    snprintf(way->refused, sizeof way->refused, "%s", bb_message());
    return BB_OK;
}

static bb_status make_runner(comparison *c, entrant *e, bb_dvr_runner *r, const char *text)
{
    BB_TRY(c->renderer.make(c->renderer.self, text, &e->instance.tree, r));
    r->way->nodes = e->instance.tree.info.node_count;
    r->way->leaves = e->instance.tree.info.leaf_count;
    r->way->references = e->instance.tree.info.ref_count;
    r->way->bytes = e->instance.account.peak + r->layout.bytes;
    r->way->tree_bytes = bb_tree_bytes(&e->instance.tree);
    return BB_OK;
}

static bb_status make_tree(comparison *c, entrant *e, const char *builder)
{
    BB_TRY(bb_instance_create(c->device, builder, c->scene, c->request->seed, &e->instance));
    bool alone = e->instance.pipeline.count == 1;
    if (is_blank(c) && (!alone || (bb_instance_inputs(&e->instance) & BB_INPUT_VOLUME) == 0))
        return bb_fail(BB_UNSUPPORTED, "there is nothing to build over");
    BB_TRY(bb_instance_build(&e->instance, c->scene, false, NULL));
    if (is_blank(c))
        return BB_OK;
    BB_TRY(bb_tree_download(&e->instance.tree, NULL));
    BB_TRY(bb_tree_check(&e->instance.tree, c->scene));
    return bb_tree_upload(&e->instance.tree, c->device, NULL);
}

static bb_status make_entrant(comparison *c, uint32_t i)
{
    const bb_dvr_request *request = c->request;
    entrant *e = &c->entrants[i];
    bb_status status = make_tree(c, e, request->builders[i]);
    const uint32_t first = c->first + i * c->kernel_count;
    e->runners = &c->runners[first];
    for (uint32_t k = 0; k < c->kernel_count; k++) {
        bb_dvr_way *way = &c->result->ways[first + k];
        snprintf(way->builder, sizeof way->builder, "%s", request->builders[i]);
        snprintf(way->kernel, sizeof way->kernel, "%s", c->kernels[k]);
        if (status != BB_OK)
            BB_TRY(note(way, status));
        else if (!is_blank(c))
            BB_TRY(note(way, make_runner(c, e, &e->runners[k], c->kernels[k])));
    }
    return BB_OK;
}

static bb_status check_input(const comparison *c)
{
    return c->renderer.check != NULL ? c->renderer.check(c->renderer.self) : BB_OK;
}

/* ---- pictures ---- */

static const bb_dvr_runner *tree_of(const bb_dvr_runner *r)
{
    return r->way->builder[0] == '\0' ? NULL : r;
}

/* Lights and counts of a way. */
static bb_status make_picture(comparison *c, const bb_dvr_runner *r, bb_light *lights)
{
    bb_dvr_pictures *p = &c->pictures;
    for (uint32_t i = 0; is_blank(c) && i < p->pixels; i++) {
        lights[i] = (bb_light){{0, 0, 0}, 1};
        c->counts[i] = (bb_count){0, 0, 0};
    }
    if (is_blank(c) && tree_of(r) != NULL)
        return BB_OK;
    BB_TRY(bb_buffer_fill(&p->lights, p->pixels * sizeof *lights, BB_POISON));
    BB_TRY(c->renderer.launch(c->renderer.self, tree_of(r), p, true));
    BB_TRY(bb_buffer_read(&p->lights, 0, p->pixels * sizeof *lights, lights));
    return bb_buffer_read(&p->counts, 0, p->pixels * sizeof *c->counts, c->counts);
}

static uint32_t in_8_bits(float channel)
{
    return (uint32_t)lroundf(fminf(fmaxf(channel, 0), 1) * 255);
}

static void add_differences(const comparison *c, bb_dvr_way *way)
{
    for (uint32_t i = 0; i < c->pictures.pixels; i++) {
        const bb_light *a = &c->without[i], *b = &c->with[i];
        const float channels[4][2] = {{a->rgb[0], b->rgb[0]},
                                      {a->rgb[1], b->rgb[1]},
                                      {a->rgb[2], b->rgb[2]},
                                      {a->left, b->left}};
        way->differ += memcmp(a, b, sizeof *a) != 0;
        for (int k = 0; k < 4; k++) {
            double apart = fabs((double)channels[k][0] - (double)channels[k][1]);
            int apart_8 = abs((int)in_8_bits(channels[k][0]) - (int)in_8_bits(channels[k][1]));
            way->most = bb_dvr_most(way->most, apart);
            way->most_8 = (uint32_t)apart_8 > way->most_8 ? (uint32_t)apart_8 : way->most_8;
        }
        way->samples += (double)c->counts[i].prims / (double)c->result->pixels;
        way->overflown += c->counts[i].overflow;
    }
}

static bb_status write_picture(const comparison *c, uint32_t view)
{
    const bb_dvr_pictures *p = &c->pictures;
    char path[4096];
    float *rgb = NULL;
    if (c->request->pictures == NULL)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)p->pixels * sizeof *rgb, "a picture", &rgb));
    for (uint32_t i = 0; i < p->pixels; i++)
        memcpy(rgb + 3 * (size_t)i, c->without[i].rgb, 3 * sizeof *rgb);
    snprintf(path, sizeof path, "%s-%s.png", c->request->pictures, p->views[view].name);
    bb_status status = bb_image_write(path, rgb, p->width, p->height);
    bb_host_free(rgb);
    return status;
}

static bb_status compare_pictures(comparison *c)
{
    const bb_dvr_request *request = c->request;
    for (uint32_t v = 0; v < c->pictures.count; v++) {
        BB_TRY(bb_dvr_take_view(c->scene, &c->pictures, v, c->device));
        BB_TRY(
            bb_march_check(c->scene, &c->pictures.rays, (float)(request->step * c->renderer.unit)));
        if (request->step_count > 0)
            BB_TRY(bb_march_check(c->scene, &c->pictures.rays,
                                  bb_dvr_finest_step(request, c->renderer.unit)));
        if (c->result->ways[0].refused[0] != '\0')
            return bb_fail(BB_UNSUPPORTED, "%s by %s, which others are compared with: %s",
                           c->result->ways[0].builder, c->result->ways[0].kernel,
                           c->result->ways[0].refused);
        BB_TRY(make_picture(c, &c->runners[0], c->without));
        memcpy(c->with, c->without, c->pictures.pixels * sizeof *c->with);
        add_differences(c, &c->result->ways[0]);
        if (request->turns == 0)
            BB_TRY(write_picture(c, v));
        for (uint32_t w = 1; w < c->result->way_count; w++) {
            if (c->result->ways[w].refused[0] != '\0')
                continue;
            BB_TRY(make_picture(c, &c->runners[w], c->with));
            add_differences(c, &c->result->ways[w]);
        }
    }
    for (uint32_t w = 1; w < c->result->way_count; w++) {
        bb_dvr_way *way = &c->result->ways[w];
        if (way->overflown == 0)
            continue;
        snprintf(way->refused, sizeof way->refused, "its stack was too small for %llu of %llu rays",
                 (unsigned long long)way->overflown, (unsigned long long)c->result->pixels);
        way->differ = 0;
    }
    return BB_OK;
}

/* Of a picture that was timed, of the last view. */
static bb_status compare_timed(comparison *c, const bb_dvr_runner *r)
{
    const bb_dvr_pictures *p = &c->pictures;
    BB_TRY(bb_buffer_read(&p->lights, 0, p->pixels * sizeof *c->with, c->with));
    for (uint32_t i = 0; i < p->pixels; i++)
        r->way->differ += memcmp(&c->without[i], &c->with[i], sizeof *c->with) != 0;
    return BB_OK;
}

/* ---- rounds ---- */

static void add_phases(bb_dvr_way *way, const bb_instance *instance)
{
    way->phase_count = 0;
    for (uint32_t s = 0; s < instance->step_count; s++) {
        const bb_build_step *step = &instance->steps[s];
        for (uint32_t p = 0; p < step->phases.count && way->phase_count < BB_PHASES_MAX; p++) {
            bb_dvr_phase *phase = &way->phases[way->phase_count++];
            bool alone = instance->step_count == 1;
            snprintf(phase->name, sizeof phase->name, "%s%s%s", alone ? "" : step->label,
                     alone ? "" : ": ", step->phases.names[p]);
            bb_samples_add(&phase->ms, step->phases.ms[p]);
        }
    }
}

static bb_status time_entrant(comparison *c, entrant *e)
{
    bb_build_timing timing;
    bool refused = true;
    for (uint32_t k = 0; k < c->kernel_count; k++)
        refused = refused && e->runners[k].way->refused[0] != '\0';
    if (refused)
        return BB_OK;
    BB_TRY(bb_instance_build(&e->instance, c->scene, false, &timing));
    double upload_ms = 0;
    if (!is_blank(c))
        BB_TRY(bb_tree_upload(&e->instance.tree, c->device, &upload_ms));
    BB_TRY(bb_instance_build(&e->instance, c->scene, true, NULL));
    if (!is_blank(c))
        BB_TRY(bb_tree_upload(&e->instance.tree, c->device, NULL));
    for (uint32_t k = 0; k < c->kernel_count; k++) {
        bb_dvr_runner *r = &e->runners[k];
        if (r->way->refused[0] != '\0')
            continue;
        bb_samples_add(&r->way->build, timing.timing.ms);
        add_phases(r->way, &e->instance);
        if (!is_blank(c))
            BB_TRY(bb_layout_maker_make(&r->maker, c->scene, &e->instance.tree, r->leaf,
                                        BB_FORMAT_VERTICES, &r->layout));
        bb_samples_add(&r->way->layout, is_blank(c) ? 0 : upload_ms + r->layout.timing.ms);
    }
    return BB_OK;
}

static bb_status time_picture(comparison *c, bb_dvr_runner *r)
{
    bb_dvr_pictures *p = &c->pictures;
    bb_stopwatch watch;
    bb_timing timing;
    if (tree_of(r) != NULL && is_blank(c))
        return BB_OK; /* a blank picture takes no rays */
    BB_TRY(bb_stopwatch_start(c->device, &watch));
    bb_status status = c->renderer.launch(c->renderer.self, tree_of(r), p, false);
    bb_status stopped = bb_stopwatch_stop(&watch, &timing);
    BB_TRY(status);
    BB_TRY(stopped);
    r->ms += timing.ms / p->count;
    r->cpu_ms += timing.cpu_ms / p->count;
    return BB_OK;
}

static bb_status time_round(comparison *c, uint32_t round)
{
    if (c->renderer.time != NULL)
        BB_TRY(c->renderer.time(c->renderer.self, c->result));
    const uint32_t ways = c->result->way_count, builders = c->request->builder_count;
    for (uint32_t i = 0; i < builders; i++)
        BB_TRY(time_entrant(c, &c->entrants[(i + round) % builders]));
    for (uint32_t w = 0; w < ways; w++)
        c->runners[w].ms = c->runners[w].cpu_ms = 0;
    for (uint32_t v = 0; v < c->pictures.count; v++) {
        BB_TRY(bb_dvr_take_view(c->scene, &c->pictures, v, c->device));
        for (uint32_t i = 0; i < ways; i++) {
            bb_dvr_runner *r = &c->runners[(i + round) % ways];
            if (r->way->refused[0] != '\0')
                continue;
            BB_TRY(time_picture(c, r));
            bool last = round == c->request->repeats && v + 1 == c->pictures.count;
            if (last && (tree_of(r) == NULL || !is_blank(c)))
                BB_TRY(compare_timed(c, r));
        }
    }
    for (uint32_t w = 0; w < ways; w++) {
        if (c->result->ways[w].refused[0] != '\0')
            continue;
        bb_samples_add(&c->result->ways[w].march, c->runners[w].ms);
        bb_samples_add(&c->result->ways[w].march_cpu, c->runners[w].cpu_ms);
    }
    return BB_OK;
}

/* ---- all of it ---- */

static bb_status choose_renderer(comparison *c)
{
    const bb_dvr_request *request = c->request;
    const bool tets = c->scene->volume == NULL;
    c->kernels = tets ? request->searches : request->kernels;
    c->kernel_count = tets ? request->search_count : request->kernel_count;
    BB_TRY(tets ? bb_dvr_render_tets(request, c->scene, &c->renderer)
                : bb_dvr_render_volume(c->scene, &c->renderer));
    c->first = c->renderer.without ? 1 : 0;
    c->result->way_count = c->first + request->builder_count * c->kernel_count;
    if (c->result->way_count > BB_DVR_WAYS_MAX || c->result->way_count == 0)
        return bb_fail(BB_INVALID, "%u builders with %u kernels are more than %d ways, or none",
                       request->builder_count, c->kernel_count, BB_DVR_WAYS_MAX - 1);
    return BB_OK;
}

static void describe(const comparison *c)
{
    bb_dvr_result *result = c->result;
    snprintf(result->scene, sizeof result->scene, "%s", c->scene->name);
    result->pictures = c->pictures.count;
    result->pixels = (uint64_t)c->pictures.count * c->pictures.pixels;
    c->renderer.describe(c->renderer.self, result);
}

static bb_status prepare(comparison *c)
{
    const bb_dvr_request *request = c->request;
    size_t pixels = (size_t)request->width * request->height;
    BB_TRY(choose_renderer(c));
    const bb_march_settings settings = {.step = (float)(request->step * c->renderer.unit),
                                        .cutoff = (float)request->cutoff};
    BB_TRY(bb_dvr_choose_views(request, c->scene, &c->pictures));
    BB_TRY(bb_dvr_reserve(request, &c->pictures));
    BB_TRY(bb_host_alloc(NULL, pixels * sizeof *c->with, "pictures", &c->with));
    BB_TRY(bb_host_alloc(NULL, pixels * sizeof *c->without, "pictures", &c->without));
    BB_TRY(bb_host_alloc(NULL, pixels * sizeof *c->counts, "counts", &c->counts));
    describe(c);
    c->entrants = calloc(request->builder_count, sizeof *c->entrants);
    c->runners = calloc(c->result->way_count, sizeof *c->runners);
    if (c->entrants == NULL || c->runners == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    for (uint32_t w = 0; w < c->result->way_count; w++)
        c->runners[w].way = &c->result->ways[w];
    BB_TRY(c->renderer.set(c->renderer.self, &settings));
    for (uint32_t i = 0; i < request->builder_count; i++)
        BB_TRY(make_entrant(c, i));
    return BB_OK;
}

/* The first that has a tree and is not refused; NULL: none. */
static const bb_dvr_runner *first_runner(const comparison *c)
{
    for (uint32_t w = c->first; w < c->result->way_count && !is_blank(c); w++)
        if (c->result->ways[w].refused[0] == '\0')
            return &c->runners[w];
    return NULL;
}

static bb_status measure(comparison *c)
{
    BB_TRY(check_input(c));
    BB_TRY(compare_pictures(c));
    for (uint32_t round = 0; round <= c->request->repeats && !bb_interrupted(); round++)
        BB_TRY(time_round(c, round));
    if (bb_interrupted() && c->result->ways[0].march.count < 2)
        return bb_fail(BB_FAILED, "%s: interrupted before a round that counts", c->scene->name);
    BB_TRY(check_input(c));
    if (c->request->step_count == 0 || bb_interrupted())
        return BB_OK;
    return bb_dvr_measure_errors(c->request, c->scene, &c->renderer, first_runner(c), &c->pictures,
                                 c->result);
}

static void release(comparison *c)
{
    for (uint32_t w = 0; c->runners != NULL && w < c->result->way_count; w++) {
        bb_layout_data_release(&c->runners[w].layout);
        bb_layout_maker_destroy(&c->runners[w].maker);
    }
    for (uint32_t i = 0; c->entrants != NULL && i < c->request->builder_count; i++)
        bb_instance_destroy(&c->entrants[i].instance);
    free(c->runners);
    free(c->entrants);
    if (c->renderer.destroy != NULL)
        c->renderer.destroy(c->renderer.self);
    bb_dvr_release(&c->pictures);
    bb_host_free(c->with);
    bb_host_free(c->without);
    bb_host_free(c->counts);
}

bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_dvr_result *result)
{
    memset(result, 0, sizeof *result);
    comparison *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    c->request = request;
    c->scene = scene;
    c->device = request->device;
    c->result = result;
    bb_status status = prepare(c);
    if (status == BB_OK)
        status = measure(c);
    release(c);
    free(c);
    return status;
}

/* Without a tree there is nothing to build. */
static bb_samples time_of(const bb_dvr_way *way, bool with_build)
{
    bb_samples sum = way->march;
    for (uint32_t i = 0; with_build && i < sum.count && i < way->build.count; i++)
        sum.values[i] += way->build.values[i] + way->layout.values[i];
    return sum;
}

bb_estimate bb_dvr_ratio(const bb_dvr_result *result, const bb_dvr_way *way, bool with_build)
{
    const bb_samples own = time_of(way, with_build);
    const bb_samples first = time_of(&result->ways[0], with_build);
    bb_samples ratio = bb_samples_ratio(&own, &first);
    return bb_samples_estimate(&ratio);
}
