/* The tests of triangles and boxes by themselves, as a kernel calls them, against exact arithmetic:
 * all named intersectors, one and four lanes, random and adversarial floats. Seed:
 * BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/scene/exact.h"
#include "tests/device_fixture.h"
#include "traversal/traversal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = BB_BLOCK_LANES, CASES = 40000, GROUP = 64 };
/* ---- the tests on the device: LANES triangles per ray ---- */

static const bb_source triangles_source = {
    .name = "test_triangles.cl",
    .text =
        "#include \"bb_device.h\"\n"
        "#include \"intersect.clh\"\n"
        "#include \"prims.clh\"\n"
        "kernel void write(global const float *vertices, global const uint *indices, uint count,\n"
        "                  global uint *records)\n"
        "{\n"
        "    uint i = get_global_id(0);\n"
        "    if (i < count)\n"
        "        bb_triangle_write(records + i / BB_LANES * BB_WORDS + i % BB_LANES, BB_LANES,\n"
        "                          BB_FORMAT, indices + 3 * i, vertices, 1.0f);\n"
        "}\n"
        "kernel void test(global const float *records, global const bb_ray *rays, uint count,\n"
        "                 global float *t)\n"
        "{\n"
        "    uint i = get_global_id(0);\n"
        "    if (i >= count)\n"
        "        return;\n"
        "    bb_ray_setup r;\n"
        "    bb_ray_setup_make(&r, rays + i, 1.0f);\n"
        "    float toward = bb_times_power(1.0f, -r.power);\n"
        "#if BB_LANES == 1\n"
        "    for (uint k = 0; k < BB_BLOCK_LANES; k++)\n"
        "        t[BB_BLOCK_LANES * i + k] =\n"
        "            toward * bb_triangle(&r, records + (BB_BLOCK_LANES * i + k) * BB_WORDS);\n"
        "#else\n"
        "    vstore4(toward * bb_triangle(&r, records + i * BB_WORDS), i, t);\n"
        "#endif\n"
        "}\n"};

/* Ray i against triangles LANES * i ..: t[LANES * i + k]. */
static void test_triangles(const bb_intersector *intersector, uint32_t lanes, const float *vertices,
                           const bb_ray *rays, uint32_t count, float *t)
{
    uint32_t triangles = LANES * count;
    uint32_t *order = calloc(3 * (size_t)triangles, sizeof *order);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        order[i] = i;
    bb_buffer d_vertices, d_indices, d_rays, d_records, d_t;
    make_buffer(&d_vertices, vertices, 9 * (size_t)triangles * sizeof(float));
    make_buffer(&d_indices, order, 3 * (size_t)triangles * sizeof *order);
    make_buffer(&d_rays, rays, count * sizeof *rays);
    make_buffer(&d_records, NULL,
                (size_t)triangles * bb_leaf_prim_words(BB_TRIANGLES, BB_FORMAT_AFFINE) *
                    sizeof(float));
    make_buffer(&d_t, NULL, triangles * sizeof(float));
    char defines[160], lane_define[32];
    bb_intersector_defines(intersector, defines, sizeof defines);
    snprintf(lane_define, sizeof lane_define, " -DBB_LANES=%u", lanes);
    strcat(defines, lane_define);
    cl_program program;
    cl_kernel write, test;
    ASSERT_OK(bb_program_build(device, &triangles_source, defines, &program));
    ASSERT_OK(bb_kernel_get(program, "write", &write));
    ASSERT_OK(bb_kernel_get(program, "test", &test));
    ASSERT_OK(bb_launch(device, write, triangles, GROUP, BB_MEM(d_vertices), BB_MEM(d_indices),
                        BB_VALUE(triangles), BB_MEM(d_records)));
    ASSERT_OK(bb_launch(device, test, count, GROUP, BB_MEM(d_records), BB_MEM(d_rays),
                        BB_VALUE(count), BB_MEM(d_t)));
    ASSERT_OK(bb_buffer_read(&d_t, 0, triangles * sizeof *t, t));
    bb_kernel_release(write);
    bb_kernel_release(test);
    bb_program_release(program);
    bb_buffer_release(&d_vertices);
    bb_buffer_release(&d_indices);
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_records);
    bb_buffer_release(&d_t);
    free(order);
}

static bool is_hit(float t)
{
    return t > 0 && t < INFINITY; /* as in a ray's interval: not NaN */
}

/* ---- away from edges ---- */

/* Four triangles of some size around the place that the ray is aimed at. */
static void make_case(bb_random *random, float *vertices, bb_ray *ray)
{
    double size = ldexp(1, (int)bb_random_below(random, 41) - 20), place[3], from[3];
    double length = ldexp(1, (int)bb_random_below(random, 11) - 5);
    for (int k = 0; k < 3; k++) {
        place[k] = size * bb_random_range(random, -2, 2);
        from[k] = place[k] + 3 * size * bb_random_range(random, -1, 1);
    }
    *ray = (bb_ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        ray->o[k] = (float)from[k];
        ray->d[k] = (float)(length * (place[k] - from[k]) / size);
        for (int v = 0; v < 3 * LANES; v++)
            vertices[3 * v + k] = (float)(place[k] + size * bb_random_range(random, -1, 1));
    }
}

/* How far inside (> 0) or outside the ray passes the triangle, as the least barycentric coordinate,
 * times the cosine between ray and normal: below some 2^-24 times the ray's distance a float cannot
 * tell. */
static double clearance(const bb_ray *ray, const float *v)
{
    double a[3][3], n[3], sides[3], sum = 0, normal = 0, along = 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            a[c][k] = (double)v[3 * c + k] - ray->o[k];
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] =
            (a[1][i] - a[0][i]) * (a[2][j] - a[0][j]) - (a[1][j] - a[0][j]) * (a[2][i] - a[0][i]);
        normal = hypot(normal, n[k]);
        along = hypot(along, ray->d[k]);
    }
    for (int e = 0; e < 3; e++) {
        const double *p = a[(e + 1) % 3], *q = a[(e + 2) % 3];
        sides[e] = 0;
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            sides[e] += ray->d[k] * (p[i] * q[j] - p[j] * q[i]);
        }
        sum += sides[e];
    }
    double least = fmin(fmin(sides[0] / sum, sides[1] / sum), sides[2] / sum);
    double cosine = fabs(sum) / (normal * along);
    return cosine < 0.05 ? 0 : least * cosine;
}

/* t at which the ray is as far away as the farthest coordinate. */
static double reach(const bb_ray *ray, const float *v)
{
    double farthest = 0, length = 0;
    for (int k = 0; k < 3; k++) {
        length = hypot(length, ray->d[k]);
        for (int c = 0; c < 3; c++)
            farthest = fmax(farthest, fabs((double)v[3 * c + k] - ray->o[k]));
    }
    return farthest / length;
}

static void compare_away_from_edges(const bb_intersector *intersector)
{
    float *vertices = calloc((size_t)CASES * LANES * 9, sizeof *vertices);
    bb_ray *rays = calloc(CASES, sizeof *rays);
    float *one = calloc(CASES * LANES, sizeof *one), *four = calloc(CASES * LANES, sizeof *four);
    bb_random random = bb_random_make(seed, 1);
    for (uint32_t i = 0; i < CASES; i++)
        make_case(&random, vertices + 9 * (size_t)LANES * i, &rays[i]);
    test_triangles(intersector, 1, vertices, rays, CASES, one);
    test_triangles(intersector, LANES, vertices, rays, CASES, four);
    uint32_t hits = 0, decided = 0;
    for (uint32_t i = 0; i < CASES * LANES; i++) {
        const float *v = vertices + 9 * (size_t)i;
        const bb_ray *ray = &rays[i / LANES];
        if (fabs(clearance(ray, v)) < 1e-3)
            continue;
        const double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
        double t = NAN;
        bool met = bb_exact_meets_triangle(o, ray->d, v, v + 3, v + 6) &&
                   bb_exact_plane_t(o, ray->d, v, v + 3, v + 6, &t);
        /* the floats' error is of the coordinates, not of the distance */
        double tolerance = 1e-4 * (fabs(t) + 1e-2 * reach(ray, v));
        bool ahead = met && t > tolerance;
        if (met && !ahead && t > -tolerance)
            continue; /* at the origin */
        decided++;
        hits += ahead;
        for (int l = 0; l < 2; l++) {
            float found = l == 0 ? one[i] : four[i];
            if (is_hit(found) != ahead || (ahead && !(fabs(found - t) <= tolerance)))
                fail_msg("%s, %d lanes, case %u: t = %g, not %g (seed %llu)", intersector->name,
                         l == 0 ? 1 : LANES, i, found, ahead ? t : INFINITY,
                         (unsigned long long)seed);
        }
    }
    assert_true(decided > CASES && hits > CASES / 8);
    free(vertices);
    free(rays);
    free(one);
    free(four);
}

static void all_tests_agree_away_from_edges(void **state)
{
    (void)state;
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        compare_away_from_edges(i);
}

/* ---- at edges and vertices ---- */

/* The four faces of a tetrahedron around the origin of the ray, which is aimed at an edge or a
 * vertex. */
static void make_edge_case(bb_random *random, const double offset[3], float *vertices, bb_ray *ray)
{
    static const int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    static const double corners[4][3] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    float v[4][3];
    for (int c = 0; c < 4; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = (float)(offset[k] + 4 * corners[c][k] + bb_random_range(random, -1, 1));
    for (int f = 0; f < 4; f++)
        for (int c = 0; c < 3; c++)
            memcpy(vertices + 9 * f + 3 * c, v[faces[f][c]], 3 * sizeof(float));
    uint32_t p = bb_random_below(random, 4), q = (p + 1 + bb_random_below(random, 3)) % 4;
    double s = bb_random_below(random, 4) == 0 ? 0 : bb_random_unit(random);
    *ray = (bb_ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        ray->o[k] = (float)(offset[k] + bb_random_range(random, -0.5, 0.5));
        ray->d[k] = (float)(v[p][k] + s * ((double)v[q][k] - v[p][k]) - ray->o[k]);
    }
}

static uint32_t count_lost(const bb_intersector *intersector, const double offset[3], double scale)
{
    float *vertices = calloc((size_t)CASES * LANES * 9, sizeof *vertices);
    float *t = calloc(CASES * LANES, sizeof *t);
    bb_ray *rays = calloc(CASES, sizeof *rays);
    bb_random random = bb_random_make(seed, 2);
    for (uint32_t i = 0; i < CASES; i++) {
        float *v = vertices + 9 * (size_t)LANES * i;
        make_edge_case(&random, offset, v, &rays[i]);
        for (int w = 0; w < 9 * LANES; w++)
            v[w] = (float)(v[w] * scale);
        for (int k = 0; k < 3; k++)
            rays[i].o[k] = (float)(rays[i].o[k] * scale);
    }
    test_triangles(intersector, LANES, vertices, rays, CASES, t);
    uint32_t lost = 0;
    for (uint32_t i = 0; i < CASES; i++) {
        bool met = false;
        for (uint32_t k = 0; k < LANES; k++)
            met = met || is_hit(t[LANES * i + k]);
        lost += !met;
    }
    free(vertices);
    free(t);
    free(rays);
    return lost;
}

static void only_watertight_tests_lose_nothing_at_edges(void **state)
{
    (void)state;
    static const struct {
        double offset[3];
        double scale;
    } places[] = {{{0, 0, 0}, 1},
                  {{0, 0, 0}, 0x1p-20},
                  {{0, 0, 0}, 0x1p20},
                  {{1e3, -1e3, 1e3}, 1},
                  {{1e6, -1e6, 1e6}, 1},
                  {{1e3, 1e3, -1e3}, 0x1p-20},
                  {{1e3, 1e3, -1e3}, 0x1p20}};
    for (size_t p = 0; p < sizeof places / sizeof places[0]; p++)
        for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++) {
            uint32_t lost = count_lost(i, places[p].offset, places[p].scale);
            bool watertight =
                strcmp(i->triangle, "exact") == 0 || strcmp(i->triangle, "watertight") == 0;
            if (watertight ? lost > 0 : lost == 0 && p == 0)
                fail_msg("%s at %g, scale %g: %u of %d lost (seed %llu)", i->name,
                         places[p].offset[0], places[p].scale, lost, CASES,
                         (unsigned long long)seed);
        }
    /* contraction breaks the plain one */
    bb_intersector fused;
    ASSERT_OK(bb_intersector_parse("watertight:contract=yes", &fused));
    if (device->is_cpu)
        assert_true(count_lost(&fused, places[0].offset, 1) > 0);
    /* not the exact one: its signs are fused on purpose */
    ASSERT_OK(bb_intersector_parse("exact:contract=yes", &fused));
    assert_int_equal(count_lost(&fused, places[0].offset, 1), 0);
}

/* ---- triangles without area ---- */

static void triangles_without_area_are_never_hit(void **state)
{
    (void)state;
    enum { RAYS = 2000 };
    float *vertices = calloc((size_t)RAYS * LANES * 9, sizeof *vertices);
    float *t = calloc(RAYS * LANES, sizeof *t);
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_random random = bb_random_make(seed, 3);
    for (uint32_t i = 0; i < RAYS; i++) {
        float *v = vertices + 9 * (size_t)LANES * i;
        /* a point, twice the same vertex, and three on a line of a grid, along an axis and not */
        for (int k = 0; k < 3; k++) {
            float p = (float)((int)bb_random_below(&random, 64) - 32);
            float q = (float)((int)bb_random_below(&random, 64) - 32);
            for (int l = 0; l < LANES; l++) {
                float along = l < 3 || k == 0 ? q : p;
                v[9 * l + k] = p;
                v[9 * l + 3 + k] = l == 0 ? p : l == 1 ? q : (p + along) / 2;
                v[9 * l + 6 + k] = l == 0 ? p : l == 1 ? (i % 2 ? q : p) : along;
            }
            rays[i].o[k] = (float)((int)bb_random_below(&random, 64) - 32);
        }
        rays[i].tmax = INFINITY;
        /* along an axis, so that nothing is rounded; or at a corner: then lines may seem to have an
         * area */
        for (int k = 0; k < 3; k++)
            rays[i].d[k] = i % 2 ? (k == (int)(i / 2 % 3) ? 1.0f : 0.0f)
                                 : v[3 * (i / 2 % 3) + k] - rays[i].o[k];
    }
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        for (uint32_t lanes = 1; lanes <= LANES; lanes += LANES - 1) {
            test_triangles(i, lanes, vertices, rays, RAYS, t);
            for (uint32_t r = 0; r < RAYS * LANES; r++)
                if (is_hit(t[r]) && (r % LANES < 2 || r / LANES % 2 == 1))
                    fail_msg("%s, %u lanes, triangle %u: hit at %g (seed %llu)", i->name, lanes, r,
                             t[r], (unsigned long long)seed);
        }
    free(vertices);
    free(t);
    free(rays);
}

/* ---- affine maps ---- */

static double length(const float v[3])
{
    return hypot(hypot(v[0], v[1]), v[2]);
}

static void affine_maps_take_vertices_to_the_unit_triangle(void **state)
{
    (void)state;
    static const char *const text =
        "#include \"bb_device.h\"\n#include \"prims.clh\"\n"
        "kernel void write(global const float *vertices, global const uint *indices, uint count,\n"
        "                  global uint *records)\n"
        "{\n"
        "    uint i = get_global_id(0);\n"
        "    if (i < count)\n"
        "        bb_triangle_write(records + 12 * i, 1, BB_FORMAT_AFFINE, indices + 3 * i, "
        "vertices,\n"
        "                          1.0f);\n"
        "}\n";
    const bb_source source = {.name = "test_affine.cl", .text = text};
    enum { COUNT = 20000 };
    float *vertices = calloc(9 * COUNT, sizeof *vertices);
    float *maps = calloc(12 * COUNT, sizeof *maps);
    uint32_t *indices = calloc(3 * COUNT, sizeof *indices), count = COUNT;
    bb_random random = bb_random_make(seed, 4);
    for (uint32_t i = 0; i < COUNT; i++) {
        double size = ldexp(1, (int)bb_random_below(&random, 81) - 40);
        double flat = i % 2 ? 1 : ldexp(1, -(int)bb_random_below(&random, 12));
        for (int w = 0; w < 9; w++) {
            indices[3 * i + w / 3] = 3 * i + (uint32_t)w / 3;
            vertices[9 * i + w] =
                (float)(size * bb_random_range(&random, -1, 1) * (w % 3 == 0 ? flat : 1));
        }
    }
    bb_buffer d_vertices, d_indices, d_maps;
    make_buffer(&d_vertices, vertices, 9 * COUNT * sizeof *vertices);
    make_buffer(&d_indices, indices, 3 * COUNT * sizeof *indices);
    make_buffer(&d_maps, NULL, 12 * COUNT * sizeof *maps);
    cl_program program;
    cl_kernel write;
    ASSERT_OK(bb_program_build(device, &source, "", &program));
    ASSERT_OK(bb_kernel_get(program, "write", &write));
    ASSERT_OK(bb_launch(device, write, COUNT, GROUP, BB_MEM(d_vertices), BB_MEM(d_indices),
                        BB_VALUE(count), BB_MEM(d_maps)));
    ASSERT_OK(bb_buffer_read(&d_maps, 0, 12 * COUNT * sizeof *maps, maps));
    for (uint32_t i = 0; i < COUNT; i++) {
        const float *map = maps + 12 * i;
        /* of the corners; of a row: how often the triangle is as long as high, and more */
        double longest = 0, reach = 0;
        for (int corner = 0; corner < 3; corner++)
            longest = fmax(longest, length(vertices + 9 * i + 3 * corner));
        for (int row = 1; row < 3; row++)
            reach = fmax(reach, length(map + 4 * row) * longest);
        for (int corner = 0; corner < 3; corner++)
            for (int row = 0; row < 3; row++) {
                const float *m = map + 4 * row, *v = vertices + 9 * i + 3 * corner;
                double at = m[3] + (double)m[0] * v[0] + (double)m[1] * v[1] + (double)m[2] * v[2];
                /* rows: z, x, y. A row is off by some 2^-24 of itself, and of the edges by as much
                 * of their height */
                double expected = (row == 1 && corner == 1) || (row == 2 && corner == 2) ? 1 : 0;
                double tolerance = 8 * 0x1p-24 * (1 + reach) * length(m) * longest;
                if (!(fabs(at - expected) <= tolerance))
                    fail_msg("triangle %u, corner %d, row %d: %g, not %g within %g (seed %llu)", i,
                             corner, row, at, expected, tolerance, (unsigned long long)seed);
            }
    }
    bb_kernel_release(write);
    bb_program_release(program);
    bb_buffer_release(&d_vertices);
    bb_buffer_release(&d_indices);
    bb_buffer_release(&d_maps);
    free(vertices);
    free(maps);
    free(indices);
}

/* ---- names ---- */

static void points_and_their_options_are_parsed(void **state)
{
    (void)state;
    bb_intersector i;
    char defines[128];
    ASSERT_OK(bb_intersector_parse("exact", &i));
    assert_true(bb_intersector_is_exact(&i));
    assert_int_equal(bb_intersector_format(&i), BB_FORMAT_VERTICES);
    ASSERT_OK(bb_intersector_parse("fast:slab=naive,triangle=woop", &i));
    assert_false(bb_intersector_is_exact(&i));
    assert_int_equal(bb_intersector_format(&i), BB_FORMAT_AFFINE);
    bb_intersector_defines(&i, defines, sizeof defines);
    assert_string_equal(defines, "-DBB_TRIANGLE_TEST=BB_TRIANGLE_WOOP -DBB_SLAB_TEST=BB_SLAB_NAIVE "
                                 "-DBB_CONTRACT");
    ASSERT_OK(bb_intersector_parse("careless:slab=padded,triangle=exact,contract=no", &i));
    assert_true(bb_intersector_is_exact(&i));
    static const char *const wrong[] = {"none", "exact:slab=wide", "exact:leaf=4", "exact:slab"};
    for (size_t w = 0; w < sizeof wrong / sizeof wrong[0]; w++)
        assert_int_equal(bb_intersector_parse(wrong[w], &i), BB_INVALID);
    /* one point only is exact, and no two are the same */
    for (const bb_intersector *p = bb_intersectors; p->name != NULL; p++) {
        assert_int_equal(bb_intersector_is_exact(p), p == &bb_intersectors[0]);
        for (const bb_intersector *q = bb_intersectors; q != p; q++)
            assert_true(strcmp(p->triangle, q->triangle) != 0 || strcmp(p->slab, q->slab) != 0 ||
                        strcmp(p->contract, q->contract) != 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_and_their_options_are_parsed),
        cmocka_unit_test(affine_maps_take_vertices_to_the_unit_triangle),
        cmocka_unit_test(all_tests_agree_away_from_edges),
        cmocka_unit_test(only_watertight_tests_lose_nothing_at_edges),
        cmocka_unit_test(triangles_without_area_are_never_hit),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
