/* Programs: compiles with the embedded headers, and caches the result. */
#include "framework/base/clock.h"
#include "framework/device/cl_error.h"
#include "framework/device/device_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

/* Returns the text of FOLDER/NAME if the device has an edit-and-run folder with this file;
 * otherwise NULL. The caller frees it. */
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

static uint32_t count_errors(const char *log)
{
    uint32_t count = 0;
    for (; (log = strstr(log, "error:")) != NULL; log++)
        count++;
    return count;
}

/* Writes " (N errors: FILE)", with the whole log in the file, or "" if the file cannot be
 * written. */
static void keep_log(const char *name, const char *log, char *text, size_t capacity)
{
    static const char ending[] = ".log";
    const char *folder = getenv("TMPDIR");
    char path[512];
    text[0] = '\0';
    int length = snprintf(path, sizeof path, "%s/bvhbench-%.100s-XXXXXX%s",
                          folder != NULL && folder[0] != '\0' ? folder : "/tmp", name, ending);
    int handle = length < (int)sizeof path ? mkstemps(path, (int)strlen(ending)) : -1;
    if (handle < 0)
        return;
    FILE *file = fdopen(handle, "w");
    if (file == NULL) {
        close(handle);
        return;
    }
    bool written = fputs(log, file) >= 0;
    if (fclose(file) == 0 && written)
        snprintf(text, capacity, " (%u errors: %s)", count_errors(log), path);
}

/* Fails with the first error of a build log, for which the message has room; if there are more, the
 * log is left in a file. */
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
        line = log + strspn(log, " \t\r\n");
    while (line > log && line[-1] != '\n')
        line--;
    if (*line == '\0')
        line = "the driver does not say why (its build log is empty)";
    char kept[640] = "";
    if (count_errors(log) > 1)
        keep_log(name, log, kept, sizeof kept);
    bb_status status = bb_fail(BB_FAILED, "compiling %s: %s: %.*s%s", name, bb_cl_error(error),
                               (int)strcspn(line, "\n"), line, kept);
    free(log);
    return status;
}

/* ---- one text of a source and its includes ---- */

typedef struct text {
    char *chars;
    size_t length, capacity;
} text;

static bb_status append(text *whole, const char *chars, size_t length)
{
    if (whole->length + length + 1 > whole->capacity) {
        size_t capacity = 2 * (whole->length + length + 1);
        char *grown = realloc(whole->chars, capacity);
        if (grown == NULL)
            return bb_fail(BB_FAILED, "out of memory");
        whole->chars = grown;
        whole->capacity = capacity;
    }
    memcpy(whole->chars + whole->length, chars, length);
    whole->length += length;
    whole->chars[whole->length] = '\0';
    return BB_OK;
}

static const bb_source *find_header(const bb_source *source, const char *name, size_t length)
{
    const bb_source *const places[2] = {bb_embedded_sources, source->folder};
    for (int i = 0; i < 2; i++)
        for (const bb_source *file = places[i]; file != NULL && file->name != NULL; file++)
            if (strlen(file->name) == length && memcmp(file->name, name, length) == 0 &&
                (has_ending(file->name, ".h") || has_ending(file->name, ".clh")))
                return file;
    return NULL;
}

static const char *skip_blanks(const char *at)
{
    return at + strspn(at, " \t");
}

/* Returns NAME, and its length, if the line is `#include "NAME"`; otherwise NULL. */
static const char *included_name(const char *line, size_t *length)
{
    line = skip_blanks(line);
    if (*line != '#')
        return NULL;
    line = skip_blanks(line + 1);
    if (strncmp(line, "include", 7) != 0)
        return NULL;
    line = skip_blanks(line + 7);
    if (*line != '"')
        return NULL;
    *length = strcspn(line + 1, "\"\n");
    return line[1 + *length] == '"' ? line + 1 : NULL;
}

enum { DEPTH_MAX = 32 };

/* Appends a #line that tells the compiler where the following lines come from. */
static bb_status append_mark(text *whole, uint32_t line, const char *name)
{
    char mark[300];
    int length = snprintf(mark, sizeof mark, "#line %u \"%.200s\"\n", line, name);
    return append(whole, mark, (size_t)length);
}

/* Appends a file, replacing each `#include "NAME"` by the file NAME: headers guard themselves. If
 * there is no such file the line stays, so that the compiler reports it. */
static bb_status append_file(bb_device *device, const bb_source *source, const bb_source *file,
                             uint32_t depth, text *whole)
{
    if (depth > DEPTH_MAX)
        return bb_fail(BB_FAILED, "compiling %s: %s includes itself", source->name, file->name);
    char *override = read_override(device, file->name);
    const char *line = override != NULL ? override : file->text;
    bb_status status = append_mark(whole, 1, file->name);
    for (uint32_t number = 1; status == BB_OK && *line != '\0'; number++) {
        size_t length = strcspn(line, "\n"), name_length = 0;
        const char *name = included_name(line, &name_length), *rest = line;
        const bb_source *header = name != NULL ? find_header(source, name, name_length) : NULL;
        if (header != NULL) {
            status = append_file(device, source, header, depth + 1, whole);
            if (status == BB_OK)
                status = append_mark(whole, number, file->name);
            rest = name + name_length + 1;
        }
        if (status == BB_OK)
            status = append(whole, rest, (size_t)(line + length - rest));
        if (status == BB_OK)
            status = append(whole, "\n", 1);
        line += length + (line[length] == '\n');
    }
    free(override);
    return status;
}

static cl_int build(bb_device *device, cl_program program, const char *options, double *ms)
{
    double begun = bb_wall_ms();
    bb_uncounted_begin();
    cl_int error = clBuildProgram(program, 1, &device->id, options, NULL, NULL);
    bb_uncounted_end();
    *ms = bb_wall_ms() - begun;
    return error;
}

/* Everything is one text, since with clCompileProgram, clLinkProgram and one program per header
 * PoCL 3.1 finds only the kernels in its cache, and compiles and links the rest each time. */
static bb_status compile(bb_device *device, const bb_source *source, const char *options,
                         cl_program *program, double *ms)
{
    text whole = {0};
    cl_int error;
    *program = NULL;
    *ms = 0;
    bb_status status = append_file(device, source, source, 0, &whole);
    if (status == BB_OK) {
        *program = clCreateProgramWithSource(device->context, 1, (const char **)&whole.chars, NULL,
                                             &error);
        if (error != CL_SUCCESS)
            status =
                bb_fail(BB_FAILED, "making a program of %s: %s", source->name, bb_cl_error(error));
    }
    free(whole.chars);
    if (status != BB_OK)
        return status;
    error = build(device, *program, options, ms);
    if (error != CL_SUCCESS) {
        status = fail_with_log(device, *program, source->name, error);
        bb_program_release(*program);
        *program = NULL;
    }
    return status;
}

/* Builders and layouts come and go; the programs that they compile stay with the device, and a
 * failed compilation is not repeated. */
struct bb_program_cache {
    struct bb_program_cache *next;
    const char *text; /* text and options tell sources of the same name apart */
    const bb_source *folder;
    cl_program program;
    double ms;     /* compile time */
    char *failure; /* the error message if there is no program */
    char options[2048];
};

/* Adds an entry, which takes over `program`, if there is one. */
static bb_status remember(bb_device *device, const bb_source *source, const char *options,
                          cl_program program, double ms, const char *failure)
{
    struct bb_program_cache *entry = calloc(1, sizeof *entry);
    char *message = failure != NULL ? strdup(failure) : NULL;
    if (entry == NULL || (failure != NULL && message == NULL)) {
        free(entry);
        free(message);
        bb_program_release(program);
        return bb_fail(BB_FAILED, "out of memory");
    }
    entry->text = source->text;
    entry->folder = source->folder;
    entry->program = program;
    entry->ms = ms;
    entry->failure = message;
    strcpy(entry->options, options);
    entry->next = device->programs;
    device->programs = entry;
    return BB_OK;
}

static bb_status take(const struct bb_program_cache *entry, const bb_source *source,
                      cl_program *program)
{
    if (entry->failure != NULL)
        return bb_fail(BB_FAILED, "%s", entry->failure);
    BB_CL_TRY(clRetainProgram(entry->program), "taking the program of %s", source->name);
    *program = entry->program;
    return BB_OK;
}

void bb_programs_clear(bb_device *device)
{
    while (device->programs != NULL) {
        struct bb_program_cache *entry = device->programs;
        device->programs = entry->next;
        bb_program_release(entry->program);
        free(entry->failure);
        free(entry);
    }
}

bb_status bb_program_build(bb_device *device, const bb_source *source, const char *defines,
                           cl_program *program)
{
    char options[sizeof device->programs->options];
    double ms;
    cl_program made;
    *program = NULL;
    const char *standard = strstr(defines, "-cl-std=") == NULL ? "-cl-std=CL1.2 " : "";
    /* -w disables warnings: the log of a successful compilation is shown to nobody, but clang
     * inside PoCL prints the number of warnings on stderr, such as those on vectors wider than the
     * processor's registers. */
    const char *info = device->tally != NULL ? "-cl-kernel-arg-info " : "";
    if (snprintf(options, sizeof options, "-w %s%s%s", info, standard, defines) >=
        (int)sizeof options)
        return bb_fail(BB_INVALID, "%s: the build options are too long", source->name);
    for (const struct bb_program_cache *entry = device->programs; entry != NULL;
         entry = entry->next)
        if (entry->text == source->text && entry->folder == source->folder &&
            strcmp(entry->options, options) == 0)
            return take(entry, source, program);
    bb_status status = compile(device, source, options, &made, &ms);
    BB_TRY(remember(device, source, options, made, ms, status == BB_OK ? NULL : bb_message()));
    return take(device->programs, source, program);
}

/* Returns the wall time of compiling the entry's text once more, as a separate program; 0 if it
 * cannot be measured. */
static double compile_again(bb_device *device, const struct bb_program_cache *entry)
{
    size_t size = 0;
    double ms = 0;
    if (clGetProgramInfo(entry->program, CL_PROGRAM_SOURCE, 0, NULL, &size) != CL_SUCCESS)
        return 0;
    char *source = calloc(1, size + 1);
    if (source == NULL)
        return 0;
    cl_program program = NULL;
    if (clGetProgramInfo(entry->program, CL_PROGRAM_SOURCE, size, source, NULL) == CL_SUCCESS)
        program = clCreateProgramWithSource(device->context, 1, (const char **)&source, NULL, NULL);
    free(source);
    if (program != NULL && build(device, program, entry->options, &ms) != CL_SUCCESS)
        ms = 0;
    bb_program_release(program);
    return ms;
}

/* The times of one program differ by less than this factor if both come from a cache. */
static const double cold_ratio = 3;

void bb_programs_measure(bb_device *device, bb_compiling *found)
{
    const struct bb_program_cache *slowest = NULL;
    *found = (bb_compiling){.cache = "not known"};
    for (const struct bb_program_cache *entry = device->programs; entry != NULL;
         entry = entry->next) {
        found->programs++;
        found->ms += entry->ms;
        if (entry->program != NULL && (slowest == NULL || entry->ms > slowest->ms))
            slowest = entry;
    }
    double again = slowest != NULL ? compile_again(device, slowest) : 0;
    if (again > 0)
        found->cache = slowest->ms > cold_ratio * again ? "cold" : "warm";
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
