#include "framework/tasks/overlap_contest.h"

#include "framework/base/memory.h"
#include "framework/tasks/mesh_row.h"
#include "framework/tasks/overlap_paint.h"

#include <stdio.h>
#include <string.h>

typedef struct overlapping {
    const char *name; /* of both, in the table */
    bb_scene *const *scenes;
    bb_contest_task task;
    bb_overlapper overlapper;
    uint32_t asking;      /* the scene that asks the other, now */
    uint32_t *answers[2]; /* per tetrahedron 1 or 0 */
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

static bb_status ask(void *self, const bb_contest_runner *runner, bb_contest_answers answers)
{
    overlapping *o = self;
    bb_tet_search search;
    BB_TRY(bb_contest_search(runner, &o->task, 1 - o->asking, &search));
    search.recording = answers.recording;
    return bb_overlap(&o->overlapper, o->scenes[o->asking], &search, runner->by_boundary,
                      answers.items, answers.counts);
}

/* A tetrahedron that asks is read by its corners' numbers. */
static bb_status code_of(void *self, const bb_contest_runner *runner, bb_simulated_code *code)
{
    overlapping *o = self;
    bb_tet_search search;
    BB_TRY(bb_contest_search(runner, &o->task, 1 - o->asking, &search));
    BB_TRY(bb_tet_search_code(&search, "overlap_tets", runner->by_boundary, code));
    code->footing.item_bytes = 4 * sizeof(uint32_t);
    code->footing.result_bytes = sizeof(uint32_t);
    return BB_OK;
}

static bb_status see(void *self, uint32_t direction, const void *first, uint32_t items)
{
    const overlapping *o = self;
    memcpy(o->answers[direction], first, items * sizeof *o->answers[0]);
    return BB_OK;
}

/* ---- as rows of a table ---- */

BB_EXACT(meeting, "meeting", "meet the other mesh", "", "Tetrahedra of the mesh.", NEITHER, 0);

#define OUTLINE .command = "overlap", .title = "bvhbench: overlaps of meshes"

const bb_page_outline bb_overlap_outline_briefly = {
    OUTLINE,
    BB_CONTEST_OUTLINE(BB_CONTEST_VIEWS_BRIEF),
};

const bb_page_outline bb_overlap_outline = {
    OUTLINE,
    BB_CONTEST_OUTLINE(BB_CONTEST_VIEWS),
    .note = "ms: medians of the rounds, of both trees and both directions. answer: which "
            "tetrahedra meet the other mesh. / first: the ratio to the first way, paired round by "
            "round (95 %). all: build, layout and answer. nodes, tests: of nodes and of pairs per "
            "tetrahedron. differ: tetrahedra whose answers differ from those of the first way. "
            "Marked: the best, and those tied with it.",
};

static void fill(void *self, bb_table *table, uint32_t both)
{
    const overlapping *o = self;
    (void)both;
    for (int s = 0; s < 2; s++) {
        const bb_scene *scene = o->scenes[s];
        uint32_t met = 0;
        char question[sizeof scene->name + 4];
        snprintf(question, sizeof question, "%c: %s", "AB"[s], scene -> name);
        const uint32_t row = bb_contest_scene_row(table, o->name, question);
        for (uint32_t i = 0; i < tets_of(scene); i++)
            met += o->answers[s][i] != 0;
        bb_mesh_fill(table, row, scene);
        bb_table_set_number(table, row, &meeting, met);
    }
}

/* ---- all of it ---- */

static bb_status prepare(overlapping *o)
{
    for (int s = 0; s < 2; s++) {
        const bb_scene *scene = o->scenes[s];
        if (scene->tets == NULL)
            return bb_fail(BB_INVALID, "%s: has no tetrahedra that could overlap", scene->name);
        const uint32_t count = tets_of(scene);
        BB_TRY(bb_host_alloc(NULL, count * sizeof *o->answers[s], "answers", &o->answers[s]));
        o->task.most_items = count > o->task.most_items ? count : o->task.most_items;
    }
    for (int s = 0; s < 2; s++)
        BB_TRY(bb_overlap_check(&o->overlapper, o->scenes[s], o->scenes[1 - s]));
    return BB_OK;
}

bb_status bb_overlap_run(const bb_contest_request *request, bb_scene *const scenes[2],
                         const char *folder, bb_table *table)
{
    overlapping o = {.name = request->name, .scenes = scenes, .overlapper = bb_overlapper_init};
    o.task = (bb_contest_task){.self = &o,
                               .scenes = scenes,
                               .scene_count = 2,
                               .summed = true,
                               .answer_bytes = sizeof(uint32_t),
                               .questions = 2,
                               .take = take,
                               .ask = ask,
                               .code = code_of,
                               .see = see,
                               .fill = fill};
    bb_status status = prepare(&o);
    if (status == BB_OK)
        status = bb_contest_run(request, &o.task, table);
    if (status == BB_OK && folder != NULL)
        status = bb_overlap_paint(scenes, o.answers, folder, request->name, table);
    bb_overlapper_release(&o.overlapper);
    for (int s = 0; s < 2; s++)
        bb_host_free(o.answers[s]);
    return status;
}
