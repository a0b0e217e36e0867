/* Groups in lockstep, caches and machines (framework/simulate/) on steps made by hand, whose
 * figures are known. */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/simulate/divergence.h"
#include "framework/simulate/simulate.h"
#include "tests/fixture.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { RAYS_MOST = 256, WORDS_MOST = 1 << 14 };

static uint32_t ends[RAYS_MOST], words[WORDS_MOST];
static bb_steps made;

static void no_rays(void)
{
    made = (bb_steps){.rays = 0, .ends = ends, .words = words};
}

/* Kinds of steps by their letters, then of a ray's beginning and end. */
static const char letters[] = "N+P-RBSLAbe";

/* Adds a ray: N7 a node, P7 a primitive, + a push, - a pop, R a restart, B7 a box, S7 a sample, L7
 * what it looks up, A another search; J1 joins its packet, J leaves it; a number is 0 if it is left
 * out. */
static void add_ray(const char *steps)
{
    uint32_t end = made.rays > 0 ? ends[made.rays - 1] : 0;
    for (const char *c = steps; *c != '\0';) {
        const char kind = *c++;
        const unsigned index = isdigit(*c) ? (unsigned)strtoul(c, (char **)&c, 10) : 0;
        const uint32_t number =
            kind == 'J' ? BB_STEP_MARK : (uint32_t)(strchr(letters, kind) - letters);
        assert_true(end < WORDS_MOST && number <= BB_STEP_MARK);
        words[end++] = number << BB_STEP_INDEX_BITS | index;
    }
    ends[made.rays++] = end;
}

static void add_rays(uint32_t count, const char *steps)
{
    for (uint32_t i = 0; i < count; i++)
        add_ray(steps);
}

/* ---- groups ---- */

/* The steps that a group of all rays issues, as "N32 P16 ...": the kind and how many lanes. */
static void expect_order_of(const bb_footing *f, const char *order)
{
    char text[1024] = "";
    bb_warp warp;
    bb_issue issue;
    bb_warp_start(&warp, &made, f, 0, made.rays);
    while (bb_warp_next(&warp, &issue))
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%c%d",
                 text[0] != '\0' ? " " : "", letters[issue.kind],
                 __builtin_popcountll(issue.lanes));
    assert_string_equal(text, order);
}

static void expect_order(bb_control control, uint32_t ring, const char *order)
{
    const bb_footing f = {.control = control, .ring = ring, .packet = 1};
    expect_order_of(&f, order);
}

static void loops_are_left_together(void **state)
{
    (void)state;
    no_rays();
    add_rays(4, "N+NPP-P");
    expect_order(BB_WHILE_WHILE, 0, "b4 N4 +4 N4 P4 P4 -4 P4 e4");
    expect_order(BB_IF_IF, 0, "b4 N4 +4 N4 P4 P4 -4 P4 e4");

    /* one ray has more nodes: the others wait at their primitives; if-if lets these go first */
    no_rays();
    add_ray("NNNP");
    add_ray("NP");
    expect_order(BB_WHILE_WHILE, 0, "b2 N2 N1 N1 P2 e2");
    expect_order(BB_IF_IF, 0, "b2 N2 P1 N1 N1 P1 e2");

    /* a ray that has left the loop of nodes comes back only when all have left it */
    no_rays();
    add_ray("N-N");
    add_ray("NNN");
    add_ray("NPN");
    expect_order(BB_WHILE_WHILE, 0, "b3 N3 N1 N1 P1 -1 N2 e3");

    /* if-else: in an iteration a ray takes a node with what follows, or pops */
    no_rays();
    add_ray("N+N-NP-N");
    add_ray("N+N+NP");
    expect_order(BB_IF_ELSE, 0, "b2 N2 +2 N2 +1 N1 P1 -1 N1 P1 -1 N1 e2");

    /* pushes of one node, then those that go on */
    no_rays();
    add_ray("N+++N");
    add_ray("N+N");
    add_ray("NN");
    expect_order(BB_WHILE_WHILE, 0, "b3 N3 +2 +1 +1 N3 e3");

    /* pops and restarts share a loop: who restarts after a pop does so an iteration later */
    no_rays();
    add_ray("N-R");
    add_ray("NR");
    expect_order(BB_WHILE_WHILE, 4, "b2 N2 -1 R1 R1 e2");

    no_rays();
    add_ray("");
    add_ray("P");
    expect_order(BB_WHILE_WHILE, 0, "b2 P1 e2");
}

static const bb_footing in_packets = {.control = BB_PACKETS,
                                      .group = 32,
                                      .packet = 8,
                                      .node_bytes = 256,
                                      .prim_bytes = 192,
                                      .result_bytes = 8};

static void packets_take_their_steps_together(void **state)
{
    (void)state;
    no_rays(); /* all equal */
    add_rays(32, "J1-1NB+1B+3-3P4P5-1P6");
    expect_order_of(&in_packets, "b32 -32 N32 B32 +32 B32 +32 -32 P32 P32 -32 P32 e32");

    no_rays(); /* one ray is left; then none */
    add_ray("J1-1NB+1-0");
    add_rays(7, "J1-0NB+0-0");
    expect_order_of(&in_packets, "b8 -1 N1 B1 +1 -0 e8");

    no_rays(); /* a ray takes part no more */
    add_ray("J1-1NB-0P4");
    add_rays(7, "J1-1NB-1P4");
    expect_order_of(&in_packets, "b8 -8 N8 B8 -7 P7 e8");

    no_rays(); /* packets that part: a leaf comes before the other's node, and waits after it */
    add_rays(8, "J1-1P4-1P4");
    add_rays(8, "J1-1NBB+1-1P4");
    expect_order_of(&in_packets, "b16 -16 P8 N8 B8 B8 +8 -16 P16 e16");

    no_rays(); /* few go on alone, while all packets wait; they may pass by each other */
    add_ray("J1-1JN1+P3-J1-0");
    add_ray("J1-1JN2J1-0");
    add_rays(6, "J1-0-0");
    add_rays(8, "J1-1NB-1P");
    expect_order_of(&in_packets, "b16 -10 N8 B8 N2 +1 P1 -1 -8 P8 e16");

    no_rays(); /* a ray that the packet leaves out goes first */
    add_ray("NP7J1-0P2");
    add_rays(3, "J1-1P2");
    expect_order_of(&in_packets, "b4 N1 P1 -3 P3 e4");
}

static void samples_are_taken_together(void **state)
{
    (void)state;
    /* after the primitives of a leaf, each with what it looks up; then pops */
    no_rays();
    add_ray("NPSLSL-NPSL");
    add_ray("NPP-NPSL");
    add_ray("NPSL");
    expect_order(BB_WHILE_WHILE, 0, "b3 N3 P3 P1 S2 L2 S1 L1 -2 N2 P2 S2 L2 e3");
    /* by leaf: a primitive's samples before the next primitive */
    no_rays();
    add_ray("NPSLPSL");
    add_ray("NPPSL");
    expect_order(BB_WHILE_WHILE, 0, "b2 N2 P2 P1 S2 L2 P1 S1 L1 e2");
    expect_order(BB_IF_IF_BY_LEAF, 0, "b2 N2 P2 S1 L1 P2 S2 L2 e2");
    /* without a tree */
    no_rays();
    add_ray("SLSL");
    add_ray("SL");
    add_ray("");
    expect_order(BB_WHILE_WHILE, 0, "b3 S2 L2 S1 L1 e3");
}

static void searches_begin_together(void **state)
{
    (void)state;
    /* who needs another search waits until all rays have ended the one before */
    no_rays();
    add_ray("NASLNP");
    add_ray("NNN-NPANSL");
    add_ray("NA");
    expect_order(BB_WHILE_WHILE, 0, "b3 N3 N1 N1 -1 N1 P1 A3 S1 L1 N2 P1 S1 L1 e3");
    /* with an empty stack, whatever the last one left */
    no_rays();
    add_ray("N+N+AN+");
    bb_warp warp;
    bb_issue issue;
    uint32_t place = 9, pushes = 0;
    bb_warp_start(&warp, &made, &(bb_footing){.control = BB_WHILE_WHILE, .group = 1, .packet = 1},
                  0, 1);
    while (bb_warp_next(&warp, &issue))
        if (issue.kind == BB_STEP_PUSH) {
            place = issue.index[0];
            pushes++;
        }
    assert_int_equal(pushes, 3);
    assert_int_equal(place, 0);
}

static void looked_up_after_all_have_found(void **state)
{
    (void)state;
    no_rays();
    add_ray("ANPLANPL");
    add_ray("ANNNPLANPL");
    expect_order(BB_IF_ELSE, 0, "b2 A2 N2 P1 N1 N1 P1 L2 A2 N2 P2 L2 e2");
}

static void rays_wait_for_their_group(void **state)
{
    (void)state;
    bb_count waits[4];
    const bb_footing f = {.control = BB_WHILE_WHILE, .group = 2};
    no_rays();
    add_ray("NNNP");
    add_ray("NP");
    add_ray("NPP");
    add_ray("N");
    bb_divergence(&made, &f, 2, waits);
    static const uint32_t expected[4][2] = {{0, 0}, {2, 0}, {0, 0}, {0, 2}};
    for (uint32_t i = 0; i < 4; i++) {
        assert_int_equal(waits[i].nodes, expected[i][0]);
        assert_int_equal(waits[i].prims, expected[i][1]);
    }

    no_rays(); /* a ray of a packet waits while it is idle, at a node's boxes too */
    add_ray("J1-1NBB-1P");
    add_ray("J1-0NBB-1P");
    bb_divergence(&made, &in_packets, 8, waits);
    assert_int_equal(waits[0].nodes, 0);
    assert_int_equal(waits[1].nodes, 3);
    assert_int_equal(waits[1].prims, 0);
}

/* ---- a machine ---- */

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

/* ---- bounds ---- */

static bb_simulation simulate_kernel(const bb_simt *simt, const char *kernel)
{
    bb_spec spec;
    bb_simulation simulation;
    bb_traverser_request request = {
        .spec = &spec, .intersector = &bb_intersectors[0], .query = &bb_query_closest};
    const bb_layout_data layout = {.lanes = 1, .kinds = BB_TRIANGLES};
    ASSERT_OK(bb_kernel_parse(kernel, &spec, &request.kernel));
    ASSERT_OK(bb_simulate(simt, &request, &layout, &made, &simulation));
    return simulation;
}

static bb_simulation simulate(const bb_simt *simt)
{
    return simulate_kernel(simt, "stack");
}

/* Nobody knows the instructions and registers of a ray: there is no bound by these, nor a least
 * one. */
static void packets_are_bounded_by_traffic_alone(void **state)
{
    (void)state;
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    no_rays();
    add_rays(16, "J1-1N5B5B5+1-1P3");
    add_rays(16, "J1-0N5B5B5+1-1P3");
    ASSERT_OK(bb_simts_parse((char *[]){"simt:device=h100"}, 1, simts, &count));
    const bb_simulation s = simulate_kernel(&simts[0], "packet8");
    assert_true(isnan(s.mrays_s) && isnan(s.issue_mrays_s) && isnan(s.efficiency));
    assert_true(s.memory_mrays_s > 0 && isfinite(s.memory_mrays_s));
    assert_true(s.l1_mrays_s > 0 && s.l2_mrays_s > 0);
    assert_true(s.node_efficiency == 0.5 && s.prim_efficiency == 1.0);
    assert_true(s.steps == 7); /* pop, node, two boxes, push, pop, primitive */
    assert_true(s.in_flight == simts[0].device.groups);
}

static bb_simt h100(void)
{
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    ASSERT_OK(bb_simts_parse((char *[]){"simt:device=h100"}, 1, simts, &count));
    return simts[0];
}

/* Costs are those of the row that has most of a kernel's options, and no others. */
static void costs_are_those_of_the_options(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    no_rays();
    add_rays(64, "N1+N2P3-P4");
    const double octant = simulate_kernel(&simt, "stack8q:order=octant").issue_mrays_s;
    assert_true(octant > 0);
    assert_true(simulate_kernel(&simt, "stack8q:order=octant,stack=64").issue_mrays_s == octant);
    assert_true(simulate_kernel(&simt, "stack8q:stack=64").issue_mrays_s ==
                simulate_kernel(&simt, "stack8q").issue_mrays_s);
    assert_true(simulate_kernel(&simt, "stack8q").issue_mrays_s != octant);
    assert_true(simulate_kernel(&simt, "stack8q:order=octant,leaf=4").issue_mrays_s != octant);
}

/* Lanes without a ray are no steps of those that there are. */
static void steps_are_those_of_the_group(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    no_rays();
    add_ray("NNP");
    assert_true(simulate_kernel(&simt, "stack").steps == 3);
    add_ray("NN");
    assert_true(simulate_kernel(&simt, "stack:group=1").steps == 2.5);
}

/* Nobody's code is taken for that of spheres; work-groups that tear runs of a sample apart, or are
 * larger than any GPU's, are refused. */
static void what_is_not_known_has_no_bound(void **state)
{
    (void)state;
    const bb_simt simt = h100();
    const bb_layout_data spheres = {.lanes = 1, .kinds = BB_SPHERES};
    bb_spec spec;
    bb_traverser_request request = {
        .spec = &spec, .intersector = &bb_intersectors[0], .query = &bb_query_closest};
    bb_simulation s;
    no_rays();
    add_rays(64, "N1P3");
    ASSERT_OK(bb_kernel_parse("stack", &spec, &request.kernel));
    ASSERT_OK(bb_simulate(&simt, &request, &spheres, &made, &s));
    assert_true(isnan(s.mrays_s) && isnan(s.issue_mrays_s) && s.l2_mrays_s > 0);
    static const char *const torn[] = {"stack:group=33", "stack:group=65536", "stack:group=96"};
    for (int i = 0; i < 3; i++) {
        ASSERT_OK(bb_kernel_parse(torn[i], &spec, &request.kernel));
        assert_int_equal(bb_simulate(&simt, &request, &spheres, &made, &s), BB_UNSUPPORTED);
    }
}

static void bounds_are_those_of_the_device(void **state)
{
    (void)state;
    char *const metrics[] = {"sah", "simt:device=h100"};
    bb_simt simts[BB_SIMT_MAX];
    uint32_t count;
    no_rays();
    for (uint32_t i = 0; i < 200; i++) {
        char steps[64];
        snprintf(steps, sizeof steps, "N%u+N%uP%u-P%u", 3 * i, 5 * i, i, 7 * i);
        add_ray(steps);
    }
    ASSERT_OK(bb_simts_parse(metrics, 2, simts, &count));
    assert_int_equal(count, 1);
    const bb_simt simt = simts[0];
    assert_string_equal(simt.name, "simt:device=h100,width=32");
    const bb_simulation s = simulate(&simt);
    const bb_traffic *t = &s.traffic;
    const double clock = simt.device.clock_ghz * 1e9;
    assert_true(fabs(s.memory_mrays_s * 1e6 * (double)(t->read + t->written) * 32 / 200 /
                         (simt.device.memory_gb_s * 1e9) -
                     1) < 1e-12);
    assert_true(fabs(s.l1_mrays_s * 1e6 * (double)t->first * 32 / 200 /
                         (simt.device.units * simt.device.first_bytes_per_clock * clock) -
                     1) < 1e-12);
    assert_true(fabs(s.l2_mrays_s * 1e6 * (double)(t->second + t->second_written) * 32 / 200 /
                         (simt.device.second_bytes_per_clock * clock) -
                     1) < 1e-12);
    assert_true(s.mrays_s <= s.issue_mrays_s && s.mrays_s <= s.l1_mrays_s &&
                s.mrays_s <= s.l2_mrays_s && s.mrays_s <= s.memory_mrays_s);
    assert_true(s.efficiency > 0 && s.efficiency <= 1);
    assert_true(fabs(s.memory_bytes - (double)(t->read + t->written) * 32 / 200) < 1e-9);

    /* half the units, issues, or clock: half the bound; groups of 64 lanes on 32 take two turns */
    bb_simt other = simt;
    other.device.units /= 2;
    assert_true(simulate(&other).issue_mrays_s * 2 == s.issue_mrays_s);
    assert_true(simulate(&other).l1_mrays_s * 2 == s.l1_mrays_s);
    assert_true(simulate(&other).memory_mrays_s == s.memory_mrays_s);
    other = simt;
    other.device.lanes = 16;
    assert_true(simulate(&other).issue_mrays_s * 2 == s.issue_mrays_s);
    other = simt;
    other.device.memory_gb_s = 1;
    assert_int_equal(simulate(&other).binds, BB_BY_MEMORY);
    assert_true(simulate(&other).mrays_s == simulate(&other).memory_mrays_s);

    /* where instructions are not known, what depends on them is left out */
    const bb_simulated_code unknown = {
        .program = "slice_tets/skip", .kernel = "slice_tets", .footing = footing};
    bb_simulation less;
    ASSERT_OK(bb_simulate_code(&simt, &unknown, &made, &less));
    assert_true(isnan(less.mrays_s) && isnan(less.issue_mrays_s) && isnan(less.efficiency));
    assert_true(less.l1_mrays_s > 0 && less.memory_mrays_s > 0 && less.node_efficiency > 0);

    /* registers, and the most groups, limit what is in flight */
    const bb_description d = {.groups = 64, .registers = 65536, .register_step = 8};
    assert_int_equal(bb_description_in_flight(&d, 32, 32), 64);
    assert_int_equal(bb_description_in_flight(&d, 33, 32), 65536 / (40 * 32));
    assert_int_equal(bb_description_in_flight(&d, 64, 64), 16);
    assert_int_equal(bb_description_in_flight(&d, 5000, 64), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loops_are_left_together),
        cmocka_unit_test(packets_take_their_steps_together),
        cmocka_unit_test(samples_are_taken_together),
        cmocka_unit_test(searches_begin_together),
        cmocka_unit_test(looked_up_after_all_have_found),
        cmocka_unit_test(rays_wait_for_their_group),
        cmocka_unit_test(efficiency_is_that_of_active_lanes),
        cmocka_unit_test(sectors_of_a_step_are_distinct),
        cmocka_unit_test(packets_share_their_entries),
        cmocka_unit_test(samples_read_eight_voxels),
        cmocka_unit_test(caches_find_what_they_hold),
        cmocka_unit_test(work_groups_are_not_torn_apart),
        cmocka_unit_test(the_second_cache_begins_warm),
        cmocka_unit_test(the_line_used_longest_ago_gives_way),
        cmocka_unit_test(sets_share_the_lines),
        cmocka_unit_test(costs_are_those_of_the_options),
        cmocka_unit_test(steps_are_those_of_the_group),
        cmocka_unit_test(what_is_not_known_has_no_bound),
        cmocka_unit_test(bounds_are_those_of_the_device),
        cmocka_unit_test(packets_are_bounded_by_traffic_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
