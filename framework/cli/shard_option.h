/* The value of --shard: I/N. */
#ifndef BB_SHARD_OPTION_H
#define BB_SHARD_OPTION_H

#include "framework/bench/bench.h"

/* Most parts of a run. */
enum { BB_SHARDS_MAX = 100000 };

/* Reads a shard, such as "2/8". BB_INVALID if it is not I/N with 1 <= I <= N; the message begins
 * with `what`. */
bb_status bb_shard_parse(const char *text, const char *what, bb_shard *shard);

#endif
