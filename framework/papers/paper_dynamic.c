/* Eisemann, Grosch, Mueller, Magnor: Automatic Creation of Object Hierarchies for Ray Tracing of
 * Dynamic Scenes. 2007.
 *
 * Its table 1: Goldsmith and Salmon built anew in each frame, Dynamic Goldsmith and Salmon, Loose
 * BVH; time of the update, of tracing and of both. The paper's scenes are not at hand. In place of
 * BART's kitchen with a toy car, a room of as many triangles in which five balls drive around once
 * (--scene S: in that room); in place of BART's museum, whose deforming art moves without
 * structure, particles in a flow, and again a bar that is twisted, since the flow's file is in
 * random order; its falling triangles are made by its own description, in random order too. The
 * pictures have the paper's sizes. It traced one reflection and one refraction where a surface has
 * any: here one diffuse ray follows each of at most 65,536 hits, of all the scene's views.
 *
 * The paper shuffled the objects for the first tree of Dynamic Goldsmith and Salmon ("rebuilt
 * several times"), and never for the rebuilds it is compared with: here both pairings are measured,
 * and both with like against like.
 */
#include "framework/papers/dynamic_figures.h"

#include "framework/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FRAMES = 11, /* the paper's, where it says */
    BOUNCES = 65536,
    SMALLER = 8, /* sides of pictures for refitted trees */
    ROUNDS = 7,
    QUICK_FRAMES = 4,
    QUICK_WIDTH = 64,
    QUICK_HEIGHT = 48,
    QUICK_ROUNDS = 2,
};

#define GS "gs:max_children=0" /* the paper has no limit */
#define LOOSE "loose-bvh:levels=6,deeper=0"

static const struct {
    const char *builder, *name;
} methods[BB_DYNAMIC_METHODS] = {
    [BB_DYNAMIC_REBUILT] = {GS ",update=rebuild,order=file", "G&S rebuilt"},
    [BB_DYNAMIC_REBUILT_SHUFFLED] = {GS ",update=rebuild,order=shuffled", "G&S rebuilt, shuffled"},
    [BB_DYNAMIC_UPDATED] = {GS ",order=file", "Dynamic G&S"},
    [BB_DYNAMIC_UPDATED_SHUFFLED] = {GS ",order=shuffled", "Dynamic G&S, shuffled"},
    [BB_DYNAMIC_LOOSE] = {LOOSE ",root=box", "Loose BVH"},
    [BB_DYNAMIC_LOOSE_CUBE] = {LOOSE ",root=cube", "Loose BVH, cubic root"},
    [BB_DYNAMIC_LOOSE_NOW] = {"loose-bvh", "Loose BVH, this builder's"},
    [BB_DYNAMIC_LBVH] = {"lbvh", "LBVH rebuilt"},
};

static const struct {
    const char *builder, *name;
} small_methods[BB_DYNAMIC_SMALL_METHODS] = {
    [BB_DYNAMIC_SMALL_REBUILT] = {"lbvh", "LBVH rebuilt, small"},
    [BB_DYNAMIC_SMALL_REFITTED] = {"lbvh+refit", "LBVH refitted, small"},
};

#define MUSEUM                                                                                     \
    76000, 800, 640, {6.137, 1.489, 1.666},                                                        \
    {                                                                                              \
        15.464, 1.147, 1.318                                                                       \
    }

const bb_dynamic_about bb_dynamic_scenes[BB_DYNAMIC_SCENES] = {
    [BB_DYNAMIC_KITCHEN] =
        {"kitchen", NULL, 110000, 300, 225, {103.471, 1.010, 1.295}, {11.204, 0.522, 0.662}},
    [BB_DYNAMIC_MUSEUM] = {"museum (flow)", "crowd:kind=flow", MUSEUM},
    [BB_DYNAMIC_TWIST] = {"museum (twist)", "twist:seed=1", MUSEUM},
    [BB_DYNAMIC_FALL] = {"falling triangles",
                         "crowd:kind=fall",
                         149000,
                         512,
                         512,
                         {8.245, 1.953, 2.416},
                         {18.510, 7.008, 8.303}},
};

static const bb_experiment experiments[] = {{.name = NULL}};

/* ---- measuring ---- */

static bb_status name_scene(const bb_reproduce_request *request, bb_dynamic_scene scene, char *out,
                            size_t capacity)
{
    const uint32_t frames = request->quick ? QUICK_FRAMES : FRAMES;
    const uint64_t asked = bb_dynamic_scenes[scene].prims;
    const uint64_t prims = asked < request->max_prims ? asked : request->max_prims;
    char room[512];
    snprintf(room, sizeof room, "interior:n=%llu", (unsigned long long)prims);
    if (request->scene_count > 0)
        snprintf(room, sizeof room, "%s", request->scenes[0]);
    if (bb_dynamic_scenes[scene].scene == NULL)
        snprintf(out, capacity, "car:room=%s,frames=%u", room, frames);
    else
        snprintf(out, capacity, "%s,n=%llu,frames=%u", bb_dynamic_scenes[scene].scene,
                 (unsigned long long)prims, frames);
    return BB_OK;
}

/* All methods, and refitted trees beside rebuilt ones in small pictures. */
static bb_status animate(const bb_reproduce_request *request, bb_scene *scene, bb_dynamic_scene at,
                         bb_dynamic *d)
{
    static const char *const kernels[] = {"stack"}, *const rays[] = {"primary",
                                                                     "diffuse:per_hit=1"};
    const char *builders[BB_DYNAMIC_METHODS], *small[BB_DYNAMIC_SMALL_METHODS];
    for (int m = 0; m < BB_DYNAMIC_METHODS; m++)
        builders[m] = methods[m].builder;
    for (int m = 0; m < BB_DYNAMIC_SMALL_METHODS; m++)
        small[m] = small_methods[m].builder;
    d->width[at] = request->quick ? QUICK_WIDTH : bb_dynamic_scenes[at].width;
    d->height[at] = request->quick ? QUICK_HEIGHT : bb_dynamic_scenes[at].height;
    bb_animate_request wanted = {
        .device = request->device,
        .builders = builders,
        .builder_count = BB_DYNAMIC_METHODS,
        .kernels = kernels,
        .kernel_count = 1,
        .rays = rays,
        .ray_count = 2,
        .intersector = "exact",
        .width = d->width[at],
        .height = d->height[at],
        .max_rays = BOUNCES,
        .last = UINT32_MAX,
        .repeats = request->quick         ? QUICK_ROUNDS
                   : request->repeats > 0 ? request->repeats
                                          : ROUNDS,
        .seed = request->seed,
        .quiet = request->quiet,
    };
    BB_TRY(bb_animate_run(&wanted, scene, &d->scenes[at]));
    wanted.builders = small;
    wanted.builder_count = BB_DYNAMIC_SMALL_METHODS;
    wanted.width /= SMALLER;
    wanted.height /= SMALLER;
    wanted.max_rays /= SMALLER * SMALLER;
    return bb_animate_run(&wanted, scene, &d->small[at]);
}

static bb_status load_and_animate(const bb_reproduce_request *request, bb_dynamic_scene at,
                                  bb_dynamic *d)
{
    char name[640];
    bb_scene *scene;
    BB_TRY(name_scene(request, at, name, sizeof name));
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = bb_scene_upload(scene, request->device);
    if (status == BB_OK)
        status = animate(request, scene, at, d);
    bb_tracers_clear(request->device);
    bb_scene_free(scene);
    return status;
}

static void release(void *opaque)
{
    bb_dynamic *d = opaque;
    for (int s = 0; d != NULL && s < BB_DYNAMIC_SCENES; s++) {
        bb_animate_release(&d->scenes[s]);
        bb_animate_release(&d->small[s]);
    }
    free(d);
}

/* A parameter's value, which the room is, ends at a ','. */
static bb_status check_room(const bb_reproduce_request *request)
{
    if (request->scene_count > 1)
        return bb_fail(BB_INVALID, "--scene is the room in which things drive: give one");
    if (request->scene_count > 0 &&
        (strchr(request->scenes[0], ',') != NULL || strlen(request->scenes[0]) > 400))
        return bb_fail(BB_INVALID,
                       "--scene %.60s: it is the room in which things drive, whose name "
                       "has no ',' and at most 400 characters",
                       request->scenes[0]);
    return BB_OK;
}

static bool is_wrong(const bb_animate_result *result)
{
    return bb_animate_wrong(result) > 0 || bb_animate_failed(result) > 0;
}

static bb_status measure(const bb_reproduce_request *request, void **out, bool *wrong)
{
    bb_dynamic *d = calloc(1, sizeof *d);
    *out = d;
    if (d == NULL)
        return bb_fail(BB_REFUSED, "reproduce: no memory");
    BB_TRY(check_room(request));
    if (request->repeats >= BB_ANIMATE_ROUNDS_MAX)
        return bb_fail(BB_INVALID, "--repeats: at most %d of sequences", BB_ANIMATE_ROUNDS_MAX - 1);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        BB_TRY(load_and_animate(request, (bb_dynamic_scene)s, d));
        *wrong = *wrong || is_wrong(&d->scenes[s]) || is_wrong(&d->small[s]);
    }
    return BB_OK;
}

/* ---- figures ---- */

bb_estimate bb_dynamic_ratio(const bb_dynamic *d, bb_dynamic_scene scene, uint32_t parts,
                             bb_dynamic_method method, bb_dynamic_method base)
{
    const bool small = method == BB_DYNAMIC_REFIT;
    const bb_animate_result *result = small ? &d->small[scene] : &d->scenes[scene];
    const uint32_t at = small ? (uint32_t)BB_DYNAMIC_SMALL_REFITTED : method,
                   other = small ? (uint32_t)BB_DYNAMIC_SMALL_REBUILT : base;
    const bb_samples own = bb_animate_samples(result, &result->methods[at], 0, parts);
    const bb_samples others = bb_animate_samples(result, &result->methods[other], 0, parts);
    const bb_samples ratio = bb_samples_ratio(&others, &own);
    return bb_samples_estimate(&ratio);
}

static double events_of(const bb_animate_method *m, const char *event)
{
    double sum = 0;
    for (uint32_t f = 1; f < m->done; f++)
        for (uint32_t e = 0; e < m->frames[f].event_count; e++)
            if (strcmp(m->frames[f].events[e], event) == 0)
                sum += (double)m->frames[f].event_numbers[e];
    return m->done > 1 ? sum / (m->done - 1) : 0;
}

double bb_dynamic_events(const bb_dynamic *d, bb_dynamic_scene scene, bb_dynamic_method method,
                         const char *event)
{
    return events_of(&d->scenes[scene].methods[method], event);
}

/* Median over rounds of a mean frame, ms. */
static double frame_ms(const bb_animate_result *result, const bb_animate_method *method,
                       uint32_t parts)
{
    const bb_samples samples = bb_animate_samples(result, method, 0, parts);
    return bb_samples_median(&samples) / (result->frame_count - 1);
}

/* ---- tables ---- */

static void add_estimate(bb_reproduction *r, bb_estimate e)
{
    bb_paper_number(r, e.value, 3);
    bb_paper_number(r, e.low, 3);
    bb_paper_number(r, e.high, 3);
}

static void add_ratios(const bb_dynamic *d, bb_dynamic_scene scene, bb_dynamic_method method,
                       bb_dynamic_method base, const bb_dynamic_factors *paper, bb_reproduction *r)
{
    const bb_dynamic_factors none = {NAN, NAN, NAN};
    paper = paper != NULL ? paper : &none;
    bb_paper_row(r);
    bb_paper_text(r, bb_dynamic_scenes[scene].name);
    const bool small = method == BB_DYNAMIC_REFIT;
    bb_paper_text(r, small ? small_methods[BB_DYNAMIC_SMALL_REFITTED].name : methods[method].name);
    bb_paper_text(r, small ? small_methods[BB_DYNAMIC_SMALL_REBUILT].name : methods[base].name);
    bb_paper_number(r, paper->update, 3);
    add_estimate(r, bb_dynamic_ratio(d, scene, BB_ANIMATE_UPDATE, method, base));
    bb_paper_number(r, paper->trace, 3);
    add_estimate(r, bb_dynamic_ratio(d, scene, BB_ANIMATE_TRACE, method, base));
    bb_paper_number(r, paper->total, 3);
    add_estimate(r, bb_dynamic_ratio(d, scene, BB_ANIMATE_UPDATE | BB_ANIMATE_TRACE, method, base));
}

/* The paper's pairings come first, with its figures; then like against like. */
static void add_table_1(const bb_dynamic *d, bb_reproduction *r)
{
    static const char *const columns[] = {
        "in place of", "method",    "faster than", "update, paper",
        "here",        "95 % from", "to",          "trace, paper",
        "here",        "95 % from", "to",          "both, paper",
        "here",        "95 % from", "to",          NULL};
    bb_paper_table_begin(
        r,
        "Table 1: how many times as fast as a rebuild: update, tracing, and both (first the "
        "paper's pairing, then both shuffled, or neither)",
        columns);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        const bb_dynamic_scene scene = (bb_dynamic_scene)s;
        const bb_dynamic_about *about = &bb_dynamic_scenes[s];
        add_ratios(d, scene, BB_DYNAMIC_UPDATED_SHUFFLED, BB_DYNAMIC_REBUILT, &about->updated, r);
        add_ratios(d, scene, BB_DYNAMIC_UPDATED_SHUFFLED, BB_DYNAMIC_REBUILT_SHUFFLED, NULL, r);
        add_ratios(d, scene, BB_DYNAMIC_UPDATED, BB_DYNAMIC_REBUILT, NULL, r);
        add_ratios(d, scene, BB_DYNAMIC_LOOSE, BB_DYNAMIC_REBUILT, &about->loose, r);
        add_ratios(d, scene, BB_DYNAMIC_LOOSE, BB_DYNAMIC_REBUILT_SHUFFLED, NULL, r);
        add_ratios(d, scene, BB_DYNAMIC_LOOSE_CUBE, BB_DYNAMIC_REBUILT, NULL, r);
        add_ratios(d, scene, BB_DYNAMIC_LOOSE_NOW, BB_DYNAMIC_LBVH, NULL, r);
        add_ratios(d, scene, BB_DYNAMIC_REFIT, BB_DYNAMIC_LBVH, NULL, r);
        add_ratios(d, scene, BB_DYNAMIC_LBVH, BB_DYNAMIC_REBUILT, NULL, r);
    }
}

static void add_method(const bb_animate_result *result, uint32_t m, const char *scene,
                       const char *name, bb_reproduction *r)
{
    const bb_animate_method *method = &result->methods[m];
    const bool whole = method->refused[0] == '\0';
    const bb_animate_sums sums = bb_animate_sum(result, method);
    bb_paper_row(r);
    bb_paper_text(r, scene);
    bb_paper_text(r, name);
    bb_paper_number(r, frame_ms(result, method, BB_ANIMATE_UPDATE), 3);
    bb_paper_number(r, frame_ms(result, method, BB_ANIMATE_TRACE), 3);
    bb_paper_number(r, frame_ms(result, method, BB_ANIMATE_UPDATE | BB_ANIMATE_TRACE), 3);
    bb_paper_number(r, frame_ms(result, method, BB_ANIMATE_TRANSFER), 3);
    bb_paper_number(r, frame_ms(result, method, BB_ANIMATE_LAYOUT), 3);
    bb_paper_number(r, whole ? sums.sah_mean : (double)NAN, 3);
    bb_paper_number(r, whole ? sums.sah_most : (double)NAN, 3);
    bb_paper_number(r, events_of(method, "reinserted"), 0);
    bb_paper_number(r, events_of(method, "thinned"), 0);
    bb_paper_number(r, (double)sums.checked, 0);
    bb_paper_number(r, (double)sums.wrong, 0);
    bb_paper_text(r, method->refused);
}

static void add_methods(const bb_dynamic *d, bb_reproduction *r)
{
    static const char *const columns[] = {"in place of", "method",      "update ms", "trace ms",
                                          "both ms",     "transfer ms", "layout ms", "SAH/best",
                                          "at worst",    "inserted",    "thinned",   "judged",
                                          "wrong",       "refused",     NULL};
    bb_paper_table_begin(
        r,
        "A frame of each method, and its tree's cost over the least of one made for the frame "
        "(transfer and layout are of this bench; the paper has none); small: in pictures of an "
        "eighth of the side",
        columns);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        const char *scene = bb_dynamic_scenes[s].name;
        for (uint32_t m = 0; m < BB_DYNAMIC_METHODS; m++)
            add_method(&d->scenes[s], m, scene, methods[m].name, r);
        for (uint32_t m = 0; m < BB_DYNAMIC_SMALL_METHODS; m++)
            add_method(&d->small[s], m, scene, small_methods[m].name, r);
    }
}

static void add_scenes(const bb_dynamic *d, bb_reproduction *r)
{
    static const char *const columns[] = {"in place of", "scene",  "triangles", "paper",
                                          "frames",      "moved",  "picture",   "primary",
                                          "diffuse",     "rounds", "s",         NULL};
    bb_paper_table_begin(r, "What was traced: means per frame", columns);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        const bb_animate_result *result = &d->scenes[s];
        char picture[48];
        double rays[2] = {0};
        for (uint32_t f = 1; f < result->frame_count; f++)
            for (int i = 0; i < 2; i++)
                rays[i] += (double)result->states[f].rays[i] / (result->frame_count - 1);
        snprintf(picture, sizeof picture, "%ux%u", d->width[s], d->height[s]);
        bb_paper_row(r);
        bb_paper_text(r, bb_dynamic_scenes[s].name);
        bb_paper_text(r, result->scene);
        bb_paper_number(r, result->states[0].prims, 0);
        bb_paper_number(r, bb_dynamic_scenes[s].prims, 0);
        bb_paper_number(r, result->frame_count, 0);
        bb_paper_number(r, bb_dynamic_events(d, (bb_dynamic_scene)s, BB_DYNAMIC_UPDATED, "moved"),
                        0);
        bb_paper_text(r, picture);
        bb_paper_number(r, rays[0], 0);
        bb_paper_number(r, rays[1], 0);
        bb_paper_number(r, result->rounds, 0);
        bb_paper_number(r, (result->ms + d->small[s].ms) / 1e3, 1);
    }
}

static void evaluate(const bb_findings *findings, const void *measured, bb_reproduction *r)
{
    (void)findings;
    if (measured == NULL)
        return;
    add_scenes(measured, r);
    add_table_1(measured, r);
    add_methods(measured, r);
    bb_dynamic_claims(measured, r);
}

extern const bb_paper bb_paper_dynamic;
const bb_paper bb_paper_dynamic = {
    .name = "dynamic",
    .title = "Eisemann, Grosch, Mueller, Magnor 2007: Automatic Creation of Object Hierarchies for "
             "Ray Tracing of Dynamic Scenes",
    .experiments = experiments,
    .builders = "gs,loose-bvh,lbvh,lbvh+refit",
    .measure = measure,
    .release = release,
    .evaluate = evaluate,
};
