/* Embree's own header, for the two files that call it: framework/embree.c and builders/embree. Embree 3; the names that Embree 4
 * gave to a few calls (rtcIntersect1's arguments, RTC_FEATURE_FLAG ...) would be mapped here.
 */
#ifndef BB_EMBREE_API_H
#define BB_EMBREE_API_H

#include <embree3/rtcore.h>

#if RTC_VERSION_MAJOR != 3
#error "bvhbench is written for Embree 3"
#endif

#endif
