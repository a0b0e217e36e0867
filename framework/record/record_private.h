/* Shared by the files of the record: rows with their entries, and functions that fill them. */
#ifndef BB_RECORD_PRIVATE_H
#define BB_RECORD_PRIVATE_H

#include "framework/record/record.h"

struct bb_section {
    bb_entry *first, *last;
    uint32_t count;
};

struct bb_entry {
    bb_table *table;
    uint32_t row;
    bb_entry *next; /* of its section, or of the parts of its entry */
    bb_section parts;
    const bb_entry *build; /* of a trace */
};

struct bb_results {
    bb_table *table;
    bb_entry **entries; /* by row */
    uint32_t entry_count, entry_room;
    bb_entry *context;
    bb_section sections[BB_SECTIONS];
    uint32_t run;     /* of the builds and traces that are added */
    bb_status status; /* of the first entry that could not be added */
};

/* The part whose fields the entries of a section have. */
extern const bb_field_part bb_section_parts[BB_SECTIONS];

/* Empty results, without a context. */
bb_status bb_results_make(bb_results **out);
/* Adds the entry of a row that was just added to the table, to its section or its entry. BB_INVALID
 * if its names make no sort of row, or if the row to which it belongs is missing. */
bb_status bb_results_enter(bb_results *results, uint32_t row);
/* Returns the entry of a cell, which is added if there is none; NULL after bb_fail(). */
bb_entry *bb_results_entry(bb_results *results, bb_cell cell);
/* Returns the entry of the part `name` of an entry; NULL after bb_fail(). */
bb_entry *bb_results_part(bb_results *results, const bb_entry *entry, const char *name);
/* Returns the entry of a cell; NULL: there is none. */
bb_entry *bb_results_find(const bb_results *results, bb_cell cell);

/* Put one value by a field; an entry that is NULL takes none. */
void bb_put_number(bb_entry *entry, bb_field_id field, double value);
void bb_put_text(bb_entry *entry, bb_field_id field, const char *value);
void bb_put_rounds(bb_entry *entry, bb_field_id field, const bb_samples *samples);
void bb_put_flag(bb_entry *entry, bb_field_id field, bool value);

/* What is put where; `extra` has what the record lacks. */
typedef struct bb_put {
    bb_results *results;
    bb_entry *entry;
    const void *record, *extra;
} bb_put;
/* Puts a field, and those that go with it. */
typedef void bb_put_fn(const bb_put *p);

/* Puts all fields of a part, from its record: bb_scene, bb_build_record, bb_trace_record or
 * bb_prediction_record. */
void bb_put_part(const bb_put *p, bb_field_part part);

/* The functions that fields.h names, of scenes, builds and traces (record_entries.c). */
bb_put_fn bb_put_kinds, bb_put_prims, bb_put_needs, bb_put_boxes, bb_put_views, bb_put_closed,
    bb_put_bits;
bb_put_fn bb_put_build_params, bb_put_stages, bb_put_phases, bb_put_layouts, bb_put_build_decisions,
    bb_put_simulated_builds;
bb_put_fn bb_put_native, bb_put_rays_source, bb_put_query, bb_put_rays_params,
    bb_put_trace_decisions, bb_put_simulated, bb_put_given, bb_put_unlike, bb_put_wrong_ppm,
    bb_put_overflowed, bb_put_first_wrong;

/* Puts the fields of a tree and its metrics. */
void bb_put_tree(bb_results *results, bb_entry *entry, const bb_build_record *build);
/* Gives a key to a trace without one, from its names. Rays of another program are known by their
 * hash. */
void bb_put_missing_key(bb_entry *trace);

/* BB_INVALID if scenes of one name have two geometries: else speeds on these would be compared. */
bb_status bb_tables_check_scenes(const bb_table *a, const bb_table *b);
/* Where a row is copied when tables are put together. */
typedef struct bb_target {
    bb_cell cell;
    const char *tree_run; /* of a trace: the run of its build, if that is another */
} bb_target;
/* Changes the target, or returns false to leave the row out. Texts live until the next call. */
typedef bool bb_target_fn(void *user, const bb_table *to, const bb_table *from, uint32_t row,
                          bb_target *target);
bb_status bb_table_copy_rows(bb_table *to, const bb_table *from, bb_target_fn *aim, void *user);
/* Copies the rows of `from`, but for predictions and steps. */
bb_status bb_results_copy(bb_results *to, const bb_results *from, bb_target_fn *aim, void *user);
/* Makes `results` those of `made`, which is freed. */
void bb_results_replace(bb_results *results, bb_results *made);
/* Adds the steps of `from`. */
bb_status bb_results_add_steps(bb_results *to, const bb_results *from);
/* Sets the sums of the times of a and b, after the last step. If either has no total, `to` has
 * none: it would be that of the other alone. */
bb_status bb_results_add_totals(bb_results *to, const bb_results *a, const bb_results *b);

#endif
