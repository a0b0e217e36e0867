#include "framework/simulate/cache.h"

#include "framework/base/memory.h"

#include <string.h>

/* The word of a line (cache.h). */
enum { PRESENT = BB_LINE_SECTORS, THERE = 2 * BB_LINE_SECTORS, LINE = THERE + 1 };
#define ALL_SECTORS ((1u << BB_LINE_SECTORS) - 1u)

bb_status bb_cache_create(uint64_t bytes, uint32_t ways, bb_cache *cache)
{
    const uint64_t lines = bytes / BB_LINE_BYTES > 0 ? bytes / BB_LINE_BYTES : 1;
    *cache = (bb_cache){.ways = ways < lines ? ways : (uint32_t)lines};
    cache->sets = (uint32_t)(lines / cache->ways);
    const size_t size = (size_t)cache->sets * cache->ways * sizeof *cache->lines;
    BB_TRY(bb_host_alloc(NULL, size, "simulated cache", &cache->lines));
    memset(cache->lines, 0, size);
    return BB_OK;
}

void bb_cache_release(bb_cache *cache)
{
    bb_host_free(cache->lines);
    *cache = (bb_cache){0};
}

/* Spreads lines over the sets, also of arrays whose strides are powers of two. */
uint32_t bb_cache_set_of(const bb_cache *cache, uint64_t address)
{
    const uint64_t line = address / BB_LINE_BYTES;
    return (uint32_t)((line * 0x9E3779B97F4A7C15ull >> 32) * cache->sets >> 32);
}

/* The word of a line that is there, without its sectors. */
static uint64_t word_of(uint64_t address)
{
    return (address / BB_LINE_BYTES << 1 | 1) << THERE;
}

/* Returns the line's word at the front of its set: as it was, or in place of the last, which gives
 * way. */
static uint64_t *to_front(bb_cache *cache, uint64_t address, bb_cache_miss *miss)
{
    uint64_t *set = cache->lines + (size_t)bb_cache_set_of(cache, address) * cache->ways;
    const uint64_t word = word_of(address);
    uint64_t found = set[0];
    for (uint32_t i = 1; found >> THERE != word >> THERE && i < cache->ways; i++) {
        const uint64_t next = set[i];
        set[i] = found;
        found = next;
    }
    if (found >> THERE != word >> THERE) {
        miss->written = found & ALL_SECTORS;
        miss->line = (found >> LINE) * BB_LINE_BYTES;
        found = word;
    }
    set[0] = found;
    return set;
}

bool bb_cache_access(bb_cache *cache, uint64_t address, bool write, bb_cache_miss *miss)
{
    *miss = (bb_cache_miss){0};
    uint64_t *line = to_front(cache, address, miss);
    const uint64_t sector = 1ull << (address / BB_SECTOR_BYTES % BB_LINE_SECTORS);
    const bool hit = (*line >> PRESENT & sector) != 0;
    *line |= sector << PRESENT;
    if (write)
        *line |= sector;
    miss->fetched = !hit && !write;
    return hit;
}

void bb_cache_hold(bb_cache *cache, uint64_t address)
{
    bb_cache_miss miss;
    *to_front(cache, address, &miss) |= (uint64_t)ALL_SECTORS << PRESENT;
}

uint8_t bb_cache_flush(bb_cache *cache, size_t i, uint64_t *line)
{
    const uint8_t written = cache->lines[i] & ALL_SECTORS;
    *line = (cache->lines[i] >> LINE) * BB_LINE_BYTES;
    cache->lines[i] = 0;
    return written;
}
