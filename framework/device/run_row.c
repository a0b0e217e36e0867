#include "framework/device/run_row.h"

#include "framework/device/device_private.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Generated at build time. */
extern const char bb_build_revision[], bb_build_version[], bb_build_flags[];

#define COLUMN_OF(sense, decimals, id, kind, name, heading, help)                                  \
    const bb_column id = {name,  heading,           "",      help, BB_COLUMN_##kind,               \
                          sense, BB_BETTER_NEITHER, decimals}
#define COLUMN(...) COLUMN_OF(BB_SENSE_EXACT, 0, __VA_ARGS__)
#define COLUMN_OF_CLOCKS(...) COLUMN_OF(BB_SENSE_TIMED, 2, __VA_ARGS__)

static COLUMN_OF_CLOCKS(date, TEXT, "date", "Date", "When the run began, UTC.");
static COLUMN(revision, TEXT, "revision", "Revision", "The program's revision.");
static COLUMN(version, TEXT, "version", "Version", "The program's version.");
COLUMN(bb_run_host, TEXT, "host", "Host", "The machine's name.");
static COLUMN(cpu, TEXT, "cpu", "Processor", "The machine's processor.");
static COLUMN(threads, NUMBER, "cpu_threads", "Threads", "Of the processor.");
static COLUMN_OF_CLOCKS(load_1, NUMBER, "load_1", "Load, 1 min", "Before the run.");
static COLUMN_OF_CLOCKS(load_5, NUMBER, "load_5", "Load, 5 min", "Before the run.");
static COLUMN_OF_CLOCKS(load_15, NUMBER, "load_15", "Load, 15 min", "Before the run.");
COLUMN(bb_run_device, TEXT, "device", "Device", "The OpenCL device.");
static COLUMN(type, TEXT, "device_type", "Device type", "CPU, or GPU for all other devices.");
COLUMN(bb_run_driver, TEXT, "driver", "Driver", "The OpenCL driver's version.");
static COLUMN(opencl, TEXT, "opencl", "OpenCL", "The OpenCL version of the device.");
static COLUMN(units, NUMBER, "compute_units", "Compute units", "Of the device.");
static COLUMN(floats, TEXT, "float_config", "Floats of the device", "In OpenCL's words.");
static COLUMN(handover, TEXT, "handover", "Handover", "How work-groups hand over data.");
static COLUMN(messages, NUMBER, "litmus_messages", "Litmus messages",
              "That the fence was tested by.");
static COLUMN(stale, NUMBER, "litmus_stale", "Stale", "Of the messages.");
static COLUMN(kernels, TEXT, "kernels", "Kernels", "Where the device code comes from.");
static COLUMN(flags, TEXT, "build_flags", "Build flags", "How the program was compiled.");
static COLUMN(seed_column, TEXT, "seed", "Seed", "The random seed.");
static COLUMN(command_column, TEXT, "command", "Command", "The command line.");
COLUMN(bb_run_interrupted, TEXT, "interrupted", "Interrupted", "yes: not all was measured.");

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
    bb_table_set_text(table, row, &floats, text);
}

static void put_device(bb_table *table, uint32_t row, const bb_device *device)
{
    const char *kind = device->is_cpu ? BB_DEVICE_CPU : BB_DEVICE_OTHER;
    bb_table_set_text(table, row, &bb_run_device, device->name);
    bb_table_set_text(table, row, &type, kind);
    bb_table_set_text(table, row, &bb_run_driver, device->driver);
    bb_table_set_text(table, row, &opencl, device->version);
    bb_table_set_number(table, row, &units, device->compute_units);
    put_floats(table, row, device->float_config);
    bb_table_set_text(table, row, &handover, bb_handover_word(device));
    if (device->litmus_pairs > 0) {
        bb_table_set_number(table, row, &messages, device->litmus_pairs);
        bb_table_set_number(table, row, &stale, device->litmus_stale);
    }
    bb_table_set_text(table, row, &kernels, device->sources);
}

static void put_machine(bb_table *table, uint32_t row)
{
    char name[256] = "";
    double load[3];
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    if (gethostname(name, sizeof name - 1) == 0)
        bb_table_set_text(table, row, &bb_run_host, name);
    read_cpu(name, sizeof name);
    bb_table_set_text(table, row, &cpu, name);
    if (count > 0)
        bb_table_set_number(table, row, &threads, (double)count);
    if (getloadavg(load, 3) != 3)
        return;
    bb_table_set_number(table, row, &load_1, load[0]);
    bb_table_set_number(table, row, &load_5, load[1]);
    bb_table_set_number(table, row, &load_15, load[2]);
}

uint32_t bb_run_row(bb_table *table, const bb_device *device, uint64_t seed, const char *command)
{
    char text[32];
    time_t now = time(NULL);
    struct tm utc;
    const uint32_t row = bb_table_row(table, (bb_cell){{NULL}});
    gmtime_r(&now, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    bb_table_set_text(table, row, &date, text);
    bb_table_set_text(table, row, &revision, bb_build_revision);
    bb_table_set_text(table, row, &version, bb_build_version);
    put_machine(table, row);
    if (device != NULL)
        put_device(table, row, device);
    bb_table_set_text(table, row, &flags, bb_build_flags);
    snprintf(text, sizeof text, "%" PRIu64, seed);
    bb_table_set_text(table, row, &seed_column, text);
    bb_table_set_text(table, row, &command_column, command);
    return row;
}
