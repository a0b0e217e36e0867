/* Writes rays files and reads rays files and hits files (framework/workload/exchange.h). Readers
 * trust nothing in a file. */
#ifndef BB_EXCHANGE_FILE_H
#define BB_EXCHANGE_FILE_H

#include "framework/judge/oracle.h"
#include "framework/judge/rays.h"
#include "framework/scene/scene.h"
#include "framework/workload/exchange.h"

/* Writes scene and rays into a temporary file, which then takes the name `path`. A `generator` that
 * is too long for the header is cut. */
bb_status bb_exchange_write_rays(const char *path, const bb_scene *scene, const bb_rays *rays,
                                 const char *generator);

/* Reads the ray set of a file that was made for `scene`. With `by_hand`, its name must not be a
 * workload's; else it must be one. BB_INVALID if the counts are not those of the scene, or if
 * counts, hashes or checksum do not agree with the content. Whether the rays are those of the
 * workload is what bb_exchange_verify_rays() checks. The caller owns the rays: bb_rays_free(). */
bb_status bb_exchange_read_rays(const char *path, const bb_scene *scene, bool by_hand,
                                bb_rays **rays);

/* Generates the rays again, from the scene and the header. BB_INVALID if they differ. Messages name
 * the file `path`. */
bb_status bb_exchange_verify_rays(const char *path, const bb_scene *scene, bb_oracle *oracle,
                                  const bb_rays *rays);

/* What a tracer answered. */
typedef struct bb_outside_hits {
    bb_hit *hits;   /* from bb_host_alloc */
    uint32_t count; /* at least 1; the hits belong to the first rays */
    char tracer[sizeof((bb_hits_header *)0)->tracer];
} bb_outside_hits;

/* Reads the hits of a tracer on `rays` of `scene`. BB_INVALID if the file is for other rays, or if
 * a hit is not a valid answer by exchange.h. *out must be zeroed; free it with
 * bb_outside_hits_release(). */
bb_status bb_exchange_read_hits(const char *path, const bb_scene *scene, const bb_rays *rays,
                                bb_outside_hits *out);
void bb_outside_hits_release(bb_outside_hits *hits);

#endif
