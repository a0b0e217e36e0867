/* Shared by embree.c, which builds, and embree_trace.c, which traces. */
#ifndef BB_EMBREE_PRIVATE_H
#define BB_EMBREE_PRIVATE_H

#include "framework/judge/embree.h"

#include "framework/judge/embree_api.h"

#include <stdatomic.h>

/* How rays are passed to Embree. */
typedef enum bb_embree_query {
    BB_QUERY_SINGLE,
    BB_QUERY_PACKET4,
    BB_QUERY_PACKET8,
    BB_QUERY_PACKET16,
    BB_QUERY_STREAM,
} bb_embree_query;

/* Argument of Embree's callbacks for a user geometry, one per kind. */
typedef struct user_kind {
    const bb_scene *scene;
    uint32_t kind;
} user_kind;

struct bb_embree {
    const bb_scene *of;
    RTCDevice device;
    RTCScene scene;
    bb_embree_query query;
    bool coherent;                      /* rays of a call are said to be near each other */
    uint32_t first_prim[BB_KIND_COUNT]; /* per geometry, in the scene's numbering */
    uint32_t geometries;
    bool built; /* once before */
    user_kind users[BB_KIND_COUNT];
    atomic_llong bytes;
    _Atomic int error; /* first error that Embree reported since the last check */
    char text[200];
};

#endif
