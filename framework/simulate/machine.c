#include "framework/simulate/machine.h"

#include "framework/base/threads.h"

#include <math.h>
#include <stdlib.h>

/* Some sets of the second cache, which a thread looks after, and what it has counted. */
typedef struct slice {
    uint32_t first, end;
    uint64_t reads, hits, writes;
    uint64_t read, written; /* from and to memory */
} slice;

typedef struct run {
    const bb_machine *machine;
    bb_pool *pool;
    bb_unit *units;
    bb_cache second;
    slice *slices;
    uint32_t slice_count;
} run;

/* ---- the second cache ---- */

static void ask(run *r, slice *s, uint64_t address, bool write)
{
    bb_cache_miss miss;
    const bool hit = bb_cache_access(&r->second, address, write, &miss);
    s->writes += write;
    s->reads += !write;
    s->hits += hit && !write;
    s->read += miss.fetched;
    s->written += (unsigned)__builtin_popcount(miss.written);
}

/* Answers requests to its sets, in the order of rounds, and in each of units. */
static void answer(run *r, slice *s)
{
    const uint32_t units = r->machine->units;
    for (uint32_t round = 0; round < BB_WINDOW_ROUNDS; round++)
        for (uint32_t i = 0; i < units; i++) {
            const bb_unit *u = &r->units[i];
            for (size_t k = round > 0 ? u->ends[round - 1] : 0; k < u->ends[round]; k++) {
                const uint64_t address = u->asked[k] & ~1ull;
                const uint32_t set = bb_cache_set_of(&r->second, address);
                if (set >= s->first && set < s->end)
                    ask(r, s, address, (u->asked[k] & 1) != 0);
            }
        }
}

static void answer_slices(void *context, size_t begin, size_t end, uint32_t thread)
{
    run *r = context;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        answer(r, &r->slices[i]);
}

/* Fills it with an even share of the lines of these bytes, `part` of them. */
static void hold_some(bb_cache *cache, uint32_t array, uint64_t bytes, double part)
{
    const uint64_t lines = (bytes + BB_LINE_BYTES - 1) / BB_LINE_BYTES;
    const uint64_t kept = (uint64_t)((double)lines * part);
    for (uint64_t i = 0; i < kept; i++)
        bb_cache_hold(cache, ((uint64_t)array << BB_BASE_SHIFT) + i * lines / kept * BB_LINE_BYTES);
}

static void warm_up(bb_cache *cache, const bb_footing *f)
{
    const double room = (double)cache->sets * cache->ways * BB_LINE_BYTES;
    const double all = (double)(f->nodes_bytes + f->prims_bytes),
                 part = all > room ? room / all : 1;
    hold_some(cache, BB_AT_NODES, f->nodes_bytes, part);
    hold_some(cache, BB_AT_PRIMS, f->prims_bytes, part);
}

/* ---- all of it ---- */

static void run_units(void *context, size_t begin, size_t end, uint32_t thread)
{
    run *r = context;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        bb_unit_run(&r->units[i]);
}

static bool are_running(const run *r)
{
    for (uint32_t i = 0; i < r->machine->units; i++)
        if (r->units[i].running > 0)
            return true;
    return false;
}

static bb_status check_memory(const run *r)
{
    for (uint32_t i = 0; i < r->machine->units; i++)
        if (r->units[i].short_of_memory)
            return bb_fail(BB_REFUSED, "no memory for requests of a simulated unit");
    return BB_OK;
}

static bb_status run_windows(run *r)
{
    while (are_running(r)) {
        bb_parallel_for(r->pool, r->machine->units, 1, run_units, r);
        BB_TRY(check_memory(r));
        bb_parallel_for(r->pool, r->slice_count, 1, answer_slices, r);
    }
    for (uint32_t i = 0; i < r->machine->units; i++)
        bb_unit_flush(&r->units[i]);
    BB_TRY(check_memory(r));
    bb_parallel_for(r->pool, r->slice_count, 1, answer_slices, r);
    return BB_OK;
}

static void add_unit(const bb_traffic *unit, bb_traffic *sum)
{
    for (uint32_t k = 0; k < BB_ISSUE_KINDS; k++) {
        sum->issued[k].count += unit->issued[k].count;
        sum->issued[k].lanes += unit->issued[k].lanes;
        sum->issued[k].sectors += unit->issued[k].sectors;
        sum->issued[k].lines += unit->issued[k].lines;
        sum->in_regions[k].count += unit->in_regions[k].count;
        sum->in_regions[k].lanes += unit->in_regions[k].lanes;
    }
    sum->groups += unit->groups;
    sum->left += unit->left;
    sum->ray_steps += unit->ray_steps;
    sum->first += unit->first;
    sum->first_hits += unit->first_hits;
}

static void sum_up(run *r, bb_traffic *sum)
{
    const size_t lines = (size_t)r->second.sets * r->second.ways;
    for (uint32_t i = 0; i < r->machine->units; i++)
        add_unit(&r->units[i].traffic, sum);
    for (uint32_t i = 0; i < r->slice_count; i++) {
        const slice *s = &r->slices[i];
        sum->second += s->reads;
        sum->second_hits += s->hits;
        sum->second_written += s->writes;
        sum->read += s->read;
        sum->written += s->written;
    }
    for (size_t i = 0; i < lines; i++) {
        uint64_t line;
        const uint8_t written = bb_cache_flush(&r->second, i, &line);
        if (!bb_unit_is_private(line))
            sum->written += (unsigned)__builtin_popcount(written);
    }
}

static bb_status create(run *r, const bb_footing *footing, const bb_steps *steps)
{
    const bb_machine *m = r->machine;
    BB_TRY(bb_pool_create(0, &r->pool));
    BB_TRY(bb_cache_create(m->second_bytes, m->second_ways, &r->second));
    r->slice_count = bb_pool_threads(r->pool);
    r->units = calloc(m->units, sizeof *r->units);
    r->slices = calloc(r->slice_count, sizeof *r->slices);
    if (r->units == NULL || r->slices == NULL)
        return bb_fail(BB_REFUSED, "no memory for a simulated machine");
    for (uint32_t i = 0; i < r->slice_count; i++) {
        r->slices[i].first = (uint32_t)((uint64_t)r->second.sets * i / r->slice_count);
        r->slices[i].end = (uint32_t)((uint64_t)r->second.sets * (i + 1) / r->slice_count);
    }
    for (uint32_t i = 0; i < m->units; i++)
        BB_TRY(bb_unit_create(m, footing, steps, i, &r->units[i]));
    warm_up(&r->second, footing);
    return BB_OK;
}

static void release(run *r)
{
    for (uint32_t i = 0; r->units != NULL && i < r->machine->units; i++)
        bb_unit_release(&r->units[i]);
    bb_cache_release(&r->second);
    free(r->units);
    free(r->slices);
    bb_pool_destroy(r->pool);
}

bb_status bb_machine_run(const bb_machine *machine, const bb_footing *footing,
                         const bb_steps *steps, bb_traffic *traffic)
{
    run r = {.machine = machine};
    *traffic = (bb_traffic){.rays = steps->rays};
    bb_status status = create(&r, footing, steps);
    if (status == BB_OK)
        status = run_windows(&r);
    if (status == BB_OK)
        sum_up(&r, traffic);
    release(&r);
    return status;
}

double bb_efficiency(const bb_issued *issued, uint32_t width)
{
    return issued->count > 0 ? (double)issued->lanes / ((double)issued->count * width)
                             : (double)NAN;
}
