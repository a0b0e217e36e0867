/* The row of a table that belongs to no cell: on what machine and device, by what program and with
 * what command the table was made. */
#ifndef BB_RUN_ROW_H
#define BB_RUN_ROW_H

#include "framework/device/device.h"
#include "framework/table/table.h"

/* Columns of that row, all of texts. */
extern const bb_column bb_run_date, bb_run_revision, bb_run_version, bb_run_host, bb_run_cpu,
    bb_run_device, bb_run_device_type, bb_run_driver, bb_run_opencl, bb_run_handover,
    bb_run_kernels, bb_run_flags, bb_run_seed, bb_run_command;
/* "yes": the run was interrupted. What is there is whole, but not all that was asked for. */
extern const bb_column bb_run_interrupted;

/* Fills the row and returns it. `device` may be NULL; `command` is the command line. */
uint32_t bb_run_row(bb_table *table, const bb_device *device, uint64_t seed, const char *command);

#endif
