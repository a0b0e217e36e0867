/* Scouts and the choice, on made-up figures. */
#include "framework/advise/advice.h"
#include "framework/advise/heat.h"
#include "framework/advise/scouts.h"
#include "framework/advise/turns.h"
#include "tests/fixture.h"

#include <math.h>
#include <string.h>

/* ---- scouts ---- */

static bb_tried list_of(const char *const *texts)
{
    bb_tried list = {.count = 0};
    for (; *texts != NULL; texts++)
        ASSERT_OK(bb_tried_add(&list, *texts));
    return list;
}

/* Scouts of two builders, three kernels and the presets from the most careless on. */
typedef struct party {
    bb_tried builders, kernels, intersectors;
    bb_entered scouts;
} party;

static party make_party(void)
{
    party p = {.builders = list_of((const char *const[]){"lbvh", "sah", NULL}),
               .kernels = list_of((const char *const[]){"stack", "stack8", "stackless", NULL}),
               .intersectors = list_of((const char *const[]){"careless", "exact", NULL})};
    ASSERT_OK(bb_scouts_enter(&p.builders, &p.kernels, &p.intersectors, &p.scouts));
    return p;
}

static void end_party(party *p)
{
    bb_tried_free(&p->builders);
    bb_tried_free(&p->kernels);
    bb_tried_free(&p->intersectors);
    bb_entered_free(&p->scouts);
}

static uint32_t scout_of(const party *p, const char *kernel, const char *intersector)
{
    for (uint32_t i = 0; i < p->scouts.count; i++)
        if (strcmp(p->scouts.who[i].kernel, kernel) == 0 &&
            strcmp(p->scouts.who[i].intersector, intersector) == 0)
            return i;
    fail_msg("there is no scout %s, %s", kernel, intersector);
    return 0;
}

static void takes(party *p, const char *kernel, const char *intersector, double ms)
{
    bb_racer *racer = &p->scouts.racers[scout_of(p, kernel, intersector)];
    for (int round = 0; round <= 8; round++)
        bb_samples_add(&racer->cost, ms);
}

/* Pairs of kernel and intersector that are left for another builder. */
static const char *left(const party *p)
{
    static char text[256];
    uint32_t count;
    size_t used = 0;
    bb_contender *who = bb_contenders_make(&p->builders, &p->kernels, &p->intersectors, &count);
    count = bb_scouts_keep(&p->scouts, who, count);
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(who[i].builder, "sah") == 0)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s+%s ", who[i].kernel,
                                     who[i].intersector);
    free(who);
    return text;
}

static void kernels_scout_with_the_most_careful(void **state)
{
    (void)state;
    party p = make_party();
    assert_int_equal(p.scouts.count, 4);
    scout_of(&p, "stack", "exact");
    scout_of(&p, "stack8", "exact");
    scout_of(&p, "stackless", "exact");
    p.scouts.racers[scout_of(&p, "stack", "careless")].state = BB_TOO_WRONG;
    p.scouts.racers[scout_of(&p, "stack8", "exact")].state = BB_NOT_RUN;
    bb_scouts_judge(&p.scouts, 3, bb_race_drop, BB_SCOUT_SLACK);
    assert_string_equal(left(&p), "stack+exact stack8+careless stack8+exact stackless+careless "
                                  "stackless+exact ");
    end_party(&p);
}

/* The kernel that all intersectors were tried with is slow; that is not their fault. */
static void a_slow_kernel_drops_no_intersector(void **state)
{
    (void)state;
    party p = make_party();
    takes(&p, "stack", "exact", 10);
    takes(&p, "stack", "careless", 9);
    takes(&p, "stack8", "exact", 3);
    takes(&p, "stackless", "exact", 4.1);
    bb_scouts_judge(&p.scouts, 3, bb_race_drop, BB_SCOUT_SLACK);
    const bb_racer *slow = &p.scouts.racers[scout_of(&p, "stackless", "exact")];
    assert_int_equal(slow->state, BB_TOO_SLOW);
    assert_int_equal(slow->behind, scout_of(&p, "stack8", "exact"));
    assert_string_equal(left(&p), "stack8+careless stack8+exact ");
    end_party(&p);
}

static void a_slow_intersector_drops_no_kernel(void **state)
{
    (void)state;
    party p = make_party();
    takes(&p, "stack", "exact", 3);
    takes(&p, "stack", "careless", 10);
    takes(&p, "stack8", "exact", 3);
    takes(&p, "stackless", "exact", 3);
    bb_scouts_judge(&p.scouts, 3, bb_race_drop, BB_SCOUT_SLACK);
    const bb_racer *slow = &p.scouts.racers[scout_of(&p, "stack", "careless")];
    assert_int_equal(slow->state, BB_TOO_SLOW);
    assert_int_equal(slow->behind, scout_of(&p, "stack", "exact"));
    assert_string_equal(left(&p), "stack+exact stack8+exact stackless+exact ");
    end_party(&p);
}

/* Who is faster may be wrong when more is measured. */
static void the_most_careful_is_never_too_slow(void **state)
{
    (void)state;
    party p = make_party();
    takes(&p, "stack", "exact", 10);
    takes(&p, "stack", "careless", 1);
    takes(&p, "stack8", "exact", 10);
    takes(&p, "stackless", "exact", 20);
    bb_scouts_judge(&p.scouts, 3, bb_race_drop, BB_SCOUT_SLACK);
    assert_string_equal(left(&p), "stack+careless stack+exact stack8+careless stack8+exact ");
    end_party(&p);
}

/* A scout on a sample says nothing of a pair that is wrong, and all of a builder that is slow. */
static void a_slow_builder_is_left_out(void **state)
{
    (void)state;
    party p = make_party();
    bb_entered builders;
    uint32_t count;
    ASSERT_OK(bb_scouts_enter_builders(&p.builders, "stack8", &p.intersectors, &builders));
    assert_int_equal(builders.count, 2);
    assert_string_equal(builders.who[0].intersector, "exact");
    builders.racers[0].state = BB_TOO_SLOW;
    builders.racers[1].state = BB_TOO_WRONG;
    bb_contender *who = bb_contenders_make(&p.builders, &p.kernels, &p.intersectors, &count);
    assert_int_equal(bb_scouts_keep_builders(&builders, who, count), count / 2);
    for (uint32_t i = 0; i < count / 2; i++)
        assert_string_equal(who[i].builder, "sah");
    free(who);
    bb_entered_free(&builders);
    end_party(&p);
}

/* By its builder's build, and by its kernel's and its intersector's share of layout and rays. */
static void an_unlikely_pair_is_left_out(void **state)
{
    (void)state;
    party p = make_party();
    bb_entered builders;
    uint32_t count;
    ASSERT_OK(bb_scouts_enter_builders(&p.builders, "stack8", &p.intersectors, &builders));
    builders.figures[0] =
        (bb_tried_figures){.measured = true, .build_ms = 1, .layout_ms = 4, .trace_ms = 5};
    builders.figures[1] =
        (bb_tried_figures){.measured = true, .build_ms = 11, .layout_ms = 4, .trace_ms = 4};
    for (uint32_t i = 0; i < p.scouts.count; i++)
        p.scouts.figures[i] =
            (bb_tried_figures){.measured = true, .build_ms = 50, .layout_ms = 10, .trace_ms = 10};
    bb_tried_figures *slow = &p.scouts.figures[scout_of(&p, "stackless", "exact")];
    slow->layout_ms = 15; /* 6 and 9 ms of the first, 6 and 7.2 of the second */
    slow->trace_ms = 18;
    p.scouts.figures[scout_of(&p, "stack", "careless")].trace_ms = 5;
    /* foretold of lbvh: 10 (careless 7.5), with stackless 16 (11.5); of sah 19 (17), 24.2 (20.6) */
    bb_contender *who = bb_contenders_make(&p.builders, &p.kernels, &p.intersectors, &count);
    assert_int_equal(count, 12);
    assert_int_equal(bb_scouts_keep_likely(&p.scouts, &builders, who, count, 2.4), 8);
    for (uint32_t i = 6; i < 8; i++) {
        assert_string_equal(who[i].builder, "sah");
        assert_string_equal(who[i].intersector, "careless");
    }
    assert_int_equal(bb_scouts_keep_likely(&p.scouts, &builders, who, 8, 1.6), 5);
    builders.figures[1].measured = false; /* of sah nothing is foretold */
    free(who);
    who = bb_contenders_make(&p.builders, &p.kernels, &p.intersectors, &count);
    assert_int_equal(bb_scouts_keep_likely(&p.scouts, &builders, who, count, 1.6), 11);
    free(who);
    bb_entered_free(&builders);
    end_party(&p);
}

/* ---- turns ---- */

/* Trees of 100 bytes, layouts of 10, room for two trees and three layouts. */
static void turns_fit_into_memory(void **state)
{
    (void)state;
    party p = make_party();
    bb_entered field, builders;
    uint32_t count, turns = 0, seen = 0;
    ASSERT_OK(bb_scouts_enter_builders(&p.builders, "stack8", &p.intersectors, &builders));
    for (uint32_t i = 0; i < builders.count; i++)
        builders.figures[i] = (bb_tried_figures){.measured = true, .bytes_build = 100};
    for (uint32_t i = 0; i < p.scouts.count; i++)
        p.scouts.figures[i] = (bb_tried_figures){.measured = true, .bytes_layout = 10};
    bb_sizes sizes = {{&p.scouts, &builders}, 230};
    assert_true(bb_size_of_build(&sizes, "sah") == 100);
    assert_true(bb_size_of_layout(&sizes, "nobody") == 10);
    bb_contender *who = bb_contenders_make(&p.builders, &p.kernels, &p.intersectors, &count);
    ASSERT_OK(bb_entered_make(who, count, &field));
    assert_int_equal(count, 12);
    bool in[12], done[12] = {false};
    for (uint32_t now; (now = bb_turn(&field, 11, &sizes, done, in)) > 0; turns++) {
        uint32_t others = 0;
        assert_true(in[11]);
        for (uint32_t i = 0; i < count; i++) {
            others += in[i] && !done[i];
            done[i] = done[i] || in[i];
        }
        assert_int_equal(others, now);
        seen += now;
        /* beside the reference's tree and layout one tree and two layouts, each for both
         * intersectors; and who shares the reference's */
        assert_true(turns > 0 || now == 6);
    }
    assert_int_equal(seen, 12);
    assert_int_equal(turns, 3);
    sizes.room = 1; /* one at a time, beside the reference */
    memset(done, 0, sizeof done);
    assert_int_equal(bb_turn(&field, 11, &sizes, done, in), 2);
    assert_int_equal(bb_turn(&field, 11, NULL, done, in), 12);
    bb_entered_free(&field);
    bb_entered_free(&builders);
    end_party(&p);
}

/* ---- the choice ---- */

static void set(bb_entered *field, uint32_t i, double ms, double bytes)
{
    field->racers[i] = (bb_racer){.state = BB_RACING, .behind = BB_NO_RACER};
    for (int round = 0; round <= 6; round++)
        bb_samples_add(&field->racers[i].cost, ms);
    field->figures[i].extent = (bb_extent){.bytes = bytes, .ms = ms, .place = i};
}

static void the_least_of_the_fast_is_chosen(void **state)
{
    (void)state;
    static bb_tried_figures figures[4];
    bb_racer racers[4];
    bb_contender who[4] = {{NULL, NULL, NULL}};
    bb_entered field = {who, racers, figures, 4};
    uint32_t best, least, within;
    set(&field, 0, 10, 5e6);
    set(&field, 1, 10.4, 4e6);
    set(&field, 2, 10.6, 1e6); /* too slow by a little */
    set(&field, 3, 1, 1e6);
    racers[3].state = BB_TOO_WRONG;
    bb_choose_least(&field, &best, &least, &within);
    assert_int_equal(best, 0);
    assert_int_equal(least, 1);
    assert_int_equal(within, 2);
    for (int i = 0; i < 4; i++)
        racers[i].state = BB_NOT_RUN;
    bb_choose_least(&field, &best, &least, &within);
    assert_int_equal(best, BB_NONE_CHOSEN);
    assert_int_equal(least, BB_NONE_CHOSEN);
}

/* Slower in one round, with which its median is the higher one; faster in all others. */
static void the_fastest_is_so_round_by_round(void **state)
{
    (void)state;
    static bb_tried_figures figures[3];
    static const double costs[3][7] = {
        {1, 1, 2, 3, 10, 11, 12}, {1, 0.9, 1.9, 9.5, 9.6, 10.5, 11.5}, {1, 20, 20, 20, 20, 20, 20}};
    bb_racer racers[3];
    bb_contender who[3] = {{NULL, NULL, NULL}};
    bb_entered field = {who, racers, figures, 3};
    uint32_t best, least, within;
    for (uint32_t i = 0; i < 3; i++) {
        set(&field, i, 0, i == 1 ? 1e6 : 2e6);
        racers[i].cost.count = 0;
        for (int round = 0; round < 7; round++)
            bb_samples_add(&racers[i].cost, costs[i][round]);
    }
    assert_int_equal(bb_race_best(racers, 3), 0);
    bb_choose_least(&field, &best, &least, &within);
    assert_int_equal(best, 1);
    assert_int_equal(least, 1);
    assert_true(bb_race_ratio(&racers[0], &racers[1]).value > 1);
    racers[1].state = BB_TOO_WRONG;
    assert_int_equal(bb_race_fastest(racers, 3), 0);
    racers[0].state = racers[2].state = BB_NOT_RUN;
    assert_int_equal(bb_race_fastest(racers, 3), BB_NO_RACER);
}

static void kinds_are_counted(void **state)
{
    (void)state;
    assert_int_equal(bb_kinds_in(""), 0);
    assert_int_equal(bb_kinds_in("triangles"), 1);
    assert_int_equal(bb_kinds_in("triangles+spheres+boxes"), 3);
}

/* What is not for the scene to choose stays. */
static void generous_settings_keep_the_rest(void **state)
{
    (void)state;
    static const struct {
        const char *own, *generous;
    } cases[] = {{"lbvh", "lbvh:bits=63"},
                 {"lbvh:bits=auto", "lbvh:bits=63"},
                 {"lbvh:arity=8,bits=auto", "lbvh:bits=63,arity=8"},
                 {"emc:code=emc64-cell,bits=auto,size-bits=auto",
                  "emc:bits=64,size-bits=24,code=emc64-cell"},
                 {"lbvh:arity=8,bits=63", NULL}, /* it has them */
                 {"sah", NULL},
                 {"presplit+lbvh", NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[128];
        const bool has = bb_generous_builder(cases[i].own, text, sizeof text);
        assert_int_equal(has, cases[i].generous != NULL);
        if (has)
            assert_string_equal(text, cases[i].generous);
    }
    char narrow[16];
    assert_false(bb_generous_builder("lbvh:arity=8", narrow, sizeof narrow));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_scout_with_the_most_careful),
        cmocka_unit_test(a_slow_kernel_drops_no_intersector),
        cmocka_unit_test(a_slow_intersector_drops_no_kernel),
        cmocka_unit_test(the_most_careful_is_never_too_slow),
        cmocka_unit_test(a_slow_builder_is_left_out),
        cmocka_unit_test(an_unlikely_pair_is_left_out),
        cmocka_unit_test(turns_fit_into_memory),
        cmocka_unit_test(the_least_of_the_fast_is_chosen),
        cmocka_unit_test(the_fastest_is_so_round_by_round),
        cmocka_unit_test(kinds_are_counted),
        cmocka_unit_test(generous_settings_keep_the_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
