#include "framework/overlap/overlap_contest.h"

#include "framework/base/memory.h"
#include "framework/contest/contest_table.h"
#include "framework/contest/tet_runner.h"

#include <stdio.h>
#include <string.h>

enum { DIRECTIONS = 2 };

typedef struct overlapping {
    const bb_overlap_request *request;
    bb_scene *const *scenes;
    bb_overlap_result *result;
    bb_overlapper *overlapper;
    uint32_t asking; /* the scene that asks the other, now */
    bb_buffer lists[2], answers, counts;
} overlapping;

static uint32_t tets_of(const bb_scene *scene)
{
    return scene->prims[BB_TETRAHEDRON].count;
}

/* ---- directions as questions ---- */

static bb_status take(void *self, uint32_t direction, uint32_t *items)
{
    overlapping *o = self;
    o->asking = direction;
    *items = tets_of(o->scenes[direction]);
    return BB_OK;
}

static bb_status make(void *self, const char *search, bb_tree *const *trees,
                      bb_contest_runner *runner)
{
    const overlapping *o = self;
    return bb_tet_runner_make(o->scenes, 2, search, trees, runner);
}

static bb_status ask(void *self, const bb_contest_runner *runner, bool counting)
{
    overlapping *o = self;
    const uint32_t other = 1 - o->asking;
    bb_tet_search search;
    BB_TRY(bb_tet_runner_search(runner, o->scenes[other], other, &o->lists[other], &search));
    return bb_overlap(o->overlapper, o->scenes[o->asking], &search,
                      runner != NULL && runner->by_boundary, &o->answers,
                      counting ? &o->counts : NULL);
}

static bb_status see(void *self, uint32_t direction, const void *first, uint32_t items)
{
    overlapping *o = self;
    bb_overlap_mesh *mesh = &o->result->meshes[direction];
    memcpy(mesh->answers, first, items * sizeof *mesh->answers);
    for (uint32_t i = 0; i < items; i++)
        mesh->meeting += mesh->answers[i] != 0;
    return BB_OK;
}

/* ---- all of it ---- */

static bb_status prepare(overlapping *o)
{
    const bb_overlap_request *request = o->request;
    uint32_t most = 0;
    for (int s = 0; s < 2; s++) {
        bb_overlap_mesh *mesh = &o->result->meshes[s];
        const bb_scene *scene = o->scenes[s];
        if (scene->tets == NULL)
            return bb_fail(BB_INVALID, "%s: has no tetrahedra that could overlap", scene->name);
        snprintf(mesh->scene, sizeof mesh->scene, "%s", scene->name);
        mesh->tets = tets_of(scene);
        mesh->boundary = scene->tets->boundary_count;
        mesh->flat = scene->tets->flat_count;
        most = mesh->tets > most ? mesh->tets : most;
        BB_TRY(bb_host_alloc(NULL, mesh->tets * sizeof *mesh->answers, "answers", &mesh->answers));
        if (request->without)
            BB_TRY(bb_tet_list_make(scene, &o->lists[s]));
    }
    snprintf(o->result->scene, sizeof o->result->scene, "%s and %s", o->scenes[0]->name,
             o->scenes[1]->name);
    BB_TRY(bb_overlapper_create(request->device, &o->overlapper));
    for (int s = 0; s < 2; s++)
        BB_TRY(bb_overlap_check(o->overlapper, o->scenes[s], o->scenes[1 - s]));
    BB_TRY(
        bb_buffer_reserve(request->device, NULL, most * sizeof(uint32_t), "answers", &o->answers));
    return bb_buffer_reserve(request->device, NULL, most * sizeof(bb_count), "counts", &o->counts);
}

static bb_status measure(overlapping *o)
{
    const bb_overlap_request *request = o->request;
    const uint32_t tets[2] = {o->result->meshes[0].tets, o->result->meshes[1].tets};
    const bb_contest_request entry = {
        .device = request->device,
        .scenes = o->scenes,
        .scene_count = 2,
        .builders = request->builders,
        .builder_count = request->builder_count,
        .searches = request->searches,
        .search_count = request->search_count,
        .most_items = tets[0] > tets[1] ? tets[0] : tets[1],
        .repeats = request->repeats,
        .seed = request->seed,
        .quiet = request->quiet,
    };
    const bb_contest_task task = {
        .self = o,
        .without = request->without,
        .summed = true,
        .answer_bytes = sizeof(uint32_t),
        .questions = DIRECTIONS,
        .answers = &o->answers,
        .counts = &o->counts,
        .take = take,
        .make = make,
        .ask = ask,
        .see = see,
    };
    bb_contest *contest;
    BB_TRY(bb_contest_create(&entry, &task, o->result->ways, &o->result->way_count, &contest));
    bb_status status = bb_contest_run(contest);
    bb_contest_destroy(contest);
    return status;
}

bb_status bb_overlap_run(const bb_overlap_request *request, bb_scene *const scenes[2],
                         bb_overlap_result *result)
{
    memset(result, 0, sizeof *result);
    overlapping o = {.request = request, .scenes = scenes, .result = result};
    bb_status status = prepare(&o);
    if (status == BB_OK)
        status = measure(&o);
    bb_overlapper_destroy(o.overlapper);
    for (int s = 0; s < 2; s++)
        bb_buffer_release(&o.lists[s]);
    bb_buffer_release(&o.answers);
    bb_buffer_release(&o.counts);
    return status;
}

void bb_overlap_release(bb_overlap_result *result)
{
    for (int s = 0; s < 2; s++) {
        bb_host_free(result->meshes[s].answers);
        result->meshes[s].answers = NULL;
    }
}

/* ---- as rows of a table ---- */

#define NUMBER BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_NEITHER

static const bb_column flat = {
    "flat_tetrahedra", "without a volume", "", "Tetrahedra of the mesh.", NUMBER, 0};
static const bb_column meeting = {
    "meeting", "meet the other mesh", "", "Tetrahedra of the mesh.", NUMBER, 0};

const bb_page_outline bb_overlap_outline = {
    .command = "overlap",
    .title = "bvhbench: overlaps of meshes",
    .views = bb_contest_views,
    .view_count = BB_CONTEST_VIEWS,
    .note = "ms: medians of the rounds, of both trees and both directions. answer: which "
            "tetrahedra meet the other mesh. / first: the ratio to the first way, paired round by "
            "round (95 %). all: build, layout and answer. nodes, tests: of nodes and of pairs per "
            "tetrahedron. differ: tetrahedra whose answers differ from those of the first way. "
            "Marked: the best, and those tied with it.",
    .wrong = "differ",
    .well = "All answers are the same to the last bit.",
    .ill = "answers differ from those of the first way.",
};

static void fill_pictures(const bb_overlap_result *r, bb_table *table)
{
    for (uint32_t v = 0; v < r->picture_count; v++) {
        const bb_cell cell = {{[BB_SCENE] = r->scene, [BB_QUESTION] = r->pictures[v]}};
        bb_table_set_text(table, bb_table_row(table, cell), &bb_column_picture, r->pictures[v]);
    }
}

void bb_overlap_fill(const bb_overlap_result *r, bb_table *table)
{
    const double tets = (double)r->meshes[0].tets + r->meshes[1].tets;
    for (int s = 0; s < 2; s++) {
        const bb_overlap_mesh *mesh = &r->meshes[s];
        char name[sizeof mesh->scene + 4];
        snprintf(name, sizeof name, "%c: %s", "AB"[s], mesh -> scene);
        const bb_cell cell = {{[BB_SCENE] = r->scene, [BB_QUESTION] = name}};
        const uint32_t row = bb_table_row(table, cell);
        bb_table_set_number(table, row, &bb_column_tetrahedra, mesh->tets);
        bb_table_set_number(table, row, &bb_column_boundary, mesh->boundary);
        bb_table_set_number(table, row, &flat, mesh->flat);
        bb_table_set_number(table, row, &meeting, mesh->meeting);
    }
    bb_contest_fill(table, r->scene, r->ways, r->way_count, tets, tets);
    fill_pictures(r, table);
}
