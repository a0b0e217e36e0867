/* For tests of builders on the host: one by itself, without the harness around it, whose trees are
 * held to what all trees promise and whose memory is booked. */
#ifndef BB_TEST_BUILDER_FIXTURE_H
#define BB_TEST_BUILDER_FIXTURE_H

#include "framework/builder/phases.h"
#include "framework/builder/registry.h"
#include "tests/tree_fixture.h"

typedef struct made {
    bb_account account;
    bb_spec spec;
    const bb_builder *builder;
    void *self;
    bb_tree tree;
    bb_phases phases;
} made;

/* What the builder says of these options; close_builder() follows in any case. */
static inline bb_status try_builder(const char *text, made *m)
{
    memset(m, 0, sizeof *m);
    ASSERT_OK(bb_spec_parse(text, &m->spec));
    m->builder = bb_builder_find(m->spec.name);
    assert_non_null(m->builder);
    ASSERT_OK(bb_spec_validate(&m->spec, m->builder->options, "builder"));
    ASSERT_OK(bb_builder_validate(m->builder));
    bb_builder_context context = {.account = &m->account,
                                  .spec = &m->spec,
                                  .options = m->builder->options,
                                  .seed = 1,
                                  .threads = 1};
    bb_tree_init(&m->tree, &m->account);
    return m->builder->create(&context, &m->self);
}

static inline void open_builder(const char *text, made *m)
{
    ASSERT_OK(try_builder(text, m));
}

static inline void expect_tree(const made *m, const bb_scene *scene)
{
    if (bb_tree_check(&m->tree, scene) != BB_OK)
        fail_msg("%s: %s", m->spec.text, bb_message());
}

static inline void build(made *m, const bb_scene *scene)
{
    m->phases = (bb_phases){.current = -1};
    ASSERT_OK(m->builder->prepare(m->self, scene, &m->tree));
    ASSERT_OK(m->builder->build(m->self, scene, NULL, &m->tree, &m->phases));
    expect_tree(m, scene);
}

static inline void update(made *m, const bb_scene *scene)
{
    m->phases = (bb_phases){.current = -1};
    m->tree.refitted = false;
    ASSERT_OK(m->builder->update(m->self, scene, BB_CHANGED_POSITIONS, &m->tree, &m->phases));
    expect_tree(m, scene);
}

static inline uint64_t hash_of(const made *m)
{
    uint64_t hash;
    ASSERT_OK(bb_tree_hash(&m->tree, &hash));
    return hash;
}

static inline uint64_t event(const made *m, const char *name)
{
    for (uint32_t i = 0; i < m->phases.event_count; i++)
        if (strcmp(m->phases.event_names[i], name) == 0)
            return m->phases.events[i];
    return 0;
}

static inline void close_builder(made *m)
{
    bb_tree_release(&m->tree);
    m->builder->destroy(m->self);
    assert_int_equal(m->account.bytes, 0); /* everything was booked, everything is free */
}

#endif
