/* The tests of boxes by themselves, as a kernel calls them, against exact arithmetic (MPFR with
 * enough bits that nothing is rounded): adversarial floats, and the known weak spots of the
 * careless ones. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "tests/device_fixture.h"
#include "traversal/traversal.h"

#include <float.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CASES = 100000, GROUP = 64, BITS = 1200 };
/* ---- on the device: each box in all places of a node of BB_WIDTH, and as a node of a tree ---- */

static const bb_source source = {
    .name = "test_slab.cl",
    .text = "#include \"bb_device.h\"\n"
            "#include \"slab.clh\"\n"
            "kernel void test(global const bb_ray *rays, global const float *planes,\n"
            "                 global const bb_node *nodes, uint count, global uint *met)\n"
            "{\n"
            "    uint i = get_global_id(0);\n"
            "    if (i >= count)\n"
            "        return;\n"
            "    float3 o = vload3(0, rays[i].o), d = vload3(0, rays[i].d);\n"
            "    bb_slab slab = bb_slab_of(o, d);\n"
            "    bb_boxes entry, exit;\n"
            "    bb_box_distances(&slab, planes + 6 * BB_WIDTH * i, rays[i].tmin,\n"
            "                     rays[i].tmax, &entry, &exit);\n"
            "#if BB_WIDTH == 2\n"
            "    met[2 * i] = (entry.x <= exit.x) + (entry.y <= exit.y);\n"
            "#else\n"
            "    met[2 * i] = popcount(BB_VECTOR(bb_bits, BB_WIDTH)(entry <= exit));\n"
            "#endif\n"
            "    met[2 * i + 1] = bb_meets_node(&slab, (global const float *)(nodes + i),\n"
            "                                   rays[i].tmin, rays[i].tmax);\n"
            "}\n"};

/* Does ray i meet box i? All places of the node must say the same, and so must the test of one
 * box. */
static void test_boxes(const char *intersector, uint32_t width, const bb_ray *rays,
                       const bb_node *boxes, uint32_t count, bool *met)
{
    float *planes = calloc(6 * (size_t)width * count, sizeof *planes);
    uint32_t *found = calloc(2 * (size_t)count, sizeof *found);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t c = 0; c < width; c++) {
                planes[6 * width * i + 2 * k * width + c] = boxes[i].lo[k];
                planes[6 * width * i + (2 * k + 1) * width + c] = boxes[i].hi[k];
            }
    bb_buffer d_rays, d_planes, d_nodes, d_met;
    make_buffer(&d_rays, rays, count * sizeof *rays);
    make_buffer(&d_planes, planes, 6 * (size_t)width * count * sizeof *planes);
    make_buffer(&d_nodes, boxes, count * sizeof *boxes);
    make_buffer(&d_met, NULL, 2 * (size_t)count * sizeof *found);
    bb_intersector parsed;
    ASSERT_OK(bb_intersector_parse(intersector, &parsed));
    char defines[160], width_define[32];
    bb_intersector_defines(&parsed, defines, sizeof defines);
    snprintf(width_define, sizeof width_define, " -DBB_WIDTH=%u", width);
    strcat(defines, width_define);
    cl_program program;
    cl_kernel kernel;
    ASSERT_OK(bb_program_build(device, &source, defines, &program));
    ASSERT_OK(bb_kernel_get(program, "test", &kernel));
    ASSERT_OK(bb_launch(device, kernel, count, GROUP, BB_MEM(d_rays), BB_MEM(d_planes),
                        BB_MEM(d_nodes), BB_VALUE(count), BB_MEM(d_met)));
    ASSERT_OK(bb_buffer_read(&d_met, 0, 2 * (size_t)count * sizeof *found, found));
    for (uint32_t i = 0; i < count; i++) {
        met[i] = found[2 * i] != 0;
        if (found[2 * i] != (met[i] ? width : 0) || (found[2 * i + 1] != 0) != met[i])
            fail_msg("%s, width %u, case %u: met in %u places, as a tree's node: %u (seed %llu)",
                     intersector, width, i, found[2 * i], found[2 * i + 1],
                     (unsigned long long)seed);
    }
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_planes);
    bb_buffer_release(&d_nodes);
    bb_buffer_release(&d_met);
    free(planes);
    free(found);
}

/* ---- exactly ---- */

static mpfr_t near_distance[3], far_distance[3], speed[3], left, right;

/* Does the ray meet the closed box at some t >= 0? Plane distances are fractions over the
 * direction: compared crosswise. */
static bool meets_exactly(const bb_ray *ray, const bb_node *box)
{
    for (int k = 0; k < 3; k++) {
        float d = ray->d[k];
        if (d == 0 && !(box->lo[k] <= ray->o[k] && ray->o[k] <= box->hi[k]))
            return false;
        float from = d < 0 ? -box->hi[k] : box->lo[k], to = d < 0 ? -box->lo[k] : box->hi[k];
        float o = d < 0 ? -ray->o[k] : ray->o[k];
        mpfr_set_flt(near_distance[k], from, MPFR_RNDN);
        mpfr_sub_d(near_distance[k], near_distance[k], o, MPFR_RNDN);
        mpfr_set_flt(far_distance[k], to, MPFR_RNDN);
        mpfr_sub_d(far_distance[k], far_distance[k], o, MPFR_RNDN);
        mpfr_set_flt(speed[k], fabsf(d), MPFR_RNDN);
        if (d != 0 && mpfr_sgn(far_distance[k]) < 0)
            return false;
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            if (ray->d[a] == 0 || ray->d[b] == 0)
                continue;
            mpfr_mul(left, near_distance[a], speed[b], MPFR_RNDN);
            mpfr_mul(right, far_distance[b], speed[a], MPFR_RNDN);
            if (mpfr_cmp(left, right) > 0)
                return false;
        }
    return true;
}

/* ---- cases ---- */

enum { RANDOM, TOUCHING, IN_FACE, ODD_DIRECTION, FLAT, FAMILIES };

static float magnitude(bb_random *random, int low, int high)
{
    int exponent = low + (int)bb_random_below(random, (uint32_t)(high - low + 1));
    return (float)ldexp(bb_random_range(random, -1, 1), exponent);
}

/* A box of any size, a ray that about touches it: through a corner or an edge of it, in the plane
 * of a face, with components of the direction that are zero, denormal or large. */
static void make_case(bb_random *random, uint32_t family, bb_ray *ray, bb_node *box)
{
    static const float odd[] = {0.0f,      -0.0f,    0x1p-149f, -0x1p-149f,
                                0x1p-130f, -FLT_MIN, 1.0f,      -0x1p100f};
    int size = (int)bb_random_below(random, 81) - 40;
    *ray = (bb_ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        float a = magnitude(random, size, size), b = magnitude(random, size - 12, size);
        b = bb_random_below(random, 2) ? a + b : b;
        if (family == FLAT && bb_random_below(random, 2))
            b = a;
        box->lo[k] = fminf(a, b);
        box->hi[k] = fmaxf(a, b);
        ray->o[k] = magnitude(random, size - 2, size + 6);
        float target = bb_random_below(random, 2) ? box->lo[k] : box->hi[k];
        if (family == RANDOM)
            target = (float)bb_random_range(random, box->lo[k], box->hi[k]);
        ray->d[k] = target - ray->o[k];
    }
    int axis = (int)bb_random_below(random, 3);
    if (family == IN_FACE || family == ODD_DIRECTION) {
        ray->o[axis] = bb_random_below(random, 2) ? box->lo[axis] : box->hi[axis];
        ray->d[axis] = bb_random_below(random, 2) ? 0.0f : -0.0f;
        if (bb_random_below(random, 2))
            ray->d[(axis + 1) % 3] = -0.0f;
    }
    if (family == ODD_DIRECTION)
        ray->d[axis] = odd[bb_random_below(random, sizeof odd / sizeof odd[0])];
}

static void padded_slabs_lose_no_box(void **state)
{
    (void)state;
    bb_ray *rays = calloc(CASES, sizeof *rays);
    bb_node *boxes = calloc(CASES, sizeof *boxes);
    bool *met = calloc(CASES, sizeof *met), *exact = calloc(CASES, sizeof *exact);
    bb_random random = bb_random_make(seed, 1);
    uint32_t touched[FAMILIES] = {0}, missed = 0;
    for (uint32_t i = 0; i < CASES; i++) {
        make_case(&random, i % FAMILIES, &rays[i], &boxes[i]);
        exact[i] = meets_exactly(&rays[i], &boxes[i]);
        touched[i % FAMILIES] += exact[i];
        missed += !exact[i];
    }
    for (int f = 0; f < FAMILIES; f++)
        assert_true(touched[f] > CASES / FAMILIES / 50);
    assert_true(missed > CASES / 20);
    for (uint32_t width = 2; width <= 8; width *= 2) {
        uint32_t kept = 0;
        test_boxes("exact", width, rays, boxes, CASES, met);
        for (uint32_t i = 0; i < CASES; i++) {
            kept += !exact[i] && met[i];
            if (exact[i] && !met[i])
                fail_msg("width %u, case %u: o %a %a %a d %a %a %a, box %a %a %a to %a %a %a "
                         "(seed %llu)",
                         width, i, rays[i].o[0], rays[i].o[1], rays[i].o[2], rays[i].d[0],
                         rays[i].d[1], rays[i].d[2], boxes[i].lo[0], boxes[i].lo[1], boxes[i].lo[2],
                         boxes[i].hi[0], boxes[i].hi[1], boxes[i].hi[2], (unsigned long long)seed);
        }
        assert_true(kept < missed); /* it does cull */
    }
    /* sign-ordered ones do lose some of them */
    uint32_t lost = 0;
    test_boxes("exact:slab=sign", 8, rays, boxes, CASES, met);
    for (uint32_t i = 0; i < CASES; i++)
        lost += exact[i] && !met[i];
    assert_true(lost > 0);
    free(rays);
    free(boxes);
    free(met);
    free(exact);
}

/* k * (1 / k) is below 1 for some k, 41 the first: a ray through the edge of the box leaves one
 * slab before it enters the other. */
static void sign_ordered_slabs_lose_a_box_by_rounding(void **state)
{
    (void)state;
    enum { COUNT = 200 };
    bb_ray rays[COUNT];
    bb_node boxes[COUNT];
    bool met[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        float k = (float)(i + 1);
        rays[i] = (bb_ray){.d = {1, k, 0}, .tmax = INFINITY};
        boxes[i] = (bb_node){.lo = {1, 0, -1}, .hi = {2, k, 1}};
        assert_true(meets_exactly(&rays[i], &boxes[i]));
    }
    static const char *const careless[] = {"fast", "careless", "exact:slab=sign"};
    for (int c = 0; c < 3; c++) {
        uint32_t lost = 0;
        test_boxes(careless[c], 4, rays, boxes, COUNT, met);
        for (uint32_t i = 0; i < COUNT; i++)
            lost += !met[i];
        if (lost == 0)
            fail_msg("%s lost nothing", careless[c]);
        if (device->is_cpu) /* where division is exactly rounded */
            assert_false(met[41 - 1]);
    }
    test_boxes("exact", 4, rays, boxes, COUNT, met);
    for (uint32_t i = 0; i < COUNT; i++)
        assert_true(met[i]);
}

/* The distance of a plane through the origin of a ray that is parallel to it is 0 * inf. */
static void naive_slabs_lose_rays_in_faces(void **state)
{
    (void)state;
    enum { COUNT = 6 };
    bb_ray rays[COUNT];
    bb_node boxes[COUNT];
    bool met[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t axis = i % 3;
        rays[i] = (bb_ray){.o = {0.5f, 0.5f, 0.5f}, .tmax = 100};
        rays[i].o[axis] = i < 3 ? 0 : 1; /* in a lo or hi face */
        rays[i].d[(axis + 1) % 3] = 1;
        boxes[i] = (bb_node){.lo = {0, 0, 0}, .hi = {1, 1, 1}};
        assert_true(meets_exactly(&rays[i], &boxes[i]));
    }
    uint32_t lost = 0;
    test_boxes("exact:slab=naive", 4, rays, boxes, COUNT, met);
    for (uint32_t i = 0; i < COUNT; i++)
        lost += !met[i];
    assert_true(lost >= 3); /* those in lo faces */
    static const char *const careful[] = {"exact", "exact:slab=sign"};
    for (int c = 0; c < 2; c++) {
        test_boxes(careful[c], 4, rays, boxes, COUNT, met);
        for (uint32_t i = 0; i < COUNT; i++)
            assert_true(met[i]);
    }
}

static int open_all(void **state)
{
    for (int k = 0; k < 3; k++)
        mpfr_inits2(BITS, near_distance[k], far_distance[k], speed[k], (mpfr_ptr)NULL);
    mpfr_inits2(BITS, left, right, (mpfr_ptr)NULL);
    return open_device(state);
}

static int close_all(void **state)
{
    close_device(state);
    for (int k = 0; k < 3; k++)
        mpfr_clears(near_distance[k], far_distance[k], speed[k], (mpfr_ptr)NULL);
    mpfr_clears(left, right, (mpfr_ptr)NULL);
    mpfr_free_cache();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(padded_slabs_lose_no_box),
        cmocka_unit_test(sign_ordered_slabs_lose_a_box_by_rounding),
        cmocka_unit_test(naive_slabs_lose_rays_in_faces),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
