/* How differences of exact figures count. */
#ifndef BB_COMPARE_FIGURES_H
#define BB_COMPARE_FIGURES_H

#include "framework/record/schema.h"
#include "framework/table/table.h"

/* Returns whether less or more of a field of the result file is better. */
bb_better bb_field_better(bb_field_id field);

/* Returns whether the figure counts wrong answers. */
bool bb_figure_is_wrong(const char *name);
/* Returns whether every cell with judged answers has this figure. */
bool bb_figure_is_judgement(const char *name);
/* Returns whether the figure is the number of judged answers. */
bool bb_figure_is_judged(const char *name);

#endif
