/* For tests that run on a device in each of its forms, with inputs of a seed: BVHBENCH_TEST_SEED takes
 * another. To be included after cmocka.
 *
 * BVHBENCH_TEST_LEVELS=1 takes the last form only: in it no work-group hands over to another inside a
 * launch, so that a tool may look for data races.
 */
#ifndef BB_TEST_DEVICE_FORMS_H
#define BB_TEST_DEVICE_FORMS_H

#include "framework/device/device_private.h"

#include <stdlib.h>
#include <string.h>

/* Primitives for CPUs and for GPUs, hand-over by a fence; for GPUs, hand-over by levels. */
enum { CPU_FORM, GPU_FORM, LEVELS_FORM, FORMS };
static bb_device *devices[FORMS];

static inline int first_form(void)
{
    return getenv("BVHBENCH_TEST_LEVELS") != NULL ? LEVELS_FORM : CPU_FORM;
}

static inline int open_devices(void **state)
{
    (void)state;
    for (int form = CPU_FORM; form < FORMS; form++) {
        bb_form primitives = form == CPU_FORM ? BB_FORM_CPU : BB_FORM_GPU;
        if (bb_device_open(NULL, primitives, NULL, &devices[form]) != BB_OK) {
            print_error("%s\n", bb_message());
            return -1;
        }
        bb_device *device = devices[form];
        /* where there is none (oclgrind runs one group after the other): OpenCL 1.2's */
        if (device->handover == BB_HANDOVER_LEVELS)
            strcpy(device->fence, "-DBB_DEVICE_FENCE()=mem_fence(CLK_GLOBAL_MEM_FENCE)");
        device->handover = form == LEVELS_FORM ? BB_HANDOVER_LEVELS : BB_HANDOVER_FENCE;
    }
    return 0;
}

static inline int close_devices(void **state)
{
    (void)state;
    for (int form = CPU_FORM; form < FORMS; form++)
        bb_device_close(devices[form]);
    return 0;
}

static inline uint64_t seed_or(uint64_t fallback)
{
    const char *given = getenv("BVHBENCH_TEST_SEED");
    return given != NULL ? strtoull(given, NULL, 10) : fallback;
}

#endif
