/* What a difference of an exact figure means. */
#ifndef BB_COMPARE_FIGURES_H
#define BB_COMPARE_FIGURES_H

#include <stdbool.h>

typedef enum bb_figure_sense {
    BB_FIGURE_NEUTRAL,     /* more is neither better nor worse */
    BB_FIGURE_LESS_BETTER, /* more is worse */
} bb_figure_sense;

/* Of a figure by its name (cell_set.h). One that is not known is neutral. */
bb_figure_sense bb_figure_sense_of(const char *name);

/* Whether it counts wrong answers, of which any is one too many. */
bool bb_figure_is_wrong(const char *name);
/* Whether it is there for every cell whose answers were judged. */
bool bb_figure_is_judgement(const char *name);
/* Whether it is how many were. */
bool bb_figure_is_judged(const char *name);

#endif
