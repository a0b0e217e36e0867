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

/* The form of the parallel primitives and other kernels that have two. */
typedef enum bb_form {
    BB_FORM_AUTO, /* by device type */
    BB_FORM_CPU,  /* one work-item per chunk, no local memory, no barriers */
    BB_FORM_GPU,  /* work-groups that co-operate through local memory */
} bb_form;

/* How bottom-up passes hand data over between work-groups: kernels/handover.clh. */
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
    char version[128];      /* CL_DEVICE_VERSION */
    bool is_cpu;            /* shares memory with the host */
    bb_form form;           /* BB_FORM_CPU or BB_FORM_GPU, never AUTO */
    bb_handover handover;   /* FENCE or LEVELS, never AUTO */
    char fence[64];         /* options that compile a fence between work-groups; "": no fence */
    uint32_t litmus_pairs;  /* messages between work-groups in the litmus test; 0: no fence */
    uint32_t litmus_stale;  /* words of these that arrived late */
    uint32_t compute_units; /* at least 1 */
    size_t max_group_size;
    cl_device_fp_config float_config; /* CL_DEVICE_SINGLE_FP_CONFIG */
    uint64_t local_bytes;
    uint64_t global_bytes;       /* global memory */
    uint64_t largest_allocation; /* largest size of a buffer */
    uint64_t bytes;              /* booked by our own accounts */
    double event_ms;             /* sum of the event times since bb_device_clear_events() */
    bool profile_events;         /* collect event_ms: a stopwatch is running */
    uint64_t launches;           /* kernels, fills and copies enqueued since opening */
    uint64_t waits;              /* blocking copies, maps and bb_finish() since opening */
    struct bb_event_list *events;
    struct bb_program_cache *programs; /* compiled programs; released with the device */
    const char *kernel_folder; /* edit-and-run: .cl and .h files are looked for here first; may be
                                * NULL */
    char sources[16];          /* "embedded" or "folder": the record says which */
    struct bb_tally *tally;    /* of what is enqueued (tally.h); NULL: none */
} bb_device;

/* Returns whether device code that has two forms uses that for CPUs. */
static inline bool bb_cpu_form(const bb_device *device)
{
    return device->form == BB_FORM_CPU;
}

/* Returns whether the device can round quotients and square roots correctly: kernels that take the
 * same steps then get the same bits. */
bool bb_device_divides_exactly(const bb_device *device);

/* Returns "fence" or "levels". */
const char *bb_handover_word(const bb_device *device);

/* Writes compiler options for programs that include handover.clh; 96 characters are enough. */
void bb_handover_defines(const bb_device *device, char *text, size_t capacity);

/* Waits until everything enqueued is finished. */
bb_status bb_finish(bb_device *device);

/* ---- buffers ---- */

typedef struct bb_buffer {
    cl_mem mem;   /* NULL when empty */
    size_t bytes; /* usable size */
    bb_device *device;
    bb_account *account;
} bb_buffer;

/* Refuses more bytes than the device's memory, or what this process may use, has left. */
bb_status bb_device_has_room(const bb_device *device, uint64_t bytes, const char *what);
/* Ensures that the buffer has at least `bytes`; contents are lost if it grows. Requests that, by
 * our own accounting, exceed the device's memory or its largest allocation are refused, with name
 * and bytes, before the driver is asked. `account` may be NULL. A zeroed bb_buffer is empty. */
bb_status bb_buffer_reserve(bb_device *device, bb_account *account, size_t bytes, const char *what,
                            bb_buffer *buffer);
void bb_buffer_release(bb_buffer *buffer);

/* Blocking copies. Offsets and sizes in bytes. */
bb_status bb_buffer_write(bb_buffer *buffer, size_t offset, size_t bytes, const void *source);
bb_status bb_buffer_read(const bb_buffer *buffer, size_t offset, size_t bytes, void *target);
/* Writes the first `bytes`. Enqueued, not waited for: `source` must not change until it is
 * finished. */
bb_status bb_buffer_send(bb_buffer *buffer, size_t bytes, const void *source);
/* Fills with a 32-bit pattern. Enqueued, not waited for. `bytes` is a multiple of 4. */
bb_status bb_buffer_fill(bb_buffer *buffer, size_t bytes, uint32_t pattern);
/* Copies the first `bytes` from one buffer to another on the device. Enqueued, not waited for. */
bb_status bb_buffer_copy(const bb_buffer *from, bb_buffer *to, size_t bytes);
/* Gives access from the host, blocking: the mapped buffer on devices that share memory, elsewhere a
 * copy, which bb_buffer_unmap() writes back if `write` is set. */
bb_status bb_buffer_map(const bb_buffer *buffer, bool write, void **pointer);
bb_status bb_buffer_unmap(const bb_buffer *buffer, void *pointer);

/* ---- programs ---- */

/* A device source or header, under the name that #include and the build use, such as "lbvh.cl". */
typedef struct bb_source {
    const char *name;
    const char *text;
    const struct bb_source *folder; /* the files of its folder, including itself; ends with name
                                     * NULL. NULL: kernels/ and builders/common */
} bb_source;

/* Declares FILE.cl of the builder's own folder as bb_source_FILE, with '_' for characters that C
 * does not allow in names. */
#define BB_DEVICE_SOURCE(file) extern const bb_source bb_source_##file
/* Returns a source of kernels/ or builders/common; NULL if there is none. */
const bb_source *bb_source_find(const char *name);

/* Compiles `source` with `defines` ("-DX=1 -DY", or ""), or returns the program compiled from them
 * earlier. `#include "x.h"` resolves by name: among the headers of kernels/ and builders/common,
 * and the .clh and _shared.h files of the source's own folder. OpenCL C 1.2 unless `defines` say
 * otherwise (-cl-std=...). "bb_device.h" sets FP_CONTRACT OFF in every program. BB_FAILED carries
 * the first line of the build log. */
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

/* Finds the group size with which the device runs a compiled kernel: `wanted`, halved until the
 * kernel's own limit allows it. BB_UNSUPPORTED if it is compiled for larger groups. */
bb_status bb_kernel_group(const bb_device *device, cl_kernel kernel, size_t wanted, size_t *group);

/* Sets the arguments and enqueues; does not wait. Groups are smaller than `local` if the device
 * only runs this kernel in smaller ones (it may need many registers). A kernel whose work-items
 * co-operate therefore declares its group size (reqd_work_group_size), and BB_UNSUPPORTED is
 * returned if that is too large. `global` is rounded up to a multiple of the group size: kernels
 * compare their id with a count. BB_FAILED, with the kernel's name, if the number or size of the
 * arguments is wrong, or the driver refuses the launch. */
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
