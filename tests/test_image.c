/* Pictures: PNG and EXR there and back, refusals, the colour map. */
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"
#include "tests/fixture.h"
#include "tests/report_sample.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
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

/* Where the bench was built without OpenImageIO there is nothing to test. */
static void need_exr(void)
{
    bb_status status = bb_exr_check();
    if (status == BB_OK)
        return;
    assert_int_equal(status, BB_UNSUPPORTED);
    print_message("skipped: %s\n", bb_message());
    skip();
}

/* What a float can be beside a number: both zeros, the smallest, infinities, NaNs that carry
 * bits. */
static void fill_oddly(float *values, size_t count)
{
    static const uint32_t odd[] = {0x80000000, 1,          0x80000001, 0x007fffff, 0x7f7fffff,
                                   0x7f800000, 0xff800000, 0x7fc00000, 0xffc12345, 0x7fffffff};
    bb_random random = bb_random_make(11, 0);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits = i < 10 ? odd[i] : (uint32_t)bb_random_u64(&random);
        if (i >= 10 && bits % 3 == 0)
            bits = odd[bits % 10];
        memcpy(&values[i], &bits, sizeof bits);
    }
}

static bb_status read_exr(const char *path, const char *channels, float **values, uint32_t *width,
                          uint32_t *height)
{
    char *data = NULL;
    size_t size;
    assert_int_equal(bb_file_read(path, 1 << 20, "test", &data, &size), BB_OK);
    bb_status status = bb_exr_read(path, data, size, channels, values, width, height);
    free(data);
    return status;
}

static void exr_comes_back_exactly(void **state)
{
    (void)state;
    need_exr();
    static const char *const names[] = {"RGB", "Y", "Z"};
    static float values[VALUES];
    char path[600];
    fill_oddly(values, VALUES);
    snprintf(path, sizeof path, "%s/a.exr", sample_folder("image"));
    for (size_t n = 0; n < 3; n++) {
        float *back = NULL;
        uint32_t width, height;
        if (bb_exr_write(path, values, names[n], WIDTH, HEIGHT) != BB_OK ||
            read_exr(path, names[n], &back, &width, &height) != BB_OK)
            fail_msg("%s: %s", names[n], bb_message());
        assert_int_equal(width, WIDTH);
        assert_int_equal(height, HEIGHT);
        assert_memory_equal(back, values, strlen(names[n]) * WIDTH * HEIGHT * sizeof *values);
        bb_host_free(back);
    }
    /* Z was the last: it has no colours */
    float *back = NULL;
    uint32_t width, height;
    assert_int_equal(bb_image_read(path, &back, &width, &height), BB_INVALID);
    assert_null(back);
    assert_non_null(strstr(bb_message(), "a.exr: it has no channel R"));
    /* as a picture it is the same RGB */
    fill(values);
    assert_int_equal(bb_image_write(path, values, WIDTH, HEIGHT), BB_OK);
    assert_int_equal(bb_image_read(path, &back, &width, &height), BB_OK);
    assert_memory_equal(back, values, sizeof values);
    bb_host_free(back);
}

/* Cut anywhere: an error in one line, and nothing to free. */
static void damaged_exr_is_refused(void **state)
{
    (void)state;
    need_exr();
    static float values[VALUES];
    char path[600], *data = NULL;
    size_t size;
    fill(values);
    snprintf(path, sizeof path, "%s/cut.exr", sample_folder("image"));
    assert_int_equal(bb_image_write(path, values, WIDTH, HEIGHT), BB_OK);
    assert_int_equal(bb_file_read(path, 1 << 20, "test", &data, &size), BB_OK);
    for (size_t cut = 1; cut < size; cut += cut < 400 ? 13 : 1777) {
        float *back = NULL;
        uint32_t width, height;
        assert_int_equal(bb_exr_read(path, data, cut, "RGB", &back, &width, &height), BB_INVALID);
        assert_null(back);
        assert_non_null(strstr(bb_message(), "cut.exr: "));
        assert_null(strchr(bb_message(), '\n'));
    }
    free(data);
}

/* The disk is full in the midst of it: the old file stays, and nothing beside it. */
static void half_a_file_is_never_seen(void **state)
{
    (void)state;
    need_exr();
    static float values[VALUES];
    const char *folder = sample_folder("image-full");
    char path[600], *before = NULL, *after = NULL;
    size_t size, size_after;
    fill(values);
    snprintf(path, sizeof path, "%s/full.exr", folder);
    assert_int_equal(bb_exr_write(path, values, "RGB", WIDTH, HEIGHT), BB_OK);
    assert_int_equal(bb_file_read(path, 1 << 20, "test", &before, &size), BB_OK);
    struct rlimit old, little;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    little = (struct rlimit){1000, old.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &little), 0);
    bb_status status = bb_exr_write(path, values + 1, "RGB", WIDTH, HEIGHT - 1);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_not_equal(status, BB_OK);
    assert_non_null(strstr(bb_message(), "full.exr"));
    assert_int_equal(bb_file_read(path, 1 << 20, "test", &after, &size_after), BB_OK);
    assert_int_equal(size_after, size);
    assert_memory_equal(after, before, size);
    free(before);
    free(after);
    int files = 0;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir)) != NULL;)
        files += entry->d_name[0] != '.';
    closedir(dir);
    assert_int_equal(files, 1);
}

static void differences_are_found(void **state)
{
    (void)state;
    need_exr();
    static float a[VALUES], b[VALUES], apart[VALUES];
    bb_exr_difference found;
    fill(a);
    memcpy(b, a, sizeof a);
    assert_int_equal(bb_exr_differences(a, b, 3, WIDTH, HEIGHT, NULL, &found), BB_OK);
    assert_true(found.pixels == 0 && found.most == 0 && found.mean == 0);
    const size_t here = 5 * WIDTH + 7, there = 11 * WIDTH + 2;
    a[3 * here + 1] = 2;
    b[3 * here + 1] = -1; /* two values of one pixel: it counts once */
    a[3 * here + 2] = 1;
    b[3 * here + 2] = 0.5f;
    a[3 * there] = 1;
    b[3 * there] = nextafterf(1, 2);
    assert_int_equal(bb_exr_differences(a, b, 3, WIDTH, HEIGHT, apart, &found), BB_OK);
    assert_int_equal(found.pixels, 2);
    assert_true(found.most == 3 && found.x == 7 && found.y == 5);
    assert_true(fabs(found.mean - 3.5 / VALUES) < 1e-6);
    for (size_t i = 0; i < VALUES; i++)
        assert_true(apart[i] == fabsf(a[i] - b[i]));
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

    /* a folder, and what is no file at all, in the place of the picture */
    snprintf(path, sizeof path, "%s/folder.png", sample_folder("image"));
    assert_true(mkdir(path, 0777) == 0 || errno == EEXIST);
    assert_int_equal(bb_image_write(path, rgb, 1, 1), BB_INVALID);
    assert_non_null(strstr(bb_message(), "not a regular file"));
    if (bb_exr_check() == BB_OK) {
        assert_int_equal(bb_image_write("/nonexistent/a.exr", rgb, 1, 1), BB_INVALID);
        assert_non_null(strstr(bb_message(), "/nonexistent/a.exr"));
        assert_int_equal(bb_exr_write("/dev/null", rgb, "Y", 1, 1), BB_INVALID);
    }
    assert_int_equal(bb_image_check("a.EXR"), BB_INVALID);
    assert_int_equal(bb_image_check("exr"), BB_INVALID);
    assert_int_equal(bb_image_check(".exr"), BB_INVALID);

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
        cmocka_unit_test(png_comes_back),         cmocka_unit_test(exr_comes_back_exactly),
        cmocka_unit_test(damaged_exr_is_refused), cmocka_unit_test(half_a_file_is_never_seen),
        cmocka_unit_test(differences_are_found),  cmocka_unit_test(bad_requests_are_refused),
        cmocka_unit_test(colour_map_is_even),     cmocka_unit_test(colour_map_clamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
