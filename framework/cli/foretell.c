#include "framework/cli/foretell.h"

#include "framework/base/clock.h"
#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/base/number.h"
#include "framework/bench/forecast.h"
#include "framework/builder/guard.h"
#include "framework/builder/idle.h"
#include "framework/device/device_private.h"
#include "framework/stress/child.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

enum { SECONDS = 600 }; /* that a forecast may take */

/* Part of the time that is given away: forecasts have been too short by up to so much. */
static const double reserve = 0.15;

/* What a child finds out about a scene, in memory that both share. */
typedef struct prediction {
    bool is_large, is_made;
    bool is_refused; /* by the comparison itself, later */
    bb_forecast forecast;
    double load_s;
    bb_bench_request request; /* whose pointers are the child's */
    char why_not[512];
} prediction;

typedef struct task {
    const bb_foretelling *what;
    const char *scene;
    const char *pictures; /* folder for small ones */
    prediction *out;
} task;

static const char *why_not(const bb_scene *scene, const bb_device *device)
{
    return !device->is_cpu                    ? "its time on a GPU is not known"
           : scene->volume != NULL            ? "it is a volume"
           : !bb_bench_can_be_foretold(scene) ? "it moves"
                                              : NULL;
}

/* Runs in a child, whose end frees all. */
static int predict(void *user)
{
    const task *t = user;
    prediction *p = t->out;
    const bb_bench_request *chosen;
    bb_device *device = NULL;
    bb_scene *scene = NULL;
    const double start_ms = bb_wall_ms();
    bb_guard_detach();
    p->is_refused = bb_scene_load(t->scene, &scene) != BB_OK;
    p->load_s = (bb_wall_ms() - start_ms) / 1e3;
    p->is_refused = p->is_refused || t->what->choose(t->what->user, &chosen) != BB_OK ||
                    bb_open_device(t->what->device, &device) != BB_OK ||
                    bb_scene_has_room(scene, device) != BB_OK;
    if (p->is_refused) {
        snprintf(p->why_not, sizeof p->why_not, "%s", bb_message());
        return 0;
    }
    const char *why = why_not(scene, device);
    p->is_large = why == NULL && scene->prim_count > BB_FORECAST_PRIMS;
    p->request = *chosen;
    bb_bench_request request = *chosen;
    request.device = device;
    request.picture_folder =
        chosen->picture_folder != NULL && t->pictures[0] != '\0' ? t->pictures : NULL;
    if (why == NULL && (p->is_large || t->what->ends_ms > 0)) {
        p->is_made = bb_bench_forecast(&request, scene, t->scene, &p->forecast) == BB_OK;
        why = bb_message();
    }
    if (!p->is_made)
        snprintf(p->why_not, sizeof p->why_not, "%s", why != NULL ? why : "");
    return 0;
}

static void say(const char *scene, const prediction *p)
{
    char time[BB_TIME_TEXT];
    const double gb = p->forecast.bytes / 1e9;
    if (p->is_large && !p->is_made)
        fprintf(stderr, "%s: is not foretold: %s\n", scene, p->why_not);
    else if (p->is_large)
        fprintf(stderr, "%s: takes about %s and %.*f GB of memory%s\n", scene,
                bb_time_words(p->forecast.seconds[0], time), gb < 10 ? 1 : 0, gb,
                p->forecast.bytes <= (double)bb_host_most()
                    ? ""
                    : ", more than there is: trees are built again in their turns, and Embree's "
                      "rows give way");
}

static void predict_scene(const bb_foretelling *what, const char *scene, prediction *p)
{
    const double left = what->ends_ms > 0 ? (what->ends_ms - bb_wall_ms()) / 1e3 : SECONDS;
    const bb_child_limits limits = {fmin(fmax(left, 1), SECONDS), bb_memory_limit() >> 20};
    char pictures[PATH_MAX] = "";
    task t = {what, scene, pictures, p};
    bb_child_report report;
    memset(p, 0, sizeof *p);
    (void)bb_temporary_folder(pictures); /* without one, pictures are not foretold */
    if (bb_child_run(predict, &t, &limits, &report) != BB_OK) {
        snprintf(p->why_not, sizeof p->why_not, "%s", bb_message());
    } else if (report.end != BB_CHILD_DONE) {
        p->is_made = false;
        p->is_large = report.end != BB_CHILD_INTERRUPTED;
        snprintf(p->why_not, sizeof p->why_not, "the small comparison ended: %s", report.words);
    }
    bb_remove_folder(pictures);
    if (what->ends_ms == 0 || p->is_made) /* else a refusal says it */
        say(scene, p);
}

/* A plug-in's threads do not survive a fork either. */
static bool has_threads(void)
{
    bb_idle threads;
    bb_idle_take(&threads);
    return threads.count > 1;
}

/* ---- keeping a time ---- */

/* What was foretold: a process in which a builder dies leaves it to the next. */
typedef struct outlook {
    bool is_told;
    double seconds[BB_THRIFTS]; /* of all scenes, by thrift */
    bb_bench_request request;   /* whose pointers nobody follows */
} outlook;
_Static_assert(sizeof(outlook) <= BB_GUARD_KEPT, "a process can leave it to the next");

/* Writes what a request has with this thrift, where it is less; "": nowhere. */
static void name_reduced(const bb_bench_request *request, uint32_t thrift, char text[BB_REDUCED])
{
    const bb_bench_request less = bb_bench_thrifty(request, thrift);
    char views[40] = "", rounds[32] = "";
    if (less.max_views != request->max_views)
        snprintf(views, sizeof views, ", one view per scene");
    if (less.repeats != request->repeats)
        snprintf(rounds, sizeof rounds, ", %u rounds", less.repeats);
    text[0] = '\0';
    if (thrift > 0)
        snprintf(text, BB_REDUCED, "pictures of %ux%u, at most %u rays in other sets%s%s",
                 less.width, less.height, less.max_rays, views, rounds);
}

static bb_status keep_time(const outlook *t, double ends_ms, bool again, bb_thrift *thrift)
{
    const double left = (ends_ms - bb_wall_ms()) / 1e3;
    char least[BB_TIME_TEXT], given[BB_TIME_TEXT];
    uint32_t *number = &thrift->number;
    for (*number = 0; *number < BB_THRIFTS; ++*number)
        if (t->seconds[*number] <= left * (1 - reserve))
            break;
    if (*number == BB_THRIFTS && !again)
        return bb_fail(BB_REFUSED,
                       "--time: with the fewest rays, views and rounds it still takes about %s, "
                       "and %s of the time are left: give more time, fewer builders or smaller "
                       "scenes",
                       bb_time_words(t->seconds[BB_THRIFTS - 1], least),
                       bb_time_words(left, given));
    if (*number == BB_THRIFTS) {
        *number = BB_THRIFTS - 1;
        fprintf(stderr, "--time will not be kept, since the work began again: ");
    }
    name_reduced(&t->request, *number, thrift->reduced_to);
    fprintf(stderr, "takes about %s%s%s\n", bb_time_words(t->seconds[*number], least),
            *number > 0 ? " with " : "", thrift->reduced_to);
    return BB_OK;
}

static bb_status foretell(const bb_foretelling *what, prediction *p, outlook *out)
{
    outlook told = {.is_told = true};
    for (size_t i = 0; i < what->scenes->count && !bb_interrupted(); i++) {
        const char *scene = what->scenes->items[i];
        if (!has_threads())
            predict_scene(what, scene, p);
        else
            snprintf(p->why_not, sizeof p->why_not, "a plug-in has threads");
        if (what->ends_ms == 0 || bb_interrupted())
            continue;
        if (p->is_refused) /* at once, not when its turn comes */
            return bb_fail(BB_REFUSED, "%s", p->why_not);
        if (!p->is_made)
            return bb_fail(BB_REFUSED, "--time: %s cannot be foretold: %s: leave out --time", scene,
                           p->why_not);
        told.request = p->request;
        const uint32_t loads = i > 0 ? 2 : 1; /* all are tried first, and the first is kept */
        for (uint32_t t = 0; t < BB_THRIFTS; t++)
            told.seconds[t] += p->forecast.seconds[t] + loads * p->load_s;
    }
    *out = told;
    return BB_OK;
}

bb_status bb_foretell(const bb_foretelling *what, bb_thrift *thrift)
{
    outlook *told = bb_guard_kept();
    const bool again = told->is_told;
    *thrift = (bb_thrift){0};
    if (!again) {
        prediction *shared =
            mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (shared == MAP_FAILED)
            return bb_fail(BB_REFUSED, "no memory to share with the process that foretells");
        const bb_status status = foretell(what, shared, told);
        (void)munmap(shared, sizeof *shared);
        BB_TRY(status);
    }
    return what->ends_ms > 0 && !bb_interrupted() ? keep_time(told, what->ends_ms, again, thrift)
                                                  : BB_OK;
}
