#include "framework/compare/fit.h"

#include <math.h>
#include <stdbool.h>

/* Sums over cells, of the deviations of logarithms from the mean of their group. */
typedef struct sums {
    double predicted, measured, both; /* sums of squares, and of products */
    uint32_t cells, groups;
} sums;

static double log_mix(const bb_fit_cell *cell, double alpha)
{
    return log((1 - alpha) * cell->a + alpha * cell->b);
}

static void add_group(sums *s, const bb_fit_cell *cells, uint32_t count, double alpha)
{
    double predicted = 0, measured = 0;
    for (uint32_t i = 0; i < count; i++) {
        predicted += log_mix(&cells[i], alpha) / count;
        measured += log(cells[i].y) / count;
    }
    for (uint32_t i = 0; i < count; i++) {
        double p = log_mix(&cells[i], alpha) - predicted, q = log(cells[i].y) - measured;
        s->predicted += p * p;
        s->measured += q * q;
        s->both += p * q;
    }
    s->cells += count;
    s->groups++;
}

static uint32_t group_size(const bb_fit_cell *cells, uint32_t count)
{
    uint32_t size = 0;
    while (size < count && cells[size].group == cells[0].group)
        size++;
    return size;
}

/* Adds up the groups of fold `only`, or all but those of fold `without`. */
static sums add_up(const bb_fit_cell *cells, uint32_t count, double alpha, uint32_t only,
                   uint32_t without)
{
    sums s = {0};
    for (uint32_t i = 0, size; i < count; i += size) {
        size = group_size(cells + i, count - i);
        bool enters = (only == BB_FIT_ALL || cells[i].fold == only) &&
                      (without == BB_FIT_ALL || cells[i].fold != without);
        if (enters)
            add_group(&s, cells + i, size, alpha);
    }
    return s;
}

/* Returns the sum of squared errors. Rounding may make it negative if the prediction is exact: then
 * 0. NAN stays NAN. */
static double squares(const sums *s)
{
    double sum = s->predicted - 2 * s->both + s->measured;
    return sum < 0 ? 0 : sum;
}

static double error_of(double sum, double degrees)
{
    return degrees > 0 ? exp(sqrt(sum / degrees)) - 1 : (double)NAN;
}

bb_fit bb_fit_of(const bb_fit_cell *cells, uint32_t count, double alpha, uint32_t fitted)
{
    sums s = add_up(cells, count, alpha, BB_FIT_ALL, BB_FIT_ALL);
    double degrees = (double)s.cells - s.groups - fitted;
    bool varies = s.predicted > 1e-24 * s.cells && s.measured > 1e-24 * s.cells;
    return (bb_fit){error_of(squares(&s), degrees),
                    varies ? s.both / sqrt(s.predicted * s.measured) : (double)NAN};
}

static double squares_at(const bb_fit_cell *cells, uint32_t count, double alpha, uint32_t without)
{
    sums s = add_up(cells, count, alpha, BB_FIT_ALL, without);
    return squares(&s);
}

double bb_fit_alpha(const bb_fit_cell *cells, uint32_t count, uint32_t without)
{
    enum { STEPS = 64, NARROWINGS = 40 };
    const double golden = 0.6180339887498949;
    double least = INFINITY, most = 0, best = 0;
    for (int i = 0; i <= STEPS; i++) {
        double at = (double)i / STEPS, sum = squares_at(cells, count, at, without);
        most = fmax(most, sum);
        if (sum < least) {
            least = sum;
            best = at;
        }
    }
    if (!(most - least > 1e-9 * most))
        return NAN;
    /* golden-section search within the steps around the best one */
    double low = fmax(0, best - 1.0 / STEPS), high = fmin(1, best + 1.0 / STEPS);
    for (int i = 0; i < NARROWINGS; i++) {
        double left = high - golden * (high - low), right = low + golden * (high - low);
        if (squares_at(cells, count, left, without) <= squares_at(cells, count, right, without))
            high = right;
        else
            low = left;
    }
    double found = 0.5 * (low + high);
    return squares_at(cells, count, found, without) < least ? found : best;
}

bb_fit_spread bb_fit_folds(const bb_fit_cell *cells, uint32_t count, uint32_t folds)
{
    bb_fit_spread spread = {INFINITY, -INFINITY, NAN};
    double sum = 0, degrees = 0;
    for (uint32_t fold = 0; fold < folds; fold++) {
        double alpha = bb_fit_alpha(cells, count, fold);
        sums s = add_up(cells, count, alpha, fold, BB_FIT_ALL);
        sum += squares(&s);
        degrees += (double)s.cells - s.groups;
        spread.least = alpha < spread.least ? alpha : spread.least;
        spread.most = alpha > spread.most ? alpha : spread.most;
        if (isnan(alpha))
            folds = 0; /* fmin() and fmax() would ignore the NAN */
    }
    if (folds < 3)
        return (bb_fit_spread){NAN, NAN, NAN};
    spread.unseen = error_of(sum, degrees);
    return spread;
}
