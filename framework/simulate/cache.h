/* A cache of lines of 128 bytes in sectors of 32, set-associative, of which the line used longest
 * ago gives way. A sector is fetched alone, as GPUs do. */
#ifndef BB_CACHE_H
#define BB_CACHE_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    BB_SECTOR_BYTES = 32,
    BB_LINE_SECTORS = 4,
    BB_LINE_BYTES = BB_SECTOR_BYTES * BB_LINE_SECTORS
};

typedef struct bb_cache_line {
    uint64_t tag;             /* address / BB_LINE_BYTES, plus one; 0: none */
    uint64_t used;            /* time of the last access */
    uint8_t present, written; /* bit i: sector i */
} bb_cache_line;

typedef struct bb_cache {
    uint32_t sets, ways;
    uint64_t time;
    bb_cache_line *lines; /* [sets][ways] */
} bb_cache;

/* What an access asks of the next level. */
typedef struct bb_cache_miss {
    bool fetched;    /* the sector is read from there */
    uint8_t written; /* bit i: sector i of the line that gave way is written there */
    uint64_t line;   /* that line's address */
} bb_cache_miss;

/* An empty cache of so many bytes, at least a line; `ways` is lowered if there are fewer lines, and
 * the number of sets is rounded down. */
bb_status bb_cache_create(uint64_t bytes, uint32_t ways, bb_cache *cache);
void bb_cache_release(bb_cache *cache); /* a zeroed one is allowed */

/* Reads or writes the sector at `address`, a multiple of BB_SECTOR_BYTES. A sector that is written
 * is not fetched, and is written back when its line gives way. Returns whether it was there. */
bool bb_cache_access(bb_cache *cache, uint64_t address, bool write, bb_cache_miss *miss);

#endif
