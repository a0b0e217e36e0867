/* A library to be preloaded, which fails one call of the program: an allocation, a call of OpenCL
 * or one of the system. Only calls that bvhbench's own code makes count, by itself or through the
 * libraries that act on its behalf (C, C++, cJSON, a sanitizer): what drivers and compilers
 * allocate is theirs to cope with. That is why it looks at return addresses, and needs no special
 * build.
 *
 * A call is known by its stack: the frames of bvhbench's code from the call up to main().
 *   BVHBENCH_FAULTS_LOG=FILE     a line for each stack: kind, its hash, its frames from within
 *   BVHBENCH_FAULTS_STACK=HASH   the first call with this stack fails
 *
 * C++ because operator new fails by an exception. */
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <new>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

namespace
{

enum { DEPTH = 64, STACKS = 1 << 15, LINE = 2048 };

/* No call of this library's own counts; initial-exec, since other models allocate. */
__attribute__((tls_model("initial-exec"))) thread_local int inside;

struct Inside {
    Inside()
    {
        inside++;
    }
    ~Inside()
    {
        inside--;
    }
};

int log_file = -1;
uint64_t chosen; /* 0: none */
bool ready;
pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
uint64_t seen[STACKS];

enum Owner { OURS, BETWEEN, OTHERS };

bool begins(const char *text, const char *with)
{
    return std::strncmp(text, with, std::strlen(with)) == 0;
}

/* Whose code an address is in, and where in its file. */
Owner owner_of(void *address, uintptr_t *offset)
{
    static const char *const between[] = {"libc.so",  "libcjson",  "libstdc++", "libasan",
                                          "libubsan", "libxxhash", "libgcc_s"};
    dl_find_object found;
    if (_dl_find_object(address, &found) != 0)
        return OTHERS;
    const char *path = found.dlfo_link_map->l_name, *slash = std::strrchr(path, '/');
    const char *name = slash != nullptr ? slash + 1 : path;
    *offset = (uintptr_t)address - found.dlfo_link_map->l_addr;
    if (name[0] == '\0' || begins(name, "libbvhbench.so") || begins(name, "bvhbench-exr"))
        return OURS;
    for (const char *one : between)
        if (begins(name, one))
            return BETWEEN;
    return OTHERS;
}

struct Stack {
    uintptr_t frames[DEPTH];
    int count;
    uint64_t hash;
};

/* Of a call on behalf of bvhbench; false for others. `caller` is who called what is failed: most
 * calls are others', which that alone tells. */
bool walk(void *caller, Stack *stack)
{
    uintptr_t offset;
    stack->count = 0;
    if (owner_of(caller, &offset) == OTHERS)
        return false;
    void *addresses[DEPTH];
    int count = backtrace(addresses, DEPTH), first = 0;
    while (first < count && addresses[first] != caller)
        first++;
    stack->hash = 14695981039346656037u;
    for (int i = first; i < count; i++) {
        Owner owner = owner_of(addresses[i], &offset);
        if (owner == OTHERS && stack->count == 0)
            return false; /* a library's own doing */
        if (owner != OURS)
            continue;
        stack->frames[stack->count++] = offset;
        stack->hash = (stack->hash ^ offset) * 1099511628211u;
    }
    return stack->count > 0;
}

/* True for the first call with a stack. */
bool note(uint64_t hash)
{
    pthread_mutex_lock(&lock);
    uint64_t i = hash % STACKS;
    while (seen[i] != hash && seen[i] != 0)
        i = (i + 1) % STACKS;
    bool fresh = seen[i] == 0;
    seen[i] = hash;
    pthread_mutex_unlock(&lock);
    return fresh;
}

void write_line(const char *kind, const Stack *stack)
{
    char line[LINE];
    int used = std::snprintf(line, sizeof line, "%s %016lx", kind, (unsigned long)stack->hash);
    for (int i = 0; i < stack->count && used < LINE - 24; i++)
        used += std::snprintf(line + used, sizeof line - (size_t)used, " %lx",
                              (unsigned long)stack->frames[i]);
    line[used++] = '\n';
    (void)!write(log_file, line, (size_t)used);
}

/* Shall this call fail? */
bool fails(const char *kind, void *caller)
{
    if (!ready || inside > 0)
        return false;
    Inside here;
    Stack stack;
    if (!walk(caller, &stack))
        return false;
    stack.hash ^= (uint64_t)(unsigned char)kind[0] << 56 ^ std::strlen(kind);
    stack.hash |= 1; /* never 0 */
    if (!note(stack.hash))
        return false;
    if (log_file >= 0)
        write_line(kind, &stack);
    return stack.hash == chosen;
}

template <typename Function> Function *next(const char *name, Function *)
{
    Inside here;
    return reinterpret_cast<Function *>(dlsym(RTLD_NEXT, name));
}

__attribute__((constructor)) void start()
{
    Inside here;
    void *first[1];
    (void)backtrace(first, 1); /* it loads its library */
    const char *log = std::getenv("BVHBENCH_FAULTS_LOG");
    const char *stack = std::getenv("BVHBENCH_FAULTS_STACK");
    if (log != nullptr)
        log_file = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    chosen = stack != nullptr ? std::strtoull(stack, nullptr, 16) : 0;
    ready = true;
}

} // namespace

#define CALLER __builtin_return_address(0)
#define NEXT(name)                                                                                 \
    static auto *const real = next(#name, &name);                                                  \
    (void)real

/* What the real function does inside is its own. */
#define PASS(...)                                                                                  \
    do {                                                                                           \
        Inside here;                                                                               \
        return real(__VA_ARGS__);                                                                  \
    } while (0)

/* ---- memory ---- */

namespace
{

void *refuse()
{
    errno = ENOMEM;
    return nullptr;
}

} // namespace

extern "C" {

void *malloc(size_t size) noexcept
{
    NEXT(malloc);
    return fails("malloc", CALLER) ? refuse() : real(size);
}

void *calloc(size_t count, size_t size) noexcept
{
    NEXT(calloc);
    return fails("calloc", CALLER) ? refuse() : real(count, size);
}

void *realloc(void *block, size_t size) noexcept
{
    NEXT(realloc);
    return fails("realloc", CALLER) ? refuse() : real(block, size);
}

void *aligned_alloc(size_t alignment, size_t size) noexcept
{
    NEXT(aligned_alloc);
    return fails("aligned_alloc", CALLER) ? refuse() : real(alignment, size);
}

char *strdup(const char *text) noexcept
{
    NEXT(strdup);
    if (fails("strdup", CALLER))
        return static_cast<char *>(refuse());
    PASS(text);
}

char *strndup(const char *text, size_t size) noexcept
{
    NEXT(strndup);
    if (fails("strndup", CALLER))
        return static_cast<char *>(refuse());
    PASS(text, size);
}

FILE *open_memstream(char **text, size_t *size) noexcept
{
    NEXT(open_memstream);
    if (fails("open_memstream", CALLER))
        return static_cast<FILE *>(refuse());
    PASS(text, size);
}

} // extern "C"

void *operator new(size_t size)
{
    using Function = void *(size_t);
    static auto *const real = next("_Znwm", static_cast<Function *>(nullptr));
    if (fails("new", CALLER))
        throw std::bad_alloc();
    PASS(size);
}

/* ---- the system ---- */

#define FAIL_WITH(code, result)                                                                    \
    do {                                                                                           \
        errno = code;                                                                              \
        return result;                                                                             \
    } while (0)

extern "C" {

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                   void *user) noexcept
{
    NEXT(pthread_create);
    return fails("pthread_create", CALLER) ? EAGAIN : real(thread, attributes, run, user);
}

ssize_t read(int file, void *data, size_t size)
{
    NEXT(read);
    if (fails("read", CALLER))
        FAIL_WITH(EIO, -1);
    return real(file, data, size);
}

ssize_t write(int file, const void *data, size_t size)
{
    NEXT(write);
    if (fails("write", CALLER))
        FAIL_WITH(ENOSPC, -1);
    return real(file, data, size);
}

int fsync(int file)
{
    NEXT(fsync);
    if (fails("fsync", CALLER))
        FAIL_WITH(EIO, -1);
    return real(file);
}

int rename(const char *from, const char *to) noexcept
{
    NEXT(rename);
    if (fails("rename", CALLER))
        FAIL_WITH(EACCES, -1);
    return real(from, to);
}

int mkdir(const char *path, mode_t mode) noexcept
{
    NEXT(mkdir);
    if (fails("mkdir", CALLER))
        FAIL_WITH(ENOSPC, -1);
    return real(path, mode);
}

int open(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    NEXT(open);
    if (fails("open", CALLER))
        FAIL_WITH(EMFILE, -1);
    return real(path, flags, mode);
}

FILE *fopen(const char *path, const char *mode)
{
    NEXT(fopen);
    if (fails("fopen", CALLER))
        FAIL_WITH(EMFILE, nullptr);
    PASS(path, mode);
}

/* ---- OpenCL ---- */

#define CALL(name, code, parameters, arguments)                                                    \
    cl_int name parameters                                                                         \
    {                                                                                              \
        NEXT(name);                                                                                \
        return fails(#name, CALLER) ? (code) : real arguments;                                     \
    }
/* The error goes to the last parameter. */
#define CREATE(type, name, code, parameters, arguments)                                            \
    type name parameters                                                                           \
    {                                                                                              \
        NEXT(name);                                                                                \
        if (!fails(#name, CALLER))                                                                 \
            return real arguments;                                                                 \
        if (error != nullptr)                                                                      \
            *error = code;                                                                         \
        return nullptr;                                                                            \
    }

CALL(clGetPlatformIDs, CL_OUT_OF_HOST_MEMORY, (cl_uint room, cl_platform_id *ids, cl_uint *count),
     (room, ids, count))
CALL(clGetPlatformInfo, CL_OUT_OF_HOST_MEMORY,
     (cl_platform_id id, cl_platform_info what, size_t room, void *out, size_t *size),
     (id, what, room, out, size))
CALL(clGetDeviceIDs, CL_OUT_OF_HOST_MEMORY,
     (cl_platform_id id, cl_device_type type, cl_uint room, cl_device_id *ids, cl_uint *count),
     (id, type, room, ids, count))
CALL(clGetDeviceInfo, CL_OUT_OF_HOST_MEMORY,
     (cl_device_id id, cl_device_info what, size_t room, void *out, size_t *size),
     (id, what, room, out, size))
CREATE(cl_context, clCreateContext, CL_OUT_OF_HOST_MEMORY,
       (const cl_context_properties *properties, cl_uint count, const cl_device_id *ids,
        void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *user,
        cl_int *error),
       (properties, count, ids, notify, user, error))
CREATE(cl_command_queue, clCreateCommandQueue, CL_OUT_OF_HOST_MEMORY,
       (cl_context context, cl_device_id id, cl_command_queue_properties properties, cl_int *error),
       (context, id, properties, error))
CREATE(cl_mem, clCreateBuffer, CL_MEM_OBJECT_ALLOCATION_FAILURE,
       (cl_context context, cl_mem_flags flags, size_t size, void *host, cl_int *error),
       (context, flags, size, host, error))
CREATE(cl_program, clCreateProgramWithSource, CL_OUT_OF_HOST_MEMORY,
       (cl_context context, cl_uint count, const char **texts, const size_t *sizes, cl_int *error),
       (context, count, texts, sizes, error))
CALL(clBuildProgram, CL_BUILD_PROGRAM_FAILURE,
     (cl_program program, cl_uint count, const cl_device_id *ids, const char *options,
      void(CL_CALLBACK *notify)(cl_program, void *), void *user),
     (program, count, ids, options, notify, user))
CALL(clRetainProgram, CL_OUT_OF_HOST_MEMORY, (cl_program program), (program))
CREATE(cl_kernel, clCreateKernel, CL_OUT_OF_HOST_MEMORY,
       (cl_program program, const char *name, cl_int *error), (program, name, error))
CALL(clSetKernelArg, CL_OUT_OF_HOST_MEMORY,
     (cl_kernel kernel, cl_uint index, size_t size, const void *value),
     (kernel, index, size, value))
CALL(clGetKernelInfo, CL_OUT_OF_HOST_MEMORY,
     (cl_kernel kernel, cl_kernel_info what, size_t room, void *out, size_t *size),
     (kernel, what, room, out, size))
CALL(clSetMemObjectDestructorCallback, CL_OUT_OF_HOST_MEMORY,
     (cl_mem buffer, void(CL_CALLBACK *notify)(cl_mem, void *), void *user), (buffer, notify, user))
CALL(clEnqueueNDRangeKernel, CL_OUT_OF_RESOURCES,
     (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
      const size_t *global, const size_t *local, cl_uint count, const cl_event *events,
      cl_event *event),
     (queue, kernel, dimensions, offset, global, local, count, events, event))
CALL(clEnqueueReadBuffer, CL_OUT_OF_RESOURCES,
     (cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
      void *out, cl_uint count, const cl_event *events, cl_event *event),
     (queue, buffer, blocking, offset, size, out, count, events, event))
CALL(clEnqueueWriteBuffer, CL_OUT_OF_RESOURCES,
     (cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
      const void *data, cl_uint count, const cl_event *events, cl_event *event),
     (queue, buffer, blocking, offset, size, data, count, events, event))
CALL(clEnqueueFillBuffer, CL_OUT_OF_RESOURCES,
     (cl_command_queue queue, cl_mem buffer, const void *pattern, size_t pattern_size,
      size_t offset, size_t size, cl_uint count, const cl_event *events, cl_event *event),
     (queue, buffer, pattern, pattern_size, offset, size, count, events, event))
CREATE(void *, clEnqueueMapBuffer, CL_MAP_FAILURE,
       (cl_command_queue queue, cl_mem buffer, cl_bool blocking, cl_map_flags flags, size_t offset,
        size_t size, cl_uint count, const cl_event *events, cl_event *event, cl_int *error),
       (queue, buffer, blocking, flags, offset, size, count, events, event, error))
CALL(clEnqueueUnmapMemObject, CL_OUT_OF_RESOURCES,
     (cl_command_queue queue, cl_mem buffer, void *mapped, cl_uint count, const cl_event *events,
      cl_event *event),
     (queue, buffer, mapped, count, events, event))
CALL(clGetProgramBuildInfo, CL_OUT_OF_HOST_MEMORY,
     (cl_program program, cl_device_id id, cl_program_build_info what, size_t room, void *out,
      size_t *size),
     (program, id, what, room, out, size))
CALL(clGetEventProfilingInfo, CL_PROFILING_INFO_NOT_AVAILABLE,
     (cl_event event, cl_profiling_info what, size_t room, void *out, size_t *size),
     (event, what, room, out, size))

/* The device's work ends before it is said to have failed: nothing is written to memory that is
 * given back. */
cl_int clFinish(cl_command_queue queue)
{
    NEXT(clFinish);
    bool failed = fails("clFinish", CALLER);
    cl_int code = real(queue);
    return failed ? CL_OUT_OF_RESOURCES : code;
}

} // extern "C"
