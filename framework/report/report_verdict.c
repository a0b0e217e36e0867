/* The answer: builders by merit over all scenes and rays, what is best and what this run cannot
 * tell apart, as a table and in sentences. On the terminal it fits on one screen of 100 columns;
 * Markdown has a few columns more. */
#include "framework/compare/summary.h"
#include "framework/report/report.h"
#include "framework/table/figure.h"
#include "framework/table/page.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Figures of a row, behind its traces. */
static const struct {
    const char *heading;
    size_t standing; /* where it is in a bb_summary_row */
    bool wide;       /* for Markdown alone */
    int decimals;
} columns[] = {
    {"build\nM/s", offsetof(bb_summary_row, build), false, 2},
    {"with\nlayout", offsetof(bb_summary_row, ready), false, 2},
    {"0.1 M\nrays", offsetof(bb_summary_row, image[0]), true, 2},
    {"1 M\nrays", offsetof(bb_summary_row, image[1]), false, 2},
    {"10 M\nrays", offsetof(bb_summary_row, image[2]), true, 2},
    {"100 M\nrays", offsetof(bb_summary_row, image[3]), false, 2},
    {"1 G\nrays", offsetof(bb_summary_row, image[4]), false, 2},
    {"10 G\nrays", offsetof(bb_summary_row, image[5]), true, 2},
    {"SAH\n/best", offsetof(bb_summary_row, quality), false, 2},
    {"EPO\n/best", offsetof(bb_summary_row, overlap), true, 2},
    {"work\n/best", offsetof(bb_summary_row, work), false, 2},
};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* ---- the head ---- */

static const char *plural(uint32_t count)
{
    return count == 1 ? "" : "s";
}

static void add_head(bb_page *page, const bb_results *results, const bb_summary *s)
{
    const double ms = bb_results_time_ms(results, "total");
    char time[64] = "", noise[80] = "";
    if (ms >= 60e3)
        snprintf(time, sizeof time, ", %.0f min %.0f s", floor(ms / 60e3),
                 floor(fmod(ms, 60e3) / 1e3));
    else if (isfinite(ms))
        snprintf(time, sizeof time, ", %.1f s", ms / 1e3);
    if (isfinite(s->noise))
        snprintf(noise, sizeof noise, "; one rate is good to %.0f %% (worst tenth: %.0f %%)",
                 100 * s->noise, 100 * s->noise_worst);
    bb_page_say(page, "bvhbench %.47s: %u scene%s, %u ray set%s, %u builder%s, %u round%s%s%s",
                bb_get_text(bb_results_context(results), BB_F_CONTEXT_REVISION), s->scenes,
                plural(s->scenes), s->sets, plural(s->sets), s->builder_count,
                plural(s->builder_count), s->rounds, plural(s->rounds), time, noise);
}

static void warn(bb_page *page, const bb_results *results)
{
    char text[BB_IMPLAUSIBLE];
    if (bb_summary_busy(results, text))
        bb_page_verdict(page, false, "WARNING: %s", text);
}

/* ---- the table ---- */

/* Builders of one rank are those that this run cannot tell from the first of them. */
static void put_rank(bb_page *page, const bb_summary *s, const bb_summary_row *row)
{
    char rank[40] = "-";
    if (row->partial)
        snprintf(rank, sizeof rank, "%u/%u", row->sets, s->sets);
    else if (row->group != UINT32_MAX && !row->reference)
        snprintf(rank, sizeof rank, "%u", row->group + 1);
    bb_page_put_text(page, rank);
}

static void put_number(bb_page *page, double value, char mark)
{
    bb_estimate figure = bb_not_measured;
    figure.value = value;
    bb_page_put_figure(page, figure, mark);
}

/* None is said: it is not what was not judged. */
static void put_wrong(bb_page *page, const bb_summary_row *row)
{
    char text[BB_FIGURE_MAX];
    const double wrong = row->checked > 0 ? row->wrong : (double)NAN;
    bb_page_put_text(page, wrong == 0 ? "none" : bb_figure(text, wrong, 0));
}

static char mark_of(const bb_summary_row *row, size_t column, const bb_standing *standing)
{
    return column == 0 && row->leaves_out ? '!' : standing->best ? '*' : standing->tied ? '~' : 0;
}

static void add_row(bb_page *page, const bb_summary *s, const bb_summary_row *row, bool wide)
{
    bb_page_put_text(page, wide && row->run == 0 ? row->builder : row->name);
    put_rank(page, s, row);
    put_number(page, row->trace.value, row->trace.best ? '*' : 0);
    for (size_t i = 0; i < COLUMNS; i++) {
        const bb_standing *standing = (const void *)((const char *)row + columns[i].standing);
        if (wide || !columns[i].wide)
            put_number(page, standing->value, mark_of(row, i, standing));
    }
    put_number(page, row->peak / (1 << 20), 0);
    put_wrong(page, row);
    if (wide)
        put_number(page, row->checked, 0);
}

static void add_rows(bb_page *page, const bb_summary *s, bool wide)
{
    bb_page_grid(page, "");
    bb_page_column(page, "builder", "", "", 0);
    bb_page_column(page, "#", "", "", 0);
    bb_page_column(page, s->reference == NULL ? "trace\n/best" : "trace\n/ref", "", "", 2);
    for (size_t i = 0; i < COLUMNS; i++)
        if (wide || !columns[i].wide)
            bb_page_column(page, columns[i].heading, "", "", columns[i].decimals);
    bb_page_column(page, "peak\nMiB", "", "", 1);
    bb_page_column(page, "wrong\nrays", "", "", 0);
    if (wide)
        bb_page_column(page, "of", "", "", 0);
    for (uint32_t i = 0; i < s->row_count; i++)
        add_row(page, s, &s->rows[i], wide);
}

static void add_legend(bb_page *page, const bb_summary *s)
{
    char ties[80];
    uint32_t partial = 0, left_out = 0;
    for (uint32_t i = 0; i < s->row_count; i++) {
        partial += s->rows[i].partial;
        left_out += s->rows[i].leaves_out;
    }
    snprintf(ties, sizeof ties,
             s->rounds < BB_INTERVAL_ROUNDS ? "ties take %d rounds to know"
                                            : "equal ones are not told from their first (95 %%)",
             BB_INTERVAL_ROUNDS);
    bb_page_note(page,
                 "geometric means over ray sets; M/s: million primitives; * best builder, ~ not "
                 "told from it; with layout: build and layout; rays: these and the image of so "
                 "many rays, by the best; work: counted, per ray");
    if (left_out > 0)
        bb_page_note(page, "! with each build, more than a tenth of it again is done outside the "
                           "clock: not ranked by build or image");
    if (s->reference != NULL)
        bb_page_note(page, "/ref: %s, by its fastest row on each ray set", s->reference);
    bb_page_note(page, "#: rank by traces, %s%s", ties,
                 partial > 0 ? "; n/m: without a rank, for what they lack of the scenes or rays"
                             : "");
    if (s->row_count > s->builder_count)
        bb_page_note(page,
                     "at the end, tracers, which trace trees of their own by code of their own");
    if (s->sets_aside > 0)
        bb_page_note(page, "aside, traced by too few builders to compare them: %u ray sets",
                     s->sets_aside);
}

/* ---- all of it ---- */

/* Whether any run was; of merged results all count. */
static bool was_interrupted(const bb_results *results)
{
    bool any = bb_get_true(bb_results_context(results), BB_F_CONTEXT_INTERRUPTED);
    bb_each(run, bb_results_section(results, BB_MERGED))
    {
        any = any || bb_get_true(run, BB_F_CONTEXT_INTERRUPTED);
    }
    return any;
}

static bb_status show(const bb_results *results, bool wide, FILE *out)
{
    bb_summary summary;
    bb_page *page;
    char implausible[BB_IMPLAUSIBLE];
    const bb_entry *context = bb_results_context(results);
    BB_TRY(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &summary));
    bb_status status = bb_page_create("bvhbench", &page);
    if (status != BB_OK)
        goto out;
    /* first: a GPU may not be the device that somebody thinks it is */
    bb_page_heading(page, bb_get_text(context, BB_F_CONTEXT_DEVICE));
    warn(page, results);
    if (bb_summary_implausible(results, implausible))
        bb_page_verdict(page, false, "WARNING: %s", implausible);
    if (was_interrupted(results))
        bb_page_verdict(page, false, "INTERRUPTED: not all that was asked for was measured");
    add_head(page, results, &summary);
    if (summary.row_count > 0) {
        add_rows(page, &summary, wide);
        add_legend(page, &summary);
    }
    for (uint32_t i = 0; i < summary.sentence_count; i++)
        bb_page_note(page, "%s: %s", summary.sentences[i].label, summary.sentences[i].text);
    warn(page, results);
    status = bb_page_end(page, wide ? bb_page_markdown : bb_page_print, out);
out:
    bb_summary_free(&summary);
    return status;
}

bb_status bb_report_verdict(const bb_results *results, FILE *out)
{
    return show(results, false, out);
}

bb_status bb_report_markdown(const bb_results *results, FILE *out)
{
    return show(results, true, out);
}
