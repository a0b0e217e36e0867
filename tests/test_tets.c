/* Tetrahedra: exact sides against MPFR, which of them lie on the boundary against brute force, the
 * generator, and files, good ones and bad: TetGen's, and by Gmsh's library. Real files only where
 * ../shared is there. Seed: BVHBENCH_TEST_SEED. A few seconds. */
#include "framework/base/beside.h"
#include "framework/base/random.h"
#include "framework/scene/exact.h"
#include "framework/scene/prim.h"
#include "framework/scene/tets.h"
#include "tests/scene_files.h"

#include <math.h>
#include <mpfr.h>
#include <string.h>
#include <unistd.h>
#include <zstd.h>

static uint64_t seed;

static const char *byte_file(const char *name, const void *bytes, size_t size)
{
    const char *path = test_path("tets", name);
    write_bytes(path, bytes, size);
    return path;
}

static const char *text_file(const char *name, const char *text)
{
    return byte_file(name, text, strlen(text));
}

/* ---- sides ---- */

static int reference_side(const double p[3], const float a[3], const float b[3], const float c[3])
{
    mpfr_t v[3][3], x, y, sum;
    const float *corners[2] = {b, c};
    mpfr_inits2(2400, x, y, sum, (mpfr_ptr)0);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            mpfr_init2(v[i][k], 2400);
            mpfr_set_d(v[i][k], i == 0 ? p[k] : (double)corners[i - 1][k], MPFR_RNDN);
            mpfr_sub_d(v[i][k], v[i][k], (double)a[k], MPFR_RNDN);
        }
    mpfr_set_zero(sum, 1);
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        mpfr_mul(x, v[1][m], v[2][n], MPFR_RNDN);
        mpfr_mul(y, v[1][n], v[2][m], MPFR_RNDN);
        mpfr_sub(x, x, y, MPFR_RNDN);
        mpfr_mul(x, x, v[0][k], MPFR_RNDN);
        mpfr_add(sum, sum, x, MPFR_RNDN);
    }
    int sign = mpfr_sgn(sum);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            mpfr_clear(v[i][k]);
    mpfr_clears(x, y, sum, (mpfr_ptr)0);
    return sign > 0 ? 1 : sign < 0 ? -1 : 0;
}

static void sides_are_exact(void **state)
{
    (void)state;
    enum { CASES = 20000 };
    uint32_t on = 0;
    for (uint32_t n = 0; n < CASES; n++) {
        bb_random random = bb_random_make(seed, n);
        float v[3][3];
        double p[3], w[2];
        bool whole = bb_random_below(&random, 2) == 0;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                v[i][k] = whole ? (float)bb_random_below(&random, 5)
                                : (float)ldexp(bb_random_range(&random, -1, 1),
                                               (int)bb_random_below(&random, 60) - 30);
        w[0] = whole ? 0.25 * bb_random_below(&random, 9) : bb_random_unit(&random);
        w[1] = whole ? 0.25 * bb_random_below(&random, 9) : bb_random_unit(&random);
        for (int k = 0; k < 3; k++) /* on the plane, but for rounding */
            p[k] =
                v[0][k] + w[0] * ((double)v[1][k] - v[0][k]) + w[1] * ((double)v[2][k] - v[0][k]);
        int side = reference_side(p, v[0], v[1], v[2]);
        on += side == 0;
        assert_int_equal(bb_exact_side(p, v[0], v[1], v[2]), side);
    }
    assert_true(on > CASES / 3 && on < CASES * 9 / 10);
}

/* ---- the boundary ---- */

static const float *vertex(const bb_scene *scene, uint32_t tet, int corner)
{
    return scene->vertices + 3 * (size_t)bb_scene_tet(scene, tet)[corner];
}

static bool has_vertex(const bb_scene *scene, uint32_t tet, uint32_t index)
{
    bool has = false;
    for (int c = 0; c < 4; c++)
        has = has || bb_scene_tet(scene, tet)[c] == index;
    return has;
}

static int side_of(const bb_scene *scene, uint32_t tet, int corner, const uint32_t face[3])
{
    const float *v = vertex(scene, tet, corner);
    const double at[3] = {v[0], v[1], v[2]};
    return bb_exact_side(at, scene->vertices + 3 * (size_t)face[0],
                         scene->vertices + 3 * (size_t)face[1],
                         scene->vertices + 3 * (size_t)face[2]);
}

/* Whether there are tetrahedra on both sides of the face. */
static bool is_inside(const bb_scene *scene, uint32_t tet, int f)
{
    uint32_t face[3];
    bool sides[3] = {false, false, false};
    for (int c = 0; c < 3; c++)
        face[c] = bb_scene_tet(scene, tet)[bb_tet_faces[f][c]];
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++)
        for (int c = 0; c < 4; c++)
            if (has_vertex(scene, i, face[0]) && has_vertex(scene, i, face[1]) &&
                has_vertex(scene, i, face[2]))
                sides[1 + side_of(scene, i, c, face)] = true;
    return sides[0] && sides[2];
}

static void expect_flags(const bb_scene *scene)
{
    uint32_t boundary = 0, flat = 0, negative = 0;
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++) {
        uint32_t flags = scene->tets->flags[i], expected = 0;
        const float *v[4];
        for (int f = 0; f < 4; f++) {
            v[f] = vertex(scene, i, f);
            expected |= is_inside(scene, i, f) ? 0 : 1u << f;
        }
        boundary += expected != 0;
        int side = bb_tet_side(v);
        expected |= side == 0 ? BB_TET_FLAT : side < 0 ? BB_TET_NEGATIVE : 0;
        flat += side == 0;
        negative += side < 0;
        if (flags != expected)
            fail_msg("%s: tetrahedron %u has the flags %#x, not %#x", scene->name, i, flags,
                     expected);
    }
    assert_int_equal(scene->tets->boundary_count, boundary);
    assert_int_equal(scene->tets->flat_count, flat);
    assert_int_equal(scene->tets->negative_count, negative);
}

static void flags_are_those_of_brute_force(void **state)
{
    (void)state;
    const char *const scenes[] = {
        "tets:side=1,shape=block", "tets:side=4", "tets:side=6,shape=shell",
        "tets:side=4,flip=3,flat=5,twins=7,jitter=0.5", "tets:side=3,shape=block,grade=3,jitter=0"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        bb_scene *scene = load_scene(scenes[i]);
        assert_int_equal(scene->kinds, BB_TETRAHEDRONS);
        expect_flags(scene);
        bb_scene_free(scene);
    }
    bb_scene *scene = load_scene("tets:side=4,flip=3,flat=5,twins=7,jitter=0.5");
    assert_true(scene->tets->flat_count > 10 && scene->tets->negative_count > 20);
    bb_scene_free(scene);
    scene = load_scene("tets:side=3,shape=block");
    assert_int_equal(scene->prim_count, 6 * 27);
    assert_int_equal(scene->tets->negative_count + scene->tets->flat_count, 0);
    bb_scene_free(scene);
}

/* Of a block of cubes: the volumes add up, and each of its points is in a tetrahedron. */
static void the_block_is_filled(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("tets:side=3,shape=block,jitter=0");
    for (uint32_t n = 0; n < 400; n++) {
        bb_random random = bb_random_make(seed, n);
        double p[3];
        uint32_t holders = 0;
        for (int k = 0; k < 3; k++)
            p[k] = n % 2 == 0 ? bb_random_range(&random, 0, 3) : 0.5 * bb_random_below(&random, 7);
        for (uint32_t i = 0; i < scene->prim_count; i++)
            holders += bb_tet_holds(scene, i, p);
        assert_true(n % 2 == 0 ? holders == 1 : holders >= 1);
        p[n % 3] = n % 2 == 0 ? -1e-300 : 3.0000001;
        for (uint32_t i = 0; i < scene->prim_count; i++)
            assert_false(bb_tet_holds(scene, i, p));
    }
    bb_scene_free(scene);
}

/* A region inside a tetrahedron holds part of the solid; one outside of it does not. */
static void solids_shrink_regions(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("tets:side=1,shape=block,jitter=0");
    const bb_prim_kind *kind = bb_prim_kinds[BB_TETRAHEDRON];
    /* the first: 0 <= z <= y <= x <= 1 */
    double lo[3] = {0.6, 0.4, 0.2}, hi[3] = {0.65, 0.45, 0.25};
    assert_true(kind->shrink(scene, 0, lo, hi));
    assert_true(lo[0] == 0.6 && hi[0] == 0.65 && lo[2] == 0.2 && hi[2] == 0.25);
    double out_lo[3] = {0.1, 0.4, 0.2}, out_hi[3] = {0.2, 0.6, 0.25};
    assert_false(kind->shrink(scene, 0, out_lo, out_hi));
    double part_lo[3] = {-1, -1, 0.5}, part_hi[3] = {2, 2, 2};
    assert_true(kind->shrink(scene, 0, part_lo, part_hi));
    assert_true(part_lo[0] == 0.5 && part_lo[1] == 0.5 && part_lo[2] == 0.5 && part_hi[2] == 1);
    bb_scene_free(scene);
}

/* ---- TetGen's files ---- */

static const char nodes[] = "# a comment\n5 3 1 0\n\n0 0 0 0 7 # the first\n1 1 0 0 -0\n2 0 1 0 1\n"
                            "3 0 0 1 2e-3\n4 1 1 1 4\n";
static const char elements[] = "2 4 0\n0 0 1 2 3\n1 4 2 1 3\n";

static void tetgen_files_are_read(void **state)
{
    (void)state;
    const char *ele = text_file("mesh.ele", elements), *node = text_file("mesh.node", nodes);
    const char *const either[] = {node, ele};
    for (int i = 0; i < 2; i++) {
        bb_scene *scene = load_scene(either[i]);
        assert_int_equal(scene->prim_count, 2);
        assert_int_equal(scene->vertex_count, 5);
        assert_string_equal(scene->tets->field_name, "attribute 1");
        assert_true(scene->tets->field[0] == 7 && !signbit(scene->tets->field[1]));
        assert_true(scene->tets->field_lo == 0 && scene->tets->field_hi == 7);
        assert_int_equal(scene->tets->boundary_count, 2);
        assert_int_equal(scene->tets->flags[0], 0xE); /* all but what both have */
        bb_scene_free(scene);
    }
    /* numbered from 1, ten nodes each, packed */
    char packed[512];
    const char from_one[] = "4 3 0 1\n1 0 0 0 5\n2 1 0 0 5\n3 0 1 0 5\n4 0 0 1 5\n";
    size_t size = ZSTD_compress(packed, sizeof packed, from_one, strlen(from_one), 3);
    const char *path = byte_file("packed.node.zst", packed, size);
    const char ten[] = "1 10 0\n1 1 2 3 4 4 4 4 4 4 4\n";
    size = ZSTD_compress(packed, sizeof packed, ten, strlen(ten), 3);
    byte_file("packed.ele.zst", packed, size);
    bb_scene *scene = load_scene(path);
    assert_int_equal(scene->prim_count, 1);
    assert_string_equal(scene->tets->field_name, "made");
    bb_scene_free(scene);
}

static void bad_tetgen_files_are_refused(void **state)
{
    (void)state;
    const struct {
        const char *nodes, *elements, *message;
    } cases[] = {
        {"", elements, "ends before the line that counts vertices"},
        {"5 3", elements, "too few for 5 vertices"},
        {"5 2 0 0\n", elements, "line 1: the dimension is 2"},
        {"-1 3 0 0\n", elements, "the number of vertices is -1"},
        {"nan 3\n", elements, "the number of vertices is nan"},
        {"1e300 3\n", elements, "1e+300"},
        {"2147483647 3 0 0\n", elements, "too few for 2147483647 vertices"},
        {"1 3 0 0\n0 0 0 zero           \n", elements, "line 2: 'zero' is no number"},
        {"1 3 0 0\n0 0 0 0x10           \n", elements, "'0x10' is no number"},
        {"1 3 0 0\n0 0 0                \n", elements, "line 2: all its vertices needs 4 numbers"},
        {"1 3 0 0\n7 0 0 0              \n", elements, "the vertex's number is 7"},
        {"2 3 0 0\n0 0 0 0\n2 0 0 0     \n", elements, "line 3: the vertex's number is 2"},
        {nodes, "", "ends before the line that counts tetrahedra"},
        {nodes, "2 5 0\n", "has elements of 5 nodes"},
        {nodes, "2 4 0\n0 0 1 2 3\n#####\n", "ends before all its tetrahedra"},
        {nodes, "1 4 0\n0 0 1 2 5\n", "a vertex is 5, it must be a whole number from 0 to 4"},
        {nodes, "1 4 0\n0 0 1 2 1.5\n", "a vertex is 1.5"},
        {"4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 inf\n", "1 4 0\n0 0 1 2 3\n", "not finite"},
        {"4 3 1 0\n0 0 0 0 1\n1 1 0 0 1\n2 0 1 0 nan\n3 0 0 1 1\n", "1 4 0\n0 0 1 2 3\n",
         "field 'attribute 1' is nan at vertex 2"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = text_file("bad.node", cases[i].nodes);
        text_file("bad.ele", cases[i].elements);
        expect_failure(path, BB_INVALID, cases[i].message);
    }
    expect_failure(text_file("alone.node", nodes), BB_INVALID, "alone.ele");
    expect_failure(text_file("no.node.zst", nodes), BB_INVALID, "is no zstd file");
}

/* ---- by Gmsh ---- */

static const char msh[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n"
                          "3 0 1 0\n4 0 0 1\n9 5 5 5\n$EndNodes\n$Elements\n2\n"
                          "1 2 2 1 1 1 2 3\n2 4 2 1 1 1 2 3 4\n$EndElements\n"
                          "$NodeData\n1\n\"heat\"\n1\n0\n3\n0\n1\n4\n1 0.5\n2 1\n3 2\n4 3\n"
                          "$EndNodeData\n";

static bool has_gmsh(void)
{
    char path[4096];
    return bb_find_beside("bvhbench-gmsh", path, sizeof path);
}

static void gmsh_reads_meshes(void **state)
{
    (void)state;
    if (!has_gmsh()) {
        print_message("skipped: built without Gmsh\n");
        skip();
    }
    bb_scene *scene = load_scene(text_file("one.msh", msh));
    assert_int_equal(scene->prim_count, 1);
    assert_int_equal(scene->vertex_count, 4); /* the fifth belongs to none */
    assert_string_equal(scene->tets->field_name, "first view");
    assert_true(scene->tets->field[0] == 0.5f && scene->tets->field[3] == 3.0f);
    bb_scene_free(scene);
    scene = load_scene(text_file("one.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n"
                                             "0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\nTetrahedra\n1\n"
                                             "1 2 3 4 1\nEnd\n"));
    assert_int_equal(scene->prim_count, 1);
    bb_scene_free(scene);
    scene = load_scene(text_file("one.vtk", "# vtk DataFile Version 2.0\nx\nASCII\n"
                                            "DATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0\n"
                                            "1 0 0\n0 1 0\n0 0 1\nCELLS 1 5\n4 0 1 2 3\n"
                                            "CELL_TYPES 1\n10\n"));
    assert_int_equal(scene->prim_count, 1);
    bb_scene_free(scene);
}

/* Whatever Gmsh makes of it, it is a scene or one line. */
static void damaged_meshes_are_no_crash(void **state)
{
    (void)state;
    if (!has_gmsh()) {
        print_message("skipped: built without Gmsh\n");
        skip();
    }
    expect_failure(text_file("empty.msh", ""), BB_INVALID, "empty.msh: ");
    expect_failure(text_file("noise.msh", "no mesh at all"), BB_INVALID, "noise.msh: ");
    /* of what is no mesh Gmsh would run the commands */
    char trace[1024];
    snprintf(trace, sizeof trace, "%s", test_path("tets", "trace"));
    static const char *const names[] = {"script.msh", "script.mesh", "script.Vtk"};
    remove(trace);
    for (int i = 0; i < 3; i++) {
        char script[1200];
        snprintf(script, sizeof script, "SystemCall \"touch %s\";\n", trace);
        expect_failure(text_file(names[i], script), BB_INVALID,
                       "does not begin like a mesh of Gmsh, MEDIT");
        snprintf(script, sizeof script, "// MeshVersionFormatted\nSystemCall \"touch %s\";\n",
                 trace);
        bb_scene *scene = NULL;
        assert_int_not_equal(bb_scene_load(text_file(names[i], script), &scene), BB_OK);
        assert_int_not_equal(access(trace, F_OK), 0);
    }
    char options[1200];
    snprintf(options, sizeof options, "SystemCall \"touch %s\";\n", trace);
    text_file("one.msh.opt", options);
    bb_scene_free(load_scene(text_file("one.msh", msh)));
    assert_int_not_equal(access(trace, F_OK), 0);
    expect_failure(text_file("hex.msh",
                             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n"
                             "3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n"
                             "$Elements\n2\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 4 2 1 1 1 2 3 5\n"
                             "$EndElements\n"),
                   BB_INVALID, "1 elements that are no tetrahedra");
    uint32_t refused = 0;
    for (uint32_t n = 0; n < 24; n++) {
        bb_random random = bb_random_make(seed, n);
        char damaged[sizeof msh];
        size_t size = sizeof msh - 1;
        memcpy(damaged, msh, sizeof msh);
        if (n % 2 == 0)
            size = bb_random_below(&random, (uint32_t)size);
        for (int i = 0; n % 2 == 1 && i < 3; i++)
            damaged[bb_random_below(&random, (uint32_t)size)] =
                (char)(' ' + bb_random_below(&random, 90));
        bb_scene *scene = NULL;
        bb_status status = bb_scene_load(byte_file("damaged.msh", damaged, size), &scene);
        assert_true(status == BB_OK || status == BB_INVALID || status == BB_REFUSED);
        assert_true(status == BB_OK || strchr(bb_message(), '\n') == NULL);
        refused += status != BB_OK;
        bb_scene_free(scene);
    }
    assert_true(refused > 6);
}

static void real_meshes_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        uint32_t tets, vertices;
    } meshes[] = {
        {"cubes_v41/cubes_v41.msh", 32981, 7714},  {"dinosaur/dinosaur.msh", 49973, 13270},
        {"gargoyle/gargoyle.msh", 57636, 12827},   {"mat100x100/mat100x100t40.msh", 58806, 20000},
        {"rod300x33/rod300x33.msh", 50511, 13333}, {"boat/boat.node.zst", 391708, 89102}};
    if (access(BB_TEST_SOURCE_DIR "/../shared/data/tet", F_OK) != 0 || !has_gmsh()) {
        print_message("skipped: ../shared/data/tet is not there, or Gmsh is not\n");
        skip();
    }
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/../shared/data/tet/%s", BB_TEST_SOURCE_DIR, meshes[i].path);
        bb_scene *scene = load_scene(path);
        print_message("%s: %u of %u tetrahedra on the boundary, %u the other way round, %u flat\n",
                      meshes[i].path, scene->tets->boundary_count, scene->prim_count,
                      scene->tets->negative_count, scene->tets->flat_count);
        assert_int_equal(scene->prim_count, meshes[i].tets);
        assert_int_equal(scene->vertex_count, meshes[i].vertices);
        bb_scene_free(scene);
    }
}

static int set_up(void **state)
{
    (void)state;
    seed = seed_or(20261122);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_are_exact),       cmocka_unit_test(flags_are_those_of_brute_force),
        cmocka_unit_test(the_block_is_filled),   cmocka_unit_test(solids_shrink_regions),
        cmocka_unit_test(tetgen_files_are_read), cmocka_unit_test(bad_tetgen_files_are_refused),
        cmocka_unit_test(gmsh_reads_meshes),     cmocka_unit_test(damaged_meshes_are_no_crash),
        cmocka_unit_test(real_meshes_are_read),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
