/* Pictures of volumes: with a tree the same as without, bit for bit, for all builders, kernels and
 * transfer functions; and what light there is, against a march in doubles that shares no code.
 * Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/builder/registry.h"
#include "framework/scene/camera.h"
#include "framework/tasks/march.h"
#include "tests/scene_files.h"
#include "tests/steps_fixture.h"
#include "tests/trace_fixture.h"

enum { SIDE = 16, LOOSE = 200, RAYS = 3 * SIDE * SIDE + LOOSE };

static const char *const kernels[] = {
    "stack",   "stackless", "short:entries=2", "trail",          "stack4", "stack8:order=octant",
    "stack8q", "short8",    "cwbvh",           "stack8i:rays=8", "packet", "packet8:rays=8"};
enum { KERNELS = sizeof kernels / sizeof kernels[0] };

/* For slow tools. */
static bool is_small(void)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL;
}

/* Pictures of all views, and rays from anywhere to anywhere, some along axes. */
static void make_rays(const bb_scene *scene, bb_ray *rays)
{
    uint32_t n = 0;
    bb_random random = bb_random_make(seed, 3);
    for (uint32_t v = 0; v < 3; v++) {
        bb_camera camera;
        check(bb_camera_make(&scene->views[v], SIDE, SIDE, &camera), "camera");
        for (uint32_t i = 0; i < SIDE * SIDE; i++)
            bb_camera_ray(&camera, i % SIDE, i / SIDE, &rays[n++]);
    }
    for (uint32_t i = 0; i < LOOSE; i++) {
        bb_ray *ray = &rays[n++];
        if (i % 7 == 3) { /* which begins far away, where a brick ends */
            float tmin = 1000 + 8 * (float)(1 + i % 4) + (float)bb_random_range(&random, -0.5, 0.5);
            *ray = (bb_ray){.o = {-1000.25f}, .tmin = tmin, .d = {1}, .tmax = tmin + 8};
            for (int k = 1; k < 3; k++)
                ray->o[k] = (float)bb_random_range(&random, 0, (double)scene->bounds.hi[k]);
            continue;
        }
        *ray = (bb_ray){.tmin = i % 5 == 0 ? 1.5f : 0, .tmax = i % 3 == 0 ? 20.0f : INFINITY};
        for (int k = 0; k < 3; k++) {
            double lo = scene->bounds.lo[k], hi = scene->bounds.hi[k];
            ray->o[k] = (float)bb_random_range(&random, lo - (hi - lo) / 4, hi + (hi - lo) / 4);
            ray->d[k] = (float)bb_random_range(&random, -1, 1);
            /* on the faces of bricks, along them */
            if (i % 4 == 0)
                ray->o[k] = roundf(ray->o[k] / 8) * 8;
            if (i % 4 == 0 && k != (int)(i / 4 % 3))
                ray->d[k] = 0;
        }
    }
}

static void march_all(bb_marcher *marcher, const bb_buffer *rays, bb_light *lights,
                      bb_count *counts)
{
    bb_buffer d_lights, d_counts;
    make_buffer(&d_lights, NULL, RAYS * sizeof *lights);
    make_buffer(&d_counts, NULL, RAYS * sizeof *counts);
    check(bb_march_all(marcher, rays, RAYS, &d_lights, &d_counts, NULL), "march without a tree");
    check(bb_buffer_read(&d_lights, 0, RAYS * sizeof *lights, lights), "lights");
    check(bb_buffer_read(&d_counts, 0, RAYS * sizeof *counts, counts), "counts");
    bb_buffer_release(&d_lights);
    bb_buffer_release(&d_counts);
}

static void march_tree(const bed *b, const bb_marcher *marcher, const bb_buffer *rays,
                       bb_light *lights, bb_count *counts)
{
    bb_buffer d_lights, d_counts;
    bb_traverser *traverser;
    bb_traverser_request request = {.kernel = bb_kernel_find(b->kernel.name),
                                    .spec = &b->kernel,
                                    .intersector = bb_intersector_find("exact"),
                                    .counting = true};
    bb_march_traverser_request(marcher, &request);
    check(bb_traverser_get(device, &request, &b->layout, &traverser), "traverser");
    make_buffer(&d_lights, NULL, RAYS * sizeof *lights);
    make_buffer(&d_counts, NULL, RAYS * sizeof *counts);
    bb_pass pass = {.traverser = traverser,
                    .layout = &b->layout,
                    .rays = rays,
                    .results = &d_lights,
                    .counts = &d_counts};
    bb_march_pass(marcher, &pass);
    check(bb_pass_run(&pass, RAYS, lights, counts), "march");
    bb_buffer_release(&d_lights);
    bb_buffer_release(&d_counts);
}

/* ---- steps ---- */

typedef struct recorded {
    bb_pass pass;
    bb_marcher *marcher; /* without a tree */
} recorded;

static bb_status launch(void *self, const bb_recording *recording)
{
    recorded *r = self;
    r->pass.recording = recording;
    return r->marcher != NULL ? bb_march_all(r->marcher, r->pass.rays, RAYS, r->pass.results,
                                             r->pass.counts, recording)
                              : bb_pass_launch(&r->pass, RAYS);
}

static uint64_t searches; /* beyond each ray's first */

/* Each ray's steps are as many as were counted: samples, and the table looked up at each; with the
 * kernel `stackless`, nodes. */
static void expect_steps(const bed *b, bb_marcher *marcher, const bb_buffer *rays,
                         const bb_count *counts)
{
    bb_buffer d_lights, d_counts;
    bb_steps steps;
    make_buffer(&d_lights, NULL, RAYS * sizeof(bb_light));
    make_buffer(&d_counts, NULL, RAYS * sizeof *counts);
    recorded r = {.pass = {.rays = rays, .results = &d_lights, .counts = &d_counts}};
    if (b != NULL) {
        bb_traverser_request request = {.kernel = bb_kernel_find(b->kernel.name),
                                        .spec = &b->kernel,
                                        .intersector = bb_intersector_find("exact"),
                                        .recording = true};
        bb_march_traverser_request(marcher, &request);
        r.pass.layout = &b->layout;
        check(bb_traverser_get(device, &request, &b->layout, &r.pass.traverser), "traverser");
        bb_march_pass(marcher, &r.pass);
    } else {
        r.marcher = marcher;
    }
    check(bb_steps_record(device, launch, &r, RAYS, BB_SAMPLE_ALL, &steps), "steps");
    step_sums *sums = sum_steps(&steps);
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t *of = sums[i].of;
        assert_int_equal(of[BB_STEP_SAMPLE], counts[i].prims);
        assert_int_equal(of[BB_STEP_LOOKUP], counts[i].prims);
        if (b != NULL && strcmp(b->kernel.name, "stackless") == 0) {
            assert_int_equal(of[BB_STEP_NODE], counts[i].nodes);
            assert_true(of[BB_STEP_SAMPLE] == 0 || of[BB_STEP_AGAIN] > 0);
        }
        if (b != NULL && strcmp(b->kernel.name, "stack") == 0)
            assert_int_equal(2 * of[BB_STEP_NODE], counts[i].nodes);
        assert_true(b != NULL || of[BB_STEP_NODE] + of[BB_STEP_AGAIN] == 0);
        searches += of[BB_STEP_AGAIN];
    }
    free(sums);
    bb_steps sample;
    check(bb_steps_record(device, launch, &r, RAYS,
                          (bb_sample_size){2 * BB_STEPS_RUN, 2 * BB_STEPS_RUN}, &sample),
          "sample");
    expect_sample(&steps, &sample);
    bb_steps_release(&sample);
    bb_steps_release(&steps);
    bb_buffer_release(&d_lights);
    bb_buffer_release(&d_counts);
}

static void expect_same(const bed *b, const char *builder, const bb_light *with,
                        const bb_light *without)
{
    for (uint32_t i = 0; i < RAYS; i++)
        if (!bb_query_march.same(&with[i], &without[i])) {
            char a[96], c[96];
            bb_query_march.say(&with[i], a, sizeof a);
            bb_query_march.say(&without[i], c, sizeof c);
            fail_msg("%s, %s, %s: ray %u: %s, without a tree %s (seed %llu)", b->scene->name,
                     builder, b->layout.name, i, a, c, (unsigned long long)seed);
        }
}

static uint64_t samples_of(const bb_count *counts)
{
    uint64_t samples = 0;
    for (uint32_t i = 0; i < RAYS; i++)
        samples += counts[i].prims;
    return samples;
}

typedef struct picture {
    bb_marcher *marcher;
    bb_buffer rays;
    bb_light without[RAYS], with[RAYS];
    bb_count counts[RAYS];
} picture;

static void open_picture(picture *p, bb_scene *scene, const bb_march_settings *settings)
{
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    make_rays(scene, rays);
    check(bb_scene_upload(scene, device), "upload");
    check(bb_marcher_create(scene, NULL, &p->marcher), "march");
    check(bb_marcher_set(p->marcher, settings), "settings");
    make_buffer(&p->rays, rays, RAYS * sizeof *rays);
    march_all(p->marcher, &p->rays, p->without, p->counts);
    free(rays);
}

static void close_picture(picture *p)
{
    bb_buffer_release(&p->rays);
    bb_marcher_destroy(p->marcher);
}

/* Returns the samples of the first kernel. */
static uint64_t compare_all(const char *name, const char *builder,
                            const bb_march_settings *settings, bool in_order)
{
    static picture p;
    bb_scene *scene = load(name);
    open_picture(&p, scene, settings);
    uint64_t all = samples_of(p.counts), first = 0;
    expect_steps(NULL, p.marcher, &p.rays, p.counts);
    bed b;
    open_bed(&b, scene, builder, "stack", 1);
    for (size_t k = 0; k < (is_small() ? 3 : KERNELS); k++) {
        choose_kernel(&b, kernels[k], k % 2 == 0 ? 1 : 4);
        march_tree(&b, p.marcher, &p.rays, p.with, p.counts);
        expect_same(&b, builder, p.with, p.without);
        if ((k < 2 || !in_order) && /* two kernels are quick to compile */
            bb_kernel_records(bb_kernel_find(b.kernel.name), &bb_query_march))
            expect_steps(&b, p.marcher, &p.rays, p.counts);
        /* others may begin again: where the order of children is only roughly right */
        if (k == 0)
            assert_true(samples_of(p.counts) <= all || !in_order);
        first = k == 0 ? samples_of(p.counts) : first;
    }
    close_picture(&p);
    close_bed(&b);
    return first;
}

/* ---- the same pictures ---- */

static const bb_march_settings usual = {.step = 0.5f};

static void pictures_are_those_without_a_tree(void **state)
{
    (void)state;
    static const char *const transfers[] = {"ramp", "bone", "sparse", "shells", "full"};
    static const char *const builders[] = {"vlbvh", "vlbvh:vote=ranges,prune=1", "lbvh", "sah",
                                           "vlbvh:prune=3,link=apetrei"};
    for (size_t t = 0; t < sizeof transfers / sizeof transfers[0]; t++)
        for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
            char name[96];
            if (is_small() && (i != t || t > 1))
                continue;
            snprintf(name, sizeof name, "nbody:n=%u,transfer=%s,brick=%d", i % 2 == 0 ? 48u : 33u,
                     transfers[t], t % 2 == 0 ? 8 : 4);
            compare_all(name, builders[i], &usual, true);
        }
}

/* Bricks in the order of their numbers: siblings overlap, and their order along a ray is none. */
static void trees_without_order_give_the_same_picture(void **state)
{
    (void)state;
    static const char volume[] = "nbody:n=48,transfer=bone,brick=4";
    const bb_march_settings cut = {.step = 0.5f, .cutoff = 0.5f};
    uint64_t in_order = compare_all(volume, "vlbvh", &usual, true);
    searches = 0;
    uint64_t begun_again = compare_all(volume, "lbvh:bits=3", &usual, false);
    assert_true(searches > 0);
    assert_true(begun_again > in_order + in_order / 10);
    /* a leaf behind may be where the march ends, until the one before it is met */
    compare_all(volume, "lbvh:bits=3", &cut, false);
    if (!is_small())
        compare_all(volume, "llbvh:bits=3", &cut, false);
}

static void a_march_may_end_early_and_step_as_it_likes(void **state)
{
    (void)state;
    const bb_march_settings settings[] = {{3.0f, 0}, {0.11f, 0.5f}, {0.5f, 0.9f}};
    static const char volume[] = "nbody:n=40,transfer=bone";
    const bb_march_settings cut = {0.5f, 0.3f};
    assert_true(compare_all(volume, "vlbvh", &cut, true) <
                compare_all(volume, "vlbvh", &usual, true) * 9 / 10);
    for (size_t i = 0; i < (is_small() ? 0 : sizeof settings / sizeof settings[0]); i++)
        compare_all(volume, "vlbvh", &settings[i], true);
}

/* ---- 16 bits, cells that are no cubes ---- */

static void write_wide_volume(const char *path)
{
    static uint16_t values[21][18][37];
    for (int z = 0; z < 21; z++)
        for (int y = 0; y < 18; y++)
            for (int x = 0; x < 37; x++) {
                double dx = x - 18, dy = y - 9, dz = z - 10;
                double far = sqrt(dx * dx / 4 + dy * dy + dz * dz);
                values[z][y][x] = far < 8 ? (uint16_t)(65535 * (1 - far / 8)) : 0;
            }
    write_bytes(path, values, sizeof values);
}

static void wide_voxels_and_flat_cells(void **state)
{
    (void)state;
    char name[1200];
    const char *path = test_path("march", "wide_37x18x21_uint16.raw");
    write_wide_volume(path);
    snprintf(name, sizeof name, "%s:spacing=0.3x1x2.5,transfer=shells", path);
    compare_all(name, "vlbvh", &usual, true);
    snprintf(name, sizeof name, "%s:spacing=1e-6x1e-6x2e-6", path);
    compare_all(name, "vlbvh", &(bb_march_settings){.step = 4e-7f}, true);
}

/* ---- against doubles ---- */

static double value_of(const bb_voxels *voxels, const double at[3])
{
    const uint8_t *values = voxels->values;
    double sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        size_t place[3];
        for (int k = 0; k < 3; k++) {
            double below = fmin(floor(at[k]), voxels->dims[k] - 2.0);
            bool up = (corner >> k & 1) != 0;
            place[k] = (size_t)below + up;
            weight *= up ? at[k] - below : 1 - (at[k] - below);
        }
        sum +=
            weight * values[(place[2] * voxels->dims[1] + place[1]) * voxels->dims[0] + place[0]];
    }
    return sum / 255;
}

/* Absorbs as much as its value says, and shines white. */
static double light_of(const bb_voxels *voxels, const bb_ray *ray, double step)
{
    double left = 1, light = 0, length = 0;
    for (int k = 0; k < 3; k++)
        length += (double)ray->d[k] * ray->d[k];
    length = sqrt(length);
    for (uint32_t i = 0; i < 4000; i++) {
        double t = (i + 0.5) * step / length, at[3];
        bool inside = t > ray->tmin && t < ray->tmax;
        for (int k = 0; k < 3; k++) {
            at[k] = ray->o[k] + t * ray->d[k];
            inside = inside && at[k] >= 0 && at[k] < voxels->dims[k] - 1;
        }
        if (!inside)
            continue;
        double alpha = value_of(voxels, at) * 0.5;
        double through = pow(1 - alpha, step);
        light += left * (1 - through);
        left *= through;
    }
    return light;
}

static void light_is_that_of_doubles(void **state)
{
    (void)state;
    static uint8_t values[12 * 10 * 11];
    static picture p;
    const double step = 0.37;
    const char *volume = test_path("march", "smooth_12x10x11_uint8.raw");
    const char *transfer = test_path("march", "white.transfer");
    char name[2200];
    bb_voxels voxels = {{12, 10, 11}, {1, 1, 1}, 1, values};
    bb_random random = bb_random_make(seed, 4);
    /* smooth, so that a table of alpha and one of extinctions differ little */
    for (size_t i = 0; i < sizeof values; i++)
        values[i] = (uint8_t)(100 + bb_random_below(&random, 20));
    write_bytes(volume, values, sizeof values);
    write_text(transfer, "# white\n0 0\n1 0.5 1 1 1\n");
    snprintf(name, sizeof name, "%s:transfer=%s", volume, transfer);
    bb_scene *scene = load(name);
    open_picture(&p, scene, &(bb_march_settings){.step = (float)step});
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    make_rays(scene, rays);
    double worst = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        double light = light_of(&voxels, &rays[i], (double)(float)step);
        /* rays along faces and ends of rays: a sample on the border is inside or not by rounding */
        double slack = i < 3 * SIDE * SIDE ? 2e-4 : 0.12;
        ASSERT_NEAR((double)p.without[i].rgb[0], light, slack);
        ASSERT_NEAR((double)p.without[i].rgb[0] + (double)p.without[i].left, 1, 1e-5);
        worst = fmax(worst, i < 3 * SIDE * SIDE ? fabs((double)p.without[i].rgb[0] - light) : 0);
    }
    print_message("largest difference to doubles: %g\n", worst);
    free(rays);
    close_picture(&p);
    bb_scene_free(scene);
}

/* ---- other transfer functions ---- */

static void a_tree_follows_its_transfer_function(void **state)
{
    (void)state;
    static picture p;
    static const char *const sequence[] = {"sparse", "full", "empty", "bone"};
    bb_scene *scene = load("nbody:n=40");
    bb_instance instance;
    check(bb_scene_upload(scene, device), "upload");
    check(bb_instance_create(device, "vlbvh", scene, seed, &instance), "vlbvh");
    for (size_t i = 0; i < sizeof sequence / sizeof sequence[0]; i++) {
        bb_transfer transfer;
        uint32_t changed;
        check(bb_transfer_load(sequence[i], &transfer), sequence[i]);
        check(bb_scene_set_transfer(scene, &transfer, &changed), sequence[i]);
        assert_int_equal(changed, BB_CHANGED_TRANSFER);
        check(bb_instance_build(&instance, scene, true, NULL), sequence[i]);
        open_picture(&p, scene, &usual);
        if (strcmp(sequence[i], "empty") == 0) {
            assert_int_equal(scene->prim_count, 0);
            assert_int_equal(instance.tree.info.node_count, 0);
            for (uint32_t r = 0; r < RAYS; r++)
                assert_true(p.without[r].rgb[0] == 0 && p.without[r].left == 1);
        } else {
            check(bb_tree_download(&instance.tree, NULL), sequence[i]);
            check(bb_tree_check(&instance.tree, scene), sequence[i]);
            assert_int_equal(instance.tree.info.ref_count, scene->prim_count);
        }
        close_picture(&p);
    }
    bb_instance_destroy(&instance);
    bb_scene_free(scene);
    assert_int_equal(bb_scene_load("nbody:n=20,transfer=empty", &scene), BB_INVALID);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_those_without_a_tree),
        cmocka_unit_test(trees_without_order_give_the_same_picture),
        cmocka_unit_test(a_march_may_end_early_and_step_as_it_likes),
        cmocka_unit_test(wide_voxels_and_flat_cells),
        cmocka_unit_test(light_is_that_of_doubles),
        cmocka_unit_test(a_tree_follows_its_transfer_function),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
