/* Oracle and arbiter: answers made by hand must be classed as what they are; the cheap rule must
 * give the classes of full arbitration; the arbiter must agree with its definition spelled out over
 * all primitives. A few seconds. */
#include "framework/judge/arbiter.h"
#include "framework/judge/judge.h"
#include "framework/judge/queries.h"
#include "framework/scene/exact.h"
#include "hand_scene.h"
#include "tests/fixture.h"

static const uint64_t seed = 4711;
static const uint32_t threads = 2;

static bb_status judge_all(bb_oracle *oracle, bb_answers *answers, const bb_hit *hits,
                           uint32_t count, uint8_t *classes, bb_accuracy *accuracy)
{
    const bb_verdict_request request = {
        .results = hits, .count = count, .may_be_unnamed = true, .classes = classes};
    return bb_judge(oracle, answers, &request, accuracy);
}

/* Answers and judgement of raw rays. */
static bb_accuracy judge(const bb_scene *scene, bb_rays *rays, const bb_hit *hits, uint8_t *classes)
{
    bb_oracle *oracle = NULL;
    bb_answers answers;
    bb_accuracy accuracy;
    assert_int_equal(bb_oracle_create(scene, threads, &oracle), BB_OK);
    assert_int_equal(bb_answers_make(oracle, rays, &answers), BB_OK);
    assert_int_equal(judge_all(oracle, &answers, hits, rays->count, classes, &accuracy), BB_OK);
    bb_answers_release(&answers);
    bb_oracle_destroy(oracle);
    return accuracy;
}

static bb_class judge_one(const bb_scene *scene, bb_ray ray, bb_hit hit, const bb_query *query,
                          bool must_hit)
{
    bb_rays rays = {.query = query, .count = 1, .rays = &ray, .must_hit = must_hit};
    uint8_t class = 0;
    bb_accuracy accuracy = judge(scene, &rays, &hit, &class);
    assert_int_equal(accuracy.checked, 1);
    assert_int_equal(accuracy.right + accuracy.missed + accuracy.false_hits + accuracy.wrong_t, 1);
    return (bb_class) class;
}

/* Two triangles that share the edge x = 0 at z = 0, one far behind at z = -4, one of zero area at x
 * = 3, a unit sphere at (10, 0, 0), and at (20, 0, 0) a needle of width 1e-9 at z = 0. */
static bb_scene *make_scene(void)
{
    bb_scene *scene = hand_scene(5, 1);
    static const float v[5][9] = {
        {0, -1, 0, 0, 1, 0, 1, 0, 0},        {0, -1, 0, 0, 1, 0, -1, 0, 0},
        {-2, -2, -4, 2, -2, -4, 0, 2, -4},   {3, -1, 0, 3, 1, 0, 3, 0.5f, 0},
        {20, -1, 0, 20, 1, 0, 20, 1, 1e-9f},
    };
    memcpy(scene->vertices, v, sizeof v);
    memcpy(bb_scene_floats(scene, BB_SPHERE), ((float[4]){10, 0, 0, 1}), 4 * sizeof(float));
    hand_finish(scene);
    return scene;
}

static bb_ray down(float x, float y, float z)
{
    return (bb_ray){{x, y, z}, 0, {0, 0, -1}, INFINITY};
}

static void test_by_hand(void **state)
{
    (void)state;
    bb_scene *scene = make_scene();
    const bb_hit miss = {INFINITY, BB_NONE};
    const bb_ray middle = down(0.25f, 0, 2), edge = down(0, 0.25f, 2), beside = down(1.5f, 1.9f, 2);
    const float e = 16 * 0x1p-24f * 2; /* eps of `middle` on triangle 0 */
    const struct {
        const char *what;
        bb_ray ray;
        bb_hit hit;
        bb_class class;
    } cases[] = {
        {"the hit", middle, {2, 0}, BB_RIGHT},
        {"t within eps", middle, {2 + 0.75f * e, 0}, BB_RIGHT},
        {"t beyond eps", middle, {2 + 3 * e, 0}, BB_WRONG_T},
        {"t in front", middle, {2 - 3 * e, 0}, BB_WRONG_T},
        {"nothing", middle, miss, BB_MISSED},
        {"what is behind", middle, {6, 2}, BB_WRONG_T},
        {"another triangle", middle, {2, 1}, BB_FALSE_HIT},
        {"a sphere far off", middle, {2, 5}, BB_FALSE_HIT},
        {"poison", middle, {2, BB_POISON}, BB_UNWRITTEN},
        {"poisoned t", middle, {NAN, 0}, BB_UNWRITTEN},
        {"no such primitive", middle, {2, 6}, BB_UNWRITTEN},
        {"a miss with t", middle, {2, BB_NONE}, BB_UNWRITTEN},
        {"an infinite hit", middle, {INFINITY, 0}, BB_UNWRITTEN},
        {"behind the origin", middle, {-2, 0}, BB_WRONG_T},
        {"an edge from beside it", down(-e / 2, 0.25f, 2), {2, 0}, BB_TIE},
        {"an edge from too far", down(-3 * e, 0.25f, 2), {2, 0}, BB_FALSE_HIT},
        {"through a shared edge", edge, {6, 2}, BB_WRONG_T},
        {"lost in a shared edge", down(0, 0.25f, 2), miss, BB_MISSED},
        {"a rim, missed", down(0.5f, 0.5f, 2), {6, 2}, BB_RIGHT},
        {"past everything", beside, miss, BB_RIGHT},
        {"where nothing is", beside, {2, 0}, BB_FALSE_HIT},
        {"zero area, missed", down(3, 0, 2), miss, BB_RIGHT},
        {"zero area, reported", down(3, 0, 2), {2, 3}, BB_RIGHT},
        {"zero area, from afar", down(3.1f, 0, 2), {2, 3}, BB_FALSE_HIT},
        {"zero area, wrong t", down(3, 0, 2), {2.5f, 3}, BB_WRONG_T},
        {"a needle, missed", down(20, 0, 2), miss, BB_RIGHT},
        {"a needle, reported", down(20.0000019f, 0, 2), {2, 4}, BB_RIGHT},
        {"a sphere", down(10, 0, 3), {2, 5}, BB_RIGHT},
        {"its far side", down(10, 0, 3), {4, 5}, BB_WRONG_T},
        {"a sphere from inside", down(10, 0, 0), {1, 5}, BB_RIGHT},
        {"a sphere from inside, missed", down(10, 0, 0), miss, BB_MISSED},
        {"a sphere touched", down(11, 0, 3), {3, 5}, BB_RIGHT},
        {"a sphere touched, missed", down(11, 0, 3), miss, BB_RIGHT},
        {"beyond tmax", {{0.25f, 0, 2}, 0, {0, 0, -1}, 1.5f}, {2, 0}, BB_FALSE_HIT},
        {"before tmin", {{0.25f, 0, 2}, 2.5f, {0, 0, -1}, 5}, {2, 0}, BB_FALSE_HIT},
        {"at tmax", {{0.25f, 0, 2}, 0, {0, 0, -1}, 2}, miss, BB_RIGHT},
        {"t in units of d", {{0.25f, 0, 2}, 0, {0, 0, -4}, INFINITY}, {0.5f, 0}, BB_RIGHT},
        {"t in units of d, wrong",
         {{0.25f, 0, 2}, 0, {0, 0, -4}, INFINITY},
         {0.5f + e, 0},
         BB_WRONG_T},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_class class = judge_one(scene, cases[i].ray, cases[i].hit, &bb_query_closest, false);
        bool right = class == cases[i].class || (cases[i].class == BB_RIGHT && class == BB_TIE);
        if (!right)
            fail_msg("%s: class %d, expected %d", cases[i].what, class, cases[i].class);
    }
    /* On the shared edge either triangle is right, and one of them is a tie. */
    bb_class one = judge_one(scene, edge, (bb_hit){2, 0}, &bb_query_closest, false);
    bb_class other = judge_one(scene, edge, (bb_hit){2, 1}, &bb_query_closest, false);
    assert_true((one == BB_RIGHT && other == BB_TIE) || (one == BB_TIE && other == BB_RIGHT));
    /* Without a margin. */
    assert_int_equal(judge_one(scene, down(0.5f, 0.5f, -9), miss, &bb_query_closest, true),
                     BB_MISSED);
    hand_free(scene);
}

static void test_any_hit(void **state)
{
    (void)state;
    bb_scene *scene = make_scene();
    const bb_hit miss = {INFINITY, BB_NONE}, unnamed = {0, BB_UNNAMED};
    const bb_ray middle = down(0.25f, 0, 2), beside = down(1.5f, 1.9f, 2);
    const struct {
        bb_ray ray;
        bb_hit hit;
        bb_class class;
    } cases[] = {
        {middle, {2, 0}, BB_RIGHT},     {middle, {6, 2}, BB_RIGHT},
        {middle, {3, 2}, BB_WRONG_T},   {middle, {2, 1}, BB_FALSE_HIT},
        {middle, unnamed, BB_RIGHT},    {middle, miss, BB_MISSED},
        {beside, miss, BB_RIGHT},       {beside, unnamed, BB_FALSE_HIT},
        {beside, {2, 0}, BB_FALSE_HIT}, {down(11, 0, 3), unnamed, BB_RIGHT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_class class = judge_one(scene, cases[i].ray, cases[i].hit, &bb_query_any, false);
        if (class != cases[i].class)
            fail_msg("any hit, case %zu: class %d, expected %d", i, class, cases[i].class);
    }
    hand_free(scene);
}

/* The counts of a set, and the errors of t, by hand. */
static void test_counts(void **state)
{
    (void)state;
    bb_scene *scene = make_scene();
    enum { COUNT = 200 };
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    uint8_t classes[COUNT];
    for (int i = 0; i < COUNT; i++) {
        rays[i] = down(0.25f, 0, 2);
        hits[i] = (bb_hit){2 + (i == 7 ? 0x1p-22f : i == 8 ? 3 * 0x1p-22f : 0), 0};
    }
    hits[100] = (bb_hit){INFINITY, BB_NONE};
    hits[101].prim = BB_POISON;
    hits[102].prim = 1;
    hits[103].t = 3;
    rays[104] = down(3, 0, 4e6f); /* eps is 4, the triangle's extent 2 */
    hits[104] = (bb_hit){INFINITY, BB_NONE};
    bb_rays set = {.query = &bb_query_closest, .count = COUNT, .rays = rays};
    bb_accuracy a = judge(scene, &set, hits, classes);
    assert_int_equal(a.checked, COUNT);
    assert_int_equal(a.right, COUNT - 4);
    assert_int_equal(a.ties, 0);
    assert_int_equal(a.missed, 2);
    assert_int_equal(a.unwritten, 1);
    assert_int_equal(a.false_hits, 1);
    assert_int_equal(a.wrong_t, 1);
    assert_int_equal(a.first_wrong, 100);
    assert_int_equal(a.oracle_wrong, 0);
    assert_true(a.wrong_ppm == 1e6 * 4 / COUNT);
    assert_true(a.t_ulp_max == 3.0 && a.t_ulp_p99 == 1.0);
    for (int i = 0; i < COUNT; i++)
        assert_int_equal(classes[i], i == 100   ? BB_MISSED
                                     : i == 101 ? BB_UNWRITTEN
                                     : i == 102 ? BB_FALSE_HIT
                                     : i == 103 ? BB_WRONG_T
                                                : BB_RIGHT);

    rays[0] = down(0.25f, 0, 4e6f);
    hits[0] = (bb_hit){4e6f, 0};
    a = judge(scene, &set, hits, classes);
    assert_int_equal(a.margin_limited, 1);
    hand_free(scene);
}

/* ---- random scenes ---- */

static void random_ray(const bb_scene *scene, bb_random *random, bb_ray *ray)
{
    double target[3];
    uint32_t aim = bb_random_below(random, 3);
    uint32_t triangle = bb_random_below(random, scene->prims[BB_TRIANGLE].count);
    const float *a = bb_scene_vertex(scene, triangle, 0), *b = bb_scene_vertex(scene, triangle, 1);
    double s = bb_random_below(random, 4) == 0 ? 0 : bb_random_unit(random);
    for (int k = 0; k < 3; k++) {
        ray->o[k] = (float)bb_random_range(random, -2, 2);
        target[k] = aim == 0 ? bb_random_range(random, -1, 1) : a[k] + s * (b[k] - a[k]);
        ray->d[k] = (float)(target[k] - ray->o[k]);
    }
    ray->tmin = bb_random_below(random, 4) == 0 ? (float)bb_random_unit(random) : 0;
    ray->tmax =
        bb_random_below(random, 4) == 0 ? ray->tmin + (float)bb_random_unit(random) : INFINITY;
}

/* A kernel's answer: mostly the oracle's, else damaged in one of many ways. */
static bb_hit damage(const bb_scene *scene, const bb_ray *ray, bb_random *random, bb_hit hit)
{
    switch (bb_random_below(random, 12)) {
    case 0:
        return (bb_hit){INFINITY, BB_NONE};
    case 1:
        return (bb_hit){(float)(3 * bb_random_unit(random)),
                        bb_random_below(random, scene->prim_count)};
    case 2:
        hit.prim = hit.prim != BB_NONE ? bb_random_below(random, scene->prim_count) : BB_NONE;
        return hit;
    case 3:
        if (hit.prim != BB_NONE)
            hit.t *= 1 + (float)bb_random_range(random, -4e-6, 4e-6);
        return hit;
    case 4: /* the other side of a sphere */
        if (hit.prim != BB_NONE && hit.prim >= scene->prims[BB_TRIANGLE].count) {
            const double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
            double t[2];
            if (bb_exact_sphere_t(o, ray->d,
                                  bb_scene_floats(scene, BB_SPHERE) +
                                      4 * (hit.prim - scene->prims[BB_TRIANGLE].count),
                                  t))
                hit.t = fabs(t[0] - hit.t) < fabs(t[1] - hit.t) ? (float)t[1] : (float)t[0];
        }
        return hit;
    default:
        return hit;
    }
}

/* Also holds the bookkeeping to the classes. */
static void test_cheap_rule(void **state)
{
    (void)state;
    enum { COUNT = 40000 };
    bb_random random = bb_random_make(seed, 1);
    bb_scene *scene = hand_scene(200, 40);
    hand_random(scene, &random);
    hand_finish(scene);
    bb_ray *rays = malloc(COUNT * sizeof *rays);
    bb_hit *hits = malloc(COUNT * sizeof *hits);
    uint8_t *classes = malloc(COUNT);
    for (int i = 0; i < COUNT; i++)
        random_ray(scene, &random, &rays[i]);
    static const bb_query *const queries[] = {&bb_query_closest, &bb_query_any};
    for (int q = 0; q < 2; q++) {
        const bb_query *query = queries[q];
        bb_rays set = {.query = query, .count = COUNT, .rays = rays};
        bb_oracle *oracle = NULL;
        bb_answers answers;
        bb_arbiter arbiter;
        bb_accuracy accuracy;
        assert_int_equal(bb_oracle_create(scene, threads, &oracle), BB_OK);
        assert_int_equal(bb_arbiter_create(scene, &arbiter), BB_OK);
        /* Any hit: the nearest one is an answer too. */
        assert_int_equal(bb_oracle_trace(oracle, rays, COUNT, &bb_query_closest, hits), BB_OK);
        for (int i = 0; i < COUNT; i++)
            hits[i] = damage(scene, &rays[i], &random, hits[i]);
        assert_int_equal(bb_answers_make(oracle, &set, &answers), BB_OK);
        assert_int_equal(judge_all(oracle, &answers, hits, COUNT, classes, &accuracy), BB_OK);
        uint32_t counts[6] = {0}, arbitrated = 0;
        for (int i = 0; i < COUNT; i++) {
            bb_class full = bb_arbiter_judge(&arbiter, &rays[i], &hits[i], query, false);
            bb_class given = classes[i] == BB_TIE ? BB_RIGHT : (bb_class)classes[i];
            if (given != full)
                fail_msg("seed %llu query %s ray %d: class %d, by full arbitration %d",
                         (unsigned long long)seed, query->name, i, given, full);
            counts[classes[i]]++;
            arbitrated += full != BB_RIGHT;
        }
        assert_int_equal(accuracy.missed, counts[BB_MISSED]);
        assert_int_equal(accuracy.false_hits, counts[BB_FALSE_HIT]);
        assert_int_equal(accuracy.wrong_t, counts[BB_WRONG_T]);
        assert_int_equal(accuracy.right, counts[BB_RIGHT] + counts[BB_TIE]);
        assert_true(accuracy.arbitrated >= arbitrated && accuracy.arbitrated < COUNT / 2);
        for (int class = BB_MISSED; class <= BB_WRONG_T; class ++)
            assert_true(counts[class] > COUNT / 500);
        bb_answers_release(&answers);
        bb_arbiter_destroy(&arbiter);
        bb_oracle_destroy(oracle);
    }
    free(rays);
    free(hits);
    free(classes);
    hand_free(scene);
}

/* ---- the definition, spelled out over all primitives ---- */

static int hits_of(const bb_scene *scene, const double o[3], const float d[3], uint32_t prim,
                   double t[2])
{
    if (prim >= scene->prims[BB_TRIANGLE].count)
        return bb_exact_sphere_t(o, d,
                                 bb_scene_floats(scene, BB_SPHERE) +
                                     4 * (prim - scene->prims[BB_TRIANGLE].count),
                                 t)
                   ? 2
                   : 0;
    const float *a = bb_scene_vertex(scene, prim, 0), *b = bb_scene_vertex(scene, prim, 1),
                *c = bb_scene_vertex(scene, prim, 2);
    return bb_exact_meets_triangle(o, d, a, b, c) && bb_exact_plane_t(o, d, a, b, c, t) ? 1 : 0;
}

/* The nine rays of this primitive hit it, as bits: at a t in (low + e, high - e), or with e < 0 in
 * a grown interval. */
static int nine(const bb_scene *scene, const bb_ray *ray, uint32_t prim, double high, double sign)
{
    double length = 0, u[3] = {0, 0, 0}, w[3];
    double eps = bb_margin(scene, ray, prim);
    for (int k = 0; k < 3; k++)
        length = hypot(length, ray->d[k]);
    int axis = fabsf(ray->d[0]) < 0.5 * length ? 0 : 1;
    int j = (axis + 1) % 3, k = (axis + 2) % 3, bits = 0;
    u[j] = ray->d[k] / hypot(ray->d[j], ray->d[k]);
    u[k] = -ray->d[j] / hypot(ray->d[j], ray->d[k]);
    for (int i = 0; i < 3; i++)
        w[i] =
            (ray->d[(i + 1) % 3] * u[(i + 2) % 3] - ray->d[(i + 2) % 3] * u[(i + 1) % 3]) / length;
    for (int n = 0; n < 9; n++) {
        double o[3], t[2], angle = n * acos(-1) / 4;
        for (int i = 0; i < 3; i++)
            o[i] = ray->o[i] + (n == 8 ? 0 : eps * (cos(angle) * u[i] + sin(angle) * w[i]));
        int count = hits_of(scene, o, ray->d, prim, t);
        for (int root = 0; root < count; root++)
            if (t[root] > ray->tmin + sign * eps / length &&
                t[root] < fmin(high, ray->tmax) - sign * eps / length)
                bits |= 1 << n;
    }
    return bits;
}

/* Our eight copies start at another angle than the arbiter's may, so only what does not depend on
 * that is compared: the classes of rays that all nine, or none of eps twice as large, agree on. */
static void test_definition(void **state)
{
    (void)state;
    enum { COUNT = 3000 };
    bb_random random = bb_random_make(seed, 2);
    bb_scene *scene = hand_scene(300, 40);
    hand_random(scene, &random);
    hand_finish(scene);
    bb_arbiter arbiter;
    assert_int_equal(bb_arbiter_create(scene, &arbiter), BB_OK);
    uint32_t missed = 0, passed = 0, falses = 0;
    for (int i = 0; i < COUNT; i++) {
        bb_ray ray;
        random_ray(scene, &random, &ray);
        int all = 0, any = 0, one = 0;
        uint32_t prim = bb_random_below(&random, scene->prim_count);
        for (uint32_t p = 0; p < scene->prim_count; p++) {
            int inside = nine(scene, &ray, p, INFINITY, 1),
                grown = nine(scene, &ray, p, INFINITY, -1);
            all |= inside;
            any |= grown;
            one |= inside == 0x1FF;
            if (grown != 0 && bb_random_below(&random, 2) == 0)
                prim = p;
        }
        bb_class class = bb_arbiter_judge(&arbiter, &ray, &(bb_hit){INFINITY, BB_NONE},
                                          &bb_query_closest, false);
        if ((one && class != BB_MISSED) || (any == 0 && class != BB_RIGHT))
            fail_msg("seed %llu ray %d: a miss is class %d; all %x any %x",
                     (unsigned long long)seed, i, class, all, any);
        missed += one;
        passed += any == 0;

        int on = nine(scene, &ray, prim, INFINITY, -1);
        class = bb_arbiter_judge(&arbiter, &ray, &(bb_hit){1, prim}, &bb_query_any, false);
        if (on == 0x1FF && class == BB_FALSE_HIT)
            fail_msg("seed %llu ray %d: a hit is called false", (unsigned long long)seed, i);
        falses += on == 0;
        double t;
        if (on == 0x1FF && bb_exact_t(scene, &ray, prim, 1, &t) && t > ray.tmin && t < ray.tmax) {
            bool nearer = false;
            for (uint32_t p = 0; p < scene->prim_count; p++)
                nearer |= nine(scene, &ray, p, t - 2e-5, 1) == 0x1FF;
            class = bb_arbiter_judge(&arbiter, &ray, &(bb_hit){(float)t, prim}, &bb_query_closest,
                                     false);
            if (nearer && class != BB_WRONG_T)
                fail_msg("seed %llu ray %d: something nearer is not seen", (unsigned long long)seed,
                         i);
        }
    }
    assert_true(missed > COUNT / 10 && passed > COUNT / 10 && falses > COUNT / 10);
    bb_arbiter_destroy(&arbiter);
    hand_free(scene);
}

/* Shared edges: no margin may hide a hole in the middle of a fan of triangles of very different
 * eps. */
static void test_no_gap(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(2, 0);
    const float v[2][9] = {{0, -1, 0, 0, 1, 0, 0.01f, 0, 0}, {0, -1, 0, 0, 1, 0, -5000, 0, 0}};
    memcpy(scene->vertices, v, sizeof v);
    hand_finish(scene);
    bb_arbiter arbiter;
    assert_int_equal(bb_arbiter_create(scene, &arbiter), BB_OK);
    for (float x = -2e-3f; x < 2e-3f; x += 1e-5f) {
        bb_ray ray = down(x, 0.25f, 2);
        assert_int_equal(bb_arbiter_judge(&arbiter, &ray, &(bb_hit){INFINITY, BB_NONE},
                                          &bb_query_closest, false),
                         BB_MISSED);
    }
    bb_arbiter_destroy(&arbiter);
    hand_free(scene);
}

/* ---- the hierarchy of the arbiter ---- */

typedef struct seen {
    uint8_t *marks;
} seen;

static bool mark(void *context, uint32_t prim)
{
    ((seen *)context)->marks[prim]++;
    return false;
}

static void test_box_tree(void **state)
{
    (void)state;
    enum { COUNT = 500 };
    bb_random random = bb_random_make(seed, 3);
    bb_scene *scene = hand_scene(COUNT, 0);
    hand_random(scene, &random);
    /* Twenty equal ones, which no split separates, and some far off. */
    for (uint32_t i = 1; i < 20; i++)
        memcpy(scene->vertices + 9 * i, scene->vertices, 9 * sizeof(float));
    for (uint32_t i = 30; i < 36; i++)
        for (uint32_t c = 0; c < 9; c++)
            scene->vertices[9 * i + c] *= powf(10, (float)(i - 25));
    hand_finish(scene);
    bb_box_tree *tree = NULL;
    assert_int_equal(bb_box_tree_create(scene->boxes, COUNT, &tree), BB_OK);
    uint32_t total = 0;
    for (int i = 0; i < 2000; i++) {
        bb_ray ray;
        random_ray(scene, &random, &ray);
        if (i % 5 == 0)
            ray.d[i % 3] = 0;
        if (ray.d[0] == 0 && ray.d[1] == 0 && ray.d[2] == 0)
            continue;
        uint8_t marks[COUNT] = {0};
        seen seen = {marks};
        bb_probe probe;
        bb_probe_make(&ray, &probe);
        bb_box_tree_visit(tree, &probe, mark, &seen);
        for (uint32_t p = 0; p < COUNT; p++) {
            assert_true(marks[p] <= 1);
            double t[2];
            if (hits_of(scene, probe.o, ray.d, p, t) == 1 && t[0] > ray.tmin && t[0] < ray.tmax)
                assert_int_equal(marks[p], 1);
            total += marks[p];
        }
    }
    assert_true(total > 2000 && total < 2000 * COUNT / 2);
    bb_box_tree_destroy(tree);
    hand_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_by_hand),    cmocka_unit_test(test_any_hit),
        cmocka_unit_test(test_counts),     cmocka_unit_test(test_cheap_rule),
        cmocka_unit_test(test_definition), cmocka_unit_test(test_no_gap),
        cmocka_unit_test(test_box_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
