/* Two-level trees of gs against flat ones, over the frames of a scene whose things move: the same
 * answers, bit for bit. */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "tests/trace_fixture.h"

enum { RAYS = 3000, FRAMES = 6, BUILDERS = 4 };

static const char *const builders[BUILDERS] = {"lbvh", "gs", "gs:objects=collections",
                                               "gs:objects=collections,moved=listed"};
static const char *const name = "car:room=interior:n=2000,things=5,frames=8";

static void make_rays(const bb_scene *scene, bb_ray *rays)
{
    bb_random random = bb_random_make(seed, 3);
    for (uint32_t i = 0; i < RAYS; i++) {
        double d[3];
        rays[i] = (bb_ray){.tmin = 0, .tmax = INFINITY};
        for (int k = 0; k < 3; k++)
            rays[i].o[k] = (float)bb_random_range(&random, (double)scene->bounds.lo[k],
                                                  (double)scene->bounds.hi[k]);
        bb_random_direction(&random, d);
        bb_ray_set_direction(&rays[i], d);
    }
}

static void answers_are_those_of_flat_trees(void **state)
{
    (void)state;
    static bb_hit hits[BUILDERS][RAYS];
    static bb_ray rays[RAYS];
    bed beds[BUILDERS];
    uint32_t inside = 0;
    for (int b = 0; b < BUILDERS; b++)
        open_bed(&beds[b], load(name), builders[b], "stack", 1);
    assert_int_equal(beds[0].scene->mover_count, 5);
    make_rays(beds[0].scene, rays);
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        for (int b = 0; b < BUILDERS; b++) {
            bed *bed = &beds[b];
            uint32_t changed = 0;
            check(bb_scene_set_frame(bed->scene, frame, &changed), "frame");
            bb_update_way way;
            check(bb_instance_update(&bed->instance, bed->scene, changed, false, &way, NULL),
                  builders[b]);
            assert_true(frame == 0 || b == 0 || way == BB_UPDATED);
            check(bb_tree_upload(&bed->instance.tree, device, NULL), builders[b]);
            check(bb_tree_download(&bed->instance.tree, NULL), builders[b]);
            check(bb_tree_check(&bed->instance.tree, bed->scene), builders[b]);
            choose_kernel(bed, "stack", 1);
            trace(bed, "exact", rays, RAYS, bb_query_find("closest"), hits[b], NULL);
            assert_memory_equal(hits[b], hits[0], sizeof hits[0]);
        }
        for (uint32_t i = 0; i < RAYS; i++)
            inside += hits[0][i].prim != BB_NONE &&
                      hits[0][i].prim >= beds[0].scene->object_starts[beds[0].scene->movers[0]];
    }
    assert_true(inside > FRAMES); /* things that move were hit */
    for (int b = 0; b < BUILDERS; b++)
        close_bed(&beds[b]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_are_those_of_flat_trees),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
