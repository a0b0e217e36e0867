/* Says in sentences what follows from the rows. */
#include "framework/compare/prediction.h"
#include "framework/compare/summary_private.h"
#include "framework/table/figure.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static bb_sentence *begin(bb_summary *s, const char *label)
{
    if (s->sentence_count == BB_SUMMARY_SENTENCES)
        return NULL;
    bb_sentence *sentence = &s->sentences[s->sentence_count++];
    snprintf(sentence->label, sizeof sentence->label, "%s", label);
    sentence->text[0] = '\0';
    return sentence;
}

/* Formats a sentence, and cuts it if it is too long. */
static void say(bb_sentence *sentence, const char *format, ...)
{
    if (sentence == NULL)
        return;
    size_t length = strlen(sentence->text);
    va_list args;
    va_start(args, format);
    vsnprintf(sentence->text + length, sizeof sentence->text - length, format, args);
    va_end(args);
}

/* 560000 -> "560 k", 3.2e9 -> "3.2 G" */
static const char *rays_text(double rays, char text[32])
{
    static const struct {
        double unit;
        const char *name;
    } units[] = {{1e9, " G"}, {1e6, " M"}, {1e3, " k"}, {1, ""}};
    size_t i = 0;
    while (i < 3 && rays < 0.9995 * units[i].unit)
        i++;
    snprintf(text, 32, rays / units[i].unit < 9.95 ? "%.2g%s" : "%.0f%s", rays / units[i].unit,
             units[i].name);
    return text;
}

/* 1.062 -> "1.06x", 37.2 -> "37x" */
static const char *times_text(double ratio, char text[32])
{
    snprintf(text, 32, ratio < 9.995 ? "%.2fx" : "%.0fx", ratio);
    return text;
}

enum { NAMED = 5 };

/* A list of rows, of which the first few are named. */
typedef struct row_list {
    const bb_summary_row *rows[NAMED];
    uint32_t count; /* number of all rows */
} row_list;

static void list_row(row_list *list, const bb_summary_row *row)
{
    if (list->count < NAMED)
        list->rows[list->count] = row;
    list->count++;
}

/* "A, B and 2 more" */
static void say_names(bb_sentence *sentence, const row_list *list)
{
    uint32_t named = list->count > NAMED ? NAMED - 1 : list->count;
    for (uint32_t i = 0; i < named; i++)
        say(sentence, "%s%s", i > 0 ? ", " : "", list->rows[i]->name);
    if (list->count > named)
        say(sentence, " and %u more", list->count - named);
}

static void say_traces(bb_summary *s)
{
    row_list tied = {.count = 0};
    while (tied.count < s->builder_count && s->rows[tied.count].group == 0)
        list_row(&tied, &s->rows[tied.count]);
    if (tied.count == 0)
        return;
    const double best = s->rows[0].trace.value, worst = s->rows[tied.count - 1].trace.value;
    bb_sentence *sentence = begin(s, "Fastest trace");
    say_names(sentence, &tied);
    if (s->reference != NULL && tied.count > 1)
        say(sentence, ": %.2f to %.2f times as fast as %s, not told apart", worst, best,
            s->reference);
    else if (s->reference != NULL)
        say(sentence, ": %.2f times as fast as %s", best, s->reference);
    else if (tied.count > 1)
        say(sentence, ": not told apart");
    const bb_summary_row *next = &s->rows[tied.count];
    if (tied.count < s->builder_count && next->group == 1)
        say(sentence, "; %s is %.0f %% slower", next->name, 100 * (1 - next->trace.value / best));
}

/* Which rows of the reference the others are divided by. */
static void say_yardsticks(bb_summary *s)
{
    bb_sentence *sentence = NULL;
    for (uint32_t i = s->builder_count; i < s->row_count; i++) {
        const bb_summary_row *row = &s->rows[i];
        if (row->yardstick == 0)
            continue;
        if (sentence == NULL) {
            sentence = begin(s, "Fastest of Embree");
            say(sentence, "%s on %u of %u ray sets", row->name, row->yardstick, s->sets);
        } else
            say(sentence, ", %s on %u", row->name, row->yardstick);
    }
}

static double wrong_of_a_million(const bb_summary_row *row)
{
    return 1e6 * row->wrong / row->checked;
}

static void say_wrong_of_tracers(bb_sentence *sentence, const bb_summary_row *least,
                                 const bb_summary_row *most)
{
    const double from = wrong_of_a_million(least), to = wrong_of_a_million(most);
    char texts[2][32];
    if (to == 0)
        say(sentence, "none of their answers was wrong");
    else if (from == to)
        say(sentence, "of a million rays they get %s wrong", rays_text(to, texts[1]));
    else
        say(sentence, "of a million rays they get %s (%s) to %s (%s) wrong",
            rays_text(from, texts[0]), least->name, rays_text(to, texts[1]), most->name);
}

/* Says how fast the fastest of the other tracers is, beside the fastest builder, and what they get
 * wrong. */
static void say_tracers(bb_summary *s)
{
    const bb_summary_row *fastest = NULL, *least = NULL, *most = NULL;
    const double best = s->builder_count > 0 ? s->rows[0].trace.value : (double)NAN;
    char text[32];
    for (uint32_t i = s->builder_count; i < s->row_count; i++) {
        const bb_summary_row *row = &s->rows[i];
        if (isfinite(best) && isfinite(row->trace.value) && !row->partial &&
            (fastest == NULL || row->trace.value > fastest->trace.value))
            fastest = row;
        if (!(row->checked > 0) || !isfinite(row->wrong))
            continue;
        least = least == NULL || wrong_of_a_million(row) < wrong_of_a_million(least) ? row : least;
        most = most == NULL || wrong_of_a_million(row) > wrong_of_a_million(most) ? row : most;
    }
    if (fastest == NULL && most == NULL)
        return;
    bb_sentence *sentence = begin(s, "Other tracers");
    if (fastest != NULL)
        say(sentence, "%s, the fastest on all ray sets, traces %s as fast as %s%s", fastest->name,
            times_text(fastest->trace.value / best, text), s->rows[0].name,
            most != NULL ? "; " : "");
    if (most != NULL)
        say_wrong_of_tracers(sentence, least, most);
}

/* Returns the figure of a row by which rows are compared. */
typedef const bb_standing *(*pick)(const bb_summary_row *, uint32_t);

static const bb_standing *pick_build(const bb_summary_row *row, uint32_t k)
{
    (void)k;
    return &row->build;
}

static const bb_standing *pick_image(const bb_summary_row *row, uint32_t k)
{
    return &row->image[k];
}

/* The best builder, those tied with it, and the first behind them. */
typedef struct podium {
    const bb_summary_row *best, *next;
    row_list tied;
} podium;

/* `sign` 1: larger figures are better; -1: smaller ones. */
static podium find_podium(const bb_summary *s, pick figure, uint32_t k, double sign)
{
    podium p = {.best = NULL};
    for (uint32_t i = 0; i < s->builder_count; i++) {
        const bb_summary_row *row = &s->rows[i];
        const bb_standing *standing = figure(row, k);
        if (!isfinite(standing->value) || row->partial || row->leaves_out)
            continue;
        if (standing->best)
            p.best = row;
        else if (standing->tied)
            list_row(&p.tied, row);
        else if (p.next == NULL || sign * standing->value > sign * figure(p.next, k)->value)
            p.next = row;
    }
    return p;
}

static void say_builds(bb_summary *s)
{
    podium p = find_podium(s, pick_build, 0, 1);
    const bb_summary_row *last = NULL;
    if (p.best == NULL)
        return;
    for (uint32_t i = 0; i < s->builder_count; i++)
        if (isfinite(s->rows[i].build.value) && !s->rows[i].partial && !s->rows[i].leaves_out &&
            (last == NULL || s->rows[i].build.value < last->build.value))
            last = &s->rows[i];
    double rate = p.best->build.value;
    char text[32];
    bb_sentence *sentence = begin(s, "Fastest build");
    say(sentence, "%s, %.3g Mprims/s", p.best->name, rate);
    if (p.tied.count > 0) {
        say(sentence, ", not told from ");
        say_names(sentence, &p.tied);
    }
    if (p.next != NULL)
        say(sentence, "; %s %s", times_text(rate / p.next->build.value, text), p.next->name);
    if (last != NULL && last != p.next && last != p.best)
        say(sentence, ", %s %s", times_text(rate / last->build.value, text), last->name);
}

/* Says whose builds leave out work that recurs with each, and how much. */
static void say_untimed(bb_summary *s)
{
    bb_sentence *sentence = NULL;
    char text[32];
    for (uint32_t i = 0; i < s->builder_count; i++) {
        if (!s->rows[i].leaves_out)
            continue;
        const bool first = sentence == NULL;
        sentence = first ? begin(s, "Not clocked") : sentence;
        say(sentence, first ? "with each build %s does other work for %s its time" : ", %s for %s",
            s->rows[i].name, times_text(s->rows[i].untimed, text));
    }
}

static void say_image_at(bb_summary *s, uint32_t k, const char *label)
{
    podium p = find_podium(s, pick_image, k, -1);
    char text[32];
    if (p.best == NULL)
        return;
    bb_sentence *sentence = begin(s, label);
    say(sentence, "%s", p.best->name);
    if (p.tied.count > 0) {
        say(sentence, ", not told from ");
        say_names(sentence, &p.tied);
    }
    if (p.next != NULL)
        say(sentence, "; %s takes %s the time", p.next->name,
            times_text(p.next->image[k].value, text));
}

/* Says who is first for how many rays. A builder keeps its place as long as this run cannot tell it
 * from the best. Each number is the last that it held. */
static void say_crossings(bb_summary *s)
{
    const bb_summary_row *holder = NULL;
    bb_sentence *sentence = NULL;
    char text[32];
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++) {
        const bb_summary_row *first = NULL;
        for (uint32_t r = 0; r < s->builder_count; r++)
            if (!s->rows[r].partial && !s->rows[r].leaves_out && isfinite(s->rows[r].curve[i]) &&
                (first == NULL || s->rows[r].curve[i] < first->curve[i]))
                first = &s->rows[r];
        if (first == NULL)
            return;
        if (holder == NULL) {
            holder = first;
            sentence = begin(s, "Fastest image");
        } else if (first != holder && !holder->curve_first[i]) {
            say(sentence, "%s up to %s rays; ", holder->name,
                rays_text(bb_summary_curve_count(i - 1), text));
            holder = first;
        }
    }
    if (holder != NULL)
        say(sentence,
            sentence->text[0] != '\0' ? "beyond, %s; each until another is surely faster"
                                      : "%s for any number of rays",
            holder->name);
}

static void say_answers(bb_summary *s)
{
    char text[32];
    uint32_t named = 0, failed = 0, partial = 0;
    bb_sentence *sentence = begin(s, "Right answers");
    for (uint32_t i = 0; i < s->builder_count; i++) {
        failed += s->rows[i].failed;
        partial += s->rows[i].partial;
    }
    if (s->wrong == 0 && !(s->checked > 0)) {
        say(sentence, "no answer was judged");
    } else if (s->wrong == 0) {
        say(sentence, "no wrong one in %s", rays_text(s->checked, text));
        say(sentence, ", on %s different rays: below %.2g per million (95 %%)",
            rays_text(s->distinct, text), bb_wrong_rate_of(0, s->distinct).high);
    } else {
        say(sentence, "WRONG: ");
        for (uint32_t i = 0; i < s->builder_count; i++)
            if (s->rows[i].wrong > 0 && named++ < 6)
                say(sentence, "%s%s lost %.0f of %s", named > 1 ? ", " : "", s->rows[i].name,
                    s->rows[i].wrong, rays_text(s->rows[i].checked, text));
        say(sentence, " rays");
    }
    if (failed > 0)
        say(sentence, "; %u builds or cells were refused or failed (--table says why)", failed);
    if (partial > 0)
        say(sentence, "; %u builders %s and have no rank", partial,
            s->sets_differ ? "were not traced with the same rays: size or seed differ,"
                           : "lack scenes or rays");
}

static void say_accuracy(bb_summary *s)
{
    char text[32];
    if (s->accuracy_count < 2)
        return;
    bb_sentence *sentence = begin(s, "Intersectors");
    say(sentence,
        "on %s rays, wrong per million and speed: ", rays_text(s->accuracy[0].checked, text));
    for (uint32_t i = 0; i < s->accuracy_count; i++) {
        const bb_summary_accuracy *a = &s->accuracy[i];
        double ppm = bb_wrong_rate_of(a->wrong, a->checked).ppm;
        say(sentence, "%s%s ", i > 0 ? "; " : "", a->intersector);
        if (a->wrong == 0)
            say(sentence, "none");
        else
            say(sentence, ppm < 100 ? "%.2g" : "%.0f", ppm);
        say(sentence, "%s, %.2fx",
            a->wrong > 0 && a->wrong_t > 0.9 * a->wrong ? " (right triangle, wrong distance)" : "",
            a->speed);
    }
    say(sentence, "; all else here is `exact`");
}

/* Returns the row that a simulation puts first, `left_out` aside; UINT32_MAX: none. */
static uint32_t first_simulated(const bb_summary *s, const bb_summary_simulation *of,
                                uint32_t left_out)
{
    uint32_t first = UINT32_MAX;
    for (uint32_t i = 0; i < s->builder_count; i++)
        if (i != left_out && isfinite(of->mrays_s[i]) &&
            (first == UINT32_MAX || of->mrays_s[i] > of->mrays_s[first]))
            first = i;
    return first;
}

/* Says which builders change places from the first simulation to this one, and what binds them. */
static void say_swaps(bb_sentence *sentence, const bb_summary *s, const bb_summary_simulation *of)
{
    const bb_summary_simulation *first = &s->simulations[0];
    uint32_t swaps = 0;
    say(sentence, "; ranks agree with those of %s by %.2f", first->name + sizeof BB_SIMT,
        of->stability);
    for (uint32_t i = 0; i < s->builder_count; i++)
        for (uint32_t k = 0; k < i; k++) {
            const double before = first->mrays_s[i] - first->mrays_s[k];
            if (!(before * (of->mrays_s[i] - of->mrays_s[k]) < 0) || swaps++ >= 3)
                continue;
            const uint32_t a = before > 0 ? i : k, b = before > 0 ? k : i;
            say(sentence, "%s %s (%s) behind %s (%s)", swaps == 1 ? ":" : ",", s->rows[a].name,
                bb_binding_word(of->binds[a]), s->rows[b].name, bb_binding_word(of->binds[b]));
        }
    if (swaps > 3)
        say(sentence, " and %u pairs more", swaps - 3);
}

static void say_simulated(bb_summary *s, const bb_summary_simulation *of)
{
    const uint32_t first = first_simulated(s, of, UINT32_MAX), next = first_simulated(s, of, first);
    if (first == UINT32_MAX)
        return;
    char mrays_s[BB_FIGURE_MAX];
    bb_sentence *sentence = begin(s, "Simulated");
    say(sentence, "neither measured nor validated, %s: %s %s Mrays/s, bound by %s most often",
        of->name + sizeof BB_SIMT, s->rows[first].name, bb_figure(mrays_s, of->mrays_s[first], -1),
        bb_binding_word(of->binds[first]));
    if (next != UINT32_MAX)
        say(sentence, "; %s %.2fx", s->rows[next].name, of->mrays_s[next] / of->mrays_s[first]);
    if (isfinite(of->correlation))
        say(sentence, "; ranks agree with those measured here by %.2f (Kendall)", of->correlation);
    if (of != &s->simulations[0] && isfinite(of->stability))
        say_swaps(sentence, s, of);
}

void bb_summary_say(bb_summary *summary)
{
    say_traces(summary);
    say_answers(summary);
    say_image_at(summary, 1, "For 1 M rays");
    say_image_at(summary, 4, "For 1 G rays");
    say_crossings(summary);
    say_builds(summary);
    say_tracers(summary);
    if (summary->reference != NULL)
        say_yardsticks(summary);
    say_untimed(summary);
    say_accuracy(summary);
    for (uint32_t i = 0; i < summary->simulation_count; i++)
        say_simulated(summary, &summary->simulations[i]);
}

/* The least and the largest error over the kinds of rays, as in "4 to 7 %". */
typedef struct error_range {
    double least, most;
} error_range;

static void widen(error_range *range, double error)
{
    range->least = fmin(range->least, 100 * error);
    range->most = fmax(range->most, 100 * error);
}

static void say_range(bb_sentence *sentence, const char *before, const error_range *range)
{
    if (range->most - range->least < 0.5)
        say(sentence, "%s%.2g %%", before, range->most);
    else
        say(sentence, "%s%.2g to %.2g %%", before, range->least, range->most);
}

/* With a lower correlation, a cost explains less than half of the variation between trees. */
static const double telling_correlation = 0.7;

static void say_mixes(bb_summary *summary, const bb_prediction_record *const *told, uint32_t count)
{
    error_range mix = {INFINITY, 0}, sah = mix, work = mix;
    bb_sentence *sentence = begin(summary, "Trees to speed");
    say(sentence, "SAH and overlap (EPO) foretell the time per ray as (1 - a) SAH + a EPO:");
    for (uint32_t i = 0; i < count; i++) {
        const bb_prediction_record *r = told[i];
        say(sentence, "%s a = %.2f (%.2f to %.2f) for %.40s", i > 0 ? "," : "", r->alpha,
            r->alpha_least, r->alpha_most, r->rays);
        widen(&mix, r->unseen_error);
        widen(&sah, r->sah_error);
        widen(&work, r->work_error);
    }
    say_range(sentence, "; a scene not fitted is off by ", &mix);
    say_range(sentence, ", by SAH alone ", &sah);
    say_range(sentence, ", by counted work ", &work);
}

static void say_untold(bb_summary *summary, const bb_prediction_record *const *untold,
                       uint32_t count)
{
    bb_sentence *sentence = begin(summary, "Trees to speed");
    say(sentence, "no mix of SAH and overlap (EPO) foretells the time per ray of");
    for (uint32_t i = 0; i < count; i++)
        say(sentence, "%s %.40s (correlation %.2f)", i > 0 ? "," : "", untold[i]->rays,
            untold[i]->mix_correlation);
    say(sentence, " here, whether because of the rays or of noise");
}

bb_status bb_summary_say_predictions(const bb_results *results, const bb_summary_choice *choice,
                                     bb_summary *summary)
{
    enum { KINDS = 8 };
    bb_predictions made;
    const bb_prediction_record *told[KINDS], *untold[KINDS];
    uint32_t told_count = 0, untold_count = 0;
    if (choice->scene != NULL)
        return BB_OK;
    BB_TRY(bb_predictions_make(results, &made));
    for (uint32_t i = 0; i < made.count; i++) {
        const bb_prediction_record *r = &made.kinds[i].record;
        if (!isfinite(r->unseen_error) ||
            (choice->rays != NULL && strcmp(choice->rays, r->rays) != 0))
            continue;
        if (r->mix_correlation >= telling_correlation && told_count < KINDS)
            told[told_count++] = r;
        else if (!(r->mix_correlation >= telling_correlation) && untold_count < KINDS)
            untold[untold_count++] = r;
    }
    if (told_count > 0)
        say_mixes(summary, told, told_count);
    if (untold_count > 0)
        say_untold(summary, untold, untold_count);
    bb_predictions_free(&made);
    return BB_OK;
}
