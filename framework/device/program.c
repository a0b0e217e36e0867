/* Programs and launches: compiling with the embedded headers, kernels, arguments, event times. */
#include "framework/device/cl_error.h"
#include "framework/device/device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADERS_MAX = 64 };

const bb_source *bb_source_find(const char *name)
{
    for (const bb_source *source = bb_embedded_sources; source->name != NULL; source++)
        if (strcmp(source->name, name) == 0)
            return source;
    return NULL;
}

static bool has_ending(const char *name, const char *ending)
{
    size_t length = strlen(name), size = strlen(ending);
    return length >= size && strcmp(name + length - size, ending) == 0;
}

/* Text of FOLDER/NAME if the device has an edit-and-run folder and the file is there; else NULL. Freed by the caller. */
static char *read_override(bb_device *device, const char *name)
{
    if (device->kernel_folder == NULL)
        return NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", device->kernel_folder, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    char *text = NULL;
    size_t used = 0, got = 0;
    do {
        char *grown = realloc(text, used + 65536 + 1);
        if (grown == NULL)
            break;
        text = grown;
        got = fread(text + used, 1, 65536, file);
        used += got;
        text[used] = '\0';
    } while (got > 0);
    fclose(file);
    strcpy(device->sources, "folder");
    return text;
}

static bb_status create_program(bb_device *device, const bb_source *source, cl_program *program)
{
    char *override = read_override(device, source->name);
    const char *text = override != NULL ? override : source->text;
    cl_int error;
    *program = clCreateProgramWithSource(device->context, 1, &text, NULL, &error);
    free(override);
    BB_CL_TRY(error, "making a program of %s", source->name);
    return BB_OK;
}

/* The first error of a build log, as the one line that the message has room for. */
static bb_status fail_with_log(bb_device *device, cl_program program, const char *name,
                               cl_int error)
{
    size_t size = 0;
    clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &size);
    char *log = calloc(1, size + 1);
    if (log == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, size, log, NULL);
    const char *line = strstr(log, "error:");
    if (line == NULL)
        line = log;
    while (line > log && line[-1] != '\n')
        line--;
    bb_status status = bb_fail(BB_FAILED, "compiling %s: %s: %.*s", name, bb_cl_error(error),
                               (int)strcspn(line, "\n"), line);
    free(log);
    return status;
}

static bb_status compile(bb_device *device, const bb_source *source, const char *options,
                         cl_program *program)
{
    cl_program main = NULL, headers[HEADERS_MAX];
    const char *names[HEADERS_MAX];
    cl_uint count = 0;
    bb_status status = create_program(device, source, &main);
    for (const bb_source *header = bb_embedded_sources; status == BB_OK && header->name != NULL;
         header++) {
        if (!has_ending(header->name, ".h") && !has_ending(header->name, ".clh"))
            continue;
        if (count == HEADERS_MAX) {
            status = bb_fail(BB_FAILED, "more than %d device headers", HEADERS_MAX);
            break;
        }
        status = create_program(device, header, &headers[count]);
        if (status == BB_OK)
            names[count++] = header->name;
    }
    if (status != BB_OK)
        goto out;

    cl_int error =
        clCompileProgram(main, 1, &device->id, options, count, headers, names, NULL, NULL);
    if (error != CL_SUCCESS) {
        status = fail_with_log(device, main, source->name, error);
        goto out;
    }
    *program = clLinkProgram(device->context, 1, &device->id, "", 1, &main, NULL, NULL, &error);
    if (error != CL_SUCCESS) {
        status = fail_with_log(device, *program != NULL ? *program : main, source->name, error);
        bb_program_release(*program);
        *program = NULL;
    }
out:
    for (cl_uint i = 0; i < count; i++)
        clReleaseProgram(headers[i]);
    bb_program_release(main);
    return status;
}

/* Objects of builders and layouts come and go; what they compile stays with the device. */
struct bb_program_cache {
    struct bb_program_cache *next;
    const char *text; /* of the source: tells two sources of one name apart */
    cl_program program;
    char key[2304]; /* name and options */
};

static bb_status remember(bb_device *device, const bb_source *source, const char *key,
                          cl_program program)
{
    struct bb_program_cache *entry = calloc(1, sizeof *entry);
    if (entry == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    entry->text = source->text;
    entry->program = program;
    strcpy(entry->key, key);
    entry->next = device->programs;
    device->programs = entry;
    BB_CL_TRY(clRetainProgram(program), "keeping the program of %s", source->name);
    return BB_OK;
}

void bb_programs_clear(bb_device *device)
{
    while (device->programs != NULL) {
        struct bb_program_cache *entry = device->programs;
        device->programs = entry->next;
        bb_program_release(entry->program);
        free(entry);
    }
}

bb_status bb_program_build(bb_device *device, const bb_source *source, const char *defines,
                           cl_program *program)
{
    char options[2048], key[2304];
    const char *standard = strstr(defines, "-cl-std=") == NULL ? "-cl-std=CL1.2 " : "";
    if (snprintf(options, sizeof options, "%s%s", standard, defines) >= (int)sizeof options)
        return bb_fail(BB_INVALID, "%s: the build options are too long", source->name);
    snprintf(key, sizeof key, "%.200s %s", source->name, options);
    for (const struct bb_program_cache *entry = device->programs; entry != NULL;
         entry = entry->next)
        if (entry->text == source->text && strcmp(entry->key, key) == 0) {
            *program = entry->program;
            BB_CL_TRY(clRetainProgram(*program), "taking the program of %s", source->name);
            return BB_OK;
        }
    BB_TRY(compile(device, source, options, program));
    return remember(device, source, key, *program);
}

bb_status bb_kernel_get(cl_program program, const char *name, cl_kernel *kernel)
{
    cl_int error;
    *kernel = clCreateKernel(program, name, &error);
    BB_CL_TRY(error, "kernel %s", name);
    return BB_OK;
}

void bb_program_release(cl_program program)
{
    if (program != NULL)
        clReleaseProgram(program);
}

void bb_kernel_release(cl_kernel kernel)
{
    if (kernel != NULL)
        clReleaseKernel(kernel);
}

/* ---- launches and their event times ---- */

enum { EVENTS_MAX = 4096 };

struct bb_event_list {
    uint32_t count;
    cl_event events[EVENTS_MAX];
};

static bb_status add_event(bb_device *device, cl_event event)
{
    if (device->events == NULL)
        device->events = calloc(1, sizeof *device->events);
    if (device->events == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    if (device->events->count == EVENTS_MAX)
        BB_TRY(bb_device_collect_events(device));
    device->events->events[device->events->count++] = event;
    return BB_OK;
}

bb_status bb_launch_args(bb_device *device, cl_kernel kernel, size_t global, size_t local,
                         const bb_arg *args, uint32_t count)
{
    if (global == 0)
        return BB_OK;
    for (uint32_t i = 0; i < count; i++)
        BB_CL_TRY(clSetKernelArg(kernel, i, args[i].size, args[i].value), "argument %u of a kernel",
                  i);
    size_t whole = (global + local - 1) / local * local;
    cl_event event;
    BB_CL_TRY(clEnqueueNDRangeKernel(device->queue, kernel, 1, NULL, &whole, &local, 0, NULL,
                                     device->profile_events ? &event : NULL),
              "launching a kernel on %zu work-items in groups of %zu", whole, local);
    if (device->profile_events)
        BB_TRY(add_event(device, event));
    return BB_OK;
}

static void drop_events(bb_device *device)
{
    for (uint32_t i = 0; device->events != NULL && i < device->events->count; i++)
        clReleaseEvent(device->events->events[i]);
    if (device->events != NULL)
        device->events->count = 0;
}

void bb_device_clear_events(bb_device *device)
{
    drop_events(device);
    device->event_ms = 0;
}

bb_status bb_device_collect_events(bb_device *device)
{
    BB_TRY(bb_finish(device));
    for (uint32_t i = 0; device->events != NULL && i < device->events->count; i++) {
        cl_ulong start = 0, end = 0;
        cl_event event = device->events->events[i];
        BB_CL_TRY(
            clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, NULL),
            "reading the time of a kernel");
        BB_CL_TRY(clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL),
                  "reading the time of a kernel");
        device->event_ms += 1e-6 * (double)(end - start);
    }
    drop_events(device);
    return BB_OK;
}
