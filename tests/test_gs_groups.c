/* gs: objects that are collections of primitives, and a list of those that move. */
#include "tests/gs_fixture.h"

enum { PRIMS = 900, OBJECTS_MAX = PRIMS, FRAMES = 40 };

static uint32_t starts[OBJECTS_MAX + 1], movers[OBJECTS_MAX];

/* Objects of 1 to `most` primitives, about one in `one_of` of which may move. */
static void group(bb_scene *scene, uint32_t most, uint32_t one_of, bb_random *random)
{
    uint32_t count = 0, moving = 0;
    for (uint32_t at = 0; at < scene->prim_count; count++) {
        starts[count] = at;
        at += 1 + bb_random_below(random, most);
        if (bb_random_below(random, one_of) == 0)
            movers[moving++] = count;
    }
    starts[count] = scene->prim_count;
    scene->object_starts = starts;
    scene->object_count = count;
    scene->movers = movers;
    scene->mover_count = moving;
}

/* Moves all that is listed: most objects as a whole, some by a single primitive, so that the
 * object's box may stay. */
static void move_listed(bb_scene *scene, bb_random *random)
{
    for (uint32_t m = 0; m < scene->mover_count; m++) {
        const uint32_t first = starts[movers[m]], end = starts[movers[m] + 1];
        const uint32_t only = bb_random_below(random, 4) == 0 ? first : BB_NONE;
        const double far = bb_random_below(random, 3) == 0 ? 50 : 0.5;
        float by[3];
        for (int k = 0; k < 3; k++)
            by[k] = (float)bb_random_range(random, -far, far);
        for (uint32_t i = first; i < end; i++)
            for (int k = 0; k < 3 && (only == BB_NONE || i == only); k++) {
                scene->boxes[i].lo[k] += by[k];
                scene->boxes[i].hi[k] += by[k];
            }
    }
}

/* Whether the node, or one below it, has a primitive of another object than `object`. */
static bool has_others(const bb_tree *tree, uint32_t n, uint32_t object)
{
    const bb_node *node = &tree->nodes[n];
    if ((node->first & BB_LEAF_BIT) != 0) {
        const uint32_t prim = tree->refs[node->first & BB_INDEX_MASK] & BB_INDEX_MASK;
        return prim < starts[object] || prim >= starts[object + 1];
    }
    for (uint32_t c = node->first; c != node->skip; c = tree->nodes[c].skip)
        if (has_others(tree, c, object))
            return true;
    return false;
}

/* Each object has a subtree of its own: a node over all of its primitives and no others. */
static void expect_two_levels(const made *m, const bb_scene *scene)
{
    uint32_t found = 0;
    for (uint32_t o = 0; o < scene->object_count; o++) {
        const uint32_t members = starts[o + 1] - starts[o];
        for (uint32_t n = 0; n < m->tree.info.node_count; n++) {
            uint32_t leaves = 0;
            const bb_node *node = &m->tree.nodes[n];
            if (members == 1 ? node->first != (BB_LEAF_BIT | starts[o])
                             : (node->first & BB_LEAF_BIT) != 0 || has_others(&m->tree, n, o))
                continue;
            for (uint32_t k = node->first; members > 1 && k != node->skip;)
                if ((m->tree.nodes[k].first & BB_LEAF_BIT) != 0) {
                    leaves++;
                    k = m->tree.nodes[k].skip;
                } else {
                    k = m->tree.nodes[k].first;
                }
            if (members == 1 || leaves == members) {
                found++;
                break;
            }
        }
    }
    assert_int_equal(found, scene->object_count);
}

static void collections_keep_their_trees(void **state)
{
    (void)state;
    static const char *const options[] = {"", ",arity=2,order=file", ",max_children=0,start=root",
                                          ",search=bb,tau=1", ",moved=listed"};
    static const uint32_t sizes[] = {1, 3, 40, PRIMS};
    for (size_t s = 0; s < sizeof options / sizeof options[0]; s++)
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            bb_random random = bb_random_make(SEED, 10 * s + k);
            bb_scene *scene = scene_of_boxes(PRIMS / (1 + 2 * (uint32_t)(s == 3)), &random);
            char text[128];
            made m;
            group(scene, sizes[k], 2, &random);
            if (scene->mover_count == 0)
                movers[scene->mover_count++] = 0;
            snprintf(text, sizeof text, "gs:objects=collections%s", options[s]);
            open_builder(text, &m);
            build(&m, scene);
            expect_two_levels(&m, scene);
            for (uint32_t frame = 0; frame < FRAMES; frame++) {
                move_listed(scene, &random);
                update(&m, scene);
                assert_true(event(&m, "moved") <= scene->mover_count);
            }
            expect_two_levels(&m, scene);
            close_builder(&m);
            free_scene(scene);
        }
}

/* A list of what moves gives the tree that comparing boxes gives, where all that is listed does
 * move. */
static void a_list_is_as_good_as_a_comparison(void **state)
{
    (void)state;
    static const char *const builders[2][2] = {
        {"gs:moved=compared", "gs:moved=listed"},
        {"gs:objects=collections,moved=compared", "gs:objects=collections,moved=listed"}};
    for (int b = 0; b < 2; b++) {
        bb_random random = bb_random_make(SEED, 77);
        bb_scene *scene = scene_of_boxes(PRIMS, &random);
        made m[2];
        group(scene, 12, 3, &random);
        for (int i = 0; i < 2; i++) {
            open_builder(builders[b][i], &m[i]);
            build(&m[i], scene);
        }
        for (uint32_t frame = 0; frame < FRAMES; frame++) {
            for (uint32_t o = 0; o < scene->mover_count; o++)
                for (uint32_t i = starts[movers[o]]; i < starts[movers[o] + 1]; i++) {
                    scene->boxes[i].lo[0] += 1;
                    scene->boxes[i].hi[0] += 1;
                }
            for (int i = 0; i < 2; i++)
                update(&m[i], scene);
            assert_int_equal(event(&m[0], "moved"), event(&m[1], "moved"));
            assert_true(hash_of(&m[0]) == hash_of(&m[1]));
        }
        for (int i = 0; i < 2; i++)
            close_builder(&m[i]);
        free_scene(scene);
    }
}

/* What is not listed is not looked at: then the tree is wrong, and the check says so. */
static void what_is_not_listed_does_not_move(void **state)
{
    (void)state;
    bb_random random = bb_random_make(SEED, 5);
    bb_scene *scene = scene_of_boxes(60, &random);
    made m;
    group(scene, 3, 2, &random);
    scene->mover_count = 1;
    movers[0] = 0;
    open_builder("gs:objects=collections,moved=listed", &m);
    build(&m, scene);
    for (int k = 0; k < 3; k++) {
        scene->boxes[59].lo[k] += 500;
        scene->boxes[59].hi[k] += 500;
    }
    m.phases = (bb_phases){.current = -1};
    ASSERT_OK(m.builder->update(m.self, scene, BB_CHANGED_POSITIONS, &m.tree, &m.phases));
    assert_int_equal(event(&m, "moved"), 1);
    assert_int_not_equal(bb_tree_check(&m.tree, scene), BB_OK);
    close_builder(&m);
    free_scene(scene);
}

static void scenes_that_do_not_say_are_refused(void **state)
{
    (void)state;
    static const char *const builders[] = {"gs:objects=collections", "gs:moved=listed"};
    bb_random random = bb_random_make(SEED, 6);
    bb_scene *scene = scene_of_boxes(10, &random);
    for (int b = 0; b < 2; b++) {
        made m;
        open_builder(builders[b], &m);
        assert_int_equal(m.builder->prepare(m.self, scene, &m.tree), BB_UNSUPPORTED);
        assert_non_null(strstr(bb_message(), "the scene does not"));
        close_builder(&m);
    }
    free_scene(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collections_keep_their_trees),
        cmocka_unit_test(a_list_is_as_good_as_a_comparison),
        cmocka_unit_test(what_is_not_listed_does_not_move),
        cmocka_unit_test(scenes_that_do_not_say_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
