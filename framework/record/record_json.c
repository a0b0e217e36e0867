/* Results section by section, as the page shows them: each entry with its fields, derived figures
 * among them. Fields of profiles, trees and accuracies stand in objects of their own.
 */
#include "framework/record/record_private.h"

#include "framework/base/json.h"

#include <math.h>

/* One value; of rounds that tables show, their median. */
static void add_value(bb_json *json, const char *name, const bb_entry *entry, bb_field_id id)
{
    const bb_field *f = &bb_fields[id];
    const char *text = bb_get_text(entry, id);
    bb_samples rounds;
    if (f->kind == (BB_FIELD_NAME | BB_RUN << BB_FIELD_DIMENSION)) {
        bb_json_add_number(json, name, bb_run_of(entry));
    } else if ((f->kind & (BB_FIELD_NAME | BB_FIELD_TEXT)) != 0) {
        bb_json_add_text(json, name, text[0] != '\0' ? text : NULL);
    } else if ((f->kind & BB_FIELD_FLAG) != 0) {
        if (text[0] != '\0')
            bb_json_add_bool(json, name, bb_get_true(entry, id));
        else
            bb_json_add_text(json, name, NULL);
    } else if ((f->kind & BB_FIELD_ROUNDS) != 0 && f->heading == NULL &&
               bb_get_samples(entry, id, &rounds)) {
        bb_json_array(json, name);
        for (uint32_t i = 0; i < rounds.count; i++)
            bb_json_add_number(json, NULL, rounds.values[i]);
        bb_json_end_array(json);
    } else {
        bb_json_add_number(json, name, bb_get_number(entry, id));
    }
}

static void add_field(bb_json *json, const bb_entry *entry, bb_field_id id)
{
    const char *name = bb_fields[id].name;
    if ((bb_fields[id].kind & BB_FIELD_PARTS) == 0) {
        add_value(json, name, entry, id);
        return;
    }
    if (bb_first_part(entry, id) == NULL)
        return;
    bb_json_object(json, name);
    bb_each_part(part, entry, id) add_value(json, bb_part_name(part), part, id);
    bb_json_end_object(json);
}

static void add_fields(bb_json *json, const bb_entry *entry, bb_field_part part)
{
    for (int id = 0; id < BB_FIELDS; id++)
        if (bb_fields[id].part == part)
            add_field(json, entry, (bb_field_id)id);
}

static void add_inner(bb_json *json, const char *name, const bb_entry *entry, bb_field_part part)
{
    bb_json_object(json, name);
    add_fields(json, entry, part);
    for (uint32_t m = 0; part == BB_IN_TREE && m < bb_metric_count(); m++) {
        bb_json_add_number(json, bb_metrics[m]->name, bb_get_metric(entry, bb_metrics[m]));
        if (bb_metrics[m]->sampled)
            bb_json_add_number(json, bb_metric_column(bb_metrics[m], true)->name,
                               bb_get_metric_half(entry, bb_metrics[m]));
    }
    bb_json_end_object(json);
}

static void add_claims(bb_json *json, const bb_entry *paper)
{
    bb_json_array(json, "claims");
    bb_each_part(claim, paper, BB_F_CLAIM_VERDICT)
    {
        bb_json_object(json, NULL);
        add_fields(json, claim, BB_IN_CLAIM);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
}

static void add_printed_row(bb_json *json, const bb_entry *row)
{
    bb_printed cell;
    bb_json_array(json, NULL);
    for (uint32_t i = 0; bb_get_printed(row, i, &cell); i++)
        if (cell.text[0] != '\0')
            bb_json_add_text(json, NULL, cell.text);
        else
            bb_json_add_number(json, NULL, cell.number);
    bb_json_end_array(json);
}

static void add_printed(bb_json *json, const bb_entry *paper)
{
    bb_printed cell;
    const bb_entry *last = NULL;
    bb_json_array(json, "tables");
    for (const bb_entry *row = bb_first_part(paper, BB_F_TABLE_TITLE); row != NULL;
         row = bb_next_part(last, BB_F_TABLE_TITLE)) {
        bb_json_object(json, NULL);
        bb_json_add_text(json, "title", bb_get_text(row, BB_F_TABLE_TITLE));
        bb_json_array(json, "columns");
        for (uint32_t i = 0; bb_get_printed(row, i, &cell); i++)
            bb_json_add_text(json, NULL, cell.heading);
        bb_json_end_array(json);
        bb_json_array(json, "rows");
        last = row;
        for (const bb_entry *one = row; (one = bb_next_printed(one)) != NULL; last = one)
            add_printed_row(json, one);
        bb_json_end_array(json);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
}

static void add_entry(bb_json *json, const bb_entry *entry, bb_section_id section)
{
    bb_json_object(json, NULL);
    add_fields(json, entry, bb_section_parts[section]);
    if (section == BB_SCENES)
        add_inner(json, "profile", entry, BB_IN_PROFILE);
    if (section == BB_BUILDS && isfinite(bb_get_number(entry, BB_F_TREE_NODES)))
        add_inner(json, "tree", entry, BB_IN_TREE);
    if (section == BB_TRACES && isfinite(bb_get_number(entry, BB_F_ACCURACY_CHECKED)))
        add_inner(json, "accuracy", entry, BB_IN_ACCURACY);
    if (section == BB_BUILDS)
        bb_json_add_number(json, "id", bb_place_of(entry));
    if (section == BB_TRACES)
        bb_json_add_number(json, "build", bb_place_of(bb_build_of(entry)));
    if (section == BB_PAPERS) {
        add_claims(json, entry);
        add_printed(json, entry);
    }
    bb_json_end_object(json);
}

static void add_times(bb_json *json, const bb_results *results, const char *name, bb_field_id field)
{
    bb_json_object(json, name);
    bb_each(step, &results->sections[BB_STEPS])
    {
        const double ms = bb_get_number(step, field);
        if (isfinite(ms))
            bb_json_add_number(json, bb_part_name(step), ms);
    }
    bb_json_end_object(json);
}

char *bb_results_json(const bb_results *results)
{
    static const char *const names[BB_SECTIONS] = {
        [BB_SCENES] = "scenes",        [BB_BUILDS] = "builds",     [BB_TRACES] = "traces",
        [BB_SKIPPED] = "skipped",      [BB_PICTURES] = "pictures", [BB_PREDICTIONS] = "predictions",
        [BB_PAPERS] = "reproductions", [BB_MERGED] = "merged"};
    bb_json json = {0};
    bb_json_object(&json, NULL);
    bb_json_object(&json, "context");
    add_fields(&json, results->context, BB_IN_CONTEXT);
    bb_json_end_object(&json);
    add_times(&json, results, "steps_ms", BB_F_STEP_MS);
    add_times(&json, results, "time_ms", BB_F_STEP_TIME);
    for (int s = 0; s < BB_STEPS; s++) {
        bb_json_array(&json, names[s]);
        bb_each(entry, &results->sections[s]) add_entry(&json, entry, (bb_section_id)s);
        bb_json_end_array(&json);
    }
    bb_json_end_object(&json);
    return bb_json_take(&json);
}
