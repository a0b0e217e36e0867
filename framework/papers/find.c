/* Values in an experiment's table. */
#include "framework/papers/figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool fits(const bb_table *table, uint32_t row, const bb_cell *cell)
{
    for (int d = 0; d < BB_DIMENSIONS; d++) {
        const char *own = bb_table_name(table, row, (bb_dimension)d);
        if (own[0] != '\0' && cell->names[d] != NULL && strcmp(own, cell->names[d]) != 0)
            return false;
    }
    return true;
}

bool bb_add_rounds(bb_samples *sum, const bb_samples *more)
{
    if (sum->count != 0 && sum->count != more->count)
        return false;
    for (uint32_t i = 0; i < more->count; i++)
        sum->values[i] = (sum->count != 0 ? sum->values[i] : 0) + more->values[i];
    sum->count = more->count;
    return true;
}

/* Of the rows that fit. */
typedef struct sum {
    bb_samples rounds;
    double sum, numbers, rays, weights;
    bool uneven; /* not all have the same rounds */
} sum;

static void add_row(const bb_table *table, uint32_t row, const char *column, sum *s)
{
    const bb_samples *rounds = bb_table_get_rounds(table, row, column);
    const double number = bb_table_get_number(table, row, column);
    const double rays = bb_table_get_number(table, row, "rays");
    if (isnan(number))
        return;
    if (rounds != NULL) { /* of which not all are in memory: see bb_table_get_rounds() */
        bb_samples copy = {.count = rounds->count};
        memcpy(copy.values, rounds->values, rounds->count * sizeof *rounds->values);
        s->uneven = !bb_add_rounds(&s->rounds, &copy) || s->uneven;
    }
    const double weight = isnan(rays) ? 1 : rays;
    s->sum += number;
    s->numbers += weight * number;
    s->weights += weight;
    s->rays += isnan(rays) ? 0 : rays;
}

static bool is_simulated(const char *column)
{
    static const char prefix[] = BB_SIMULATED_TIME;
    return strncmp(column, prefix, strcspn(prefix, "%")) == 0;
}

static bb_found find_column(const bb_findings *f, const bb_cell *cell, const char *column)
{
    sum s = {.uneven = false};
    bb_found found = {.number = NAN};
    for (uint32_t row = 0; row < bb_table_row_count(f->table); row++)
        if (fits(f->table, row, cell))
            add_row(f->table, row, column, &s);
    if (s.weights == 0 || s.uneven)
        return found;
    found.rays = s.rays;
    found.rounds = s.rounds;
    found.number = s.rounds.count > 0            ? bb_samples_median(&s.rounds)
                   : strcmp(column, "rays") == 0 ? s.rays
                   : is_simulated(column)        ? s.sum
                                                 : s.numbers / s.weights;
    return found;
}

bool bb_simulated_columns(const char *columns, uint32_t simulation, char out[256])
{
    bool any = false;
    out[0] = '\0';
    for (const char *at = columns; at != NULL; at = strchr(at, '+')) {
        char column[64];
        const size_t used = strlen(out);
        at += *at == '+';
        snprintf(column, sizeof column, "%.*s", (int)strcspn(at, "+"), at);
        const bool own = strcmp(column, "trace_ms") == 0 || strcmp(column, "build_ms") == 0 ||
                         strcmp(column, "answer_ms") == 0;
        any = any || own;
        snprintf(out + used, 256 - used, "%s", used > 0 ? "+" : "");
        if (own && simulation > 0)
            snprintf(out + strlen(out), 256 - strlen(out), BB_SIMULATED_TIME, simulation, column);
        else
            snprintf(out + strlen(out), 256 - strlen(out), "%s", column);
    }
    return any;
}

bb_found bb_find(const bb_findings *f, const bb_cell *cell, const char *columns)
{
    bb_found all = {.number = 0};
    for (const char *at = columns; at != NULL; at = strchr(at, '+')) {
        char column[64];
        at += *at == '+';
        snprintf(column, sizeof column, "%.*s", (int)strcspn(at, "+"), at);
        const bb_found found = find_column(f, cell, column);
        if (isnan(found.number) || !bb_add_rounds(&all.rounds, &found.rounds))
            return (bb_found){.number = NAN};
        all.number += found.number;
        all.rays += found.rays;
    }
    if (all.rounds.count > 0)
        all.number = bb_samples_median(&all.rounds);
    return all;
}

const char *bb_view_name(const bb_findings *f, const char *scene, int number)
{
    for (uint32_t row = 0; f->table != NULL && row < bb_table_row_count(f->table); row++)
        if (strcmp(bb_table_name(f->table, row, BB_SCENE), scene) == 0 &&
            bb_table_name(f->table, row, BB_BUILDER)[0] == '\0' &&
            bb_table_name(f->table, row, BB_FRAME)[0] != '\0' && number-- == 0)
            return bb_table_name(f->table, row, BB_FRAME);
    return "";
}

const char *bb_found_text(const bb_findings *f, const char *scene, const char *builder,
                          const char *column)
{
    const bb_cell cell = {{[BB_SCENE] = scene, [BB_BUILDER] = builder}};
    return bb_table_get_text(f->table, bb_table_find(f->table, cell), column);
}
