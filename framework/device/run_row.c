#include "framework/device/run_row.h"

#include "framework/device/device_private.h"
#include "framework/device/processors.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Generated at build time. */
extern const char bb_build_version[], bb_build_flags[];

/* The kinds of run_fields.h. */
enum { TEXT = BB_COLUMN_TEXT, FLAG = BB_COLUMN_TEXT, NUMBER = BB_COLUMN_NUMBER, SIGNED = 0 };

const bb_column bb_run_columns[BB_RUN_COLUMNS] = {
#define RUN(id, name, unit, kind, sense, format, decimals, heading, help)                          \
    [BB_RUN_##id] = {                                                                              \
        name,    heading, unit, help, (bb_column_kind)(kind), BB_SENSE_##sense, BB_BETTER_NEITHER, \
        decimals},
#include "framework/device/run_fields.h"
};

static void put_text(bb_table *table, uint32_t row, bb_run_column column, const char *text)
{
    bb_table_set_text(table, row, &bb_run_columns[column], text);
}

static void put_number(bb_table *table, uint32_t row, bb_run_column column, double value)
{
    bb_table_set_number(table, row, &bb_run_columns[column], value);
}

static void read_cpu(char *name, size_t capacity)
{
    char line[512];
    FILE *file = fopen("/proc/cpuinfo", "r");
    name[0] = '\0';
    while (file != NULL && name[0] == '\0' && fgets(line, sizeof line, file) != NULL) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || colon == NULL)
            continue;
        colon += strspn(colon, ": \t");
        colon[strcspn(colon, "\n")] = '\0';
        snprintf(name, capacity, "%s", colon);
    }
    if (file != NULL)
        fclose(file);
}

/* What the device's floats can do: OpenCL's names without their prefix, between blanks. */
static void put_floats(bb_table *table, uint32_t row, cl_device_fp_config config)
{
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
    char text[256] = "";
    for (size_t i = 0, used = 0; i < sizeof words / sizeof words[0]; i++)
        if (config & words[i].flag)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used > 0 ? " " : "",
                                     words[i].word);
    put_text(table, row, BB_RUN_FLOATS, text);
}

static void put_device(bb_table *table, uint32_t row, const bb_device *device)
{
    const char *kind = device->is_cpu ? BB_DEVICE_CPU : BB_DEVICE_OTHER;
    put_text(table, row, BB_RUN_DEVICE, device->name);
    put_text(table, row, BB_RUN_DEVICE_TYPE, kind);
    put_text(table, row, BB_RUN_DRIVER, device->driver);
    put_text(table, row, BB_RUN_OPENCL, device->version);
    put_number(table, row, BB_RUN_UNITS, device->compute_units);
    put_floats(table, row, device->float_config);
    put_text(table, row, BB_RUN_HANDOVER, bb_handover_word(device));
    if (device->litmus_pairs > 0) {
        put_number(table, row, BB_RUN_LITMUS, device->litmus_pairs);
        put_number(table, row, BB_RUN_STALE, device->litmus_stale);
    }
    put_text(table, row, BB_RUN_KERNELS, device->sources);
}

static void put_processors(bb_table *table, uint32_t row)
{
    bb_processors is;
    cpu_set_t mine;
    if (sched_getaffinity(0, sizeof mine, &mine) != 0)
        return;
    bb_processors_read(BB_PROCESSORS_FOLDER, &mine, &is);
    put_text(table, row, BB_RUN_GOVERNOR, is.governor);
    put_text(table, row, BB_RUN_SMT, is.smt);
    put_text(table, row, BB_RUN_BOOST, is.boost);
    put_text(table, row, BB_RUN_PROCESSORS, is.list);
}

static void put_machine(bb_table *table, uint32_t row)
{
    char name[256] = "";
    double load[3];
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    if (gethostname(name, sizeof name - 1) == 0)
        put_text(table, row, BB_RUN_HOST, name);
    read_cpu(name, sizeof name);
    put_text(table, row, BB_RUN_CPU, name);
    if (count > 0)
        put_number(table, row, BB_RUN_THREADS, (double)count);
    put_processors(table, row);
    if (getloadavg(load, 3) != 3)
        return;
    put_number(table, row, BB_RUN_LOAD_1, load[0]);
    put_number(table, row, BB_RUN_LOAD_5, load[1]);
    put_number(table, row, BB_RUN_LOAD_15, load[2]);
}

uint32_t bb_run_row(bb_table *table, const bb_device *device, uint64_t seed, const char *command)
{
    char text[32];
    time_t now = time(NULL);
    struct tm utc;
    const uint32_t row = bb_table_row(table, (bb_cell){{NULL}});
    gmtime_r(&now, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    put_text(table, row, BB_RUN_DATE, text);
    put_text(table, row, BB_RUN_REVISION, bb_build_revision);
    put_text(table, row, BB_RUN_VERSION, bb_build_version);
    put_machine(table, row);
    if (device != NULL)
        put_device(table, row, device);
    put_text(table, row, BB_RUN_FLAGS, bb_build_flags);
    snprintf(text, sizeof text, "%" PRIu64, seed);
    put_text(table, row, BB_RUN_SEED, text);
    put_text(table, row, BB_RUN_COMMAND, command);
    return row;
}
