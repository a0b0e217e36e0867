#include "framework/simulate/machine.h"

#include "framework/base/arithmetic.h"
#include "framework/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    /* an array begins with each multiple of 2^40 */
    BASE_SHIFT = 40,
    RAYS = 1,
    RESULTS,
    NODES,
    PRIMS,
    PRIVATE,
    /* of a lane */
    ENTRY_WORDS = 2,
    ENTRIES_MOST = 1 << 12,
    /* sectors of a step: each lane reads a node of 256 bytes or two words */
    SECTORS_MOST = BB_WARP_MOST * 16
};

typedef struct unit {
    bb_cache cache;
    bb_warp *slots; /* [in_flight] */
    bool *busy;
    uint32_t turn;    /* slot */
    uint32_t running; /* groups */
} unit;

typedef struct run {
    const bb_machine *machine;
    const bb_footing *footing;
    const bb_steps *steps;
    bb_traffic *traffic;
    unit *units;
    bb_cache second;
    uint32_t next, groups; /* of rays */
} run;

/* Sorts a few values, and keeps one of each. */
static uint32_t sort_unique(uint64_t *values, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t value = values[i];
        uint32_t at = kept;
        while (at > 0 && values[at - 1] > value)
            at--;
        if (at > 0 && values[at - 1] == value)
            continue;
        memmove(values + at + 1, values + at, (kept - at) * sizeof *values);
        values[at] = value;
        kept++;
    }
    return kept;
}

/* Gets the distinct sectors of items [bytes] of an array that the lanes name. */
static uint32_t sectors_of(const bb_issue *issue, uint32_t array, uint32_t bytes, uint64_t *sectors)
{
    uint64_t items[BB_WARP_MOST];
    uint32_t count = 0, n = 0;
    for (uint64_t rest = issue->lanes; rest != 0; rest &= rest - 1)
        items[count++] = issue->index[__builtin_ctzll(rest)];
    count = sort_unique(items, count);
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t at = ((uint64_t)array << BASE_SHIFT) + items[i] * bytes;
        for (uint64_t s = at / BB_SECTOR_BYTES; s <= (at + bytes - 1) / BB_SECTOR_BYTES; s++)
            if (n == 0 || sectors[n - 1] != s)
                sectors[n++] = s;
    }
    return n;
}

/* The same of stack entries, whose words lie side by side for all lanes of a slot. */
static uint32_t sectors_of_stack(const bb_issue *issue, uint32_t width, uint64_t slot,
                                 uint64_t *sectors)
{
    uint32_t n = 0;
    const uint64_t base =
        ((uint64_t)PRIVATE << BASE_SHIFT) + slot * ENTRIES_MOST * ENTRY_WORDS * width * 4;
    for (uint32_t i = 0; i < width; i++)
        for (uint32_t word = 0; (issue->lanes >> i & 1) != 0 && word < ENTRY_WORDS; word++) {
            const uint64_t row = (uint64_t)issue->index[i] * ENTRY_WORDS + word;
            sectors[n++] = (base + (row * width + i) * 4) / BB_SECTOR_BYTES;
        }
    return sort_unique(sectors, n);
}

static void to_memory(run *r, uint8_t written)
{
    r->traffic->written += (unsigned)__builtin_popcount(written);
}

static void ask_second(run *r, uint64_t address, bool write)
{
    bb_cache_miss miss;
    const bool hit = bb_cache_access(&r->second, address, write, &miss);
    if (write) {
        r->traffic->second_written++;
    } else {
        r->traffic->second++;
        r->traffic->second_hits += hit;
    }
    r->traffic->read += miss.fetched;
    to_memory(r, miss.written);
}

static void write_back(run *r, const bb_cache_miss *miss)
{
    for (uint32_t s = 0; s < BB_LINE_SECTORS; s++)
        if ((miss->written >> s & 1) != 0)
            ask_second(r, miss->line + s * BB_SECTOR_BYTES, true);
}

static void ask_first(run *r, unit *u, uint64_t sector, bool write)
{
    bb_cache_miss miss;
    const uint64_t address = sector * BB_SECTOR_BYTES;
    r->traffic->first++;
    r->traffic->first_hits += bb_cache_access(&u->cache, address, write, &miss);
    write_back(r, &miss);
    if (miss.fetched)
        ask_second(r, address, false);
}

static void issue_step(run *r, unit *u, uint64_t slot, const bb_issue *issue)
{
    const bb_footing *f = r->footing;
    uint64_t sectors[SECTORS_MOST], line = UINT64_MAX;
    uint32_t count = 0;
    switch (issue->kind) {
    case BB_STEP_NODE:
        count = sectors_of(issue, NODES, f->node_bytes, sectors);
        break;
    case BB_STEP_PRIMS:
        count = sectors_of(issue, PRIMS, f->prim_bytes, sectors);
        break;
    case BB_ISSUE_BEGIN:
        count = sectors_of(issue, RAYS, sizeof(bb_ray), sectors);
        break;
    case BB_ISSUE_END:
        count = sectors_of(issue, RESULTS, f->result_bytes, sectors);
        break;
    case BB_STEP_PUSH:
    case BB_STEP_POP:
        count = sectors_of_stack(issue, r->machine->width, slot, sectors);
        break;
    default:
        break;
    }
    bb_issued *sum = &r->traffic->issued[issue->kind];
    sum->count++;
    sum->lanes += (unsigned)__builtin_popcountll(issue->lanes);
    sum->sectors += count;
    const bool write = issue->kind == BB_STEP_PUSH || issue->kind == BB_ISSUE_END;
    for (uint32_t i = 0; i < count; i++) {
        sum->lines += sectors[i] / BB_LINE_SECTORS != line;
        line = sectors[i] / BB_LINE_SECTORS;
        ask_first(r, u, sectors[i], write);
    }
}

/* Gives the next group to the first free slot of the unit, if there are both. */
static void take_group(run *r, unit *u)
{
    const uint32_t width = r->machine->width;
    for (uint32_t s = 0; s < r->machine->in_flight && r->next < r->groups; s++) {
        if (u->busy[s])
            continue;
        const uint32_t first = r->next++ * width;
        bb_warp_start(&u->slots[s], r->steps, r->footing->control, r->footing->ring, first,
                      bb_min_u32(width, r->steps->rays - first));
        u->busy[s] = true;
        u->running++;
        return;
    }
}

/* A unit's turn in a round: a step of the next of its groups that has one. */
static void take_turn(run *r, unit *u)
{
    bb_issue issue;
    const uint32_t slots = r->machine->in_flight;
    while (u->running > 0) {
        const uint32_t s = u->turn;
        u->turn = (s + 1) % slots;
        if (!u->busy[s])
            continue;
        if (bb_warp_next(&u->slots[s], &issue)) {
            issue_step(r, u, (uint64_t)(u - r->units) * slots + s, &issue);
            return;
        }
        u->busy[s] = false;
        u->running--;
        take_group(r, u);
    }
}

static void run_rounds(run *r)
{
    const uint32_t units = r->machine->units;
    /* groups are dealt out to the units by turns */
    for (uint32_t s = 0; s < r->machine->in_flight; s++)
        for (uint32_t i = 0; i < units; i++)
            take_group(r, &r->units[i]);
    for (bool any = true; any;) {
        any = false;
        for (uint32_t i = 0; i < units; i++) {
            take_turn(r, &r->units[i]);
            any = any || r->units[i].running > 0;
        }
    }
}

static void flush(run *r, bb_cache *cache, bool first)
{
    for (size_t i = 0; i < (size_t)cache->sets * cache->ways; i++) {
        const bb_cache_miss miss = {.written = cache->lines[i].written,
                                    .line = (cache->lines[i].tag - 1) * BB_LINE_BYTES};
        if (miss.written != 0 && first)
            write_back(r, &miss);
        else
            to_memory(r, miss.written);
    }
}

static bb_status create(run *r)
{
    const bb_machine *m = r->machine;
    r->units = calloc(m->units, sizeof *r->units);
    if (r->units == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    BB_TRY(bb_cache_create(m->second_bytes, m->second_ways, &r->second));
    for (uint32_t i = 0; i < m->units; i++) {
        unit *u = &r->units[i];
        BB_TRY(bb_cache_create(m->first_bytes, m->first_ways, &u->cache));
        BB_TRY(bb_host_alloc(NULL, m->in_flight * sizeof *u->slots, "groups in flight", &u->slots));
        BB_TRY(bb_host_alloc(NULL, m->in_flight * sizeof *u->busy, "groups in flight", &u->busy));
        memset(u->busy, 0, m->in_flight * sizeof *u->busy);
    }
    return BB_OK;
}

static void release(run *r)
{
    for (uint32_t i = 0; r->units != NULL && i < r->machine->units; i++) {
        bb_cache_release(&r->units[i].cache);
        bb_host_free(r->units[i].slots);
        bb_host_free(r->units[i].busy);
    }
    bb_cache_release(&r->second);
    free(r->units);
}

bb_status bb_machine_run(const bb_machine *machine, const bb_footing *footing,
                         const bb_steps *steps, bb_traffic *traffic)
{
    run r = {.machine = machine, .footing = footing, .steps = steps, .traffic = traffic};
    r.groups = bb_divide_up(steps->rays, machine->width);
    *traffic = (bb_traffic){.rays = steps->rays, .groups = r.groups};
    bb_status status = create(&r);
    if (status == BB_OK) {
        run_rounds(&r);
        for (uint32_t i = 0; i < machine->units; i++)
            flush(&r, &r.units[i].cache, true);
        flush(&r, &r.second, false);
    }
    release(&r);
    return status;
}

double bb_efficiency(const bb_issued *issued, uint32_t width)
{
    return issued->count > 0 ? (double)issued->lanes / ((double)issued->count * width)
                             : (double)NAN;
}
