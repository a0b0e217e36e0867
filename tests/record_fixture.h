/* What the tests of records share: results as JSON to look at, their rows to change, and a path for
 * their file. */
#ifndef BB_RECORD_FIXTURE_H
#define BB_RECORD_FIXTURE_H

#include "tests/fixture.h"
#include "tests/report_sample.h"

#include "framework/record/record_private.h"
#include "tests/document.h"

#include <unistd.h>

/* A section of the results as they are now. */
static inline cJSON *section(const bb_results *results, const char *name)
{
    cJSON *array = cJSON_GetObjectItemCaseSensitive(document_of(results), name);
    assert_true(cJSON_IsArray(array));
    return array;
}

/* The entry of that index, for bb_put_number(), bb_put_text() ... */
static inline bb_entry *entry_at(bb_results *results, bb_section_id section, int index)
{
    bb_entry *entry = results->sections[section].first;
    while (entry != NULL && index-- > 0)
        entry = entry->next;
    assert_non_null(entry);
    return entry;
}

static inline bool is_kept(void *left_out, const bb_table *to, const bb_table *from, uint32_t row,
                           bb_target *target)
{
    (void)to;
    (void)from;
    (void)target;
    return !((const bool *)left_out)[row];
}

/* Leaves out the rows for which left_out[row] is true. Entries must be found anew. */
static inline void leave_out(bb_results *results, const bool *left_out)
{
    bb_results *rest;
    assert_int_equal(bb_results_make(&rest), BB_OK);
    assert_int_equal(bb_results_copy(rest, results, is_kept, (void *)left_out), BB_OK);
    assert_int_equal(bb_results_add_steps(rest, results), BB_OK);
    if (isfinite(bb_results_time_ms(results, "total")))
        assert_int_equal(bb_results_set_total(rest, bb_results_time_ms(results, "build"),
                                              bb_results_time_ms(results, "trace"),
                                              bb_results_time_ms(results, "total")),
                         BB_OK);
    bb_results_replace(results, rest);
}

/* Leaves out an entry with its parts. A build must have no traces. */
static inline void leave_out_entry(bb_results *results, const bb_entry *entry)
{
    bool *out = calloc(bb_table_row_count(results->table), sizeof *out);
    assert_non_null(out);
    out[entry->row] = true;
    for (const bb_entry *part = entry->parts.first; part != NULL; part = part->next)
        out[part->row] = true;
    leave_out(results, out);
    free(out);
}

static inline cJSON *member(const cJSON *object, const char *name)
{
    cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (item == NULL)
        fail_msg("no member %s", name);
    return item;
}

/* Of a file that is not there yet. */
static inline const char *results_path(const char *test)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/results.json", sample_folder(test));
    unlink(path);
    return path;
}

#endif
