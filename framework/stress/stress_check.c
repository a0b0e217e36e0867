/* Checks axes, methods and the device before anything runs. */
#include "framework/stress/stress_private.h"

#include "framework/base/identity.h"
#include "framework/builder/instance.h"
#include "framework/builder/tracers.h"
#include "framework/record/cell.h"
#include "framework/scene/scene.h"
#include "framework/stress/point_private.h"

#include <string.h>

/* ---- axes and methods ---- */

/* Loads the scene of the normal case in a child. If the child dies, the atlas will show it. */
typedef struct first_scene {
    const char *name;
    uint32_t frames;
} first_scene;

static int load_scene(void *user)
{
    const first_scene *first = user;
    bb_scene *scene = NULL;
    bb_status status = bb_scene_load(first->name, &scene);
    if (status == BB_OK && scene->frame_count < first->frames)
        status = bb_fail(BB_INVALID, "%s has %u frames, not the %u of the axis", scene->name,
                         scene->frame_count, first->frames);
    if (status == BB_OK)
        return 0;
    fprintf(stderr, "%s\n", bb_message());
    return 1;
}

static bb_status check_scene(const bb_stress_request *request, const char *scene, uint32_t frames)
{
    bb_child_report report;
    first_scene first = {scene, frames};
    BB_TRY(bb_child_run(load_scene, &first, &request->limits, &report));
    return report.end == BB_CHILD_GAVE_UP ? bb_fail(BB_INVALID, "%s", report.said) : BB_OK;
}

static bb_status check_axis(const bb_stress_request *request, const bb_axis *axis)
{
    bb_points points = bb_stress_points(request, axis);
    points.n = axis->quick_n;
    bool wanted[BB_METHODS_MAX];
    char reason[1024];
    bb_point_request asked;
    memset(wanted, true, sizeof wanted);
    bb_status status = bb_point_request_make(&points, axis->from, wanted, &asked);
    if (status == BB_OK)
        status = bb_bench_check(&asked.bench);
    if (status == BB_OK)
        status = check_scene(request, asked.scene, axis->frames);
    snprintf(reason, sizeof reason, "%s", bb_message());
    return status == BB_OK ? BB_OK : bb_fail(status, "axis %s: %s", axis->name, reason);
}

bb_status bb_stress_check(const bb_stress_request *request)
{
    char names[BB_STRESS_AXES_MAX][64];
    if (request->axis_count == 0 || request->axis_count > BB_STRESS_AXES_MAX)
        return bb_fail(BB_INVALID, "stress: %u axes, must be 1 to %d", request->axis_count,
                       BB_STRESS_AXES_MAX);
    if (request->method_count == 0 || request->method_count > BB_METHODS_MAX)
        return bb_fail(BB_INVALID, "stress: %u methods, must be 1 to %d: choose some",
                       request->method_count, BB_METHODS_MAX);
    for (uint32_t i = 0; i < request->axis_count; i++) {
        bb_axis axis;
        bb_status status = bb_axis_load(request->axes[i], &axis);
        if (status == BB_OK)
            status = check_axis(request, &axis);
        snprintf(names[i], sizeof names[i], "%s", axis.name);
        bb_axis_free(&axis);
        BB_TRY(status);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(names[k], names[i]) == 0)
                return bb_fail(BB_INVALID, "stress: two axes are called %s: drop one", names[i]);
    }
    return BB_OK;
}

/* ---- the device, and parameters of builders ---- */

static int open_device(void *user)
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

bb_status bb_stress_identify(const bb_stress_request *request, uint64_t *hash)
{
    bb_child_report report;
    const bb_child_limits limits = {300, request->limits.megabytes};
    BB_TRY(bb_child_run(open_device, (void *)request, &limits, &report));
    if (report.end != BB_CHILD_DONE && report.end != BB_CHILD_INTERRUPTED)
        return report.end == BB_CHILD_GAVE_UP && report.said[0] != '\0'
                   ? bb_fail(BB_INVALID, "%s", report.said)
                   : bb_fail(BB_FAILED, "the device cannot be opened: %s%s", report.words,
                             report.end == BB_CHILD_FLOODED ? ": give it more (--memory)" : "");
    bb_identity *identity = bb_identity_begin();
    bb_identity_add(identity, &request->identity, sizeof request->identity);
    bb_identity_add_text(identity, report.said);
    return bb_identity_end(identity, "stress", hash);
}

/* Refuses parameters out of range, which are bad input and no weak spot. */
static int try_builders(void *user)
{
    const bb_stress_request *request = user;
    bb_device *device = NULL;
    bb_status status = request->open_device(request->user, &device);
    for (uint32_t i = 0; i < request->method_count && status == BB_OK; i++) {
        const bb_method *method = &request->methods[i];
        bb_child_alive();
        if (method->part == BB_A_BUILDER && bb_tracer_of(method->text) == NULL)
            status = bb_instance_try(device, method->text, request->seed);
    }
    if (status != BB_OK)
        fprintf(stderr, "%s\n", bb_message());
    return status != BB_OK;
}

/* Runs in a child. If the child dies, the atlas will show it. */
bb_status bb_stress_check_parameters(const bb_stress_request *request)
{
    bb_child_report report;
    BB_TRY(bb_child_run(try_builders, (void *)request, &request->limits, &report));
    return report.end == BB_CHILD_GAVE_UP ? bb_fail(BB_INVALID, "%s", report.said) : BB_OK;
}
