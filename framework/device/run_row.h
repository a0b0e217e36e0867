/* The row of a table that belongs to no cell: on what machine and device, by what program and with
 * what command the table was made. */
#ifndef BB_RUN_ROW_H
#define BB_RUN_ROW_H

#include "framework/device/device.h"
#include "framework/table/table.h"

/* Words of "device_type". */
#define BB_DEVICE_CPU "CPU"
#define BB_DEVICE_OTHER "GPU" /* whatever is no CPU */

/* Columns of that row, of run_fields.h. Interrupted, "yes": what is there is whole, but it is not
 * all that was asked for. */
typedef enum bb_run_column {
#define RUN(id, name, unit, kind, sense, format, decimals, heading, help) BB_RUN_##id,
#include "framework/device/run_fields.h"
    BB_RUN_COLUMNS
} bb_run_column;
extern const bb_column bb_run_columns[BB_RUN_COLUMNS];

extern const char bb_build_revision[]; /* generated: the program's */

/* Fills the row and returns it: date, revision, version, host, cpu, cpu_threads, governor, smt,
 * boost and processors (processors.h), the load of 1, 5 and 15 minutes; of the device (NULL: none)
 * its name, type, driver, opencl, compute_units, float_config, handover, litmus test and kernels;
 * build_flags, seed and command line. */
uint32_t bb_run_row(bb_table *table, const bb_device *device, uint64_t seed, const char *command);

#endif
