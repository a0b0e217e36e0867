/* Whether a ray hits anything; a named hit is one of its hits. */
#include "framework/judge/judge_hits.h"
#include "framework/judge/queries.h"
#include "framework/scene/scene.h"

static bool same(const void *a, const void *b)
{
    return (((const bb_hit *)a)->prim == BB_NONE) == (((const bb_hit *)b)->prim == BB_NONE);
}

const bb_query bb_query_any = {
    .name = "any",
    .asks = "any hit",
    .define = "BB_QUERY_ANY",
    .way = BB_ALONG_RAYS,
    .kinds = BB_ALL_KINDS,
    .result_bytes = sizeof(bb_hit),
    .is_hit = true,
    .is_recorded = true,
    .any = true,
    .exchange = 1,
    .same = same,
    .say = bb_hit_say,
    .judge = bb_judge_hits,
};
