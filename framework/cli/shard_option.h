/* The value of --shard: I/N. */
#ifndef BB_SHARD_OPTION_H
#define BB_SHARD_OPTION_H

#include "framework/bench/bench.h"

/* Parts of a run at most. */
enum { BB_SHARDS_MAX = 100000 };

/* "2/8". BB_INVALID, with `what`, if it is not I/N with 1 <= I <= N. */
bb_status bb_shard_parse(const char *text, const char *what, bb_shard *shard);

#endif
