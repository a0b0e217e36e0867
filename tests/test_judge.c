/* A judge that trusts nobody: oracles that are wrong, or lie; margins that would hide what lies in
 * front of them; answers that were judged before. Seed: BVHBENCH_TEST_SEED. A few seconds. */
#include "framework/judge/judge.h"
#include "framework/judge/open_way.h"
#include "framework/judge/oracle_private.h"
#include "framework/judge/queries.h"
#include "hand_scene.h"
#include "tests/fixture.h"

static uint64_t seed = 20261121;
static const bb_hit miss = {INFINITY, BB_NONE};

static void check(bb_status status)
{
    if (status != BB_OK)
        fail_msg("%s (seed %llu)", bb_message(), (unsigned long long)seed);
}

typedef struct court {
    bb_scene *scene;
    bb_oracle *oracle;
    bb_rays rays;
    bb_answers answers;
} court;

/* Takes scene and rays; `lies` in place of Embree's answers, unless NULL. */
static void open_court(court *c, bb_scene *scene, bb_ray *rays, uint32_t count,
                       const bb_query *query, const bb_hit *lies)
{
    memset(c, 0, sizeof *c);
    c->scene = scene;
    c->rays = (bb_rays){.query = query, .count = count, .rays = rays};
    check(bb_oracle_create(scene, 2, &c->oracle));
    if (lies == NULL) {
        check(bb_answers_make(c->oracle, &c->rays, &c->answers));
        return;
    }
    c->answers.rays = &c->rays;
    check(bb_host_alloc(NULL, count * sizeof *lies, "lies", &c->answers.hits));
    memcpy(c->answers.hits, lies, count * sizeof *lies);
    check(bb_answers_show(c->oracle, &c->answers));
}

static bb_accuracy judge(court *c, const bb_hit *hits, bool may_be_unnamed, uint8_t *classes)
{
    bb_accuracy accuracy;
    const bb_verdict_request request = {hits, c->rays.count, may_be_unnamed, classes};
    check(bb_judge(c->oracle, &c->answers, &request, &accuracy));
    return accuracy;
}

static void close_court(court *c)
{
    bb_answers_release(&c->answers);
    bb_oracle_destroy(c->oracle);
    hand_free(c->scene);
}

/* ---- Embree is wrong ---- */

/* From inside a tetrahedron of size 10^-20 Embree, which flushes denormals, sees nothing; nor does
 * a tracer that answers "miss" to every ray. Both are wrong. */
static void who_agrees_with_a_blind_oracle_is_wrong(void **state)
{
    (void)state;
    enum { COUNT = 2000 };
    static const int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    static const float corners[4][3] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    bb_scene *scene = hand_scene(4, 0);
    for (int f = 0; f < 4; f++)
        for (int k = 0; k < 9; k++)
            scene->vertices[9 * f + k] = 1e-20f * corners[faces[f][k / 3]][k % 3];
    hand_finish(scene);
    bb_random random = bb_random_make(seed, 1);
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    for (int i = 0; i < COUNT; i++) {
        rays[i] = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++)
            rays[i].d[k] = (float)bb_random_range(&random, -1, 1);
        hits[i] = miss;
    }
    court c;
    open_court(&c, scene, rays, COUNT, &bb_query_closest, NULL);
    uint32_t blind = 0;
    for (int i = 0; i < COUNT; i++)
        blind += c.answers.hits[i].prim == BB_NONE;
    assert_int_equal(blind, COUNT); /* else this test is of nothing */
    bb_accuracy a = judge(&c, hits, false, NULL);
    assert_int_equal(a.missed, COUNT);
    assert_int_equal(a.oracle_wrong, COUNT);
    close_court(&c);
}

/* ---- what is lost between primitives ---- */

/* Two triangles, side by side, hide what is behind them; a huge one beside the ray, which some of
 * the copies that are moved by its own large margin hit, opens no way through: whichever comes
 * first. */
static void a_huge_neighbour_opens_no_way(void **state)
{
    (void)state;
    enum { COUNT = 99 };
    static const float q = 0.01f,
                       near[2][9] = {
                           {0, -0.0025f, 0.0025f, 0.01f, 0, 0.0025f, 0, 0.0025f, 0.0025f},
                           {0, -0.0025f, 0.0025f, 0, 0.0025f, 0.0025f, -0.005f, 0, 0.0025f}};
    static const float huge[2][9] = {{0.035f, -1e5f, 2, 0.035f, 1e5f, 2, 1e5f, 0, 2},
                                     {-1e5f, 0.035f, 2, 1e5f, 0.035f, 2, 0, -1e5f, 2}};
    for (int arrangement = 0; arrangement < 5; arrangement++) {
        bb_scene *scene = hand_scene(arrangement == 0 ? 2 : 3, 0);
        const float *order[3] = {near[0], near[1], NULL};
        if (arrangement > 0)
            order[2] = huge[arrangement / 2 % 2];
        if (arrangement > 2) { /* first instead of last */
            order[1] = near[0], order[0] = order[2], order[2] = near[1];
        }
        for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++)
            memcpy(scene->vertices + 9 * i, order[i], sizeof near[0]);
        hand_finish(scene);
        bb_ray rays[COUNT];
        bb_hit hits[COUNT];
        for (int i = 0; i < COUNT; i++) {
            float x = 0x1p-20f * q * (float)(i + 1) / 100;
            rays[i] = (bb_ray){.o = {x, 1e-4f, 0}, .d = {0, 0, 1}, .tmax = INFINITY};
            hits[i] = miss;
        }
        court c;
        open_court(&c, scene, rays, COUNT, &bb_query_closest, NULL);
        bb_accuracy a = judge(&c, hits, false, NULL);
        if (a.missed != COUNT)
            fail_msg("arrangement %d: %llu missed", arrangement, (unsigned long long)a.missed);
        close_court(&c);
    }
}

/* ---- the oracle lies ---- */

static void aim_at_random(const bb_scene *scene, bb_random *random, bb_ray *ray)
{
    const bb_box *aim = &scene->boxes[bb_random_below(random, scene->prim_count)];
    *ray = (bb_ray){.tmax =
                        bb_random_below(random, 4) == 0 ? (float)bb_random_unit(random) : INFINITY};
    for (int k = 0; k < 3; k++) {
        ray->o[k] = (float)bb_random_range(random, -2, 2);
        ray->d[k] = (float)bb_random_range(random, aim->lo[k], aim->hi[k]) - ray->o[k];
    }
}

/* The last primitive, by number, that the ray hits, and where: often one behind another. */
static bb_hit what_is_hit(const bb_scene *scene, const bb_ray *ray)
{
    for (uint32_t prim = scene->prim_count; prim-- > 0;) {
        double t;
        if (bb_exact_first(scene, ray, prim, &t))
            return (bb_hit){(float)t, prim};
    }
    return miss;
}

/* What anybody might say: the truth, nothing, what is behind, any primitive, another t. */
static bb_hit say(const bb_scene *scene, const bb_ray *ray, bb_random *random, bb_hit truth)
{
    switch (bb_random_below(random, 7)) {
    case 0:
        return miss;
    case 1:
        return (bb_hit){(float)(2 * bb_random_unit(random)),
                        bb_random_below(random, scene->prim_count)};
    case 2:
        truth.t *= truth.prim != BB_NONE ? 1 + (float)bb_random_range(random, -1e-4, 1e-4) : 1;
        return truth;
    case 3:
        truth.t *= truth.prim != BB_NONE ? 1 + (float)bb_random_range(random, -4e-6, 4e-6) : 1;
        return truth;
    case 4:
        return what_is_hit(scene, ray);
    default:
        return truth;
    }
}

/* With whatever oracle, answers get the classes of the arbiter, which does not ask it. */
static void no_lie_of_the_oracle_changes_a_class(void **state)
{
    (void)state;
    enum { COUNT = 30000 };
    bb_random random = bb_random_make(seed, 2);
    bb_ray *rays = calloc(COUNT, sizeof *rays);
    bb_hit *truth = calloc(COUNT, sizeof *truth), *lies = calloc(COUNT, sizeof *lies),
           *hits = calloc(COUNT, sizeof *hits);
    uint8_t *classes = calloc(COUNT, 1);
    static const bb_query *const queries[] = {&bb_query_closest, &bb_query_any};
    for (int q = 0; q < 2; q++) {
        const bb_query *query = queries[q];
        bb_scene *scene = hand_scene(200, 40);
        hand_random(scene, &random);
        hand_finish(scene);
        for (int i = 0; i < COUNT; i++)
            aim_at_random(scene, &random, &rays[i]);
        bb_oracle *oracle;
        bb_arbiter arbiter = {0};
        check(bb_oracle_create(scene, 2, &oracle));
        check(bb_arbiter_create(scene, &arbiter));
        check(bb_oracle_trace(oracle, rays, COUNT, &bb_query_closest, truth));
        for (int i = 0; i < COUNT; i++) {
            lies[i] = say(scene, &rays[i], &random, truth[i]);
            if (query == &bb_query_any && lies[i].prim != BB_NONE)
                lies[i] = (bb_hit){0, BB_UNNAMED};
            /* half of them agree with it, lie or not */
            hits[i] =
                bb_random_below(&random, 2) ? lies[i] : say(scene, &rays[i], &random, truth[i]);
        }
        court c;
        open_court(&c, scene, rays, COUNT, query, lies);
        bb_accuracy a = judge(&c, hits, true, classes);
        uint32_t lied = 0, wrong = 0;
        for (int i = 0; i < COUNT; i++) {
            bb_class full = bb_arbiter_judge(&arbiter, &rays[i], &hits[i], query, false);
            bb_class oracles = bb_arbiter_judge(&arbiter, &rays[i], &lies[i], query, false);
            bb_class given = classes[i] == BB_TIE ? BB_RIGHT : (bb_class)classes[i];
            if (given != full)
                fail_msg("query %s ray %d: class %d, by the arbiter alone %d (seed %llu)",
                         query->name, i, given, full, (unsigned long long)seed);
            lied += oracles != BB_RIGHT;
            wrong += full != BB_RIGHT;
        }
        assert_int_equal(a.oracle_wrong, lied);
        assert_int_equal(a.missed + a.false_hits + a.wrong_t, wrong);
        assert_true(lied > COUNT / 10 && wrong > COUNT / 10 && wrong < COUNT / 2);
        bb_arbiter_destroy(&arbiter);
        bb_oracle_destroy(oracle);
        close_court(&c);
    }
    free(rays);
    free(truth);
    free(lies);
    free(hits);
    free(classes);
}

/* ---- margins ---- */

static bb_ray down(float x, float y, float z)
{
    return (bb_ray){{x, y, z}, 0, {0, 0, -1}, INFINITY};
}

/* A ground of 10^6 has a margin of nearly 1; a ball of radius 0.4 lies on it. */
static void a_large_margin_hides_nothing_before_it(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(1, 1);
    const float ground[9] = {-1e6f, -1e6f, 0, 1e6f, -1e6f, 0, 0, 1e6f, 0};
    memcpy(scene->vertices, ground, sizeof ground);
    memcpy(bb_scene_floats(scene, BB_SPHERE), ((float[4]){0, 0, 0.4f, 0.4f}), 4 * sizeof(float));
    hand_finish(scene);
    static const struct {
        bb_hit hit;
        bb_class class;
    } cases[] = {
        {{4.2f, 1}, BB_RIGHT},    /* the ball's top */
        {{5, 0}, BB_WRONG_T},     /* the ground, through the ball */
        {{4.1999f, 0}, BB_TIE},   /* by rounding, as the ground's t may */
        {{4.21f, 0}, BB_WRONG_T}, /* not in front of the ball */
        {{INFINITY, BB_NONE}, BB_MISSED},
    };
    enum { COUNT = sizeof cases / sizeof cases[0], ALL = COUNT + 2 };
    bb_ray rays[ALL];
    bb_hit hits[ALL];
    uint8_t classes[ALL];
    for (int i = 0; i < COUNT; i++) {
        rays[i] = down(0.01f, 0.01f, 5);
        hits[i] = cases[i].hit;
    }
    hits[0].t = 5 - 0.4f - sqrtf(0.16f - 0.0002f);
    /* beside the ball the ground's t may be off by its margin, and this is counted */
    rays[COUNT] = rays[COUNT + 1] = down(3, 0, 5);
    hits[COUNT] = (bb_hit){5, 0};
    hits[COUNT + 1] = (bb_hit){5.9f, 0};
    court c;
    open_court(&c, scene, rays, ALL, &bb_query_closest, NULL);
    bb_accuracy a = judge(&c, hits, false, classes);
    for (int i = 0; i < COUNT; i++)
        if (classes[i] != cases[i].class)
            fail_msg("case %d: class %d, not %d", i, classes[i], cases[i].class);
    assert_int_equal(classes[COUNT], BB_RIGHT);
    assert_int_equal(classes[COUNT + 1], BB_RIGHT);
    assert_int_equal(a.t_off, 2); /* the last, and the ground in front of the ball */
    close_court(&c);
}

/* Behind an edge that the ray just meets lies a plane that it grazes. A float may miss what has the
 * edge, and report the plane. Half of the nine hit the plane far nearer: which does not show that
 * anything lies before it. */
static void a_grazed_plane_is_no_witness_against_itself(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(2, 1);
    const float near[9] = {0, -1, 1, 0, 1, 1, 1, 0, 1},
                plane[9] = {-0.5f, 1, -498, 0.5f, 1, 502, 0, -1, 2};
    memcpy(scene->vertices, near, sizeof near);
    memcpy(scene->vertices + 9, plane, sizeof plane);
    memcpy(bb_scene_floats(scene, BB_SPHERE), ((float[4]){5, 0, 3, 1}), 4 * sizeof(float));
    hand_finish(scene);
    const bb_ray along_edge = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY},
                 inside = {{0.25f, 0, 0}, 0, {0, 0, 1}, INFINITY},
                 at_sphere = {{5, 0, 0}, 0, {0, 0, 1}, INFINITY};
    bb_ray rays[] = {along_edge, along_edge, inside, at_sphere, at_sphere};
    bb_hit hits[] = {{2, 1}, {1, 0}, {252, 1}, {2, 2}, {4, 2}};
    const bb_class expected[] = {BB_TIE, BB_RIGHT, BB_WRONG_T, BB_RIGHT, BB_WRONG_T};
    enum { COUNT = sizeof rays / sizeof rays[0] };
    uint8_t classes[COUNT];
    court c;
    open_court(&c, scene, rays, COUNT, &bb_query_closest, NULL);
    judge(&c, hits, false, classes);
    for (int i = 0; i < COUNT; i++)
        if (classes[i] != expected[i])
            fail_msg("case %d: class %d, not %d", i, classes[i], expected[i]);
    close_court(&c);
}

/* Corners at distance r from the z axis, at the angle of a sector. */
static void put_sector(float v[9], const double r[3], const int sector[3], int sectors)
{
    for (int corner = 0; corner < 3; corner++) {
        double angle = 2 * acos(-1) * sector[corner] / sectors;
        v[3 * corner] = (float)(r[corner] * cos(angle));
        v[3 * corner + 1] = (float)(r[corner] * sin(angle));
        v[3 * corner + 2] = 1000;
    }
}

/* Around the ray, seen from afar: a sliver that the ray just meets, in a disc as large as the
 * margin, in a ring of that radius, or in a disc with a narrow sector left out. The nine hit
 * something each, but through the ring and the sector the way is open. */
static void an_open_way_between_the_nine_is_found(void **state)
{
    (void)state;
    enum { SECTORS = 20 };
    const double eps = 16 * 0x1p-24 * 1000;
    for (int shape = 0; shape < 3; shape++) {
        const double in = shape == 1 ? 0.8 * eps : 0, out = 1.2 * eps;
        bb_scene *scene = hand_scene(1 + 2 * (SECTORS - (shape == 2)), 0);
        float *v = scene->vertices;
        memcpy(v, ((float[9]){0, -1e-4f, 1000, 0, 1e-4f, 1000, -1e-4f, 0, 1000}), 9 * sizeof *v);
        for (int i = 0; i < SECTORS - (shape == 2); i++) {
            put_sector(v += 9, (double[]){in, out, out}, (int[]){i, i, i + 1}, SECTORS);
            put_sector(v += 9, (double[]){in, out, in}, (int[]){i, i + 1, i + 1}, SECTORS);
        }
        hand_finish(scene);
        bb_ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
        const bb_hit nothing = {INFINITY, BB_NONE};
        uint8_t class;
        court c;
        open_court(&c, scene, &ray, 1, &bb_query_closest, NULL);
        bb_accuracy a = judge(&c, &nothing, false, &class);
        assert_int_equal(class, shape > 0 ? BB_RIGHT : BB_MISSED);
        assert_int_equal(a.forgiven, shape > 0);
        close_court(&c);
    }
}

static bool count_and_say_no(void *context, double x, double y)
{
    (void)x, (void)y;
    ++*(uint32_t *)context;
    return false;
}

/* At a corner of n triangles their 2 n sides cross each other in n (2 n - 1) pairs; all of it is
 * one place. */
static void a_corner_of_many_is_looked_at_once(void **state)
{
    (void)state;
    enum { FAN = 64 };
    bb_outline fan[FAN];
    bb_cover covers[FAN];
    uint32_t asked = 0;
    for (int i = 0; i < FAN; i++) {
        double from = 2 * acos(-1) * i / FAN, to = 2 * acos(-1) * (i + 1) / FAN;
        fan[i] =
            (bb_outline){{{0, 0}, {2 * cos(from), 2 * sin(from)}, {2 * cos(to), 2 * sin(to)}}, 3};
        covers[i] = (bb_cover){fan[i], 1e-6};
    }
    assert_false(bb_find_open_way(fan, FAN, NULL, 0, count_and_say_no, &asked));
    assert_in_range(asked, FAN, 8 * FAN);
    /* where all is closed inside, hardly anything is left to ask about but a missing triangle */
    uint32_t asked_closed = 0, asked_open = 0;
    assert_false(bb_find_open_way(fan, FAN, covers, FAN, count_and_say_no, &asked_closed));
    assert_in_range(asked_closed, 0, 4);
    assert_false(bb_find_open_way(fan, FAN - 1, covers, FAN - 1, count_and_say_no, &asked_open));
    assert_in_range(asked_open, 1, 8);
    /* corners that may be off by more than the way to the next side hide nothing */
    for (int i = 0; i < FAN; i++)
        covers[i].clear = 0.2;
    uint32_t asked_coarse = 0;
    assert_false(bb_find_open_way(fan, FAN, covers, FAN, count_and_say_no, &asked_coarse));
    assert_int_equal(asked_coarse, asked);
}

/* The margin against the smallest height, of the primitive reported and of the oracle's. */
static void rays_on_hair_are_limited(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(2, 0);
    const float v[18] = {0,  0,  0,  1, 0,  0,  1, 1e-7f, 0, /* a hair */
                         -9, -9, -3, 9, -9, -3, 0, 9,     -3};
    memcpy(scene->vertices, v, sizeof v);
    hand_finish(scene);
    bb_ray rays[] = {down(0.5f, 2e-8f, 1), down(0.5f, 2e-8f, 1), down(0.5f, 1, 1)};
    const bb_hit hits[] = {{1, 0}, {4, 1}, {4, 1}};
    court c;
    open_court(&c, scene, rays, 3, &bb_query_closest, (bb_hit[]){{1, 0}, {1, 0}, {4, 1}});
    bb_accuracy a = judge(&c, hits, false, NULL);
    assert_int_equal(a.margin_limited,
                     2); /* as reported, and as the oracle's that is not reported */
    assert_int_equal(a.missed + a.false_hits + a.wrong_t, 0);
    close_court(&c);
}

/* ---- answers without a name ---- */

static void only_who_may_leaves_out_the_name(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(1, 0);
    const float v[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    memcpy(scene->vertices, v, sizeof v);
    hand_finish(scene);
    bb_ray rays[] = {down(0.25f, 0.25f, 1), down(0.9f, 0.9f, 1)};
    const bb_hit hits[] = {{0, BB_UNNAMED}, {0, BB_UNNAMED}};
    court c;
    open_court(&c, scene, rays, 2, &bb_query_any, NULL);
    bb_accuracy a = judge(&c, hits, true, NULL);
    assert_int_equal(a.right, 1);
    assert_int_equal(a.false_hits, 1);
    a = judge(&c, hits, false, NULL);
    assert_int_equal(a.unwritten, 2);
    a = judge(&c, hits, true, NULL);
    assert_int_equal(a.right, 1);
    close_court(&c);
}

/* ---- answers that come again ---- */

static void what_was_judged_before_gets_the_same_class(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    bb_random random = bb_random_make(seed, 3);
    bb_scene *scene = hand_scene(200, 40);
    hand_random(scene, &random);
    hand_finish(scene);
    bb_ray rays[COUNT];
    bb_hit first[COUNT], second[COUNT];
    uint8_t classes[COUNT], again[COUNT], fresh[COUNT];
    for (int i = 0; i < COUNT; i++)
        aim_at_random(scene, &random, &rays[i]);
    court c;
    open_court(&c, scene, rays, COUNT, &bb_query_closest, NULL);
    for (int i = 0; i < COUNT; i++) {
        first[i] = say(scene, &rays[i], &random, c.answers.hits[i]);
        second[i] = bb_random_below(&random, 2) ? first[i]
                                                : say(scene, &rays[i], &random, c.answers.hits[i]);
    }
    bb_accuracy a = judge(&c, first, false, classes), b = judge(&c, first, false, again);
    assert_memory_equal(classes, again, COUNT);
    assert_true(a.arbitrated > 0 && b.arbitrated == 0);
    assert_true(a.wrong_ppm == b.wrong_ppm && a.t_ulp_p99 == b.t_ulp_p99 &&
                a.margin_limited == b.margin_limited && a.forgiven == b.forgiven);
    judge(&c, second, false, again);
    bb_judged_release(&c.answers);
    judge(&c, second, false, fresh);
    assert_memory_equal(again, fresh, COUNT);
    close_court(&c);
}

/* ---- the ray's own way ---- */

static void the_way_is_what_all_primitives_say(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 4);
    uint32_t states[3] = {0};
    for (uint32_t run = 0; run < 60; run++) {
        bb_scene *scene =
            hand_scene(1 + bb_random_below(&random, 200), bb_random_below(&random, 40));
        float scale = ldexpf(1, (int)bb_random_below(&random, 160) - 80);
        hand_random(scene, &random);
        for (uint32_t i = 0; i < 9 * scene->prims[BB_TRIANGLE].count; i++)
            scene->vertices[i] =
                scale * (run % 3 == 0 ? roundf(scene->vertices[i] * 4) / 4 : scene->vertices[i]);
        for (uint32_t i = 0; i < 4 * scene->prims[BB_SPHERE].count; i++)
            bb_scene_floats(scene, BB_SPHERE)[i] *= scale;
        hand_finish(scene);
        bb_box_tree *tree;
        bb_way *way;
        check(bb_box_tree_create(scene->boxes, scene->prim_count, &tree));
        check(bb_way_create(scene, tree, &way));
        for (uint32_t i = 0; i < 1000; i++) {
            bb_ray ray;
            aim_at_random(scene, &random, &ray);
            for (int k = 0; k < 3; k++) {
                ray.o[k] = scale * (run % 3 == 0 ? roundf(ray.o[k] * 4) / 4 : ray.o[k]);
                ray.d[k] =
                    bb_random_below(&random, 4) == 0 ? 0 : (float)bb_random_range(&random, -1, 1);
            }
            if (ray.d[0] == 0 && ray.d[1] == 0 && ray.d[2] == 0)
                ray.d[i % 3] = -1;
            ray.tmin = bb_random_below(&random, 2) ? 0.25f * scale : 0;
            double limit =
                bb_random_below(&random, 2) ? INFINITY : ray.tmin + scale * bb_random_unit(&random);
            uint32_t except = bb_random_below(&random, 2 * scene->prim_count);
            const double o[3] = {ray.o[0], ray.o[1], ray.o[2]};
            bool blocked = false, unsure = false;
            for (uint32_t p = 0; p < scene->prim_count; p++) {
                double t[2];
                int count = p == except ? 0 : bb_exact_hits(scene, o, ray.d, p, t);
                for (int root = 0; root < count; root++) {
                    double slack = 0x1p-28 * fabs(t[root]);
                    blocked |= t[root] > ray.tmin + slack && t[root] < limit - slack;
                    unsure |= fabs(t[root] - ray.tmin) <= slack || fabs(t[root] - limit) <= slack;
                }
            }
            bb_way_state expected = blocked  ? BB_WAY_BLOCKED
                                    : unsure ? BB_WAY_UNSURE
                                             : BB_WAY_CLEAR;
            bb_way_state found = bb_way_ask(way, &ray, limit, except);
            if (found != expected)
                fail_msg("run %u ray %u: %d, not %d (seed %llu)", run, i, found, expected,
                         (unsigned long long)seed);
            states[found]++;
        }
        bb_way_destroy(way);
        bb_box_tree_destroy(tree);
        hand_free(scene);
    }
    assert_true(states[BB_WAY_CLEAR] > 1000 && states[BB_WAY_BLOCKED] > 1000 &&
                states[BB_WAY_UNSURE] > 10);
}

/* Of a hundred errors from 0 to 99 ulp, in any order, the 99th percentile is the second largest. */
static void errors_of_t_have_their_ranks(void **state)
{
    (void)state;
    enum { COUNT = 100 };
    static const float corners[9] = {-300, -300, 1.5f, 300, -300, 1.5f, 0, 300, 1.5f};
    bb_scene *scene = hand_scene(1, 0);
    memcpy(scene->vertices, corners, sizeof corners);
    hand_finish(scene);
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    for (int i = 0; i < COUNT; i++) {
        rays[i] = (bb_ray){.d = {0, 0, 1}, .tmax = INFINITY};
        hits[i] = (bb_hit){1.5f + 0x1p-23f * (float)(i * 37 % COUNT), 0};
    }
    court c;
    open_court(&c, scene, rays, COUNT, &bb_query_closest, NULL);
    bb_accuracy a = judge(&c, hits, false, NULL);
    assert_int_equal(a.right, COUNT);
    assert_true(a.t_ulp_max == 99 && a.t_ulp_p99 == 98);
    close_court(&c);
}

int main(void)
{
    seed = seed_or(seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_agrees_with_a_blind_oracle_is_wrong),
        cmocka_unit_test(a_huge_neighbour_opens_no_way),
        cmocka_unit_test(no_lie_of_the_oracle_changes_a_class),
        cmocka_unit_test(a_large_margin_hides_nothing_before_it),
        cmocka_unit_test(a_grazed_plane_is_no_witness_against_itself),
        cmocka_unit_test(an_open_way_between_the_nine_is_found),
        cmocka_unit_test(a_corner_of_many_is_looked_at_once),
        cmocka_unit_test(rays_on_hair_are_limited),
        cmocka_unit_test(only_who_may_leaves_out_the_name),
        cmocka_unit_test(what_was_judged_before_gets_the_same_class),
        cmocka_unit_test(errors_of_t_have_their_ranks),
        cmocka_unit_test(the_way_is_what_all_primitives_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
