/* `bvhbench compare` from outside: files, revisions and programs. */
#include "tests/compare_edits.h"
#include "tests/program_fixture.h"

#include <sys/stat.h>

static void write_texts(bb_results *r)
{
    set_context(r, BB_F_CONTEXT_SHARD, "\033[2J\033]0;title\007");
}

/* Nor does it steer the terminal from within a message. */
static void messages_do_not_steer(void **state)
{
    (void)state;
    write_run(folder, "a.json", edit_nothing, 1);
    write_run(folder, "steer.json", write_texts, 1);
    const char *script = "#!/bin/sh\nprintf 'bvhbench: \\033[2J\\302\\233 broken\\n' >&2\nexit 2\n";
    char path[600];
    write_file("steers", script, strlen(script));
    snprintf(path, sizeof path, "%s/steers", folder);
    assert_int_equal(chmod(path, 0755), 0);
    static const char *const arguments[] = {"merge a.json steer.json --out m",
                                            "compare --run ./steers ./steers --quiet",
                                            "compare a.json $'\\033[2J'"};
    for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++) {
        const outcome *o = run(arguments[i]);
        assert_int_equal(o->exit_status, 2);
        assert_null(strchr(o->err, '\033'));
        assert_null(strstr(o->err, "\302\233"));
        assert_non_null(strstr(o->err, "bvhbench: "));
    }
    refuses("", "compare --run ./steers ./steers --quiet", "?[2J? broken");
    refuses("", "merge a.json steer.json --out m", "?[2J");
}

static void files_are_compared(void **state)
{
    (void)state;
    write_run(folder, "a.json", edit_nothing, 1);
    write_run(folder, "b.json", edit_nothing, 2);
    write_run(folder, "slow.json", edit_slower, 2);
    write_run(folder, "sah.json", edit_sah, 2);
    write_run(folder, "elsewhere.json", edit_all_scenes, 2);
    refuses("", "compare a.json elsewhere.json", "nothing can be compared");
    write_run(folder, "failed.json", edit_all_failed, 2);
    refuses("", "compare failed.json failed.json", "nothing can be compared");
    expect(1, "compare a.json failed.json", " status  ok      failed ");
    expect(0, "compare a.json b.json", "nothing is worse");
    expect(1, "compare a.json slow.json", "1 figures are worse");
    expect(0, "compare slow.json a.json", "better: 1");
    expect(1, "compare a.json sah.json --format github", " | sah | 97.3 | 99.25 | 1.020 |");
    expect(1, "compare a.json sah.json --format markdown", " | sah | 97.3 | 99.25 | 1.020 |");
    expect(1, "compare a.json slow.json --format junit", " failures=\"1\"");
    expect(0, "compare a.json b.json --format junit", " failures=\"0\"");
    expect(0, "compare a.json slow.json --threshold 60", "the 60.00 %: --threshold");
    expect(1, "compare a.json slow.json --threshold 40", "worse: 1");
    write_run(folder, "gone.json", edit_gone, 2);
    expect(1, "compare a.json gone.json", "1 cells are missing");
    expect(0, "compare gone.json a.json", "nothing is worse");
    write_run(folder, "many.json", edit_many_rounds, 1);
    expect(0, "compare many.json many.json --detect 900", "could have shown a slowing by");
    expect(1, "compare a.json slow.json --detect 1", "1 figures are worse");
    const outcome *o = run("compare a.json b.json --detect 1");
    if (o->exit_status != 2 || strstr(o->out, "nothing is worse") == NULL ||
        strstr(o->err, "times could not have shown 1 %: take") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    refuses("", "compare a.json b.json --detect -1", "--detect");
    refuses("", "compare a.json", "give two: result files");
    refuses("", "compare a.json b.json a.json", "give two");
    refuses("", "compare a.json nothing.json", "nothing.json");
    refuses("", "compare a.json b.json --format html", "must be text, github, markdown or junit");
    refuses("", "compare a.json b.json --threshold -1", "--threshold");
    refuses("", "compare a.json b.json --rounds 7", "--rounds needs --run");
    refuses("", "compare a.json b.json --history nowhere.db", "nowhere.db: cannot open it");
    write_file("cut.json", "{\"schema\": \"bvh", 15);
    refuses("", "compare a.json cut.json", "truncated");
}

/* As Google Benchmark's tools/compare.py reads it: rounds that count, by name. */
static void results_as_google_benchmark(void **state)
{
    (void)state;
    static const char *const texts[] = {"name", "run_name", "run_type", "time_unit"};
    static const char *const numbers[] = {"repetitions", "repetition_index", "iterations",
                                          "real_time",   "cpu_time",         "family_index",
                                          "threads"};
    write_run(folder, "a.json", edit_nothing, 1);
    const outcome *o =
        run_program("", "sh", "-c '" BB_TEST_PROGRAM " report a.json --google-benchmark >gb.json'");
    assert_int_equal(o->exit_status, 0);
    cJSON *json = read_json("gb.json"), *entry, *a = read_results("a.json"), *trace;
    cJSON *list = cJSON_GetObjectItem(json, "benchmarks");
    assert_true(cJSON_IsString(member(member(json, "context"), "host_name")));
    int rounds = 0;
    cJSON_ArrayForEach(entry, list)
    {
        for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
            assert_true(cJSON_IsString(member(entry, texts[i])));
        for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
            assert_true(cJSON_IsNumber(member(entry, numbers[i])));
        assert_string_equal(member(entry, "run_type")->valuestring, "iteration");
    }
    trace = cJSON_GetArrayItem(cJSON_GetObjectItem(a, "traces"), 5);
    cJSON_ArrayForEach(entry, list)
    {
        if (strcmp(member(entry, "name")->valuestring, member(trace, "cell")->valuestring) != 0)
            continue;
        double ms = cJSON_GetArrayItem(member(trace, "ms"), rounds + 1)->valuedouble;
        assert_int_equal(member(entry, "repetition_index")->valueint, rounds);
        assert_int_equal(member(entry, "repetitions")->valueint, 6);
        ASSERT_NEAR(member(entry, "real_time")->valuedouble, 1e6 * ms, 1e-3);
        rounds++;
    }
    assert_int_equal(rounds, 6); /* the first does not count */
    cJSON_Delete(json);
    cJSON_Delete(a);
}

static void revisions_are_compared(void **state)
{
    (void)state;
    char path[600];
    snprintf(path, sizeof path, "%s/bench.db", folder);
    history_fill(path);
    expect(0, "compare --history bench.db aaaa abab",
           "between runs of one revision in the history");
    expect(1, "compare --history bench.db abab cccc", "trace ms");
    expect(1, "compare --history bench.db cccc dddd", " sah ");
    /* eeee was measured in the south last, but both in the north */
    expect(0, "compare --history bench.db dddd eeee", "\nbetter: 1\n");
    expect(1, "compare --history bench.db eeee dddd", "\nworse: 1\n");
    refuses("", "compare --history bench.db a cccc", "write more of it");
    refuses("", "compare --history bench.db abab ffff", "has no revision 'ffff'");
    write_run(folder, "a.json", edit_nothing, 1);
    expect(0, "compare --history bench.db abab a.json", "in both");
    expect(0, "report --history bench.db --out history.html",
           "dddd444444444  2024-01-04T00:00:00Z     1    258      1       0          0        0\n");
    refuses("", "report --history bench.db a.json", "a report of its own");
    refuses("", "report --history bench.db --csv", "do not go together");
    refuses("", "report --history nowhere.db", "cannot open it");
}

static void a_page_never_replaces_its_database(void **state)
{
    (void)state;
    char path[600];
    static const char *const made[] = {"-c 'cp kept.db page.html'", "-c 'ln -s kept.db soft.db'",
                                       "-c 'ln kept.db hard.db'"};
    snprintf(path, sizeof path, "%s/kept.db", folder);
    history_fill(path);
    for (size_t i = 0; i < sizeof made / sizeof made[0]; i++)
        assert_int_equal(run_program("", "sh", made[i])->exit_status, 0);
    refuses("", "report --history page.html", "would overwrite the database");
    refuses("", "report --history kept.db --out kept.db", "would overwrite the database");
    refuses("", "report --history kept.db --out ./kept.db", "would overwrite the database");
    refuses("", "report --history kept.db --out hard.db", "would overwrite the database");
    refuses("", "report --history soft.db --out kept.db", "would overwrite the database");
    expect(0, "report --history kept.db --out other.html",
           "dddd444444444  2024-01-04T00:00:00Z     1    258      1       0          0        0\n");
    expect(0, "report --history page.html --out page2.html",
           "dddd444444444  2024-01-04T00:00:00Z     1    258      1       0          0        0\n");
}

/* Programs that run at once, or in a tenth of a second: they hand out a file. */
static void write_programs(void)
{
    static const char *const names[] = {"quick", "slow", "broken", "dead", "sleepy"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char script[2000], path[600];
        snprintf(script, sizeof script,
                 "#!/bin/sh\n[ \"$1\" = run ] || exit 2\n"
                 "while [ $# -gt 1 ]; do [ \"$1\" = --out ] && out=$2; shift; done\n"
                 "echo %s >>'%s/order'\n"
                 "mkdir -p \"$out\" && cp '%s/%s.json' \"$out/results.json\"\n%s",
                 names[i], folder, folder, i == 1 ? "slow" : "a",
                 i == 2   ? "echo 'bvhbench: it is broken' >&2; exit 2\n"
                 : i == 3 ? "kill -9 $$\n"
                 : i == 4 ? "sleep 0.1\n"
                          : "exit 1\n");
        write_file(names[i], script, strlen(script));
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        assert_int_equal(chmod(path, 0755), 0);
    }
}

static void programs_are_run_in_turns(void **state)
{
    (void)state;
    char order[4000], path[600];
    write_run(folder, "a.json", edit_nothing, 1);
    write_run(folder, "slow.json", edit_slower, 1);
    write_programs();
    expect(1, "compare --run ./quick ./slow --rounds 9 --history programs.db", "in pairs");
    /* 10 pairs, each of both, and not always in the same order */
    size_t size = read_file("order", order, sizeof order);
    assert_int_equal(size, 10 * strlen("quick\nslow\n"));
    uint32_t first = 0;
    for (int i = 0; i < 10; i++) {
        const char *pair = order + i * 11;
        bool quick = strncmp(pair, "quick\nslow\n", 11) == 0;
        assert_true(quick || strncmp(pair, "slow\nquick\n", 11) == 0);
        first += quick;
    }
    assert_true(first > 0 && first < 10);
    expect(0, "compare --run ./quick ./quick --rounds 9 --quiet -- --repeats 6",
           "nothing is worse");
    expect(0, "compare a.json a.json --history programs.db", "(compare --run)");
    refuses("", "compare --run ./quick", "give two programs");
    refuses("", "compare --run ./quick ./nobody", "./nobody: No such file");
    refuses("", "compare --run ./quick .", "is no program that can be run");
    refuses("", "compare --run ./quick ./slow --rounds 6", "--rounds");
    refuses("", "compare --run ./quick ./slow -- --out x", "leave --out out");
    refuses("", "compare --run ./quick ./broken --quiet", "it is broken");
    refuses("", "compare --run ./dead ./quick --quiet", "killed by signal 9");
    /* nothing is left of them */
    const outcome *o =
        run_with("mkdir t && TMPDIR=$PWD/t", "compare --run ./quick ./quick --quiet");
    assert_int_equal(o->exit_status, 0);
    assert_int_equal(rmdir(strcat(strcpy(path, folder), "/t")), 0);
}

/* Returns how many programs have run since the file was removed. */
static uint32_t turns_taken(void)
{
    static char order[8000];
    uint32_t turns = 0;
    char path[600];
    read_file("order", order, sizeof order);
    for (const char *at = order; (at = strchr(at, '\n')) != NULL; at++)
        turns++;
    snprintf(path, sizeof path, "%s/order", folder);
    assert_int_equal(remove(path), 0);
    return turns;
}

/* A time is kept by fewer pairs, and a signal leaves those that there are. */
static void fewer_pairs_are_compared_too(void **state)
{
    (void)state;
    write_run(folder, "a.json", edit_nothing, 1);
    write_programs();
    write_file("order", "", 0);
    const outcome *o =
        expect(0, "compare --run ./sleepy ./sleepy --rounds 60 --time 12s", "nothing is worse");
    assert_non_null(strstr(o->err, "a pair takes about "));
    const uint32_t turns = turns_taken();
    assert_true(turns >= 2 * 8 && turns < 2 * 61);
    refuses("", "compare --run ./sleepy ./sleepy --quiet --time 0.5s", "fewer than 7 tell nothing");
    refuses("", "compare --run ./sleepy ./sleepy --time never", "--time is 'never'");
    (void)turns_taken();
    o = run_program("timeout --foreground --preserve-status -s TERM 12", BB_TEST_BINARY,
                    "compare --run ./sleepy ./sleepy --rounds 60");
    if (o->exit_status != 130 || strstr(o->out, "nothing is worse") == NULL)
        fail_msg("exit %d: %s%s", o->exit_status, o->err, o->out);
    (void)turns_taken();
    o = run_program("timeout --foreground --preserve-status -s TERM 2", BB_TEST_BINARY,
                    "compare --run ./sleepy ./sleepy --rounds 60");
    assert_int_equal(o->exit_status, 130);
    assert_non_null(strstr(o->err, "before enough pairs were measured"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(messages_do_not_steer),
        cmocka_unit_test(files_are_compared),
        cmocka_unit_test(results_as_google_benchmark),
        cmocka_unit_test(revisions_are_compared),
        cmocka_unit_test(a_page_never_replaces_its_database),
        cmocka_unit_test(programs_are_run_in_turns),
        cmocka_unit_test(fewer_pairs_are_compared_too),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
