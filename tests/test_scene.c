/* Scenes: generators, finishing, views, the profile on cases solved by hand, and bad names. */
#include "tests/scene_files.h"

#include "framework/base/random.h"

#include <float.h>
#include <math.h>

static const char *path_of(const char *name)
{
    return test_path("scene", name);
}

/* ---- generators ---- */

/* Recorded once: the same seed must give the same scene on every machine and in every version. */
static const struct {
    const char *spec;
    uint32_t prims;
    uint64_t hash;
} recorded[] = {
    {"single", 1, 0xc916126e4290fb58u},
    {"cube", 12, 0x4cfa155a8a54976fu},
    {"sphere-mesh:n=8,radius=2", 512, 0x5be9547755328482u},
    {"random:n=1000,ratio=100,seed=7", 1000, 0xcaf3b1177d147e9eu},
    {"terrain:n=1000,seed=7", 968, 0x51197177dac57850u},
    {"hairball:n=1000,seed=7", 1000, 0x14b940a9b07c712au},
    {"interior:n=20000,seed=7", 18576, 0xc44d70f0a645f70du},
    {"city:n=10000,seed=7", 8014, 0x0ccaefbd6548836au},
    {"spheres:n=1000,seed=7", 1000, 0x5a5c5ec5b56a67f1u},
    {"spheres:n=1000,state=settled,seed=7", 1000, 0x4d23b6f1ec7cc68du},
};

static void test_recorded_hashes(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof recorded / sizeof recorded[0]; i++) {
        bb_scene *scene = load_scene(recorded[i].spec);
        if (scene->prim_count != recorded[i].prims || scene->hash != recorded[i].hash)
            fail_msg("%s: %u primitives, hash %016llx", recorded[i].spec, scene->prim_count,
                     (unsigned long long)scene->hash);
        assert_true(scene->view_count >= 3);
        bb_scene_free(scene);
    }
}

static void test_seeds_differ(void **state)
{
    (void)state;
    static const char *const specs[] = {"random:n=100",
                                        "terrain:n=100",
                                        "hairball:n=100",
                                        "interior:n=5000",
                                        "city:n=10000",
                                        "spheres:n=100",
                                        "spheres:n=100,state=settled"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        char spec[128];
        uint64_t hashes[2];
        for (int seed = 0; seed < 2; seed++) {
            snprintf(spec, sizeof spec, "%s,seed=%d", specs[i], seed);
            bb_scene *scene = load_scene(spec);
            hashes[seed] = scene->hash;
            bb_scene_free(scene);
        }
        assert_true(hashes[0] != hashes[1]);
    }
}

/* Closed, of radius 1 to a rounding, wound outwards, at any tessellation and place. */
static void test_sphere_mesh(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere-mesh:n=1", "sphere-mesh:n=2", "sphere-mesh:n=3",
                                        "sphere-mesh:n=33",
                                        "sphere-mesh:n=20,radius=1000,x=148376,y=1234,z=-223423"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        bb_scene *scene = load_scene(specs[i]);
        assert_int_equal(scene->profile.closed, 1);
        assert_true(scene->closed_from_inside);
        double radius = i < 4 ? 1 : 1000;
        double volume = 0;
        for (uint32_t t = 0; t < scene->prims[BB_TRIANGLE].count; t++) {
            double p[3][3];
            for (uint32_t k = 0; k < 3; k++) {
                double square = 0;
                for (int axis = 0; axis < 3; axis++) {
                    p[k][axis] =
                        (double)bb_scene_vertex(scene, t, k)[axis] - scene->inside_point[axis];
                    square += p[k][axis] * p[k][axis];
                }
                assert_true(fabs(sqrt(square) / radius - 1) < 1e-4);
            }
            double part = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                          p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                          p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
            assert_true(part > 0);
            volume += part / 6;
        }
        assert_true(volume > 0 && volume < 4.18879 * radius * radius * radius);
        bb_scene_free(scene);
    }
    expect_failure("sphere-mesh:radius=1,x=1e8", BB_INVALID, "take a larger radius");
}

static double edge(const bb_scene *scene, uint32_t triangle, uint32_t a, uint32_t b)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = (double)bb_scene_vertex(scene, triangle, a)[axis] -
                   (double)bb_scene_vertex(scene, triangle, b)[axis];
        square += d * d;
    }
    return sqrt(square);
}

static void test_size_ratio(void **state)
{
    (void)state;
    static const double ratios[] = {1, 10, 1000};
    for (int i = 0; i < 3; i++) {
        char spec[64];
        snprintf(spec, sizeof spec, "random:n=2000,ratio=%g,seed=3", ratios[i]);
        bb_scene *scene = load_scene(spec);
        double least = INFINITY, most = 0;
        for (uint32_t t = 0; t < scene->prims[BB_TRIANGLE].count; t++) {
            double a = edge(scene, t, 0, 1), b = edge(scene, t, 1, 2), c = edge(scene, t, 2, 0);
            assert_true(fabs(a / b - 1) < 2e-3 && fabs(a / c - 1) < 2e-3);
            least = fmin(least, a);
            most = fmax(most, a);
        }
        assert_true(fabs(most / least / ratios[i] - 1) < 2e-3);
        bb_scene_free(scene);
    }
}

static void test_mixtures(void **state)
{
    (void)state;
    bb_scene *initial = load_scene("spheres:n=20000");
    bb_scene *settled = load_scene("spheres:n=20000,state=settled");
    assert_int_equal(initial->kinds, BB_SPHERES);
    assert_true(initial->profile.overlap > 2);
    assert_true(initial->profile.size_max > 15 * initial->profile.size_min);
    assert_true(settled->profile.overlap < 0.05);
    assert_true(settled->profile.size_max > 3.5 * settled->profile.size_min);
    bb_scene_free(initial);
    bb_scene_free(settled);
    for (int n = 1; n < 40; n++) {
        char spec[64];
        snprintf(spec, sizeof spec, "spheres:state=settled,n=%d", n);
        bb_scene *scene = load_scene(spec);
        assert_int_equal(scene->prims[BB_SPHERE].count, n);
        bb_scene_free(scene);
    }
}

static void test_interior_is_closed(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("interior:n=50000");
    assert_int_equal(scene->profile.closed, 1);
    assert_true(scene->profile.size_max > 1000 * scene->profile.size_min);
    assert_true(fabs(scene->prim_count / 50000.0 - 1) < 0.2);
    bb_scene_free(scene);
}

/* ---- finishing, by hand ---- */

static bb_scene *make_scene(const float *triangles, uint32_t triangle_count, const float *spheres,
                            uint32_t sphere_count)
{
    bb_scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    strcpy(scene->name, "by-hand");
    const bb_prim_counts counts = {
        .of = {[BB_TRIANGLE] = triangle_count, [BB_SPHERE] = sphere_count}};
    assert_int_equal(bb_scene_reserve(scene, 3 * triangle_count, &counts), BB_OK);
    if (triangle_count > 0)
        memcpy(scene->vertices, triangles, 36 * triangle_count);
    for (uint32_t i = 0; i < 3 * triangle_count; i++)
        bb_scene_indices(scene)[i] = i;
    if (sphere_count > 0)
        memcpy(bb_scene_floats(scene, BB_SPHERE), spheres, 16 * sphere_count);
    return scene;
}

/* A float, and no infinity, for whatever is accepted. */
static void test_scale_is_finite(void **state)
{
    (void)state;
    for (int e = -130; e <= 127; e++) {
        bb_scene *scene = NULL;
        assert_int_equal(bb_scene_load("cube", &scene), BB_OK);
        for (uint32_t i = 0; i < 3 * scene->vertex_count; i++)
            scene->vertices[i] = ldexpf(scene->vertices[i] > 0 ? 1.0f : -1.0f, e);
        bb_status status = bb_scene_finish(scene);
        assert_true(status == BB_INVALID || (isnormal(scene->scale) && scene->scale <= 0x1p120f));
        bb_scene_free(scene);
    }
}

static void expect_finish_failure(bb_scene *scene, const char *words)
{
    assert_int_equal(bb_scene_finish(scene), BB_INVALID);
    if (strstr(bb_message(), words) == NULL)
        fail_msg("'%s' is not in: %s", words, bb_message());
    bb_scene_free(scene);
}

static void test_finish(void **state)
{
    (void)state;
    static const float good[9] = {0, 1, 2, -3, 4, 5, 6, -7, 8};
    float bad[9];
    bb_scene *scene = make_scene(good, 1, NULL, 0);
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    static const float lo[3] = {-3, -7, 2}, hi[3] = {6, 4, 8};
    assert_memory_equal(scene->boxes[0].lo, lo, sizeof lo);
    assert_memory_equal(scene->bounds.hi, hi, sizeof hi);
    bb_scene_indices(scene)[2] = 3;
    expect_finish_failure(scene, "index 3 is beyond");

    for (int i = 0; i < 9; i++) {
        memcpy(bad, good, sizeof bad);
        bad[i] = i % 2 != 0 ? NAN : INFINITY;
        expect_finish_failure(make_scene(bad, 1, NULL, 0), "not finite");
    }
    expect_finish_failure(make_scene(NULL, 0, NULL, 0), "no primitive");
    memcpy(bad, good, sizeof bad);
    bad[0] = FLT_MAX;
    bad[3] = -FLT_MAX;
    expect_finish_failure(make_scene(bad, 1, NULL, 0), "too far");
    static const float spheres[][4] = {
        {0, 0, 0, -1}, {0, 0, NAN, 1}, {0, 0, 0, INFINITY}, {FLT_MAX, 0, 0, FLT_MAX}};
    for (int i = 0; i < 4; i++)
        expect_finish_failure(make_scene(NULL, 0, spheres[i], 1), "sphere 0");
}

/* The box holds the exact sphere and is no more than one float larger: differences of floats up to
 * 2^30 apart in size are exact in long double. */
static void test_sphere_boxes(void **state)
{
    (void)state;
    enum { SPHERES = 4096 };
    const uint64_t seed = 11;
    bb_random random = bb_random_make(seed, 0);
    float *spheres = malloc(SPHERES * 4 * sizeof *spheres);
    assert_non_null(spheres);
    for (int i = 0; i < SPHERES * 4; i++) {
        double scale = i % 4 == 3 ? 1 : bb_random_below(&random, 2) != 0 ? 1e6 : 1e-3;
        spheres[i] = (float)(bb_random_range(&random, i % 4 == 3 ? 0 : -1, 1) * scale);
    }
    bb_scene *scene = make_scene(NULL, 0, spheres, SPHERES);
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    for (int i = 0; i < SPHERES; i++)
        for (int axis = 0; axis < 3; axis++) {
            long double c = spheres[4 * i + axis], r = spheres[4 * i + 3];
            float lo = scene->boxes[i].lo[axis], hi = scene->boxes[i].hi[axis];
            if (!(lo <= c - r && nextafterf(lo, INFINITY) > c - r && hi >= c + r &&
                  nextafterf(hi, -INFINITY) < c + r))
                fail_msg("seed %llu, sphere %d: [%a, %a] is not tight", (unsigned long long)seed, i,
                         (double)lo, (double)hi);
        }
    bb_scene_free(scene);
    free(spheres);
    /* What a double cannot hold either: 1 - 2^-60. */
    static const float far[4] = {1, 1, 1, 0x1p-60f};
    scene = make_scene(NULL, 0, far, 1);
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    assert_true(scene->boxes[0].lo[0] == nextafterf(1, 0) &&
                scene->boxes[0].hi[0] == nextafterf(1, 2));
    bb_scene_free(scene);
}

static void test_reserve_refuses(void **state)
{
    (void)state;
    bb_scene scene = {.name = "huge"};
    const bb_prim_counts all = {.of = {UINT64_MAX, UINT64_MAX, UINT64_MAX}};
    const bb_prim_counts sum = {.of = {1u << 30, 1u << 30, 1}};
    const bb_prim_counts spheres = {.of = {[BB_SPHERE] = INT32_MAX}};
    assert_int_equal(bb_scene_reserve_mesh(&scene, 3, UINT64_C(1) << 31), BB_REFUSED);
    assert_int_equal(bb_scene_reserve(&scene, 3, &all), BB_REFUSED);
    assert_int_equal(bb_scene_reserve(&scene, 3, &sum), BB_REFUSED);
    assert_non_null(
        strstr(bb_message(), "3 vertices, 1073741824 triangles, 1073741824 spheres, 1 boxes are"));
    assert_int_equal(bb_scene_reserve_mesh(&scene, UINT64_C(1) << 32, 1), BB_REFUSED);
    assert_int_equal(bb_scene_reserve(&scene, 0, &spheres), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "bytes"));
}

/* ---- the profile ---- */

static void test_profile_cube(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("cube");
    const bb_profile *profile = &scene->profile;
    assert_true(profile->flatness == 1);
    assert_true(fabs(profile->size_median - sqrt(2)) < 1e-6 &&
                profile->size_min == profile->size_max);
    /* The two triangles of a side have one box, and each centroid lies in the other's. */
    assert_int_equal(profile->duplicate_boxes, 6);
    assert_int_equal(profile->duplicate_centroids, 6);
    assert_true(profile->overlap == 1);
    assert_int_equal(profile->closed, 1);
    assert_int_equal(profile->zero_area, 0);
    bb_scene_free(scene);
}

/* An open cube; and triangles of zero area of every kind. */
static void test_profile_open_and_flat(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("cube");
    scene->prims[BB_TRIANGLE].count = 11;
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    assert_int_equal(bb_scene_profile(scene), BB_OK);
    assert_int_equal(scene->profile.closed, 0);
    bb_scene_free(scene);
    static const float flat[][9] = {
        {0, 0, 0, 0, 0, 0, 0, 0, 0},           {1, 2, 3, 1, 2, 3, 4, 5, 6},
        {0, 0, 0, 1, 1, 1, 3, 3, 3},           {0.1f, 0, 0, 0.2f, 0, 0, 0.7f, 0, 0},
        {0, 0, 0, 1e-20f, 0, 0, 0, 1e-20f, 0}, {0, 0, 0, 1, 1, 1, 1, 1, 1.0000001f}};
    scene = make_scene(flat[0], 6, NULL, 0);
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    assert_int_equal(bb_scene_profile(scene), BB_OK);
    assert_int_equal(scene->profile.zero_area, 4); /* the last two are small or thin, not flat */
    bb_scene_free(scene);
}

/* Spheres of radius 0 on a line: which code separates them is known. */
static void expect_bits(const float *spheres, uint32_t count, uint32_t bits, uint32_t depth)
{
    bb_scene *scene = make_scene(NULL, 0, spheres, count);
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    assert_int_equal(bb_scene_profile(scene), BB_OK);
    assert_int_equal(scene->profile.code_bits, bits);
    assert_int_equal(scene->profile.octree_depth, depth);
    assert_int_equal(scene->profile.closed, -1);
    bb_scene_free(scene);
}

static void test_profile_codes(void **state)
{
    (void)state;
    /* On [0, 1] with a neighbour of 0 at distance 2^-k: k levels tell them apart, if a level has a
     * bit of this axis. */
    static const struct {
        float step;
        uint32_t bits, depth;
    } cases[] = {{0x1p-1f, 30, 2},   {0x1p-10f, 30, 10}, {0x1p-11f, 32, 11}, {0x1p-12f, 63, 12},
                 {0x1p-21f, 63, 21}, {0x1p-22f, 64, 21}, {0x1p-23f, 0, 21}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const float spheres[] = {0, 5, 5, 0, cases[i].step, 5, 5, 0, 1, 5, 5, 0};
        /* 1/2 and 1 share the upper half at the first level, hence depth 2. */
        expect_bits(spheres, 3, cases[i].bits, cases[i].depth);
    }
    /* All equal: nothing to separate. */
    static const float same[] = {1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0};
    expect_bits(same, 3, 30, 0);
}

/* The same estimates as by testing all pairs, within what sampling allows. */
static void test_profile_overlap(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("random:n=5000,ratio=200,seed=5");
    uint64_t pairs = 0;
    for (uint32_t i = 0; i < scene->prim_count; i++)
        for (uint32_t j = 0; j < scene->prim_count; j++) {
            bool inside = i != j;
            for (int axis = 0; axis < 3; axis++) {
                float c = 0.5f * scene->boxes[i].lo[axis] + 0.5f * scene->boxes[i].hi[axis];
                inside = inside && c >= scene->boxes[j].lo[axis] && c <= scene->boxes[j].hi[axis];
            }
            pairs += inside;
        }
    double exact = (double)pairs / scene->prim_count;
    if (fabs(scene->profile.overlap / exact - 1) > 0.1)
        fail_msg("overlap %g, exactly %g", scene->profile.overlap, exact);
    bb_scene_free(scene);
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The median against a sort, duplicates against pairs, on sizes with many ties. */
static void test_profile_counts(void **state)
{
    (void)state;
    enum { SPHERES = 777, ROUNDS = 20 };
    for (uint64_t seed = 0; seed < ROUNDS; seed++) {
        bb_random random = bb_random_make(seed, 0);
        float spheres[SPHERES][4], sizes[SPHERES];
        uint32_t range = 1 + bb_random_below(&random, 12), boxes = 0, centroids = 0;
        for (int i = 0; i < SPHERES; i++) {
            for (int k = 0; k < 4; k++)
                spheres[i][k] = (float)bb_random_below(&random, range);
            double side = 2 * (double)spheres[i][3];
            sizes[i] = (float)sqrt(3 * side * side);
            bool box = false, centroid = false;
            for (int j = 0; j < i; j++) {
                bool same = memcmp(spheres[i], spheres[j], 3 * sizeof(float)) == 0;
                centroid = centroid || same;
                box = box || (same && spheres[i][3] == spheres[j][3]);
            }
            boxes += box;
            centroids += centroid;
        }
        bb_scene *scene = make_scene(NULL, 0, spheres[0], SPHERES);
        assert_int_equal(bb_scene_finish(scene), BB_OK);
        assert_int_equal(bb_scene_profile(scene), BB_OK);
        qsort(sizes, SPHERES, sizeof sizes[0], compare_floats);
        if (scene->profile.size_median != (double)sizes[(SPHERES - 1) / 2] ||
            scene->profile.duplicate_boxes != boxes ||
            scene->profile.duplicate_centroids != centroids)
            fail_msg("seed %llu: median %g, boxes %u, centroids %u, expected %g, %u, %u",
                     (unsigned long long)seed, scene->profile.size_median,
                     scene->profile.duplicate_boxes, scene->profile.duplicate_centroids,
                     (double)sizes[(SPHERES - 1) / 2], boxes, centroids);
        bb_scene_free(scene);
    }
}

/* ---- views ---- */

/* A sample is some of the scene's triangles, where they were, and no vertex beside theirs. */
static void test_sample(void **state)
{
    (void)state;
    bb_scene *scene = NULL, *sample = NULL;
    assert_int_equal(bb_scene_load("sphere-mesh:n=60", &scene), BB_OK);
    const uint32_t all = scene->prims[BB_TRIANGLE].count, wanted = all / 7;
    assert_int_equal(bb_scene_sample(scene, wanted, &sample), BB_OK);
    const uint32_t count = sample->prims[BB_TRIANGLE].count;
    assert_int_equal(count, wanted);
    bool *used = calloc(sample->vertex_count, sizeof *used);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t from = (uint32_t)((uint64_t)i * all / count);
        for (int c = 0; c < 3; c++) {
            assert_memory_equal(bb_scene_vertex(sample, i, c), bb_scene_vertex(scene, from, c),
                                3 * sizeof(float));
            used[bb_scene_indices(sample)[3 * i + (uint32_t)c]] = true;
        }
    }
    for (uint32_t v = 0; v < sample->vertex_count; v++)
        assert_true(used[v]);
    assert_true(sample->vertex_count < scene->vertex_count);
    free(used);
    bb_scene_free(sample);
    bb_scene_free(scene);
}

static void test_views_read(void **state)
{
    (void)state;
    bb_view views[BB_VIEWS_MAX];
    uint32_t count;
    write_text(path_of("good.views"),
               "# two views\n\n a eye=0,0,5 target=0,0,0 up=0,1,0 fov=45 # near\n"
               "b\tup=0,0,1 parallel=2.5 target=1,2,3 eye=-1e1,2,3\r\n");
    assert_int_equal(bb_views_read(path_of("good.views"), views, BB_VIEWS_MAX, &count), BB_OK);
    assert_int_equal(count, 2);
    assert_string_equal(views[0].name, "a");
    assert_true(!views[0].parallel && views[0].fov_y == 45 && views[0].eye[2] == 5);
    assert_true(views[1].parallel && views[1].fov_y == 2.5 && views[1].eye[0] == -10);
    static const struct {
        const char *text;
        const char *words;
    } bad[] = {
        {"a eye=0,0,5 target=0,0,0 up=0,1,0\n", ":1: view 'a' needs fov="},
        {"#\na eye=0,0,5 target=0,0,0 fov=45\n", ":2: view 'a' needs eye="},
        {"a eye=0,0 target=0,0,0 up=0,1,0 fov=45\n", "'eye=0,0' is none of"},
        {"a eye=0,0,nan target=0,0,0 up=0,1,0 fov=45\n", "'eye=0,0,nan' is none of"},
        {"a eye=0,0,5 target=0,0,0 up=0,1,0 fov=180\n", "1 to 170"},
        {"a eye=0,0,5 target=0,0,0 up=0,1,0 parallel=0\n", "above 0"},
        {"a eye=0,0,5 target=0,0,0 up=0,1,0 fov=45 parallel=1\n", "one must go"},
        {"a eye=0,0,5 target=0,0,5 up=0,1,0 fov=45\n", "eye at its target"},
        {"a eye=0,0,5 target=0,0,0 up=0,0,-3 fov=45\n", "points along the view"},
        {"a eye=0,0,5 eye=0,0,6 target=0,0,0 up=0,1,0 fov=45\n", "eye= is given twice"},
        {"a eye=0,0,5 target=0,0,0 up=0,1,0 fov=45 roll=3\n", "'roll=3' is none of"},
        {"a eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\na eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\n",
         ":2: there is a view 'a' already"},
        {"eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\n", "no name"},
        {"# nothing\n", "has no view"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        write_text(path_of("bad.views"), bad[i].text);
        assert_int_equal(bb_views_read(path_of("bad.views"), views, BB_VIEWS_MAX, &count),
                         BB_INVALID);
        assert_int_equal(count, 0);
        if (strstr(bb_message(), bad[i].words) == NULL)
            fail_msg("'%s' is not in: %s", bad[i].words, bb_message());
    }
    write_text(path_of("many.views"), "a eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\n"
                                      "b eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\n");
    assert_int_equal(bb_views_read(path_of("many.views"), views, 1, &count), BB_INVALID);
    assert_int_equal(bb_views_read(path_of("none.views"), views, 1, &count), BB_INVALID);
}

/* Whatever the scene, the derived cameras are cameras, with names of their own, and twice the same.
 */
static void test_views_derived(void **state)
{
    (void)state;
    static const float point[9] = {3, 3, 3, 3, 3, 3, 3, 3, 3};
    static const float line[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    static const float huge[9] = {-1e38f, 0, 0, 1e38f, 0, 0, 0, 1e38f, 1e38f};
    static const float tiny[9] = {0, 0, 0, 1e-30f, 0, 0, 0, 1e-30f, 1e-30f};
    static const float *const triangles[] = {point, line, huge, tiny};
    for (int i = 0; i < 4; i++) {
        bb_scene *scene = make_scene(triangles[i], 1, NULL, 0);
        assert_int_equal(bb_scene_finish(scene), BB_OK);
        assert_int_equal(bb_scene_profile(scene), BB_OK);
        bb_scene_derive_views(scene);
        assert_true(scene->view_count >= 3);
        bb_view first[BB_VIEWS_MAX];
        memcpy(first, scene->views, sizeof first);
        uint32_t count = scene->view_count;
        bb_scene_derive_views(scene); /* has views: nothing happens */
        assert_int_equal(scene->view_count, count);
        scene->view_count = 0;
        bb_scene_derive_views(scene);
        assert_memory_equal(first, scene->views, sizeof first);
        for (uint32_t k = 0; k < count; k++) {
            double square = 0;
            for (int axis = 0; axis < 3; axis++) {
                double d = first[k].eye[axis] - first[k].target[axis];
                square += d * d;
            }
            assert_true(isfinite(square) && square > 0);
        }
        bb_scene_free(scene);
    }
}

/* A room with one hole is seen from inside; a heap of triangles from outside. */
static void test_views_inside_or_outside(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("interior:n=20000");
    scene->prims[BB_TRIANGLE].count--; /* the last one: now the mesh is open */
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    assert_int_equal(bb_scene_profile(scene), BB_OK);
    scene->view_count = 0;
    bb_scene_derive_views(scene);
    assert_int_equal(scene->view_count, 3);
    for (uint32_t k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            assert_true(scene->views[k].eye[axis] > (double)scene->bounds.lo[axis] &&
                        scene->views[k].eye[axis] < (double)scene->bounds.hi[axis]);
    bb_scene_free(scene);
    scene = load_scene("hairball:n=5000");
    assert_string_equal(scene->views[0].name, "three-quarter");
    bb_scene_free(scene);
}

/* ---- names ---- */

static void test_shipped(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t triangles, zero_area;
    } shipped[] = {{"coffee", 235265, 224}, {"mountain", 50562, 0}, {"scorpion", 99990, 0}};
    for (int i = 0; i < 3; i++) {
        bb_scene *scene = load_scene(shipped[i].name);
        assert_int_equal(scene->prims[BB_TRIANGLE].count, shipped[i].triangles);
        assert_int_equal(scene->profile.zero_area, shipped[i].zero_area);
        assert_true(scene->view_count >= 3);
        assert_string_equal(scene->name, shipped[i].name);
        bb_scene_free(scene);
    }
    expect_failure("coffee:n=3", BB_INVALID, "no option");
}

static void test_bad_names(void **state)
{
    (void)state;
    expect_failure("nonesuch", BB_INVALID, "one of coffee");
    expect_failure("", BB_INVALID, "no name");
    expect_failure("random:m=3", BB_INVALID, "n, ratio, seed");
    expect_failure("random:n=0", BB_INVALID, "from 1 to");
    expect_failure("random:n", BB_INVALID, "key=value");
    expect_failure("random:ratio=nan", BB_INVALID, "ratio");
    expect_failure("spheres:state=liquid", BB_INVALID, "initial|settled");
    expect_failure("random:n=2000000000", BB_REFUSED, "vertices");
    expect_failure("/no/such/file.glb", BB_INVALID, "no such file");
}

/* A file finds its own views, and bad ones are an error of the scene. */
static void test_views_beside(void **state)
{
    (void)state;
    write_text(path_of("own.gltf"),
               "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"componentType\":5126,\"count\":"
               "3,\"type\":"
               "\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
               "\"nodes\":[{\"mesh\":0}]}");
    write_text(path_of("own.views"), "mine eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\n");
    bb_scene *scene = load_scene(path_of("own.gltf"));
    assert_int_equal(scene->view_count, 1);
    assert_string_equal(scene->views[0].name, "mine");
    bb_scene_free(scene);
    write_text(path_of("own.views"), "mine\n");
    expect_failure(path_of("own.gltf"), BB_INVALID, "own.views:1");
    remove(path_of("own.views"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_recorded_hashes),
        cmocka_unit_test(test_scale_is_finite),
        cmocka_unit_test(test_seeds_differ),
        cmocka_unit_test(test_sphere_mesh),
        cmocka_unit_test(test_size_ratio),
        cmocka_unit_test(test_mixtures),
        cmocka_unit_test(test_interior_is_closed),
        cmocka_unit_test(test_finish),
        cmocka_unit_test(test_sphere_boxes),
        cmocka_unit_test(test_reserve_refuses),
        cmocka_unit_test(test_profile_cube),
        cmocka_unit_test(test_profile_open_and_flat),
        cmocka_unit_test(test_profile_codes),
        cmocka_unit_test(test_profile_overlap),
        cmocka_unit_test(test_profile_counts),
        cmocka_unit_test(test_sample),
        cmocka_unit_test(test_views_read),
        cmocka_unit_test(test_views_derived),
        cmocka_unit_test(test_views_inside_or_outside),
        cmocka_unit_test(test_shipped),
        cmocka_unit_test(test_bad_names),
        cmocka_unit_test(test_views_beside),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
