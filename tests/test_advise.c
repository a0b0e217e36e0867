/* Advice: racing on made-up samples, the order of leastness, the choice; then the program from
 * outside. Seed of the simulation: BVHBENCH_TEST_SEED. */
#include "framework/advise/advice.h"
#include "framework/advise/heat.h"
#include "framework/advise/scouts.h"
#include "framework/base/random.h"
#include "framework/base/shell_word.h"
#include "tests/program_fixture.h"

#include <math.h>

/* ---- racing ---- */

enum { MANY = 12 };

typedef struct track {
    double cost[MANY];    /* of each, in truth */
    double noise, shared; /* of one measurement; of a round, on all */
    uint32_t rounds;
    bb_random random;
    uint32_t measured[MANY]; /* heats */
    uint32_t fails_in;       /* heat in which measuring fails; UINT32_MAX: none */
} track;

/* Heavy-tailed upwards, as times are. */
static double noisy(track *t, double spread)
{
    return exp(spread * pow(bb_random_unit(&t->random), 4) * 4);
}

static bb_status measure(void *user, uint32_t heat, bb_racer *racers, uint32_t count)
{
    track *t = user;
    if (heat == t->fails_in)
        return bb_fail(BB_FAILED, "the track is flooded");
    for (uint32_t i = 0; i < count; i++)
        racers[i].cost.count = racers[i].state == BB_RACING ? 0 : racers[i].cost.count;
    for (uint32_t round = 0; round <= t->rounds; round++) {
        double common = noisy(t, t->shared);
        for (uint32_t i = 0; i < count; i++)
            if (racers[i].state == BB_RACING)
                bb_samples_add(&racers[i].cost, t->cost[i] * common * noisy(t, t->noise));
    }
    for (uint32_t i = 0; i < count; i++)
        t->measured[i] += racers[i].state == BB_RACING;
    return BB_OK;
}

static track make_track(uint64_t seed, double noise, uint32_t rounds)
{
    return (track){.noise = noise,
                   .shared = 0.5,
                   .rounds = rounds,
                   .random = bb_random_make(seed, 0),
                   .fails_in = UINT32_MAX};
}

/* Twelve between 1 and 2, many of them close to the best. Returns how much slower than the winner
 * the best of those is that are left; counts who is dropped. */
static double race_of_many(track *t, uint32_t *dropped)
{
    bb_racer racers[MANY];
    double winner = 2, left = INFINITY;
    for (uint32_t i = 0; i < MANY; i++) {
        t->cost[i] = 1 + pow(bb_random_unit(&t->random), 3);
        winner = fmin(winner, t->cost[i]);
    }
    ASSERT_OK(bb_race_run(racers, MANY, 3, BB_ADVISE_SLACK, measure, t));
    for (uint32_t i = 0; i < MANY; i++) {
        *dropped += racers[i].state == BB_TOO_SLOW;
        if (racers[i].state == BB_RACING)
            left = fmin(left, t->cost[i]);
    }
    return left / winner;
}

/* Factors of noise up to 1.1, 1.5. */
static void the_winner_is_never_dropped(void **state)
{
    (void)state;
    const uint64_t seed = seed_or(20261122);
    enum { TRIALS = 2000 };
    uint32_t dropped = 0;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        track t = make_track(seed + trial, trial % 2 ? 0.025 : 0.1, 8);
        if (race_of_many(&t, &dropped) != 1)
            fail_msg("seed %llu: the winner was dropped", (unsigned long long)(seed + trial));
    }
    assert_true(dropped > TRIALS * MANY / 3); /* it is a race all the same */
}

/* Factors up to 2.2: luck may drop the winner now and then, for one that is as good. */
static void noise_costs_little(void **state)
{
    (void)state;
    const uint64_t seed = seed_or(20261122);
    enum { TRIALS = 2000 };
    uint32_t dropped = 0, lost = 0;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        track t = make_track(seed + trial, 0.2, 8);
        double left = race_of_many(&t, &dropped);
        lost += left != 1;
        if (left > BB_ADVISE_SLACK)
            fail_msg("seed %llu: all that are left are slower than the winner by %.3f",
                     (unsigned long long)(seed + trial), left);
    }
    assert_true(lost <= TRIALS / 100);
}

static void who_is_surely_slower_is_dropped(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, 6);
    bb_racer racers[4];
    const double costs[] = {1.2, 1, 1.04, 3};
    memcpy(t.cost, costs, sizeof costs);
    ASSERT_OK(bb_race_run(racers, 4, 3, BB_ADVISE_SLACK, measure, &t));
    assert_int_equal(racers[0].state, BB_TOO_SLOW);
    assert_int_equal(racers[0].behind, 1);
    assert_true(racers[0].ratio.least > 1.05 && fabs(racers[0].ratio.value - 1.2) < 0.05);
    assert_int_equal(racers[1].state, BB_RACING);
    assert_int_equal(racers[2].state, BB_RACING); /* within 5 % */
    assert_int_equal(racers[3].state, BB_TOO_SLOW);
    const uint32_t heats[] = {1, 3, 3, 1};
    for (int i = 0; i < 4; i++) { /* what is out is measured no more */
        assert_int_equal(t.measured[i], heats[i]);
        assert_int_equal(racers[i].heats, heats[i]);
    }
}

static void too_few_rounds_drop_nobody(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, BB_INTERVAL_ROUNDS - 1);
    bb_racer racers[2];
    t.cost[0] = 1;
    t.cost[1] = 100;
    ASSERT_OK(bb_race_run(racers, 2, 3, BB_ADVISE_SLACK, measure, &t));
    assert_int_equal(racers[1].state, BB_RACING);
}

static void ties_stay_in_order(void **state)
{
    (void)state;
    track t = make_track(1, 0, 6);
    bb_racer racers[3];
    t.cost[0] = t.cost[1] = t.cost[2] = 2;
    ASSERT_OK(bb_race_run(racers, 3, 2, BB_ADVISE_SLACK, measure, &t));
    assert_int_equal(bb_race_best(racers, 3), 0);
    for (int i = 0; i < 3; i++)
        assert_int_equal(racers[i].state, BB_RACING);
    t.cost[2] = 2 * BB_ADVISE_SLACK; /* exactly as much as is allowed */
    ASSERT_OK(bb_race_run(racers, 3, 2, BB_ADVISE_SLACK * (1 + 1e-12), measure, &t));
    assert_int_equal(racers[2].state, BB_RACING);
}

static bb_status lose_two(void *user, uint32_t heat, bb_racer *racers, uint32_t count)
{
    BB_TRY(measure(user, heat, racers, count));
    racers[0].state = BB_TOO_WRONG;
    racers[1].state = BB_NOT_RUN;
    return BB_OK;
}

static bb_status lose_all(void *user, uint32_t heat, bb_racer *racers, uint32_t count)
{
    BB_TRY(measure(user, heat, racers, count));
    for (uint32_t i = 0; i < count; i++)
        racers[i].state = BB_TOO_WRONG;
    return BB_OK;
}

/* However fast it is. */
static void what_is_wrong_does_not_win(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, 6);
    bb_racer racers[4];
    const double costs[] = {0.1, 0.1, 1, 1.5};
    memcpy(t.cost, costs, sizeof costs);
    ASSERT_OK(bb_race_run(racers, 4, 3, BB_ADVISE_SLACK, lose_two, &t));
    assert_int_equal(bb_race_best(racers, 4), 2);
    assert_int_equal(racers[0].state, BB_TOO_WRONG);
    assert_int_equal(racers[1].state, BB_NOT_RUN);
    assert_int_equal(racers[3].behind, 2);
    ASSERT_OK(bb_race_run(racers, 4, 3, BB_ADVISE_SLACK, lose_all, &t));
    assert_int_equal(bb_race_best(racers, 4), BB_NO_RACER);
}

static void failures_are_passed_up(void **state)
{
    (void)state;
    track t = make_track(1, 0.001, 6);
    bb_racer racers[2];
    t.fails_in = 1;
    t.cost[0] = t.cost[1] = 1;
    assert_int_equal(bb_race_run(racers, 2, 3, BB_ADVISE_SLACK, measure, &t), BB_FAILED);
    assert_string_equal(bb_message(), "the track is flooded");
}

/* ---- leastness ---- */

static const bb_extent middle = {.bytes = 1e6,
                                 .code_bits = 30,
                                 .stack = 64,
                                 .kinds = 2,
                                 .width = 4,
                                 .doubt = 1,
                                 .ms = 10,
                                 .place = 5};

static void the_first_difference_decides(void **state)
{
    (void)state;
    bb_extent less[8], more = middle;
    const char *const reasons[] = {"memory",
                                   "bits of the code",
                                   "entries of the stack",
                                   "kinds of primitives",
                                   "children of a node",
                                   "a more careful intersector",
                                   "time",
                                   "its place in the list"};
    for (int i = 0; i < 8; i++)
        less[i] = middle;
    less[0].bytes = 0.9e6;
    less[1].code_bits = 29;
    less[2].stack = 32;
    less[3].kinds = 1;
    less[4].width = 2;
    less[5].doubt = 0;
    less[6].ms = 9;
    less[7].place = 4;
    for (int i = 0; i < 8; i++) {
        bb_extent one = less[i]; /* more of all that comes later */
        one.code_bits += i < 1 ? 9 : 0;
        one.stack += i < 2 ? 9 : 0;
        one.kinds += i < 3 ? 9 : 0;
        one.width += i < 4 ? 9 : 0;
        one.doubt += i < 5 ? 9 : 0;
        one.ms += i < 6 ? 9 : 0;
        one.place += i < 7 ? 9 : 0;
        assert_true(bb_extent_compare(&one, &more) < 0);
        assert_true(bb_extent_compare(&more, &one) > 0);
        assert_string_equal(bb_extent_reason(&one, &more), reasons[i]);
    }
    assert_int_equal(bb_extent_compare(&middle, &middle), 0);
}

/* What has no bytes that are known is no bargain. */
static void unknown_memory_is_the_most(void **state)
{
    (void)state;
    bb_extent unknown = middle, none = middle;
    unknown.bytes = NAN;
    none.bytes = 0;
    assert_true(bb_extent_compare(&unknown, &middle) > 0);
    assert_true(bb_extent_compare(&none, &middle) > 0);
}

static bb_extent random_extent(bb_random *random)
{
    return (bb_extent){.bytes = 1e6 * pow(1.1, bb_random_unit(random)),
                       .code_bits = (uint32_t)bb_random_below(random, 2),
                       .stack = (uint32_t)bb_random_below(random, 2),
                       .kinds = (uint32_t)bb_random_below(random, 2),
                       .width = (uint32_t)bb_random_below(random, 2),
                       .ms = (double)bb_random_below(random, 2),
                       .place = (uint32_t)bb_random_below(random, 3)};
}

static void it_is_an_order(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed_or(3), 0);
    for (int i = 0; i < 200000; i++) {
        bb_extent a = random_extent(&random), b = random_extent(&random),
                  c = random_extent(&random);
        int ab = bb_extent_compare(&a, &b), bc = bb_extent_compare(&b, &c);
        assert_true((ab < 0) == (bb_extent_compare(&b, &a) > 0));
        if (ab <= 0 && bc <= 0)
            assert_true(bb_extent_compare(&a, &c) <= 0);
    }
}

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
    bb_scouts_judge(&p.scouts, 3, BB_SCOUT_SLACK);
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
    bb_scouts_judge(&p.scouts, 3, BB_SCOUT_SLACK);
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
    bb_scouts_judge(&p.scouts, 3, BB_SCOUT_SLACK);
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
    bb_scouts_judge(&p.scouts, 3, BB_SCOUT_SLACK);
    assert_string_equal(left(&p), "stack+careless stack+exact stack8+careless stack8+exact ");
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

/* ---- the program ---- */

#define SMALL "advise --size 16x16 --quick --quiet --count 1000 "

static double number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (!cJSON_IsNumber(item))
        fail_msg("%s is no number", name);
    return item->valuedouble;
}

static const cJSON *part(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (item == NULL)
        fail_msg("there is no %s", name);
    return item;
}

static bool is(const cJSON *object, const char *name, const char *text)
{
    return strcmp(part(object, name)->valuestring, text) == 0;
}

static void advice_as_json(void **state)
{
    (void)state;
    const outcome *o =
        run(SMALL "--scene random:n=2000 --max-rays 1024 --rays primary,diffuse --builder "
                  "lbvh:bits=63,lbvh:bits=auto,sah --kernel stack,stack8:leaf=8 "
                  "--exhaustive --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    assert_non_null(json);
    assert_true(is(json, "schema", "bvhbench-advice/1"));
    assert_true(number(json, "prims") == 2000 && number(json, "image_rays") == 1000);
    const cJSON *choice = part(json, "choice"), *one;
    assert_true(number(choice, "wrong") == 0 && number(choice, "checked") > 500);
    assert_true(fabs(number(choice, "wrong_ppm_at_most") - 3e6 / number(choice, "checked")) < 1);
    assert_true(number(choice, "bytes") ==
                number(choice, "bytes_build") + number(choice, "bytes_layout"));
    assert_true(number(choice, "ratio") <= 1.05);
    assert_true(is(part(part(choice, "decisions"), "kinds compiled in"), "value", "triangles"));
    assert_true(is(part(part(json, "needs"), "code bits"), "by", "scene"));
    uint32_t chosen = 0, count = 0;
    cJSON_ArrayForEach(one, part(json, "contenders"))
    {
        count++;
        if (!is(one, "state", "chosen"))
            continue;
        chosen++;
        assert_true(is(one, "builder", part(choice, "builder")->valuestring));
    }
    assert_true(count > 0 && count <= 6 && chosen == 1);
    cJSON_ArrayForEach(one, part(json, "savings"))
        assert_true(number(one, "bytes") > -1e6 && isfinite(number(one, "ms")));
    assert_int_equal(number(part(json, "exhaustive"), "configurations"), 6);
    assert_true(number(part(json, "exhaustive"), "ratio") > 0);

    /* the command that it names measures just that */
    char command[1024];
    snprintf(command, sizeof command, "%s --quick --quiet --charts no --no-pictures",
             part(json, "command")->valuestring + strlen("bvhbench "));
    expect(0, command, part(choice, "builder")->valuestring);
    cJSON_Delete(json);
}

static void advice_as_text(void **state)
{
    (void)state;
    const outcome *o = expect(0,
                              SMALL "--scene cube --rays primary --builder lbvh:bits=auto "
                                    "--kernel stack --out kept --charts no",
                              "What the scene asks for");
    static const char *const words[] = {
        "The least that does it",          "paired round by round", "lbvh:bits=auto",
        "none wrong of 256 judged, below", "lbvh:bits=63",          "a stack of 1024, not 16",
        "bvhbench run --scene cube"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strstr(o->out, words[i]) == NULL)
            fail_msg("no '%s' in:\n%s", words[i], o->out);
    cJSON *json = read_results("kept/results.json");
    part(json, "advice");
    assert_true(cJSON_GetArraySize(part(json, "traces")) >= 1);
    cJSON_Delete(json);
    expect(0, "report kept --table", "lbvh:bits=auto"); /* it is a result file like any */
}

static void words_are_quoted_for_a_shell(void **state)
{
    (void)state;
    static const char *const words[][2] = {
        {"lbvh:bits=63,size=1.5", "lbvh:bits=63,size=1.5"},
        {"", "''"},
        {"my scene.ply", "'my scene.ply'"},
        {"$(touch pwned)`ls`", "'$(touch pwned)`ls`'"},
        {"it's", "'it'\\''s'"},
        {"~/a\nb", "'~/a\nb'"},
    };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        char *text = NULL;
        size_t size;
        FILE *out = open_memstream(&text, &size);
        assert_non_null(out);
        bb_put_shell_word(out, words[i][0]);
        fclose(out);
        assert_string_equal(text, words[i][1]);
        free(text);
    }
}

/* A file whose name a shell would take to pieces; the command is run by one. */
static void the_command_is_the_same_to_a_shell(void **state)
{
    (void)state;
    char name[600], command[2048];
    snprintf(name, sizeof name, "%s/a $(touch pwned) b's.obj", folder);
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
    assert_int_equal(fclose(file), 0);
    const outcome *o = run(SMALL "--scene 'a $(touch pwned) b'\\''s.obj' --rays primary --builder "
                                 "lbvh --kernel stack --seed 7 --max-rays 1k --device 0 --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    const char *text = part(json, "command")->valuestring;
    assert_non_null(strstr(text, " --size 16x16 --max-rays 1k --seed 7 --device 0"));
    snprintf(command, sizeof command, "%s --quick --quiet --charts no --no-pictures",
             text + strlen("bvhbench "));
    expect(0, command, "lbvh");
    snprintf(name, sizeof name, "%s/pwned", folder);
    assert_null(fopen(name, "r"));
    cJSON_Delete(json);
}

/* A name with what clears a terminal, sets its title, turns the writing. */
static void a_name_does_not_steer_the_terminal(void **state)
{
    (void)state;
#define EVIL "\033[2J\033]0;x\007\302\233\342\200\256.obj"
    char name[600];
    snprintf(name, sizeof name, "%s/" EVIL, folder);
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
    assert_int_equal(fclose(file), 0);
    static const char *const arguments[] = {
        "advise --size 16x16 --quick --count 1000 --scene '" EVIL
        "' --rays primary --builder lbvh --kernel stack",
        "advise --scene 'nosuch" EVIL "'"};
    for (int i = 0; i < 2; i++) {
        const outcome *o = run(arguments[i]);
        assert_int_equal(o->exit_status, i == 0 ? 0 : 2);
        const char *shown = i == 0 ? o->out : o->err;
        if (strstr(shown, "?[2J?]0;x???.obj") == NULL)
            fail_msg("the name is not shown:\n%s", shown);
        assert_null(strstr(o->out, "\033[2J"));
        assert_null(strstr(o->err, "\033[2J"));
        assert_null(strstr(o->out, "\342\200\256"));
        assert_null(strstr(o->err, "\342\200\256"));
    }
#undef EVIL
}

/* Rays at edges, and an intersector that loses some of them. */
static void nothing_right_enough_is_status_1(void **state)
{
    (void)state;
    const char *careless = SMALL "--scene sphere-mesh:n=8 --rays edges --builder lbvh --kernel "
                                 "stack --intersector careless ";
    char arguments[512];
    snprintf(arguments, sizeof arguments, "%s --max-rays 20k", careless);
    expect(1, arguments, "Nothing that was tried is right often enough");
    snprintf(arguments, sizeof arguments, "%s --max-rays 20k --json", careless);
    const outcome *o = expect(1, arguments, "\"choice\":\tnull");
    assert_non_null(strstr(o->out, "too wrong"));
    /* all are out before the last heat, whose document has nothing of the scene */
    cJSON *json = cJSON_Parse(o->out);
    assert_true(number(json, "prims") > 0);
    part(part(json, "needs"), "code bits");
    cJSON_Delete(json);
    snprintf(arguments, sizeof arguments, "%s --max-rays 20k --max-wrong-ppm 1e6", careless);
    expect(0, arguments, "careless: ");
}

/* 256 rays without a wrong one show a rate below 11,719 per million, and no less. */
static void a_limit_that_rays_cannot_show_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *limit, *text;
        bool shown;
    } cases[] = {{"0", NULL, false},
                 {"11718", "257 judged rays if none is wrong", false},
                 {"10", "300,000 judged rays if none is wrong", false},
                 {"11719", NULL, true},
                 {"1e6", NULL, true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments,
                 SMALL "--scene cube --rays primary --builder lbvh --kernel stack --intersector "
                       "exact --max-wrong-ppm %s --out limit%zu --charts no",
                 cases[i].limit, i);
        const outcome *o =
            expect(0, arguments, cases[i].text != NULL ? cases[i].text : "none wrong of 256");
        assert_int_equal(strstr(o->out, "do not show") != NULL, cases[i].text != NULL);
        snprintf(arguments, sizeof arguments, "limit%zu/results.json", i);
        cJSON *json = read_results(arguments);
        const cJSON *choice = part(part(json, "advice"), "choice");
        assert_int_equal(cJSON_IsTrue(part(choice, "limit_shown")), cases[i].shown);
        cJSON_Delete(json);
    }
}

static const cJSON *find(const cJSON *list, const char *builder, const char *kernel,
                         const char *intersector)
{
    const cJSON *one;
    cJSON_ArrayForEach(one, list)
    {
        if (is(one, "builder", builder) && is(one, "kernel", kernel) &&
            is(one, "intersector", intersector))
            return one;
    }
    return NULL;
}

/* The first kernel's stack is too short: whoever is right gives other answers. */
static void who_is_right_stays_beside_one_that_is_wrong(void **state)
{
    (void)state;
    const outcome *o = run("advise --scene ladder --builder lbvh:bits=30 --kernel "
                           "stack:stack=4,stack --rays primary --quick --quiet --size 32x32 "
                           "--max-rays 1024 --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    const cJSON *field = part(json, "contenders");
    const cJSON *wrong = find(field, "lbvh:bits=30", "stack:stack=4", "exact");
    assert_true(is(wrong, "state", "too wrong") && number(wrong, "wrong") > 0);
    assert_true(is(find(field, "lbvh:bits=30", "stack", "exact"), "state", "chosen"));
    cJSON_Delete(json);
}

/* What an intersector gets wrong is not the kernels' fault. */
static void kernels_are_not_dropped_for_an_intersector(void **state)
{
    (void)state;
    const outcome *o = run(SMALL "--scene slivers --builder lbvh,sah --kernel stackless,stack "
                                 "--intersector careless,exact --rays primary --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    const cJSON *scouts = part(json, "scouts");
    assert_int_equal(cJSON_GetArraySize(scouts), 3);
    assert_true(is(find(scouts, "lbvh", "stackless", "careless"), "state", "too wrong"));
    assert_false(is(find(scouts, "lbvh", "stackless", "exact"), "state", "too wrong"));
    assert_false(is(find(scouts, "lbvh", "stack", "exact"), "state", "too wrong"));
    assert_true(is(part(json, "choice"), "intersector", "exact"));
    cJSON_Delete(json);
}

static void what_cannot_be_done_is_refused(void **state)
{
    (void)state;
    refuses("", "advise", "give one --scene");
    refuses("", "advise --scene cube --scene coffee", "give one --scene");
    refuses("", "advise --scene coffe", "coffe");
    refuses("", "advise --scene cube --builder nosuch", "nosuch");
    refuses("", "advise --scene cube --builder embree-native:quality=high", "reference row");
    refuses("", "advise --scene cube --kernel stack:stack=7", "stack");
    refuses("", "advise --scene cube --kernel stackless:stack=16", "no stack");
    refuses("", "advise --scene cube --kernel stack:kinds=some", "kinds");
    refuses("", "advise --quiet --scene cube --builder lbvh:bits=few", "bits");
    refuses("", "advise --scene cube --intersector sloppy", "sloppy");
    refuses("", "advise --scene cube --rays none", "none");
    refuses("", "advise --scene cube --repeats 5", "--repeats");
    refuses("", "advise --scene cube --count 0", "--count");
    refuses("", "advise --scene cube --max-wrong-ppm -1", "--max-wrong-ppm");
    refuses("", "advise --scene cube --max-wrong-ppm nan", "--max-wrong-ppm");
    refuses("", "advise --scene cube --out /dev/null/x", "/dev/null/x");
}

/* Too short a stack is never silent, and what was given is recorded as given. */
static void kernels_take_what_is_given(void **state)
{
    (void)state;
    const char *kernels =
        "run --quiet --charts no --no-pictures --scene random:n=3000 --rays primary "
        "--size 32x32 --repeats 1 --builder lbvh --out given --kernel ";
    char arguments[512];
    snprintf(arguments, sizeof arguments,
             "%s stack,stack:kinds=all,stack:stack=1024,stack8:leaf=8,stack8:leaf=8,kinds=all",
             kernels);
    expect(0, arguments, ""); /* all answers are the same, bit for bit */
    cJSON *json = read_results("given/results.json");
    const cJSON *trace;
    cJSON_ArrayForEach(trace, part(json, "traces"))
    {
        const cJSON *kernel = part(trace, "kernel");
        if (cJSON_IsTrue(part(trace, "reference")))
            continue;
        const cJSON *kinds = part(part(trace, "decisions"), "kinds compiled in");
        const cJSON *stack = part(part(trace, "decisions"), "stack entries");
        bool all = strstr(kernel->valuestring, "kinds=all") != NULL;
        bool large = strstr(kernel->valuestring, "stack=1024") != NULL;
        assert_true(is(kinds, "by", all ? "given" : "scene"));
        assert_true(is(kinds, "value", all ? "triangles+spheres+boxes" : "triangles"));
        assert_true(is(stack, "by", large ? "given" : "tree"));
        assert_true(number(stack, "value") == number(trace, "stack_size"));
        assert_true((number(stack, "value") == 1024) == large);
    }
    cJSON_Delete(json);
    snprintf(arguments, sizeof arguments, "%s stack:stack=4", kernels);
    const outcome *o = run(arguments);
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->err, "WRONG"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_winner_is_never_dropped),
        cmocka_unit_test(noise_costs_little),
        cmocka_unit_test(who_is_surely_slower_is_dropped),
        cmocka_unit_test(too_few_rounds_drop_nobody),
        cmocka_unit_test(ties_stay_in_order),
        cmocka_unit_test(what_is_wrong_does_not_win),
        cmocka_unit_test(failures_are_passed_up),
        cmocka_unit_test(the_first_difference_decides),
        cmocka_unit_test(unknown_memory_is_the_most),
        cmocka_unit_test(it_is_an_order),
        cmocka_unit_test(kernels_scout_with_the_most_careful),
        cmocka_unit_test(a_slow_kernel_drops_no_intersector),
        cmocka_unit_test(a_slow_intersector_drops_no_kernel),
        cmocka_unit_test(the_most_careful_is_never_too_slow),
        cmocka_unit_test(the_least_of_the_fast_is_chosen),
        cmocka_unit_test(the_fastest_is_so_round_by_round),
        cmocka_unit_test(kinds_are_counted),
        cmocka_unit_test(advice_as_json),
        cmocka_unit_test(advice_as_text),
        cmocka_unit_test(words_are_quoted_for_a_shell),
        cmocka_unit_test(the_command_is_the_same_to_a_shell),
        cmocka_unit_test(a_name_does_not_steer_the_terminal),
        cmocka_unit_test(nothing_right_enough_is_status_1),
        cmocka_unit_test(a_limit_that_rays_cannot_show_is_said),
        cmocka_unit_test(who_is_right_stays_beside_one_that_is_wrong),
        cmocka_unit_test(kernels_are_not_dropped_for_an_intersector),
        cmocka_unit_test(what_cannot_be_done_is_refused),
        cmocka_unit_test(kernels_take_what_is_given),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
