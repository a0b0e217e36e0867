/* null: one leaf over everything. Tracing it is brute force; building it costs the harness's own
 * overhead and one read of every box.
 */
#include "framework/builder/builder.h"

#include <string.h>

typedef struct null_builder {
    bb_account *account;
} null_builder;

static void destroy(void *self)
{
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **self)
{
    null_builder *made = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *made, "null: object", &made));
    made->account = context->account;
    *self = made;
    return BB_OK;
}

static bb_status prepare(void *self, const bb_scene *scene, bb_tree *tree)
{
    (void)self;
    return bb_tree_reserve(tree, NULL, BB_ON_HOST, 1, scene->prim_count);
}

static bb_status build(void *self, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    BB_TRY(prepare(self, scene, tree));
    BB_TRY(bb_phase(phases, "leaf"));
    uint32_t count = scene->prim_count;
    bb_node *leaf = &tree->nodes[0];
    memcpy(leaf->lo, scene->boxes[0].lo, sizeof leaf->lo);
    memcpy(leaf->hi, scene->boxes[0].hi, sizeof leaf->hi);
    for (uint32_t i = 0; i < count; i++) {
        const bb_box *box = &scene->boxes[i];
        for (int axis = 0; axis < 3; axis++) {
            leaf->lo[axis] = box->lo[axis] < leaf->lo[axis] ? box->lo[axis] : leaf->lo[axis];
            leaf->hi[axis] = box->hi[axis] > leaf->hi[axis] ? box->hi[axis] : leaf->hi[axis];
        }
        tree->refs[i] = i;
    }
    tree->refs[count - 1] |= BB_LAST_BIT;
    leaf->first = BB_LEAF_BIT | 0;
    leaf->skip = BB_NONE;
    tree->info = (bb_tree_info){.node_count = 1, .leaf_count = 1, .ref_count = count};
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_null = {
    .abi_version = BB_ABI_VERSION,
    .name = "null",
    .summary = "one leaf with all primitives: brute force, and the harness's own overhead",
    .paper = "none",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .variants = BB_NO_VARIANTS,
    .create = create,
    .prepare = prepare,
    .build = build,
    .destroy = destroy,
};
