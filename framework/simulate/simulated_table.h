/* Simulated figures as columns of a table, for commands that have no results of traces. */
#ifndef BB_SIMULATED_TABLE_H
#define BB_SIMULATED_TABLE_H

#include "framework/simulate/simulate.h"
#include "framework/table/table.h"

/* Puts all figures into the row, and what binds. */
void bb_simulated_put(bb_table *table, uint32_t row, const bb_simulation *simulation);

/* Puts the reason why there are none. */
void bb_simulated_put_none(bb_table *table, uint32_t row, const char *why);

/* Reads them back. A figure that is not there is NAN. Returns whether there is a bound. */
bool bb_simulated_get(const bb_table *table, uint32_t row, bb_simulation *simulation);

#endif
