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

static const bb_column date = {.name = "date",
                               .heading = "Date",
                               .unit = "",
                               .help = "When the run began, UTC.",
                               .kind = BB_COLUMN_TEXT,
                               .sense = BB_SENSE_TIMED};
BB_TEXT(revision, "revision", "Revision", "The program's revision.");
BB_TEXT(version, "version", "Version", "The program's version.");
const bb_column bb_run_host = BB_TEXT_COLUMN("host", "Host", "The machine's name.");
BB_TEXT(cpu, "cpu", "Processor", "The machine's processor.");
BB_EXACT(threads, "cpu_threads", "Threads", "", "Of the processor.", NEITHER, 0);
BB_TIMED(load_1, "load_1", "Load, 1 min", "", "Before the run.", NEITHER, 2);
BB_TIMED(load_5, "load_5", "Load, 5 min", "", "Before the run.", NEITHER, 2);
BB_TIMED(load_15, "load_15", "Load, 15 min", "", "Before the run.", NEITHER, 2);
const bb_column bb_run_device = BB_TEXT_COLUMN("device", "Device", "The OpenCL device.");
BB_TEXT(type, "device_type", "Device type", "CPU, or GPU for all other devices.");
const bb_column bb_run_driver = BB_TEXT_COLUMN("driver", "Driver", "The OpenCL driver's version.");
BB_TEXT(opencl, "opencl", "OpenCL", "The OpenCL version of the device.");
BB_EXACT(units, "compute_units", "Compute units", "", "Of the device.", NEITHER, 0);
BB_TEXT(floats, "float_config", "Floats of the device", "In OpenCL's words.");
BB_TEXT(handover, "handover", "Handover", "How work-groups hand over data.");
BB_EXACT(messages, "litmus_messages", "Litmus messages", "", "That the fence was tested by.",
         NEITHER, 0);
BB_EXACT(stale, "litmus_stale", "Stale", "", "Of the messages.", NEITHER, 0);
BB_TEXT(kernels, "kernels", "Kernels", "Where the device code comes from.");
BB_TEXT(flags, "build_flags", "Build flags", "How the program was compiled.");
BB_TEXT(seed_column, "seed", "Seed", "The random seed.");
BB_TEXT(command_column, "command", "Command", "The command line.");
const bb_column bb_run_interrupted =
    BB_TEXT_COLUMN("interrupted", "Interrupted", "yes: not all was measured.");

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
