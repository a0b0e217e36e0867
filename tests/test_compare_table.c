/* Tables of results compared and kept in the history, whatever command made them. */
#include "framework/compare/cell_set.h"
#include "framework/device/run_row.h"
#include "framework/history/history.h"
#include "tests/program_fixture.h"

#include <math.h>

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

static bb_samples rounds_about(double ms)
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

static bb_table *make_table(change c)
{
    static const char *const builders[] = {"lbvh", "emc:bits=32/x"};
    bb_table *table;
    ASSERT_OK(bb_table_create("slice", &table));
    const uint32_t run = bb_run_row(table, NULL, 7, "bvhbench slice");
    bb_table_set_text(table, run, &bb_run_device, c.device != NULL ? c.device : "a card");
    bb_table_set_text(table, run, &bb_run_host, "here");
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

static void write_table(const char *name, change c)
{
    char path[600];
    bb_table *table = make_table(c);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    ASSERT_OK(bb_table_write(table, path));
    bb_table_free(table);
}

static void rows_become_cells(void **state)
{
    (void)state;
    bb_cell_set set;
    bb_table *table = make_table(none);
    ASSERT_OK(bb_cell_set_of_table(table, "it", &set));
    assert_int_equal(set.count, 2 * 3); /* the numbers, two times; a rate is no time */
    const bb_measured *search =
        bb_cell_set_find(&set, "command=slice/scene=tets/question=z/builder=emc:bits=32%2Fx/"
                               "intersector=skip/time=search_ms");
    assert_non_null(search);
    assert_string_equal(search->time, "search ms");
    assert_string_equal(search->status, "ok");
    assert_string_equal(search->scene_hash, "0123456789abcdef");
    assert_int_equal(search->ms.count, ROUNDS);
    const bb_measured *numbers =
        bb_cell_set_find(&set, "command=slice/scene=tets/question=z/builder=lbvh/intersector=skip");
    assert_non_null(numbers);
    assert_int_equal(numbers->figure_count, 3); /* without the time */
    assert_true(bb_measured_figure(numbers, "nodes") == 99);
    assert_int_equal(bb_measured_better(numbers, "found"), BB_BETTER_MORE);
    assert_string_equal(set.origin.device, "a card");
    assert_string_equal(set.origin.host, "here");
    assert_string_equal(set.origin.seed, "7");
    assert_true(set.origin.revision[0] != '\0' && set.origin.date[0] != '\0');
    bb_cell_set_free(&set);
    bb_table_free(table);
}

static void the_history_keeps_tables(void **state)
{
    (void)state;
    char path[600];
    bb_history *history;
    bb_history_entry entry;
    bb_cell_set wanted, kept;
    uint32_t others;
    bb_table *table = make_table(none);
    snprintf(path, sizeof path, "%s/tables.db", folder);
    remove(path);
    ASSERT_OK(bb_cell_set_of_table(table, "it", &wanted));
    ASSERT_OK(bb_history_open(path, true, &history));
    ASSERT_OK(bb_history_append(history, table));
    ASSERT_OK(bb_history_find(history, wanted.origin.revision, NULL, &entry, &others));
    ASSERT_OK(bb_history_set(history, &entry, &kept));
    assert_int_equal(kept.count, wanted.count);
    assert_string_equal(kept.origin.device, "a card");
    for (uint32_t i = 0; i < kept.count; i++) {
        const bb_measured *a = &wanted.cells[i], *b = &kept.cells[i];
        assert_string_equal(a->key, b->key);
        assert_string_equal(a->time, b->time);
        assert_string_equal(a->scene_hash, b->scene_hash);
        assert_int_equal(a->ms.count, b->ms.count);
        for (uint32_t k = 0; k < a->ms.count; k++)
            assert_true(a->ms.values[k] == b->ms.values[k]);
        assert_int_equal(a->figure_count, b->figure_count);
        for (uint32_t k = 0; k < a->figure_count; k++) {
            const char *name = a->figures[k].name;
            assert_true(a->figures[k].value == bb_measured_figure(b, name));
            assert_int_equal(a->figures[k].better, bb_measured_better(b, name));
        }
    }
    bb_cell_set_free(&kept);
    bb_cell_set_free(&wanted);
    bb_history_close(history);
    bb_table_free(table);
}

static void files_of_tables_are_compared(void **state)
{
    (void)state;
    change c = none;
    write_table("a.json", none);
    expect(0, "compare a.json a.json", "nothing is worse");
    c.search = 1.5;
    write_table("slow.json", c);
    expect(1, "compare a.json slow.json", "search ms");
    expect(0, "compare slow.json a.json", "better: 1");
    c = none;
    c.differ = 1;
    write_table("wrong.json", c);
    expect(1, "compare a.json wrong.json", "differ");
    expect(0, "compare wrong.json a.json", "better: 2");
    c = none;
    c.found = 4;
    write_table("lost.json", c);
    expect(1, "compare a.json lost.json", "found");
    expect(0, "compare lost.json a.json", "better: 2");
    c = none;
    c.nodes = 98;
    write_table("other.json", c);
    expect(0, "compare a.json other.json", "nodes");
    c = none;
    c.waited = 100;
    c.rate = 0.01;
    write_table("waited.json", c); /* what no interval bounds is not compared */
    expect(0, "compare a.json waited.json", "nothing is worse");
    c = none;
    c.status = "failed";
    write_table("failed.json", c);
    expect(1, "compare a.json failed.json", "ok -> failed");
    c = none;
    c.hash = "fedcba9876543210";
    write_table("scene.json", c);
    refuses("", "compare a.json scene.json", "nothing can be compared");
    c = none;
    c.device = "another card";
    write_table("device.json", c);
    refuses("", "compare a.json device.json", "another card");
}

/* Members of a file may stand in any order; a file that only speaks of tables is none. */
static void tables_are_told_from_results(void **state)
{
    (void)state;
    char path[600];
    const char *sorted = "{\"columns\": [], \"command\": \"slice\", \"rows\": [],\n"
                         " \"schema\" : \"bvhbench-table/1\"}";
    const char *other =
        "{\"schema\":\"other\",\"text\":\"\\\"schema\\\":\\\"bvhbench-table/1\\\"\"}";
    write_file("sorted.json", sorted, strlen(sorted));
    write_file("other.json", other, strlen(other));
    snprintf(path, sizeof path, "%s/sorted.json", folder);
    assert_true(bb_table_is_other(path, "run"));
    assert_false(bb_table_is_other(path, "slice"));
    snprintf(path, sizeof path, "%s/other.json", folder);
    assert_false(bb_table_is_other(path, "run"));
    assert_false(bb_table_is_other("/nowhere", "run"));
}

/* Every command that writes a table appends it, at once or later; what it wrote compares with
 * itself, and a change of it is found. */
static void commands_write_what_is_compared(void **state)
{
    (void)state;
    static const struct {
        const char *name, *arguments;
    } commands[] = {
        {"animate", "animate --scene twist:n=100,frames=3 --builder lbvh,lbvh+refit --rays primary "
                    "--size 8x8 --repeats 1"},
        {"slice", "slice --scene tets:side=2 --builder lbvh --size 8x8 --slices 2 --repeats 1"},
        {"overlap", "overlap tets:side=2 tets:side=2 --builder lbvh --repeats 1"},
        {"volume", "volume --scene nbody:n=8 --builder vlbvh --size 8x8 --repeats 1 --brief"},
        {"stress", "stress --axis nan --builder lbvh --quick --no-pictures"},
        {"advise", "advise --scene cube --builder lbvh --kernel stack --rays primary --count 1000 "
                   "--quick --size 8x8 --charts no"},
    };
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char arguments[512], file[64];
        snprintf(file, sizeof file, "%s/%s.json", commands[i].name, commands[i].name);
        snprintf(arguments, sizeof arguments, "%s --quiet --out %s --history all.db",
                 commands[i].arguments, commands[i].name);
        expect(0, arguments, "");
        snprintf(arguments, sizeof arguments, "compare %s %s", file, file);
        expect(0, arguments, "nothing is worse");
        cJSON *table = read_json(file), *row, *changed = NULL;
        cJSON_ArrayForEach(row, cJSON_GetObjectItem(table, "rows"))
        {
            const char *const figures[] = {"nodes", "tree_bytes", "checked", "bytes"};
            for (size_t f = 0; f < 4 && changed == NULL; f++)
                changed = cJSON_GetObjectItem(row, "revision") == NULL
                              ? cJSON_GetObjectItem(row, figures[f])
                              : NULL;
        }
        assert_non_null(changed);
        cJSON_SetNumberValue(changed, changed->valuedouble + 1);
        char *text = cJSON_PrintUnformatted(table);
        write_file("changed.json", text, strlen(text));
        snprintf(arguments, sizeof arguments, "compare %s changed.json", file);
        const outcome *o = run(arguments);
        if (strstr(o->out, changed->string) == NULL)
            fail_msg("%s: a changed %s is not found: %s%s", commands[i].name, changed->string,
                     o->out, o->err);
        cJSON_free(text);
        cJSON_Delete(table);
        snprintf(arguments, sizeof arguments, "merge %s --history later.db", file);
        expect(0, arguments, "");
        snprintf(arguments, sizeof arguments, "merge %s --out m", file);
        refuses("", arguments, "is a table, which has no shards");
    }
    expect(0, "report --history all.db --out all.html", "6 runs");
    expect(0, "report --history later.db --out later.html", "6 runs");
    refuses("", "slice --scene tets:side=2 --builder lbvh --quiet --history /nowhere/a.db",
            "/nowhere/a.db");
}

static void damaged_tables_are_refused(void **state)
{
    (void)state;
    write_file("damaged.json", "{\"schema\":\"bvhbench-table/1\",", 29);
    refuses("", "compare damaged.json damaged.json", "damaged.json");
    write_file("version.json", "{\"schema\":\"bvhbench-table/9\"}", 29);
    refuses("", "compare version.json version.json", "bvhbench-table/1");
    write_file("older.json", "{\"schema\":\"bvhbench-slice/1\"}", 29);
    refuses("", "compare older.json older.json", "bvhbench-slice/1");
    write_file("animate.json", "{\"schema\":\"bvhbench-animate/1\"}", 31);
    refuses("", "compare animate.json animate.json", "bvhbench-animate/1");
    refuses("", "report animate.json", "bvhbench-animate/1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_become_cells),
        cmocka_unit_test(the_history_keeps_tables),
        cmocka_unit_test(files_of_tables_are_compared),
        cmocka_unit_test(tables_are_told_from_results),
        cmocka_unit_test(commands_write_what_is_compared),
        cmocka_unit_test(damaged_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
