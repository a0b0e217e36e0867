/* Embree as tracer (framework/judge/embree.c) and as builder (builders/embree). A few seconds. */
#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/builder/phases.h"
#include "framework/builder/registry.h"
#include "framework/judge/embree.h"
#include "framework/judge/oracle.h"
#include "framework/judge/queries.h"
#include "hand_scene.h"
#include "tests/fixture.h"

#include <signal.h>
#include <time.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

static const uint64_t seed = 7;

/* ---- the tracer ---- */

static bb_status make(const bb_scene *scene, const bb_spec *spec, uint32_t threads,
                      bb_embree **embree)
{
    bb_status status = bb_embree_create(scene, spec, threads, embree);
    if (status == BB_OK)
        status = bb_embree_build(*embree);
    if (status != BB_OK) {
        bb_embree_destroy(*embree);
        *embree = NULL;
    }
    return status;
}

/* Returns false, and says so, if the library lacks the kind of call. */
static bool trace(const bb_scene *scene, const char *text, const bb_ray *rays, uint32_t count,
                  const bb_query *query, bb_hit *hits)
{
    bb_embree *embree = NULL;
    bb_spec spec;
    assert_int_equal(bb_spec_parse(text, &spec), BB_OK);
    if (make(scene, &spec, 3, &embree) != BB_OK)
        fail_msg("%s", bb_message());
    if (bb_embree_pass(embree, &spec) != BB_OK) {
        print_message("skipped: %s\n", bb_message());
        bb_embree_destroy(embree);
        return false;
    }
    assert_int_equal(bb_embree_build(embree), BB_OK);
    assert_true(bb_embree_bytes(embree) > 0);
    assert_int_equal(bb_embree_trace(embree, rays, count, query->any, hits), BB_OK);
    bb_embree_destroy(embree);
    return true;
}

static const char *const modes[] = {
    "e:quality=low,mode=fast",
    "e:quality=medium,mode=robust",
    "e:quality=high,mode=robust",
    "e:quality=low,mode=robust",
    "e:query=packet4",
    "e:query=packet8,mode=fast",
    "e:query=packet8,coherent=yes",
    "e:query=stream,coherent=yes",
    "e:query=packet16,mode=robust",
    "e:query=stream",
};

/* Numbering of triangles and spheres, both sides of a sphere, intervals, units of t, misses. */
static void test_trace_by_hand(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(2, 2);
    const float v[2][9] = {{-9, -9, 5, 9, -9, 5, 0, 9, 5}, {-9, -9, -5, 9, -9, -5, 0, 9, -5}};
    const float s[2][4] = {{0, 0, 0, 1}, {3, 0, 0, 0.5f}};
    memcpy(scene->vertices, v, sizeof v);
    memcpy(bb_scene_floats(scene, BB_SPHERE), s, sizeof s);
    hand_finish(scene);
    const struct {
        bb_ray ray;
        bb_hit hit;
    } cases[] = {
        {{{-3, 0, 0}, 0, {1, 0, 0}, INFINITY}, {2, 2}},
        {{{-3, 0, 0}, 0, {4, 0, 0}, INFINITY}, {0.5f, 2}},
        {{{0, 0, 0}, 0, {1, 0, 0}, INFINITY}, {1, 2}},     /* from inside: the far side */
        {{{-3, 0, 0}, 2.5f, {1, 0, 0}, INFINITY}, {4, 2}}, /* from inside, by tmin */
        {{{-3, 0, 0}, 4.5f, {1, 0, 0}, INFINITY}, {5.5f, 3}},
        {{{-3, 0, 0}, 0, {1, 0, 0}, 1.5f}, {INFINITY, BB_NONE}},
        {{{0, 0, 0}, 0.25f, {1, 0, 0}, 0.5f}, {INFINITY, BB_NONE}},
        {{{0, 1.5f, 0}, 0, {0, 0, 1}, INFINITY}, {5, 0}},
        {{{0, 1.5f, 0}, 0, {0, 0, -1}, INFINITY}, {5, 1}},
        {{{0, 50, 0}, 0, {0, 1, 0}, INFINITY}, {INFINITY, BB_NONE}},
    };
    enum { COUNT = sizeof cases / sizeof cases[0] };
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    for (int i = 0; i < COUNT; i++)
        rays[i] = cases[i].ray;
    for (size_t m = 0; m < sizeof modes / sizeof modes[0]; m++) {
        if (!trace(scene, modes[m], rays, COUNT, &bb_query_closest, hits))
            continue;
        for (int i = 0; i < COUNT; i++)
            if (hits[i].prim != cases[i].hit.prim ||
                !(hits[i].t == cases[i].hit.t || fabsf(hits[i].t - cases[i].hit.t) < 1e-5f))
                fail_msg("%s, case %d: %u at %g", modes[m], i, hits[i].prim, (double)hits[i].t);
        trace(scene, modes[m], rays, COUNT, &bb_query_any, hits);
        for (int i = 0; i < COUNT; i++) {
            bool hit = cases[i].hit.prim != BB_NONE;
            assert_int_equal(hits[i].prim, hit ? BB_UNNAMED : BB_NONE);
            assert_true(hit ? hits[i].t == 0 : isinf(hits[i].t));
        }
    }
    hand_free(scene);
}

/* What Embree does not take, on which some builds of it abort, is a miss, also between rays that it
 * takes. */
static void test_too_large(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    enum { COUNT = 21 };
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    for (int i = 0; i < COUNT; i++)
        rays[i] = (bb_ray){.o = {0.1f, 0.1f, i % 3 == 1 ? -3e18f : -3},
                           .d = {0, 0, i % 3 == 2 ? 2e18f : 1},
                           .tmax = INFINITY};
    assert_int_equal(bb_scene_load("cube", &scene), BB_OK);
    for (size_t m = 0; m < 2 * sizeof modes / sizeof modes[0]; m++) {
        const bb_query *query = m % 2 == 0 ? &bb_query_closest : &bb_query_any;
        if (!trace(scene, modes[m / 2], rays, COUNT, query, hits))
            continue;
        for (int i = 0; i < COUNT; i++)
            if ((hits[i].prim == BB_NONE) != (i % 3 != 0))
                fail_msg("%s, ray %d: %u", modes[m / 2], i, hits[i].prim);
    }
    bb_scene_free(scene);
}

/* Packets and streams of any length answer as single rays do: all kinds of primitives, closest and
 * any hits. Robust triangles may round differently by a few units in the last place. */
static void test_queries_agree(void **state)
{
    (void)state;
    static const char *const scenes[] = {"soup:n=500", "spheres:n=500", "blocks:side=6,mixed=yes"};
    static const char *const queries[] = {"e:query=packet4", "e:query=packet8", "e:query=packet16",
                                          "e:query=stream"};
    enum { COUNT = 2048 + 257 };
    bb_ray *rays = malloc(COUNT * sizeof *rays);
    bb_hit *single = malloc(COUNT * sizeof *single), *hits = malloc(COUNT * sizeof *hits);
    bb_random random = bb_random_make(seed_or(seed), 2);
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene;
        uint32_t found = 0;
        ASSERT_OK(bb_scene_load(scenes[s], &scene));
        for (int i = 0; i < COUNT; i++) {
            double d[3];
            bb_random_direction(&random, d);
            rays[i] = (bb_ray){.d = {(float)d[0], (float)d[1], (float)d[2]}, .tmax = INFINITY};
            for (int k = 0; k < 3; k++)
                rays[i].o[k] =
                    (float)bb_random_range(&random, scene->bounds.lo[k], scene->bounds.hi[k]);
        }
        for (size_t m = 0; m < 2 * sizeof queries / sizeof queries[0]; m++) {
            const bb_query *query = m % 2 == 0 ? &bb_query_closest : &bb_query_any;
            uint32_t apart = 0;
            assert_true(trace(scene, "e", rays, COUNT, query, single));
            if (!trace(scene, queries[m / 2], rays, COUNT, query, hits))
                continue;
            for (int i = 0; i < COUNT; i++) {
                found += single[i].prim != BB_NONE;
                /* blocks share faces: two primitives at one distance */
                apart += (s < 2 && hits[i].prim != single[i].prim) ||
                         (hits[i].prim == BB_NONE) != (single[i].prim == BB_NONE) ||
                         !(hits[i].t == single[i].t ||
                           fabsf(hits[i].t - single[i].t) <= 1e-5f * single[i].t);
            }
            /* a ray that grazes an edge, or a sphere, may be decided otherwise */
            if (apart > COUNT / 100)
                fail_msg("%s, %s, %s: %u of %d", scenes[s], queries[m / 2], query->name, apart,
                         COUNT);
        }
        assert_true(found > COUNT);
        bb_scene_free(scene);
    }
    free(rays);
    free(single);
    free(hits);
}

/* Leaves the floating-point mode alone, and sleeps between calls. */
static void test_manners(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 1);
    bb_scene *scene = hand_scene(3000, 100);
    hand_random(scene, &random);
    hand_finish(scene);
    enum { COUNT = 20000 };
    bb_ray *rays = malloc(COUNT * sizeof *rays);
    bb_hit *hits = malloc(COUNT * sizeof *hits);
    for (int i = 0; i < COUNT; i++) {
        double d[3];
        bb_random_direction(&random, d);
        rays[i] = (bb_ray){{0, 0, 0}, 0, {(float)d[0], (float)d[1], (float)d[2]}, INFINITY};
    }
    bb_embree *embree = NULL;
    assert_int_equal(make(scene, NULL, 4, &embree), BB_OK);
#if defined(__SSE__)
    unsigned int before = _mm_getcsr();
#endif
    assert_int_equal(bb_embree_trace(embree, rays, COUNT, false, hits), BB_OK);
    volatile float small = 1e-39f;
    assert_true(small * 0.5f > 0);
#if defined(__SSE__)
    assert_int_equal(_mm_getcsr() & 0x8040u, before & 0x8040u);
#endif
    uint32_t found = 0;
    for (int i = 0; i < COUNT; i++)
        found += hits[i].prim != BB_NONE;
    assert_in_range(found, COUNT / 10, COUNT);

    /* TBB spins for a moment after a build, a longer one where other processes want the cores. */
    const struct timespec nap = {0, 300000000};
    double busy = INFINITY;
    for (int naps = 0; naps < 20 && busy >= 30; naps++) {
        double cpu = bb_cpu_ms();
        nanosleep(&nap, NULL);
        busy = bb_cpu_ms() - cpu;
    }
    assert_true(busy < 30);
    bb_embree_destroy(embree);
    free(rays);
    free(hits);
    hand_free(scene);
}

/* ---- the builder ---- */

typedef struct built {
    bb_account account;
    bb_spec spec;
    void *self;
    bb_tree tree;
    const bb_builder *builder;
} built;

static void begin(built *b, const bb_scene *scene, const char *text)
{
    memset(b, 0, sizeof *b);
    b->builder = bb_builder_find("embree");
    assert_non_null(b->builder);
    assert_int_equal(bb_builder_validate(b->builder), BB_OK);
    assert_int_equal(bb_spec_parse(text, &b->spec), BB_OK);
    assert_int_equal(bb_spec_validate(&b->spec, b->builder->options, "builder embree"), BB_OK);
    const bb_builder_context context = {
        .account = &b->account, .spec = &b->spec, .options = b->builder->options, .threads = 3};
    bb_tree_init(&b->tree, &b->account);
    assert_int_equal(b->builder->create(&context, &b->self), BB_OK);
    assert_int_equal(b->builder->prepare(b->self, scene, &b->tree), BB_OK);
}

static bb_status build(built *b, const bb_scene *scene, bb_phases *phases)
{
    *phases = (bb_phases){.current = -1};
    assert_int_equal(b->builder->restore(b->self, scene), BB_OK);
    return b->builder->build(b->self, scene, NULL, &b->tree, phases);
}

static void end(built *b)
{
    b->builder->destroy(b->self);
    bb_tree_release(&b->tree);
    assert_int_equal(b->account.bytes, 0); /* all is given back, Embree's own memory too */
}

static const char *const specs[] = {
    "embree:quality=low",
    "embree:quality=medium",
    "embree:quality=high",
    "embree:quality=low,leaf=8",
    "embree:quality=medium,leaf=4,sah-block-size=4",
    "embree:quality=high,leaf=4,splits=3",
};

/* Valid trees; the same ones again, also from another object; more room is used if splits are
 * allowed. */
static void check_scene(const bb_scene *scene, bool splits)
{
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        uint64_t hashes[4];
        for (int run = 0; run < 4; run += 2) {
            built b;
            bb_phases phases;
            begin(&b, scene, specs[i]);
            for (int again = 0; again < 2; again++) {
                if (build(&b, scene, &phases) != BB_OK || bb_tree_check(&b.tree, scene) != BB_OK ||
                    bb_tree_hash(&b.tree, &hashes[run + again]) != BB_OK)
                    fail_msg("%s: %s", specs[i], bb_message());
            }
            assert_int_equal(phases.count, 2);
            assert_string_equal(phases.names[0], "rtcBuildBVH");
            bool high = strstr(specs[i], "high") != NULL;
            assert_int_equal(b.tree.duplicated, high);
            if (!high)
                assert_int_equal(b.tree.info.ref_count, scene->prim_count);
            else if (splits)
                assert_true(b.tree.info.ref_count > scene->prim_count);
            if (strstr(specs[i], "leaf") == NULL)
                assert_int_equal(b.tree.info.ref_count, b.tree.info.leaf_count);
            assert_true(b.account.peak >= scene->prim_count * 32u);
            end(&b);
        }
        assert_true(hashes[0] == hashes[1] && hashes[1] == hashes[2] && hashes[2] == hashes[3]);
    }
}

static void test_builder(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 2);
    bb_scene *scene = hand_scene(5000, 500);
    hand_random(scene, &random);
    /* Long thin triangles across the scene are what spatial splits are for; some are equal, some
     * have no area. */
    for (uint32_t i = 0; i < 300; i++)
        for (uint32_t c = 0; c < 9; c++)
            scene->vertices[9 * i + c] = (float)(c < 3   ? bb_random_range(&random, -1, 1)
                                                 : c < 6 ? bb_random_range(&random, -1, 1)
                                                         : scene->vertices[9 * i + c - 3] + 0.01f);
    for (uint32_t i = 400; i < 440; i++)
        memcpy(scene->vertices + 9 * i, scene->vertices + 9 * 399, 9 * sizeof(float));
    for (uint32_t i = 450; i < 460; i++)
        memcpy(scene->vertices + 9 * i + 6, scene->vertices + 9 * i, 3 * sizeof(float));
    hand_finish(scene);
    check_scene(scene, true);
    hand_free(scene);
}

static void test_small_scenes(void **state)
{
    (void)state;
    for (uint32_t count = 1; count <= 3; count++) {
        bb_scene *scene = hand_scene(count, 0);
        memset(scene->vertices, 0, 9 * count * sizeof(float));
        hand_finish(scene);
        check_scene(scene, false);
        hand_free(scene);
        scene = hand_scene(0, count);
        for (uint32_t i = 0; i < count; i++)
            memcpy(bb_scene_floats(scene, BB_SPHERE) + 4 * i, ((float[4]){0, 0, 0, 1}),
                   4 * sizeof(float));
        hand_finish(scene);
        check_scene(scene, false);
        hand_free(scene);
    }
}

/* Morton codes that differ in one bit after the other make a chain; many equal ones at its end make
 * it deeper than Embree's default limit of 32. */
static void test_depth(void **state)
{
    (void)state;
    enum { CHAIN = 30, EQUAL = 4096 };
    bb_scene *scene = hand_scene(0, CHAIN + EQUAL);
    memset(bb_scene_floats(scene, BB_SPHERE), 0, 4 * sizeof(float) * (CHAIN + EQUAL));
    for (int i = 0; i < CHAIN; i++)
        bb_scene_floats(scene, BB_SPHERE)[4 * i + i % 3] = ldexpf(1, 10 - i / 3);
    hand_finish(scene);
    built b;
    bb_phases phases;
    begin(&b, scene, "embree:quality=low,depth=32");
    bb_status status = build(&b, scene, &phases);
    assert_int_equal(status, BB_FAILED);
    assert_non_null(strstr(bb_message(), "depth"));
    end(&b);
    begin(&b, scene, "embree:quality=low");
    assert_int_equal(build(&b, scene, &phases), BB_OK);
    assert_int_equal(bb_tree_check(&b.tree, scene), BB_OK);
    assert_true(b.tree.info.depth > 32);
    end(&b);
    hand_free(scene);
}

static void test_bad_options(void **state)
{
    (void)state;
    const bb_builder *builder = bb_builder_find("embree");
    const char *const bad[] = {"embree:leaf=0",   "embree:leaf=33", "embree:sah-block-size=x",
                               "embree:splits=0", "embree:depth=1", "embree:splits=nan"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bb_account account = {0};
        bb_spec spec;
        void *self = NULL;
        assert_int_equal(bb_spec_parse(bad[i], &spec), BB_OK);
        const bb_builder_context context = {
            .account = &account, .spec = &spec, .options = builder->options, .threads = 1};
        assert_int_equal(builder->create(&context, &self), BB_INVALID);
        assert_int_equal(account.bytes, 0);
    }
}

/* ---- memory, and who waits ---- */

/* What Embree holds is booked where all memory is; without room its tree is refused, and what it
 * had taken is given back. */
static void test_memory(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_embree *embree = NULL;
    bb_account *all = bb_host_account();
    const uint64_t limit = bb_memory_limit();
    assert_int_equal(bb_scene_load("sphere-mesh:n=200", &scene), BB_OK);
    const uint64_t before = all->bytes;
    assert_int_equal(make(scene, NULL, 2, &embree), BB_OK);
    const uint64_t held = bb_embree_bytes(embree);
    assert_true(held > 0);
    assert_int_equal(all->bytes, before + held);
    bb_embree_destroy(embree);
    assert_int_equal(all->bytes, before);
    const uint64_t taken = limit - limit / 16 - before - held / 2; /* half of it is left */
    bb_host_book(taken);
    assert_int_equal(make(scene, NULL, 2, &embree), BB_REFUSED);
    assert_null(embree);
    assert_non_null(strstr(bb_message(), "Embree has no room"));
    assert_non_null(strstr(bb_message(), "sphere-mesh"));
    bb_host_unbook(taken);
    assert_int_equal(all->bytes, before);
    assert_int_equal(make(scene, NULL, 2, &embree), BB_OK);
    bb_embree_destroy(embree);
    bb_scene_free(scene);
}

/* Nobody waits for a tree after Ctrl-C. Comes last: the signal stays noted. */
static void test_interrupt(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_embree *embree = NULL;
    assert_int_equal(bb_scene_load("sphere-mesh:n=200", &scene), BB_OK);
    const uint64_t before = bb_host_account()->bytes;
    bb_interrupt_catch();
    raise(SIGTERM);
    assert_true(bb_interrupted());
    assert_int_equal(make(scene, NULL, 2, &embree), BB_FAILED);
    assert_null(embree);
    assert_int_equal(bb_host_account()->bytes, before);
    bb_scene_free(scene);
}

/* Embree's own threads do the work of its builder; they are not built with ThreadSanitizer, which
 * would see races in all that they hand over. */
#if defined(__SANITIZE_THREAD__)
enum { BUILDER_TOO = 0 };
#else
enum { BUILDER_TOO = 1 };
#endif

int main(void)
{
    const struct CMUnitTest tracer[] = {
        cmocka_unit_test(test_trace_by_hand), cmocka_unit_test(test_too_large),
        cmocka_unit_test(test_queries_agree), cmocka_unit_test(test_manners),
        cmocka_unit_test(test_memory),
    };
    const struct CMUnitTest last[] = {cmocka_unit_test(test_interrupt)};
    const struct CMUnitTest builder[] = {
        cmocka_unit_test(test_builder),
        cmocka_unit_test(test_small_scenes),
        cmocka_unit_test(test_depth),
        cmocka_unit_test(test_bad_options),
    };
    int failed = cmocka_run_group_tests(tracer, NULL, NULL);
    if (BUILDER_TOO)
        failed += cmocka_run_group_tests(builder, NULL, NULL);
    return failed + cmocka_run_group_tests(last, NULL, NULL);
}
