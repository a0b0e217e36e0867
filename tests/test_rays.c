/* Ray sets: the same for the same seed, finite, distributed as they should be, and off the surfaces
 * they start on. A few seconds. */
#include "framework/judge/arbiter.h"
#include "framework/judge/oracle.h"
#include "framework/judge/queries.h"
#include "framework/scene/camera.h"
#include "framework/workload/workload.h"
#include "hand_scene.h"
#include "tests/fixture.h"

enum { SIZE = 96, MOST = 60000 };
static const uint64_t seed = 99;
static const float zero[3] = {0, 0, 0};

static bb_view view_of(const char *name, double x, double y, double z)
{
    bb_view view = {.eye = {x, y, z}, .up = {0, 1, 0}, .fov_y = 60};
    snprintf(view.name, sizeof view.name, "%s", name);
    return view;
}

/* A room with spheres and triangles in it, seen from inside; the second view looks at less of them.
 */
static bb_scene *make_room(const float offset[3])
{
    bb_random random = bb_random_make(seed, 1);
    bb_scene *scene = hand_scene(40, 10);
    hand_random(scene, &random);
    for (uint32_t i = 0; i < 9 * scene->prims[BB_TRIANGLE].count; i++)
        scene->vertices[i] += offset[i % 3];
    for (uint32_t i = 0; i < 4 * scene->prims[BB_SPHERE].count; i++)
        bb_scene_floats(scene, BB_SPHERE)[i] += i % 4 < 3 ? offset[i % 4] : 0;
    hand_cube(scene, 0, 2, offset);
    hand_finish(scene);
    scene->view_count = 2;
    scene->views[0] = view_of("front", 0.1, 0.2, 1.9);
    scene->views[1] = view_of("far", 0, 0, 40);
    for (int v = 0; v < 2; v++)
        for (int k = 0; k < 3; k++) {
            scene->views[v].eye[k] += (double)offset[k];
            scene->views[v].target[k] += (double)offset[k];
        }
    return scene;
}

static bb_status make(const bb_scene *scene, bb_oracle *oracle, const char *text,
                      const bb_view *view, uint32_t most, uint64_t with_seed, bb_rays **rays)
{
    bb_spec spec;
    assert_int_equal(bb_spec_parse(text, &spec), BB_OK);
    bb_rays_request request = {.spec = &spec,
                               .view = view,
                               .width = SIZE,
                               .height = SIZE,
                               .max_rays = most,
                               .seed = with_seed};
    return bb_rays_make(scene, oracle, &request, rays);
}

static bb_rays *made(const bb_scene *scene, bb_oracle *oracle, const char *text,
                     const bb_view *view)
{
    bb_rays *rays = NULL;
    if (make(scene, oracle, text, view, MOST, seed, &rays) != BB_OK)
        fail_msg("%s: %s", text, bb_message());
    return rays;
}

static double length_of(const float v[3])
{
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

static void test_all(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    scene->closed_from_inside = true;
    bb_oracle *oracle = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    for (const bb_workload *const *w = bb_workloads; *w != NULL; w++) {
        const bb_workload *workload = *w;
        if (strcmp(workload->name, "edges") == 0)
            continue; /* has a test of its own */
        const bb_view *view = workload->per_view ? &scene->views[0] : NULL;
        bb_rays *one = made(scene, oracle, workload->name, view),
                *again = made(scene, oracle, workload->name, view), *other = NULL;
        assert_int_equal(make(scene, oracle, workload->name, view, MOST, seed + 1, &other), BB_OK);
        assert_true(one->hash == again->hash && one->count == again->count);
        assert_memory_equal(one->rays, again->rays, one->count * sizeof(bb_ray));
        assert_int_equal(one->hash == other->hash, strcmp(workload->name, "primary") == 0);
        assert_string_equal(one->name, workload->name);
        assert_true(one->query == workload->query && one->count > 1000 && one->count <= MOST);
        assert_false(one->must_hit);
        for (uint32_t i = 0; i < one->count; i++) {
            const bb_ray *ray = &one->rays[i];
            for (int k = 0; k < 3; k++)
                assert_true(isfinite(ray->o[k]) && isfinite(ray->d[k]));
            assert_true(length_of(ray->d) > 0 && ray->tmin >= 0 && ray->tmax > ray->tmin);
        }
        bb_rays_free(one);
        bb_rays_free(again);
        bb_rays_free(other);
    }
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

static void test_primary(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_view view = view_of("axis", 0, 0, 10);
    view.fov_y = 90;
    bb_rays *rays = made(scene, NULL, "primary:tmin=0.5", &view);
    assert_true(rays->count == SIZE * SIZE && rays->width == SIZE && rays->height == SIZE);
    assert_string_equal(rays->view, "axis");
    const bb_ray *first = &rays->rays[0], *last = &rays->rays[SIZE * SIZE - 1];
    const double edge = 1.0 - 1.0 / SIZE; /* centre of the outermost pixel at distance 1 */
    assert_true(first->tmin == 0.5f && isinf(first->tmax));
    for (int k = 0; k < 3; k++)
        assert_true(first->o[k] == (k == 2 ? 10.0f : 0.0f));
    /* x to the right, y from the top, looking down -z */
    assert_float_equal(first->d[0] / -first->d[2], -edge, 1e-5);
    assert_float_equal(first->d[1] / -first->d[2], edge, 1e-5);
    assert_float_equal(last->d[0] / -last->d[2], edge, 1e-5);
    assert_float_equal(last->d[1] / -last->d[2], -edge, 1e-5);
    bb_rays_free(rays);

    view.parallel = true;
    view.fov_y = 4;
    rays = made(scene, NULL, "primary", &view);
    first = &rays->rays[0];
    assert_true(first->d[0] == 0 && first->d[1] == 0 && first->d[2] == -1);
    assert_float_equal(first->o[0], -2 * edge, 1e-5);
    assert_float_equal(first->o[1], 2 * edge, 1e-5);
    bb_rays_free(rays);
    hand_free(scene);
}

/* Share of the rays that the oracle has hit before `limit`. */
static double share_before(bb_oracle *oracle, const bb_rays *rays, double limit)
{
    bb_hit *hits = malloc(rays->count * sizeof *hits);
    assert_int_equal(bb_oracle_trace(oracle, rays->rays, rays->count, &bb_query_closest, hits),
                     BB_OK);
    uint32_t before = 0;
    for (uint32_t i = 0; i < rays->count; i++)
        before += hits[i].prim != BB_NONE && hits[i].t < limit;
    free(hits);
    return (double)before / rays->count;
}

/* Cosine-weighted: within a batch the directions' sum is along the normal, of 2/3 their number; and
 * they don't start on the wrong side, also far from the origin. */
static void test_hemispheres(void **state)
{
    (void)state;
    const float offsets[2][3] = {{0, 0, 0}, {148376, 1234, -223423}};
    for (int run = 0; run < 2; run++) {
        bb_scene *scene = make_room(offsets[run]);
        bb_oracle *oracle = NULL;
        assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
        double diagonal = 4 * sqrt(3);
        bb_rays *rays = made(scene, oracle, "ao:per_hit=200,length=0.25", NULL);
        assert_true(rays->count == MOST / 200 * 200);
        double mean = 0;
        for (uint32_t i = 0; i < rays->count; i += 200) {
            double sum[3] = {0, 0, 0};
            for (uint32_t j = i; j < i + 200; j++) {
                assert_memory_equal(rays->rays[j].o, rays->rays[i].o, sizeof rays->rays[i].o);
                assert_float_equal(length_of(rays->rays[j].d), 1, 1e-6);
                assert_float_equal(rays->rays[j].tmax, 0.25 * diagonal, 0.05);
                for (int k = 0; k < 3; k++)
                    sum[k] += rays->rays[j].d[k];
            }
            mean += sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 200;
        }
        /* E[cos] = 2/3; the tangential part of 200 directions adds some 0.2 %. */
        assert_float_equal(mean / (rays->count / 200), 0.667, 0.01);
        bb_rays_free(rays);

        /* Nothing starts on the wrong side or on the surface itself; corners, where walls meet, are
         * few. */
        rays = made(scene, oracle, "diffuse:per_hit=16", NULL);
        assert_true(isinf(rays->rays[0].tmax));
        double grain = run == 0 ? 1e-5 * diagonal : 0.22;
        assert_true(share_before(oracle, rays, grain) < (run == 0 ? 0.001 : 0.15));
        assert_true(share_before(oracle, rays, 1e-3) < (run == 0 ? 0.01 : 0.02));
        assert_true(share_before(oracle, rays, INFINITY) > 0.7);
        bb_rays_free(rays);
        bb_oracle_destroy(oracle);
        hand_free(scene);
    }
}

static void test_sampling(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_oracle *oracle = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    /* 100 hits of 2 views: 50 each. The second view sees the room from outside, so its points are
     * on the cube's outside. */
    bb_rays *rays = NULL;
    assert_int_equal(make(scene, oracle, "diffuse:per_hit=4", NULL, 400, seed, &rays), BB_OK);
    assert_int_equal(rays->count, 400);
    uint32_t outside = 0;
    for (uint32_t i = 0; i < rays->count; i++)
        outside += fabsf(rays->rays[i].o[0]) > 2 || fabsf(rays->rays[i].o[1]) > 2 ||
                   fabsf(rays->rays[i].o[2]) > 2;
    assert_int_equal(outside, 200);
    bb_rays_free(rays);

    /* Fewer hits than wanted: all of them, and the first view makes up for the second. */
    rays = made(scene, oracle, "shadow", NULL);
    bb_rays *first = made(scene, oracle, "shadow", &scene->views[0]);
    assert_true(first->count == SIZE * SIZE && rays->count > first->count && rays->count < MOST);
    bb_rays_free(rays);
    bb_rays_free(first);
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

static void expect(bb_status expected, const bb_scene *scene, bb_oracle *oracle, const char *text,
                   const bb_view *view);

/* More pictures: the first as ever, later ones with a ray in each pixel, none of them twice. */
static void test_more_pictures(void **state)
{
    (void)state;
    enum { PIXELS = SIZE * SIZE };
    bb_scene *scene = make_room(zero);
    bb_view view = view_of("axis", 0, 0, 10);
    view.fov_y = 90;
    bb_rays *one = made(scene, NULL, "primary", &view);
    bb_rays *more = made(scene, NULL, "primary:least=20000", &view), *other = NULL;
    assert_int_equal(more->count, 3 * PIXELS); /* 9216 each */
    assert_int_equal(more->width, 0);          /* of no picture */
    assert_memory_equal(more->rays, one->rays, PIXELS * sizeof(bb_ray));
    double centre = 0, square = 0;
    for (uint32_t i = PIXELS; i < more->count; i++) {
        const bb_ray *ray = &more->rays[i], *same = &one->rays[i % PIXELS];
        for (int k = 0; k < 2; k++) { /* pixels are 2 / SIZE wide at distance 1 */
            double off = (double)(ray->d[k] / -ray->d[2] - same->d[k] / -same->d[2]) * SIZE / 2;
            assert_true(fabs(off) <= 0.5 + 1e-3);
            centre += off / (4 * PIXELS);
            square += off * off / (4 * PIXELS);
        }
        assert_true(ray->d[0] != more->rays[i - PIXELS].d[0]);
    }
    assert_true(fabs(centre) < 0.01 && fabs(square - 1.0 / 12) < 0.003); /* all over the pixel */
    assert_int_equal(make(scene, NULL, "primary:least=20000", &view, MOST, seed + 1, &other),
                     BB_OK);
    assert_memory_equal(other->rays, more->rays, PIXELS * sizeof(bb_ray));
    assert_true(memcmp(other->rays + PIXELS, more->rays + PIXELS, PIXELS * sizeof(bb_ray)) != 0);
    bb_rays_free(other);
    assert_int_equal(make(scene, NULL, "primary:least=9216", &view, MOST, seed, &other), BB_OK);
    assert_true(other->hash == one->hash && other->width == SIZE);
    bb_rays_free(one);
    bb_rays_free(more);
    bb_rays_free(other);
    hand_free(scene);
}

/* Rays from surfaces: at least as many as asked for, from as many pictures as that takes, and not
 * one point twice; never more than the limit. */
static void test_more_samples(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_oracle *oracle = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    static const char *const kinds[] = {"shadow", "path:bounce=1", "ao", "diffuse"};
    for (int i = 0; i < 4; i++) {
        char text[64];
        snprintf(text, sizeof text, "%s%cleast=50000%s", kinds[i], i == 1 ? ',' : ':',
                 i > 1 ? ",per_hit=2" : "");
        bb_rays *rays = made(scene, oracle, text, NULL), *few = NULL;
        if (rays->count < 50000 || rays->count > MOST)
            fail_msg("%s: %u rays", text, rays->count);
        for (uint32_t k = 2; k < rays->count; k += 2)
            assert_memory_not_equal(rays->rays[k].o, rays->rays[k - 2].o, sizeof rays->rays[k].o);
        assert_int_equal(make(scene, oracle, text, NULL, 1000, seed, &few), BB_OK);
        assert_int_equal(few->count, 1000);
        bb_rays_free(rays);
        bb_rays_free(few);
    }
    expect(BB_INVALID, scene, oracle, "shadow:least=0", NULL);
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

/* Each ray of a bounce starts where one of the bounce before hits, in their order, and goes
 * anywhere above it; paths that leave the scene end. */
static void test_paths(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_oracle *oracle = NULL;
    bb_rays *before = NULL, *rays = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    double dot = 0, count = 0;
    for (uint32_t bounce = 1; bounce <= 4; bounce++) {
        char text[32];
        snprintf(text, sizeof text, "path:bounce=%u", bounce);
        rays = made(scene, oracle, text, NULL);
        if (before != NULL) {
            bb_hit *hits = malloc(before->count * sizeof *hits);
            ASSERT_OK(
                bb_oracle_trace(oracle, before->rays, before->count, &bb_query_closest, hits));
            uint32_t at = 0;
            for (uint32_t i = 0; i < before->count && at < rays->count; i++) {
                double away = 0, on[3];
                if (hits[i].prim == BB_NONE)
                    continue;
                for (int k = 0; k < 3; k++) {
                    on[k] = before->rays[i].o[k] + (double)hits[i].t * before->rays[i].d[k];
                    away = hypot(away, on[k] - rays->rays[at].o[k]);
                }
                if (away > 1e-3)
                    continue; /* a hit without a point */
                for (int k = 0; k < 3; k++)
                    dot += before->rays[i].d[k] * (double)rays->rays[at].d[k];
                count++;
                at++;
            }
            assert_int_equal(at, rays->count);
            if (rays->count > before->count || rays->count < before->count / 3)
                fail_msg("%s: %u rays, before %u", text, rays->count, before->count);
            free(hits);
            bb_rays_free(before);
        }
        before = rays;
    }
    assert_true(dot / count <
                -0.3); /* away from what they hit: -4/9 where all directions hit alike */
    expect(BB_INVALID, scene, oracle, "path:bounce=0", NULL);
    bb_rays_free(before);
    bb_oracle_destroy(oracle);
    hand_free(scene);

    bb_random random = bb_random_make(seed, 9);
    scene = hand_scene(1, 0);
    hand_random(scene, &random);
    hand_finish(scene);
    scene->view_count = 1;
    scene->views[0] = view_of("front", 0, 0, 9);
    for (int k = 0; k < 3; k++)
        scene->views[0].target[k] =
            (scene->vertices[k] + scene->vertices[3 + k] + scene->vertices[6 + k]) / 3;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    expect(BB_UNSUPPORTED, scene, oracle, "path", NULL);
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

/* What is added to rays that say nothing of it, and to kinds that have it. */
static void test_at_least(void **state)
{
    (void)state;
    static const char *const cases[][2] = {{"primary", "primary:least=1000"},
                                           {"ao:per_hit=4", "ao:per_hit=4,least=1000"},
                                           {"shadow:least=5", "shadow:least=5"},
                                           {"random", "random"}};
    char more[64];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(bb_workload_at_least(cases[i][0], 1000, more, sizeof more), BB_OK);
        assert_string_equal(more, cases[i][1]);
    }
    assert_int_equal(bb_workload_at_least("primary", 1000, more, 18), BB_INVALID);
}

static void test_shadow_and_random(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_oracle *oracle = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    bb_rays *rays = made(scene, oracle, "shadow:size=0.5,drop=0.125", NULL);
    double mean[3] = {0, 0, 0};
    for (uint32_t i = 0; i < rays->count; i++) {
        const bb_ray *ray = &rays->rays[i];
        assert_true(ray->tmax == 1.0f);
        for (int k = 0; k < 3; k++) {
            double target = (double)ray->o[k] + ray->d[k];
            if (k == 1) {
                assert_float_equal(target, 1.5, 1e-4); /* box [-2, 2] */
            } else {
                assert_true(fabs(target) < 1.0 + 1e-4);
            }
            mean[k] += target / rays->count;
        }
    }
    assert_true(fabs(mean[0]) < 0.05 && fabs(mean[2]) < 0.05);
    bb_rays_free(rays);

    rays = made(scene, oracle, "random:count=20000", NULL);
    assert_int_equal(rays->count, 20000);
    memset(mean, 0, sizeof mean);
    for (uint32_t i = 0; i < rays->count; i++)
        for (int k = 0; k < 3; k++) {
            assert_true(fabsf(rays->rays[i].o[k]) <= 2);
            mean[k] += (double)rays->rays[i].o[k] / rays->count;
        }
    assert_true(fabs(mean[0]) < 0.05 && fabs(mean[1]) < 0.05 && fabs(mean[2]) < 0.05);
    bb_rays_free(rays);
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

/* In exact arithmetic each ray hits the mesh, close to an edge or a vertex. */
static void test_edges(void **state)
{
    (void)state;
    const float offsets[2][3] = {{0, 0, 0}, {148376, 1234, -223423}};
    for (int run = 0; run < 2; run++) {
        bb_scene *scene = hand_scene(12, 0);
        hand_cube(scene, 0, 2, offsets[run]);
        hand_finish(scene);
        for (int k = 0; k < 3; k++)
            scene->inside_point[k] = (double)offsets[run][k] + 0.25;
        bb_rays *rays = NULL;
        assert_int_equal(make(scene, NULL, "edges:from=inside", NULL, MOST, seed, &rays),
                         BB_UNSUPPORTED);
        scene->closed_from_inside = true;
        rays = made(scene, NULL, "edges:count=20000", NULL);
        assert_true(rays->must_hit && rays->count == 20000);
        uint32_t vertices = 0, centres = 0;
        for (uint32_t i = 0; i < rays->count; i++) {
            const bb_ray *ray = &rays->rays[i];
            double t;
            bool hit = false;
            for (uint32_t p = 0; p < 12; p++)
                hit |= bb_exact_first(scene, ray, p, &t);
            assert_true(hit);
            /* At t = 1 it is on an edge of the cube or on a diagonal of a face: on its surface, at
             * least. */
            int on = 0;
            bool centre = true;
            for (int k = 0; k < 3; k++) {
                double at = (double)ray->o[k] + ray->d[k] - (double)offsets[run][k];
                on += fabs(fabs(at) - 2) < 1e-5;
                centre &= ray->o[k] == (float)scene->inside_point[k];
                assert_true(fabs(at) < 2 + 1e-5);
            }
            assert_true(on >= 1);
            vertices += on == 3;
            centres += centre;
        }
        assert_true(vertices >= 5000 && vertices < 6000 && centres >= 10000);
        bb_rays_free(rays);
        hand_free(scene);
    }
}

static void expect(bb_status expected, const bb_scene *scene, bb_oracle *oracle, const char *text,
                   const bb_view *view)
{
    bb_rays *rays = NULL;
    bb_status status = make(scene, oracle, text, view, MOST, seed, &rays);
    if (status != expected)
        fail_msg("%s: status %d, expected %d", text, status, expected);
    assert_null(rays);
    assert_true(strlen(bb_message()) > 10);
}

static void test_bad_input(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_oracle *oracle = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    bb_view blind = view_of("blind", 0, 0, 0), along = view_of("along", 0, 5, 0),
            huge = view_of("huge", 1e300, 0, 0), away = view_of("away", 0, 0, 9);
    away.target[2] = 10;
    expect(BB_INVALID, scene, oracle, "nonsense", NULL);
    expect(BB_INVALID, scene, oracle, "ao:colour=red", NULL);
    expect(BB_INVALID, scene, oracle, "ao:length=-1", NULL);
    expect(BB_INVALID, scene, oracle, "ao:length=nan", NULL);
    expect(BB_INVALID, scene, oracle, "ao:per_hit=100000", NULL);
    expect(BB_INVALID, scene, oracle, "ao:tmin=1e20", NULL);
    expect(BB_INVALID, scene, oracle, "random:count=0", NULL);
    expect(BB_INVALID, scene, oracle, "primary", NULL);
    expect(BB_INVALID, scene, oracle, "primary", &blind);
    expect(BB_INVALID, scene, oracle, "primary", &along);
    expect(BB_INVALID, scene, oracle, "primary", &huge);
    expect(BB_UNSUPPORTED, scene, oracle, "ao", &away);
    expect(BB_UNSUPPORTED, scene, oracle, "edges:from=inside", NULL);
    bb_oracle_destroy(oracle);
    hand_free(scene);

    /* A scene that is a point. */
    scene = hand_scene(0, 1);
    memset(bb_scene_floats(scene, BB_SPHERE), 0, 4 * sizeof(float));
    hand_finish(scene);
    memset(&scene->bounds, 0, sizeof scene->bounds);
    expect(BB_UNSUPPORTED, scene, NULL, "random", NULL);
    hand_free(scene);
}

/* Crofton: of lines through a ball the share that meets a convex body within is that of their
 * areas; Cauchy: the mean length inside is 4 volumes over the area. */
static void test_lines(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(12, 0);
    hand_cube(scene, 0, 2, zero);
    hand_finish(scene);
    bb_oracle *oracle = NULL;
    bb_rays *rays = NULL, *again = NULL, *any = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    assert_int_equal(make(scene, oracle, "lines:query=interval", NULL, MOST, 3, &rays), BB_OK);
    assert_int_equal(make(scene, oracle, "lines", NULL, MOST, 3, &again), BB_OK);
    assert_int_equal(make(scene, oracle, "lines:query=any,count=100", NULL, MOST, 4, &any), BB_OK);
    assert_string_equal(rays->query->name, "interval");
    assert_string_equal(any->query->name, "any");
    assert_true(rays->hash == again->hash && any->count == 100 && rays->count == MOST);
    double met = 0, length = 0, side = 0;
    for (int k = 0; k < 3; k++)
        side = fmax(side, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    for (uint32_t i = 0; i < rays->count; i++) {
        const bb_ray *ray = &rays->rays[i];
        double from = ray->tmin, to = ray->tmax;
        for (int k = 0; k < 3; k++) {
            double a = ((double)scene->bounds.lo[k] - ray->o[k]) / ray->d[k];
            double b = ((double)scene->bounds.hi[k] - ray->o[k]) / ray->d[k];
            from = fmax(from, fmin(a, b));
            to = fmin(to, fmax(a, b));
        }
        met += from < to;
        length += from < to ? to - from : 0;
    }
    double expected = 6 / (acos(-1.0) * 3); /* 6 s^2 / (4 pi (3 / 4) s^2) */
    double sigma = sqrt(expected * (1 - expected) / rays->count);
    assert_true(fabs(met / rays->count - expected) < 5 * sigma);
    assert_true(fabs(length / met - 4 * side / 6) < 5 * side / sqrt(met));
    bb_rays_free(rays);
    bb_rays_free(again);
    bb_rays_free(any);
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

/* The first and last hit are asked of meshes alone. */
static void test_lines_need_meshes_for_intervals(void **state)
{
    (void)state;
    bb_scene *scene = make_room(zero);
    bb_oracle *oracle = NULL;
    bb_rays *rays = NULL;
    assert_int_equal(bb_oracle_create(scene, 2, &oracle), BB_OK);
    assert_int_equal(make(scene, oracle, "lines:query=interval", NULL, MOST, 3, &rays),
                     BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "query=closest"));
    assert_int_equal(make(scene, oracle, "lines", NULL, MOST, 3, &rays), BB_OK);
    bb_rays_free(rays);
    bb_oracle_destroy(oracle);
    hand_free(scene);
}

/* Two sets have one hash only if no ray differs in anything. */
static void test_hash(void **state)
{
    (void)state;
    bb_ray rays[2] = {{{1, 2, 3}, 4, {5, 6, 7}, 8}, {{9, 10, 11}, 12, {13, 14, 15}, 16}};
    bb_rays set = {.rays = rays, .count = 2};
    const uint64_t hash = bb_rays_hash(&set);
    for (size_t i = 0; i < sizeof rays; i++) {
        ((unsigned char *)rays)[i] ^= 1;
        assert_true(bb_rays_hash(&set) != hash);
        ((unsigned char *)rays)[i] ^= 1;
    }
    assert_true(bb_rays_hash(&set) == hash);
    set.count = 1;
    assert_true(bb_rays_hash(&set) != hash);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all),
        cmocka_unit_test(test_primary),
        cmocka_unit_test(test_hemispheres),
        cmocka_unit_test(test_sampling),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_shadow_and_random),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_hash),
        cmocka_unit_test(test_more_pictures),
        cmocka_unit_test(test_more_samples),
        cmocka_unit_test(test_paths),
        cmocka_unit_test(test_at_least),
        cmocka_unit_test(test_lines),
        cmocka_unit_test(test_lines_need_meshes_for_intervals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
