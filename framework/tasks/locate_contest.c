#include "framework/tasks/locate_contest.h"

#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/builder/tracing.h"
#include "framework/device/device_private.h"
#include "framework/judge/queries.h"
#include "framework/scene/tets_faces.h"
#include "framework/tasks/mesh_row.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP_SIZE = 64 };

/* Embree with one of its queries. */
typedef struct embree_way {
    const char *query;
    bb_spec spec;
    bool missing;  /* the library lacks the query */
    bool compared; /* its answers were */
    bb_contest_way way;
} embree_way;

static const char *const embree_queries[] = {"single", "packet8", "packet16", "stream"};
enum { QUERIES = sizeof embree_queries / sizeof embree_queries[0] };

typedef struct location {
    const bb_location_request *request;
    bb_scene *scene, *faces;
    bb_face_sides *sides;
    float *points;
    bb_rays rays; /* from the points */
    bb_hit *hits; /* Embree's */
    bb_located *first;
    bb_contest_task task;
    bb_tet_kernels kernels;
    cl_program program;
    cl_kernel of_faces;
    bb_buffer d_points, d_sides, d_hits;
    bb_tracing *embree;
    embree_way ways[QUERIES];
} location;

/* ---- points ---- */

/* Evenly distributed in the tetrahedron: weights that are the gaps between three sorted numbers. */
static void make_point(const bb_scene *scene, uint32_t tet, bb_random *random, float *point)
{
    const uint32_t *corners = bb_scene_tet(scene, tet);
    double cuts[5] = {0, bb_random_unit(random), bb_random_unit(random), bb_random_unit(random), 1};
    for (int i = 1; i < 3; i++)
        for (int j = 1; j < 4 - i; j++)
            if (cuts[j] > cuts[j + 1]) {
                const double swap = cuts[j];
                cuts[j] = cuts[j + 1];
                cuts[j + 1] = swap;
            }
    for (size_t k = 0; k < 3; k++) {
        double sum = 0;
        for (int c = 0; c < 4; c++)
            sum += (cuts[c + 1] - cuts[c]) * (double)scene->vertices[3 * (size_t)corners[c] + k];
        point[k] = (float)sum;
    }
}

/* One in each of equal parts of the volume, in the order of the tetrahedra. */
static bb_status make_points(location *l)
{
    const uint32_t tets = l->scene->prims[BB_TETRAHEDRON].count, count = l->request->points;
    bb_random random = bb_random_make(l->request->contest.seed, 1);
    double all = 0, before = 0;
    uint32_t tet = 0;
    for (uint32_t i = 0; i < tets; i++)
        all += bb_mesh_volume_of(l->scene, i);
    if (!(all > 0 && isfinite(all)))
        return bb_fail(BB_UNSUPPORTED, "%s: its volume is %g: there are no points to locate",
                       l->scene->name, all);
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)count * sizeof *l->points, "points", &l->points));
    for (uint32_t i = 0; i < count; i++) {
        const double at = (i + bb_random_unit(&random)) / count * all;
        while (tet + 1 < tets && before + bb_mesh_volume_of(l->scene, tet) <= at)
            before += bb_mesh_volume_of(l->scene, tet++);
        make_point(l->scene, tet, &random, l->points + 3 * (size_t)i);
    }
    return BB_OK;
}

/* The longest edge of the mesh: no face that decides is farther. */
static float longest_edge(const bb_scene *scene)
{
    double longest = 0;
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++)
        for (int c = 0; c < 6; c++) {
            static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
            const uint32_t *corners = bb_scene_tet(scene, i);
            double square = 0;
            for (size_t k = 0; k < 3; k++) {
                const double side = (double)scene->vertices[3 * (size_t)corners[ends[c][0]] + k] -
                                    (double)scene->vertices[3 * (size_t)corners[ends[c][1]] + k];
                square += side * side;
            }
            longest = fmax(longest, square);
        }
    return (float)(sqrt(longest) * (1 + 0x1p-20));
}

static bb_status make_rays(location *l)
{
    const uint32_t count = l->request->points;
    const float most = longest_edge(l->scene);
    snprintf(l->rays.name, sizeof l->rays.name, "points");
    BB_TRY(bb_rays_reserve(&l->rays, count));
    for (uint32_t i = 0; i < count; i++) {
        l->rays.rays[i] = (bb_ray){.d = {1, 0, 0}, .tmin = 0, .tmax = most};
        memcpy(l->rays.rays[i].o, l->points + 3 * (size_t)i, sizeof l->rays.rays[i].o);
    }
    return bb_rays_check(l->faces, &l->rays);
}

/* ---- answers ---- */

static bb_status take(void *self, uint32_t question, uint32_t *items)
{
    const location *l = self;
    (void)question;
    *items = l->request->points;
    return BB_OK;
}

static bb_status compile(void *self, bb_contest_runner *runner)
{
    const location *l = self;
    for (int counting = 0; counting < 2; counting++) {
        const bb_traverser_request request = {.kernel = runner->kernel,
                                              .spec = runner->spec,
                                              .intersector = &bb_intersectors[0],
                                              .query = bb_query_find("closest"),
                                              .counting = counting != 0};
        BB_TRY(bb_traverser_get(l->request->contest.device, &request, runner->data[0],
                                &runner->traversers[counting]));
    }
    return BB_OK;
}

static bb_status ask_tets(location *l, const bb_contest_runner *runner, bb_contest_answers answers)
{
    const bb_scene_device *there = &l->scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(l->scene);
    bb_arg args[BB_TET_SEARCH_ARGS + 7];
    bb_tet_search search;
    cl_kernel kernel;
    BB_TRY(bb_contest_search(runner, &l->task, 0, &search));
    BB_TRY(bb_tet_kernels_get(&l->kernels, there->device, search.way, false,
                              bb_tet_counting_for(&search, answers.counts), &kernel));
    uint32_t n = bb_tet_search_args(&search, args);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_MEM(l->d_points);
    args[n++] = BB_VALUE(l->request->points);
    args[n++] = BB_MEM(*answers.items);
    if (answers.counts != NULL)
        args[n++] = BB_MEM(*answers.counts);
    return bb_launch_args(there->device, kernel, l->request->points, GROUP_SIZE, args, n);
}

/* From faces that were hit to tetrahedra. */
static bb_status take_sides(location *l, bb_buffer *located)
{
    const bb_scene_device *there = &l->scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(l->scene), face_ends = bb_scene_ends(l->faces);
    return bb_launch(
        there->device, l->of_faces, l->request->points, GROUP_SIZE, BB_MEM(there->prims),
        BB_VALUE(ends), BB_MEM(there->vertices), BB_MEM(there->field), BB_MEM(there->tet_flags),
        BB_VALUE(l->scene->prims[BB_TETRAHEDRON].first), BB_VALUE(l->scene->scale),
        BB_MEM(l->faces->on_device.prims), BB_VALUE(face_ends), BB_MEM(l->d_sides),
        BB_MEM(l->d_points), BB_MEM(l->d_hits), BB_VALUE(l->request->points), BB_MEM(*located));
}

static bb_status ask(void *self, const bb_contest_runner *runner, bb_contest_answers answers)
{
    location *l = self;
    const bb_pass pass = {.query = bb_query_find("closest"),
                          .traverser = runner->traversers[answers.counts != NULL],
                          .layout = runner->data[0],
                          .rays = &l->rays.on_device,
                          .results = &l->d_hits,
                          .counts = answers.counts};
    if (pass.traverser == NULL)
        return ask_tets(l, runner, answers);
    if (answers.counts != NULL) /* it is not timed */
        BB_TRY(bb_pass_poison(&pass, l->request->points));
    BB_TRY(bb_pass_launch(&pass, l->request->points));
    return take_sides(l, answers.items);
}

/* Keeps the first way's answers. */
static bb_status see(void *self, uint32_t question, const void *first, uint32_t items)
{
    location *l = self;
    (void)question;
    memcpy(l->first, first, items * sizeof *l->first);
    return BB_OK;
}

/* ---- Embree ---- */

static bb_status build_embree(location *l, double *ms)
{
    bb_build_timing timing;
    bb_phases phases;
    BB_TRY(bb_tracing_build(l->embree, &timing, &phases));
    *ms = timing.timing.ms;
    return BB_OK;
}

static bb_status start_embree(location *l)
{
    const bb_guarded whose = {l->faces->name, BB_REFERENCE_NAME};
    double ms;
    BB_TRY(bb_tracing_create(l->request->contest.device, BB_REFERENCE_NAME, l->faces, &l->embree));
    BB_TRY(build_embree(l, &ms));
    for (int i = 0; i < QUERIES; i++) {
        embree_way *e = &l->ways[i];
        char text[64];
        e->query = embree_queries[i];
        snprintf(text, sizeof text, BB_REFERENCE_NAME ":query=%s", e->query);
        BB_TRY(bb_spec_parse(text, &e->spec));
        const bb_status status = bb_tracing_pass(l->embree, whose, &e->spec);
        if (status != BB_OK && status != BB_UNSUPPORTED)
            return status;
        e->missing = status != BB_OK;
        e->way.builder = "faces/" BB_REFERENCE_NAME;
        e->way.search = e->query;
        e->way.visits = e->way.work = e->way.restarts = NAN; /* Embree does not say */
    }
    return BB_OK;
}

static bb_status trace_embree(location *l, embree_way *e, bb_timing *timing)
{
    const bb_guarded whose = {l->faces->name, BB_REFERENCE_NAME};
    return bb_tracing_trace(l->embree, whose, &e->spec, l->rays.rays, l->rays.count, false, l->hits,
                            timing);
}

/* In each round: its build, and each of its queries. */
static bb_status time_embree(void *self)
{
    location *l = self;
    double build_ms;
    BB_TRY(build_embree(l, &build_ms));
    for (int i = 0; i < QUERIES; i++) {
        embree_way *e = &l->ways[i];
        bb_timing timing;
        if (e->missing)
            continue;
        BB_TRY(trace_embree(l, e, &timing));
        bb_samples_add(&e->way.build, build_ms);
        bb_samples_add(&e->way.answer, timing.ms);
        bb_samples_add(&e->way.answer_cpu, timing.cpu_ms);
    }
    return BB_OK;
}

/* Compares the answers of its last queries with the first way's. */
static bb_status end_embree(void *self, const bb_contest_runner *first, bb_contest_answers answers)
{
    location *l = self;
    const size_t hit_bytes = l->rays.count * sizeof *l->hits;
    bb_located *located = NULL;
    bb_status status = bb_host_alloc(NULL, l->rays.count * sizeof *located, "answers", &located);
    (void)first;
    for (int i = 0; i < QUERIES && status == BB_OK; i++) {
        embree_way *e = &l->ways[i];
        bb_timing timing;
        if (e->missing)
            continue;
        status = trace_embree(l, e, &timing);
        if (status == BB_OK)
            status = bb_buffer_write(&l->d_hits, 0, hit_bytes, l->hits);
        if (status == BB_OK)
            status = take_sides(l, answers.items);
        if (status == BB_OK)
            status = bb_buffer_read(answers.items, 0, l->rays.count * sizeof *located, located);
        for (uint32_t k = 0; k < l->rays.count && status == BB_OK; k++)
            e->way.differ += memcmp(&located[k], &l->first[k], sizeof *located) != 0;
        e->compared = status == BB_OK;
    }
    bb_host_free(located);
    return status;
}

/* ---- all of it ---- */

BB_EXACT(points, "points", "points", "", "That are located.", NEITHER, 0);
BB_EXACT(faces, "faces", "faces", "", "Of the mesh, each once.", NEITHER, 0);

static void fill(void *self, bb_table *table, uint32_t row)
{
    const location *l = self;
    bb_mesh_fill(table, row, l->scene);
    bb_table_set_number(table, row, &points, l->request->points);
    bb_table_set_number(table, row, &faces, l->faces->prim_count);
    for (int i = 0; i < QUERIES; i++)
        if (!l->ways[i].missing && l->ways[i].compared) /* else it was interrupted before */
            bb_contest_fill(table, l->request->contest.name, &l->ways[i].way, 1, l->request->points,
                            0);
}

static bb_status prepare(location *l)
{
    bb_device *device = l->request->contest.device;
    const size_t count = l->request->points;
    char defines[64];
    BB_TRY(bb_tets_faces(l->scene, &l->faces, &l->sides));
    BB_TRY(bb_scene_upload(l->faces, device));
    BB_TRY(make_points(l));
    BB_TRY(make_rays(l));
    BB_TRY(bb_rays_upload(&l->rays, device));
    BB_TRY(bb_host_alloc(NULL, count * sizeof *l->hits, "hits", &l->hits));
    BB_TRY(bb_host_alloc(NULL, count * sizeof *l->first, "answers", &l->first));
    l->task.face_bytes = l->faces->prim_count * sizeof *l->sides;
    BB_TRY(bb_buffer_reserve(device, NULL, l->task.face_bytes, "sides of faces", &l->d_sides));
    BB_TRY(bb_buffer_write(&l->d_sides, 0, l->task.face_bytes, l->sides));
    BB_TRY(bb_buffer_reserve(device, NULL, 3 * count * sizeof(float), "points", &l->d_points));
    BB_TRY(bb_buffer_write(&l->d_points, 0, 3 * count * sizeof(float), l->points));
    BB_TRY(bb_buffer_reserve(device, NULL, count * sizeof(bb_hit), "hits", &l->d_hits));
    snprintf(defines, sizeof defines, "-DBB_HAS_DOUBLES=%d", bb_device_has_doubles(device));
    BB_TRY(bb_program_build(device, bb_source_find("locate_faces.cl"), defines, &l->program));
    BB_TRY(bb_kernel_get(l->program, "locate_faces", &l->of_faces));
    return start_embree(l);
}

bb_status bb_location_run(const bb_location_request *request, bb_scene *scene, bb_table *table)
{
    location *l = calloc(1, sizeof *l);
    if (l == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    l->request = request;
    l->scene = scene;
    l->kernels = (bb_tet_kernels){.source = "locate_points.cl", .name = "locate_points"};
    bb_status status = prepare(l);
    l->task.self = l;
    l->task.scenes = &l->scene;
    l->task.scene_count = 1;
    l->task.faces = l->faces;
    l->task.answer_bytes = sizeof(bb_located);
    l->task.most_items = request->points;
    l->task.questions = 1;
    l->task.take = take;
    l->task.compile = compile;
    l->task.ask = ask;
    l->task.see = see;
    l->task.time = time_embree;
    l->task.end = end_embree;
    l->task.fill = fill;
    if (status == BB_OK)
        status = bb_contest_run(&request->contest, &l->task, table);
    bb_tracing_destroy(l->embree);
    bb_tet_kernels_release(&l->kernels);
    bb_kernel_release(l->of_faces);
    bb_program_release(l->program);
    bb_buffer_release(&l->d_points);
    bb_buffer_release(&l->d_sides);
    bb_buffer_release(&l->d_hits);
    bb_buffer_release(&l->rays.on_device);
    bb_host_free(l->rays.rays);
    bb_host_free(l->points);
    bb_host_free(l->hits);
    bb_host_free(l->first);
    bb_host_free(l->sides);
    bb_scene_free(l->faces);
    free(l);
    return status;
}
