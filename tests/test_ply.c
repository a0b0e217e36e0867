/* PLY scenes in all three encodings, on files written here; and what must be refused, in one line
 * that says where. */
#include "tests/scene_files.h"

#include <unistd.h>

typedef enum encoding { ASCII, LITTLE, BIG } encoding;

/* A file that is being written, in any encoding. */
typedef struct writer {
    encoding encoding;
    unsigned char bytes[8192];
    size_t size;
} writer;

static void put_text(writer *to, const char *text)
{
    assert_true(to->size + strlen(text) < sizeof to->bytes);
    memcpy(to->bytes + to->size, text, strlen(text));
    to->size += strlen(text);
}

static void put_bits(writer *to, uint64_t bits, uint32_t size)
{
    for (uint32_t i = 0; i < size; i++)
        to->bytes[to->size++] =
            (unsigned char)(bits >> 8 * (to->encoding == LITTLE ? i : size - 1 - i));
}

static void put_whole(writer *to, int64_t value, uint32_t size)
{
    char text[32];
    snprintf(text, sizeof text, " %lld", (long long)value);
    if (to->encoding == ASCII)
        put_text(to, text);
    else
        put_bits(to, (uint64_t)value, size);
}

static void put_real(writer *to, double value, uint32_t size)
{
    char text[64];
    float single = (float)value;
    uint32_t bits32;
    uint64_t bits64;
    memcpy(&bits32, &single, 4);
    memcpy(&bits64, &value, 8);
    snprintf(text, sizeof text, " %.17g", value);
    if (to->encoding == ASCII)
        put_text(to, text);
    else
        put_bits(to, size == 4 ? bits32 : bits64, size);
}

static void end_row(writer *to)
{
    if (to->encoding == ASCII)
        put_text(to, "\n");
}

static const char *save(const writer *from)
{
    const char *path = test_path("ply", "case.ply");
    write_bytes(path, from->bytes, from->size);
    return path;
}

static void start(writer *to, encoding encoding, const char *elements)
{
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    to->encoding = encoding;
    to->size = 0;
    put_text(to, "ply\nformat ");
    put_text(to, names[encoding]);
    put_text(to, " 1.0\ncomment of a test\nobj_info \x01\n");
    put_text(to, elements);
    put_text(to, "end_header\n");
}

/* Everything at once: an element of others before and between, properties of all types around what
 * is read, lists that are not, doubles, a quad, a triangle, an edge. */
static void write_mixed(writer *to, encoding encoding)
{
    static const uint32_t quad[] = {0, 1, 2, 3}, triangle[] = {3, 2, 4}, edge[] = {0, 1};
    static const struct {
        const uint32_t *corners;
        uint32_t count;
    } faces[] = {{quad, 4}, {triangle, 3}, {edge, 2}};
    start(to, encoding,
          "element camera 1\nproperty double f\nproperty list ushort short n\n"
          "element vertex 5\nproperty char a\nproperty float64 z\nproperty uint8 red\n"
          "property double x\nproperty float32 y\nproperty list uint8 float w\n"
          "element material 2\nproperty uint n\n"
          "element face 3\nproperty int8 flag\nproperty list int uint32 vertex_indices\n"
          "property list uchar float texcoord\n");
    put_real(to, -0.5, 8);
    put_whole(to, 2, 2);
    put_whole(to, -7, 2);
    put_whole(to, 300, 2);
    end_row(to);
    for (int i = 0; i < 5; i++) {
        put_whole(to, -i, 1);
        put_real(to, 0.1 * i, 8);
        put_whole(to, 200 + i, 1);
        put_real(to, i * i, 8);
        put_real(to, -i, 4);
        put_whole(to, i % 2, 1);
        if (i % 2 == 1)
            put_real(to, 5, 4);
        end_row(to);
    }
    for (int i = 0; i < 2; i++) {
        put_whole(to, 4000000000, 4);
        end_row(to);
    }
    for (int f = 0; f < 3; f++) {
        put_whole(to, -1, 1);
        put_whole(to, faces[f].count, 4);
        for (uint32_t k = 0; k < faces[f].count; k++)
            put_whole(to, faces[f].corners[k], 4);
        put_whole(to, 0, 1);
        end_row(to);
    }
}

static void test_encodings(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 0, 2, 3, 3, 2, 4};
    for (encoding encoding = ASCII; encoding <= BIG; encoding++) {
        writer file;
        write_mixed(&file, encoding);
        bb_scene *scene = load_scene(save(&file));
        assert_string_equal(scene->source, "PLY");
        assert_int_equal(scene->vertex_count, 5);
        assert_int_equal(scene->prim_count, 3);
        assert_int_equal(scene->ignored, 1);
        assert_memory_equal(bb_scene_indices(scene), expected, sizeof expected);
        for (int i = 0; i < 5; i++) {
            const float *at = scene->vertices + 3 * i;
            assert_true(at[0] == (float)(i * i) && at[1] == (float)-i && at[2] == (float)(0.1 * i));
        }
        bb_scene_free(scene);
    }
}

/* Indices and counts of all whole types, faces before their vertices. */
static void test_types_of_indices(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t size;
    } types[] = {{"char", 1}, {"uchar", 1}, {"short", 2}, {"ushort", 2},
                 {"int", 4},  {"uint", 4},  {"int16", 2}, {"uint32", 4}};
    static const uint32_t expected[] = {2, 0, 1};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        char elements[256];
        writer file;
        snprintf(elements, sizeof elements,
                 "element face 1\nproperty list %s %s vertex_index\n"
                 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                 types[i].name, types[i].name);
        start(&file, (encoding)(i % 3), elements);
        put_whole(&file, 3, types[i].size);
        for (int k = 0; k < 3; k++)
            put_whole(&file, (int)expected[k], types[i].size);
        end_row(&file);
        for (int k = 0; k < 9; k++) {
            put_real(&file, k * k, 4);
            if (k % 3 == 2)
                end_row(&file);
        }
        bb_scene *scene = load_scene(save(&file));
        assert_memory_equal(bb_scene_indices(scene), expected, sizeof expected);
        bb_scene_free(scene);
    }
}

/* A file that ends anywhere else is refused, and nothing is read behind its end. */
static void test_truncated(void **state)
{
    (void)state;
    for (encoding encoding = ASCII; encoding <= BIG; encoding++) {
        writer file;
        write_mixed(&file, encoding);
        /* ASCII may do without its last end of line, and its last number is a 0 with a space */
        size_t whole = file.size - (encoding == ASCII ? 2 : 0);
        for (size_t size = 0; size < whole; size += size < 300 ? 7 : 1) {
            writer part = file;
            part.size = size;
            expect_failure(save(&part), BB_INVALID, test_path("ply", "case.ply"));
        }
    }
}

#define HEAD "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACE(n) "element face " #n "\nproperty list uchar int vertex_indices\n"
#define MESH HEAD "element vertex 3\n" XYZ FACE(1) "end_header\n"
#define THREE "0 0 0\n1 0 0\n0 1 0\n"

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"", "is empty"},
        {"plywood\n", "is not PLY: its first line is not 'ply'"},
        {"{\"asset\":{}}", "is not PLY"},
        {"ply\n", "is truncated: its header has no end_header"},
        {"ply\n\x01\n", "line 2 of its header is not text"},
        {"ply\nformat ascii 2.0\n", "line 2 of its header must be format ascii 1.0"},
        {"ply\nelement vertex 3\n", "line 2 of its header comes before the format"},
        {HEAD "elements vertex 3\n", "line 3 of its header must be format, element"},
        {HEAD "element vertex -3\n", "line 3 of its header must be element NAME COUNT"},
        {HEAD "element vertex 3x\n", "has a bad count of rows"},
        {HEAD "element vertex 99999999999999999999\n", "has a bad count of rows"},
        {HEAD "property float x\n", "is a property before the first element"},
        {HEAD "element vertex 3\nproperty real x\n", "line 4 of its header has an unknown type"},
        {HEAD "element vertex 3\nproperty float\n", "must be property TYPE NAME"},
        {HEAD "element vertex 3\n" XYZ "property float x\n", "repeats a property"},
        {HEAD "element vertex 3\nelement vertex 3\n", "repeats an element"},
        {HEAD "element face 1\nproperty list float int vertex_index\n",
         "has a list count of no integer type"},
        {HEAD "element face 1\nproperty list int float vertex_index\n",
         "has indices of no integer type"},
        {HEAD "end_header\n", "has no vertices"},
        {HEAD "element vertex 3\nproperty float x\nend_header\n", "have no x, y and z"},
        {HEAD "element vertex 3\n" XYZ "end_header\n" THREE,
         "holds points only: 3 vertices and no face"},
        {HEAD "element vertex 3\n" XYZ FACE(0) "end_header\n" THREE, "holds points only"},
        {HEAD "element vertex 3\n" XYZ "element face 1\nproperty int n\nend_header\n" THREE "1\n",
         "have no list vertex_indices or vertex_index"},
        {HEAD "element none 9\nelement vertex 3\n" XYZ FACE(1) "end_header\n",
         "its element none has no property"},
        {HEAD "element vertex 18446744073709551615\n" XYZ FACE(1) "end_header\n" THREE,
         "is truncated: 18446744073709551615 of vertex take 3 bytes each or more"},
        {MESH THREE "2 0 1\n", "holds no face of three corners (1 of fewer)"},
        {MESH THREE "3 0 1 3\n", "line 13: index 3 names no vertex, there are 3"},
        {MESH THREE "3 0 1 -1\n", "line 13: index -1 names no vertex"},
        {MESH THREE "3 0 1 1.5\n", "line 13: '1.5' is no int"},
        {MESH THREE "3 0 1 4294967296\n", "line 13: '4294967296' is no int"},
        {MESH THREE "256 0 1 2\n", "line 13: '256' is no uchar"},
        {MESH THREE "3 0 1\n2\n", "line 13 ends before the numbers of its face are there"},
        {MESH THREE "3 0 1 2 3\n", "line 13 has more numbers than its face needs"},
        {MESH "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11 ends before the numbers of its vertex"},
        {MESH "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", "line 11: the vertex is not finite: (1 0 nan)"},
        {MESH "0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n", "line 11: the vertex is not finite"},
        {MESH "0 0 0\n1 0 1e39\n0 1 0\n3 0 1 2\n", "line 11: the vertex is not finite"},
        {MESH "0 0 0\n1 0 0x1\n0 1 0\n3 0 1 2\n", "line 11: '0x1' is no float"},
        {MESH "0 0 0\n1 0 1e\n0 1 0\n3 0 1 2\n", "line 11: '1e' is no float"},
        {MESH "0 0 0\n1 0 \x02\n0 1 0\n3 0 1 2\n", "line 11: '?' is no float"},
        {MESH "0 0 0\n1 0 0\n", "is truncated: it ends in vertex 3 of 3"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = test_path("ply", "case.ply");
        write_text(path, cases[i].text);
        expect_failure(path, BB_INVALID, cases[i].words);
    }
    const char *path = test_path("ply", "strips.ply");
    write_text(path, HEAD "element vertex 3\n" XYZ "element tristrips 1\n"
                          "property list int int vertex_indices\nend_header\n" THREE "3 0 1 2\n");
    expect_failure(path, BB_UNSUPPORTED, "holds triangle strips, which are not read");
    path = test_path("ply", "folder.ply");
    mkdir(path, 0777);
    expect_failure(path, BB_INVALID, "is not a regular file");
}

/* What is wrong in a binary file has no line: its row is named. */
static void test_refused_in_binary(void **state)
{
    (void)state;
    static const char *const elements =
        "element vertex 3\n" XYZ "element face 1\nproperty list uint int vertex_indices\n";
    static const struct {
        double last;
        int64_t count, corner;
        const char *words;
    } cases[] = {
        {1, 3, 3, "face 0 (from 0): index 3 names no vertex, there are 3"},
        {1, 3, -2, "face 0 (from 0): index -2 names no vertex"},
        {1, 4000000000, 2, "is truncated: it ends in face 1 of 1"},
        {1e39, 3, 2, "vertex 2 (from 0): the vertex is not finite"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        writer file;
        start(&file, BIG, elements);
        for (int k = 0; k < 8; k++)
            put_real(&file, k % 4, 4);
        put_real(&file, cases[i].last, 4);
        put_whole(&file, cases[i].count, 4);
        put_whole(&file, 0, 4);
        put_whole(&file, 1, 4);
        put_whole(&file, cases[i].corner, 4);
        expect_failure(save(&file), BB_INVALID, cases[i].words);
    }
}

/* The Stanford bunny, where it is. */
static void test_bunny(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    const char *path = BB_TEST_SOURCE_DIR "/../shared/data/tri/bunny/bunny.ply";
    if (access(path, R_OK) != 0) {
        print_message("skipped: no %s\n", path);
        skip();
    }
    ASSERT_OK(bb_scene_load(path, &scene));
    assert_int_equal(scene->vertex_count, 35947);
    assert_int_equal(scene->prim_count, 69451);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_encodings),         cmocka_unit_test(test_types_of_indices),
        cmocka_unit_test(test_truncated),         cmocka_unit_test(test_refused),
        cmocka_unit_test(test_refused_in_binary), cmocka_unit_test(test_bunny),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
