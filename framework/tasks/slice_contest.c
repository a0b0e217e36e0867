#include "framework/tasks/slice_contest.h"

#include "framework/base/memory.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"
#include "framework/tasks/mesh_row.h"

#include <stdio.h>
#include <string.h>

typedef struct slicing {
    bb_slice_request request; /* with a complete plan */
    bb_scene *scene;
    bb_contest_task task;
    bb_tet_kernels kernels;
    bb_slice_args slice;       /* the present one */
    uint64_t filled, extended; /* voxels with material; of these, beyond a tetrahedron */
} slicing;

/* ---- slices as answers ---- */

static bb_status take(void *self, uint32_t number, uint32_t *items)
{
    slicing *s = self;
    s->slice = bb_slice_at(s->scene, &s->request.plan, number);
    *items = s->task.most_items;
    return BB_OK;
}

static bb_status ask(void *self, const bb_contest_runner *runner, bb_contest_answers answers)
{
    slicing *s = self;
    bb_tet_search search;
    BB_TRY(bb_contest_search(runner, &s->task, 0, &search));
    search.recording = answers.recording;
    return bb_slice(&s->kernels, &search, runner->by_boundary, &s->slice, answers.items,
                    answers.counts);
}

static bb_status code_of(void *self, const bb_contest_runner *runner, bb_simulated_code *code)
{
    const slicing *s = self;
    bb_tet_search search;
    BB_TRY(bb_contest_search(runner, &s->task, 0, &search));
    BB_TRY(bb_tet_search_code(&search, "slice_tets", runner->by_boundary, code));
    code->footing.result_bytes = sizeof(bb_sliced);
    return BB_OK;
}

/* ---- pictures ---- */

/* From the top, and from black, where there is no material, over the map of colours. */
static void paint(const slicing *s, const bb_sliced *voxels, float *rgb, float *numbers)
{
    const bb_slice_plan *plan = &s->request.plan;
    const float lo = s->scene->tets->field_lo, range = s->scene->tets->field_hi - lo;
    for (uint32_t y = 0; y < plan->height; y++)
        for (uint32_t x = 0; x < plan->width; x++) {
            const bb_sliced *voxel = &voxels[(size_t)(plan->height - 1 - y) * plan->width + x];
            const size_t at = (size_t)y * plan->width + x;
            const bool filled = voxel->prim != BB_NONE;
            memset(rgb + 3 * at, 0, 3 * sizeof *rgb);
            if (filled)
                bb_colour_map(range > 0 ? (voxel->value - lo) / range : 0.5f, rgb + 3 * at);
            numbers[2 * at] = voxel->value;
            numbers[2 * at + 1] = filled ? (voxel->inside != 0 ? 1 : 0.5f) : 0;
        }
}

static bb_status write(const slicing *s, uint32_t number, const bb_sliced *voxels, float *rgb,
                       float *numbers)
{
    const bb_slice_plan *plan = &s->request.plan;
    char path[4096];
    paint(s, voxels, rgb, numbers);
    snprintf(path, sizeof path, "%s-%03u.png", s->request.contest.pictures, number);
    BB_TRY(bb_image_write(path, rgb, plan->width, plan->height));
    snprintf(path, sizeof path, "%s-%03u.exr", s->request.contest.pictures, number);
    return s->request.exr ? bb_exr_write(path, numbers, "YA", plan->width, plan->height) : BB_OK;
}

/* Counts what is filled, and writes the picture. */
static bb_status see(void *self, uint32_t number, const void *first, uint32_t items)
{
    slicing *s = self;
    const bb_sliced *voxels = first;
    float *rgb = NULL, *numbers = NULL;
    for (uint32_t i = 0; i < items; i++) {
        s->filled += voxels[i].prim != BB_NONE;
        s->extended += voxels[i].prim != BB_NONE && voxels[i].inside == 0;
    }
    if (s->request.contest.pictures == NULL)
        return BB_OK;
    bb_status status = bb_host_alloc(NULL, 3 * (size_t)items * sizeof *rgb, "a picture", &rgb);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, 2 * (size_t)items * sizeof *numbers, "a picture", &numbers);
    if (status == BB_OK)
        status = write(s, number, voxels, rgb, numbers);
    bb_host_free(rgb);
    bb_host_free(numbers);
    return status;
}

/* ---- as rows of a table ---- */

BB_TEXT(axis, "axis", "across", "Across which axis slices lie.");
BB_EXACT(width, "width", "width", "", "Of a slice, in voxels.", NEITHER, 0);
BB_EXACT(height, "height", "height", "", "Of a slice, in voxels.", NEITHER, 0);
BB_EXACT(slices, "slices", "slices", "", "How many.", NEITHER, 0);
BB_EXACT(thickness, "thickness", "thickness", "", "Of a slice, in scene units.", NEITHER, -1);
BB_EXACT(voxels, "voxels", "voxels", "", "Of all slices.", NEITHER, 0);
BB_EXACT(filled, "voxels_filled", "voxels with material", "", "Of all slices.", NEITHER, 0);
BB_EXACT(filled_part, "filled_percent", "with material", "%", "Of all voxels.", NEITHER, 1);
BB_EXACT(extended, "voxels_extended", "voxels by a tetrahedron beside the centre", "",
         "Of all slices.", NEITHER, 0);
BB_EXACT(extended_part, "extended_percent", "by a tetrahedron beside the centre", "%",
         "Of all voxels.", NEITHER, 1);

const bb_page_outline bb_slice_outline = {
    .command = "slice",
    .title = "bvhbench: slices of meshes",
    BB_CONTEST_OUTLINE(BB_CONTEST_VIEWS),
    .note =
        "ms: medians of the rounds. answer: a slice, the mean of all. / first: the ratio to the "
        "first way, paired round by round (95 %). all: build, layout and answer. M/s: millions "
        "of voxels per second. nodes, tests: of nodes and tetrahedra per voxel. differ: voxels "
        "that differ from those of the first way. Marked: the best, and those tied with it.",
};

static void fill(void *self, bb_table *table, uint32_t row)
{
    const slicing *s = self;
    const bb_slice_plan *plan = &s->request.plan;
    const double all = (double)plan->width * plan->height * plan->count;
    const char across[2] = {"xyz"[plan->axis], '\0'};
    bb_mesh_fill(table, row, s->scene);
    bb_table_set_number(table, row, &slices, plan->count);
    bb_table_set_number(table, row, &width, plan->width);
    bb_table_set_number(table, row, &height, plan->height);
    bb_table_set_text(table, row, &axis, across);
    bb_table_set_number(table, row, &thickness, plan->thickness);
    bb_table_set_number(table, row, &voxels, all);
    bb_table_set_number(table, row, &filled, (double)s->filled);
    bb_table_set_number(table, row, &filled_part, 100 * (double)s->filled / all);
    bb_table_set_number(table, row, &extended, (double)s->extended);
    bb_table_set_number(table, row, &extended_part, 100 * (double)s->extended / all);
}

static void fill_pictures(const bb_slice_request *request, bb_table *table)
{
    for (uint32_t n = 0; request->contest.pictures != NULL && n < request->plan.count; n++) {
        char question[32], path[300];
        snprintf(question, sizeof question, "slice %u", n);
        snprintf(path, sizeof path, "%.255s-%03u.png", request->contest.files, n);
        const uint32_t row = bb_contest_scene_row(table, request->contest.name, question);
        bb_table_set_text(table, row, &bb_column_picture, path);
    }
}

/* ---- all of it ---- */

bb_status bb_slice_run(const bb_slice_request *request, bb_scene *scene, bb_table *table)
{
    slicing s = {.request = *request, .scene = scene, .kernels = bb_slice_kernels};
    BB_TRY(bb_slice_plan_check(scene, &s.request.plan));
    s.task = (bb_contest_task){.self = &s,
                               .scenes = &s.scene,
                               .scene_count = 1,
                               .answer_bytes = sizeof(bb_sliced),
                               .most_items = request->plan.width * request->plan.height,
                               .questions = request->plan.count,
                               .take = take,
                               .ask = ask,
                               .code = code_of,
                               .see = see,
                               .fill = fill};
    bb_status status = bb_contest_run(&request->contest, &s.task, table);
    bb_tet_kernels_release(&s.kernels);
    if (status == BB_OK)
        fill_pictures(request, table);
    return status;
}
