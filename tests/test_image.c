/* Pictures: PNG and EXR there and back, refusals, the colour map. */
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/picture/image.h"
#include "tests/fixture.h"
#include "tests/report_sample.h"

#include <unistd.h>

enum { WIDTH = 61, HEIGHT = 37, VALUES = 3 * WIDTH * HEIGHT };

static void fill(float *rgb)
{
    bb_random random = bb_random_make(9, 0);
    for (int i = 0; i < VALUES; i++)
        rgb[i] = (float)bb_random_unit(&random);
}

static float srgb(float v)
{
    return v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
}

static void png_comes_back(void **state)
{
    (void)state;
    static float rgb[VALUES];
    char path[600];
    fill(rgb);
    rgb[0] = -1.0f; /* out of range: clamped */
    rgb[1] = 7.0f;
    rgb[2] = NAN;
    snprintf(path, sizeof path, "%s/a.png", sample_folder("image"));
    assert_int_equal(bb_image_write(path, rgb, WIDTH, HEIGHT), BB_OK);
    float *back = NULL;
    uint32_t width, height;
    assert_int_equal(bb_image_read(path, &back, &width, &height), BB_OK);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    assert_true(back[0] == 0.0f && back[1] == 1.0f && back[2] == 0.0f);
    for (int i = 3; i < VALUES; i++)
        if (fabsf(srgb(back[i]) - srgb(rgb[i])) > 0.5f / 255 + 1e-5f)
            fail_msg("value %d: %g came back as %g (seed 9)", i, (double)rgb[i], (double)back[i]);
    bb_host_free(back);
}

static void exr_comes_back_exactly(void **state)
{
    (void)state;
    static float rgb[VALUES];
    char path[600];
    fill(rgb);
    rgb[0] = -1e20f;
    rgb[1] = INFINITY;
    rgb[2] = 1e-40f;
    snprintf(path, sizeof path, "%s/a.exr", sample_folder("image"));
    bb_status status = bb_image_write(path, rgb, WIDTH, HEIGHT);
    if (status == BB_UNSUPPORTED) {
        print_message("skipped: %s\n", bb_message());
        skip();
    }
    if (status != BB_OK)
        fail_msg("%s", bb_message());
    float *back = NULL;
    uint32_t width, height;
    assert_int_equal(bb_image_read(path, &back, &width, &height), BB_OK);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    assert_memory_equal(back, rgb, sizeof rgb);
    bb_host_free(back);

    /* a damaged one is refused */
    char *data = NULL;
    size_t size;
    assert_int_equal(bb_file_read(path, 1 << 20, "test", &data, &size), BB_OK);
    assert_int_equal(bb_file_write(path, data, size / 2, "test"), BB_OK);
    free(data);
    back = NULL;
    assert_int_equal(bb_image_read(path, &back, &width, &height), BB_INVALID);
    assert_null(back);
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    float rgb[3] = {0, 0, 0}, *back = NULL;
    uint32_t width, height;
    char path[600];
    assert_int_equal(bb_image_write("a.jpg", rgb, 1, 1), BB_INVALID);
    assert_non_null(strstr(bb_message(), ".png or .exr"));
    assert_int_equal(bb_image_write(".png", rgb, 1, 1), BB_INVALID);
    assert_int_equal(bb_image_write("a.png", rgb, 0, 1), BB_INVALID);
    assert_int_equal(bb_image_write("a.png", rgb, 65536, 65536), BB_INVALID);
    assert_int_equal(bb_image_write("/nonexistent/a.png", rgb, 1, 1), BB_INVALID);
    assert_non_null(strstr(bb_message(), "/nonexistent/a.png"));
    assert_int_equal(bb_image_read("/nonexistent/a.png", &back, &width, &height), BB_INVALID);

    snprintf(path, sizeof path, "%s/bad.png", sample_folder("image"));
    assert_int_equal(bb_file_write(path, "\x89PNG\r\n\x1a\n and no more", 20, "test"), BB_OK);
    assert_int_equal(bb_image_read(path, &back, &width, &height), BB_INVALID);
    assert_null(back);
}

/* Lightness rises in equal steps, no channel is clipped but by rounding, and equal steps of the
 * value are steps of nearly equal length in OKLab. */
static void oklab(const float rgb[3], double lab[3])
{
    double l = cbrt(0.4122214708 * rgb[0] + 0.5363325363 * rgb[1] + 0.0514459929 * rgb[2]);
    double m = cbrt(0.2119034982 * rgb[0] + 0.6806995451 * rgb[1] + 0.1073969566 * rgb[2]);
    double s = cbrt(0.0883024619 * rgb[0] + 0.2817188376 * rgb[1] + 0.6299787005 * rgb[2]);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

static void colour_map_is_even(void **state)
{
    (void)state;
    enum { STEPS = 64 };
    double last[3] = {0}, shortest = INFINITY, longest = 0;
    for (int i = 0; i <= STEPS; i++) {
        float rgb[3];
        double lab[3];
        bb_colour_map((float)i / STEPS, rgb);
        for (int k = 0; k < 3; k++)
            assert_true(rgb[k] >= 0 && rgb[k] <= 1);
        oklab(rgb, lab);
        if (i > 0) {
            double step = sqrt(pow(lab[0] - last[0], 2) + pow(lab[1] - last[1], 2) +
                               pow(lab[2] - last[2], 2));
            assert_true(fabs(lab[0] - last[0] - 0.66 / STEPS) < 1e-4);
            shortest = fmin(shortest, step);
            longest = fmax(longest, step);
        }
        memcpy(last, lab, sizeof last);
    }
    assert_true(longest < 1.4 * shortest);
}

static void colour_map_clamps(void **state)
{
    (void)state;
    float low[3], high[3], other[3];
    bb_colour_map(0, low);
    bb_colour_map(1, high);
    bb_colour_map(-3, other);
    assert_memory_equal(low, other, sizeof low);
    bb_colour_map(NAN, other);
    assert_memory_equal(low, other, sizeof low);
    bb_colour_map(INFINITY, other);
    assert_memory_equal(high, other, sizeof high);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(png_comes_back),           cmocka_unit_test(exr_comes_back_exactly),
        cmocka_unit_test(bad_requests_are_refused), cmocka_unit_test(colour_map_is_even),
        cmocka_unit_test(colour_map_clamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
