/* A GPU on paper: devices/NAME.json, or a file of that form (devices/README.md). */
#ifndef BB_DESCRIPTION_H
#define BB_DESCRIPTION_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Whole numbers but for clock and memory. */
typedef struct bb_description {
    char name[32], title[96], code[16];
    double units, lanes, clock_ghz, issues_per_clock;
    double groups, registers, register_step;
    double first_bytes, first_ways, first_bytes_per_clock;
    double second_bytes, second_ways, second_bytes_per_clock;
    double memory_gb_s;
} bb_description;

/* Reads the device of that name, or the file if `text` ends with ".json"; the name of such a device
 * ends with a hash of its figures. BB_INVALID for an unknown name, and for a member that is missing
 * or there twice, or that no device can have. */
bb_status bb_description_read(const char *text, bb_description *description);

/* Writes the names of devices/, with `separator` between them. */
void bb_description_names(const char *separator, char *text, size_t capacity);

/* Groups of `width` rays that a unit has in flight, if each ray needs so many registers: at least
 * one. */
uint32_t bb_description_in_flight(const bb_description *description, uint32_t registers,
                                  uint32_t width);

#endif
