/* Rays that are awkward, with every kernel: along the axes in box faces, from and through vertices,
 * from surfaces, with empty intervals, with components that are zero, denormal, infinite or no
 * number. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/judge/judge.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"
#include "tests/device_fixture.h"
#include "tests/trace_fixture.h"

/* Traces by every kernel and has the answers judged: none may be wrong. */
static void expect_right(const char *scene_name, const char *what, const bb_ray *rays,
                         uint32_t count)
{
    bb_scene *scene = load(scene_name);
    bb_oracle *oracle;
    bb_answers answers;
    bb_accuracy accuracy;
    bb_rays set = {.name = "awkward", .query = &bb_query_closest, .count = count};
    check(bb_oracle_create(scene, device->compute_units, &oracle), "oracle");
    check(bb_host_alloc(NULL, count * sizeof *rays, "rays", &set.rays), "rays");
    memcpy(set.rays, rays, count * sizeof *rays);
    check(bb_answers_make(oracle, &set, &answers), "answers");
    bb_hit *hits = calloc(count, sizeof *hits);
    bed b;
    open_bed(&b, scene, "lbvh", bb_kernels[0]->name, 1);
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
        choose_kernel(&b, (*k)->name, 1);
        trace(&b, "exact", rays, count, &bb_query_closest, hits, NULL);
        check(bb_judge(oracle, &answers, &(bb_verdict_request){.results = hits, .count = count},
                       &accuracy),
              "judge");
        if (accuracy.wrong_ppm > 0)
            fail_msg("%s, kernel %s: %llu missed, %llu false, %llu wrong t, the first is ray %u "
                     "(seed %llu)",
                     what, (*k)->name, (unsigned long long)accuracy.missed,
                     (unsigned long long)accuracy.false_hits, (unsigned long long)accuracy.wrong_t,
                     accuracy.first_wrong, (unsigned long long)seed);
    }
    free(hits);
    bb_answers_release(&answers);
    bb_host_free(set.rays);
    bb_oracle_destroy(oracle);
    close_bed(&b);
}

enum { COUNT = 20000 };

static void along_axes_in_box_faces(void **state)
{
    (void)state;
    bb_scene *scene = load("terrain:n=2000");
    bb_ray *rays = calloc(COUNT, sizeof *rays);
    bb_random random = bb_random_make(seed, 1);
    for (uint32_t i = 0; i < COUNT; i++) {
        const bb_box *box = &scene->boxes[bb_random_below(&random, scene->prim_count)];
        bb_ray *r = &rays[i];
        *r = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++)
            r->o[k] = bb_random_below(&random, 2) ? box->lo[k] : box->hi[k];
        int axis = (int)bb_random_below(&random, 3);
        r->d[axis] = bb_random_below(&random, 2) ? 1.0f : -1.0f;
        r->d[(axis + 1) % 3] = bb_random_below(&random, 2) ? 0.0f : -0.0f;
        r->o[axis] -= r->d[axis] * (float)bb_random_below(&random, 3);
    }
    bb_scene_free(scene);
    expect_right("terrain:n=2000", "along the axes", rays, COUNT);
    free(rays);
}

/* Directions with components of 0 and of denormal and very small size, and origins on vertices. */
static void tiny_components_and_origins_on_surfaces(void **state)
{
    (void)state;
    static const float tiny[] = {0.0f, -0.0f, 1e-45f, -1e-40f, 1e-38f, -1e-30f, 1e-10f};
    bb_scene *scene = load("interior:n=2000");
    bb_ray *rays = calloc(COUNT, sizeof *rays);
    bb_random random = bb_random_make(seed, 2);
    for (uint32_t i = 0; i < COUNT; i++) {
        const float *vertex =
            scene->vertices + 3 * (size_t)bb_random_below(&random, scene->vertex_count);
        bb_ray *r = &rays[i];
        *r = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            r->o[k] = i % 2 == 0 ? vertex[k]
                                 : (float)bb_random_range(&random, scene->bounds.lo[k],
                                                          scene->bounds.hi[k]);
            r->d[k] = bb_random_below(&random, 2)
                          ? tiny[bb_random_below(&random, sizeof tiny / sizeof tiny[0])]
                          : (float)bb_random_range(&random, -1, 1);
        }
        if (fabsf(r->d[0]) + fabsf(r->d[1]) + fabsf(r->d[2]) < 1e-3f)
            r->d[i % 3] = 1;
    }
    bb_scene_free(scene);
    expect_right("interior:n=2000", "tiny components", rays, COUNT);
    free(rays);
}

static bool is_number(const bb_ray *ray)
{
    bool number = true;
    for (int k = 0; k < 3; k++)
        number = number && !isnan(ray->o[k]) && !isnan(ray->d[k]);
    return number;
}

/* `room` has space for an interval of each ray. */
static void expect_within(bed *b, const char *kernel, const bb_query *query, const bb_ray *rays,
                          uint32_t count, void *room)
{
    const bb_hit *hits = room;
    const bb_interval *intervals = room;
    choose_kernel(b, kernel, 1);
    trace(b, "exact", rays, count, query, room, NULL);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t end = 0; end < (query->is_hit ? 1u : 2u); end++) {
            const float t = query->is_hit ? hits[i].t : intervals[i].t[end];
            const uint32_t prim = query->is_hit ? hits[i].prim : intervals[i].prims[end];
            bool miss = prim == BB_NONE && t == (end == 0 ? INFINITY : -INFINITY);
            bool inside = t > rays[i].tmin && t < rays[i].tmax;
            if (!miss && (!is_number(&rays[i]) || !inside || prim >= b->scene->prim_count))
                fail_msg("kernel %s, %s, ray %u: %u at %g (seed %llu)", kernel, query->name, i,
                         prim, t, (unsigned long long)seed);
        }
}

/* Every ray gets an answer; no hit lies outside of its interval; what is no ray hits nothing. */
static void no_rays_and_empty_intervals(void **state)
{
    (void)state;
    const float bad[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-45f, 3e38f, 1.0f};
    const float ends[][2] = {{0, INFINITY},  {0, 0},   {0.5f, 0.5f},         {1, 0.5f},
                             {NAN, 1},       {0, NAN}, {INFINITY, INFINITY}, {-1, 1e-45f},
                             {0, -1},        {-2, -1}, {0, -INFINITY},       {3e38f, INFINITY},
                             {INFINITY, NAN}};
    enum { BAD = 8, ENDS = 13, ALL = BAD * BAD * BAD * 2 + 1000 * ENDS };
    bb_ray *rays = calloc(ALL, sizeof *rays);
    bb_interval *hits = calloc(ALL, sizeof *hits);
    bb_random random = bb_random_make(seed, 3);
    for (uint32_t i = 0; i < ALL; i++) {
        bb_ray *r = &rays[i];
        *r = (bb_ray){.o = {0.1f, 0.2f, 0.3f}, .d = {0, 0, 1}, .tmax = INFINITY};
        if (i < BAD * BAD * BAD * 2) {
            float *v = i % 2 == 0 ? r->d : r->o;
            v[0] = bad[i / 2 % BAD];
            v[1] = bad[i / 2 / BAD % BAD];
            v[2] = bad[i / 2 / BAD / BAD % BAD];
            continue;
        }
        for (int k = 0; k < 3; k++)
            r->d[k] = (float)bb_random_range(&random, -1, 1);
        r->tmin = ends[i % ENDS][0];
        r->tmax = ends[i % ENDS][1];
    }
    const bb_query *const queries[] = {&bb_query_closest, &bb_query_any, bb_query_find("interval")};
    for (uint32_t i = 0; i < 6; i++) {
        bed b; /* the cube is one leaf, which rays come to without a box */
        open_bed(&b, load(i % 2 == 0 ? "interior:n=2000" : "cube"), i % 2 == 0 ? "lbvh" : "null",
                 bb_kernels[0]->name, 1);
        for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
            expect_within(&b, (*kernel)->name, queries[i / 2], rays, ALL, hits);
        close_bed(&b);
    }
    free(rays);
    free(hits);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(along_axes_in_box_faces),
        cmocka_unit_test(tiny_components_and_origins_on_surfaces),
        cmocka_unit_test(no_rays_and_empty_intervals),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
