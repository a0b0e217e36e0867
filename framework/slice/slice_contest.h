/* Builders and searches against each other in slicing a mesh: `bvhbench slice`. */
#ifndef BB_SLICE_CONTEST_H
#define BB_SLICE_CONTEST_H

#include "framework/contest/contest.h"
#include "framework/show/outline.h"
#include "framework/slice/slice.h"

typedef struct bb_slice_request {
    bb_device *device;
    const char *const *builders; /* specifications */
    uint32_t builder_count;
    const char *const *searches; /* see bb_tet_search_parse() */
    uint32_t search_count;
    bool without;       /* also by looking at all tetrahedra, which the others are compared with */
    bb_slice_plan plan; /* see bb_slice_plan_check() */
    uint32_t repeats;   /* rounds that count, after one that does not */
    uint64_t seed;
    bool quiet;           /* no progress */
    const char *pictures; /* the beginning of paths of PNG and EXR files; NULL: none */
    bool exr;
} bb_slice_request;

typedef struct bb_slice_result {
    char scene[256], field[64];
    uint32_t tets, boundary;
    bb_slice_plan plan;
    uint64_t voxels;           /* of all slices */
    uint64_t filled, extended; /* with material; of these, beyond a tetrahedron */
    uint32_t way_count;
    bb_contest_way ways[BB_CONTEST_WAYS_MAX];
} bb_slice_result;

/* The scene is on the device. What a builder or search cannot do is said in its way. */
bb_status bb_slice_run(const bb_slice_request *request, bb_scene *scene, bb_slice_result *result);

extern const bb_page_outline bb_slice_outline;

/* Adds the result to a table. `pictures`: what the names of its PNG files begin with, as in
 * request.pictures, but from the table's folder; NULL: there are none. */
void bb_slice_fill(const bb_slice_result *result, const char *pictures, bb_table *table);

#endif
