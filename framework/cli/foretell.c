#include "framework/cli/foretell.h"

#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/base/number.h"
#include "framework/bench/forecast.h"
#include "framework/builder/guard.h"
#include "framework/builder/idle.h"
#include "framework/device/device_private.h"
#include "framework/stress/child.h"

#include <stdio.h>
#include <string.h>

enum { SECONDS = 600 }; /* that a forecast may take */

typedef struct task {
    const bb_foretelling *what;
    const char *scene;
} task;

static const char takes[] = "takes about ", not_foretold[] = "is not foretold";

/* Prints the forecast, or why there is none. Runs in a child, whose end frees all. */
static int foretell(void *user)
{
    const task *t = user;
    const bb_bench_request *chosen;
    bb_device *device = NULL;
    bb_scene *scene = NULL;
    bb_forecast forecast;
    char time[BB_TIME_TEXT];
    bb_guard_detach();
    if (bb_scene_load(t->scene, &scene) != BB_OK || !bb_bench_can_be_foretold(scene) ||
        t->what->choose(t->what->user, &chosen) != BB_OK ||
        bb_open_device(t->what->device, &device) != BB_OK || !device->is_cpu ||
        bb_scene_has_room(scene, device) != BB_OK)
        return 0; /* a refusal is left to the comparison itself */
    bb_bench_request request = *chosen;
    request.device = device;
    if (bb_bench_forecast(&request, scene, t->scene, &forecast) != BB_OK) {
        printf("%s: %s\n", not_foretold, bb_message());
        return 0;
    }
    const double gb = forecast.bytes / 1e9, most = (double)bb_host_most();
    printf("%s%s and %.*f GB of memory%s\n", takes, bb_time_words(forecast.seconds, time),
           gb < 10 ? 1 : 0, gb,
           forecast.bytes <= most ? ""
                                  : ", more than there is: trees are built again in their turns, "
                                    "and Embree's rows give way");
    return 0;
}

static bool begins_with(const char *text, const char *begin)
{
    return strncmp(text, begin, strlen(begin)) == 0;
}

static void foretell_scene(const bb_foretelling *what, const char *scene)
{
    const bb_child_limits limits = {SECONDS, bb_memory_limit() >> 20};
    task t = {what, scene};
    bb_child_report report;
    if (bb_child_run(foretell, &t, &limits, &report) != BB_OK)
        return; /* no process can be started */
    if (report.end != BB_CHILD_DONE && report.end != BB_CHILD_INTERRUPTED)
        fprintf(stderr, "%s: %s: the small comparison ended: %s\n", scene, not_foretold,
                report.words);
    else if (begins_with(report.said, takes) || begins_with(report.said, not_foretold))
        fprintf(stderr, "%s: %s\n", scene, report.said);
}

/* A plug-in's threads do not survive a fork either. */
static bool has_threads(void)
{
    bb_idle threads;
    bb_idle_take(&threads);
    return threads.count > 1;
}

void bb_foretell(const bb_foretelling *what)
{
    for (size_t i = 0; i < what->scenes->count && !has_threads(); i++)
        if (!bb_guard_said()) /* by a process before this one, which died */
            foretell_scene(what, what->scenes->items[i]);
}
