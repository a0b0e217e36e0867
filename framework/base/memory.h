/* Accounted memory, on host and device.
 *
 * Every byte that a builder, layout or kernel takes goes through an account, so that `bytes_peak`
 * is measured by the same book for all, and so that what does not fit is refused, with the bytes it
 * needs, before the driver is asked (drivers overcommit).
 */
#ifndef BB_MEMORY_H
#define BB_MEMORY_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_account {
    uint64_t bytes; /* in use now, host and device together */
    uint64_t peak;  /* the most there has been since bb_account_mark() */
} bb_account;

/* Restarts the peak at what is in use now. */
void bb_account_mark(bb_account *account);
void bb_account_add(bb_account *account, uint64_t bytes);
void bb_account_subtract(bb_account *account, uint64_t bytes);

/* Host memory, 64-byte aligned, not cleared; a size of 0 gives a valid pointer. BB_REFUSED names
 * `what` and the bytes if the host has not that much. `*out` must be NULL or come from here: it is
 * replaced (freed first), so the same call serves to make and to resize scratch. Account may be
 * NULL. */
bb_status bb_host_alloc(bb_account *account, size_t bytes, const char *what, void *out);
void bb_host_free(void *pointer); /* NULL is allowed; leaves the account */

/* The most bytes that a scene, or the files that it is read from, may take on the host: three
 * quarters of its memory. UINT64_MAX if that is not known. */
uint64_t bb_host_limit(void);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
