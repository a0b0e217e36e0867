/* Embree's own header, for the two files that call it, framework/embree/embree.c and
 * builders/embree; and the few calls whose form Embree 4 changed, by names of our own. CMake says
 * which of the two it found (BB_EMBREE_MAJOR).
 */
#ifndef BB_EMBREE_API_H
#define BB_EMBREE_API_H

/* What the calls below take beside scene and ray: how it is made, and whether it comes before the
 * ray or after it. */
#if BB_EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
typedef struct RTCIntersectContext bb_intersect_arguments, bb_occluded_arguments;
#define BB_INIT_INTERSECT rtcInitIntersectContext
#define BB_INIT_OCCLUDED rtcInitIntersectContext
#define BB_RAY_AND_ARGUMENTS(ray, arguments) (arguments), (ray)
#elif BB_EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
typedef struct RTCIntersectArguments bb_intersect_arguments;
typedef struct RTCOccludedArguments bb_occluded_arguments;
#define BB_INIT_INTERSECT rtcInitIntersectArguments
#define BB_INIT_OCCLUDED rtcInitOccludedArguments
#define BB_RAY_AND_ARGUMENTS(ray, arguments) (ray), (arguments)
#else
#error "bvhbench needs Embree 3 or 4: CMake sets BB_EMBREE_MAJOR"
#endif

/* Arguments that say: incoherent rays, no filters. Made once for many rays. */
static inline void bb_intersect_arguments_init(bb_intersect_arguments *arguments)
{
    BB_INIT_INTERSECT(arguments);
}

static inline void bb_occluded_arguments_init(bb_occluded_arguments *arguments)
{
    BB_INIT_OCCLUDED(arguments);
}

static inline void bb_intersect1(RTCScene scene, struct RTCRayHit *hit,
                                 bb_intersect_arguments *arguments)
{
    rtcIntersect1(scene, BB_RAY_AND_ARGUMENTS(hit, arguments));
}

static inline void bb_occluded1(RTCScene scene, struct RTCRay *ray,
                                bb_occluded_arguments *arguments)
{
    rtcOccluded1(scene, BB_RAY_AND_ARGUMENTS(ray, arguments));
}

#endif
