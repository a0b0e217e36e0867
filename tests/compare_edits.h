/* Edits of made-up results, for the tests of `bvhbench compare`. */
#ifndef BB_TEST_COMPARE_EDITS_H
#define BB_TEST_COMPARE_EDITS_H

#include "tests/history_sample.h"

static const history_change nothing = {-1, -1, -1};

typedef void edit_fn(bb_results *results);

static inline bb_entry *trace_at(bb_results *results, int index)
{
    return entry_at(results, BB_TRACES, index);
}

static inline bb_entry *build_at(bb_results *results, int index)
{
    return entry_at(results, BB_BUILDS, index);
}

static inline void scale(bb_entry *entry, bb_field_id field, double factor)
{
    bb_put_number(entry, field, factor * bb_get_number(entry, field));
}

static inline void scale_metric(bb_results *results, bb_entry *build, const char *name,
                                double factor)
{
    put_metric(results, build, name, factor * metric_of(build, name));
}

static inline void scale_ms(bb_entry *entry, bb_field_id field, double factor)
{
    bb_samples rounds;
    assert_true(bb_get_samples(entry, field, &rounds));
    for (uint32_t i = 0; i < rounds.count; i++)
        rounds.values[i] *= factor;
    bb_put_rounds(entry, field, &rounds);
}

/* Takes away all figures of a part of the entry. */
static inline void clear_part(bb_entry *entry, bb_field_part part)
{
    for (int id = 0; id < BB_FIELDS; id++)
        if (bb_fields[id].part == part)
            bb_put_number(entry, (bb_field_id)id, (double)NAN);
}

static inline void set_context(bb_results *results, bb_field_id field, const char *text)
{
    ASSERT_OK(bb_results_set_text(results, field, text));
}

static inline void edit_nothing(bb_results *results)
{
    (void)results;
}

/* Writes a made-up run, edited, into a file of the folder. */
static inline void write_run(const char *folder, const char *name, edit_fn *edit, uint64_t seed)
{
    char path[600];
    bb_results *results = history_run("one", "here", "2024-01-01T00:00:00Z", nothing, seed);
    edit(results);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    ASSERT_OK(bb_results_write(results, path));
    bb_results_destroy(results);
}

/* ---- edits ---- */

static inline void edit_sah(bb_results *r)
{
    scale_metric(r, build_at(r, 3), "sah", 1.02);
}
static inline void edit_sah_better(bb_results *r)
{
    scale_metric(r, build_at(r, 3), "sah", 0.98);
}
static inline void edit_layout_sah(bb_results *r)
{
    scale(bb_results_part(r, build_at(r, 3), "pair:leaf=4"), BB_F_BUILD_LAYOUTS_SAH, 1 + 1e-12);
}
static inline void edit_layout_slower(bb_results *r)
{
    scale_ms(bb_results_part(r, build_at(r, 3), "pair:leaf=4"), BB_F_BUILD_LAYOUTS_MS, 1.5);
}
static inline void edit_nodes(bb_results *r)
{
    scale(build_at(r, 3), BB_F_TREE_NODES, 1.5);
}
static inline void edit_bytes(bb_results *r)
{
    bb_entry *build = build_at(r, 3);
    bb_put_number(build, BB_F_TREE_BYTES_PEAK, bb_get_number(build, BB_F_TREE_BYTES_PEAK) + 1);
}
static inline void edit_tests(bb_results *r)
{
    scale(trace_at(r, 5), BB_F_TRACE_NODE_TESTS, 1.001);
}
static inline void edit_missed(bb_results *r)
{
    bb_put_number(trace_at(r, 0), BB_F_ACCURACY_MISSED, 1);
}
static inline void edit_failed(bb_results *r)
{
    bb_put_text(trace_at(r, 5), BB_F_TRACE_STATUS, "failed");
}
static inline void edit_slower(bb_results *r)
{
    scale_ms(trace_at(r, 5), BB_F_TRACE_MS, 1.5);
}
static inline void edit_faster(bb_results *r)
{
    scale_ms(trace_at(r, 5), BB_F_TRACE_MS, 0.5);
}
static inline void edit_slower_reference(bb_results *r)
{
    bb_entry *trace = trace_at(r, 0);
    while (!bb_get_true(trace, BB_F_TRACE_REFERENCE))
        trace = trace->next;
    scale_ms(trace, BB_F_TRACE_MS, 1.5);
}
static inline void edit_slower_elsewhere(bb_results *r)
{
    edit_slower(r);
    set_context(r, BB_F_CONTEXT_DEVICE, "another device");
}
static inline void edit_slower_host(bb_results *r)
{
    edit_slower(r);
    set_context(r, BB_F_CONTEXT_HOST, "there");
}
static inline void edit_rays(bb_results *r)
{
    bb_put_text(trace_at(r, 5), BB_F_TRACE_RAYS_HASH, "0123");
    scale_ms(trace_at(r, 5), BB_F_TRACE_MS, 1.5);
    scale(trace_at(r, 5), BB_F_TRACE_NODE_TESTS, 1.5);
}
static inline void edit_cut_rounds(bb_results *r)
{
    edit_slower(r);
    bb_samples rounds;
    assert_true(bb_get_samples(trace_at(r, 5), BB_F_TRACE_MS, &rounds));
    rounds.count--;
    bb_put_rounds(trace_at(r, 5), BB_F_TRACE_MS, &rounds);
}
static inline void edit_gone(bb_results *r)
{
    leave_out_entry(r, trace_at(r, 5));
}
static inline void edit_layout_gone(bb_results *r)
{
    leave_out_entry(r, bb_results_part(r, build_at(r, 3), "pair:leaf=4"));
}
static inline void edit_twice(bb_results *r)
{
    bb_put_text(trace_at(r, 6), BB_F_TRACE_CELL, bb_get_text(trace_at(r, 5), BB_F_TRACE_CELL));
}
static inline void edit_seed(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_SEED, "7");
}
static inline void edit_governor(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_GOVERNOR, "powersave");
}
static inline void edit_no_governor(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_GOVERNOR, "");
}
static inline void edit_smt(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_SMT, "on");
}
static inline void edit_boost(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_BOOST, "on");
}
static inline void edit_processors(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_PROCESSORS, "0-1");
}
static inline void set_busy(bb_results *r, double processors)
{
    ASSERT_OK(bb_results_set_number(r, BB_F_CONTEXT_OTHERS, processors));
}
static inline void edit_faster_quiet(bb_results *r)
{
    edit_faster(r);
    set_busy(r, 1); /* of 4: not more than a quarter */
}
static inline void edit_faster_busy(bb_results *r)
{
    edit_faster(r);
    set_busy(r, 2);
}
static inline void edit_slower_busy(bb_results *r)
{
    edit_slower(r);
    set_busy(r, 2);
}
static inline void edit_no_figure(bb_results *r)
{
    put_metric(r, build_at(r, 3), "sah", (double)NAN);
}

static inline void edit_no_tree(bb_results *r)
{
    bb_entry *build = build_at(r, 3);
    clear_part(build, BB_IN_TREE);
    for (uint32_t m = 0; m < bb_metric_count(); m++)
        put_metric(r, build, bb_metrics[m]->name, (double)NAN);
}
static inline void edit_unjudged(bb_results *r)
{
    clear_part(trace_at(r, 5), BB_IN_ACCURACY);
}
static inline void edit_fewer_judged(bb_results *r)
{
    scale(trace_at(r, 5), BB_F_ACCURACY_CHECKED, 0.5);
}
static inline void edit_none_judged(bb_results *r)
{
    scale(trace_at(r, 5), BB_F_ACCURACY_CHECKED, 0);
}
static inline void put_in_all(bb_results *r, bb_section_id section, bb_field_id field,
                              const char *text)
{
    for (bb_entry *entry = entry_at(r, section, 0); entry != NULL; entry = entry->next)
        bb_put_text(entry, field, text);
}

static inline void edit_all_scenes(bb_results *r)
{
    put_in_all(r, BB_SCENES, BB_F_SCENE_HASH, "0123456789abcdef");
}

static inline void edit_all_failed(bb_results *r)
{
    put_in_all(r, BB_BUILDS, BB_F_BUILD_STATUS, "failed");
    put_in_all(r, BB_TRACES, BB_F_TRACE_STATUS, "failed");
}

/* As if the program knew none of the parameters that have defaults, but for the scene's. */
static inline void edit_short_keys(bb_results *r)
{
    static const bb_section_id sections[] = {BB_BUILDS, BB_TRACES};
    for (int s = 0; s < 2; s++)
        for (bb_entry *e = entry_at(r, sections[s], 0); e != NULL; e = e->next) {
            char key[BB_CELL_KEY], scene[BB_CELL_TEXT];
            bb_cell_parts cell;
            ASSERT_OK(bb_cell_key_parse(bb_get_text(e, BB_F_TRACE_CELL), &cell));
            strcpy(scene, cell.scene);
            bb_cell_short(&cell);
            strcpy(cell.scene, scene);
            ASSERT_OK(bb_cell_key_format(&cell, key));
            bb_put_text(e, BB_F_TRACE_CELL, key);
        }
}

/* Each build and layout has as many rounds as an interval needs, and more. */
static inline void edit_many_rounds(bb_results *r)
{
    bb_samples rounds = {0};
    for (int i = 0; i < 10; i++)
        bb_samples_add(&rounds, 10 + 0.01 * i);
    for (bb_entry *build = entry_at(r, BB_BUILDS, 0); build != NULL; build = build->next) {
        bb_put_rounds(build, BB_F_BUILD_MS, &rounds);
        bb_each_part(layout, build, BB_F_BUILD_LAYOUTS_MS)
            bb_put_rounds(&(bb_entry){.table = layout->table, .row = layout->row},
                          BB_F_BUILD_LAYOUTS_MS, &rounds);
    }
}

#endif
