/* Packets of rays that part company at once, of one ray that is left, of no numbers, of opposite,
 * equal and parallel rays, and of every length: the answers are those of brute force, bit for bit.
 * Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "tests/device_fixture.h"
#include "tests/trace_fixture.h"

enum { PACKETS = 400, RAYS = 16 * PACKETS, LONGEST = 49 };

static void to_random(bb_random *random, float v[3], double reach)
{
    for (int k = 0; k < 3; k++)
        v[k] = (float)bb_random_range(random, -reach, reach);
}

static void aim(bb_random *random, const bb_scene *scene, bb_ray *r)
{
    const bb_box *box = &scene->boxes[bb_random_below(random, scene->prim_count)];
    for (int k = 0; k < 3; k++)
        r->d[k] = 0.5f * (box->lo[k] + box->hi[k]) - r->o[k];
}

/* The kinds of packets, in words for messages. Ray `i` of a packet is made from its first. */
static const char *const kinds[] = {"from one point everywhere",
                                    "one ray that is left",
                                    "no numbers",
                                    "opposite",
                                    "equal",
                                    "parallel",
                                    "nearly parallel",
                                    "along the axes",
                                    "short and long"};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static void make_ray(bb_random *random, const bb_scene *scene, uint32_t kind, uint32_t i,
                     const bb_ray *first, bb_ray *r)
{
    *r = *first;
    switch (kind) {
    case 0:
        aim(random, scene, r);
        break;
    case 1:
        if (i != 5)
            r->tmax = i % 2 == 0 ? -1.0f : r->tmin;
        break;
    case 2:
        if (i % 3 == 0)
            (i % 2 == 0 ? r->o : r->d)[i % 3] = i % 4 == 0 ? NAN : INFINITY;
        if (i % 5 == 1)
            r->tmin = NAN;
        break;
    case 3:
        for (int k = 0; k < 3 && i % 2 == 1; k++)
            r->d[k] = -r->d[k];
        break;
    case 4:
        break;
    case 5:
        for (int k = 0; k < 3; k++)
            r->o[k] += (float)bb_random_range(random, -0.05, 0.05);
        break;
    case 6:
        for (int k = 0; k < 3; k++)
            r->d[k] *= (float)bb_random_range(random, 0.97, 1.03);
        break;
    case 7:
        for (int k = 0; k < 3; k++)
            r->d[k] = i % 3 == (uint32_t)k ? (i % 2 == 0 ? 1.0f : -1.0f) : i % 4 < 2 ? 0.0f : -0.0f;
        break;
    default:
        r->tmin = (float)bb_random_range(random, 0, 0.5);
        r->tmax = (float)bb_random_range(random, 0, 1.5);
    }
}

static void make_rays(const bb_scene *scene, bb_ray *rays)
{
    bb_random random = bb_random_make(seed, 4);
    for (uint32_t p = 0; p < PACKETS; p++) {
        bb_ray first = {.tmax = INFINITY};
        to_random(&random, first.o, 2);
        aim(&random, scene, &first);
        for (uint32_t i = 0; i < 16; i++)
            make_ray(&random, scene, p % KINDS, i, &first, &rays[16 * p + i]);
    }
}

static bool is_same(const bb_query *query, const bb_hit *a, const bb_hit *b)
{
    return query->any ? (a->prim == BB_NONE) == (b->prim == BB_NONE)
                      : a->prim == b->prim && memcmp(&a->t, &b->t, sizeof a->t) == 0;
}

static void expect(const bed *b, const bb_query *query, const bb_ray *rays, uint32_t count,
                   const bb_hit *right, bb_hit *found)
{
    memset(found, 0x55, count * sizeof *found);
    trace(b, "exact", rays, count, query, found, NULL);
    for (uint32_t i = 0; i < count; i++)
        if (!is_same(query, &right[i], &found[i]))
            fail_msg("%s, %s, %s hit, ray %u of %u, packet %s: %u at %a, not %u at %a (seed %llu)",
                     b->scene->name, b->kernel.text, query->name, i, count, kinds[i / 16 % KINDS],
                     found[i].prim, found[i].t, right[i].prim, right[i].t,
                     (unsigned long long)seed);
}

static void packets_answer_as_brute_force(void **state)
{
    (void)state;
    static const char *const scenes[] = {"interior:n=3000", "terrain:n=2000", "spheres:n=500",
                                         "tets:side=4", "single"};
    static const char *const kernels[] = {"packet:rays=8",         "packet:rays=16,few=0",
                                          "packet:rays=16,few=8",  "packet8:rays=8,few=0",
                                          "packet8:rays=16,few=2", "packet8",
                                          "packet8:sort=yes"};
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_hit *right = calloc(RAYS, sizeof *right), *found = calloc(RAYS, sizeof *found);
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++)
        for (int any = 0; any < 2; any++) {
            const bb_query *query = any ? &bb_query_any : &bb_query_closest;
            bed b;
            open_bed(&b, load(scenes[s]), "null", "stack", 1);
            make_rays(b.scene, rays);
            trace(&b, "exact", rays, RAYS, query, right, NULL);
            close_bed(&b);
            open_bed(&b, load(scenes[s]), "lbvh", "stack", 1);
            for (size_t k = 0; k < sizeof kernels / sizeof kernels[0]; k++) {
                choose_kernel(&b, kernels[k], k % 2 == 0 ? 1 : 8);
                expect(&b, query, rays, RAYS, right, found);
                for (uint32_t count = 1; count <= LONGEST && s == 0 && k % 3 == 1; count++)
                    expect(&b, query, rays, count, right, found);
            }
            close_bed(&b);
        }
    free(rays);
    free(right);
    free(found);
}

/* Equal rays take part in the same tests, and have equal counts. */
static void every_ray_of_a_packet_is_counted(void **state)
{
    (void)state;
    bb_ray rays[16];
    bb_hit hits[16];
    bb_count counts[16];
    bed b;
    open_bed(&b, load("interior:n=3000"), "lbvh", "stack", 1);
    bb_random random = bb_random_make(seed, 5);
    bb_ray first = {.tmax = INFINITY};
    aim(&random, b.scene, &first);
    for (uint32_t i = 0; i < 16; i++)
        rays[i] = first;
    choose_kernel(&b, "packet8:rays=16", 8);
    trace(&b, "exact", rays, 16, &bb_query_closest, hits, counts);
    for (uint32_t i = 0; i < 16; i++) {
        assert_int_equal(counts[i].nodes, counts[0].nodes);
        assert_int_equal(counts[i].prims, counts[0].prims);
        assert_int_equal(counts[i].overflow, 0);
    }
    assert_true(counts[0].nodes > 0 && counts[0].prims > 0);
    close_bed(&b);
}

/* Any hit: the leaf that stopped a packet is tested first with the next one, and stops equal rays
 * without a test of a box, until a packet comes that it does not stop. */
static void what_stopped_a_packet_stops_the_next(void **state)
{
    (void)state;
    enum { COUNT = 6 * 16 };
    static const bool away[] = {false, false, true, false, false, false};
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    bb_count counts[COUNT], nearest[COUNT];
    bed b;
    open_bed(&b, load("sphere-mesh:n=20"), "lbvh", "stack", 1);
    bb_random random = bb_random_make(seed, 6);
    bb_ray first = {.o = {0, 0, 9}, .tmax = INFINITY};
    aim(&random, b.scene, &first);
    for (uint32_t i = 0; i < COUNT; i++) {
        rays[i] = first;
        for (int k = 0; k < 3 && away[i / 16]; k++)
            rays[i].d[k] = -first.d[k];
    }
    choose_kernel(&b, "packet8:rays=16,few=0,group=96", 8);
    trace(&b, "exact", rays, COUNT, &bb_query_any, hits, counts);
    for (uint32_t i = 0; i < COUNT; i++)
        assert_int_equal(hits[i].prim == BB_NONE, away[i / 16]);
    assert_true(counts[0].nodes > 0);
    assert_int_equal(counts[16].nodes, 0); /* stopped by the leaf that stopped the first */
    assert_true(counts[16].prims > 0 && counts[16].prims <= 8);
    assert_true(counts[32].prims > 0);                   /* tested with it, in vain */
    assert_int_equal(counts[48].nodes, counts[0].nodes); /* begins anew */
    assert_int_equal(counts[48].prims, counts[0].prims);
    assert_int_equal(counts[64].nodes, 0);
    assert_int_equal(counts[80].nodes, 0);
    trace(&b, "exact", rays, COUNT, &bb_query_closest, hits, nearest);
    assert_int_equal(nearest[16].nodes, nearest[0].nodes); /* the closest hit may be another's */
    close_bed(&b);
}

/* An interval query cuts nothing, so each ray is tested with the primitives of all leaves whose
 * boxes it meets, alone or in a packet. */
static void packets_test_no_other_primitives(void **state)
{
    (void)state;
    static const char *const kernels[] = {"stack8", "packet8:few=0", "packet8"};
    const bb_query *query = bb_query_find("interval");
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_interval *found = calloc(RAYS, sizeof *found);
    bb_count *counts = calloc(2 * RAYS, sizeof *counts);
    bed b;
    open_bed(&b, load("interior:n=3000"), "lbvh", "stack", 1);
    make_rays(b.scene, rays);
    for (int k = 0; k < 3; k++) {
        choose_kernel(&b, kernels[k], 8);
        trace(&b, "exact", rays, RAYS, query, found, k == 0 ? counts : counts + RAYS);
        for (uint32_t i = 0; i < RAYS && k > 0; i++)
            if (counts[i].prims != counts[RAYS + i].prims)
                fail_msg("%s, ray %u, packet %s: %u tests of primitives, not %u (seed %llu)",
                         kernels[k], i, kinds[i / 16 % KINDS], counts[RAYS + i].prims,
                         counts[i].prims, (unsigned long long)seed);
    }
    close_bed(&b);
    free(rays);
    free(found);
    free(counts);
}

/* With a stack that is too short a ray has the right answer, or none and is counted. */
static void short_stacks_spoil_no_others(void **state)
{
    (void)state;
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_hit *right = calloc(RAYS, sizeof *right), *found = calloc(RAYS, sizeof *found);
    bb_count *counts = calloc(RAYS, sizeof *counts);
    uint32_t overflowed[2] = {0};
    bed b;
    open_bed(&b, load("interior:n=3000"), "lbvh", "stack", 1);
    make_rays(b.scene, rays);
    trace(&b, "exact", rays, RAYS, &bb_query_closest, right, NULL);
    for (int k = 0; k < 2; k++) {
        choose_kernel(&b, k == 0 ? "stack8:stack=8" : "packet8:stack=8", 1);
        memset(found, 0x55, RAYS * sizeof *found);
        trace(&b, "exact", rays, RAYS, &bb_query_closest, found, counts);
        for (uint32_t i = 0; i < RAYS; i++) {
            overflowed[k] += counts[i].overflow;
            if (counts[i].overflow == 0 && !is_same(&bb_query_closest, &right[i], &found[i]))
                fail_msg("%s, ray %u: a wrong answer (seed %llu)", b.kernel.text, i,
                         (unsigned long long)seed);
        }
    }
    if (overflowed[0] == 0 || overflowed[1] > overflowed[0])
        fail_msg("%u rays lack an answer alone, %u in packets (seed %llu)", overflowed[0],
                 overflowed[1], (unsigned long long)seed);
    close_bed(&b);
    free(rays);
    free(right);
    free(found);
    free(counts);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packets_answer_as_brute_force),
        cmocka_unit_test(every_ray_of_a_packet_is_counted),
        cmocka_unit_test(what_stopped_a_packet_stops_the_next),
        cmocka_unit_test(packets_test_no_other_primitives),
        cmocka_unit_test(short_stacks_spoil_no_others),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
