/* The command line from outside: help, words that are misspelt, numbers, lists, what is printed to
 * nowhere. Nothing here needs a device but what says so. */
#include "tests/program_fixture.h"

#include "framework/cli/cli.h"

#include <sys/stat.h>

static bool is_there(const char *name)
{
    char path[600];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &info) == 0;
}

/* Same output, exit 0. */
static void same_help(const char *a, const char *b)
{
    static char first[sizeof((outcome *)NULL)->out];
    const outcome *o = run(a);
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "usage: bvhbench"));
    strcpy(first, o->out);
    o = run(b);
    assert_int_equal(o->exit_status, 0);
    assert_string_equal(o->out, first);
}

static void help_is_where_it_is_looked_for(void **state)
{
    (void)state;
    static const char *const commands[] = {"list",   "run",       "check", "render",
                                           "report", "reproduce", "rays",  "judge"};
    same_help("--help", "-h");
    same_help("--help", "help");
    same_help("--help", "help --help");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char option[64], letter[64], word[64];
        snprintf(option, sizeof option, "%s --help", commands[i]);
        snprintf(letter, sizeof letter, "%s -h", commands[i]);
        snprintf(word, sizeof word, "help %s", commands[i]);
        same_help(option, letter);
        same_help(option, word);
    }
    expect(0, "version", "bvhbench ");
    expect(0, "--version", "bvhbench ");
    const outcome *o = run("");
    assert_int_equal(o->exit_status, 2);
    assert_string_equal(o->out, "");
    assert_non_null(strstr(o->err, "usage: bvhbench"));
    refuses("", "help fly", "unknown command 'fly': see");
    refuses("", "help run extra", "leave 'extra' out");
    refuses("", "help --help run", "leave 'run' out");
}

static void nearly_known_words_are_named(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"runn", "'run'"},
        {"reprot", "'report'"},
        {"--vers", "'--version'"},
        {"help chek", "'check'"},
        {"run --bulder lbvh", "'--builder'"},
        {"run --max-ray=3", "'--max-rays'"},
        {"run --builder lbv", "'lbvh'"},
        {"run --builder lbvh+rotat", "'rotate'"},
        {"run --builder embree-nativ", "'embree-native'"},
        {"run --builder lbvh:bts=30", "'bits'"},
        {"run --kernel stak", "'stack'"},
        {"run --kernel stack:leav=3", "'leaf'"},
        {"run --rays primry", "'primary'"},
        {"run --intersector exakt", "'exact'"},
        {"run --metrics eop", "'epo'"},
        {"run --scene cofee", "'coffee'"},
        {"check --scene cofee", "'coffee'"},
        {"reproduce emc --scene cofee", "'coffee'"},
        {"run --scene box:length=1.5,citty:flatness=0.1", "'city'"},
        {"run --cell scene=cofee/builder=lbvh", "'coffee'"},
        {"run --cell scene=cube/rays=aoo/builder=lbvh/kernel=stack", "'ao'"},
        {"run --cell scene=cube/rays=ao/builder=lbvh/kernel=stock", "'stack'"},
        {"render --scene sphere:n=9 --out x.png", "'spheres'"},
        {"rays --scene cube --rays rando --out x.rays", "'random'"},
        {"judge --scene cubes --rays-file a --hits b", "'cube'"},
        {"list builder", "'builders'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char words[64];
        snprintf(words, sizeof words, "(did you mean %s?)", cases[i][1]);
        refuses("", cases[i][0], words);
    }
    assert_null(strstr(run("run --builder nobody")->err, "did you mean"));
}

/* A beginning of an option's name would be another one, or none, with the next option. */
static void options_are_written_in_full(void **state)
{
    (void)state;
    refuses("", "run --scen cube", "unknown option '--scen' (did you mean '--scene'?)");
    refuses("", "run --scen=cube", "(did you mean '--scene'?)");
    refuses("", "run --he", "(did you mean '--help'?)");
    refuses("", "list --jso", "(did you mean '--json'?)");
}

static void ranges_are_named(void **state)
{
    (void)state;
    refuses("", "run --repeats 0", "must be a whole number from 1 to ");
    refuses("", "run --seed=-1", "must be a whole number below 2^64");
    refuses("", "run --max-rays 1.5", "--max-rays is '1.5', must be a whole number from 1 to");
    refuses("", "run --max-rays 2G", "--max-rays is '2G', must be a whole number from 1 to");
    refuses("", "run --size 100000x100000", "from 1 to 65536, and 134217728 pixels at most");
    refuses("", "run --size 0x0", "from 1 to 65536");
    refuses("", "run --size 9", "must be WIDTHxHEIGHT, such as 512x512");
    refuses("", "run --size 1e3x", "must be WIDTHxHEIGHT");
    /* past this check */
    refuses("", "run --size 1kx1e3 --max-rays 1_000 --repeats 1e1 --seed 1M --builder no-one",
            "no-one");
    expect(0, "rays --scene spheres:n=1e2 --rays random --max-rays 1.5k --seed 1k --out n.rays",
           "1500 rays, random, closest hit; 0 triangles, 100 spheres");
}

static void empty_values_name_their_option(void **state)
{
    (void)state;
    static const char *const options[] = {"out", "scene", "device", "builder", "cell", "repeats"};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        char arguments[64], words[64];
        snprintf(arguments, sizeof arguments, "run --%s ''", options[i]);
        snprintf(words, sizeof words, "--%s is empty", options[i]);
        refuses("", arguments, words);
    }
    refuses("", "run --scene cube,,coffee", "--scene: empty item in the list");
    refuses("", "judge --name= --scene cube", "--name is empty");
}

static void one_thing_is_given_once(void **state)
{
    (void)state;
    refuses("", "run --builder lbvh,lbvh", "--builder: 'lbvh' is given twice");
    refuses("", "run --builder lbvh --builder lbvh:code=mc32", "are the same");
    refuses("", "run --scene spheres:n=1e3,spheres:n=1000", "are the same");
    refuses("", "run --kernel all,stack", "--kernel: 'stack' is given twice");
    refuses("", "run --rays ao,ao:per_hit=32", "are the same");
    refuses("", "run --metrics epo,epo", "--metrics: 'epo' is given twice");
    refuses("", "check --scene cube,cube", "--scene: 'cube' is given twice");
}

/* One line, and nothing is left in the folder. */
static void what_fails_at_once_leaves_no_folder(void **state)
{
    (void)state;
    refuses("", "run --scene cube,missing.glb --builder lbvh", "missing.glb");
    assert_false(is_there("out"));
    refuses("", "run --scene cube --builder lbvh --device nowhere --out new", "nowhere");
    refuses("", "reproduce emc --device nowhere --out new", "nowhere");
    refuses("", "judge --scene cube --rays-file no.rays --hits no.hits --out new", "no.rays");
    assert_false(is_there("new"));
    refuses("mkdir kept;", "run --scene cube --device nowhere --out kept", "nowhere");
    assert_true(is_there("kept"));
    refuses("", "run --scene cube --device nowhere --out kept/a//b/", "nowhere");
    refuses("", "rays --scene no.obj --rays primary --out kept/a.rays", "no.obj");
    refuses("", "rays --scene cube --rays primary --view no --out kept/a/b.rays", "no view");
    assert_true(is_there("kept"));
    assert_false(is_there("kept/a"));
}

/* Of every command that has --out: what begins it, all but --out. */
static const char *const writers[] = {
    "run --scene cube",
    "rays --scene cube --rays primary",
    "judge --scene cube --rays-file a.rays --hits a.hits",
    "render --scene cube",
    "merge a b",
    "report a",
    "report --history a.db",
    "compare --run true true --rounds 7",
    "stress --quick",
    "volume --scene nbody:n=8",
    "slice --scene tets:side=2",
    "overlap tets:side=2 tets:side=2",
    "animate --scene twist:n=100",
    "advise --scene cube",
    "reproduce emc",
};

/* Before anything is read or measured: the device is not there, nor are the files. */
static void out_where_a_file_is_in_the_way_is_refused_at_once(void **state)
{
    (void)state;
    write_file("taken", "", 0);
    for (size_t i = 0; i < sizeof writers / sizeof writers[0]; i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, "%s --out taken/a/b.png", writers[i]);
        refuses("OCL_ICD_VENDORS=/nonexistent", arguments, "taken is a file");
    }
    refuses("", "rays --scene cube --rays primary --out kept", "not a regular file");
    for (const bb_command *const *c = bb_commands; *c != NULL; c++) {
        size_t length = strlen((*c)->name);
        bool writes = false, known = false;
        for (const bb_cli_option *o = (*c)->options; o->kind != BB_CLI_END; o++)
            writes = writes || (o->name != NULL && strcmp(o->name, "out") == 0);
        for (size_t i = 0; i < sizeof writers / sizeof writers[0]; i++)
            known = known ||
                    (strncmp(writers[i], (*c)->name, length) == 0 && writers[i][length] == ' ');
        if (writes != known)
            fail_msg("%s has --out: %d, is tried here: %d", (*c)->name, writes, known);
    }
}

static void expect_made(const char *arguments, const char *file)
{
    const outcome *o = run(arguments);
    if (o->exit_status != 0 || !is_there(file))
        fail_msg("%s: exit %d, no %s: %s", arguments, o->exit_status, file, o->err);
}

/* On a device. */
static void folders_of_out_are_made(void **state)
{
    (void)state;
    expect_made("run --shard 1/1 --scene single --builder null --rays none --charts no "
                "--no-pictures --quiet --out m/shards/1 --history m/shards/1/bench.db",
                "m/shards/1/bench.db");
    expect_made("merge m/shards/1 --out m/merged/all", "m/merged/all/results.json");
    expect_made("report m/merged/all --charts no --out m/pages/a.html", "m/pages/a.html");
    expect_made("report --history m/shards/1/bench.db --out m/page/h.html", "m/page/h.html");
    expect_made("rays --scene single --rays primary --size 8x8 --out m/rays/a/b.rays",
                "m/rays/a/b.rays");
    expect_made("render --scene single --size 8x8 --out m/png/x.png", "m/png/x.png");
    expect_made("slice --scene tets:side=2 --slices 2 --repeats 1 --out m/slices/1",
                "m/slices/1/slice.json");
}

/* On a device. Its name, perhaps that others keep the machine busy, a line of what is begun, no bar
 * where there is no terminal; with --quiet nothing. */
static void contests_say_what_they_are_at(void **state)
{
    (void)state;
    static const char *const commands[] = {
        "volume --scene nbody:n=8 --builder lbvh --kernel stack --size 8x8 --steps none",
        "slice --scene tets:side=2 --builder lbvh --search skip",
        "overlap tets:side=2 tets:side=2 --builder lbvh --search skip",
    };
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, "%s --repeats 3 --quiet", commands[i]);
        assert_string_equal(expect(0, arguments, "lbvh")->err, "");
        snprintf(arguments, sizeof arguments, "%s --repeats 3", commands[i]);
        const outcome *o = expect(0, arguments, "lbvh");
        const char *line = strchr(o->err, '\n') + 1;
        if (strncmp(line, "WARNING: the machine is busy", 28) == 0) /* by other tests */
            line = strchr(line, '\n') + 1;
        assert_int_equal(strncmp(o->err, "device: ", 8), 0);
        assert_non_null(strstr(line, " ways, 3 rounds\n"));
        assert_int_equal(strchr(line, '\n')[1], '\0');
    }
}

static void rays_beyond_memory_are_refused_first(void **state)
{
    (void)state;
    double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    if (bytes > 100e9)
        skip(); /* as many rays as may be asked for would fit */
    refuses("", "run --scene cube --rays primary,random --max-rays 1G", "rays random: ");
    refuses("", "run --scene cube --rays lines --max-rays 1G --out new", "take at most");
    refuses("", "rays --scene cube --rays edges:count=2G --out x.rays", "take at most");
    assert_false(is_there("out") || is_there("new"));
}

static void missing_folders_and_drivers_are_said(void **state)
{
    (void)state;
    refuses("BVHBENCH_SCENES=/nonexistent", "run --scene coffee", "BVHBENCH_SCENES is");
    refuses("BVHBENCH_SCENES=/nonexistent", "render --scene coffee --out x.png",
            "BVHBENCH_SCENES is");
    const outcome *o = run_with("OCL_ICD_VENDORS=/nonexistent", "list devices");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "none: install a driver"));
    o = run_with("OCL_ICD_VENDORS=/nonexistent", "list devices --json");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "\"devices\":\t[]"));
    o = run("list devices");
    if (strstr(o->out, "Portable Computing Language") == NULL)
        return;
    refuses("POCL_CACHE_DIR=/proc/none", "run --scene cube", "set POCL_CACHE_DIR");
    o = run_with("POCL_CACHE_DIR=/proc/none", "list devices");
    assert_non_null(strstr(o->out, "set POCL_CACHE_DIR"));
}

static void references_are_for_run_alone(void **state)
{
    (void)state;
    static const char words[] = "traces with its own tree: only `run` takes it";
    refuses("", "check --builder embree-native", words);
    refuses("", "render --scene cube --out x.png --builder embree-native:quality=low", words);
}

/* What could not be printed was not done. */
static void output_to_nowhere_is_no_success(void **state)
{
    (void)state;
    static const char *const commands[] = {"list", "list --json",  "--help",     "help run",
                                           "-h",   "run --help",   "--version",  "version",
                                           "help", "list metrics", "rays --help"};
    static const char *const nowhere[] = {">/dev/full", ">&-"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        for (size_t k = 0; k < sizeof nowhere / sizeof nowhere[0]; k++) {
            char before[64];
            snprintf(before, sizeof before, "sh -c '\"$@\" %s' -", nowhere[k]);
            const outcome *o = run_program(before, BB_TEST_BINARY, commands[i]);
            const char *newline = strchr(o->err, '\n');
            if (o->exit_status != 2 || newline == NULL || newline[1] != '\0' ||
                strncmp(o->err, "bvhbench: cannot write to standard output: ", 43) != 0)
                fail_msg("%s %s: exit %d, '%s'", commands[i], nowhere[k], o->exit_status, o->err);
        }
}

/* A file is not given the number of a standard one that was closed, and what is meant for that. */
static void closed_files_do_not_come_back(void **state)
{
    (void)state;
    static char rays[2][65536];
    expect(0, "rays --scene single --rays primary --size 8x8 --out open.rays", "64 rays");
    const outcome *o =
        run_program("sh -c '\"$@\" <&- >&- 2>&-' -", BB_TEST_BINARY,
                    "rays --scene single --rays primary --size 8x8 --out closed.rays");
    assert_int_equal(o->exit_status, 2);
    size_t size = read_file("open.rays", rays[0], sizeof rays[0]);
    assert_int_equal(read_file("closed.rays", rays[1], sizeof rays[1]), size);
    /* after the header, which has the command line */
    assert_memory_equal(rays[0] + size - 64, rays[1] + size - 64, 64);
}

/* On a device: a view of its own gives another picture. */
static void pictures_have_a_view_and_what_is_shown(void **state)
{
    (void)state;
    static const char *const views[] = {"--show depth --view back", "--show depth"};
    static char pictures[2][65536];
    size_t sizes[2];
    for (size_t i = 0; i < 2; i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, "render --scene cube --size 16x16 --out x.png %s",
                 views[i]);
        assert_int_equal(run(arguments)->exit_status, 0);
        sizes[i] = read_file("x.png", pictures[i], sizeof pictures[i]);
    }
    assert_true(sizes[0] != sizes[1] || memcmp(pictures[0], pictures[1], sizes[0]) != 0);
    refuses("", "render --scene cube --show taste --out x.png", "--show is 'taste'");
    refuses("", "render --scene cube --camera back --out x.png", "unknown option '--camera'");
}

/* On a device: `all` of everything that has it. */
static void all_stands_for_what_there_is(void **state)
{
    (void)state;
    const outcome *o = run("run --scene single --builder null --kernel stack --rays all "
                           "--intersector all --metrics all --size 8x8 --max-rays 500 --repeats 1 "
                           "--table --no-pictures --charts no --quiet --out all");
    assert_int_not_equal(o->exit_status, 2);
    static const char *const words[] = {
        "primary", "ao: ", "lines: ", "random:", " careless", "EPO"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strstr(o->out, words[i]) == NULL)
            fail_msg("no %s in %s", words[i], o->out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_is_where_it_is_looked_for),
        cmocka_unit_test(nearly_known_words_are_named),
        cmocka_unit_test(options_are_written_in_full),
        cmocka_unit_test(ranges_are_named),
        cmocka_unit_test(empty_values_name_their_option),
        cmocka_unit_test(one_thing_is_given_once),
        cmocka_unit_test(what_fails_at_once_leaves_no_folder),
        cmocka_unit_test(out_where_a_file_is_in_the_way_is_refused_at_once),
        cmocka_unit_test(folders_of_out_are_made),
        cmocka_unit_test(contests_say_what_they_are_at),
        cmocka_unit_test(rays_beyond_memory_are_refused_first),
        cmocka_unit_test(missing_folders_and_drivers_are_said),
        cmocka_unit_test(references_are_for_run_alone),
        cmocka_unit_test(output_to_nowhere_is_no_success),
        cmocka_unit_test(closed_files_do_not_come_back),
        cmocka_unit_test(pictures_have_a_view_and_what_is_shown),
        cmocka_unit_test(all_stands_for_what_there_is),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
