/* Joining the shards of one run: which build stays, and which tree a trace went through. */
#include "tests/record_fixture.h"

#include "framework/base/file.h"

static bb_results *shard(const char *name)
{
    bb_results *results;
    static bb_scene scene = {.name = "s", .prim_count = 8, .hash = 1};
    ASSERT_OK(bb_results_create(&(bb_context){NULL, 1, "bvhbench run"}, &results));
    ASSERT_OK(bb_results_add_scene(results, &scene, NULL));
    ASSERT_OK(bb_results_set_shard(results, name, 77));
    ASSERT_OK(bb_results_add_step(results, "load", 10));
    return results;
}

/* A build of `nodes` nodes, and one trace of the kernel through it. */
static void add(bb_results *results, const char *builder, bool measured, uint32_t nodes,
                const char *kernel)
{
    bb_spec spec;
    static bb_build_record build;
    static bb_trace_record trace;
    bb_build_record_init(&build);
    bb_trace_record_init(&trace);
    ASSERT_OK(bb_spec_parse(builder, &spec));
    build.spec = &spec;
    strcpy(build.scene, "s");
    snprintf(build.cell, sizeof build.cell, "scene=s/builder=%s", builder);
    build.has_tree = true;
    build.tree.node_count = nodes;
    build.unmeasured = !measured;
    build.phase_count = 1;
    build.phases[0] = (bb_named_ms){"link", nodes};
    if (measured)
        bb_samples_add(&build.build_ms, 5);
    ASSERT_OK(bb_results_add_build(results, &build));
    strcpy(trace.scene, "s");
    strcpy(trace.rays, "primary");
    snprintf(trace.builder, sizeof trace.builder, "%s", builder);
    snprintf(trace.kernel, sizeof trace.kernel, "%s", kernel);
    trace.count = 100;
    ASSERT_OK(bb_results_add_trace(results, &trace));
}

static const bb_entry *trace_by(bb_results *results, const char *builder, const char *kernel)
{
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        if (strcmp(bb_get_text(trace, BB_F_TRACE_BUILDER), builder) == 0 &&
            strcmp(bb_get_text(trace, BB_F_TRACE_KERNEL), kernel) == 0)
            return trace;
    }
    fail_msg("no trace of %s by %s", builder, kernel);
    return NULL;
}

/* The trace went through a tree of so many nodes, whose build was measured or not. */
static void expect(bb_results *results, const char *builder, const char *kernel, double nodes,
                   bool measured)
{
    const bb_entry *build = bb_build_of(trace_by(results, builder, kernel));
    assert_true(bb_get_number(build, BB_F_TREE_NODES) == nodes);
    assert_true(bb_get_named(build, BB_F_BUILD_PHASES, "link") == nodes);
    assert_int_equal(isfinite(bb_get_number(build, BB_F_BUILD_MS)), measured);
}

/* The results as they come back from a file. */
static bb_results *through_a_file(bb_results *results)
{
    bb_results *read;
    const char *path = results_path("join");
    ASSERT_OK(bb_results_write(results, path));
    ASSERT_OK(bb_results_read(path, &read));
    assert_true(cJSON_Compare(document_of(results), document_of(read), 1));
    bb_results_destroy(results);
    return read;
}

/* Which of both shards measures, and whether their trees are alike. */
static void the_measured_build_stays(void **state)
{
    (void)state;
    static const struct {
        bool first, second; /* measured */
        uint32_t nodes[2];
        uint32_t builds;
    } cases[] = {
        {true, false, {7, 7}, 1}, {false, true, {7, 7}, 1}, {false, false, {7, 7}, 1},
        {true, false, {7, 9}, 2}, {false, true, {7, 9}, 2}, {false, false, {7, 9}, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_results *a = shard("1/2"), *b = shard("2/2");
        const uint32_t *nodes = cases[i].nodes;
        const bool alike = nodes[0] == nodes[1];
        add(a, "hploc", cases[i].first, nodes[0], "stack");
        add(b, "hploc", cases[i].second, nodes[1], "stackless");
        add(b, "lbvh", true, 3, "stack");
        ASSERT_OK(bb_results_join(a, b));
        bb_results_destroy(b);
        a = through_a_file(a);
        assert_int_equal(bb_section_count(bb_results_section(a, BB_BUILDS)), cases[i].builds + 1);
        assert_int_equal(bb_section_count(bb_results_section(a, BB_TRACES)), 3);
        expect(a, "hploc", "stack", nodes[0], cases[i].first || (alike && cases[i].second));
        expect(a, "hploc", "stackless", nodes[1], cases[i].second || (alike && cases[i].first));
        expect(a, "lbvh", "stack", 3, true);
        bb_each(trace, bb_results_section(a, BB_TRACES)) assert_int_equal(bb_run_of(trace), 0);
        assert_true(bb_results_step_ms(a, "load") == 20);
        bb_results_destroy(a);
    }
}

/* Each of three shards got another tree. */
static void three_trees_stay_apart(void **state)
{
    (void)state;
    bb_results *a = shard("1/3"), *b = shard("2/3"), *c = shard("3/3"), *other;
    add(a, "hploc", false, 7, "stack");
    add(b, "hploc", false, 9, "stackless");
    add(c, "hploc", true, 11, "short");
    ASSERT_OK(bb_results_join(a, b));
    ASSERT_OK(bb_results_join(a, c));
    bb_results_destroy(b);
    bb_results_destroy(c);
    bb_results_end_join(a);
    a = through_a_file(a);
    expect(a, "hploc", "stack", 7, false);
    expect(a, "hploc", "stackless", 9, false);
    expect(a, "hploc", "short", 11, true);
    const char *shards = bb_get_text(bb_results_context(a), BB_F_CONTEXT_SHARDS);
    assert_non_null(strstr(shards, "1/3 on "));
    assert_non_null(strstr(shards, "; 2/3 on "));
    assert_non_null(strstr(shards, "; 3/3 on "));
    assert_string_equal(bb_get_text(bb_results_context(a), BB_F_CONTEXT_SHARD), "");
    other = shard("1/1"); /* and after merging, in which runs get other numbers */
    add(other, "hploc", true, 5, "stack");
    ASSERT_OK(bb_results_merge(other, a));
    other = through_a_file(other);
    const bb_entry *trace = other->sections[BB_TRACES].first;
    static const double nodes[] = {5, 7, 9, 11};
    for (int i = 0; i < 4; i++, trace = trace->next) {
        assert_int_equal(bb_run_of(trace), i > 0);
        assert_true(bb_get_number(bb_build_of(trace), BB_F_TREE_NODES) == nodes[i]);
    }
    bb_results_destroy(other);
    bb_results_destroy(a);
}

/* However many there are. */
static void all_shards_are_listed(void **state)
{
    (void)state;
    char name[16];
    bb_results *a = shard("1/100");
    for (int i = 2; i <= 100; i++) {
        snprintf(name, sizeof name, "%d/100", i);
        bb_results *b = shard(name);
        ASSERT_OK(bb_results_join(a, b));
        bb_results_destroy(b);
    }
    const char *shards = bb_get_text(bb_results_context(a), BB_F_CONTEXT_SHARDS);
    for (int i = 2; i <= 100; i++) {
        snprintf(name, sizeof name, "; %d/100 on ", i);
        assert_non_null(strstr(shards, name));
    }
    bb_results_destroy(a);
}

/* A trace of a tree of another run, with a part of its own, and a build that names a run. */
static void odd_runs_do_no_harm(void **state)
{
    (void)state;
    bb_results *a = shard("1/2"), *b = shard("2/2");
    add(a, "hploc", true, 7, "stack");
    bb_put_text(a->sections[BB_BUILDS].first, BB_F_TRACE_TREE_RUN, "5");
    add(b, "lbvh", true, 3, "stack");
    bb_put_text(bb_results_part(b, b->sections[BB_TRACES].first, "kinds"), BB_F_TRACE_DECISIONS,
                "triangles");
    ASSERT_OK(bb_results_join(a, b));
    assert_int_equal(bb_results_join(b, a), BB_INVALID); /* cells of both */
    assert_int_equal(bb_section_count(bb_results_section(a, BB_TRACES)), 2);
    assert_string_equal(bb_get_decision(trace_by(a, "lbvh", "stack"), "kinds"), "triangles");
    bb_results_destroy(b);
    bb_results_destroy(a);
}

static void what_is_no_shard_is_refused(void **state)
{
    (void)state;
    bb_results *a = shard("1/2"), *b = shard("2/2");
    add(a, "hploc", true, 7, "stack");
    add(b, "hploc", true, 7, "stackless");
    assert_int_equal(bb_results_join(a, b), BB_INVALID);
    assert_non_null(strstr(bb_message(), "measured in two"));
    bb_results_destroy(b);
    b = shard("2/2");
    add(b, "hploc", false, 7, "stack");
    assert_int_equal(bb_results_join(a, b), BB_INVALID);
    assert_non_null(strstr(bb_message(), "in two of the files"));
    ASSERT_OK(bb_results_set_shard(b, "2/2", 78));
    assert_int_equal(bb_results_join(a, b), BB_INVALID);
    assert_non_null(strstr(bb_message(), "same options"));
    ASSERT_OK(bb_results_set_text(b, BB_F_CONTEXT_SEED, "2"));
    assert_int_equal(bb_results_join(a, b), BB_INVALID);
    assert_non_null(strstr(bb_message(), "same seed"));
    bb_results_destroy(b);
    bb_results_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_measured_build_stays),    cmocka_unit_test(three_trees_stay_apart),
        cmocka_unit_test(all_shards_are_listed),       cmocka_unit_test(odd_runs_do_no_harm),
        cmocka_unit_test(what_is_no_shard_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
