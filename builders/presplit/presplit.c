/* presplit: a splitter, which makes references of primitives by one of two methods.
 *
 *   priority   distributes splits by priority, at planes of the Morton grid, on the device
 *              (presplit_priority.c, presplit.cl): Karras, Aila 2013
 *   esc        halves the largest boxes first, on the host (presplit_esc.c): Ernst, Greiner 2007
 *
 * `method` chooses. With `auto`, giving `beta` selects `priority`, otherwise `esc` is used.
 * `saves`, an addition of ours, is an option of both methods; `beta` belongs to `priority` alone,
 * `budget` and `above` to `esc`. On devices with memory of their own `esc` reads the scene back;
 * this is part of its time.
 *
 * The papers' texts were not at hand: `priority` was made from published code, and derived again.
 */
#include "framework/builder/builder.h"
#include "presplit_esc.h"
#include "presplit_priority.h"

#include <stdio.h>
#include <stdlib.h>

static const bb_option options[] = {
    {"method", "auto", "auto|priority|esc",
     "Karras and Aila's or early split clipping; auto: priority if beta is given, else esc"},
    {"beta", NULL, NULL, "priority: most splits per primitive of the scene, 0 to 15; default: 0.3"},
    {"budget", "1.5", NULL, "esc: most references per primitive of the scene, 1 to 16"},
    {"above", "0.5", NULL,
     "esc: smallest box to split: its area, relative to the mean of all boxes, 0 to 1e9"},
    {"saves", "0.3", NULL,
     "least share of a box's area that a split must save, -1 to 0.9; -1: any split is made; "
     "priority: applies only to a triangle's first split"},
    {.name = NULL},
};

typedef struct presplit {
    ps_priority *priority; /* the chosen method; the other is NULL */
    ps_esc *esc;
    uint32_t prims, references; /* of the last build */
} presplit;

static void destroy(void *opaque)
{
    presplit *self = opaque;
    if (self == NULL)
        return;
    ps_priority_destroy(self->priority);
    ps_esc_destroy(self->esc);
    free(self);
}

/* Chooses by whether `beta` is given. `beta` has no default for this reason, and because its value
 * is part of a cell's key. Options of the other method are refused, since they would have no
 * effect. */
static bb_status choose_method(const bb_spec *spec, bool *esc)
{
    const bool beta = bb_spec_value(spec, NULL, "beta") != NULL;
    const bool budget = bb_spec_value(spec, NULL, "budget") != NULL;
    const bool above = bb_spec_value(spec, NULL, "above") != NULL;
    *esc = bb_spec_is(spec, options, "method", "esc") ||
           (bb_spec_is(spec, options, "method", "auto") && !beta);
    if (*esc ? !beta : !budget && !above)
        return BB_OK;
    return bb_fail(BB_INVALID, "%s: option '%s' is not of the method '%s': leave it out",
                   spec->text,
                   *esc     ? "beta"
                   : budget ? "budget"
                            : "above",
                   *esc ? "esc" : "priority");
}

static bb_status create(const bb_builder_context *context, void **out)
{
    const bb_spec *spec = context->spec;
    ps_esc_limits limits;
    double beta = 0.3;
    bool esc;
    BB_TRY(choose_method(spec, &esc));
    if (bb_spec_value(spec, NULL, "beta") != NULL)
        BB_TRY(bb_spec_double(spec, options, "beta", 0, 15, &beta));
    BB_TRY(bb_spec_double(spec, options, "budget", 1, 16, &limits.budget));
    BB_TRY(bb_spec_double(spec, options, "above", 0, 1e9, &limits.above));
    BB_TRY(bb_spec_double(spec, options, "saves", -1, 0.9, &limits.saves));
    presplit *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    if (esc)
        return ps_esc_create(context->account, limits, &self->esc);
    return ps_priority_create(context, beta, limits.saves, &self->priority);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    (void)tree;
    presplit *self = opaque;
    return self->esc != NULL ? ps_esc_prepare(self->esc, scene)
                             : ps_priority_prepare(self->priority, scene);
}

/* A buffer that stays mapped while a method on the host reads it. Unused if there are no
 * vertices. */
typedef struct mapping {
    const bb_buffer *buffer;
    void *memory;
} mapping;

static bb_status split_on_host(ps_esc *esc, const bb_scene *scene, bb_references *references,
                               bb_phases *phases)
{
    const bb_scene_device *there = &scene->on_device;
    mapping mapped[] = {{&there->boxes, NULL}, {&there->prims, NULL}, {&there->vertices, NULL}};
    enum { MAPPED = sizeof mapped / sizeof mapped[0] };
    bb_status status = bb_phase(phases, "areas");
    for (int i = 0; i < MAPPED && status == BB_OK; i++)
        if (mapped[i].buffer->mem != NULL)
            status = bb_buffer_map(mapped[i].buffer, false, &mapped[i].memory);
    if (status == BB_OK) {
        bb_scene here = *scene;
        here.boxes = mapped[0].memory;
        here.prims[BB_TRIANGLE].data = mapped[1].memory; /* triangles come first */
        here.vertices = mapped[2].memory;
        status = ps_esc_split(esc, &here, references, phases);
    }
    for (int i = 0; i < MAPPED; i++)
        if (mapped[i].memory != NULL) {
            bb_status unmapped = bb_buffer_unmap(mapped[i].buffer, mapped[i].memory);
            status = status == BB_OK ? unmapped : status;
        }
    return status;
}

static bb_status split(void *opaque, const bb_scene *scene, bb_references *references,
                       bb_phases *phases)
{
    presplit *self = opaque;
    self->prims = scene->prim_count;
    if (self->esc != NULL)
        BB_TRY(split_on_host(self->esc, scene, references, phases));
    else
        BB_TRY(ps_priority_split(self->priority, scene, references, phases));
    self->references = references->count;
    return bb_event(phases, "splits", references->count - scene->prim_count);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const presplit *self = opaque;
    snprintf(text, capacity, "%u references to %u primitives, by %s", self->references, self->prims,
             self->esc != NULL ? "early split clipping" : "priority");
    return BB_OK;
}

const bb_builder bb_builder_presplit = {
    .abi_version = BB_ABI_VERSION,
    .name = "presplit",
    .summary = "splitter: splits large boxes and clips the parts to their primitives",
    .paper = "Karras, Aila 2013 (priority); Ernst, Greiner 2007 (esc)",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_GEOMETRY,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = BB_NO_VARIANTS,
    .create = create,
    .prepare = prepare,
    .split = split,
    .describe = describe,
    .destroy = destroy,
};
