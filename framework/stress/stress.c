#include "framework/stress/stress.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/progress.h"
#include "framework/bench/bench.h"
#include "framework/device/device.h"
#include "framework/judge/oracle.h"
#include "framework/picture/picture.h"
#include "framework/scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

static const char *part_word(bb_method_part part)
{
    return part == BB_A_BUILDER ? "builder" : part == BB_A_KERNEL ? "kernel" : "intersector";
}

/* ---- before anything runs ---- */

/* As the point's comparisons will ask, one name of each kind at a time. */
static bb_status check_names(char *builder, char *kernel, char *intersector, char **rays,
                             uint32_t ray_count)
{
    const bb_bench_request request = {.builders = &builder,
                                      .builder_count = builder != NULL,
                                      .kernels = &kernel,
                                      .kernel_count = kernel != NULL,
                                      .intersectors = &intersector,
                                      .intersector_count = intersector != NULL,
                                      .workloads = rays,
                                      .workload_count = ray_count,
                                      .max_rays = 1};
    return bb_bench_check(&request);
}

static bb_status check_axis(bb_axis *axis)
{
    char text[2 * BB_AXIS_TEXT], rays[BB_AXIS_RAYS_MAX][2 * BB_AXIS_TEXT];
    char *list[BB_AXIS_RAYS_MAX];
    BB_TRY(bb_axis_fill(axis->scene, axis->from, axis->quick_n, text, sizeof text));
    for (uint32_t i = 0; i < axis->ray_count; i++) {
        list[i] = rays[i];
        BB_TRY(bb_axis_fill(axis->rays[i], axis->from, axis->quick_n, rays[i], sizeof rays[i]));
    }
    bb_status status = check_names(axis->builder, axis->kernel, NULL, list, axis->ray_count);
    bb_scene *scene = NULL;
    char reason[1024];
    if (status == BB_OK) /* where all is to be normal, there must be a scene */
        status = bb_scene_load(text, &scene);
    bb_scene_free(scene);
    snprintf(reason, sizeof reason, "%s", bb_message());
    return status == BB_OK ? BB_OK : bb_fail(status, "axis %s: %s", axis->name, reason);
}

static bb_status check_methods(const bb_stress_request *request)
{
    if (request->method_count == 0 || request->method_count > BB_METHODS_MAX)
        return bb_fail(BB_INVALID, "stress: %u methods, must be 1 to %d: choose some",
                       request->method_count, BB_METHODS_MAX);
    for (uint32_t m = 0; m < request->method_count; m++) {
        char *text = (char *)request->methods[m].text;
        bb_method_part part = request->methods[m].part;
        BB_TRY(check_names(part == BB_A_BUILDER ? text : NULL, part == BB_A_KERNEL ? text : NULL,
                           part == BB_AN_INTERSECTOR ? text : NULL, NULL, 0));
    }
    return BB_OK;
}

bb_status bb_stress_check(const bb_stress_request *request)
{
    char names[BB_STRESS_AXES_MAX][64];
    if (request->axis_count == 0 || request->axis_count > BB_STRESS_AXES_MAX)
        return bb_fail(BB_INVALID, "stress: %u axes, must be 1 to %d", request->axis_count,
                       BB_STRESS_AXES_MAX);
    BB_TRY(check_methods(request));
    for (uint32_t i = 0; i < request->axis_count; i++) {
        bb_axis axis;
        bb_status status = bb_axis_load(request->axes[i], &axis);
        if (status == BB_OK)
            status = check_axis(&axis);
        snprintf(names[i], sizeof names[i], "%s", axis.name);
        bb_axis_free(&axis);
        BB_TRY(status);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(names[k], names[i]) == 0)
                return bb_fail(BB_INVALID, "stress: two axes are called %s: drop one", names[i]);
    }
    return BB_OK;
}

/* ---- the device ---- */

/* Opened in a child of its own, so that what is wrong with it is said once, before all. */
static int try_device(void *user)
{
    const bb_stress_request *request = user;
    bb_device *device = NULL;
    bb_status status = request->open_device(request->user, &device);
    if (status == BB_OK)
        fprintf(stderr, "%s, %s, %s\n", device->name, device->driver, device->version);
    else
        fprintf(stderr, "%s\n", bb_message());
    return status != BB_OK;
}

/* What the device calls itself goes into `identity`: points of another are not taken over. */
static bb_status check_device(const bb_stress_request *request, const char *folder,
                              uint64_t *identity)
{
    char log[1200], words[256], line[512] = "";
    bb_child_end end;
    const bb_child_limits limits = {300, request->limits.megabytes};
    snprintf(log, sizeof log, "%s/log-%ld.txt", folder, (long)getpid());
    BB_TRY(bb_child_run(try_device, (void *)request, &limits, log, &end, words, sizeof words));
    FILE *file = fopen(log, "r");
    if (file != NULL) {
        if (fgets(line, sizeof line, file) == NULL)
            line[0] = '\0';
        fclose(file);
    }
    unlink(log);
    line[strcspn(line, "\n")] = '\0';
    bb_clean_text(line);
    *identity = XXH3_64bits_withSeed(line, strlen(line), request->identity);
    if (end == BB_CHILD_DONE || end == BB_CHILD_INTERRUPTED)
        return BB_OK;
    return end == BB_CHILD_GAVE_UP && line[0] != '\0'
               ? bb_fail(BB_INVALID, "%s", line)
               : bb_fail(BB_FAILED, "the device cannot be opened: %s", words);
}

/* ---- pictures ---- */

enum { PICTURE_SIDE = 256 };

typedef struct picture {
    char scene[2 * BB_AXIS_TEXT], path[1200];
} picture;

static int make_picture(void *user)
{
    const picture *p = user;
    bb_scene *scene = NULL;
    bb_oracle *oracle = NULL;
    bb_status status = bb_scene_load(p->scene, &scene);
    if (status == BB_OK)
        status = bb_oracle_create(scene, 1, &oracle);
    if (status == BB_OK)
        status =
            bb_picture_write(scene, oracle, &scene->views[0], PICTURE_SIDE, PICTURE_SIDE, p->path);
    if (status != BB_OK)
        fprintf(stderr, "%s\n", bb_message());
    return status != BB_OK;
}

/* The value at which most methods fail for the first time; NAN if none does. */
static double most_failing(const bb_stress_axis *a, uint32_t method_count)
{
    double best = NAN;
    uint32_t most = 0;
    for (uint32_t i = 0; i < a->search.probe_count; i++) {
        uint32_t count = 0;
        for (uint32_t m = 0; m < method_count; m++)
            for (uint32_t f = 0; f < BB_MANNERS; f++) {
                const bb_threshold *t = &a->search.thresholds[m][f];
                count += t->found && !t->from_start && f != BB_MANNER_REFUSED &&
                         t->at == a->search.probes[i].x;
            }
        if (count > most) {
            most = count;
            best = a->search.probes[i].x;
        }
    }
    return best;
}

/* A scene of which no picture can be made, such as one that is refused, has none. */
static bb_status add_picture(const bb_stress_request *request, bb_stress_axis *a)
{
    picture p;
    char log[1200], words[256];
    bb_child_end end;
    a->picture_at = most_failing(a, request->method_count);
    if (isnan(a->picture_at) || !request->pictures || bb_interrupted())
        return BB_OK;
    BB_TRY(bb_axis_fill(a->axis.scene, a->picture_at, a->n, p.scene, sizeof p.scene));
    snprintf(a->picture, sizeof a->picture, "stress-%s.png", a->axis.name);
    snprintf(p.path, sizeof p.path, "%s/%s", request->folder, a->picture);
    snprintf(log, sizeof log, "%s/points/log-%ld.txt", request->folder, (long)getpid());
    BB_TRY(bb_child_run(make_picture, &p, &request->limits, log, &end, words, sizeof words));
    unlink(log);
    if (end != BB_CHILD_DONE)
        a->picture[0] = '\0';
    return BB_OK;
}

/* ---- all axes ---- */

typedef struct watched {
    bb_points points;
    bb_progress *progress;
} watched;

static bb_status measure(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    watched *w = user;
    bb_progress_step(w->progress);
    return bb_point_measure(&w->points, wishes, count, again);
}

static bb_status search_axis(bb_stress *s, bb_stress_axis *a, const char *points,
                             bb_progress *progress)
{
    const bb_stress_request *r = s->request;
    const uint32_t quick_intervals = a->axis.intervals < 2 ? a->axis.intervals : 2;
    a->n = r->quick ? a->axis.quick_n : a->axis.n;
    watched w = {.progress = progress,
                 .points = {.axis = &a->axis,
                            .methods = r->methods,
                            .method_count = r->method_count,
                            .n = a->n,
                            .max_rays = s->max_rays,
                            .repeats = s->repeats,
                            .seed = r->seed,
                            .limits = r->limits,
                            .folder = points,
                            .identity = s->identity,
                            .open_device = r->open_device,
                            .user = r->user}};
    a->search = (bb_search){.axis = &a->axis,
                            .method_count = r->method_count,
                            .intervals = r->quick ? quick_intervals : a->axis.intervals,
                            .bisections = s->bisections,
                            .times = !r->quick,
                            .measure = measure,
                            .user = &w};
    bb_progress_stage(progress, (1 + a->search.times) * (1 + a->search.bisections), "%s",
                      a->axis.name);
    bb_progress_weigh(progress, 1);
    bb_status status = bb_search_run(&a->search);
    snprintf(a->mishap, sizeof a->mishap, "%s", w.points.mishap);
    s->measured += w.points.measured;
    s->taken_over += w.points.taken_over;
    if (w.points.device[0] != '\0') {
        snprintf(s->device, sizeof s->device, "%s", w.points.device);
        snprintf(s->driver, sizeof s->driver, "%s", w.points.driver);
    }
    if (status == BB_OK)
        status = add_picture(r, a);
    a->complete = !bb_interrupted();
    return status;
}

static void choose_effort(bb_stress *s)
{
    const bool quick = s->request->quick;
    s->max_rays = quick ? 1024 : 4096;
    s->repeats = quick ? 1 : 3;
    s->bisections = quick ? 0 : 5;
}

bb_status bb_stress_run(const bb_stress_request *request, bb_stress *out)
{
    char points[1100];
    memset(out, 0, sizeof *out);
    out->request = request;
    choose_effort(out);
    double start = bb_wall_ms();
    snprintf(points, sizeof points, "%s/points", request->folder);
    if (mkdir(points, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "cannot make the folder %s: %s", points, strerror(errno));
    out->axes = calloc(request->axis_count, sizeof *out->axes);
    if (out->axes == NULL)
        return bb_fail(BB_FAILED, "stress: no memory");
    BB_TRY(check_device(request, points, &out->identity));
    bb_progress progress;
    bb_progress_start(&progress, request->quiet);
    bb_progress_plan(&progress, request->axis_count);
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < request->axis_count && status == BB_OK && !bb_interrupted(); i++) {
        bb_stress_axis *a = &out->axes[i];
        status = bb_axis_load(request->axes[i], &a->axis);
        out->axis_count++;
        if (status == BB_OK)
            status = search_axis(out, a, points, &progress);
    }
    bb_progress_end(&progress);
    out->ms = bb_wall_ms() - start;
    return status;
}

void bb_stress_free(bb_stress *stress)
{
    for (uint32_t i = 0; i < stress->axis_count; i++) {
        bb_search_free(&stress->axes[i].search);
        bb_axis_free(&stress->axes[i].axis);
    }
    free(stress->axes);
    stress->axes = NULL;
}

/* ---- what is a bug ---- */

static bool is_bug(const bb_stress_axis *a, const bb_method *method, bb_manner manner,
                   const bb_figures *f)
{
    switch (manner) {
    case BB_MANNER_CRASHED:
    case BB_MANNER_HUNG:
    case BB_MANNER_MEMORY:
    case BB_MANNER_FAILED:
        return true;
    case BB_MANNER_WRONG: /* a stack that overflowed says so: no silence */
        return method->exact && a->axis.known[0] == '\0' && !(f->overflowed > 0);
    default:
        return false;
    }
}

static void tell(FILE *out, const bb_stress_axis *a, const bb_method *method, double x,
                 const char *what, const char *reason)
{
    if (out != NULL)
        fprintf(out, "bvhbench: %s %s %s on %s at %.9g%s%s\n", part_word(method->part),
                method->text, what, a->axis.name, x, reason[0] != '\0' ? ": " : "", reason);
}

/* Answers that no judge finds wrong, and that are yet unlike those of another exact cell: told
 * where nothing exact is wrong, since else it is not known whom to blame. */
static uint32_t blame_unlike(const bb_stress *s, const bb_stress_axis *a, FILE *out)
{
    for (uint32_t p = 0; p < a->search.probe_count; p++) {
        const bb_figures *f = a->search.probes[p].figures;
        uint32_t unlike = 0, wrong = 0, last = 0;
        for (uint32_t m = 0; m < s->request->method_count; m++) {
            if (!s->request->methods[m].exact || f[m].outcome != BB_MEASURED)
                continue;
            wrong += f[m].wrong > 0 || f[m].overflowed > 0;
            unlike += f[m].unlike > 0;
            last = f[m].unlike > 0 ? m : last;
        }
        if (unlike > 0 && wrong == 0) {
            tell(out, a, &s->request->methods[last], a->search.probes[p].x,
                 "answers unlike another method that must be exact", "");
            return 1;
        }
    }
    return 0;
}

uint32_t bb_stress_blame(const bb_stress *s, FILE *out)
{
    uint32_t bugs = 0;
    for (uint32_t i = 0; i < s->axis_count; i++) {
        const char *mishap = s->axes[i].mishap;
        bugs += (mishap[0] != '\0') + blame_unlike(s, &s->axes[i], out);
        if (mishap[0] != '\0' && out != NULL)
            fprintf(out, "bvhbench: %s; none does so by itself\n", mishap);
    }
    for (uint32_t i = 0; i < s->axis_count; i++)
        for (uint32_t m = 0; m < s->request->method_count; m++) {
            const bb_stress_axis *a = &s->axes[i];
            const bb_method *method = &s->request->methods[m];
            uint32_t verdicts = 0;
            bool told[BB_MANNERS] = {false};
            for (uint32_t p = 0; p < a->search.probe_count; p++) {
                const bb_figures *f = &a->search.probes[p].figures[m];
                verdicts += f->outcome != BB_NOT_MEASURED;
                for (uint32_t k = 0; k < BB_MANNERS; k++)
                    if (!told[k] && !bb_manners[k].relative &&
                        bb_manner_shows((bb_manner)k, f, f) && is_bug(a, method, (bb_manner)k, f)) {
                        told[k] = true;
                        bugs++;
                        tell(out, a, method, a->search.probes[p].x, bb_manners[k].word, f->reason);
                    }
            }
            if (verdicts == 0 && a->complete) {
                bugs++;
                tell(out, a, method, a->axis.from, "has no verdict", "");
            }
        }
    return bugs;
}
