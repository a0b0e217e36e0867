/* Embree's own header, for the two files that call it, framework/judge/embree.c and
 * builders/embree, and our own names for the few calls that Embree 4 changed. CMake sets which
 * version it found (BB_EMBREE_MAJOR).
 */
#ifndef BB_EMBREE_API_H
#define BB_EMBREE_API_H

/* The argument of the calls below besides scene and ray: its type, and whether it precedes or
 * follows the ray. */
#if BB_EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
typedef struct RTCIntersectContext bb_intersect_arguments, bb_occluded_arguments;
#define BB_INIT_INTERSECT rtcInitIntersectContext
#define BB_INIT_OCCLUDED rtcInitIntersectContext
#define BB_COHERENT RTC_INTERSECT_CONTEXT_FLAG_COHERENT
#define BB_RAY_AND_ARGUMENTS(ray, arguments) (arguments), (ray)
#elif BB_EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
typedef struct RTCIntersectArguments bb_intersect_arguments;
typedef struct RTCOccludedArguments bb_occluded_arguments;
#define BB_INIT_INTERSECT rtcInitIntersectArguments
#define BB_INIT_OCCLUDED rtcInitOccludedArguments
#define BB_COHERENT RTC_RAY_QUERY_FLAG_COHERENT
#define BB_RAY_AND_ARGUMENTS(ray, arguments) (ray), (arguments)
#else
#error "bvhbench needs Embree 3 or 4: CMake sets BB_EMBREE_MAJOR"
#endif

/* Initialises arguments for rays without filters, once for many rays. */
static inline void bb_intersect_arguments_init(bb_intersect_arguments *arguments, bool coherent)
{
    BB_INIT_INTERSECT(arguments);
    if (coherent)
        arguments->flags = BB_COHERENT;
}

static inline void bb_occluded_arguments_init(bb_occluded_arguments *arguments, bool coherent)
{
    BB_INIT_OCCLUDED(arguments);
    if (coherent)
        arguments->flags = BB_COHERENT;
}

/* Member `m` of ray `i` of a packet of n rays whose size is known at run time: each member is an
 * array of n. Embree has such accessors for C++ only. */
#define BB_RAY_MEMBER(type, rays, n, i, m) (((type *)(rays))[(size_t)(m) * (n) + (i)])
enum { BB_RAY_ORG = 0, BB_RAY_TNEAR = 3, BB_RAY_DIR = 4, BB_RAY_TFAR = 8 };
/* of ray and hit together */
enum { BB_HIT_PRIM = 17, BB_HIT_GEOMETRY = 18, BB_HIT_INSTANCE = 19 };

/* The calls. Of a packet, `valid` has -1 for each ray that is traced, and 0 for others. */
#define BB_INTERSECT1(scene, hit, arguments)                                                       \
    rtcIntersect1(scene, BB_RAY_AND_ARGUMENTS(hit, arguments))
#define BB_OCCLUDED1(scene, ray, arguments)                                                        \
    rtcOccluded1(scene, BB_RAY_AND_ARGUMENTS(ray, arguments))
#define BB_INTERSECT_PACKET(n, valid, scene, hits, arguments)                                      \
    rtcIntersect##n(valid, scene, BB_RAY_AND_ARGUMENTS(hits, arguments))
#define BB_OCCLUDED_PACKET(n, valid, scene, rays, arguments)                                       \
    rtcOccluded##n(valid, scene, BB_RAY_AND_ARGUMENTS(rays, arguments))

#endif
