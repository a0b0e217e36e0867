/* For tests that run on a device in each form, with inputs of a seed: BVHBENCH_TEST_SEED takes another. To be included after cmocka. */
#ifndef BB_TEST_BOTH_FORMS_H
#define BB_TEST_BOTH_FORMS_H

#include "framework/device.h"

#include <stdlib.h>

static bb_device *devices[2]; /* BB_FORM_CPU, BB_FORM_GPU */

static int open_devices(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++)
        if (bb_device_open(NULL, form == 0 ? BB_FORM_CPU : BB_FORM_GPU, NULL, &devices[form]) !=
            BB_OK) {
            print_error("%s\n", bb_message());
            return -1;
        }
    return 0;
}

static int close_devices(void **state)
{
    (void)state;
    bb_device_close(devices[0]);
    bb_device_close(devices[1]);
    return 0;
}

static uint64_t seed_or(uint64_t fallback)
{
    const char *given = getenv("BVHBENCH_TEST_SEED");
    return given != NULL ? strtoull(given, NULL, 10) : fallback;
}

#endif
