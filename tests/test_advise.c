/* Advice, by the program from outside. */
#include "framework/advise/advice.h"
#include "framework/base/shell_word.h"
#include "tests/program_fixture.h"

#include <math.h>

#define SMALL "advise --size 16x16 --quick --quiet --count 1000 "

static double number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (!cJSON_IsNumber(item))
        fail_msg("%s is no number", name);
    return item->valuedouble;
}

static const cJSON *part(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (item == NULL)
        fail_msg("there is no %s", name);
    return item;
}

static bool is(const cJSON *object, const char *name, const char *text)
{
    return strcmp(part(object, name)->valuestring, text) == 0;
}

/* The row of a question in which a member has this text, the first of several; NULL: there is none.
 * `question` NULL: the scene's; `name` NULL: any. */
static const cJSON *find(const cJSON *table, const char *question, const char *name,
                         const char *text)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, part(table, "rows"))
    {
        const cJSON *asked = cJSON_GetObjectItemCaseSensitive(row, "question");
        const cJSON *member = cJSON_GetObjectItemCaseSensitive(row, name != NULL ? name : "scene");
        if (cJSON_GetObjectItemCaseSensitive(row, "scene") == NULL || !cJSON_IsString(member) ||
            (asked != NULL) != (question != NULL) ||
            (asked != NULL && strcmp(asked->valuestring, question) != 0))
            continue;
        if (name == NULL || strcmp(member->valuestring, text) == 0)
            return row;
    }
    return NULL;
}

static const cJSON *scene_of(const cJSON *table)
{
    const cJSON *row = find(table, NULL, NULL, NULL);
    assert_non_null(row);
    return row;
}

static const cJSON *choice_of(const cJSON *table)
{
    return find(table, "race", "state", "chosen");
}

static double median(const cJSON *row, const char *name)
{
    const cJSON *one;
    bb_samples rounds = {0};
    cJSON_ArrayForEach(one, part(row, name)) bb_samples_add(&rounds, one->valuedouble);
    return bb_samples_median(&rounds);
}

static void advice_as_json(void **state)
{
    (void)state;
    const outcome *o =
        run(SMALL "--scene random:n=2000 --max-rays 1024 --rays primary,diffuse --builder "
                  "lbvh:bits=63,lbvh:bits=auto,sah --kernel stack,stack8:leaf=8 "
                  "--exhaustive --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    assert_non_null(json);
    assert_true(is(json, "schema", "bvhbench-table/1") && is(json, "command", "advise"));
    assert_true(number(scene_of(json), "primitives") == 2000 &&
                number(scene_of(json), "image_rays") == 1000);
    const cJSON *choice = choice_of(json), *one;
    assert_non_null(choice);
    assert_true(number(choice, "wrong") == 0 && number(choice, "checked") > 500);
    assert_true(fabs(number(choice, "wrong_ppm_at_most") - 3e6 / number(choice, "checked")) < 1);
    assert_true(number(choice, "bytes") ==
                number(choice, "bytes_build") + number(choice, "bytes_layout"));
    assert_true(median(choice, "ratio") <= 1.05);
    assert_true(is(find(json, "kinds compiled in", "builder", part(choice, "builder")->valuestring),
                   "value", "triangles"));
    assert_true(is(find(json, "code bits", NULL, NULL), "by", "scene"));
    assert_null(cJSON_GetObjectItemCaseSensitive(find(json, "code bits", NULL, NULL), "builder"));
    uint32_t chosen = 0, count = 0, searched = 0, saved = 0;
    cJSON_ArrayForEach(one, part(json, "rows"))
    {
        const cJSON *question = cJSON_GetObjectItemCaseSensitive(one, "question");
        if (question == NULL)
            continue;
        count += is(one, "question", "race");
        chosen += is(one, "question", "race") && is(one, "state", "chosen");
        searched += is(one, "question", "exhaustive search");
        if (is(one, "question", "savings")) {
            saved++;
            assert_true(number(one, "bytes_more") > -1e6 && isfinite(median(one, "ms_more")));
        }
    }
    assert_true(count > 0 && count <= 6 && chosen == 1 && saved > 0);
    assert_int_equal(searched, 6);
    assert_non_null(find(json, "exhaustive search", "state", "chosen"));
    assert_true(median(find(json, "exhaustive search", "state", "chosen"), "ratio") > 0);

    /* the command that it names measures just that */
    char command[1024];
    snprintf(command, sizeof command, "%s --quick --quiet --charts no --no-pictures",
             part(find(json, "again", NULL, NULL), "again")->valuestring + strlen("bvhbench "));
    expect(0, command, part(choice, "builder")->valuestring);
    cJSON_Delete(json);
}

static void advice_as_text(void **state)
{
    (void)state;
    const outcome *o = expect(0,
                              SMALL "--scene cube --rays primary --builder lbvh:bits=auto "
                                    "--kernel stack --out kept --charts no",
                              "What the scene asks for");
    static const char *const words[] = {"The least that does it",
                                        "lbvh:bits=auto, stack, exact",
                                        "none wrong of 256 judged rays, below",
                                        "lbvh:bits=63",
                                        "stack=1024",
                                        "7,168", /* more bytes for each ray in flight */
                                        "race: 1 configurations: 1 chosen.",
                                        "To measure the choice again\nbvhbench run --scene cube"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strstr(o->out, words[i]) == NULL)
            fail_msg("no '%s' in:\n%s", words[i], o->out);
    cJSON *json = read_results("kept/results.json");
    assert_true(cJSON_GetArraySize(part(json, "traces")) >= 1);
    cJSON_Delete(json);
    expect(0, "report kept --table", "lbvh:bits=auto"); /* it is a result file like any */
    expect(0, "report kept/advise.json", "paired round by round");
    expect(0, "report kept/advise.json --table", "What the scene asks for");
    expect(0, "report kept/advise.json --markdown", "| builder | intersector |");
    expect(0, "report kept/advise.json --csv", "scene,");
}

static void words_are_quoted_for_a_shell(void **state)
{
    (void)state;
    static const char *const words[][2] = {
        {"lbvh:bits=63,size=1.5", "lbvh:bits=63,size=1.5"},
        {"", "''"},
        {"my scene.ply", "'my scene.ply'"},
        {"$(touch pwned)`ls`", "'$(touch pwned)`ls`'"},
        {"it's", "'it'\\''s'"},
        {"~/a\nb", "'~/a\nb'"},
    };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        char *text = NULL;
        size_t size;
        FILE *out = open_memstream(&text, &size);
        assert_non_null(out);
        bb_put_shell_word(out, words[i][0]);
        fclose(out);
        assert_string_equal(text, words[i][1]);
        free(text);
    }
}

/* A file whose name a shell would take to pieces; the command is run by one. */
static void the_command_is_the_same_to_a_shell(void **state)
{
    (void)state;
    char name[600], command[2048];
    snprintf(name, sizeof name, "%s/a $(touch pwned) b's.obj", folder);
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
    assert_int_equal(fclose(file), 0);
    const outcome *o = run(SMALL "--scene 'a $(touch pwned) b'\\''s.obj' --rays primary --builder "
                                 "lbvh --kernel stack --seed 7 --max-rays 1k --device 0 --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    const char *text = part(find(json, "again", NULL, NULL), "again")->valuestring;
    assert_non_null(strstr(text, " --size 16x16 --max-rays 1k --seed 7 --device 0"));
    snprintf(command, sizeof command, "%s --quick --quiet --charts no --no-pictures",
             text + strlen("bvhbench "));
    expect(0, command, "lbvh");
    snprintf(name, sizeof name, "%s/pwned", folder);
    assert_null(fopen(name, "r"));
    cJSON_Delete(json);
}

/* A name with what clears a terminal, sets its title, turns the writing. */
static void a_name_does_not_steer_the_terminal(void **state)
{
    (void)state;
#define EVIL "\033[2J\033]0;x\007\302\233\342\200\256.obj"
    char name[600];
    snprintf(name, sizeof name, "%s/" EVIL, folder);
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
    assert_int_equal(fclose(file), 0);
    static const char *const arguments[] = {
        "advise --size 16x16 --quick --count 1000 --scene '" EVIL
        "' --rays primary --builder lbvh --kernel stack",
        "advise --scene 'nosuch" EVIL "'"};
    for (int i = 0; i < 2; i++) {
        const outcome *o = run(arguments[i]);
        assert_int_equal(o->exit_status, i == 0 ? 0 : 2);
        const char *shown = i == 0 ? o->out : o->err;
        if (strstr(shown, "?[2J?]0;x???.obj") == NULL)
            fail_msg("the name is not shown:\n%s", shown);
        assert_null(strstr(o->out, "\033[2J"));
        assert_null(strstr(o->err, "\033[2J"));
        assert_null(strstr(o->out, "\342\200\256"));
        assert_null(strstr(o->err, "\342\200\256"));
    }
#undef EVIL
}

/* Rays at edges, and an intersector that loses some of them. */
static void nothing_right_enough_is_status_1(void **state)
{
    (void)state;
    const char *careless = SMALL "--scene sphere-mesh:n=8 --rays edges --builder lbvh --kernel "
                                 "stack --intersector careless ";
    char arguments[512];
    snprintf(arguments, sizeof arguments, "%s --max-rays 20k", careless);
    expect(1, arguments, "Nothing that was tried is right often enough");
    snprintf(arguments, sizeof arguments, "%s --max-rays 20k --json", careless);
    const outcome *o = expect(1, arguments, "too wrong");
    /* all are out before the last heat, whose document has nothing of the scene */
    cJSON *json = cJSON_Parse(o->out);
    assert_null(choice_of(json));
    assert_true(number(scene_of(json), "primitives") > 0);
    assert_non_null(find(json, "code bits", NULL, NULL));
    cJSON_Delete(json);
    snprintf(arguments, sizeof arguments, "%s --max-rays 20k --max-wrong-ppm 1e6", careless);
    expect(0, arguments, "lbvh, stack, careless");
}

/* 256 rays without a wrong one show a rate below 11,719 per million, and no less. */
static void a_limit_that_rays_cannot_show_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *limit, *text;
        bool shown;
    } cases[] = {{"0", NULL, false},
                 {"11718", "257 judged rays if none is wrong", false},
                 {"10", "300,000 judged rays if none is wrong", false},
                 {"11719", NULL, true},
                 {"1e6", NULL, true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments,
                 SMALL "--scene cube --rays primary --builder lbvh --kernel stack --intersector "
                       "exact --max-wrong-ppm %s --out limit%zu --charts no",
                 cases[i].limit, i);
        expect(0, arguments, "none wrong of 256");
        snprintf(arguments, sizeof arguments, "report limit%zu/advise.json --markdown", i);
        const outcome *o = expect(0, arguments, cases[i].text != NULL ? cases[i].text : "");
        assert_int_equal(strstr(o->out, "do not show") != NULL, cases[i].text != NULL);
        snprintf(arguments, sizeof arguments, "limit%zu/advise.json", i);
        cJSON *json = read_json(arguments);
        assert_int_equal(is(choice_of(json), "limit_shown", "yes"), cases[i].shown);
        cJSON_Delete(json);
    }
}

/* The first kernel's stack is too short: whoever is right gives other answers. */
static void who_is_right_stays_beside_one_that_is_wrong(void **state)
{
    (void)state;
    const outcome *o = run("advise --scene ladder --builder lbvh:bits=30 --kernel "
                           "stack:stack=4,stack --rays primary --quick --quiet --size 32x32 "
                           "--max-rays 1024 --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    const cJSON *wrong = find(json, "race", "intersector", "stack:stack=4, exact");
    assert_true(is(wrong, "state", "too wrong") && number(wrong, "wrong") > 0);
    assert_true(is(wrong, "builder", "lbvh:bits=30") && is(wrong, "unfit", "wrong too often"));
    assert_true(is(choice_of(json), "builder", "lbvh:bits=30") &&
                is(choice_of(json), "intersector", "stack, exact"));
    cJSON_Delete(json);
}

/* What an intersector gets wrong is not the kernels' fault. */
static void kernels_are_not_dropped_for_an_intersector(void **state)
{
    (void)state;
    const outcome *o = run(SMALL "--scene slivers --builder lbvh,sah --kernel stackless,stack "
                                 "--intersector careless,exact --rays primary --json");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    static const char *const scouts[] = {"stackless, careless", "stackless, exact", "stack, exact"};
    for (size_t i = 0; i < 3; i++) {
        const cJSON *scout = find(json, "kernels, intersectors", "intersector", scouts[i]);
        assert_non_null(scout);
        assert_true(is(scout, "builder", "lbvh"));
        assert_int_equal(is(scout, "state", "too wrong"), i == 0);
    }
    assert_null(find(json, "kernels, intersectors", "intersector", "stack, careless"));
    assert_non_null(strstr(part(choice_of(json), "intersector")->valuestring, ", exact"));
    cJSON_Delete(json);
}

/* With results, so that the clocks are held against each other. */
static void a_few_primitives_are_advised(void **state)
{
    (void)state;
    static const char *const scenes[] = {"single", "cube", "sphere-mesh:n=4"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments,
                 SMALL "--scene %s --builder lbvh,sah --kernel stack,stack8:leaf=4 --max-rays 1024 "
                       "--out few%zu --charts no",
                 scenes[i], i);
        const outcome *o = expect(0, arguments, "To measure the choice again");
        assert_null(strstr(o->err, "do not trust"));
    }
}

/* By accounts, not by the machine; of everything that is tried, so that it does not depend on who
 * is dropped. */
static void memory_is_bounded_by_turns(void **state)
{
    (void)state;
    double held[2];
    static const char *const rooms[] = {"4M", "1G"};
    for (int i = 0; i < 2; i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments,
                 SMALL "--scene random:n=10000 --rays primary --builder lbvh,emc,llbvh,ploc "
                       "--kernel stack8:leaf=8,stack8:leaf=4,stack --memory %s --exhaustive --json",
                 rooms[i]);
        const outcome *o = run(arguments);
        if (o->exit_status != 0)
            fail_msg("exit %d: %s", o->exit_status, o->err);
        cJSON *json = cJSON_Parse(o->out);
        held[i] = number(find(json, "taken", NULL, NULL), "held_bytes");
        assert_true(number(find(json, "foretold", NULL, NULL), "held_bytes") > 0);
        cJSON_Delete(json);
    }
    print_message("%g and %g bytes were held\n", held[0], held[1]);
    assert_true(held[0] < 0.9 * held[1]); /* the scouts hold all builders' trees of the sample */
}

/* Interrupted once the race has begun. */
static void an_interrupt_leaves_the_best_so_far(void **state)
{
    (void)state;
    char command[2048];
    static char text[1 << 18];
    snprintf(
        command, sizeof command,
        "cd %s && (" BB_TEST_PROGRAM
        " advise --scene random:n=20000 --builder lbvh,sah --kernel stack8:leaf=8,stack8:leaf=4 "
        "--rays primary --size 64x64 --repeats 60 --out cut --charts no >stdout "
        "2>stderr & p=$!; while kill -0 $p && ! grep -q 'heat 1 of' stderr; do sleep 0.1; "
        "done; kill -TERM $p; wait $p)", /* shells have what is behind & ignore SIGINT */
        folder);
    const int status = system(command);
    assert_int_equal(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 130);
    read_file("stdout", text, sizeof text);
    if (strstr(text, "PRELIMINARY") == NULL)
        fail_msg("no advice:\n%s", text);
    read_file("stderr", text, sizeof text);
    const char *foretold = strstr(text, "are left; about");
    assert_true(foretold != NULL && strstr(foretold, "GB of host memory") != NULL &&
                strstr(foretold, "heat 1 of") != NULL);
    cJSON *json = read_json("cut/advise.json");
    assert_true(cJSON_IsString(part(scene_of(json), "preliminary")));
    part(choice_of(json), "builder");
    cJSON_Delete(json);
    json = read_results("cut/results.json"); /* the last comparison */
    part(json, "builds");
    cJSON_Delete(json);
}

/* When its time is over, the best so far is the advice. */
static void a_time_is_kept(void **state)
{
    (void)state;
    static const char *const times[] = {"15s", "1min", "4min"}; /* sanitizers take longer */
    const outcome *o = NULL;
    for (size_t i = 0; i < sizeof times / sizeof times[0] && (o == NULL || o->exit_status == 2);
         i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments,
                 "advise --scene random:n=20000 --builder lbvh,sah --kernel "
                 "stack8:leaf=8,stack8:leaf=4 --rays primary --size 2048x2048 --repeats 60 "
                 "--charts no --time %s",
                 times[i]);
        o = run(arguments);
    }
    const bool over = strstr(o->err, "--time was over: this is the best") != NULL;
    if (o->exit_status != 0 || (strstr(o->out, "PRELIMINARY") != NULL && !over))
        fail_msg("exit %d: %s%s", o->exit_status, o->err, o->out);
    refuses("", "advise --scene cube --time 0.001s", "--time was over before anything");
    refuses("", "advise --scene cube --time soon", "--time is 'soon'");
}

static void what_cannot_be_done_is_refused(void **state)
{
    (void)state;
    refuses("", "advise", "advise needs --scene");
    refuses("", "advise --scene cube --scene coffee", "--scene is given twice");
    refuses("", "advise --scene coffe", "coffe");
    refuses("", "advise --scene cube --builder nosuch", "nosuch");
    refuses("", "advise --scene cube --builder embree-native:quality=high", "reference row");
    refuses("", "advise --scene cube --kernel stack:stack=7", "stack");
    refuses("", "advise --scene cube --kernel stackless:stack=16", "no stack");
    refuses("", "advise --scene cube --kernel stack:kinds=some", "kinds");
    refuses("", "advise --scene cube --builder lbvh:bits=few", "bits");
    refuses("", "advise --scene cube --builder lbvh,sah,aac:delta=0", "'0', must be");
    refuses("", "advise --scene cube --intersector sloppy", "sloppy");
    refuses("", "advise --scene cube --rays none", "none");
    refuses("", "advise --scene cube --repeats 5", "--repeats");
    refuses("", "advise --scene cube --count 0", "--count");
    refuses("", "advise --scene cube --memory 0", "--memory");
    refuses("", "advise --scene cube --max-wrong-ppm -1", "--max-wrong-ppm");
    refuses("", "advise --scene cube --max-wrong-ppm nan", "--max-wrong-ppm");
    refuses("", "advise --scene cube --out /dev/null/x", "/dev/null/x");
    refuses("", "advise --scene cube --quiet --history /nowhere/a.db", "/nowhere/a.db");
    write_file("older.json", "{\"schema\":\"bvhbench-advice/1\"}", 30);
    refuses("", "report older.json", "bvhbench-advice/1");
    refuses("", "compare older.json older.json", "bvhbench-advice/1");
}

/* Too short a stack is never silent, and what was given is recorded as given. */
static void kernels_take_what_is_given(void **state)
{
    (void)state;
    const char *kernels =
        "run --quiet --charts no --no-pictures --scene random:n=3000 --rays primary "
        "--size 32x32 --repeats 1 --builder lbvh --out given --kernel ";
    char arguments[512];
    snprintf(arguments, sizeof arguments,
             "%s stack,stack:kinds=all,stack:stack=1024,stack8:leaf=8,stack8:leaf=8,kinds=all",
             kernels);
    expect(0, arguments, ""); /* all answers are the same, bit for bit */
    cJSON *json = read_results("given/results.json");
    const cJSON *trace;
    cJSON_ArrayForEach(trace, part(json, "traces"))
    {
        const cJSON *kernel = part(trace, "kernel");
        if (cJSON_IsTrue(part(trace, "reference")))
            continue;
        const cJSON *decided = part(trace, "decision"), *by = part(trace, "decided_by");
        bool all = strstr(kernel->valuestring, "kinds=all") != NULL;
        bool large = strstr(kernel->valuestring, "stack=1024") != NULL;
        const double entries = strtod(part(decided, "stack entries")->valuestring, NULL);
        assert_true(is(by, "kinds compiled in", all ? "given" : "scene"));
        assert_true(is(decided, "kinds compiled in",
                       all ? "triangles+spheres+boxes+tetrahedra" : "triangles"));
        assert_true(is(by, "stack entries", large ? "given" : "default"));
        assert_true(entries == number(trace, "stack_size"));
        assert_true((entries == 1024) == large);
    }
    cJSON_Delete(json);
    snprintf(arguments, sizeof arguments, "%s stack:stack=4", kernels);
    const outcome *o = run(arguments);
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->err, "WRONG"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(advice_as_json),
        cmocka_unit_test(advice_as_text),
        cmocka_unit_test(words_are_quoted_for_a_shell),
        cmocka_unit_test(the_command_is_the_same_to_a_shell),
        cmocka_unit_test(a_name_does_not_steer_the_terminal),
        cmocka_unit_test(nothing_right_enough_is_status_1),
        cmocka_unit_test(a_limit_that_rays_cannot_show_is_said),
        cmocka_unit_test(who_is_right_stays_beside_one_that_is_wrong),
        cmocka_unit_test(kernels_are_not_dropped_for_an_intersector),
        cmocka_unit_test(a_few_primitives_are_advised),
        cmocka_unit_test(memory_is_bounded_by_turns),
        cmocka_unit_test(an_interrupt_leaves_the_best_so_far),
        cmocka_unit_test(a_time_is_kept),
        cmocka_unit_test(what_cannot_be_done_is_refused),
        cmocka_unit_test(kernels_take_what_is_given),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
