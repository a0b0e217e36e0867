/* How work-groups hand over: which devices document a fence, by made-up lists; how many launches
 * and waits a build without one takes, and whether its tree is that with a fence, bit for bit. */
#include "framework/device/handover.h"

#include "framework/base/random.h"
#include "tests/box_fixture.h"
#include "tests/device_forms.h"

#include <math.h>

/* ---- what is documented ---- */

static bb_named_version named(cl_uint major, const char *name)
{
    bb_named_version n = {.version = major << 22};      /* CL_MAKE_VERSION(major, 0, 0) */
    memcpy(n.name, name, strnlen(name, sizeof n.name)); /* of full length: without an end */
    return n;
}

#define ORDER "__opencl_c_atomic_order_acq_rel"
#define SCOPE "__opencl_c_atomic_scope_device"

static void fences_are_found_in_lists(void **state)
{
    (void)state;
    char endless[sizeof((bb_named_version *)0)->name + 1];
    memset(endless, 'x', sizeof endless - 1);
    endless[sizeof endless - 1] = '\0';
    bb_named_version c1[] = {named(1, "OpenCL C")};
    bb_named_version c2[] = {named(1, "OpenCL C"), named(2, "OpenCL C")};
    bb_named_version c3[] = {named(1, "OpenCL C"), named(3, "OpenCL C")};
    bb_named_version c23[] = {named(2, "OpenCL C"), named(3, "OpenCL C")};
    bb_named_version both[] = {named(3, ORDER), named(3, SCOPE)};
    bb_named_version order[] = {named(3, ORDER), named(3, ORDER "x")};
    bb_named_version scope[] = {named(3, SCOPE), named(3, "")};
    bb_named_version odd[] = {named(3, endless), named(3, endless)};
    bb_named_version many[1000];
    for (size_t i = 0; i < 1000; i++)
        many[i] = i == 998 ? both[0] : i == 999 ? both[1] : odd[0];
#define LIST(names)                                                                                \
    {                                                                                              \
        names, sizeof names / sizeof *names                                                        \
    }
#define EMPTY                                                                                      \
    {                                                                                              \
        NULL, 0                                                                                    \
    }
    const struct {
        bb_driver_names versions, features;
        const char *version, *option;
    } cases[] = {
        {EMPTY, EMPTY, "OpenCL C 1.2 ", ""},
        {EMPTY, EMPTY, "OpenCL C 2.0 ", "-cl-std=CL2.0"}, /* before lists */
        {EMPTY, EMPTY, "OpenCL C 3.0 ", ""},
        {EMPTY, EMPTY, "", ""},
        {EMPTY, LIST(both), "OpenCL C 1.2 ", ""},
        {LIST(c1), LIST(both), "OpenCL C 1.2 ", ""},
        {LIST(c2), EMPTY, "OpenCL C 1.2 ", "-cl-std=CL2.0"},
        {LIST(c3), EMPTY, "OpenCL C 1.2 ", ""},
        {LIST(c3), EMPTY, "OpenCL C 2.0 ", "-cl-std=CL2.0"},
        {LIST(c3), LIST(both), "OpenCL C 1.2 ", "-cl-std=CL3.0"},
        {LIST(c3), LIST(order), "OpenCL C 1.2 ", ""},
        {LIST(c3), LIST(scope), "OpenCL C 1.2 ", ""},
        {LIST(c3), LIST(odd), "OpenCL C 1.2 ", ""},
        {LIST(c3), LIST(many), "OpenCL C 1.2 ", "-cl-std=CL3.0"},
        {LIST(c23), LIST(order), "OpenCL C 1.2 ", "-cl-std=CL2.0"},
        {LIST(c23), LIST(both), "OpenCL C 1.2 ", "-cl-std=CL3.0"},
        {LIST(odd), LIST(odd), "", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *option =
            bb_fence_option(&cases[i].versions, &cases[i].features, cases[i].version);
        if (strcmp(option, cases[i].option) != 0)
            fail_msg("case %zu: '%s', not '%s'", i, option, cases[i].option);
    }
}

/* ---- launches ---- */

typedef enum order { RANDOM, SORTED, EQUAL, CHAIN, ORDERS } order;
static const char *const order_names[ORDERS] = {"random", "sorted", "equal", "chain"};

/* Chain: a fortieth of them at each distance from a corner, and each distance half of the one
 * before. */
static bb_box *make_order(order kind, uint32_t count)
{
    bb_box *boxes = calloc(count, sizeof *boxes);
    bb_random random = bb_random_make(seed, kind);
    assert_non_null(boxes);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double at = kind == RANDOM   ? bb_random_unit(&random)
                        : kind == SORTED ? (double)i / count
                        : kind == EQUAL  ? 0.5
                                         : ldexp(1, -(int)(i * UINT64_C(40) / count));
            boxes[i].lo[k] = (float)at;
            boxes[i].hi[k] = boxes[i].lo[k];
            if (kind != EQUAL) /* those have one centroid */
                boxes[i].hi[k] += (float)(1e-3 * at * bb_random_unit(&random));
        }
    return boxes;
}

static void make_tree(bb_device *on, const char *builder, const bb_box *boxes, uint32_t count,
                      box_build *b)
{
    memset(b, 0, sizeof *b);
    b->scene = scene_of(boxes, count);
    bb_tree_init(&b->preorder, NULL);
    check(upload_boxes(&b->scene, on), builder);
    check(bb_instance_create(on, builder, &b->scene, 1, &b->instance), builder);
    for (int i = 0; i < 2; i++) /* the first one may prepare */
        check(bb_instance_build(&b->instance, &b->scene, false, NULL), builder);
    check(bb_tree_download(&b->instance.tree, NULL), builder);
    check(bb_tree_check(&b->instance.tree, &b->scene), builder);
    check(bb_tree_preorder(&b->instance.tree, &b->preorder), builder);
}

static void expect_same(const box_build *a, const box_build *b, const char *what, uint32_t count)
{
    const bb_tree *x = &a->preorder, *y = &b->preorder;
    if (memcmp(&x->info, &y->info, sizeof x->info) != 0 ||
        memcmp(x->nodes, y->nodes, x->info.node_count * sizeof *x->nodes) != 0 ||
        memcmp(x->refs, y->refs, x->info.ref_count * sizeof *x->refs) != 0)
        fail_msg("%s, %u boxes: not the tree that there is with a fence", what, count);
}

/* By chunks of both sizes: the form for CPUs and that for GPUs. */
static void expect_few(const char *builder, order kind, uint32_t count, uint32_t most)
{
    bb_box *boxes = make_order(kind, count);
    box_build fence;
    make_tree(devices[GPU_FORM], builder, boxes, count, &fence);
    for (int form = CPU_FORM; form <= LEVELS_FORM; form += LEVELS_FORM) {
        bb_device *on = devices[form];
        const bb_handover handover = on->handover;
        box_build b;
        on->handover = BB_HANDOVER_LEVELS;
        make_tree(on, builder, boxes, count, &b);
        on->handover = handover;
        const bb_timing *timing = &b.instance.steps[0].timing.timing;
        if (timing->launches > most || timing->launches == 0 || timing->waits > 0)
            fail_msg("%s, %u boxes, %s, form %d: %llu launches, %llu waits", builder, count,
                     order_names[kind], form, (unsigned long long)timing->launches,
                     (unsigned long long)timing->waits);
        expect_same(&fence, &b, order_names[kind], count);
        close_box_build(&b);
    }
    close_box_build(&fence);
    free(boxes);
}

static void builds_without_a_fence_are_few_launches(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 17, 1000, 2049, 8193, 100000};
    const bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (uint32_t c = 0; c < (small ? 3 : sizeof counts / sizeof *counts); c++)
        for (order kind = 0; kind < ORDERS; kind++) {
            expect_few("lbvh", kind, counts[c], 40);
            expect_few("lbvh:bits=63", kind, counts[c], 80);
        }
    for (order kind = 0; kind < ORDERS && !small; kind++)
        expect_few("lbvh", kind, 1000000, 40);
}

int main(void)
{
    seed = seed_or(seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fences_are_found_in_lists),
        cmocka_unit_test(builds_without_a_fence_are_few_launches),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
