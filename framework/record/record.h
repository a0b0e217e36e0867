/* Records of a run, and the result file (schema bvhbench-results/1). Names contain the units. NAN
 * and NULL mean "not measured" and are written as null, never as 0.
 */
#ifndef BB_RECORD_H
#define BB_RECORD_H

#include "framework/base/decision.h"
#include "framework/base/statistics.h"
#include "framework/base/status.h"
#include "framework/device/device_private.h"
#include "framework/device/run_row.h"
#include "framework/judge/accuracy.h"
#include "framework/rays/rays.h"
#include "framework/record/cell.h"
#include "framework/record/schema.h"
#include "framework/scene/scene.h"
#include "framework/tree/metric.h"
#include "framework/tree/tree.h"

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
    uint32_t id;
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
    double prepare_ms;     /* preparation before the first build; NAN: not measured */
    double boxes_ms;       /* making of the boxes, if the builder reads them; NAN: not measured */
    char inputs[64];       /* what the builder declares it reads: "boxes geometry"; "": not known */
    char handover[8];      /* bb_handover_word() of a builder on a device; "": on the host */
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
    } layouts[BB_LAYOUTS_MAX];
    bool has_tree;
    bb_tree_info tree;
    uint64_t bytes_tree, bytes_peak;
    bb_metric_value metrics[BB_METRICS_MAX]; /* as bb_metrics; NAN: not measured */
    bb_decisions decisions;                  /* decisions that the stages report */
    char about[512];     /* the builder's description of its tree; "" for none */
    double bytes_native; /* of reference rows, the library's bytes; else NAN */
    bool reference;
    bool unmeasured; /* built only for the traces of this shard; another shard measures the build */
} bb_build_record;

typedef struct bb_trace_record {
    uint32_t build;         /* id of the build */
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
    bool counts_for_exit;  /* an `exact` cell that is no reference */
    bool wrong; /* above the limit; shown as WRONG if it counts for the exit, else as `wrong` */
    bool reference;
} bb_trace_record;

/* How well measures of trees predict the time of one kind of rays: SAH, EPO, (1 - alpha) SAH +
 * alpha EPO, and the counted work. framework/summary/prediction.h computes it. NAN: not known. */
typedef struct bb_prediction_record {
    const char *rays;
    uint32_t cells, groups, trees, scenes;
    double alpha, alpha_least, alpha_most; /* the range: with one scene left out */
    double mix_error, mix_correlation, unseen_error;
    double sah_error, sah_correlation, epo_error, epo_correlation, work_error, work_correlation;
} bb_prediction_record;

/* Empty records: every figure "not measured", status ok. */
void bb_build_record_init(bb_build_record *build);
void bb_trace_record_init(bb_trace_record *trace);

typedef struct bb_results bb_results;

/* Whether figures of two devices, by name and type, may stand side by side: of one device, or of
 * processors. */
bool bb_device_is_like(const char *device, const char *type, const char *other,
                       const char *other_type);

/* What ratios to reference rows are to: "Embree"; "Embree on the CPU" where the run's device is
 * another. */
const char *bb_results_reference(const bb_results *results);

/* An empty result document with its context (date, revision, host, cpu, load, device, driver ...).
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
bb_status bb_results_add_build(bb_results *results, const bb_build_record *build);
bb_status bb_results_add_trace(bb_results *results, const bb_trace_record *trace);
/* Adds the time of a step outside builds and traces, such as "load" or "judge answers". Times of
 * one name add up. */
bb_status bb_results_add_step(bb_results *results, const char *name, double ms);
/* Sets the wall times of the run and of its timed builds and traces. The rest, which steps do not
 * account for, becomes "other". To be called after the last step; a later call replaces it. */
bb_status bb_results_set_total(bb_results *results, double build_ms, double trace_ms,
                               double total_ms);
/* Sets how many processors other programs kept busy during the run; NAN: not known. A later call
 * replaces it. */
bb_status bb_results_set_others(bb_results *results, double processors);
/* Sets what compiling took (framework/device/device_private.h). To be called once. */
bb_status bb_results_set_compiling(bb_results *results, const bb_compiling *compiling);
/* Marks the run as a shard, such as "2/8". `of` is a hash of the whole request. */
bb_status bb_results_set_shard(bb_results *results, const char *shard, uint64_t of);
/* Marks the run as interrupted: its records are complete, but some are missing. */
bb_status bb_results_set_interrupted(bb_results *results);
/* Adds a ray set that could not be made, with the reason. */
bb_status bb_results_add_skipped(bb_results *results, const char *scene, const char *rays,
                                 const char *view, const char *reason);
/* Adds a picture for the report. `path` is relative to the results folder. */
bb_status bb_results_add_picture(bb_results *results, const char *scene, const char *view,
                                 const char *caption, const char *path);

/* Predictions follow from the whole document, so merging and joining remove them. */
bb_status bb_results_add_prediction(bb_results *results, const bb_prediction_record *prediction);
void bb_results_clear_predictions(bb_results *results);

/* Returns the least id that no build has. */
uint32_t bb_results_next_build(const bb_results *results);

cJSON *bb_results_json(bb_results *results); /* still owned by `results` */
typedef enum bb_section_id {
    BB_SCENES,
    BB_BUILDS,
    BB_TRACES,
    BB_SKIPPED,
    BB_PICTURES,
    BB_PREDICTIONS,
    BB_MERGED, /* contexts of runs that were merged into this document */
    BB_STEPS,  /* parts: times outside builds and traces, in ms */
    BB_TIMES,  /* parts: "build", "trace", "steps", "other", "total", in ms */
    BB_SECTIONS
} bb_section_id;

/* Returns a section; NULL if there is none. */
const bb_section *bb_results_section(const bb_results *results, bb_section_id section);
/* Returns another member of the document, such as "advice", "audit" or "reproductions"; NULL if
 * there is none. */
const cJSON *bb_results_member(const bb_results *results, const char *name);
const bb_entry *bb_results_context(const bb_results *results);
/* Returns the number of a part of a section; NAN if there is none. */
double bb_results_ms(const bb_results *results, bb_section_id section, const char *part);
/* Finds a scene by name, a build by id; NULL if there is none. */
cJSON *bb_results_scene(const bb_results *results, const char *name);
cJSON *bb_results_build(const bb_results *results, uint32_t id);
/* Returns the array of reproductions of papers, which is made if there is none; NULL without
 * memory. */
cJSON *bb_results_reproductions(bb_results *results);
/* Returns the document as text, with enough digits to read each number back exactly. Free it with
 * cJSON_free(). NULL without memory. */
char *bb_results_print(const bb_results *results, bool formatted);

/* Writes the file by way of a temporary file, so that an interrupted run leaves the old file or
 * none. */
bb_status bb_results_write(const bb_results *results, const char *path);
/* Reads a file and checks it against the schema. BB_INVALID names what is wrong. */
bb_status bb_results_read(const char *path, bb_results **out);
/* Appends b's scenes, builds (renumbered), traces, skipped sets, pictures, reproductions and times
 * to a. b's context goes into a's array "merged", and b's builds, traces and skipped sets get the
 * member "run", the number of that context from 1. Times add up; the total is dropped if a or b has
 * none. BB_INVALID if a scene of one name has two geometries. */
bb_status bb_results_merge(bb_results *a, const bb_results *b);

/* Adds shard b of a run to a, another shard of it or several that were joined. The context's
 * "shards" lists them. If one shard measured a build and the other only needed it, the measured one
 * stays. BB_INVALID if both are not of one run (revision, device or seed differ) or measured the
 * same cell; `a` must not be used then. */
bb_status bb_results_join(bb_results *a, const bb_results *b);
/* Ends joining once all shards are there: the document is a whole run then. */
void bb_results_end_join(bb_results *results);

#endif
