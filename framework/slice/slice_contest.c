#include "framework/slice/slice_contest.h"

#include "framework/base/memory.h"
#include "framework/contest/contest_table.h"
#include "framework/contest/tet_runner.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct slicing {
    const bb_slice_request *request;
    bb_scene *scene;
    bb_slice_result *result;
    bb_slicer *slicer;
    bb_slice_args slice; /* the present one */
    bb_buffer list, voxels, counts;
} slicing;

/* ---- slices as answers ---- */

static uint32_t voxels_of(const bb_slice_plan *plan)
{
    return plan->width * plan->height;
}

static bb_status take(void *self, uint32_t number, uint32_t *items)
{
    slicing *s = self;
    s->slice = bb_slice_at(s->scene, &s->result->plan, number);
    *items = voxels_of(&s->result->plan);
    return BB_OK;
}

static bb_status make(void *self, const char *search, bb_tree *const *trees,
                      bb_contest_runner *runner)
{
    slicing *s = self;
    return bb_tet_runner_make(&s->scene, 1, search, trees, runner);
}

static bb_status ask(void *self, const bb_contest_runner *runner, bool counting)
{
    slicing *s = self;
    bb_tet_search search;
    BB_TRY(bb_tet_runner_search(runner, s->scene, 0, &s->list, &search));
    return bb_slice(s->slicer, &search, runner != NULL && runner->by_boundary, &s->slice,
                    &s->voxels, counting ? &s->counts : NULL);
}

/* ---- pictures ---- */

/* From the top, and from black, where there is no material, over the map of colours. */
static void paint(const slicing *s, const bb_sliced *voxels, float *rgb, float *numbers)
{
    const bb_slice_plan *plan = &s->result->plan;
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
    const bb_slice_plan *plan = &s->result->plan;
    char path[4096];
    paint(s, voxels, rgb, numbers);
    snprintf(path, sizeof path, "%s-%03u.png", s->request->pictures, number);
    BB_TRY(bb_image_write(path, rgb, plan->width, plan->height));
    snprintf(path, sizeof path, "%s-%03u.exr", s->request->pictures, number);
    return s->request->exr ? bb_exr_write(path, numbers, "YA", plan->width, plan->height) : BB_OK;
}

/* Counts what is filled, and writes the picture. */
static bb_status see(void *self, uint32_t number, const void *first, uint32_t items)
{
    slicing *s = self;
    const bb_sliced *voxels = first;
    float *rgb = NULL, *numbers = NULL;
    for (uint32_t i = 0; i < items; i++) {
        s->result->filled += voxels[i].prim != BB_NONE;
        s->result->extended += voxels[i].prim != BB_NONE && voxels[i].inside == 0;
    }
    if (s->request->pictures == NULL)
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

/* ---- all of it ---- */

static bb_status prepare(slicing *s)
{
    const bb_slice_request *request = s->request;
    bb_slice_result *result = s->result;
    result->plan = request->plan;
    BB_TRY(bb_slicer_create(s->scene, &s->slicer));
    BB_TRY(bb_slice_plan_check(s->scene, &result->plan));
    snprintf(result->scene, sizeof result->scene, "%s", s->scene->name);
    snprintf(result->field, sizeof result->field, "%s", s->scene->tets->field_name);
    result->tets = s->scene->prims[BB_TETRAHEDRON].count;
    result->boundary = s->scene->tets->boundary_count;
    const uint32_t voxels = voxels_of(&result->plan);
    result->voxels = (uint64_t)voxels * result->plan.count;
    if (request->without)
        BB_TRY(bb_tet_list_make(s->scene, &s->list));
    BB_TRY(bb_buffer_reserve(request->device, NULL, voxels * sizeof(bb_sliced), "voxels of a slice",
                             &s->voxels));
    return bb_buffer_reserve(request->device, NULL, voxels * sizeof(bb_count), "counts",
                             &s->counts);
}

static bb_status measure(slicing *s)
{
    const bb_slice_request *request = s->request;
    const bb_contest_request entry = {
        .device = request->device,
        .scenes = &s->scene,
        .scene_count = 1,
        .builders = request->builders,
        .builder_count = request->builder_count,
        .searches = request->searches,
        .search_count = request->search_count,
        .most_items = voxels_of(&s->result->plan),
        .repeats = request->repeats,
        .seed = request->seed,
        .quiet = request->quiet,
    };
    const bb_contest_task task = {
        .self = s,
        .without = request->without,
        .answer_bytes = sizeof(bb_sliced),
        .questions = s->result->plan.count,
        .answers = &s->voxels,
        .counts = &s->counts,
        .take = take,
        .make = make,
        .ask = ask,
        .see = see,
    };
    bb_contest *contest;
    BB_TRY(bb_contest_create(&entry, &task, s->result->ways, &s->result->way_count, &contest));
    bb_status status = bb_contest_run(contest);
    bb_contest_destroy(contest);
    return status;
}

bb_status bb_slice_run(const bb_slice_request *request, bb_scene *scene, bb_slice_result *result)
{
    memset(result, 0, sizeof *result);
    slicing s = {.request = request, .scene = scene, .result = result};
    bb_status status = prepare(&s);
    if (status == BB_OK)
        status = measure(&s);
    bb_slicer_destroy(s.slicer);
    bb_buffer_release(&s.list);
    bb_buffer_release(&s.voxels);
    bb_buffer_release(&s.counts);
    return status;
}

/* ---- as rows of a table ---- */

#define NUMBER BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_NEITHER

static const bb_column axis = {
    "axis",         "across",          "", "Across which axis slices lie.", BB_COLUMN_TEXT,
    BB_SENSE_EXACT, BB_BETTER_NEITHER, 0};
static const bb_column width = {"width", "width", "", "Of a slice, in voxels.", NUMBER, 0};
static const bb_column height = {"height", "height", "", "Of a slice, in voxels.", NUMBER, 0};
static const bb_column slices = {"slices", "slices", "", "How many.", NUMBER, 0};
static const bb_column thickness = {"thickness", "thickness", "", "Of a slice, in scene units.",
                                    NUMBER,      -1};
static const bb_column voxels = {"voxels", "voxels", "", "Of all slices.", NUMBER, 0};
static const bb_column filled = {
    "voxels_filled", "voxels with material", "", "Of all slices.", NUMBER, 0};
static const bb_column filled_part = {"filled_percent", "with material", "%",
                                      "Of all voxels.", NUMBER,          1};
static const bb_column extended = {"voxels_extended",
                                   "voxels by a tetrahedron beside the centre",
                                   "",
                                   "Of all slices.",
                                   NUMBER,
                                   0};
static const bb_column extended_part = {
    "extended_percent", "by a tetrahedron beside the centre", "%", "Of all voxels.", NUMBER, 1};

const bb_page_outline bb_slice_outline = {
    .command = "slice",
    .title = "bvhbench: slices of meshes",
    .views = bb_contest_views,
    .view_count = BB_CONTEST_VIEWS,
    .note =
        "ms: medians of the rounds. answer: a slice, the mean of all. / first: the ratio to the "
        "first way, paired round by round (95 %). all: build, layout and answer. M/s: millions "
        "of voxels per second. nodes, tests: of nodes and tetrahedra per voxel. differ: voxels "
        "that differ from those of the first way. Marked: the best, and those tied with it.",
    .wrong = "differ",
    .well = "All answers are the same to the last bit.",
    .ill = "answers differ from those of the first way.",
};

static void fill_pictures(const bb_slice_result *r, const char *pictures, bb_table *table)
{
    for (uint32_t n = 0; pictures != NULL && n < r->plan.count; n++) {
        char question[32], path[300];
        snprintf(question, sizeof question, "slice %u", n);
        snprintf(path, sizeof path, "%.255s-%03u.png", pictures, n);
        const bb_cell cell = {{[BB_SCENE] = r->scene, [BB_QUESTION] = question}};
        bb_table_set_text(table, bb_table_row(table, cell), &bb_column_picture, path);
    }
}

void bb_slice_fill(const bb_slice_result *r, const char *pictures, bb_table *table)
{
    const uint32_t row = bb_table_row(table, (bb_cell){{[BB_SCENE] = r->scene}});
    const double all = (double)r->voxels;
    const char across[2] = {"xyz"[r->plan.axis], '\0'};
    bb_table_set_number(table, row, &bb_column_tetrahedra, r->tets);
    bb_table_set_number(table, row, &bb_column_boundary, r->boundary);
    bb_table_set_text(table, row, &bb_column_field, r->field);
    bb_table_set_number(table, row, &slices, r->plan.count);
    bb_table_set_number(table, row, &width, r->plan.width);
    bb_table_set_number(table, row, &height, r->plan.height);
    bb_table_set_text(table, row, &axis, across);
    bb_table_set_number(table, row, &thickness, r->plan.thickness);
    bb_table_set_number(table, row, &voxels, all);
    bb_table_set_number(table, row, &filled, (double)r->filled);
    bb_table_set_number(table, row, &filled_part, 100 * (double)r->filled / all);
    bb_table_set_number(table, row, &extended, (double)r->extended);
    bb_table_set_number(table, row, &extended_part, 100 * (double)r->extended / all);
    bb_contest_fill(table, r->scene, r->ways, r->way_count, all / r->plan.count, r->tets);
    fill_pictures(r, pictures, table);
}
