/* What simulations say of builders, beside what was measured, and never mixed into it. */
#include "framework/compare/summary_private.h"

#include <stdlib.h>
#include <string.h>

static bool is_same_set(const bb_entry *a, const bb_entry *b)
{
    return bb_same_text(a, b, BB_F_TRACE_SCENE) && bb_same_text(a, b, BB_F_TRACE_RAYS) &&
           bb_same_text(a, b, BB_F_TRACE_VIEW) && bb_same_text(a, b, BB_F_TRACE_RAYS_HASH);
}

static double bound_of(const bb_entry *trace, const char *simulation)
{
    return bb_get_named(trace, BB_F_SIMT_RATE, simulation);
}

/* Returns whether the trace is of this row, simulated, and the fastest so of its ray set. */
static bool is_fastest(const bb_results *results, const bb_summary_choice *choice,
                       const bb_summary_row *row, const bb_entry *trace, const char *simulation)
{
    const double bound = bound_of(trace, simulation);
    if (!(bound > 0) || bb_run_of(trace) != row->run ||
        strcmp(bb_get_text(trace, BB_F_TRACE_BUILDER), row->builder) != 0 ||
        !bb_choice_takes(choice, bb_get_text(trace, BB_F_TRACE_SCENE),
                         bb_get_text(trace, BB_F_TRACE_RAYS)))
        return false;
    bb_each(other, bb_results_section(results, BB_TRACES))
    {
        const double rival = bound_of(other, simulation);
        if (other != trace && bb_same_text(trace, other, BB_F_TRACE_BUILDER) &&
            bb_run_of(other) == row->run && is_same_set(trace, other) &&
            (rival > bound || (rival == bound && bb_place_of(other) < bb_place_of(trace))))
            return false;
    }
    return true;
}

typedef uint32_t binding_counts[BB_BINDINGS];

static bb_binding most_frequent(const binding_counts counts)
{
    bb_binding most = BB_BY_ISSUE;
    for (int b = 0; b < BB_BINDINGS; b++)
        most = counts[b] > counts[most] ? (bb_binding)b : most;
    return most;
}

static uint32_t sum_of(const binding_counts counts)
{
    uint32_t sum = 0;
    for (int b = 0; b < BB_BINDINGS; b++)
        sum += counts[b];
    return sum;
}

/* `counts`, zeroed: for each row, how many of its ray sets are bound by what. */
static void fill(const bb_results *results, const bb_summary_choice *choice, const bb_summary *s,
                 binding_counts *counts, bb_summary_simulation *of)
{
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        for (uint32_t i = 0; i < s->builder_count; i++) {
            if (!is_fastest(results, choice, &s->rows[i], trace, of->name))
                continue;
            of->mrays_s[i] += log(bound_of(trace, of->name));
            const bb_binding by =
                bb_binding_of(bb_get_named_text(trace, BB_F_SIMT_BINDS, of->name));
            if (by < BB_BINDINGS)
                counts[i][by]++;
        }
    }
    for (uint32_t i = 0; i < s->builder_count; i++) {
        of->sets = sum_of(counts[i]) > of->sets ? sum_of(counts[i]) : of->sets;
        of->binds[i] = most_frequent(counts[i]);
    }
    for (uint32_t i = 0; i < s->row_count; i++)
        of->mrays_s[i] = of->sets > 0 && sum_of(counts[i]) == of->sets
                             ? exp(of->mrays_s[i] / of->sets)
                             : (double)NAN;
}

static bb_status simulate(const bb_results *results, const bb_summary_choice *choice,
                          const char *name, bb_summary *s, bb_summary_simulation *of)
{
    const size_t rows = s->row_count + 1;
    binding_counts *counts = calloc(rows, sizeof *counts);
    double *measured = calloc(rows, sizeof *measured);
    *of = (bb_summary_simulation){.name = name,
                                  .mrays_s = calloc(rows, sizeof *of->mrays_s),
                                  .binds = calloc(rows, sizeof *of->binds)};
    if (counts == NULL || measured == NULL || of->mrays_s == NULL || of->binds == NULL) {
        free(counts);
        free(measured);
        return bb_fail(BB_FAILED, "summary: no memory");
    }
    fill(results, choice, s, counts, of);
    free(counts);
    of->stability = bb_kendall(of->mrays_s, s->simulations[0].mrays_s, s->builder_count);
    for (uint32_t i = 0; i < s->builder_count; i++)
        measured[i] = s->rows[i].mrays_s;
    of->correlation = bb_kendall(of->mrays_s, measured, s->builder_count);
    free(measured);
    return BB_OK;
}

bb_status bb_summary_simulations(const bb_results *results, const bb_summary_choice *choice,
                                 bb_summary *summary)
{
    const char *names[BB_SIMT_MAX];
    const uint32_t count = bb_results_simulations(results, names);
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(simulate(results, choice, names[i], summary,
                        &summary->simulations[summary->simulation_count++]));
    return BB_OK;
}
