/* Pictures of tetrahedra, by trees that say which of them holds a sample. */
#include "framework/dvr/dvr_private.h"
#include "framework/march/tet_march.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct tet_renderer {
    bb_scene *scene;
    const bb_transfer *transfer;
    bb_tet_marcher *marcher;
} tet_renderer;

const bb_option bb_dvr_search_options[] = {
    {"interval", "yes", "yes|no", "only where cells of the boundary say that a ray may be inside"},
    {.name = NULL},
};

bb_status bb_dvr_search_parse(const char *text, bb_spec *spec)
{
    BB_TRY(bb_spec_parse(text, spec));
    if (strcmp(spec->name, "skip") == 0)
        return bb_spec_validate(spec, NULL, "search skip");
    if (strcmp(spec->name, "octree") == 0)
        return bb_spec_validate(spec, bb_dvr_search_options, "search octree");
    return bb_fail(BB_INVALID, "there is no search '%s': take skip or octree", spec->name);
}

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

static bb_status make(void *opaque, const char *text, bb_tree *tree, bb_dvr_runner *runner)
{
    tet_renderer *self = opaque;
    bb_spec spec;
    BB_TRY(bb_dvr_search_parse(text, &spec));
    runner->leaf = 1;
    runner->interval = strcmp(spec.name, "octree") == 0 &&
                       bb_spec_is(&spec, bb_dvr_search_options, "interval", "yes");
    BB_TRY(bb_layout_maker_create(bb_layout_find(spec.name), self->scene->on_device.device,
                                  &runner->maker));
    return bb_layout_maker_make(&runner->maker, self->scene, tree, 1, BB_FORMAT_VERTICES,
                                &runner->layout);
}

static bb_status set(void *opaque, const bb_march_settings *settings)
{
    tet_renderer *self = opaque;
    return bb_tet_marcher_set(self->marcher, settings, self->transfer);
}

static bb_status launch(void *opaque, const bb_dvr_runner *runner, bb_dvr_pictures *p,
                        bool counting)
{
    tet_renderer *self = opaque;
    const bb_tet_way way = {runner->maker.layout, &runner->layout, runner->interval};
    return bb_tet_march(self->marcher, &way, &p->rays.on_device, p->pixels, &p->lights,
                        counting ? &p->counts : NULL);
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
