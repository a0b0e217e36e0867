/* Groups that take the steps of their rays in lockstep (framework/simulate/warp.h), in the order of
 * the kernel's loops. */
#include "framework/simulate/divergence.h"
#include "tests/made_steps.h"

#include <stdio.h>

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

static void leaves_are_found_together(void **state)
{
    (void)state;
    /* a node's boxes, pushes, pops and restarts; a leaf of each ray once all have one */
    no_rays();
    add_ray("BNBB+NB-FPPNBFP");
    add_ray("BNB-NBRNFP");
    expect_order(BB_UNTIL_LEAF, 8, "b2 B2 N2 B2 B1 +1 -1 N2 B2 -1 R1 N1 F2 P2 P1 N1 B1 F1 P1 e2");
    /* what is found is looked up when all have found it */
    no_rays();
    add_ray("ABNFPLABNFPL");
    add_ray("ABNBNFPLABNFPL");
    expect_order(BB_UNTIL_LEAF, 8, "b2 A2 B2 N2 B1 N1 F2 P2 L2 A2 B2 N2 F2 P2 L2 e2");
}

static void exact_tests_come_after_their_primitive(void **state)
{
    (void)state;
    no_rays();
    add_ray("NPXYPPXNPX");
    add_ray("NPPXPNP");
    expect_order(BB_IF_ELSE, 0, "b2 N2 P2 X1 Y1 P2 X1 P2 X1 N2 P2 X1 e2");
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loops_are_left_together),
        cmocka_unit_test(packets_take_their_steps_together),
        cmocka_unit_test(samples_are_taken_together),
        cmocka_unit_test(searches_begin_together),
        cmocka_unit_test(looked_up_after_all_have_found),
        cmocka_unit_test(leaves_are_found_together),
        cmocka_unit_test(exact_tests_come_after_their_primitive),
        cmocka_unit_test(rays_wait_for_their_group),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
