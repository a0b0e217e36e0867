/* A small table of `slice`, and the same with changes, for tests of what is made of tables. */
#ifndef BB_TEST_SLICE_TABLE_H
#define BB_TEST_SLICE_TABLE_H

#include "framework/device/run_row.h"
#include "tests/program_fixture.h"

#define COLUMN(name, heading, unit, kind, sense, better)                                           \
    {                                                                                              \
        name, heading, unit, "A figure.", BB_COLUMN_##kind, BB_SENSE_##sense, BB_BETTER_##better,  \
            -1                                                                                     \
    }
static const bb_column build_ms = COLUMN("build_ms", "build", "ms", ROUNDS, TIMED, LESS);
static const bb_column search_ms = COLUMN("search_ms", "search", "ms", ROUNDS, TIMED, LESS);
static const bb_column rate = COLUMN("rate", "rate", "1/s", ROUNDS, TIMED, MORE);
static const bb_column waited_ms = COLUMN("waited_ms", "waited", "ms", NUMBER, TIMED, LESS);
static const bb_column nodes = COLUMN("nodes", "nodes", "", NUMBER, EXACT, NEITHER);
static const bb_column differ = COLUMN("differ", "differ", "voxels", NUMBER, EXACT, LESS);
static const bb_column found = COLUMN("found", "found", "", NUMBER, EXACT, MORE);
static const bb_column scene_hash = COLUMN("hash", "hash", "", TEXT, EXACT, NEITHER);
static const bb_column status = COLUMN("status", "status", "", TEXT, EXACT, NEITHER);

enum { ROUNDS = 20 };

static inline bb_samples rounds_about(double ms)
{
    bb_samples samples = {0};
    for (int i = 0; i < ROUNDS; i++)
        bb_samples_add(&samples, ms * (1 + 0.001 * ((7 * i) % ROUNDS)));
    return samples;
}

/* How a table differs from the usual one. */
typedef struct change {
    double search, nodes, differ, found, waited, rate;
    const char *hash, *status, *device;
} change;

static const change none = {.search = 1, .found = 5, .nodes = 99, .waited = 1, .rate = 1};

static inline bb_table *make_table(change c)
{
    static const char *const builders[] = {"lbvh", "emc:bits=32/x"};
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    const uint32_t run = bb_run_row(table, NULL, 7, "bvhbench slice");
    bb_table_set_text(table, run, &bb_run_columns[BB_RUN_DEVICE],
                      c.device != NULL ? c.device : "a card");
    bb_table_set_text(table, run, &bb_run_columns[BB_RUN_HOST], "here");
    bb_table_set_number(table, run, &nodes, 1e6 * c.search); /* of no cell: it is not compared */
    const uint32_t scene = bb_table_row(table, (bb_cell){{[BB_SCENE] = "tets"}});
    bb_table_set_text(table, scene, &scene_hash, c.hash != NULL ? c.hash : "0123456789abcdef");
    for (int b = 0; b < 2; b++) {
        const bb_samples build = rounds_about(20), search = rounds_about(b == 0 ? 3 * c.search : 3),
                         speed = rounds_about(c.rate);
        const uint32_t row = bb_table_row(table, (bb_cell){{[BB_SCENE] = "tets",
                                                            [BB_QUESTION] = "z",
                                                            [BB_BUILDER] = builders[b],
                                                            [BB_INTERSECTOR] = "skip"}});
        bb_table_set_rounds(table, row, &build_ms, &build);
        bb_table_set_rounds(table, row, &search_ms, &search);
        bb_table_set_rounds(table, row, &rate, &speed);
        bb_table_set_number(table, row, &waited_ms, c.waited);
        bb_table_set_number(table, row, &nodes, c.nodes);
        bb_table_set_number(table, row, &differ, c.differ);
        bb_table_set_number(table, row, &found, c.found);
        bb_table_set_text(table, row, &status, b == 1 ? c.status : NULL);
    }
    ASSERT_OK(bb_table_status(table));
    return table;
}

static inline void write_table(const char *name, change c)
{
    char path[600];
    bb_table *table = make_table(c);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    ASSERT_OK(bb_table_write(table, path));
    bb_table_free(table);
}

#endif
