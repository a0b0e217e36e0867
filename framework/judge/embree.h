/* The interface to Embree, version 3 or 4: as oracle, and as the reference that traces with its own
 * trees. (Only builders/embree calls Embree elsewhere, for rtcBuildBVH.)
 */
#ifndef BB_EMBREE_H
#define BB_EMBREE_H

#include "framework/base/options.h"
#include "framework/scene/scene.h"
#include "kernels/bb_shared.h"

typedef struct bb_embree bb_embree;

extern const bb_option bb_embree_options[]; /* quality, mode, query, coherent */

/* Of these, those that say how rays are passed: one tree serves all. */
#define BB_EMBREE_PASSING "query,coherent"

/* The calls that trace, for the record; the specification's query says which. */
#define BB_EMBREE_API "rtcIntersect and rtcOccluded: 1, 4, 8, 16 or 1M, by query="

/* Writes the version of the loaded Embree, such as "3.13.5". BB_FAILED if it cannot open a
 * device. */
bb_status bb_embree_version(char *text, size_t capacity);

/* Makes Embree's own scene, with the geometry in it and no tree yet; `threads` threads will build.
 * `spec` gives quality and mode; NULL: medium, robust, compact. */
bb_status bb_embree_create(const bb_scene *scene, const bb_spec *spec, uint32_t threads,
                           bb_embree **out);
void bb_embree_destroy(bb_embree *embree); /* NULL is allowed */

/* Builds, the second and later times again from the same geometry, reusing memory: from geometry in
 * Embree's buffers to a scene that can be traced, including primitive boxes and leaf data. Threads
 * sleep between calls. */
bb_status bb_embree_build(bb_embree *embree);

/* Says how bb_embree_trace() passes rays from now on, by the specification's query (NULL: single).
 * BB_UNSUPPORTED, by name, if the library that was loaded lacks it. */
bb_status bb_embree_pass(bb_embree *embree, const bb_spec *spec);

/* Returns the bytes that Embree has currently allocated. */
uint64_t bb_embree_bytes(const bb_embree *embree);

/* Traces by closest-hit calls or, with `any`, by occlusion calls, of the kind that the
 * specification's query says, on the calling thread, of which there may be several. Packets and
 * streams are filled from `rays` and emptied into `hits` within the call. Hits have t and the
 * primitive in the scene's numbering; any hits are (0, BB_UNNAMED), since Embree does not name the
 * primitive. A ray with a number beyond 1.8e18 is not passed to Embree: it misses, and is judged
 * so. */
bb_status bb_embree_trace(bb_embree *embree, const bb_ray *rays, uint32_t count, bool any,
                          bb_hit *hits);

#endif
