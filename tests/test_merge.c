/* What merge refuses, keeps and appends. */
#include "tests/report_sample.h"
#include "tests/slice_table.h"

#include <sys/stat.h>

/* Merging refuses what would mix devices or geometries, and runs that are no numbers. */
static void what_cannot_be_merged_is_refused(void **state)
{
    (void)state;
    change c = none;
    write_table("a.json", none);
    c.device = "another card";
    write_table("device.json", c);
    refuses("", "merge a.json device.json --out m --history none.db", "measured on another card");
    c = none;
    c.hash = "fedcba9876543210";
    write_table("scene.json", c);
    refuses("", "merge a.json scene.json --out m --history none.db", "other geometry");
    bb_table *table = make_table(none);
    char path[600];
    bb_table_row(table, (bb_cell){{[BB_RUN] = "x"}});
    snprintf(path, sizeof path, "%s/numbers.json", folder);
    ASSERT_OK(bb_table_write(table, path));
    bb_table_free(table);
    refuses("", "merge a.json numbers.json --out m --history none.db", "the run 'x' is no number");
    refuses("", "report --history none.db", "none.db"); /* nothing was appended */
}

/* Figures of one name must be the same: ms and s in one column would be nonsense. */
static void columns_that_differ_are_refused(void **state)
{
    (void)state;
    static const struct {
        bb_column column;
        const char *words;
    } cases[] = {
        {COLUMN("more", "more", "ms", NUMBER, EXACT, LESS), NULL},
        {COLUMN("more", "more", "s", NUMBER, EXACT, LESS), "it has two units"},
        {COLUMN("more", "more", "ms", NUMBER, TIMED, LESS), "it is exact in one"},
        {COLUMN("more", "more", "ms", NUMBER, EXACT, MORE), "it has two senses of better"},
        {COLUMN("more", "more", "ms", TEXT, EXACT, LESS), "it is of two kinds"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char path[600], arguments[128];
        bb_table *table = make_table(none);
        const uint32_t row = bb_table_find(table, (bb_cell){{[BB_SCENE] = "tets"}});
        if (cases[i].column.kind == BB_COLUMN_TEXT)
            bb_table_set_text(table, row, &cases[i].column, "1");
        else
            bb_table_set_number(table, row, &cases[i].column, 1);
        snprintf(path, sizeof path, "%s/column%zu.json", folder, i);
        ASSERT_OK(bb_table_write(table, path));
        bb_table_free(table);
        snprintf(arguments, sizeof arguments, "merge column0.json column%zu.json --out columns", i);
        if (i > 0)
            refuses("", arguments, cases[i].words);
    }
    write_table("column.json", none); /* has none of that name */
    expect(0, "merge column.json column0.json --out columns", "");
}

/* Pictures of one name are both kept. */
static void pictures_of_both_runs_are_kept(void **state)
{
    (void)state;
    static const bb_column picture = COLUMN("picture", "picture", "", TEXT, EXACT, NEITHER);
    char path[600], text[64];
    for (int i = 0; i < 2; i++) {
        bb_table *table = make_table(none);
        snprintf(path, sizeof path, "%s/p%d", folder, i);
        assert_int_equal(mkdir(path, 0777), 0);
        bb_table_set_text(table, bb_table_find(table, (bb_cell){{[BB_SCENE] = "tets"}}), &picture,
                          "a.png");
        snprintf(path, sizeof path, "%s/p%d/slice.json", folder, i);
        ASSERT_OK(bb_table_write(table, path));
        bb_table_free(table);
        snprintf(text, sizeof text, "p%d/a.png", i);
        write_file(text, i == 0 ? "one" : "two", 3);
    }
    expect(0, "merge p0/slice.json p1/slice.json --out pm", "");
    read_file("pm/a.png", text, sizeof text);
    assert_string_equal(text, "one");
    read_file("pm/2-a.png", text, sizeof text);
    assert_string_equal(text, "two");
}

/* ---- the folder ---- */

static void make_sub_folder(const char *name)
{
    char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(mkdir(path, 0777), 0);
}

/* The results of a run in a folder of that name, with a file for one of its pictures. */
static void write_run(const char *name, const char *picture)
{
    char path[600], file[64];
    make_sub_folder(name);
    bb_results *results = sample_results(NULL);
    snprintf(path, sizeof path, "%s/%s/results.json", folder, name);
    ASSERT_OK(bb_results_write(results, path));
    bb_results_destroy(results);
    snprintf(file, sizeof file, "%s/heat.png", name); /* which the sample names */
    write_file(file, picture, strlen(picture));
}

static void the_folder_of_an_input_is_refused(void **state)
{
    (void)state;
    static char before[1 << 20], after[1 << 20];
    char path[600];
    make_sub_folder("in");
    write_table("in/slice.json", none);
    write_table("beside.json", none);
    read_file("in/slice.json", before, sizeof before);
    snprintf(path, sizeof path, "%s/link", folder);
    assert_int_equal(symlink("in", path), 0);
    refuses("", "merge in/slice.json beside.json --out in",
            "merge: in/slice.json lies in in, where the merged run would go: name another folder");
    refuses("", "merge beside.json in/slice.json --out link/", "lies in link/");
    refuses("", "merge beside.json --out .", "beside.json lies in .");
    read_file("in/slice.json", after, sizeof after);
    assert_string_equal(before, after);
    write_run("whole", "");
    refuses("", "merge whole --out whole", "whole/results.json lies in whole");
}

/* What an earlier merge left is moved, of whatever command. */
static void earlier_results_are_kept(void **state)
{
    (void)state;
    static const char *const inputs[][2] = {{"once.json", "slice"}, {"r0", "results"}};
    static char before[4 << 20], after[4 << 20];
    write_table("once.json", none);
    write_run("r0", "");
    for (int i = 0; i < 2; i++) {
        char text[128], file[256];
        snprintf(text, sizeof text, "merge %s --out kept", inputs[i][0]);
        assert_null(strstr(expect(0, text, "")->err, "moved"));
        snprintf(file, sizeof file, "kept/%s.json", inputs[i][1]);
        read_file(file, before, sizeof before);
        const char *place = strstr(expect(0, text, "")->err, " to kept/earlier/");
        assert_non_null(place);
        snprintf(file, sizeof file, "%.*s/%s.json", (int)strcspn(place + 4, "\n"), place + 4,
                 inputs[i][1]);
        read_file(file, after, sizeof after);
        assert_string_equal(before, after);
    }
}

/* Of runs, pictures are called after scenes: both runs have the same. */
static void the_first_runs_picture_stays(void **state)
{
    (void)state;
    char text[64];
    write_run("r1", "one");
    write_run("r2", "two");
    expect(0, "merge r1 r2 --out rm", "");
    read_file("rm/heat.png", text, sizeof text);
    assert_string_equal(text, "one");
}

/* A table may call any file its picture. */
static void only_pictures_are_copied(void **state)
{
    (void)state;
    static const char *const names[] = {"notes.txt", "notes", ".png", "a.png"};
    static const bb_column picture = COLUMN("picture", "picture", "", TEXT, EXACT, NEITHER);
    make_sub_folder("files");
    for (int i = 0; i < 4; i++) {
        char path[600], file[64];
        bb_table *table = make_table(none);
        bb_table_set_text(table, bb_table_find(table, (bb_cell){{[BB_SCENE] = "tets"}}), &picture,
                          names[i]);
        snprintf(path, sizeof path, "%s/files/slice.json", folder);
        ASSERT_OK(bb_table_write(table, path));
        bb_table_free(table);
        snprintf(file, sizeof file, "files/%s", names[i]);
        write_file(file, "mine", 4);
        expect(0, "merge files/slice.json --out copied", "");
        snprintf(path, sizeof path, "grep -qsx mine 'copied/%s' '#'", names[i]);
        const int found = run_program("", path, "")->exit_status;
        if ((found == 0) != (i == 3))
            fail_msg("%s: copied %d", names[i], found == 0);
    }
}

/* ---- the history ---- */

/* If one part cannot be appended, none is. */
static void all_parts_are_appended_or_none(void **state)
{
    (void)state;
    static char long_name[BB_CELL_KEY + 1];
    char path[600];
    memset(long_name, 'x', BB_CELL_KEY);
    bb_table *table = make_table(none);
    const uint32_t row = bb_table_row(table, (bb_cell){{[BB_SCENE] = long_name}});
    bb_table_set_number(table, row, &nodes, 1);
    snprintf(path, sizeof path, "%s/long.json", folder);
    ASSERT_OK(bb_table_write(table, path));
    bb_table_free(table);
    write_table("short.json", none);
    write_table("beside.json", none);
    expect(0, "merge short.json --history parts.db", "");
    refuses("", "merge short.json long.json --history parts.db", "its key has more than");
    expect(0, "report --history parts.db --out parts.html", "Z     1  ");
    expect(0, "merge short.json beside.json --history parts.db", "");
    expect(0, "report --history parts.db --out parts.html", "Z     3  ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_cannot_be_merged_is_refused),
        cmocka_unit_test(columns_that_differ_are_refused),
        cmocka_unit_test(pictures_of_both_runs_are_kept),
        cmocka_unit_test(the_folder_of_an_input_is_refused),
        cmocka_unit_test(earlier_results_are_kept),
        cmocka_unit_test(the_first_runs_picture_stays),
        cmocka_unit_test(only_pictures_are_copied),
        cmocka_unit_test(all_parts_are_appended_or_none),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
