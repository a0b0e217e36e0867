/* What papers are made of: figures, tables and claims, as constant data. A figure says which values
 * of which experiment; figures.c looks them up, claims.c and tables.c show what they say.
 */
#ifndef BB_PAPER_FIGURES_H
#define BB_PAPER_FIGURES_H

#include "framework/base/statistics.h"
#include "framework/table/table.h"

#include <stdbool.h>

/* ---- what was measured ---- */

/* An experiment's table. Its cells: a scene; a scene and one of its views (frame); a scene and a
 * builder, with a phase (maker) or without; these and a kernel or search (intersector), rays or
 * another task (question), and a view. */
typedef struct bb_findings {
    bb_table *table;
    char **scenes;
    size_t scene_count;
    const char *const *simulations; /* names of those asked for, in one order for all tables */
    uint32_t simulation_count;      /* at most BB_SIMT_MAX */
} bb_findings;

/* Name of a scene's view by number; "" if there is none. */
const char *bb_view_name(const bb_findings *f, const char *scene, int number);

/* A text on a build; "" if there is none. */
const char *bb_found_text(const bb_findings *f, const char *scene, const char *builder,
                          const char *column);

/* Columns of such tables: an exact number, a text, a time in rounds. */
#define BB_FOUND_NUMBER(name_, help_)                                                              \
    {                                                                                              \
        .name = name_, .heading = name_, .unit = "", .help = help_                                 \
    }
#define BB_FOUND_TEXT(name_, help_)                                                                \
    {                                                                                              \
        .name = name_, .heading = name_, .unit = "", .help = help_, .kind = BB_COLUMN_TEXT         \
    }
#define BB_FOUND_ROUNDS(name_, help_)                                                              \
    {                                                                                              \
        .name = name_, .heading = name_, .unit = "ms", .help = help_, .kind = BB_COLUMN_ROUNDS,    \
        .sense = BB_SENSE_TIMED                                                                    \
    }

/* A value that a table has. */
typedef struct bb_found {
    bb_samples rounds; /* none: the value is exact */
    double number;     /* or the median of rounds; NAN: not measured */
    double rays;       /* that were traced for it; 0: none */
} bb_found;

/* The value of all rows that fit: a name that is NULL, or that the row lacks, fits. `columns`: of
 * one, or the sum of several, "build_ms+trace_ms". Of several rows rounds, rays and simulated times
 * are summed up, and other numbers are the mean over the rays. */
bb_found bb_find(const bb_findings *f, const bb_cell *cell, const char *columns);

/* Times that are simulated: "trace_ms" of simulation number 1 is in column "simulated1_trace_ms",
 * without rounds. Makes `out` of columns for bb_find(); returns whether one of them is such a time.
 */
#define BB_SIMULATED_TIME "simulated%u_%s"
bool bb_simulated_columns(const char *columns, uint32_t simulation, char out[256]);

/* Adds `more` to `sum` round by round; false if the rounds differ. */
bool bb_add_rounds(bb_samples *sum, const bb_samples *more);

/* ---- figures ---- */

/* A row of a table, or what a claim is said of. Lists end with name NULL. */
typedef struct bb_paper_entrant {
    const char *name;
    const char *builder; /* '$' stands for what a figure puts there */
    const char *kernel, *note;
    const char *base, *base_kernel;       /* what it is compared with */
    const struct bb_paper_numbers *paper; /* what the paper has of it */
    bool optional;                        /* left out of tables where it was not measured */
} bb_paper_entrant;

/* Where a figure is looked at. */
typedef struct bb_paper_place {
    const bb_findings *all;      /* by experiment, from that of the table or claim on */
    const bb_paper_entrant *row; /* NULL: no row */
    const char *scene;           /* NULL: all, and their mean */
    int view;                    /* of the scene, by number; -1: all of them */
    uint32_t simulated;          /* times are those of this simulation, from 1 on; 0: measured */
} bb_paper_place;

typedef enum bb_paper_mean {
    BB_MEAN_OF_SCENES, /* arithmetic, of those measured: as papers average ratios */
    BB_MEAN_OF_ROUNDS, /* the same in each round: it has an interval */
    BB_MEAN_GEOMETRIC, /* in each round, over all scenes: noise does not push it up */
} bb_paper_mean;

/* Names that are NULL are the row's. A builder is taken as it stands, but "$TEXT" is the row's with
 * TEXT for its '$', and "=" is the row's base. A '%' in it is the view's number; of "levels={6,7}"
 * it is the one that builds and traces in the least time. */
typedef struct bb_figure {
    const char *what; /* see bb_find() */
    const char *per;  /* divided by that of the same cell; NULL: by nothing */
    double scale;     /* 0: 1 */
    int of;           /* the experiment, after that of the table or claim */
    const char *builder, *kernel, *rays, *phase;
    const char *base, *base_kernel; /* base NULL: not a ratio */
    int base_of;                    /* its experiment, after `of` */
    bool previous; /* ratio to the same cell of the scene before; the first has none */
    bool inverse;  /* base over builder, such as of speeds */
    bool unpaired; /* ratio of medians, not round by round */
    bb_paper_mean mean;
    int views; /* over so many views of each scene, one by one */
    bool (*only)(const bb_findings *f, const char *scene); /* of some scenes */
} bb_figure;

/* What was measured there: a mean if the place has no scene. Without rounds there is no interval;
 * *timed: whether the figure has rounds. */
bb_estimate bb_figure_at(bb_paper_place at, const bb_figure *figure, bool *timed);

/* The same without its interval. */
double bb_value_at(bb_paper_place at, const bb_figure *figure);

/* The builder that a figure has there; `chosen`: what of {...} it is. */
void bb_figure_builder(const bb_paper_place *at, const bb_figure *figure, const char *pattern,
                       const char *kernel, char out[256], char chosen[32]);

/* A figure of each scene, or of each of its views: of all that an experiment may have. */
enum { BB_SERIES_MAX = 3 * 128 };
typedef struct bb_paper_series {
    size_t count;
    bb_paper_place places[BB_SERIES_MAX];
    bb_estimate each[BB_SERIES_MAX];
    bb_estimate mean;
    bool timed;
} bb_paper_series;
bb_paper_series bb_figure_series(bb_paper_place at, const bb_figure *figure);

/* Arithmetic, of those that are no NAN; NAN if there is none. */
double bb_series_mean(const bb_paper_series *s);
double bb_series_least(const bb_paper_series *s);
double bb_series_most(const bb_paper_series *s);

/* ---- texts ---- */

/* A text that grows; what does not fit is left out, and "..." says so. A zeroed one is empty. */
typedef struct bb_words {
    char text[4000];
    size_t length;
} bb_words;
__attribute__((format(printf, 2, 3))) void bb_say(bb_words *words, const char *format, ...);

/* "claimed 8, here 5.20 [95 %: 5.10 to 5.30]", after "; " if there is something before it. */
void bb_say_claimed(bb_words *words, const char *where, double claimed, bb_estimate here);

/* "1.20 [95 %: 1.10 to 1.30]", with the range, or without brackets, where there is no interval. */
void bb_say_estimate(bb_words *words, bb_estimate e);

/* Says "no such builder: atrbvh" if one of its stages is not registered; after "; " if there is
 * something before it. */
bool bb_say_missing(const char *builder, bb_words *words);

/* Says a text in which {scene}, {view} and {row} stand for names, and {N...} for figure N there:
 *   {0}     estimate            {0.3}   number with 3 decimals
 *   {0%1}   change in percent   {0~}    mean, least and most of the scenes
 *   {0#}    how many there are  {0<1.5} how many are below (or above, '>')
 *   {0!}    largest change      {0=}    what of {...} in its builder is the best
 *   {0/}    mean, least and most */
void bb_say_text(bb_words *words, const char *text, bb_paper_place at,
                 const bb_figure *const *figures);

/* ---- verdicts ---- */

/* In rising order of what decides over several that are to hold together. */
typedef enum bb_claim_verdict {
    BB_HELD,
    BB_DIRECTION,      /* on the right side, but not as far as claimed */
    BB_OPEN,           /* an interval reaches to both sides */
    BB_TOO_FEW_ROUNDS, /* for an interval */
    BB_NOT_TESTED,     /* a figure is missing */
    BB_NOT_HELD,
} bb_claim_verdict;

typedef enum bb_test_side {
    BB_NO_SIDE,
    BB_BELOW,
    BB_ABOVE,
    BB_AT_MOST,
    BB_AT_LEAST,
    BB_EQUAL
} bb_test_side;

/* What a figure may fall short of the claimed one and still holds: so much of it. */
#define BB_CLAIM_MARGIN 0.05

/* Where a figure is: of times, the whole interval decides. It holds if it is at `claimed` or
 * beyond, by BB_CLAIM_MARGIN; else it is on the right side of `bound`, BB_DIRECTION, or not. With
 * `claimed` 0 the side is all that is claimed, and the bound decides without a margin; with `bound`
 * 0 there is no right side. BB_EQUAL is at `claimed`, with the margin on both sides. */
bb_claim_verdict bb_verdict_at(bb_estimate e, bool timed, bb_test_side side, double bound,
                               double claimed);
/* All together; BB_NOT_TESTED for none. */
bb_claim_verdict bb_all(const bb_claim_verdict *each, size_t count);
/* More than half of those that were tested. */
bb_claim_verdict bb_most(const bb_claim_verdict *each, size_t count);
/* As the record says it: "held", "cannot be told: too few rounds" ... */
const char *bb_verdict_words(bb_claim_verdict verdict);

/* ---- claims ---- */

/* Which figure is compared: the mean of the scenes, each, or that of most; or how many scenes are
 * below the bound, less those that are as far above 1. */
typedef enum bb_over { BB_OVER_MEAN, BB_EACH, BB_MOST_OF, BB_MORE } bb_over;

typedef struct bb_test {
    int figure; /* of the claim */
    bb_over over;
    bb_test_side side;
    double bound, claimed; /* see bb_verdict_at() */
    int than;              /* the bound is the mean of figure than - 1; 0: it is `bound` */
    const struct bb_paper_numbers *paper; /* what is claimed of each scene: its number `number` */
    int number;
    bool untimed; /* the medians decide */
} bb_test;

/* A piece of what is said of a claim, after "; " if there is something before it. */
typedef struct bb_saying {
    const char *text;           /* NULL: the last */
    const char *before, *first; /* instead of "; ", and of nothing */
    bool each;                  /* for each row, or each scene (and view) of figure `of` */
    int of;
    bool always;         /* of `why`: else only if the claim did not hold */
    bool unless;         /* not where all tests hold */
    int unless_test;     /* not where test unless_test - 1 holds */
    const bb_test *when; /* only where this holds; NULL: everywhere */
    const char *also;    /* what follows where `also_when` holds */
    const bb_test *also_when;
} bb_saying;

/* What is said of a claim: what is claimed beside what was measured, the figures, those that say
 * why, and what follows. */
typedef struct bb_said {
    bb_words claimed, ours, why;
    bb_claim_verdict verdict;
} bb_said;

enum { BB_CLAIM_FIGURES = 10, BB_CLAIM_TESTS = 5, BB_CLAIM_SAYINGS = 6 };

typedef struct bb_paper_claim {
    const char *text;             /* the paper's statement, shortened; as bb_say_text() */
    const char *paper;            /* its figures; "": none */
    int of;                       /* experiment: that of its figures */
    const bb_paper_entrant *rows; /* said of each of them; NULL: of none */
    uint32_t which;               /* of the rows, by bits; 0: all */
    bool together;                /* one claim on all rows, which stand for its scenes */
    bool of_scenes;               /* on each of these rows with each scene */
    const bb_figure *figures[BB_CLAIM_FIGURES];
    bb_test tests[BB_CLAIM_TESTS]; /* end with one without a side */
    uint32_t scenes;               /* at least: with fewer it is not tested */
    bb_saying ours[BB_CLAIM_SAYINGS], why[BB_CLAIM_SAYINGS];
    /* What no row says: adds to the words, and may put another verdict. */
    void (*judge)(bb_paper_place at, bb_said *said);
} bb_paper_claim;

/* Tests of rows above, and where a saying is said: where figure N is on that side, or is measured
 * at all. */
#define BB_TEST(figure_, side_, bound_)                                                            \
    {                                                                                              \
        .figure = figure_, .side = side_, .bound = bound_                                          \
    }
#define BB_TEST_CLAIMED(figure_, side_, bound_, claimed_)                                          \
    {                                                                                              \
        .figure = figure_, .side = side_, .bound = bound_, .claimed = claimed_                     \
    }
#define BB_TEST_EACH(figure_, side_, bound_)                                                       \
    {                                                                                              \
        .figure = figure_, .over = BB_EACH, .side = side_, .bound = bound_                         \
    }
#define BB_WHEN(figure_, side_, bound_) .when = &(const bb_test)BB_TEST(figure_, side_, bound_)
#define BB_MEASURED(figure_) BB_WHEN(figure_, BB_ABOVE, 0)

/* ---- tables ---- */

typedef enum bb_shown {
    BB_SHOW_FIGURE,
    BB_SHOW_LOW,
    BB_SHOW_HIGH,
    BB_SHOW_LEAST,
    BB_SHOW_MOST,
    BB_SHOW_SCENES, /* a column for each scene */
    BB_SHOW_SCENE,
    BB_SHOW_VIEW,
    BB_SHOW_ROW,     /* its name */
    BB_SHOW_MISSING, /* the same, and which of its builders is not there */
    BB_SHOW_PAPER,   /* the paper's number of the row */
    BB_SHOW_BUILDER,
    BB_SHOW_KERNEL,
    BB_SHOW_NOTE,
    BB_SHOW_TEXT, /* that `note` names, of the scene, or of the row's builder there */
    BB_SHOW_BEST, /* the number that is the best in the figure's {...} */
    BB_SHOW_WORDS,
    BB_SHOW_NUMBER,
} bb_shown;

enum { BB_PAPER_NUMBERS = 20 };

/* A row of the paper's own. */
typedef struct bb_paper_numbers {
    const char *name;
    double numbers[BB_PAPER_NUMBERS]; /* 0: there is none */
} bb_paper_numbers;

typedef struct bb_paper_column {
    const char *heading; /* NULL: the last */
    bb_shown shown;
    const bb_figure *figure;
    int decimals;
    int paper, paper_over; /* the paper's number, from 1 on, over another; 0: none */
    const char *note;      /* of the paper's average, or the name of a text */
    void (*words)(bb_paper_place at, const bb_figure *figure, bb_words *words);
    double (*number)(bb_paper_place at, const bb_figure *figure);
} bb_paper_column;

#define BB_COLUMN(heading_, figure_, decimals_)                                                    \
    {                                                                                              \
        .heading = heading_, .figure = figure_, .decimals = decimals_                              \
    }
#define BB_COLUMN_OF(heading_, shown_)                                                             \
    {                                                                                              \
        .heading = heading_, .shown = shown_                                                       \
    }
/* A figure that no other column has. */
#define BB_COLUMN_AS(heading_, decimals_, ...)                                                     \
    BB_COLUMN(heading_, (&(const bb_figure){__VA_ARGS__}), decimals_)
/* A figure, and the ends of its interval. */
#define BB_COLUMN_INTERVAL(heading_, figure_)                                                      \
    BB_COLUMN(heading_, figure_, 3),                                                               \
        {.heading = "95 % from", .shown = BB_SHOW_LOW, .figure = figure_, .decimals = 3},          \
    {                                                                                              \
        .heading = "to", .shown = BB_SHOW_HIGH, .figure = figure_, .decimals = 3                   \
    }

typedef struct bb_paper_table {
    const char *title; /* "": more rows of the table before; NULL: the last */
    const bb_paper_column *columns;
    const bb_figure *figure;      /* of columns that have none */
    const bb_paper_entrant *rows; /* with scenes: for each of them; NULL: none */
    bool by_scene;                /* a row for each scene of experiment `of` */
    int of;
    int views;                      /* and for so many views of it */
    bool rows_first;                /* all scenes of a row, then of the next */
    const bb_figure *needs;         /* optional rows are left out where it is not measured */
    const char *average;            /* name of a row of means after the scenes; NULL: none */
    const bb_paper_numbers *paper;  /* before ours; end with name NULL */
    bool paper_last;                /* or after them */
    const char *const *paper_words; /* the same as texts: one row, with one for each column */
    const bb_paper_numbers *paper_average;
    void (*title_words)(bb_paper_place at, bb_words *title); /* adds to the title */
} bb_paper_table;

#endif
