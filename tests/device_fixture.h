/* What tests on a device share: the device, which BVHBENCH_TEST_DEVICE names (as --device does; the
 * preferred one otherwise), and the seed of their inputs. */
#ifndef BB_TEST_DEVICE_FIXTURE_H
#define BB_TEST_DEVICE_FIXTURE_H

#include "framework/device/device_private.h"
#include "tests/fixture.h"
#include "traversal/traversal.h"

static bb_device *device;
static uint64_t seed = 20261121;

static inline bb_status open_test_device(bb_form form, const char *kernel_folder, bb_device **out)
{
    return bb_device_open(getenv("BVHBENCH_TEST_DEVICE"), form, kernel_folder, out);
}

/* Set-up and tear-down of a group. */
static inline int open_device(void **state)
{
    (void)state;
    seed = seed_or(seed);
    if (open_test_device(BB_FORM_AUTO, NULL, &device) == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

static inline int close_device(void **state)
{
    (void)state;
    bb_traversers_clear(device);
    bb_device_close(device);
    return 0;
}

static inline void check(bb_status status, const char *what)
{
    if (status != BB_OK)
        fail_msg("%s (seed %llu): %s", what, (unsigned long long)seed, bb_message());
}

/* A buffer of `bytes` bytes, with `data` in it unless that is NULL. */
static inline void make_buffer(bb_buffer *buffer, const void *data, size_t bytes)
{
    *buffer = (bb_buffer){0};
    ASSERT_OK(bb_buffer_reserve(device, NULL, bytes, "test", buffer));
    if (data != NULL)
        ASSERT_OK(bb_buffer_write(buffer, 0, bytes, data));
}

/* For walks of the registry: false, and said by name, if the builder does not take what it was
 * given. Counts what it took in *ran: a walk that ran nothing has shown nothing. */
static inline bool is_taken(bb_status status, const char *builder, uint32_t *ran)
{
    if (status == BB_UNSUPPORTED) {
        print_message("skipped: %s: %s\n", builder, bb_message());
        return false;
    }
    check(status, builder);
    ++*ran;
    return true;
}

#endif
