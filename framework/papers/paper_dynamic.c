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
#include "framework/papers/dynamic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    BOUNCES = 65536,
    SMALLER = 8, /* sides of pictures for refitted trees */
    QUICK_FRAMES = 4,
    QUICK_WIDTH = 64,
    QUICK_HEIGHT = 48,
};

#define GS "gs:max_children=0" /* the paper has no limit */
#define LOOSE_OF_PAPER "loose-bvh:levels=6,deeper=0"

#define METHOD(name_, builder_) .name = name_, .builder = name_, .note = builder_
const bb_paper_entrant bb_dynamic_methods[] = {
    {METHOD(REBUILT, GS ",update=rebuild,order=file")},
    {METHOD(REBUILT_SHUFFLED, GS ",update=rebuild,order=shuffled")},
    {METHOD(UPDATED, GS ",order=file")},
    {METHOD(UPDATED_SHUFFLED, GS ",order=shuffled")},
    {METHOD(COLLECTIONS, GS ",order=file,objects=collections")},
    {METHOD(LISTED, GS ",order=file,objects=collections,moved=listed")},
    {METHOD(LOOSE, "loose-bvh-array")},
    {METHOD(LOOSE_SORTED, LOOSE_OF_PAPER ",root=box")},
    {METHOD(LOOSE_CUBE, LOOSE_OF_PAPER ",root=cube")},
    {METHOD(LOOSE_NOW, "loose-bvh")},
    {METHOD(LBVH, "lbvh")},
    {METHOD(SMALL_REBUILT, "lbvh")},
    {METHOD(SMALL_REFITTED, "lbvh+refit")},
    {.name = NULL},
};

const bb_dynamic_about bb_dynamic_scenes[BB_DYNAMIC_SCENES] = {
    [BB_DYNAMIC_KITCHEN] = {"kitchen", NULL, 110000, 300, 225},
    [BB_DYNAMIC_MUSEUM] = {"museum (flow)", "crowd:kind=flow", 76000, 800, 640},
    [BB_DYNAMIC_TWIST] = {"museum (twist)", "twist:seed=1", 76000, 800, 640},
    [BB_DYNAMIC_FALL] = {"falling triangles", "crowd:kind=fall", 149000, 512, 512},
};

/* ---- measuring ---- */

static void name_scene(const bb_reproduce_request *request, bb_dynamic_scene scene, char *out,
                       size_t capacity)
{
    const uint32_t frames = request->quick ? QUICK_FRAMES : BB_DYNAMIC_FRAMES;
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
}

/* All methods, or refitted trees beside rebuilt ones in small pictures. */
static bb_status animate(const bb_reproduce_request *request, bb_scene *scene, bb_dynamic_scene at,
                         bool small, bb_table *table, bool *wrong)
{
    static const char *const kernels[] = {"stack"};
    static const char *const rays[] = {"primary", "diffuse:per_hit=1"};
    const uint32_t first = small ? BB_DYNAMIC_METHODS : 0, scale = small ? SMALLER : 1;
    const char *builders[BB_DYNAMIC_METHODS];
    bb_animate_result result = {.rounds = 0};
    const bb_animate_request wanted = {
        .device = request->device,
        .builders = builders,
        .builder_count = small ? BB_DYNAMIC_SMALL_METHODS : BB_DYNAMIC_METHODS,
        .kernels = kernels,
        .kernel_count = 1,
        .rays = rays,
        .ray_count = 2,
        .intersector = "exact",
        .width = (request->quick ? QUICK_WIDTH : bb_dynamic_scenes[at].width) / scale,
        .height = (request->quick ? QUICK_HEIGHT : bb_dynamic_scenes[at].height) / scale,
        .max_rays = BOUNCES / (scale * scale),
        .last = UINT32_MAX,
        .repeats = bb_paper_rounds(request, 7),
        .seed = request->seed,
        .quiet = request->quiet,
        .audit = request->audit,
        .watch = request->watch,
    };
    for (uint32_t m = 0; m < wanted.builder_count; m++)
        builders[m] = bb_dynamic_methods[first + m].note;
    const bb_status status = bb_animate_run(&wanted, scene, &result);
    if (status == BB_OK)
        bb_dynamic_add(table, at, &result, first, wanted.width, wanted.height);
    *wrong = *wrong || bb_animate_wrong(&result) > 0 || bb_animate_failed(&result) > 0;
    bb_animate_release(&result);
    return status;
}

static bb_status load_and_animate(const bb_reproduce_request *request, bb_dynamic_scene at,
                                  bb_findings *f, bool *wrong)
{
    char name[640];
    bb_scene *scene;
    BB_TRY(bb_paper_add_scene(f, bb_dynamic_scenes[at].name));
    name_scene(request, at, name, sizeof name);
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = bb_scene_upload(scene, request->device);
    for (int small = 0; small < 2 && status == BB_OK; small++)
        status = animate(request, scene, at, small == 1, f->table, wrong);
    bb_traversers_clear(request->device);
    bb_scene_free(scene);
    return status;
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

static bb_status measure(const bb_reproduce_request *request, bb_findings *f, bool *wrong)
{
    BB_TRY(check_room(request));
    if (request->repeats >= BB_ANIMATE_ROUNDS_MAX)
        return bb_fail(BB_INVALID, "--repeats: at most %d of sequences", BB_ANIMATE_ROUNDS_MAX - 1);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++)
        BB_TRY(load_and_animate(request, (bb_dynamic_scene)s, f, wrong));
    return BB_OK;
}

/* ---- what was measured, as rows ---- */

/* Of a method: sums over all frames but the first. */
static const struct {
    uint32_t part;
    bb_column column;
} parts[] = {
    {BB_ANIMATE_UPDATE, BB_FOUND_ROUNDS("update_ms", "Updates.")},
    {BB_ANIMATE_TRACE, BB_FOUND_ROUNDS("trace_ms", "Tracing.")},
    {BB_ANIMATE_TRANSFER, BB_FOUND_ROUNDS("transfer_ms", "Transfers of trees.")},
    {BB_ANIMATE_LAYOUT, BB_FOUND_ROUNDS("layout_ms", "Making layouts.")},
};
static const bb_column frames = BB_FOUND_NUMBER("frames", "Frames but the first."),
                       sah_mean =
                           BB_FOUND_NUMBER("sah_mean", "Cost over the best made for the frame."),
                       sah_most = BB_FOUND_NUMBER("sah_most", "The same at worst."),
                       judged = BB_FOUND_NUMBER("judged", "Rays that were judged."),
                       wrong_rays = BB_FOUND_NUMBER("wrong", "Rays that were wrong."),
                       refused = BB_FOUND_TEXT("refused", "Why there are no figures.");
static const bb_column unevenness = {.name = "unevenness",
                                     .heading = "unevenness",
                                     .unit = "",
                                     .help = "The longest update, by its median, over the mean.",
                                     .kind = BB_COLUMN_ROUNDS,
                                     .sense = BB_SENSE_TIMED};
/* Means per frame. */
static const bb_column events[] = {
    BB_FOUND_NUMBER("moved", "Objects that moved."),
    BB_FOUND_NUMBER("reinserted", "Objects that were inserted again."),
    BB_FOUND_NUMBER("thinned", "Nodes that were thinned.")};
/* Of a scene; rays are means per frame. */
static const bb_column prims = BB_FOUND_NUMBER("prims", "Triangles."),
                       all_frames = BB_FOUND_NUMBER("all_frames", "Frames."),
                       primary = BB_FOUND_NUMBER("primary", "Primary rays."),
                       diffuse = BB_FOUND_NUMBER("diffuse", "Diffuse rays."),
                       rounds = BB_FOUND_NUMBER("rounds", "Rounds that count."),
                       seconds = BB_FOUND_NUMBER("seconds", "All measurements, in s."),
                       own_name = BB_FOUND_TEXT("name", "The scene."),
                       picture = BB_FOUND_TEXT("picture", "Width and height.");

/* 0 if the builder counts no such. */
static double events_of(const bb_animate_method *m, const char *event)
{
    double sum = 0;
    for (uint32_t f = 1; f < m->done; f++)
        for (uint32_t e = 0; e < m->frames[f].event_count; e++)
            if (strcmp(m->frames[f].events[e], event) == 0)
                sum += (double)m->frames[f].event_numbers[e];
    return m->done > 1 ? sum / (m->done - 1) : 0;
}

static bb_samples unevenness_of(const bb_animate_result *result, const bb_animate_method *method,
                                const bb_animate_sums *sums)
{
    const bb_samples all = bb_animate_samples(result, method, 0, BB_ANIMATE_UPDATE);
    bb_samples over = {.count = 0};
    for (uint32_t f = 1; f < method->done; f++)
        if (result->states[f].frame == sums->worst_frame)
            for (uint32_t r = 0; r < all.count; r++)
                bb_samples_add(&over, method->frames[f].update[r] * sums->frames / all.values[r]);
    return over;
}

static void add_method(bb_table *table, uint32_t row, const bb_animate_result *result,
                       const bb_animate_method *method)
{
    const bb_animate_sums sums = bb_animate_sum(result, method);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const bb_samples samples = bb_animate_samples(result, method, 0, parts[i].part);
        bb_table_set_rounds(table, row, &parts[i].column, &samples);
    }
    for (size_t i = 0; i < sizeof events / sizeof events[0]; i++)
        bb_table_set_number(table, row, &events[i], events_of(method, events[i].name));
    bb_table_set_number(table, row, &frames, result->frame_count - 1);
    bb_table_set_number(table, row, &judged, (double)sums.checked);
    bb_table_set_number(table, row, &wrong_rays, (double)sums.wrong);
    bb_table_set_text(table, row, &refused, method->refused);
    if (method->refused[0] != '\0')
        return;
    bb_table_set_number(table, row, &sah_mean, sums.sah_mean);
    bb_table_set_number(table, row, &sah_most, sums.sah_most);
    const bb_samples uneven = unevenness_of(result, method, &sums);
    bb_table_set_rounds(table, row, &unevenness, &uneven);
}

/* Figure 7: update and tracing frame by frame, as views of the scene. */
static void add_frames(bb_table *table, bb_cell cell, const bb_animate_result *result,
                       const bb_animate_method *method)
{
    static const bb_column update = BB_FOUND_ROUNDS("frame_update_ms", "Update of a frame."),
                           trace = BB_FOUND_ROUNDS("frame_trace_ms", "Tracing of a frame.");
    for (uint32_t f = 1; f < method->done; f++) {
        const bb_animate_frame *frame = &method->frames[f];
        bb_samples updates = {.count = 0}, traces = {.count = 0};
        char name[32];
        for (uint32_t r = 0; r <= result->rounds; r++) {
            double ms = 0;
            for (uint32_t k = 0; k < result->ray_count; k++)
                ms += frame->traces[0].rays[k][r];
            bb_samples_add(&updates, frame->update[r]);
            bb_samples_add(&traces, ms);
        }
        snprintf(name, sizeof name, "frame %u", result->states[f].frame);
        cell.names[BB_FRAME] = name;
        (void)bb_table_row(table,
                           (bb_cell){{[BB_SCENE] = cell.names[BB_SCENE], [BB_FRAME] = name}});
        const uint32_t row = bb_table_row(table, cell);
        bb_table_set_rounds(table, row, &update, &updates);
        bb_table_set_rounds(table, row, &trace, &traces);
    }
}

static void add_scene(bb_table *table, uint32_t row, const bb_animate_result *result,
                      uint32_t width, uint32_t height)
{
    char size[48];
    double rays[2] = {0};
    for (uint32_t f = 1; f < result->frame_count; f++)
        for (int i = 0; i < 2; i++)
            rays[i] += (double)result->states[f].rays[i] / (result->frame_count - 1);
    snprintf(size, sizeof size, "%ux%u", width, height);
    bb_table_set_text(table, row, &own_name, result->scene);
    bb_table_set_text(table, row, &picture, size);
    bb_table_set_number(table, row, &prims, result->states[0].prims);
    bb_table_set_number(table, row, &all_frames, result->frame_count);
    bb_table_set_number(table, row, &primary, rays[0]);
    bb_table_set_number(table, row, &diffuse, rays[1]);
    bb_table_set_number(table, row, &rounds, result->rounds);
}

void bb_dynamic_add(bb_table *table, bb_dynamic_scene at, const bb_animate_result *result,
                    uint32_t first, uint32_t width, uint32_t height)
{
    bb_cell cell = {{[BB_SCENE] = bb_dynamic_scenes[at].name}};
    const uint32_t row = bb_table_row(table, cell);
    const double before = bb_table_get_number(table, row, seconds.name);
    if (first == 0)
        add_scene(table, row, result, width, height);
    bb_table_set_number(table, row, &seconds, result->ms / 1e3 + (isnan(before) ? 0 : before));
    for (uint32_t m = 0; m < result->method_count; m++) {
        cell.names[BB_BUILDER] = bb_dynamic_methods[first + m].name;
        add_method(table, bb_table_row(table, cell), result, &result->methods[m]);
        if (first == 0)
            add_frames(table, cell, result, &result->methods[m]);
    }
}

extern const bb_paper bb_paper_dynamic;
const bb_paper bb_paper_dynamic = {
    .name = "dynamic",
    .title = "Eisemann, Grosch, Mueller, Magnor 2007: Automatic Creation of Object Hierarchies for "
             "Ray Tracing of Dynamic Scenes",
    .builders = "gs,loose-bvh,loose-bvh-array,lbvh,lbvh+refit",
    .measure = measure,
    .tables = bb_dynamic_tables,
    .claims = {bb_dynamic_claims},
};
