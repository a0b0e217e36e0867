/* builders/common/compact: the values that are marked, in their order, in both forms; against the
 * host. */
#include "builders/common/compact.h"
#include "framework/base/random.h"
#include "tests/tree_fixture.h"

#include "tests/device_forms.h"

enum { MOST = 70000 };

static uint32_t marks[MOST], values[MOST], expected[MOST], found[MOST + 1];

static void write_all(bb_device *device, bb_buffer *buffer, const uint32_t *from, uint32_t count)
{
    size_t bytes = ((size_t)count + 1) * sizeof(uint32_t);
    ASSERT_OK(bb_buffer_reserve(device, NULL, bytes, "test", buffer));
    if (count > 0 && from != NULL)
        ASSERT_OK(bb_buffer_write(buffer, 0, count * sizeof(uint32_t), from));
}

/* One in `rarity` is kept. What lies behind the kept ones stays as it was. */
static void check_compaction(int form, uint32_t count, uint32_t rarity, bool numbers)
{
    bb_device *device = devices[form];
    bb_random random = bb_random_make(17, count + rarity);
    bb_buffer d_marks = {0}, d_values = {0}, out = {0}, kept = {0};
    bb_primitives *primitives = NULL;
    bb_compaction *compaction = NULL;
    uint32_t wanted = 0, said;
    for (uint32_t i = 0; i < count; i++) {
        marks[i] = bb_random_below(&random, rarity) == 0;
        values[i] = (uint32_t)bb_random_u64(&random);
        if (marks[i] != 0)
            expected[wanted++] = numbers ? i : values[i];
    }
    ASSERT_OK(bb_primitives_create(device, NULL, &primitives));
    ASSERT_OK(bb_compaction_create(device, NULL, primitives, &compaction));
    write_all(device, &d_marks, marks, count);
    write_all(device, &d_values, values, count);
    write_all(device, &out, NULL, count);
    write_all(device, &kept, NULL, 1);
    ASSERT_OK(bb_buffer_fill(&out, out.bytes / 4 * 4, 0xABABABAB));
    for (int again = 0; again < 2; again++)
        ASSERT_OK(
            bb_compact_u32(compaction, &d_marks, numbers ? NULL : &d_values, count, &out, &kept));
    ASSERT_OK(bb_buffer_read(&kept, 0, sizeof said, &said));
    assert_int_equal(said, wanted);
    ASSERT_OK(bb_buffer_read(&out, 0, ((size_t)count + 1) * sizeof(uint32_t), found));
    assert_memory_equal(found, expected, wanted * sizeof(uint32_t));
    for (uint32_t i = wanted; i <= count; i++)
        assert_int_equal(found[i], 0xABABABAB);
    bb_compaction_destroy(compaction);
    bb_primitives_destroy(primitives);
    bb_buffer_release(&d_marks);
    bb_buffer_release(&d_values);
    bb_buffer_release(&out);
    bb_buffer_release(&kept);
}

static void what_is_marked_stays_in_order(void **state)
{
    (void)state;
    static const uint32_t counts[] = {0, 1, 63, 64, 65, 1000, MOST},
                          rarities[] = {1, 2, 50, 100000};
    for (int form = CPU_FORM; form <= GPU_FORM; form++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
            for (size_t r = 0; r < sizeof rarities / sizeof rarities[0]; r++)
                check_compaction(form, counts[c], rarities[r], (c + r) % 2 == 0);
}

static void what_is_too_small_is_refused(void **state)
{
    (void)state;
    bb_buffer marks_of_two = {0}, out = {0}, kept = {0};
    bb_primitives *primitives = NULL;
    bb_compaction *compaction = NULL;
    ASSERT_OK(bb_primitives_create(devices[CPU_FORM], NULL, &primitives));
    ASSERT_OK(bb_compaction_create(devices[CPU_FORM], NULL, primitives, &compaction));
    write_all(devices[CPU_FORM], &marks_of_two, NULL, 1);
    write_all(devices[CPU_FORM], &out, NULL, 8);
    write_all(devices[CPU_FORM], &kept, NULL, 1);
    assert_int_equal(bb_compact_u32(compaction, &marks_of_two, NULL, 1 << 20, &out, &kept),
                     BB_INVALID);
    bb_compaction_destroy(compaction);
    bb_primitives_destroy(primitives);
    bb_buffer_release(&marks_of_two);
    bb_buffer_release(&out);
    bb_buffer_release(&kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_marked_stays_in_order),
        cmocka_unit_test(what_is_too_small_is_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
