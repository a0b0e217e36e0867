/* Figures of papers: ratios of what was measured, and their means over scenes. */
#include "framework/papers/figures.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- names ---- */

/* Copies `text`, with `with` for its first `mark`. */
static void put(char out[256], const char *text, char mark, const char *with)
{
    const char *at = strchr(text, mark);
    if (at == NULL)
        snprintf(out, 256, "%s", text);
    else
        snprintf(out, 256, "%.*s%s%s", (int)(at - text), text, with, at + 1);
}

static bb_cell cell_of(const bb_paper_place *at, const bb_figure *figure, const char *builder,
                       const char *kernel, const char *view)
{
    const char *own = kernel != NULL ? kernel : figure->kernel;
    const bb_paper_entrant none = {NULL}, *row = at->row != NULL ? at->row : &none;
    return (bb_cell){{[BB_SCENE] = at->scene,
                      [BB_BUILDER] = builder,
                      [BB_MAKER] = figure->phase,
                      [BB_INTERSECTOR] = own != NULL ? own : row->kernel,
                      [BB_QUESTION] = figure->rays,
                      [BB_FRAME] = view}};
}

static bb_found find_there(const bb_paper_place *at, int of, const bb_cell *cell,
                           const char *columns)
{
    char own[256];
    bb_simulated_columns(columns, at->simulated, own);
    return bb_find(&at->all[of], cell, own);
}

/* The one of {...} whose build and traces take the least time. */
static void choose(const bb_paper_place *at, const bb_figure *figure, const char *kernel,
                   char out[256], char chosen[32])
{
    const char *begin = strchr(out, '{'), *end = begin != NULL ? strchr(begin, '}') : NULL;
    char best[256] = "", one[256];
    double least = INFINITY;
    if (end == NULL)
        return;
    for (const char *item = begin + 1; item < end; item += strcspn(item, ",}") + 1) {
        const int length = (int)strcspn(item, ",}");
        snprintf(one, sizeof one, "%.*s%.*s%s", (int)(begin - out), out, length, item, end + 1);
        const bb_cell cell = cell_of(at, figure, one, kernel, NULL);
        const double ms = find_there(at, figure->of, &cell, "build_ms+trace_ms").number;
        if (ms < least || best[0] == '\0') {
            least = isnan(ms) ? INFINITY : ms;
            snprintf(best, sizeof best, "%s", one);
            snprintf(chosen, 32, "%.*s", length, item);
        }
    }
    snprintf(out, 256, "%s", best);
}

void bb_figure_builder(const bb_paper_place *at, const bb_figure *figure, const char *pattern,
                       const char *kernel, char out[256], char chosen[32])
{
    char name[256], number[16];
    const char *row = at->row != NULL && at->row->builder != NULL ? at->row->builder : "";
    if (pattern == NULL)
        put(name, row, '$', "");
    else if (strcmp(pattern, "=") == 0)
        snprintf(name, sizeof name, "%s", at->row->base);
    else if (pattern[0] == '$')
        put(name, row, '$', pattern + 1);
    else
        snprintf(name, sizeof name, "%s", pattern);
    snprintf(number, sizeof number, "%d", at->view);
    put(out, name, '%', number);
    chosen[0] = '\0';
    if (at->scene != NULL)
        choose(at, figure, kernel, out, chosen);
}

/* ---- values ---- */

static bb_found divide(const bb_found *a, const bb_found *b, bool paired)
{
    bb_found ratio = {.number = a->number / b->number, .rays = a->rays};
    if (paired && a->rounds.count > 0 && b->rounds.count > 0) {
        ratio.rounds = bb_samples_ratio(&a->rounds, &b->rounds);
        ratio.number = bb_samples_median(&ratio.rounds);
    }
    return ratio;
}

/* Of one builder at one scene, over `per`. */
static bb_found find(const bb_paper_place *at, const bb_figure *figure, int of, const char *builder,
                     const char *kernel)
{
    char name[256], chosen[32];
    const bb_findings *f = &at->all[of];
    const char *view = at->view >= 0 ? bb_view_name(f, at->scene, at->view) : NULL;
    bb_figure_builder(at, figure, builder, kernel, name, chosen);
    const bb_cell cell = cell_of(at, figure, name, kernel, view);
    const bb_found found = find_there(at, of, &cell, figure->what);
    if (figure->per == NULL)
        return found;
    const bb_found per = find_there(at, of, &cell, figure->per);
    return divide(&found, &per, !figure->unpaired);
}

/* NULL: it is the first. */
static const char *scene_before(const bb_findings *f, const char *scene)
{
    for (size_t s = 1; s < f->scene_count; s++)
        if (strcmp(f->scenes[s], scene) == 0)
            return f->scenes[s - 1];
    return NULL;
}

static bb_found find_figure(const bb_paper_place *at, const bb_figure *figure)
{
    const bb_found none = {.number = NAN};
    bb_found own = find(at, figure, figure->of, figure->builder, NULL);
    if (figure->base != NULL) {
        const char *kernel = figure->base_kernel != NULL ? figure->base_kernel
                             : at->row != NULL           ? at->row->base_kernel
                                                         : NULL;
        const bb_found base = find(at, figure, figure->of + figure->base_of, figure->base, kernel);
        if (own.rays != base.rays) /* not the same */
            return none;
        own = figure->inverse ? divide(&base, &own, !figure->unpaired)
                              : divide(&own, &base, !figure->unpaired);
    }
    if (figure->previous) {
        bb_paper_place before = *at;
        bb_figure same = *figure;
        same.previous = false;
        same.scale = 0;
        before.scene = scene_before(&at->all[figure->of], at->scene);
        const bb_found base = before.scene != NULL ? find_figure(&before, &same) : none;
        own = divide(&own, &base, true);
    }
    for (uint32_t i = 0; figure->scale != 0 && i < own.rounds.count; i++)
        own.rounds.values[i] *= figure->scale;
    own.number *= figure->scale != 0 ? figure->scale : 1;
    return own;
}

static bb_estimate estimate_of(const bb_found *found)
{
    bb_estimate e = bb_not_measured;
    if (found->rounds.count > 0)
        e = bb_samples_estimate(&found->rounds);
    e.value = found->number;
    return e;
}

/* ---- means ---- */

/* In each round; a zeroed one is empty. */
typedef struct mean {
    bb_samples sum;
    double values;
    uint32_t count, rounds; /* measured; of these, with rounds */
    bool uneven;
} mean;

static void add(mean *m, const bb_found *found, bb_paper_mean how)
{
    if (isnan(found->number))
        return;
    m->count++;
    m->values += found->number;
    if (found->rounds.count == 0)
        return;
    bb_samples rounds = found->rounds;
    for (uint32_t i = 0; how == BB_MEAN_GEOMETRIC && i < rounds.count; i++)
        rounds.values[i] = log(rounds.values[i]);
    m->rounds++;
    m->uneven = !bb_add_rounds(&m->sum, &rounds) || m->uneven;
}

static bb_estimate mean_of(const mean *m, bb_paper_mean how, size_t scenes)
{
    bb_estimate e = bb_not_measured;
    if (m->count == 0)
        return e;
    if (how == BB_MEAN_OF_SCENES || m->rounds == 0) {
        e.value = m->values / m->count;
        return e;
    }
    if (m->uneven || (how == BB_MEAN_GEOMETRIC && m->rounds < scenes))
        return e;
    bb_samples means = m->sum;
    for (uint32_t i = 0; i < means.count; i++) {
        means.values[i] /= m->rounds;
        if (how == BB_MEAN_GEOMETRIC)
            means.values[i] = exp(means.values[i]);
    }
    return bb_samples_estimate(&means);
}

bb_paper_series bb_figure_series(bb_paper_place at, const bb_figure *figure)
{
    const bb_findings *f = &at.all[figure->of];
    bb_paper_series s = {.count = 0};
    mean m = {.count = 0};
    for (size_t i = 0; i < f->scene_count; i++) {
        at.scene = f->scenes[i];
        for (int v = 0; v < figure->views || v == 0; v++) {
            at.view = figure->views > 0 ? v : -1;
            if (figure->only != NULL && !figure->only(f, at.scene))
                continue;
            assert(s.count < BB_SERIES_MAX);
            const bb_found found = find_figure(&at, figure);
            s.timed = s.timed || found.rounds.count > 0;
            s.places[s.count] = at;
            s.each[s.count++] = estimate_of(&found);
            add(&m, &found, figure->mean);
        }
    }
    s.mean = mean_of(&m, figure->mean, s.count);
    return s;
}

bb_estimate bb_figure_at(bb_paper_place at, const bb_figure *figure, bool *timed)
{
    if (at.scene == NULL) {
        const bb_paper_series s = bb_figure_series(at, figure);
        *timed = s.timed;
        return s.mean;
    }
    const bb_found found = find_figure(&at, figure);
    *timed = found.rounds.count > 0;
    return estimate_of(&found);
}

double bb_series_least(const bb_paper_series *s)
{
    double least = NAN;
    for (size_t i = 0; i < s->count; i++)
        least = fmin(least, s->each[i].value);
    return least;
}

double bb_series_most(const bb_paper_series *s)
{
    double most = NAN;
    for (size_t i = 0; i < s->count; i++)
        most = fmax(most, s->each[i].value);
    return most;
}

double bb_series_mean(const bb_paper_series *s)
{
    mean m = {.count = 0};
    for (size_t i = 0; i < s->count; i++)
        add(&m, &(bb_found){.number = s->each[i].value}, BB_MEAN_OF_SCENES);
    return m.count > 0 ? m.values / m.count : (double)NAN;
}

double bb_value_at(bb_paper_place at, const bb_figure *figure)
{
    bool timed;
    return bb_figure_at(at, figure, &timed).value;
}
