/* The answer on one screen: builders by merit over all scenes and rays, what is best and what this
 * run cannot tell apart, in a table and in sentences. At most 100 columns. */
#include "framework/report/columns.h"
#include "framework/report/report.h"
#include "framework/summary/summary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 100, LABEL = 15 };

/* Numbers of rays that have a column: of bb_summary_counts. */
static const uint32_t shown_counts[] = {0, 1, 3, 4};
enum { SHOWN = sizeof shown_counts / sizeof shown_counts[0] };

/* ---- the head ---- */

static void print_minutes(FILE *out, double ms)
{
    if (ms >= 60e3)
        fprintf(out, "%.0f min %.0f s", floor(ms / 60e3), floor(fmod(ms, 60e3) / 1e3));
    else
        fprintf(out, "%.1f s", ms / 1e3);
}

static void print_count(FILE *out, const char *before, uint32_t count, const char *name)
{
    fprintf(out, "%s%u %s%s", before, count, name, count == 1 ? "" : "s");
}

/* Before all else: a GPU may not be the device that somebody thinks it is. */
static void print_device(FILE *out, const bb_results *results)
{
    const bb_entry *context = bb_results_context(results);
    char device[60];
    snprintf(device, sizeof device, "%s", bb_get_text(context, BB_F_CONTEXT_DEVICE));
    bb_print_text(out, device, 0);
    fputc('\n', out);
}

static void print_head(FILE *out, const bb_results *results, const bb_summary *s)
{
    const bb_entry *context = bb_results_context(results);
    double ms = bb_results_time_ms(results, "total");
    char revision[48];
    fputs("bvhbench ", out);
    snprintf(revision, sizeof revision, "%s", bb_get_text(context, BB_F_CONTEXT_REVISION));
    bb_print_text(out, revision, 0);
    print_count(out, ": ", s->scenes, "scene");
    print_count(out, ", ", s->sets, "ray set");
    print_count(out, ", ", s->builder_count, "builder");
    print_count(out, ", ", s->rounds, "round");
    if (isfinite(ms)) {
        fputs(", ", out);
        print_minutes(out, ms);
    }
    fputc('\n', out);
    if (isfinite(s->noise))
        fprintf(out, "one rate is good to %.0f %% (worst tenth: %.0f %%)\n", 100 * s->noise,
                100 * s->noise_worst);
}

/* ---- the table ---- */

/* Best, or tied with the best. */
static char mark_of(const bb_standing *standing)
{
    return standing->best ? '*' : standing->tied ? '~' : ' ';
}

static void print_figure(FILE *out, double value, int width)
{
    if (!isfinite(value))
        fprintf(out, "%*s", width, "-");
    else
        fprintf(out, "%*.*f", width, value < 9.995 ? 2 : value < 99.95 ? 1 : 0, value);
}

/* A bracket around the rows that this run can't tell apart. */
static char bracket_of(const bb_summary *s, uint32_t i)
{
    const bb_summary_row *row = &s->rows[i];
    bool above = i > 0 && s->rows[i - 1].group == row->group;
    bool below = i + 1 < s->builder_count && s->rows[i + 1].group == row->group;
    if (row->reference || row->group == UINT32_MAX || (!above && !below))
        return ' ';
    return above && below ? '|' : above ? '/' : '\\';
}

static void print_row(FILE *out, const bb_summary *s, uint32_t i)
{
    const bb_summary_row *row = &s->rows[i];
    char wrong[BB_ENTRY] = "-";
    fputc(' ', out);
    bb_print_text(out, row->name, 27);
    print_figure(out, row->trace.value, 6);
    fprintf(out, "%c%c", row->trace.best ? '*' : ' ', bracket_of(s, i));
    print_figure(out, row->build.value, 6);
    fputc(mark_of(&row->build), out);
    print_figure(out, row->ready.value, 7);
    fputc(mark_of(&row->ready), out);
    for (uint32_t k = 0; k < SHOWN; k++) {
        print_figure(out, row->image[shown_counts[k]].value, 5);
        fputc(mark_of(&row->image[shown_counts[k]]), out);
    }
    print_figure(out, row->quality.value, 5);
    fputc(mark_of(&row->quality), out);
    print_figure(out, row->work.value, 5);
    fputc(mark_of(&row->work), out);
    print_figure(out, row->peak / (1 << 20), 6);
    if (row->checked > 0)
        snprintf(wrong, sizeof wrong, row->wrong == 0 ? "none" : "%.0f", row->wrong);
    fprintf(out, "%7s\n", wrong);
}

static void print_rows(FILE *out, const bb_summary *s)
{
    /* "on the CPU" is in the heading, not below the table */
    const bool elsewhere = s->reference != NULL && strcmp(s->reference, "Embree") != 0;
    fprintf(out, "\n %-26s%7s  %6s %7s    %-21s%5s %5s %6s%7s\n", "",
            elsewhere ? "/Embree" : "trace", "build", "+layout", "time to image /best", "SAH",
            "work", "peak", "wrong");
    fprintf(out, " %-26s%7s  %6s %7s ", "builder",
            s->reference == NULL ? "/best"
            : elsewhere          ? "on CPU"
                                 : "/Embree",
            "M/s", "M/s");
    static const char *const counts[] = {"0.1 M", "1 M", "10 M", "100 M", "1 G", "10 G"};
    for (uint32_t k = 0; k < SHOWN; k++)
        fprintf(out, "%5s ", counts[shown_counts[k]]);
    fprintf(out, "%5s %5s %6s%7s\n", "/best", "/best", "MiB", "rays");
    for (uint32_t i = 0; i < s->row_count; i++) {
        if (i < s->builder_count && s->rows[i].partial && (i == 0 || !s->rows[i - 1].partial))
            fputs(" without a rank, for what they lack of the scenes or rays:\n", out);
        if (i == s->builder_count)
            fprintf(out, " for reference, %s with its own trees:\n",
                    s->reference != NULL ? s->reference : "Embree");
        print_row(out, s, i);
    }
}

/* Words of `text` in lines, behind a label of `width` columns. */
static void print_wrapped(FILE *out, const char *label, int width, const char *text)
{
    int column = fprintf(out, " %-*s", width, label);
    const int start = column;
    while (*text != '\0') {
        char word[128];
        int length = (int)strcspn(text, " ");
        int blank = column > start;
        if (blank && column + 1 + length > COLUMNS) {
            fprintf(out, "\n%*s", start, "");
            column = start;
            blank = 0;
        }
        snprintf(word, sizeof word, "%.*s", length < 127 ? length : 127, text);
        fprintf(out, "%*s", blank, "");
        bb_print_text(out, word, 0);
        column += blank + length;
        text += length + (text[length] == ' ');
    }
    fputc('\n', out);
}

static void print_legend(FILE *out, const bb_summary *s)
{
    char text[512], base[64], ties[128] = "\\|/ not to be told from their first by this run";
    if (s->rounds < BB_INTERVAL_ROUNDS)
        snprintf(ties, sizeof ties, "ties take %d rounds to know", BB_INTERVAL_ROUNDS);
    if (s->reference != NULL)
        snprintf(base, sizeof base, "/%s: by its fastest row on each ray set", s->reference);
    else
        snprintf(base, sizeof base, "/best: by the best builder");
    snprintf(
        text, sizeof text,
        "geometric means over ray sets; M/s: million primitives; * best builder, ~ not told from "
        "it; %s (95 %% each); %s; +layout: build and layout; image: these and so many rays; work: "
        "counted, per ray",
        ties, base);
    print_wrapped(out, "", 0, text);
    text[0] = '\0';
    for (uint32_t i = 0, said = 0; i < s->row_count && said < 4; i++) {
        size_t length = strlen(text);
        if (s->rows[i].sets != s->sets && s->rows[i].sets > 0)
            snprintf(text + length, sizeof text - length, "%s%s %u of %u",
                     said++ == 0 ? "ray sets of " : ", ", s->rows[i].name, s->rows[i].sets,
                     s->sets);
    }
    if (text[0] != '\0')
        print_wrapped(out, "", 0, text);
    if (s->sets_aside > 0)
        fprintf(out, " aside, traced by too few builders to compare them: %u ray sets\n",
                s->sets_aside);
}

bb_status bb_report_verdict(const bb_results *results, FILE *out)
{
    bb_summary summary;
    char busy[256], implausible[BB_IMPLAUSIBLE];
    BB_TRY(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &summary));
    print_device(out, results);
    bool is_busy = bb_summary_busy(results, busy);
    if (is_busy)
        print_wrapped(out, "WARNING", LABEL, busy);
    if (bb_summary_implausible(results, implausible))
        print_wrapped(out, "WARNING", LABEL, implausible);
    if (bb_get_true(bb_results_context(results), BB_F_CONTEXT_INTERRUPTED))
        print_wrapped(out, "INTERRUPTED", LABEL, "not all that was asked for was measured");
    print_head(out, results, &summary);
    if (summary.row_count > 0) {
        print_rows(out, &summary);
        print_legend(out, &summary);
        fputc('\n', out);
    }
    for (uint32_t i = 0; i < summary.sentence_count; i++)
        print_wrapped(out, summary.sentences[i].label, LABEL, summary.sentences[i].text);
    if (is_busy)
        print_wrapped(out, "WARNING", LABEL, busy);
    bb_summary_free(&summary);
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the summary") : BB_OK;
}
