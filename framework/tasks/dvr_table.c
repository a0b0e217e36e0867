/* A comparison as rows of a table, and what its page shows. */
#include "framework/base/json.h"
#include "framework/tasks/dvr_private.h"
#include "framework/tasks/mesh_row.h"

#include <stdio.h>

/* Of the run; the step of a row of accuracy, too. */
BB_EXACT(step, "step", "step", "", "Distance of samples, by the step's unit.", NEITHER, -1);
BB_EXACT(cutoff, "cutoff", "cutoff", "", "A ray ends where less light than this is left.", NEITHER,
         -1);

/* Of a scene. */
BB_TEXT(transfer, "transfer", "transfer function", "Its name.");
BB_TEXT(voxels, "voxels", "voxels", "Along each axis.");
BB_EXACT(bits, "bits", "bits", "", "Of a voxel.", NEITHER, 0);
BB_EXACT(side, "brick_side", "brick side", "", "In cells.", NEITHER, 0);
BB_EXACT(bricks, "bricks", "bricks", "", "Of the volume.", NEITHER, 0);
BB_EXACT(seen, "bricks_seen", "bricks seen", "", "Through the transfer function.", NEITHER, 0);
BB_EXACT(seen_part, "bricks_seen_percent", "seen", "%", "Of all bricks.", NEITHER, 2);
BB_EXACT(volume_bytes, "volume_bytes", "all bricks", "bytes", "Of all bricks.", NEITHER, 0);
BB_ROUNDS(copy, "copy_ms", "a copy of all bricks", "ms", "From one buffer to another.", LESS, 3);
BB_TIMED(copy_rate, "copy_gb_per_s", "copied at", "GB/s", "All bricks by the time of their copy.",
         MORE, 1);
BB_EXACT(vertices, "vertices", "vertices", "", "Of the mesh.", NEITHER, 0);
BB_TEXT(unit, "step_unit", "unit of steps", "What a step of 1 is.");
BB_EXACT(pictures, "pictures", "pictures", "", "Of each way.", NEITHER, 0);
BB_EXACT(pixels, "pixels", "pixels", "", "Of all pictures.", NEITHER, 0);
BB_TEXT(compared_by, "compared_by", "compared by", "The program that compared as well.");
BB_EXACT(converged, "converged_to", "converged to", "",
         "How far twice the reference's step is from it.", NEITHER, -1);

/* Of a step: the accuracy. */
BB_EXACT(largest_error, "largest_error", "largest error", "", "Of a channel in all pictures.", LESS,
         -1);
BB_EXACT(rms_error, "rms_error", "RMS error", "", "Over all channels and pictures.", LESS, -1);
BB_EXACT(samples, "samples_per_ray", "samples", "", "Per ray.", NEITHER, 1);
BB_ROUNDS(picture_ms, "picture_ms", "last picture", "ms", "By the first builder and kernel.", LESS,
          2);

#define OUTLINE .command = "volume", .title = "bvhbench: pictures of volumes"

const bb_page_outline bb_dvr_outline = {
    OUTLINE,
    BB_CONTEST_OUTLINE(BB_CONTEST_VIEWS),
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
    BB_CONTEST_OUTLINE(BB_CONTEST_VIEWS_BRIEF),
};

/* ---- rows ---- */

static void fill_volume(const bb_dvr *dvr, uint32_t row, bb_table *table)
{
    char size[64];
    const bb_volume *volume = dvr->scene->volume;
    const uint32_t *cells = volume->grid.cells;
    const double all_bytes = (double)bb_volume_bytes(volume);
    snprintf(size, sizeof size, "%u x %u x %u", cells[0] + 1, cells[1] + 1, cells[2] + 1);
    bb_table_set_text(table, row, &transfer, volume->transfer.name);
    bb_table_set_text(table, row, &voxels, size);
    bb_table_set_number(table, row, &bits, 8 * volume->bytes);
    bb_table_set_number(table, row, &side, volume->grid.side);
    bb_table_set_number(table, row, &bricks, volume->brick_count);
    bb_table_set_number(table, row, &seen, dvr->scene->prim_count);
    bb_table_set_number(table, row, &seen_part,
                        100.0 * dvr->scene->prim_count / volume->brick_count);
    bb_table_set_number(table, row, &volume_bytes, all_bytes);
    bb_table_set_rounds(table, row, &copy, &dvr->copy_ms);
    if (dvr->copy_ms.count > 0)
        bb_table_set_number(table, row, &copy_rate,
                            all_bytes / 1e6 / bb_samples_median(&dvr->copy_ms));
    bb_table_set_text(table, row, &unit, "a voxel");
}

static void fill_mesh(const bb_dvr *dvr, uint32_t row, bb_table *table)
{
    bb_table_set_text(table, row, &transfer, dvr->request->transfer->name);
    bb_mesh_fill(table, row, dvr->scene);
    bb_table_set_number(table, row, &vertices, dvr->scene->vertex_count);
    bb_table_set_text(table, row, &unit, "1/128 of the longest side");
}

void bb_dvr_fill(void *self, bb_table *table, uint32_t row)
{
    const bb_dvr *dvr = self;
    const uint32_t run = bb_table_row(table, (bb_cell){{NULL}});
    bb_table_set_number(table, run, &step, dvr->request->step);
    bb_table_set_number(table, run, &cutoff, dvr->request->cutoff);
    (dvr->scene->volume == NULL ? fill_mesh : fill_volume)(dvr, row, table);
    bb_table_set_number(table, row, &pictures, dvr->task.questions);
    bb_table_set_number(table, row, &pixels, (double)dvr->task.questions * dvr->pixels);
    if (dvr->by_others)
        bb_table_set_text(table, row, &compared_by, "OpenImageIO");
    if (dvr->error_count > 0)
        bb_table_set_number(table, row, &converged, dvr->converged);
}

void bb_dvr_fill_questions(const bb_dvr *dvr, bb_table *table)
{
    const bb_contest_request *request = &dvr->request->contest;
    const uint32_t views = dvr->request->turns > 0 ? 0 : dvr->task.questions;
    for (uint32_t i = 0; i < dvr->error_count; i++) {
        const bb_dvr_error *error = &dvr->errors[i];
        char digits[BB_JSON_DIGITS], question[BB_JSON_DIGITS + 8];
        snprintf(question, sizeof question, "step %s", bb_json_digits(digits, error->step));
        const uint32_t row = bb_contest_scene_row(table, request->name, question);
        bb_table_set_number(table, row, &step, error->step);
        bb_table_set_number(table, row, &largest_error, error->most);
        bb_table_set_number(table, row, &rms_error, error->rms);
        bb_table_set_number(table, row, &samples, error->samples);
        if (error->march.count > 1) /* else it was interrupted before a round that counts */
            bb_table_set_rounds(table, row, &picture_ms, &error->march);
    }
    for (uint32_t v = 0; request->pictures != NULL && v < views; v++) {
        char path[256];
        snprintf(path, sizeof path, "%.150s-%s.png", request->files, dvr->views[v].name);
        const uint32_t row = bb_contest_scene_row(table, request->name, dvr->views[v].name);
        bb_table_set_text(table, row, &bb_column_picture, path);
    }
}
