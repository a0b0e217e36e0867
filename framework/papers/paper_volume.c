/* Zellmann, Hellmann, Lang: A Linear Time BVH Construction Algorithm for Sparse Volumes.
 * PacificVis 2019.
 *
 * Phases of the build (figure 3), and build with picture against a march without a tree (table 1,
 * figure 4), by the size of the volume. Of table 1 there are no numbers in the text that we have:
 * of the paper there are its words. As there, an n-body density or a volume that is given, seen in
 * parallel projection, turned full circle about each axis; here in fewer steps than 180, smaller
 * pictures than 2160 x 2160, and sizes from 64 to 1024; 2048 with --max-prims 5000000, if memory is
 * predicted to suffice. Beside it: memory with the number of visible bricks known in advance,
 * pruned trees, which the paper suggests, and a tree for each of several transfer functions in
 * turn.
 */
#include "framework/base/memory.h"
#include "framework/papers/reproduce.h"
#include "framework/tasks/dvr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_LEAST = 64, SIZES_MAX = 6, BRICK = 8, PAPER_SIDE = 2160 }; /* the last: the paper's */
enum { SEEN_PART = 4 }; /* of the bricks, about one in so many is visible: a primitive */
/* Some volumes; one of them with nothing to skip; the same with each transfer function. */
enum { OF_SIZES, FULL, IN_TURN };
#define VOLUME_BUILDER "vlbvh"
#define KNOWING "vlbvh:room=seen"
#define PRUNED_1 "vlbvh:prune=1"
#define PRUNED_2 "vlbvh:prune=2"
#define NO_TREE "no tree"

/* ---- measuring ---- */

static const bb_column cubes = BB_FOUND_NUMBER("cubes", "Voxels."),
                       share = BB_FOUND_NUMBER("vote_share", "Vote over all phases of the build."),
                       width = BB_FOUND_NUMBER("picture_width", "Pixels of a picture."),
                       height = BB_FOUND_NUMBER("picture_height", "Likewise."),
                       turns = BB_FOUND_NUMBER("turns", "Pictures about each axis."),
                       left_out = BB_FOUND_TEXT("left_out", "Volumes for which memory is short."),
                       frame = BB_FOUND_ROUNDS("frame_ms", "Build, layout and picture.");

/* The vote over all phases of a builder's build. */
static double share_of_vote(const bb_table *table, const char *scene, const char *builder)
{
    double vote = NAN, sum = 0;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const double ms = bb_table_get_number(table, row, "phase_ms");
        if (strcmp(bb_table_name(table, row, BB_SCENE), scene) != 0 ||
            strcmp(bb_table_name(table, row, BB_BUILDER), builder) != 0 || !isfinite(ms))
            continue;
        vote = strcmp(bb_table_name(table, row, BB_MAKER), "vote") == 0 ? ms : vote;
        sum += ms;
    }
    return vote / sum;
}

/* Those of the whole frame, and of the vote, of each way. */
static void add_sums(bb_table *table, const char *scene)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const char *builder = bb_table_name(table, row, BB_BUILDER);
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
        if (builder[0] != '\0')
            bb_table_set_number(table, row, &share, share_of_vote(table, scene, builder));
    }
}

static bb_status measure_scene(const bb_reproduce_request *request, const char *name,
                               bb_scene *scene, bb_findings *f, bool *wrong)
{
    static const char *const builders[] = {VOLUME_BUILDER, KNOWING, PRUNED_1, PRUNED_2};
    static const char *const kernels[] = {"stack", "stack8"};
    const uint32_t side = request->quick ? 16 : request->full_size ? PAPER_SIDE : 192;
    bb_dvr_request dvr = {
        .contest = bb_paper_contest(request, name),
        .turns = request->quick ? 1 : 4,
        .width = side,
        .height = side,
        .step = 0.5,
    };
    dvr.contest.builders = builders;
    dvr.contest.builder_count = sizeof builders / sizeof builders[0];
    dvr.contest.searches = kernels;
    dvr.contest.search_count = 2;
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
    bb_traversers_clear(request->device);
    return status;
}

/* A volume, on the device. */
static bb_status load(const bb_reproduce_request *request, const char *name, bb_scene **scene)
{
    BB_TRY(bb_scene_load_any(name, scene));
    const bb_status status =
        (*scene)->volume == NULL
            ? bb_fail(BB_INVALID, "reproduce volume: --scene %s is no volume", name)
            : bb_scene_upload(*scene, request->device);
    if (status != BB_OK)
        bb_scene_free(*scene);
    return status;
}

static bb_status picture(const bb_reproduce_request *request, const char *name, bb_findings *f,
                         bool *wrong)
{
    bb_scene *scene;
    BB_TRY(bb_paper_add_scene(f, name));
    BB_TRY(load(request, name, &scene));
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

/* A tree and a picture for each transfer function there is. */
static bb_status picture_in_turn(const bb_reproduce_request *request, const char *name,
                                 bb_findings *f, bool *wrong)
{
    bb_scene *scene;
    BB_TRY(load(request, name, &scene));
    bb_status status = BB_OK;
    for (const bb_transfer_preset *preset = bb_transfer_presets;
         preset->name != NULL && status == BB_OK; preset++) {
        bb_transfer transfer;
        char title[1024];
        uint32_t changed;
        snprintf(title, sizeof title, "%s, %s", name, preset->name);
        status = bb_transfer_load(preset->name, &transfer);
        if (status == BB_OK)
            status = bb_scene_set_transfer(scene, &transfer, &changed);
        if (status == BB_OK)
            status = bb_paper_add_scene(f, title);
        if (status == BB_OK)
            status = measure_scene(request, title, scene, f, wrong);
    }
    bb_scene_free(scene);
    return status;
}

/* Bytes that a volume of so many voxels of a byte takes while it is compared: its bricks with the
 * layer that they share, on the host, on the device, and there once more to be copied; and for each
 * brick boxes, and the trees and layouts of all builders. */
static double predicted_bytes(double side)
{
    enum { BYTES_OF_BRICK = 600 };
    const double cells = side * side * side, overlap = (double)(BRICK + 1) / BRICK;
    return 3 * cells * overlap * overlap * overlap +
           cells / (BRICK * BRICK * BRICK) * BYTES_OF_BRICK;
}

/* Says on the first volume that a larger one is left out. */
static void leave_out(bb_findings *f, const char *why)
{
    const bb_cell first = {{[BB_SCENE] = f->scenes[0]}};
    bb_table_set_text(f->table, bb_table_row(f->table, first), &left_out, why);
}

static bb_status measure_sizes(const bb_reproduce_request *request, bb_findings *f, char full[64],
                               bool *wrong)
{
    char name[64];
    for (uint64_t side = request->quick ? 24 : SIDE_LEAST, count = 0;
         count < (request->quick ? 2 : SIZES_MAX); count++, side *= 2) {
        const uint64_t bricks = side / BRICK * (side / BRICK) * (side / BRICK);
        if (bricks / SEEN_PART > request->max_prims)
            break;
        snprintf(name, sizeof name, "nbody:n=%u", (uint32_t)side);
        char why[400];
        bb_status status = BB_OK;
        if (predicted_bytes((double)side) > (double)bb_host_limit())
            status = bb_fail(BB_REFUSED, "%s would take %.1f GiB, of which %.1f are there", name,
                             predicted_bytes((double)side) / (1 << 30),
                             (double)bb_host_limit() / (1 << 30));
        else
            status = picture(request, name, f, wrong);
        if (status == BB_REFUSED && count > 0) { /* else nothing was measured */
            snprintf(why, sizeof why, "%s", bb_message());
            if (strcmp(f->scenes[f->scene_count - 1], name) == 0)
                free(f->scenes[--f->scene_count]);
            leave_out(f, why);
            break;
        }
        BB_TRY(status);
        if (count < 3) /* a full volume takes long */
            snprintf(full, 64, "%s", name);
    }
    return BB_OK;
}

static bb_status measure(const bb_reproduce_request *request, bb_findings *f, bool *wrong)
{
    char smaller[64] = "";
    const char *name = request->scene_count > 0 ? request->scenes[0] : smaller;
    for (uint32_t i = 0; i < request->scene_count; i++)
        BB_TRY(picture(request, request->scenes[i], &f[OF_SIZES], wrong));
    if (request->scene_count == 0)
        BB_TRY(measure_sizes(request, &f[OF_SIZES], smaller, wrong));
    if (name[0] == '\0')
        return bb_fail(BB_INVALID, "reproduce volume: --max-prims leaves no volume");
    BB_TRY(picture_of_all(request, name, &f[FULL], wrong));
    return picture_in_turn(request, name, &f[IN_TURN], wrong);
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

/* In pictures of the paper's size: how build and picture compare depends on it. */
static bool is_published(const bb_findings *f, const char *scene, double side)
{
    const bb_cell cell = {{[BB_SCENE] = scene}};
    return cubes_of(f, scene) == side * side * side &&
           bb_find(f, &cell, "picture_width").number == PAPER_SIDE;
}

static bool is_1024(const bb_findings *f, const char *scene)
{
    return is_published(f, scene, 1024);
}

static bool is_2048(const bb_findings *f, const char *scene)
{
    return is_published(f, scene, 2048);
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
/* What the paper says of build and picture, and suggests of leaves. */
#define BUILD_OVER_PICTURE .what = "build_ms", .per = "answer_ms", BY_STACK
#define OVER_WHOLE(builder_)                                                                       \
    {                                                                                              \
        .what = "answer_ms", .builder = builder_, .kernel = "stack", .base = VOLUME_BUILDER        \
    }
static const bb_figure build_share = {BUILD_OVER_PICTURE},
                       build_growth = {BUILD_OVER_PICTURE, .previous = true, .only = is_later},
                       share_of_2048 = {BUILD_OVER_PICTURE, .only = is_2048},
                       pruned_1 = OVER_WHOLE(PRUNED_1), pruned_2 = OVER_WHOLE(PRUNED_2),
                       published_ms = {.what = "frame_ms", BY_STACK, .only = is_1024};

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

#define MIB(heading_, what_)                                                                       \
    BB_COLUMN_AS(heading_, 2, .what = what_, .scale = 1.0 / (1 << 20), .kernel = "stack")
static const bb_figure build_to_whole = {
    .what = "build_ms", .kernel = "stack", .base = VOLUME_BUILDER};
static const bb_paper_column rooms[] = {
    BB_COLUMN_OF("volume", BB_SHOW_SCENE),
    BB_COLUMN_OF("builder", BB_SHOW_BUILDER),
    BB_COLUMN_AS("bricks seen, %", 1, .what = "bricks_seen_percent", .builder = ""),
    MIB("most memory MiB", "bytes"),
    MIB("tree MiB", "tree_bytes"),
    BB_COLUMN_INTERVAL("build", &build_to_whole),
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
    {.name = "stack, prune=1", .builder = PRUNED_1, .kernel = "stack"},
    {.name = "stack, prune=2", .builder = PRUNED_2, .kernel = "stack"},
    {.name = NULL},
};
static const bb_paper_entrant known[] = {
    {WAY("stack", VOLUME_BUILDER)},
    {WAY("stack", KNOWING)},
    {.name = NULL},
};

static void say_sizes(bb_paper_place at, bb_words *title)
{
    const bb_cell first = {{[BB_SCENE] = at.all->scene_count > 0 ? at.all->scenes[0] : ""}};
    bb_say(title, "pictures of %g x %g pixels, %g about each axis (paper: %d x %d, 180)",
           bb_find(at.all, &first, "picture_width").number,
           bb_find(at.all, &first, "picture_height").number,
           bb_find(at.all, &first, "turns").number, PAPER_SIDE, PAPER_SIDE);
    const char *missing = bb_found_text(at.all, first.names[BB_SCENE], NULL, "left_out");
    bb_say(title, "%s%s", missing[0] != '\0' ? "; " : "", missing);
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
    {.title = "The same volume, a tree and pictures for each transfer function in turn",
     .columns = frames,
     .rows = ways,
     .by_scene = true,
     .of = IN_TURN},
    {.title = "Memory: reserved for all bricks, since the number of those that are seen comes out "
              "of the build; and for these alone",
     .columns = rooms,
     .rows = known,
     .by_scene = true},
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
    {.text = "The larger the volume, the more the build counts beside the picture",
     .paper = "section 4, figure 4",
     .figures = {&build_share, &build_growth},
     .tests = {BB_TEST_EACH(1, BB_ABOVE, 1)},
     .scenes = 3,
     .ours = {{.each = true, .first = "build over picture at ", .text = "{scene}: {0}"}}},
    {.text = "At 2048^3 the build takes longer than a picture of 2160 x 2160 pixels",
     .paper = "section 4, figure 4",
     .figures = {&share_of_2048},
     .tests = {BB_TEST_EACH(0, BB_ABOVE, 1)},
     .ours = {{.each = true, .text = "{scene}: {0}"}}},
    {.text = "A tree and a picture of 2160 x 2160 pixels fit into the time of a frame at 1024^3",
     .paper = "30 to 35 ms",
     .figures = {&published_ms},
     .tests = {{.over = BB_EACH, .side = BB_AT_MOST, .claimed = 35}},
     .ours = {{.each = true, .text = "{scene}: {0} ms"}}},
    {.text =
         "Pruning the tree makes up for some of the time that it costs where nothing is skipped",
     .paper = "section 4 expects it, without figures",
     .of = FULL,
     .figures = {&pruned_1, &pruned_2},
     .tests = {BB_TEST_EACH(0, BB_BELOW, 1), BB_TEST_EACH(1, BB_BELOW, 1)},
     .ours = {{.each = true,
               .first = "picture by leaves of 16^3 and 32^3 cells over those of 8^3: ",
               .before = ", ",
               .text = "{scene}: {0}, {1}"}}},
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
