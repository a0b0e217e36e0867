/* Finding and opening an OpenCL device. Its buffers are in buffer.c, its programs and launches in
 * program.c. */
#include "framework/device/device_private.h"

#include "framework/base/limits.h"
#include "framework/device/cl_error.h"
#include "framework/device/handover.h"

#include <sched.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { DEVICES_MAX = 64 };

typedef struct found_device {
    cl_platform_id platform;
    cl_device_id id;
    uint32_t rank; /* among the kinds of devices below */
} found_device;

/* In order of preference: with a GPU present, it is to be measured, not the CPU driver. */
static const struct {
    cl_device_type type;
    const char *name;
} kinds[] = {{CL_DEVICE_TYPE_GPU, "GPU"},
             {CL_DEVICE_TYPE_ACCELERATOR, "accelerator"},
             {CL_DEVICE_TYPE_CPU, "CPU"},
             {CL_DEVICE_TYPE_ALL, "of another kind"}};

bb_status bb_device_check_system(const char *folder)
{
    struct stat info;
    if (stat(folder, &info) == 0 && S_ISDIR(info.st_mode))
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "there is no %s, which OpenCL drivers need: mount sysfs (in a container or "
                   "chroot: mount -t sysfs none /sys)",
                   folder);
}

enum { PLATFORMS_MAX = 16 };

/* Whether this process may run on the processors 0 to count - 1, and on no others. */
static bool has_first_processors(uint32_t count)
{
    cpu_set_t mine;
    if (sched_getaffinity(0, sizeof mine, &mine) != 0 || (uint32_t)CPU_COUNT(&mine) != count)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!CPU_ISSET(i, &mine))
            return false;
    return true;
}

/* Returns whether the environment asks for more threads of PoCL than this. */
static bool asks_for_more_threads(uint32_t count)
{
    const char *const asked[] = {getenv("POCL_MAX_PTHREAD_COUNT"), getenv("POCL_CPU_MAX_CU_COUNT")};
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++)
        if (asked[i] != NULL && strtoul(asked[i], NULL, 10) > count)
            return true;
    return false;
}

/* PoCL has a thread for each core of the machine, unless the environment says otherwise. Those that
 * sleep between launches are often woken on one core, and take twice as long, unless each keeps to
 * its own; PoCL knows only the first cores, and aborts if there are more threads than cores. */
static void steer_pocl(void)
{
    char cores[16];
    const uint32_t count = bb_core_count();
    if (has_first_processors(count) && !asks_for_more_threads(count))
        setenv("POCL_AFFINITY", "1", 0);
    if (count >= (uint32_t)sysconf(_SC_NPROCESSORS_ONLN))
        return;
    snprintf(cores, sizeof cores, "%u", count);
    setenv("POCL_MAX_PTHREAD_COUNT", cores, 0); /* up to PoCL 4 */
    setenv("POCL_CPU_MAX_CU_COUNT", cores, 0);
}

/* The ICD loader reports "no platform" as an error. */
static cl_uint find_platforms(cl_platform_id platforms[PLATFORMS_MAX])
{
    cl_uint count = 0;
    steer_pocl();
    if (clGetPlatformIDs(PLATFORMS_MAX, platforms, &count) != CL_SUCCESS)
        return 0;
    return count < PLATFORMS_MAX ? count : PLATFORMS_MAX;
}

static uint32_t rank_of(cl_device_id id)
{
    cl_device_type type = 0;
    clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    uint32_t rank = 0;
    while (rank + 1 < sizeof kinds / sizeof kinds[0] && (type & kinds[rank].type) == 0)
        rank++;
    return rank;
}

/* Inserts after the devices of the same rank. */
static void insert(found_device *found, uint32_t count, found_device device)
{
    uint32_t at = count;
    for (; at > 0 && found[at - 1].rank > device.rank; at--)
        found[at] = found[at - 1];
    found[at] = device;
}

/* Finds all devices, in order of preference, then in the order of the drivers. */
static bb_status find_devices(found_device *found, uint32_t *count)
{
    cl_platform_id platforms[PLATFORMS_MAX];
    *count = 0;
    BB_TRY(bb_device_check_system("/sys/devices/system/cpu")); /* PoCL aborts without it */
    cl_uint platform_count = find_platforms(platforms);
    for (cl_uint p = 0; p < platform_count; p++) {
        cl_device_id ids[DEVICES_MAX];
        cl_uint ids_count = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, DEVICES_MAX, ids, &ids_count) !=
            CL_SUCCESS)
            continue;
        for (cl_uint i = 0; i < ids_count && *count < DEVICES_MAX; i++)
            insert(found, (*count)++, (found_device){platforms[p], ids[i], rank_of(ids[i])});
    }
    return BB_OK;
}

static void describe(const found_device *found, char *text, size_t capacity)
{
    char platform[128] = "", name[128] = "", version[128] = "";
    cl_uint units = 0;
    clGetPlatformInfo(found->platform, CL_PLATFORM_NAME, sizeof platform, platform, NULL);
    clGetDeviceInfo(found->id, CL_DEVICE_NAME, sizeof name, name, NULL);
    clGetDeviceInfo(found->id, CL_DEVICE_VERSION, sizeof version, version, NULL);
    clGetDeviceInfo(found->id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    snprintf(text, capacity, "%s / %s / %s / %u compute units / %s", platform, name, version, units,
             kinds[found->rank].name);
}

bb_status bb_device_count(uint32_t *count)
{
    found_device found[DEVICES_MAX];
    return find_devices(found, count);
}

bb_status bb_device_describe(uint32_t index, char *text, size_t capacity)
{
    found_device found[DEVICES_MAX];
    uint32_t count;
    BB_TRY(find_devices(found, &count));
    if (index >= count)
        return bb_fail(BB_INVALID, "there is no device %u: `bvhbench list devices` shows them",
                       index);
    describe(&found[index], text, capacity);
    return BB_OK;
}

void bb_device_say_none(char *text, size_t capacity)
{
    cl_platform_id platforms[PLATFORMS_MAX];
    char name[128] = "";
    if (find_platforms(platforms) == 0) {
        snprintf(text, capacity,
                 "install a driver (Debian: pocl-opencl-icd for the CPU, or the vendor's ICD)");
        return;
    }
    clGetPlatformInfo(platforms[0], CL_PLATFORM_NAME, sizeof name, name, NULL);
    bool pocl = strcmp(name, "Portable Computing Language") == 0;
    snprintf(
        text, capacity, "the platform '%s' has none%s", name,
        pocl ? ": PoCL must be able to write its cache: set POCL_CACHE_DIR to a folder where it "
               "can"
             : ": see `clinfo`");
}

static bb_status select_device(const char *selector, found_device *selected)
{
    found_device found[DEVICES_MAX];
    uint32_t count;
    BB_TRY(find_devices(found, &count));
    if (count == 0) {
        char reason[320];
        bb_device_say_none(reason, sizeof reason);
        return bb_fail(BB_INVALID, "no OpenCL device: %s", reason);
    }
    if (selector == NULL) {
        *selected = found[0];
        return BB_OK;
    }
    char *end;
    unsigned long index = strtoul(selector, &end, 10);
    if (selector[0] >= '0' && selector[0] <= '9' && *end == '\0' && index < count) {
        *selected = found[index];
        return BB_OK;
    }
    for (uint32_t i = 0; i < count; i++) {
        char text[512];
        describe(&found[i], text, sizeof text);
        if (strcasestr(text, selector) != NULL) {
            *selected = found[i];
            return BB_OK;
        }
    }
    return bb_fail(BB_INVALID,
                   "no OpenCL device matches '%s' among the %u there are: `bvhbench list "
                   "devices` shows them",
                   selector, count);
}

/* Refuses a driver that reports no memory or no work-group size. */
static bb_status check_limits(const bb_device *device, cl_ulong global, cl_ulong largest,
                              cl_ulong local)
{
    const struct {
        const char *name;
        cl_ulong limit;
    } limits[] = {{"CL_DEVICE_GLOBAL_MEM_SIZE", global},
                  {"CL_DEVICE_MAX_MEM_ALLOC_SIZE", largest},
                  {"CL_DEVICE_LOCAL_MEM_SIZE", local},
                  {"CL_DEVICE_MAX_WORK_GROUP_SIZE", device->max_group_size},
                  {"CL_DEVICE_MAX_COMPUTE_UNITS", device->compute_units}};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
        if (limits[i].limit == 0)
            return bb_fail(BB_FAILED,
                           "the driver of %s gives 0 as %s: take another driver, or another "
                           "--device",
                           device->name, limits[i].name);
    return BB_OK;
}

/* Queries everything or fails: without its type, for instance, a CPU would get code for other
 * devices. */
static bb_status query_device(bb_device *device)
{
    cl_device_type type = 0;
    cl_uint units = 0;
    cl_ulong global = 0, largest = 0, local = 0;
    const struct {
        cl_device_info what;
        size_t size;
        void *out;
    } queries[] = {
        {CL_DEVICE_NAME, sizeof device->name, device->name},
        {CL_DRIVER_VERSION, sizeof device->driver, device->driver},
        {CL_DEVICE_VERSION, sizeof device->version, device->version},
        {CL_DEVICE_TYPE, sizeof type, &type},
        {CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units},
        {CL_DEVICE_GLOBAL_MEM_SIZE, sizeof global, &global},
        {CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof largest, &largest},
        {CL_DEVICE_LOCAL_MEM_SIZE, sizeof local, &local},
        {CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof device->max_group_size, &device->max_group_size},
        {CL_DEVICE_SINGLE_FP_CONFIG, sizeof device->float_config, &device->float_config},
    };
    for (size_t i = 0; i < sizeof queries / sizeof queries[0]; i++)
        BB_CL_TRY(
            clGetDeviceInfo(device->id, queries[i].what, queries[i].size, queries[i].out, NULL),
            "asking the device what it is");
    device->compute_units = units;
    BB_TRY(check_limits(device, global, largest, local));
    device->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    if (device->is_cpu && global > bb_memory_limit())
        global = bb_memory_limit();
    device->global_bytes = global;
    device->largest_allocation = largest;
    device->local_bytes = local;
    return BB_OK;
}

uint32_t bb_device_find_kind(const char *selector)
{
    bb_device device = {.is_cpu = true};
    found_device selected = {0};
    if (select_device(selector, &selected) != BB_OK)
        return BB_FOR_CPU;
    device.id = selected.id;
    return query_device(&device) == BB_OK ? bb_device_kind(&device) : BB_FOR_CPU;
}

bb_status bb_device_open(const char *selector, bb_form form, const char *kernel_folder,
                         bb_device **out)
{
    struct stat info;
    if (kernel_folder != NULL && (stat(kernel_folder, &info) != 0 || !S_ISDIR(info.st_mode)))
        return bb_fail(BB_INVALID, "%s is not a folder of device code", kernel_folder);
    found_device selected = {0};
    BB_TRY(select_device(selector, &selected));
    bb_device *device = calloc(1, sizeof *device);
    if (device == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    device->platform = selected.platform;
    device->id = selected.id;
    bb_status known = query_device(device);
    if (known != BB_OK) {
        free(device);
        return known;
    }
    device->form = form != BB_FORM_AUTO ? form : device->is_cpu ? BB_FORM_CPU : BB_FORM_GPU;
    device->kernel_folder = kernel_folder;
    strcpy(device->sources, "embedded");

    cl_int error;
    device->context = clCreateContext(NULL, 1, &device->id, NULL, NULL, &error);
    if (error == CL_SUCCESS)
        device->queue =
            clCreateCommandQueue(device->context, device->id, CL_QUEUE_PROFILING_ENABLE, &error);
    if (error != CL_SUCCESS) {
        bb_status status = bb_fail(BB_FAILED, "cannot open the OpenCL device %s: %s", device->name,
                                   bb_cl_error(error));
        bb_device_close(device);
        return status;
    }
    bb_status status = bb_choose_handover(device);
    if (status != BB_OK) {
        bb_device_close(device);
        return status;
    }
    *out = device;
    return BB_OK;
}

void bb_device_close(bb_device *device)
{
    if (device == NULL)
        return;
    bb_device_clear_events(device);
    bb_programs_clear(device);
    free(device->events);
    if (device->queue != NULL) {
        /* A driver's thread that still compiles or runs when the process ends can crash. */
        clFinish(device->queue);
        clReleaseCommandQueue(device->queue);
    }
    if (device->context != NULL)
        clReleaseContext(device->context);
    free(device);
}

uint32_t bb_host_threads(const bb_device *device)
{
    uint32_t cores = bb_core_count();
    return device->is_cpu && device->compute_units < cores ? device->compute_units : cores;
}

bool bb_device_divides_exactly(const bb_device *device)
{
    return (device->float_config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
}
