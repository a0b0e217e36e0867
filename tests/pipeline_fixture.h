/* Builders in stages, built twice and checked, for tests of what they make. */
#ifndef BB_PIPELINE_FIXTURE_H
#define BB_PIPELINE_FIXTURE_H

#include "framework/builder/instance.h"
#include "framework/scene/scene.h"
#include "tests/device_fixture.h"
#include "tests/tree_fixture.h"

enum { SEED = 4711 };

static bb_scene *load(const char *name)
{
    bb_scene *scene;
    ASSERT_OK(bb_scene_load(name, &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
}

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

#endif
