/* Step-down maximum over cells, by permutation: Westfall and Young, Resampling-Based Multiple
 * Testing, 1993, section 2.6.
 *
 *     for each exchange of labels (the one that was measured first), from the cell with the
 *     smallest statistic, as measured, to the one with the largest:
 *         largest = max(largest, the cell's statistic under the exchange)
 *         count[cell] += largest >= the cell's statistic as measured
 *     p(cell) = the most of count / exchanges of this cell and all with a larger statistic
 *
 * A cell is compared only with those that moved no more than itself. The cells that moved most are
 * large under many exchanges, and do not hide the others.
 *
 * All cells with equally many rounds share an exchange. For pairs, it flips the signs of some
 * rounds' log ratios; for two runs, it deals the rounds out between the runs. If the labels mean
 * nothing, the measured labels are as likely as any others to have the largest maximum. So P(any p
 * <= level) <= level, however the cells depend on each other and however the noise is distributed.
 *
 * The statistic: mean / sqrt(spread^2 + s0^2), where s0 is the median spread of all cells, so that
 * no cell has a large statistic by chance of a small spread (Tusher, Tibshirani, Chu, PNAS 98,
 * 2001). Values far from the centre are drawn in to three times the median distance, unless that is
 * 0. Spread and centre are those of all values of a cell, which no exchange changes. */
#include "framework/compare/family.h"

#include "framework/base/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    EXCHANGES = 2048,
    ALL_SIGNS = 11, /* up to this many pairs, all exchanges are tried */
    VALUES = 2 * BB_SAMPLES_MAX,
};

uint32_t bb_family_pairs_needed(double level)
{
    uint32_t pairs = 1;
    while (ldexp(1, -(int)pairs) > level)
        pairs++;
    return pairs;
}

/* ---- a cell's values ---- */

typedef struct row {
    uint32_t first, count; /* number of values: of the first label, of both */
    float values[VALUES];
    double spread, scale;
} row;

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count)
{
    if (count == 0)
        return 0;
    qsort(values, count, sizeof *values, compare);
    return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

/* Stores `values` as distances from `centre` and draws outliers in. A missing value becomes 0. */
static void draw_in(row *r, const double *values, double centre)
{
    double sorted[VALUES], sum = 0;
    uint32_t known = 0;
    for (uint32_t i = 0; i < r->count; i++)
        if (isfinite(values[i]))
            sorted[known++] = fabs(values[i] - centre);
    double most = 3 * median(sorted, known);
    if (!(most > 0)) /* most values are the same: nothing is drawn in */
        most = INFINITY;
    for (uint32_t i = 0; i < r->count; i++) {
        double v = isfinite(values[i]) ? values[i] - centre : 0;
        r->values[i] = (float)fmax(-most, fmin(most, v));
        sum += (double)r->values[i] * r->values[i];
    }
    r->spread = known > 0 ? sqrt(sum / known) : 0;
}

static void prepare_pairs(row *r, const bb_family_row *from)
{
    r->first = r->count = from->before.count;
    draw_in(r, from->before.values, 0);
}

static void prepare_runs(row *r, const bb_family_row *from)
{
    double values[VALUES], sorted[VALUES];
    uint32_t known = 0;
    r->first = from->before.count;
    r->count = r->first + from->after.count;
    memcpy(values, from->before.values, r->first * sizeof *values);
    memcpy(values + r->first, from->after.values, from->after.count * sizeof *values);
    for (uint32_t i = 0; i < r->count; i++)
        if (isfinite(values[i]))
            sorted[known++] = values[i];
    draw_in(r, values, median(sorted, known));
}

/* Sets each row's scale, by which its mean is divided; 0 if all its values are the same. *usual:
 * the median spread. */
static bb_status scale(row *rows, uint32_t count, double *usual)
{
    double *spreads = calloc(count + 1, sizeof *spreads);
    uint32_t known = 0;
    if (spreads == NULL)
        return bb_fail(BB_FAILED, "comparison: no memory");
    for (uint32_t i = 0; i < count; i++)
        if (rows[i].count > 0)
            spreads[known++] = rows[i].spread;
    *usual = median(spreads, known);
    for (uint32_t i = 0; i < count; i++)
        rows[i].scale = hypot(rows[i].spread, *usual);
    free(spreads);
    return BB_OK;
}

/* ---- exchanges ---- */

/* Sets sign[i] to +1 or -1. Exchange 0 has the measured labels. For pairs, -1 flips the ratio; for
 * runs, the sign is the label. */
static void signs_of_pairs(uint32_t exchange, uint32_t count, float *sign)
{
    bb_random random = bb_random_make(exchange, count);
    for (uint32_t i = 0; i < count; i++) {
        bool flip = count <= ALL_SIGNS ? exchange >> i & 1 : bb_random_u64(&random) >> 63;
        sign[i] = flip && exchange > 0 ? -1 : 1;
    }
}

static void signs_of_runs(uint32_t exchange, uint32_t first, uint32_t count, float *sign)
{
    bb_random random = bb_random_make(exchange, (uint64_t)first << 32 | count);
    for (uint32_t i = 0; i < count; i++)
        sign[i] = i < first ? -1 : 1;
    for (uint32_t i = count; i > 1 && exchange > 0; i--) {
        uint32_t k = bb_random_below(&random, i);
        float swapped = sign[k];
        sign[k] = sign[i - 1];
        sign[i - 1] = swapped;
    }
}

static double statistic(const row *r, const float *sign, bool pairs)
{
    double before = 0, after = 0;
    if (r->count == 0 || !(r->scale > 0))
        return 0;
    for (uint32_t i = 0; i < r->count; i++) {
        double v = (double)r->values[i];
        if (pairs)
            after += sign[i] * v;
        else if (sign[i] < 0)
            before += v;
        else
            after += v;
    }
    if (pairs)
        return after / (r->count * r->scale);
    if (r->first == 0 || r->first == r->count)
        return 0;
    return (after / (r->count - r->first) - before / r->first) / r->scale;
}

/* ---- step by step ---- */

/* A cell's place among all, by its statistic as measured. */
typedef struct place {
    uint32_t row;
    uint32_t above,
        below; /* exchanges in which the maximum so far is as large, or the minimum as small */
    double t, exchanged; /* the statistic as measured; under the exchange */
} place;

static int by_statistic(const void *a, const void *b)
{
    const place *p = a, *q = b;
    return p->t != q->t ? (p->t > q->t) - (p->t < q->t) : (p->row > q->row) - (p->row < q->row);
}

/* Sets the statistics of all rows under an exchange. Rows of one shape share its signs. */
static void exchange_all(const row *rows, place *places, uint32_t count, uint32_t exchange,
                         bool pairs)
{
    float sign[VALUES] = {0};
    uint32_t first = 0, all = 0;
    for (uint32_t i = 0; i < count; i++) {
        const row *r = &rows[places[i].row];
        if (r->first != first || r->count != all) {
            first = r->first;
            all = r->count;
            if (pairs)
                signs_of_pairs(exchange, all, sign);
            else
                signs_of_runs(exchange, first, all, sign);
        }
        places[i].exchanged = statistic(r, sign, pairs);
    }
}

static void count_exchange(place *places, uint32_t count)
{
    const double slack = 1e-9; /* for sums of the same values in another order */
    double largest = -INFINITY, smallest = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        largest = fmax(largest, places[i].exchanged);
        places[i].above += largest >= places[i].t - slack;
    }
    for (uint32_t i = count; i-- > 0;) {
        smallest = fmin(smallest, places[i].exchanged);
        places[i].below += smallest <= places[i].t + slack;
    }
}

static bool has_values(const row *r, bool pairs)
{
    return pairs ? r->count > 0 : r->first > 0 && r->first < r->count;
}

/* Sets p-values from the largest count of this cell and of all that moved more. */
static void set_p(bb_family_row *family, const row *rows, const place *places, uint32_t count,
                  uint32_t exchanges, bool pairs)
{
    uint32_t most = 0;
    for (uint32_t i = count; i-- > 0;) {
        most = places[i].above > most ? places[i].above : most;
        family[places[i].row].p_up =
            has_values(&rows[places[i].row], pairs) ? (double)most / exchanges : 1;
    }
    most = 0;
    for (uint32_t i = 0; i < count; i++) {
        most = places[i].below > most ? places[i].below : most;
        family[places[i].row].p_down =
            has_values(&rows[places[i].row], pairs) ? (double)most / exchanges : 1;
    }
}

/* `places` has room for all rows. */
static void step_through(bb_family_row *family, const row *rows, place *places, uint32_t count,
                         uint32_t exchanges, bool pairs)
{
    for (uint32_t i = 0; i < count; i++)
        places[i] = (place){.row = i};
    exchange_all(rows, places, count, 0, pairs);
    for (uint32_t i = 0; i < count; i++)
        places[i].t = places[i].exchanged;
    qsort(places, count, sizeof *places, by_statistic);
    for (uint32_t e = 0; e < exchanges; e++) {
        exchange_all(rows, places, count, e, pairs);
        count_exchange(places, count);
    }
    set_p(family, rows, places, count, exchanges, pairs);
}

static void prepare(row *r, const bb_family_row *from, bool pairs)
{
    if (pairs)
        prepare_pairs(r, from);
    else
        prepare_runs(r, from);
}

/* Prepares all rows; returns the number of exchanges to try. */
static uint32_t prepare_all(row *rows, const bb_family_row *family, uint32_t count, bool pairs)
{
    uint32_t longest = 0;
    for (uint32_t i = 0; i < count; i++) {
        prepare(&rows[i], &family[i], pairs);
        longest = rows[i].count > longest ? rows[i].count : longest;
    }
    return pairs && longest <= ALL_SIGNS ? 1u << longest : EXCHANGES;
}

static bb_status adjust(bb_family_row *family, uint32_t count, bool pairs)
{
    bb_status status = BB_OK;
    double usual;
    row *rows = calloc(count + 1, sizeof *rows);
    place *places = calloc(count + 1, sizeof *places);
    if (rows == NULL || places == NULL) {
        status = bb_fail(BB_FAILED, "comparison: no memory");
        goto out;
    }
    const uint32_t exchanges = prepare_all(rows, family, count, pairs);
    status = scale(rows, count, &usual);
    if (status == BB_OK)
        step_through(family, rows, places, count, exchanges, pairs);
out:
    free(rows);
    free(places);
    return status;
}

bb_status bb_family_of_pairs(bb_family_row *rows, uint32_t count)
{
    return adjust(rows, count, true);
}

bb_status bb_family_of_runs(bb_family_row *rows, uint32_t count)
{
    return adjust(rows, count, false);
}

/* ---- the least slowing that would have been found ---- */

/* All that a search for it needs. */
typedef struct search {
    bb_family_row *centred;
    row *rows;
    place *places;
    double usual, level;
    uint32_t exchanges, count;
    bool pairs;
    double *largest; /* for each exchange, the largest statistic of all rows */
    float *signs;    /* of all exchanges for rows of the shape first, all; VALUES each */
    uint32_t first, all;
} search;

static void centre(bb_samples *values)
{
    double sorted[BB_SAMPLES_MAX];
    uint32_t known = 0;
    for (uint32_t i = 0; i < values->count; i++)
        if (isfinite(values->values[i]))
            sorted[known++] = values->values[i];
    const double middle = median(sorted, known);
    for (uint32_t i = 0; i < values->count; i++)
        values->values[i] -= middle;
}

static void find_largest(search *s)
{
    for (uint32_t i = 0; i < s->count; i++)
        s->places[i] = (place){.row = i};
    for (uint32_t e = 0; e < s->exchanges; e++) {
        exchange_all(s->rows, s->places, s->count, e, s->pairs);
        s->largest[e] = -INFINITY;
        for (uint32_t i = 0; i < s->count; i++)
            s->largest[e] = fmax(s->largest[e], s->places[i].exchanged);
    }
}

/* The signs of all exchanges, kept as long as the shape stays. */
static void take_signs(search *s, const row *r)
{
    if (r->first == s->first && r->count == s->all)
        return;
    s->first = r->first;
    s->all = r->count;
    for (uint32_t e = 0; e < s->exchanges; e++) {
        float *sign = s->signs + (size_t)e * VALUES;
        if (s->pairs)
            signs_of_pairs(e, s->all, sign);
        else
            signs_of_runs(e, s->first, s->all, sign);
    }
}

static bool finds(search *s, uint32_t i, double shift)
{
    bb_family_row shifted = s->centred[i];
    row r;
    bb_samples *moved = s->pairs ? &shifted.before : &shifted.after;
    for (uint32_t k = 0; k < moved->count; k++)
        moved->values[k] += shift;
    prepare(&r, &shifted, s->pairs);
    r.scale = hypot(r.spread, s->usual);
    take_signs(s, &r);
    const double t = statistic(&r, s->signs, s->pairs), slack = 1e-9;
    uint32_t above = 0;
    for (uint32_t e = 0; e < s->exchanges; e++)
        above += fmax(s->largest[e], statistic(&r, s->signs + (size_t)e * VALUES, s->pairs)) >=
                 t - slack;
    return above <= s->level * s->exchanges;
}

/* Between a thousandth and ten times as slow, to a hundredth of itself. */
static double least_found(search *s, uint32_t i)
{
    double low = log(1e-3), high = log(log(10)); /* logarithms of shifts */
    if (!has_values(&s->rows[i], s->pairs) || !finds(s, i, exp(high)))
        return INFINITY;
    while (high - low > 0.01) {
        const double middle = 0.5 * (low + high);
        if (finds(s, i, exp(middle)))
            high = middle;
        else
            low = middle;
    }
    return exp(high);
}

bb_status bb_family_found(const bb_family_row *rows, uint32_t count, bool pairs, double level,
                          double *least)
{
    search s = {.count = count, .pairs = pairs, .level = level, .all = UINT32_MAX};
    s.centred = malloc((count + 1) * sizeof *s.centred);
    s.rows = calloc(count + 1, sizeof *s.rows);
    s.places = calloc(count + 1, sizeof *s.places);
    s.largest = calloc(EXCHANGES, sizeof *s.largest);
    s.signs = calloc((size_t)EXCHANGES * VALUES, sizeof *s.signs);
    bb_status status = BB_OK;
    if (s.centred == NULL || s.rows == NULL || s.places == NULL || s.largest == NULL ||
        s.signs == NULL)
        status = bb_fail(BB_FAILED, "comparison: no memory");
    if (status == BB_OK && count > 0) {
        memcpy(s.centred, rows, count * sizeof *rows);
        for (uint32_t i = 0; i < count; i++) {
            centre(&s.centred[i].before);
            if (!pairs)
                centre(&s.centred[i].after);
        }
        s.exchanges = prepare_all(s.rows, s.centred, count, pairs);
        status = scale(s.rows, count, &s.usual);
    }
    if (status == BB_OK)
        find_largest(&s);
    for (uint32_t i = 0; i < count && status == BB_OK; i++)
        least[i] = least_found(&s, i);
    free(s.centred);
    free(s.rows);
    free(s.places);
    free(s.largest);
    free(s.signs);
    return status;
}
