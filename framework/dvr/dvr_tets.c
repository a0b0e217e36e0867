/* Pictures of tetrahedra, by trees that say which of them holds a sample. */
#include "framework/contest/tet_runner.h"
#include "framework/dvr/dvr_private.h"
#include "framework/march/tet_march.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct tet_renderer {
    bb_scene *scene;
    const bb_transfer *transfer;
    bb_tet_marcher *marcher;
} tet_renderer;

static void describe(const void *opaque, bb_dvr_result *result)
{
    const tet_renderer *self = opaque;
    const bb_scene *scene = self->scene;
    snprintf(result->transfer, sizeof result->transfer, "%s", self->transfer->name);
    snprintf(result->field, sizeof result->field, "%s", scene->tets->field_name);
    result->tets = scene->prims[BB_TETRAHEDRON].count;
    result->vertices = scene->vertex_count;
    result->boundary = scene->tets->boundary_count;
}

static bb_status make(void *opaque, const char *search, bb_tree *const *trees,
                      bb_contest_runner *runner)
{
    tet_renderer *self = opaque;
    return bb_tet_runner_make(&self->scene, 1, search, trees, runner);
}

static bb_status set(void *opaque, const bb_march_settings *settings)
{
    tet_renderer *self = opaque;
    return bb_tet_marcher_set(self->marcher, settings, self->transfer);
}

static bb_status launch(void *opaque, const bb_contest_runner *runner, bb_dvr_pictures *p,
                        bool counting)
{
    tet_renderer *self = opaque;
    bb_tet_search search;
    BB_TRY(bb_tet_runner_search(runner, self->scene, 0, NULL, &search));
    return bb_tet_march(self->marcher, &search, runner->by_boundary, &p->rays.on_device, p->pixels,
                        &p->lights, counting ? &p->counts : NULL);
}

static void destroy(void *opaque)
{
    tet_renderer *self = opaque;
    if (self == NULL)
        return;
    bb_tet_marcher_destroy(self->marcher);
    free(self);
}

bb_status bb_dvr_render_tets(const bb_dvr_request *request, bb_scene *scene,
                             bb_dvr_renderer *renderer)
{
    tet_renderer *self = calloc(1, sizeof *self);
    *renderer = (bb_dvr_renderer){.self = self,
                                  .unit = bb_tet_march_width(scene),
                                  .describe = describe,
                                  .make = make,
                                  .set = set,
                                  .launch = launch,
                                  .destroy = destroy};
    if (self == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    self->scene = scene;
    self->transfer = request->transfer;
    return bb_tet_marcher_create(scene, NULL, &self->marcher);
}
