/* References: boxes that stand for a primitive or a part of it. A splitter makes them, on the host
 * or on the device, and a builder builds its tree over them instead of the primitives' boxes.
 */
#ifndef BB_REFERENCES_H
#define BB_REFERENCES_H

#include "framework/builder/tree.h"

#pragma GCC visibility push(default) /* what a plug-in may call */

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_references {
    bb_account *account; /* books what is reserved, and the copy on the other side */
    bb_place place;      /* where the splitter left them */
    uint32_t count;      /* set by the splitter; at least one per primitive */
    bool copied;         /* the other side holds an up-to-date copy */

    bb_box *boxes;   /* host side; NULL until reserved there or downloaded */
    uint32_t *prims; /* primitive of each */
    size_t capacity; /* of the host arrays */

    bb_buffer d_boxes; /* bb_box[count] */
    bb_buffer d_prims; /* u32[count] */
} bb_references;

void bb_references_init(bb_references *references, bb_account *account);
void bb_references_release(bb_references *references); /* empty, and may be used again */

/* Makes room for up to `capacity` references at `place`, which becomes their place. Contents are
 * lost if it grows; a copy on the other side becomes stale. Refused beyond 2^31 - 1. */
bb_status bb_references_reserve(bb_references *references, bb_device *device, bb_place place,
                                size_t capacity);

/* device -> host and host -> device copies; `ms` gets the wall time (may be NULL). They do nothing
 * if the copy is up to date. */
bb_status bb_references_download(bb_references *references, double *ms);
bb_status bb_references_upload(bb_references *references, bb_device *device, double *ms);

#ifdef __cplusplus
}
#endif

#pragma GCC visibility pop

#endif
