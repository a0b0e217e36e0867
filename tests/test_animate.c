/* Moving scenes frame by frame: every method right in every frame, what it says of itself, layouts
 * that follow in place, triggers; and the rotations of a refit against a plain reference. */
#include "framework/builder/registry.h"
#include "framework/tasks/animate.h"
#include "tests/device_forms.h"
#include "tests/program_fixture.h"
#include "tests/tree_fixture.h"

#include <math.h>

static const char *const kernels[] = {"stack", "stack8:leaf=4", "stackless"};
static const char *const rays[] = {"primary", "random:count=300"};

static bb_animate_request request_of(const char *const *builders, uint32_t count)
{
    return (bb_animate_request){.device = devices[CPU_FORM],
                                .builders = builders,
                                .builder_count = count,
                                .kernels = kernels,
                                .kernel_count = 3,
                                .rays = rays,
                                .ray_count = 2,
                                .intersector = "exact",
                                .width = 16,
                                .height = 16,
                                .max_rays = 300,
                                .last = UINT32_MAX,
                                .repeats = 1,
                                .seed = 3,
                                .quiet = true};
}

static void animate(const bb_animate_request *request, const char *name, bb_animate_result *result)
{
    bb_scene *scene;
    ASSERT_OK(bb_scene_load(name, &scene));
    ASSERT_OK(bb_scene_upload(scene, request->device));
    ASSERT_OK(bb_animate_run(request, scene, result));
    bb_scene_free(scene);
    for (uint32_t m = 0; m < result->method_count; m++)
        if (result->methods[m].refused[0] != '\0')
            fail_msg("%s: %s: %s", name, result->methods[m].builder, result->methods[m].refused);
    if (bb_animate_wrong(result) > 0 || bb_animate_failed(result) > 0)
        fail_msg("%s: wrong answers", name);
}

static bb_animate_result *new_result(void)
{
    bb_animate_result *result = calloc(1, sizeof *result);
    assert_non_null(result);
    return result;
}

static const char *const methods[] = {
    "lbvh",        "lbvh+refit",           "lbvh+refit:rotate=yes", "sah+refit:trigger=sah:1.05",
    "lobvh+refit", "sah+refit:partial=1.1"};
enum { METHODS = sizeof methods / sizeof methods[0] };

static const char *const sequences[] = {
    "wave:n=400,frames=4",
    "ripple:n=300,frames=4",
    "twist:n=300,frames=4,away=1e6",
    "limb:n=500,frames=4",
    "car:room=interior:n=1000,frames=4",
    "crowd:kind=rigid,n=2000,frames=4",
    "crowd:kind=explode,n=300,frames=4",
    "crowd:kind=fall,n=300,frames=4",
    "crowd:kind=flow,n=300,frames=4",
    "crowd:kind=shuffle,n=300,frames=4",
    "crowd:kind=cross,n=300,frames=4",
    "crowd:kind=origin,n=300,frames=4",
    "crowd:kind=grow,n=300,frames=4",
    "crowd:kind=still,n=300,frames=4",
};

static void every_method_is_right_in_every_frame(void **state)
{
    (void)state;
    bb_animate_result *result = new_result();
    const bb_animate_request request = request_of(methods, METHODS);
    for (size_t s = 0; s < sizeof sequences / sizeof sequences[0]; s++) {
        bool still = strstr(sequences[s], "still") != NULL;
        bool grows = strstr(sequences[s], "grow") != NULL;
        animate(&request, sequences[s], result);
        assert_int_equal(result->frame_count, 4);
        for (uint32_t m = 0; m < METHODS; m++) {
            const bb_animate_method *method = &result->methods[m];
            bool refits = strcmp(method->builder, "lbvh+refit") == 0;
            assert_int_equal(method->done, 4);
            for (uint32_t f = 0; f < 4; f++) {
                const bb_animate_frame *frame = &method->frames[f];
                assert_int_equal(frame->tree.ref_count, result->states[f].prims);
                if (f > 0 && still)
                    assert_int_equal(frame->way, BB_KEPT);
                if (f > 0 && (grows || m == 0) && !still)
                    assert_int_equal(frame->way, BB_REBUILT);
                for (int k = 0; k < 3 && f > 0; k++) {
                    assert_true(frame->traces[k].checked > 0);
                    if (refits && !grows)
                        assert_true(frame->traces[k].in_place);
                    if (m == 0 && !still)
                        assert_false(frame->traces[k].in_place);
                }
            }
        }
        bb_animate_release(result);
    }
    free(result);
}

/* The same, bit for bit, as a layout that is made anew of the refitted tree. */
static void layouts_follow_in_place(void **state)
{
    (void)state;
    static const char *const names[] = {"pair", "skip"};
    bb_device *device = devices[CPU_FORM];
    for (int i = 0; i < 2; i++) {
        bb_scene *scene;
        bb_instance instance;
        bb_layout_maker followed, fresh;
        bb_layout_data a = {0}, b = {0};
        bb_update_way way;
        uint32_t changed;
        bool in_place;
        ASSERT_OK(bb_scene_load("crowd:kind=explode,n=3000,frames=5", &scene));
        ASSERT_OK(bb_scene_upload(scene, device));
        ASSERT_OK(bb_instance_create(device, "lbvh+refit", scene, 1, &instance));
        ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
        ASSERT_OK(bb_layout_maker_create(bb_layout_find(names[i]), device, &followed));
        ASSERT_OK(bb_layout_maker_create(bb_layout_find(names[i]), device, &fresh));
        ASSERT_OK(bb_layout_maker_make(&followed, scene, &instance.tree, 1, 0, &a));
        for (uint32_t frame = 1; frame < 5; frame++) {
            ASSERT_OK(bb_scene_set_frame(scene, frame, &changed));
            ASSERT_OK(bb_instance_update(&instance, scene, changed, false, &way, NULL));
            ASSERT_OK(
                bb_layout_maker_follow(&followed, scene, &instance.tree, 1, 0, &a, &in_place));
            assert_true(in_place);
            ASSERT_OK(bb_layout_maker_make(&fresh, scene, &instance.tree, 1, 0, &b));
            assert_int_equal(a.root, b.root);
            assert_int_equal(a.bytes, b.bytes);
            for (uint32_t k = 0; k < a.buffer_count; k++) {
                size_t bytes = a.buffers[k].bytes;
                char *left = malloc(bytes), *right = malloc(bytes);
                assert_int_equal(bytes, b.buffers[k].bytes);
                ASSERT_OK(bb_buffer_read(&a.buffers[k], 0, bytes, left));
                ASSERT_OK(bb_buffer_read(&b.buffers[k], 0, bytes, right));
                assert_memory_equal(left, right, bytes);
                free(left);
                free(right);
            }
        }
        /* another tree, with other links */
        ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
        ASSERT_OK(bb_layout_maker_follow(&followed, scene, &instance.tree, 1, 0, &a, &in_place));
        assert_false(in_place);
        bb_layout_data_release(&a);
        bb_layout_data_release(&b);
        bb_layout_maker_destroy(&followed);
        bb_layout_maker_destroy(&fresh);
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
}

static void triggers_fire_when_they_say(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh+refit", "lbvh+refit:trigger=sah:1.3",
                                           "lbvh+refit:trigger=ratio:3",
                                           "lbvh+refit:trigger=every:3"};
    bb_animate_result *result = new_result();
    bb_animate_request request = request_of(builders, 4);
    request.kernel_count = 1;
    animate(&request, "crowd:kind=explode,n=600,frames=61", result);
    const bb_animate_frame *plain = result->methods[0].frames;
    for (uint32_t m = 1; m < 3; m++) {
        const bb_animate_method *method = &result->methods[m];
        uint32_t rebuilt = 0;
        for (uint32_t f = 1; f < method->done; f++)
            rebuilt += method->frames[f].way == BB_REBUILT;
        assert_in_range(rebuilt, 1, 30);
    }
    /* the first time as soon as the refitted tree costs so much more, and not before */
    for (uint32_t f = 1, fired = 0; f < 61 && fired == 0; f++) {
        double ratio = plain[f].sah / plain[0].sah;
        fired = result->methods[1].frames[f].way == BB_REBUILT;
        assert_true(fired ? ratio > 1.299 : ratio < 1.301);
    }
    for (uint32_t f = 1; f < 61; f++)
        assert_int_equal(result->methods[3].frames[f].way, f % 3 == 0 ? BB_REBUILT : BB_UPDATED);
    bb_animate_release(result);
    free(result);
}

static void rotations_hold_the_cost(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh+refit", "lbvh+refit:rotate=yes",
                                           "lbvh+refit:rotate=yes,pause=2"};
    bb_animate_result *result = new_result();
    bb_animate_request request = request_of(builders, 3);
    request.kernel_count = 1;
    animate(&request, "crowd:kind=rigid,n=8640,frames=11", result);
    double refit = bb_animate_sum(result, &result->methods[0]).sah_last - 1;
    double turned = bb_animate_sum(result, &result->methods[1]).sah_last - 1;
    print_message("rigid: drift %.3f, with rotations %.3f\n", refit, turned);
    assert_true(turned < 0.5 * refit);
    double paused = bb_animate_sum(result, &result->methods[2]).sah_last - 1;
    assert_true(turned < paused && paused < 0.5 * refit);
    /* layouts follow in place where nothing is rotated */
    for (uint32_t f = 1; f < 11; f++)
        assert_int_equal(result->methods[2].frames[f].traces[0].in_place, f % 3 != 0);
    bb_animate_release(result);
    free(result);
}

/* One that builds five times: the four frames that are judged, and the first of those that count.
 */
static void what_was_not_measured_is_no_figure(void **state)
{
    (void)state;
    static const char *const builders[] = {"wreck:above=1,how=tire", "lbvh"};
    bb_animate_result *result = new_result();
    bb_animate_request request = request_of(builders, 2);
    bb_scene *scene;
    request.kernel_count = 1;
    request.repeats = 2;
    ASSERT_OK(bb_plugin_load(BB_TEST_PLUGIN_DIR "/wreck.so"));
    ASSERT_OK(bb_scene_load("twist:n=100,frames=4", &scene));
    ASSERT_OK(bb_scene_upload(scene, request.device));
    ASSERT_OK(bb_animate_run(&request, scene, result));
    bb_scene_free(scene);
    const bb_animate_method *tired = &result->methods[0], *lbvh = &result->methods[1];
    assert_int_equal(result->rounds, 2);
    assert_string_equal(tired->refused, "frame 1: wreck: it is tired, as told");
    assert_true(tired->failed && bb_animate_failed(result) == 1 && bb_animate_wrong(result) == 0);
    for (uint32_t f = 0; f < 4; f++) {
        const bb_animate_frame *frame = &tired->frames[f];
        assert_true(isnan(bb_animate_median(result, frame->update)) == (f > 0));
        assert_true(isnan(bb_animate_median(result, frame->transfer)) == (f > 0));
        assert_true(isnan(bb_animate_median(result, frame->traces[0].layout)) == (f > 0));
        assert_true(isnan(bb_animate_median(result, frame->traces[0].rays[1])) == (f > 0));
        assert_true(bb_animate_median(result, lbvh->frames[f].update) > 0);
    }
    assert_true(bb_animate_median(result, tired->frames[0].update) == tired->frames[0].update[1]);
    bb_animate_sums sums = bb_animate_sum(result, tired);
    assert_true(isnan(bb_animate_median(result, sums.update)) && isnan(sums.worst_update) &&
                isnan(bb_animate_median(result, sums.layout[0])));
    assert_true(sums.rays[1] > 0 && isnan(bb_animate_median(result, sums.traces[0][1])));
    assert_int_equal(bb_animate_winner(result, 1, 1e9), 1);
    bb_animate_release(result);
    free(result);
}

/* ---- rotations against a plain reference ---- */

static float area_of(const bb_node *a, const bb_node *b)
{
    float size[3];
    for (int k = 0; k < 3; k++)
        size[k] = fmaxf(a->hi[k], b->hi[k]) - fminf(a->lo[k], b->lo[k]);
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

static void join(bb_node *nodes, uint32_t n, const uint32_t children[2])
{
    for (int k = 0; k < 3; k++) {
        nodes[n].lo[k] = fminf(nodes[children[0]].lo[k], nodes[children[1]].lo[k]);
        nodes[n].hi[k] = fmaxf(nodes[children[0]].hi[k], nodes[children[1]].hi[k]);
    }
}

static void swap(uint32_t *a, uint32_t *b)
{
    uint32_t kept = *a;
    *a = *b;
    *b = kept;
}

/* The largest saving of all exchanges below n, found by making each. */
static float best_saving(bb_node *nodes, uint32_t (*children)[2], uint32_t n)
{
    uint32_t a = children[n][0], b = children[n][1];
    bool inner_a = children[a][0] != BB_NONE, inner_b = children[b][0] != BB_NONE;
    float best = 0, area_a = area_of(&nodes[a], &nodes[a]), area_b = area_of(&nodes[b], &nodes[b]);
    for (int side = 0; side < 2; side++)
        for (int g = 0; g < 2; g++) {
            uint32_t child = children[n][side], into = children[n][1 - side];
            if (!(side == 0 ? inner_b : inner_a))
                continue;
            float after = area_of(&nodes[child], &nodes[children[into][1 - g]]);
            best = fmaxf(best, (side == 0 ? area_b : area_a) - after);
        }
    for (int g = 0; g < 2 && inner_a && inner_b; g++) {
        swap(&children[a][0], &children[b][g]);
        float after = area_of(&nodes[children[a][0]], &nodes[children[a][1]]) +
                      area_of(&nodes[children[b][0]], &nodes[children[b][1]]);
        swap(&children[a][0], &children[b][g]);
        best = fmaxf(best, area_a + area_b - after);
    }
    return best;
}

static uint32_t list_children(const bb_tree *tree, uint32_t (*children)[2], uint32_t *order)
{
    uint32_t count = 0;
    for (uint32_t n = tree->info.root; n != BB_NONE;) {
        const bb_node *node = &tree->nodes[n];
        bool leaf = bb_node_is_leaf(node);
        order[count++] = n;
        children[n][0] = leaf ? BB_NONE : node->first;
        children[n][1] = leaf ? BB_NONE : tree->nodes[node->first].skip;
        n = leaf ? node->skip : node->first;
    }
    return count;
}

/* No exchange of two subtrees leaves a node, after the children have had theirs, that would have
 * saved more than the one that was made: the costs of the whole tree tell. */
static void each_node_takes_its_best_rotation(void **state)
{
    (void)state;
    for (int form = first_form(); form < FORMS; form++)
        for (uint32_t run = 0; run < 12; run++) {
            char name[96];
            bb_scene *scene;
            bb_instance plain, turned;
            bb_update_way way;
            snprintf(name, sizeof name, "crowd:kind=explode,n=%u,frames=3,seed=%u", 3 + 7 * run,
                     run);
            ASSERT_OK(bb_scene_load(name, &scene));
            ASSERT_OK(bb_scene_upload(scene, devices[form]));
            ASSERT_OK(bb_instance_create(devices[form], "lbvh+refit", scene, 1, &plain));
            ASSERT_OK(
                bb_instance_create(devices[form], "lbvh+refit:rotate=yes", scene, 1, &turned));
            ASSERT_OK(bb_instance_build(&plain, scene, false, NULL));
            ASSERT_OK(bb_instance_build(&turned, scene, false, NULL));
            ASSERT_OK(bb_scene_set_frame(scene, 2, NULL));
            ASSERT_OK(bb_instance_update(&plain, scene, 0, false, &way, NULL));
            assert_int_equal(way, BB_UPDATED);
            ASSERT_OK(bb_instance_update(&turned, scene, 0, false, &way, NULL));
            ASSERT_OK(bb_tree_download(&plain.tree, NULL));
            ASSERT_OK(bb_tree_download(&turned.tree, NULL));
            ASSERT_OK(bb_tree_check(&turned.tree, scene));
            uint32_t count = plain.tree.info.node_count;
            uint32_t(*children)[2] = calloc(count, sizeof *children);
            uint32_t *order = calloc(count, sizeof *order);
            bb_node *nodes = plain.tree.nodes;
            assert_int_equal(list_children(&plain.tree, children, order), count);
            double saved = 0, before = bb_tree_sah(&plain.tree);
            for (uint32_t i = count; i-- > 0;) {
                uint32_t n = order[i];
                if (children[n][0] == BB_NONE)
                    continue;
                float best = best_saving(nodes, children, n);
                uint32_t a = children[n][0], b = children[n][1];
                /* make it: the first exchange that saves as much */
                bool made = best == 0;
                for (int side = 1; side >= 0 && !made; side--)
                    for (int g = 1; g >= 0 && !made; g--) {
                        uint32_t into = side == 0 ? b : a;
                        if (children[into][0] == BB_NONE)
                            continue;
                        float saves =
                            area_of(&nodes[into], &nodes[into]) -
                            area_of(&nodes[children[n][side]], &nodes[children[into][1 - g]]);
                        if (saves != best)
                            continue;
                        swap(&children[n][side], &children[into][g]);
                        join(nodes, into, children[into]);
                        made = true;
                    }
                for (int g = 0; g < 2 && !made; g++) {
                    swap(&children[a][0], &children[b][g]);
                    float after = area_of(&nodes[children[a][0]], &nodes[children[a][1]]) +
                                  area_of(&nodes[children[b][0]], &nodes[children[b][1]]);
                    made = area_of(&nodes[a], &nodes[a]) + area_of(&nodes[b], &nodes[b]) - after ==
                           best;
                    if (!made)
                        swap(&children[a][0], &children[b][g]);
                }
                if (best > 0) {
                    assert_true(made);
                    if (children[a][0] != BB_NONE)
                        join(nodes, a, children[a]);
                    if (children[b][0] != BB_NONE)
                        join(nodes, b, children[b]);
                }
                saved += best;
            }
            double root = bb_half_area(nodes[order[0]].lo, nodes[order[0]].hi);
            double expected = before - BB_COST_TRAVERSAL * saved / root;
            double sah = bb_tree_sah(&turned.tree);
            if (fabs(sah - expected) > 1e-5 * before)
                fail_msg("%s: SAH %.9g, expected %.9g of %.9g", name, sah, expected, before);
            free(order);
            free(children);
            bb_instance_destroy(&plain);
            bb_instance_destroy(&turned);
            bb_scene_free(scene);
        }
}

/* ---- the command ---- */

static void bad_requests_get_one_line(void **state)
{
    (void)state;
    static const char *const bad[][2] = {
        {"animate", "animate needs --scene"},
        {"animate --scene cube", "does not move"},
        {"animate --scene twist:n=100 --frames 5", "is none of A..B"},
        {"animate --scene twist:n=100 --frames 5..2", "is none of A..B"},
        {"animate --scene twist:n=100 --frames 30..40", "they are 0 to 20"},
        {"animate --scene twist:n=100 --view nowhere", "has no view 'nowhere'"},
        {"animate --scene twist:n=100 --rays nothing", "nothing"},
        {"animate --scene twist:n=100 --builder lbvh+refit:trigger=sah", "is none of none, sah:F"},
        {"animate --scene twist:n=100 --builder lbvh+refit:trigger=sah:0.5", "a number of 1"},
        {"animate --scene twist:n=100 --builder lbvh+refit:trigger=every:2.5", "a whole number"},
        {"animate --scene twist:n=100 --builder lbvh+refit:pause=1", "give rotate=yes"},
        {"animate --scene car:away=1", "leave 'away' out"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        refuses("", bad[i][0], bad[i][1]);
}

static int set_up(void **state)
{
    return make_folder(state) == 0 ? open_devices(state) : -1;
}

static int tear_down(void **state)
{
    return close_devices(state) == 0 ? remove_folder(state) : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_method_is_right_in_every_frame),
        cmocka_unit_test(layouts_follow_in_place),
        cmocka_unit_test(triggers_fire_when_they_say),
        cmocka_unit_test(rotations_hold_the_cost),
        cmocka_unit_test(what_was_not_measured_is_no_figure),
        cmocka_unit_test(each_node_takes_its_best_rotation),
        cmocka_unit_test(bad_requests_get_one_line),
    };
    return cmocka_run_group_tests_name("animate", tests, set_up, tear_down);
}
