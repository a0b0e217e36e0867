/* Primitives in the order of their codes, with which every builder over a code begins. Owns the
 * code, the keys, the sorted primitives and the sorter.
 *
 *   create():   bb_sorted_codes_create()
 *   prepare():  bb_sorted_codes_prepare(), then recompilation for the size of keys
 *               (bb_codes_key_changed())
 *   build():    bb_sorted_codes_make()
 *   destroy():  bb_sorted_codes_release()
 */
#ifndef BB_SORTED_CODES_H
#define BB_SORTED_CODES_H

#include "builders/common/codes.h"
#include "framework/device/primitives.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_sorted_codes {
    bb_device *device;
    bb_account *account;
    const char *builder;
    bb_primitives *primitives; /* with scratch for the sort; the builder may use it too */
    bb_codes *codes;
    bb_buffer keys;   /* per primitive, of bb_codes_key_bytes() */
    bb_buffer values; /* u32 per primitive: its number */
} bb_sorted_codes;

/* For a builder with BB_CODE_OPTIONS. `sorted` is zero before, and must be released even after a
 * failure. Memory is booked on the context's account. `leave_bounds`: see bb_codes_create(). */
bb_status bb_sorted_codes_create(const bb_builder_context *context, bool leave_bounds,
                                 bb_sorted_codes *sorted);
void bb_sorted_codes_release(bb_sorted_codes *sorted);

/* Resolves the code for the scene (bb_codes_prepare) and reserves the memory of
 * bb_sorted_codes_make(). */
bb_status bb_sorted_codes_prepare(bb_sorted_codes *sorted, const bb_scene *scene,
                                  uint32_t multiple);

/* Phases "bounds", "codes" and "sort": fills keys and values in ascending order of the keys; equal
 * keys stay in the order of the primitives. Waits as bb_codes_make() does. */
bb_status bb_sorted_codes_make(bb_sorted_codes *sorted, const bb_scene *scene, bb_phases *phases);

/* The second half, phase "sort", for builders that change the keys in between: sorts the first
 * `count` keys by their lowest `bits` bits. */
bb_status bb_sorted_codes_sort(bb_sorted_codes *sorted, uint32_t count, uint32_t bits,
                               bb_phases *phases);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
