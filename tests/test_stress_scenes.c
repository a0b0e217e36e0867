/* What the axes of `stress` are made of: each parameter of the generators `soup` and `nests` does
 * what it says and leaves all else, and so do the rays `axial` and `grazing`. */
#include "tests/scene_files.h"

#include "framework/workload/workload.h"

#include <math.h>

enum { N = 1000, COUNT = 4096 };

static float least(const bb_scene *scene, uint32_t triangle, int axis)
{
    return scene->boxes[triangle].lo[axis];
}

static bool is_copy(const bb_scene *scene, uint32_t a, uint32_t b)
{
    return memcmp(bb_scene_vertex(scene, a, 0), bb_scene_vertex(scene, b, 0), 36) == 0;
}

static double side(const bb_box *box, int axis)
{
    return (double)box->hi[axis] - (double)box->lo[axis];
}

static double distance(const float *a, const float *b)
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += ((double)a[k] - b[k]) * ((double)a[k] - b[k]);
    return sqrt(square);
}

static void soups_repeat(void **state)
{
    (void)state;
    bb_scene *a = load_scene("soup:n=1000"), *b = load_scene("soup:n=1000,seed=1"),
             *c = load_scene("soup:n=1000,seed=2");
    assert_true(a->hash == b->hash && a->hash != c->hash);
    assert_int_equal(a->prim_count, N);
    assert_int_equal(a->profile.zero_area, 0);
    assert_int_equal(a->profile.duplicate_centroids, 0);
    bb_scene_free(a);
    bb_scene_free(b);
    bb_scene_free(c);
}

static void soups_have_shapes(void **state)
{
    (void)state;
    const double aspects[] = {1, 100, 1e4};
    for (size_t i = 0; i < 3; i++) {
        char name[96];
        snprintf(name, sizeof name, "soup:n=1000,edge=3,aspect=%g", aspects[i]);
        bb_scene *scene = load_scene(name);
        for (uint32_t t = 0; t < N; t++) {
            const float *a = bb_scene_vertex(scene, t, 0), *b = bb_scene_vertex(scene, t, 1),
                        *c = bb_scene_vertex(scene, t, 2);
            double edge = distance(a, b), u[3], v[3], square = 0;
            for (int k = 0; k < 3; k++) {
                u[k] = (double)b[k] - a[k];
                v[k] = (double)c[k] - a[k];
            }
            for (int k = 0; k < 3; k++) {
                double n = u[k] * v[(k + 1) % 3] - u[(k + 1) % 3] * v[k];
                square += n * n;
            }
            double height = sqrt(square) / edge;
            double expected = aspects[i] == 1 ? sqrt(0.75) : 1 / aspects[i];
            ASSERT_NEAR(edge, 0.3, 1e-6); /* 3 mean distances of a tenth */
            ASSERT_NEAR(height / edge, expected, 1e-6);
        }
        bb_scene_free(scene);
    }
    bb_scene *axis = load_scene("soup:n=1000,aspect=1e9,along=axis"),
             *diagonal = load_scene("soup:n=1000,aspect=1e9,along=diagonal");
    for (uint32_t t = 0; t < N; t++) {
        double most = fmax(side(&axis->boxes[t], 0),
                           fmax(side(&axis->boxes[t], 1), side(&axis->boxes[t], 2)));
        double sum = side(&axis->boxes[t], 0) + side(&axis->boxes[t], 1) + side(&axis->boxes[t], 2);
        assert_true(sum < 1.001 * most);
        for (int k = 0; k < 3; k++)
            ASSERT_NEAR(side(&diagonal->boxes[t], k), 0.1 / sqrt(3), 1e-6);
    }
    bb_scene_free(axis);
    bb_scene_free(diagonal);
}

static void soups_have_places(void **state)
{
    (void)state;
    bb_scene *flat = load_scene("soup:n=1000,flat=0"), *thin = load_scene("soup:n=1000,flat=1e-3"),
             *full = load_scene("soup:n=1000"), *moved = load_scene("soup:n=1000,move=100"),
             *scaled = load_scene("soup:n=1000,scale=4"),
             *layer = load_scene("soup:n=1000,layer=1e-3");
    assert_true(flat->profile.flatness == 0);
    for (uint32_t t = 0; t < N; t++)
        for (int k = 0; k < 3; k++) {
            ASSERT_NEAR(least(thin, t, k), least(full, t, k) * (k == 2 ? 1e-3 : 1), 1e-7);
            ASSERT_NEAR(least(moved, t, k), least(full, t, k) + 100, 1e-5);
            assert_true(least(scaled, t, k) == 4 * least(full, t, k));
            ASSERT_NEAR(side(&layer->boxes[t], k), side(&full->boxes[t], k), 1e-6);
            if (k == 2)
                assert_true(fabs(least(layer, t, k) + side(&layer->boxes[t], k) / 2) < 0.06);
            else
                assert_true(least(layer, t, k) == least(full, t, k));
        }
    bb_scene_free(flat);
    bb_scene_free(thin);
    bb_scene_free(full);
    bb_scene_free(moved);
    bb_scene_free(scaled);
    bb_scene_free(layer);
}

/* Things with another place in frame 1 than in frame 0; `things` of 8 triangles each. */
static uint32_t moved_things(const char *name, uint32_t things)
{
    bb_scene *scene = load_scene(name);
    uint32_t moved = 0;
    bb_box *before = calloc(scene->prim_count, sizeof *before);
    assert_non_null(before);
    assert_int_equal(scene->prim_count, 8 * things);
    memcpy(before, scene->boxes, scene->prim_count * sizeof *before);
    ASSERT_OK(bb_scene_set_frame(scene, 1, NULL));
    for (uint32_t t = 0; t < things; t++)
        moved += memcmp(&before[8 * t], &scene->boxes[8 * t], sizeof *before) != 0;
    free(before);
    bb_scene_free(scene);
    return moved;
}

static void crowds_have_a_share(void **state)
{
    (void)state;
    assert_int_equal(moved_things("crowd:kind=shuffle,n=8000,share=0", 1000), 0);
    const uint32_t few = moved_things("crowd:kind=shuffle,n=8000,share=0.02", 1000),
                   by_default = moved_things("crowd:kind=shuffle,n=8000", 1000),
                   many = moved_things("crowd:kind=shuffle,n=8000,share=1", 1000);
    assert_true(few > 30 && few <= 40); /* 20 pairs, of which few share a thing */
    assert_true(by_default > 16 && by_default <= 22);
    assert_true(many > 800);
    static const struct {
        const char *name;
        uint32_t triangles;
    } growing[] = {
        {"crowd:kind=grow,n=8000,frames=3,share=0", 8000},
        {"crowd:kind=grow,n=8000,frames=3,share=0.1", 9600},
        {"crowd:kind=grow,n=8000,frames=3", 8176},
    };
    for (size_t i = 0; i < sizeof growing / sizeof growing[0]; i++) {
        bb_scene *scene = load_scene(growing[i].name);
        ASSERT_OK(bb_scene_set_frame(scene, 2, NULL));
        assert_int_equal(scene->prim_count, growing[i].triangles);
        bb_scene_free(scene);
    }
    bb_scene *none = NULL;
    assert_int_equal(bb_scene_load("crowd:kind=grow,n=8000,share=2", &none), BB_INVALID);
    assert_int_equal(bb_scene_load("crowd:kind=grow,n=2e8,frames=1e4,share=1", &none), BB_INVALID);
    assert_non_null(strstr(bb_message(), "things"));
}

static void soups_repeat_places(void **state)
{
    (void)state;
    bb_scene *copies = load_scene("soup:n=1000,copies=7"),
             *centred = load_scene("soup:n=1000,centred=1"),
             *half = load_scene("soup:n=1000,centred=0.5"),
             *sorted = load_scene("soup:n=1000,sorted=0.5"),
             *one = load_scene("soup:n=1000,cells=1,edge=0.001");
    for (uint32_t t = 0; t < N; t++)
        assert_true(is_copy(copies, t, t - t % 7));
    assert_int_equal(copies->profile.duplicate_boxes, N - (N + 6) / 7);
    assert_int_equal(centred->profile.duplicate_centroids, N - 1);
    assert_true(centred->profile.duplicate_boxes < 10);
    assert_true(half->profile.duplicate_centroids > 400 && half->profile.duplicate_centroids < 600);
    for (uint32_t t = 1; t < N / 2; t++)
        assert_true(bb_scene_vertex(sorted, t - 1, 0)[0] <= bb_scene_vertex(sorted, t, 0)[0]);
    uint32_t falls = 0;
    for (uint32_t t = N / 2 + 1; t < N; t++)
        falls += bb_scene_vertex(sorted, t - 1, 0)[0] > bb_scene_vertex(sorted, t, 0)[0];
    assert_true(falls > 100);
    for (int k = 0; k < 3; k++)
        assert_true(side(&one->bounds, k) < 0.001);
    bb_scene_free(copies);
    bb_scene_free(centred);
    bb_scene_free(half);
    bb_scene_free(sorted);
    bb_scene_free(one);
}

static void soups_are_refused(void **state)
{
    (void)state;
    const struct {
        const char *name, *words;
    } cases[] = {
        {"soup:n=10,nan=1", "triangle 0 has a vertex that is not finite"},
        {"soup:n=10,nan=11", "nan"},
        {"soup:n=10,flat=2", "flat"},
        {"soup:n=10,aspect=0", "aspect"},
        {"soup:n=10,edge=-1", "edge"},
        {"soup:n=10,edge=nan", "edge"},
        {"soup:n=10,copies=0", "copies"},
        {"soup:n=10,along=up", "along"},
        {"soup:n=10,scale=1e-45", "scale"},
        {"soup:n=0", "n"},
        {"nests:n=10,levels=11", "levels"},
        {"nests:n=10,levels=0", "levels"},
        {"nests:n=10,spread=2", "spread"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_scene *scene = NULL;
        if (bb_scene_load(cases[i].name, &scene) == BB_OK ||
            strstr(bb_message(), cases[i].words) == NULL)
            fail_msg("%s: %s", cases[i].name, bb_message());
        bb_scene_free(scene);
    }
}

static void nests_lie_within_each_other(void **state)
{
    (void)state;
    const char *const names[] = {"nests:n=1000,levels=50", "nests:n=1000,levels=50,spread=0"};
    for (int i = 0; i < 2; i++) {
        bb_scene *scene = load_scene(names[i]);
        assert_int_equal(scene->prim_count, N);
        for (uint32_t t = 1; t < N; t++) {
            const bb_box *outer = &scene->boxes[t - 1], *inner = &scene->boxes[t];
            for (int k = 0; k < 3 && t % 50 != 0; k++) {
                assert_true(outer->lo[k] <= inner->lo[k] && inner->hi[k] <= outer->hi[k]);
                ASSERT_NEAR((double)inner->lo[k] + inner->hi[k],
                            (double)outer->lo[k] + outer->hi[k], 1e-6);
            }
            if (i == 1)
                ASSERT_NEAR(side(inner, 0), side(inner, 1), 1e-6);
        }
        bb_scene_free(scene);
    }
}

/* ---- rays ---- */

static bb_rays *made(const bb_scene *scene, const char *text)
{
    bb_spec spec;
    bb_rays *rays = NULL;
    ASSERT_OK(bb_spec_parse(text, &spec));
    bb_rays_request request = {.spec = &spec, .max_rays = COUNT, .seed = 3};
    ASSERT_OK(bb_rays_make(scene, NULL, &request, &rays));
    assert_int_equal(rays->count, COUNT);
    return rays;
}

/* Is there a primitive whose box has this coordinate? */
static bool is_plane(const bb_scene *scene, int axis, float at)
{
    for (uint32_t i = 0; i < scene->prim_count; i++)
        if (scene->boxes[i].lo[axis] == at || scene->boxes[i].hi[axis] == at)
            return true;
    return false;
}

static void axial_rays_lie_in_planes(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("blocks:side=4,mixed=yes");
    bb_rays *rays = made(scene, "axial"), *tilted = made(scene, "axial:tilt=1e-3"),
            *again = made(scene, "axial:count=4096");
    uint32_t negative = 0, axes[3] = {0};
    assert_true(rays->hash == again->hash && rays->hash != tilted->hash);
    for (uint32_t i = 0; i < COUNT; i++) {
        const bb_ray *ray = &rays->rays[i];
        int along = fabsf(ray->d[0]) == 1 ? 0 : fabsf(ray->d[1]) == 1 ? 1 : 2;
        axes[along]++;
        assert_true(fabsf(ray->d[along]) == 1);
        bool before = ray->d[along] > 0 ? ray->o[along] < scene->bounds.lo[along]
                                        : ray->o[along] > scene->bounds.hi[along];
        assert_true(before);
        for (int k = 0; k < 3; k++) {
            if (k == along)
                continue;
            assert_true(ray->d[k] == 0);
            negative += signbit(ray->d[k]) != 0;
            assert_true(is_plane(scene, k, ray->o[k]));
            assert_true(fabsf(tilted->rays[i].d[k]) <= 1 && isfinite(tilted->rays[i].o[k]));
        }
    }
    assert_true(negative > COUNT / 2 && negative < 3 * COUNT / 2);
    assert_true(axes[0] > COUNT / 4 && axes[1] > COUNT / 4 && axes[2] > COUNT / 4);
    bb_rays_free(rays);
    bb_rays_free(tilted);
    bb_rays_free(again);
    bb_scene_free(scene);
}

/* The least sine of the angle between the ray and the planes of all triangles that it passes within
 * a millionth. */
static double least_sine(const bb_scene *scene, const bb_ray *ray)
{
    double best = 1;
    for (uint32_t t = 0; t < scene->prim_count; t++) {
        const float *v[3] = {bb_scene_vertex(scene, t, 0), bb_scene_vertex(scene, t, 1),
                             bb_scene_vertex(scene, t, 2)};
        double n[3], along = 0, size = 0;
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = ((double)v[1][i] - v[0][i]) * ((double)v[2][j] - v[0][j]) -
                   ((double)v[1][j] - v[0][j]) * ((double)v[2][i] - v[0][i]);
            along += n[k] * (double)ray->d[k];
            size += n[k] * n[k];
        }
        best = fmin(best, fabs(along) / sqrt(size));
    }
    return best;
}

static void grazing_rays_graze(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("soup:n=50");
    const double angles[] = {0.1, 1e-3, 1e-6, 0};
    for (size_t a = 0; a < 4; a++) {
        char text[64];
        snprintf(text, sizeof text, "grazing:angle=%g", angles[a]);
        bb_rays *rays = made(scene, text);
        for (uint32_t i = 0; i < 512; i++) {
            double sine = least_sine(scene, &rays->rays[i]);
            if (!(sine <= angles[a] + 1e-6))
                fail_msg("%s: ray %u has a sine of %g", text, i, sine);
        }
        bb_rays_free(rays);
    }
    bb_scene_free(scene);
    bb_scene *spheres = load_scene("spheres:n=10"), *points = load_scene("soup:n=4,edge=0");
    bb_scene *const without[] = {spheres, points};
    for (int i = 0; i < 2; i++) {
        bb_spec spec;
        bb_rays *rays = NULL;
        ASSERT_OK(bb_spec_parse("grazing", &spec));
        bb_rays_request request = {.spec = &spec, .max_rays = COUNT, .seed = 3};
        assert_int_equal(bb_rays_make(without[i], NULL, &request, &rays), BB_UNSUPPORTED);
        bb_scene_free(without[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soups_repeat),
        cmocka_unit_test(soups_have_shapes),
        cmocka_unit_test(soups_have_places),
        cmocka_unit_test(soups_repeat_places),
        cmocka_unit_test(soups_are_refused),
        cmocka_unit_test(crowds_have_a_share),
        cmocka_unit_test(nests_lie_within_each_other),
        cmocka_unit_test(axial_rays_lie_in_planes),
        cmocka_unit_test(grazing_rays_graze),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
