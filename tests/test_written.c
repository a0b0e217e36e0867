/* What programs leave behind is whole: where nobody reads their output, where names are no UTF-8,
 * where a plug-in sets a locale with decimal commas, where scenes have like names. On a device. */
#include "tests/program_fixture.h"

#include <dirent.h>
#include <sys/stat.h>

#define QUICK                                                                                      \
    "--builder lbvh --kernel stack --rays primary --repeats 1 --size 8x8 --charts no --quiet "

static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
static const char twice[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n";

/* ---- pipes ---- */

/* The status of a program whose output and errors go to a `reader` that is there first. */
static int read_by(const char *reader, const char *arguments)
{
    char before[256];
    snprintf(before, sizeof before,
             "bash -c '{ sleep 0.3; \"$@\" 2>&1; } | %s >/dev/null; exit ${PIPESTATUS[0]}' -",
             reader);
    return run_program(before, BB_TEST_BINARY, arguments)->exit_status;
}

static void nobody_reads_and_all_is_written(void **state)
{
    (void)state;
    assert_int_equal(read_by("head -c 40", "run --scene cube --builder lbvh,sah --rays primary "
                                           "--size 8x8 --charts no --table --out unread"),
                     141);
    cJSON *json = read_results("unread/results.json");
    assert_false(
        cJSON_IsTrue(cJSON_GetObjectItem(cJSON_GetObjectItem(json, "context"), "interrupted")));
    assert_true(cJSON_GetArraySize(cJSON_GetObjectItem(json, "traces")) >= 2);
    cJSON_Delete(json);
    static const char *const files[] = {"unread/report.html", "unread/tables.txt"};
    static char text[1 << 22];
    for (size_t i = 0; i < 2; i++)
        assert_true(read_file(files[i], text, sizeof text) > 500);
    assert_int_equal(read_by(":", "slice --scene tets:side=2 --repeats 1 --out unread"), 141);
    cJSON_Delete(read_json("unread/slice.json"));
    assert_int_equal(read_by(":", "list"), 141);
    assert_int_equal(read_by(":", "run --scene nowhere"), 2);
}

/* ---- names ---- */

static void expect_utf8(const char *file)
{
    char check[256];
    snprintf(check, sizeof check, "-f UTF-8 -t UTF-16 '%s'", file);
    const outcome *o = run_program("", "iconv -o /dev/null", check);
    if (o->exit_status != 0)
        fail_msg("%s: %s", file, o->err);
}

static void names_that_are_no_utf8_make_json(void **state)
{
    (void)state;
    static const char name[] = "a\xff\xc3.obj";
    static const char *const made[] = {"\xfe/results.json", "\xfe/report.html", "\xfe/slice.json",
                                       "\xfe/slice.html",   "\xfe/volume.json", "\xfe/volume.html"};
    write_file(name, triangle, sizeof triangle - 1);
    write_file("a\xfe\xc3.obj", twice, sizeof twice - 1);
    expect(0, "run --scene 'a\xff\xc3.obj' --scene 'a\xfe\xc3.obj' " QUICK "--out '\xfe'", "lbvh");
    expect(0, "slice --scene tets:side=2 --repeats 1 --out '\xfe'", "tetrahedra");
    static char raw[8 * 8 * 8];
    memset(raw + 100, 200, 100);
    write_file("v\xff.raw", raw, sizeof raw);
    expect(0,
           "volume --scene 'v\xff.raw:dims=8x8x8,type=uint8' --builder lbvh --kernel stack "
           "--steps none --size 8x8 --repeats 1 --out '\xfe'",
           "voxels");
    for (size_t i = 0; i < sizeof made / sizeof made[0]; i++)
        expect_utf8(made[i]);
    cJSON *json = read_results(made[0]);
    const cJSON *scene = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "scenes"), 0);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(scene, "name")), "a%FF%C3.obj");
    cJSON_Delete(json);
    expect(0, "report '\xfe' --charts no", "2 scenes,"); /* of like names, not of one */
}

/* ---- locales ---- */

static void a_locale_of_a_plugin_changes_no_number(void **state)
{
    (void)state;
    if (run_program("", "localedef", "-i de_DE -f UTF-8 ./de_DE.UTF-8")->exit_status != 0)
        skip(); /* no sources of locales (Debian: locales) */
    const outcome *o =
        run_with("LOCPATH=$PWD LC_ALL=de_DE.UTF-8",
                 "run --scene cube --plugin " BB_TEST_PLUGIN_DIR
                 "/rogue.so --builder rogue:term=locale,at=prepare,lbvh --kernel stack "
                 "--rays primary --size 8x8 --repeats 2 --charts no --out commas");
    if (o->exit_status != 1)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    bool found = false;
    static char text[1 << 22];
    read_file("commas/results.json", text, sizeof text);
    cJSON *json = read_results("commas/results.json");
    const cJSON *builds = cJSON_GetObjectItem(json, "builds"), *build;
    cJSON_ArrayForEach(build, builds)
    {
        double ms = cJSON_GetNumberValue(cJSON_GetObjectItem(build, "build_ms_median"));
        const char *reason = cJSON_GetStringValue(cJSON_GetObjectItem(build, "reason"));
        if (reason != NULL && strstr(reason, "rogue changed the locale in prepare()") != NULL) {
            found = true;
            continue;
        }
        assert_true(ms > 0 || cJSON_IsTrue(cJSON_GetObjectItem(build, "reference")));
    }
    assert_true(found);
    cJSON_Delete(json);
    expect(0, "report commas --csv", "cube,");
}

/* ---- pictures ---- */

static uint32_t count_pictures(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    DIR *entries = opendir(path);
    uint32_t count = 0;
    assert_non_null(entries);
    for (const struct dirent *e; (e = readdir(entries)) != NULL;)
        count += strstr(e->d_name, ".png") != NULL;
    closedir(entries);
    return count;
}

/* Each picture has a file of its own, and the page shows each once. */
static void expect_own_pictures(const char *name)
{
    char file[256];
    snprintf(file, sizeof file, "%s/results.json", name);
    cJSON *json = read_results(file);
    const cJSON *pictures = cJSON_GetObjectItem(json, "pictures"), *a, *b;
    assert_true(cJSON_GetArraySize(pictures) >= 4);
    assert_int_equal(count_pictures(name), cJSON_GetArraySize(pictures));
    cJSON_ArrayForEach(a, pictures) for (b = a->next; b != NULL; b = b->next)
        assert_string_not_equal(cJSON_GetStringValue(cJSON_GetObjectItem(a, "path")),
                                cJSON_GetStringValue(cJSON_GetObjectItem(b, "path")));
    cJSON_Delete(json);
}

static void scenes_of_like_names_have_pictures_of_their_own(void **state)
{
    (void)state;
    static const char *const lists[] = {"d1/x.obj,d2/x.obj", "a+b.obj,a-b.obj"};
    char command[512];
    assert_int_equal(run_program("", "mkdir", "d1 d2")->exit_status, 0);
    write_file("d1/x.obj", triangle, sizeof triangle - 1);
    write_file("d2/x.obj", twice, sizeof twice - 1);
    write_file("a+b.obj", triangle, sizeof triangle - 1);
    write_file("a-b.obj", twice, sizeof twice - 1);
    for (size_t i = 0; i < 2; i++) {
        snprintf(command, sizeof command, "run --scene %s " QUICK "--out both%zu", lists[i], i);
        expect(0, command, "lbvh");
        snprintf(command, sizeof command, "both%zu", i);
        expect_own_pictures(command);
        for (int shard = 1; shard <= 2; shard++) {
            snprintf(command, sizeof command, "run --shard %d/2 --scene %s " QUICK "--out s%zu/%d",
                     shard, lists[i], i, shard);
            expect(0, command, "");
        }
        snprintf(command, sizeof command, "merge s%zu/1 s%zu/2 --out m%zu", i, i, i);
        expect(0, command, "lbvh");
        snprintf(command, sizeof command, "m%zu", i);
        expect_own_pictures(command);
    }
    if (system("command -v gnuplot >/dev/null") != 0)
        skip();
    expect(0, "report both0 --out both0/charts.html --charts yes", "lbvh");
    expect(0, "report both1 --out both1/charts.html --charts yes", "lbvh");
    assert_int_equal(count_pictures("both0/charts-charts"), count_pictures("both1/charts-charts"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nobody_reads_and_all_is_written),
        cmocka_unit_test(names_that_are_no_utf8_make_json),
        cmocka_unit_test(a_locale_of_a_plugin_changes_no_number),
        cmocka_unit_test(scenes_of_like_names_have_pictures_of_their_own),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
