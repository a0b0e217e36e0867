/* What a contest measured, as rows of a table: of each way, each tree and each phase of its build.
 */
#ifndef BB_CONTEST_TABLE_H
#define BB_CONTEST_TABLE_H

#include "framework/base/statistics.h"
#include "framework/builder/builder.h"
#include "framework/simulate/simulate.h"
#include "framework/table/outline.h"

enum { BB_CONTEST_WAYS_MAX = 64, BB_CONTEST_VIEWS = 9, BB_CONTEST_VIEWS_BRIEF = 7 };

/* A phase of a build. */
typedef struct bb_contest_phase {
    char name[48];
    bb_samples ms;
} bb_contest_phase;

/* A builder with a search, or no tree. Times in ms; of answers the mean over all questions, or
 * their sum, in each round. Of several scenes, sums. */
typedef struct bb_contest_way {
    const char *builder, *search; /* the request's; "": no tree */
    char refused[320];            /* why there are no figures; "": there are */
    /* layout: with the transfer of a tree that was made on the host */
    bb_samples build, layout, answer, answer_cpu;
    uint32_t phase_count;
    bb_contest_phase phases[BB_PHASES_MAX];
    uint32_t nodes, leaves;
    uint32_t references;
    uint64_t tree_bytes;
    uint64_t query_bytes; /* of layouts: what an answer reads, the scene's own not counted */
    uint64_t bytes;       /* of trees and scratch at most, and of layouts */
    double visits, work, restarts; /* nodes, primitives and restarts of bb_count, per item */
    bool light;                    /* the answers are light, of which these are known: */
    double most;                   /* the largest difference of a channel from the base, */
    uint32_t most_8;               /* and that in 8 bits */
    uint64_t differ;               /* items whose answers differ at all */
    uint64_t overflown;            /* items for which a stack was too small */
    bool simulated;                /* there are simulations, as many as were asked for */
    char unsimulated[320];         /* why there are none; "": there are, or none was asked for */
    bb_simulation simulations[BB_SIMT_MAX];
} bb_contest_way;

/* Views of all contests, for bb_page_outline; the last ones are those of trees and phases. */
extern const bb_table_view bb_contest_views[BB_CONTEST_VIEWS];

/* What outlines of contests have in common. */
#define BB_CONTEST_OUTLINE(count)                                                                  \
    .views = bb_contest_views, .view_count = count, .wrong = "differ",                             \
    .well = "All answers are the same to the last bit.",                                           \
    .ill = "answers differ from those of the first way."

/* Of what is measured, `animate` included. */
extern const bb_column bb_column_status, bb_column_refused, bb_column_rounds, bb_column_nodes,
    bb_column_tree_bytes, bb_column_bytes, bb_column_phase;
/* The path of a PNG file from the table's folder. */
extern const bb_column bb_column_picture;

/* Adds the ways. `items`: how many an answer has, such as voxels of a slice. `primitives`: of the
 * scene, which references are counted by; 0: they are not. */
void bb_contest_fill(bb_table *table, const char *scene, const bb_contest_way *ways, uint32_t count,
                     double items, double primitives);

/* Adds each simulation as a row of its way, with the simulation's name as the maker; `items` as
 * above. */
void bb_contest_fill_simulated(bb_table *table, const char *scene, const bb_contest_way *ways,
                               uint32_t count, double items, const bb_simt *simts,
                               uint32_t simt_count);

/* The row of a scene, with a question (NULL: without). */
uint32_t bb_contest_scene_row(bb_table *table, const char *scene, const char *question);

#endif
