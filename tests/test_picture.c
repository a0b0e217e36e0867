/* Pictures of tests per ray and of wrong rays: colours where they belong, scales that say what they
 * show, words that are not cut. */
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"
#include "framework/picture/picture.h"
#include "tests/fixture.h"
#include "tests/hand_scene.h"
#include "tests/scene_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* Rays of a picture, straight down onto z = 0, and nothing else in them. */
static bb_rays *flat_rays(uint32_t width, uint32_t height)
{
    bb_rays *rays = calloc(1, sizeof *rays);
    rays->width = width;
    rays->height = height;
    rays->count = width * height;
    assert_int_equal(bb_host_alloc(NULL, rays->count * sizeof(bb_ray), "test", &rays->rays), BB_OK);
    for (uint32_t i = 0; i < rays->count; i++)
        rays->rays[i] =
            (bb_ray){{(float)(i % width), (float)(i / width), 1}, 0, {0, 0, -1}, INFINITY};
    return rays;
}

static const float *pixel(const bb_canvas *canvas, uint32_t x, uint32_t y)
{
    assert_true(x < canvas->width && y < canvas->height);
    return canvas->rgb + 3 * ((size_t)y * canvas->width + x);
}

static bool same(const float *a, const float *b)
{
    return memcmp(a, b, 3 * sizeof *a) == 0;
}

static const float white[3] = {1, 1, 1};

/* Words that were cut would touch the edge: beside and below the picture the outermost pixels are
 * white. */
static void expect_margin(const bb_canvas *canvas, const bb_rays *rays)
{
    uint32_t ink = 0;
    for (uint32_t y = 0; y < canvas->height; y++)
        for (uint32_t x = 0; x < canvas->width; x++) {
            if (x < rays->width && y < rays->height)
                continue;
            bool edge = x + 1 == canvas->width || y + 1 == canvas->height || x == 0;
            bool blank = same(pixel(canvas, x, y), white);
            if (edge && !blank)
                fail_msg("%ux%u: something is cut at %u, %u of %ux%u", rays->width, rays->height, x,
                         y, canvas->width, canvas->height);
            ink += !blank;
        }
    assert_true(ink > 100);
}

static const uint32_t sizes[][2] = {{1, 1},   {64, 48},   {700, 3},   {3, 700},
                                    {511, 4}, {512, 512}, {1280, 720}};

static const bb_heat_words words = {"tests per ray", "boxes", "primitives"};

static void heat_has_a_bar_that_is_not_cut(void **state)
{
    (void)state;
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (uint32_t most = 0; most < 2000000000; most = 17 * most + 3) {
            bb_rays *rays = flat_rays(sizes[s][0], sizes[s][1]);
            bb_count *counts = calloc(rays->count, sizeof *counts);
            for (uint32_t i = 0; i < rays->count; i++)
                counts[i] = (bb_count){.nodes = most, .prims = most / 2};
            bb_canvas canvas = {0};
            bb_heat_map heat;
            assert_int_equal(bb_picture_heat(rays, counts, &words, &canvas, &heat), BB_OK);
            assert_true(canvas.width > rays->width && canvas.height > rays->height);
            assert_true(heat.boxes == most && heat.prims == most / 2);
            assert_true(heat.most == (double)most + most / 2);
            assert_true(heat.top == fmax(1, heat.most));
            expect_margin(&canvas, rays);
            bb_canvas_free(&canvas);
            free(counts);
            bb_rays_free(rays);
        }
}

static void heat_is_the_colour_map_of_the_tests(void **state)
{
    (void)state;
    enum { WIDTH = 100, HEIGHT = 50 };
    bb_rays *rays = flat_rays(WIDTH, HEIGHT);
    bb_count *counts = calloc(rays->count, sizeof *counts);
    bb_random random = bb_random_make(2, 0);
    for (uint32_t i = 0; i < rays->count; i++)
        counts[i] = (bb_count){.nodes = bb_random_below(&random, 90),
                               .prims = bb_random_below(&random, 10)};
    counts[1234].nodes = 100000; /* an outlier */
    bb_canvas canvas = {0};
    bb_heat_map heat;
    assert_int_equal(bb_picture_heat(rays, counts, &words, &canvas, &heat), BB_OK);
    assert_true(heat.most >= 100000 && heat.most < 100010);
    assert_true(heat.top > 80 && heat.top < 100);
    double boxes = 0, prims = 0;
    for (uint32_t i = 0; i < rays->count; i++) {
        float expected[3];
        bb_colour_map((float)((counts[i].nodes + counts[i].prims) / heat.top), expected);
        assert_true(same(pixel(&canvas, i % WIDTH, i / WIDTH), expected));
        boxes += counts[i].nodes;
        prims += counts[i].prims;
    }
    assert_true(fabs(heat.boxes - boxes / rays->count) < 1e-9);
    assert_true(fabs(heat.prims - prims / rays->count) < 1e-9);
    /* the bar: light at its upper end, dark at its lower one, and never lighter downwards */
    uint32_t x = WIDTH + 8, rows = 0;
    float before = INFINITY;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        const float *rgb = pixel(&canvas, x, y);
        if (same(rgb, white))
            continue;
        float light = rgb[0] + rgb[1] + rgb[2];
        assert_true(light <= before + 0.01f);
        before = light;
        rows++;
    }
    assert_true(rows >= 20 && before < 0.2f);
    bb_canvas_free(&canvas);
    free(counts);
    bb_rays_free(rays);
}

/* ---- classes ---- */

typedef struct diff {
    bb_scene *scene;
    bb_rays *rays;
    bb_hit *hits;
    uint8_t *classes;
    bb_canvas canvas;
} diff;

/* All rays right: the left half hits one triangle, the right half nothing. */
static diff make_diff(uint32_t width, uint32_t height)
{
    diff d = {.scene = hand_scene(1, 0), .rays = flat_rays(width, height)};
    static const float corners[] = {-9, -9, 0, 2000, -9, 0, -9, 2000, 0};
    memcpy(d.scene->vertices, corners, sizeof corners);
    hand_finish(d.scene);
    d.hits = calloc(d.rays->count, sizeof *d.hits);
    d.classes = calloc(d.rays->count, 1);
    for (uint32_t i = 0; i < d.rays->count; i++)
        d.hits[i] = i % width < width / 2 ? (bb_hit){1, 0} : (bb_hit){INFINITY, BB_NONE};
    return d;
}

static void draw_diff(diff *d, const bb_accuracy *accuracy)
{
    bb_canvas_free(&d->canvas);
    assert_int_equal(bb_picture_diff(d->scene, d->rays, d->hits, d->classes, accuracy, &d->canvas),
                     BB_OK);
}

static void free_diff(diff *d)
{
    bb_canvas_free(&d->canvas);
    bb_rays_free(d->rays);
    hand_free(d->scene);
    free(d->hits);
    free(d->classes);
}

/* CIE lightness, 0 to 100, of linear RGB. */
static double lightness(const float *rgb)
{
    double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    return y > 0.008856 ? 116 * cbrt(y) - 16 : 903.3 * y;
}

static void each_class_has_its_colour(void **state)
{
    (void)state;
    diff d = make_diff(40, 20);
    static const uint8_t classes[] = {BB_MISSED, BB_FALSE_HIT, BB_WRONG_T, BB_TIE};
    for (size_t i = 0; i < 4; i++)
        d.classes[5 * 40 + 5 + 8 * i] = classes[i];
    d.classes[12 * 40 + 5] = BB_UNWRITTEN;
    bb_accuracy accuracy = {.checked = 800};
    draw_diff(&d, &accuracy);
    const float *colour[4];
    for (uint32_t i = 0; i < 4; i++) {
        colour[i] = pixel(&d.canvas, 5 + 8 * i, 5);
        /* what is wrong is seen with its neighbours, a tie alone */
        for (int dy = -1; dy <= 1; dy++)
            for (int dx = -1; dx <= 1; dx++)
                if (dx != 0 || dy != 0)
                    assert_true(
                        same(pixel(&d.canvas, (uint32_t)(5 + 8 * (int)i + dx), (uint32_t)(5 + dy)),
                             colour[i]) == (i < 3));
        assert_false(same(pixel(&d.canvas, 7 + 8 * i, 5), colour[i]));
    }
    assert_true(same(pixel(&d.canvas, 5, 12), colour[0])); /* unwritten counts as missed */
    /* told apart without hues, from the faint background too; red from violet by hue as well */
    for (uint32_t i = 0; i < 4; i++) {
        assert_true(lightness(colour[i]) < 75);
        for (uint32_t k = 0; k < i; k++)
            assert_false(same(colour[i], colour[k]));
    }
    assert_true(lightness(colour[1]) - lightness(colour[0]) > 25);
    assert_true(lightness(colour[1]) - lightness(colour[2]) > 25);
    assert_true(lightness(colour[3]) - lightness(colour[2]) > 25);
    for (uint32_t y = 0; y < 20; y++)
        for (uint32_t x = 0; x < 40; x++) {
            const float *rgb = pixel(&d.canvas, x, y);
            bool grey = rgb[0] == rgb[1] && rgb[1] == rgb[2];
            if (grey)
                assert_true(lightness(rgb) > 70);
        }
    free_diff(&d);
}

static void nothing_wrong_is_painted_over(void **state)
{
    (void)state;
    diff d = make_diff(30, 30);
    bb_accuracy accuracy = {.checked = 900};
    /* alone in the corners, to know the colours and that edges are no trouble */
    d.classes[0] = BB_MISSED;
    d.classes[29] = BB_FALSE_HIT;
    d.classes[29 * 30] = BB_WRONG_T;
    d.classes[29 * 30 + 29] = BB_TIE;
    draw_diff(&d, &accuracy);
    float colour[BB_UNWRITTEN + 1][3];
    memcpy(colour[BB_MISSED], pixel(&d.canvas, 0, 0), sizeof colour[0]);
    memcpy(colour[BB_UNWRITTEN], pixel(&d.canvas, 0, 0), sizeof colour[0]);
    memcpy(colour[BB_FALSE_HIT], pixel(&d.canvas, 29, 0), sizeof colour[0]);
    memcpy(colour[BB_WRONG_T], pixel(&d.canvas, 0, 29), sizeof colour[0]);
    memcpy(colour[BB_TIE], pixel(&d.canvas, 29, 29), sizeof colour[0]);
    bb_random random = bb_random_make(4, 0);
    for (uint32_t i = 0; i < 900; i++)
        d.classes[i] = (uint8_t)bb_random_below(&random, BB_UNWRITTEN + 1);
    draw_diff(&d, &accuracy);
    for (uint32_t i = 0; i < 900; i++)
        if (d.classes[i] != BB_RIGHT)
            assert_true(same(pixel(&d.canvas, i % 30, i / 30), colour[d.classes[i]]));
    free_diff(&d);
}

static void legends_are_not_cut(void **state)
{
    (void)state;
    const bb_accuracy accuracies[] = {
        {.checked = 1},
        {.checked = 262144, .missed = 12, .false_hits = 345, .wrong_t = 6789, .ties = 1},
        {.checked = UINT32_MAX,
         .missed = UINT32_MAX,
         .false_hits = UINT32_MAX,
         .wrong_t = UINT32_MAX,
         .ties = UINT32_MAX},
    };
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        diff d = make_diff(sizes[s][0], sizes[s][1]);
        for (size_t a = 0; a < 3; a++) {
            draw_diff(&d, &accuracies[a]);
            assert_true(d.canvas.width >= d.rays->width && d.canvas.height > d.rays->height);
            expect_margin(&d.canvas, d.rays);
        }
        free_diff(&d);
    }
}

static void what_lies_outside_of_a_canvas_is_left_out(void **state)
{
    (void)state;
    bb_canvas canvas = {0};
    assert_int_equal(bb_canvas_create(20, 10, &canvas), BB_OK);
    static const float red[3] = {1, 0, 0};
    bb_canvas_fill(&canvas, -5, -5, 7, 6, red);
    bb_canvas_fill(&canvas, 18, 9, 100, 100, red);
    bb_canvas_fill(&canvas, 30, 2, 5, 5, red);
    bb_canvas_fill(&canvas, 5, 5, 0, -3, red);
    bb_canvas_text(&canvas, -7, -3, 3,
                   "cut on all sides, and longer than a line can ever be: "
                   "................................................................");
    uint32_t count = 0;
    for (uint32_t y = 0; y < 10; y++)
        for (uint32_t x = 0; x < 20; x++)
            count += same(pixel(&canvas, x, y), red);
    assert_true(count <= 4);
    bb_canvas_free(&canvas);
    assert_int_equal(bb_text_width("tests", 3), 3 * bb_text_width("tests", 1));
    assert_true(bb_text_width("tests per ray", 1) > bb_text_width("tests", 1));
}

/* By the program, read back: the picture with its room for words, and a careless intersector's
 * wrong rays in colour. */
static void pictures_come_from_the_program(void **state)
{
    (void)state;
    static const char *const views[] = {"heat", "diff --intersector fast"};
    for (size_t v = 0; v < 2; v++) {
        char command[1024];
        const char *path = test_path("picture", v == 0 ? "heat.png" : "diff.png");
        snprintf(command, sizeof command,
                 BB_TEST_PROGRAM " render --scene coffee --show %s --size 256x256 --out %s >%s",
                 views[v], path, test_path("picture", "log"));
        assert_int_equal(system(command), 0);
        float *rgb = NULL;
        uint32_t width, height, coloured = 0;
        assert_int_equal(bb_image_read(path, &rgb, &width, &height), BB_OK);
        assert_true(width > (v == 0 ? 256u : 255u) && height > 256);
        for (uint32_t y = 0; y < 256; y++)
            for (uint32_t x = 0; x < 256; x++) {
                const float *p = rgb + 3 * ((size_t)y * width + x);
                coloured += fabsf(p[0] - p[1]) > 0.1f || fabsf(p[1] - p[2]) > 0.1f;
            }
        if (v == 0 ? coloured < 256 : coloured < 5 || coloured > 2000)
            fail_msg("%s: %u pixels in colour", views[v], coloured);
        bb_host_free(rgb);
    }
}

/* ---- the numbers behind the pictures ---- */

enum { SIDE = 64 };

/* Rendered by the program and read back; from bb_host_alloc(). */
static float *render_exr(const char *arguments, const char *name, const char *channels)
{
    char command[1024], *data = NULL;
    const char *path = test_path("picture", name);
    size_t size;
    float *values = NULL;
    uint32_t width, height;
    snprintf(command, sizeof command,
             BB_TEST_PROGRAM " render --scene coffee --size %dx%d %s --out %s >%s", SIDE, SIDE,
             arguments, path, test_path("picture", "log"));
    assert_int_equal(system(command), 0);
    assert_int_equal(bb_file_read(path, 1 << 20, "test", &data, &size), BB_OK);
    if (bb_exr_read(path, data, size, channels, &values, &width, &height) != BB_OK)
        fail_msg("%s", bb_message());
    free(data);
    assert_true(width == SIDE && height == SIDE);
    return values;
}

static uint64_t pixels_apart(const float *a, const float *b)
{
    bb_exr_difference found;
    assert_int_equal(bb_exr_differences(a, b, 1, SIDE, SIDE, NULL, &found), BB_OK);
    return found.pixels;
}

/* Boxes and primitives per ray, as the program says. */
static double printed_tests(void)
{
    double boxes = 0, prims = 0;
    FILE *file = fopen(test_path("picture", "log"), "r");
    assert_non_null(file);
    assert_int_equal(
        fscanf(file, "tests per ray: %lf boxes and %lf primitives on average", &boxes, &prims), 2);
    fclose(file);
    return boxes + prims;
}

/* All exact kernels and trees give one depth; a careless one doesn't, and `diff` has the size of
 * it. */
static void exr_holds_the_numbers(void **state)
{
    (void)state;
    bb_status there = bb_exr_check();
    if (there != BB_OK) {
        assert_int_equal(there, BB_UNSUPPORTED);
        print_message("skipped: %s\n", bb_message());
        skip();
    }
    float *depth = render_exr("--show depth", "depth.exr", "Z");
    float *other = render_exr("--show depth --builder lbvh --kernel stackless", "other.exr", "Z");
    float *fast = render_exr("--show depth --intersector fast", "fast.exr", "Z");
    float *normals = render_exr("--show normal", "normal.exr", "RGB");
    float *tests = render_exr("--show heat", "heat.exr", "Y");
    const double mean = printed_tests();
    float *apart = render_exr("--show diff", "diff.exr", "Y");
    float most = 0;
    double sum = 0;
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        const float *n = normals + 3 * i;
        bool hit = isfinite(depth[i]);
        assert_true(hit ? depth[i] > 0 : depth[i] == INFINITY);
        assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - (hit ? 1 : 0)) < 1e-5f);
        assert_true(tests[i] == floorf(tests[i]) && tests[i] >= (hit ? 2 : 0));
        assert_true(apart[i] >= 0);
        sum += tests[i];
        most = fmaxf(most, apart[i]);
        if (!hit) /* a miss is no number that could be compared */
            depth[i] = other[i] = fast[i] = 0;
    }
    assert_true(most < 1e-4f);
    assert_true(fabs(sum / (SIDE * SIDE) - mean) < 0.11); /* two roundings to one digit */
    assert_int_equal(pixels_apart(depth, other), 0);
    assert_true(pixels_apart(depth, fast) > 0);
    float *all[] = {depth, other, fast, normals, tests, apart};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        bb_host_free(all[i]);
}

/* A program without the module beside its library: one line that names the package, before any
 * work, and PNG as ever. */
static void without_the_module_exr_is_refused(void **state)
{
    (void)state;
    char command[4096], log[1000] = "";
    snprintf(command, sizeof command,
             "cd %s && rm -rf bare && mkdir bare && cp %s bare/ && "
             "cp -d \"$(dirname %s)\"/libbvhbench.so* bare/",
             test_path("picture", "."), BB_TEST_BINARY, BB_TEST_BINARY);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command,
             "cd %s && LD_LIBRARY_PATH=$PWD/bare bare/bvhbench render --scene coffee --out x.exr "
             "2>log >/dev/null",
             test_path("picture", "."));
    int status = system(command);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 2);
    FILE *file = fopen(test_path("picture", "log"), "r");
    assert_non_null(file);
    assert_non_null(fgets(log, sizeof log, file));
    assert_non_null(strstr(log, "install libopenimageio-dev"));
    assert_null(fgets(log, sizeof log, file));
    fclose(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heat_has_a_bar_that_is_not_cut),
        cmocka_unit_test(heat_is_the_colour_map_of_the_tests),
        cmocka_unit_test(each_class_has_its_colour),
        cmocka_unit_test(nothing_wrong_is_painted_over),
        cmocka_unit_test(legends_are_not_cut),
        cmocka_unit_test(what_lies_outside_of_a_canvas_is_left_out),
        cmocka_unit_test(pictures_come_from_the_program),
        cmocka_unit_test(exr_holds_the_numbers),
        cmocka_unit_test(without_the_module_exr_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
