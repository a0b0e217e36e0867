/* LLBVH against a slow recursive construction from the definition: levels found by trying all of
 * them, cells bit by bit; in both forms, by both ways of linking, each option; bit for bit. Seed:
 * BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "tests/box_fixture.h"
#include "tests/device_forms.h"
#include "tests/fixture.h"
#include "tests/loose_reference.h"

#include <float.h>
#include <stdio.h>

/* ---- what is built ---- */

typedef enum side { SMALLEST, LARGEST, MEAN, VOLUME } side;
typedef enum box { SCENE, CENTROIDS, CUBE } box;

/* Options beside their text; what is 0 is the default. */
typedef struct way {
    const char *options;
    uint32_t levels;
    side side;
    box box;
    double loose;
    bool fit, even;
    uint32_t upto, merge; /* ANY: without limit */
    uint32_t order[3];    /* axes of the bits of a level */
    uint32_t flips;
} way;

#define ANY UINT32_MAX

static way with_defaults(way w)
{
    static const uint32_t xyz[3] = {0, 1, 2};
    w.levels = w.levels == 0 ? 10 : w.levels;
    w.loose = w.loose == 0 ? 2 : w.loose;
    w.upto = w.upto == 0 ? w.levels : w.upto;
    w.merge = w.merge == 0 ? 64 : w.merge == ANY ? 0 : w.merge;
    if (w.order[0] == w.order[1])
        memcpy(w.order, xyz, sizeof xyz);
    return w;
}

static const way ways[] = {
    {"box=scene", .box = SCENE},
    {"box=cube", .box = CUBE},
    {"box=centroids", .box = CENTROIDS},
    {"box=scene,link=search", .box = SCENE},
    {"box=cube,bits=63", .levels = 21, .box = CUBE},
    {"box=cube,bits=63,link=search,merge=1", .levels = 21, .box = CUBE, .merge = 1},
    {"box=cube,bits=3", .levels = 1, .box = CUBE},
    {"box=cube,bits=6,merge=4,link=search", .levels = 2, .box = CUBE, .merge = 4},
    {"box=scene,bits=9,merge=0", .levels = 3, .box = SCENE, .merge = ANY},
    {"box=scene,bits=36,side=largest", .levels = 12, .box = SCENE, .side = LARGEST},
    {"box=cube,side=largest,loose=1.5", .box = CUBE, .side = LARGEST, .loose = 1.5},
    {"box=cube,side=mean", .box = CUBE, .side = MEAN},
    {"box=cube,side=volume,merge=1", .box = CUBE, .side = VOLUME, .merge = 1},
    {"box=scene,side=mean", .box = SCENE, .side = MEAN},
    {"box=scene,side=volume", .box = SCENE, .side = VOLUME},
    {"box=scene,sizes=yes,upto=6", .box = SCENE, .even = true, .upto = 6},
    {"box=cube,bits=63,sizes=yes", .levels = 21, .box = CUBE, .even = true},
    {"box=cube,view=1/-3/2", .box = CUBE, .order = {1, 2, 0}, .flips = 2},
    {"box=scene,view=-1/-3/-2,link=search", .box = SCENE, .order = {1, 2, 0}, .flips = 7},
};

/* The fit test: only where a box is sure to fit at the level of eq. 1 does it give the deepest
 * level that fits. */
static const way fits[] = {
    {"box=cube,side=largest", .box = CUBE, .side = LARGEST, .fit = true},
    {"box=cube,side=largest,loose=3", .box = CUBE, .side = LARGEST, .fit = true, .loose = 3},
    {"box=scene,side=largest", .box = SCENE, .side = LARGEST, .fit = true},
};

/* ---- the reference's places ---- */

typedef struct cells {
    double low[3], whole[3]; /* of the root cell */
    float scale[3];          /* cells of the deepest level per unit; 0: an axis of one cell */
    uint32_t of[3];          /* the centroid's cell */
    double centroid[3], sides[3];
} cells;

/* Is the box small enough for `level`, or small enough to fit whatever its cell? */
static bool is_small(const way *w, const cells *c, uint32_t level)
{
    uint32_t axes = 0, small = 0;
    double sum = 0, product = 1;
    for (int k = 0; k < 3; k++) {
        if (c->scale[k] == 0)
            continue;
        float reach = (float)((w->loose - 1) * c->whole[k]);
        axes++;
        small += ldexp(c->sides[k], (int)level) <= reach;
        sum += (float)((float)c->sides[k] / reach);
        product *= ldexp((float)((float)c->sides[k] / reach), (int)level);
    }
    return axes == 0 || (w->side == LARGEST    ? small == axes
                         : w->side == SMALLEST ? small > 0
                         : w->side == MEAN     ? ldexp(sum, (int)level) <= axes
                                               : product <= 1);
}

/* Does the box lie in the enlarged cell of its centroid? */
static bool lies_inside(const way *w, const cells *c, uint32_t level)
{
    for (int k = 0; k < 3; k++) {
        double cell = ldexp(c->whole[k], -(int)level);
        double middle = c->low[k] + ((c->of[k] >> (w->levels - level)) + 0.5) * cell;
        double reach = 0.5 * w->loose * cell, half = 0.5 * c->sides[k];
        if (c->scale[k] != 0 &&
            (c->centroid[k] - half < middle - reach || c->centroid[k] + half > middle + reach))
            return false;
    }
    return true;
}

static loose_node place_of(const way *w, const cells *c)
{
    uint32_t level = w->levels;
    while (level > 0 && !(w->fit ? lies_inside(w, c, level) : is_small(w, c, level)))
        level--;
    if (w->even && level < w->levels)
        level -= level % 2;
    if (level > w->upto)
        level = w->levels;
    loose_node node = {0, 3 * level};
    for (uint32_t l = 0; l < w->levels; l++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t axis = w->order[k];
            uint64_t bit = (c->of[axis] >> (w->levels - 1 - l) & 1) ^ (w->flips >> axis & 1);
            node.path = node.path << 1 | (l < level ? bit : 0);
        }
    return node;
}

static float centroid_of(const bb_box *box, int k)
{
    return 0.5f * box->lo[k] + 0.5f * box->hi[k];
}

static void make_places(const way *w, const bb_box *boxes, uint32_t count, loose_node *places)
{
    double high[3], longest = 0;
    cells c;
    for (int k = 0; k < 3; k++) {
        c.low[k] = INFINITY;
        high[k] = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            bool centroids = w->box == CENTROIDS;
            c.low[k] = fmin(c.low[k], centroids ? centroid_of(&boxes[i], k) : boxes[i].lo[k]);
            high[k] = fmax(high[k], centroids ? centroid_of(&boxes[i], k) : boxes[i].hi[k]);
        }
        longest = fmax(longest, high[k] - c.low[k]);
    }
    for (int k = 0; k < 3; k++) {
        c.whole[k] = w->box == CUBE ? longest : high[k] - c.low[k];
        double scale = ldexp(1, (int)w->levels) / c.whole[k];
        c.scale[k] = c.whole[k] > 0 && scale <= FLT_MAX ? (float)scale : 0;
    }
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            float at = centroid_of(&boxes[i], k), last = (float)((1u << w->levels) - 1);
            float cell = (at - (float)c.low[k]) * c.scale[k];
            c.of[k] = (uint32_t)(cell < last ? cell : last);
            c.centroid[k] = at;
            c.sides[k] = boxes[i].hi[k] - boxes[i].lo[k];
        }
        places[i] = place_of(w, &c);
    }
}

/* ---- the comparison ---- */

static void compare(bb_device *device, const way *given, const bb_box *boxes, uint32_t count,
                    const char *what)
{
    const way filled = with_defaults(*given), *w = &filled;
    char builder[96];
    snprintf(builder, sizeof builder, "llbvh:%s,fit=%s", w->options, w->fit ? "yes" : "no");
    loose_node *places = malloc(count * sizeof *places);
    loose_reference r;
    make_places(w, boxes, count, places);
    loose_reference_make(&r, boxes, places, count, 3 * w->levels, w->merge);

    box_build b;
    open_box_build(&b, device, builder, boxes, count, what);
    if (!loose_reference_equals(&r, &b.preorder))
        fail_msg("%s, %s, %u boxes, seed %llu: not the tree of the definition: %u nodes of %u",
                 builder, what, count, (unsigned long long)seed, b.preorder.info.node_count,
                 r.node_count);
    loose_reference_release(&r);
    free(places);
    close_box_build(&b);
}

/* ---- inputs ---- */

static void set_box(bb_box *box, const double centre[3], const double sides[3])
{
    *box = (bb_box){{0}, 0, {0}, 0};
    for (int k = 0; k < 3; k++) {
        box->lo[k] = (float)(centre[k] - 0.5 * sides[k]);
        box->hi[k] = (float)(centre[k] + 0.5 * sides[k]);
    }
}

typedef void (*fill_function)(bb_random *random, uint32_t i, uint32_t count, bb_box *box);

static void fill_mixed(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3], s[3];
    for (int k = 0; k < 3; k++) {
        c[k] = bb_random_range(random, -1, 1) * (k + 1);
        s[k] = exp2(-12 * bb_random_unit(random));
    }
    set_box(box, c, s);
}

/* All levels at few places: nearly every node has ancestors with primitives. */
static void fill_dense(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)count;
    double c[3], size = exp2(-(double)bb_random_below(random, 6));
    for (int k = 0; k < 3; k++)
        c[k] = i < 2 ? (double)i * 2 - 1 : bb_random_range(random, -1, 1) / (1 + (i & 8));
    set_box(box, c, (const double[]){size, size, size});
}

static void fill_equal(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double size = exp2(-3 * bb_random_unit(random));
    set_box(box, (const double[]){3, -4, 5}, (const double[]){size, size, size});
}

static void fill_flat(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    box->lo[1] = box->hi[1] = 2;
}

/* Boxes of axis-aligned triangles: one side is 0. */
static void fill_aligned(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    box->hi[i % 3] = box->lo[i % 3];
}

static void fill_points(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    memcpy(box->hi, box->lo, sizeof box->hi);
}

static void fill_duplicates(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    if (i % 20 != 0)
        set_box(box, (const double[]){0.25, 0.5, 0.75}, (const double[]){0.5, 0.25, 0.125});
}

static void fill_outlier(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    if (i == count / 2)
        set_box(box, (const double[]){1e8, 1e8, 1e8}, (const double[]){1, 1, 1});
}

/* Sides and places from denormal to 2^60. */
static void fill_extreme(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3], s[3];
    for (int k = 0; k < 3; k++) {
        c[k] = ldexp(bb_random_range(random, -1, 1), (int)bb_random_below(random, 200) - 140);
        s[k] = ldexp(bb_random_unit(random), (int)bb_random_below(random, 200) - 140);
    }
    set_box(box, c, s);
}

static const struct {
    const char *name;
    fill_function fill;
} inputs[] = {
    {"mixed", fill_mixed},           {"dense", fill_dense},
    {"equal", fill_equal},           {"flat", fill_flat},
    {"aligned", fill_aligned},       {"points", fill_points},
    {"duplicates", fill_duplicates}, {"outlier", fill_outlier},
    {"extreme", fill_extreme},
};

static void trees_are_those_of_the_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 65, 129, 1000, 5003};
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (size_t k = 0; k < sizeof inputs / sizeof inputs[0]; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            if ((counts[c] > 2000 && k > 1) || (small && counts[c] != 65))
                continue;
            bb_random random = bb_random_make(seed, k * 100 + c);
            bb_box *boxes = malloc(counts[c] * sizeof *boxes);
            for (uint32_t i = 0; i < counts[c]; i++)
                inputs[k].fill(&random, i, counts[c], &boxes[i]);
            for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++)
                for (int form = first_form(); form < FORMS; form++)
                    if (!small || (w + k) % 8 == 0)
                        compare(devices[form], &ways[w], boxes, counts[c], inputs[k].name);
            free(boxes);
        }
}

/* Whole numbers in a box of 1024: all that is compared is exact. */
static void fit_test_finds_the_deepest_level(void **state)
{
    (void)state;
    enum { COUNT = 500 };
    bb_box boxes[COUNT];
    for (uint32_t t = 0; t < 4; t++) {
        bb_random random = bb_random_make(seed, 5000 + t);
        set_box(&boxes[0], (const double[]){512, 512, 512}, (const double[]){1024, 1024, 1024});
        for (uint32_t i = 1; i < COUNT; i++) {
            boxes[i] = (bb_box){{0}, 0, {0}, 0};
            uint32_t most = 1u << bb_random_below(&random, 10);
            for (int k = 0; k < 3; k++) {
                uint32_t length = bb_random_below(&random, most + 1);
                uint32_t low = bb_random_below(&random, 1025 - length);
                boxes[i].lo[k] = (float)low;
                boxes[i].hi[k] = (float)(low + length);
            }
        }
        for (size_t w = 0; w < sizeof fits / sizeof fits[0]; w++)
            compare(devices[t & 1], &fits[w], boxes, COUNT, "whole numbers");
    }
}

/* What has no octree is refused in one line. */
static void other_codes_are_refused(void **state)
{
    (void)state;
    static const char *const builders[] = {
        "llbvh:code=emc64-var", "llbvh:code=emc32-sort", "llbvh:bits=31", "llbvh:bits=64",
        "llbvh:every=4",        "llbvh:loose=1",         "llbvh:upto=22",
    };
    bb_box box = {{0}, 0, {1, 1, 1}, 0};
    bb_scene scene = {.name = "test", .kinds = BB_TRIANGLES, .prim_count = 1, .boxes = &box};
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_instance instance;
        assert_int_equal(bb_instance_create(devices[0], builders[i], &scene, 1, &instance),
                         BB_INVALID);
        assert_null(strchr(bb_message(), '\n'));
        bb_instance_destroy(&instance);
    }
}

int main(void)
{
    seed = seed_or(20181012);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_those_of_the_definition),
        cmocka_unit_test(fit_test_finds_the_deepest_level),
        cmocka_unit_test(other_codes_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
