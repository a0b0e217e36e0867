/* Contests of OLBVH's paper: pictures, slices, overlaps, and points by the paper's rival. */
#include "framework/papers/olbvh.h"
#include "framework/scene/tets_gather.h"
#include "framework/tasks/dvr.h"
#include "framework/tasks/locate_contest.h"
#include "framework/tasks/overlap_contest.h"
#include "framework/tasks/slice_contest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MESHES_MAX = 16 };

static const char *const builders[] = {LBVH, ALPHA0, ALPHA1, ALPHA2, FACES_LBVH, FACES_PLOC};
static const char *const searches[] = {"skip", "octree", "olbvh", "olbvh:boundary=no"};
static const char *const kernels[] = {"stack", "stack8"};
enum { BUILDERS = 4, BUILDERS_AND_RIVALS = 6, SEARCHES = 3, SEARCHES_RENDERING, KERNELS = 2 };

static const char *const meshes[] = {"tets:side=24", "tets:side=24,shape=block,jitter=0",
                                     "tets:side=32,shape=shell",
                                     "tets:side=20,shape=block,grade=1.4,jitter=0", NULL};
static const char *const quick_meshes[] = {"tets:side=4", "tets:side=4,shape=shell", NULL};

static const bb_column side_column = BB_FOUND_NUMBER("side", "Pixels along a picture or slice.");

static const bb_column array_column =
    BB_FOUND_NUMBER("array_bytes", "Of an OLBVH's arrays as published; of an LBVH, the tree.");

static void note_side(bb_table *table, const char *scene, uint32_t side)
{
    bb_table_set_number(table, bb_table_row(table, (bb_cell){{[BB_SCENE] = scene}}), &side_column,
                        side);
}

/* The request of all contests. */
static bb_contest_request contest_of(const bb_reproduce_request *request, const char *name)
{
    bb_contest_request contest = bb_paper_contest(request, name);
    contest.builders = builders;
    contest.builder_count = BUILDERS;
    contest.searches = searches;
    contest.search_count = SEARCHES;
    return contest;
}

static bb_status render(const bb_reproduce_request *request, bb_scene *scene, const char *name,
                        bb_table *table)
{
    bb_transfer transfer;
    BB_TRY(bb_transfer_load(bb_transfer_presets[0].name, &transfer));
    const uint32_t side = request->quick ? 12 : request->full_size ? BB_OLBVH_PICTURE : 96;
    bb_dvr_request dvr = {.contest = contest_of(request, name),
                          .transfer = &transfer,
                          .width = side,
                          .height = side,
                          .step = 1};
    dvr.contest.search_count = SEARCHES_RENDERING;
    note_side(table, name, side);
    return bb_dvr_run(&dvr, scene, table);
}

/* Of what was rendered last. */
static void note_arrays(bb_findings *f)
{
    const char *scene = f->scenes[f->scene_count - 1]; /* as tables have it */
    for (int i = 0; i < BUILDERS; i++) {
        const bool lbvh = strcmp(builders[i], LBVH) == 0;
        const bb_cell tree = {{[BB_SCENE] = scene, [BB_BUILDER] = builders[i]}};
        bb_cell from = tree;
        from.names[BB_INTERSECTOR] = lbvh ? "skip" : "olbvh";
        const bb_found bytes = bb_find(f, &from, lbvh ? "tree_bytes" : "query_bytes");
        if (isfinite(bytes.number))
            bb_table_set_number(f->table, bb_table_row(f->table, tree), &array_column,
                                bytes.number);
    }
}

static bb_status cut(const bb_reproduce_request *request, bb_scene *scene, const char *name,
                     bb_table *table)
{
    const uint32_t side = request->quick ? 16 : request->full_size ? BB_OLBVH_SLICE : 333;
    const double height = (double)scene->bounds.hi[2] - (double)scene->bounds.lo[2];
    const bb_slice_request slice = {
        .contest = contest_of(request, name),
        /* one, as thick as 1/20 of the mesh is high: what most of table 4 amounts to */
        .plan = {.axis = 2, .width = side, .height = side, .count = 1, .thickness = height / 20}};
    note_side(table, name, side);
    return bb_slice_run(&slice, scene, table);
}

static bb_status locate(const bb_reproduce_request *request, bb_scene *scene, const char *name,
                        bb_findings *f)
{
    bb_location_request location = {.contest = contest_of(request, name),
                                    .points = request->quick       ? 2000
                                              : request->full_size ? 1 << 20
                                                                   : 1 << 17};
    location.contest.builder_count = BUILDERS_AND_RIVALS;
    location.contest.kernels = kernels;
    location.contest.kernel_count = KERNELS;
    const bb_status status = bb_location_run(&location, scene, f->table);
    if (status != BB_UNSUPPORTED && status != BB_REFUSED)
        return status;
    /* it is the last of the mesh's tasks, and takes none of the others with it */
    const uint32_t row = bb_table_row(f->table, (bb_cell){{[BB_SCENE] = name}});
    bb_table_set_text(f->table, row, &bb_column_refused, bb_message());
    return BB_OK;
}

/* With `other`, fitted into the middle. */
static bb_status overlap(const bb_reproduce_request *request, bb_scene *scene, const char *name,
                         const char *other, bb_table *table)
{
    const bb_contest_request contest = contest_of(request, name);
    bb_scene *scenes[2] = {scene, NULL}, *loaded;
    BB_TRY(bb_scene_load(other, &loaded));
    bb_status status = loaded->tets != NULL ? bb_tets_fit(loaded, scene, 0.6, &scenes[1])
                                            : bb_fail(BB_INVALID, "%s: has no tetrahedra", other);
    if (status == BB_OK)
        status = bb_scene_upload(scenes[1], request->device);
    if (status == BB_OK)
        status = bb_overlap_run(&contest, scenes, NULL, table);
    bb_scene_free(scenes[1]);
    bb_scene_free(loaded);
    return status;
}

static bb_status measure_mesh(const bb_reproduce_request *request, const char *name,
                              const char *next, bb_findings *f)
{
    bb_scene *scene;
    for (int task = 0; task < BB_OLBVH_TASKS; task++)
        BB_TRY(bb_paper_add_scene(&f[task], name));
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = scene->tets != NULL ? bb_scene_upload(scene, request->device)
                                           : bb_fail(BB_INVALID, "%s: has no tetrahedra", name);
    if (status == BB_OK)
        status = render(request, scene, name, f[BB_OLBVH_RENDERING].table);
    if (status == BB_OK)
        note_arrays(&f[BB_OLBVH_RENDERING]);
    if (status == BB_OK)
        status = cut(request, scene, name, f[BB_OLBVH_SLICES].table);
    if (status == BB_OK)
        status = overlap(request, scene, name, next, f[BB_OLBVH_OVERLAPS].table);
    if (status == BB_OK)
        status = locate(request, scene, name, &f[BB_OLBVH_LOCATION]);
    bb_scene_free(scene);
    return status;
}

/* Searches of tetrahedra agree to the last bit. Tracing of faces need not: a point may be closer to
 * a face than rounding tells, and meshes with hanging nodes have faces that do not meet. */
static bool is_wrong(const bb_findings *f, const char *scene)
{
    bool wrong = false;
    for (int b = 0; b < BUILDERS; b++)
        for (int s = 0; s < SEARCHES; s++) {
            const bb_cell way = {
                {[BB_SCENE] = scene, [BB_BUILDER] = builders[b], [BB_INTERSECTOR] = searches[s]}};
            wrong = wrong || bb_find(f, &way, "differ").number > 0;
        }
    return wrong;
}

bb_status bb_olbvh_measure(const bb_reproduce_request *request, bb_findings *f, bool *wrong)
{
    const char *const *names = request->quick ? quick_meshes : meshes;
    uint32_t count = request->scene_count;
    if (count > MESHES_MAX)
        return bb_fail(BB_INVALID, "reproduce olbvh: more than %d meshes", MESHES_MAX);
    if (count > 0)
        names = (const char *const *)request->scenes;
    else
        while (names[count] != NULL)
            count++;
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(measure_mesh(request, names[i], names[(i + 1) % count], f));
    const bb_findings *located = &f[BB_OLBVH_LOCATION];
    for (size_t i = 0; i < located->scene_count; i++)
        *wrong = *wrong || is_wrong(located, located->scenes[i]);
    for (int task = 0; task < BB_OLBVH_LOCATION; task++)
        *wrong = *wrong || bb_outline_is_wrong(&bb_slice_outline, f[task].table);
    return BB_OK;
}
