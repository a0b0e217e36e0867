/* The interface to Embree, version 3 or 4: as oracle, and as the reference that traces with its own
 * trees. (Only builders/embree calls Embree elsewhere, for rtcBuildBVH.)
 */
#ifndef BB_EMBREE_H
#define BB_EMBREE_H

#include "framework/judge/rays.h"
#include "framework/scene/scene.h"

typedef struct bb_embree bb_embree;

extern const bb_option bb_embree_options[]; /* quality, mode, query */

/* The calls that trace, for the record; the specification's query says which. */
#define BB_EMBREE_API "rtcIntersect and rtcOccluded: 1, 4, 8, 16 or 1M, by query="

/* Named in the record in place of a kernel, since the reference traces by itself. */
#define BB_EMBREE_KERNEL "embree"

/* Writes the version of the loaded Embree, such as "3.13.5". BB_FAILED if it cannot open a
 * device. */
bb_status bb_embree_version(char *text, size_t capacity);

/* Builds Embree's own scene; `threads` threads build and trace. `spec` gives quality and mode;
 * NULL: medium, robust. *build_ms: wall time of the first build on fresh memory (may be NULL). A
 * build is rtcCommitGeometry and rtcCommitScene: from geometry in Embree's buffers to a scene that
 * can be traced, including primitive boxes and leaf data. Threads sleep between calls. */
bb_status bb_embree_create(const bb_scene *scene, const bb_spec *spec, uint32_t threads,
                           bb_embree **out, double *build_ms);
void bb_embree_destroy(bb_embree *embree);

/* Builds again from the same geometry, reusing memory; *ms as above. */
bb_status bb_embree_rebuild(bb_embree *embree, double *ms);

/* Says how bb_embree_trace() passes rays from now on, by the specification's query (NULL: single).
 * BB_UNSUPPORTED, by name, if the library that was loaded lacks it. */
bb_status bb_embree_set_query(bb_embree *embree, const bb_spec *spec);

/* Returns whether the two specifications differ in their query at most: one tree serves both. */
bool bb_embree_same_tree(const bb_spec *a, const bb_spec *b);

/* Returns the bytes that Embree has currently allocated. */
uint64_t bb_embree_bytes(const bb_embree *embree);

/* Wall time of the last bb_embree_trace(), as its threads saw it, in ms. */
double bb_embree_span_ms(const bb_embree *embree);

/* Traces by closest-hit or occlusion calls of the kind that the specification's query says, on all
 * threads, which take chunks from one counter. Packets and streams are filled from `rays` and
 * emptied into `hits` within the call. Hits have t and the primitive in the scene's numbering. For
 * any-hit queries a hit is (0, BB_UNNAMED): Embree does not name the primitive. A ray with a number
 * beyond 1.8e18 is not passed to Embree: it misses, and is judged so. */
bb_status bb_embree_trace(bb_embree *embree, const bb_ray *rays, uint32_t count,
                          const bb_query *query, bb_hit *hits);

#endif
