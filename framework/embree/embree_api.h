/* Embree's own header, for the two files that call it, framework/embree/embree.c and
 * builders/embree; and the few calls whose form Embree 4 changed, by names of our own. CMake says
 * which of the two it found (BB_EMBREE_MAJOR).
 */
#ifndef BB_EMBREE_API_H
#define BB_EMBREE_API_H

#if BB_EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
#elif BB_EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
#else
#error "bvhbench needs Embree 3 or 4: CMake sets BB_EMBREE_MAJOR"
#endif

/* What rtcIntersect1() and rtcOccluded1() take beside scene and ray: incoherent rays, no filters.
 * Made once for many rays. */
#if BB_EMBREE_MAJOR == 3

typedef struct RTCIntersectContext bb_intersect_arguments;
typedef struct RTCIntersectContext bb_occluded_arguments;

static inline void bb_intersect_arguments_init(bb_intersect_arguments *arguments)
{
    rtcInitIntersectContext(arguments);
}

static inline void bb_occluded_arguments_init(bb_occluded_arguments *arguments)
{
    rtcInitIntersectContext(arguments);
}

static inline void bb_intersect1(RTCScene scene, struct RTCRayHit *hit,
                                 bb_intersect_arguments *arguments)
{
    rtcIntersect1(scene, arguments, hit);
}

static inline void bb_occluded1(RTCScene scene, struct RTCRay *ray,
                                bb_occluded_arguments *arguments)
{
    rtcOccluded1(scene, arguments, ray);
}

#else

typedef struct RTCIntersectArguments bb_intersect_arguments;
typedef struct RTCOccludedArguments bb_occluded_arguments;

static inline void bb_intersect_arguments_init(bb_intersect_arguments *arguments)
{
    rtcInitIntersectArguments(arguments);
}

static inline void bb_occluded_arguments_init(bb_occluded_arguments *arguments)
{
    rtcInitOccludedArguments(arguments);
}

static inline void bb_intersect1(RTCScene scene, struct RTCRayHit *hit,
                                 bb_intersect_arguments *arguments)
{
    rtcIntersect1(scene, hit, arguments);
}

static inline void bb_occluded1(RTCScene scene, struct RTCRay *ray,
                                bb_occluded_arguments *arguments)
{
    rtcOccluded1(scene, ray, arguments);
}

#endif

#endif
