#include "framework/simulate/cache.h"

#include "framework/base/memory.h"

#include <string.h>

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
static uint32_t set_of(const bb_cache *cache, uint64_t line)
{
    return (uint32_t)((line * 0x9E3779B97F4A7C15ull >> 32) * cache->sets >> 32);
}

/* Returns the line's place: where it is, or that of the one that gives way, which is then empty. */
static bb_cache_line *find(bb_cache *cache, uint64_t line, bb_cache_miss *miss)
{
    bb_cache_line *set = cache->lines + (size_t)set_of(cache, line) * cache->ways, *oldest = set;
    for (uint32_t i = 0; i < cache->ways; i++) {
        if (set[i].tag == line + 1)
            return &set[i];
        if (set[i].used < oldest->used)
            oldest = &set[i];
    }
    if (oldest->written != 0) {
        miss->written = oldest->written;
        miss->line = (oldest->tag - 1) * BB_LINE_BYTES;
    }
    *oldest = (bb_cache_line){.tag = line + 1};
    return oldest;
}

bool bb_cache_access(bb_cache *cache, uint64_t address, bool write, bb_cache_miss *miss)
{
    *miss = (bb_cache_miss){0};
    bb_cache_line *line = find(cache, address / BB_LINE_BYTES, miss);
    const uint8_t sector = (uint8_t)(1u << (address / BB_SECTOR_BYTES % BB_LINE_SECTORS));
    const bool hit = (line->present & sector) != 0;
    line->used = ++cache->time;
    line->present |= sector;
    if (write)
        line->written |= sector;
    miss->fetched = !hit && !write;
    return hit;
}
