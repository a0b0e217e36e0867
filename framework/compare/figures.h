/* What a difference of an exact figure means. */
#ifndef BB_COMPARE_FIGURES_H
#define BB_COMPARE_FIGURES_H

#include "framework/record/schema.h"
#include "framework/table/table.h"

/* Whether less of a field of the result file is better. */
bb_better bb_field_better(bb_field_id field);

/* Whether it counts wrong answers, of which any is one too many. */
bool bb_figure_is_wrong(const char *name);
/* Whether it is there for every cell whose answers were judged. */
bool bb_figure_is_judgement(const char *name);
/* Whether it is how many were. */
bool bb_figure_is_judged(const char *name);

#endif
