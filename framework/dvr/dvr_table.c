/* A comparison as rows of a table, and what its page shows. */
#include "framework/base/json.h"
#include "framework/contest/contest_table.h"
#include "framework/dvr/dvr.h"

#include <stdio.h>

#define NUMBER BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_NEITHER
#define LESS BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_LESS
#define RATE BB_COLUMN_NUMBER, BB_SENSE_TIMED, BB_BETTER_MORE
#define ROUNDS BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS
#define TEXT BB_COLUMN_TEXT, BB_SENSE_EXACT, BB_BETTER_NEITHER, 0

/* Of the run; the step of a row of accuracy, too. */
static const bb_column step = {"step", "step", "", "Distance of samples, by the step's unit.",
                               NUMBER, -1};
static const bb_column cutoff = {
    "cutoff", "cutoff", "", "A ray ends where less light than this is left.", NUMBER, -1};

/* Of a scene. */
static const bb_column transfer = {"transfer", "transfer function", "", "Its name.", TEXT};
static const bb_column voxels = {"voxels", "voxels", "", "Along each axis.", TEXT};
static const bb_column bits = {"bits", "bits", "", "Of a voxel.", NUMBER, 0};
static const bb_column side = {"brick_side", "brick side", "", "In cells.", NUMBER, 0};
static const bb_column bricks = {"bricks", "bricks", "", "Of the volume.", NUMBER, 0};
static const bb_column seen = {
    "bricks_seen", "bricks seen", "", "Through the transfer function.", NUMBER, 0};
static const bb_column seen_part = {"bricks_seen_percent", "seen", "%",
                                    "Of all bricks.",      NUMBER, 2};
static const bb_column volume_bytes = {"volume_bytes",   "all bricks", "bytes",
                                       "Of all bricks.", NUMBER,       0};
static const bb_column copy = {
    "copy_ms", "a copy of all bricks", "ms", "From one buffer to another.", ROUNDS, 3};
static const bb_column copy_rate = {
    "copy_gb_per_s", "copied at", "GB/s", "All bricks by the time of their copy.", RATE, 1};
static const bb_column vertices = {"vertices", "vertices", "", "Of the mesh.", NUMBER, 0};
static const bb_column unit = {"step_unit", "unit of steps", "", "What a step of 1 is.", TEXT};
static const bb_column pictures = {"pictures", "pictures", "", "Of each way.", NUMBER, 0};
static const bb_column pixels = {"pixels", "pixels", "", "Of all pictures.", NUMBER, 0};
static const bb_column compared_by = {"compared_by", "compared by", "",
                                      "The program that compared as well.", TEXT};
static const bb_column converged = {"converged_to",
                                    "converged to",
                                    "",
                                    "How far twice the reference's step is from it.",
                                    NUMBER,
                                    -1};

/* Of a way. */
static const bb_column samples_rate = {
    "msamples_per_s", "samples M/s", "", "Millions of samples per second.", RATE, 2};
static const bb_column difference = {"largest_difference",
                                     "largest difference",
                                     "",
                                     "Of a channel, from the first way.",
                                     NUMBER,
                                     -1};
static const bb_column difference_8 = {"largest_difference_8_bits",
                                       "in 8 bits",
                                       "",
                                       "The largest difference, in steps of 1/255.",
                                       NUMBER,
                                       0};

/* Of a step: the accuracy. */
static const bb_column largest_error = {
    "largest_error", "largest error", "", "Of a channel in all pictures.", LESS, -1};
static const bb_column rms_error = {"rms_error", "RMS error", "", "Over all channels and pictures.",
                                    LESS,        -1};
static const bb_column samples = {"samples_per_ray", "samples", "", "Per ray.", NUMBER, 1};
static const bb_column picture_ms = {
    "picture_ms", "last picture", "ms", "By the first builder and kernel.", ROUNDS, 2};

#define OUTLINE                                                                                    \
    .command = "volume", .title = "bvhbench: pictures of volumes", .wrong = "differ",              \
    .well = "All answers are the same to the last bit.",                                           \
    .ill = "answers differ from those of the first way."

const bb_page_outline bb_dvr_outline = {
    OUTLINE,
    .views = bb_contest_views,
    .view_count = BB_CONTEST_VIEWS,
    .note =
        "ms: medians of the rounds. answer: a picture, the mean of all. / first: the ratio to the "
        "first way (of a volume, the march without a tree), paired round by round (95 %). all: "
        "build, layout and answer. M/s: millions of pixels per second. nodes, tests: of nodes and "
        "samples per ray, of a mesh those in tetrahedra alone. largest difference: of a channel "
        "from the picture of the first way. Builders that do not read the volume itself get the "
        "boxes of what is seen, and find nothing out. Accuracy: errors are the differences from a "
        "march with an eighth of the shortest step. Marked: the best, and those tied with it.",
};

const bb_page_outline bb_dvr_outline_briefly = {
    OUTLINE,
    .views = bb_contest_views,
    .view_count = BB_CONTEST_VIEWS_BRIEF,
};

/* ---- rows ---- */

static void fill_volume(const bb_dvr_result *r, uint32_t row, bb_table *table)
{
    char size[64];
    snprintf(size, sizeof size, "%u x %u x %u", r->dims[0], r->dims[1], r->dims[2]);
    bb_table_set_text(table, row, &voxels, size);
    bb_table_set_number(table, row, &bits, 8 * r->bytes);
    bb_table_set_number(table, row, &side, r->brick_side);
    bb_table_set_number(table, row, &bricks, r->bricks);
    bb_table_set_number(table, row, &seen, r->seen);
    bb_table_set_number(table, row, &seen_part, 100.0 * r->seen / r->bricks);
    bb_table_set_number(table, row, &volume_bytes, (double)r->volume_bytes);
    bb_table_set_rounds(table, row, &copy, &r->copy);
    if (r->copy.count > 0)
        bb_table_set_number(table, row, &copy_rate,
                            (double)r->volume_bytes / 1e6 / bb_samples_median(&r->copy));
    bb_table_set_text(table, row, &unit, "a voxel");
}

static void fill_mesh(const bb_dvr_result *r, uint32_t row, bb_table *table)
{
    bb_table_set_number(table, row, &bb_column_tetrahedra, r->tets);
    bb_table_set_number(table, row, &bb_column_boundary, r->boundary);
    bb_table_set_number(table, row, &vertices, r->vertices);
    bb_table_set_text(table, row, &bb_column_field, r->field);
    bb_table_set_text(table, row, &unit, "1/128 of the longest side");
}

static void fill_ways(const bb_dvr_result *r, bb_table *table)
{
    const double rays = (double)r->pixels / r->pictures;
    bb_contest_fill(table, r->scene, r->ways, r->way_count, rays, r->tets);
    for (uint32_t w = 0; w < r->way_count; w++) {
        const bb_contest_way *way = &r->ways[w];
        const uint32_t row = bb_contest_row(table, r->scene, way);
        if (way->refused[0] != '\0')
            continue;
        bb_table_set_number(table, row, &samples_rate,
                            way->work * rays / bb_samples_median(&way->answer) / 1e3);
        if (way->builder[0] == '\0')
            continue;
        bb_table_set_number(table, row, &difference, way->most);
        bb_table_set_number(table, row, &difference_8, way->most_8);
    }
}

static uint32_t question_row(const bb_dvr_result *r, const char *question, bb_table *table)
{
    return bb_table_row(table, (bb_cell){{[BB_SCENE] = r->scene, [BB_QUESTION] = question}});
}

static void fill_accuracy(const bb_dvr_result *r, bb_table *table)
{
    for (uint32_t i = 0; i < r->error_count; i++) {
        const bb_dvr_error *error = &r->errors[i];
        char digits[BB_JSON_DIGITS], question[BB_JSON_DIGITS + 8];
        snprintf(question, sizeof question, "step %s", bb_json_digits(digits, error->step));
        const uint32_t row = question_row(r, question, table);
        bb_table_set_number(table, row, &step, error->step);
        bb_table_set_number(table, row, &largest_error, error->most);
        bb_table_set_number(table, row, &rms_error, error->rms);
        bb_table_set_number(table, row, &samples, error->samples);
        bb_table_set_rounds(table, row, &picture_ms, &error->march);
    }
}

void bb_dvr_fill(const bb_dvr_request *request, const bb_dvr_result *r, const char *files,
                 bb_table *table)
{
    const uint32_t run = bb_table_row(table, (bb_cell){{NULL}});
    const uint32_t row = bb_table_row(table, (bb_cell){{[BB_SCENE] = r->scene}});
    bb_table_set_number(table, run, &step, request->step);
    bb_table_set_number(table, run, &cutoff, request->cutoff);
    bb_table_set_text(table, row, &transfer, r->transfer);
    (r->tets > 0 ? fill_mesh : fill_volume)(r, row, table);
    bb_table_set_number(table, row, &pictures, r->pictures);
    bb_table_set_number(table, row, &pixels, (double)r->pixels);
    if (r->by_others)
        bb_table_set_text(table, row, &compared_by, "OpenImageIO");
    if (r->error_count > 0)
        bb_table_set_number(table, row, &converged, r->converged);
    fill_ways(r, table);
    fill_accuracy(r, table);
    for (uint32_t v = 0; files != NULL && v < r->view_count; v++) {
        char path[256];
        snprintf(path, sizeof path, "%.150s-%s.png", files, r->views[v]);
        bb_table_set_text(table, question_row(r, r->views[v], table), &bb_column_picture, path);
    }
}
