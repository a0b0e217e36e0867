/* fickle: two leaves, whose boxes its update() brings up to date; which is right, until it is told
 * otherwise. For the tests of what must not be taken on trust when scenes move. */
#include "framework/builder/builder.h"

#include <math.h>
#include <unistd.h>

enum { WORK_US = 20000 };

static const bb_option options[] = {
    {"how", "right", "right|shrinks|gives-up|tries",
     "from its second build on: shrinks: half of each leaf is not in its box; gives-up: its "
     "updates "
     "ask for a build; tries: each does so, from the first on, after 20 ms"},
    {.name = NULL},
};

typedef struct fickle {
    bb_device *device;
    bool shrinks, gives_up, tries;
    uint32_t builds;
} fickle;

static bb_status create(const bb_builder_context *context, void **out)
{
    fickle *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "fickle: object", &self));
    *self = (fickle){.device = context->device,
                     .shrinks = bb_spec_is(context->spec, options, "how", "shrinks"),
                     .gives_up = bb_spec_is(context->spec, options, "how", "gives-up"),
                     .tries = bb_spec_is(context->spec, options, "how", "tries")};
    *out = self;
    return BB_OK;
}

static void destroy(void *self)
{
    bb_host_free(self);
}

/* A leaf over the primitives from `begin` on, below the root. */
static void enclose(const fickle *self, const bb_scene *scene, uint32_t begin, uint32_t end,
                    bb_tree *tree, bb_node *leaf)
{
    bb_node *root = &tree->nodes[0];
    for (int k = 0; k < 3; k++) {
        leaf->lo[k] = INFINITY;
        leaf->hi[k] = -INFINITY;
        for (uint32_t i = begin; i < end; i++) {
            leaf->lo[k] = fminf(leaf->lo[k], scene->boxes[i].lo[k]);
            leaf->hi[k] = fmaxf(leaf->hi[k], scene->boxes[i].hi[k]);
        }
        root->lo[k] = fminf(root->lo[k], leaf->lo[k]);
        root->hi[k] = fmaxf(root->hi[k], leaf->hi[k]);
    }
    if (self->shrinks && self->builds > 1)
        leaf->hi[0] = 0.5f * leaf->lo[0] + 0.5f * leaf->hi[0];
}

static void enclose_all(const fickle *self, const bb_scene *scene, bb_tree *tree)
{
    const uint32_t count = scene->prim_count;
    for (int k = 0; k < 3; k++) {
        tree->nodes[0].lo[k] = INFINITY;
        tree->nodes[0].hi[k] = -INFINITY;
    }
    enclose(self, scene, 0, count / 2, tree, &tree->nodes[1]);
    enclose(self, scene, count / 2, count, tree, &tree->nodes[2]);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    fickle *self = opaque;
    const uint32_t count = scene->prim_count, half = count / 2;
    if (count < 2)
        return bb_fail(BB_UNSUPPORTED, "fickle: takes two primitives or more");
    BB_TRY(bb_phase(phases, "leaves"));
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_HOST, 3, count));
    tree->info = (bb_tree_info){
        .node_count = 3, .leaf_count = 2, .ref_count = count, .arity = 2, .depth = 1};
    tree->nodes[0] = (bb_node){.first = 1, .skip = BB_NONE};
    tree->nodes[1] = (bb_node){.first = BB_LEAF_BIT, .skip = 2};
    tree->nodes[2] = (bb_node){.first = BB_LEAF_BIT | half, .skip = BB_NONE};
    for (uint32_t i = 0; i < count; i++)
        tree->refs[i] = i | (i + 1 == half || i + 1 == count ? BB_LAST_BIT : 0);
    self->builds++;
    enclose_all(self, scene, tree);
    return bb_phase(phases, NULL);
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    fickle *self = opaque;
    if (changed != BB_CHANGED_POSITIONS)
        return bb_fail(BB_UNSUPPORTED, "fickle: builds again");
    BB_TRY(bb_phase(phases, "follow"));
    if (self->tries)
        usleep(WORK_US);
    if (self->tries || (self->gives_up && self->builds > 1))
        return bb_fail(BB_UNSUPPORTED, "fickle: gives up, as told");
    enclose_all(self, scene, tree);
    bb_tree_boxes_changed(tree);
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_fickle = {
    .abi_version = BB_ABI_VERSION,
    .name = "fickle",
    .summary = "is another builder from its second build on, as told; for tests",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .create = create,
    .build = build,
    .update = update,
    .destroy = destroy,
};
