/* Builders and searches against each other in finding where two meshes overlap: `bvhbench overlap`.
 */
#ifndef BB_OVERLAP_CONTEST_H
#define BB_OVERLAP_CONTEST_H

#include "framework/contest/contest.h"
#include "framework/overlap/overlap.h"
#include "framework/show/outline.h"

typedef struct bb_overlap_request {
    bb_device *device;
    const char *const *builders; /* specifications; each builds both trees */
    uint32_t builder_count;
    const char *const *searches; /* see bb_tet_search_parse() */
    uint32_t search_count;
    bool without;     /* also by looking at all pairs, which the others are compared with */
    uint32_t repeats; /* rounds that count, after one that does not */
    uint64_t seed;
    bool quiet; /* no progress */
} bb_overlap_request;

typedef struct bb_overlap_mesh {
    char scene[256];
    uint32_t tets, boundary, flat;
    uint32_t meeting;  /* of these, how many meet the other mesh */
    uint32_t *answers; /* per tetrahedron 1 or 0 */
} bb_overlap_mesh;

typedef struct bb_overlap_result {
    char scene[520]; /* "A and B" */
    bb_overlap_mesh meshes[2];
    uint32_t picture_count;
    char pictures[BB_VIEWS_MAX][64]; /* names of PNG files */
    uint32_t way_count;
    bb_contest_way ways[BB_CONTEST_WAYS_MAX];
} bb_overlap_result;

/* Both scenes are on the device, and may be one. Each asks the other; times are of both directions
 * together. What a builder or search cannot do is said in its way. The result is released also
 * after a failure. */
bb_status bb_overlap_run(const bb_overlap_request *request, bb_scene *const scenes[2],
                         bb_overlap_result *result);
void bb_overlap_release(bb_overlap_result *result);

/* Shows both meshes without what meets the other, from outside, as PNG files of `folder`; the
 * result gets their names. */
bb_status bb_overlap_paint(bb_scene *const scenes[2], const char *folder,
                           bb_overlap_result *result);

extern const bb_page_outline bb_overlap_outline;

/* Adds the result to a table. */
void bb_overlap_fill(const bb_overlap_result *result, bb_table *table);

#endif
