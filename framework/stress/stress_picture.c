/* Makes a picture of each axis at the value at which most methods begin to fail. */
#include "framework/stress/stress_private.h"

#include "framework/base/interrupt.h"
#include "framework/judge/oracle.h"
#include "framework/picture/picture.h"
#include "framework/scene/scene.h"

#include <math.h>

enum { PICTURE_SIDE = 256 };

typedef struct picture {
    char scene[2 * BB_AXIS_TEXT], path[1200];
    uint32_t frames; /* the last is shown */
} picture;

static int make_picture(void *user)
{
    const picture *p = user;
    bb_scene *scene = NULL;
    bb_oracle *oracle = NULL;
    bb_status status = bb_scene_load(p->scene, &scene);
    if (status == BB_OK && p->frames > 0)
        status = bb_scene_set_frame(
            scene, (p->frames < scene->frame_count ? p->frames : scene->frame_count) - 1, NULL);
    if (status == BB_OK)
        status = bb_oracle_create(scene, 1, &oracle);
    if (status == BB_OK)
        status =
            bb_picture_write(scene, oracle, &scene->views[0], PICTURE_SIDE, PICTURE_SIDE, p->path);
    if (status != BB_OK)
        fprintf(stderr, "%s\n", bb_message());
    return status != BB_OK;
}

/* Returns the value at which most methods begin to fail; NAN: none fails. */
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

bb_status bb_stress_picture(const bb_stress_request *request, bb_stress_axis *axis)
{
    picture p;
    bb_child_report report;
    axis->picture_at = most_failing(axis, request->method_count);
    if (isnan(axis->picture_at) || !request->pictures || bb_interrupted())
        return BB_OK;
    BB_TRY(bb_axis_fill(axis->axis.scene, axis->picture_at, axis->n, p.scene, sizeof p.scene));
    p.frames = axis->axis.frames;
    snprintf(axis->picture, sizeof axis->picture, "stress-%s.png", axis->axis.name);
    snprintf(p.path, sizeof p.path, "%s/%s", request->folder, axis->picture);
    BB_TRY(bb_child_run(make_picture, &p, &request->limits, &report));
    if (report.end != BB_CHILD_DONE)
        axis->picture[0] = '\0';
    return BB_OK;
}
