/* The scenes that hunt for lost rays: watertight in floats whatever their turn and scale, closed
 * where they say so, exactly scaled, and in sight of their views. */
#include "tests/scene_files.h"

#include "framework/base/random.h"
#include "framework/scene/camera.h"

#include <math.h>

static const uint64_t default_seed = 20;
static uint64_t seed;

/* ---- edges, told by the floats of their ends ---- */

typedef struct edge {
    float ends[2][3];
} edge;

static int compare_edges(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(edge));
}

/* How many edges belong to one triangle, to two, to more. */
typedef struct tally {
    uint32_t one, two, more;
} tally;

static tally count_edges(const bb_scene *scene)
{
    size_t count = 3 * (size_t)scene->prims[BB_TRIANGLE].count;
    edge *edges = malloc(count * sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < count; i++) {
        uint32_t triangle = (uint32_t)(i / 3), corner = (uint32_t)(i % 3);
        float ends[2][3];
        memcpy(ends[0], bb_scene_vertex(scene, triangle, corner), sizeof ends[0]);
        memcpy(ends[1], bb_scene_vertex(scene, triangle, (corner + 1) % 3), sizeof ends[1]);
        int swap = memcmp(ends[0], ends[1], sizeof ends[0]) > 0;
        memcpy(edges[i].ends[0], ends[swap], sizeof ends[0]);
        memcpy(edges[i].ends[1], ends[!swap], sizeof ends[0]);
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    tally out = {0};
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i + 1; next < count && compare_edges(&edges[i], &edges[next]) == 0;)
            next++;
        if (next - i > 2)
            out.more++;
        else
            *(next - i == 2 ? &out.two : &out.one) += 1;
    }
    free(edges);
    return out;
}

/* ---- rays in doubles, by brute force ---- */

static void subtract(const float a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k] - b[k];
}

static double triple(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static bool hits_triangle(const bb_scene *scene, uint32_t triangle, const double o[3],
                          const double d[3])
{
    double p[3][3];
    for (uint32_t k = 0; k < 3; k++)
        subtract(bb_scene_vertex(scene, triangle, k), o, p[k]);
    double u = triple(d, p[0], p[1]), v = triple(d, p[1], p[2]), w = triple(d, p[2], p[0]);
    if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)))
        return false;
    double volume = triple(p[0], p[1], p[2]); /* has the sign of the others where it is ahead */
    return volume != 0 && (volume > 0) == (u + v + w > 0);
}

static bool hits_sphere(const float sphere[4], const double o[3], const double d[3])
{
    double to[3], along = 0, square = 0, length = 0;
    subtract(sphere, o, to);
    for (int k = 0; k < 3; k++) {
        along += to[k] * d[k];
        square += to[k] * to[k];
        length += d[k] * d[k];
    }
    double radius = (double)sphere[3];
    return along > 0 && square - along * along / length <= radius * radius;
}

static uint32_t count_hits(const bb_scene *scene, const double o[3], const double d[3])
{
    uint32_t hits = 0;
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++)
        hits += hits_triangle(scene, i, o, d);
    for (uint32_t i = 0; i < scene->prims[BB_SPHERE].count; i++)
        hits += hits_sphere(bb_scene_floats(scene, BB_SPHERE) + 4 * (size_t)i, o, d);
    return hits;
}

/* ---- all of them, wherever they stand ---- */

/* Counts as asked for; edges with one side and with two (none has more). */
typedef struct hunted {
    const char *spec;
    uint32_t triangles, spheres;
    uint32_t open, shared;
    uint64_t hash;
} hunted;

static const hunted hunting[] = {
    {"boards", 80, 0, 82, 79, 0x6aa24b51466ef970u},
    {"boards:n=7,width=0.3,length=1e6,distance=1", 14, 0, 16, 13, 0xe1313702452a260bu},
    {"blinds", 320, 0, 328, 316, 0xf4c7974b8f6b7bd7u},
    {"blinds:layers=2,n=9,open=0.5,tilt=0.2,length=100", 36, 0, 72, 18, 0x8642f0257914877au},
    {"corridor", 128, 0, 0, 192, 0x01257757fd5c619cu},
    {"corridor:length=1e6,width=1,strips=5,inside=end", 80, 0, 0, 120, 0xa718ce5457c643d3u},
    {"slivers:aspect=50", 600, 0, 0, 900, 0x679f5539378a1f34u},
    {"slivers:aspect=1", 12, 0, 0, 18, 0xd299244136548aa0u},
    {"scales", 992, 0, 0, 1488, 0xcc96fb269ee75d92u},
    {"scales:from=-3,to=-3,n=4", 128, 0, 0, 192, 0x955fb7de96ba66ffu},
    {"ground:reach=1e5,stones=5,balls=3", 162, 3, 4, 241, 0x880d88b0561667b0u},
    {"ground:cuts=3,stones=0,balls=2,reach=50", 18, 2, 12, 21, 0x2314a57bf7f3cf22u},
    {"ladder", 17, 0, 51, 0, 0xecabfff2453f7cc5u},
};
enum { HUNTING = sizeof hunting / sizeof hunting[0] };

/* The spec with more options. Valid until the next call. */
static const char *with(const char *spec, const char *options)
{
    static char text[256];
    snprintf(text, sizeof text, "%s%c%s", spec, strchr(spec, ':') != NULL ? ',' : ':', options);
    return text;
}

static void check_inside(const bb_scene *scene, bb_random *random)
{
    for (int i = 0; i < 8; i++) {
        double d[3];
        bb_random_direction(random, d);
        uint32_t hits = count_hits(scene, scene->inside_point, d);
        if (hits % 2 != 1)
            fail_msg("%s, seed %llu: %u hits from inside along (%a %a %a)", scene->name,
                     (unsigned long long)seed, hits, d[0], d[1], d[2]);
    }
}

/* A quarter of the rays of each view meet something, and all if the view is from inside. */
static void check_views(const bb_scene *scene)
{
    enum { SIDE = 8 };
    assert_true(scene->view_count >= 2);
    for (uint32_t v = 0; v < scene->view_count; v++) {
        bb_camera camera;
        uint32_t met = 0;
        assert_int_equal(bb_camera_make(&scene->views[v], SIDE, SIDE, &camera), BB_OK);
        for (uint32_t i = 0; i < SIDE * SIDE; i++) {
            bb_ray ray;
            bb_camera_ray(&camera, i % SIDE, i / SIDE, &ray);
            double o[3], d[3];
            for (int k = 0; k < 3; k++) {
                o[k] = (double)ray.o[k];
                d[k] = (double)ray.d[k];
                assert_true(isfinite(o[k]) && isfinite(d[k]));
            }
            met += count_hits(scene, o, d) > 0;
        }
        bool inside = scene->closed_from_inside && strcmp(scene->views[v].name, "outside") != 0;
        if (met < (inside ? SIDE * SIDE : SIDE * SIDE / 4))
            fail_msg("%s: view %s meets the scene with %u rays of %d", scene->name,
                     scene->views[v].name, met, SIDE * SIDE);
    }
}

static void test_watertight_everywhere(void **state)
{
    (void)state;
    static const char *const places[] = {"turn=0",
                                         "turn=1",
                                         "turn=2,scale=0.37",
                                         "turn=3,scale=1e-15",
                                         "turn=18446744073709551615,scale=1e15",
                                         "scale=1e-15",
                                         "scale=1e15"};
    bb_random random = bb_random_make(seed, 1);
    for (size_t i = 0; i < HUNTING; i++)
        for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
            const hunted *want = &hunting[i];
            bb_scene *scene = load_scene(with(want->spec, places[k]));
            tally edges = count_edges(scene);
            if (scene->prims[BB_TRIANGLE].count != want->triangles ||
                scene->prims[BB_SPHERE].count != want->spheres || edges.one != want->open ||
                edges.two != want->shared || edges.more != 0)
                fail_msg(
                    "%s: %u triangles, %u spheres, edges %u of one side, %u of two, %u of more",
                    scene->name, scene->prims[BB_TRIANGLE].count, scene->prims[BB_SPHERE].count,
                    edges.one, edges.two, edges.more);
            assert_int_equal(scene->closed_from_inside, want->open == 0);
            assert_int_equal(scene->profile.zero_area, 0);
            if (scene->closed_from_inside)
                check_inside(scene, &random);
            check_views(scene);
            bb_scene_free(scene);
        }
}

/* Recorded once: the same on every machine and in every version. */
static void test_recorded_hashes(void **state)
{
    (void)state;
    bool same = true;
    for (size_t i = 0; i < HUNTING; i++) {
        bb_scene *scene = load_scene(with(hunting[i].spec, "turn=5"));
        if (scene->hash != hunting[i].hash)
            print_error("%s: hash 0x%016llxu\n", scene->name, (unsigned long long)scene->hash);
        same = same && scene->hash == hunting[i].hash;
        bb_scene_free(scene);
    }
    assert_true(same);
}

/* ---- scale and turn ---- */

static void expect_scaled(const float *base, const float *scaled, size_t count, float factor)
{
    for (size_t i = 0; i < count; i++) {
        float expected = base[i] * factor; /* exact: a power of two */
        assert_memory_equal(&scaled[i], &expected, sizeof expected);
    }
}

static void test_powers_of_two_scale_exactly(void **state)
{
    (void)state;
    for (size_t i = 0; i < HUNTING; i++)
        for (int turned = 0; turned < 2; turned++) {
            bb_scene *base = load_scene(with(hunting[i].spec, turned ? "turn=9" : "turn=0"));
            bb_scene *scaled = load_scene(
                with(hunting[i].spec, turned ? "scale=0.0009765625,turn=9" : "scale=1048576"));
            float factor = turned ? 0x1p-10f : 0x1p20f;
            expect_scaled(base->vertices, scaled->vertices, 3 * (size_t)base->vertex_count, factor);
            expect_scaled(bb_scene_floats(base, BB_SPHERE), bb_scene_floats(scaled, BB_SPHERE),
                          4 * (size_t)base->prims[BB_SPHERE].count, factor);
            for (int k = 0; k < 3; k++) {
                assert_true(base->inside_point[k] * (double)factor == scaled->inside_point[k]);
                for (uint32_t v = 0; v < base->view_count; v++) {
                    const bb_view *from = &base->views[v], *to = &scaled->views[v];
                    assert_true(from->eye[k] * (double)factor == to->eye[k] &&
                                from->target[k] * (double)factor == to->target[k] &&
                                from->up[k] == to->up[k] && from->fov_y == to->fov_y);
                }
            }
            bb_scene_free(base);
            bb_scene_free(scaled);
        }
}

static double distance(const float *a, const float *b)
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(square);
}

/* A turn keeps distances and handedness, but not the directions; two turns are different. */
static void test_turns_are_rotations(void **state)
{
    (void)state;
    bb_scene *as_it_is = load_scene("slivers:aspect=3"), *turned[4];
    for (int i = 0; i < 4; i++) {
        char spec[64];
        snprintf(spec, sizeof spec, "slivers:aspect=3,turn=%d", i + 1);
        turned[i] = load_scene(spec);
        const float *a = as_it_is->vertices, *b = turned[i]->vertices;
        for (size_t p = 0; p < as_it_is->vertex_count; p++)
            for (size_t q = 0; q < p; q++)
                assert_true(fabs(distance(a + 3 * p, a + 3 * q) - distance(b + 3 * p, b + 3 * q)) <
                            1e-6);
        double volume = 0;
        for (uint32_t t = 0; t < turned[i]->prims[BB_TRIANGLE].count; t++) {
            double corner[3][3];
            for (uint32_t k = 0; k < 3; k++)
                subtract(bb_scene_vertex(turned[i], t, k), turned[i]->inside_point, corner[k]);
            double part = triple(corner[0], corner[1], corner[2]);
            assert_true(part > 0); /* wound to be seen from outside */
            volume += part / 6;
        }
        assert_true(fabs(volume - 1) < 1e-5);
        for (int k = 0; k <= i; k++)
            assert_true(distance(k < i ? turned[k]->vertices : a, b) > 0.01);
    }
    for (int i = 0; i < 4; i++)
        bb_scene_free(turned[i]);
    bb_scene_free(as_it_is);
}

/* ---- what each is there for ---- */

static void test_slivers_are_slivers(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("slivers:aspect=200");
    for (uint32_t t = 0; t < scene->prims[BB_TRIANGLE].count; t++) {
        const float *a = bb_scene_vertex(scene, t, 0), *b = bb_scene_vertex(scene, t, 1),
                    *c = bb_scene_vertex(scene, t, 2);
        double sides[3] = {distance(a, b), distance(b, c), distance(c, a)};
        double longest = fmax(sides[0], fmax(sides[1], sides[2]));
        double p[2][3], from[3] = {(double)a[0], (double)a[1], (double)a[2]}, square = 0;
        subtract(b, from, p[0]);
        subtract(c, from, p[1]);
        for (int k = 0; k < 3; k++) {
            double n =
                p[0][(k + 1) % 3] * p[1][(k + 2) % 3] - p[0][(k + 2) % 3] * p[1][(k + 1) % 3];
            square += n * n;
        }
        assert_true(longest * longest / sqrt(square) > 200 * 0.999);
        for (uint32_t side = 0; side < 3; side++) { /* none is parallel to an axis */
            int equal = 0;
            for (uint32_t k = 0; k < 3; k++)
                equal += bb_scene_vertex(scene, t, side)[k] ==
                         bb_scene_vertex(scene, t, (side + 1) % 3)[k];
            assert_true(equal < 2);
        }
    }
    bb_scene_free(scene);
}

/* Half of a corridor lies before an eye in its middle, all of it before one at its end. */
static void test_corridor(void **state)
{
    (void)state;
    bb_scene *middle = load_scene("corridor:length=5000"), *end = load_scene("corridor:inside=end");
    assert_true(middle->inside_point[2] == 0 && end->inside_point[2] == -498);
    assert_true(middle->bounds.hi[2] == 2500 && end->bounds.hi[2] == 500);
    assert_true(end->views[0].eye[2] == -498 && end->views[0].target[2] > -498);
    bb_scene_free(middle);
    bb_scene_free(end);
}

/* One shell per decade, of that radius. */
static void test_scales(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("scales:turn=2");
    static const float origin[3] = {0, 0, 0};
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        int decade = (int)(i / 18) - 15;
        assert_true(fabs(distance(scene->vertices + 3 * i, origin) / pow(10, decade) - 1) < 1e-6);
    }
    bb_scene_free(scene);
}

static void test_ground(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("ground:balls=30,stones=30");
    assert_true(scene->bounds.lo[0] == -1e6f && scene->bounds.hi[2] == 1e6f);
    assert_true(scene->bounds.lo[1] == 0 && scene->bounds.hi[1] < 0.81f);
    for (uint32_t i = 0; i < scene->prims[BB_SPHERE].count; i++) {
        const float *sphere = bb_scene_floats(scene, BB_SPHERE) + 4 * (size_t)i;
        assert_true(sphere[3] == 0.4f && sphere[1] == 0.4f);
        assert_true(fabsf(sphere[0]) < 4 && fabsf(sphere[2]) < 4);
        for (uint32_t k = 0; k < i; k++)
            assert_true(distance(sphere, bb_scene_floats(scene, BB_SPHERE) + 4 * (size_t)k) > 0.79);
    }
    bb_scene *other = load_scene("ground:balls=30,stones=30,seed=2");
    assert_true(scene->hash != other->hash);
    bb_scene_free(scene);
    bb_scene_free(other);
}

/* Before it is finished: the generator's own floats. */
static bb_scene *generate(const char *text)
{
    bb_spec spec;
    const bb_generator *const *g = bb_generators;
    assert_int_equal(bb_spec_parse(text, &spec), BB_OK);
    while (strcmp((*g)->name, spec.name) != 0)
        g++;
    bb_scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    assert_int_equal((*g)->make(&spec, (*g)->options, scene), BB_OK);
    return scene;
}

/* On each axis many triangles end at corners of both 0 and -0, and so does the whole on x and y. */
static void test_zeros_of_both_signs(void **state)
{
    (void)state;
    enum { TRIANGLES = 1000 };
    bb_scene *scene = generate("awkward:kind=zeros,n=1000");
    assert_int_equal(scene->prims[BB_TRIANGLE].count, TRIANGLES);
    for (uint32_t axis = 0; axis < 3; axis++) {
        uint32_t both = 0, ends = 0, above = 0, below = 0;
        for (uint32_t t = 0; t < TRIANGLES; t++) {
            uint32_t plus = 0, minus = 0;
            float low = INFINITY, high = -INFINITY;
            for (uint32_t c = 0; c < 3; c++) {
                float x = bb_scene_vertex(scene, t, c)[axis];
                plus += x == 0 && !signbit(x);
                minus += x == 0 && signbit(x);
                low = fminf(low, x);
                high = fmaxf(high, x);
            }
            both += plus > 0 && minus > 0;
            ends += plus + minus > 0 && (low == 0 || high == 0);
            above += high > 0;
            below += low < 0;
        }
        assert_true(both > TRIANGLES / 10 && ends > TRIANGLES / 2);
        assert_true((above > TRIANGLES / 4) == (axis != 1));
        assert_true((below > TRIANGLES / 4) == (axis != 0));
        assert_true((above == 0) == (axis == 1) && (below == 0) == (axis == 0));
    }
    bb_scene_free(scene);
}

static void test_bad_parameters(void **state)
{
    (void)state;
    static const struct {
        const char *spec, *words;
    } bad[] = {
        {"boards:n=0", "'n' is '0'"},
        {"boards:width=0", "'width' is '0'"},
        {"boards:length=-1", "'length' is '-1'"},
        {"boards:length=1e6,distance=0.5", "more than 1e6"},
        {"boards:scale=1e-16", "'scale' is '1e-16'"},
        {"boards:scale=nan", "'scale' is 'nan'"},
        {"boards:turn=-1", "'turn' is '-1'"},
        {"boards:turn=1,width=0.01,length=1e6", "details of 0.01"},
        {"boards:height=3", "no option 'height'"},
        {"blinds:layers=0", "'layers' is '0'"},
        {"blinds:open=1", "'open' is '1'"},
        {"blinds:length=2e6", "more than 1e6"},
        {"blinds:turn=2,length=1e6,width=0.1,open=0.9", "details of 0.01"},
        {"corridor:length=1", "from 2 to 1e6"},
        {"corridor:length=3e6", "from 2 to 1e6"},
        {"corridor:strips=0", "'strips' is '0'"},
        {"corridor:inside=outside", "middle|end"},
        {"corridor:length=1e6,strips=100,turn=1", "details of 0.02"},
        {"slivers:aspect=0", "'aspect' is '0'"},
        {"slivers:aspect=2.5", "'aspect' is '2.5'"},
        {"scales:from=-16", "'from' is '-16'"},
        {"scales:to=0.5", "'to' is 0.5"},
        {"scales:from=3,to=2", "from=3 is above to=2"},
        {"ground:reach=0", "'reach' is '0'"},
        {"ground:reach=1e8,turn=1", "details of 0.4"},
        {"ground:cuts=0", "'cuts' is '0'"},
        {"awkward:kind=ones", "zeros"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        expect_failure(bad[i].spec, BB_INVALID, bad[i].words);
}

int main(void)
{
    const char *given = getenv("BVHBENCH_TEST_SEED");
    seed = given != NULL ? strtoull(given, NULL, 10) : default_seed;
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_watertight_everywhere),
        cmocka_unit_test(test_recorded_hashes),
        cmocka_unit_test(test_powers_of_two_scale_exactly),
        cmocka_unit_test(test_turns_are_rotations),
        cmocka_unit_test(test_slivers_are_slivers),
        cmocka_unit_test(test_corridor),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_ground),
        cmocka_unit_test(test_zeros_of_both_signs),
        cmocka_unit_test(test_bad_parameters),
    };
    return cmocka_run_group_tests_name("hunting_scenes", tests, NULL, NULL);
}
