/* Shared by the files of the record: the document, and functions that put members into it. */
#ifndef BB_RECORD_PRIVATE_H
#define BB_RECORD_PRIVATE_H

#include "framework/device/run_row.h"
#include "framework/record/put.h"
#include "framework/record/record.h"

#define BB_RESULTS_SCHEMA "bvhbench-results/1"

struct bb_results {
    cJSON *root;
};

/* A skipped ray set, or a picture. */
typedef struct bb_note_record {
    const char *scene, *rays, *view, *reason, *caption, *path;
} bb_note_record;

/* ---- members; each returns false when there is no memory ---- */

/* Puts the field `name`, and those that go with it, into `object`. `extra` has what the record
 * lacks.
 */
typedef bool bb_put_fn(cJSON *object, const char *name, const void *record, const void *extra);

/* Puts all fields of a part, from its record: bb_scene, bb_build_record, bb_trace_record or
 * bb_note_record. */
bool bb_put_part(cJSON *object, bb_field_part part, const void *record, const void *extra);
/* Puts all fields of a part into an object of its own, the member `name` of `entry`. */
bool bb_put_inner(cJSON *entry, const char *name, bb_field_part part, const void *record);

/* Puts a number; null for 0, which means that it is not known. */
bool bb_put_size(cJSON *object, const char *name, uint64_t value);
bool bb_put_samples(cJSON *object, const char *name, const bb_samples *samples);
bool bb_put_named(cJSON *object, const char *name, const bb_named_ms *entries, uint32_t count);

/* The functions that fields.h names, of scenes, builds and traces (record_entries.c). */
bb_put_fn bb_put_prims, bb_put_steps, bb_put_bits, bb_put_needs;
bb_put_fn bb_put_build_decisions, bb_put_trace_decisions;
bb_put_fn bb_put_kinds, bb_put_bounds, bb_put_profile, bb_put_boxes, bb_put_views, bb_put_closed;
bb_put_fn bb_put_builder, bb_put_build_params, bb_put_build_times, bb_put_build_rate, bb_put_phases,
    bb_put_layouts, bb_put_tree;
bb_put_fn bb_put_native, bb_put_rays_source, bb_put_query, bb_put_rays_params, bb_put_rate,
    bb_put_accuracy, bb_put_unlike, bb_put_wrong_ppm, bb_put_overflowed, bb_put_first_wrong,
    bb_put_work, bb_put_first_ray;

/* Gives a key to a trace without one, from its members. Rays of another program are known by their
 * hash. */
bool bb_put_missing_key(cJSON *trace);

/* Puts the run's context into the document, as the member "context". */
bb_status bb_put_context(cJSON *root, const bb_context *context, const char *embree_version);

/* Put intervals and ranges of `ms` into a build as times, and into a trace, which must have its
 * count, as rates. False without memory. */
bool bb_put_build_spread(cJSON *build, const bb_samples *ms);
bool bb_put_rate_spread(cJSON *trace, const bb_samples *ms);

#endif
