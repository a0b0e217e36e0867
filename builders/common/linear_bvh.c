#include "builders/common/linear_bvh.h"

#include "builders/common/radix_tree.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct linear_bvh {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    bb_codes *codes;
    bb_linking linking;
    uint32_t key_bytes; /* of the radix tree; 0: there is none yet */
    bb_radix_tree *radix;
    bb_refitter *refitter; /* NULL: trees are built again */
    bb_buffer keys;
    bb_buffer values;
} linear_bvh;

void bb_linear_destroy(void *opaque)
{
    linear_bvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->keys);
    bb_buffer_release(&self->values);
    bb_codes_destroy(self->codes);
    bb_radix_tree_destroy(self->radix);
    bb_refitter_destroy(self->refitter);
    bb_primitives_destroy(self->primitives);
    free(self);
}

/* The radix tree for keys as the code has them, which is known once nothing of it is open. */
static bb_status make_radix(linear_bvh *self)
{
    uint32_t key_bytes = bb_codes_key_bytes(self->codes);
    if (!bb_codes_ready(self->codes) || self->key_bytes == key_bytes)
        return BB_OK;
    bb_radix_kind kind = {.key_bytes = key_bytes, .linking = self->linking};
    bb_radix_tree_destroy(self->radix);
    self->radix = NULL;
    self->key_bytes = 0;
    BB_TRY(bb_radix_tree_create(self->device, self->account, kind, &self->radix));
    self->key_bytes = key_bytes;
    return BB_OK;
}

bb_status bb_linear_create(const bb_builder_context *context, void **out)
{
    linear_bvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    bool karras = bb_spec_is(context->spec, context->options, "link", "karras");
    BB_TRY(bb_codes_create(context, &self->codes));
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    if (bb_spec_is(context->spec, context->options, "update", "refit"))
        BB_TRY(bb_refitter_create(self->device, self->account, &self->refitter));
    self->linking = karras ? BB_LINK_KARRAS : BB_LINK_APETREI;
    return make_radix(self);
}

bb_status bb_linear_prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    linear_bvh *self = opaque;
    size_t count = scene->prim_count;
    BB_TRY(bb_codes_prepare(self->codes, scene, 1));
    BB_TRY(make_radix(self));
    uint32_t key_bytes = bb_codes_key_bytes(self->codes);
    BB_TRY(bb_buffer_reserve(self->device, self->account, count * key_bytes, "lbvh: codes",
                             &self->keys));
    BB_TRY(bb_buffer_reserve(self->device, self->account, count * sizeof(uint32_t), "lbvh: indices",
                             &self->values));
    BB_TRY(bb_primitives_reserve(self->primitives, scene->prim_count, key_bytes));
    if (self->refitter != NULL)
        BB_TRY(bb_refitter_reserve(self->refitter, 2 * count - 1));
    return bb_radix_tree_reserve(self->radix, scene->prim_count, tree);
}

bb_status bb_linear_build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                          bb_phases *phases)
{
    (void)input;
    linear_bvh *self = opaque;
    uint32_t count = scene->prim_count;
    BB_TRY(bb_codes_make(self->codes, self->primitives, scene, &self->keys, &self->values, phases));
    BB_TRY(bb_phase(phases, "sort"));
    BB_TRY(bb_sort_keys(self->primitives, bb_codes_key_bytes(self->codes), &self->keys,
                        &self->values, count, bb_codes_pattern(self->codes)->bits));
    BB_TRY(bb_phase(phases, "link"));
    BB_TRY(bb_radix_tree_link(self->radix, &self->keys, NULL, &self->values,
                              &scene->on_device.boxes, count, tree));
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
    linear_bvh *self = opaque;
    char letters[BB_CODE_BITS_MAX + 1];
    const bb_code_pattern *layout = bb_codes_pattern(self->codes);
    bb_code_letters(layout, letters, sizeof letters);
    snprintf(text, capacity, "code of %u bits: %s", layout->bits, letters);
    return BB_OK;
}

void bb_linear_decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const linear_bvh *self = opaque;
    bb_codes_decide(self->codes, scene, decisions);
}
