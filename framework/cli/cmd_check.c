/* bvhbench check: conformance of builders, and of splitters and optimisers beside one, by small
 * scenes before large ones. Each tree is held to the promises of the common tree, must come out the
 * same bit for bit when built again (by the same object, and by a fresh one), and must be traced
 * rightly: by every kernel as by brute force, bit for bit. */
#include "framework/base/clock.h"
#include "framework/base/progress.h"
#include "framework/bench/conformance.h"
#include "framework/builder/guard.h"
#include "framework/cli/choice.h"
#include "framework/cli/time_option.h"
#include "framework/cli/watchdog.h"
#include "framework/device/device_private.h"
#include "framework/scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Small scenes, each with a difficulty for builders. */
static const char *const procedural_scenes[] = {
    "single",
    "cube",
    "interior:n=20000",
    "terrain:n=20000",
    "random:n=10000",
    "hairball:n=10000",
    "spheres:n=10000,state=initial",
    "spheres:n=10000,state=settled",
    "sphere-mesh",
    "sphere-mesh:x=148376,y=1234,z=-223423",
    "awkward:kind=outlier,n=2000",
    "awkward:kind=centroids,n=1000",
    "awkward:kind=flat",
    "awkward:kind=axis",
    "awkward:kind=duplicates",
    "awkward:kind=zeros,n=1000",
    "boards:length=1e5",
    "blinds:length=1e5",
    "corridor:length=1e5",
    "slivers:aspect=40",
    "scales:from=-8,to=8,n=1",
    "ground",
    "nbody:n=65",
    "tets",
    "tets:side=4,shape=shell,flip=3,flat=5,twins=7",
    "tets:side=3,shape=block,thin=130",
    "ladder",
    "wave:n=2000,frames=4",
};

static bb_status default_scenes(bb_names *names)
{
    for (size_t i = 0; i < sizeof procedural_scenes / sizeof procedural_scenes[0]; i++)
        BB_TRY(bb_names_add(names, procedural_scenes[i]));
    return bb_add_shipped_scenes(names);
}

enum { FORMS_MAX = 2 };

/* Builds of fewer primitives say nothing about how time grows. */
enum { PRIMS_TIMED = 1000 };

/* A builder's times per primitive, over the scenes. */
typedef struct pace {
    double slowest_us, fastest_us; /* 0: none was timed */
    char slowest_scene[256];
} pace;

typedef struct check {
    bb_device *devices[FORMS_MAX]; /* one, or both forms of one */
    uint32_t device_count;
    bb_names builders, scenes;
    bb_device_choice choice;
    uint32_t form; /* a word of --form: bb_form, or BOTH_FORMS */
    bool quiet;
    bool beside[BB_NAMES_MAX]; /* a splitter or optimiser, which was put beside a default builder */
    uint32_t taken[BB_NAMES_MAX]; /* for each builder, the number of scenes that it took */
    /* for each builder, the first scene that it did not take, and why; from malloc */
    char *refusals[BB_NAMES_MAX];
    uint64_t seed;  /* seed of the ray sets */
    uint32_t side;  /* a ray set has side * side rays */
    uint32_t limit; /* most seconds for each line of the table; 0: no limit */
    const char *time;
    double ends_ms; /* bb_wall_ms() when the time is over; 0: never */
    bb_progress progress;
    uint32_t checked, failed;
    uint32_t skipped; /* for want of time: trees */
    pace paces[BB_NAMES_MAX];
    bb_conformed found[FORMS_MAX][BB_NAMES_MAX]; /* on the current scene */
    bool conforms[FORMS_MAX][BB_NAMES_MAX];
} check;

enum { BOTH_FORMS = BB_FORM_GPU + 1 };

static const bb_cli_option options[] = {
    {"builder", "B", "name:key=value,...; A+B; `all`; default: all, in the variants to compare",
     BB_INTO(check, builders)},
    {"scene", "S", "`all` and default: small procedural scenes, then the shipped ones",
     BB_INTO(check, scenes)},
    BB_GROUP(bb_device_options, check, choice),
    {"form", NULL, BB_FORM_HELP "; both: they must give equal trees", BB_INTO(check, form),
     .words = "auto|cpu|gpu|both", .fallback = "auto"},
    {"seed", "N", "random seed of the rays", BB_INTO(check, seed), .fallback = "1"},
    {"side", "N", "trace N x N rays of each kind; fewer suit slow tools", BB_INTO(check, side),
     .low = 6, .high = 1024, .fallback = "64"},
    {"limit", "SECONDS",
     "most time for one builder on one scene, with checks but without compiling; after that, "
     "`check` ends; 0: no limit",
     BB_INTO(check, limit), .high = 1000000, .fallback = "900"},
    BB_TIME_OPTION(check, time,
                   "no check begins later than this, such as 5min; what is left is said"),
    BB_QUIET_OPTION(check, quiet),
    {.name = NULL},
};

/* A line of the table: result, scene, builder, text. */
#define TABLE_LINE "%-11s %-36s %-34s %s\n"

static void say(check *c, const char *word, const char *scene, const char *builder,
                const char *text)
{
    if (bb_guard_said())
        return;
    bb_progress_end(&c->progress);
    printf(TABLE_LINE, word, scene, builder, text);
    fflush(stdout);
}

/* Starts the watchdog for the next line of the table. */
static void watch(const check *c, const char *scene, const char *builder)
{
    char line[2048], text[160];
    snprintf(text, sizeof text,
             "not done after %u s (--limit): given up, and what would have come after it",
             c->limit);
    snprintf(line, sizeof line, TABLE_LINE, "HUNG", scene, builder, text);
    bb_watchdog_start(c->limit, line);
}

/* Completes splitters and optimisers that were given alone by a default builder. */
static bb_status complete(check *c)
{
    for (size_t i = 0; i < c->builders.count; i++) {
        char whole[sizeof((bb_pipeline *)NULL)->text], **item = &c->builders.items[i];
        BB_TRY(bb_pipeline_complete(*item, whole, sizeof whole, &c->beside[i]));
        free(*item);
        *item = strdup(whole);
        if (*item == NULL)
            return bb_fail(BB_FAILED, "out of memory");
        BB_TRY(bb_instance_check(*item));
    }
    return BB_OK;
}

static void add_pace(pace *p, const bb_scene *scene, double ms)
{
    double us = 1e3 * ms / scene->prim_count;
    if (scene->prim_count < PRIMS_TIMED)
        return;
    if (p->fastest_us == 0 || us < p->fastest_us)
        p->fastest_us = us;
    if (us > p->slowest_us) {
        p->slowest_us = us;
        snprintf(p->slowest_scene, sizeof p->slowest_scene, "%s", scene->name);
    }
}

/* Returns the last message with the scene before it; NULL without memory. */
static char *refusal_of(const bb_scene *scene)
{
    char text[1200];
    snprintf(text, sizeof text, "%s: %s", scene->name, bb_message());
    return strdup(text);
}

static void check_builder(check *c, uint32_t form, bb_conformance *conformance,
                          const bb_scene *scene, size_t i)
{
    bb_conformed *found = &c->found[form][i];
    const char *builder = c->builders.items[i];
    watch(c, scene->name, builder);
    bb_status status = bb_conformance_check(conformance, builder, found);
    bb_watchdog_stop();
    c->conforms[form][i] = status == BB_OK;
    char text[1200];
    snprintf(text, sizeof text, "%s%s", status == BB_OK ? found->note : bb_message(),
             c->beside[i] ? " (beside a default builder)" : "");
    say(c,
        status == BB_OK            ? "ok"
        : status == BB_UNSUPPORTED ? "unsupported"
                                   : "FAILED",
        scene->name, builder, text);
    if (status == BB_UNSUPPORTED && c->refusals[i] == NULL)
        c->refusals[i] = refusal_of(scene);
    c->taken[i] += status != BB_UNSUPPORTED;
    c->checked += status != BB_UNSUPPORTED;
    c->failed += status != BB_OK && status != BB_UNSUPPORTED;
    if (status == BB_OK)
        add_pace(&c->paces[i], scene, found->build_ms);
    bb_progress_step(&c->progress);
}

static void say_of_scene(check *c, const bb_scene *scene, bb_conformance *conformance)
{
    char text[1200];
    if (scene->out_of_range > 0) {
        snprintf(text, sizeof text,
                 "%u of %u primitives are too small, relative to the scene, for floats",
                 scene->out_of_range, scene->prim_count);
        say(c, "note", scene->name, "", text);
    }
    if (bb_conformance_left_out(conformance)[0] != '\0') {
        snprintf(text, sizeof text, "no rays %s", bb_conformance_left_out(conformance));
        say(c, "note", scene->name, "", text);
    }
}

static void check_brute_force(check *c, bb_conformance *conformance, const char *scene)
{
    static const char what[] = "no tree, all primitives";
    watch(c, scene, what);
    bb_status status = bb_conformance_brute_force(conformance);
    bb_watchdog_stop();
    if (status == BB_OK)
        return;
    c->failed++;
    say(c, "FAILED", scene, what, bb_message());
}

static bool is_over(const check *c)
{
    return c->ends_ms > 0 && bb_wall_ms() >= c->ends_ms;
}

static void skip(check *c, uint32_t form, size_t i)
{
    c->conforms[form][i] = false;
    c->skipped++;
}

static bb_status check_scene(check *c, uint32_t form, const char *name)
{
    bb_scene *scene = NULL;
    bb_conformance *conformance = NULL;
    bb_device *device = c->devices[form];
    if (is_over(c)) {
        for (size_t i = 0; i < c->builders.count; i++)
            skip(c, form, i);
        return BB_OK;
    }
    bb_status status = bb_scene_load(name, &scene);
    if (status == BB_OK)
        bb_progress_stage(&c->progress, (uint32_t)c->builders.count, "%s: %u primitives%s", name,
                          scene->prim_count,
                          c->device_count == 1          ? ""
                          : device->form == BB_FORM_CPU ? ", form cpu"
                                                        : ", form gpu");
    if (status == BB_OK)
        status = bb_conformance_create(device, scene, c->side, c->seed, &conformance);
    if (status == BB_OK)
        say_of_scene(c, scene, conformance);
    if (status == BB_OK)
        check_brute_force(c, conformance, name);
    for (size_t i = 0; i < c->builders.count && status == BB_OK; i++) {
        if (is_over(c))
            skip(c, form, i);
        else
            check_builder(c, form, conformance, scene, i);
        status = bb_device_check(device);
    }
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
    return status;
}

/* Compares the trees of both forms, which must be equal for a deterministic builder. */
static void compare_forms(check *c, const char *scene)
{
    for (size_t i = 0; i < c->builders.count; i++) {
        const bb_conformed *cpu = &c->found[0][i], *gpu = &c->found[1][i];
        if (!c->conforms[0][i] || !c->conforms[1][i] || !cpu->deterministic)
            continue;
        if (cpu->hash == gpu->hash)
            continue;
        char text[120];
        snprintf(text, sizeof text, "form cpu makes tree %016llx, form gpu %016llx",
                 (unsigned long long)cpu->hash, (unsigned long long)gpu->hash);
        say(c, "FAILED", scene, c->builders.items[i], text);
        c->failed++;
    }
}

/* Fails builders that took none of the scenes. */
static void find_unchecked(check *c)
{
    for (size_t i = 0; i < c->builders.count; i++)
        if (c->taken[i] == 0) {
            char text[1200];
            snprintf(text, sizeof text, "supports none of the scenes: it was not checked; %s",
                     c->refusals[i] != NULL ? c->refusals[i] : "");
            c->failed++;
            say(c, "FAILED", "", c->builders.items[i], text);
        }
}

/* A method whose time does not grow with its input shows on the scene that it likes least. */
static void say_paces(check *c)
{
    for (size_t i = 0; i < c->builders.count; i++) {
        const pace *p = &c->paces[i];
        char text[160];
        if (p->slowest_us == 0)
            continue;
        snprintf(text, sizeof text, "slowest build: %.3g us per primitive (its fastest: %.3g)",
                 p->slowest_us, p->fastest_us);
        say(c, "note", p->slowest_scene, c->builders.items[i], text);
    }
}

static bb_status open_devices(check *c)
{
    const bool both = c->form == BOTH_FORMS;
    c->device_count = both ? 2 : 1;
    c->choice.form = both ? BB_FORM_CPU : c->form;
    BB_TRY(bb_open_device(&c->choice, &c->devices[0]));
    c->choice.form = BB_FORM_GPU;
    return both ? bb_open_device(&c->choice, &c->devices[1]) : BB_OK;
}

/* Parameters out of range are bad input, and no failure of a builder. */
static bb_status try_builders(check *c)
{
    for (size_t i = 0; i < c->builders.count; i++) {
        watch(c, "", c->builders.items[i]);
        bb_status status = bb_instance_try(c->devices[0], c->builders.items[i], c->seed);
        bb_watchdog_stop();
        BB_TRY(status);
    }
    return BB_OK;
}

/* What a user waits for before anything runs. */
static void say_compiling(const check *c)
{
    for (uint32_t form = 0; form < c->device_count; form++) {
        bb_compiling compiling;
        bb_programs_measure(c->devices[form], &compiling);
        printf("%s: %u programs compiled in %.1f s, kernel cache %s\n", c->devices[form]->name,
               compiling.programs, 1e-3 * compiling.ms, compiling.cache);
    }
}

static bb_status check_all(check *c)
{
    for (size_t s = 0; s < c->scenes.count; s++) {
        for (uint32_t form = 0; form < c->device_count; form++)
            BB_TRY(check_scene(c, form, c->scenes.items[s]));
        if (c->device_count == FORMS_MAX)
            compare_forms(c, c->scenes.items[s]);
    }
    say_paces(c);
    if (c->skipped == 0)
        find_unchecked(c);
    bb_progress_end(&c->progress);
    return BB_OK;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    (void)cli;
    check *c = values;
    BB_TRY(bb_time_option(c->time, &c->ends_ms));
    BB_TRY(bb_load_plugins(&c->choice.plugins));
    BB_TRY(bb_choose_builders(&c->builders, true));
    BB_TRY(complete(c));
    BB_TRY(bb_choose_scenes(&c->scenes, default_scenes));
    BB_TRY(open_devices(c));
    BB_TRY(try_builders(c));
    if (!bb_guard_said())
        printf("%s\n", c->devices[0]->name); /* before all else */
    fflush(stdout);
    bb_progress_start(&c->progress, c->quiet);
    BB_TRY(check_all(c));
    if (c->skipped > 0 && c->checked + c->failed == 0)
        return bb_fail(BB_REFUSED, "check: --time was over before anything was checked: give more "
                                   "time");
    say_compiling(c);
    printf("builders: %zu, scenes: %zu; %u trees checked, %u checks failed\n", c->builders.count,
           c->scenes.count, c->checked, c->failed);
    if (c->skipped > 0)
        fprintf(stderr, "bvhbench: --time was over: %u trees were not checked\n", c->skipped);
    else if (c->checked == 0)
        fprintf(stderr, "bvhbench: no builder supports any of the scenes: nothing was checked\n");
    *exit_status = c->failed > 0 || c->checked == 0 ? BB_EXIT_WRONG : BB_EXIT_OK;
    return BB_OK;
}

static void release(void *values)
{
    check *c = values;
    for (uint32_t form = 0; form < FORMS_MAX; form++)
        bb_device_close(c->devices[form]);
    for (size_t i = 0; i < c->builders.count; i++)
        free(c->refusals[i]);
}

extern const bb_command bb_command_check;
const bb_command bb_command_check = {
    .name = "check",
    .summary = "check that builders make valid, repeatable trees that trace correctly",
    .options = options,
    .bytes = sizeof(check),
    .run = run,
    .release = release,
    .goes_on = true,
};
