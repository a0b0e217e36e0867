/* The query interval: what exact arithmetic finds is right, and each way of being wrong is found. A
 * second. */
#include "framework/judge/arbiter.h"
#include "framework/judge/judge.h"
#include "framework/judge/queries.h"
#include "tests/hand_scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { RAYS = 2000 };

static const bb_interval no_hit = {{INFINITY, -INFINITY}, {BB_NONE, BB_NONE}};

/* By all primitives, one after the other. */
static bb_interval exact_interval(const bb_scene *scene, const bb_ray *ray)
{
    const double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
    bb_interval found = no_hit;
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        double t[2];
        if (bb_exact_hits(scene, o, ray->d, prim, t) == 0 || t[0] <= ray->tmin || t[0] >= ray->tmax)
            continue;
        for (int end = 0; end < 2; end++)
            if (end == 0 ? (float)t[0] < found.t[0] : (float)t[0] > found.t[1]) {
                found.t[end] = (float)t[0];
                found.prims[end] = prim;
            }
    }
    return found;
}

typedef struct bed {
    bb_scene *scene;
    bb_oracle *oracle;
    bb_rays set;
    bb_answers answers;
    bb_ray rays[RAYS];
    bb_interval truth[RAYS], said[RAYS];
    uint8_t classes[RAYS];
} bed;

static void make_bed(bed *b)
{
    bb_random random = bb_random_make(11, 0);
    memset(b, 0, sizeof *b);
    b->scene = hand_scene(300, 0);
    hand_random(b->scene, &random);
    hand_finish(b->scene);
    for (int i = 0; i < RAYS; i++) {
        bb_ray *ray = &b->rays[i];
        for (int k = 0; k < 3; k++) {
            ray->o[k] = (float)bb_random_range(&random, -3, 3);
            ray->d[k] = (float)bb_random_range(&random, -1, 1) - ray->o[k];
        }
        ray->tmax = i % 4 == 0 ? 1.0f : INFINITY;
    }
    b->set = (bb_rays){.name = "test", .query = bb_query_find("interval"), .count = RAYS};
    b->set.rays = b->rays;
    assert_non_null(b->set.query);
    assert_int_equal(bb_oracle_create(b->scene, 2, &b->oracle), BB_OK);
    assert_int_equal(bb_answers_make(b->oracle, &b->set, &b->answers), BB_OK);
    for (int i = 0; i < RAYS; i++)
        b->truth[i] = exact_interval(b->scene, &b->rays[i]);
}

static void free_bed(bed *b)
{
    bb_answers_release(&b->answers);
    bb_oracle_destroy(b->oracle);
    hand_free(b->scene);
}

static bb_accuracy judge(bed *b)
{
    bb_accuracy accuracy;
    const bb_verdict_request request = {.results = b->said, .count = RAYS, .classes = b->classes};
    assert_int_equal(bb_judge(b->oracle, &b->answers, &request, &accuracy), BB_OK);
    assert_int_equal(accuracy.checked, RAYS);
    return accuracy;
}

static void what_is_exact_is_right(void **state)
{
    (void)state;
    static bed b;
    uint32_t hits = 0, long_ones = 0;
    make_bed(&b);
    memcpy(b.said, b.truth, sizeof b.said);
    bb_accuracy accuracy = judge(&b);
    for (int i = 0; i < RAYS; i++) {
        hits += b.truth[i].prims[0] != BB_NONE;
        long_ones += b.truth[i].prims[0] != b.truth[i].prims[1];
    }
    assert_true(hits > RAYS / 4 && hits < RAYS && long_ones > RAYS / 12);
    assert_int_equal(accuracy.right, RAYS);
    assert_true(accuracy.wrong_ppm == 0.0 && accuracy.first_wrong == BB_NONE);
    free_bed(&b);
}

/* The ways of being wrong, each said of every ray of which it is a lie. */
static bool lie(int way, const bb_scene *scene, bb_interval *said)
{
    const bb_interval truth = *said;
    bool hit = truth.prims[0] != BB_NONE, two = hit && truth.t[1] > 1.01f * truth.t[0];
    switch (way) {
    case 0: /* the first is also the last */
        said->t[1] = truth.t[0];
        said->prims[1] = truth.prims[0];
        return two;
    case 1:
        said->t[0] = truth.t[1];
        said->prims[0] = truth.prims[1];
        return two;
    case 2:
        *said = no_hit;
        return hit;
    case 3:
        said->t[1] = 1.5f * truth.t[1];
        return hit;
    case 4:
        said->prims[0] = scene->prim_count;
        return hit;
    case 5: /* ends change places */
        *said = (bb_interval){{truth.t[1], truth.t[0]}, {truth.prims[1], truth.prims[0]}};
        return two;
    default:
        memset(said, 0xEE, sizeof *said);
        return true;
    }
}

static void lies_are_found(void **state)
{
    (void)state;
    static bed b;
    make_bed(&b);
    for (int way = 0; way <= 6; way++) {
        uint32_t lied = 0, found = 0, first = BB_NONE;
        for (uint32_t i = 0; i < RAYS; i++) {
            b.said[i] = b.truth[i];
            if (!lie(way, b.scene, &b.said[i])) {
                b.said[i] = b.truth[i];
                continue;
            }
            lied++;
            first = first == BB_NONE ? i : first;
        }
        bb_accuracy accuracy = judge(&b);
        for (uint32_t i = 0; i < RAYS; i++)
            found += b.classes[i] != BB_RIGHT;
        print_message("way %d: %u lies, %u found\n", way, lied, found);
        assert_true(lied > RAYS / 10);
        /* a needle's neighbour may lie within its margin */
        assert_true(found <= lied && found >= lied - lied / 50);
        assert_int_equal(accuracy.right, RAYS - found);
        assert_int_equal(accuracy.unwritten, way == 4 || way == 6 ? found : 0);
        assert_true(accuracy.first_wrong >= first);
    }
    free_bed(&b);
}

static void answers_are_the_same_if_all_of_them_is(void **state)
{
    (void)state;
    const bb_query *query = bb_query_find("interval");
    const bb_interval a = {{1, 2}, {3, 4}}, b = {{1, 2}, {3, 5}};
    char text[128];
    assert_true(query->same(&a, &a) && !query->same(&a, &b));
    query->say(&a, text, sizeof text);
    assert_string_equal(text, "primitive 3 at 0x1p+0 to primitive 4 at 0x1p+1");
    query->say(&no_hit, text, sizeof text);
    assert_string_equal(text, "a miss");
    assert_true(query->result_bytes <= BB_RESULT_BYTES_MAX);
    assert_null(bb_query_find("nearest"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_exact_is_right),
        cmocka_unit_test(lies_are_found),
        cmocka_unit_test(answers_are_the_same_if_all_of_them_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
