#include "framework/simulate/unit.h"

#include "framework/base/arithmetic.h"
#include "framework/base/memory.h"

#include <stdlib.h>
#include <string.h>

enum {
    ENTRIES_MOST = 1 << 12, /* of a lane */
    /* sectors of a step: each lane reads a node of 256 bytes or two words */
    SECTORS_MOST = BB_WARP_MOST * 16,
    SAMPLE_PAIRS = 4, /* of voxels beside each other along x */
    WORD_BYTES = 4,
    BOX_BYTES = 24,
    VERTEX_BYTES = 12,
    TET_CORNERS = 4,
    /* requests of a sector: it is fetched, and a line of written ones gives way */
    REQUESTS_MOST = 1 + BB_LINE_SECTORS
};

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
        for (uint32_t k = kept++; k > at; k--)
            values[k] = values[k - 1];
        values[at] = value;
    }
    return kept;
}

static uint64_t base_of(uint32_t array)
{
    return (uint64_t)array << BB_BASE_SHIFT;
}

/* Gets the distinct sectors of items [bytes] of the array at address `base`; sorts the items. */
static uint32_t sectors_at(uint64_t base, uint32_t stride, uint32_t bytes, uint64_t *items,
                           uint32_t count, uint64_t *sectors)
{
    uint32_t n = 0;
    count = sort_unique(items, count);
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t at = base + items[i] * stride;
        for (uint64_t s = at / BB_SECTOR_BYTES; s <= (at + bytes - 1) / BB_SECTOR_BYTES; s++)
            if (n == 0 || sectors[n - 1] < s)
                sectors[n++] = s;
    }
    return n;
}

/* The same of items that the lanes name. */
static uint32_t sectors_from(const bb_issue *issue, uint32_t array, uint32_t stride, uint32_t bytes,
                             uint64_t *sectors)
{
    uint64_t items[BB_WARP_MOST];
    uint32_t count = 0;
    for (uint64_t rest = issue->lanes; rest != 0; rest &= rest - 1)
        items[count++] = issue->index[__builtin_ctzll(rest)];
    return sectors_at(base_of(array), stride, bytes, items, count, sectors);
}

static uint32_t sectors_of(const bb_issue *issue, uint32_t array, uint32_t bytes, uint64_t *sectors)
{
    return sectors_from(issue, array, bytes, bytes, sectors);
}

/* The same of the eight voxels around samples. */
static uint32_t sectors_of_samples(const bb_issue *issue, const bb_footing *f, uint64_t *sectors)
{
    const uint32_t offsets[SAMPLE_PAIRS] = {0, f->row, f->slice, f->slice + f->row};
    uint32_t n = 0;
    for (uint32_t p = 0; p < SAMPLE_PAIRS; p++) {
        bb_issue pair = *issue;
        for (uint32_t i = 0; i < BB_WARP_MOST; i++)
            if ((issue->lanes >> i & 1) != 0)
                pair.index[i] += offsets[p];
        n += sectors_from(&pair, BB_AT_VOXELS, f->voxel_bytes, 2 * f->voxel_bytes, sectors + n);
    }
    return sort_unique(sectors, n);
}

/* The same of boxes that are apart from their nodes, or of flags where these suffice. */
static uint32_t sectors_of_boxes(const bb_issue *issue, const bb_footing_lists *lists,
                                 uint64_t *sectors)
{
    uint64_t boxes[BB_WARP_MOST], flags[BB_WARP_MOST];
    uint32_t box_count = 0, flag_count = 0;
    for (uint64_t rest = issue->lanes; rest != 0; rest &= rest - 1) {
        const uint32_t child = issue->index[__builtin_ctzll(rest)];
        if ((child & 1) != 0)
            boxes[box_count++] = child >> 1;
        else
            flags[flag_count++] = child >> 1;
    }
    const uint64_t base = base_of(BB_AT_NODES);
    uint32_t n =
        sectors_at(base + lists->boxes_at, BOX_BYTES, BOX_BYTES, boxes, box_count, sectors);
    return n + sectors_at(base + lists->flags_at, 1, 1, flags, flag_count, sectors + n);
}

/* The same of tetrahedra in lists. */
static uint32_t sectors_of_tets(const bb_issue *issue, const bb_footing_lists *lists,
                                uint64_t *sectors)
{
    uint64_t tets[BB_WARP_MOST], vertices[BB_WARP_MOST * TET_CORNERS];
    uint32_t tet_count = 0, vertex_count = 0;
    for (uint64_t rest = issue->lanes; rest != 0; rest &= rest - 1) {
        const uint32_t tet = lists->tets[issue->index[__builtin_ctzll(rest)]];
        if (tet == BB_NONE)
            continue;
        tets[tet_count++] = tet;
        for (uint32_t c = 0; c < TET_CORNERS; c++)
            vertices[vertex_count++] = lists->corners[(size_t)TET_CORNERS * tet + c];
    }
    const uint64_t base = base_of(BB_AT_PRIMS);
    uint32_t n = sectors_from(issue, BB_AT_PRIMS, WORD_BYTES, WORD_BYTES, sectors);
    n += sectors_at(base + lists->corners_at, TET_CORNERS * WORD_BYTES, TET_CORNERS * WORD_BYTES,
                    tets, tet_count, sectors + n);
    return n + sectors_at(base + lists->vertices_at, VERTEX_BYTES, VERTEX_BYTES, vertices,
                          vertex_count, sectors + n);
}

/* The same of nodes, boxes and leaves of a tree in arrays. */
static uint32_t sectors_of_arrays(const bb_issue *issue, const bb_footing_lists *lists,
                                  uint64_t *sectors)
{
    if (issue->kind == BB_STEP_BOX)
        return sectors_of_boxes(issue, lists, sectors);
    return sectors_from(issue, BB_AT_NODES, WORD_BYTES, 2 * WORD_BYTES, sectors);
}

/* The same of stack entries, whose words lie side by side for all lanes of a slot. */
static uint32_t sectors_of_stack(const bb_issue *issue, uint32_t width, uint64_t slot,
                                 uint64_t *sectors)
{
    uint32_t n = 0;
    const uint64_t base = base_of(BB_AT_PRIVATE) + slot * ENTRIES_MOST * BB_ENTRY_WORDS * width * 4;
    for (uint32_t i = 0; i < width; i++)
        for (uint32_t word = 0; word < BB_ENTRY_WORDS; word++) {
            if ((issue->words[word] >> i & 1) == 0)
                continue;
            const uint64_t row = (uint64_t)issue->index[i] * BB_ENTRY_WORDS + word;
            sectors[n++] = (base + (row * width + i) * 4) / BB_SECTOR_BYTES;
        }
    return sort_unique(sectors, n);
}

/* ---- the first cache ---- */

static void ask_second(bb_unit *u, uint64_t address, bool write)
{
    u->asked[u->count++] = address | write;
}

static void write_back(bb_unit *u, uint8_t written, uint64_t line)
{
    for (uint32_t s = 0; s < BB_LINE_SECTORS; s++)
        if ((written >> s & 1) != 0)
            ask_second(u, line + s * BB_SECTOR_BYTES, true);
}

static void ask_first(bb_unit *u, uint64_t sector, bool write)
{
    bb_cache_miss miss;
    const uint64_t address = sector * BB_SECTOR_BYTES;
    u->traffic.first++;
    u->traffic.first_hits += bb_cache_access(&u->cache, address, write, &miss);
    write_back(u, miss.written, miss.line);
    if (miss.fetched)
        ask_second(u, address, false);
}

/* Returns whether so many more requests can be noted. */
static bool make_room(bb_unit *u, size_t more)
{
    if (u->count + more <= u->room)
        return true;
    const size_t room = 2 * (u->count + more);
    uint64_t *asked = realloc(u->asked, room * sizeof *asked);
    u->short_of_memory = asked == NULL;
    if (asked == NULL)
        return false;
    u->asked = asked;
    u->room = room;
    return true;
}

/* ---- groups ---- */

static void issue_step(bb_unit *u, uint32_t slot, const bb_issue *issue)
{
    const bb_footing *f = u->footing;
    uint64_t sectors[SECTORS_MOST], line = UINT64_MAX;
    uint32_t count = 0;
    switch (issue->kind) {
    case BB_STEP_NODE:
    case BB_STEP_BOX:
    case BB_STEP_LEAF:
        count = f->lists.tets != NULL ? sectors_of_arrays(issue, &f->lists, sectors)
                                      : sectors_of(issue, BB_AT_NODES, f->node_bytes, sectors);
        break;
    case BB_STEP_PRIMS:
        count = f->lists.tets != NULL ? sectors_of_tets(issue, &f->lists, sectors)
                                      : sectors_of(issue, BB_AT_PRIMS, f->prim_bytes, sectors);
        break;
    case BB_ISSUE_BEGIN:
        count = f->item_bytes > 0 ? sectors_of(issue, BB_AT_RAYS, f->item_bytes, sectors) : 0;
        break;
    case BB_ISSUE_END:
        count = sectors_of(issue, BB_AT_RESULTS, f->result_bytes, sectors);
        break;
    case BB_STEP_PUSH:
    case BB_STEP_POP:
        count = sectors_of_stack(issue, u->machine->width,
                                 (uint64_t)u->number * u->machine->in_flight + slot, sectors);
        break;
    case BB_STEP_SAMPLE:
        count = sectors_of_samples(issue, f, sectors);
        break;
    case BB_STEP_LOOKUP:
        count = sectors_from(issue, BB_AT_TABLE, f->entry_bytes, 2 * f->entry_bytes, sectors);
        break;
    default:
        break;
    }
    bb_issued *sum = &u->traffic.issued[issue->kind];
    sum->count++;
    sum->lanes += (unsigned)__builtin_popcountll(issue->lanes);
    sum->sectors += count;
    if (u->slots[slot].in_region) {
        u->traffic.in_regions[issue->kind].count++;
        u->traffic.in_regions[issue->kind].lanes += (unsigned)__builtin_popcountll(issue->lanes);
    }
    const bool write = issue->kind == BB_STEP_PUSH || issue->kind == BB_ISSUE_END;
    for (uint32_t i = 0; i < count; i++) {
        sum->lines += sectors[i] / BB_LINE_SECTORS != line;
        line = sectors[i] / BB_LINE_SECTORS;
        ask_first(u, sectors[i], write);
    }
}

/* Gives the next group to a free slot, if there is one. */
static void take_group(bb_unit *u, uint32_t slot)
{
    const bb_machine *m = u->machine;
    const uint32_t of_group = bb_divide_up(u->footing->group, m->width);
    uint32_t first;
    const uint32_t lanes = bb_footing_lanes(u->footing, m->width, u->steps->rays, u->next, &first);
    u->busy[slot] = lanes > 0;
    if (lanes == 0)
        return;
    bb_warp_start(&u->slots[slot], u->steps, u->footing, first, lanes);
    u->issued[slot] = 0;
    u->next++;
    if (u->next % of_group == 0) /* the others of these work-groups are the other units' */
        u->next += (uint64_t)of_group * (m->units - 1);
    u->running++;
    u->traffic.groups++;
}

/* A step of the next of its groups that has one. */
static void take_turn(bb_unit *u)
{
    bb_issue issue;
    const uint32_t slots = u->machine->in_flight;
    while (u->running > 0) {
        const uint32_t s = u->turn;
        u->turn = (s + 1) % slots;
        if (!u->busy[s])
            continue;
        if (bb_warp_next(&u->slots[s], &issue)) {
            issue_step(u, s, &issue);
            u->issued[s] += issue.kind < BB_STEP_KINDS;
            return;
        }
        u->traffic.left += bb_warp_left(&u->slots[s]);
        u->traffic.ray_steps += u->issued[s] * u->slots[s].lanes;
        u->running--;
        take_group(u, s);
    }
}

bb_status bb_unit_create(const bb_machine *machine, const bb_footing *footing,
                         const bb_steps *steps, uint32_t number, bb_unit *unit)
{
    *unit = (bb_unit){.machine = machine,
                      .footing = footing,
                      .steps = steps,
                      .number = number,
                      .next = (uint64_t)number * bb_divide_up(footing->group, machine->width)};
    BB_TRY(bb_cache_create(machine->first_bytes, machine->first_ways, &unit->cache));
    BB_TRY(bb_host_alloc(NULL, machine->in_flight * sizeof *unit->slots, "groups in flight",
                         &unit->slots));
    BB_TRY(bb_host_alloc(NULL, machine->in_flight * sizeof *unit->issued, "groups in flight",
                         &unit->issued));
    BB_TRY(bb_host_alloc(NULL, machine->in_flight * sizeof *unit->busy, "groups in flight",
                         &unit->busy));
    for (uint32_t s = 0; s < machine->in_flight; s++)
        take_group(unit, s);
    return BB_OK;
}

void bb_unit_release(bb_unit *unit)
{
    bb_cache_release(&unit->cache);
    bb_host_free(unit->slots);
    bb_host_free(unit->issued);
    bb_host_free(unit->busy);
    free(unit->asked);
}

void bb_unit_run(bb_unit *unit)
{
    unit->count = 0;
    for (uint32_t round = 0; round < BB_WINDOW_ROUNDS; round++) {
        if (make_room(unit, SECTORS_MOST * REQUESTS_MOST))
            take_turn(unit);
        unit->ends[round] = unit->count;
    }
}

void bb_unit_flush(bb_unit *unit)
{
    const size_t lines = (size_t)unit->cache.sets * unit->cache.ways;
    unit->count = 0;
    for (size_t i = 0; i < lines && make_room(unit, BB_LINE_SECTORS); i++) {
        uint64_t line;
        const uint8_t written = bb_cache_flush(&unit->cache, i, &line);
        if (!bb_unit_is_private(line))
            write_back(unit, written, line);
    }
    for (uint32_t round = 0; round < BB_WINDOW_ROUNDS; round++)
        unit->ends[round] = unit->count;
}
