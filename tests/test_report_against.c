/* Two runs side by side on one page, from outside.
 *
 *   test_report_against --write FOLDER      writes against.html, which is looked at in a browser
 */
#include "tests/compare_edits.h"
#include "tests/program_fixture.h"

#include <math.h>
#include <sys/stat.h>

static void edit_both(bb_results *results)
{
    edit_slower(results);
    edit_sah(results);
}

/* Other scenes' cells. */
static void edit_keys(bb_results *results)
{
    for (int section = BB_BUILDS; section <= BB_TRACES; section++)
        for (bb_entry *e = results->sections[section].first; e != NULL; e = e->next) {
            const bb_field_id cell = section == BB_BUILDS ? BB_F_BUILD_CELL : BB_F_TRACE_CELL;
            char key[BB_CELL_KEY + 8];
            snprintf(key, sizeof key, "scene=other-%s", bb_get_text(e, cell) + strlen("scene="));
            bb_put_text(e, cell, key);
        }
}

/* The data of the page's part, for cJSON_Delete(). */
static cJSON *against_of(const char *page)
{
    static char text[1 << 23];
    static const char begin[] = "id=\"against-data\">";
    read_file(page, text, sizeof text);
    const char *at = strstr(text, begin);
    assert_non_null(at);
    cJSON *json = cJSON_ParseWithOpts(at + strlen(begin), NULL, false);
    assert_non_null(json);
    return json;
}

static double number(const cJSON *row, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(row, name);
    return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

static const char *text(const cJSON *row, const char *name)
{
    return cJSON_GetStringValue(cJSON_GetObjectItem(row, name));
}

/* Each cell of both has both figures and their ratio; the verdicts are those of `compare`. */
static void both_figures_and_their_ratio(void **state)
{
    (void)state;
    uint32_t worse = 0, sah = 0, times = 0;
    const cJSON *row;
    write_run(folder, "old.json", edit_nothing, 1);
    write_run(folder, "new.json", edit_both, 2);
    expect(1, "compare old.json new.json", "2 figures are worse");
    expect(0, "report --against old.json new.json --out page.html", "2 figures are worse");
    cJSON *json = against_of("page.html");
    assert_int_equal(number(json, "worse"), 2);
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(json, "rows"))
    {
        const bool is_worse = strcmp(text(row, "verdict"), "worse") == 0;
        const bool timed = isfinite(number(row, "low"));
        worse += is_worse;
        times += timed;
        sah += strcmp(text(row, "figure"), "sah") == 0;
        assert_true(fabs(number(row, "ratio") - number(row, "new") / number(row, "old")) < 1e-3);
        if (timed) {
            assert_true(number(row, "low") <= number(row, "ratio"));
            assert_true(is_worse == (number(row, "ratio") > 1.2));
        }
    }
    assert_int_equal(worse, 2);
    assert_int_equal(sah, 1);
    assert_true(times > 100);
    cJSON_Delete(json);
    expect(0, "report old.json new.json --out merged.html --charts no", "merged.html");
    json = against_of("merged.html"); /* as before: one report of both */
    assert_true(cJSON_IsNull(json));
    cJSON_Delete(json);
}

static void what_is_no_two_runs_is_refused(void **state)
{
    (void)state;
    struct stat info;
    char path[600];
    write_run(folder, "a.json", edit_nothing, 1);
    write_run(folder, "b.json", edit_nothing, 2);
    write_run(folder, "c.json", edit_keys, 3);
    snprintf(path, sizeof path, "%s/none.html", folder);
    refuses("", "report --against --out none.html", "--against compares two runs, not 0: give OLD");
    refuses("", "report --against a.json --out none.html", "two runs, not 1");
    refuses("", "report --against a.json b.json c.json --out none.html", "two runs, not 3");
    refuses("", "report --against a.json a.json --out none.html", "is given twice");
    refuses("", "report --against a.json c.json --out none.html", "have no cell in common");
    refuses("", "report --against --table a.json b.json --out none.html", "--table");
    assert_int_not_equal(stat(path, &info), 0);
    expect(0, "report --against a.json b.json", "nothing is worse");
    snprintf(path, sizeof path, "%s/against.html", folder);
    assert_int_equal(stat(path, &info), 0);
}

static int write_page(const char *to)
{
    char arguments[1024];
    make_folder(NULL);
    write_run(folder, "old.json", edit_nothing, 1);
    write_run(folder, "new.json", edit_both, 2);
    snprintf(arguments, sizeof arguments,
             "report --against old.json new.json --out %s/against.html", to);
    const int status = run(arguments)->exit_status;
    remove_folder(NULL);
    return status;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_page(argv[2]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_figures_and_their_ratio),
        cmocka_unit_test(what_is_no_two_runs_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
