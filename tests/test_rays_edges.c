/* Rays at edges: as ever without options, off the edge by no more than they say, from where they
 * say, at long edges as often as at short ones. A second or two. */
#include "tests/scene_files.h"

#include "framework/judge/arbiter.h"
#include "framework/workload/workload.h"

#include <math.h>

enum { COUNT = 4096 };
static const uint64_t default_seed = 99;
static uint64_t seed;

static bb_status make(const bb_scene *scene, const char *text, uint64_t with_seed, bb_rays **rays)
{
    bb_spec spec;
    assert_int_equal(bb_spec_parse(text, &spec), BB_OK);
    bb_rays_request request = {.spec = &spec, .max_rays = COUNT, .seed = with_seed};
    return bb_rays_make(scene, NULL, &request, rays);
}

static bb_rays *made(const bb_scene *scene, const char *text)
{
    bb_rays *rays = NULL;
    if (make(scene, text, seed, &rays) != BB_OK)
        fail_msg("%s, %s, seed %llu: %s", scene->name, text, (unsigned long long)seed,
                 bb_message());
    assert_int_equal(rays->count, COUNT);
    return rays;
}

/* Where ray i is aimed. */
static void target_of(const bb_rays *rays, uint32_t i, double at[3])
{
    for (int k = 0; k < 3; k++)
        at[k] = (double)rays->rays[i].o[k] + (double)rays->rays[i].d[k];
}

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void expect_same(const bb_scene *scene, const char *one, const char *other)
{
    bb_rays *a = made(scene, one), *b = made(scene, other);
    assert_memory_equal(a->rays, b->rays, COUNT * sizeof(bb_ray));
    assert_true(a->must_hit == b->must_hit && a->hash == b->hash);
    bb_rays_free(a);
    bb_rays_free(b);
}

/* Hashes are in result files: without options the rays are the same in every version. */
static void test_recorded(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("sphere-mesh:n=8,radius=2");
    bb_rays *rays = NULL;
    assert_int_equal(make(scene, "edges:count=5000", default_seed, &rays), BB_OK);
    assert_true(rays->hash == 0x799848be8b7e400eu);
    bb_rays_free(rays);
    expect_same(scene, "edges", "edges:jitter=0");
    expect_same(scene, "edges", "edges:from=inside");
    bb_scene_free(scene);
}

/* ---- jitter ---- */

/* Distance from the target to the nearest edge of a triangle, in 2^-24 of that triangle's extent
 * from the origin of the ray. */
static double steps_off(const bb_scene *scene, uint32_t triangle, const bb_ray *ray,
                        const double at[3])
{
    double extent = 0, nearest = INFINITY;
    for (uint32_t c = 0; c < 3; c++) {
        const float *p = bb_scene_vertex(scene, triangle, c),
                    *q = bb_scene_vertex(scene, triangle, (c + 1) % 3);
        double along = 0, square = 0, off[3];
        for (int k = 0; k < 3; k++) {
            double side = (double)q[k] - (double)p[k];
            extent = fmax(extent, fabs((double)p[k] - (double)ray->o[k]));
            along += side * (at[k] - (double)p[k]);
            square += side * side;
        }
        double s = fmin(fmax(along / square, 0), 1);
        for (int k = 0; k < 3; k++)
            off[k] = at[k] - ((double)p[k] + s * ((double)q[k] - (double)p[k]));
        nearest = fmin(nearest, length_of(off));
    }
    return nearest / (0x1p-24 * extent);
}

static void check_jitter(const char *name, const char *options, double jitter)
{
    char text[64];
    snprintf(text, sizeof text, "edges:jitter=%g%s", jitter, options);
    bb_scene *scene = load_scene(name);
    bb_rays *rays = made(scene, text);
    uint32_t far = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double at[3], steps = INFINITY;
        target_of(rays, i, at);
        for (uint32_t t = 0; t < scene->prims[BB_TRIANGLE].count; t++)
            steps = fmin(steps, steps_off(scene, t, &rays->rays[i], at));
        if (steps > jitter + 2) /* rounding the direction adds up to sqrt(3) */
            fail_msg("%s, %s, seed %llu: ray %u is off by %g", name, text, (unsigned long long)seed,
                     i, steps);
        far += steps > 0.25 * jitter;
    }
    /* The distance from an edge is that from its line in the plane across, less than what the
     * target was moved by. */
    if (jitter > 0 && far < COUNT / 4)
        fail_msg("%s, %s, seed %llu: %u of %u rays are off", name, text, (unsigned long long)seed,
                 far, COUNT);
    bb_rays_free(rays);
    bb_scene_free(scene);
}

static void test_jitter(void **state)
{
    (void)state;
    static const char *const scenes[] = {"cube", "corridor:strips=2,length=100,turn=1",
                                         "boards:n=5"};
    static const double jitters[] = {0, 4, 64};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            check_jitter(scenes[i], "", jitters[k]);
            check_jitter(scenes[i], ",from=around", jitters[k]);
        }
}

/* Off the edge as well, whatever is aimed at from inside is hit. */
static void test_inside_must_hit(void **state)
{
    (void)state;
    static const char *const scenes[] = {"corridor", "corridor:turn=3,length=1e5,inside=end",
                                         "slivers:aspect=40", "scales:from=-2,to=2,n=1"};
    static const char *const rays_of[] = {"edges", "edges:jitter=4", "edges:jitter=64"};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            bb_scene *scene = load_scene(scenes[i]);
            bb_rays *rays = made(scene, rays_of[k]);
            assert_true(rays->must_hit);
            for (uint32_t r = 0; r < COUNT; r++) {
                double at;
                bool hit = false;
                for (uint32_t t = 0; t < scene->prims[BB_TRIANGLE].count && !hit; t++)
                    hit = bb_exact_first(scene, &rays->rays[r], t, &at);
                if (!hit)
                    fail_msg("%s, %s, seed %llu: ray %u misses", scenes[i], rays_of[k],
                             (unsigned long long)seed, r);
            }
            bb_rays_free(rays);
            bb_scene_free(scene);
        }
}

/* ---- origins ---- */

/* Half at an eye, the others within a hundredth of its distance to what it looks at. */
static void check_eyes(const bb_scene *scene, const bb_rays *rays)
{
    uint32_t at_eye = 0, seen[BB_VIEWS_MAX] = {0};
    for (uint32_t i = 0; i < COUNT; i++) {
        bool near = false, same = false;
        for (uint32_t v = 0; v < scene->view_count; v++) {
            const bb_view *view = &scene->views[v];
            double off[3], ahead[3];
            for (int k = 0; k < 3; k++) {
                off[k] = (double)rays->rays[i].o[k] - (double)(float)view->eye[k];
                ahead[k] = view->target[k] - view->eye[k];
            }
            bool here = length_of(off) <= 0.0101 * length_of(ahead);
            near |= here;
            same |= length_of(off) == 0;
            seen[v] += here;
        }
        assert_true(near);
        at_eye += same;
    }
    assert_true(at_eye >= COUNT / 2 && at_eye < COUNT * 0.51);
    for (uint32_t v = 0; v < scene->view_count; v++)
        assert_true(seen[v] > COUNT / (2 * scene->view_count));
}

/* In the box grown by a tenth of its longest side: not all of them in the box itself. */
static void check_around(const bb_scene *scene, const bb_rays *rays)
{
    double side = 0;
    uint32_t outside = 0;
    for (int k = 0; k < 3; k++)
        side = fmax(side, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    for (uint32_t i = 0; i < COUNT; i++) {
        bool out = false;
        for (int k = 0; k < 3; k++) {
            double o = (double)rays->rays[i].o[k], slack = 1e-6 * side;
            double low = (double)scene->bounds.lo[k], high = (double)scene->bounds.hi[k];
            assert_true(o >= low - 0.1 * side - slack && o <= high + 0.1 * side + slack);
            out |= o < low || o > high;
        }
        outside += out;
    }
    assert_true(outside > COUNT / 4);
}

static void test_from(void **state)
{
    (void)state;
    static const char *const scenes[] = {"boards",          "boards:turn=2,scale=1e-15",
                                         "corridor:turn=1", "ground:reach=100",
                                         "single",          "scales:scale=1e15"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        bb_scene *scene = load_scene(scenes[i]);
        expect_same(scene, "edges",
                    scene->closed_from_inside ? "edges:from=inside" : "edges:from=eyes");
        bb_rays *rays = made(scene, "edges:from=eyes");
        assert_false(rays->must_hit);
        check_eyes(scene, rays);
        bb_rays_free(rays);
        rays = made(scene, "edges:from=around,jitter=8");
        assert_false(rays->must_hit);
        check_around(scene, rays);
        bb_rays_free(rays);
        bb_scene_free(scene);
    }
}

/* ---- targets ---- */

/* Two long triangles among 512 small ones get half of the rays; an eye that is close to a long edge
 * gets most of its targets close by. */
static void test_long_edges(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("ground:balls=0,reach=1e4");
    bb_rays *rays = made(scene, "edges:from=around");
    uint32_t on_ground = 0, near = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double at[3];
        target_of(rays, i, at);
        on_ground += fabs(at[0]) > 10 || fabs(at[2]) > 10;
    }
    assert_true(on_ground > 0.42 * COUNT && on_ground < 0.55 * COUNT);
    bb_rays_free(rays);
    bb_scene_free(scene);

    scene = load_scene("boards");
    rays = made(scene, "edges");
    for (uint32_t i = 0; i < COUNT; i++) {
        double at[3];
        target_of(rays, i, at);
        near += fabs(at[2]) < 20;
    }
    assert_true(near > COUNT / 3 && near < COUNT / 2);
    bb_rays_free(rays);
    bb_scene_free(scene);
}

static void test_seeds(void **state)
{
    (void)state;
    static const char *const texts[] = {"edges:jitter=2", "edges:from=eyes",
                                        "edges:from=around,jitter=1"};
    bb_scene *scene = load_scene("corridor");
    for (int i = 0; i < 3; i++) {
        bb_rays *one = NULL, *again = NULL, *other = NULL;
        assert_int_equal(make(scene, texts[i], seed, &one), BB_OK);
        assert_int_equal(make(scene, texts[i], seed, &again), BB_OK);
        assert_int_equal(make(scene, texts[i], seed + 1, &other), BB_OK);
        assert_true(one->hash == again->hash && one->hash != other->hash);
        bb_rays_free(one);
        bb_rays_free(again);
        bb_rays_free(other);
    }
    bb_scene_free(scene);
}

/* ---- refusals ---- */

static void refuses(const bb_scene *scene, const char *text, bb_status status, const char *words)
{
    bb_rays *rays = NULL;
    bb_status got = make(scene, text, seed, &rays);
    if (got != status || rays != NULL || strstr(bb_message(), words) == NULL ||
        strchr(bb_message(), '\n') != NULL)
        fail_msg("%s, %s: status %d instead of %d: %s", scene->name, text, (int)got, (int)status,
                 bb_message());
}

static void test_refusals(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("boards:n=2");
    refuses(scene, "edges:jitter=65", BB_INVALID, "from 0 to 64");
    refuses(scene, "edges:jitter=-1", BB_INVALID, "from 0 to 64");
    refuses(scene, "edges:jitter=nan", BB_INVALID, "from 0 to 64");
    refuses(scene, "edges:from=above", BB_INVALID, "inside|eyes|around");
    refuses(scene, "edges:from=inside", BB_UNSUPPORTED, "from=eyes or from=around");
    scene->view_count = 0;
    refuses(scene, "edges", BB_UNSUPPORTED, "no views");
    for (uint32_t i = 0; i < 3 * scene->vertex_count; i++) /* a scene that is a point */
        scene->vertices[i] = 1;
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    bb_scene_derive_views(scene);
    refuses(scene, "edges:from=eyes", BB_UNSUPPORTED, "no edge");
    refuses(scene, "edges:from=around", BB_UNSUPPORTED, "no edge");
    scene->closed_from_inside = true;
    refuses(scene, "edges", BB_UNSUPPORTED, "do not resolve the inside");
    bb_scene_free(scene);
    scene = load_scene("spheres:n=10");
    refuses(scene, "edges", BB_UNSUPPORTED, "no triangles");
    refuses(scene, "edges:from=around", BB_UNSUPPORTED, "no triangles");
    bb_scene_free(scene);
}

int main(void)
{
    const char *given = getenv("BVHBENCH_TEST_SEED");
    seed = given != NULL ? strtoull(given, NULL, 10) : default_seed;
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_recorded),        cmocka_unit_test(test_jitter),
        cmocka_unit_test(test_inside_must_hit), cmocka_unit_test(test_from),
        cmocka_unit_test(test_long_edges),      cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests_name("rays_edges", tests, NULL, NULL);
}
