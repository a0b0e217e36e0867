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
#include <xxhash.h>

/* A way at work. */
typedef struct runner {
    bb_dvr_way *way;
    bb_spec kernel;
    bb_layout_maker maker;
    bb_layout_data layout;
    bb_tracer *tracers[2]; /* not counting, counting */
    double ms, cpu_ms;     /* of the pictures of this round */
} runner;

typedef struct entrant {
    bb_instance instance;
    runner *runners; /* one per kernel */
} entrant;

typedef struct comparison {
    const bb_dvr_request *request;
    bb_scene *scene;
    bb_device *device;
    bb_dvr_result *result;
    bb_marcher *marcher;
    bb_dvr_pictures pictures;
    entrant *entrants;
    runner *runners; /* of all ways; the first has no tree */
    bb_buffer copy;  /* room for the bricks once more; empty: there is none */
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

static bb_status make_runner(comparison *c, entrant *e, runner *r, const char *text)
{
    const bb_kernel *kernel;
    uint64_t leaf;
    BB_TRY(bb_kernel_parse(text, &r->kernel, &kernel));
    BB_TRY(bb_spec_u64(&r->kernel, bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf));
    BB_TRY(bb_layout_maker_create(bb_layout_find(kernel->layout), c->device, &r->maker));
    BB_TRY(bb_layout_maker_make(&r->maker, c->scene, &e->instance.tree, (uint32_t)leaf,
                                BB_FORMAT_VERTICES, &r->layout));
    for (int counting = 0; counting < 2; counting++) {
        bb_tracer_request request = {.kernel = kernel,
                                     .spec = &r->kernel,
                                     .intersector = &bb_intersectors[0],
                                     .counting = counting != 0};
        bb_march_tracer_request(c->marcher, &request);
        BB_TRY(bb_tracer_get(c->device, &request, &r->layout, &r->tracers[counting]));
    }
    r->way->nodes = e->instance.tree.info.node_count;
    r->way->leaves = e->instance.tree.info.leaf_count;
    r->way->bytes = e->instance.account.peak + r->layout.bytes;
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
    e->runners = &c->runners[1 + i * request->kernel_count];
    for (uint32_t k = 0; k < request->kernel_count; k++) {
        bb_dvr_way *way = &c->result->ways[1 + i * request->kernel_count + k];
        e->runners[k].way = way;
        snprintf(way->builder, sizeof way->builder, "%s", request->builders[i]);
        snprintf(way->kernel, sizeof way->kernel, "%s", request->kernels[k]);
        if (status != BB_OK)
            BB_TRY(note(way, status));
        else if (!is_blank(c))
            BB_TRY(note(way, make_runner(c, e, &e->runners[k], request->kernels[k])));
    }
    return BB_OK;
}

/* Whether the bricks on the device are still those that were loaded: builders are handed them, and
 * a picture of others would be the same with any tree. */
static bb_status check_bricks(const comparison *c)
{
    const bb_volume *volume = c->scene->volume;
    const bb_buffer *bricks = &c->scene->on_device.bricks;
    void *mapped;
    BB_TRY(bb_buffer_map(bricks, false, &mapped));
    bool same = XXH3_64bits(mapped, (size_t)bb_volume_bytes(volume)) == volume->bricks_hash;
    BB_TRY(bb_buffer_unmap(bricks, mapped));
    return same ? BB_OK
                : bb_fail(BB_FAILED, "%s: a builder has changed the volume on the device",
                          c->scene->name);
}

/* ---- pictures ---- */

static bb_pass pass_of(const comparison *c, const runner *r, bool counting)
{
    bb_dvr_pictures *p = (bb_dvr_pictures *)&c->pictures;
    bb_pass pass = {.tracer = r->tracers[counting],
                    .layout = &r->layout,
                    .rays = &p->rays.on_device,
                    .results = &p->lights,
                    .counts = counting ? &p->counts : NULL};
    bb_march_pass(c->marcher, &pass);
    return pass;
}

static bb_status read_picture(comparison *c, bb_light *lights)
{
    const bb_dvr_pictures *p = &c->pictures;
    BB_TRY(bb_buffer_read(&p->lights, 0, p->pixels * sizeof *lights, lights));
    return bb_buffer_read(&p->counts, 0, p->pixels * sizeof *c->counts, c->counts);
}

/* Lights and counts of a way. */
static bb_status make_picture(comparison *c, const runner *r, bb_light *lights)
{
    bb_dvr_pictures *p = &c->pictures;
    if (r->way->builder[0] == '\0') {
        BB_TRY(bb_march_all(c->marcher, &p->rays.on_device, p->pixels, &p->lights, &p->counts));
        return read_picture(c, lights);
    }
    for (uint32_t i = 0; is_blank(c) && i < p->pixels; i++) {
        lights[i] = (bb_light){{0, 0, 0}, 1};
        c->counts[i] = (bb_count){0, 0, 0};
    }
    if (is_blank(c))
        return BB_OK;
    const bb_pass pass = pass_of(c, r, true);
    return bb_pass_run(&pass, p->pixels, lights, c->counts);
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
    for (uint32_t v = 0; v < c->pictures.count; v++) {
        BB_TRY(bb_dvr_take_view(c->scene, &c->pictures, v, c->device));
        BB_TRY(bb_march_check(c->scene, &c->pictures.rays,
                              (float)(c->request->step * bb_volume_voxel(c->scene->volume))));
        if (c->request->step_count > 0)
            BB_TRY(bb_march_check(c->scene, &c->pictures.rays,
                                  bb_dvr_finest_step(c->request, c->scene)));
        BB_TRY(make_picture(c, &c->runners[0], c->without));
        memcpy(c->with, c->without, c->pictures.pixels * sizeof *c->with);
        add_differences(c, &c->result->ways[0]);
        if (c->request->turns == 0)
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
static bb_status compare_timed(comparison *c, const runner *r)
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
    for (uint32_t k = 0; k < c->request->kernel_count; k++)
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
    for (uint32_t k = 0; k < c->request->kernel_count; k++) {
        runner *r = &e->runners[k];
        uint64_t leaf = 1;
        if (r->way->refused[0] != '\0')
            continue;
        bb_samples_add(&r->way->build, timing.timing.ms);
        add_phases(r->way, &e->instance);
        if (!is_blank(c)) {
            BB_TRY(
                bb_spec_u64(&r->kernel, bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf));
            BB_TRY(bb_layout_maker_make(&r->maker, c->scene, &e->instance.tree, (uint32_t)leaf,
                                        BB_FORMAT_VERTICES, &r->layout));
        }
        bb_samples_add(&r->way->layout, is_blank(c) ? 0 : upload_ms + r->layout.timing.ms);
    }
    return BB_OK;
}

static bb_status time_picture(comparison *c, runner *r)
{
    bb_dvr_pictures *p = &c->pictures;
    bb_stopwatch watch;
    bb_timing timing;
    bool without = r->way->builder[0] == '\0';
    if (!without && is_blank(c))
        return BB_OK; /* a blank picture takes no rays */
    const bb_pass pass = pass_of(c, r, false);
    BB_TRY(bb_stopwatch_start(c->device, &watch));
    bb_status status =
        without ? bb_march_all(c->marcher, &p->rays.on_device, p->pixels, &p->lights, NULL)
                : bb_pass_launch(&pass, p->pixels);
    bb_status stopped = bb_stopwatch_stop(&watch, &timing);
    BB_TRY(status);
    BB_TRY(stopped);
    r->ms += timing.ms / p->count;
    r->cpu_ms += timing.cpu_ms / p->count;
    return BB_OK;
}

/* What votes are compared with: how fast memory is. */
static bb_status time_copy(comparison *c)
{
    bb_stopwatch watch;
    bb_timing timing;
    if (c->copy.mem == NULL)
        return BB_OK;
    BB_TRY(bb_stopwatch_start(c->device, &watch));
    bb_status status = bb_buffer_copy(&c->scene->on_device.bricks, &c->copy,
                                      (size_t)bb_volume_bytes(c->scene->volume));
    bb_status stopped = bb_stopwatch_stop(&watch, &timing);
    BB_TRY(status);
    BB_TRY(stopped);
    bb_samples_add(&c->result->copy, timing.ms);
    return BB_OK;
}

static bb_status time_round(comparison *c, uint32_t round)
{
    BB_TRY(time_copy(c));
    const uint32_t ways = c->result->way_count, builders = c->request->builder_count;
    for (uint32_t i = 0; i < builders; i++)
        BB_TRY(time_entrant(c, &c->entrants[(i + round) % builders]));
    for (uint32_t w = 0; w < ways; w++)
        c->runners[w].ms = c->runners[w].cpu_ms = 0;
    for (uint32_t v = 0; v < c->pictures.count; v++) {
        BB_TRY(bb_dvr_take_view(c->scene, &c->pictures, v, c->device));
        for (uint32_t i = 0; i < ways; i++) {
            runner *r = &c->runners[(i + round) % ways];
            if (r->way->refused[0] != '\0')
                continue;
            BB_TRY(time_picture(c, r));
            bool last = round == c->request->repeats && v + 1 == c->pictures.count;
            if (last && (r->way->builder[0] == '\0' || !is_blank(c)))
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

static void describe(const comparison *c)
{
    const bb_volume *volume = c->scene->volume;
    bb_dvr_result *result = c->result;
    snprintf(result->scene, sizeof result->scene, "%s", c->scene->name);
    snprintf(result->transfer, sizeof result->transfer, "%s", volume->transfer.name);
    for (int k = 0; k < 3; k++)
        result->dims[k] = volume->grid.cells[k] + 1;
    result->bytes = volume->bytes;
    result->brick_side = volume->grid.side;
    result->bricks = volume->brick_count;
    result->seen = c->scene->prim_count;
    result->volume_bytes = bb_volume_bytes(volume);
    result->pictures = c->pictures.count;
    result->pixels = (uint64_t)c->pictures.count * c->pictures.pixels;
    result->way_count = 1 + c->request->builder_count * c->request->kernel_count;
}

static bb_status prepare(comparison *c)
{
    const bb_dvr_request *request = c->request;
    const double voxel = bb_volume_voxel(c->scene->volume);
    const bb_march_settings settings = {.step = (float)(request->step * voxel),
                                        .cutoff = (float)request->cutoff};
    size_t pixels = (size_t)request->width * request->height;
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
    BB_TRY(bb_marcher_create(c->scene, NULL, &c->marcher));
    BB_TRY(bb_marcher_set(c->marcher, &settings));
    bb_status room = bb_buffer_reserve(c->device, NULL, (size_t)c->result->volume_bytes,
                                       "a copy of the bricks", &c->copy);
    if (room != BB_OK && room != BB_REFUSED)
        return room;
    c->runners[0].way = &c->result->ways[0];
    for (uint32_t i = 0; i < request->builder_count; i++)
        BB_TRY(make_entrant(c, i));
    return BB_OK;
}

static bb_status measure(comparison *c)
{
    BB_TRY(check_bricks(c));
    BB_TRY(compare_pictures(c));
    for (uint32_t round = 0; round <= c->request->repeats && !bb_interrupted(); round++)
        BB_TRY(time_round(c, round));
    if (bb_interrupted() && c->result->ways[0].march.count < 2)
        return bb_fail(BB_FAILED, "%s: interrupted before a round that counts", c->scene->name);
    BB_TRY(check_bricks(c));
    if (c->request->step_count == 0 || bb_interrupted())
        return BB_OK;
    const runner *first = NULL;
    for (uint32_t w = 1; w < c->result->way_count && first == NULL && !is_blank(c); w++)
        first = c->result->ways[w].refused[0] == '\0' ? &c->runners[w] : NULL;
    const bb_pass pass = first != NULL ? pass_of(c, first, true) : (bb_pass){0};
    return bb_dvr_measure_errors(c->request, c->scene, c->marcher, first != NULL ? &pass : NULL,
                                 &c->pictures, c->result);
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
    bb_marcher_destroy(c->marcher);
    bb_dvr_release(&c->pictures);
    bb_buffer_release(&c->copy);
    bb_host_free(c->with);
    bb_host_free(c->without);
    bb_host_free(c->counts);
}

bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_dvr_result *result)
{
    memset(result, 0, sizeof *result);
    if (1 + request->builder_count * request->kernel_count > BB_DVR_WAYS_MAX)
        return bb_fail(BB_INVALID, "%u builders with %u kernels are more than %d ways: take fewer",
                       request->builder_count, request->kernel_count, BB_DVR_WAYS_MAX - 1);
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

bb_estimate bb_dvr_ratio(const bb_dvr_result *result, const bb_dvr_way *way, bool with_build)
{
    bb_samples sum = way->march;
    for (uint32_t i = 0; with_build && i < sum.count && i < way->build.count; i++)
        sum.values[i] += way->build.values[i] + way->layout.values[i];
    bb_samples ratio = bb_samples_ratio(&sum, &result->ways[0].march);
    return bb_samples_estimate(&ratio);
}
