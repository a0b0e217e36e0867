/* Finds what a row is from the names that it has, and links it to the rows that it belongs to. */
#include "framework/record/record_private.h"

#include <stdlib.h>

const bb_field_part bb_section_parts[BB_SECTIONS] = {
    [BB_SCENES] = BB_IN_SCENE,     [BB_BUILDS] = BB_IN_BUILD,
    [BB_TRACES] = BB_IN_TRACE,     [BB_SKIPPED] = BB_IN_SKIPPED,
    [BB_PICTURES] = BB_IN_PICTURE, [BB_PREDICTIONS] = BB_IN_PREDICTION,
    [BB_PAPERS] = BB_IN_PAPER,     [BB_MERGED] = BB_IN_CONTEXT,
    [BB_STEPS] = BB_IN_STEP};

enum {
    SCENE = 1 << BB_SCENE,
    FRAME = 1 << BB_FRAME,
    QUESTION = 1 << BB_QUESTION,
    VIEW = 1 << BB_VIEW,
    BUILDER = 1 << BB_BUILDER,
    KERNEL = 1 << BB_KERNEL,
    MAKER = 1 << BB_MAKER,
    INTERSECTOR = 1 << BB_INTERSECTOR,
};

/* Sorts of rows: the names that each must have, and those that it may have besides a run. */
static const struct sort {
    unsigned must, may;
    bb_section_id section;
    bool is_part; /* of the row without its maker, and without these names */
    unsigned dropped;
} sorts[] = {
    {0, 0, BB_MERGED, false, 0},
    {MAKER, 0, BB_STEPS, false, 0},
    {SCENE, 0, BB_SCENES, false, 0},
    {SCENE | MAKER, 0, BB_SCENES, true, 0},
    {SCENE | VIEW, 0, BB_SCENES, true, VIEW},
    {SCENE | BUILDER, 0, BB_BUILDS, false, 0},
    {SCENE | BUILDER | MAKER, 0, BB_BUILDS, true, 0},
    {SCENE | QUESTION | BUILDER, VIEW | KERNEL | INTERSECTOR, BB_TRACES, false, 0},
    {SCENE | QUESTION | BUILDER | MAKER, VIEW | KERNEL | INTERSECTOR, BB_TRACES, true, 0},
    {SCENE | QUESTION, VIEW, BB_SKIPPED, false, 0},
    {FRAME, SCENE | VIEW, BB_PICTURES, false, 0},
    {QUESTION, 0, BB_PREDICTIONS, false, 0}, /* or a paper, which has a title */
    {QUESTION | MAKER, 0, BB_PAPERS, true, 0},
    {QUESTION | FRAME | MAKER, 0, BB_PAPERS, true, FRAME},
};

static const struct sort *sort_of(bb_cell cell)
{
    unsigned names = 0;
    for (int d = BB_RUN + 1; d < BB_DIMENSIONS; d++)
        names |= cell.names[d] != NULL ? 1u << d : 0;
    for (size_t i = 0; i < sizeof sorts / sizeof sorts[0]; i++)
        if ((names & sorts[i].must) == sorts[i].must &&
            (names & ~(sorts[i].must | sorts[i].may)) == 0)
            return &sorts[i];
    return NULL;
}

static void append(bb_section *section, bb_entry *entry)
{
    *(section->last != NULL ? &section->last->next : &section->first) = entry;
    section->last = entry;
    section->count++;
}

static bb_status missing(uint32_t row, const char *what, const char *name)
{
    return bb_fail(BB_INVALID, "rows[%u] names %s '%.100s', which is missing", row, what, name);
}

/* Links a part to its entry. */
static bb_status join_entry(bb_results *results, const struct sort *sort, bb_cell cell,
                            bb_entry *part)
{
    cell.names[BB_MAKER] = NULL;
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if ((sort->dropped & 1u << d) != 0)
            cell.names[d] = NULL;
    bb_entry *entry = bb_results_find(results, cell);
    if (entry == NULL)
        return bb_fail(BB_INVALID, "rows[%u] is part of a row that does not stand before it",
                       part->row);
    append(&entry->parts, part);
    return BB_OK;
}

/* Finds the rows that a build or a trace names. */
static bb_status find_named(bb_results *results, const struct sort *sort, bb_cell cell,
                            bb_entry *entry)
{
    const char *run =
        bb_table_get_text(results->table, entry->row, bb_fields[BB_F_TRACE_TREE_RUN].name);
    bb_cell build = {{[BB_RUN] = run[0] != '\0' ? run : cell.names[BB_RUN],
                      [BB_SCENE] = cell.names[BB_SCENE],
                      [BB_BUILDER] = cell.names[BB_BUILDER]}};
    if (sort->section != BB_BUILDS && sort->section != BB_TRACES)
        return BB_OK;
    if (bb_results_scene(results, cell.names[BB_SCENE]) == NULL)
        return missing(entry->row, "scene", cell.names[BB_SCENE]);
    if (sort->section == BB_TRACES) {
        entry->build = bb_results_find(results, build);
        if (entry->build == NULL)
            return missing(entry->row, "a build of", cell.names[BB_BUILDER]);
    }
    return BB_OK;
}

static bb_status put_in_place(bb_results *results, bb_entry *entry)
{
    const bb_cell cell = bb_table_cell(results->table, entry->row);
    const struct sort *sort = sort_of(cell);
    if (sort == NULL)
        return bb_fail(BB_INVALID, "rows[%u] has the names of no sort of row", entry->row);
    if (sort->is_part)
        return join_entry(results, sort, cell, entry);
    if (cell.names[BB_RUN] != NULL && (sort->section == BB_SCENES || sort->section == BB_STEPS))
        return bb_fail(BB_INVALID, "rows[%u] is of a run, but scenes and steps are of all runs",
                       entry->row);
    BB_TRY(find_named(results, sort, cell, entry));
    bb_section_id section = sort->section;
    if (section == BB_MERGED && cell.names[BB_RUN] == NULL) {
        results->context = entry;
        return BB_OK;
    }
    if (section == BB_PREDICTIONS && bb_get_text(entry, BB_F_PAPER_TITLE)[0] != '\0')
        section = BB_PAPERS;
    append(&results->sections[section], entry);
    return BB_OK;
}

static bool reserve(bb_results *results, uint32_t row)
{
    if (row >= results->entry_room) {
        const uint32_t room = 2 * (row + 8);
        bb_entry **larger = realloc(results->entries, room * sizeof *larger);
        if (larger == NULL)
            return false;
        results->entries = larger;
        results->entry_room = room;
    }
    while (results->entry_count <= row)
        results->entries[results->entry_count++] = NULL;
    return true;
}

bb_status bb_results_enter(bb_results *results, uint32_t row)
{
    if (row < results->entry_count && results->entries[row] != NULL)
        return BB_OK;
    bb_entry *entry = calloc(1, sizeof *entry);
    if (entry == NULL || !reserve(results, row)) {
        free(entry);
        return bb_fail(BB_REFUSED, "no memory for results");
    }
    entry->table = results->table;
    entry->row = row;
    bb_status status = put_in_place(results, entry);
    if (status == BB_OK)
        results->entries[row] = entry;
    else
        free(entry);
    return status;
}
