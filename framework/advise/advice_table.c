/* Puts an advice into a table. */
#include "framework/advise/advice.h"
#include "framework/base/shell_word.h"
#include "framework/simulate/simulated_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- of the scene ---- */

BB_EXACT(prims, "primitives", "primitives", "", "Of the scene.", NEITHER, 0);
BB_EXACT(sample_prims, "sample_primitives", "primitives of the sample", "",
         "On which kernels, intersectors and builders are tried first.", NEITHER, 0);
BB_EXACT(image_rays, "image_rays", "rays of an image", "", "Of all kinds together.", NEITHER, 0);
BB_TEXT(ray_kinds, "ray_kinds", "kinds of rays", "An image has equally many rays of each.");
BB_EXACT(limit, "max_wrong_ppm", "tolerated", "wrong rays per million", "As asked for.", NEITHER,
         -1);
BB_EXACT(slack, "slack", "slack", "", "The choice takes so many times the least time at most.",
         NEITHER, 2);
BB_EXACT(scout_slack, "scout_slack", "slack of scouts", "",
         "What takes more than so many times the least time on the sample is dropped.", NEITHER, 2);
BB_TIMED(within, "within_slack", "within the slack", "", "Contenders of the last heat.", NEITHER,
         0);
BB_TIMED(unlikely, "unlikely", "left out as foretold", "",
         "Contenders that are too slow by far, by the figures of the scouts.", NEITHER, 0);
BB_TIMED(heats, "heats", "heats", "", "Of the race; those that a contender ran in.", NEITHER, 0);
BB_TEXT(preliminary, "preliminary", "PRELIMINARY, by",
        "What was measured last when the command was interrupted.");
BB_TEXT(again, "again", "To measure the choice again", "A command line.");

/* ---- of the rows "foretold" and "taken" ---- */

BB_TIMED(seconds, "seconds", "time", "s", "Wall time.", NEITHER, 1);
BB_TIMED(host_bytes, "host_bytes", "host memory", "bytes", "At its peak.", NEITHER, 0);
BB_TIMED(device_bytes, "device_bytes", "device memory", "bytes", "At its peak.", NEITHER, 0);
BB_TIMED(held_bytes, "held_bytes", "trees and layouts", "bytes",
         "By their accounts, with scratch: the most at a time.", NEITHER, 0);

/* ---- of a decision ---- */

BB_TEXT(value, "value", "value", "What was decided.");
BB_TEXT(by, "by", "by", "default, scene, tree or given.");
BB_TEXT(figure, "figure", "because", "The figure that it rests on.");

/* ---- of a contender ---- */

BB_TEXT(state, "state", "state", "What became of it.");
BB_TEXT(pick, "pick", "pick", "chosen, fastest or least.");
BB_TEXT(reason, "reason", "more by", "Why the choice needs less.");
BB_TEXT(unfit, "unfit", "unfit", "Why it has no part in the race.");
BB_TEXT(limit_shown, "limit_shown", "limit shown",
        "yes: the 95 % interval of its wrong rays ends at the tolerated rate or below.");
BB_TEXT(against, "against", "against", "The contender that the ratio is to.");
BB_ROUNDS(ratio, "ratio", "ratio", "",
          "Of its time to that of the fastest, or of who dropped it, paired round by round.",
          NEITHER, 3);
BB_EXACT(simulated_ratio, "simt_ratio", "ratio", "",
         "Simulated: of its time to that of the fastest, or of who dropped it.", LESS, 3);
BB_EXACT(simulated_ms, "simt_image_ms", "rays", "ms",
         "Simulated: the rays of an image, each set at its bound; builds are not simulated.", LESS,
         -1);
BB_ROUNDS(image_ms, "image_ms", "image", "ms", "Build, layout and rays, in its last heat.", LESS,
          1);
BB_TIMED(build_ms, "build_ms", "build", "ms", "Median, with boxes and transfer.", LESS, 1);
BB_TIMED(layout_ms, "layout_ms", "layout", "ms", "Median.", LESS, 1);
BB_TIMED(trace_ms, "trace_ms", "rays", "ms", "Median, of all rays.", LESS, 1);
BB_EXACT(wrong, "wrong", "wrong", "", "Wrong rays.", LESS, 0);
BB_EXACT(checked, "checked", "judged", "", "Rays that were judged.", NEITHER, 0);
BB_EXACT(wrong_ppm, "wrong_ppm_at_most", "wrong at most", "ppm", "95 %.", LESS, -1);
BB_EXACT(bytes, "bytes", "memory", "bytes", "Of tree, scratch and layout.", LESS, 0);
BB_EXACT(bytes_build, "bytes_build", "tree, scratch", "bytes", "Of the build, at its peak.", LESS,
         0);
BB_EXACT(bytes_layout, "bytes_layout", "layout", "bytes", "What the kernel reads.", LESS, 0);
BB_EXACT(code_bits, "code_bits", "code bits", "", "Of the code that the builder sorts by.", NEITHER,
         0);
BB_EXACT(stack_entries, "stack_entries", "stack", "", "Entries.", NEITHER, 0);
BB_EXACT(kinds, "kinds", "kinds", "", "Of primitives, compiled in.", NEITHER, 0);

/* ---- of a saving ---- */

BB_TEXT(left_out, "left_out", "left out", "The setting that the choice does not need.");
BB_TEXT(chosen, "chosen", "chosen", "The setting of the choice.");
BB_TEXT(generous, "generous", "instead of", "The generous setting.");
BB_EXACT(bytes_more, "bytes_more", "more memory", "bytes", "Than the choice takes.", NEITHER, 0);
BB_EXACT(ray_bytes, "ray_bytes_more", "more per ray", "bytes", "Stack of each ray in flight.",
         NEITHER, 0);
BB_ROUNDS(ms_more, "ms_more", "more time", "ms", "Than the choice takes, paired round by round.",
          NEITHER, 1);

const char *const bb_fates[BB_FATES] = {
    "raced to the end", "too slow",         "too wrong", "not measured",
    "chosen",           "more than needed", "slower"};

/* The table, and what its rows are of. */
typedef struct rows {
    bb_table *table;
    const char *scene, *simulation; /* NULL: they are measured */
} rows;

/* Joins kernel and intersector, which are one name of a cell. */
static void name_pair(const char *kernel, const char *intersector, char *name, size_t capacity)
{
    snprintf(name, capacity, "%s, %s", kernel, intersector);
}

static uint32_t row_of(const rows *to, const char *question, const bb_contender *who)
{
    char pair[1200];
    bb_cell cell = {
        {[BB_SCENE] = to->scene, [BB_QUESTION] = question, [BB_MAKER] = to->simulation}};
    if (who != NULL) {
        name_pair(who->kernel, who->intersector, pair, sizeof pair);
        cell.names[BB_BUILDER] = who->builder;
        cell.names[BB_INTERSECTOR] = pair;
    }
    return bb_table_row(to->table, cell);
}

/* ---- contenders ---- */

static void put_times(bb_table *table, uint32_t row, const bb_tried_figures *f)
{
    bb_table_set_rounds(table, row, &image_ms, &f->cost);
    bb_table_set_number(table, row, &build_ms, f->build_ms);
    bb_table_set_number(table, row, &layout_ms, f->layout_ms);
    bb_table_set_number(table, row, &trace_ms, f->trace_ms);
}

static void put_bounds(bb_table *table, uint32_t row, const bb_tried_figures *f)
{
    const bb_simulation all = bb_simulated_sum(&f->simulated);
    bb_table_set_number(table, row, &simulated_ms, bb_samples_median(&f->cost));
    bb_simulated_put(table, row, &all);
}

static void put_figures(bb_table *table, uint32_t row, const bb_tried_figures *f)
{
    bb_table_set_number(table, row, &wrong, f->wrong);
    bb_table_set_number(table, row, &checked, f->checked);
    bb_table_set_number(table, row, &wrong_ppm, bb_wrong_rate_of(f->wrong, f->checked).high);
    bb_table_set_number(table, row, &bytes, f->extent.bytes);
    bb_table_set_number(table, row, &bytes_build, f->bytes_build);
    bb_table_set_number(table, row, &bytes_layout, f->bytes_layout);
    if (f->extent.code_bits > 0)
        bb_table_set_number(table, row, &code_bits, f->extent.code_bits);
    bb_table_set_number(table, row, &stack_entries, f->extent.stack);
    bb_table_set_number(table, row, &kinds, f->extent.kinds);
}

/* The picks of a list; BB_NONE_CHOSEN: none. */
typedef struct picked {
    uint32_t choice, best, least;
} picked;

static void put_pick(bb_table *table, uint32_t row, const picked *p, uint32_t i)
{
    const uint32_t who[] = {p->choice, p->best, p->least};
    static const char *const words[] = {"chosen", "fastest", "least"};
    char text[32] = "";
    for (size_t k = 0; k < 3; k++)
        if (who[k] == i)
            snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s",
                     text[0] != '\0' ? ", " : "", words[k]);
    bb_table_set_text(table, row, &pick, text);
}

/* Puts the contender's state, and why it is not the choice. */
static void put_fate(const rows *to, uint32_t row, const bb_entered *field, uint32_t i,
                     const picked *p)
{
    bb_table *table = to->table;
    const bb_racer *racer = &field->racers[i];
    const bool raced = racer->state == BB_RACING && p->best != BB_NONE_CHOSEN;
    const uint32_t whom = raced ? p->best : racer->behind;
    const bb_samples ratios =
        raced ? bb_samples_ratio(&racer->cost, &field->racers[whom].cost) : racer->ratio;
    uint32_t fate = racer->state;
    if (i == p->choice)
        fate = BB_CHOSEN;
    else if (raced)
        fate = bb_samples_median(&ratios) <= BB_ADVISE_SLACK ? BB_MORE_THAN_NEEDED : BB_SLOWER;
    bb_table_set_text(table, row, &state, bb_fates[fate]);
    if (fate == BB_MORE_THAN_NEEDED && p->choice != BB_NONE_CHOSEN)
        bb_table_set_text(
            table, row, &reason,
            bb_extent_reason(&field->figures[p->choice].extent, &field->figures[i].extent));
    if (fate == BB_WAS_NOT_RUN || fate == BB_WAS_WRONG)
        bb_table_set_text(table, row, &unfit,
                          fate == BB_WAS_WRONG ? "wrong too often" : field->figures[i].reason);
    if (racer->heats > 0)
        bb_table_set_number(table, row, &heats, racer->heats);
    if (to->simulation != NULL)
        bb_table_set_number(table, row, &simulated_ratio, bb_samples_median(&ratios));
    else
        bb_table_set_rounds(table, row, &ratio, &ratios);
    if (whom < field->count) {
        char text[1800];
        const bb_contender *other = &field->who[whom];
        snprintf(text, sizeof text, "%s, %s, %s", other->builder, other->kernel,
                 other->intersector);
        bb_table_set_text(table, row, &against, text);
    }
}

static void put_field(const rows *to, const char *question, const bb_entered *field, picked p)
{
    for (uint32_t i = 0; i < field->count; i++) {
        const bb_tried_figures *f = &field->figures[i];
        const uint32_t row = row_of(to, question, &field->who[i]);
        put_fate(to, row, field, i, &p);
        put_pick(to->table, row, &p, i);
        if (!f->measured)
            continue;
        put_figures(to->table, row, f);
        (to->simulation != NULL ? put_bounds : put_times)(to->table, row, f);
    }
}

/* ---- decisions ---- */

/* Puts the decisions of the configuration `who`; NULL: of the scene. */
static void put_decisions(const rows *to, const bb_contender *who, const bb_entry *entry,
                          bb_field_id field)
{
    bb_each_part(one, entry, field)
    {
        const uint32_t row = row_of(to, bb_part_name(one), who);
        bb_table_set_text(to->table, row, &value, bb_get_text(one, field));
        bb_table_set_text(to->table, row, &by, bb_get_text(one, BB_F_DECIDED_BY));
        bb_table_set_text(to->table, row, &figure, bb_get_text(one, BB_F_DECIDED_FIGURE));
    }
}

/* ---- the choice ---- */

static void print_command(const bb_advise_request *r, const bb_contender *who, const char *metric,
                          FILE *out)
{
    const char *const words[][2] = {{"--scene", r->scene},
                                    {"--builder", who->builder},
                                    {"--kernel", who->kernel},
                                    {"--intersector", who->intersector}};
    fputs("bvhbench run", out);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        fprintf(out, " %s ", words[i][0]);
        bb_put_shell_word(out, words[i][1]);
    }
    for (uint32_t i = 0; i < r->ray_count; i++) {
        fputs(i > 0 ? "," : " --rays ", out);
        bb_put_shell_word(out, r->rays[i]);
    }
    fputs(r->further, out);
    if (metric != NULL) {
        fputs(" --metrics ", out);
        bb_put_shell_word(out, metric);
    }
}

/* Puts the command that measures a choice again, or simulates it as `metric` says. */
static bb_status put_command(const rows *to, const bb_advise_request *r, const bb_contender *who,
                             const char *metric)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (out != NULL)
        print_command(r, who, metric, out);
    const bool printed = out != NULL && fclose(out) == 0;
    if (printed)
        bb_table_set_text(to->table, row_of(to, "again", NULL), &again, text);
    free(text);
    return printed ? BB_OK : bb_fail(BB_REFUSED, "advise: no memory");
}

static bb_status put_choice(const rows *to, const bb_advice *a)
{
    const bb_contender *who = &a->field.who[a->choice];
    const bb_tried_figures *f = &a->field.figures[a->choice];
    const double at_most = bb_wrong_rate_of(f->wrong, f->checked).high;
    bb_table_set_text(to->table, row_of(to, "race", who), &limit_shown,
                      at_most <= a->request->max_wrong_ppm ? "yes" : "no");
    put_decisions(to, who, f->build, BB_F_BUILD_DECISIONS);
    put_decisions(to, who, f->trace, BB_F_TRACE_DECISIONS);
    return put_command(to, a->request, who, NULL);
}

/* Puts what a simulation found, in rows of its own. */
static bb_status put_simulated(const bb_advice *a, uint32_t i, bb_table *table)
{
    const bb_simulated_advice *s = &a->simulated[i];
    const rows to = {table, a->request->scene, s->name};
    const picked nobody = {BB_NONE_CHOSEN, BB_NONE_CHOSEN, BB_NONE_CHOSEN};
    put_field(&to, BB_BY_SIMULATION, &s->field, (picked){s->choice, s->best, BB_NONE_CHOSEN});
    put_field(&to, "kernels, simulated", &s->kernels, nobody);
    put_field(&to, "builders, simulated", &s->builders, nobody);
    return s->choice == BB_NONE_CHOSEN
               ? BB_OK
               : put_command(&to, a->request, &s->field.who[s->choice], a->request->metrics[i]);
}

static void put_savings(const rows *to, const bb_advice *a)
{
    for (uint32_t i = 0; i < a->saving_count; i++) {
        const bb_saving *s = &a->savings[i];
        const bb_contender who = {s->builder, s->kernel, s->intersector};
        const char *question = strcmp(s->what, BB_EXACTNESS) == 0 ? BB_EXACTNESS : "savings";
        const uint32_t row = row_of(to, question, &who);
        bb_table_set_text(to->table, row, &left_out, s->what);
        bb_table_set_text(to->table, row, &unfit, s->reason);
        if (!s->measured)
            continue;
        bb_table_set_text(to->table, row, &chosen, s->was);
        bb_table_set_text(to->table, row, &generous, s->kept);
        bb_table_set_number(to->table, row, &wrong, s->wrong);
        bb_table_set_number(to->table, row, &checked, s->checked);
        bb_table_set_number(to->table, row, &bytes_more, s->bytes);
        bb_table_set_rounds(to->table, row, &ms_more, &s->ms);
        if (strcmp(s->what, "stack") == 0)
            bb_table_set_number(to->table, row, &ray_bytes, 8 * (atof(s->kept) - atof(s->was)));
    }
}

/* ---- all of it ---- */

static void put_takings(const rows *to, const char *question, const bb_takings *t)
{
    const uint32_t row = row_of(to, question, NULL);
    bb_table_set_number(to->table, row, &seconds, t->seconds);
    bb_table_set_number(to->table, row, &host_bytes, t->host_bytes);
    bb_table_set_number(to->table, row, &device_bytes, t->device_bytes);
    bb_table_set_number(to->table, row, &held_bytes, t->held_bytes);
}

static void put_scene(const rows *to, const bb_advice *a)
{
    const bb_advise_request *r = a->request;
    const double count = a->whole.scene->prim_count;
    const uint32_t row = row_of(to, NULL, NULL);
    char kinds_asked[1024] = "";
    for (uint32_t i = 0; i < r->ray_count; i++)
        snprintf(kinds_asked + strlen(kinds_asked), sizeof kinds_asked - strlen(kinds_asked),
                 "%s%s", i > 0 ? ", " : "", r->rays[i]);
    bb_table_set_number(to->table, row, &prims, count);
    bb_table_set_number(to->table, row, &image_rays, r->image_rays);
    bb_table_set_text(to->table, row, &ray_kinds, kinds_asked);
    bb_table_set_number(to->table, row, &limit, r->max_wrong_ppm);
    bb_table_set_number(to->table, row, &slack, BB_ADVISE_SLACK);
    bb_table_set_number(to->table, row, &sample_prims, round(count / a->sample.factor));
    bb_table_set_number(to->table, row, &scout_slack, a->scout_slack);
    bb_table_set_number(to->table, row, &unlikely, a->unlikely);
    bb_table_set_number(to->table, row, &heats, a->heats);
    if (a->choice != BB_NONE_CHOSEN)
        bb_table_set_number(to->table, row, &within, a->within);
    bb_table_set_text(to->table, row, &preliminary, a->preliminary);
}

bb_status bb_advice_fill(const bb_advice *a, bb_table *table)
{
    const rows to = {table, a->request->scene, NULL};
    const picked nobody = {BB_NONE_CHOSEN, BB_NONE_CHOSEN, BB_NONE_CHOSEN};
    put_scene(&to, a);
    put_decisions(&to, NULL, a->scene, BB_F_SCENE_DECISIONS);
    put_field(&to, "race", &a->field, (picked){a->choice, a->best, BB_NONE_CHOSEN});
    put_field(&to, "exhaustive search", &a->all,
              (picked){a->all_choice, a->all_best, a->all_least});
    put_field(&to, "kernels, intersectors", &a->scouts, nobody);
    put_field(&to, "builders", &a->builders, nobody);
    put_savings(&to, a);
    put_takings(&to, "foretold", &a->foretold);
    put_takings(&to, "taken", &a->taken);
    if (a->choice != BB_NONE_CHOSEN)
        BB_TRY(put_choice(&to, a));
    for (uint32_t i = 0; i < a->simulated_count; i++)
        BB_TRY(put_simulated(a, i, table));
    return bb_table_status(table);
}
