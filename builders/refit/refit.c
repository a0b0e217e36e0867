/* refit: keeps another builder's tree while primitives move: `lbvh+refit`, `sah+refit:rotate=yes`.
 *
 * build() takes the tree as it is. update() gives its nodes new boxes, from the bottom up, on the
 * device (builders/common/refit.h); with rotate=yes it also turns each node once on the way
 * (turns.cl). With a trigger it gives up when the tree has become too bad; then the harness builds
 * it again:
 *
 *   sah:F    the tree's SAH is more than F times what it was when it was built
 *   ratio:F  the mean over all inner nodes of area / (area of both children) has risen by more than
 *            F: Lauterbach, Yoon, Tuft, Manocha 2006 (RT-DEFORM), section 3.2, who take 0.4
 *   every:N  with each N-th update
 *
 * What a trigger needs is summed up in the pass of the refit.
 */
#include "builders/common/refit.h"
#include "builders/refit/turns_shared.h"
#include "framework/builder/builder.h"
#include "framework/device/levels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(turns);

enum { GROUP_SIZE = 64 };

static const bb_option options[] = {
    {"rotate", "no", "no|yes", "rotate each node at most once in each update, where that helps"},
    {"trigger", "none", NULL,
     "when to build again: none, sah:F (SAH F times that of the build), ratio:F, every:N"},
    {.name = NULL},
};

typedef enum refit_trigger { NEVER, BY_SAH, BY_RATIO, BY_COUNT } refit_trigger;

typedef struct refit {
    bb_device *device;
    bb_account *account;
    bool rotates, by_levels;
    refit_trigger trigger;
    double limit;
    bb_refitter *refitter; /* without books; else: */
    cl_program program;
    cl_kernel parents_kernel, climb, leaves, level, skips;
    bb_buffer parents, missing, states;
    bb_levels levels;
    bb_turn_state built, now; /* of the root */
    double built_area, area;
    uint32_t updates; /* since the build */
} refit;

static void destroy(void *opaque)
{
    refit *self = opaque;
    if (self == NULL)
        return;
    bb_refitter_destroy(self->refitter);
    bb_buffer_release(&self->parents);
    bb_buffer_release(&self->missing);
    bb_buffer_release(&self->states);
    bb_levels_release(&self->levels);
    bb_kernel_release(self->parents_kernel);
    bb_kernel_release(self->climb);
    bb_kernel_release(self->leaves);
    bb_kernel_release(self->level);
    bb_kernel_release(self->skips);
    bb_program_release(self->program);
    free(self);
}

/* ---- what was asked for ---- */

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
        if (end != text + length && *end == '\0' && self->limit >= kinds[i].low &&
            self->limit <= 1e9)
            return BB_OK;
        return bb_fail(BB_INVALID,
                       "builder refit: trigger '%s': a number of %g to 1e9 has to follow", text,
                       kinds[i].low);
    }
    return bb_fail(BB_INVALID,
                   "builder refit: trigger '%s' is none of none, sah:F, ratio:F, every:N", text);
}

/* Books are kept of the tree for a trigger by what they say, and by rotations. */
static bool keeps_books(const refit *self)
{
    return self->rotates || self->trigger == BY_SAH || self->trigger == BY_RATIO;
}

static bb_status get_kernels(refit *self)
{
    char handover[96], defines[192];
    bb_handover_defines(self->device, handover, sizeof handover);
    snprintf(defines, sizeof defines, "%s -DBB_TURN_CT=%.9ef -DBB_TURN_CI=%.9ef", handover,
             BB_COST_TRAVERSAL, BB_COST_INTERSECTION);
    BB_TRY(bb_program_build(self->device, &bb_source_turns, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "turn_parents", &self->parents_kernel));
    BB_TRY(bb_kernel_get(self->program, "turn_skips", &self->skips));
    if (!self->by_levels)
        return bb_kernel_get(self->program, "turn_climb", &self->climb);
    BB_TRY(bb_kernel_get(self->program, "turn_leaves", &self->leaves));
    return bb_kernel_get(self->program, "turn_level", &self->level);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    refit *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->by_levels = context->device->handover == BB_HANDOVER_LEVELS;
    self->rotates = bb_spec_is(context->spec, options, "rotate", "yes");
    BB_TRY(read_trigger(context->spec, self));
    if (keeps_books(self))
        return get_kernels(self);
    return bb_refitter_create(self->device, self->account, &self->refitter);
}

/* ---- a pass with books ---- */

static bb_status reserve(refit *self, const bb_tree *tree)
{
    uint32_t nodes = tree->info.node_count;
    size_t bytes = nodes * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(self->device, self->account, bytes, "refit: parents", &self->parents));
    BB_TRY(bb_buffer_reserve(self->device, self->account, bytes, "refit: missing children",
                             &self->missing));
    BB_TRY(bb_buffer_reserve(self->device, self->account, nodes * sizeof(bb_turn_state),
                             "refit: what subtrees cost", &self->states));
    if (!self->by_levels)
        return BB_OK;
    /* rotations may make the tree deeper, and a binary tree has no more levels than leaves */
    return bb_levels_reserve(&self->levels, self->device, self->account, nodes,
                             self->rotates ? tree->info.leaf_count : tree->info.depth,
                             "refit: levels");
}

typedef struct level_job {
    refit *self;
    bb_tree *tree;
    uint32_t turns;
} level_job;

static bb_status do_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    refit *self = job->self;
    return bb_launch(self->device, self->level, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(job->tree->d_nodes), BB_VALUE(job->turns), BB_MEM(self->parents),
                     BB_MEM(self->missing), BB_MEM(self->states), BB_MEM(levels->lists[n % 2]),
                     BB_VALUE(n), BB_MEM(levels->counts), BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status go_up(refit *self, const bb_buffer *boxes, uint32_t turns, bb_tree *tree)
{
    level_job job = {self, tree, turns};
    uint32_t count = tree->info.node_count;
    if (!self->by_levels)
        return bb_launch(self->device, self->climb, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                         BB_MEM(tree->d_refs), BB_MEM(*boxes), BB_VALUE(count), BB_VALUE(turns),
                         BB_MEM(self->parents), BB_MEM(self->missing), BB_MEM(self->states));
    BB_TRY(bb_levels_start(&self->levels));
    BB_TRY(bb_launch(self->device, self->leaves, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_MEM(*boxes), BB_VALUE(count), BB_MEM(self->parents),
                     BB_MEM(self->missing), BB_MEM(self->states), BB_MEM(self->levels.counts),
                     BB_MEM(self->levels.lists[1])));
    return bb_levels_run(&self->levels, do_level, &job);
}

static bb_status pass(refit *self, const bb_buffer *boxes, bool turns, bb_tree *tree)
{
    uint32_t count = tree->info.node_count, root = tree->info.root;
    bb_node top;
    BB_TRY(go_up(self, boxes, turns, tree));
    BB_TRY(bb_buffer_read(&self->states, root * sizeof self->now, sizeof self->now, &self->now));
    BB_TRY(bb_buffer_read(&tree->d_nodes, root * sizeof top, sizeof top, &top));
    self->area = bb_half_area(top.lo, top.hi);
    tree->disjoint = false;
    if (self->now.turned == 0) {
        bb_tree_boxes_changed(tree);
        return BB_OK;
    }
    bb_tree_changed(tree);
    return bb_launch(self->device, self->skips, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_VALUE(root), BB_MEM(self->parents), BB_MEM(self->states),
                     BB_MEM(tree->d_info));
}

/* ---- the hooks ---- */

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    refit *self = opaque;
    const bb_tree_info *info = &input->info;
    uint32_t count = info->node_count;
    if (keeps_books(self) && (info->arity > 2 || count != 2 * info->leaf_count - 1))
        return bb_fail(BB_UNSUPPORTED,
                       "refit with rotate or a trigger takes binary trees, and this one has nodes "
                       "of another number of children than two");
    if (keeps_books(self) && input->duplicated)
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
    self->updates = 0;
    if (keeps_books(self)) {
        BB_TRY(bb_phase(phases, "books"));
        BB_TRY(reserve(self, tree));
        BB_TRY(bb_launch(self->device, self->parents_kernel, count, GROUP_SIZE,
                         BB_MEM(tree->d_nodes), BB_VALUE(count), BB_VALUE(info->root),
                         BB_MEM(self->parents), BB_MEM(self->missing)));
        BB_TRY(pass(self, &scene->on_device.boxes, false, tree));
        self->built = self->now;
        self->built_area = self->area;
    } else {
        BB_TRY(bb_phase(phases, "plan"));
        BB_TRY(bb_refit_plan(self->refitter, tree));
    }
    return bb_phase(phases, NULL);
}

/* Whether the tree has become so bad that it had better be built again. */
static bool is_worn(const refit *self, const bb_tree *tree)
{
    double inner = tree->info.leaf_count - 1.0;
    switch (self->trigger) {
    case BY_SAH:
        return (double)self->now.cost * self->built_area >
               self->limit * self->built.cost * self->area;
    case BY_RATIO:
        return (double)self->now.spread - self->built.spread > self->limit * inner;
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
    if (!keeps_books(self))
        BB_TRY(bb_refit_device(self->refitter, &scene->on_device.boxes, tree));
    else {
        BB_TRY(pass(self, &scene->on_device.boxes, self->rotates, tree));
        BB_TRY(bb_event(phases, "rotated", self->now.turned));
        if (is_worn(self, tree))
            return bb_fail(BB_UNSUPPORTED, "refit: the tree has become too bad");
    }
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_refit = {
    .abi_version = BB_ABI_VERSION,
    .name = "refit",
    .summary = "optimiser for moving scenes: keeps the tree and gives its nodes new boxes, with "
               "rotations or a trigger to build again",
    .paper = "Terdiman 2001; Wald, Boulos, Shirley 2007; rotations: Kopta et al. 2012; trigger: "
             "Lauterbach et al. 2006",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_TREE | BB_INPUT_BOXES,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .compared = "",
    .stressed = "lbvh+refit:rotate=yes,lbvh+refit:trigger=sah:1.3",
    .moving = "lbvh+refit,lbvh+refit:rotate=yes,lbvh+refit:trigger=sah:1.3,sah+refit",
    .create = create,
    .build = build,
    .update = update,
    .destroy = destroy,
};
