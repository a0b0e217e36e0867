/* Tables of results compared and kept in the history, whatever command made them. */
#include "framework/compare/cell_set.h"
#include "framework/compare/history.h"
#include "tests/slice_table.h"

#include <sys/stat.h>

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
    expect(1, "compare a.json failed.json", " status  ok      failed ");
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

/* A command that writes a table, and the name of its file. */
static const struct {
    const char *name, *arguments, *file;
} commands[] = {
    {"animate",
     "animate --scene twist:n=100,frames=3 --builder lbvh,lbvh+refit --rays primary "
     "--size 8x8 --repeats 1",
     "animate"},
    {"slice", "slice --scene tets:side=2 --builder lbvh --size 8x8 --slices 2 --repeats 1",
     "slice"},
    {"overlap", "overlap tets:side=2 tets:side=2 --builder lbvh --repeats 1", "overlap"},
    {"volume", "volume --scene nbody:n=8 --builder vlbvh --size 8x8 --repeats 1 --brief", "volume"},
    {"stress", "stress --axis nan --builder lbvh --quick --no-pictures", "stress"},
    {"advise",
     "advise --scene cube --builder lbvh --kernel stack --rays primary --count 1000 "
     "--quick --size 8x8 --charts no",
     "advise"},
    {"run",
     "run --scene cube --builder lbvh --kernel stack --rays primary --size 8x8 --repeats 1 "
     "--charts no --no-pictures",
     "results"},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

/* Plants one change in a copy of the command's file, in a folder of its own; returns the name of
 * the changed figure. */
static const char *plant_change(size_t command)
{
    static char name[32];
    char file[64], copy[64];
    snprintf(file, sizeof file, "%s/%s.json", commands[command].name, commands[command].file);
    snprintf(copy, sizeof copy, "changed/%s.json", commands[command].file);
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
    snprintf(name, sizeof name, "%s", changed->string);
    char *text = cJSON_PrintUnformatted(table);
    write_file(copy, text, strlen(text));
    cJSON_free(text);
    cJSON_Delete(table);
    return name;
}

static uint32_t lines_of(const char *text)
{
    uint32_t lines = 0;
    for (; *text != '\0'; text++)
        lines += *text == '\n';
    return lines;
}

/* The rounds of all times in the file. */
static uint32_t rounds_of(const char *path)
{
    uint32_t rounds = 0;
    cJSON *json = read_json(path);
    const cJSON *row, *value;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(json, "rows")) cJSON_ArrayForEach(value, row)
        rounds += cJSON_IsArray(value) ? (uint32_t)cJSON_GetArraySize(value) : 0;
    cJSON_Delete(json);
    return rounds;
}

/* Merged with its changed copy, a file has the rows of both, and the second run is numbered. */
static void expect_merged(size_t command)
{
    char arguments[512], file[64];
    const char *name = commands[command].name, *base = commands[command].file;
    snprintf(arguments, sizeof arguments,
             "merge %s/%s.json changed/%s.json --out m-%s --history both.db", name, base, base,
             name);
    expect(0, arguments, "results  m-");
    snprintf(file, sizeof file, "m-%s/%s.json", name, base);
    cJSON *one = read_json(file), *row;
    int runs[2] = {0}, others = 0;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(one, "rows"))
    {
        const cJSON *run = cJSON_GetObjectItem(row, "run");
        others += run != NULL && strcmp(cJSON_GetStringValue(run), "1") != 0;
        runs[run != NULL]++;
    }
    cJSON_Delete(one);
    assert_int_equal(others, 0);
    assert_true(strcmp(name, "run") == 0 ? runs[1] > 1 : runs[0] == runs[1]);
    snprintf(arguments, sizeof arguments, "compare %s %s", file, file);
    expect(0, arguments, "nothing is worse");
    snprintf(arguments, sizeof arguments, "compare %s/%s.json %s", name, base, file);
    expect(0, arguments, "nothing is worse"); /* the first run is as it was */
    snprintf(arguments, sizeof arguments, "report %s --csv", file);
    expect(0, arguments, "run");
    snprintf(arguments, sizeof arguments, "report %s --samples", file);
    const outcome *o = expect(0, arguments, ",figure,unit,round,value\r\n");
    assert_int_equal(lines_of(o->out), 1 + rounds_of(file));
    static const char *const forms[] = {"table", "markdown"};
    for (int form = 0; form < 2; form++) {
        snprintf(arguments, sizeof arguments, "report %s --%s", file, forms[form]);
        expect(0, arguments, strcmp(name, "run") == 0 ? "lbvh" : "Run 2");
    }
    snprintf(arguments, sizeof arguments, "report %s --charts no --out page.html", file);
    expect(0, arguments, "");
}

/* Whether the published schema takes the file, once jq has changed it. */
static bool fits_schema(const char *file, const char *change)
{
    char arguments[1024];
    snprintf(arguments, sizeof arguments,
             "-e -L " BB_TEST_SOURCE_DIR "/tests --slurpfile schema " BB_TEST_SOURCE_DIR
             "/framework/table/table.schema.json 'include \"schema\"; %s | fits($schema[0])' %s",
             change, file);
    const outcome *o = run_program("", "jq", arguments);
    if (o->exit_status > 1 || o->err[0] != '\0')
        fail_msg("%s: jq, exit %d: %s", file, o->exit_status, o->err);
    return o->exit_status == 0;
}

static void the_schema_refuses_what_is_no_table(void)
{
    static const char *const changes[] = {".more = 1",
                                          "del(.command)",
                                          ".command = \"A b\"",
                                          ".schema = \"bvhbench-table/2\"",
                                          ".columns[0].kind = \"other\"",
                                          ".columns[0].decimals = 1.5",
                                          ".columns[0].more = 1",
                                          ".rows[0] = [1]",
                                          ".rows[0].scene = \"\"",
                                          ".rows[0].x = null",
                                          ".rows[0].x = []",
                                          ".rows[0].x = [1, \"a\"]",
                                          ".rows[0].x = [range(257)]"};
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++)
        if (fits_schema("run/results.json", changes[i]))
            fail_msg("the schema takes %s", changes[i]);
}

/* Every command that writes a table appends it, at once or later; what it wrote is as the schema
 * says, compares with itself, and a change of it is found. */
static void commands_write_what_is_compared(void **state)
{
    (void)state;
    char arguments[512];
    snprintf(arguments, sizeof arguments, "%s/changed", folder);
    assert_int_equal(mkdir(arguments, 0777), 0);
    for (size_t i = 0; i < COMMANDS; i++) {
        char file[64];
        snprintf(file, sizeof file, "%s/%s.json", commands[i].name, commands[i].file);
        snprintf(arguments, sizeof arguments, "%s --quiet --out %s --history all.db",
                 commands[i].arguments, commands[i].name);
        expect(0, arguments, "");
        assert_true(fits_schema(file, "."));
        snprintf(arguments, sizeof arguments, "compare %s %s", file, file);
        expect(0, arguments, "nothing is worse");
        const char *changed = plant_change(i);
        snprintf(arguments, sizeof arguments, "compare %s changed/%s.json", file, commands[i].file);
        const outcome *o = run(arguments);
        if (strstr(o->out, changed) == NULL)
            fail_msg("%s: a changed %s is not found: %s%s", commands[i].name, changed, o->out,
                     o->err);
        snprintf(arguments, sizeof arguments, "merge %s --history later.db", file);
        expect(0, arguments, "");
        expect_merged(i);
    }
    the_schema_refuses_what_is_no_table();
    expect(0, "report --history all.db --out all.html", "Z     7  ");
    expect(0, "report --history later.db --out later.html", "Z     7  ");
    expect(0, "report --history both.db --out both.html", "Z    14  ");
    refuses("", "merge slice/slice.json overlap/overlap.json --out m",
            "overlap/overlap.json: it is a table of `overlap`, slice/slice.json one of `slice`");
    refuses("", "merge run slice/slice.json --out m", "it is a table of `slice`, run one of `run`");
    refuses("", "merge slice/slice.json", "--out DIR says");
    refuses("", "report slice/slice.json changed/slice.json", "merge several");
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
