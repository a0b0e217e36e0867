/* An OpenCL device with one in-order queue, its accounted buffers, its programs and launches. */
#ifndef BB_DEVICE_H
#define BB_DEVICE_H

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include "framework/base/memory.h"
#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Which form of the parallel primitives and other form-dependent kernels to use. */
typedef enum bb_form {
    BB_FORM_AUTO, /* by device type */
    BB_FORM_CPU,  /* one work-item per chunk, no local memory, no barriers */
    BB_FORM_GPU,  /* work-groups that co-operate through local memory */
} bb_form;

/* How bottom-up passes hand data from one work-group to another: kernels/handover.clh. */
typedef enum bb_handover {
    BB_HANDOVER_AUTO,   /* as the device documents, confirmed by a litmus test */
    BB_HANDOVER_FENCE,  /* inside a launch */
    BB_HANDOVER_LEVELS, /* from one launch to the next */
} bb_handover;

typedef struct bb_device {
    cl_platform_id platform;
    cl_device_id id;
    cl_context context;
    cl_command_queue queue; /* in order, profiling on */
    char name[256];
    char driver[128];
    char version[128];     /* CL_DEVICE_VERSION */
    bool is_cpu;           /* shares memory with the host */
    bb_form form;          /* BB_FORM_CPU or BB_FORM_GPU, never AUTO */
    bb_handover handover;  /* FENCE or LEVELS, never AUTO */
    char fence[64];        /* options that compile a fence between work-groups; "": there is none */
    uint32_t litmus_pairs; /* of work-groups' messages in the litmus test; 0: there is no fence */
    uint32_t litmus_stale; /* words of them that were not there yet */
    uint32_t compute_units; /* at least 1 */
    size_t max_group_size;
    cl_device_fp_config float_config; /* CL_DEVICE_SINGLE_FP_CONFIG */
    uint64_t local_bytes;
    uint64_t global_bytes;       /* what the device has */
    uint64_t largest_allocation; /* what one buffer may have */
    uint64_t bytes;              /* in use by our own account */
    double event_ms;             /* sum of the event times since bb_device_clear_events() */
    bool profile_events;         /* collect event_ms: a stopwatch runs */
    uint64_t launches;           /* kernels, fills and copies enqueued since it was opened */
    uint64_t waits;              /* blocking copies and maps since then, and bb_finish() */
    struct bb_event_list *events;
    struct bb_program_cache *programs; /* what was compiled; released with the device */
    const char *kernel_folder; /* edit-and-run: .cl and .h are read from here first; may be NULL */
    char sources[16];          /* "embedded" or "folder": the record says which */
} bb_device;

/* Whether device code that has two forms takes that for CPUs. */
static inline bool bb_cpu_form(const bb_device *device)
{
    return device->form == BB_FORM_CPU;
}

/* Whether the device can round quotients and square roots correctly: kernels that take the same
 * steps then get the same bits. */
bool bb_device_divides_exactly(const bb_device *device);

/* "fence" or "levels". */
const char *bb_handover_word(const bb_device *device);

/* Compiler options for programs that include handover.clh; 96 characters are enough. */
void bb_handover_defines(const bb_device *device, char *text, size_t capacity);

/* Waits until everything enqueued is done. */
bb_status bb_finish(bb_device *device);

/* ---- buffers ---- */

typedef struct bb_buffer {
    cl_mem mem;   /* NULL when empty */
    size_t bytes; /* usable size */
    bb_device *device;
    bb_account *account;
} bb_buffer;

/* Makes sure that the buffer has at least `bytes` (contents are lost if it grows). Requests that,
 * by our own accounting, exceed the device's memory or its largest allocation are refused, with
 * name and bytes, before the driver is asked. Account may be NULL. A zeroed bb_buffer is empty. */
bb_status bb_buffer_reserve(bb_device *device, bb_account *account, size_t bytes, const char *what,
                            bb_buffer *buffer);
void bb_buffer_release(bb_buffer *buffer);

/* Blocking copies. Offsets and sizes in bytes. */
bb_status bb_buffer_write(bb_buffer *buffer, size_t offset, size_t bytes, const void *source);
bb_status bb_buffer_read(const bb_buffer *buffer, size_t offset, size_t bytes, void *target);
/* Writes the first `bytes`; enqueued, not waited for: `source` stays as it is until it is done. */
bb_status bb_buffer_send(bb_buffer *buffer, size_t bytes, const void *source);
/* Fills with a 32-bit pattern; enqueued, not waited for. `bytes` is a multiple of 4. */
bb_status bb_buffer_fill(bb_buffer *buffer, size_t bytes, uint32_t pattern);
/* Copies the first `bytes` from one buffer to another on the device; enqueued, not waited for. */
bb_status bb_buffer_copy(const bb_buffer *from, bb_buffer *to, size_t bytes);
/* For host access: mapped on devices that share memory, elsewhere a copy, which goes back if it was
 * for writing; blocking. */
bb_status bb_buffer_map(const bb_buffer *buffer, bool write, void **pointer);
bb_status bb_buffer_unmap(const bb_buffer *buffer, void *pointer);

/* ---- programs ---- */

/* A device source or header, under the name that #include and the build use, such as "lbvh.cl". */
typedef struct bb_source {
    const char *name;
    const char *text;
    const struct bb_source *folder; /* the files that lie with it, itself among them; ends with name
                                       NULL. NULL: kernels/ and builders/common */
} bb_source;

/* Declares FILE.cl of the builder's own folder as bb_source_FILE, with '_' for characters that C
 * does not allow in names. */
#define BB_DEVICE_SOURCE(file) extern const bb_source bb_source_##file
/* A source of kernels/ or builders/common; NULL if there is none. */
const bb_source *bb_source_find(const char *name);

/* Compiles `source` with `defines` ("-DX=1 -DY", or ""), or returns what was compiled of it before
 * with the same. `#include "x.h"` resolves by name: among the headers of kernels/ and
 * builders/common, and the .clh and _shared.h of the source's own folder. OpenCL C 1.2 unless
 * `defines` say otherwise (-cl-std=...). Every program gets FP_CONTRACT OFF from "bb_device.h".
 * BB_FAILED carries the first line of the build log. */
bb_status bb_program_build(bb_device *device, const bb_source *source, const char *defines,
                           cl_program *program);
bb_status bb_kernel_get(cl_program program, const char *name, cl_kernel *kernel);
void bb_program_release(cl_program program); /* NULL is allowed */
void bb_kernel_release(cl_kernel kernel);    /* NULL is allowed */

/* ---- launches ---- */

typedef struct bb_arg {
    size_t size;
    const void *value;
} bb_arg;

#define BB_MEM(buffer) ((bb_arg){sizeof(cl_mem), &(buffer).mem})
#define BB_VALUE(variable) ((bb_arg){sizeof(variable), &(variable)})

/* The group in which the device runs a compiled kernel: `wanted`, or half of it, or a quarter ...
 * until the kernel's own limit allows it. BB_UNSUPPORTED if it is compiled for larger ones. */
bb_status bb_kernel_group(const bb_device *device, cl_kernel kernel, size_t wanted, size_t *group);

/* Sets the arguments and enqueues; does not wait. Groups are smaller than `local` if the device
 * runs this kernel in smaller ones only (it may need many registers): a kernel whose work-items
 * co-operate says how large its groups are (reqd_work_group_size), and BB_UNSUPPORTED is returned
 * where that is too large. `global` is rounded up to a multiple of the groups' size: kernels
 * compare their id with a count. BB_FAILED, with the kernel's name, if there are more or fewer
 * arguments than it takes, one has the wrong size, or the driver refuses the launch. */
bb_status bb_launch_args(bb_device *device, cl_kernel kernel, size_t global, size_t local,
                         const bb_arg *args, uint32_t count);
#define bb_launch(device, kernel, global, local, ...)                                              \
    bb_launch_args((device), (kernel), (global), (local), (const bb_arg[]){__VA_ARGS__},           \
                   (uint32_t)(sizeof((const bb_arg[]){__VA_ARGS__}) / sizeof(bb_arg)))

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
