/* Tetrahedra of two meshes that meet: by trees on the device against exact arithmetic over all
 * pairs, where they overlap, touch by a face, an edge or a corner, and just do not; then by trees
 * against no tree, on what is awkward. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind).
 * Seed: BVHBENCH_TEST_SEED. */
#include "framework/scene/tets_gather.h"
#include "framework/tasks/overlap.h"
#include "tests/lattice_mesh.h"
#include "tests/steps_fixture.h"

static bool small, floats; /* floats: as on a device that has no doubles */

static uint32_t tets_of(const bb_scene *scene)
{
    return scene->prims[BB_TETRAHEDRON].count;
}

typedef struct overlapping {
    bb_overlapper *overlapper;
    bb_tet_search search;
    const bb_scene *scene;
    bool boundary;
    bb_buffer *results, *counts;
} overlapping;

static bb_status launch(void *self, const bb_recording *recording)
{
    overlapping *o = self;
    o->search.recording = recording;
    return bb_overlap(o->overlapper, o->scene, &o->search, o->boundary, o->results, o->counts);
}

/* Each tetrahedron's steps at nodes are as many as were counted. */
static void expect_steps(overlapping *o, uint32_t count)
{
    bb_simulated_code code = {.kernel = NULL};
    bb_steps steps;
    bb_count *counts = malloc(count * sizeof *counts);
    check(bb_tet_search_code(&o->search, "overlap_tets", o->boundary, &code), "code");
    check(bb_buffer_read(o->counts, 0, count * sizeof *counts, counts), "counts");
    check(bb_steps_record(device, launch, o, count, BB_SAMPLE_ALL, &steps), "steps");
    step_sums *sums = sum_steps(&steps);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(tested_nodes(&sums[i], code.footing.control), counts[i].nodes);
        assert_int_equal(sums[i].of[BB_STEP_RESTART], counts[i].restarts);
        assert_int_equal(sums[i].of[BB_STEP_EXACT], counts[i].prims);
        assert_true(sums[i].of[BB_STEP_PRIMS] >= counts[i].prims); /* boxes that do not meet */
        /* a corner inside ends the search */
        assert_true(counts[i].prims - sums[i].of[BB_STEP_FURTHER] <= 1);
    }
    if (code.footing.control == BB_UNTIL_LEAF)
        expect_lists(&steps);
    free(sums);
    free(counts);
    bb_steps_release(&steps);
    bb_simulated_code_release(&code);
}

/* Asks a way twice, counting and not; returns the pairs that it looked at. */
static uint64_t overlap(const bb_scene *scene, bb_scene *other, const tet_way *way,
                        uint32_t *results)
{
    const uint32_t count = tets_of(scene);
    searched s = {0};
    bb_overlapper overlapper = bb_overlapper_init;
    bb_buffer there, counted;
    bb_count *counts = malloc(count * sizeof *counts);
    uint32_t *again = malloc(count * sizeof *again);
    uint64_t tests = 0;
    open_search(&s, other, way);
    overlapper.overlap.floats = overlapper.cells_inside.floats = overlapper.leaves_inside.floats =
        floats;
    make_buffer(&there, NULL, count * sizeof *results);
    make_buffer(&counted, NULL, count * sizeof *counts);
    for (int counting = 0; counting < 2; counting++) {
        uint32_t *to = counting ? again : results;
        check(bb_buffer_fill(&there, count * sizeof *results, BB_POISON), "poison");
        check(bb_overlap(&overlapper, scene, &s.search, way->boundary, &there,
                         counting ? &counted : NULL),
              "overlap");
        check(bb_buffer_read(&there, 0, count * sizeof *results, to), "results");
    }
    assert_memory_equal(results, again, count * sizeof *again);
    expect_steps(&(overlapping){&overlapper, s.search, scene, way->boundary, &there, &counted},
                 count);
    check(bb_buffer_read(&counted, 0, count * sizeof *counts, counts), "counts");
    for (uint32_t i = 0; i < count; i++)
        tests += counts[i].prims;
    bb_buffer_release(&there);
    bb_buffer_release(&counted);
    bb_overlapper_release(&overlapper);
    close_search(&s);
    free(counts);
    free(again);
    return tests;
}

/* ---- against exact arithmetic ---- */

static void expect_exact(bb_scene *const scenes[2], const lattice lattices[2], uint32_t *meeting)
{
    for (int s = 0; s < 2; s++)
        check(bb_scene_upload(scenes[s], device), "upload");
    for (int asking = 0; asking < 2; asking++) {
        const bb_scene *own = scenes[asking], *other = scenes[1 - asking];
        const uint32_t count = tets_of(own);
        uint32_t *expected = calloc(count, sizeof *expected);
        uint32_t *found = malloc(count * sizeof *found);
        for (uint32_t i = 0; i < count; i++) {
            const solid a = tet_of(own, &lattices[asking], i);
            for (uint32_t k = 0; k < tets_of(other) && expected[i] == 0; k++) {
                const solid b = tet_of(other, &lattices[1 - asking], k);
                expected[i] = has_volume(&a) && has_volume(&b) && solids_meet(&a, &b);
            }
            *meeting += expected[i];
        }
        for (int w = 0; w < TET_WAYS; w += small ? 3 : 1) {
            overlap(own, scenes[1 - asking], &tet_ways[w], found);
            for (uint32_t i = 0; i < count; i++)
                if (floats ? found[i] < expected[i] : found[i] != expected[i])
                    fail_msg("way %d, mesh %d, tetrahedron %u: %u, not %u", w, asking, i, found[i],
                             expected[i]);
        }
        free(expected);
        free(found);
    }
}

static void overlap_is_exact_on_lattices(void **state)
{
    (void)state;
    /* The second beside the first: deep inside it, partly, on a face, on an edge, on a corner, and
     * one step away from each of these. */
    static const int64_t shifts[][3] = {{10, 13, 7},  {40, 33, 21}, {64, 0, 0},  {64, 64, 5},
                                        {64, 64, 64}, {65, 0, 0},   {64, 65, 5}, {64, 64, 65},
                                        {-32, 0, 3},  {0, -33, 3},  {1, 0, 0}};
    uint32_t touching = 0, apart = 0;
    for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; i += small ? 7 : 1)
        for (int form = 0; form < (small ? 1 : 3); form++) {
            /* as it is; far away; tiny, with holes */
            const double scale = form == 2 ? 0x1p-60 : 1;
            const int64_t far = form == 1 ? 1 << 21 : 0;
            lattice lattices[2] = {{small ? 2 : 4, 5, form == 2 ? 3 : 0, {far, 0, far}, scale},
                                   {small ? 1 : 2, 4, 0, {far, 0, far}, scale}};
            bb_scene *scenes[2];
            uint32_t meeting = 0;
            for (int k = 0; k < 3; k++)
                lattices[1].shift[k] += shifts[i][k];
            for (int s = 0; s < 2; s++)
                scenes[s] = make_lattice(&lattices[s], 2 * i + (uint64_t)s);
            expect_exact(scenes, lattices, &meeting);
            if (i % 4 == 0 && form != 1) { /* none is missed */
                uint32_t again = 0;
                floats = true;
                expect_exact(scenes, lattices, &again);
                floats = false;
            }
            touching += meeting > 0;
            apart += meeting == 0;
            for (int s = 0; s < 2; s++)
                bb_scene_free(scenes[s]);
        }
    assert_true(small || (touching > 10 && apart >= 6));
}

/* ---- against no tree ---- */

/* All ways agree; returns how many meet. */
static uint32_t expect_agreement(const char *a, const char *b)
{
    bb_scene *scenes[2];
    uint32_t meeting = 0;
    check(bb_scene_load(a, &scenes[0]), a);
    check(bb_scene_load(b, &scenes[1]), b);
    for (int s = 0; s < 2; s++)
        check(bb_scene_upload(scenes[s], device), "upload");
    for (int asking = 0; asking < 2; asking++) {
        const uint32_t count = tets_of(scenes[asking]);
        uint32_t *expected = malloc(count * sizeof *expected);
        uint32_t *found = malloc(count * sizeof *found);
        overlap(scenes[asking], scenes[1 - asking], &tet_ways[TET_WAYS - 1], expected);
        for (uint32_t i = 0; i < count; i++)
            meeting += expected[i];
        for (int w = 0; w + 1 < TET_WAYS; w += small ? 3 : 1) {
            overlap(scenes[asking], scenes[1 - asking], &tet_ways[w], found);
            for (uint32_t i = 0; i < count; i++)
                if (found[i] != expected[i])
                    fail_msg("%s, %s, way %d, mesh %d, tetrahedron %u: %u, not %u", a, b, w, asking,
                             i, found[i], expected[i]);
        }
        free(expected);
        free(found);
    }
    for (int s = 0; s < 2; s++)
        bb_scene_free(scenes[s]);
    return meeting;
}

/* Slivers, tetrahedra without a volume, inverted ones, copies, one alone; widths that grow a
 * billionfold; meshes that are far smaller or thinner than the other. */
static void awkward_meshes_agree(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"tets:side=2", "tets:side=1,flat=2"},
        {"tets:side=5", "tets:side=4,shape=shell,jitter=0.6"},
        {"tets:side=4,flat=3", "tets:side=4,flip=2,twins=5"},
        {"tets:side=1,shape=block", "tets:side=6,jitter=0"},
        {"tets:side=12,shape=block,grade=5.6,jitter=0", "tets:side=3"},
        {"tets:side=4,thin=60", "tets:side=4"},
        {"tets:side=4,thin=20", "tets:side=3,thin=20,jitter=0.9"},
        {"tets:side=3,jitter=1", "tets:side=3,jitter=1,seed=2"},
    };
    uint32_t most = 0;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i += small ? 8 : 1) {
        uint32_t meeting = expect_agreement(pairs[i][0], pairs[i][1]);
        most = meeting > most ? meeting : most;
    }
    assert_true(most > 100 || small);
}

/* Cells that are all inside spare tests: of a mesh in the middle of a large one, all. */
static void flags_spare_tests(void **state)
{
    (void)state;
    bb_scene *large = NULL, *little = NULL, *moved = NULL;
    if (small)
        return;
    check(bb_scene_load("tets:side=16,shape=block,jitter=0", &large), "large");
    check(bb_scene_load("tets:side=3,jitter=0.5", &little), "little");
    bb_tets_part part = {.scene = little, .scale = 1};
    for (int k = 0; k < 3; k++)
        part.shift[k] = ((double)large->bounds.lo[k] + (double)large->bounds.hi[k] -
                         (double)little->bounds.lo[k] - (double)little->bounds.hi[k]) /
                        2;
    check(bb_tets_gather("moved", &part, 1, &moved), "moved");
    check(bb_scene_upload(large, device), "large");
    check(bb_scene_upload(moved, device), "moved");
    uint32_t *results = malloc(tets_of(moved) * sizeof *results);
    const tet_way without = {"olbvh", "octree", false}, with = {"olbvh", "octree", true};
    assert_true(overlap(moved, large, &without, results) >= tets_of(moved));
    assert_true(overlap(moved, large, &with, results) == 0);
    for (uint32_t i = 0; i < tets_of(moved); i++)
        assert_int_equal(results[i], 1);
    free(results);
    bb_scene_free(large);
    bb_scene_free(little);
    bb_scene_free(moved);
}

/* A corner so far away that it is no number in the other's unit: refused, not answered wrongly. */
static void what_is_too_far_is_refused(void **state)
{
    (void)state;
    const lattice l = {1, 0, 0, {0, 0, 0}, 0x1p-4};
    bb_scene *cube = make_lattice(&l, 1), *far = calloc(1, sizeof *far);
    bb_overlapper overlapper = bb_overlapper_init;
    static const float corners[4][3] = {
        {0.5f, 0.5f, 2}, {0.3f, 0.4f, -1e30f}, {0.5f, 0.5f, -1}, {0.6f, 0.5f, -1}};
    check(bb_scene_reserve(far, 4, &(bb_prim_counts){.of = {[BB_TETRAHEDRON] = 1}}), "far");
    memcpy(far->vertices, corners, sizeof corners);
    for (uint32_t i = 0; i < 4; i++)
        ((uint32_t *)far->prims[BB_TETRAHEDRON].data)[i] = i;
    check(bb_scene_finish(far), "far");
    check(bb_scene_upload(cube, device), "cube");
    check(bb_scene_upload(far, device), "far");
    if (cube->scale >= 0x1p30f)
        assert_int_equal(bb_overlap_check(&overlapper, far, cube), BB_UNSUPPORTED);
    assert_int_equal(bb_overlap_check(&overlapper, cube, far), BB_OK);
    overlapper.overlap.floats = true;
    assert_int_equal(bb_overlap_check(&overlapper, far, cube), BB_UNSUPPORTED);
    bb_overlapper_release(&overlapper);
    bb_scene_free(cube);
    bb_scene_free(far);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_overlapper overlapper = bb_overlapper_init;
    bb_buffer none = {0};
    searched s = {0};
    check(bb_scene_load("tets:side=1", &scene), "tets");
    check(bb_scene_upload(scene, device), "tets");
    open_search(&s, scene, &tet_ways[0]);
    assert_int_equal(bb_overlap(&overlapper, scene, &s.search, true, &none, NULL), BB_UNSUPPORTED);
    bb_overlapper_release(&overlapper);
    close_search(&s);
    bb_scene_free(scene);
}

static int set_up(void **state)
{
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    return open_device(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(overlap_is_exact_on_lattices),
        cmocka_unit_test(awkward_meshes_agree),
        cmocka_unit_test(flags_spare_tests),
        cmocka_unit_test(what_is_too_far_is_refused),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, close_device);
}
