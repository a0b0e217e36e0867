/* A query about a ray: one constant struct each, bb_query_NAME in framework/judge/query_NAME.c,
 * which CMake finds, and kernels/query_NAME.clh. */
#ifndef BB_QUERY_H
#define BB_QUERY_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct bb_accuracy;
struct bb_answers;
struct bb_oracle;
struct bb_verdict_request;

/* Ways in which kernels find an answer; a kernel declares those that it supports. */
enum {
    BB_ALONG_RAYS = 1u << 0, /* by a search along the ray (kernels/search.clh) */
};

enum { BB_RESULT_BYTES_MAX = 16 }; /* largest result of any query */

typedef struct bb_query {
    const char *name;    /* "closest": in records and messages */
    const char *asks;    /* in a heading: "closest hit" */
    const char *define;  /* its name in kernels/search.clh */
    uint32_t way;        /* BB_ALONG_RAYS */
    uint32_t kinds;      /* kinds of primitives that it is defined for, as bits */
    size_t result_bytes; /* size of one ray's answer, on the device and in memory */
    bool is_hit;         /* the answer is a bb_hit: Embree and outside tracers can give it */
    bool is_recorded;    /* steps of a search for it can be recorded (kernels/steps.clh) */
    bool any;            /* any of several hits is right */
    uint32_t exchange;   /* its number in rays files, if its answer is a bb_hit */

    /* Returns whether two answers to one ray are equal, as those of `exact` cells must be. */
    bool (*same)(const void *a, const void *b);
    /* The answer in words. */
    void (*say)(const void *result, char *text, size_t capacity);
    /* Judges request->results. */
    bb_status (*judge)(struct bb_oracle *oracle, struct bb_answers *answers,
                       const struct bb_verdict_request *request, struct bb_accuracy *accuracy);
} bb_query;

#endif
