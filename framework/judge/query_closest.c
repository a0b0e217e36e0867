/* The nearest hit of a ray, and its primitive. */
#include "framework/judge/judge_hits.h"
#include "framework/judge/queries.h"
#include "framework/scene/scene.h"

#include <string.h>

static bool same(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(bb_hit)) == 0;
}

const bb_query bb_query_closest = {
    .name = "closest",
    .asks = "closest hit",
    .define = "BB_QUERY_CLOSEST",
    .way = BB_ALONG_RAYS,
    .kinds = BB_ALL_KINDS,
    .result_bytes = sizeof(bb_hit),
    .is_hit = true,
    .is_recorded = true,
    .exchange = 0,
    .same = same,
    .say = bb_hit_say,
    .judge = bb_judge_hits,
};
