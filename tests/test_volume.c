/* Volumes: bricks and votes against loops, transfer functions at their corners, the builder's trees
 * in all forms of the device. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "framework/scene/volume.h"
#include "tests/device_forms.h"
#include "tests/scene_files.h"

#include <math.h>

/* ---- bricks ---- */

static bb_voxels random_voxels(const uint32_t dims[3], uint32_t bytes, uint32_t side)
{
    bb_voxels voxels = {{dims[0], dims[1], dims[2]}, {1, 2, 0.5}, bytes, NULL};
    bb_random random = bb_random_make(seed, dims[0] * 91 + dims[1] * 7 + dims[2]);
    ASSERT_OK(bb_voxels_reserve("test", side, &voxels));
    for (size_t i = 0; i < (size_t)dims[0] * dims[1] * dims[2]; i++)
        if (bytes == 1)
            ((uint8_t *)voxels.values)[i] = (uint8_t)bb_random_u64(&random);
        else
            ((uint16_t *)voxels.values)[i] = (uint16_t)bb_random_u64(&random);
    return voxels;
}

static uint32_t value_of(const void *values, uint32_t bytes, size_t i)
{
    return bytes == 1 ? ((const uint8_t *)values)[i] : ((const uint16_t *)values)[i];
}

/* Each value of each brick is the voxel that it stands for, or the nearest one that there is. */
static void expect_bricks(const bb_voxels *voxels, const bb_volume *volume)
{
    const bb_volume_grid *grid = &volume->grid;
    const uint32_t along = grid->side + 1;
    size_t at = 0;
    for (uint32_t brick = 0; brick < volume->brick_count; brick++) {
        const uint32_t corner[3] = {
            brick % grid->bricks[0] * grid->side,
            brick / grid->bricks[0] % grid->bricks[1] * grid->side,
            brick / (grid->bricks[0] * grid->bricks[1]) * grid->side,
        };
        uint32_t lo = UINT32_MAX, hi = 0;
        for (uint32_t i = 0; i < along * along * along; i++, at++) {
            uint32_t place[3] = {i % along, i / along % along, i / along / along};
            for (int k = 0; k < 3; k++) {
                place[k] += corner[k];
                if (place[k] >= voxels->dims[k])
                    place[k] = voxels->dims[k] - 1;
            }
            size_t from =
                ((size_t)place[2] * voxels->dims[1] + place[1]) * voxels->dims[0] + place[0];
            uint32_t value = value_of(voxels->values, voxels->bytes, from);
            assert_int_equal(value_of(volume->bricks, volume->bytes, at), value);
            lo = value < lo ? value : lo;
            hi = value > hi ? value : hi;
        }
        assert_int_equal(volume->ranges[brick], lo | hi << 16);
    }
    assert_int_equal(at * volume->bytes, bb_volume_bytes(volume));
}

static void bricks_hold_the_voxels_of_their_cells(void **state)
{
    (void)state;
    static const uint32_t dims[][3] = {{2, 2, 2},   {9, 9, 9},   {10, 9, 8}, {17, 3, 5},
                                       {33, 18, 2}, {8, 64, 11}, {5, 5, 34}};
    for (size_t d = 0; d < sizeof dims / sizeof dims[0]; d++)
        for (uint32_t side = 4; side <= 32; side *= 2)
            for (uint32_t bytes = 1; bytes <= 2; bytes++) {
                bb_voxels voxels = random_voxels(dims[d], bytes, side);
                bb_volume *volume;
                ASSERT_OK(bb_volume_make("test", &voxels, side, &volume));
                for (int k = 0; k < 3; k++)
                    assert_int_equal(volume->grid.bricks[k], (dims[d][k] - 2) / side + 1);
                expect_bricks(&voxels, volume);
                bb_volume_free(volume);
                bb_voxels_free(&voxels);
            }
}

static void voxels_that_make_no_volume_are_refused(void **state)
{
    (void)state;
    static const struct {
        bb_voxels voxels;
        bb_status status;
        const char *words;
    } cases[] = {
        {{{1, 9, 9}, {1, 1, 1}, 1, NULL}, BB_INVALID, "1 voxels along x"},
        {{{9, 9, 0}, {1, 1, 1}, 1, NULL}, BB_INVALID, "0 voxels along z"},
        {{{9, 8194, 9}, {1, 1, 1}, 1, NULL}, BB_REFUSED, "8194 voxels along y"},
        {{{8000, 8000, 8000}, {1, 1, 1}, 2, NULL}, BB_REFUSED, "bytes"},
        {{{9, 9, 9}, {1, 0, 1}, 1, NULL}, BB_INVALID, "along y are 0 apart"},
        {{{9, 9, 9}, {NAN, 1, 1}, 1, NULL}, BB_INVALID, "along x are nan apart"},
        {{{9, 9, 9}, {1, 1, INFINITY}, 1, NULL}, BB_INVALID, "along z are inf apart"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_voxels voxels = cases[i].voxels;
        assert_int_equal(bb_voxels_reserve("test", 8, &voxels), cases[i].status);
        if (strstr(bb_message(), cases[i].words) == NULL)
            fail_msg("the message lacks '%s': %s", cases[i].words, bb_message());
    }
}

/* ---- transfer functions ---- */

static void transfer_functions_are_linear_between_their_points(void **state)
{
    (void)state;
    bb_transfer transfer;
    bb_transfer_entry table[BB_TRANSFER_STEPS];
    const double last = BB_TRANSFER_STEPS - 1;
    ASSERT_OK(bb_transfer_parse("test",
                                "# a step at 1/2\n"
                                "0.25 0 1 0 0  # red\n"
                                "\n"
                                "0.5 0.5\n"
                                "0.5 0 0 1 0\r\n"
                                "1 1 0 0 1",
                                &transfer));
    assert_int_equal(transfer.count, 4);
    bb_transfer_table(&transfer, 2, table);
    for (uint32_t i = 0; i < BB_TRANSFER_STEPS; i++) {
        double value = i / last;
        double alpha = value < 0.25 ? 0 : value < 0.5 ? (value - 0.25) * 2 : (value - 0.5) * 2;
        double left = fmax(1 - alpha, BB_TRANSFER_LEAST_LEFT);
        ASSERT_NEAR(table[i].extinction, -log(left) / 2, 1e-5 * -log(left));
        if (table[i].extinction > 0) {
            ASSERT_NEAR(table[i].rgb[0], value < 0.5 ? 1 : 0, 1e-6);
            ASSERT_NEAR(table[i].rgb[2], value < 0.5 ? 0 : (value - 0.5) * 2, 1e-6);
        }
    }
    /* one point: the same everywhere */
    ASSERT_OK(bb_transfer_parse("test", "0.3 0.25", &transfer));
    bb_transfer_table(&transfer, 1, table);
    assert_true(table[0].extinction == table[BB_TRANSFER_STEPS - 1].extinction);
    ASSERT_NEAR(table[0].extinction, -log(0.75), 1e-6);
    assert_true(table[7].rgb[0] == 1 && table[7].rgb[1] == 1 && table[7].rgb[2] == 1);
    /* what no device tells from 0 is 0 */
    ASSERT_OK(bb_transfer_parse("test", "0 1e-300", &transfer));
    bb_transfer_table(&transfer, 1, table);
    assert_true(table[0].extinction == 0);
}

static void bad_transfer_functions_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"", "no line VALUE ALPHA"},
        {"# nothing\n\n", "no line VALUE ALPHA"},
        {"0.5", "line 1: has 1 numbers"},
        {"0 0\n0.1 0.1 0.1\n", "line 2: has 3 numbers"},
        {"0 0 0 0 0 0\n", "line 1: '0' is too much"},
        {"0 2\n", "line 1: '2' is no number from 0 to 1"},
        {"0 -0.5\n", "'-0.5'"},
        {"0 nan\n", "'nan'"},
        {"0.5 0\n0.25 0\n", "line 2: value 0.25 comes after 0.5"},
        {"a b\n", "line 1: 'a'"},
    };
    bb_transfer transfer;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(bb_transfer_parse("test", cases[i].text, &transfer), BB_INVALID);
        if (strstr(bb_message(), cases[i].words) == NULL)
            fail_msg("'%s': the message lacks '%s': %s", cases[i].text, cases[i].words,
                     bb_message());
    }
    char many[4 * BB_TRANSFER_POINTS_MAX + 8] = "";
    for (int i = 0; i <= BB_TRANSFER_POINTS_MAX; i++)
        strcat(many, "0 0\n");
    assert_int_equal(bb_transfer_parse("test", many, &transfer), BB_INVALID);
    assert_int_equal(bb_transfer_load("rampp", &transfer), BB_INVALID);
    assert_non_null(strstr(bb_message(), "did you mean 'ramp'?"));
    assert_int_equal(bb_transfer_load("/nowhere.txt", &transfer), BB_INVALID);
    for (const bb_transfer_preset *p = bb_transfer_presets; p->name != NULL; p++) {
        ASSERT_OK(bb_transfer_load(p->name, &transfer));
        assert_string_equal(transfer.name, p->name);
    }
}

/* The table's extinction at a value, as the device interpolates it, in doubles. */
static double extinction_at(const bb_transfer_entry *table, double value, double white)
{
    double x = value * (BB_TRANSFER_STEPS - 1) / white;
    uint32_t i = x >= BB_TRANSFER_STEPS - 1 ? BB_TRANSFER_STEPS - 2 : (uint32_t)x;
    double w = x - i;
    return table[i].extinction * (1 - w) + table[i + 1].extinction * w;
}

static void random_transfer(bb_random *random, bb_transfer *transfer)
{
    transfer->count = 2 + bb_random_below(random, 6);
    double value = 0;
    for (uint32_t i = 0; i < transfer->count; i++) {
        bool nothing = bb_random_below(random, 3) > 0;
        value += bb_random_unit(random) * (1 - value) * (bb_random_below(random, 4) > 0 ? 0.5 : 0);
        transfer->points[i] =
            (bb_transfer_point){value, nothing ? 0 : bb_random_unit(random), {1, 1, 1}};
    }
}

/* What is not seen has no value in its range, and none a hair beyond, that absorbs; what is seen
 * has one within three steps of the table. */
static void a_vote_is_right_at_the_corners(void **state)
{
    (void)state;
    static bb_volume volume;
    bb_transfer transfer;
    bb_transfer_entry table[BB_TRANSFER_STEPS];
    bb_random random = bb_random_make(seed, 9);
    uint32_t seen = 0, unseen = 0;
    for (int round = 0; round < 300; round++) {
        uint32_t white = round % 2 == 0 ? 255 : 65535;
        volume.grid.white = white;
        for (int k = 0; k < 3; k++)
            volume.grid.cell[k] = 1;
        random_transfer(&random, &transfer);
        bb_volume_set_transfer(&volume, &transfer);
        bb_transfer_table(&transfer, 1, table);
        for (int i = 0; i < 200; i++) {
            uint32_t lo = bb_random_below(&random, white + 1);
            uint32_t hi =
                lo + bb_random_below(&random, i % 2 == 0                    ? white + 1 - lo
                                              : white / 64 < white + 1 - lo ? white / 64 + 1
                                                                            : 1);
            bool votes = bb_volume_sees(&volume, lo, hi);
            double least = fmax(0, lo - 1e-3), most = fmin(white, hi + 1e-3), step = white / 1023.0;
            bool any = false, near = false;
            for (double v = least - 3 * step; v <= most + 3 * step; v += step / 7) {
                double value = fmin(fmax(v, 0), white);
                bool absorbs = extinction_at(table, value, white) > 0;
                near = near || absorbs;
                any = any || (absorbs && v >= least && v <= most);
            }
            any = any || extinction_at(table, least, white) > 0 ||
                  extinction_at(table, most, white) > 0;
            if (any && !votes)
                fail_msg("values %u to %u of %u are seen and voted out (seed %llu)", lo, hi, white,
                         (unsigned long long)seed);
            if (votes && !near)
                fail_msg("values %u to %u of %u are not seen and voted in (seed %llu)", lo, hi,
                         white, (unsigned long long)seed);
            seen += votes;
            unseen += !votes;
        }
    }
    assert_true(seen > 1000 && unseen > 1000);
}

/* ---- trees ---- */

static uint64_t hash_of(bb_device *on, bb_scene *scene, const char *builder)
{
    bb_instance instance;
    uint64_t hash;
    if (bb_scene_upload(scene, on) != BB_OK ||
        bb_instance_create(on, builder, scene, seed, &instance) != BB_OK ||
        bb_instance_build(&instance, scene, true, NULL) != BB_OK ||
        bb_tree_download(&instance.tree, NULL) != BB_OK ||
        bb_tree_check(&instance.tree, scene) != BB_OK ||
        bb_tree_hash(&instance.tree, &hash) != BB_OK)
        fail_msg("%s, %s: %s", scene->name, builder, bb_message());
    bb_instance_destroy(&instance);
    return hash;
}

/* Both votes, both ways of linking, and all forms of the device: one tree. */
static void all_ways_give_one_tree(void **state)
{
    (void)state;
    static const char *const scenes[] = {"nbody:n=34,brick=4", "nbody:n=40,transfer=sparse",
                                         "nbody:n=40,transfer=full,brick=16"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++)
        for (int prune = 0; prune <= 5; prune += prune == 0 ? 1 : 4) {
            uint64_t first = 0;
            bb_scene *scene = load_scene(scenes[s]);
            for (int form = first_form(); form < FORMS; form++)
                for (int way = 0; way < 4; way++) {
                    char builder[64];
                    snprintf(builder, sizeof builder, "vlbvh:prune=%d,vote=%s,link=%s", prune,
                             way % 2 == 0 ? "voxels" : "ranges", way < 2 ? "karras" : "apetrei");
                    uint64_t hash = hash_of(devices[form], scene, builder);
                    first = first == 0 ? hash : first;
                    if (hash != first)
                        fail_msg("%s, %s, form %d: another tree", scenes[s], builder, form);
                }
            bb_scene_free(scene);
        }
}

/* Leaves are cubes of bricks: as many references in a leaf as bricks of the cube are seen. */
static void pruned_leaves_are_cubes(void **state)
{
    (void)state;
    bb_instance instance;
    bb_device *on = devices[first_form()];
    bb_scene *scene = load_scene("nbody:n=65,brick=4,transfer=full");
    ASSERT_OK(bb_scene_upload(scene, on));
    ASSERT_OK(bb_instance_create(on, "vlbvh:prune=2", scene, seed, &instance));
    ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
    assert_int_equal(scene->prim_count, 16 * 16 * 16);
    assert_int_equal(instance.tree.info.leaf_count, 4 * 4 * 4);
    assert_int_equal(instance.tree.info.ref_count, 16 * 16 * 16);
    bb_instance_destroy(&instance);
    bb_scene_free(scene);
}

/* Without a volume there is nothing to vote on. */
static void other_scenes_are_unsupported(void **state)
{
    (void)state;
    bb_instance instance;
    bb_device *on = devices[first_form()];
    bb_scene *scene = load_scene("blocks:side=4");
    ASSERT_OK(bb_scene_upload(scene, on));
    assert_int_equal(bb_instance_create(on, "vlbvh", scene, seed, &instance), BB_UNSUPPORTED);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bricks_hold_the_voxels_of_their_cells),
        cmocka_unit_test(voxels_that_make_no_volume_are_refused),
        cmocka_unit_test(transfer_functions_are_linear_between_their_points),
        cmocka_unit_test(bad_transfer_functions_are_refused),
        cmocka_unit_test(a_vote_is_right_at_the_corners),
        cmocka_unit_test(all_ways_give_one_tree),
        cmocka_unit_test(pruned_leaves_are_cubes),
        cmocka_unit_test(other_scenes_are_unsupported),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
