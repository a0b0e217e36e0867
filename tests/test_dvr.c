/* `bvhbench volume` from outside: what it measures, writes and refuses. */
#include "tests/table_fixture.h"

/* As `volume --json` printed it. */
static bb_table *printed_table(const outcome *o)
{
    bb_table *table;
    assert_int_equal(o->exit_status, 0);
    ASSERT_OK(bb_table_parse(o->out, "printed", &table));
    return table;
}

/* Rows, by their names. */
static bb_cell scene_cell(const char *scene)
{
    return (bb_cell){{[BB_SCENE] = scene}};
}

static bb_cell question_cell(const char *scene, const char *question)
{
    return (bb_cell){{[BB_SCENE] = scene, [BB_QUESTION] = question}};
}

static bb_cell way_cell(const char *scene, const char *builder, const char *kernel)
{
    return (bb_cell){{[BB_SCENE] = scene, [BB_BUILDER] = builder, [BB_INTERSECTOR] = kernel}};
}

static const char *text(const bb_table *table, bb_cell cell, const char *column)
{
    const uint32_t row = bb_table_find(table, cell);
    assert_int_not_equal(row, BB_NO_ROW);
    return bb_table_get_text(table, row, column);
}

static void expect_phases(const bb_table *table, const char *scene)
{
    static const char *const phases[] = {"vote", "compact", "codes", "boxes", "sort", "link"};
    for (size_t i = 0; i < sizeof phases / sizeof phases[0]; i++) {
        const bb_cell cell = {{[BB_SCENE] = scene, [BB_BUILDER] = "vlbvh", [BB_MAKER] = phases[i]}};
        assert_true(number(table, cell, "phase_ms") >= 0);
    }
}

/* All ways were measured and give the picture that there is without a tree. */
static void expect_ways(const bb_table *table, const char *scene, int ways)
{
    const double all = number(table, way_cell(scene, NULL, "no tree"), "tests_per_item");
    int found = 0;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const char *builder = bb_table_name(table, row, BB_BUILDER);
        const bb_cell way = way_cell(scene, builder, bb_table_name(table, row, BB_INTERSECTOR));
        if (way.names[BB_INTERSECTOR][0] == '\0' || bb_table_find(table, way) != row)
            continue;
        found++;
        assert_string_equal(bb_table_get_text(table, row, "refused"), "");
        assert_true(number(table, way, "answer_ms") >= 0);
        const double rate =
            number(table, way, "mitems_per_s") * number(table, way, "tests_per_item");
        assert_true(fabs(number(table, way, "msamples_per_s") / rate - 1) < 1e-9);
        assert_true(number(table, way, "differ") == 0);
        if (builder[0] == '\0')
            continue;
        assert_true(number(table, way, "largest_difference") == 0);
        assert_true(number(table, way, "largest_difference_8_bits") == 0);
        assert_true(number(table, way, "tests_per_item") <= all);
        assert_true(number(table, way, "build_ms") > 0);
        assert_true(number(table, way, "layout_ms") >= 0);
    }
    assert_int_equal(found, ways);
    expect_phases(table, scene);
    assert_true(number(table, scene_cell(scene), "copy_ms") >= 0);
    assert_true(number(table, scene_cell(scene), "volume_bytes") > 0);
}

/* Errors fall with the step; each step takes more samples than the longer one. */
static void expect_accuracy(const bb_table *table, const char *scene)
{
    const bb_cell steps[] = {question_cell(scene, "step 2"), question_cell(scene, "step 1"),
                             question_cell(scene, "step 0.5")};
    const double most = number(table, steps[2], "largest_error");
    assert_true(number(table, steps[0], "rms_error") > number(table, steps[2], "rms_error"));
    assert_true(number(table, steps[2], "rms_error") > 0);
    assert_true(number(table, steps[2], "rms_error") < most);
    assert_true(number(table, steps[0], "largest_error") > most);
    assert_true(number(table, scene_cell(scene), "converged_to") < most);
    for (int i = 0; i < 3; i++) {
        assert_true(number(table, steps[i], "step") == 2.0 / (1 << i));
        assert_true(number(table, steps[i], "picture_ms") >= 0);
        assert_true(i == 0 || number(table, steps[i - 1], "samples_per_ray") <
                                  number(table, steps[i], "samples_per_ray"));
    }
}

#define BONE "nbody:n=40, transfer function bone"
#define FULL "nbody:n=40, transfer function full"

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
    assert_non_null(strstr(o->out, "Phases of builds"));
    bb_table *table = read_table("made/volume.json");
    static const char *const scenes[] = {BONE, FULL};
    for (int s = 0; s < 2; s++) {
        expect_ways(table, scenes[s], 5);
        expect_accuracy(table, scenes[s]);
        assert_true(number(table, scene_cell(scenes[s]), "pixels") == 3 * 24 * 20);
        assert_true(number(table, scene_cell(scenes[s]), "rounds") == 6);
        assert_string_equal(text(table, scene_cell(scenes[s]), "voxels"), "40 x 40 x 40");
    }
    assert_true(number(table, scene_cell(FULL), "bricks_seen") ==
                number(table, scene_cell(FULL), "bricks"));
    assert_true(number(table, scene_cell(FULL), "bricks_seen_percent") == 100);
    /* of each scene in 7 rounds 2 builds, 4 layouts, and 3 pictures by 5 ways */
    assert_true(bb_table_get_number(table, 0, "timings") == 2 * 7 * (2 + 4 + 3 * 5));
    assert_true(bb_table_get_number(table, 0, "clock_complaints") == 0);
    assert_true(bb_table_get_number(table, 0, "step") == 0.5);
    assert_true(bb_table_get_number(table, 0, "cutoff") == 0);
    assert_string_equal(text(table, question_cell(BONE, "front"), "picture"),
                        "volume-1-bone-front.png");
    bb_table_free(table);
    static char png[1 << 16];
    assert_true(read_file("made/volume-1-bone-front.png", png, sizeof png) > 100);
    assert_true(read_file("made/volume-2-full-inside.png", png, sizeof png) > 100);
    expect(0, "report made/volume.json --table", "Accuracy");
    expect(0, "report made/volume.json --markdown", "## " FULL);
    expect(0, "report made/volume.json --csv", BONE);
    expect(0, "compare made/volume.json made/volume.json", "nothing is worse");
}

/* Ways and accuracy alone. */
static void less_is_printed_briefly(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=34 --builder vlbvh --kernel stack --size 12x12 "
                           "--steps 2,1 --repeats 1 --brief");
    assert_int_equal(o->exit_status, 0);
    assert_non_null(strstr(o->out, "Ways\n"));
    assert_non_null(strstr(o->out, "Accuracy\n"));
    assert_null(strstr(o->out, "Phases of builds"));
    assert_null(strstr(o->out, "Trees\n"));
    assert_null(strstr(o->out, "medians"));
}

/* The same tree with memory for all bricks, or for those that are seen alone. */
static void room_is_for_all_bricks(void **state)
{
    (void)state;
    const char *scene = "nbody:n=70, transfer function shells";
    bb_table *table =
        printed_table(run("volume --scene nbody:n=70 --transfer shells --builder "
                          "vlbvh,vlbvh:room=seen --kernel stack --size 12x12 --steps none "
                          "--repeats 1 --json"));
    const double all = number(table, way_cell(scene, "vlbvh", "stack"), "bytes");
    const double seen = number(table, way_cell(scene, "vlbvh:room=seen", "stack"), "bytes");
    const double share = number(table, scene_cell(scene), "bricks_seen_percent");
    assert_true(share < 60 && seen < all);
    assert_true(number(table, way_cell(scene, "vlbvh:room=seen", "stack"), "differ") == 0);
    assert_true(number(table, way_cell(scene, "vlbvh", NULL), "tree_bytes") ==
                number(table, way_cell(scene, "vlbvh:room=seen", NULL), "tree_bytes"));
    bb_table_free(table);
}

/* No tree and a blank picture; and back again. */
static void nothing_is_seen_of_an_empty_volume(void **state)
{
    (void)state;
    const char *scene = "nbody:n=40,transfer=empty, transfer function empty";
    bb_table *table =
        printed_table(run("volume --scene nbody:n=40,transfer=empty --builder vlbvh,lbvh --kernel "
                          "stack --size 16x16 --steps none --repeats 1 --json"));
    assert_true(number(table, scene_cell(scene), "bricks_seen") == 0);
    const bb_cell vlbvh = way_cell(scene, "vlbvh", "stack");
    assert_true(number(table, vlbvh, "differ") == 0);
    assert_int_equal(bb_table_find(table, way_cell(scene, "vlbvh", NULL)), BB_NO_ROW); /* no tree */
    assert_non_null(
        strstr(text(table, way_cell(scene, "lbvh", "stack"), "refused"), "nothing to build over"));
    bb_table_free(table);
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
    assert_non_null(strstr(o->out, "field made"));
    static const char scene[] = "tets:side=6,shape=shell, transfer function ramp";
    static const char *const builders[] = {"lbvh", "olbvh"};
    static const char *const searches[] = {"skip", "octree", "octree:boundary=no"};
    bb_table *table = read_table("mesh/volume.json");
    const bb_cell mesh = scene_cell(scene);
    assert_string_equal(text(table, mesh, "field"), "made");
    assert_true(number(table, mesh, "boundary_tetrahedra") > 100 &&
                number(table, mesh, "tetrahedra") > 300 && number(table, mesh, "vertices") > 100);
    const double samples = number(table, way_cell(scene, "lbvh", "skip"), "tests_per_item");
    assert_true(samples > 1);
    for (int w = 0; w < 6; w++) {
        const bb_cell way = way_cell(scene, builders[w / 3], searches[w % 3]);
        const bb_cell tree = way_cell(scene, builders[w / 3], NULL);
        if (w == 1 || w == 2) {
            assert_non_null(strstr(text(table, way, "refused"), "'cells'"));
            continue;
        }
        assert_true(number(table, way, "largest_difference") == 0);
        assert_true(number(table, way, "differ") == 0);
        assert_true(number(table, way, "tests_per_item") == samples);
        assert_true(number(table, way, "build_ms") > 0 && number(table, way, "answer_ms") > 0);
        assert_true(number(table, tree, "tree_bytes") > 0 &&
                    number(table, tree, "references") > 300);
    }
    expect_accuracy(table, scene);
    bb_table_free(table);
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
    bb_table *table = printed_table(o);
    const char *scene = bb_table_name(table, 1, BB_SCENE);
    assert_true(number(table, way_cell(scene, "vlbvh", "stack"), "answer_ms") > 0);
    bb_table_free(table);
}

static uint32_t scene_count(const bb_table *table)
{
    uint32_t count = 0;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        count += !isnan(bb_table_get_number(table, row, "pictures"));
    return count;
}

/* What fails later leaves what was measured before. */
static void what_was_measured_is_kept(void **state)
{
    (void)state;
    const outcome *o = run("volume --scene nbody:n=34 --scene cube --builder vlbvh --kernel stack "
                           "--size 12x12 --steps none --repeats 1 --out kept");
    assert_int_equal(o->exit_status, 2);
    assert_non_null(strstr(o->err, "cube: is neither a volume nor a mesh"));
    bb_table *table = read_table("kept/volume.json");
    assert_int_equal(scene_count(table), 1);
    bb_table_free(table);
}

static void steps_that_nearly_agree_are_two(void **state)
{
    (void)state;
    bb_table *table =
        printed_table(run("volume --scene nbody:n=34 --builder vlbvh --kernel stack --size 8x8 "
                          "--steps 1.0000002,1.0000001 --repeats 1 --json"));
    const char *scene = bb_table_name(table, 1, BB_SCENE);
    static const char *const steps[] = {"step 1.0000002", "step 1.0000001"};
    for (int i = 0; i < 2; i++) {
        const bb_cell cell = {{[BB_SCENE] = scene, [BB_QUESTION] = steps[i]}};
        assert_true(number(table, cell, "step") == (i == 0 ? 1.0000002 : 1.0000001));
    }
    bb_table_free(table);
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
    bb_table *table =
        printed_table(run("volume --scene nbody:n=34 --turns 3 --builder vlbvh --kernel stack8 "
                          "--size 12x12 --steps none --repeats 1 --cutoff 0.02 --json"));
    const char *scene = bb_table_name(table, 1, BB_SCENE);
    assert_true(number(table, scene_cell(scene), "pictures") == 9);
    assert_true(bb_table_get_number(table, 0, "cutoff") == 0.02);
    expect_ways(table, scene, 2);
    bb_table_free(table);
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
        cmocka_unit_test(less_is_printed_briefly),
        cmocka_unit_test(room_is_for_all_bricks),
        cmocka_unit_test(nothing_is_seen_of_an_empty_volume),
        cmocka_unit_test(meshes_are_compared),
        cmocka_unit_test(ways_that_cannot_say_so),
        cmocka_unit_test(what_was_measured_is_kept),
        cmocka_unit_test(steps_that_nearly_agree_are_two),
        cmocka_unit_test(names_and_paths_are_told_apart),
        cmocka_unit_test(the_paper_turns_the_volume),
        cmocka_unit_test(what_makes_no_sense_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
