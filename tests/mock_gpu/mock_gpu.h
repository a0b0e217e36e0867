/* A GPU for tests, made of PoCL's device: what its files share. README.md says what it does. */
#ifndef MOCK_GPU_H
#define MOCK_GPU_H

#define CL_TARGET_OPENCL_VERSION 300
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include <dlfcn.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What the environment asks for: MOCK_GPU_GROUP and so on. */
typedef struct mock_settings {
    cl_device_type types[8]; /* of PoCL's devices, in their order */
    uint32_t type_count;
    size_t group;
    const char *kernel; /* the kernel that takes `kernel_group` at most; NULL: none */
    size_t kernel_group;
    cl_ulong local_bytes, largest, memory;
    cl_uint units;
    const char *fence;
    const char *fails;  /* the kernel whose launch fails; NULL: none */
    uint32_t fail_at;   /* its n-th launch, from 1 */
    const char *manner; /* resources, late, lost */
    const char *silent; /* the source whose build fails without a word; NULL: none */
    const char *record; /* folder; NULL: no recording */
    const char *counts; /* file; NULL: no counts */
} mock_settings;

extern mock_settings mock;

/* The function of this name that comes after ours. */
#define REAL(name) (__extension__(__typeof__(&name)) dlsym(RTLD_NEXT, #name))

/* Whether it is one of our GPUs (or accelerators), not a CPU passed through. */
bool mock_is_gpu(cl_device_id device);
bool mock_queue_is_gpu(cl_command_queue queue);
bool mock_context_is_gpu(cl_context context);

/* Of a clGet...Info() whose answer is ours. */
cl_int mock_answer(const void *value, size_t size, size_t room, void *out, size_t *size_out);

/* The most work-items that a group of the kernel may have. */
size_t mock_kernel_group(cl_kernel kernel);
void mock_kernel_name(cl_kernel kernel, char *name, size_t capacity);
/* "*" matches any name. */
bool mock_matches(const char *pattern, const char *name);

typedef enum mock_call {
    MOCK_LAUNCH,
    MOCK_READ, /* all of bvhbench's block */
    MOCK_WRITE,
    MOCK_FILL,
    MOCK_COPY,
    MOCK_MAP,
    MOCK_FINISH,
    MOCK_BUILD,
    MOCK_BUFFER,
    MOCK_REFUSED, /* those of the above that the mock refused */
    MOCK_CALLS,
} mock_call;

void mock_count(mock_call call);
void mock_count_launch(const char *kernel);

/* Writes FOLDER/NAME-HASH.cl: the options in a comment, then the text; once for each. */
void mock_record_program(cl_program program, const char *options);
/* The name in the first line of the program's text, as `#line 1 "NAME"` gives it. */
void mock_program_name(const char *text, char *name, size_t capacity);
char *mock_program_text(cl_program program);

#endif
