#include "framework/slice/slice_contest.h"

#include "framework/base/memory.h"
#include "framework/contest/tet_runner.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"
#include "framework/record/put.h"

#include <math.h>
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
    BB_TRY(bb_contest_add_file(s->request->picture_files, path));
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

/* ---- as text, as JSON ---- */

static void print_way(const bb_slice_result *r, const bb_contest_way *way)
{
    const double per_slice = (double)r->voxels / r->plan.count;
    if (!bb_contest_print_name(way))
        return;
    const double ms = bb_samples_median(&way->answer);
    printf(" %9.2f", ms);
    if (way == bb_contest_base(r->ways, r->way_count)) {
        printf(" %24s", "");
    } else {
        bb_estimate ratio = bb_contest_ratio(bb_contest_base(r->ways, r->way_count), way, false);
        printf(" %7.3f", ratio.value);
        bb_contest_print_interval(ratio);
    }
    printf(" %9.3f %8.1f %8.1f %llu\n", per_slice / ms / 1e3, way->visits, way->work,
           (unsigned long long)way->differ);
}

void bb_slice_print(const bb_slice_result *r)
{
    printf("%s\n %u tetrahedra, %u on the boundary, field '%s'\n", r->scene, r->tets, r->boundary,
           r->field);
    printf(" %u slices of %u x %u voxels across %c, %g thick; %llu voxels in all: %.1f %% with "
           "material, %.1f %% by a tetrahedron beside the centre\n\n",
           r->plan.count, r->plan.width, r->plan.height, "xyz"[r->plan.axis], r -> plan.thickness,
           (unsigned long long)r->voxels, 100.0 * (double)r->filled / (double)r->voxels,
           100.0 * (double)r->extended / (double)r->voxels);
    printf(" %-38s%8s %8s %9s %7s %-16s %9s %8s %8s %s\n", "", "build", "layout", "slice", "slice",
           "/first", "M/s", "nodes", "tests", "differ");
    for (uint32_t w = 0; w < r->way_count; w++)
        print_way(r, &r->ways[w]);
    printf(" ms, medians of %u rounds; of slices the mean, and the ratio to that of the first way, "
           "paired round by round (95 %%);\n M/s: millions of voxels per second; nodes and tests "
           "of tetrahedra: per voxel; differ: voxels, from the first way\n\n",
           bb_contest_rounds(r->ways, r->way_count));
    bb_contest_print_trees(r->ways, r->way_count, r->tets);
    bb_contest_print_phases(r->ways, r->way_count);
    printf("\n");
}

static bool put_way(cJSON *list, const bb_slice_result *r, const bb_contest_way *way)
{
    cJSON *entry;
    bool put =
        bb_contest_put_way(list, bb_contest_base(r->ways, r->way_count), way, "slice", &entry);
    if (entry == NULL || !put)
        return put;
    return bb_put_number(entry, "nodes_per_voxel", way->visits) &&
           bb_put_number(entry, "tests_per_voxel", way->work) &&
           bb_put_number(entry, "voxels_that_differ", (double)way->differ);
}

static bool put_result(cJSON *root, const bb_slice_result *r)
{
    const double size[2] = {r->plan.width, r->plan.height};
    const char axis[2] = {"xyz"[r->plan.axis], '\0'};
    cJSON *ways = cJSON_CreateArray();
    bool put = bb_put_text(root, "scene", r->scene) && bb_put_text(root, "field", r->field) &&
               bb_put_number(root, "tetrahedra", r->tets) &&
               bb_put_number(root, "boundary_tetrahedra", r->boundary) &&
               bb_put_text(root, "axis", axis) && bb_put_numbers(root, "size", size, 2) &&
               bb_put_number(root, "slices", r->plan.count) &&
               bb_put_number(root, "thickness", r->plan.thickness) &&
               bb_put_number(root, "voxels", (double)r->voxels) &&
               bb_put_number(root, "voxels_filled", (double)r->filled) &&
               bb_put_number(root, "voxels_extended", (double)r->extended);
    put = bb_put(root, "ways", ways) && put;
    for (uint32_t w = 0; w < r->way_count && put; w++)
        put = put_way(ways, r, &r->ways[w]);
    return put;
}

cJSON *bb_slice_json(const bb_slice_result *result)
{
    cJSON *root = cJSON_CreateObject();
    if (root != NULL && put_result(root, result))
        return root;
    cJSON_Delete(root);
    return NULL;
}
