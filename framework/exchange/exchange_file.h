/* Rays files and hits files (framework/exchange/exchange.h): writing, and reading what anybody may
 * have written. */
#ifndef BB_EXCHANGE_FILE_H
#define BB_EXCHANGE_FILE_H

#include "framework/exchange/exchange.h"
#include "framework/judge/oracle.h"
#include "framework/rays/rays.h"
#include "framework/scene/scene.h"

/* Writes scene and rays by way of a temporary file. `generator` is cut where the header has no more
 * room. */
bb_status bb_exchange_write_rays(const char *path, const bb_scene *scene, const bb_rays *rays,
                                 const char *generator);

/* Reads the ray set of a file that was made for `scene`: of a workload or, if `by_hand`, one under
 * a name that is no workload's. BB_INVALID, with what is wrong, unless each byte of the file is as
 * it was written: its counts are those of the scene and agree with its size, and hashes and
 * checksum with its content. That the rays are those of the workload is left to
 * bb_exchange_verify_rays(). Owned by the caller: bb_rays_free(). */
bb_status bb_exchange_read_rays(const char *path, const bb_scene *scene, bool by_hand,
                                bb_rays **rays);

/* Makes the rays of a workload again, from the scene and from what their file says they were made
 * by. BB_INVALID unless they are the same. `path` is that of the file, for the message. */
bb_status bb_exchange_verify_rays(const char *path, const bb_scene *scene, bb_oracle *oracle,
                                  const bb_rays *rays);

/* What a tracer answered. */
typedef struct bb_outside_hits {
    bb_hit *hits;   /* from bb_host_alloc */
    uint32_t count; /* of the first rays; 1 or more */
    char tracer[sizeof((bb_hits_header *)0)->tracer];
} bb_outside_hits;

/* Reads the hits that were made for `rays` of `scene`; BB_INVALID, with what is wrong, if they were
 * not, or if one of them is no answer (exchange.h says what is). *out must be zeroed;
 * bb_outside_hits_release() frees it. */
bb_status bb_exchange_read_hits(const char *path, const bb_scene *scene, const bb_rays *rays,
                                bb_outside_hits *out);
void bb_outside_hits_release(bb_outside_hits *hits);

#endif
