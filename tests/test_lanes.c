/* Masks and moves of lanes, in each of their forms: for what the device has, and for less. */
#include "tests/device_fixture.h"

#include <stdio.h>

enum { LANES = 8, MASKS = 1 << LANES };

static const bb_source source = {
    .name = "test_lanes.cl",
    .text = "#if FORM > 0\n"
            "#undef __AVX512VL__\n"
            "#undef __AVX512DQ__\n"
            "#endif\n"
            "#if FORM > 1\n"
            "#undef __BMI2__\n"
            "#endif\n"
            "#if FORM > 2\n"
            "#undef __AVX2__\n"
            "#undef __AVX__\n"
            "#undef __SSE__\n"
            "#endif\n"
            "#include \"bb_device.h\"\n"
            "#include \"lanes.clh\"\n"
            "kernel void test(global uint8 *compressed, global uint8 *picked, global uint *bits)\n"
            "{\n"
            "    uint mask = get_global_id(0);\n"
            "    uint8 lane = (uint8)(0, 1, 2, 3, 4, 5, 6, 7), v = 100u + lane;\n"
            "    int8 met = ((uint8)(mask) >> lane & 1u) != 0u;\n"
            "    compressed[mask] = bb_compress8(v, mask);\n"
            "    picked[mask] = bb_pick8(v, lane ^ mask);\n"
            "    bits[4 * mask] = bb_bits2(met.lo.lo);\n"
            "    bits[4 * mask + 1] = bb_bits4(met.lo);\n"
            "    bits[4 * mask + 2] = bb_bits8(met);\n"
            "    bits[4 * mask + 3] = bb_bits16((int16)(met, ~met));\n"
            "}\n"};

static void expect_form(int form)
{
    static uint32_t compressed[MASKS][LANES], picked[MASKS][LANES], bits[MASKS][4];
    bb_buffer d_compressed, d_picked, d_bits;
    cl_program program;
    cl_kernel kernel;
    char defines[16];
    snprintf(defines, sizeof defines, "-DFORM=%d", form);
    make_buffer(&d_compressed, NULL, sizeof compressed);
    make_buffer(&d_picked, NULL, sizeof picked);
    make_buffer(&d_bits, NULL, sizeof bits);
    ASSERT_OK(bb_program_build(device, &source, defines, &program));
    ASSERT_OK(bb_kernel_get(program, "test", &kernel));
    ASSERT_OK(bb_launch(device, kernel, MASKS, 1, BB_MEM(d_compressed), BB_MEM(d_picked),
                        BB_MEM(d_bits)));
    ASSERT_OK(bb_buffer_read(&d_compressed, 0, sizeof compressed, compressed));
    ASSERT_OK(bb_buffer_read(&d_picked, 0, sizeof picked, picked));
    ASSERT_OK(bb_buffer_read(&d_bits, 0, sizeof bits, bits));
    for (uint32_t mask = 0; mask < MASKS; mask++) {
        const uint32_t expected[4] = {mask & 3, mask & 15, mask, mask | (~mask & 255) << 8};
        uint32_t at = 0;
        for (uint32_t lane = 0; lane < LANES; lane++) {
            assert_int_equal(picked[mask][lane], 100 + ((lane ^ mask) & 7));
            if ((mask >> lane & 1) != 0 && compressed[mask][at++] != 100 + lane)
                fail_msg("form %d, mask %x: lane %u is %u", form, mask, at - 1,
                         compressed[mask][at - 1]);
        }
        assert_memory_equal(bits[mask], expected, sizeof expected);
    }
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_buffer_release(&d_compressed);
    bb_buffer_release(&d_picked);
    bb_buffer_release(&d_bits);
}

static void lanes_are_what_they_say(void **state)
{
    (void)state;
    for (int form = 0; form < 4; form++)
        expect_form(form);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lanes_are_what_they_say)};
    return cmocka_run_group_tests(tests, open_device, close_device);
}
