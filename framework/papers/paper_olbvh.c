/* Stroeter, Mueller-Roemer, Stork, Fellner: OLBVH: octree linear bounding volume hierarchy for
 * volumetric meshes. The Visual Computer 36, 2020.
 *
 * Memory and build (table 2, figure 6), volume rendering (figure 7), slices (figure 8) and overlaps
 * (figure 10) by OLBVH, alpha 0 to 2, and by the LBVH of the same tetrahedra. The figures' bars
 * have no numbers in the text; of the paper there are table 2 and the ranges of its words. Its
 * meshes are not to be had: here a ball, a regular block (as "Jets"), a shell (as "Part" and "Pot")
 * and a block whose cubes grow (as those with large variance), or what is asked for.
 */
#include "framework/dvr/dvr.h"
#include "framework/overlap/overlap_contest.h"
#include "framework/papers/reproduce.h"
#include "framework/scene/tets_gather.h"
#include "framework/slice/slice_contest.h"

#include <math.h>
#include <stdlib.h>

enum { MESHES_MAX = 16, ALPHAS = 3, TASKS = 3 };

static const char *const builders[] = {"lbvh", "olbvh", "olbvh:alpha=1", "olbvh:alpha=2"};
static const char *const searches[] = {"skip", "octree"};
enum { BUILDERS = sizeof builders / sizeof builders[0], SEARCHES = 2 };

static const char *const meshes[] = {"tets:side=24", "tets:side=24,shape=block,jitter=0",
                                     "tets:side=32,shape=shell",
                                     "tets:side=20,shape=block,grade=1.4,jitter=0"};
static const char *const quick_meshes[] = {"tets:side=4", "tets:side=4,shape=shell"};

/* Of one mesh; of its overlap, with the mesh after it, fitted into its middle. */
typedef struct mesh_figures {
    char name[256];
    uint32_t tets;
    bb_dvr_result dvr;
    bb_slice_result slice;
    bb_overlap_result overlap;
} mesh_figures;

typedef struct measured {
    uint32_t count;
    mesh_figures *meshes;
} measured;

static const bb_experiment experiments[] = {{.name = NULL}};

/* ---- measuring ---- */

static bool differ(const bb_contest_way *ways, uint32_t count)
{
    bool found = false;
    for (uint32_t w = 0; w < count; w++)
        found = found || ways[w].differ > 0;
    return found;
}

static uint32_t rounds(const bb_reproduce_request *request)
{
    return request->quick ? 2 : request->repeats > 0 ? request->repeats : 7;
}

static bb_status render(const bb_reproduce_request *request, bb_scene *scene, bb_dvr_result *result)
{
    bb_transfer transfer;
    BB_TRY(bb_transfer_load(bb_transfer_presets[0].name, &transfer));
    const uint32_t side = request->quick ? 12 : 96;
    const bb_dvr_request dvr = {.device = request->device,
                                .builders = builders,
                                .builder_count = BUILDERS,
                                .searches = searches,
                                .search_count = SEARCHES,
                                .transfer = &transfer,
                                .width = side,
                                .height = side,
                                .step = 1,
                                .repeats = rounds(request),
                                .seed = request->seed,
                                .quiet = request->quiet};
    return bb_dvr_run(&dvr, scene, result);
}

static bb_status cut(const bb_reproduce_request *request, bb_scene *scene, bb_slice_result *result)
{
    const uint32_t side = request->quick ? 16 : 333;
    const double height = (double)scene->bounds.hi[2] - (double)scene->bounds.lo[2];
    const bb_slice_request slice = {
        .device = request->device,
        .builders = builders,
        .builder_count = BUILDERS,
        .searches = searches,
        .search_count = SEARCHES,
        /* one, as thick as 1/20 of the mesh is high: what most of table 4 amounts to */
        .plan = {.axis = 2, .width = side, .height = side, .count = 1, .thickness = height / 20},
        .repeats = rounds(request),
        .seed = request->seed,
        .quiet = request->quiet};
    return bb_slice_run(&slice, scene, result);
}

static bb_status overlap(const bb_reproduce_request *request, bb_scene *scene, const char *other,
                         bb_overlap_result *result)
{
    const bb_overlap_request overlap = {.device = request->device,
                                        .builders = builders,
                                        .builder_count = BUILDERS,
                                        .searches = searches,
                                        .search_count = SEARCHES,
                                        .repeats = rounds(request),
                                        .seed = request->seed,
                                        .quiet = request->quiet};
    bb_scene *scenes[2] = {scene, NULL}, *loaded;
    BB_TRY(bb_scene_load(other, &loaded));
    bb_status status = loaded->tets != NULL ? bb_tets_fit(loaded, scene, 0.6, &scenes[1])
                                            : bb_fail(BB_INVALID, "%s: has no tetrahedra", other);
    if (status == BB_OK)
        status = bb_scene_upload(scenes[1], request->device);
    if (status == BB_OK)
        status = bb_overlap_run(&overlap, scenes, result);
    bb_scene_free(scenes[1]);
    bb_scene_free(loaded);
    return status;
}

static bb_status measure_mesh(const bb_reproduce_request *request, const char *name,
                              const char *next, mesh_figures *m, bool *wrong)
{
    bb_scene *scene;
    snprintf(m->name, sizeof m->name, "%s", name);
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = scene->tets != NULL ? bb_scene_upload(scene, request->device)
                                           : bb_fail(BB_INVALID, "%s: has no tetrahedra", name);
    m->tets = scene->prims[BB_TETRAHEDRON].count;
    if (status == BB_OK)
        status = render(request, scene, &m->dvr);
    if (status == BB_OK)
        status = cut(request, scene, &m->slice);
    if (status == BB_OK)
        status = overlap(request, scene, next, &m->overlap);
    bb_scene_free(scene);
    *wrong = *wrong || differ(m->dvr.ways, m->dvr.way_count) ||
             differ(m->slice.ways, m->slice.way_count) ||
             differ(m->overlap.ways, m->overlap.way_count);
    return status;
}

static bb_status measure(const bb_reproduce_request *request, void **out, bool *wrong)
{
    const char *const *names = request->quick ? quick_meshes : meshes;
    uint32_t count = request->quick ? sizeof quick_meshes / sizeof quick_meshes[0]
                                    : sizeof meshes / sizeof meshes[0];
    measured *m = calloc(1, sizeof *m);
    *out = m;
    if (request->scene_count > 0) {
        names = (const char *const *)request->scenes;
        count = request->scene_count;
    }
    if (count > MESHES_MAX)
        return bb_fail(BB_INVALID, "reproduce olbvh: more than %d meshes", MESHES_MAX);
    if (m != NULL)
        m->meshes = calloc(count, sizeof *m->meshes);
    if (m == NULL || m->meshes == NULL)
        return bb_fail(BB_REFUSED, "reproduce: no memory");
    for (uint32_t i = 0; i < count; i++) {
        m->count = i + 1; /* also of one that fails there is something to release */
        BB_TRY(measure_mesh(request, names[i], names[(i + 1) % count], &m->meshes[i], wrong));
    }
    return BB_OK;
}

static void release(void *opaque)
{
    measured *m = opaque;
    if (m == NULL)
        return;
    for (uint32_t i = 0; m->meshes != NULL && i < m->count; i++)
        bb_overlap_release(&m->meshes[i].overlap);
    free(m->meshes);
    free(m);
}

/* ---- figures ---- */

static const char *const task_names[TASKS] = {"volume rendering", "slice", "overlap"};

static const bb_contest_way *ways_of(const mesh_figures *m, int task)
{
    return task == 0 ? m->dvr.ways : task == 1 ? m->slice.ways : m->overlap.ways;
}

/* Ours by the octree of `alpha`; the rival is the first way, lbvh by skip. */
static const bb_contest_way *ours_of(const mesh_figures *m, int task, int alpha)
{
    return &ways_of(m, task)[(1 + alpha) * SEARCHES + 1];
}

/* How many times as fast as LBVH: the ratio of times upside down. */
static bb_estimate speedup(const mesh_figures *m, int task, int alpha)
{
    const bb_contest_way *ways = ways_of(m, task);
    const bb_estimate e = bb_contest_ratio(&ways[0], ours_of(m, task, alpha), false);
    return (bb_estimate){.value = 1 / e.value,
                         .low = 1 / e.high,
                         .high = 1 / e.low,
                         .least = 1 / e.most,
                         .most = 1 / e.least};
}

/* NAN if either was refused. */
static double bytes_ratio(const mesh_figures *m, int alpha)
{
    if (ours_of(m, 0, alpha)->tree_bytes == 0 || ways_of(m, 0)[0].tree_bytes == 0)
        return NAN;
    return (double)ours_of(m, 0, alpha)->tree_bytes / (double)ways_of(m, 0)[0].tree_bytes;
}

static bb_estimate build_ratio(const mesh_figures *m, int alpha)
{
    const bb_samples ratio =
        bb_samples_ratio(&ours_of(m, 0, alpha)->build, &ways_of(m, 0)[0].build);
    return bb_samples_estimate(&ratio);
}

/* ---- tables ---- */

/* Table 2, over the LBVH's memory. */
static const struct {
    const char *mesh;
    double tets, lbvh_mib, mib[ALPHAS];
} paper_memory[] = {
    {"Bunny", 32.0e3, 2.07, {1.83, 0.57, 0.27}}, {"Dragon", 824.8e3, 53.5, {52.9, 15.9, 7.41}},
    {"Part", 1.1e6, 71.3, {28.4, 12.3, 7.22}},   {"Fusion", 3.0e6, 195, {116, 45.2, 24.6}},
    {"Jets", 12.3e6, 797, {433, 164, 91.2}},
};

static void add_memory(const measured *m, bb_reproduction *r)
{
    static const char *const columns[] = {"mesh",     "tetrahedra", "LBVH MiB", "alpha 0",
                                          "alpha 1",  "alpha 2",    "/LBVH, 0", "/LBVH, 1",
                                          "/LBVH, 2", NULL};
    const double mib = 1 << 20;
    bb_paper_table_begin(r, "Memory of the tree, MiB and over that of LBVH (table 2)", columns);
    for (uint32_t i = 0; i < m->count; i++) {
        const mesh_figures *mesh = &m->meshes[i];
        bb_paper_row(r);
        bb_paper_text(r, mesh->name);
        bb_paper_number(r, mesh->tets, 0);
        bb_paper_number(r, (double)mesh->dvr.ways[0].tree_bytes / mib, 2);
        for (int a = 0; a < ALPHAS; a++)
            bb_paper_number(r, (double)ours_of(mesh, 0, a)->tree_bytes / mib, 2);
        for (int a = 0; a < ALPHAS; a++)
            bb_paper_number(r, bytes_ratio(mesh, a), 3);
    }
    for (size_t i = 0; i < sizeof paper_memory / sizeof paper_memory[0]; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s (paper)", paper_memory[i].mesh);
        bb_paper_row(r);
        bb_paper_text(r, name);
        bb_paper_number(r, paper_memory[i].tets, 0);
        bb_paper_number(r, paper_memory[i].lbvh_mib, 2);
        for (int a = 0; a < ALPHAS; a++)
            bb_paper_number(r, paper_memory[i].mib[a], 2);
        for (int a = 0; a < ALPHAS; a++)
            bb_paper_number(r, paper_memory[i].mib[a] / paper_memory[i].lbvh_mib, 3);
    }
}

static void add_builds(const measured *m, bb_reproduction *r)
{
    static const char *const columns[] = {"mesh",      "builder",   "references/tet", "nodes",
                                          "build ms",  "over LBVH", "95 % from",      "to",
                                          "layout ms", NULL};
    bb_paper_table_begin(r, "Build (figure 6)", columns);
    for (uint32_t i = 0; i < m->count; i++)
        for (int a = -1; a < ALPHAS; a++) {
            const mesh_figures *mesh = &m->meshes[i];
            const bb_contest_way *way = a < 0 ? &mesh->dvr.ways[0] : ours_of(mesh, 0, a);
            const bb_estimate e =
                a < 0 ? (bb_estimate){.value = 1, .low = 1, .high = 1} : build_ratio(mesh, a);
            if (way->refused[0] != '\0')
                continue;
            bb_paper_row(r);
            bb_paper_text(r, mesh->name);
            bb_paper_text(r, way->builder);
            bb_paper_number(r, (double)way->references / mesh->tets, 2);
            bb_paper_number(r, way->nodes, 0);
            bb_paper_number(r, bb_samples_median(&way->build), 2);
            bb_paper_number(r, e.value, 3);
            bb_paper_number(r, e.low, 3);
            bb_paper_number(r, e.high, 3);
            bb_paper_number(r, bb_samples_median(&way->layout), 2);
        }
}

static void add_task(const measured *m, int task, const char *const *paper, bb_reproduction *r)
{
    static const char *const columns[] = {"mesh",       "builder",   "search", "ms",
                                          "speed/LBVH", "95 % from", "to",     "nodes",
                                          "tests",      "wrong",     "paper",  NULL};
    char title[96];
    snprintf(title, sizeof title, "%s: speed over that of LBVH (%s)", task_names[task],
             task == 0   ? "figure 7"
             : task == 1 ? "figure 8"
                         : "figure 10");
    bb_paper_table_begin(r, title, columns);
    for (uint32_t i = 0; i < m->count; i++)
        for (uint32_t w = 0; w < BUILDERS * SEARCHES; w++) {
            const bb_contest_way *ways = ways_of(&m->meshes[i], task), *way = &ways[w];
            const int alpha = (int)(w / SEARCHES) - 1;
            const bb_estimate e = bb_contest_ratio(&ways[0], way, false);
            if (way->refused[0] != '\0')
                continue;
            bb_paper_row(r);
            bb_paper_text(r, m->meshes[i].name);
            bb_paper_text(r, way->builder);
            bb_paper_text(r, way->search);
            bb_paper_number(r, bb_samples_median(&way->answer), 2);
            bb_paper_number(r, 1 / e.value, 3);
            bb_paper_number(r, 1 / e.high, 3);
            bb_paper_number(r, 1 / e.low, 3);
            bb_paper_number(r, way->visits, 1);
            bb_paper_number(r, way->work, 2);
            bb_paper_number(r, (double)way->differ, 0);
            bb_paper_text(r, alpha >= 0 && w % SEARCHES == 1 ? paper[alpha] : "");
        }
}

/* ---- claims ---- */

static void claim_memory(const measured *m, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict less[MESHES_MAX], falls[MESHES_MAX];
    for (uint32_t i = 0; i < m->count; i++) {
        const double ratio[ALPHAS] = {bytes_ratio(&m->meshes[i], 0), bytes_ratio(&m->meshes[i], 1),
                                      bytes_ratio(&m->meshes[i], 2)};
        less[i] = bb_verdict_of(ratio[0] < 1, ratio[0], ratio[0]);
        falls[i] =
            bb_verdict_of(ratio[1] < 0.5 * ratio[0] && ratio[2] < ratio[1], ratio[0], ratio[2]);
        bb_say(&ours, "%s%s: %.2f, %.2f, %.2f", i > 0 ? "; " : "", m->meshes[i].name, ratio[0],
               ratio[1], ratio[2]);
        bb_say(&why, "%s%s: %.1f references a tetrahedron", i > 0 ? "; " : "", m->meshes[i].name,
               (double)ours_of(&m->meshes[i], 0, 0)->references / m->meshes[i].tets);
    }
    bb_claim(r, bb_most(less, m->count),
             "OLBVH takes less memory than LBVH for most meshes, alpha 0", "0.40 to 0.99 of it",
             &ours, &why);
    bb_claim(r, bb_all(falls, m->count),
             "A larger alpha saves much memory (here: less than half with alpha 1, and still less "
             "with alpha 2)",
             "0.17 to 0.30, 0.10 to 0.14", &ours, &why);
}

static void claim_builds(const measured *m, bb_reproduction *r)
{
    bb_words slower = {0}, faster = {0}, why = {0};
    bb_claim_verdict above[MESHES_MAX], below[2 * MESHES_MAX];
    for (uint32_t i = 0; i < m->count; i++) {
        above[i] = bb_above(build_ratio(&m->meshes[i], 0), 1);
        bb_say(&slower, "%s%s: ", i > 0 ? "; " : "", m->meshes[i].name);
        bb_say_estimate(&slower, build_ratio(&m->meshes[i], 0));
        for (int a = 1; a < ALPHAS; a++) {
            below[2 * i + (uint32_t)a - 1] = bb_below(build_ratio(&m->meshes[i], a), 1.1);
            bb_say(&faster, "%s%s, %d: ", i > 0 || a > 1 ? "; " : "", m->meshes[i].name, a);
            bb_say_estimate(&faster, build_ratio(&m->meshes[i], a));
        }
    }
    bb_say(&why, "a reference is a code to be sorted, and LBVH has one per tetrahedron; its rival "
                 "here is not Apetrei's but Karras' linking");
    bb_claim(r, bb_all(above, m->count), "With alpha 0 the build is slower than LBVH's",
             "section 4.1", &slower, &why);
    bb_claim(r, bb_most(below, 2 * m->count),
             "With alpha 1 and 2 it matches or beats LBVH's in many cases (here: at most 1.1 times "
             "its time in most)",
             "section 4.1", &faster, &why);
}

static void claim_task(const measured *m, int task, int alpha, double bound, const char *claim,
                       const char *paper, const char *reason, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict each[MESHES_MAX];
    for (uint32_t i = 0; i < m->count; i++) {
        const bb_estimate e = speedup(&m->meshes[i], task, alpha);
        each[i] = bb_above(e, bound);
        bb_say(&ours, "%s%s: ", i > 0 ? "; " : "", m->meshes[i].name);
        bb_say_estimate(&ours, e);
    }
    bb_say(&why, "%s", reason);
    bb_claim(r, bb_most(each, m->count), claim, paper, &ours, &why);
}

static void evaluate(const bb_findings *findings, const void *opaque, bb_reproduction *r)
{
    static const char *const papers[TASKS][ALPHAS] = {
        {"2 to 13", "above LBVH's", ""},
        {"3 to 25", "3 to 25", ""},
        {"5 to 52", "significant", "significant"},
    };
    const measured *m = opaque;
    (void)findings;
    if (m == NULL)
        return;
    add_memory(m, r);
    add_builds(m, r);
    for (int task = 0; task < TASKS; task++)
        add_task(m, task, papers[task], r);
    claim_memory(m, r);
    claim_builds(m, r);
    claim_task(m, 0, 0, 2, "Volume rendering with alpha 0 is at least twice as fast as by LBVH",
               "2 to 13 times",
               "LBVH here has tight boxes, a search that ends at the first tetrahedron that holds "
               "the sample for sure, and caches that hold the path of one sample for the next",
               r);
    claim_task(m, 1, 0, 3, "Slices with alpha 0 are at least three times as fast as by LBVH",
               "3 to 25 times",
               "LBVH here looks for the centre first, as OLBVH does, and only then for what meets "
               "the voxel; the paper's looks for the latter at once",
               r);
    claim_task(
        m, 2, 0, 5, "Overlaps with alpha 0 are at least five times as fast as by LBVH",
        "5 to 52 times",
        "LBVH here ends with the first pair that meets, of which most tetrahedra inside need "
        "one or two; and that a cell is inside has to be shown, cell by cell",
        r);
}

extern const bb_paper bb_paper_olbvh;
const bb_paper bb_paper_olbvh = {
    .name = "olbvh",
    .title = "Stroeter, Mueller-Roemer, Stork, Fellner 2020: OLBVH: octree linear bounding volume "
             "hierarchy for volumetric meshes",
    .experiments = experiments,
    .builders = "lbvh,olbvh,olbvh:alpha=1,olbvh:alpha=2",
    .measure = measure,
    .release = release,
    .evaluate = evaluate,
};
