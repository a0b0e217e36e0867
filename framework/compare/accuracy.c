/* Compares intersectors on the same rays, trees and kernels: how often each is wrong, and how fast
 * it is. */
#include "framework/compare/summary_private.h"

#include <stdlib.h>
#include <string.h>

/* A cell of ours that was judged. */
typedef struct judged {
    double build, rate, wrong, wrong_t, checked;
    const char *hash, *rays, *view, *kernel, *intersector;
    bool exact;
} judged;

typedef struct cells {
    judged *items;
    uint32_t count;
} cells;

static bool usable(const bb_entry *trace, const bb_summary_choice *choice)
{
    return bb_is_ok(trace) && !bb_get_true(trace, BB_F_TRACE_REFERENCE) &&
           bb_get_number(trace, BB_F_ACCURACY_CHECKED) > 0 &&
           isfinite(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM)) &&
           bb_get_number(trace, BB_F_TRACE_RATE) > 0 &&
           bb_choice_takes(choice, bb_get_text(trace, BB_F_TRACE_SCENE),
                           bb_get_text(trace, BB_F_TRACE_RAYS));
}

static judged read(const bb_entry *trace)
{
    double checked = bb_get_number(trace, BB_F_ACCURACY_CHECKED);
    return (judged){
        .build = bb_place_of(bb_build_of(trace)),
        .rate = bb_get_number(trace, BB_F_TRACE_RATE),
        .checked = checked,
        .wrong = round(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM) * checked / 1e6),
        .wrong_t = bb_get_number(trace, BB_F_ACCURACY_WRONG_T),
        .hash = bb_get_text(trace, BB_F_TRACE_RAYS_HASH),
        .rays = bb_get_text(trace, BB_F_TRACE_RAYS),
        .view = bb_get_text(trace, BB_F_TRACE_VIEW),
        .kernel = bb_get_text(trace, BB_F_TRACE_KERNEL),
        .intersector = bb_get_text(trace, BB_F_TRACE_INTERSECTOR),
        .exact = bb_get_true(trace, BB_F_TRACE_COUNTS),
    };
}

/* Returns whether both differ at most in the intersector. */
static bool beside(const judged *a, const judged *b)
{
    return a->build == b->build && strcmp(a->hash, b->hash) == 0 && strcmp(a->rays, b->rays) == 0 &&
           strcmp(a->view, b->view) == 0 && strcmp(a->kernel, b->kernel) == 0;
}

static bb_summary_accuracy *entry_of(bb_summary *s, const char *intersector)
{
    for (uint32_t i = 0; i < s->accuracy_count; i++)
        if (strcmp(s->accuracy[i].intersector, intersector) == 0)
            return &s->accuracy[i];
    bb_summary_accuracy *grown =
        realloc(s->accuracy, (s->accuracy_count + 1) * sizeof *s->accuracy);
    if (grown == NULL)
        return NULL;
    s->accuracy = grown;
    grown[s->accuracy_count] = (bb_summary_accuracy){.intersector = intersector};
    return &grown[s->accuracy_count++];
}

/* Returns the cell beside `of` with this intersector; NULL if there is none. */
static const judged *cell_with(const cells *all, const judged *of, const char *intersector)
{
    for (uint32_t i = 0; i < all->count; i++)
        if (strcmp(all->items[i].intersector, intersector) == 0 && beside(&all->items[i], of))
            return &all->items[i];
    return NULL;
}

/* Adds the cells beside `exact` if every intersector has one, so that all sums cover the same rays.
 */
static void add_together(const cells *all, const judged *exact, bb_summary *s)
{
    for (uint32_t i = 0; i < s->accuracy_count; i++)
        if (cell_with(all, exact, s->accuracy[i].intersector) == NULL)
            return;
    for (uint32_t i = 0; i < s->accuracy_count; i++) {
        bb_summary_accuracy *a = &s->accuracy[i];
        const judged *cell = cell_with(all, exact, a->intersector);
        a->wrong += cell->wrong;
        a->wrong_t += cell->wrong_t;
        a->checked += cell->checked;
        a->speed += log(cell->rate / exact->rate);
        a->cells++;
    }
}

static int by_wrong(const void *a, const void *b)
{
    const bb_summary_accuracy *x = a, *y = b;
    double p = x->wrong / x->checked, q = y->wrong / y->checked;
    if (p != q)
        return p < q ? -1 : 1;
    return strcmp(x->intersector, y->intersector);
}

/* Lists the intersectors of the cells, each once. */
static bb_status list_intersectors(const cells *all, bb_summary *s)
{
    for (uint32_t i = 0; i < all->count; i++)
        if (entry_of(s, all->items[i].intersector) == NULL)
            return bb_fail(BB_FAILED, "summary: no memory");
    return BB_OK;
}

bb_status bb_summary_accuracies(const bb_results *results, const bb_summary_choice *choice,
                                bb_summary *summary)
{
    const bb_section *traces = bb_results_section(results, BB_TRACES);
    cells all = {.items = calloc((size_t)bb_section_count(traces) + 1, sizeof *all.items)};
    if (all.items == NULL)
        return bb_fail(BB_FAILED, "summary: no memory");
    bb_each(trace, traces)
    {
        if (usable(trace, choice))
            all.items[all.count++] = read(trace);
    }
    bb_status status = list_intersectors(&all, summary);
    for (uint32_t i = 0; status == BB_OK && summary->accuracy_count > 1 && i < all.count; i++)
        if (all.items[i].exact)
            add_together(&all, &all.items[i], summary);
    free(all.items);
    if (status != BB_OK)
        return status;
    if (summary->accuracy_count > 0 && summary->accuracy[0].cells == 0)
        summary->accuracy_count = 0; /* no intersectors have common cells */
    for (uint32_t i = 0; i < summary->accuracy_count; i++)
        summary->accuracy[i].speed = exp(summary->accuracy[i].speed / summary->accuracy[i].cells);
    if (summary->accuracy_count > 1)
        qsort(summary->accuracy, summary->accuracy_count, sizeof *summary->accuracy, by_wrong);
    return BB_OK;
}
