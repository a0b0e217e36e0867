/* Programs: compiling with the embedded headers, and what was compiled before. */
#include "framework/device/cl_error.h"
#include "framework/device/device_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADERS_MAX = 128 };

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

/* Text of FOLDER/NAME if the device has an edit-and-run folder and the file is there; else NULL.
 * Freed by the caller. */
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

/* The headers that a source may include. */
typedef struct header_list {
    cl_uint count;
    cl_program programs[HEADERS_MAX];
    const char *names[HEADERS_MAX];
} header_list;

static bb_status add_headers(bb_device *device, const bb_source *files, header_list *headers)
{
    for (const bb_source *file = files; file != NULL && file->name != NULL; file++) {
        if (!has_ending(file->name, ".h") && !has_ending(file->name, ".clh"))
            continue;
        if (headers->count == HEADERS_MAX)
            return bb_fail(BB_FAILED, "more than %d device headers", HEADERS_MAX);
        BB_TRY(create_program(device, file, &headers->programs[headers->count]));
        headers->names[headers->count++] = file->name;
    }
    return BB_OK;
}

static bb_status compile(bb_device *device, const bb_source *source, const char *options,
                         cl_program *program)
{
    cl_program main = NULL;
    header_list headers = {.count = 0};
    bb_status status = create_program(device, source, &main);
    if (status == BB_OK)
        status = add_headers(device, bb_embedded_sources, &headers);
    if (status == BB_OK)
        status = add_headers(device, source->folder, &headers);
    if (status != BB_OK)
        goto out;

    cl_int error = clCompileProgram(main, 1, &device->id, options, headers.count, headers.programs,
                                    headers.names, NULL, NULL);
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
    for (cl_uint i = 0; i < headers.count; i++)
        clReleaseProgram(headers.programs[i]);
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
