/* Records of a run, and its results: a table (framework/table) whose rows are scenes, builds,
 * traces and their parts. Names contain the units. NAN and NULL mean "not measured": the file has
 * no value then, never 0.
 */
#ifndef BB_RECORD_H
#define BB_RECORD_H

#include "framework/base/decision.h"
#include "framework/base/statistics.h"
#include "framework/base/status.h"
#include "framework/builder/metric.h"
#include "framework/builder/tree.h"
#include "framework/device/device_private.h"
#include "framework/device/run_row.h"
#include "framework/judge/accuracy.h"
#include "framework/judge/rays.h"
#include "framework/record/cell.h"
#include "framework/record/schema.h"
#include "framework/scene/scene.h"
#include "framework/simulate/build.h"

enum {
    BB_LAYOUTS_MAX = 48,     /* most layouts of one tree */
    BB_RECORD_STEPS_MAX = 5, /* most steps of a pipeline: its stages and what comes between them */
    BB_RECORD_PHASES_MAX = 64,
};

typedef struct bb_named_ms {
    char name[64];
    double ms;
} bb_named_ms;

typedef struct bb_build_record {
    char scene[256];
    char cell[BB_CELL_KEY];   /* key of the build; "": none */
    const bb_spec *spec;      /* builder and parameters as given */
    const bb_option *options; /* declared; their defaults complete the recorded parameters */
    bb_status status;
    char reason[512];
    bb_samples build_ms; /* warm builds */
    bb_samples event_ms; /* of these builds, the sum of the kernels' times by the device's clock */
    bb_samples cpu_ms;
    bb_samples restore_ms; /* restoring of the builder's input before each build; no part of it */
    bb_samples outside_ms; /* time of phases outside the clock */
    uint32_t launches; /* kernels, copies and fills that a build enqueues; 0: none, on the host */
    bb_samples unseen_ms; /* builds of inputs that it had not seen; no round of its own */
    bool remembers;       /* these took long, each beside a build of what it had seen */
    double prepare_ms;    /* preparation before the first build; NAN: not measured */
    double boxes_ms;      /* making of the boxes, if the builder reads them; NAN: not measured */
    char inputs[64];      /* what the builder declares it reads: "boxes geometry"; "": not known */
    char handover[8];     /* bb_handover_word() of a builder on a device; "": on the host */
    double cold_ms;
    bb_samples transfer_ms; /* download of the declared inputs and upload of the tree */
    uint32_t phase_count;
    bb_named_ms phases[BB_RECORD_PHASES_MAX];
    /* For a builder made of stages, `spec` has only the text, and `options` is NULL. */
    uint32_t stage_count; /* 0: a single builder */
    struct {
        const char *label;
        const bb_spec *spec;
        const bb_option *options;
    } stages[BB_RECORD_STEPS_MAX];
    uint32_t step_count;
    struct {
        char name[64];
        bb_samples ms;              /* of the warm builds; the steps add up to build_ms */
        double sah;                 /* of the tree after this step; NAN: there is none */
        uint64_t bytes, bytes_peak; /* bytes of its output; with scratch; 0: not known */
    } steps[BB_RECORD_STEPS_MAX];
    uint32_t layout_count;
    struct {
        char name[96]; /* as recorded: "pair:leaf=4" */
        bb_samples ms;
        double sah;
        uint64_t bytes;
        uint32_t launches; /* that make it */
    } layouts[BB_LAYOUTS_MAX];
    uint32_t simulated_count;
    struct {
        char name[80]; /* "simt:device=h100,width=32" */
        bb_build_simulation simulation;
    } simulated[BB_SIMT_MAX];
    bool has_tree;
    bb_tree_info tree;
    uint64_t bytes_tree, bytes_peak;
    uint64_t bytes_unbooked;                 /* of the peak; 0: none to speak of */
    bb_metric_value metrics[BB_METRICS_MAX]; /* as bb_metrics; NAN: not measured */
    bb_decisions decisions;                  /* decisions that the stages report */
    char about[512];     /* the builder's description of its tree; "" for none */
    double bytes_native; /* of reference rows, the library's bytes; else NAN */
    bool reference;
    bool unmeasured; /* built only for the traces of this shard; another shard measures the build */
} bb_build_record;

typedef struct bb_trace_record {
    char cell[BB_CELL_KEY]; /* key of the trace; "": none */
    char scene[256], view[48], builder[512], kernel[512], layout[96], intersector[64];
    char rays[128];
    bool rays_as_given; /* made by hand, not by a workload: see `bvhbench judge --verify no` */
    const bb_spec *rays_spec; /* parameters as given; may be NULL */
    const bb_option *rays_options;
    const bb_query *query;
    uint32_t count;
    uint64_t rays_hash;
    bool native; /* the layout keeps the shape of the builder's tree */
    uint32_t group_size, stack_size;
    bb_decisions decisions; /* decisions of the kernel; none for a reference */
    bb_status status;
    char reason[512];
    bb_samples ms, event_ms, cpu_ms;
    bb_samples sort_ms;   /* of ms: sorting the rays; none unless the kernel does */
    double mrays_s_given; /* of an external tracer, its speed as given; else 0 */
    double node_tests_per_ray, prim_tests_per_ray;
    bool has_accuracy;
    bb_accuracy accuracy;
    uint32_t counted; /* rays that the counting variant traced, a sample of the set; the tests per
                         ray are means over them; 0: not measured, `overflowed` is null then */
    uint64_t overflowed; /* of the counted rays: those that needed more stack than there is. In the
                             timed run such a ray's hit stays poisoned: it is judged as unwritten,
                             thus missed */
    /* only for `exact` cells: rays whose answers differ from those of the first `exact` cell of the
     * set */
    uint32_t unlike;
    uint32_t launches;     /* launches per round */
    uint32_t warm_rounds;  /* rounds before those in the samples */
    char traced_on[8];     /* "CPU" for a reference beside another device; "": the run's device */
    char unlike_whom[256]; /* key of that cell; "" if this one was not compared */
    uint32_t simulated_count;
    struct {
        char name[80]; /* "simt:device=h100,width=32" */
        bb_simulation simulation;
    } simulated[BB_SIMT_MAX];
    bool counts_for_exit; /* an `exact` cell that is no reference */
    bool wrong; /* above the limit; shown as WRONG if it counts for the exit, else as `wrong` */
    bool reference;
} bb_trace_record;

/* How well measures of trees predict the time of one kind of rays: SAH, EPO, (1 - alpha) SAH +
 * alpha EPO, and the counted work. framework/compare/prediction.h computes it. NAN: not known. */
typedef struct bb_prediction_record {
    const char *rays;
    uint32_t cells, groups, trees, scenes;
    double alpha, alpha_least, alpha_most; /* the range: with one scene left out */
    double mix_error, mix_correlation, unseen_error;
    double sah_error, sah_correlation, epo_error, epo_correlation, work_error, work_correlation;
} bb_prediction_record;

/* What a paper says, and whether it holds here. */
typedef struct bb_claim_record {
    const char *claim, *verdict, *paper;
    const char *claimed; /* figures beside those measured; NULL or "": none */
    const char *ours, *why;
    int held;              /* 1, 0; -1: in direction only, or not decided */
    const char *simulated; /* by which simulation it was judged; NULL: by what was measured */
} bb_claim_record;

/* Empty records: every figure "not measured", status ok. */
void bb_build_record_init(bb_build_record *build);
void bb_trace_record_init(bb_trace_record *trace);

typedef struct bb_results bb_results;

/* Writes the names of the simulations that traces have, each once, and returns their number. The
 * results own them. */
uint32_t bb_results_simulations(const bb_results *results, const char *names[BB_SIMT_MAX]);

/* Reads a trace's simulation of this name; returns whether it has one. */
bool bb_get_simulation(const bb_entry *trace, const char *name, bb_simulation *simulation);

/* Whether figures of two devices, by name and type, may stand side by side: of one device, or of
 * processors. */
bool bb_device_is_like(const char *device, const char *type, const char *other,
                       const char *other_type);

/* What ratios to reference rows are to: "Embree"; "Embree on the CPU" where the run's device is
 * another. */
const char *bb_results_reference(const bb_results *results);

/* Empty results with their context (date, revision, host, cpu, load, device, driver ...).
 * Revision, build flags and so on are those of this program; Embree's version is that of the loaded
 * library. The caller owns the results. BB_FAILED without memory or Embree. */
typedef struct bb_context {
    const bb_device *device;
    uint64_t seed;
    const char *command; /* the command line */
} bb_context;
bb_status bb_results_create(const bb_context *context, bb_results **out);
void bb_results_destroy(bb_results *results);

/* `boxes_ms`: times of making the primitives' boxes on the device; NULL: not measured. */
bb_status bb_results_add_scene(bb_results *results, const bb_scene *scene,
                               const bb_samples *boxes_ms);
/* BB_INVALID if the present run has this build already. */
bb_status bb_results_add_build(bb_results *results, const bb_build_record *build);
/* BB_INVALID if the build is missing, or if the present run has this trace already. */
bb_status bb_results_add_trace(bb_results *results, const bb_trace_record *trace);
/* What is added from now on belongs to another run on the same machine, unless there are no builds
 * yet: the same cells may then be measured again. Returns its number; the first is 0. */
uint32_t bb_results_begin_run(bb_results *results);
/* Adds the time of a step outside builds and traces, such as "load" or "judge answers". Times of
 * one name add up. */
bb_status bb_results_add_step(bb_results *results, const char *name, double ms);
/* Sets the wall times of the run and of its timed builds and traces. The rest, which steps do not
 * account for, becomes "other". To be called after the last step; a later call replaces it. */
bb_status bb_results_set_total(bb_results *results, double build_ms, double trace_ms,
                               double total_ms);
/* Set a figure or a text of the context. NAN and "": there is none. A later call replaces it. */
bb_status bb_results_set_number(bb_results *results, bb_field_id field, double value);
bb_status bb_results_set_text(bb_results *results, bb_field_id field, const char *value);
/* Sets what compiling took (framework/device/device_private.h). */
bb_status bb_results_set_compiling(bb_results *results, const bb_compiling *compiling);
/* Marks the run as a shard, such as "2/8". `of` is a hash of the whole request. */
bb_status bb_results_set_shard(bb_results *results, const char *shard, uint64_t of);
/* Marks the run as interrupted: its records are complete, but some are missing. */
bb_status bb_results_set_interrupted(bb_results *results);
/* Adds a ray set that could not be made, with the reason. */
bb_status bb_results_add_skipped(bb_results *results, const char *scene, const char *rays,
                                 const char *view, const char *reason);
/* Sets the folder in which all pictures lie. */
bb_status bb_results_locate_pictures(bb_results *results, const char *folder);
/* Adds a picture for the report. `path` is relative to the results folder. */
bb_status bb_results_add_picture(bb_results *results, const char *scene, const char *view,
                                 const char *caption, const char *path);
/* Adds a reproduced paper (without a title it is shown by its name), a claim of it, and a row of a
 * table that it prints. The row's cells are set one by one; bb_results_print_cell() takes a text,
 * or NULL and a number. Tables and rows are numbered from 0. They do nothing after a failure.
 * BB_INVALID if the present run has the paper already. */
bb_status bb_results_add_paper(bb_results *results, const char *name, const char *title);
bb_status bb_results_add_claim(bb_results *results, const char *paper,
                               const bb_claim_record *claim);
bb_status bb_results_print_heading(bb_results *results, const char *paper, const char *title,
                                   uint32_t table, uint32_t column, const char *heading);
bb_status bb_results_print_cell(bb_results *results, const char *paper, const char *title,
                                uint32_t table, uint32_t row, uint32_t column, const char *text,
                                double number);

/* Adds the prediction for one kind of rays, or replaces it. Predictions follow from all other rows,
 * so merging and joining clear them: a prediction without "cells" is none. */
bb_status bb_results_add_prediction(bb_results *results, const bb_prediction_record *prediction);
void bb_results_clear_predictions(bb_results *results);

typedef enum bb_section_id {
    BB_SCENES,
    BB_BUILDS,
    BB_TRACES,
    BB_SKIPPED,
    BB_PICTURES,
    BB_PREDICTIONS,
    BB_PAPERS, /* reproduced; their parts are claims and rows of tables */
    BB_MERGED, /* contexts of runs that were merged into these results */
    BB_STEPS,  /* steps and times of the run */
    BB_SECTIONS
} bb_section_id;

/* Entries stay where they are until results are merged, joined or destroyed. */
const bb_section *bb_results_section(const bb_results *results, bb_section_id section);
const bb_entry *bb_results_context(const bb_results *results);
/* Returns a scene by name; NULL if there is none. */
const bb_entry *bb_results_scene(const bb_results *results, const char *name);
/* Returns the time of a step; NAN if there is none. */
double bb_results_step_ms(const bb_results *results, const char *step);
/* Returns the time "build", "trace", "steps", "other" or "total"; NAN if it was not set. */
double bb_results_time_ms(const bb_results *results, const char *part);
/* Returns all rows, still owned by `results`. */
const bb_table *bb_results_table(const bb_results *results);
/* Returns the entries section by section as JSON, with derived figures, for the page. From malloc;
 * NULL without memory. */
char *bb_results_json(const bb_results *results);

/* Writes the table by way of a temporary file, so that an interrupted run leaves the old file or
 * none. */
bb_status bb_results_write(const bb_results *results, const char *path);
/* Reads a table and checks that its rows are those of a run. BB_INVALID names what is wrong. */
bb_status bb_results_read(const char *path, bb_results **out);
/* Adds b's rows to a, tables of one command, as rows of further runs: the rows of b and of the runs
 * that were merged into b get the next free numbers. BB_INVALID if a scene of one name has two
 * geometries, or if the devices differ. */
bb_status bb_table_merge(bb_table *a, const bb_table *b);
/* Does the same with results. A scene of both has its rows once, and times of steps add up; the
 * total is dropped if a or b has none. */
bb_status bb_results_merge(bb_results *a, const bb_results *b);

/* Adds shard b of a run to a, another shard of it or several that were joined. The context's
 * "shards" lists them. If one shard measured a build and the other only needed it, the measured one
 * stays, also for the traces of the other, unless the trees differ. BB_INVALID if both are not of
 * one run (revision, device or seed differ) or measured the same cell. */
bb_status bb_results_join(bb_results *a, const bb_results *b);
/* Ends joining once all shards are there: the results are of a whole run then. */
void bb_results_end_join(bb_results *results);

#endif
