/* For tests that run on a device in each of its forms.
 *
 * BVHBENCH_TEST_LEVELS=1 takes the last form only: in it no work-group hands over to another inside
 * a launch, so that a tool may look for data races.
 */
#ifndef BB_TEST_DEVICE_FORMS_H
#define BB_TEST_DEVICE_FORMS_H

#include "tests/device_fixture.h"

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
        if (open_test_device(primitives, NULL, &devices[form]) != BB_OK) {
            print_error("%s\n", bb_message());
            return -1;
        }
        bb_device *opened = devices[form];
        /* where there is none (oclgrind runs one group after the other): OpenCL 1.2's */
        if (opened->handover == BB_HANDOVER_LEVELS)
            strcpy(opened->fence, "-DBB_DEVICE_FENCE()=mem_fence(CLK_GLOBAL_MEM_FENCE)");
        opened->handover = form == LEVELS_FORM ? BB_HANDOVER_LEVELS : BB_HANDOVER_FENCE;
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

#endif
