/* Accounted memory, on host and device.
 *
 * Every byte that a builder, layout or kernel uses is booked on an account, so that `bytes_peak` is
 * measured in the same way for all, and so that requests that do not fit are refused, with the
 * bytes they need, before the driver is asked (drivers overcommit).
 */
#ifndef BB_MEMORY_H
#define BB_MEMORY_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_account {
    uint64_t bytes; /* in use now, host and device together */
    uint64_t peak;  /* the maximum since bb_account_mark() */
} bb_account;

/* Resets the peak to what is in use now. */
void bb_account_mark(bb_account *account);
void bb_account_add(bb_account *account, uint64_t bytes);
void bb_account_subtract(bb_account *account, uint64_t bytes);

/* Allocates host memory, 64-byte aligned and not cleared; a size of 0 gives a valid pointer. The 16
 * bytes after it may be read, since vectors reach beyond the last element of an array.
 * BB_REFUSED names `what` and the bytes if the host does not have that much. `*out` must be NULL or
 * come from here: it is freed and replaced, so that the same call creates and resizes scratch
 * memory. `account` may be NULL. */
bb_status bb_host_alloc(bb_account *account, size_t bytes, const char *what, void *out);
/* Moves the first `bytes` of a block to one of that size, and frees it. Without room for both the
 * block stays as it is. `out` as above. */
void bb_host_shrink(void *out, size_t bytes);
void bb_host_free(void *pointer); /* NULL is allowed; also books the block off its account */

/* Returns the most bytes that a scene, or the files it is read from, may take on the host: three
 * quarters of its memory. UINT64_MAX if that is unknown. */
uint64_t bb_host_limit(void);

/* Returns the most bytes the process has had in memory so far; 0 if unknown. */
uint64_t bb_host_peak(void);

/* Bytes that part of a program has added to the process's memory: now, and at most. */
typedef struct bb_footprint {
    int64_t now, peak;
} bb_footprint;

/* Starts anew what bb_host_peak_since_mark() returns: the most bytes that the process has had in
 * memory since. Where Linux does not let it, that is what it has now. */
void bb_host_mark_peak(void);
uint64_t bb_host_peak_since_mark(void);

/* Returns the bytes that the process has in memory now, to some hundred KiB; 0 if unknown. */
uint64_t bb_host_resident(void);

/* ---- one account of all: of bb_host_alloc(), of devices that share the host's memory, of
 * libraries that say what they take ---- */

/* The most that may be booked: a sixteenth of the memory is left to what nobody books, such as
 * drivers, compilers, programs. */
uint64_t bb_host_most(void);
/* BB_REFUSED names `what` and the bytes if they do not fit beside all that is booked. */
bb_status bb_host_has_room(uint64_t bytes, const char *what);
/* Returns the most bytes that were missing at a refusal since the last call; 0: none. */
uint64_t bb_host_missing(void);
void bb_host_book(uint64_t bytes);
void bb_host_unbook(uint64_t bytes);
/* For libraries that tell what they take, before it or (`taken`) after it; a negative number is
 * given back. Returns false without room: nothing is booked, and the library must not take it. */
bool bb_host_follow(int64_t bytes, bool taken, const char *what);

/* What is booked now, and the most since its last bb_account_mark(). */
bb_account *bb_host_account(void);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
