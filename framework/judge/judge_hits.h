/* Functions shared by the queries whose answer is a bb_hit. */
#ifndef BB_JUDGE_HITS_H
#define BB_JUDGE_HITS_H

#include "framework/judge/judge.h"

/* They implement bb_query.judge and bb_query.say of these queries. */
bb_status bb_judge_hits(bb_oracle *oracle, bb_answers *answers, const bb_verdict_request *request,
                        bb_accuracy *accuracy);
void bb_hit_say(const void *result, char *text, size_t capacity);

#endif
