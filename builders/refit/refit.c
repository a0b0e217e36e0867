/* refit: keeps another builder's tree while primitives move: `lbvh+refit`, `sah+refit:rotate=yes`.
 *
 * build() copies the tree. update() gives its nodes new boxes, bottom-up, on the device
 * (builders/common/refit.h). With rotate=yes it also applies at most one rotation per node on the
 * way up (turns.cl), in every update or, with pause=N, in every (N + 1)-th. With a trigger update()
 * gives up when the tree has become too bad, and the harness builds it again:
 *
 *   sah:F    the tree's SAH is more than F times its SAH when built: never, if that was the worst
 *            possible, with everything at one place
 *   ratio:F  the mean over all inner nodes of area / (area of both children) has risen by more than
 *            F: Lauterbach, Yoon, Tuft, Manocha 2006 (RT-DEFORM)
 *   every:N  at each N-th update
 *
 * The values for a trigger are summed up in the refit's pass. With partial=F parts of the tree that
 * have become F times worse are rebuilt in place (parts.h).
 */
#include "builders/common/refit.h"
#include "framework/builder/builder.h"
#include "parts.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const bb_option options[] = {
    {"rotate", "no", "no|yes", "rotate each node at most once in an update, where that helps"},
    {"pause", "0", NULL,
     "updates without rotations after each one with rotations, 0 to 1000: layouts follow them in "
     "place"},
    {"trigger", "none", NULL,
     "when to build again: none, sah:F (SAH F times that of the build), ratio:F, every:N"},
    {"partial", "none", NULL,
     "none, or F, from 1: rebuild in place each part of the tree whose share of the SAH is F times "
     "what it was when the part was built"},
    {.name = NULL},
};

typedef enum refit_trigger { NEVER, BY_SAH, BY_RATIO, BY_COUNT } refit_trigger;

typedef struct refit {
    bb_device *device;
    bb_account *account;
    refit_trigger trigger;
    double limit;
    bb_refitter *refitter; /* without books and parts */
    bb_turner turner;      /* with books */
    bb_parts parts;        /* if its factor is not 0 */
    bb_turn_totals built;
    uint64_t pause;   /* updates between two that rotate */
    uint32_t updates; /* number since the build */
} refit;

static void destroy(void *opaque)
{
    refit *self = opaque;
    if (self == NULL)
        return;
    bb_refitter_destroy(self->refitter);
    bb_turner_release(&self->turner);
    bb_parts_release(&self->parts);
    free(self);
}

/* ---- options ---- */

static bb_status read_trigger(const bb_spec *spec, refit *self)
{
    static const struct {
        const char *name;
        refit_trigger trigger;
        double low;
    } kinds[] = {{"sah:", BY_SAH, 1}, {"ratio:", BY_RATIO, 0}, {"every:", BY_COUNT, 1}};
    const char *text = bb_spec_value(spec, options, "trigger");
    if (strcmp(text, "none") == 0)
        return BB_OK;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        size_t length = strlen(kinds[i].name);
        char *end;
        if (strncmp(text, kinds[i].name, length) != 0)
            continue;
        self->trigger = kinds[i].trigger;
        self->limit = strtod(text + length, &end);
        const bool whole = self->trigger == BY_COUNT;
        if (end != text + length && *end == '\0' && self->limit >= kinds[i].low &&
            self->limit <= 1e9 && (!whole || self->limit == floor(self->limit)))
            return BB_OK;
        return bb_fail(BB_INVALID,
                       "builder refit: trigger '%s': a %snumber of %g to 1e9 has to follow", text,
                       whole ? "whole " : "", kinds[i].low);
    }
    return bb_fail(BB_INVALID,
                   "builder refit: trigger '%s' is none of none, sah:F, ratio:F, every:N", text);
}

/* Books of the tree are kept for rotations, and for a trigger that reads them. */
static bool keeps_books(const refit *self)
{
    return self->turner.rotates || self->trigger == BY_SAH || self->trigger == BY_RATIO;
}

static bool goes_by_parts(const refit *self)
{
    return self->parts.factor != 0;
}

static bb_status read_partial(const bb_spec *spec, refit *self)
{
    if (bb_spec_is(spec, options, "partial", "none"))
        return BB_OK;
    BB_TRY(bb_spec_double(spec, options, "partial", 1, 1e9, &self->parts.factor));
    if (keeps_books(self))
        return bb_fail(BB_INVALID, "builder refit: partial takes neither rotations nor the "
                                   "triggers sah and ratio: leave one of them out");
    return BB_OK;
}

static bb_status read_rotations(const bb_spec *spec, refit *self)
{
    self->turner.rotates = bb_spec_is(spec, options, "rotate", "yes");
    BB_TRY(bb_spec_u64(spec, options, "pause", 0, 1000, &self->pause));
    if (self->pause > 0 && !self->turner.rotates)
        return bb_fail(BB_INVALID, "builder refit: pause is between rotations: give rotate=yes");
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    refit *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    BB_TRY(read_trigger(context->spec, self));
    self->turner = (bb_turner){.device = self->device,
                               .account = self->account,
                               .costs = self->trigger == BY_SAH,
                               .spreads = self->trigger == BY_RATIO};
    BB_TRY(read_rotations(context->spec, self));
    BB_TRY(read_partial(context->spec, self));
    if (keeps_books(self))
        return bb_turner_create(&self->turner);
    self->parts.device = self->device;
    self->parts.account = self->account;
    if (goes_by_parts(self))
        return bb_parts_create(&self->parts);
    return bb_refitter_create(self->device, self->account, &self->refitter);
}

/* ---- the hooks ---- */

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    refit *self = opaque;
    const bb_tree_info *info = &input->info;
    uint32_t count = info->node_count;
    bool binary = keeps_books(self) || goes_by_parts(self);
    if (binary && (info->arity > 2 || count != 2 * info->leaf_count - 1))
        return bb_fail(BB_UNSUPPORTED,
                       "refit with rotate, partial or a trigger takes binary trees, and this one "
                       "has nodes of another number of children than two");
    if (binary && input->duplicated)
        return bb_fail(BB_UNSUPPORTED, "refit: the tree has duplicated references, whose boxes do "
                                       "not follow from the primitives'");
    BB_TRY(bb_phase(phases, "copy"));
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_DEVICE, count, info->ref_count));
    BB_TRY(bb_buffer_copy(&input->d_nodes, &tree->d_nodes, count * sizeof(bb_node)));
    BB_TRY(bb_buffer_copy(&input->d_refs, &tree->d_refs, info->ref_count * sizeof(uint32_t)));
    BB_TRY(bb_buffer_write(&tree->d_info, 0, sizeof *info, info));
    tree->info = *info;
    tree->duplicated = input->duplicated;
    tree->disjoint = input->disjoint;
    tree->keep_nodes = input->keep_nodes;
    self->updates = 0;
    if (keeps_books(self)) {
        BB_TRY(bb_phase(phases, "plan"));
        BB_TRY(bb_turner_plan(&self->turner, tree));
        if (self->trigger != BY_SAH && self->trigger != BY_RATIO)
            return bb_phase(phases, NULL);
        BB_TRY(bb_phase(phases, "books"));
        BB_TRY(bb_turner_pass(&self->turner, &scene->on_device.boxes, false, tree));
        self->built = self->turner.totals;
    } else if (goes_by_parts(self)) {
        BB_TRY(bb_phase(phases, "plan"));
        BB_TRY(bb_parts_plan(&self->parts, &scene->on_device.boxes, tree));
    } else {
        BB_TRY(bb_phase(phases, "plan"));
        BB_TRY(bb_refit_plan(self->refitter, tree));
    }
    return bb_phase(phases, NULL);
}

/* Returns whether the trigger says to build the tree again. */
static bool is_worn(const refit *self, const bb_tree *tree)
{
    const bb_turn_totals *now = &self->turner.totals;
    double inner = tree->info.leaf_count - 1.0;
    switch (self->trigger) {
    case BY_SAH:
        return (double)now->cost * self->built.area > self->limit * self->built.cost * now->area;
    case BY_RATIO:
        return (double)now->spread - self->built.spread > self->limit * inner;
    case BY_COUNT:
        return self->updates >= self->limit;
    case NEVER:
        break;
    }
    return false;
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    refit *self = opaque;
    if (changed != BB_CHANGED_POSITIONS)
        return bb_fail(BB_UNSUPPORTED, "refit: there are other primitives than before");
    self->updates++;
    if (self->trigger == BY_COUNT && is_worn(self, tree))
        return bb_fail(BB_UNSUPPORTED, "refit: its time has come");
    BB_TRY(bb_phase(phases, "refit"));
    if (goes_by_parts(self)) {
        uint32_t rebuilt;
        BB_TRY(bb_parts_update(&self->parts, &scene->on_device.boxes, tree, &rebuilt));
        BB_TRY(bb_event(phases, "rebuilt", rebuilt));
    } else if (!keeps_books(self))
        BB_TRY(bb_refit_device(self->refitter, &scene->on_device.boxes, tree));
    else {
        bool turns = self->turner.rotates && self->updates % (self->pause + 1) == 0;
        BB_TRY(bb_turner_pass(&self->turner, &scene->on_device.boxes, turns, tree));
        BB_TRY(bb_event(phases, "rotated", self->turner.totals.turned));
        if (is_worn(self, tree))
            return bb_fail(BB_UNSUPPORTED, "refit: the tree has become too bad");
    }
    return bb_phase(phases, NULL);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_STRESSED,
     "lbvh+refit:rotate=yes,lbvh+refit:partial=1.3,lbvh+refit:trigger=sah:1.3"},
    {BB_FOR_ALL, BB_ROLE_MOVING,
     "lbvh+refit,lbvh+refit:rotate=yes,lbvh+refit:trigger=sah:1.3,sah+refit"},
    {0},
};

const bb_builder bb_builder_refit = {
    .abi_version = BB_ABI_VERSION,
    .name = "refit",
    .summary = "optimiser for moving scenes: keeps the tree and gives its nodes new boxes, with "
               "rotations, parts built again, or a trigger to build all again",
    .paper = "Terdiman 2001; Wald, Boulos, Shirley 2007; rotations: Kopta et al. 2012; trigger: "
             "Lauterbach et al. 2006",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_TREE | BB_INPUT_BOXES,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .build = build,
    .update = update,
    .destroy = destroy,
};
