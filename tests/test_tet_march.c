/* The march through tetrahedra: the same picture whatever finds the samples, bit for bit; the light
 * against doubles, with the samples found by exact arithmetic; intervals by the boundary leave no
 * sample out. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). Seed:
 * BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "framework/scene/camera.h"
#include "framework/tasks/tet_march.h"
#include "tests/device_fixture.h"
#include "tests/locate_all.h"
#include "tests/steps_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 24, LOOSE = 200, VIEWS = 3, RAYS = VIEWS * SIDE * SIDE + LOOSE, WAYS = 6 };

static bool small;

static const struct {
    const char *builder, *layout;
    bool interval;
} ways[WAYS] = {{"lbvh", "skip", false},          {"olbvh", "skip", false},
                {"olbvh", "octree", false},       {"olbvh", "olbvh", false},
                {"olbvh:alpha=1", "olbvh", true}, {"olbvh:alpha=1", "octree", true}};

/* All of some pictures; then rays that end, begin inside, lie in planes of the bounds, or miss. */
static void make_rays(const bb_scene *scene, bb_ray *rays)
{
    uint32_t n = 0;
    for (uint32_t v = 0; v < VIEWS; v++) {
        bb_camera camera;
        check(bb_camera_make(&scene->views[v % scene->view_count], SIDE, SIDE, &camera), "camera");
        for (uint32_t i = 0; i < SIDE * SIDE; i++)
            bb_camera_ray(&camera, i % SIDE, i / SIDE, &rays[n++]);
    }
    for (uint32_t i = 0; i < LOOSE; i++) {
        bb_random random = bb_random_make(seed, i);
        bb_ray *ray = &rays[n++];
        for (int k = 0; k < 3; k++) {
            float lo = scene->bounds.lo[k], side = scene->bounds.hi[k] - lo;
            ray->o[k] = i % 4 == 0 ? lo : lo + side * (float)bb_random_range(&random, -0.3, 1.3);
            ray->d[k] = i % 3 == 0 ? (float)((int)bb_random_below(&random, 3) - 1)
                                   : (float)bb_random_range(&random, -1, 1);
        }
        if (ray->d[0] == 0 && ray->d[1] == 0 && ray->d[2] == 0)
            ray->d[i % 3] = 1;
        ray->tmin = i % 5 == 0 ? 0.5f : 0;
        ray->tmax = i % 7 == 0 ? 1.5f : INFINITY;
    }
}

typedef struct marching {
    bb_tet_marcher *marcher;
    bb_tet_search search;
    bool interval;
    const bb_buffer *rays;
    bb_buffer *lights, *counts;
} marching;

static bb_status launch(void *self, const bb_recording *recording)
{
    marching *m = self;
    m->search.recording = recording;
    return bb_tet_march(m->marcher, &m->search, m->interval, m->rays, RAYS, m->lights, m->counts);
}

/* Each ray's steps at nodes are as many as were counted, restarts and look-ups too. */
static void expect_steps(marching *m, const bb_count *counts)
{
    bb_simulated_code code = {.kernel = NULL};
    bb_steps steps;
    check(bb_tet_search_code(&m->search, "tet_march", m->interval, &code), "code");
    check(bb_steps_record(device, launch, m, RAYS, BB_SAMPLE_ALL, &steps), "steps");
    step_sums *sums = sum_steps(&steps);
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t *of = sums[i].of;
        assert_int_equal(tested_nodes(&sums[i], code.footing.control), counts[i].nodes);
        assert_int_equal(of[BB_STEP_RESTART], counts[i].restarts);
        assert_int_equal(of[BB_STEP_LOOKUP], counts[i].prims);
        assert_true(of[BB_STEP_AGAIN] >= of[BB_STEP_LOOKUP]);
    }
    if (code.footing.control == BB_UNTIL_LEAF)
        expect_lists(&steps);
    free(sums);
    bb_steps_release(&steps);
    bb_simulated_code_release(&code);
}

static void march(bb_scene *scene, bb_tet_marcher *marcher, int way, const bb_buffer *rays,
                  bb_light *lights, bb_count *counts)
{
    bb_instance instance = {0};
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bb_buffer there, counted;
    const bb_layout *layout = bb_layout_find(ways[way].layout);
    const bool interval = ways[way].interval;
    bb_tet_search how;
    check(bb_instance_create(device, ways[way].builder, scene, 1, &instance), ways[way].builder);
    check(bb_instance_build(&instance, scene, false, NULL), ways[way].builder);
    check(bb_layout_maker_create(layout, device, &maker), layout->name);
    check(bb_layout_maker_make(&maker, scene, &instance.tree, 1, BB_FORMAT_VERTICES, &data),
          layout->name);
    check(bb_tet_search_by(scene, layout, &data, &how), layout->name);
    make_buffer(&there, NULL, RAYS * sizeof *lights);
    make_buffer(&counted, NULL, RAYS * sizeof *counts);
    check(bb_buffer_fill(&there, RAYS * sizeof *lights, BB_POISON), "poison");
    check(bb_tet_march(marcher, &how, interval, rays, RAYS, &there, NULL), "march");
    check(bb_buffer_read(&there, 0, RAYS * sizeof *lights, lights), "lights");
    bb_light *again = malloc(RAYS * sizeof *again);
    check(bb_tet_march(marcher, &how, interval, rays, RAYS, &there, &counted), "march");
    check(bb_buffer_read(&there, 0, RAYS * sizeof *again, again), "lights");
    check(bb_buffer_read(&counted, 0, RAYS * sizeof *counts, counts), "counts");
    assert_memory_equal(again, lights, RAYS * sizeof *lights);
    expect_steps(&(marching){marcher, how, interval, rays, &there, &counted}, counts);
    check(bb_buffer_read(&there, 0, RAYS * sizeof *again, again), "lights");
    assert_memory_equal(again, lights, RAYS * sizeof *lights);
    free(again);
    bb_buffer_release(&there);
    bb_buffer_release(&counted);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    bb_instance_destroy(&instance);
}

/* ---- the same in doubles ---- */

static double field_at(const bb_scene *scene, uint32_t tet, const double p[3])
{
    double w[4], sum = 0, value = 0;
    for (int c = 0; c < 4; c++) { /* the volume with corner c moved to the point */
        double v[4][3];
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                v[i][k] =
                    i == c
                        ? p[k]
                        : (double)
                              scene->vertices[3 * (size_t)bb_scene_tet(scene, tet)[i] + (size_t)k];
        w[c] = 0;
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            w[c] += (v[3][k] - v[0][k]) * ((v[1][m] - v[0][m]) * (v[2][n] - v[0][n]) -
                                           (v[1][n] - v[0][n]) * (v[2][m] - v[0][m]));
        }
        sum += w[c];
        value += w[c] * (double)scene->tets->field[bb_scene_tet(scene, tet)[c]];
    }
    return value / sum;
}

/* With a transfer function that absorbs as much as the field's place in its range, times alpha. */
static double light_of(const bb_scene *scene, const bb_ray *ray, double step, double alpha)
{
    double left = 1, light = 0, length = 0, width = bb_tet_march_width(scene);
    for (int k = 0; k < 3; k++)
        length += (double)ray->d[k] * ray->d[k];
    length = sqrt(length);
    for (uint32_t i = 0; i < 4000; i++) {
        double t = (i + 0.5) * step / length, p[3];
        uint32_t tet;
        for (int k = 0; k < 3; k++)
            p[k] = ray->o[k] + t * (double)ray->d[k];
        if (t <= ray->tmin || t >= ray->tmax || locate_all(scene, p, &tet, 1) == 0)
            continue;
        double range = (double)scene->tets->field_hi - scene->tets->field_lo;
        double x = (field_at(scene, tet, p) - scene->tets->field_lo) / range;
        double through = pow(1 - alpha * x, step / width);
        light += left * (1 - through);
        left *= through;
    }
    return light;
}

/* ---- comparisons ---- */

static void compare(const char *name, double step, double cutoff)
{
    bb_scene *scene = NULL;
    bb_tet_marcher *marcher;
    bb_transfer transfer;
    bb_buffer there;
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_light *lights[2] = {calloc(RAYS, sizeof **lights), calloc(RAYS, sizeof **lights)};
    bb_count *counts = calloc(RAYS, sizeof *counts);
    uint64_t samples[WAYS] = {0}, nodes[WAYS] = {0};
    check(bb_scene_load(name, &scene), name);
    check(bb_scene_upload(scene, device), name);
    check(bb_transfer_parse("test", "0 0 1 1 1\n1 0.2\n", &transfer), "transfer");
    const bb_march_settings settings = {(float)(step * bb_tet_march_width(scene)), (float)cutoff};
    check(bb_tet_marcher_create(scene, NULL, &marcher), "march");
    check(bb_tet_marcher_set(marcher, &settings, &transfer), "settings");
    make_rays(scene, rays);
    make_buffer(&there, rays, RAYS * sizeof *rays);
    for (int way = 0; way < WAYS; way++) {
        march(scene, marcher, way, &there, lights[way > 0], counts);
        for (uint32_t i = 0; i < RAYS; i++) {
            samples[way] += counts[i].prims;
            nodes[way] += counts[i].nodes;
            if (way > 0 && memcmp(&lights[0][i], &lights[1][i], sizeof **lights) != 0)
                fail_msg("%s, ray %u by %s: light %g, by %s on %s it is %g", name, i,
                         ways[0].builder, (double)lights[0][i].rgb[0], ways[way].builder,
                         ways[way].layout, (double)lights[1][i].rgb[0]);
        }
        assert_true(samples[way] > RAYS / 8 && samples[way] == samples[0]);
    }
    print_message("%s: %llu samples, nodes %llu, %llu, %llu, %llu\n", name,
                  (unsigned long long)samples[0], (unsigned long long)nodes[0],
                  (unsigned long long)nodes[1], (unsigned long long)nodes[2],
                  (unsigned long long)nodes[3]);
    double sum = 0, worst = 0;
    uint32_t compared = 0;
    for (uint32_t i = 0; i < RAYS && cutoff == 0; i += small ? 97 : 7, compared++) {
        double light = light_of(scene, &rays[i], (double)settings.step, 0.2);
        /* a sample by rounding inside or outside */
        ASSERT_NEAR((double)lights[0][i].rgb[0], light, 0.05 + 0.2 * step);
        double apart = fabs((double)lights[0][i].rgb[0] - light);
        sum += apart;
        worst = fmax(worst, apart);
    }
    if (cutoff == 0) {
        print_message("  differs from doubles by %.2g on average, %.2g at most\n", sum / compared,
                      worst);
        assert_true(sum / compared < 2e-3);
    }
    bb_buffer_release(&there);
    bb_tet_marcher_destroy(marcher);
    free(rays);
    free(lights[0]);
    free(lights[1]);
    free(counts);
    bb_scene_free(scene);
}

static void pictures_are_the_same_by_all_ways(void **state)
{
    (void)state;
    compare("tets:side=3", small ? 16 : 2, 0);
    if (small)
        return;
    compare("tets:side=6,shape=shell", 1.3, 0);
    compare("tets:side=5,shape=block,flip=3,flat=4", 1, 0);
    compare("tets:side=6,shape=shell", 1.3, 0.5);
    compare("tets:side=8,grade=2,jitter=0.1", 0.5, 0);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_tet_marcher *marcher;
    bb_layout_data data = {0};
    bb_buffer none = {0};
    bb_transfer transfer;
    check(bb_scene_load("cube", &scene), "cube");
    assert_int_equal(bb_tet_marcher_create(scene, NULL, &marcher), BB_INVALID);
    bb_scene_free(scene);
    check(bb_scene_load("tets:side=1", &scene), "tets");
    check(bb_scene_upload(scene, device), "tets");
    check(bb_transfer_load("ramp", &transfer), "ramp");
    check(bb_tet_marcher_create(scene, NULL, &marcher), "march");
    assert_int_equal(bb_tet_marcher_set(marcher, &(bb_march_settings){0, 0}, &transfer),
                     BB_INVALID);
    bb_tet_search search;
    assert_int_equal(bb_tet_search_by(scene, bb_layout_find("pair"), &data, &search),
                     BB_UNSUPPORTED);
    check(bb_tet_search_by(scene, bb_layout_find("skip"), &data, &search), "skip");
    assert_int_equal(bb_tet_march(marcher, &search, true, &none, 1, &none, NULL), BB_UNSUPPORTED);
    bb_tet_marcher_destroy(marcher);
    bb_scene_free(scene);
}

static int set_up(void **state)
{
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    return open_device(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_same_by_all_ways),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, close_device);
}
