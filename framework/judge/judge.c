#include "framework/judge/judge.h"

#include "framework/base/clock.h"
#include "framework/judge/queries.h"

#include <string.h>

const bb_query *bb_query_find(const char *name)
{
    for (const bb_query *const *query = bb_queries; *query != NULL; query++)
        if (strcmp((*query)->name, name) == 0)
            return *query;
    return NULL;
}

bb_status bb_judge(bb_oracle *oracle, bb_answers *answers, const bb_verdict_request *request,
                   bb_accuracy *accuracy)
{
    double start = bb_wall_ms();
    memset(accuracy, 0, sizeof *accuracy);
    if (request->count > answers->rays->count)
        return bb_fail(BB_INVALID, "%u hits for %u rays: give at most one per ray", request->count,
                       answers->rays->count);
    bb_status status = answers->rays->query->judge(oracle, answers, request, accuracy);
    accuracy->judge_ms = bb_wall_ms() - start;
    return status;
}
