/* An animation as rows of a table: README.md has them. */
#include "framework/tasks/animate.h"

#include "framework/bench/contest_table.h"
#include "framework/simulate/simulated_table.h"
#include "framework/table/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- columns ---- */

/* Of a scene; of these `rays` of a frame, too. */
BB_TEXT(view, "camera", "view", "Which rays start from.");
BB_TEXT(test, "intersector_used", "intersection tests", "By name.");
BB_EXACT(first, "first_frame", "first frame", "", "Whose trees are built, for all alike.", NEITHER,
         0);
BB_EXACT(last, "last_frame", "last frame", "", "That was gone through.", NEITHER, 0);
BB_EXACT(ignored, "ignored", "parts of the file that were ignored", "",
         "Points, lines, channels that move nothing known.", NEITHER, 0);
BB_EXACT(resized, "frames_resized", "frames with more or fewer primitives than before", "",
         "Their number.", NEITHER, 0);
BB_TEXT(rebuilder, "faster_than", "faster: than",
        "The first method that builds each frame anew, if anything moves.");
BB_TIMED(seconds, "seconds", "took", "s", "Everything, also what is not measured.", LESS, 1);

/* Of a frame; of a scene, means. */
BB_EXACT(prims, "primitives", "primitives", "", "Of the scene.", NEITHER, 0);
BB_EXACT(moved, "moved_percent", "primitives that move", "%",
         "Of all: their boxes are others than in the frame before.", NEITHER, 1);
BB_EXACT(moved_by, "moved_by", "by", "diagonals of the scene",
         "The median way of the middles of boxes that move.", NEITHER, -1);
BB_EXACT(rays, "rays", "rays", "", "Of the frame; 0: the scene has none there.", NEITHER, 0);
BB_EXACT(fresh, "sah_fresh", "SAH", "", "Of the tree that this builder makes for the frame.",
         NEITHER, 2);
BB_EXACT(fresh_best, "sah_fresh_best", "best SAH", "", "The least of trees made for the frame.",
         NEITHER, 2);
BB_TIMED(oracle, "oracle_ms", "oracle", "ms", "Making what judges the answers.", NEITHER, 1);
BB_TIMED(judge, "judge_ms", "right answers", "ms", "Finding them.", NEITHER, 1);

/* Of a method in a frame; of a method, means over all frames but the first. */
BB_ROUNDS(build, "build_ms", "build", "ms", "Building the tree of the first frame.", LESS, 3);
BB_ROUNDS(update, "update_ms", "update", "ms", "The tree's, or building it anew.", LESS, 3);
BB_ROUNDS(update_cpu, "update_cpu_ms", "update CPU", "ms", "Processor time of an update.", LESS, 3);
BB_ROUNDS(transfer, "transfer_ms", "transfer", "ms", "Of a tree from the host to the device.", LESS,
          3);
BB_TEXT(way, "way", "tree", "kept, updated or rebuilt.");
BB_EXACT(sah, "tree_sah", "SAH", "", "Surface area heuristic of the tree.", LESS, 2);
BB_EXACT(over_best, "sah_over_best", "SAH / fresh", "",
         "Over the least of trees made for the same frame.", LESS, 3);
BB_EXACT(depth, "depth", "depth", "", "Of the tree.", LESS, 0);
BB_EXACT(events, "events", "events", "", "That the builder counted.", NEITHER, 0);
BB_ROUNDS(layout, "layout_ms", "layout", "ms", "Making or following it.", LESS, 3);
BB_EXACT(in_place, "in_place", "in place", "",
         "Frames whose layout followed without being numbered anew.", NEITHER, 0);
BB_EXACT(wrong, "wrong", "wrong", "", "Answers in the frame.", LESS, 0);
BB_ROUNDS(trace, "trace_ms", "tracing", "ms", "All rays of a frame.", LESS, 3);

/* Of a method alone. */
BB_TIMED(worst_ms, "worst_update_ms", "worst update", "ms", "Of all frames.", LESS, 3);
BB_TIMED(worst_frame, "worst_frame", "in frame", "", "Whose update was the worst.", NEITHER, 0);
BB_EXACT(over_best_most, "sah_over_best_most", "most", "", "SAH / fresh in the worst frame.", LESS,
         3);
BB_EXACT(over_fresh_most, "sah_over_fresh_most", "most SAH / fresh", "",
         "Over this builder's trees, in the worst frame.", LESS, 3);
BB_EXACT(drift, "drift_per_frame", "drift", "", "Slope of SAH / fresh, per frame.", NEITHER, 4);
static const bb_column ways[] = {
    [BB_KEPT] = BB_EXACT_COLUMN("frames_kept", "kept", "", "Frames.", NEITHER, 0),
    [BB_UPDATED] = BB_EXACT_COLUMN("frames_updated", "updated", "", "Frames.", NEITHER, 0),
    [BB_REBUILT] = BB_EXACT_COLUMN("frames_rebuilt", "rebuilt", "", "Frames.", NEITHER, 0),
};
BB_EXACT(answers, "answers", "answers", "", "That were judged, in all frames.", NEITHER, 0);
BB_EXACT(all_wrong, "wrong_answers", "wrong", "", "In all frames.", NEITHER, 0);
BB_TIMED(speed, "mrays_per_s", "M/s", "",
         "Millions of rays per second, over all frames but the first.", MORE, 3);

/* Of a frame with so many rays of a kind. */
BB_TIMED(frame_ms, "frame_ms", "frame", "ms",
         "Update, transfer, layout and tracing, by the method's best kernel.", LESS, 3);
BB_TIMED(least_ms, "least_frame_ms", "frame", "ms", "By the fastest method and kernel.", LESS, 3);
BB_TEXT(winner, "fastest", "fastest", "Method and kernel.");
BB_TEXT(as_fast, "as_fast", "as fast", "Methods that the fastest is not faster than.");
BB_TEXT(faster_for, "faster_for", "faster for",
        "Rays per frame: see \"faster_than\" of the scene.");

/* ---- rounds ---- */

/* Those that count, after the judged one. Rounds that a method did not get to are left out. */
static bb_samples samples_of(const bb_animate_result *r, const bb_rounds from)
{
    bb_samples samples = {.count = 0};
    for (uint32_t i = 0; i <= r->rounds && isfinite(from[i]); i++)
        bb_samples_add(&samples, from[i]);
    samples.count = samples.count > 1 ? samples.count : 0;
    return samples;
}

static void put(bb_table *table, uint32_t row, const bb_column *column, const bb_animate_result *r,
                const bb_rounds from)
{
    const bb_samples samples = samples_of(r, from);
    bb_table_set_rounds(table, row, column, &samples);
}

/* ---- what all methods share ---- */

/* The row of a cell of the scene; NULL: it has no such name. */
static uint32_t row_of(const bb_animate_result *r, bb_table *table, const char *frame,
                       const char *question, const char *builder, const char *maker,
                       const char *kernel)
{
    return bb_table_row(table, (bb_cell){{[BB_SCENE] = r->scene,
                                          [BB_FRAME] = frame,
                                          [BB_QUESTION] = question,
                                          [BB_BUILDER] = builder,
                                          [BB_MAKER] = maker,
                                          [BB_INTERSECTOR] = kernel}});
}

typedef char name[32];

static const char *name_frame(const bb_animate_result *r, uint32_t f, name out)
{
    snprintf(out, sizeof(name), "%u", r->states[f].frame);
    return out;
}

static void fill_frames(const bb_animate_result *r, bb_table *table)
{
    for (uint32_t f = 0; f < r->frame_count; f++) {
        const bb_animate_state *state = &r->states[f];
        name frame;
        name_frame(r, f, frame);
        const uint32_t row = row_of(r, table, frame, NULL, NULL, NULL, NULL);
        bb_table_set_number(table, row, &prims, state->prims);
        bb_table_set_number(table, row, &moved, 100 * state->moved);
        bb_table_set_number(table, row, &moved_by, state->moved_by);
        bb_table_set_number(table, row, &fresh_best, state->fresh_best);
        bb_table_set_number(table, row, &oracle, state->oracle_ms);
        bb_table_set_number(table, row, &judge, state->judge_ms);
        for (uint32_t i = 0; i < r->ray_count; i++)
            bb_table_set_number(table, row_of(r, table, frame, r->rays[i], NULL, NULL, NULL), &rays,
                                state->rays[i]);
        for (uint32_t i = 0; i < r->yardstick_count; i++)
            bb_table_set_number(table, row_of(r, table, frame, NULL, NULL, r->yardsticks[i], NULL),
                                &fresh, state->fresh[i]);
    }
}

/* What the scene is like, which decides over methods more than its size. */
static void fill_motion(const bb_animate_result *r, uint32_t row, bb_table *table)
{
    double share = 0, by = 0;
    uint32_t count = 0;
    for (uint32_t f = 1; f < r->frame_count; f++)
        if (!isnan(r->states[f].moved)) {
            share += r->states[f].moved;
            by += r->states[f].moved_by;
            count++;
        }
    bb_table_set_number(table, row, &moved, 100 * share / count);
    bb_table_set_number(table, row, &moved_by, by / count);
    if (count + 1 < r->frame_count)
        bb_table_set_number(table, row, &resized, r->frame_count - 1 - count);
}

static void fill_scene(const bb_animate_result *r, uint32_t row, bb_table *table)
{
    const bb_animate_method *with = bb_animate_rebuilder(r);
    uint64_t checked = 0;
    for (uint32_t m = 0; m < r->method_count; m++)
        checked += bb_animate_sum(r, &r->methods[m]).checked;
    bb_table_set_number(table, row, &first, r->states[0].frame);
    bb_table_set_number(table, row, &last, r->states[r->frame_count - 1].frame);
    bb_table_set_number(table, row, &prims, r->states[0].prims);
    fill_motion(r, row, table);
    if (r->ignored > 0)
        bb_table_set_number(table, row, &ignored, r->ignored);
    bb_table_set_text(table, row, &view, r->view);
    bb_table_set_text(table, row, &test, r->intersector);
    bb_table_set_number(table, row, &bb_column_rounds, r->rounds);
    bb_table_set_number(table, row, &answers, (double)checked);
    bb_table_set_number(table, row, &all_wrong, (double)bb_animate_wrong(r));
    bb_table_set_text(table, row, &rebuilder, with != NULL ? with->builder : "");
    bb_table_set_number(table, row, &seconds, r->ms / 1e3);
}

/* ---- methods ---- */

static void fill_kernels(const bb_animate_result *r, const bb_animate_method *method, uint32_t f,
                         const char *frame, bb_table *table)
{
    for (uint32_t k = 0; k < r->kernel_count; k++) {
        const bb_animate_trace *of = &method->frames[f].traces[k];
        const uint32_t row = row_of(r, table, frame, NULL, method->builder, NULL, r->kernels[k]);
        put(table, row, &layout, r, of->layout);
        bb_table_set_number(table, row, &in_place, of->in_place);
        bb_table_set_number(table, row, &wrong, (double)of->wrong);
        for (uint32_t i = 0; i < r->ray_count; i++)
            if (r->states[f].rays[i] > 0)
                put(table,
                    row_of(r, table, frame, r->rays[i], method->builder, NULL, r->kernels[k]),
                    &trace, r, of->rays[i]);
    }
}

/* In rows of their own, which have nothing that was measured. */
static void fill_simulations(const bb_animate_result *r, const bb_animate_method *method,
                             uint32_t f, const char *frame, uint32_t i, bb_table *table)
{
    for (uint32_t k = 0; k < r->kernel_count; k++)
        for (uint32_t set = 0; set < r->ray_count; set++) {
            const bb_simulation *s = bb_animate_simulation(r, method, f, k, set, i);
            if (s != NULL)
                bb_simulated_put(table,
                                 row_of(r, table, frame, r->rays[set], method->builder,
                                        r->simulations[i], r->kernels[k]),
                                 s);
        }
}

static void fill_unsimulated(const bb_animate_result *r, const bb_animate_method *method,
                             bb_table *table)
{
    for (uint32_t k = 0; k < r->kernel_count; k++)
        for (uint32_t i = 0; i < r->simulation_count && method->unsimulated[k][0] != '\0'; i++)
            bb_simulated_put_none(
                table,
                row_of(r, table, NULL, NULL, method->builder, r->simulations[i], r->kernels[k]),
                method->unsimulated[k]);
}

static void fill_frame(const bb_animate_result *r, const bb_animate_method *method, uint32_t f,
                       bb_table *table)
{
    const bb_animate_frame *of = &method->frames[f];
    name frame;
    name_frame(r, f, frame);
    const uint32_t row = row_of(r, table, frame, NULL, method->builder, NULL, NULL);
    put(table, row, f == 0 ? &build : &update, r, of->update);
    put(table, row, &update_cpu, r, of->update_cpu);
    put(table, row, &transfer, r, of->transfer);
    bb_table_set_text(table, row, &way, bb_update_word(of->way));
    bb_table_set_number(table, row, &sah, of->sah);
    bb_table_set_number(table, row, &over_best, of->sah / r->states[f].fresh_best);
    bb_table_set_number(table, row, &bb_column_nodes, of->tree.node_count);
    bb_table_set_number(table, row, &depth, of->tree.depth);
    bb_table_set_number(table, row, &bb_column_tree_bytes, (double)of->tree_bytes);
    for (uint32_t p = 0; p < of->phase_count; p++)
        put(table, row_of(r, table, frame, NULL, method->builder, of->phases[p], NULL),
            &bb_column_phase, r, of->phase_ms[p]);
    for (uint32_t e = 0; e < of->event_count; e++)
        bb_table_set_number(table,
                            row_of(r, table, frame, NULL, method->builder, of->events[e], NULL),
                            &events, (double)of->event_numbers[e]);
    fill_kernels(r, method, f, frame, table);
    for (uint32_t i = 0; i < r->simulation_count; i++)
        fill_simulations(r, method, f, frame, i, table);
}

static void fill_kernel_means(const bb_animate_result *r, const bb_animate_method *method,
                              const bb_animate_sums *sums, bb_table *table)
{
    for (uint32_t k = 0; k < r->kernel_count; k++) {
        const uint32_t row = row_of(r, table, NULL, NULL, method->builder, NULL, r->kernels[k]);
        put(table, row, &layout, r, sums->layout[k]);
        bb_table_set_number(table, row, &in_place, sums->in_place[k]);
        bb_table_set_number(table, row, &all_wrong, (double)sums->kernel_wrong[k]);
        for (uint32_t i = 0; i < r->ray_count; i++) {
            const uint32_t set =
                row_of(r, table, NULL, r->rays[i], method->builder, NULL, r->kernels[k]);
            put(table, set, &trace, r, sums->traces[k][i]);
            bb_table_set_number(table, set, &speed,
                                sums->rays[i] / bb_animate_median(r, sums->traces[k][i]) / 1e3);
        }
    }
}

static void fill_sums(const bb_animate_result *r, const bb_animate_method *method, uint32_t row,
                      const bb_animate_sums *sums, bb_table *table)
{
    bb_table_set_number(table, row, &worst_ms, sums->worst_update);
    bb_table_set_number(table, row, &worst_frame, sums->worst_frame);
    bb_table_set_number(table, row, &over_best, sums->sah_mean);
    bb_table_set_number(table, row, &over_best_most, sums->sah_most);
    bb_table_set_number(table, row, &drift, sums->drift);
    for (int i = BB_KEPT; i <= BB_REBUILT; i++)
        bb_table_set_number(table, row, &ways[i], sums->ways[i]);
    for (uint32_t i = 0; i < r->yardstick_count; i++)
        bb_table_set_number(table,
                            row_of(r, table, NULL, NULL, method->builder, r->yardsticks[i], NULL),
                            &over_fresh_most, sums->fresh_most[i]);
}

static void fill_method(const bb_animate_result *r, const bb_animate_method *method,
                        bb_table *table)
{
    const bb_animate_sums sums = bb_animate_sum(r, method);
    const uint32_t row = row_of(r, table, NULL, NULL, method->builder, NULL, NULL);
    for (uint32_t f = 0; f < method->done; f++)
        fill_frame(r, method, f, table);
    put(table, row, &update, r, sums.update);
    put(table, row, &update_cpu, r, sums.update_cpu);
    put(table, row, &transfer, r, sums.transfer);
    fill_unsimulated(r, method, table);
    if (sums.frames > 0) {
        fill_sums(r, method, row, &sums, table);
        fill_kernel_means(r, method, &sums, table);
    }
    bb_table_set_number(table, row, &bb_column_bytes, (double)method->most_bytes);
    bb_table_set_number(table, row, &answers, (double)sums.checked);
    bb_table_set_number(table, row, &all_wrong, (double)sums.wrong);
    bb_table_set_text(table, row, &bb_column_refused, method->refused);
    if (method->refused[0] != '\0')
        bb_table_set_text(table, row, &bb_column_status, method->failed ? "failed" : "refused");
}

/* ---- who is fastest ---- */

static void fill_winner(const bb_animate_result *r, uint32_t set, double count, const char *frame,
                        bb_table *table)
{
    const uint32_t w = bb_animate_winner(r, set, count);
    uint32_t kernel = 0;
    char text[256], others[BB_ANIMATE_METHODS_MAX * 130] = "";
    size_t used = 0;
    if (w == BB_NONE)
        return;
    const uint32_t row = row_of(r, table, frame, r->rays[set], NULL, NULL, NULL);
    bb_table_set_number(table, row, &least_ms,
                        bb_animate_frame_ms(r, &r->methods[w], set, count, &kernel));
    snprintf(text, sizeof text, "%s, %s", r->methods[w].builder, r->kernels[kernel]);
    bb_table_set_text(table, row, &winner, text);
    for (uint32_t m = 0; m < r->method_count; m++)
        if (bb_animate_ties(r, w, m, set, count))
            used += (size_t)snprintf(others + used, sizeof others - used, "%s%s",
                                     used > 0 ? ", " : "", r->methods[m].builder);
    bb_table_set_text(table, row, &as_fast, others);
}

/* From 1e5 to 1e9 rays, three in each power of ten. */
static void fill_counts(const bb_animate_result *r, uint32_t set, bb_table *table)
{
    static const int steps[] = {1, 2, 5};
    for (int i = 0; i <= 12; i++) {
        const double count = steps[i % 3] * pow(10, 5 + i / 3);
        name frame;
        snprintf(frame, sizeof frame, "%de%d rays", steps[i % 3], 5 + i / 3);
        if (i % 3 == 0)
            fill_winner(r, set, count, frame, table);
        for (uint32_t m = 0; m < r->method_count; m++) {
            const char *method = r->methods[m].builder;
            const double ms = bb_animate_frame_ms(r, &r->methods[m], set, count, NULL);
            if (isfinite(ms))
                bb_table_set_number(table,
                                    row_of(r, table, frame, r->rays[set], method, NULL, NULL),
                                    &frame_ms, ms);
        }
    }
}

/* "below 2e5 and above 1e7"; from malloc, NULL without memory. */
static char *words_of(const bb_animate_interval *intervals, uint32_t count)
{
    char *text = NULL, from[BB_FIGURE_MAX], to[BB_FIGURE_MAX];
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        return NULL;
    fputs(count == 0 ? "none" : "", out);
    for (uint32_t i = 0; i < count; i++) {
        bb_figure(from, intervals[i].from, -1);
        bb_figure(to, intervals[i].to, -1);
        fputs(i > 0 ? " and " : "", out);
        if (intervals[i].from > 0 && isfinite(intervals[i].to))
            fprintf(out, "%s to %s", from, to);
        else if (intervals[i].from > 0)
            fprintf(out, "above %s", from);
        else
            fprintf(out, "%s%s", isinf(intervals[i].to) ? "any number" : "below ",
                    isinf(intervals[i].to) ? "" : to);
    }
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}

static void fill_faster(const bb_animate_result *r, uint32_t set, bb_table *table)
{
    const bb_animate_method *with = bb_animate_rebuilder(r);
    for (uint32_t m = 0; m < r->method_count && with != NULL; m++) {
        const bb_animate_method *method = &r->methods[m];
        bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX];
        if (method == with || method->done < 2)
            continue;
        char *words = words_of(intervals, bb_animate_faster(r, method, with, set, intervals));
        bb_table_set_text(table, row_of(r, table, NULL, r->rays[set], method->builder, NULL, NULL),
                          &faster_for, words);
        free(words);
    }
}

void bb_animate_fill(const bb_animate_result *r, const char *strip, bb_table *table)
{
    const uint32_t row = row_of(r, table, NULL, NULL, NULL, NULL, NULL);
    fill_scene(r, row, table);
    if (strip != NULL)
        bb_table_set_text(table, row_of(r, table, NULL, "frames", NULL, NULL, NULL),
                          &bb_column_picture, strip);
    fill_frames(r, table);
    for (uint32_t m = 0; m < r->method_count; m++)
        fill_method(r, &r->methods[m], table);
    for (uint32_t i = 0; i < r->ray_count; i++) {
        fill_counts(r, i, table);
        fill_faster(r, i, table);
    }
}
