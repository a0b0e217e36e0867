/* Builders in stages: how a specification is read, what is refused, and that stages are handed what
 * they take, timed and booked apart; what rotate and presplit promise; side arrays of trees. */
#include "builders/presplit/clip.h"
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/tree/tree_cover.h"
#include "tests/device_fixture.h"
#include "tests/registry.h"
#include "tests/tree_fixture.h"

#include "framework/scene/scene.h"

enum { SEED = 4711 };

static int load_relay(void **state)
{
    if (open_device(state) == 0 && bb_plugin_load(BB_TEST_PLUGIN_DIR "/relay.so") == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

static bb_scene *load(const char *name)
{
    bb_scene *scene;
    ASSERT_OK(bb_scene_load(name, &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
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
        assert_false(builder->usual && usual != NULL);
        usual = builder->usual ? builder : usual;
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

typedef struct built {
    bb_instance instance;
    bb_build_timing timing;
    uint64_t hash;
    double sah;
} built;

/* Two builds by one object: the same tree, valid. */
static void build(const bb_scene *scene, const char *builder, built *b)
{
    uint64_t again;
    memset(b, 0, sizeof *b);
    ASSERT_OK(bb_instance_create(device, builder, scene, SEED, &b->instance));
    for (int i = 0; i < 2; i++) {
        ASSERT_OK(bb_instance_build(&b->instance, scene, false, &b->timing));
        ASSERT_OK(bb_tree_download(&b->instance.tree, NULL));
        if (bb_tree_check(&b->instance.tree, scene) != BB_OK)
            fail_msg("%s of %s: %s", builder, scene->name, bb_message());
        ASSERT_OK(bb_tree_hash(&b->instance.tree, i == 0 ? &b->hash : &again));
    }
    assert_true(b->hash == again);
    b->sah = bb_tree_sah(&b->instance.tree);
}

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

/* ---- rotate ---- */

static void rotations_never_raise_the_cost(void **state)
{
    (void)state;
    static const char *const scenes[] = {"single",
                                         "cube",
                                         "interior:n=3000",
                                         "spheres:n=2000",
                                         "hairball:n=1000",
                                         "awkward:kind=flat,n=1000",
                                         "awkward:kind=axis,n=1000",
                                         "awkward:kind=duplicates,n=1000",
                                         "awkward:kind=zeros,n=1000"};
    static const char *const builders[] = {
        "lbvh", "sah", "sah:leaf=4", "embree:quality=high", "null", "presplit:saves=-1+lbvh"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
            char text[128];
            built before, after, other;
            build(scene, builders[i], &before);
            snprintf(text, sizeof text, "%s+rotate:passes=100", builders[i]);
            build(scene, text, &after);
            snprintf(text, sizeof text, "%s+rotate:passes=100,order=random", builders[i]);
            build(scene, text, &other);
            const bb_tree_info *a = &before.instance.tree.info, *b = &after.instance.tree.info;
            if (!(after.sah <= before.sah * (1 + 1e-12) || isnan(before.sah)) ||
                !(other.sah <= before.sah * (1 + 1e-12) || isnan(before.sah)))
                fail_msg("%s of %s: SAH %.17g, was %.17g", text, scenes[s], after.sah, before.sah);
            assert_int_equal(a->leaf_count, b->leaf_count);
            assert_int_equal(a->ref_count, b->ref_count);
            assert_int_equal(before.instance.tree.duplicated, after.instance.tree.duplicated);
            bb_instance_destroy(&before.instance);
            bb_instance_destroy(&after.instance);
            bb_instance_destroy(&other.instance);
        }
        bb_scene_free(scene);
    }
}

/* It does something: a tree that is bad on purpose becomes better, and another seed's another
 * one. */
static void rotations_lower_the_cost(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=3000");
    built before, after, other;
    build(scene, "lbvh", &before);
    build(scene, "lbvh+rotate", &after);
    build(scene, "lbvh+rotate:order=random", &other);
    assert_true(after.sah < 0.95 * before.sah);
    bb_instance reseeded;
    uint64_t hash;
    ASSERT_OK(bb_instance_create(device, "lbvh+rotate:order=random", scene, SEED + 1, &reseeded));
    ASSERT_OK(bb_instance_build(&reseeded, scene, false, NULL));
    ASSERT_OK(bb_tree_hash(&reseeded.tree, &hash));
    assert_true(hash != other.hash);
    char text[512];
    ASSERT_OK(bb_instance_describe(&after.instance, scene, text, sizeof text));
    assert_non_null(strstr(text, "lbvh: code of"));
    assert_non_null(strstr(text, "; rotate: "));
    bb_instance_destroy(&before.instance);
    bb_instance_destroy(&after.instance);
    bb_instance_destroy(&other.instance);
    bb_instance_destroy(&reseeded);
    bb_scene_free(scene);
}

/* A chain of a million levels, and the wide nodes that it does not take, straight into the hook. */
static void rotate_takes_chains_and_refuses_wide_nodes(void **state)
{
    (void)state;
    enum { LEVELS = 1000000 };
    const bb_builder *rotate = bb_builder_find("rotate");
    bb_spec spec;
    ASSERT_OK(bb_spec_parse("rotate:passes=1", &spec));
    bb_account account = {0};
    bb_builder_context context = {
        .device = device, .account = &account, .spec = &spec, .options = rotate->options};
    bb_scene *scene = make_box_scene(LEVELS + 1);
    void *self = NULL;
    bb_tree chain, out;
    bb_tree_init(&chain, NULL);
    bb_tree_init(&out, &account);
    ASSERT_OK(bb_tree_reserve(&chain, NULL, BB_ON_HOST, 2 * LEVELS + 1, LEVELS + 1));
    for (uint32_t i = 0; i <= LEVELS; i++) {
        float at = (float)i;
        bb_box box = {.lo = {at, 0, 0}, .hi = {at + 0.5f, 1, 1}};
        scene->boxes[i] = box;
        bb_node leaf = make_node(box.lo, box.hi, BB_LEAF_BIT | i, 2 * i + 2);
        const float far[3] = {LEVELS + 0.5f, 1, 1};
        chain.refs[i] = i | BB_LAST_BIT;
        chain.nodes[2 * i] = make_node(box.lo, far, 2 * i + 1, BB_NONE);
        if (i == LEVELS)
            chain.nodes[2 * i].first = BB_LEAF_BIT | i;
        else
            chain.nodes[2 * i + 1] = leaf;
    }
    chain.info = (bb_tree_info){0, 2 * LEVELS + 1, LEVELS + 1, LEVELS + 1, 2, LEVELS};
    bb_phases phases = {.current = -1};
    ASSERT_OK(bb_tree_check(&chain, scene));
    ASSERT_OK(rotate->create(&context, &self));
    ASSERT_OK(rotate->build(self, scene, &chain, &out, &phases));
    ASSERT_OK(bb_tree_check(&out, scene));
    assert_true(bb_tree_sah(&out) < bb_tree_sah(&chain));
    chain.info.arity = 3;
    assert_int_equal(rotate->build(self, scene, &chain, &out, &phases), BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "binary trees"));
    rotate->destroy(self);
    bb_tree_release(&chain);
    bb_tree_release(&out);
    assert_int_equal(account.bytes, 0);
    free_scene(scene);
}

/* ---- presplit ---- */

static void splits_are_covered_and_within_the_budget(void **state)
{
    (void)state;
    static const char *const scenes[] = {"interior:n=3000",   "hairball:n=1000",
                                         "random:n=1000",     "spheres:n=1000,state=initial",
                                         "slivers:aspect=40", "awkward:kind=axis,n=500",
                                         "blocks:side=6",     "blocks:side=6,mixed=yes"};
    static const char *const builders[] = {"sah", "lbvh", "llbvh", "lobvh"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
            char text[128];
            built b;
            snprintf(text, sizeof text, "presplit:budget=3,above=0.1,saves=-1+%s", builders[i]);
            build(scene, text, &b);
            assert_int_equal(b.instance.tree.info.ref_count, b.instance.references.count);
            if (scene->kinds == BB_SPHERES) /* they stay whole */
                assert_int_equal(b.instance.references.count, scene->prim_count);
            else
                assert_true(b.instance.references.count > scene->prim_count);
            assert_true(b.instance.references.count <= 3 * scene->prim_count);
            assert_int_equal(b.instance.tree.duplicated, scene->kinds != BB_SPHERES);
            bb_instance_destroy(&b.instance);
        }
        bb_scene_free(scene);
    }
}

/* Halves reference `index` as presplit_esc.c says, or leaves it. */
static bool halve(const bb_scene *scene, bb_box *boxes, const uint32_t *prims, uint32_t index,
                  uint32_t count, double saves)
{
    const bb_prims *spheres = &scene->prims[BB_SPHERE];
    bb_box halves[2] = {boxes[index], boxes[index]};
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if ((double)halves[0].hi[k] - halves[0].lo[k] >
            (double)halves[0].hi[axis] - halves[0].lo[axis])
            axis = k;
    const float middle = 0.5f * halves[0].lo[axis] + 0.5f * halves[0].hi[axis];
    if (prims[index] - spheres->first < spheres->count || !(halves[0].lo[axis] < middle) ||
        !(middle < halves[0].hi[axis]))
        return false;
    halves[0].hi[axis] = halves[1].lo[axis] = middle;
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        bb_clip_primitive(scene, prims[index], &halves[i]);
        sum += bb_half_area(halves[i].lo, halves[i].hi);
    }
    if (sum > (1 - saves) * bb_half_area(boxes[index].lo, boxes[index].hi))
        return false;
    boxes[index] = halves[0];
    boxes[count] = halves[1];
    return true;
}

/* The largest box first, the first of several, found by looking at all of them. */
static void the_largest_boxes_are_split_first(void **state)
{
    (void)state;
    static const char *const scenes[] = {"slivers:aspect=40", "interior:n=1000", "blinds:n=10",
                                         "blocks:side=4,mixed=yes"};
    const double above = 0.1, saves = 0.05;
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        const uint32_t most = (uint32_t)(1.25 * scene->prim_count);
        bb_box *boxes = malloc(most * sizeof *boxes);
        uint32_t *prims = malloc(most * sizeof *prims), count = scene->prim_count, largest;
        bool *done = calloc(most, sizeof *done);
        double sum = 0, area;
        built b;
        for (uint32_t i = 0; i < count; i++) {
            boxes[i] = scene->boxes[i];
            prims[i] = i;
            sum += bb_half_area(boxes[i].lo, boxes[i].hi);
        }
        const double least = above * sum / count;
        do {
            largest = BB_NONE;
            double most_area = least;
            for (uint32_t i = 0; i < count; i++) {
                area = bb_half_area(boxes[i].lo, boxes[i].hi);
                if (!done[i] && area > most_area) {
                    most_area = area;
                    largest = i;
                }
            }
            if (largest == BB_NONE)
                break;
            if (halve(scene, boxes, prims, largest, count, saves))
                prims[count++] = prims[largest];
            else
                done[largest] = true;
        } while (count < most);
        build(scene, "presplit:budget=1.25,above=0.1,saves=0.05+sah", &b);
        const bb_references *made = &b.instance.references;
        assert_true(count > scene->prim_count + 10);
        assert_int_equal(made->count, count);
        for (uint32_t i = 0; i < count; i++) {
            assert_memory_equal(made->boxes[i].lo, boxes[i].lo, sizeof boxes[i].lo);
            assert_memory_equal(made->boxes[i].hi, boxes[i].hi, sizeof boxes[i].hi);
            assert_int_equal(made->prims[i], prims[i]);
        }
        bb_instance_destroy(&b.instance);
        free(boxes);
        free(prims);
        free(done);
        bb_scene_free(scene);
    }
}

/* Triangles cut in two again and again, also far from the origin and thin beside it: the parts
 * cover. */
static void clips_lose_nothing(void **state)
{
    (void)state;
    enum { RUNS = 3000, PARTS = 32 };
    bb_random random = bb_random_make(SEED, 1);
    double kept = 0;
    for (uint32_t run = 0; run < RUNS; run++) {
        float corners[9];
        double away = pow(10, bb_random_range(&random, -3, 6)), thin = run % 3 == 0 ? 1e-6 : 1;
        for (int i = 0; i < 9; i++)
            corners[i] = (float)((run % 2) * away +
                                 bb_random_unit(&random) * (i % 3 == (int)(run % 5) ? thin : 1));
        bb_scene *scene = make_scene(corners, 1, NULL, 0);
        bb_box parts[PARTS] = {scene->boxes[0]};
        double whole = bb_half_area(parts[0].lo, parts[0].hi), sum = 0;
        uint32_t count = 1;
        while (count < PARTS) {
            bb_box *box = &parts[bb_random_below(&random, count)], *other = &parts[count++];
            int axis = (int)bb_random_below(&random, 3);
            *other = *box;
            float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
            box->hi[axis] = other->lo[axis] = middle;
            bb_clip_primitive(scene, 0, box);
            bb_clip_primitive(scene, 0, other);
            assert_true(box->lo[0] <= box->hi[0] && other->lo[2] <= other->hi[2]);
        }
        bool covered;
        double point[3];
        ASSERT_OK(bb_cover_primitive(scene, 0, parts, count, &covered, point));
        if (!covered)
            fail_msg("run %u: (%.9g %.9g %.9g) is in no part", run, point[0], point[1], point[2]);
        for (uint32_t i = 0; i < count; i++)
            sum += bb_half_area(parts[i].lo, parts[i].hi);
        kept += sum / whole / RUNS;
        free_scene(scene);
    }
    assert_true(kept < 2); /* else nothing was cut off: 32 boxes of a third of the area and more */
}

/* What lies askew is cut, and makes the better tree; a wall's box is as full in halves. */
static void splits_are_made_where_they_save(void **state)
{
    (void)state;
    bb_scene *scene = load("slivers:aspect=40");
    built whole, split;
    build(scene, "sah", &whole);
    build(scene, "presplit:budget=2+sah", &split);
    assert_int_equal(split.instance.references.count, 2 * scene->prim_count);
    assert_true(split.sah < 0.7 * whole.sah);
    bb_instance_destroy(&whole.instance);
    bb_instance_destroy(&split.instance);
    bb_scene_free(scene);

    scene = load("interior:n=3000");
    build(scene, "presplit+sah", &split);
    assert_int_equal(split.instance.references.count, scene->prim_count);
    bb_instance_destroy(&split.instance);
    bb_scene_free(scene);
}

/* A part that is cut too small is found by the tree's check. */
static void a_wrong_clip_is_found(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=3000");
    built b;
    build(scene, "presplit:saves=-1+sah", &b);
    bb_tree *tree = &b.instance.tree;
    uint32_t found = 0, tried = 0;
    uint32_t *uses = calloc(scene->prim_count, sizeof *uses);
    for (uint32_t i = 0; i < tree->info.ref_count; i++)
        uses[tree->refs[i] & BB_INDEX_MASK]++;
    for (uint32_t n = 0; n < tree->info.node_count; n++) {
        bb_node *node = &tree->nodes[n];
        if (!bb_node_is_leaf(node) ||
            uses[tree->refs[node->first & BB_INDEX_MASK] & BB_INDEX_MASK] < 2)
            continue;
        int axis = 0;
        for (int k = 1; k < 3; k++)
            axis = node->hi[k] - node->lo[k] > node->hi[axis] - node->lo[axis] ? k : axis;
        float hi = node->hi[axis];
        node->hi[axis] = nextafterf(node->hi[axis] - 1e-3f * (hi - node->lo[axis]), -INFINITY);
        tried++;
        found += bb_tree_check(tree, scene) == BB_FAILED &&
                 strstr(bb_message(), "is not covered by its") != NULL;
        node->hi[axis] = hi;
        if (tried == 20)
            break;
    }
    assert_int_equal(tried, 20);
    assert_int_equal(found, tried);
    free(uses);
    bb_instance_destroy(&b.instance);
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
        cmocka_unit_test(rotations_never_raise_the_cost),
        cmocka_unit_test(rotations_lower_the_cost),
        cmocka_unit_test(rotate_takes_chains_and_refuses_wide_nodes),
        cmocka_unit_test(splits_are_covered_and_within_the_budget),
        cmocka_unit_test(the_largest_boxes_are_split_first),
        cmocka_unit_test(clips_lose_nothing),
        cmocka_unit_test(splits_are_made_where_they_save),
        cmocka_unit_test(a_wrong_clip_is_found),
    };
    return cmocka_run_group_tests_name("pipeline", tests, load_relay, close_device);
}
