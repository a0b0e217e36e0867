/* reinsert: an optimiser of binary trees that removes subtrees and reinserts them where they cost
 * least, on the device.
 *
 *   make families: inner nodes with both children's boxes                 (reinsert_families.cl)
 *   for each pass, until one gains too little:
 *       take a share of the subtrees, the largest ones, in some parts; for each part:
 *           for each subtree: find the place where it would cost least      (reinsert_search.cl)
 *           make the moves that do not conflict, the best first              (reinsert_moves.cl)
 *       if the tree has become worse: undo the pass
 *   convert the families back to nodes                                    (reinsert_families.cl)
 *
 * Meister and Bittner 2018 (Parallel Reinsertion for Bounding Volume Hierarchy Optimization), after
 * Bittner, Hapala and Havran 2013 (Fast Insertion-Based Optimization of Bounding Volume
 * Hierarchies). The papers' texts were not at hand: this was made from their abstracts and the
 * authors' code, and derived again. The cost is the sum of the areas of all inner nodes: leaves,
 * and so their cost, stay the same.
 *
 * Where this knowingly departs from that code, and what was added:
 *
 * - Their "every n-th node" corresponds to one part here.
 * - With `share` only the largest subtrees are considered; they offer most of the possible gain.
 * - A search visits at most `visits` nodes.
 * - Moves are chosen in several rounds (reinsert_moves.cl), and cycles of moves are impossible
 *   (reinsert_search.cl).
 *
 * Bounds: passes, parts and rounds are limited, a search visits at most `visits` nodes, and nothing
 * recurses. The depth has no bound: nested boxes cost least as a chain, and become one.
 */
#include "families.h"
#include "framework/builder/builder.h"
#include "moves.h"
#include "search.h"

#include <stdio.h>
#include <stdlib.h>

enum { PARTS_MAX = 64 };

static const bb_option options[] = {
    {"passes", "3", NULL, "most passes, 1 to 1000; ends when a pass gains too little"},
    {"share", "1", NULL,
     "share of the subtrees, the largest first, for which a pass looks for a better position, "
     "0.0001 to 1"},
    {"parts", "8", NULL,
     "parts that a pass is divided into, 1 to 64: each sees the moves of earlier parts"},
    {"stop", "1e-4", NULL,
     "ends after a pass that lowers the cost of the inner nodes by less than this share, 0 to 1"},
    {"visits", "1000", NULL,
     "most nodes that one search visits, 8 to 1e9: bounds the time in bad trees"},
    {.name = NULL},
};

typedef struct reinsert {
    bb_device *device;
    uint64_t passes;
    uint32_t parts;
    double share, stop;
    bb_family_tree tree;
    bb_reinsert_search search;
    bb_mover mover;
    uint32_t passes_made; /* by the last build */
    uint64_t searched, moved;
    double before, after; /* cost of the inner nodes */
} reinsert;

static void destroy(void *opaque)
{
    reinsert *self = opaque;
    if (self == NULL)
        return;
    bb_mover_release(&self->mover);
    bb_reinsert_search_release(&self->search);
    bb_family_tree_release(&self->tree);
    free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    const bb_spec *spec = context->spec;
    bb_device *device = context->device;
    bb_account *account = context->account;
    uint64_t visits, parts;
    reinsert *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = device;
    BB_TRY(bb_spec_u64(spec, options, "passes", 1, 1000, &self->passes));
    BB_TRY(bb_spec_u64(spec, options, "parts", 1, PARTS_MAX, &parts));
    self->parts = (uint32_t)parts;
    BB_TRY(bb_spec_double(spec, options, "share", 0.0001, 1, &self->share));
    BB_TRY(bb_spec_double(spec, options, "stop", 0, 1, &self->stop));
    BB_TRY(bb_spec_u64(spec, options, "visits", 8, 1000000000, &visits));
    BB_TRY(bb_family_tree_create(device, account, &self->tree));
    BB_TRY(bb_reinsert_search_create(device, account, self->tree.primitives, (uint32_t)visits,
                                     &self->search));
    return bb_mover_create(device, account, &self->mover);
}

/* Searches for one part of the list and makes the moves found: moves[*begin .. *end). */
static bb_status make_step(reinsert *self, uint32_t part, bb_moves *moves, uint32_t *made,
                           bb_phases *phases)
{
    bb_family_tree *tree = &self->tree;
    *made = 0;
    BB_TRY(bb_phase(phases, "search"));
    BB_TRY(bb_reinsert_find(&self->search, tree, part, self->parts, moves->begin, &moves->end));
    if (moves->begin == moves->end)
        return BB_OK;
    BB_TRY(bb_phase(phases, "choose"));
    BB_TRY(bb_mover_choose(&self->mover, *moves, made));
    BB_TRY(bb_phase(phases, "move"));
    return bb_mover_make(&self->mover, tree, *moves);
}

static bb_status undo_pass(reinsert *self, const bb_moves moves[PARTS_MAX])
{
    for (uint32_t part = self->parts; part-- > 0;)
        if (moves[part].begin < moves[part].end)
            BB_TRY(bb_mover_undo(&self->mover, &self->tree, moves[part]));
    return BB_OK;
}

/* Runs a pass over a share of the subtrees. *gains: whether another pass is worthwhile. */
static bb_status make_pass(reinsert *self, bb_phases *phases, bool *gains)
{
    bb_moves moves[PARTS_MAX];
    uint32_t made = 0, made_now, begin = 0;
    double cost;
    BB_TRY(bb_phase(phases, "list"));
    BB_TRY(bb_reinsert_choose(&self->search, &self->tree, self->share));
    for (uint32_t part = 0; part < self->parts; part++) {
        moves[part] = (bb_moves){&self->search.moves, begin, begin};
        BB_TRY(make_step(self, part, &moves[part], &made_now, phases));
        begin = moves[part].end;
        made += made_now;
    }
    BB_TRY(bb_phase(phases, "cost"));
    BB_TRY(bb_family_tree_cost(&self->tree, &cost));
    self->passes_made++;
    self->searched += self->search.count;
    *gains = self->after - cost > self->stop * self->after;
    if (cost > self->after)
        return undo_pass(self, moves);
    self->after = cost;
    self->moved += made;
    return BB_OK;
}

static bb_status make_passes(reinsert *self, bb_phases *phases)
{
    bool gains = true;
    BB_TRY(bb_phase(phases, "cost"));
    BB_TRY(bb_family_tree_cost(&self->tree, &self->before));
    self->after = self->before;
    for (uint64_t pass = 0; pass < self->passes && gains; pass++)
        BB_TRY(make_pass(self, phases, &gains));
    return BB_OK;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)scene;
    reinsert *self = opaque;
    const bb_tree_info *info = &input->info;
    if (info->arity > 2 || info->node_count != 2 * info->leaf_count - 1)
        return bb_fail(BB_UNSUPPORTED, "reinsert takes binary trees, and this one has nodes of "
                                       "another number of children than two");
    BB_TRY(bb_phase(phases, "read"));
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_DEVICE, info->node_count, info->ref_count));
    tree->info = *info;
    self->passes_made = 0;
    self->searched = self->moved = 0;
    self->before = self->after = 0;
    if (info->leaf_count == 1) {
        BB_TRY(bb_tree_copy(input, tree));
        return bb_phase(phases, NULL);
    }
    BB_TRY(bb_buffer_copy(&input->d_refs, &tree->d_refs, info->ref_count * sizeof(uint32_t)));
    tree->duplicated = input->duplicated;
    tree->disjoint = false; /* siblings are other nodes than before */
    BB_TRY(bb_family_tree_gather(&self->tree, input));
    BB_TRY(bb_reinsert_search_reserve(&self->search, self->tree.count));
    BB_TRY(bb_mover_reserve(&self->mover, self->tree.count));
    BB_TRY(make_passes(self, phases));
    BB_TRY(bb_phase(phases, "write"));
    BB_TRY(bb_family_tree_write(&self->tree, info->ref_count, tree));
    BB_TRY(bb_phase(phases, NULL));
    BB_TRY(bb_event(phases, "searched", self->searched));
    return bb_event(phases, "moved", self->moved);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const reinsert *self = opaque;
    double lower = self->before > 0 ? 1 - self->after / self->before : 0;
    snprintf(text, capacity, "%llu of %llu moved in %u passes, inner nodes cost %.3g %% less",
             (unsigned long long)self->moved, (unsigned long long)self->searched, self->passes_made,
             100 * lower);
    return BB_OK;
}

const bb_builder bb_builder_reinsert = {
    .abi_version = BB_ABI_VERSION,
    .name = "reinsert",
    .summary = "optimiser: moves subtrees of a binary tree to where they cost least, on the device",
    .paper = "Meister, Bittner 2018 (parallel reinsertion)",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_TREE,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = BB_NO_VARIANTS,
    .create = create,
    .build = build,
    .describe = describe,
    .destroy = destroy,
};
