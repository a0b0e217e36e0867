/* Records of a run, and the result file (schema bvhbench-results/1). Units are in the names; NAN
 * and NULL are "not measured" and are written as null, never as 0.
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
    BB_LAYOUTS_MAX = 48,     /* of one tree */
    BB_RECORD_STEPS_MAX = 5, /* of a pipeline: its stages and what comes between them */
    BB_RECORD_PHASES_MAX = 64,
};

typedef struct bb_named_ms {
    char name[64];
    double ms;
} bb_named_ms;

typedef struct bb_build_record {
    uint32_t id;
    char scene[256];
    char cell[BB_CELL_KEY];   /* the build's key; "": none */
    const bb_spec *spec;      /* builder as given with its parameters */
    const bb_option *options; /* with the defaults, all parameters are recorded */
    bb_status status;
    char reason[512];
    bb_samples build_ms; /* warm builds */
    bb_samples event_ms; /* of those: sum of their kernels' times, by the device's clock */
    bb_samples cpu_ms;
    bb_samples restore_ms; /* before each of them; the builder's own, outside the clock */
    bb_samples outside_ms; /* in phases outside the clock */
    double prepare_ms;     /* before the first; NAN: not measured */
    double boxes_ms;  /* of making the primitives' boxes, if they are an input; NAN: not measured */
    char inputs[64];  /* what the builder declares it reads: "boxes geometry"; "": not known */
    char handover[8]; /* bb_handover_word() of what is built on a device; "": on the host */
    double cold_ms;
    bb_samples transfer_ms; /* of what the builder declares it reads down, of the tree up */
    uint32_t phase_count;
    bb_named_ms phases[BB_RECORD_PHASES_MAX];
    /* Of a builder made of stages, `spec` has the text alone and `options` is NULL. */
    uint32_t stage_count; /* 0: one builder by itself */
    struct {
        const char *label;
        const bb_spec *spec;
        const bb_option *options;
    } stages[BB_RECORD_STEPS_MAX];
    uint32_t step_count;
    struct {
        char name[64];
        bb_samples ms;              /* of the warm builds: they add up to build_ms */
        double sah;                 /* of the tree after it; NAN: it makes none */
        uint64_t bytes, bytes_peak; /* of what it made; with its scratch; 0: not known */
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
    bb_decisions decisions;                  /* of the stages; none where nobody reports any */
    char about[512];                         /* the builder's own words on its tree; "" for none */
    double bytes_native;                     /* reference rows: what the library booked; NAN else */
    bool reference;
    bool unmeasured; /* built for traces of this shard alone: another shard measures the build */
} bb_build_record;

typedef struct bb_trace_record {
    uint32_t build;         /* id */
    char cell[BB_CELL_KEY]; /* the key; "": none */
    char scene[256], view[48], builder[512], kernel[512], layout[96], intersector[64];
    char rays[128];
    bool rays_as_given; /* made by hand, not by a workload: see `bvhbench judge --verify no` */
    const bb_spec *rays_spec; /* with the defaults, all parameters are recorded; may be NULL */
    const bb_option *rays_options;
    const bb_query *query;
    uint32_t count;
    uint64_t rays_hash;
    bool native; /* the layout keeps the shape of the builder's tree */
    uint32_t group_size, stack_size;
    bb_decisions decisions; /* of the kernel; none of a reference */
    bb_status status;
    char reason[512];
    bb_samples ms, event_ms, cpu_ms;
    double mrays_s_given; /* of an outside tracer: its speed, as somebody says; else 0 */
    double node_tests_per_ray, prim_tests_per_ray;
    bool has_accuracy;
    bb_accuracy accuracy;
    uint32_t counted; /* rays that the counting variant traced, a sample of the set; the tests per
                         ray are means over them; 0: not measured, `overflowed` is null then */
    uint64_t overflowed; /* of the counted rays: those that needed more stack than there is. In the
                             timed run such a ray's hit stays poisoned: it is judged as unwritten,
                             thus missed */
    /* rays answered otherwise than by the first `exact` cell of the set; `exact` only */
    uint32_t unlike;
    uint32_t launches;     /* that a round took */
    uint32_t warm_rounds;  /* before those that are in the samples; 0: none */
    char traced_on[8];     /* "CPU" of a reference beside another device; "" on the run's own */
    char unlike_whom[256]; /* that cell; "" if this one was not compared */
    bool counts_for_exit;  /* an `exact` cell of ours */
    bool wrong; /* above the limit; marked WRONG if it counts for the exit, else `wrong` */
    bool reference;
} bb_trace_record;

/* How well measures of trees predict what rays of one kind take: SAH, EPO, (1 - alpha) SAH + alpha
 * EPO, and the counted work (framework/summary/prediction.h makes it). NAN: not known. */
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
 * Revision, flags and the like are those of the binary, Embree's version that of the library that
 * is loaded. Owned by the caller. BB_FAILED without memory or Embree. */
typedef struct bb_context {
    const bb_device *device;
    uint64_t seed;
    const char *command; /* the command line */
} bb_context;
bb_status bb_results_create(const bb_context *context, bb_results **out);
void bb_results_destroy(bb_results *results);

/* `boxes_ms`: of making the primitives' boxes on the device; NULL: not measured. */
bb_status bb_results_add_scene(bb_results *results, const bb_scene *scene,
                               const bb_samples *boxes_ms);
bb_status bb_results_add_build(bb_results *results, const bb_build_record *build);
bb_status bb_results_add_trace(bb_results *results, const bb_trace_record *trace);
/* Time of a step outside build and trace: "load", "rays", "oracle", "judge", "compile", "report"
 * ...; adds up per name. */
bb_status bb_results_add_step(bb_results *results, const char *name, double ms);
/* Wall clock of the whole run and of its timed builds and traces; what neither they nor the steps
 * account for is written as "other". To be called after the last step; a later call replaces it. */
bb_status bb_results_set_total(bb_results *results, double build_ms, double trace_ms,
                               double total_ms);
/* Processors that other programs kept busy meanwhile; NAN: not known. A later call replaces it. */
bb_status bb_results_set_others(bb_results *results, double processors);
/* What compiling took (framework/device/device_private.h). Once. */
bb_status bb_results_set_compiling(bb_results *results, const bb_compiling *compiling);
/* Which part of the cells this is: "2/8"; and of which run: a hash of what was asked for. */
bb_status bb_results_set_shard(bb_results *results, const char *shard, uint64_t of);
/* That the run was interrupted: what is there is whole, but not all that was asked for. */
bb_status bb_results_set_interrupted(bb_results *results);
/* A ray set that the scene does not have, and why: no hole goes unsaid. */
bb_status bb_results_add_skipped(bb_results *results, const char *scene, const char *rays,
                                 const char *view, const char *reason);
/* A picture (path relative to the results folder) to be shown in the report. */
bb_status bb_results_add_picture(bb_results *results, const char *scene, const char *view,
                                 const char *caption, const char *path);

/* What follows from the whole document, and not from that of which it becomes a part: merging and
 * joining take it out. */
bb_status bb_results_add_prediction(bb_results *results, const bb_prediction_record *prediction);
void bb_results_clear_predictions(bb_results *results);

/* The least id that no build has. */
uint32_t bb_results_next_build(const bb_results *results);

cJSON *bb_results_json(bb_results *results); /* still owned by `results` */
typedef enum bb_section_id {
    BB_SCENES,
    BB_BUILDS,
    BB_TRACES,
    BB_SKIPPED,
    BB_PICTURES,
    BB_PREDICTIONS,
    BB_MERGED, /* contexts of the runs that were merged into this one */
    BB_STEPS,  /* parts: times outside builds and traces, in ms */
    BB_TIMES,  /* parts: "build", "trace", "steps", "other", "total", in ms */
    BB_SECTIONS
} bb_section_id;

/* NULL if there is none. */
const bb_section *bb_results_section(const bb_results *results, bb_section_id section);
/* Another member of the document: "advice", "audit", "reproductions"; NULL if there is none. */
const cJSON *bb_results_member(const bb_results *results, const char *name);
const bb_entry *bb_results_context(const bb_results *results);
/* Of one of the parts of a section; NAN if there is none. */
double bb_results_ms(const bb_results *results, bb_section_id section, const char *part);
/* Entries by name and by id; NULL if there is none. */
cJSON *bb_results_scene(const bb_results *results, const char *name);
cJSON *bb_results_build(const bb_results *results, uint32_t id);
/* The array of reproductions of papers, made if there is none yet; NULL if there is no memory. */
cJSON *bb_results_reproductions(bb_results *results);
/* The document as text, each number with the digits that give it back exactly; for cJSON_free().
 * NULL if there is no memory. */
char *bb_results_print(const bb_results *results, bool formatted);

/* Writes DIR/results.json by way of a temporary file and rename: an interrupted run leaves the old
 * file or none. */
bb_status bb_results_write(const bb_results *results, const char *path);
/* Reads and checks the schema; BB_INVALID names what is wrong. */
bb_status bb_results_read(const char *path, bb_results **out);
/* Appends b's scenes, builds (renumbered), traces, skipped sets, pictures, reproductions and times
 * to a; b's context goes into a's "merged" array and b's builds, traces and skipped sets get the
 * member "run", the number of that entry from 1. Times add up; the total is dropped if one of the
 * two has none. BB_INVALID if a scene of one name has two geometries. */
bb_status bb_results_merge(bb_results *a, const bb_results *b);

/* Adds shard b of a run to shard a of it, or to what was joined of it before; context "shards" then
 * lists them. A build that one of them measured and the other only needed is there once. BB_INVALID
 * if they are not of one run: another revision, device or seed, or a cell that both measured; `a`
 * is of no use then. */
bb_status bb_results_join(bb_results *a, const bb_results *b);
/* After the last: it is no shard any more. */
void bb_results_end_join(bb_results *results);

#endif
