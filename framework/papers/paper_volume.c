/* Zellmann, Hellmann, Lang: A Linear Time BVH Construction Algorithm for Sparse Volumes.
 * PacificVis 2019.
 *
 * Phases of the build (figure 3), and build with picture against a march without a tree (table 1,
 * figure 4), by the size of the volume. Of table 1 there are no numbers in the text that we have:
 * of the paper there are its words. As there, an n-body density or a volume that is given, seen in
 * parallel projection, turned full circle about each axis; here in fewer steps than 180, smaller
 * pictures than 2160 x 2160, and sizes from 64 on.
 */
#include "framework/papers/reproduce.h"
#include "framework/tasks/dvr.h"

#include <math.h>
#include <string.h>

enum { SIZES_MAX = 8, BRICK = 8, PAPER_SIDE = 2160 }; /* the last: the paper's */
enum { OF_SIZES, FULL }; /* some volumes; one of them with nothing to skip */
#define VOLUME_BUILDER "vlbvh"
#define NO_TREE "no tree"

/* ---- measuring ---- */

static const bb_column cubes = BB_FOUND_NUMBER("cubes", "Voxels."),
                       share = BB_FOUND_NUMBER("vote_share", "Vote over all phases of the build."),
                       width = BB_FOUND_NUMBER("picture_width", "Pixels of a picture."),
                       height = BB_FOUND_NUMBER("picture_height", "Likewise."),
                       turns = BB_FOUND_NUMBER("turns", "Pictures about each axis."),
                       frame = BB_FOUND_ROUNDS("frame_ms", "Build, layout and picture.");

/* Those of the whole frame, and of the vote, of each way. */
static void add_sums(bb_table *table, const char *scene)
{
    const uint32_t count = bb_table_row_count(table);
    double vote = NAN, sum = 0;
    for (uint32_t row = 0; row < count; row++) {
        const double ms = bb_table_get_number(table, row, "phase_ms");
        if (strcmp(bb_table_name(table, row, BB_SCENE), scene) != 0 || !isfinite(ms))
            continue;
        vote = strcmp(bb_table_name(table, row, BB_MAKER), "vote") == 0 ? ms : vote;
        sum += ms;
    }
    for (uint32_t row = 0; row < count; row++) {
        static const char *const parts[] = {"answer_ms", "build_ms", "layout_ms"};
        bb_samples all = {.count = 0};
        if (strcmp(bb_table_name(table, row, BB_SCENE), scene) != 0 ||
            bb_table_get_rounds(table, row, parts[0]) == NULL)
            continue;
        for (int p = 0; p < 3; p++) {
            const bb_samples *more = bb_table_get_rounds(table, row, parts[p]);
            if (more != NULL)
                bb_add_rounds(&all, more);
        }
        bb_table_set_rounds(table, row, &frame, &all);
        if (bb_table_name(table, row, BB_BUILDER)[0] != '\0')
            bb_table_set_number(table, row, &share, vote / sum);
    }
}

static bb_status measure_scene(const bb_reproduce_request *request, const char *name,
                               bb_scene *scene, bb_findings *f, bool *wrong)
{
    static const char *const builders[] = {VOLUME_BUILDER}, *const kernels[] = {"stack", "stack8"};
    const uint32_t side = request->quick ? 16 : request->full_size ? PAPER_SIDE : 192;
    bb_dvr_request dvr = {
        .contest = bb_paper_contest(request, name),
        .turns = request->quick ? 1 : 4,
        .width = side,
        .height = side,
        .step = 0.5,
    };
    dvr.contest.builders = builders;
    dvr.contest.builder_count = 1;
    dvr.contest.searches = kernels;
    dvr.contest.search_count = 2;
    if (scene->volume == NULL)
        return bb_fail(BB_INVALID, "reproduce volume: --scene %s is no volume", name);
    BB_TRY(bb_scene_upload(scene, request->device));
    const bb_status status = bb_dvr_run(&dvr, scene, f->table);
    const uint32_t row = bb_table_row(f->table, (bb_cell){{[BB_SCENE] = name}});
    double voxels = 1;
    for (int axis = 0; axis < 3; axis++)
        voxels *= 1.0 + scene->volume->grid.cells[axis];
    bb_table_set_number(f->table, row, &cubes, voxels);
    bb_table_set_number(f->table, row, &width, dvr.width);
    bb_table_set_number(f->table, row, &height, dvr.height);
    bb_table_set_number(f->table, row, &turns, dvr.turns);
    add_sums(f->table, name);
    *wrong = *wrong || bb_outline_is_wrong(&bb_dvr_outline, f->table);
    bb_tracers_clear(request->device);
    return status;
}

static bb_status picture(const bb_reproduce_request *request, const char *name, bb_findings *f,
                         bool *wrong)
{
    bb_scene *scene;
    BB_TRY(bb_paper_add_scene(f, name));
    BB_TRY(bb_scene_load_any(name, &scene));
    const bb_status status = measure_scene(request, name, scene, f, wrong);
    bb_scene_free(scene);
    return status;
}

/* The same with all of the volume seen: a parameter more. */
static bb_status picture_of_all(const bb_reproduce_request *request, const char *name,
                                bb_findings *f, bool *wrong)
{
    char full[1024];
    snprintf(full, sizeof full, "%s%ctransfer=full", name, strchr(name, ':') == NULL ? ':' : ',');
    return picture(request, full, f, wrong);
}

static bb_status measure(const bb_reproduce_request *request, bb_findings *f, bool *wrong)
{
    uint64_t side = request->quick ? 24 : 64, full = side;
    char name[64];
    for (uint32_t i = 0; i < request->scene_count; i++)
        BB_TRY(picture(request, request->scenes[i], &f[OF_SIZES], wrong));
    if (request->scene_count > 0)
        return picture_of_all(request, request->scenes[0], &f[FULL], wrong);
    for (uint32_t count = 0; count < (request->quick ? 2 : SIZES_MAX); count++, side *= 2) {
        const uint64_t bricks = side / BRICK * (side / BRICK) * (side / BRICK);
        if (bricks > request->max_prims)
            break;
        snprintf(name, sizeof name, "nbody:n=%u", (uint32_t)side);
        BB_TRY(picture(request, name, &f[OF_SIZES], wrong));
        full = count < 3 ? side : full; /* a full volume takes long */
    }
    snprintf(name, sizeof name, "nbody:n=%u", (uint32_t)full);
    return picture_of_all(request, name, &f[FULL], wrong);
}

/* ---- figures: by stack ---- */

static double cubes_of(const bb_findings *f, const char *scene)
{
    return bb_find(f, &(bb_cell){{[BB_SCENE] = scene}}, "cubes").number;
}

/* Twice the side of the one before: what growth is said of. */
static bool is_later(const bb_findings *f, const char *scene)
{
    size_t s = 0;
    while (s < f->scene_count && strcmp(f->scenes[s], scene) != 0)
        s++;
    return s > 0 && s < f->scene_count && cubes_of(f, scene) == 8 * cubes_of(f, f->scenes[s - 1]);
}

static bool is_largest(const bb_findings *f, const char *scene)
{
    for (size_t s = 0; s < f->scene_count; s++)
        if (cubes_of(f, f->scenes[s]) > cubes_of(f, scene))
            return false;
    return true;
}

static bool is_last_double(const bb_findings *f, const char *scene)
{
    return is_later(f, scene) && is_largest(f, scene);
}

#define BY_STACK .builder = VOLUME_BUILDER, .kernel = "stack"
#define OVER_NO_TREE .base = "", .base_kernel = NO_TREE
#define VOTE .what = "phase_ms", .phase = "vote", .per = "build_ms", BY_STACK
#define PICTURE .what = "answer_ms", BY_STACK, OVER_NO_TREE
static const bb_figure vote = {VOTE},
                       largest_vote = {VOTE, .mean = BB_MEAN_OF_ROUNDS, .only = is_largest},
                       vote_growth = {VOTE, .previous = true, .only = is_later},
                       picture_ratio = {PICTURE},
                       picture_growth = {PICTURE, .previous = true, .only = is_later},
                       full_picture = {PICTURE},
                       voxel_growth = {.what = "build_ms",
                                       BY_STACK,
                                       .scale = 1.0 / 8,
                                       .previous = true,
                                       .only = is_last_double},
                       largest_frame = {.what = "frame_ms",
                                        BY_STACK,
                                        OVER_NO_TREE,
                                        .only = is_largest},
                       samples = {.what = "tests_per_item", BY_STACK},
                       all_samples = {.what = "tests_per_item", .builder = "", .kernel = NO_TREE},
                       seen_bricks = {.what = "bricks_seen_percent"};

/* ---- tables ---- */

#define PHASE(name) BB_COLUMN_AS(name, 3, .what = "phase_ms", .phase = name, BY_STACK)
static const bb_paper_column phases[] = {
    BB_COLUMN_OF("volume", BB_SHOW_SCENE),
    BB_COLUMN_AS("build ms", 3, .what = "build_ms", BY_STACK),
    PHASE("vote"),
    PHASE("compact"),
    PHASE("codes"),
    PHASE("boxes"),
    PHASE("sort"),
    PHASE("link"),
    BB_COLUMN_AS("vote, share", 3, .what = "vote_share", BY_STACK),
    BB_COLUMN_AS("ns/voxel", 3, .what = "build_ms", .per = "cubes", .scale = 1e6, BY_STACK),
    {.heading = NULL},
};

static const bb_figure both = {.what = "frame_ms", OVER_NO_TREE};
static const bb_paper_column frames[] = {
    BB_COLUMN_OF("volume", BB_SHOW_SCENE),
    BB_COLUMN_OF("kernel", BB_SHOW_ROW),
    BB_COLUMN_AS("build ms", 2, .what = "build_ms"),
    BB_COLUMN_AS("picture ms", 2, .what = "answer_ms"),
    BB_COLUMN_AS("both ms", 2, .what = "frame_ms"),
    BB_COLUMN_AS("picture", 3, .what = "answer_ms", OVER_NO_TREE),
    BB_COLUMN_INTERVAL("both", &both),
    BB_COLUMN_AS("samples", 1, .what = "tests_per_item"),
    BB_COLUMN_AS("wrong pixels", 0, .what = "differ"),
    {.heading = NULL},
};

#define WAY(name_, builder_) .name = name_, .builder = builder_, .kernel = name_
static const bb_paper_entrant ways[] = {
    {WAY(NO_TREE, "")},
    {WAY("stack", VOLUME_BUILDER)},
    {WAY("stack8", VOLUME_BUILDER)},
    {.name = NULL},
};

static void say_sizes(bb_paper_place at, bb_words *title)
{
    const bb_cell first = {{[BB_SCENE] = at.all->scene_count > 0 ? at.all->scenes[0] : ""}};
    bb_say(title, "pictures of %g x %g pixels, %g about each axis (paper: %d x %d, 180)",
           bb_find(at.all, &first, "picture_width").number,
           bb_find(at.all, &first, "picture_height").number,
           bb_find(at.all, &first, "turns").number, PAPER_SIDE, PAPER_SIDE);
}

static const bb_paper_table tables[] = {
    {.title = "Phases of the build, ms (figure 3)", .columns = phases, .by_scene = true},
    {.title = "Build and picture against a march without a tree, ratios (table 1, figure 4); the "
              "last volume has nothing to skip; ",
     .columns = frames,
     .rows = ways,
     .by_scene = true,
     .title_words = say_sizes},
    {.title = "", .columns = frames, .rows = ways, .by_scene = true, .of = FULL},
    {.title = NULL},
};

/* ---- claims ---- */

static const bb_paper_claim claims[] = {
    {.text = "Voting dominates the build more and more, the larger the volume (here: its share "
             "grows with each size, and is above a half at the largest)",
     .paper = "section 4, figure 3",
     .figures = {&vote, &largest_vote, &vote_growth},
     .tests = {BB_TEST_EACH(2, BB_ABOVE, 1), BB_TEST(1, BB_ABOVE, 0.5)},
     .scenes = 3,
     .ours = {{.each = true, .first = "share of the vote at ", .text = "{scene}: {0}"}}},
    {.text = "The build takes linear time (here: per voxel no more at twice the side)",
     .paper = "section 3",
     .figures = {&voxel_growth},
     .tests = {{.over = BB_EACH, .side = BB_AT_MOST, .claimed = 1}},
     .scenes = 3,
     .ours = {{.each = true, .text = "a voxel at {scene} over one at half the side: {0}"}}},
    {.text = "Build and picture together are two to three times as fast as a march without a tree "
             "(here: at most half of its time, at the largest volume)",
     .paper = "2 to 3 times at 1024^3",
     .figures = {&largest_frame, &samples, &all_samples, &seen_bricks},
     .tests = {{.over = BB_EACH, .side = BB_BELOW, .bound = 1, .claimed = 0.5}},
     .ours = {{.each = true, .text = "at {scene}: {0}"}},
     .why = {{.each = true,
              .always = true,
              .text = "{1.1} of {2.1} samples are left, {3.1} % of the bricks are seen"}}},
    {.text = "Of the picture alone, the gain by the tree increases with the size of the volume",
     .paper = "section 4",
     .figures = {&picture_ratio, &picture_growth},
     .tests = {BB_TEST_EACH(1, BB_BELOW, 1)},
     .scenes = 3,
     .ours = {{.each = true, .first = "picture, ratio at ", .text = "{scene}: {0}"}}},
    {.text = "With no empty space at all, the picture by the tree is slower than without one",
     .paper = "section 4",
     .of = FULL,
     .figures = {&full_picture},
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     .ours = {{.each = true, .text = "{scene}: {0}"}}},
    {.text = NULL},
};

extern const bb_paper bb_paper_volume;
const bb_paper bb_paper_volume = {
    .name = "volume",
    .title = "Zellmann, Hellmann, Lang 2019: A Linear Time BVH Construction Algorithm for Sparse "
             "Volumes",
    .builders = VOLUME_BUILDER,
    .measure = measure,
    .tables = tables,
    .claims = {claims},
};
