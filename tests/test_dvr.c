/* `bvhbench volume` from outside: what it measures, writes and refuses. */
#include "tests/program_fixture.h"

static cJSON *read_json(const char *name)
{
    static char text[1 << 20];
    read_file(name, text, sizeof text);
    cJSON *root = cJSON_Parse(text);
    assert_non_null(root);
    return root;
}

static double number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    if (!cJSON_IsNumber(item))
        fail_msg("there is no number '%s'", name);
    return item->valuedouble;
}

static double median(const cJSON *way, const char *name)
{
    return number(cJSON_GetObjectItem(way, name), "median");
}

static const char *text(const cJSON *object, const char *name)
{
    const char *value = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return value != NULL ? value : "";
}

static void expect_phases(const cJSON *way, const char *const *names)
{
    const cJSON *phases = cJSON_GetObjectItem(way, "phases_ms");
    for (; *names != NULL; names++)
        assert_true(median(phases, *names) >= 0);
}

/* All ways were measured and give the picture that there is without a tree. */
static void expect_ways(const cJSON *result, int ways)
{
    static const char *const phases[] = {"vote", "compact", "codes", "boxes", "sort", "link", NULL};
    const cJSON *list = cJSON_GetObjectItem(result, "ways"), *way;
    assert_int_equal(cJSON_GetArraySize(list), ways);
    double all = number(cJSON_GetArrayItem(list, 0), "samples_per_ray");
    assert_true(cJSON_IsNull(cJSON_GetObjectItem(cJSON_GetArrayItem(list, 0), "builder")));
    cJSON_ArrayForEach(way, list)
    {
        assert_null(cJSON_GetObjectItem(way, "refused"));
        assert_true(median(way, "picture_ms") >= 0);
        if (way == list->child)
            continue;
        assert_true(number(way, "largest_difference") == 0);
        assert_true(number(way, "pixels_that_differ") == 0);
        assert_true(number(way, "samples_per_ray") <= all);
        assert_true(median(way, "build_ms") > 0);
        assert_true(number(cJSON_GetObjectItem(way, "all_ratio"), "median") >=
                    number(cJSON_GetObjectItem(way, "picture_ratio"), "median"));
        if (strcmp(text(way, "builder"), "vlbvh") == 0)
            expect_phases(way, phases);
    }
}

/* Errors fall with the step; each step takes more samples than the longer one. */
static void expect_accuracy(const cJSON *result, int steps)
{
    const cJSON *list = cJSON_GetObjectItem(result, "accuracy");
    assert_int_equal(cJSON_GetArraySize(list), steps);
    const cJSON *first = cJSON_GetArrayItem(list, 0), *last = cJSON_GetArrayItem(list, steps - 1);
    assert_true(number(first, "rms") > number(last, "rms") && number(last, "rms") > 0);
    assert_true(number(first, "most") > number(last, "most"));
    assert_true(number(first, "samples_per_ray") < number(last, "samples_per_ray"));
    assert_true(number(result, "converged_to") < number(last, "most"));
}

static void volumes_are_compared(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=40 --transfer bone,full --builder vlbvh,lbvh "
                           "--kernel stack,stackless --size 24x20 --steps 2,1,0.5 --repeats 6 "
                           "--out made");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    assert_non_null(strstr(o->out, "nbody:n=40, transfer function bone"));
    assert_non_null(strstr(o->out, "transfer function full"));
    cJSON *root = read_json("made/volume.json");
    assert_string_equal(text(root, "schema"), "bvhbench-volume/1");
    const cJSON *results = cJSON_GetObjectItem(root, "results"), *result;
    assert_int_equal(cJSON_GetArraySize(results), 2);
    cJSON_ArrayForEach(result, results)
    {
        expect_ways(result, 5);
        expect_accuracy(result, 3);
        assert_true(number(result, "pixels") == 3 * 24 * 20);
    }
    assert_true(number(cJSON_GetArrayItem(results, 1), "bricks_seen") ==
                number(cJSON_GetArrayItem(results, 1), "bricks"));
    cJSON_Delete(root);
    static char png[1 << 16];
    assert_true(read_file("made/volume-1-bone-front.png", png, sizeof png) > 100);
    assert_true(read_file("made/volume-2-full-inside.png", png, sizeof png) > 100);
}

/* No tree and a blank picture; and back again. */
static void nothing_is_seen_of_an_empty_volume(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=40,transfer=empty --builder vlbvh,lbvh --kernel "
                           "stack --size 16x16 --steps none --repeats 1 --json");
    assert_int_equal(o->exit_status, 0);
    cJSON *root = cJSON_Parse(o->out);
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    const cJSON *ways = cJSON_GetObjectItem(result, "ways");
    assert_true(number(result, "bricks_seen") == 0);
    const cJSON *vlbvh = cJSON_GetArrayItem(ways, 1), *lbvh = cJSON_GetArrayItem(ways, 2);
    assert_true(number(vlbvh, "nodes") == 0 && number(vlbvh, "pixels_that_differ") == 0);
    assert_non_null(strstr(text(lbvh, "refused"), "nothing to build over"));
    cJSON_Delete(root);
}

/* Of a mesh all ways give the picture of the first; only trees with cells are searched by these. */
static void meshes_are_compared(void **state)
{
    (void)state;
    const outcome *o =
        run("volume --scene tets:side=6,shape=shell --builder lbvh,olbvh --search "
            "skip,octree,octree:boundary=no --size 24x20 --steps 2,1,0.5 --repeats 6 --out mesh");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    assert_non_null(strstr(o->out, "field 'made'"));
    cJSON *root = read_json("mesh/volume.json");
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    const cJSON *ways = cJSON_GetObjectItem(result, "ways");
    assert_int_equal(cJSON_GetArraySize(ways), 6);
    assert_string_equal(text(result, "field"), "made");
    assert_true(number(result, "boundary_tetrahedra") > 100 && number(result, "tetrahedra") > 300);
    double samples = number(cJSON_GetArrayItem(ways, 0), "samples_per_ray");
    assert_true(samples > 1);
    for (int w = 0; w < 6; w++) {
        const cJSON *way = cJSON_GetArrayItem(ways, w);
        if (w == 1 || w == 2) {
            assert_non_null(strstr(text(way, "refused"), "'cells'"));
            continue;
        }
        assert_true(number(way, "largest_difference") == 0);
        assert_true(number(way, "pixels_that_differ") == 0);
        assert_true(number(way, "samples_per_ray") == samples);
        assert_true(median(way, "build_ms") > 0 && median(way, "picture_ms") > 0);
        assert_true(number(way, "tree_bytes") > 0 && number(way, "references") > 300);
    }
    expect_accuracy(result, 3);
    cJSON_Delete(root);
    static char png[1 << 16];
    assert_true(read_file("mesh/volume-1-ramp-above.png", png, sizeof png) > 100);
}

/* Ways that cannot, beside one that can: each says why. */
static void ways_that_cannot_say_so(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=40,transfer=empty --builder vlbvh+rotate,vlbvh "
                           "--kernel stack --size 16x16 --steps none --repeats 1 --json");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "there is nothing to build over"));
    o = run("volume --scene nbody:n=70,brick=4 --builder vlbvh --kernel stack:stack=4,stack --size "
            "32x32 --steps none --repeats 1 --json");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "its stack was too small for"));
    cJSON *root = cJSON_Parse(o->out);
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    const cJSON *ways = cJSON_GetObjectItem(result, "ways");
    assert_true(median(cJSON_GetArrayItem(ways, 2), "picture_ms") > 0);
    cJSON_Delete(root);
}

/* What fails later leaves what was measured before. */
static void what_was_measured_is_kept(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=34 --scene cube --builder vlbvh --kernel stack "
                           "--size 12x12 --steps none --repeats 1 --out kept");
    assert_int_equal(o->exit_status, 2);
    assert_non_null(strstr(o->err, "cube: is neither a volume nor a mesh"));
    cJSON *root = read_json("kept/volume.json");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(root, "results")), 1);
    cJSON_Delete(root);
}

/* A path as a generator's parameter, and a file that is called as a generator is. */
static void names_and_paths_are_told_apart(void **state)
{
    (void)state;
    write_file("t.txt", "0 0.1\n", 6);
    write_file("nbody", "x", 1);
    const outcome *o = run("volume --scene nbody:n=34,transfer=./t.txt --builder vlbvh --kernel "
                           "stack --size 12x12 --steps none --repeats 1");
    if (o->exit_status != 0 || strstr(o->out, "transfer function t.txt") == NULL)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
}

static void the_paper_turns_the_volume(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=34 --turns 3 --builder vlbvh --kernel stack8 "
                           "--size 12x12 --steps none --repeats 1 --cutoff 0.02 --json");
    assert_int_equal(o->exit_status, 0);
    cJSON *root = cJSON_Parse(o->out);
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    assert_true(number(result, "pictures") == 9);
    expect_ways(result, 2);
    cJSON_Delete(root);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    refuses("", "volume", "needs --scene");
    refuses("", "volume --scene cube", "is neither a volume nor a mesh");
    refuses("", "volume --scene tets:side=2 --search octre", "no search 'octre'");
    refuses("", "volume --scene tets:side=2 --search octree:boundary=maybe", "boundary");
    refuses("", "volume --scene tets:side=2 --search skip:boundary=no", "boundary");
    refuses("", "volume --scene tets:side=2 --builder lbvh --search octree", "'cells'");
    refuses("", "volume --scene nbody:n=1", "n=1");
    refuses("", "volume --scene nbody:n=20 --transfer rmp", "unknown transfer function 'rmp'");
    refuses("", "volume --scene nbody:n=20 --view side", "no view 'side'");
    refuses("", "volume --scene nbody:n=20 --view front --turns 2",
            "--view and --turns do not go together");
    refuses("", "volume --scene nbody:n=20 --turns 181", "turns");
    refuses("", "volume --scene nbody:n=20 --step 0", "step");
    refuses("", "volume --scene nbody:n=20 --cutoff 2", "cutoff");
    refuses("", "volume --scene nbody:n=20 --steps 1,2", "must descend");
    refuses("", "volume --scene nbody:n=20 --steps x", "'x' is no number");
    refuses("", "volume --scene nbody:n=20 --builder vlbv", "vlbv");
    refuses("", "volume --scene nbody:n=20 --kernel stak", "stak");
    refuses("", "volume --scene nbody:n=20 --repeats 0", "repeats");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_compared),
        cmocka_unit_test(nothing_is_seen_of_an_empty_volume),
        cmocka_unit_test(meshes_are_compared),
        cmocka_unit_test(ways_that_cannot_say_so),
        cmocka_unit_test(what_was_measured_is_kept),
        cmocka_unit_test(names_and_paths_are_told_apart),
        cmocka_unit_test(the_paper_turns_the_volume),
        cmocka_unit_test(what_makes_no_sense_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
