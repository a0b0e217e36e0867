/* What is asked of a ray: one constant struct per query, bb_query_NAME in
 * framework/judge/query_NAME.c, which CMake finds, beside kernels/query_NAME.clh. */
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

/* How kernels come to an answer; a kernel says which of these it can. */
enum {
    BB_ALONG_RAYS = 1u << 0, /* by a search along the ray (kernels/search.clh) */
};

enum { BB_RESULT_BYTES_MAX = 16 }; /* of a result of any query */

typedef struct bb_query {
    const char *name;    /* "closest": in records and messages */
    const char *asks;    /* in a line: "closest hit" */
    const char *define;  /* what kernels/search.clh knows it by */
    uint32_t way;        /* BB_ALONG_RAYS */
    uint32_t kinds;      /* of primitives that it is defined for, as bits */
    size_t result_bytes; /* of one ray's answer, on the device and in memory */
    bool is_hit;         /* the answer is a bb_hit: Embree and outside tracers can give it */
    bool any;            /* of several hits any will do */
    uint32_t exchange;   /* its number in rays files, if it is a hit */

    /* Whether two answers to one ray are the same, as those of `exact` cells must be. */
    bool (*same)(const void *a, const void *b);
    /* The answer in words. */
    void (*say)(const void *result, char *text, size_t capacity);
    /* Judges request->results. */
    bb_status (*judge)(struct bb_oracle *oracle, struct bb_answers *answers,
                       const struct bb_verdict_request *request, struct bb_accuracy *accuracy);
} bb_query;

#endif
