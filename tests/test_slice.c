/* Slices of tetrahedra: which voxels have material, and by which tetrahedron, against exact
 * arithmetic on meshes of integers, where voxels touch tetrahedra by faces, edges and corners; then
 * trees against no tree, bit for bit, on what is awkward; values against doubles; plans that cannot
 * be. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). Seed: BVHBENCH_TEST_SEED. */
#include "framework/tasks/slice.h"
#include "tests/lattice_mesh.h"
#include "tests/locate_all.h"
#include "tests/steps_fixture.h"

static bool small, floats; /* floats: as on a device that has no doubles */
static uint64_t restarts;  /* of all searches, as recorded */

static uint32_t tets_of(const bb_scene *scene)
{
    return scene->prims[BB_TETRAHEDRON].count;
}

typedef struct slicing {
    bb_tet_kernels *slicer;
    bb_tet_search search;
    const bb_slice_args *args;
    bool boundary;
    bb_buffer *voxels, *counts;
} slicing;

static bb_status launch(void *self, const bb_recording *recording)
{
    slicing *s = self;
    s->search.recording = recording;
    return bb_slice(s->slicer, &s->search, s->boundary, s->args, s->voxels, s->counts);
}

/* Each voxel's steps at nodes are as many as were counted, and so are restarts; with all
 * tetrahedra, each search reads all until it ends. */
static void expect_steps(slicing *s, uint32_t count)
{
    bb_simulated_code code = {.kernel = NULL};
    bb_steps steps;
    bb_count *counts = malloc(count * sizeof *counts);
    check(bb_tet_search_code(&s->search, "slice_tets", s->boundary, &code), "code");
    check(bb_buffer_read(s->counts, 0, count * sizeof *counts, counts), "counts");
    check(bb_steps_record(device, launch, s, count, BB_SAMPLE_ALL, &steps), "steps");
    assert_true((strstr(code.program, ":boundary=no") != NULL) ==
                (bb_tet_search_has_boundary(s->search.way) && !s->boundary));
    step_sums *sums = sum_steps(&steps);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *of = sums[i].of;
        assert_int_equal(tested_nodes(&sums[i], code.footing.control), counts[i].nodes);
        assert_int_equal(of[BB_STEP_RESTART], counts[i].restarts);
        restarts += of[BB_STEP_RESTART];
        assert_true(of[BB_STEP_AGAIN] <= 1 && of[BB_STEP_POP] <= of[BB_STEP_PUSH]);
        if (of[BB_STEP_RESTART] == 0 && code.footing.control == BB_UNTIL_LEAF)
            assert_int_equal(of[BB_STEP_POP], of[BB_STEP_PUSH]);
        assert_int_equal(sums[i].first_prims + of[BB_STEP_EXACT], counts[i].prims);
        assert_true(of[BB_STEP_FURTHER] <= of[BB_STEP_EXACT]); /* the first is the nearest so far */
        assert_true((of[BB_STEP_FURTHER] > 0) == (of[BB_STEP_EXACT] > 0));
    }
    if (code.footing.control == BB_UNTIL_LEAF)
        expect_lists(&steps);
    free(sums);
    free(counts);
    bb_steps_release(&steps);
    bb_simulated_code_release(&code);
}

/* Asks a way twice, counting and not. */
static void slice(const bb_slice_args *args, bb_scene *scene, const tet_way *way,
                  bb_sliced *results)
{
    const uint32_t count = args->size[0] * args->size[1];
    searched s = {0};
    bb_tet_kernels slicer = bb_slice_kernels;
    bb_buffer there, counted;
    bb_sliced *again = malloc(count * sizeof *again);
    open_search(&s, scene, way);
    slicer.floats = floats;
    make_buffer(&there, NULL, count * sizeof *results);
    make_buffer(&counted, NULL, count * sizeof(bb_count));
    for (int counting = 0; counting < 2; counting++) {
        check(bb_buffer_fill(&there, count * sizeof *results, BB_POISON), "poison");
        check(bb_slice(&slicer, &s.search, way->boundary, args, &there, counting ? &counted : NULL),
              "slice");
        check(bb_buffer_read(&there, 0, count * sizeof *results, counting ? again : results),
              "results");
    }
    assert_memory_equal(results, again, count * sizeof *again);
    expect_steps(&(slicing){&slicer, s.search, args, way->boundary, &there, &counted}, count);
    bb_buffer_release(&there);
    bb_buffer_release(&counted);
    bb_tet_kernels_release(&slicer);
    close_search(&s);
    free(again);
}

/* ---- against exact arithmetic ---- */

/* Between planes of integers; twice, so that its middle is one, too. */
typedef struct voxel {
    solid box;        /* times 2 */
    double centre[3]; /* of the scene */
} voxel;

static voxel voxel_of(const bb_slice_args *args, const lattice *l, uint32_t x, uint32_t y)
{
    const uint32_t at[2] = {x, y};
    const uint32_t along[2] = {args->axis == 0 ? 1 : 0, args->axis == 2 ? 1 : 2};
    int64_t ends[2][3];
    voxel v = {.box.count = 8};
    for (int k = 0; k < 2; k++)
        for (uint32_t e = 0; e < 2; e++)
            ends[e][along[k]] =
                (int64_t)(2 * ((double)args->lo[k] + (double)args->step[k] * (at[k] + e)) /
                          l->scale);
    ends[0][args->axis] = (int64_t)(2 * (double)args->below / l->scale);
    ends[1][args->axis] = (int64_t)(2 * (double)args->above / l->scale);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            v.box.v[i][k] = ends[i >> k & 1][k];
    for (int k = 0; k < 3; k++)
        v.centre[k] = (double)(ends[0][k] + ends[1][k]) / 4 * l->scale;
    return v;
}

static solid doubled(solid s)
{
    for (int i = 0; i < s.count; i++)
        for (int k = 0; k < 3; k++)
            s.v[i][k] *= 2;
    return s;
}

static void expect_voxel(const bb_scene *scene, const lattice *l, const voxel *v,
                         const bb_sliced *found, uint32_t *touched)
{
    const uint32_t first = scene->prims[BB_TETRAHEDRON].first;
    uint32_t holders[64], holding = locate_all(scene, v->centre, holders, 64);
    bool meets = false, meets_boundary = false;
    for (uint32_t i = 0; i < tets_of(scene) && holding == 0; i++) {
        const solid tet = doubled(tet_of(scene, l, i));
        const bool met = has_volume(&tet) && solids_meet(&tet, &v->box);
        const bool outer = (scene->tets->flags[i] & BB_TET_BOUNDARY) != 0;
        meets = meets || met;
        meets_boundary = meets_boundary || (met && outer);
        if (found->prim == first + i && !floats)
            assert_true(met && outer);
    }
    assert_int_equal(meets, meets_boundary); /* the kernel relies on it */
    if (floats) {                            /* nothing is missed */
        assert_true(found->prim != BB_NONE || (holding == 0 && !meets));
        return;
    }
    assert_int_equal(found->inside, holding > 0);
    assert_int_equal(found->prim != BB_NONE, holding > 0 || meets);
    if (holding > 0)
        assert_int_equal(found->prim, holders[0]);
    *touched += holding == 0 && meets;
}

static void material_is_exact_on_lattices(void **state)
{
    (void)state;
    uint32_t touched = 0, empty = 0;
    for (int form = 0; form < (small ? 1 : 7); form++) {
        floats = form == 6;
        const double scale = form % 3 == 2 ? 0x1p-60 : 1;
        const int64_t far = form % 3 == 1 ? 1 << 20 : 0;
        const lattice l = {small ? 2 : 3, form < 3 ? 5 : 0, 3, {far, 0, far}, scale};
        bb_scene *scene = make_lattice(&l, (uint64_t)form);
        check(bb_scene_upload(scene, device), "upload");
        bb_slice_plan plan = {.axis = (uint32_t)form % 3,
                              .width = (uint32_t)l.side * 8,
                              .height = (uint32_t)l.side * 4,
                              .count = (uint32_t)l.side * 4,
                              .thickness = 4 * scale};
        check(bb_slice_plan_check(scene, &plan), "plan");
        const uint32_t voxels = plan.width * plan.height;
        bb_sliced *found = malloc(voxels * sizeof *found);
        for (uint32_t n = 0; n < plan.count; n += small ? 8 : 3) {
            const bb_slice_args args = bb_slice_at(scene, &plan, n);
            for (int w = 0; w < TET_WAYS; w += small ? 3 : 1) {
                slice(&args, scene, &tet_ways[w], found);
                for (uint32_t i = 0; i < voxels; i++) {
                    const voxel v = voxel_of(&args, &l, i % plan.width, i / plan.width);
                    expect_voxel(scene, &l, &v, &found[i], &touched);
                    empty += found[i].prim == BB_NONE;
                }
            }
        }
        free(found);
        bb_scene_free(scene);
    }
    floats = false;
    assert_true(small || (touched > 20 && empty > 100));
}

/* ---- against no tree ---- */

static void expect_agreement(const char *name, uint32_t axis, uint32_t *extended)
{
    bb_scene *scene = NULL;
    bb_slice_plan plan = {
        .axis = axis, .width = small ? 6 : 30, .height = small ? 5 : 20, .count = small ? 2 : 5};
    const uint32_t voxels = plan.width * plan.height;
    bb_sliced *expected = malloc(voxels * sizeof *expected);
    bb_sliced *found = malloc(voxels * sizeof *found);
    check(bb_scene_load(name, &scene), name);
    check(bb_scene_upload(scene, device), name);
    check(bb_slice_plan_check(scene, &plan), name);
    for (uint32_t n = 0; n < plan.count; n++) {
        const bb_slice_args args = bb_slice_at(scene, &plan, n);
        slice(&args, scene, &tet_ways[TET_WAYS - 1], expected);
        for (int w = 0; w + 1 < TET_WAYS; w += small ? 3 : 1) {
            slice(&args, scene, &tet_ways[w], found);
            for (uint32_t i = 0; i < voxels; i++)
                if (memcmp(&found[i], &expected[i], sizeof *found) != 0)
                    fail_msg("%s, slice %u, way %d, voxel %u: %u by %g, not %u by %g", name, n, w,
                             i, found[i].prim, (double)found[i].value, expected[i].prim,
                             (double)expected[i].value);
        }
        for (uint32_t i = 0; i < voxels; i++) {
            *extended += expected[i].prim != BB_NONE && expected[i].inside == 0;
            if (expected[i].prim != BB_NONE)
                assert_true(expected[i].value >= scene->tets->field_lo &&
                            expected[i].value <= scene->tets->field_hi);
        }
    }
    bb_scene_free(scene);
    free(expected);
    free(found);
}

static void awkward_meshes_agree(void **state)
{
    (void)state;
    static const char *const names[] = {
        "tets:side=1",
        "tets:side=5",
        "tets:side=6,shape=shell,jitter=0.4",
        "tets:side=4,flat=3,flip=2",
        "tets:side=10,shape=block,grade=8,jitter=0",
        "tets:side=4,thin=40",
    };
    uint32_t extended = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i += small ? 6 : 1)
        expect_agreement(names[i], (uint32_t)i % 3, &extended);
    assert_true(small || extended > 200);
}

/* ---- values ---- */

/* A field that is linear all over is continued as such, but not beyond its own range. */
static void linear_fields_are_continued(void **state)
{
    (void)state;
    const lattice l = {2, 5, 0, {0, 0, 0}, 1};
    bb_scene *scene = make_lattice(&l, 9);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        const float *at = scene->vertices + 3 * (size_t)v;
        scene->tets->field[v] = 3 + at[0] - 2 * at[1] + 0.5f * at[2];
    }
    scene->tets->field_lo = 3 - 2 * 32;
    scene->tets->field_hi = 3 + 32 + 16;
    check(bb_scene_upload(scene, device), "upload");
    /* voxels lie half beyond the mesh above it, and below */
    bb_slice_plan plan = {.axis = 2, .width = 8, .height = 8, .count = 9, .thickness = 4};
    check(bb_slice_plan_check(scene, &plan), "plan");
    uint32_t beside = 0;
    for (uint32_t n = 0; n < plan.count; n++) {
        bb_slice_args args = bb_slice_at(scene, &plan, n);
        bb_sliced found[64];
        args.below -= 0.5f * (float)(n == 0) * 4;
        args.above += 3.5f * (float)(n == plan.count - 1);
        slice(&args, scene, &tet_ways[3], found);
        for (uint32_t i = 0; i < 64; i++) {
            const double x = 4.0 * (i % 8) + 2, y = 4.0 * (i / 8) + 2;
            const double z = ((double)args.below + (double)args.above) / 2;
            double value = 3 + x - 2 * y + 0.5 * z;
            value = fmax(3 - 2 * 32, fmin(3 + 32 + 16, value));
            assert_true(found[i].prim != BB_NONE);
            assert_true(fabs((double)found[i].value - value) < 1e-4);
            beside += found[i].inside == 0;
        }
    }
    assert_true(beside >= 64);
    bb_scene_free(scene);
}

/* ---- searches that restart ---- */

/* A voxel as large as a hollow mesh meets more nodes than a short stack has room for. */
static void large_voxels_restart(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_sliced found;
    check(bb_scene_load("tets:side=6,shape=shell", &scene), "tets");
    check(bb_scene_upload(scene, device), "tets");
    bb_slice_plan plan = {.axis = 2, .width = 1, .height = 1, .count = 1};
    check(bb_slice_plan_check(scene, &plan), "plan");
    const bb_slice_args args = bb_slice_at(scene, &plan, 0);
    const tet_way published = {"olbvh", "olbvh", true};
    restarts = 0;
    slice(&args, scene, &published, &found);
    assert_true(found.inside == 0 && restarts > 0);
    bb_scene_free(scene);
}

/* ---- what cannot be ---- */

static void plans_that_cannot_be_are_refused(void **state)
{
    (void)state;
    static const bb_slice_plan bad[] = {
        {.axis = 2, .width = 1u << 26, .height = 1, .count = 1},
        {.axis = 0, .width = 2, .height = 1u << 26, .count = 1},
        {.axis = 2, .width = 8, .height = 8, .count = 1, .thickness = 1e-30},
        {.axis = 2, .width = 8, .height = 8, .count = 2, .thickness = 4e38},
        {.axis = 2, .width = 8, .height = 8, .count = 1, .thickness = 1e20}, /* times the scale */
    };
    static const bb_slice_plan none[] = {
        {.axis = 2, .width = 65536, .height = 65536, .count = 1},
        {.axis = 2, .width = 0, .height = 8, .count = 1},
        {.axis = 2, .width = 8, .height = 8, .count = 0, .thickness = 1},
    };
    bb_scene *scene = NULL, *cube = NULL;
    check(bb_scene_load("tets:side=1", &scene), "tets");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        bb_slice_plan plan = bad[i];
        assert_int_equal(bb_slice_plan_check(scene, &plan), BB_INVALID);
        assert_non_null(strstr(bb_message(), "floats can tell"));
    }
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        bb_slice_plan plan = none[i];
        assert_int_equal(bb_slice_plan_check(scene, &plan), BB_INVALID);
        assert_non_null(strstr(bb_message(), "at least one"));
    }
    bb_scene_free(scene);
    check(bb_scene_load("cube", &cube), "cube");
    assert_int_equal(
        bb_slice_plan_check(cube, &(bb_slice_plan){.width = 2, .height = 2, .count = 1}),
        BB_UNSUPPORTED);
    bb_scene_free(cube);
}

static void boundaries_need_cells(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_tet_kernels slicer = bb_slice_kernels;
    bb_buffer none = {0};
    searched s = {0};
    bb_slice_plan plan = {.width = 2, .height = 2, .count = 1};
    check(bb_scene_load("tets:side=1", &scene), "tets");
    check(bb_scene_upload(scene, device), "tets");
    check(bb_slice_plan_check(scene, &plan), "plan");
    const bb_slice_args args = bb_slice_at(scene, &plan, 0);
    open_search(&s, scene, &tet_ways[0]);
    assert_int_equal(bb_slice(&slicer, &s.search, true, &args, &none, NULL), BB_UNSUPPORTED);
    bb_tet_kernels_release(&slicer);
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
        cmocka_unit_test(material_is_exact_on_lattices),    cmocka_unit_test(awkward_meshes_agree),
        cmocka_unit_test(linear_fields_are_continued),      cmocka_unit_test(large_voxels_restart),
        cmocka_unit_test(plans_that_cannot_be_are_refused), cmocka_unit_test(boundaries_need_cells),
    };
    return cmocka_run_group_tests(tests, set_up, close_device);
}
