/* What tests of primitives and boxes keep per ray (ray_setup.clh, slab.clh), without a branch,
 * against plain C with branches, bit for bit. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "tests/device_fixture.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { RAYS = 20000, FLOATS = 20, WORDS = 10 };

static const char text[] =
    "#include \"bb_device.h\"\n"
    "#include \"intersect.clh\"\n"
    "kernel void test(global const bb_ray *rays, float scale, uint count, global float *floats,\n"
    "                 global uint *words)\n"
    "{\n"
    "    uint i = get_global_id(0);\n"
    "    if (i >= count)\n"
    "        return;\n"
    "    bb_ray_setup r;\n"
    "    bb_ray_setup_make(&r, rays + i, scale);\n"
    "    bb_slab s = bb_slab_of(r.o, r.d);\n"
    "    global float *f = floats + 20 * i;\n"
    "    global uint *w = words + 10 * i;\n"
    "    vstore3(r.o, 0, f);\n"
    "    vstore3(r.d, 1, f);\n"
    "    vstore3((float3)(r.ox, r.oy, r.oz), 2, f);\n"
    "    vstore3((float3)(r.sx, r.sy, r.sz), 3, f);\n"
    "    vstore3(s.near, 4, f);\n"
    "    vstore3(s.far, 5, f);\n"
    "    f[18] = s.o.x;\n"
    "    f[19] = s.o.z;\n"
    "    w[0] = r.kx;\n"
    "    w[1] = r.ky;\n"
    "    w[2] = r.kz;\n"
    "    w[3] = (uint)r.power;\n"
    "    for (uint a = 0; a < 3; a++) {\n"
    "        w[4 + a] = s.near_plane[a];\n"
    "        w[7 + a] = s.far_plane[a];\n"
    "    }\n"
    "}\n";

/* A ray as rays may be: a largest component of the direction from 2^-120 to 2^120. */
static bb_ray any_ray(bb_random *random)
{
    bb_ray ray = {.tmax = INFINITY};
    const int size = (int)bb_random_below(random, 240) - 120;
    const uint32_t longest = bb_random_below(random, 3);
    for (uint32_t k = 0; k < 3; k++) {
        const float sign = bb_random_below(random, 2) ? 1.0f : -1.0f;
        const float one = 1 + (float)bb_random_below(random, 1u << 22) * 0x1p-23f;
        const int below = bb_random_below(random, 3) == 0   ? 0
                          : bb_random_below(random, 3) == 0 ? (int)bb_random_below(random, 20)
                                                            : 55 + (int)bb_random_below(random, 20);
        ray.d[k] =
            sign * ldexpf(bb_random_below(random, 4) ? one : 1, size - (k == longest ? 0 : below));
        if (k != longest && bb_random_below(random, 4) == 0)
            ray.d[k] = sign * 0.0f;
        ray.o[k] = bb_random_below(random, 5) == 0
                       ? sign * 0.0f
                       : sign * ldexpf(one, (int)bb_random_below(random, 60) - 30);
    }
    return ray;
}

/* `floats` and `words` as the kernel writes them. */
static void expect_setup(const bb_ray *ray, float scale, uint32_t i, const float *floats,
                         const uint32_t *words)
{
    const float pad = 0x1.8p-19f;
    float d[3], f[FLOATS];
    uint32_t z = 2, w[WORDS];
    if (fabsf(ray->d[0]) > fabsf(ray->d[1]) && fabsf(ray->d[0]) > fabsf(ray->d[2]))
        z = 0;
    else if (fabsf(ray->d[1]) >= fabsf(ray->d[0]) && fabsf(ray->d[1]) > fabsf(ray->d[2]))
        z = 1;
    const uint32_t x = (z + 1) % 3, y = (z + 2) % 3;
    const int e = ilogbf(ray->d[z]);
    for (uint32_t k = 0; k < 3; k++) {
        f[k] = ray->o[k] * scale;
        d[k] = ldexpf(ray->d[k], -e);
        f[3 + k] = d[k] = fabsf(d[k]) < 0x1p-64f ? 0.0f : d[k];
        const float r = 1 / d[k];
        const bool down = d[k] < 0;
        f[12 + k] = d[k] == 0 ? FLT_MAX : r * (1 - pad);
        f[15 + k] = r * (1 + pad);
        w[4 + k] = (2 * k + down) * 2;
        w[7 + k] = (2 * k + !down) * 2;
    }
    f[6] = f[x];
    f[7] = f[y];
    f[8] = f[z];
    f[9] = d[x] / d[z];
    f[10] = d[y] / d[z];
    f[11] = 1 / d[z];
    f[18] = f[0];
    f[19] = f[2];
    w[0] = x;
    w[1] = y;
    w[2] = z;
    w[3] = (uint32_t)(e + ilogbf(scale));
    for (uint32_t k = 0; k < FLOATS; k++)
        if (memcmp(&f[k], &floats[k], sizeof f[k]) != 0)
            fail_msg("ray %u (d %a %a %a): figure %u is %a, expected %a (seed %llu)", i, ray->d[0],
                     ray->d[1], ray->d[2], k, floats[k], f[k], (unsigned long long)seed);
    for (uint32_t k = 0; k < WORDS; k++)
        if (w[k] != words[k])
            fail_msg("ray %u (d %a %a %a): word %u is %u, expected %u (seed %llu)", i, ray->d[0],
                     ray->d[1], ray->d[2], k, words[k], w[k], (unsigned long long)seed);
}

static void setups_are_as_with_branches(void **state)
{
    (void)state;
    if (!bb_device_divides_exactly(device))
        skip();
    static bb_ray rays[RAYS];
    static float floats[RAYS * FLOATS];
    static uint32_t words[RAYS * WORDS];
    const bb_source source = {.name = "test_ray_setup.cl", .text = text};
    cl_program program;
    cl_kernel kernel;
    check(bb_program_build(device, &source, "-cl-fp32-correctly-rounded-divide-sqrt", &program),
          "program");
    check(bb_kernel_get(program, "test", &kernel), "kernel");
    bb_random random = bb_random_make(seed, 1);
    for (int power = -60; power <= 60; power += 30) {
        const float scale = ldexpf(1, power);
        const uint32_t count = RAYS;
        for (uint32_t i = 0; i < RAYS; i++)
            rays[i] = any_ray(&random);
        bb_buffer d_rays, d_floats, d_words;
        make_buffer(&d_rays, rays, sizeof rays);
        make_buffer(&d_floats, NULL, sizeof floats);
        make_buffer(&d_words, NULL, sizeof words);
        check(bb_launch(device, kernel, RAYS, 64, BB_MEM(d_rays), BB_VALUE(scale), BB_VALUE(count),
                        BB_MEM(d_floats), BB_MEM(d_words)),
              "launch");
        check(bb_buffer_read(&d_floats, 0, sizeof floats, floats), "read");
        check(bb_buffer_read(&d_words, 0, sizeof words, words), "read");
        for (uint32_t i = 0; i < RAYS; i++)
            expect_setup(&rays[i], scale, i, floats + (size_t)FLOATS * i,
                         words + (size_t)WORDS * i);
        bb_buffer_release(&d_rays);
        bb_buffer_release(&d_floats);
        bb_buffer_release(&d_words);
    }
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_programs_clear(device);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(setups_are_as_with_branches),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
