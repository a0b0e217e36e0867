#include "framework/overlap/overlap_contest.h"

#include "framework/base/memory.h"
#include "framework/contest/tet_runner.h"
#include "framework/record/put.h"

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

/* ---- as text, as JSON ---- */

static void print_way(const bb_overlap_result *r, const bb_contest_way *way)
{
    if (!bb_contest_print_name(way))
        return;
    printf(" %9.2f", bb_samples_median(&way->answer));
    if (way == bb_contest_base(r->ways, r->way_count)) {
        printf(" %24s", "");
    } else {
        bb_estimate ratio = bb_contest_ratio(bb_contest_base(r->ways, r->way_count), way, false);
        printf(" %7.3f", ratio.value);
        bb_contest_print_interval(ratio);
    }
    printf(" %8.1f %8.2f %llu\n", way->visits, way->work, (unsigned long long)way->differ);
}

void bb_overlap_print(const bb_overlap_result *r)
{
    const uint64_t tets = (uint64_t)r->meshes[0].tets + r->meshes[1].tets;
    for (int s = 0; s < 2; s++) {
        const bb_overlap_mesh *mesh = &r->meshes[s];
        printf("%s\n %u tetrahedra, %u on the boundary, %u without a volume; %u meet the other "
               "mesh\n",
               mesh->scene, mesh->tets, mesh->boundary, mesh->flat, mesh->meeting);
    }
    printf("\n %-38s%8s %8s %9s %7s %-16s %8s %8s %s\n", "", "build", "layout", "overlap",
           "overlap", "/first", "nodes", "tests", "differ");
    for (uint32_t w = 0; w < r->way_count; w++)
        print_way(r, &r->ways[w]);
    printf(" ms, medians of %u rounds, of both trees and both directions; overlap /first: paired "
           "round by round (95 %%);\n nodes and tests of pairs: per tetrahedron; differ: "
           "tetrahedra, from the first way\n\n",
           bb_contest_rounds(r->ways, r->way_count));
    bb_contest_print_trees(r->ways, r->way_count, tets);
    bb_contest_print_phases(r->ways, r->way_count);
    printf("\n");
}

static bool put_way(cJSON *list, const bb_overlap_result *r, const bb_contest_way *way)
{
    cJSON *entry;
    bool put =
        bb_contest_put_way(list, bb_contest_base(r->ways, r->way_count), way, "overlap", &entry);
    if (entry == NULL || !put)
        return put;
    return bb_put_number(entry, "nodes_per_tetrahedron", way->visits) &&
           bb_put_number(entry, "tests_per_tetrahedron", way->work) &&
           bb_put_number(entry, "tetrahedra_that_differ", (double)way->differ);
}

static bool put_mesh(cJSON *list, const bb_overlap_mesh *mesh)
{
    cJSON *entry = cJSON_CreateObject();
    if (entry == NULL || !cJSON_AddItemToArray(list, entry)) {
        cJSON_Delete(entry);
        return false;
    }
    return bb_put_text(entry, "scene", mesh->scene) &&
           bb_put_number(entry, "tetrahedra", mesh->tets) &&
           bb_put_number(entry, "boundary_tetrahedra", mesh->boundary) &&
           bb_put_number(entry, "flat_tetrahedra", mesh->flat) &&
           bb_put_number(entry, "meeting", mesh->meeting);
}

static bool put_result(cJSON *root, const bb_overlap_result *r)
{
    cJSON *meshes = cJSON_CreateArray();
    bool put = bb_put(root, "meshes", meshes);
    for (int s = 0; s < 2 && put; s++)
        put = put_mesh(meshes, &r->meshes[s]);
    cJSON *ways = cJSON_CreateArray();
    put = bb_put(root, "ways", ways) && put;
    for (uint32_t w = 0; w < r->way_count && put; w++)
        put = put_way(ways, r, &r->ways[w]);
    return put;
}

cJSON *bb_overlap_json(const bb_overlap_result *result)
{
    cJSON *root = cJSON_CreateObject();
    if (root != NULL && put_result(root, result))
        return root;
    cJSON_Delete(root);
    return NULL;
}
