/* gs: inserts one object after the other where it costs least, on the host; objects that move are
 * removed and inserted again.
 *
 *   build:   for each object, in random rounds (gs_order.c): walk down from the root along the
 *            cheapest path; make it a child there, or a sibling of a child (gs_insert.c)
 *   update:  for each object that moved: remove it, and insert it again from the first ancestor
 *            whose box contains it (gs_update.c); then delete nodes that have become too large for
 *            their remaining objects, and insert their children again (gs_thin.c)
 *
 * Goldsmith and Salmon 1987 (Automatic Creation of Object Hierarchies for Ray Tracing); Eisemann,
 * Grosch, Mueller, Magnor 2007, section 3.1 ("Dynamic Goldsmith and Salmon").
 *
 * What the paper leaves open, and how it is settled here:
 *   - When a node is thinned: if Q / Q_init > tau, a ratio, since a difference would depend on the
 *     scene's size. q=min lowers Q_init to the least Q that the node has had.
 *   - Whether the boxes above a removed object shrink: they do, after the ancestor to start from is
 *     chosen. Otherwise they would go on attracting objects to where the removed one was.
 *   - The order of objects, in builds and updates. In a file's order trees can be several times
 *     worse; so can updates of objects that move together, since each is compared with neighbours
 *     that have not been moved yet. The paper's first tree was shuffled, its baselines' were not.
 *   - Where the children of a deleted node start: at its parent, whose box contains them.
 *   - Objects are primitives, or with objects=collections what the scene says moves as one, each
 *     with a tree of its own (gs_groups.c).
 *   - Which objects have moved: all boxes are compared, since the paper's figures assume that
 *     nothing is known of movements; moved=listed takes the scene's list and compares none.
 *   - How wide a node may become. Nearly equal boxes, such as those of objects that all start at
 *     the origin, would otherwise all go to one node, and each insertion would test them all.
 *
 * Greedy insertion tests the children along one path. The depth is usually that of a random search
 * tree, but has no bound: boxes nested in each other make a chain. search=bb may visit all nodes
 * for each object, and does so where all boxes overlap.
 */
#include "gs.h"

#include <stdio.h>
#include <string.h>

static const bb_option options[] = {
    {"order", "rounds", "rounds|shuffled|file",
     "order of insertion: random rounds, each in the file's order; shuffled; as in the file"},
    {"arity", "k", "k|2", "any number of children, or two"},
    {"max_children", "16", NULL, "arity=k: most children of a node, 3 or more; 0: any number"},
    {"search", "greedy", "greedy|bb",
     "how an object's place is found: along one path, or in the whole tree by branch and bound"},
    {"objects", "primitives", "primitives|collections",
     "each primitive is an object, or what the scene says belongs together, with a tree of its "
     "own"},
    {"update", "dynamic", "dynamic|rebuild", "insert moved objects again, or build again"},
    {"moved", "compared", "compared|listed",
     "which objects have moved: found by comparing boxes, or all that the scene lists as moving"},
    {"start", "enclosing", "enclosing|root",
     "where the insertion of moved objects starts: the first ancestor whose box contains it, or "
     "the root"},
    {"tau", "1.3", NULL,
     "delete nodes whose area per object is more than this many times the initial; 0: none"},
    {"q", "init", "init|min",
     "initial area per object: when the node was made, or the least since"},
    {"thin_budget", "0", NULL, "most nodes deleted per update; 0: any number"},
    {.name = NULL},
};

typedef struct gs {
    bb_account *account;
    uint64_t seed;
    bool dynamic, collections, listed;
    bb_gs_order order;
    uint64_t updates; /* since the build; each update has its own order */
    bb_gs_tree tree;
    bb_gs_groups groups; /* of collections */
} gs;

static void destroy(void *opaque)
{
    gs *self = opaque;
    if (self == NULL)
        return;
    bb_gs_release(&self->tree);
    bb_gs_groups_release(&self->groups);
    bb_host_free(self);
}

static bb_status read_rules(const bb_spec *spec, bb_gs_rules *rules)
{
    uint64_t most, budget;
    BB_TRY(bb_spec_u64(spec, options, "max_children", 0, UINT32_MAX, &most));
    BB_TRY(bb_spec_u64(spec, options, "thin_budget", 0, UINT32_MAX, &budget));
    BB_TRY(bb_spec_double(spec, options, "tau", 0, 1e9, &rules->tau));
    if (most == 1 || most == 2)
        return bb_fail(BB_INVALID,
                       "gs: max_children=%u: it is 0 (any number), or 3 or more; for "
                       "binary trees write arity=2",
                       (unsigned)most);
    if (rules->tau > 0 && rules->tau < 1)
        return bb_fail(BB_INVALID, "gs: tau=%g: it is 0 (off), or 1 or more", rules->tau);
    rules->max_children = (uint32_t)most;
    rules->thin_budget = (uint32_t)budget;
    rules->binary = bb_spec_is(spec, options, "arity", "2");
    rules->whole = bb_spec_is(spec, options, "search", "bb");
    rules->from_root = bb_spec_is(spec, options, "start", "root");
    rules->least_q = bb_spec_is(spec, options, "q", "min");
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    bb_gs_rules rules;
    BB_TRY(read_rules(context->spec, &rules));
    gs *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "gs: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->account = context->account;
    self->seed = context->seed;
    self->order = bb_spec_is(context->spec, options, "order", "rounds")     ? BB_GS_ROUNDS
                  : bb_spec_is(context->spec, options, "order", "shuffled") ? BB_GS_SHUFFLED
                                                                            : BB_GS_AS_IN_FILE;
    self->dynamic = bb_spec_is(context->spec, options, "update", "dynamic");
    self->collections = bb_spec_is(context->spec, options, "objects", "collections");
    self->listed = bb_spec_is(context->spec, options, "moved", "listed");
    self->tree.rules = self->groups.one.rules = rules;
    self->groups.order = self->order;
    self->groups.seed = self->seed;
    self->tree.groups = self->collections ? &self->groups : NULL;
    return BB_OK;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    gs *self = opaque;
    const size_t count = scene->prim_count;
    if (self->collections && scene->object_count == 0)
        return bb_fail(BB_UNSUPPORTED,
                       "gs: objects=collections: the scene does not say what belongs together");
    if (self->listed && scene->mover_count == 0)
        return bb_fail(BB_UNSUPPORTED, "gs: moved=listed: the scene does not list what moves");
    BB_TRY(bb_tree_reserve(tree, NULL, BB_ON_HOST, 2 * count - 1, count));
    if (self->collections)
        BB_TRY(bb_gs_groups_reserve(&self->groups, self->account, scene));
    return bb_gs_reserve(&self->tree, self->account,
                         self->collections ? scene->object_count : scene->prim_count);
}

static const bb_box *boxes_of(const gs *self, const bb_scene *scene)
{
    return self->collections ? self->groups.boxes : scene->boxes;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    gs *self = opaque;
    bb_gs_tree *own = &self->tree;
    BB_TRY(prepare(self, scene, tree));
    const uint32_t objects = self->collections ? scene->object_count : scene->prim_count;
    if (self->collections) {
        BB_TRY(bb_phase(phases, "collections"));
        bb_gs_groups_make(&self->groups, scene, tree);
    }
    BB_TRY(bb_phase(phases, "order"));
    const bb_box *boxes = boxes_of(self, scene);
    bb_gs_clear(own, objects);
    self->updates = 0;
    for (uint32_t i = 0; i < objects; i++)
        own->scratch[i] = i;
    bb_gs_put_in_order(own, self->order, objects, self->seed, 0);
    BB_TRY(bb_phase(phases, "insert"));
    for (uint32_t i = 0; i < objects; i++) {
        bb_gs_box box = bb_gs_box_of(&boxes[own->scratch[i]]);
        bb_gs_add(own, own->scratch[i], &box);
    }
    BB_TRY(bb_phase(phases, "emit"));
    bb_gs_start_q(own);
    bb_gs_emit(own, true, tree);
    for (uint32_t i = 0; i < scene->prim_count; i++)
        tree->refs[i] = i | BB_LAST_BIT;
    return bb_phase(phases, NULL);
}

/* What follows an object in the common tree. */
static uint32_t skip_of(const gs *self, uint32_t object, const bb_tree *tree)
{
    return tree->nodes[self->groups.first[self->groups.count] + self->tree.leaf_of[object]].skip;
}

/* Makes the boxes of collections, of the listed ones or all. */
static void follow(gs *self, const bb_scene *scene, bb_tree *tree)
{
    const uint32_t count = self->listed ? scene->mover_count : self->groups.count;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t object = self->listed ? scene->movers[i] : i;
        bb_gs_groups_refit(&self->groups, object, scene, skip_of(self, object, tree), tree);
    }
}

/* Lists the objects that moved in scratch; returns their number. */
static uint32_t find_moved(gs *self, const bb_scene *scene, const bb_box *boxes)
{
    uint32_t *list = self->tree.scratch, count = 0;
    if (!self->listed)
        return bb_gs_detect(&self->tree, boxes);
    for (uint32_t i = 0; i < scene->mover_count; i++) {
        const uint32_t object = scene->movers[i];
        if (self->collections)
            list[count++] = object;
        for (uint32_t p = scene->object_starts[object];
             !self->collections && p < scene->object_starts[object + 1]; p++)
            list[count++] = p;
    }
    return count;
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    gs *self = opaque;
    bb_gs_tree *own = &self->tree;
    const uint32_t objects = self->collections ? scene->object_count : scene->prim_count;
    if (!self->dynamic || changed != BB_CHANGED_POSITIONS || objects != own->object_count)
        return bb_fail(BB_UNSUPPORTED, "the tree is built again");
    if (self->collections) {
        BB_TRY(bb_phase(phases, "collections"));
        follow(self, scene, tree);
    }
    BB_TRY(bb_phase(phases, "detect"));
    const bb_box *boxes = boxes_of(self, scene);
    const uint32_t moved = find_moved(self, scene, boxes);
    own->reinserted = own->thinned = 0;
    BB_TRY(bb_event(phases, "moved", moved));
    if (moved == 0) {
        bb_tree_boxes_changed(tree); /* true although not even boxes may have changed */
        return bb_phase(phases, NULL);
    }
    BB_TRY(bb_phase(phases, "move"));
    bb_gs_put_in_order(own, self->order, moved, self->seed, ++self->updates);
    bb_gs_move(own, boxes, moved);
    BB_TRY(bb_phase(phases, "thin"));
    bb_gs_thin(own);
    BB_TRY(bb_event(phases, "reinserted", own->reinserted));
    BB_TRY(bb_event(phases, "thinned", own->thinned));
    BB_TRY(bb_phase(phases, "emit"));
    bb_gs_emit(own, false, tree);
    bb_tree_changed(tree);
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const bb_gs_tree *tree = &((const gs *)opaque)->tree;
    uint32_t inner = tree->count - tree->object_count;
    snprintf(text, capacity, "%.3g children per inner node, at most %u",
             inner > 0 ? (tree->count - 1.0) / inner : 0.0, tree->arity);
    return BB_OK;
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_MOVING, "gs,gs:search=bb,start=root"},
    {BB_FOR_ALL, BB_ROLE_STRESSED, "gs:order=file,gs:order=file,max_children=0"},
    {0},
};

const bb_builder bb_builder_gs = {
    .abi_version = BB_ABI_VERSION,
    .name = "gs",
    .summary = "inserts each object where it costs least, on the host; moved objects again",
    .paper = "Goldsmith and Salmon 1987; Eisemann et al. 2007, section 3.1",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_OBJECTS,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .prepare = prepare,
    .build = build,
    .update = update,
    .describe = describe,
    .destroy = destroy,
};
