/* The glTF loader, feature by feature, on files written here; and what it must refuse. */
#include "tests/scene_files.h"

#include <math.h>

/* The one buffer of most cases: 6 positions, then indices of each width, then sparse data. */
static const float positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                                      {0, 1, 0}, {0, 0, 1}, {-0.0f, 2, 1}};

typedef struct blob {
    float positions[6][3];   /* 0 */
    uint32_t wide[6];        /* 72 */
    uint16_t middle[6];      /* 96 */
    uint8_t narrow[6];       /* 108 */
    uint16_t replaced[1];    /* 114 */
    float replacement[1][3]; /* 116 */
    float interleaved[3][5]; /* 128: 8 bytes of something else after each position */
    int16_t quantised[3][4]; /* 188: stride 8 */
} blob;

static const char *path_of(const char *name)
{
    return test_path("gltf", name);
}

static void write_blob(const char *name)
{
    blob blob = {.wide = {0, 1, 2, 0, 2, 3},
                 .middle = {0, 1, 2, 0, 2, 3},
                 .narrow = {0, 1, 2, 0, 2, 3},
                 .replaced = {1},
                 .replacement = {{9, 8, 7}},
                 .interleaved = {{0, 0, 0, 5, 5}, {2, 0, 0, 5, 5}, {0, 2, 0, 5, 5}},
                 .quantised = {{0, 0, 0, 0}, {32767, 0, 0, 0}, {0, -32768, 100, 0}}};
    assert_int_equal(sizeof blob, 212);
    memcpy(blob.positions, positions, sizeof positions);
    write_bytes(path_of(name), &blob, sizeof blob);
}

/* A file with the usual buffer and views, and the given accessors, primitive and other members. */
static const char *write_case(const char *name, const char *accessors, const char *primitive,
                              const char *more)
{
    static char text[8192];
    const char *path = path_of(name);
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":212,\"uri\":\"case%%"
             "2Ebin\"}],"
             "\"bufferViews\":[{\"buffer\":0,\"byteLength\":72},"
             "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":24},"
             "{\"buffer\":0,\"byteOffset\":96,\"byteLength\":12},"
             "{\"buffer\":0,\"byteOffset\":108,\"byteLength\":6},"
             "{\"buffer\":0,\"byteOffset\":114,\"byteLength\":14},"
             "{\"buffer\":0,\"byteOffset\":128,\"byteLength\":60,\"byteStride\":20},"
             "{\"buffer\":0,\"byteOffset\":188,\"byteLength\":24,\"byteStride\":8}],"
             "\"accessors\":[%s],\"meshes\":[{\"name\":\"M\",\"primitives\":[%s]}]%s}",
             accessors, primitive, more);
    write_blob("case.bin");
    write_text(path, text);
    return path;
}

#define NODES ",\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]"
#define POSITIONS "{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\"}"
#define PLAIN "{\"attributes\":{\"POSITION\":0}}"
#define INDEXED "{\"attributes\":{\"POSITION\":0},\"indices\":1}"

static void expect_indices(const bb_scene *scene, const uint32_t *expected, uint32_t triangles)
{
    assert_int_equal(scene->prims[BB_TRIANGLE].count, triangles);
    assert_memory_equal(bb_scene_indices(scene), expected, 12 * triangles);
}

/* A -0 comes in as +0: they are equal, but not the same bits. */
static void expect_positions(const bb_scene *scene)
{
    for (int i = 0; i < 18; i++) {
        assert_true(scene->vertices[i] == positions[i / 3][i % 3]);
        assert_false(signbit(scene->vertices[i]));
    }
}

static void test_not_indexed(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 3, 4, 5};
    bb_scene *scene = load_scene(write_case("plain.gltf", POSITIONS, PLAIN, NODES));
    expect_indices(scene, expected, 2);
    assert_int_equal(scene->vertex_count, 6);
    /* Every bit, the sign of zero included. */
    expect_positions(scene);
    assert_string_equal(scene->source, "glTF");
    assert_int_equal(scene->kinds, BB_TRIANGLES);
    assert_true(scene->view_count >= 3);
    bb_scene_free(scene);
}

static void test_index_widths(void **state)
{
    (void)state;
    static const uint32_t expected[] = {0, 1, 2, 0, 2, 3};
    static const struct {
        int view, type;
    } widths[] = {{1, 5125}, {2, 5123}, {3, 5121}};
    for (int i = 0; i < 3; i++) {
        char accessors[512];
        snprintf(accessors, sizeof accessors,
                 POSITIONS
                 ",{\"bufferView\":%d,\"componentType\":%d,\"count\":6,\"type\":\"SCALAR\"}",
                 widths[i].view, widths[i].type);
        bb_scene *scene = load_scene(write_case("width.gltf", accessors, INDEXED, NODES));
        expect_indices(scene, expected, 2);
        bb_scene_free(scene);
    }
}

static void test_strip_and_fan(void **state)
{
    (void)state;
    static const uint32_t strip[] = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4};
    static const uint32_t fan[] = {1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0};
    bb_scene *scene = load_scene(
        write_case("strip.gltf", POSITIONS, "{\"attributes\":{\"POSITION\":0},\"mode\":5}", NODES));
    expect_indices(scene, strip, 4);
    bb_scene_free(scene);
    scene = load_scene(
        write_case("fan.gltf", POSITIONS, "{\"attributes\":{\"POSITION\":0},\"mode\":6}", NODES));
    expect_indices(scene, fan, 4);
    bb_scene_free(scene);
}

static void test_sparse(void **state)
{
    (void)state;
    const char *sparse =
        "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":4,\"componentType\":5123},"
        "\"values\":{\"bufferView\":4,\"byteOffset\":2}}}";
    char accessor[512];
    snprintf(accessor, sizeof accessor,
             "{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"VEC3\",%s", sparse);
    bb_scene *scene = load_scene(write_case("sparse.gltf", accessor, PLAIN, NODES));
    const float replaced[] = {0, 0, 0, 9, 8, 7, 1, 1, 0};
    assert_memory_equal(scene->vertices, replaced, sizeof replaced);
    bb_scene_free(scene);
    /* Without a bufferView the base is zero. */
    snprintf(accessor, sizeof accessor, "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",%s",
             sparse);
    scene = load_scene(write_case("zeros.gltf", accessor, PLAIN, NODES));
    const float zeros[] = {0, 0, 0, 9, 8, 7, 0, 0, 0};
    assert_memory_equal(scene->vertices, zeros, sizeof zeros);
    assert_int_equal(scene->profile.zero_area, 1);
    bb_scene_free(scene);
    /* Indices may be sparse too: 0 0 0 with the second one replaced by 1 (the first u16 of view 4).
     */
    snprintf(accessor, sizeof accessor,
             POSITIONS
             ",{\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\","
             "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":4,\"componentType\":5123},"
             "\"values\":{\"bufferView\":4}}}");
    scene = load_scene(write_case("sparse-indices.gltf", accessor, INDEXED, NODES));
    const uint32_t indices[] = {0, 1, 0};
    expect_indices(scene, indices, 1);
    bb_scene_free(scene);
}

static void test_interleaved_and_quantised(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(write_case(
        "interleaved.gltf",
        "{\"bufferView\":5,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}", PLAIN, NODES));
    const float expected[] = {0, 0, 0, 2, 0, 0, 0, 2, 0};
    assert_memory_equal(scene->vertices, expected, sizeof expected);
    bb_scene_free(scene);
    const char *normalised = "{\"bufferView\":6,\"componentType\":5122,\"normalized\":true,"
                             "\"count\":3,\"type\":\"VEC3\"}";
    scene = load_scene(write_case("quantised.gltf", normalised, PLAIN,
                                  NODES ",\"extensionsRequired\":[\"KHR_mesh_quantization\"]"));
    const float scaled[] = {0, 0, 0, 1, 0, 0, 0, -1, (float)(100 / 32767.0)};
    assert_memory_equal(scene->vertices, scaled, sizeof scaled);
    bb_scene_free(scene);
    expect_failure(write_case("integer.gltf", normalised, PLAIN, NODES), BB_INVALID,
                   "KHR_mesh_quantization");
}

/* Quarter turn about z, scale by 2, 3 and 4 before it, shift; below a parent that shifts; and the
 * same as a matrix. */
static void test_transforms(void **state)
{
    (void)state;
    bb_scene *scene =
        load_scene(write_case("trs.gltf", POSITIONS, PLAIN,
                              ",\"nodes\":[{\"translation\":[10,0,0],\"children\":[1]},"
                              "{\"mesh\":0,\"translation\":[0,0,5],\"rotation\":[0,0,0."
                              "7071067811865476,0.7071067811865476],"
                              "\"scale\":[2,3,4]}],\"scenes\":[{\"nodes\":[0]}]"));
    const float turned[] = {10, 0, 5, 10, 2, 5, 7, 2, 5};
    for (int i = 0; i < 9; i++)
        assert_true(fabsf(scene->vertices[i] - turned[i]) < 1e-6f);
    bb_scene_free(scene);
    scene = load_scene(
        write_case("matrix.gltf", POSITIONS, PLAIN,
                   ",\"nodes\":[{\"mesh\":0,\"matrix\":[0,2,0,0,-3,0,0,0,0,0,4,0,10,0,5,1]}],"
                   "\"scenes\":[{\"nodes\":[0]}]"));
    assert_memory_equal(scene->vertices, turned, sizeof turned);
    bb_scene_free(scene);
}

/* All scenes, each node once; without scenes, all roots; nodes of no scene are not there. */
static void test_scenes(void **state)
{
    (void)state;
    const char *nodes =
        ",\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[0,0,3]},{\"mesh\":0}]";
    char more[512];
    snprintf(more, sizeof more, "%s,\"scenes\":[{\"nodes\":[1]},{\"nodes\":[0,1]},{}]", nodes);
    bb_scene *scene = load_scene(write_case("scenes.gltf", POSITIONS, PLAIN, more));
    assert_int_equal(scene->prims[BB_TRIANGLE].count, 4);
    assert_true(scene->vertices[2] == 3);
    bb_scene_free(scene);
    scene = load_scene(write_case("roots.gltf", POSITIONS, PLAIN, nodes));
    assert_int_equal(scene->prims[BB_TRIANGLE].count, 6);
    bb_scene_free(scene);
}

/* Primitives that share positions share vertices; points and primitives without positions are
 * counted. */
static void test_sharing_and_ignored(void **state)
{
    (void)state;
    bb_scene *scene =
        load_scene(write_case("shared.gltf", POSITIONS,
                              PLAIN "," PLAIN ",{\"attributes\":{\"POSITION\":0},\"mode\":0},"
                                    "{\"attributes\":{},\"mode\":4}",
                              NODES));
    assert_int_equal(scene->prims[BB_TRIANGLE].count, 4);
    assert_int_equal(scene->vertex_count, 6);
    assert_int_equal(scene->ignored, 2);
    assert_int_equal(scene->profile.duplicate_boxes, 2);
    bb_scene_free(scene);
}

/* Missing images, unknown extras, materials of any kind: nobody looks. */
static void test_images_are_left_alone(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(write_case(
        "images.gltf", POSITIONS, "{\"attributes\":{\"POSITION\":0,\"NORMAL\":7},\"material\":3}",
        NODES ",\"images\":[{\"uri\":\"missing.png\"},{},{\"bufferView\":99}],\"textures\":[{"
              "\"source\":7}],"
              "\"extensionsRequired\":[\"KHR_texture_basisu\",\"KHR_materials_unlit\"],"
              "\"materials\":\"none\",\"extras\":[[[[1]]]]"));
    assert_int_equal(scene->prims[BB_TRIANGLE].count, 2);
    bb_scene_free(scene);
}

static void test_data_uri(void **state)
{
    (void)state;
    /* (0,0,0) (1,0,0) (0,1,0) */
    const char *text =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":"
        "\"data:application/x-any;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,"
        "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[" PLAIN "]}]" NODES "}";
    const float expected[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    write_text(path_of("data.gltf"), text);
    bb_scene *scene = load_scene(path_of("data.gltf"));
    assert_memory_equal(scene->vertices, expected, sizeof expected);
    bb_scene_free(scene);
}

/* ---- GLB ---- */

typedef struct glb {
    unsigned char bytes[2048];
    uint32_t size;
} glb;

static void put_word(glb *out, uint32_t at, uint32_t word)
{
    memcpy(out->bytes + at, &word, 4);
}

static void put_chunk(glb *out, uint32_t type, const void *data, uint32_t size, char fill)
{
    uint32_t padded = (size + 3) / 4 * 4;
    put_word(out, out->size, padded);
    put_word(out, out->size + 4, type);
    memcpy(out->bytes + out->size + 8, data, size);
    memset(out->bytes + out->size + 8 + size, fill, padded - size);
    out->size += 8 + padded;
    put_word(out, 8, out->size);
}

static glb make_glb(void)
{
    const char *text = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":72}],"
                       "\"bufferViews\":[{\"buffer\":0,"
                       "\"byteLength\":72}],\"accessors\":[" POSITIONS
                       "],\"meshes\":[{\"primitives\":[" PLAIN "]}]" NODES "}";
    glb out = {.size = 12};
    put_word(&out, 0, 0x46546C67);
    put_word(&out, 4, 2);
    put_chunk(&out, 0x4E4F534A, text, (uint32_t)strlen(text), ' ');
    put_chunk(&out, 0x004E4942, positions, sizeof positions, 0);
    return out;
}

static void test_glb(void **state)
{
    (void)state;
    glb file = make_glb();
    put_chunk(&file, 0x12345678, "unknown", 7, 0);
    write_bytes(path_of("good.GLB"), file.bytes, file.size);
    bb_scene *scene = load_scene(path_of("good.GLB"));
    expect_positions(scene);
    bb_scene_free(scene);
}

/* Cut anywhere, the file is an error and nothing else. */
static void test_glb_truncated(void **state)
{
    (void)state;
    glb file = make_glb();
    const char *path = path_of("cut.glb");
    write_bytes(path, file.bytes, 0);
    expect_failure(path, BB_INVALID, "is empty");
    for (uint32_t size = 1; size < file.size; size++) {
        write_bytes(path, file.bytes, size);
        expect_failure(path, BB_INVALID, "is truncated");
        glb shorter = file; /* the header agrees: the chunks don't */
        if (size < 12)
            continue;
        put_word(&shorter, 8, size);
        write_bytes(path, shorter.bytes, size);
        expect_failure(path, BB_INVALID, "cut.glb: ");
    }
}

/* Each byte of the file changed: an error or a scene, never a crash. */
static void test_glb_flipped(void **state)
{
    (void)state;
    glb file = make_glb();
    const char *path = path_of("flipped.glb");
    write_text(path_of("flipped.views"),
               "a eye=0,0,5 target=0,0,0 up=0,1,0 fov=45\n"); /* saves deriving */
    for (uint32_t at = 0; at < file.size; at++) {
        glb flipped = file;
        flipped.bytes[at] ^= at % 2 != 0 ? 0x80 : 0x11;
        write_bytes(path, flipped.bytes, flipped.size);
        bb_scene *scene = NULL;
        if (bb_scene_load(path, &scene) == BB_OK)
            bb_scene_free(scene);
        else
            assert_non_null(strstr(bb_message(), "flipped.glb"));
    }
}

/* ---- refusals ---- */

typedef struct refusal {
    const char *accessors;
    const char *primitive;
    const char *more;
    bb_status status;
    const char *words;
} refusal;

#define INDICES(view, type, count)                                                                 \
    POSITIONS ",{\"bufferView\":" #view ",\"componentType\":" #type ",\"count\":" #count           \
              ",\"type\":\"SCALAR\"}"
#define POSITIONS_AT(rest) "{\"componentType\":5126,\"type\":\"VEC3\"," rest "}"

static const refusal refusals[] = {
    {POSITIONS, PLAIN, NODES ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
     BB_UNSUPPORTED, "KHR_draco_mesh_compression"},
    {POSITIONS, PLAIN, NODES ",\"extensionsRequired\":[\"EXT_meshopt_compression\"]",
     BB_UNSUPPORTED, "EXT_meshopt_compression"},
    {POSITIONS, PLAIN, NODES ",\"extensionsRequired\":[\"VENDOR_new\"]", BB_UNSUPPORTED,
     "VENDOR_new"},
    {POSITIONS_AT("\"count\":3"),
     "{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":{}}}", NODES,
     BB_UNSUPPORTED, "KHR_draco_mesh_compression"},
    {POSITIONS, "{\"attributes\":{\"POSITION\":0},\"mode\":0},{\"attributes\":{}}", NODES,
     BB_INVALID,
     "holds no triangles: of the primitives in its scenes, 1 are points or lines and 1 lack "
     "positions"},
    {POSITIONS, PLAIN, ",\"nodes\":[{}],\"scenes\":[{\"nodes\":[0]}]", BB_INVALID, "no triangle"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":1}]", BB_INVALID, "mesh is 1"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":-1}]", BB_INVALID, "mesh is -1"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":4294967296}]", BB_INVALID, "4294967296"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0.0}]", BB_INVALID, "whole number"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0,\"matrix\":\"x\"}]", BB_INVALID, "matrix"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0,\"scale\":[1,2]}]", BB_INVALID, "scale"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0,\"scale\":[1e999,1,1]}]", BB_INVALID, "not glTF"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0,\"scale\":[1e200,1,1]}]", BB_INVALID,
     "mesh 0 (M), primitive 0: vertex 1 is not finite"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0,\"rotation\":[0,0,0,0]}]", BB_INVALID, "length 0"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"mesh\":0,\"children\":[0]}]", BB_INVALID, "cycle"},
    {POSITIONS, PLAIN,
     ",\"nodes\":[{\"children\":[1]},{\"mesh\":0,\"children\":[2]},{\"children\":[1]}]", BB_INVALID,
     "is a child of node"},
    {POSITIONS, PLAIN, ",\"nodes\":[{\"children\":[1]},{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]}]",
     BB_INVALID, "root of scene 0"},
    {POSITIONS, "{\"attributes\":{\"POSITION\":0},\"mode\":7}", NODES, BB_INVALID, "mode is 7"},
    {POSITIONS, "{\"attributes\":{\"POSITION\":1}}", NODES, BB_INVALID, "POSITION is 1"},
    {POSITIONS, "{}", NODES, BB_INVALID, "'attributes' property is missing"},
    {POSITIONS, "7", NODES, BB_INVALID, "not a JSON object"},
    {INDICES(0, 5125, 6), INDEXED, NODES, BB_INVALID, "index 3 is 1065353216"},
    {INDICES(1, 5125, 5), INDEXED, NODES, BB_INVALID, "whole number of triangles"},
    {INDICES(1, 5125, 7), INDEXED, NODES, BB_INVALID, "reach beyond"},
    {INDICES(1, 5125, 18446744073709551615), INDEXED, NODES, BB_INVALID, "reach beyond"},
    {INDICES(1, 5124, 6), INDEXED, NODES, BB_INVALID, "unsigned 8, 16 or 32"},
    {INDICES(1, 5126, 6), INDEXED, NODES, BB_INVALID, "unsigned 8, 16 or 32"},
    {INDICES(9, 5125, 6), INDEXED, NODES, BB_INVALID, "bufferView is 9"},
    {POSITIONS_AT("\"bufferView\":0,\"count\":0"), PLAIN, NODES, BB_INVALID, "count is 0"},
    {POSITIONS_AT("\"bufferView\":0,\"count\":7"), PLAIN, NODES, BB_INVALID, "reach beyond"},
    {POSITIONS_AT("\"bufferView\":0,\"count\":-3"), PLAIN, NODES, BB_INVALID, "count is -3"},
    {POSITIONS_AT("\"bufferView\":0,\"byteOffset\":18446744073709551612,\"count\":3"), PLAIN, NODES,
     BB_INVALID, "reach beyond"},
    {POSITIONS_AT("\"count\":3000000000"), PLAIN, NODES, BB_REFUSED, "no data"},
    {POSITIONS_AT("\"bufferView\":0,\"count\":6,\"normalized\":true"), PLAIN, NODES, BB_INVALID,
     "normalized"},
    {POSITIONS_AT(
         "\"bufferView\":0,\"count\":3,\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,"
         "\"byteOffset\":20,\"componentType\":5125},\"values\":{\"bufferView\":0}}"),
     PLAIN, NODES, BB_INVALID, "sparse index 0 is 3"},
    {POSITIONS_AT(
         "\"bufferView\":0,\"count\":3,\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":4,"
         "\"componentType\":5123},\"values\":{\"bufferView\":0}}"),
     PLAIN, NODES, BB_INVALID, "sparse index 1"},
    {POSITIONS_AT(
         "\"bufferView\":0,\"count\":3,\"sparse\":{\"count\":4,\"indices\":{\"bufferView\":1,"
         "\"componentType\":5125},\"values\":{\"bufferView\":0}}"),
     PLAIN, NODES, BB_INVALID, "replaces 4 of its 3"},
    {"{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"VEC2\"}", PLAIN, NODES,
     BB_INVALID, "VEC3 of float"},
    {"{\"bufferView\":0,\"componentType\":5126,\"count\":6,\"type\":\"vec3\"}", PLAIN, NODES,
     BB_INVALID, "\"vec3\""},
};

static void test_refusals(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        const refusal *r = &refusals[i];
        expect_failure(write_case("refused.gltf", r->accessors, r->primitive, r->more), r->status,
                       r->words);
    }
}

/* A vertex that is not a number is named, even if no triangle uses it. */
static void test_not_finite(void **state)
{
    (void)state;
    const char *path = write_case("finite.gltf", INDICES(1, 5125, 6), INDEXED, NODES);
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        write_blob("case.bin");
        FILE *file = fopen(path_of("case.bin"), "r+b");
        assert_non_null(file);
        fseek(file, 12 * 4 + 4, SEEK_SET);
        fwrite(&bad[i], sizeof bad[i], 1, file);
        fclose(file);
        expect_failure(path, BB_INVALID, "mesh 0 (M), primitive 0: vertex 4 is not finite");
    }
}

static void test_bad_files(void **state)
{
    (void)state;
    const char *path = path_of("bad.gltf");
    static const struct {
        const char *text;
        const char *words;
    } texts[] = {
        {"", "is empty"},
        {"{", "is not glTF, or truncated: its JSON breaks off in line 1"},
        {"{\"asset\":\n{\"version\":\"2", "breaks off in line 2"},
        {"solid cube\nfacet", "is not glTF: line 1, column 1 is not JSON"},
        {"{\"asset\":\n {\"version\" 2}}", "is not glTF: line 2, column 13 is not JSON"},
        {"{\"asset\":1e999}", "is not glTF: its JSON holds a number that is too large"},
        {"\xff\x01", "is not glTF: line 1, column 1 is not JSON"},
        {"[]", "not an object"},
        {"{}", "not glTF 2.0"},
        {"{\"asset\":{\"version\":\"1.0\"}}", "version '1.0'"},
        {"{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}", "version '2.1'"},
        {"{\"asset\":{\"version\":\"2.0\"}}",
         "holds no triangles: no node of its scenes has a mesh"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1e300,\"uri\":\"x\"}]}",
         "byteLength"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":\"gone.bin\"}]}",
         "gone.bin"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":\"http://x/"
         "y\"}]}",
         "not a file"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":\"/dev/zero\"}]}",
         "absolute"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":9,\"uri\":\"data:;base64,"
         "AAAA\"}]}",
         "truncated"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":{}}", "not an array"},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        write_text(path, texts[i].text);
        expect_failure(path, BB_INVALID, texts[i].words);
    }
    expect_failure(path_of("none.glb"), BB_INVALID, "no such file");
    write_text(path_of("text.GLB"), "{\"asset\":{\"version\":\"2.0\"}}");
    expect_failure(path_of("text.GLB"), BB_INVALID,
                   "is not binary glTF: it does not begin with 'glTF'");
    write_text(path_of("thing.stl"), "solid");
    expect_failure(path_of("thing.stl"), BB_INVALID,
                   "one of .gltf, .glb, .msh, .mesh, .vtk, .nrrd");
    mkdir(path_of("folder.glb"), 0777);
    expect_failure(path_of("folder.glb"), BB_INVALID, "regular file");
}

/* A million brackets, a chain of 100,000 nodes: neither recursion nor memory gives way. */
static void test_deep(void **state)
{
    (void)state;
    enum { DEPTH = 1000000, CHAIN = 100000 };
    char *text = malloc(DEPTH + 64 * CHAIN);
    assert_non_null(text);
    memset(text, '[', DEPTH);
    write_bytes(path_of("deep.gltf"), text, DEPTH);
    expect_failure(path_of("deep.gltf"), BB_INVALID, "nested");
    size_t used = (size_t)sprintf(text, "%s", ",\"nodes\":[");
    for (int i = 0; i < CHAIN; i++)
        used += (size_t)sprintf(text + used, "{\"children\":[%d]},", i + 1);
    sprintf(text + used, "{\"mesh\":0}]");
    char *file = malloc(used + 4096);
    assert_non_null(file);
    sprintf(file,
            "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"componentType\":5126,\"count\":3,"
            "\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[" PLAIN "]}]%s}",
            text);
    write_text(path_of("chain.gltf"), file);
    bb_scene *scene = load_scene(path_of("chain.gltf"));
    assert_int_equal(scene->prims[BB_TRIANGLE].count, 1);
    bb_scene_free(scene);
    free(text);
    free(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_not_indexed),
        cmocka_unit_test(test_index_widths),
        cmocka_unit_test(test_strip_and_fan),
        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_interleaved_and_quantised),
        cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_sharing_and_ignored),
        cmocka_unit_test(test_images_are_left_alone),
        cmocka_unit_test(test_data_uri),
        cmocka_unit_test(test_glb),
        cmocka_unit_test(test_glb_truncated),
        cmocka_unit_test(test_glb_flipped),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_deep),
    };
    return cmocka_run_group_tests_name("gltf", tests, NULL, NULL);
}
