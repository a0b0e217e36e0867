/* The context of a run: the machine, the device, the libraries, this program. */
#include "framework/embree/embree.h"
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Generated at build time. */
extern const char bb_build_revision[], bb_build_version[], bb_build_flags[];

static void cpu_name(char *name, size_t capacity)
{
    name[0] = '\0';
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (file == NULL)
        return;
    char line[512];
    while (name[0] == '\0' && fgets(line, sizeof line, file) != NULL) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || colon == NULL)
            continue;
        colon += strspn(colon, ": \t");
        colon[strcspn(colon, "\n")] = '\0';
        snprintf(name, capacity, "%s", colon);
    }
    fclose(file);
}

bool bb_put_load(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_context_record *context = record;
    return isnan(context->load[0]) ? bb_put(object, name, cJSON_CreateNull())
                                   : bb_put_numbers(object, name, context->load, 3);
}

/* What the device's floats can do, in words: OpenCL's names without their prefix. */
bool bb_put_float_config(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    static const struct {
        cl_device_fp_config flag;
        const char *word;
    } words[] = {
        {CL_FP_DENORM, "denorm"},
        {CL_FP_INF_NAN, "inf_nan"},
        {CL_FP_ROUND_TO_NEAREST, "round_to_nearest"},
        {CL_FP_ROUND_TO_ZERO, "round_to_zero"},
        {CL_FP_ROUND_TO_INF, "round_to_inf"},
        {CL_FP_FMA, "fma"},
        {CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, "correctly_rounded_divide_sqrt"},
        {CL_FP_SOFT_FLOAT, "soft_float"},
    };
    const bb_context_record *context = record;
    const char *said[sizeof words / sizeof words[0]];
    int count = 0;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (context->float_config & words[i].flag)
            said[count++] = words[i].word;
    return bb_put(object, name,
                  count > 0 ? cJSON_CreateStringArray(said, count) : cJSON_CreateNull());
}

/* The Embree that is the oracle and the reference. */
bool bb_put_embree(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_context_record *context = record;
    cJSON *embree = cJSON_CreateObject();
    if (embree == NULL)
        return false;
    if (bb_put_text(embree, "version", context->embree_version) &&
        bb_put_text(embree, "api", BB_EMBREE_API))
        return bb_put(object, name, embree);
    cJSON_Delete(embree);
    return false;
}

/* A seed that a JSON number cannot hold is written as its digits. */
bool bb_put_seed(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    uint64_t seed = ((const bb_context_record *)record)->seed;
    char digits[24];
    if (seed <= (uint64_t)1 << 53)
        return bb_put_number(object, name, (double)seed);
    snprintf(digits, sizeof digits, "%llu", (unsigned long long)seed);
    return bb_put_text(object, name, digits);
}

/* How work-groups hand over to each other, and what the litmus test of the fence found. */
static void add_device(bb_context_record *record, const bb_device *device)
{
    record->litmus_messages = record->litmus_stale = NAN;
    if (device == NULL)
        return;
    record->device = device->name;
    record->device_type = device->is_cpu ? BB_DEVICE_CPU : BB_DEVICE_OTHER;
    record->driver = device->driver;
    record->opencl = device->version;
    record->compute_units = device->compute_units;
    record->float_config = device->float_config;
    record->kernels = device->sources;
    record->handover = bb_handover_word(device);
    if (device->litmus_pairs > 0) {
        record->litmus_messages = device->litmus_pairs;
        record->litmus_stale = device->litmus_stale;
    }
}

bool bb_put_context(cJSON *root, const bb_context *context, const char *embree_version)
{
    char date[32], host[256] = "", cpu[256];
    time_t now = time(NULL);
    struct tm utc;
    gmtime_r(&now, &utc);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    if (gethostname(host, sizeof host - 1) != 0)
        host[0] = '\0';
    cpu_name(cpu, sizeof cpu);
    long threads = sysconf(_SC_NPROCESSORS_ONLN);
    bb_context_record record = {
        .date = date,
        .revision = bb_build_revision,
        .version = bb_build_version,
        .host = host,
        .cpu = cpu,
        .cpu_threads = threads > 0 ? (uint32_t)threads : 0,
        .embree_version = embree_version,
        .build_flags = bb_build_flags,
        .seed = context->seed,
        .command = context->command,
    };
    if (getloadavg(record.load, 3) != 3)
        record.load[0] = NAN;
    add_device(&record, context->device);
    return bb_put_inner(root, "context", BB_IN_CONTEXT, &record);
}
