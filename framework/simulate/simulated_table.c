#include "framework/simulate/simulated_table.h"

#include <math.h>

BB_TEXT(binds, "simt_binds", "binds", "What bounds the simulated speed: issue, L1, L2 or memory.");
BB_TEXT(unsimulated, "simt_unsimulated", "not simulated", "Why there are no simulated figures.");
static const bb_column columns[] = {
#define SIMT(id, member, name, unit, better, heading, help)                                        \
    BB_EXACT_COLUMN(name, name, unit, "Simulated, neither measured nor validated: " help ".",      \
                    better, -1),
#include "framework/simulate/simt_figures.h"
};

void bb_simulated_put(bb_table *table, uint32_t row, const bb_simulation *s)
{
    const bb_column *column = columns;
#define SIMT(id, member, name, unit, better, heading, help)                                        \
    bb_table_set_number(table, row, column++, s->member);
#include "framework/simulate/simt_figures.h"
    if (isfinite(s->mrays_s))
        bb_table_set_text(table, row, &binds, bb_binding_word(s->binds));
}

void bb_simulated_put_none(bb_table *table, uint32_t row, const char *why)
{
    bb_table_set_text(table, row, &unsimulated, why);
}

bool bb_simulated_get(const bb_table *table, uint32_t row, bb_simulation *s)
{
    *s = (bb_simulation){.binds = bb_binding_of(bb_table_get_text(table, row, binds.name))};
#define SIMT(id, member, name, unit, better, heading, help)                                        \
    s->member = bb_table_get_number(table, row, name);
#include "framework/simulate/simt_figures.h"
    return isfinite(s->mrays_s);
}
