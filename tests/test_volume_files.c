/* Files of volumes: raw, zstd, NRRD and MagicaVoxel; what must be refused, in one line; and every
 * file of ../shared/data/vol, whole, cut off and damaged. */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "tests/scene_files.h"

#include <dirent.h>
#include <math.h>
#include <zstd.h>

#define DATA BB_TEST_SOURCE_DIR "/../shared/data/vol"

static const char *path_of(const char *name)
{
    return test_path("volume_files", name);
}

/* The value of voxel (x, y, z), of a volume of one brick. */
static uint32_t voxel(const bb_scene *scene, uint32_t x, uint32_t y, uint32_t z)
{
    const bb_volume *volume = scene->volume;
    uint32_t along = volume->grid.side + 1;
    size_t i = ((size_t)z * along + y) * along + x;
    assert_int_equal(volume->brick_count, 1);
    return volume->bytes == 1 ? ((const uint8_t *)volume->bricks)[i]
                              : ((const uint16_t *)volume->bricks)[i];
}

/* "FILE:options" */
static const char *with(const char *path, const char *options)
{
    static char text[1200];
    snprintf(text, sizeof text, "%s:%s", path, options);
    return text;
}

/* ---- raw ---- */

static void raw_volumes_are_read(void **state)
{
    (void)state;
    uint8_t narrow[24];
    for (size_t i = 0; i < sizeof narrow; i++)
        narrow[i] = (uint8_t)(i * 11);
    const char *named = path_of("a_2x3x4_uint8.raw"), *plain = path_of("plain.raw");
    write_bytes(named, narrow, sizeof narrow);
    write_bytes(plain, narrow, sizeof narrow);
    bb_scene *scene = load_scene(with(named, "transfer=full"));
    bb_scene *given = load_scene(with(plain, "dims=2x3x4,type=uint8,transfer=full"));
    assert_true(scene->hash == given->hash);
    for (uint32_t z = 0; z < 4; z++)
        for (uint32_t y = 0; y < 3; y++)
            for (uint32_t x = 0; x < 2; x++)
                assert_int_equal(voxel(scene, x, y, z), narrow[(z * 3 + y) * 2 + x]);
    assert_int_equal(scene->view_count, 3);
    assert_int_equal(scene->prim_count, 1);
    bb_scene_free(scene);
    bb_scene_free(given);
    /* what is given counts more than the name */
    given = load_scene(with(named, "dims=3x2x2,type=uint16,endian=big,spacing=1x2x0.5"));
    assert_int_equal(voxel(given, 1, 0, 0), narrow[2] << 8 | narrow[3]);
    assert_true(given->volume->grid.cell[1] == 2 && given->volume->grid.cell[2] == 0.5f);
    bb_scene_free(given);
    given = load_scene(with(named, "dims=3x2x2,type=uint16,transfer=full"));
    assert_int_equal(voxel(given, 1, 0, 0), narrow[3] << 8 | narrow[2]);
    bb_scene_free(given);
}

static void bad_raw_volumes_are_refused(void **state)
{
    (void)state;
    static const uint8_t bytes[64] = {0};
    const char *plain = path_of("bad.raw"), *named = path_of("bad_4x4x4_uint8.raw");
    write_bytes(plain, bytes, sizeof bytes);
    write_bytes(named, bytes, sizeof bytes);
    expect_failure(plain, BB_INVALID, "how many voxels?");
    expect_failure(with(plain, "dims=4x4"), BB_INVALID, "how many voxels?");
    expect_failure(with(plain, "dims=4x4x4x"), BB_INVALID, "how many voxels?");
    expect_failure(with(plain, "dims=0x4x4"), BB_INVALID, "how many voxels?");
    expect_failure(with(plain, "dims=-4x4x4"), BB_INVALID, "how many voxels?");
    expect_failure(with(plain, "dims=4x4x4"), BB_INVALID, "which type has a voxel?");
    expect_failure(with(plain, "dims=4x4x4,type=float"), BB_INVALID, "type");
    expect_failure(with(plain, "dims=4x4x4,typ=uint8"), BB_INVALID, "typ");
    expect_failure(with(plain, "dims=4x4x4,type=uint16"), BB_INVALID, "has 64 bytes");
    expect_failure(with(plain, "dims=4x4x5,type=uint8"), BB_INVALID, "are 80");
    expect_failure(with(plain, "dims=64x1x1,type=uint8"), BB_INVALID, "1 voxels along y");
    expect_failure(with(plain, "dims=99999x9999x9999,type=uint8"), BB_REFUSED, "along x");
    expect_failure(with(plain, "dims=8000x8000x8000,type=uint8"), BB_REFUSED, "bytes");
    expect_failure(with(plain, "dims=4x4x4,type=uint8,spacing=1x1"), BB_INVALID, "spacing=1x1");
    expect_failure(with(plain, "dims=4x4x4,type=uint8,spacing=1x1x0"), BB_INVALID, "along z");
    expect_failure(with(plain, "dims=4x4x4,type=uint8,spacing=1x1x1x1"), BB_INVALID, "AxBxC");
    expect_failure(with(named, "transfer=nothing-like-it"), BB_INVALID, "transfer function");
    expect_failure(with(named, "brick=7"), BB_INVALID, "brick");
    expect_failure(named, BB_INVALID, "nothing of it is seen");
    expect_failure(with(path_of("none.raw"), "dims=4x4x4"), BB_INVALID, "no such file");
}

static void compressed_volumes_are_read(void **state)
{
    (void)state;
    uint8_t values[9 * 4 * 5], packed[1024], two[2048];
    for (size_t i = 0; i < sizeof values; i++)
        values[i] = (uint8_t)(i * 53);
    const char *path = path_of("z_9x4x5_uint8.raw.zst");
    size_t size = ZSTD_compress(packed, sizeof packed, values, sizeof values, 3);
    assert_false(ZSTD_isError(size));
    write_bytes(path, packed, size);
    bb_scene *scene = load_scene(path);
    assert_int_equal(voxel(scene, 8, 3, 4), values[sizeof values - 1]);
    bb_scene_free(scene);
    /* two frames, one after the other, are one file */
    size_t first = ZSTD_compress(two, sizeof two, values, 100, 3);
    size_t second =
        ZSTD_compress(two + first, sizeof two - first, values + 100, sizeof values - 100, 3);
    write_bytes(path, two, first + second);
    scene = load_scene(path);
    assert_int_equal(voxel(scene, 8, 3, 4), values[sizeof values - 1]);
    bb_scene_free(scene);
    expect_failure(with(path, "dims=9x4x4"), BB_INVALID, "expands to more");
    expect_failure(with(path, "dims=9x4x6"), BB_INVALID, "ends too soon");
    write_bytes(path, packed, size - 3);
    expect_failure(path, BB_INVALID, "ends too soon");
    write_bytes(path, values, sizeof values);
    expect_failure(path, BB_INVALID, "no zstd file");
    write_bytes(path, "", 0);
    expect_failure(path, BB_INVALID, "ends too soon");
}

/* ---- NRRD ---- */

static void write_nrrd(const char *path, const char *header, const void *data, size_t size)
{
    char bytes[4096];
    size_t length = strlen(header);
    memcpy(bytes, header, length);
    memcpy(bytes + length, data, size);
    write_bytes(path, bytes, length + size);
}

static void nrrd_volumes_are_read(void **state)
{
    (void)state;
    const char *path = path_of("a.nrrd");
    const uint16_t wide[8] = {0, 1, 2, 3, 65535, 5, 6, 700};
    const float floats[8] = {-1, 0, 0.5f, 1, 3, 2, 2.5f, -0.5f};
    write_nrrd(path,
               "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 2 2 2\nspacings: 1 2 nan\n"
               "endian: little\nencoding: raw\n\n",
               wide, sizeof wide);
    bb_scene *scene = load_scene(with(path, "transfer=full"));
    for (uint32_t i = 0; i < 8; i++)
        assert_int_equal(voxel(scene, i & 1, i >> 1 & 1, i >> 2), wide[i]);
    assert_true(scene->volume->grid.cell[1] == 2 && scene->volume->grid.cell[2] == 1);
    bb_scene_free(scene);
    write_nrrd(path,
               "NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 2 2 2\nspace directions: (1,0,0) (0,-3,0) (0,0,0.5)\nendian: little\n"
               "encoding: raw\n\n",
               floats, sizeof floats);
    scene = load_scene(with(path, "transfer=full"));
    assert_int_equal(voxel(scene, 0, 0, 0), 0);
    assert_int_equal(voxel(scene, 0, 0, 1), 65535);
    assert_int_equal(voxel(scene, 1, 1, 0), 32768);
    assert_true(scene->volume->grid.cell[1] == 3 && scene->volume->grid.cell[2] == 0.5f);
    bb_scene_free(scene);
}

static void bad_nrrd_volumes_are_refused(void **state)
{
    (void)state;
    const char *path = path_of("bad.nrrd");
    const uint8_t bytes[64] = {1, 2, 3};
    static const struct {
        const char *header, *words;
    } cases[] = {
        {"", "does not begin with 'NRRD000'"},
        {"P5 8 8 255\n", "does not begin with 'NRRD000'"},
        {"NRRD0009\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n",
         "teem does not read it"},
        {"NRRD0004\ntype: uchar\ndimension: 2\nsizes: 8 8\nencoding: raw\n\n", "2 axes"},
        {"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 8\nencoding: raw\n\n", "4 axes"},
        {"NRRD0004\ntype: block\nblock size: 1\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n",
         "no numbers"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 9 9\nencoding: raw\n\n", "truncated"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 90000 90000 90000\nencoding: gzip\n\n",
         "bytes"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 5 5\nencoding: gzip\n\n",
         "teem does not read it"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 64 1 1\nencoding: raw\n\n", "along y"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
         "data file: /etc/passwd\n\n",
         "/etc/passwd"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
         "data file: ../a.raw\n\n",
         "'../a.raw'"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\nDATA FILE: -\n\n",
         "'-'"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
         "datafile: slice%02d.raw 1 4 1\n\n",
         "several files"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
         "data file: none.raw\n\n",
         "none.raw"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
         "content: x\rdata file: /etc/passwd\n\n",
         "carriage return"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
         "data file: SKIPLIST\n0 /etc/passwd\n",
         "several files"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: a:x\n\n",
         "'a:x'"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: gzip\nbyte skip: -1\n\n",
         "from the end of compressed data"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4294967298 2 2\nencoding: raw\n\n",
         "4294967298 values along x"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 -4\nencoding: raw\n\n",
         "teem does not read it"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_nrrd(path, cases[i].header, bytes, sizeof bytes);
        bb_scene *scene = NULL;
        bb_status status = bb_scene_load(path, &scene);
        if (status != BB_INVALID && status != BB_REFUSED)
            fail_msg("status %d for %s", (int)status, cases[i].header);
        if (strstr(bb_message(), cases[i].words) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("the message lacks '%s': %s", cases[i].words, bb_message());
    }
    const float nan_value[8] = {1, 2, 3, NAN};
    write_nrrd(path,
               "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nendian: little\n"
               "encoding: raw\n\n",
               nan_value, sizeof nan_value);
    expect_failure(path, BB_INVALID, "value 3 (from 0)");
}

/* ---- MagicaVoxel ---- */

static size_t put_chunk(unsigned char *to, const char *id, const void *data, uint32_t size)
{
    memcpy(to, id, 4);
    for (int i = 0; i < 4; i++) {
        to[4 + i] = (unsigned char)(size >> 8 * i);
        to[8 + i] = 0;
    }
    memcpy(to + 12, data, size);
    return 12 + size;
}

/* A file of one model of `dims`, whose list claims `count` voxels and has those of `list`. */
static size_t make_vox(unsigned char *to, const uint8_t dims[3], uint8_t count, const uint8_t *list,
                       uint32_t listed)
{
    unsigned char shape[12] = {dims[0], 0, 0, 0, dims[1], 0, 0, 0, dims[2]};
    unsigned char voxels[64] = {count};
    size_t size = 8;
    memcpy(to, "VOX \226\0\0\0", 8);
    memcpy(voxels + 4, list, 4 * (size_t)listed);
    size += put_chunk(to + size, "MAIN", "", 0);
    size += put_chunk(to + size, "SIZE", shape, sizeof shape);
    return size + put_chunk(to + size, "XYZI", voxels, 4 + 4 * listed);
}

static void voxel_models_are_read(void **state)
{
    (void)state;
    static const uint8_t dims[3] = {3, 4, 2}, list[] = {0, 0, 0, 9, 2, 3, 1, 255};
    unsigned char bytes[512];
    const char *path = path_of("a.vox");
    size_t size = make_vox(bytes, dims, 2, list, 2);
    write_bytes(path, bytes, size);
    bb_scene *scene = load_scene(with(path, "transfer=full"));
    const bb_volume_grid *grid = &scene->volume->grid;
    assert_true(grid->cells[0] == 4 && grid->cells[1] == 3 && grid->cells[2] == 5);
    /* z, which is up there, is y here, and y is -z; one empty voxel around */
    assert_int_equal(voxel(scene, 1, 1, 4), 9);
    assert_int_equal(voxel(scene, 3, 2, 1), 255);
    assert_int_equal(voxel(scene, 2, 1, 4), 0);
    bb_scene_free(scene);
    expect_failure(with(path, "model=2"), BB_INVALID, "has 1 models");
    /* no length at which it is cut off makes it anything else than refused */
    for (size_t cut = 0; cut < size; cut++) {
        write_bytes(path, bytes, cut);
        expect_failure(path, BB_INVALID, path);
    }
    size = make_vox(bytes, dims, 3, list, 2);
    write_bytes(path, bytes, size);
    expect_failure(path, BB_INVALID, "claims 3 voxels");
    static const uint8_t outside[] = {0, 4, 0, 9};
    size = make_vox(bytes, dims, 1, outside, 1);
    write_bytes(path, bytes, size);
    expect_failure(path, BB_INVALID, "is at 4 along y");
    static const uint8_t none[3] = {3, 0, 2};
    size = make_vox(bytes, none, 0, list, 0);
    write_bytes(path, bytes, size);
    expect_failure(path, BB_INVALID, "0 voxels along y");
}

/* ---- real files ---- */

static char *read_whole(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

/* A file that is damaged loads, or is refused in one line. */
static void load_damaged(const char *name, const char *bytes, size_t size)
{
    const char *path = path_of(name);
    bb_scene *scene = NULL;
    write_bytes(path, bytes, size);
    bb_status status = bb_scene_load(path, &scene);
    if (status != BB_OK &&
        (strstr(bb_message(), path) == NULL || strchr(bb_message(), '\n') != NULL))
        fail_msg("%s: %s", name, bb_message());
    bb_scene_free(scene);
}

static void try_file(const char *folder, const char *name)
{
    char path[1200];
    snprintf(path, sizeof path, DATA "/%s/%s", folder, name);
    bb_scene *scene = load_scene(path);
    print_message("%s: %u of %u bricks\n", name, scene->prim_count, scene->volume->brick_count);
    assert_true(scene->prim_count > 0);
    bb_scene_free(scene);
    size_t size;
    char *bytes = read_whole(path, &size);
    bb_random random = bb_random_make(seed_or(5), size);
    for (int i = 0; i < 6; i++)
        load_damaged(name, bytes, i == 0 ? size - 1 : bb_random_u64(&random) % size);
    for (int i = 0; i < 6; i++) {
        size_t at = i < 3 ? bb_random_u64(&random) % 64 : bb_random_u64(&random) % size;
        char kept = bytes[at];
        bytes[at] = (char)~kept;
        load_damaged(name, bytes, size);
        bytes[at] = kept;
    }
    free(bytes);
}

static void real_volumes_are_read(void **state)
{
    (void)state;
    DIR *folders = opendir(DATA);
    if (folders == NULL) {
        print_message("skipped: there is no " DATA "\n");
        skip();
    }
    int files = 0;
    for (struct dirent *folder = readdir(folders); folder != NULL; folder = readdir(folders)) {
        char path[1200];
        snprintf(path, sizeof path, DATA "/%s", folder->d_name);
        DIR *inside = folder->d_name[0] != '.' ? opendir(path) : NULL;
        for (struct dirent *file = inside != NULL ? readdir(inside) : NULL; file != NULL;
             file = readdir(inside))
            if (strstr(file->d_name, ".raw") != NULL || strstr(file->d_name, ".vox") != NULL) {
                try_file(folder->d_name, file->d_name);
                files++;
            }
        if (inside != NULL)
            closedir(inside);
    }
    closedir(folders);
    assert_true(files >= 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(raw_volumes_are_read),
        cmocka_unit_test(bad_raw_volumes_are_refused),
        cmocka_unit_test(compressed_volumes_are_read),
        cmocka_unit_test(nrrd_volumes_are_read),
        cmocka_unit_test(bad_nrrd_volumes_are_refused),
        cmocka_unit_test(voxel_models_are_read),
        cmocka_unit_test(real_volumes_are_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
