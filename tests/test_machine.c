/* Units and caches (framework/simulate/machine.h) on steps made by hand, whose sectors, lines and
 * hits are known; caches against a list. */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "tests/made_steps.h"

#include <math.h>
#include <stdio.h>

static const bb_footing footing = {.control = BB_WHILE_WHILE,
                                   .group = 32,
                                   .node_bytes = 64,
                                   .prim_bytes = 48,
                                   .item_bytes = sizeof(bb_ray),
                                   .result_bytes = 8,
                                   .voxel_bytes = 1,
                                   .row = 9,
                                   .slice = 81,
                                   .entry_bytes = 16};

static bb_traffic run(const bb_machine *machine, const bb_footing *f)
{
    bb_traffic traffic;
    ASSERT_OK(bb_machine_run(machine, f, &made, &traffic));
    return traffic;
}

static bb_machine machine_of(uint32_t width, uint32_t units, uint32_t in_flight)
{
    return (bb_machine){.width = width,
                        .units = units,
                        .in_flight = in_flight,
                        .first_bytes = 1 << 20,
                        .first_ways = 8,
                        .second_bytes = 1 << 22,
                        .second_ways = 16};
}

static void efficiency_is_that_of_active_lanes(void **state)
{
    (void)state;
    const bb_machine m = machine_of(32, 1, 1);
    no_rays();
    add_rays(32, "NNP");
    bb_traffic t = run(&m, &footing);
    assert_true(bb_efficiency(&t.issued[BB_STEP_NODE], 32) == 1.0);
    assert_true(bb_efficiency(&t.issued[BB_STEP_PRIMS], 32) == 1.0);
    assert_true(isnan(bb_efficiency(&t.issued[BB_STEP_POP], 32)));

    no_rays(); /* one long ray */
    add_ray("NNNNNNNNNN");
    add_rays(31, "N");
    t = run(&m, &footing);
    assert_int_equal(t.issued[BB_STEP_NODE].count, 10);
    assert_true(bb_efficiency(&t.issued[BB_STEP_NODE], 32) == 41.0 / 320.0);

    no_rays(); /* alternating */
    for (uint32_t i = 0; i < 16; i++) {
        add_ray("N");
        add_ray("P");
    }
    t = run(&m, &footing);
    assert_true(bb_efficiency(&t.issued[BB_STEP_NODE], 32) == 0.5);
    assert_true(bb_efficiency(&t.issued[BB_STEP_PRIMS], 32) == 0.5);

    no_rays(); /* a last group of 5, of 32 lanes as all */
    add_rays(37, "N");
    t = run(&m, &footing);
    assert_int_equal(t.groups, 2);
    assert_true(bb_efficiency(&t.issued[BB_STEP_NODE], 32) == 37.0 / 64.0);

    no_rays();
    t = run(&m, &footing);
    assert_int_equal(t.groups, 0);
    assert_int_equal(t.read + t.written, 0);
}

static void expect_issued(const bb_traffic *t, uint32_t kind, uint64_t count, uint64_t sectors,
                          uint64_t lines)
{
    assert_int_equal(t->issued[kind].count, count);
    assert_int_equal(t->issued[kind].sectors, sectors);
    assert_int_equal(t->issued[kind].lines, lines);
}

static void sectors_of_a_step_are_distinct(void **state)
{
    (void)state;
    bb_machine m = machine_of(32, 1, 1);
    no_rays();
    add_rays(32, "N5P5");
    bb_traffic t = run(&m, &footing);
    expect_issued(&t, BB_STEP_NODE, 1, 2, 1);
    expect_issued(&t, BB_STEP_PRIMS, 1, 2, 2); /* bytes 240 to 287 */
    expect_issued(&t, BB_ISSUE_BEGIN, 1, 32, 8);
    expect_issued(&t, BB_ISSUE_END, 1, 8, 2);

    no_rays(); /* nodes 0 to 31: 2 KiB; primitives 0 to 31: 1536 bytes */
    for (uint32_t i = 0; i < 32; i++) {
        char steps[32];
        snprintf(steps, sizeof steps, "N%uP%u", 31 - i, i);
        add_ray(steps);
    }
    t = run(&m, &footing);
    expect_issued(&t, BB_STEP_NODE, 1, 64, 16);
    expect_issued(&t, BB_STEP_PRIMS, 1, 48, 12);

    /* entries of one place lie side by side: two rows of 128 bytes; of two places, halves of four
     * */
    no_rays();
    add_rays(16, "N0+-");
    add_rays(16, "N0++--");
    t = run(&m, &footing);
    assert_int_equal(t.issued[BB_STEP_PUSH].count, 2);
    assert_int_equal(t.issued[BB_STEP_PUSH].sectors, 8 + 4);
    assert_int_equal(t.issued[BB_STEP_POP].count, 2);
    assert_int_equal(t.issued[BB_STEP_POP].sectors, 4 + 4 + 4);

    /* a short stack of two entries comes back to its first place */
    bb_footing ring = footing;
    ring.ring = 2;
    no_rays();
    add_rays(32, "N0+++");
    bb_traffic shorter = run(&m, &ring), longer = run(&m, &footing);
    assert_int_equal(shorter.first_hits - longer.first_hits, 8);
    assert_int_equal(shorter.written, longer.written); /* answers alone */
}

static void packets_share_their_entries(void **state)
{
    (void)state;
    const bb_machine m = machine_of(32, 1, 1);
    bb_footing wide = in_packets;
    wide.packet = 16;
    no_rays(); /* a node once for all rays; of an entry all distances, and two words of a packet */
    add_rays(32, "J1-1N5B5+3");
    bb_traffic t = run(&m, &in_packets);
    expect_issued(&t, BB_STEP_NODE, 1, 8, 2);
    expect_issued(&t, BB_STEP_BOX, 1, 8, 2);
    expect_issued(&t, BB_STEP_POP, 1, 4 + 4, 2);
    expect_issued(&t, BB_STEP_PUSH, 1, 4 + 4, 2);
    assert_true(bb_efficiency(&t.issued[BB_STEP_BOX], 32) == 1.0);
    t = run(&m, &wide);
    expect_issued(&t, BB_STEP_PUSH, 1, 4 + 2, 2);

    no_rays(); /* one ray is left: the others' distances are stored, too */
    add_ray("J1-1N5B5+3");
    add_rays(31, "J1-0N5B5+2");
    t = run(&m, &in_packets);
    assert_true(bb_efficiency(&t.issued[BB_STEP_NODE], 32) == 1.0 / 32.0);
    expect_issued(&t, BB_STEP_PUSH, 1, 4 + 4, 2);

    no_rays(); /* a packet of three rays has the entries of a whole one */
    add_rays(3, "J1-1N5B5+3");
    t = run(&m, &wide);
    assert_true(bb_efficiency(&t.issued[BB_STEP_POP], 32) == 3.0 / 32.0);
    expect_issued(&t, BB_STEP_PUSH, 1, 2 + 1, 2);

    no_rays(); /* so has the last one of a work-group */
    add_rays(40, "J1-1N5");
    bb_footing short_of = in_packets;
    short_of.group = 20;
    t = run(&m, &short_of);
    expect_issued(&t, BB_STEP_POP, 2, 2 * (3 + 3), 2 * 2);
    assert_int_equal(t.issued[BB_STEP_POP].lanes, 40);

    /* a ray on its own has a stack beside the packet's, which begins anew each time */
    no_rays();
    add_ray("J1-1NB+1JN+J1-1JN+J1");
    add_rays(7, "J1-1NB+1-0");
    t = run(&m, &in_packets);
    assert_int_equal(t.issued[BB_STEP_PUSH].count, 3);
    /* 8 sectors of the node thrice, 2 of the packet's entry twice, 2 of the ray's second one */
    assert_int_equal(t.first_hits, 3 * 8 + 2 * 2 + 2);
    assert_int_equal(t.written, 2); /* answers alone: what is on a stack at the end is dead */
}

static void samples_read_eight_voxels(void **state)
{
    (void)state;
    const bb_machine m = machine_of(32, 1, 1);
    no_rays();
    add_ray("S0L0"); /* voxels 0, 1, 9, 10, 81, 82, 90, 91; bytes 0 to 31 of the table */
    bb_traffic t = run(&m, &footing);
    expect_issued(&t, BB_STEP_SAMPLE, 1, 2, 1);
    expect_issued(&t, BB_STEP_LOOKUP, 1, 1, 1);
    no_rays();
    add_ray("S47L7"); /* 47, 48, 56, 57, 128, 129, 137, 138; bytes 112 to 143 */
    t = run(&m, &footing);
    expect_issued(&t, BB_STEP_SAMPLE, 1, 2, 2);
    expect_issued(&t, BB_STEP_LOOKUP, 1, 2, 2);
    no_rays(); /* together: sectors 0, 1, 2, 4 of voxels, and 0, 3, 4 of the table */
    add_ray("S0L0");
    add_ray("S47L7");
    t = run(&m, &footing);
    expect_issued(&t, BB_STEP_SAMPLE, 1, 4, 2);
    expect_issued(&t, BB_STEP_LOOKUP, 1, 3, 2);
    bb_footing wide = footing;
    wide.voxel_bytes = 2; /* bytes 0, 18, 162, 180, each of four: sectors 0, 5 */
    no_rays();
    add_ray("S0L0");
    t = run(&m, &wide);
    expect_issued(&t, BB_STEP_SAMPLE, 1, 2, 2);
    wide.item_bytes = 0; /* nothing is read first */
    expect_issued(&t, BB_ISSUE_BEGIN, 1, 1, 1);
    t = run(&m, &wide);
    expect_issued(&t, BB_ISSUE_BEGIN, 1, 0, 0);
}

static void trees_in_arrays_are_read_by_their_lists(void **state)
{
    (void)state;
    static const uint32_t tets[] = {2, 0, BB_NONE},
                          corners[] = {3, 4, 5, 6, 7, 8, 9, 9, 0, 1, 2, 30};
    const bb_machine m = machine_of(32, 1, 1);
    const bb_footing f = {.control = BB_UNTIL_LEAF,
                          .group = 32,
                          .ring = 8,
                          .is_link = true,
                          .result_bytes = 4,
                          .lists = {.tets = tets,
                                    .corners = corners,
                                    .boxes_at = 256,
                                    .flags_at = 512,
                                    .corners_at = 256,
                                    .vertices_at = 512}};
    no_rays();
    add_ray("B3N7F0P0"); /* bytes 24 to 47 of boxes; 28 to 35 and 0 to 7 of words */
    bb_traffic t = run(&m, &f);
    expect_issued(&t, BB_STEP_BOX, 1, 2, 1);
    expect_issued(&t, BB_STEP_NODE, 1, 2, 1);
    expect_issued(&t, BB_STEP_LEAF, 1, 1, 1);
    /* word 0 of the list, corners of tetrahedron 2, vertices 0 to 2 in two sectors, and 30 */
    expect_issued(&t, BB_STEP_PRIMS, 1, 1 + 1 + 3, 4);
    no_rays(); /* a flag alone; a primitive of another kind */
    add_ray("B3F0P0");
    add_ray("B4F0P2");
    t = run(&m, &f);
    expect_issued(&t, BB_STEP_BOX, 1, 3, 2);
    expect_issued(&t, BB_STEP_PRIMS, 1, 1 + 1 + 3, 4);
    no_rays(); /* an entry is a link: half as much as elsewhere */
    add_rays(32, "N0+-");
    t = run(&m, &f);
    expect_issued(&t, BB_STEP_PUSH, 1, 4, 1);
    expect_issued(&t, BB_STEP_POP, 1, 4, 1);
}

static void searches_in_regions_are_counted_apart(void **state)
{
    (void)state;
    const bb_machine m = machine_of(32, 1, 1);
    bb_footing f = footing;
    f.control = BB_IF_ELSE;
    no_rays();
    add_rays(20, "N1P1A1N1N1P1XA0N1");
    add_ray("N1");
    bb_traffic t = run(&m, &f);
    assert_int_equal(t.issued[BB_STEP_NODE].count, 4);
    assert_int_equal(t.in_regions[BB_STEP_NODE].count, 2);
    assert_int_equal(t.in_regions[BB_STEP_NODE].lanes, 40);
    assert_int_equal(t.in_regions[BB_STEP_AGAIN].count, 1);
    assert_int_equal(t.in_regions[BB_STEP_EXACT].lanes, 20);
    bb_machine two = m; /* the second one's groups are others */
    two.units = 2;
    no_rays();
    add_rays(32, "N1A1N1");
    add_rays(32, "N1A1N1N1");
    t = run(&two, &f);
    assert_int_equal(t.issued[BB_STEP_NODE].count, 5);
    assert_int_equal(t.in_regions[BB_STEP_NODE].count, 3);
    no_rays();
    add_rays(20, "N1P1A1N1N1P1XA0N1");
    add_ray("N1");
    f.in_region = true; /* from the beginning */
    t = run(&m, &f);
    assert_int_equal(t.in_regions[BB_STEP_NODE].count, 3);
    assert_int_equal(t.in_regions[BB_STEP_NODE].lanes, 61);
}

static void caches_find_what_they_hold(void **state)
{
    (void)state;
    bb_machine m = machine_of(32, 1, 1);
    no_rays();
    add_rays(64, "N1N2");
    bb_traffic t = run(&m, &footing);
    /* rays 64 sectors, nodes 2 * 2 of which the second group finds all; answers 16 */
    assert_int_equal(t.first, 64 + 2 * 4 + 16);
    assert_int_equal(t.first_hits, 4);
    assert_int_equal(t.second, 64 + 4);
    assert_int_equal(t.second_hits, 0);
    assert_int_equal(t.second_written, 16);
    assert_int_equal(t.read, 64 + 4);
    assert_int_equal(t.written, 16);

    m.units = 2; /* each unit finds nothing in its own cache; the second one in the shared one */
    t = run(&m, &footing);
    assert_int_equal(t.first_hits, 0);
    assert_int_equal(t.second, 64 + 8);
    assert_int_equal(t.second_hits, 4);
    assert_int_equal(t.read, 64 + 4);

    m.units =
        1; /* two groups in flight take turns: the second finds what the first has just read */
    m.in_flight = 2;
    m.first_bytes = 128 * 40;
    t = run(&m, &footing);
    assert_int_equal(t.first_hits, 4);

    m.in_flight = 1;
    m.first_bytes = m.second_bytes = 128; /* a line each */
    t = run(&m, &footing);
    assert_int_equal(t.written, 16);
    assert_true(t.read > 64 + 4);
}

/* A work-group that is no multiple of the width has idle lanes, and one unit runs all of it. */
static void work_groups_are_not_torn_apart(void **state)
{
    (void)state;
    bb_machine m = machine_of(32, 2, 1);
    bb_footing f = footing;
    f.group = 48;
    no_rays();
    add_rays(100, "N1"); /* 32, 16; 32, 16; 4 */
    bb_traffic t = run(&m, &f);
    assert_int_equal(t.groups, 5);
    assert_int_equal(t.issued[BB_STEP_NODE].count, 5);
    assert_int_equal(t.issued[BB_STEP_NODE].lanes, 100);
    /* all groups of a unit but the first find the node in its cache */
    assert_int_equal(t.first_hits, 2 * (5 - 2));
    f.group = 32;
    t = run(&m, &f);
    assert_int_equal(t.groups, 4);
    f.group = 16; /* as many lanes are idle as active */
    t = run(&m, &f);
    assert_int_equal(t.groups, 7);
    assert_true(bb_efficiency(&t.issued[BB_STEP_NODE], 32) == 100.0 / (7 * 32));
}

/* The second cache has the layout at first, or every other line of it. */
static void the_second_cache_begins_warm(void **state)
{
    (void)state;
    const bb_machine m = machine_of(32, 1, 1);
    bb_footing f = footing;
    no_rays();
    for (uint32_t i = 0; i < 64; i++) {
        char steps[32];
        snprintf(steps, sizeof steps, "N%uP%u", 2 * i, 8 * i);
        add_ray(steps);
    }
    const bb_traffic cold = run(&m, &f);
    f.nodes_bytes = 128 * 64;
    f.prims_bytes = 512 * 48;
    const bb_traffic warm = run(&m, &f);
    const bb_issued *nodes = &warm.issued[BB_STEP_NODE], *prims = &warm.issued[BB_STEP_PRIMS];
    assert_int_equal(cold.second_hits, 0);
    assert_int_equal(warm.second_hits, nodes->sectors + prims->sectors);
    assert_int_equal(cold.read - warm.read, warm.second_hits);
    assert_int_equal(cold.written, warm.written);
    /* twice as many lines as there is room for: half of them, less where a set is full; these are
     * read from the middle of the arrays */
    f.nodes_bytes = f.prims_bytes = m.second_bytes;
    no_rays();
    for (uint32_t i = 0; i < 64; i++) {
        char steps[32];
        snprintf(steps, sizeof steps, "N%uP%u", 30000 + 2 * i, 40000 + 8 * i);
        add_ray(steps);
    }
    const bb_traffic half = run(&m, &f);
    const double hits = (double)half.second_hits, all = (double)warm.second_hits;
    assert_true(hits > 0.35 * all && hits < 0.55 * all);
}

/* ---- caches, against a list ---- */

typedef struct listed {
    uint64_t line;
    uint8_t present, written;
} listed;

/* One set of `ways` lines, the last used first. */
static bool ask_list(listed *list, uint32_t *count, uint32_t ways, uint64_t address, bool write,
                     uint8_t *written)
{
    const uint64_t line = address / 128;
    const uint8_t sector = (uint8_t)(1u << (address / 32 % 4));
    listed found = {.line = line};
    uint32_t at = 0;
    *written = 0;
    while (at < *count && list[at].line != line)
        at++;
    if (at < *count) {
        found = list[at];
    } else if (*count == ways) {
        at = ways - 1;
        *written = list[at].written;
    } else {
        at = (*count)++;
    }
    memmove(list + 1, list, at * sizeof *list);
    const bool hit = (found.present & sector) != 0;
    found.present |= sector;
    found.written |= write ? sector : 0;
    list[0] = found;
    return hit;
}

static void the_line_used_longest_ago_gives_way(void **state)
{
    (void)state;
    static const uint32_t ways[] = {1, 2, 8, 64};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
        bb_cache cache;
        listed list[64];
        uint32_t count = 0;
        bb_random random = bb_random_make(seed_or(5), w);
        ASSERT_OK(bb_cache_create(128 * ways[w], ways[w], &cache));
        assert_int_equal(cache.sets, 1);
        for (uint32_t i = 0; i < 20000; i++) {
            const uint64_t address = 32ull * bb_random_below(&random, 8 * ways[w] + 8);
            const bool write = bb_random_below(&random, 4) == 0;
            bb_cache_miss miss;
            uint8_t written;
            const bool expected = ask_list(list, &count, ways[w], address, write, &written);
            const bool hit = bb_cache_access(&cache, address, write, &miss);
            assert_int_equal(hit, expected);
            assert_int_equal(miss.fetched, !hit && !write);
            assert_int_equal(miss.written, written);
        }
        bb_cache_release(&cache);
    }
}

static void sets_share_the_lines(void **state)
{
    (void)state;
    bb_cache cache;
    bb_cache_miss miss;
    ASSERT_OK(bb_cache_create(1 << 16, 8, &cache));
    assert_int_equal(cache.sets, 64);
    uint32_t hits = 0, lines = (1 << 16) / 128;
    /* lines a power of two apart fill it almost, not one set alone */
    for (uint32_t round = 0; round < 2; round++)
        for (uint32_t i = 0; i < lines / 2; i++)
            hits += bb_cache_access(&cache, (uint64_t)i << 14, false, &miss);
    assert_true(hits > lines / 2 * 8 / 10);
    bb_cache_release(&cache);
    ASSERT_OK(bb_cache_create(1, 8, &cache)); /* a line at least */
    assert_int_equal(cache.sets * cache.ways, 1);
    bb_cache_release(&cache);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(efficiency_is_that_of_active_lanes),
        cmocka_unit_test(sectors_of_a_step_are_distinct),
        cmocka_unit_test(packets_share_their_entries),
        cmocka_unit_test(samples_read_eight_voxels),
        cmocka_unit_test(trees_in_arrays_are_read_by_their_lists),
        cmocka_unit_test(searches_in_regions_are_counted_apart),
        cmocka_unit_test(caches_find_what_they_hold),
        cmocka_unit_test(work_groups_are_not_torn_apart),
        cmocka_unit_test(the_second_cache_begins_warm),
        cmocka_unit_test(the_line_used_longest_ago_gives_way),
        cmocka_unit_test(sets_share_the_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
