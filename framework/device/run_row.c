#include "framework/device/run_row.h"

#include "framework/device/device_private.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Generated at build time. */
extern const char bb_build_revision[], bb_build_version[], bb_build_flags[];

#define TEXT(id, name, heading, help)                                                              \
    const bb_column id = {name,           heading,           "", help, BB_COLUMN_TEXT,             \
                          BB_SENSE_EXACT, BB_BETTER_NEITHER, 0}

TEXT(bb_run_date, "date", "date", "When the run began, UTC.");
TEXT(bb_run_revision, "revision", "revision", "The program's revision.");
TEXT(bb_run_version, "version", "version", "The program's version.");
TEXT(bb_run_host, "host", "host", "The machine's name.");
TEXT(bb_run_cpu, "cpu", "processor", "The machine's processor.");
TEXT(bb_run_device, "device", "device", "The OpenCL device.");
TEXT(bb_run_device_type, "device_type", "device type", "CPU, or GPU for all other devices.");
TEXT(bb_run_driver, "driver", "driver", "The OpenCL driver's version.");
TEXT(bb_run_opencl, "opencl", "OpenCL", "The OpenCL version of the device.");
TEXT(bb_run_handover, "handover", "handover", "How work-groups hand over data.");
TEXT(bb_run_kernels, "kernels", "kernels", "Where the device code comes from.");
TEXT(bb_run_flags, "build_flags", "build flags", "How the program was compiled.");
TEXT(bb_run_seed, "seed", "seed", "The random seed.");
TEXT(bb_run_command, "command", "command", "The command line.");
TEXT(bb_run_interrupted, "interrupted", "interrupted", "yes: not all was measured.");

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

static void put_device(bb_table *table, uint32_t row, const bb_device *device)
{
    bb_table_set_text(table, row, &bb_run_device, device->name);
    bb_table_set_text(table, row, &bb_run_device_type, device->is_cpu ? "CPU" : "GPU");
    bb_table_set_text(table, row, &bb_run_driver, device->driver);
    bb_table_set_text(table, row, &bb_run_opencl, device->version);
    bb_table_set_text(table, row, &bb_run_handover, bb_handover_word(device));
    bb_table_set_text(table, row, &bb_run_kernels, device->sources);
}

uint32_t bb_run_row(bb_table *table, const bb_device *device, uint64_t seed, const char *command)
{
    char date[32], host[256] = "", cpu[256], digits[24];
    time_t now = time(NULL);
    struct tm utc;
    const uint32_t row = bb_table_row(table, (bb_cell){{NULL}});
    gmtime_r(&now, &utc);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    if (gethostname(host, sizeof host - 1) != 0)
        host[0] = '\0';
    read_cpu(cpu, sizeof cpu);
    snprintf(digits, sizeof digits, "%" PRIu64, seed);
    bb_table_set_text(table, row, &bb_run_date, date);
    bb_table_set_text(table, row, &bb_run_revision, bb_build_revision);
    bb_table_set_text(table, row, &bb_run_version, bb_build_version);
    bb_table_set_text(table, row, &bb_run_host, host);
    bb_table_set_text(table, row, &bb_run_cpu, cpu);
    if (device != NULL)
        put_device(table, row, device);
    bb_table_set_text(table, row, &bb_run_flags, bb_build_flags);
    bb_table_set_text(table, row, &bb_run_seed, digits);
    bb_table_set_text(table, row, &bb_run_command, command);
    return row;
}
