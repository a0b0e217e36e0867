/* Joins the shards of one run. Unlike merging (record_merge.c), runs are not numbered. If one shard
 * measured a build and others only needed it, the measured one stays.
 */
#include "framework/record/record_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- whether they are shards of one run ---- */

static bb_status check_contexts(const bb_entry *a, const bb_entry *b)
{
    static const bb_field_id alike[] = {
        BB_F_CONTEXT_REVISION, BB_F_CONTEXT_VERSION, BB_F_CONTEXT_CPU,
        BB_F_CONTEXT_DEVICE,   BB_F_CONTEXT_DRIVER,  BB_F_CONTEXT_FLAGS,
        BB_F_CONTEXT_KERNELS,  BB_F_CONTEXT_SEED,    BB_F_CONTEXT_EMBREE};
    for (size_t i = 0; i < sizeof alike / sizeof alike[0]; i++)
        if (!bb_same_text(a, b, alike[i]))
            return bb_fail(BB_INVALID,
                           "shards of one run have the same %s, these have not (%.100s, %.100s): "
                           "bvhbench report makes one report of several runs",
                           bb_fields[alike[i]].name, bb_get_text(a, alike[i]),
                           bb_get_text(b, alike[i]));
    return BB_OK;
}

/* Checks that both shards are of the same request: else their parts would not make up the whole. */
static bb_status check_requests(const bb_entry *a, const bb_entry *b)
{
    if (bb_same_text(a, b, BB_F_CONTEXT_SHARD_OF))
        return BB_OK;
    return bb_fail(BB_INVALID, "shards of one run are made with the same options, these are not "
                               "(see \"command\" in the files): run them alike but for --shard and "
                               "--out");
}

/* Returns the entry of the same cell in `results`; NULL: there is none. */
static const bb_entry *same_cell(const bb_results *results, const bb_entry *entry)
{
    return bb_results_find(results, bb_table_cell(entry->table, entry->row));
}

static bb_status check_cells(const bb_results *a, const bb_results *b)
{
    bb_each(trace, bb_results_section(b, BB_TRACES))
    {
        if (same_cell(a, trace) != NULL)
            return bb_fail(BB_INVALID,
                           "cell %.400s is in two of the files: they are no shards of one run",
                           bb_get_text(trace, BB_F_TRACE_CELL));
    }
    bb_each(build, bb_results_section(b, BB_BUILDS))
    {
        const bb_entry *known = same_cell(a, build);
        if (known != NULL && !bb_get_true(build, BB_F_BUILD_UNMEASURED) &&
            !bb_get_true(known, BB_F_BUILD_UNMEASURED))
            return bb_fail(BB_INVALID,
                           "build %.400s was measured in two of the files: they are no shards of "
                           "one run",
                           bb_get_text(build, BB_F_BUILD_CELL));
    }
    return BB_OK;
}

/* ---- builds ---- */

/* Returns whether both builds gave the same tree: not all builders are deterministic. */
static bool same_tree(const bb_entry *a, const bb_entry *b)
{
    static const bb_field_id shape[] = {BB_F_TREE_NODES, BB_F_TREE_LEAVES, BB_F_TREE_REFS,
                                        BB_F_TREE_DEPTH};
    if (!bb_same_text(a, b, BB_F_BUILD_STATUS))
        return false;
    for (size_t i = 0; i < sizeof shape / sizeof shape[0]; i++) {
        double x = bb_get_number(a, shape[i]), y = bb_get_number(b, shape[i]);
        if (x != y && (x == x || y == y))
            return false;
    }
    return true;
}

/* ---- targets ---- */

/* Rows of one of the shards, of which the other shard is `other`. */
typedef struct joining {
    const bb_results *own, *other;
    bool is_first;   /* of two builds that nobody measured, the first stays */
    const char *run; /* of builds with another tree than the one that stays */
    bool traces;     /* these are copied, or all others */
} joining;

/* What becomes of a build. */
enum fate { STAYS, GOES, GETS_RUN };

static enum fate fate_of(const joining *j, const bb_entry *build)
{
    const bb_entry *known = same_cell(j->other, build);
    const bool measured = !bb_get_true(build, BB_F_BUILD_UNMEASURED);
    if (known == NULL || measured || (j->is_first && bb_get_true(known, BB_F_BUILD_UNMEASURED)))
        return STAYS;
    return same_tree(build, known) ? GOES : GETS_RUN;
}

static bool aim(void *user, const bb_table *to, const bb_table *from, uint32_t row,
                bb_target *target)
{
    const joining *j = user;
    (void)from;
    const char **names = target->cell.names;
    const bool made = names[BB_SCENE] != NULL && names[BB_BUILDER] != NULL;
    const bool trace = made && names[BB_QUESTION] != NULL;
    if (trace != j->traces)
        return false;
    if (!made)
        return bb_table_find(to, target->cell) == BB_NO_ROW; /* of both: that of the first */
    if (trace) {
        const bb_entry *build = j->own->entries[row]->build; /* NULL: a part of a trace */
        if (build != NULL && fate_of(j, build) == GETS_RUN)
            target->tree_run = j->run;
        return true;
    }
    const bb_cell build = {
        {[BB_RUN] = names[BB_RUN], [BB_SCENE] = names[BB_SCENE], [BB_BUILDER] = names[BB_BUILDER]}};
    const enum fate fate = fate_of(j, bb_results_find(j->own, build));
    if (fate == GETS_RUN)
        names[BB_RUN] = j->run;
    return fate != GOES;
}

/* ---- joining ---- */

/* Adds "2/8 on HOST, DATE" to the list of shards in `context`. */
static bb_status note_shard(bb_entry *context, const bb_entry *of)
{
    char *text;
    const char *known = bb_get_text(context, BB_F_CONTEXT_SHARDS);
    if (asprintf(&text, "%s%s%s on %s, %s", known, known[0] != '\0' ? "; " : "",
                 bb_get_text(of, BB_F_CONTEXT_SHARD), bb_get_text(of, BB_F_CONTEXT_HOST),
                 bb_get_text(of, BB_F_CONTEXT_DATE)) < 0)
        return bb_fail(BB_REFUSED, "no memory for results");
    bb_put_text(context, BB_F_CONTEXT_SHARDS, text);
    free(text);
    return BB_OK;
}

static bb_status join_contexts(bb_entry *context, const bb_entry *other)
{
    const double others = bb_get_number(other, BB_F_CONTEXT_OTHERS);
    const double own = bb_get_number(context, BB_F_CONTEXT_OTHERS);
    if (bb_get_text(context, BB_F_CONTEXT_SHARDS)[0] == '\0')
        BB_TRY(note_shard(context, context));
    BB_TRY(note_shard(context, other));
    if (bb_get_true(other, BB_F_CONTEXT_INTERRUPTED))
        bb_put_flag(context, BB_F_CONTEXT_INTERRUPTED, true);
    if (others > own)
        bb_put_number(context, BB_F_CONTEXT_OTHERS, others);
    for (bb_field_id f = BB_F_CONTEXT_SETS; f <= BB_F_CONTEXT_CELLS; f++)
        bb_put_number(context, f, bb_get_number(context, f) + bb_get_number(other, f));
    return BB_OK;
}

static bb_status join_rows(bb_results *sum, const bb_results *a, const bb_results *b)
{
    const uint32_t of_a = bb_table_runs(a->table), of_b = bb_table_runs(b->table);
    char run[16];
    bb_run_name(of_a > of_b ? of_a : of_b, run);
    for (int traces = 0; traces < 2; traces++) { /* behind their builds, which may be b's */
        joining j = {.own = a, .other = b, .is_first = true, .run = run, .traces = traces == 1};
        BB_TRY(bb_results_copy(sum, a, aim, &j));
        j.own = b;
        j.other = a;
        j.is_first = false;
        BB_TRY(bb_results_copy(sum, b, aim, &j));
    }
    BB_TRY(join_contexts(sum->context, b->context));
    BB_TRY(bb_results_add_steps(sum, a));
    BB_TRY(bb_results_add_steps(sum, b));
    return bb_results_add_totals(sum, a, b);
}

bb_status bb_results_join(bb_results *a, const bb_results *b)
{
    bb_results *sum;
    BB_TRY(check_contexts(a->context, b->context));
    BB_TRY(check_requests(a->context, b->context));
    BB_TRY(bb_tables_check_scenes(a->table, b->table));
    BB_TRY(check_cells(a, b));
    BB_TRY(bb_results_make(&sum));
    bb_status status = join_rows(sum, a, b);
    if (status == BB_OK)
        bb_results_replace(a, sum);
    else
        bb_results_destroy(sum);
    return status;
}

void bb_results_end_join(bb_results *results)
{
    bb_put_text(results->context, BB_F_CONTEXT_SHARD, "");
    bb_put_text(results->context, BB_F_CONTEXT_SHARD_OF, "");
}
