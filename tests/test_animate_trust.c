/* What an animation must not take on trust: that layouts and trees which follow are right, that
 * what was right in the first round stays so, that each set of rays was judged, that figures are of
 * the frame and the clock that they say. Bugs are planted in device code, and a builder changes its
 * ways (plugin/fickle). */
#include "framework/builder/registry.h"
#include "framework/tasks/animate.h"
#include "tests/device_fixture.h"
#include "tests/table_fixture.h"

/* ---- bugs in device code, through the program ---- */

typedef struct plant {
    const char *find, *with; /* `find` stands in the file once */
} plant;

/* The file with the bugs, into folder NAME of the test's. */
static void write_planted(const char *source, const char *name, const plant *plants, int count)
{
    static char text[65536], with_bug[65536];
    char path[512], planted[128];
    snprintf(path, sizeof path, "%s/%s", BB_TEST_SOURCE_DIR, source);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    for (int i = 0; i < count; i++) {
        char *at = strstr(text, plants[i].find);
        if (at == NULL || strstr(at + 1, plants[i].find) != NULL)
            fail_msg("%s: '%s' must stand there once: mend the plant", source, plants[i].find);
        snprintf(with_bug, sizeof with_bug, "%.*s%s%s", (int)(at - text), text, plants[i].with,
                 at + strlen(plants[i].find));
        memcpy(text, with_bug, sizeof text);
    }
    snprintf(path, sizeof path, "mkdir -p %s/%s", folder, name);
    assert_int_equal(system(path), 0);
    snprintf(planted, sizeof planted, "%s%s", name, strrchr(source, '/'));
    write_file(planted, text, strlen(text));
}

/* `animate` with device code from folder NAME: its table. Exit status 1. */
static bb_table *animate_planted(const char *name, const char *arguments)
{
    char command[512], path[64];
    snprintf(command, sizeof command,
             "animate %s --size 16x16 --max-rays 200 --repeats 1 --quiet --kernels-from %s "
             "--out %s.out",
             arguments, name, name);
    const outcome *o = run(command);
    if (o->exit_status != 1)
        fail_msg("%s: exit %d\n%s%s", name, o->exit_status, o->out, o->err);
    snprintf(path, sizeof path, "%s.out/animate.json", name);
    return read_table(path);
}

/* The only scene's name. */
static const char *scene_of(const bb_table *table)
{
    return bb_table_name(table, bb_table_row_count(table) - 1, BB_SCENE);
}

static bb_cell method_of(const bb_table *table, const char *name)
{
    return (bb_cell){{[BB_SCENE] = scene_of(table), [BB_BUILDER] = name}};
}

static const char *text_of(const bb_table *table, bb_cell cell, const char *column)
{
    return bb_table_get_text(table, bb_table_find(table, cell), column);
}

/* None with wrong answers or a fault is among the fastest, of which there are some. */
static void expect_no_winner(const bb_table *table, const char *way)
{
    uint32_t winners = 0;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const char *fastest = bb_table_get_text(table, row, "fastest");
        winners += fastest[0] != '\0';
        assert_true(strncmp(fastest, way, strlen(way)) != 0);
    }
    assert_true(winners > 0);
}

/* Wrong answers in frame f of those through a kernel. */
static double wrong_in(const bb_table *table, const char *method, const char *kernel, int f)
{
    char frame[8];
    bb_cell cell = method_of(table, method);
    snprintf(frame, sizeof frame, "%d", f);
    cell.names[BB_FRAME] = frame;
    cell.names[BB_INTERSECTOR] = kernel;
    return number(table, cell, "wrong");
}

/* How many frames a method did. */
static int frames_of(const bb_table *table, const char *method)
{
    int count = 0;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        count += bb_table_get_text(table, row, "way")[0] != '\0' &&
                 strcmp(bb_table_name(table, row, BB_BUILDER), method) == 0;
    return count;
}

/* In the frames where it follows, of the method and the kernel that it is made for. */
static void a_layout_that_follows_wrongly_is_found(void **state)
{
    (void)state;
    write_planted(
        "kernels/layout_wide_follow.cl", "places",
        &(plant){"for (uint c = 0; c < BB_WIDTH; c++)", "for (uint c = 2; c < BB_WIDTH; c++)"}, 1);
    bb_table *table = animate_planted("places", "--scene twist:n=300,frames=3 --builder lbvh,"
                                                "lbvh+refit --kernel stack,stack8 --rays primary,"
                                                "random");
    double sum = 0;
    for (int f = 0; f < 3; f++) {
        const double wrong = wrong_in(table, "lbvh+refit", "stack8", f);
        sum += wrong;
        assert_true((wrong > 0) == (f > 0));
        assert_true(wrong_in(table, "lbvh+refit", "stack", f) == 0);
        assert_true(wrong_in(table, "lbvh", "stack8", f) == 0);
        assert_true(wrong_in(table, "lbvh", "stack", f) == 0);
    }
    assert_true(number(table, method_of(table, "lbvh+refit"), "wrong_answers") == sum);
    assert_true(number(table, method_of(table, "lbvh"), "wrong_answers") == 0);
    assert_string_equal(text_of(table, method_of(table, "lbvh+refit"), "status"), "");
    expect_no_winner(table, "lbvh+refit, stack8");
    bb_table_free(table);
}

/* Whichever way work-groups hand over. */
static void a_refit_that_loses_boxes_is_found(void **state)
{
    (void)state;
    static const plant plants[] = {
        {"for (uint c = first; c != end;", "for (uint c = nodes[first].skip; c != end;"},
        {"        e = bb_joined(e, child);",
         "        if (children > 0)\n            e = bb_joined(e, child);"},
    };
    write_planted("builders/common/refit.cl", "boxes", plants, 2);
    bb_table *table =
        animate_planted("boxes", "--scene twist:n=300,frames=3 --builder lbvh,lbvh+refit "
                                 "--kernel stack --rays primary");
    const bb_cell refit = method_of(table, "lbvh+refit"), lbvh = method_of(table, "lbvh");
    const char *refused = text_of(table, refit, "refused");
    if (strncmp(refused, "frame 1: ", 9) != 0 || strstr(refused, "contain") == NULL)
        fail_msg("lbvh+refit: '%s'", refused);
    assert_int_equal(frames_of(table, "lbvh+refit"), 1);
    assert_string_equal(text_of(table, lbvh, "refused"), "");
    assert_int_equal(frames_of(table, "lbvh"), 3);
    assert_string_equal(text_of(table, refit, "status"), "failed");
    assert_string_equal(text_of(table, lbvh, "status"), "");
    expect_no_winner(table, "lbvh+refit");
    bb_table_free(table);
    const outcome *o = run("report --markdown boxes.out/animate.json");
    assert_non_null(strstr(o->out, "**lbvh+refit failed: frame 1: "));
}

/* Each kind of wrong answer by itself: a distance that is off by a thousandth, on the right
 * primitive; no hit; hits of rays that have none. In the room each ray has one. */
static void wrong_answers_of_each_kind_count(void **state)
{
    (void)state;
    static const char room[] = "--scene car:room=interior:n=1000,frames=2",
                      outside[] = "--scene twist:n=300,frames=2";
    static const struct {
        const char *name, *source, *scene;
        plant plant;
    } cases[] = {
        {"far",
         "kernels/search.clh",
         room,
         {"bb_lanes t = bb_primitive(", "bb_lanes t = 1.001f * bb_primitive("}},
        {"none",
         "kernels/search.clh",
         room,
         {"bb_lanes t = bb_primitive(", "bb_lanes t = INFINITY + bb_primitive("}},
        {"all",
         "kernels/query_closest.clh",
         outside,
         {"    result->prim = f->prim;", "    result->prim = f->prim != BB_NONE ? f->prim : 0u;\n"
                                         "    result->t = f->prim != BB_NONE ? result->t : 1.0f;"}},
    };
    for (int i = 0; i < 3; i++) {
        char arguments[128];
        snprintf(arguments, sizeof arguments, "%s --builder lbvh --kernel stack --rays primary",
                 cases[i].scene);
        write_planted(cases[i].source, cases[i].name, &cases[i].plant, 1);
        bb_table *table = animate_planted(cases[i].name, arguments);
        for (int f = 0; f < 2; f++) {
            double wrong = wrong_in(table, "lbvh", "stack", f);
            if (cases[i].scene == room ? wrong != 16 * 16 : wrong <= 0 || wrong >= 16 * 16)
                fail_msg("%s, frame %d: %g wrong", cases[i].name, f, wrong);
        }
        assert_true(number(table, method_of(table, "lbvh"), "answers") == 2 * 16 * 16);
        bb_table_free(table);
    }
}

/* ---- methods ---- */

static bb_animate_result *animate(const char *scene_name, const char *const *builders,
                                  uint32_t count)
{
    static const char *const kernels[] = {"stack", "stack8"};
    static const char *const rays[] = {"primary", "random:count=300", "diffuse"};
    const bb_animate_request request = {.device = device,
                                        .builders = builders,
                                        .builder_count = count,
                                        .kernels = kernels,
                                        .kernel_count = 2,
                                        .rays = rays,
                                        .ray_count = 3,
                                        .intersector = "exact",
                                        .width = 16,
                                        .height = 16,
                                        .max_rays = 200,
                                        .last = UINT32_MAX,
                                        .repeats = 2,
                                        .seed = 3,
                                        .quiet = true};
    bb_animate_result *result = calloc(1, sizeof *result);
    bb_scene *scene;
    assert_non_null(result);
    ASSERT_OK(bb_scene_load(scene_name, &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    ASSERT_OK(bb_animate_run(&request, scene, result));
    bb_scene_free(scene);
    assert_int_equal(result->rounds, 2);
    return result;
}

static void release(bb_animate_result *result)
{
    bb_animate_release(result);
    free(result);
}

/* What is wrong in the first round, or another thing in a later one; it wins nothing. */
static void what_does_not_hold_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *builder, *words[2];
        uint32_t done;
    } cases[] = {
        {"wreck:above=1,how=wrong", {"frame 0: ", "contain"}, 0},
        {"fickle:how=shrinks", {"frame 0: ", "stack: other answers than the first time"}, 4},
        {"fickle:how=gives-up", {"frame 1: ", "rebuilt here, but updated the first time"}, 4},
    };
    const char *builders[4] = {"lbvh"};
    for (int i = 0; i < 3; i++)
        builders[i + 1] = cases[i].builder;
    bb_animate_result *result = animate("twist:n=100,frames=4", builders, 4);
    assert_string_equal(result->methods[0].refused, "");
    assert_false(result->methods[0].failed);
    for (int i = 0; i < 3; i++) {
        const bb_animate_method *method = &result->methods[i + 1];
        if (strncmp(method->refused, cases[i].words[0], strlen(cases[i].words[0])) != 0 ||
            strstr(method->refused, cases[i].words[1]) == NULL)
            fail_msg("%s: '%s'", cases[i].builder, method->refused);
        assert_true(method->failed);
        assert_int_equal(method->done, cases[i].done);
        assert_int_equal(bb_animate_sum(result, method).wrong, 0); /* in what was judged */
    }
    for (uint32_t i = 0; i < 3; i++)
        assert_int_equal(bb_animate_winner(result, i, 1), 0);
    assert_int_equal(bb_animate_wrong(result), 0);
    assert_int_equal(bb_animate_failed(result), 3);
    release(result);
}

/* ---- figures ---- */

static void all_sets_of_rays_are_judged(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh+refit", "fickle"};
    bb_animate_result *result = animate("car:room=interior:n=1000,frames=3", builders, 2);
    for (uint32_t m = 0; m < 2; m++)
        for (uint32_t f = 0; f < 3; f++) {
            uint64_t rays = 0;
            for (int i = 0; i < 3; i++) {
                assert_true(result->states[f].rays[i] > 0);
                rays += result->states[f].rays[i];
            }
            for (int k = 0; k < 2; k++)
                assert_int_equal(result->methods[m].frames[f].traces[k].checked, rays);
        }
    release(result);
}

/* Of each frame: a tree of the same builder, made for it, costs the same. */
static void yardsticks_are_of_their_frame(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh", "sah"};
    bb_animate_result *result = animate("crowd:kind=explode,n=300,frames=5", builders, 2);
    uint32_t found = 0;
    for (uint32_t y = 0; y < result->yardstick_count; y++)
        for (uint32_t m = 0; m < 2; m++)
            for (uint32_t f = 0; f < 5 && strcmp(result->yardsticks[y], builders[m]) == 0; f++) {
                const bb_animate_state *at = &result->states[f];
                assert_true(at->fresh[y] == result->methods[m].frames[f].sah);
                assert_true(at->fresh_best <= at->fresh[y]);
                assert_true(f == 0 || at->fresh[y] != result->states[f - 1].fresh[y]);
                found++;
            }
    assert_int_equal(found, 2 * 5);
    release(result);
}

/* Adds what a frame took in a round, and holds its figures to each other. */
static void add_frame(const bb_animate_result *result, const bb_animate_method *method, uint32_t f,
                      uint32_t round, double *sum)
{
    const bb_animate_frame *frame = &method->frames[f];
    bool on_host = strcmp(method->builder, "lbvh+refit") != 0, kept = frame->way == BB_KEPT;
    double update = frame->update[round], phases = 0;
    for (uint32_t p = 0; p < frame->phase_count; p++)
        phases += frame->phase_ms[p][round];
    if ((kept ? update != 0 : phases <= 0 || phases > update) ||
        (frame->transfer[round] > 0) != (on_host && !kept))
        fail_msg("%s, frame %u: update %g ms, phases %g ms, transfer %g ms", method->builder, f,
                 update, phases, frame->transfer[round]);
    *sum += update + frame->transfer[round];
    for (uint32_t k = 0; k < result->kernel_count; k++) {
        const bb_animate_trace *trace = &frame->traces[k];
        *sum += trace->layout[round];
        if (!kept)
            assert_true(trace->layout[round] > 0.002);
        for (uint32_t i = 0; i < result->ray_count; i++)
            *sum += trace->rays[i][round];
    }
}

/* All in ms: phases within updates, all that was timed within the time that it took together, and
 * nothing too short to be true; transfers of trees from the host, where there is another one. */
static void times_are_in_their_unit(void **state)
{
    (void)state;
    static const char *const builders[] = {"gs", "lbvh+refit", "sah", "fickle:how=tries"};
    static const char *const scenes[] = {"crowd:kind=explode,n=2000,frames=4",
                                         "crowd:kind=still,n=300,frames=3"};
    for (int s = 0; s < 2; s++) {
        bb_animate_result *result = animate(scenes[s], builders, 4);
        double sum = 0;
        for (uint32_t m = 0; m < 4; m++) {
            const bb_animate_method *method = &result->methods[m];
            assert_string_equal(method->refused, "");
            assert_int_equal(method->done, result->frame_count);
            for (uint32_t f = 0; f < method->done; f++)
                for (uint32_t round = 0; round <= 2; round++)
                    add_frame(result, method, f, round, &sum);
        }
        for (uint32_t f = 1; f < 4 && s == 0; f++)
            assert_true(bb_animate_median(result, result->methods[3].frames[f].update) >= 20);
        assert_true(sum < result->ms);
        release(result);
    }
}

static int set_up(void **state)
{
    if (make_folder(state) == 0 && open_device(state) == 0 &&
        bb_plugin_load(BB_TEST_PLUGIN_DIR "/wreck.so") == BB_OK &&
        bb_plugin_load(BB_TEST_PLUGIN_DIR "/fickle.so") == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

static int tear_down(void **state)
{
    return close_device(state) == 0 ? remove_folder(state) : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_layout_that_follows_wrongly_is_found),
        cmocka_unit_test(a_refit_that_loses_boxes_is_found),
        cmocka_unit_test(wrong_answers_of_each_kind_count),
        cmocka_unit_test(what_does_not_hold_is_refused),
        cmocka_unit_test(all_sets_of_rays_are_judged),
        cmocka_unit_test(yardsticks_are_of_their_frame),
        cmocka_unit_test(times_are_in_their_unit),
    };
    return cmocka_run_group_tests_name("animations on trust", tests, set_up, tear_down);
}
