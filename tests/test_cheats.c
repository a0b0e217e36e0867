/* The judge against tracers that cheat, and against exact answers, from outside: `bvhbench rays`,
 * tests/cheats/cheat_tracer, `bvhbench judge`. Half a minute; BVHBENCH_TEST_SEED gives other rays.
 *
 * The tracer says how many of its answers are plainly wrong. The judge must find nearly all of
 * these, and nothing among the answers that the cheat left alone.
 */
#include "tests/cheats/attack.h"
#include "tests/cheats/scenes.h"
#include "tests/fixture.h"

#include <sys/stat.h>

/* ---- exact answers ---- */

static void exact_answers_are_right(void **state)
{
    (void)state;
    static const char all[] = "primary ao diffuse shadow random edges",
                      open[] = "primary ao diffuse shadow random";
    const struct {
        const char *scene, *workloads;
    } cases[] = {
        {"cube", all},
        {"single", open},
        {"sphere-mesh:n=6", all},
        {"sphere-mesh:n=4,x=1000,y=-500", all},
        {"interior:n=1000", open},
        {"random:n=300", open},
        {"random:n=300,ratio=1000", open},
        {"spheres:n=300", open},
        {"spheres:n=300,state=settled", open},
        {"terrain:n=500", open},
        {"hairball:n=500", open},
        {"awkward:kind=centroids,n=300", open},
        {"awkward:kind=flat,n=300", open},
        {"awkward:kind=axis,n=300", open},
        {"awkward:kind=duplicates,n=300", open},
        {"awkward:kind=outlier,n=300,far=1e4", "primary random:near=1"},
        {"ground.gltf", "primary shadow random:near=1"},
        {"tiny.gltf", "primary random"},
    };
    uint32_t sets = 0, rays = 0;
    size_t step = getenv("BVHBENCH_TEST_SMALL") != NULL ? 3 : 1;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i += step) {
        char workloads[128];
        outcome total = {0};
        snprintf(workloads, sizeof workloads, "%s", cases[i].workloads);
        for (char *rest, *word = strtok_r(workloads, " ", &rest); word != NULL;
             word = strtok_r(NULL, " ", &rest)) {
            const attack a = {cases[i].scene, word, "none", NULL};
            outcome o;
            if (!perform(&a, &o))
                continue;
            if (o.exit_status != 0 || found_in(&o) != 0)
                fail_case(&a, &o, "exact answers are called wrong");
            if (o.t_ulp_max > 0.5001) /* false if it is NAN */
                fail_case(&a, &o, "t is not the nearest float");
            sets++;
            total.rays += o.rays;
            total.hits += o.hits;
            total.ties += o.ties;
            total.margin_limited += o.margin_limited;
        }
        rays += total.rays;
        print_message("%-36s %6u rays, %6u hits, %5u ties, %5u margin limited\n", cases[i].scene,
                      total.rays, total.hits, total.ties, total.margin_limited);
    }
    print_message("%u ray sets, %u rays, seed %llu\n", sets, rays, seed);
    assert_int_equal(failures, 0);
}

/* ---- cheats ---- */

/* More than three, and more than 1 in 20, of the plainly wrong: a few lie where the margin of
 * another primitive is larger. */
static bool is_overlooked(const outcome *o, uint32_t found)
{
    return found + 3 < 0.95 * o->plain;
}

/* Nearly all that is plainly wrong is found, most of it in the right class, and nothing else. */
static void check(const attack *a)
{
    outcome o;
    if (!perform(a, &o))
        return;
    uint32_t found = found_in(&o), of_class = found;
    if (a->class != NULL)
        of_class = strcmp(a->class, "missed") == 0  ? o.missed
                   : strcmp(a->class, "false") == 0 ? o.false_hits
                                                    : o.wrong_t;
    print_message("%-12s %-32s %-16s altered %5u, plainly wrong %5u, found %5u\n", a->cheat,
                  a->scene, a->rays, o.altered, o.plain, found);
    if (o.plain == 0)
        fail_case(a, &o, "the cheat has nothing to gain here");
    else if (found > o.altered)
        fail_case(a, &o, "more is found than there is");
    else if (is_overlooked(&o, found) || o.exit_status != 1)
        fail_case(a, &o, "not found");
    else if (of_class < 0.9 * found)
        fail_case(a, &o, "found as something else");
}

static void check_all(const attack *attacks, size_t count)
{
    size_t step = getenv("BVHBENCH_TEST_SMALL") != NULL ? 3 : 1; /* under sanitizers */
    for (size_t i = 0; i < count; i += step)
        check(&attacks[i]);
    assert_int_equal(failures, 0);
}

#define CHECK_ALL(attacks) check_all(attacks, sizeof(attacks) / sizeof((attacks)[0]))

static void misses_are_found(void **state)
{
    (void)state;
    static const attack attacks[] = {
        {"cube", "primary", "all-miss", "missed"},
        {"cube", "edges", "all-miss", "missed"},
        {"cube", "shadow", "all-miss", "missed"},
        {"sphere-mesh:n=6", "edges", "every-1000", "missed"},
        {"sphere-mesh:n=6", "edges", "every-10", "missed"},
        {"sphere-mesh:n=6", "random", "every-100", "missed"},
        {"interior:n=1000", "primary", "every-1000", "missed"},
        {"random:n=300", "ao", "all-miss", "missed"},
        {"spheres:n=300", "primary", "every-10", "missed"},
        {"spheres:n=300", "shadow", "all-miss", "missed"},
        {"terrain:n=500", "primary", "every-10", "missed"},
        {"awkward:kind=flat,n=300", "primary", "all-miss", "missed"},
        {"awkward:kind=duplicates,n=300", "shadow", "all-miss", "missed"},
    };
    CHECK_ALL(attacks);
}

/* At this scale Embree misses everything as well. */
static void tiny_scenes_are_judged(void **state)
{
    (void)state;
    static const attack attacks[] = {
        {"tiny.gltf", "primary", "all-miss", "missed"},
        {"tiny.gltf", "random", "all-miss", "missed"},
        {"tiny.gltf", "random", "every-10", "missed"},
        {"tiny.gltf", "primary", "behind", "wrong t"},
        {"tiny.gltf", "primary", "t-1e-2", "wrong t"},
        {"tiny.gltf", "random", "number+1", NULL}, /* may be hit as well, behind */
    };
    CHECK_ALL(attacks);
}

static void false_hits_are_found(void **state)
{
    (void)state;
    static const attack attacks[] = {
        {"random:n=300", "ao", "something", "false"},
        {"random:n=300", "ao", "beyond", NULL},
        {"random:n=300", "primary", "number+1", "false"},
        {"random:n=300", "random:tmin=0.3", "beyond", NULL},
        {"spheres:n=300", "ao", "something", "false"},
        {"spheres:n=300", "shadow", "beyond", NULL},
        {"spheres:n=300", "ao", "number+1", "false"},
        {"terrain:n=500", "primary", "neighbour", "false"},
        {"terrain:n=500", "primary", "number+1", "false"},
        {"sphere-mesh:n=6", "primary", "neighbour", "false"},
        {"sphere-mesh:n=6", "random", "number+1", "false"},
        {"interior:n=1000", "random", "neighbour", "false"},
        {"interior:n=1000", "ao", "something", "false"},
        {"cube", "primary", "neighbour", NULL},
        {"cube", "random", "number+1", NULL},
        {"interior:n=1000", "diffuse", "self", NULL},
        {"sphere-mesh:n=6", "ao", "self", NULL},
        {"spheres:n=300", "diffuse", "self", NULL},
        {"terrain:n=500", "shadow", "self", NULL},
    };
    CHECK_ALL(attacks);
}

static void wrong_hits_are_found(void **state)
{
    (void)state;
    static const attack attacks[] = {
        {"cube", "primary", "behind", "wrong t"},
        {"sphere-mesh:n=6", "primary", "behind", "wrong t"},
        {"sphere-mesh:n=6", "primary", "stale", NULL},
        {"sphere-mesh:n=4,x=1000,y=-500", "primary", "behind", "wrong t"},
        {"random:n=300", "random", "behind", "wrong t"},
        {"random:n=300", "random", "stale", NULL},
        {"spheres:n=300", "primary", "behind", "wrong t"},
        {"spheres:n=300", "ao", "stale", NULL},
        {"terrain:n=500", "primary", "stale", NULL},
        {"awkward:kind=axis,n=300", "primary", "behind", "wrong t"},
        {"interior:n=1000", "random", "behind", "wrong t"},
        {"interior:n=1000", "diffuse", "stale", NULL},
        {"awkward:kind=centroids,n=300", "primary", "behind", "wrong t"},
    };
    CHECK_ALL(attacks);
}

/* What lies behind is reported instead of what is small. */
static void small_primitives_are_missed(void **state)
{
    (void)state;
    static const attack attacks[] = {
        {"random:n=300,ratio=1000", "random", "small-0.1", NULL},
        {"random:n=300,ratio=1000", "primary", "detail-0.3", "wrong t"},
        {"spheres:n=300,state=settled", "primary", "small-0.1", NULL},
        {"interior:n=1000", "primary", "small-0.02", "wrong t"},
        {"interior:n=1000", "random", "detail-0.1", "wrong t"},
    };
    CHECK_ALL(attacks);
}

/* A ball of radius 0.4 lies within the margin of the ground that it lies on. */
static void large_primitives_hide_nothing(void **state)
{
    (void)state;
    static const attack attacks[] = {
        {"ground.gltf", "primary", "small-2e-6", "wrong t"},
        {"ground.gltf", "primary", "detail-0.01", "wrong t"},
        {"ground.gltf", "primary", "margin", "wrong t"},
        {"ground.gltf", "random:near=1", "detail-0.01", NULL},
        {"ground.gltf", "primary", "behind", "wrong t"},
    };
    CHECK_ALL(attacks);
}

/* t off by a factor is found where that exceeds the margin. */
static void wrong_distances_are_found(void **state)
{
    (void)state;
    static const char *const cheats[] = {"t-1e-6", "t-1e-5", "t-1e-4", "t-1e-3", "t-1e-2"};
    static const struct {
        const char *scene, *rays;
    } sets[] = {
        {"cube", "primary"},          {"sphere-mesh:n=6", "primary"},
        {"random:n=300", "random"},   {"interior:n=1000", "diffuse"},
        {"spheres:n=300", "primary"}, {"spheres:n=300", "ao"},
        {"terrain:n=500", "primary"}, {"hairball:n=500", "random"},
    };
    for (size_t s = 0; s < sizeof sets / sizeof sets[0]; s++) {
        print_message("%-16s %-8s", sets[s].scene, sets[s].rays);
        for (size_t c = 0; c < sizeof cheats / sizeof cheats[0]; c++) {
            const attack a = {sets[s].scene, sets[s].rays, cheats[c], "wrong t"};
            outcome o;
            if (!perform(&a, &o))
                continue;
            uint32_t found = found_in(&o);
            print_message(" %s %3.0f %% hidden,", a.cheat,
                          100 - 100.0 * found / (o.altered > 0 ? o.altered : 1));
            if (is_overlooked(&o, found) || found > o.altered || o.wrong_t < 0.9 * found)
                fail_case(&a, &o, "not found, or as something else");
            if (strcmp(a.cheat, "t-1e-2") == 0 && (o.exit_status != 1 || found < 0.9 * o.altered))
                fail_case(&a, &o, "1 % is not within any margin here");
        }
        print_message("\n");
    }
    assert_int_equal(failures, 0);
}

/* What the margin allows is counted all the same: on the ground it is as large as the ball. */
static void distances_within_the_margin_are_counted(void **state)
{
    (void)state;
    static const attack a = {"ground.gltf", "primary", "t-1e-2", NULL};
    outcome o;
    if (perform(&a, &o)) {
        print_message("%s: altered %u, found %u, t_off %g\n", a.cheat, o.altered, found_in(&o),
                      o.t_off);
        if (!(found_in(&o) + o.t_off >= 0.99 * o.altered))
            fail_case(&a, &o, "neither found nor counted as t_off");
    }
    assert_int_equal(failures, 0);
}

static void unnamed_hits_are_refused(void **state)
{
    (void)state;
    static const attack attacks[] = {{"cube", "primary", "unnamed", NULL},
                                     {"spheres:n=300", "random", "something", NULL}};
    for (size_t i = 0; i < sizeof attacks / sizeof attacks[0]; i++) {
        const attack *a = &attacks[i];
        char command[1024], err[2000];
        rays_command(a, command);
        assert_int_equal(run(command), 0);
        tracer_command(a, command);
        assert_int_equal(run(command), 0);
        judge_command(a, command);
        int status = run(command);
        read_file("stderr", err, sizeof err);
        const char *newline = strchr(err, '\n');
        if (status != 2 || newline == NULL || newline[1] != '\0' || !strstr(err, "is no answer"))
            fail_case(a, &(outcome){.exit_status = status}, "not refused in one line");
    }
    assert_int_equal(failures, 0);
}

/* The path of a file in the folder, until the next call. */
static const char *path_of(const char *name)
{
    static char path[1200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int make_scenes(void **state)
{
    (void)state;
    const char *base = getenv("BVHBENCH_TEST_DIR"), *given = getenv("BVHBENCH_TEST_SEED");
    if (given != NULL)
        seed = strtoull(given, NULL, 10);
    base = base != NULL ? base : "/tmp/bvhbench-tests";
    mkdir(base, 0777);
    snprintf(folder, sizeof folder, "%s/cheats", base);
    mkdir(folder, 0777);
    write_tetrahedron(path_of("tiny.gltf"), 1e-20f);
    write_ball_on_ground(path_of("ground.gltf"));
    FILE *views = fopen(path_of("ground.views"), "w"); /* from above the ball */
    assert_non_null(views);
    fputs("above eye=0,5,0 target=0,0,0 up=0,0,1 fov=12\n", views);
    assert_int_equal(fclose(views), 0);
    return 0;
}

static int begin(void **state)
{
    (void)state;
    failures = 0;
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(exact_answers_are_right, begin),
        cmocka_unit_test_setup(misses_are_found, begin),
        cmocka_unit_test_setup(tiny_scenes_are_judged, begin),
        cmocka_unit_test_setup(false_hits_are_found, begin),
        cmocka_unit_test_setup(wrong_hits_are_found, begin),
        cmocka_unit_test_setup(small_primitives_are_missed, begin),
        cmocka_unit_test_setup(large_primitives_hide_nothing, begin),
        cmocka_unit_test_setup(wrong_distances_are_found, begin),
        cmocka_unit_test_setup(distances_within_the_margin_are_counted, begin),
        cmocka_unit_test_setup(unnamed_hits_are_refused, begin),
    };
    return cmocka_run_group_tests(tests, make_scenes, NULL);
}
