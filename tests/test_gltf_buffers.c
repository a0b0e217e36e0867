/* Buffers of glTF files: which uris name one, that no more is read than is asked for, and that
 * what is too much is refused before it is read. */
#include "tests/scene_files.h"

#include <errno.h>
#include <stdint.h>
#include <sys/resource.h>
#include <unistd.h>

static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
enum { BYTES = sizeof corners, MANY = 64 };

static const char *path_of(const char *name)
{
    return test_path("gltf_buffers", name);
}

/* One triangle at `offset` of buffer `buffer`. Valid until the next call. */
static const char *write_model(const char *buffers, unsigned buffer, unsigned offset)
{
    const char *path = path_of("model.gltf");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file,
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[%s],\"bufferViews\":[{\"buffer\":%u,"
            "\"byteOffset\":%u,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
            "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{"
            "\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]}",
            buffers, buffer, offset);
    assert_int_equal(fclose(file), 0);
    return path;
}

/* The same with one buffer of this uri. */
static const char *write_uri(const char *uri, unsigned long long bytes)
{
    char *text = malloc(strlen(uri) + 100);
    assert_non_null(text);
    sprintf(text, "{\"byteLength\":%llu,\"uri\":\"%s\"}", bytes, uri);
    const char *path = write_model(text, 0, 0);
    free(text);
    return path;
}

static void expect_corners(const char *path)
{
    bb_scene *scene = load_scene(path);
    assert_int_equal(scene->vertex_count, 3);
    assert_memory_equal(scene->vertices, corners, BYTES);
    bb_scene_free(scene);
}

/* ---- uris ---- */

static void test_names(void **state)
{
    (void)state;
    static const char *const good[] = {"t.bin",      "./t.bin",     "%74%2Ebin", "sub/t.bin",
                                       "sub//t.bin", "sub%2ft.bin", "a..b",      "...",
                                       "..a",        "a%3Ab.bin",   "./a:b.bin", "100%.bin"};
    mkdir(path_of("sub"), 0777);
    static const char *const files[] = {"t.bin", "sub/t.bin", "a..b",    "...",
                                        "..a",   "a:b.bin",   "100%.bin"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        write_bytes(path_of(files[i]), corners, BYTES);
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        expect_corners(write_uri(good[i], BYTES));
}

static void test_refused_names(void **state)
{
    (void)state;
    static const struct {
        const char *uri, *words;
    } bad[] = {
        {"/etc/passwd", "absolute path"},
        {"%2Fetc/passwd", "absolute path"},
        {"//host/t.bin", "absolute path"},
        {"../t.bin", "leave its folder"},
        {"..", "leave its folder"},
        {"sub/../t.bin", "leave its folder"},
        {"sub/..", "leave its folder"},
        {"./../t.bin", "leave its folder"},
        {"%2e%2e/t.bin", "leave its folder"},
        {"%2E.%2Ft.bin", "leave its folder"},
        {"sub%2f..%2f..%2ft.bin", "leave its folder"},
        {"http://example.org/t.bin", "is not a file"},
        {"file:///etc/passwd", "is not a file"},
        {"file:t.bin", "is not a file"},
        {"FTP:t.bin", "is not a file"},
        {"a:b.bin", "is not a file"},
        {"", "empty uri"},
        {"t%00.bin", "zero byte"},
        {"gone.bin", "No such file"},
        {"sub", "not a regular file"},
        {"pipe", "not a regular file"},
    };
    mkdir(path_of("sub"), 0777);
    assert_true(mkfifo(path_of("pipe"), 0600) == 0 || errno == EEXIST);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        expect_failure(write_uri(bad[i].uri, BYTES), BB_INVALID, bad[i].words);
}

/* ---- data URIs ---- */

/* Base64 of bytes, from malloc. */
static char *encode(const unsigned char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *out = malloc((size + 2) / 3 * 4 + 1), *to = out;
    assert_non_null(out);
    for (size_t i = 0; i < size; i += 3) {
        uint32_t word = (uint32_t)bytes[i] << 16;
        word |= i + 1 < size ? (uint32_t)bytes[i + 1] << 8 : 0;
        word |= i + 2 < size ? bytes[i + 2] : 0;
        for (unsigned k = 0; k < 4; k++)
            *to++ = k > size - i ? '=' : digits[word >> (18 - 6 * k) & 63];
    }
    *to = '\0';
    return out;
}

/* Every length there is a remainder for, and more than is decoded in one piece. */
static void test_base64(void **state)
{
    (void)state;
    enum { LARGE = 100000 };
    unsigned char *bytes = calloc(LARGE + 8, 1);
    char *uri = malloc(LARGE / 3 * 4 + 100);
    assert_true(bytes != NULL && uri != NULL);
    for (size_t size = BYTES; size < BYTES + 4; size++)
        for (size_t front = 0; front < 2; front++) {
            size_t whole = size + front * (LARGE - BYTES) / 4 * 4;
            memset(bytes, 0xA5, whole);
            memcpy(bytes + whole / 4 * 4 - BYTES, corners, BYTES);
            char *text = encode(bytes, whole);
            sprintf(uri, "{\"byteLength\":%zu,\"uri\":\"%s,%s\"}", whole,
                    front ? "data:;base64" : "DATA:model/any;x=1;base64", text);
            expect_corners(write_model(uri, 0, (unsigned)(whole / 4 * 4 - BYTES)));
            free(text);
        }
    free(bytes);
    free(uri);
}

static void test_other_data_uris(void **state)
{
    (void)state;
    static const struct {
        const char *uri;
        unsigned bytes;
        const char *words;
    } bad[] = {
        {"data:;base64,AAAA", 9, "it has 3 of 9 bytes"},
        {"data:;base64,AAAAA", 4, "it has 3 of 4 bytes"},
        {"data:;base64,AAAAAA==", 5, "it has 4 of 5 bytes"},
        {"data:;base64,AA?AAAAAAAA", 3, "it has 1 of 3 bytes"},
        {"data:;base64,", 1, "it has 0 of 1 bytes"},
        {"data:AAAA", 4, "no comma"},
        {"data:,%00%0", 4, "it has 3 of 4 bytes"},
        {"data:;base64,AAAA", 4000000000u, "it has 3 of 4000000000 bytes"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        expect_failure(write_uri(bad[i].uri, bad[i].bytes), BB_INVALID, bad[i].words);
    /* Percent-encoded: 1.0f is 00 00 80 3F, and 3F may stand for itself. */
    expect_corners(write_uri("data:,%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80?"
                             "%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00%00and%20",
                             BYTES));
}

/* ---- sizes ---- */

/* Sparse: it has a size, but takes no room on the disk. */
static void write_sparse(const char *name, unsigned long long size)
{
    write_bytes(path_of(name), corners, BYTES);
    if (truncate(path_of(name), (off_t)size) != 0)
        fail_msg("%s: cannot have %llu bytes: %s", name, size, strerror(errno));
}

/* The most memory that this process has had so far. */
static uint64_t peak_bytes(void)
{
    struct rusage usage;
    assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
    return (uint64_t)usage.ru_maxrss * 1024;
}

/* MANY buffers of a length each: of one file, or each of its own name for it. */
static const char *write_many(const char *file, bool own_names, unsigned long long bytes)
{
    char buffers[MANY * 80], name[64];
    size_t used = 0;
    for (int i = 0; i < MANY; i++) {
        snprintf(name, sizeof name, own_names ? "%s.%d" : "%s", file, i);
        unlink(own_names ? path_of(name) : path_of("none"));
        if (own_names)
            assert_int_equal(symlink(file, path_of(name)), 0);
        used += (size_t)snprintf(buffers + used, sizeof buffers - used,
                                 "%s{\"byteLength\":%llu,\"uri\":\"%s\"}", i > 0 ? "," : "", bytes,
                                 name);
    }
    return write_model(buffers, MANY - 1, 0);
}

static uint64_t host_bytes(void)
{
    return (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* A file as large as the host's memory: a few bytes are read of it, or a megabyte once. */
static void test_no_more_than_is_asked_for(void **state)
{
    (void)state;
    enum { MEGABYTE = 1 << 20, SLACK = 24 * MEGABYTE };
    write_sparse("huge.bin", host_bytes());
    uint64_t before = peak_bytes();
    expect_corners(write_many("huge.bin", false, BYTES));
    expect_corners(write_many("huge.bin", true, BYTES));
    expect_corners(write_many("huge.bin", false, MEGABYTE));
    uint64_t after = peak_bytes();
    if (after - before > SLACK)
        fail_msg("took %llu bytes more", (unsigned long long)(after - before));
    unlink(path_of("huge.bin"));
}

/* Together beyond three quarters of the host's memory: refused at once, each alone would fit. */
static void test_too_much_is_refused(void **state)
{
    (void)state;
    uint64_t host = host_bytes(), before = peak_bytes();
    write_sparse("huge.bin", host);
    expect_failure(write_many("huge.bin", true, host / 32), BB_REFUSED, "three quarters");
    expect_failure(write_uri("huge.bin", host), BB_REFUSED, "three quarters");
    expect_failure(write_uri("huge.bin", host + 1), BB_INVALID, "is truncated");
    expect_failure(write_uri("huge.bin", UINT64_MAX), BB_INVALID, "is truncated");
    unlink(path_of("huge.bin"));
    write_sparse("huge.glb", host);
    expect_failure(path_of("huge.glb"), BB_REFUSED, "three quarters");
    unlink(path_of("huge.glb"));
    assert_true(peak_bytes() - before < 24 << 20);
}

/* Two lengths of one file: each buffer ends at its own. */
static void test_shared_with_other_lengths(void **state)
{
    (void)state;
    float twice[18];
    memcpy(twice, corners, BYTES);
    memcpy(twice + 9, corners, BYTES);
    write_bytes(path_of("twice.bin"), twice, sizeof twice);
    const char *buffers = "{\"byteLength\":36,\"uri\":\"twice.bin\"},"
                          "{\"byteLength\":72,\"uri\":\"twice.bin\"},"
                          "{\"byteLength\":40,\"uri\":\"twice.bin\"}";
    expect_corners(write_model(buffers, 0, 0));
    expect_corners(write_model(buffers, 1, 36));
    expect_failure(write_model(buffers, 0, 4), BB_INVALID, "beyond the 36 bytes of buffer 0");
    expect_failure(write_model(buffers, 1, 40), BB_INVALID, "beyond the 72 bytes of buffer 1");
    expect_failure(write_model(buffers, 2, 36), BB_INVALID, "beyond the 40 bytes of buffer 2");
    expect_failure(write_uri("twice.bin", 73), BB_INVALID, "it has 72 of 73 bytes");
}

static void test_without_bytes(void **state)
{
    (void)state;
    expect_failure(write_model("{\"byteLength\":36}", 0, 0), BB_INVALID, "has no data");
    expect_failure(write_model("{\"byteLength\":36,\"uri\":7}", 0, 0), BB_INVALID, "not a string");
}

/* What follows byteLength in the BIN chunk is padding, also if it is long. */
static void test_chunk(void **state)
{
    (void)state;
    for (unsigned bytes = BYTES - 1; bytes <= BYTES + 5; bytes++) {
        char text[600], file[2000] = "glTF\2";
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%u}],"
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{"
                 "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
                 "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                 "\"nodes\":[{\"mesh\":0}]}",
                 bytes);
        uint32_t json = ((uint32_t)strlen(text) + 3) / 4 * 4, binary = BYTES + 4;
        uint32_t head[] = {20 + json + 8 + binary, json, 0x4E4F534A}, next[] = {binary, 0x4E4942};
        memcpy(file + 8, head, sizeof head);
        memset(file + 20, ' ', json);
        memcpy(file + 20, text, strlen(text));
        memcpy(file + 20 + json, next, sizeof next);
        memcpy(file + 28 + json, corners, BYTES);
        write_bytes(path_of("chunk.glb"), file, head[0]);
        if (bytes < BYTES)
            expect_failure(path_of("chunk.glb"), BB_INVALID, "beyond the 35 bytes");
        else if (bytes > binary)
            expect_failure(path_of("chunk.glb"), BB_INVALID, "it has 40 of 41 bytes");
        else
            expect_corners(path_of("chunk.glb"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_more_than_is_asked_for),
        cmocka_unit_test(test_too_much_is_refused),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_refused_names),
        cmocka_unit_test(test_base64),
        cmocka_unit_test(test_other_data_uris),
        cmocka_unit_test(test_shared_with_other_lengths),
        cmocka_unit_test(test_without_bytes),
        cmocka_unit_test(test_chunk),
    };
    return cmocka_run_group_tests_name("gltf_buffers", tests, NULL, NULL);
}
