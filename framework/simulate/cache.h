/* A cache of lines of 128 bytes in sectors of 32, set-associative, of which the line used longest
 * ago gives way. A sector is fetched alone, as GPUs do. */
#ifndef BB_CACHE_H
#define BB_CACHE_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    BB_SECTOR_BYTES = 32,
    BB_LINE_SECTORS = 4,
    BB_LINE_BYTES = BB_SECTOR_BYTES * BB_LINE_SECTORS
};

/* The lines of a set, the one used last first. A line is a word: from the top its address /
 * BB_LINE_BYTES, a bit that is set for all lines but empty ones, a bit for each sector that is
 * present, and one for each that was written. */
typedef struct bb_cache {
    uint32_t sets, ways;
    uint64_t *lines; /* [sets][ways] */
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

/* Returns the set that holds the line at this address. */
uint32_t bb_cache_set_of(const bb_cache *cache, uint64_t address);

/* Reads or writes the sector at `address`, a multiple of BB_SECTOR_BYTES. A sector that is written
 * is not fetched, and is written back when its line gives way. Returns whether it was there. */
bool bb_cache_access(bb_cache *cache, uint64_t address, bool write, bb_cache_miss *miss);

/* Has all sectors of the line at this address, as if they had been read. */
void bb_cache_hold(bb_cache *cache, uint64_t address);

/* Empties line number i of sets * ways; returns the sectors of it that have to be written, and its
 * address in *line. */
uint8_t bb_cache_flush(bb_cache *cache, size_t i, uint64_t *line);

#endif
