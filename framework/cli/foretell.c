#include "framework/cli/foretell.h"

#include "framework/base/interrupt.h"
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/base/number.h"
#include "framework/bench/forecast.h"
#include "framework/device/device_private.h"
#include "framework/stress/child.h"

#include <stdio.h>

enum { SECONDS = 600 }; /* that a forecast may take */

typedef struct task {
    const bb_device_choice *device;
    const bb_bench_request *request;
    const char *scene;
} task;

/* Prints the forecast, or why there is none; nothing for a scene that cannot be loaded, which the
 * comparison says. Runs in a child, whose end frees all. */
static int foretell(void *user)
{
    const task *t = user;
    bb_bench_request request = *t->request;
    bb_scene *scene = NULL;
    bb_forecast forecast;
    char time[BB_TIME_TEXT];
    if (bb_scene_load(t->scene, &scene) != BB_OK || !bb_bench_can_be_foretold(scene))
        return 0;
    bb_status status = bb_open_device(t->device, &request.device);
    if (status == BB_OK && !request.device->is_cpu)
        return 0;
    if (status == BB_OK)
        status = bb_bench_forecast(&request, scene, t->scene, &forecast);
    if (status != BB_OK) {
        printf("is not foretold: %s\n", bb_message());
        return 1;
    }
    const double gb = forecast.bytes / 1e9, most = (double)bb_host_most();
    printf("takes about %s and %.*f GB of memory%s\n", bb_time_words(forecast.seconds, time),
           gb < 10 ? 1 : 0, gb,
           forecast.bytes <= most ? ""
                                  : ", more than there is: trees are built again in their turns, "
                                    "and Embree's rows give way");
    return 0;
}

void bb_foretell(const bb_device_choice *device, const bb_bench_request *request)
{
    const bb_child_limits limits = {SECONDS, bb_memory_limit() >> 20};
    for (uint32_t i = 0; i < request->scene_count && !bb_interrupted(); i++) {
        task t = {device, request, request->scenes[i]};
        bb_child_report report;
        if (bb_child_run(foretell, &t, &limits, &report) != BB_OK)
            return; /* no process can be started */
        if (report.end == BB_CHILD_DONE || report.end == BB_CHILD_GAVE_UP) {
            if (report.said[0] != '\0')
                fprintf(stderr, "%s: %s\n", t.scene, report.said);
        } else if (report.end != BB_CHILD_INTERRUPTED) {
            fprintf(stderr, "%s: is not foretold: the small comparison ended: %s\n", t.scene,
                    report.words);
        }
    }
}
