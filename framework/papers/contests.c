/* What a contest measured, as rows of a paper's table. */
#include "framework/papers/contests.h"

static const bb_column build_ms = BB_FOUND_ROUNDS("build_ms", "Building the tree."),
                       layout_ms = BB_FOUND_ROUNDS("layout_ms", "Making the layout."),
                       answer_ms = BB_FOUND_ROUNDS("answer_ms", "All answers."),
                       phase_ms = BB_FOUND_ROUNDS("phase_ms", "A phase of the build."),
                       nodes = BB_FOUND_NUMBER("nodes", "Nodes of the tree."),
                       references = BB_FOUND_NUMBER("references", "References in its leaves."),
                       bytes = BB_FOUND_NUMBER("bytes", "Bytes of the tree."),
                       visits = BB_FOUND_NUMBER("visits", "Nodes visited for an item."),
                       work = BB_FOUND_NUMBER("work", "Primitives tested, or samples, of an item."),
                       differ = BB_FOUND_NUMBER("differ",
                                                "Items whose answers differ from the first way's.");

static void add_way(bb_table *table, bb_cell cell, const bb_contest_way *way)
{
    const uint32_t row = bb_table_row(table, cell);
    bb_table_set_rounds(table, row, &build_ms, &way->build);
    bb_table_set_rounds(table, row, &layout_ms, &way->layout);
    bb_table_set_rounds(table, row, &answer_ms, &way->answer);
    bb_table_set_number(table, row, &nodes, way->nodes);
    bb_table_set_number(table, row, &references, way->references);
    bb_table_set_number(table, row, &bytes, (double)way->tree_bytes);
    bb_table_set_number(table, row, &visits, way->visits);
    bb_table_set_number(table, row, &work, way->work);
    bb_table_set_number(table, row, &differ, (double)way->differ);
    for (uint32_t p = 0; p < way->phase_count; p++) {
        cell.names[BB_MAKER] = way->phases[p].name;
        bb_table_set_rounds(table, bb_table_row(table, cell), &phase_ms, &way->phases[p].ms);
    }
}

bool bb_paper_add_ways(bb_table *table, const char *scene, const char *task,
                       const bb_contest_way *ways, uint32_t count)
{
    bool wrong = false;
    for (uint32_t w = 0; w < count; w++) {
        const bool tree = ways[w].builder[0] != '\0';
        const bb_cell cell = {{[BB_SCENE] = scene,
                               [BB_QUESTION] = task,
                               [BB_BUILDER] = tree ? ways[w].builder : BB_NO_TREE,
                               [BB_INTERSECTOR] = tree ? ways[w].search : BB_NO_TREE}};
        wrong = wrong || ways[w].differ > 0;
        if (ways[w].refused[0] == '\0')
            add_way(table, cell, &ways[w]);
    }
    return wrong;
}
