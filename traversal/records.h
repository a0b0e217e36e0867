/* Primitive records: what most layouts hand their kernels of the primitives, expanded in the order of the leaves
 * (bb_record_words() in kernels/bb_shared.h; device code in kernels/records.cl). */
#ifndef BB_RECORDS_H
#define BB_RECORDS_H

#include "traversal/traversal.h"

typedef struct bb_records bb_records;

/* Compiles the kernel. Owned by the caller. */
bb_status bb_records_create(bb_device *device, bb_account *account, bb_records **out);
void bb_records_destroy(bb_records *records); /* NULL is allowed */

/* Record i is of the primitive of refs[i] of the source's tree, its last-bit included; triangles in the
 * form BB_RECORD_..., lengths times the scene's scale. Reserves `out` on the account and adds its size
 * to *bytes. Enqueued, not waited for. */
bb_status bb_records_make(bb_records *records, const bb_layout_source *source, uint32_t form,
                          bb_buffer *out, uint64_t *bytes);

#endif
