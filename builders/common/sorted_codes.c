#include "builders/common/sorted_codes.h"

#include <stdio.h>

bb_status bb_sorted_codes_create(const bb_builder_context *context, bool leave_bounds,
                                 bb_sorted_codes *sorted)
{
    sorted->device = context->device;
    sorted->account = context->account;
    sorted->builder = context->spec->name;
    BB_TRY(bb_codes_create(context, leave_bounds, &sorted->codes));
    return bb_primitives_create(sorted->device, sorted->account, &sorted->primitives);
}

void bb_sorted_codes_release(bb_sorted_codes *sorted)
{
    bb_buffer_release(&sorted->keys);
    bb_buffer_release(&sorted->values);
    bb_codes_destroy(sorted->codes);
    bb_primitives_destroy(sorted->primitives);
    *sorted = (bb_sorted_codes){0};
}

bb_status bb_sorted_codes_prepare(bb_sorted_codes *sorted, const bb_scene *scene, uint32_t multiple)
{
    const size_t count = scene->prim_count;
    char keys[64], values[64];
    BB_TRY(bb_codes_prepare(sorted->codes, scene, multiple));
    const uint32_t key_bytes = bb_codes_key_bytes(sorted->codes);
    snprintf(keys, sizeof keys, "%s: codes", sorted->builder);
    snprintf(values, sizeof values, "%s: indices", sorted->builder);
    BB_TRY(
        bb_buffer_reserve(sorted->device, sorted->account, count * key_bytes, keys, &sorted->keys));
    BB_TRY(bb_buffer_reserve(sorted->device, sorted->account, count * sizeof(uint32_t), values,
                             &sorted->values));
    return bb_primitives_reserve(sorted->primitives, scene->prim_count, key_bytes);
}

bb_status bb_sorted_codes_make(bb_sorted_codes *sorted, const bb_scene *scene, bb_phases *phases)
{
    BB_TRY(bb_codes_make(sorted->codes, sorted->primitives, scene, &sorted->keys, &sorted->values,
                         phases));
    return bb_sorted_codes_sort(sorted, scene->prim_count, bb_codes_pattern(sorted->codes)->bits,
                                phases);
}

bb_status bb_sorted_codes_sort(bb_sorted_codes *sorted, uint32_t count, uint32_t bits,
                               bb_phases *phases)
{
    BB_TRY(bb_phase(phases, "sort"));
    return bb_sort_keys(sorted->primitives, bb_codes_key_bytes(sorted->codes), &sorted->keys,
                        &sorted->values, count, bits);
}
