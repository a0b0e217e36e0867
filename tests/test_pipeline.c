/* Builders in stages: how a specification is read, what is refused, and that stages are handed what
 * they take, timed and booked apart. */
#include "framework/builder/phases.h"
#include "framework/builder/registry.h"
#include "tests/pipeline_fixture.h"
#include "tests/registry.h"

static int load_relay(void **state)
{
    if (open_device(state) == 0 && bb_plugin_load(BB_TEST_PLUGIN_DIR "/relay.so") == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

/* ---- specifications ---- */

static void a_plus_separates_stages(void **state)
{
    (void)state;
    bb_pipeline p;
    ASSERT_OK(
        bb_pipeline_parse("presplit:budget=2,above=1e+1+sah:bins=8+rotate+rotate:passes=1", &p));
    assert_int_equal(p.count, 4);
    assert_string_equal(p.stages[0].spec.text, "presplit:budget=2,above=1e+1");
    assert_string_equal(bb_spec_value(&p.stages[0].spec, NULL, "above"), "1e+1");
    assert_string_equal(p.stages[1].builder->name, "sah");
    assert_string_equal(bb_spec_value(&p.stages[1].spec, NULL, "bins"), "8");
    assert_string_equal(p.stages[2].label, "rotate");
    assert_string_equal(p.stages[3].label, "rotate#2");
    ASSERT_OK(bb_pipeline_parse("lbvh:view=a\\+b+rotate", &p));
    assert_int_equal(p.count, 2);
    assert_string_equal(bb_spec_value(&p.stages[0].spec, NULL, "view"), "a+b");
}

static void bad_orders_are_refused_in_one_line(void **state)
{
    (void)state;
    static const char *const bad[][2] = {
        {"rotate", "takes another builder's tree: write BUILDER+rotate"},
        {"rotate+sah", "takes another builder's tree"},
        {"presplit", "write presplit+BUILDER"},
        {"sah+presplit", "can only come first"},
        {"presplit+presplit+sah", "can only come first"},
        {"presplit+rotate", "write presplit+BUILDER+rotate"},
        {"sah+lbvh", "lbvh takes no tree, so it can't come after sah"},
        {"presplit+embree", "reads the primitives' geometry"},
        {"sah+nothing", "unknown builder 'nothing'"},
        {"sah+", "stage 2 of 'sah+' is empty"},
        {"+sah", "stage 1 of '+sah' is empty"},
        {"sah++rotate", "stage 2 of"},
        {"sah+rotate+rotate+rotate+rotate", "more than 4 stages"},
        {"sah+rotate:passes", "is not key=value"},
        {"sah+rotate:passes=2+rotate:nothing=1", "builder rotate has no option 'nothing'"},
        {"embree-native+rotate", "not as a stage"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        if (bb_instance_check(bad[i][0]) != BB_INVALID)
            fail_msg("'%s' was taken", bad[i][0]);
        if (strstr(bb_message(), bad[i][1]) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("'%s': expected '%s' in '%s'", bad[i][0], bad[i][1], bb_message());
    }
}

static void what_stands_alone_gets_a_builder(void **state)
{
    (void)state;
    char whole[512];
    bool completed;
    ASSERT_OK(bb_pipeline_complete("rotate:passes=2", whole, sizeof whole, &completed));
    assert_true(completed);
    assert_non_null(strstr(whole, "+rotate:passes=2"));
    ASSERT_OK(bb_instance_check(whole));
    ASSERT_OK(bb_pipeline_complete("presplit", whole, sizeof whole, &completed));
    assert_true(completed);
    ASSERT_OK(bb_instance_check(whole));
    ASSERT_OK(bb_pipeline_complete("sah+rotate", whole, sizeof whole, &completed));
    assert_false(completed);
    assert_string_equal(whole, "sah+rotate");
}

/* One declares itself, so that what stands beside a stage does not hang on the order of names. */
static void the_usual_builder_is_declared(void **state)
{
    (void)state;
    const bb_builder *usual = NULL;
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *builder = bb_builder_at(i);
        const bool is_usual = bb_builder_variants(builder, BB_ROLE_USUAL) != NULL;
        assert_false(is_usual && usual != NULL);
        usual = is_usual ? builder : usual;
    }
    assert_non_null(usual);
    assert_true(usual->deterministic);
    assert_ptr_equal(bb_usual_builder(BB_ALL_KINDS), usual);
    assert_null(bb_usual_builder(0));
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *stage = bb_builder_at(i);
        char whole[512], expected[512];
        ASSERT_OK(bb_pipeline_complete(stage->name, whole, sizeof whole, NULL));
        if (bb_is_splitter(stage))
            snprintf(expected, sizeof expected, "%s+%s", stage->name, usual->name);
        else if (bb_is_optimiser(stage))
            snprintf(expected, sizeof expected, "%s+%s", usual->name, stage->name);
        else
            snprintf(expected, sizeof expected, "%s", stage->name);
        assert_string_equal(whole, expected);
    }
}

/* ---- building ---- */

static void stages_are_timed_and_booked_apart(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=5000");
    built b;
    build(scene, "presplit:saves=-1+lbvh+rotate", &b);
    static const char *const steps[] = {"presplit", "lbvh", "map", "rotate"};
    assert_int_equal(b.instance.step_count, 4);
    double sum = 0;
    for (uint32_t i = 0; i < 4; i++) {
        assert_string_equal(b.instance.steps[i].label, steps[i]);
        assert_true(b.instance.steps[i].timing.timing.ms > 0);
        sum += b.instance.steps[i].timing.timing.ms;
    }
    ASSERT_NEAR(b.timing.timing.ms, sum, 1e-9 * sum);
    assert_int_equal(b.instance.steps[0].phases.count, 2);
    assert_string_equal(b.instance.steps[3].phases.names[1], "rotate");

    /* boxes and geometry down, references and the last tree up, lbvh's tree down */
    double ms;
    ASSERT_OK(bb_instance_transfer(&b.instance, scene, &ms));
    assert_true(ms > 0);
    assert_true(b.instance.references.copied && b.instance.stages[1].tree->copied);
    assert_int_equal(bb_instance_inputs(&b.instance),
                     BB_INPUT_BOXES | BB_INPUT_GEOMETRY | BB_INPUT_PROFILE);

    /* one account holds it all: references and lbvh's tree on both sides, the last tree, scratch */
    uint64_t refs = b.instance.references.count, booked = b.instance.account.bytes;
    uint64_t tree = (2 * refs - 1) * sizeof(bb_node) + refs * sizeof(uint32_t);
    assert_true(refs > scene->prim_count);
    assert_true(b.instance.account.peak >= booked);
    bb_tree_release(b.instance.stages[1].tree);
    assert_int_equal(booked - b.instance.account.bytes, 2 * tree + sizeof(bb_tree_info));
    booked = b.instance.account.bytes;
    bb_tree_release(&b.instance.tree); /* its copy is the harness's */
    assert_int_equal(booked - b.instance.account.bytes, tree);
    booked = b.instance.account.bytes;
    bb_references_release(&b.instance.references);
    assert_true(booked - b.instance.account.bytes >=
                2 * refs * (sizeof(bb_box) + sizeof(uint32_t)));
    bb_instance_destroy(&b.instance);
    assert_int_equal(b.instance.account.bytes, 0);

    build(scene, "lbvh", &b);
    ASSERT_OK(bb_instance_transfer(&b.instance, scene, &ms));
    assert_true(ms < 1); /* there is nothing to move */
    bb_instance_destroy(&b.instance);
    bb_scene_free(scene);
}

/* Each stage's tree is the one that the builders up to it make alone; what stages hold adds up to
 * what the account has. */
static void stages_have_figures_of_their_own(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=5000");
    built b, alone;
    double sah;
    build(scene, "presplit:saves=-1+lbvh", &alone);
    build(scene, "presplit:saves=-1+lbvh+rotate", &b);
    ASSERT_OK(bb_instance_stage_sah(&b.instance, 0, &sah));
    assert_true(isnan(sah)); /* a splitter leaves no tree */
    ASSERT_OK(bb_instance_stage_sah(&b.instance, 1, &sah));
    assert_true(sah == alone.sah && sah > b.sah);
    ASSERT_OK(bb_instance_stage_sah(&b.instance, 2, &sah));
    assert_true(sah == b.sah);

    const uint64_t refs = b.instance.references.count;
    const uint64_t tree = (2 * refs - 1) * sizeof(bb_node) + refs * sizeof(uint32_t);
    const uint64_t made[] = {refs * (sizeof(bb_box) + sizeof(uint32_t)), tree, 0, tree};
    uint64_t held = 0, peaks = 0;
    for (uint32_t i = 0; i < 4; i++) {
        const bb_build_step *step = &b.instance.steps[i];
        assert_int_equal(step->bytes, made[i]);
        assert_true(step->peak >= made[i] && step->peak < b.instance.account.peak);
        peaks += step->peak;
    }
    for (uint32_t i = 0; i < 3; i++)
        held += b.instance.stages[i].bytes;
    assert_int_equal(held, b.instance.account.bytes);
    assert_true(peaks >= b.instance.account.peak);
    bb_instance_destroy(&b.instance);
    bb_instance_destroy(&alone.instance);

    /* on the device no stage needs a copy: none stays for the figure's sake */
    build(scene, "lbvh+refit", &b);
    ASSERT_OK(bb_instance_stage_sah(&b.instance, 0, &sah));
    assert_true(sah > 0 && b.instance.stages[0].tree->nodes == NULL);
    bb_instance_destroy(&b.instance);
    bb_scene_free(scene);
}

/* A pipeline is as its stages made it one after the other; what splits nothing changes nothing. */
static void idle_stages_change_nothing(void **state)
{
    (void)state;
    static const char *const builders[] = {"sah", "lbvh", "llbvh", "lobvh", "null"};
    bb_scene *scene = load("interior:n=3000");
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        char text[64];
        built alone, fed;
        snprintf(text, sizeof text, "presplit:budget=1+%s", builders[i]);
        build(scene, builders[i], &alone);
        build(scene, text, &fed);
        assert_true(alone.hash == fed.hash);
        assert_false(fed.instance.tree.duplicated);
        bb_instance_destroy(&alone.instance);
        bb_instance_destroy(&fed.instance);
    }
    bb_scene_free(scene);
}

/* Trees go over to the device and back, whoever made them, with all that they say of themselves. */
/* A stage that finds nothing to do, as in a tree of one leaf, has still handed one on: a clock that
 * saw the device do nothing would not be believed. */
static void the_device_is_seen_at_work_in_each_stage(void **state)
{
    (void)state;
    static const char *const scenes[] = {"single", "cube"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        uint32_t ran = 0;
        for (size_t i = 0; i < bb_builder_count(); i++) {
            const char *builder = whole_builder(bb_builder_at(i));
            bb_instance instance = {0};
            bb_status status = bb_instance_create(device, builder, scene, SEED, &instance);
            if (status == BB_OK)
                status = bb_instance_build(&instance, scene, false, NULL);
            if (is_taken(status, builder, &ran))
                for (uint32_t k = 0; k < instance.step_count; k++) {
                    const bb_build_step *step = &instance.steps[k];
                    const bool on_host = step->phases.device == NULL && step->phases.count > 0;
                    if (step->phases.used_device && !on_host && !(step->timing.timing.event_ms > 0))
                        fail_msg("%s of %s: no work was seen in %s", builder, scenes[s],
                                 step->label);
                }
            bb_instance_destroy(&instance);
        }
        bb_scene_free(scene);
    }
}

/* What a builder takes of the device is booked, and given back. */
static void the_account_holds_what_the_device_gave(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=5000");
    uint32_t ran = 0;
    for (size_t i = 0; i < bb_builder_count(); i++) {
        const char *builder = whole_builder(bb_builder_at(i));
        const uint64_t before = device->bytes;
        bb_instance instance = {0};
        bb_status status = bb_instance_create(device, builder, scene, SEED, &instance);
        if (status == BB_OK)
            status = bb_instance_build(&instance, scene, false, NULL);
        if (is_taken(status, builder, &ran) && device->bytes - before > instance.account.bytes)
            fail_msg("%s: %llu bytes of the device, %llu are booked", builder,
                     (unsigned long long)(device->bytes - before),
                     (unsigned long long)instance.account.bytes);
        bb_instance_destroy(&instance);
        assert_true(device->bytes == before);
    }
    bb_scene_free(scene);
}

/* Prepared, a builder over codes of either length has all that its build takes: in a build of its
 * own, memory would be in its time. */
static void builders_over_codes_reserve_before_they_build(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh",          "lbvh:bits=63",  "emc",
                                           "aac",           "aac:code=mc64", "hlbvh:code=mc64",
                                           "ploc",          "hploc",         "ploc:code=mc32",
                                           "llbvh:bits=63", "llbvh",         "lbvh:update=refit"};
    bb_scene *scene = load("interior:n=5000");
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_account account = {0};
        bb_spec spec;
        bb_tree tree;
        bb_phases phases = {.current = -1};
        void *self = NULL;
        ASSERT_OK(bb_spec_parse(builders[i], &spec));
        const bb_builder *builder = bb_builder_find(spec.name);
        const bb_builder_context context = {.device = device,
                                            .account = &account,
                                            .spec = &spec,
                                            .options = builder->options,
                                            .seed = SEED,
                                            .threads = 1};
        bb_tree_init(&tree, &account);
        ASSERT_OK(builder->create(&context, &self));
        ASSERT_OK(builder->prepare(self, scene, &tree));
        const uint64_t prepared = account.bytes;
        ASSERT_OK(builder->build(self, scene, NULL, &tree, &phases));
        if (account.bytes != prepared)
            fail_msg("%s: %llu bytes once prepared, %llu once built", builders[i],
                     (unsigned long long)prepared, (unsigned long long)account.bytes);
        bb_tree_release(&tree);
        builder->destroy(self);
        assert_int_equal(account.bytes, 0);
    }
    bb_scene_free(scene);
}

static void trees_are_handed_over_both_ways(void **state)
{
    (void)state;
    static const char *const builders[] = {"sah", "lbvh", "lobvh", "presplit:saves=-1+sah",
                                           "presplit:saves=-1+lbvh"};
    bb_scene *scene = load("interior:n=3000");
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        char text[64];
        built alone, relayed;
        snprintf(text, sizeof text, "%s+relay", builders[i]);
        build(scene, builders[i], &alone);
        build(scene, text, &relayed);
        assert_true(alone.hash == relayed.hash);
        assert_int_equal(relayed.instance.tree.place, BB_ON_DEVICE);
        assert_true(relayed.instance.steps[relayed.instance.step_count - 1].phases.used_device);
        bb_instance_destroy(&alone.instance);
        bb_instance_destroy(&relayed.instance);
    }
    built straight, detour;
    build(scene, "sah+rotate:passes=2", &straight);
    build(scene, "sah+relay+rotate:passes=1+rotate:passes=1", &detour);
    assert_true(straight.sah <= detour.sah * (1 + 1e-12) && detour.sah <= straight.sah * 1.05);
    bb_instance_destroy(&straight.instance);
    bb_instance_destroy(&detour.instance);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plus_separates_stages),
        cmocka_unit_test(bad_orders_are_refused_in_one_line),
        cmocka_unit_test(what_stands_alone_gets_a_builder),
        cmocka_unit_test(the_usual_builder_is_declared),
        cmocka_unit_test(stages_are_timed_and_booked_apart),
        cmocka_unit_test(stages_have_figures_of_their_own),
        cmocka_unit_test(idle_stages_change_nothing),
        cmocka_unit_test(the_device_is_seen_at_work_in_each_stage),
        cmocka_unit_test(the_account_holds_what_the_device_gave),
        cmocka_unit_test(builders_over_codes_reserve_before_they_build),
        cmocka_unit_test(trees_are_handed_over_both_ways),
    };
    return cmocka_run_group_tests_name("pipeline", tests, load_relay, close_device);
}
