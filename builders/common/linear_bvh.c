#include "builders/common/linear_bvh.h"

#include "builders/common/radix_tree.h"
#include "builders/common/sorted_codes.h"
#include "builders/common/wide_tree.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE_LEAF = 4 }; /* most primitives of a leaf, if no option says another number */

typedef struct linear_bvh {
    bb_sorted_codes sorted;
    bb_linking linking;
    uint64_t leaf;         /* most primitives of a wide tree's leaf; 0: trees are binary */
    uint32_t key_bytes;    /* of the linker; 0: there is none yet */
    bb_radix_tree *radix;  /* either this ... */
    bb_wide_tree *wide;    /* ... or this */
    bb_refitter *refitter; /* NULL: trees are rebuilt */
} linear_bvh;

void bb_linear_destroy(void *opaque)
{
    linear_bvh *self = opaque;
    if (self == NULL)
        return;
    bb_sorted_codes_release(&self->sorted);
    bb_radix_tree_destroy(self->radix);
    bb_wide_tree_destroy(self->wide);
    bb_refitter_destroy(self->refitter);
    free(self);
}

/* Makes what links keys of the code's size, once no option is `auto`. */
static bb_status make_linker(linear_bvh *self)
{
    const bb_sorted_codes *sorted = &self->sorted;
    if (!bb_codes_key_changed(sorted->codes, self->key_bytes))
        return BB_OK;
    uint32_t key_bytes = bb_codes_key_bytes(sorted->codes);
    bb_radix_kind kind = {.key_bytes = key_bytes, .linking = self->linking};
    bb_radix_tree_destroy(self->radix);
    bb_wide_tree_destroy(self->wide);
    self->radix = NULL;
    self->wide = NULL;
    self->key_bytes = 0;
    BB_TRY(self->leaf > 0
               ? bb_wide_tree_create(sorted->device, sorted->account, key_bytes,
                                     (uint32_t)self->leaf, &self->wide)
               : bb_radix_tree_create(sorted->device, sorted->account, kind, &self->radix));
    self->key_bytes = key_bytes;
    return BB_OK;
}

/* Reads BB_ARITY_OPTIONS. */
static bb_status choose_arity(linear_bvh *self, const bb_builder_context *context)
{
    const bb_spec *spec = context->spec;
    const bool wide = bb_spec_is(spec, NULL, "arity", "8");
    const char *unused = wide ? "link" : "leaf";
    self->leaf = wide ? WIDE_LEAF : 0;
    if (bb_spec_value(spec, NULL, unused) != NULL)
        return bb_fail(BB_INVALID, "%s: trees of arity=%d have no %s=: drop it", spec->name,
                       wide ? 8 : 2, unused);
    if (bb_spec_value(spec, NULL, "leaf") == NULL)
        return BB_OK;
    return bb_spec_u64(spec, context->options, "leaf", 1, BB_LEAF_MAX, &self->leaf);
}

bb_status bb_linear_create(const bb_builder_context *context, void **out)
{
    linear_bvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    bool karras = bb_spec_is(context->spec, context->options, "link", "karras");
    BB_TRY(choose_arity(self, context));
    BB_TRY(bb_sorted_codes_create(context, true, &self->sorted));
    BB_TRY(bb_refitter_choose(context, &self->refitter));
    self->linking = karras ? BB_LINK_KARRAS : BB_LINK_APETREI;
    return make_linker(self);
}

bb_status bb_linear_prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    linear_bvh *self = opaque;
    BB_TRY(bb_sorted_codes_prepare(&self->sorted, scene, 1));
    BB_TRY(make_linker(self));
    BB_TRY(bb_refitter_reserve(
        self->refitter, self->wide != NULL ? bb_wide_tree_nodes(self->wide, scene->prim_count)
                                           : 2 * (size_t)scene->prim_count - 1));
    return self->wide != NULL ? bb_wide_tree_reserve(self->wide, scene->prim_count, tree)
                              : bb_radix_tree_reserve(self->radix, scene->prim_count, tree);
}

bb_status bb_linear_build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                          bb_phases *phases)
{
    (void)input;
    linear_bvh *self = opaque;
    const bb_sorted_codes *sorted = &self->sorted;
    BB_TRY(bb_sorted_codes_make(&self->sorted, scene, phases));
    BB_TRY(bb_phase(phases, "link"));
    const bb_buffer *boxes = &scene->on_device.boxes;
    BB_TRY(self->wide != NULL
               ? bb_wide_tree_make(self->wide, &sorted->keys, &sorted->values, boxes,
                                   scene->prim_count, tree)
               : bb_radix_tree_link(self->radix, &sorted->keys, NULL, &sorted->values, boxes,
                                    scene->prim_count, tree));
    return bb_phase(phases, NULL);
}

bb_status bb_linear_update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                           bb_phases *phases)
{
    return bb_refit_update(((linear_bvh *)opaque)->refitter, scene, changed, tree, phases);
}

bb_status bb_linear_describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const linear_bvh *self = opaque;
    uint32_t met, most;
    bb_codes_describe(self->sorted.codes, text, capacity);
    if (self->radix == NULL)
        return BB_OK;
    BB_TRY(bb_radix_tree_longest(self->radix, &met, &most));
    const size_t used = strlen(text);
    if (most > 0)
        snprintf(
            text + used, capacity - used,
            "; linked without a fence: at most %u steps of a work-item, of %u that there may be",
            met, most);
    return BB_OK;
}

void bb_linear_decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const linear_bvh *self = opaque;
    bb_codes_decide(self->sorted.codes, scene, decisions);
}
