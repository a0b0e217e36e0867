#include "builders/common/linear_bvh.h"

#include "builders/common/radix_tree.h"
#include "builders/common/sorted_codes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct linear_bvh {
    bb_sorted_codes sorted;
    bb_linking linking;
    uint32_t key_bytes; /* of the radix tree; 0: there is none yet */
    bb_radix_tree *radix;
    bb_refitter *refitter; /* NULL: trees are rebuilt */
} linear_bvh;

void bb_linear_destroy(void *opaque)
{
    linear_bvh *self = opaque;
    if (self == NULL)
        return;
    bb_sorted_codes_release(&self->sorted);
    bb_radix_tree_destroy(self->radix);
    bb_refitter_destroy(self->refitter);
    free(self);
}

/* Makes the radix tree for keys of the code's size, once no option is `auto`. */
static bb_status make_radix(linear_bvh *self)
{
    if (!bb_codes_key_changed(self->sorted.codes, self->key_bytes))
        return BB_OK;
    uint32_t key_bytes = bb_codes_key_bytes(self->sorted.codes);
    bb_radix_kind kind = {.key_bytes = key_bytes, .linking = self->linking};
    bb_radix_tree_destroy(self->radix);
    self->radix = NULL;
    self->key_bytes = 0;
    BB_TRY(bb_radix_tree_create(self->sorted.device, self->sorted.account, kind, &self->radix));
    self->key_bytes = key_bytes;
    return BB_OK;
}

bb_status bb_linear_create(const bb_builder_context *context, void **out)
{
    linear_bvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    bool karras = bb_spec_is(context->spec, context->options, "link", "karras");
    BB_TRY(bb_sorted_codes_create(context, true, &self->sorted));
    BB_TRY(bb_refitter_choose(context, &self->refitter));
    self->linking = karras ? BB_LINK_KARRAS : BB_LINK_APETREI;
    return make_radix(self);
}

bb_status bb_linear_prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    linear_bvh *self = opaque;
    BB_TRY(bb_sorted_codes_prepare(&self->sorted, scene, 1));
    BB_TRY(make_radix(self));
    BB_TRY(bb_refitter_reserve(self->refitter, 2 * (size_t)scene->prim_count - 1));
    return bb_radix_tree_reserve(self->radix, scene->prim_count, tree);
}

bb_status bb_linear_build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                          bb_phases *phases)
{
    (void)input;
    linear_bvh *self = opaque;
    const bb_sorted_codes *sorted = &self->sorted;
    BB_TRY(bb_sorted_codes_make(&self->sorted, scene, phases));
    BB_TRY(bb_phase(phases, "link"));
    BB_TRY(bb_radix_tree_link(self->radix, &sorted->keys, NULL, &sorted->values,
                              &scene->on_device.boxes, scene->prim_count, tree));
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
