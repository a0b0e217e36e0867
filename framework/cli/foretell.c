#include "framework/cli/foretell.h"

#include "framework/base/clock.h"
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
    bb_bench_request request; /* whose pointers are the child's */
    char why_not[512];
} prediction;

typedef struct task {
    const bb_foretelling *what;
    const char *scene;
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
    bb_guard_detach();
    p->is_refused = bb_scene_load(t->scene, &scene) != BB_OK ||
                    t->what->choose(t->what->user, &chosen) != BB_OK ||
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
    task t = {what, scene, p};
    bb_child_report report;
    memset(p, 0, sizeof *p);
    if (bb_child_run(predict, &t, &limits, &report) != BB_OK) {
        snprintf(p->why_not, sizeof p->why_not, "%s", bb_message());
    } else if (report.end != BB_CHILD_DONE) {
        p->is_made = false;
        p->is_large = report.end != BB_CHILD_INTERRUPTED;
        snprintf(p->why_not, sizeof p->why_not, "the small comparison ended: %s", report.words);
    }
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

/* Says what a thrift leaves out of a request. */
static void say_thrift(const bb_bench_request *request, uint32_t thrift, double seconds)
{
    const bb_bench_request less = bb_bench_thrifty(request, thrift);
    char time[BB_TIME_TEXT];
    fprintf(stderr, "takes about %s", bb_time_words(seconds, time));
    if (thrift > 0)
        fprintf(stderr, " with pictures of %ux%u, at most %u rays in other sets", less.width,
                less.height, less.max_rays);
    if (less.max_views != request->max_views)
        fprintf(stderr, ", one view");
    if (less.repeats != request->repeats)
        fprintf(stderr, ", %u rounds", less.repeats);
    fprintf(stderr, "\n");
}

/* seconds[]: of all scenes, by thrift. */
static bb_status keep_time(const bb_foretelling *what, const bb_bench_request *request,
                           const double seconds[BB_THRIFTS], uint32_t *thrift)
{
    const double left = (what->ends_ms - bb_wall_ms()) / 1e3;
    char least[BB_TIME_TEXT], given[BB_TIME_TEXT];
    for (*thrift = 0; *thrift < BB_THRIFTS; ++*thrift)
        if (seconds[*thrift] <= left * (1 - reserve)) {
            say_thrift(request, *thrift, seconds[*thrift]);
            return BB_OK;
        }
    return bb_fail(BB_REFUSED,
                   "--time: with the fewest rays, views and rounds it still takes about %s, and "
                   "%s of the time are left: give more time, fewer builders or smaller scenes",
                   bb_time_words(seconds[BB_THRIFTS - 1], least), bb_time_words(left, given));
}

static bb_status foretell(const bb_foretelling *what, prediction *p, uint32_t *thrift)
{
    double seconds[BB_THRIFTS] = {0};
    bb_bench_request request = {0};
    for (size_t i = 0; i < what->scenes->count && !bb_interrupted(); i++) {
        const char *scene = what->scenes->items[i];
        if (!has_threads() && !bb_guard_said()) /* by a process before this one, which died */
            predict_scene(what, scene, p);
        else
            snprintf(p->why_not, sizeof p->why_not, "a plug-in has threads, or a builder died");
        if (what->ends_ms == 0)
            continue;
        if (bb_interrupted())
            return BB_OK;
        if (p->is_refused) /* at once, not when its turn comes */
            return bb_fail(BB_REFUSED, "%s", p->why_not);
        if (!p->is_made)
            return bb_fail(BB_REFUSED, "--time: %s cannot be foretold: %s: leave out --time", scene,
                           p->why_not);
        request = p->request;
        for (uint32_t t = 0; t < BB_THRIFTS; t++)
            seconds[t] += p->forecast.seconds[t];
    }
    return what->ends_ms > 0 ? keep_time(what, &request, seconds, thrift) : BB_OK;
}

bb_status bb_foretell(const bb_foretelling *what, uint32_t *thrift)
{
    *thrift = 0;
    prediction *shared =
        mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED)
        return bb_fail(BB_REFUSED, "no memory to share with the process that foretells");
    memset(shared, 0, sizeof *shared);
    const bb_status status = foretell(what, shared, thrift);
    (void)munmap(shared, sizeof *shared);
    return status;
}
