/* What is tallied of launches, sorts, fills, copies and transfers whose bytes are known, and the
 * bounds that follow (framework/device/tally.h, framework/simulate/build.h). */
#include "framework/device/primitives.h"
#include "framework/device/stopwatch.h"
#include "framework/simulate/build.h"
#include "tests/device_fixture.h"

#include <string.h>

enum { COUNT = 1000, WORD = 4, ARRAY = COUNT * WORD };

static const bb_source source = {
    .name = "tallied.cl",
    .text = "kernel void add(global const uint *a, global uint *b, uint n)\n"
            "{\n"
            "    if (get_global_id(0) < n)\n"
            "        b[get_global_id(0)] += a[get_global_id(0)];\n"
            "}\n"};

static bb_tally tally;
static bb_stopwatch watch;
static bb_buffer a, b, c;

static void begin(void)
{
    tally = (bb_tally){0};
    bb_tally_attach(&tally, device);
    make_buffer(&a, NULL, ARRAY);
    make_buffer(&b, NULL, ARRAY);
    make_buffer(&c, NULL, 2 * ARRAY);
    ASSERT_OK(bb_buffer_fill(&a, ARRAY, 0));
    ASSERT_OK(bb_buffer_fill(&b, ARRAY, 0));
    assert_int_equal(tally.move_count, 0); /* before the clock starts */
    ASSERT_OK(bb_stopwatch_start(device, &watch));
}

static bb_timing stop(void)
{
    bb_timing timing;
    ASSERT_OK(bb_stopwatch_stop(&watch, BB_OK, &timing));
    bb_tally_detach(&tally, device);
    return timing;
}

static void end(void)
{
    bb_buffer_release(&a);
    bb_buffer_release(&b);
    bb_buffer_release(&c);
    bb_tally_release(&tally);
}

static uint64_t bytes(void)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < tally.move_count; i++)
        sum += tally.moves[i].bytes;
    return sum;
}

static void launches_share_their_arrays(void **state)
{
    (void)state;
    const uint32_t count = COUNT;
    cl_program program;
    cl_kernel kernel;
    begin();
    ASSERT_OK(bb_program_build(device, &source, "", &program));
    ASSERT_OK(bb_kernel_get(program, "add", &kernel));
    for (int level = 0; level < 3; level++) {
        ASSERT_OK(bb_launch(device, kernel, COUNT, 64, BB_MEM(a), BB_MEM(b), BB_VALUE(count)));
        assert_int_equal(bytes(), 2 * ARRAY);
    }
    ASSERT_OK(bb_launch(device, kernel, COUNT, 64, BB_MEM(a), BB_MEM(c), BB_VALUE(count)));
    assert_int_equal(bytes(), 2 * ARRAY + 3 * ARRAY); /* c is twice as large */
    ASSERT_OK(bb_launch(device, kernel, COUNT, 64, BB_MEM(b), BB_MEM(b), BB_VALUE(count)));
    assert_int_equal(bytes(), 5 * ARRAY + ARRAY); /* one array is no two */
    assert_int_equal(tally.moves[5 - 1].arrays, ARRAY);
    assert_int_equal(tally.array_bytes, 4 * ARRAY);
    ASSERT_OK(
        bb_launch(bb_tally_pass(device), kernel, COUNT, 64, BB_MEM(a), BB_MEM(b), BB_VALUE(count)));
    assert_int_equal(bytes(), 8 * ARRAY);
    ASSERT_OK(bb_launch(device, kernel, COUNT, 64, BB_MEM(a), BB_MEM(b), BB_VALUE(count)));
    assert_int_equal(bytes(), 8 * ARRAY); /* only that launch was a pass of its own */
    assert_int_equal(stop().launches, 7);
    assert_int_equal(tally.move_count, 7);
    ASSERT_OK(bb_buffer_fill(&a, ARRAY, 0));
    assert_int_equal(tally.move_count, 7); /* after the clock has stopped */
    bb_kernel_release(kernel);
    bb_program_release(program);
    end();
}

static void parts_move_their_bytes(void **state)
{
    (void)state;
    uint32_t words[2] = {1, 2};
    void *mapped;
    begin();
    ASSERT_OK(bb_buffer_fill(&a, 12, 7));
    assert_int_equal(bytes(), 12);
    ASSERT_OK(bb_buffer_copy(&a, &b, 8));
    assert_int_equal(bytes(), 12 + 2 * 8);
    ASSERT_OK(bb_buffer_write(&a, 4, sizeof words, words));
    ASSERT_OK(bb_buffer_send(&a, sizeof words[0], words));
    ASSERT_OK(bb_buffer_read(&a, 0, sizeof words, words));
    assert_int_equal(bytes(), 28 + 8 + 4 + 8);
    ASSERT_OK(bb_buffer_map(&b, false, &mapped));
    ASSERT_OK(bb_buffer_unmap(&b, mapped));
    assert_int_equal(bytes(), 48 + ARRAY);
    assert_int_equal(tally.array_bytes, 2 * ARRAY);
    stop();
    end();
}

/* A sort by 8 bits has two passes of 4; each counts digits (a tile has 1,024 keys: 16 counters),
 * scans the counts, whose total nobody wants, and moves the pairs from one place to the other. */
static void a_sort_passes_over_all_pairs(void **state)
{
    (void)state;
    enum {
        COUNTERS = 16 * WORD,
        PASS = (ARRAY + COUNTERS) + (COUNTERS + WORD) + (4 * ARRAY + COUNTERS)
    };
    bb_account account = {0};
    bb_primitives *primitives;
    begin();
    ASSERT_OK(bb_primitives_create(device, &account, &primitives));
    ASSERT_OK(bb_primitives_reserve(primitives, COUNT, WORD));
    ASSERT_OK(bb_sort_u32(primitives, &a, &b, COUNT, 8));
    assert_int_equal(stop().launches, 2 * 3);
    assert_int_equal(tally.sort_passes, 2);
    assert_int_equal(bytes(), 2 * PASS);
    assert_int_equal(tally.array_bytes, 4 * ARRAY + COUNTERS + WORD);
    bb_primitives_destroy(primitives);
    end();
}

static void the_device_is_itself_again(void **state)
{
    (void)state;
    const bb_device before = *device;
    tally = (bb_tally){0};
    bb_tally_attach(&tally, device);
    assert_int_equal(device->form, BB_FORM_GPU);
    assert_int_equal(device->handover, BB_HANDOVER_LEVELS);
    bb_tally_detach(&tally, device);
    bb_tally_release(&tally);
    assert_memory_equal(device, &before, sizeof before);
}

/* A clock of 1 GHz, 10 bytes a clock from a cache of 1,000 bytes, 1 GB/s from memory. */
static void bounds_follow(void **state)
{
    (void)state;
    const bb_description paper = {
        .clock_ghz = 1, .second_bytes = 1000, .second_bytes_per_clock = 10, .memory_gb_s = 1};
    bb_tally_move moves[] = {{600, 1000}, {0, 1000}, {800, 1001}};
    bb_build_moves build = {
        .tally = {.moves = moves, .move_count = 3, .sort_passes = 4, .array_bytes = 700},
        .launches = 3,
        .waits = 1};
    bb_build_simulation s = bb_simulate_build(&paper, &build);
    assert_float_equal(s.bytes, 1400, 0);
    assert_float_equal(s.memory_bytes, 800, 0); /* of the launch that does not fit */
    assert_float_equal(s.l2_ms, 140e-6, 1e-12);
    assert_float_equal(s.memory_ms, 800e-6, 1e-12);
    assert_float_equal(s.ms, s.memory_ms, 0);
    assert_int_equal(s.binds, BB_BY_MEMORY);
    assert_float_equal(s.launches, 3, 0);
    assert_float_equal(s.waits, 1, 0);
    assert_float_equal(s.sort_passes, 4, 0);

    moves[2].arrays = 1000; /* all fits: each array once */
    build.tally.array_bytes = 100;
    s = bb_simulate_build(&paper, &build);
    assert_float_equal(s.memory_bytes, 100, 0);
    assert_float_equal(s.ms, 140e-6, 1e-12);
    assert_int_equal(s.binds, BB_BY_SECOND);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(launches_share_their_arrays),
        cmocka_unit_test(parts_move_their_bytes),
        cmocka_unit_test(a_sort_passes_over_all_pairs),
        cmocka_unit_test(the_device_is_itself_again),
        cmocka_unit_test(bounds_follow),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
