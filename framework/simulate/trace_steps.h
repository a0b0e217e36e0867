/* The steps of rays that a kernel traces. */
#ifndef BB_TRACE_STEPS_H
#define BB_TRACE_STEPS_H

#include "framework/judge/rays.h"
#include "framework/simulate/steps.h"

/* Traces rays[0..count) by the recording variant of what is requested, and records the steps of all
 * of them, or of a sample: bb_steps_record(). BB_UNSUPPORTED if the kernel has no such variant.
 * BB_REFUSED if there is no room for all rays. */
bb_status bb_trace_steps(bb_device *device, const bb_traverser_request *request,
                         const bb_layout_data *layout, const bb_ray *rays, uint32_t count,
                         bb_sample_size size, bb_steps *steps);

#endif
