/* `check` from outside: both forms, the slowest builds, progress; and plug-ins from the
 * environment. */
#include "tests/program_fixture.h"

#define ROGUE "--plugin " BB_TEST_PLUGIN_DIR "/rogue.so --builder rogue"

static void both_forms_make_one_tree(void **state)
{
    (void)state;
    const outcome *o = expect(0, "check --form both --scene cube --builder lbvh " ROGUE,
                              "4 trees checked, 0 checks failed");
    assert_non_null(strstr(o->err, "cube: 12 primitives, form cpu\n"));
    assert_non_null(strstr(o->err, "cube: 12 primitives, form gpu\n"));
    expect(1, "check --form both --scene cube " ROGUE ":kind=form", "form cpu makes tree ");
    expect(0, "check --form gpu --scene cube " ROGUE ":kind=form", "0 checks failed");
    refuses("", "check --scene cube --builder lbvh:bits=65", "'65', must be");
    refuses("", "check --form both --scene cube --builder sah,lbvh+trbvh:rounds=0", "'0', must be");
    refuses("", "check --form neither --scene cube", "--form is 'neither'");
}

/* As the first line of progress, and of what is printed. */
static void output_begins_with_the_device(void **state)
{
    (void)state;
    static const char *const commands[] = {
        "check --scene cube --builder lbvh",
        "animate --scene car:frames=2 --builder lbvh --kernel stack --rays primary --size 8x8",
        "slice --scene tets:side=2 --builder lbvh --size 8x8 --slices 2",
        "overlap tets:side=2 tets:side=2 --builder lbvh",
        "volume --scene nbody:n=8 --builder lbvh --size 8x8",
        "advise --scene single --builder lbvh --kernel stack --size 8x8 --max-rays 64 --rays ao",
        "run --scene cube --builder lbvh --kernel stack --size 8x8 --rays primary --repeats 1 "
        "--charts no --out begun"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char name[256];
        const outcome *o = run_program("", BB_TEST_BINARY, commands[i]);
        const char *end = strstr(o->err, " (OpenCL "), *line = strchr(o->out, '\n');
        if (strncmp(o->err, "device: ", 8) != 0 || end == NULL)
            fail_msg("%s: progress begins with %.60s", commands[i], o->err);
        snprintf(name, sizeof name, "%.*s", (int)(end - o->err - 8), o->err + 8);
        const char *found = strstr(o->out, name);
        if (found == NULL || found > line)
            fail_msg("%s: begins with %.40s, without %s", commands[i], o->out, name);
    }
}

static void the_slowest_builds_are_noted(void **state)
{
    (void)state;
    const outcome *o = expect(0, "check --quiet --scene cube --scene terrain:n=2000 --builder sah",
                              "slowest build: ");
    assert_string_equal(o->err, "");
    const char *note = strstr(o->out, "\nnote        terrain:n=2000 ");
    assert_non_null(note); /* of the cube's twelve primitives nothing is said */
    assert_non_null(strstr(note, " us per primitive"));
}

static void plugins_come_from_the_environment_too(void **state)
{
    (void)state;
    const outcome *o = run_with("BVHBENCH_PLUGINS=" BB_TEST_PLUGIN_DIR
                                "/median.so:" BB_TEST_PLUGIN_DIR "/rogue.so",
                                "list builders");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "median "));
    assert_non_null(strstr(o->out, "rogue "));
    refuses("BVHBENCH_PLUGINS=/no/such.so", "list builders",
            "BVHBENCH_PLUGINS: plug-in /no/such.so");
    refuses("BVHBENCH_PLUGINS=" BB_TEST_PLUGIN_DIR "/foreign.so", "list builders",
            "its bb_plugin is no builder or tracer of this bvhbench");
}

/* Device files of a plug-in can be overridden like any other, by their names. */
static void a_folder_overrides_a_plugins_files(void **state)
{
    (void)state;
    static const char broken[] = "#error from the folder\n";
    const char *check = "check --scene cube --builder strips --plugin " BB_TEST_PLUGIN_DIR
                        "/strips.so --kernels-from edited";
    expect(0, "check --scene cube --builder strips --plugin " BB_TEST_PLUGIN_DIR "/strips.so",
           "0 checks failed");
    assert_int_equal(run_program("", "mkdir", "edited")->exit_status, 0);
    write_file("edited/strips.clh", broken, sizeof broken - 1);
    expect(1, check, "from the folder");
    refuses("", "check --scene cube --kernels-from edited", "strips.clh would not be used");
}

/* What hangs is named, and everything before it is there. */
static void what_hangs_is_given_up(void **state)
{
    (void)state;
    /* the time for the one that is well includes the compiler's, if its cache is empty */
    expect(0, "check --limit 0 --scene cube " ROGUE, "0 checks failed");
    const outcome *o =
        expect(1, "check --limit 5 --scene cube " ROGUE " --builder rogue:kind=hangs", "\nHUNG ");
    const char *hung = strstr(o->out, "\nHUNG ");
    assert_non_null(strstr(hung, " cube "));
    assert_non_null(strstr(hung, " rogue:kind=hangs "));
    assert_non_null(strstr(hung, "not done after 5 s"));
    assert_non_null(strstr(o->out, "\nok "));          /* after the device's name */
    assert_string_equal(strchr(hung + 1, '\n'), "\n"); /* the last line */
    refuses("", "check --limit soon --scene cube", "--limit");
    refuses("", "check --scene cube --builder lbvh --time soon", "--time is 'soon'");
}

/* Every tree is checked, or counted as not checked. */
static void time_ends_it(void **state)
{
    (void)state;
    const outcome *o = run("check --quiet --scene cube --builder lbvh --time 0.001s");
    assert_int_equal(o->exit_status, 2);
    assert_non_null(strstr(o->err, "--time was over before anything was checked"));
    static const double times[] = {0.5, 2, 100};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        char command[200];
        unsigned checked = 0, left = 0;
        snprintf(command, sizeof command,
                 "check --quiet --form both --scene cube --scene terrain:n=200 "
                 "--builder lbvh,sah --time %gs",
                 times[i]);
        o = run(command);
        if (o->exit_status == 2)
            continue;
        const char *sum = strstr(o->out, "scenes: 2; "),
                   *over = strstr(o->err, "--time was over: ");
        assert_int_equal(o->exit_status, 0);
        assert_non_null(sum);
        assert_int_equal(sscanf(sum, "scenes: 2; %u", &checked), 1);
        if (over != NULL)
            assert_int_equal(sscanf(over, "--time was over: %u", &left), 1);
        assert_int_equal(checked + left, 8);
        if (left == 0)
            break;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_forms_make_one_tree),
        cmocka_unit_test(output_begins_with_the_device),
        cmocka_unit_test(the_slowest_builds_are_noted),
        cmocka_unit_test(plugins_come_from_the_environment_too),
        cmocka_unit_test(a_folder_overrides_a_plugins_files),
        cmocka_unit_test(what_hangs_is_given_up),
        cmocka_unit_test(time_ends_it),
    };
    return cmocka_run_group_tests_name("check", tests, make_folder, remove_folder);
}
