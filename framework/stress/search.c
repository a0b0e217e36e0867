#include "framework/stress/search.h"

#include "framework/base/interrupt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A second measurement of a value beside the normal one. */
typedef struct second_look {
    double x;
    bool looked[BB_METHODS_MAX];
    bb_point_figures *here, *normal; /* of the methods */
} second_look;

typedef struct state {
    bb_search *search;
    bb_wish *wishes; /* BB_WISHES_MAX */
    uint32_t wish_count;
    second_look *looks; /* BB_PROBES_MAX */
    uint32_t look_count;
} state;

/* ---- wishes ---- */

static void drop_wishes(state *st)
{
    for (uint32_t i = 0; i < st->wish_count; i++)
        free(st->wishes[i].figures);
    st->wish_count = 0;
}

/* Returns the wish for x, which is added if missing. */
static bb_status wish_for(state *st, double x, bb_wish **out)
{
    const bb_search *s = st->search;
    for (uint32_t i = 0; i < st->wish_count; i++)
        if (st->wishes[i].x == x) {
            *out = &st->wishes[i];
            return BB_OK;
        }
    bb_point_figures *figures = calloc(s->method_count, sizeof *figures);
    if (figures == NULL || st->wish_count == BB_WISHES_MAX) {
        free(figures);
        return bb_fail(BB_FAILED, "axis %s: no room for another value", s->axis->name);
    }
    *out = &st->wishes[st->wish_count++];
    memset(*out, 0, sizeof **out);
    (*out)->x = x;
    (*out)->figures = figures;
    return BB_OK;
}

/* ---- probes ---- */

/* Returns the probe at x, which is inserted in the order of the axis if missing. */
static bb_status probe_at(bb_search *s, double x, bb_search_probe **out)
{
    const bool down = s->axis->from > s->axis->to;
    uint32_t at = 0;
    while (at < s->probe_count && (down ? s->probes[at].x > x : s->probes[at].x < x))
        at++;
    if (at == s->probe_count || s->probes[at].x != x) {
        bb_point_figures *figures = calloc(s->method_count, sizeof *figures);
        if (figures == NULL || s->probe_count == BB_PROBES_MAX) {
            free(figures);
            return bb_fail(BB_FAILED, "axis %s: no room for another value", s->axis->name);
        }
        memmove(&s->probes[at + 1], &s->probes[at], (s->probe_count - at) * sizeof *s->probes);
        s->probes[at] = (bb_search_probe){x, figures};
        s->probe_count++;
    }
    *out = &s->probes[at];
    return BB_OK;
}

const bb_point_figures *bb_search_figures(const bb_search *s, double x, uint32_t method)
{
    for (uint32_t i = 0; i < s->probe_count; i++)
        if (s->probes[i].x == x)
            return &s->probes[i].figures[method];
    return NULL;
}

/* Measures the wishes that are not known yet, and makes probes of all. */
static bb_status grant(state *st)
{
    bb_search *s = st->search;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < st->wish_count; i++) {
        bb_wish wish = st->wishes[i];
        bool any = false;
        for (uint32_t m = 0; m < s->method_count; m++) {
            const bb_point_figures *f = bb_search_figures(s, wish.x, m);
            wish.wanted[m] = wish.wanted[m] && (f == NULL || f->outcome == BB_NOT_MEASURED);
            any = any || wish.wanted[m];
        }
        st->wishes[i].figures = NULL;
        if (any)
            st->wishes[kept++] = wish;
        else
            free(wish.figures);
    }
    st->wish_count = kept;
    bb_status status = kept > 0 ? s->measure(s->user, st->wishes, kept, false) : BB_OK;
    for (uint32_t i = 0; i < kept && status == BB_OK; i++) {
        bb_search_probe *probe = NULL;
        status = probe_at(s, st->wishes[i].x, &probe);
        for (uint32_t m = 0; m < s->method_count && status == BB_OK; m++)
            if (st->wishes[i].wanted[m])
                probe->figures[m] = st->wishes[i].figures[m];
    }
    drop_wishes(st);
    return status;
}

/* ---- second measurements of failures by time ---- */

static second_look *look_at(state *st, double x, bool make)
{
    for (uint32_t i = 0; i < st->look_count; i++)
        if (st->looks[i].x == x)
            return &st->looks[i];
    if (!make || st->look_count == BB_PROBES_MAX)
        return NULL;
    second_look *look = &st->looks[st->look_count++];
    look->x = x;
    look->here = calloc(st->search->method_count, sizeof *look->here);
    look->normal = calloc(st->search->method_count, sizeof *look->normal);
    return look->here != NULL && look->normal != NULL ? look : NULL;
}

static bool first_says(const bb_search *s, uint32_t method, bb_manner manner, double x)
{
    const bb_point_figures *here = bb_search_figures(s, x, method);
    const bb_point_figures *normal = bb_search_figures(s, s->axis->from, method);
    return here != NULL && normal != NULL && bb_manner_shows(manner, normal, here);
}

/* Returns whether the method seems to fail at x by time, and has no second measurement yet. */
static bool is_suspect(state *st, uint32_t method, double x)
{
    const second_look *look = look_at(st, x, false);
    for (uint32_t f = 0; f < BB_MANNERS; f++)
        if (bb_manners[f].timed && first_says(st->search, method, (bb_manner)f, x))
            return look == NULL || !look->looked[method];
    return false;
}

static bb_status keep_looks(state *st)
{
    const bb_search *s = st->search;
    for (uint32_t i = 1; i < st->wish_count; i++) {
        second_look *look = look_at(st, st->wishes[i].x, true);
        if (look == NULL)
            return bb_fail(BB_FAILED, "axis %s: no memory", s->axis->name);
        for (uint32_t m = 0; m < s->method_count; m++) {
            if (!st->wishes[i].wanted[m])
                continue;
            look->looked[m] = true;
            look->here[m] = st->wishes[i].figures[m];
            look->normal[m] = st->wishes[0].figures[m];
        }
    }
    return BB_OK;
}

/* Measures all suspects again, beside the normal value. */
static bb_status look_again(state *st, const double *values, uint32_t count)
{
    bb_search *s = st->search;
    bb_wish *normal = NULL, *wish = NULL;
    if (!s->times)
        return BB_OK;
    bb_status status = wish_for(st, s->axis->from, &normal);
    for (uint32_t i = 0; i < count && status == BB_OK; i++)
        for (uint32_t m = 0; m < s->method_count && status == BB_OK; m++) {
            if (values[i] == s->axis->from || !is_suspect(st, m, values[i]))
                continue;
            status = wish_for(st, values[i], &wish);
            if (status == BB_OK)
                wish->wanted[m] = normal->wanted[m] = true;
        }
    if (status == BB_OK && st->wish_count > 1 && !bb_interrupted()) {
        status = s->measure(s->user, st->wishes, st->wish_count, true);
        if (status == BB_OK && !bb_interrupted())
            status = keep_looks(st);
    }
    drop_wishes(st);
    return status;
}

/* Returns whether the method fails at x. *ratio: to the normal figure; by time, the lesser of both
 * measurements. */
static bool shows(state *st, uint32_t method, bb_manner manner, double x, double *ratio)
{
    const bb_search *s = st->search;
    const bb_point_figures *here = bb_search_figures(s, x, method);
    const bb_point_figures *normal = bb_search_figures(s, s->axis->from, method);
    *ratio = NAN;
    if (here == NULL || normal == NULL || !first_says(s, method, manner, x))
        return false;
    *ratio = bb_manner_ratio(manner, normal, here);
    if (!bb_manners[manner].timed)
        return true;
    const second_look *look = look_at(st, x, false);
    if (look == NULL || !look->looked[method])
        return false;
    *ratio = fmin(*ratio, bb_manner_ratio(manner, &look->normal[method], &look->here[method]));
    return bb_manner_shows(manner, &look->normal[method], &look->here[method]);
}

/* ---- the search ---- */

static bb_status look_end_to_end(state *st, const double *values, uint32_t count)
{
    bb_wish *wish = NULL;
    for (uint32_t i = 0; i < count; i++) {
        bb_status status = wish_for(st, values[i], &wish);
        if (status != BB_OK) {
            drop_wishes(st);
            return status;
        }
        for (uint32_t m = 0; m < st->search->method_count; m++)
            wish->wanted[m] = true;
    }
    BB_TRY(grant(st));
    return bb_interrupted() ? BB_OK : look_again(st, values, count);
}

/* Returns whether the manner can be judged there. Relative manners need both figures. */
static bool can_tell(const state *st, uint32_t method, bb_manner manner, double x)
{
    const bb_search *s = st->search;
    const bb_point_figures *here = bb_search_figures(s, x, method);
    const bb_point_figures *normal = bb_search_figures(s, s->axis->from, method);
    return !bb_manners[manner].relative ||
           (here != NULL && normal != NULL && !isnan(bb_manner_ratio(manner, normal, here)));
}

/* Finds the threshold by all values measured so far. */
static void settle(state *st, uint32_t method, bb_manner manner)
{
    const bb_search *s = st->search;
    bb_threshold *t = &st->search->thresholds[method][manner];
    double before = NAN;
    *t = (bb_threshold){.ratio = NAN, .below = NAN, .at = NAN};
    for (uint32_t i = 0; i < s->probe_count; i++) {
        const bb_point_figures *here = &s->probes[i].figures[method];
        const double x = s->probes[i].x;
        double ratio;
        if (here->outcome == BB_NOT_MEASURED || !can_tell(st, method, manner, x))
            continue;
        bool fails = shows(st, method, manner, x, &ratio);
        if (fails && !t->found)
            *t = (bb_threshold){.found = true,
                                .from_start = x == s->axis->from,
                                .below = before,
                                .at = x,
                                .ratio = ratio};
        else if (t->found && !fails && here->outcome == BB_MEASURED)
            t->returns = true;
        before = x;
    }
}

static void settle_all(state *st)
{
    for (uint32_t m = 0; m < st->search->method_count; m++)
        for (uint32_t f = 0; f < BB_MANNERS; f++)
            settle(st, m, (bb_manner)f);
}

/* Returns the value that halves a threshold's interval; NAN: none is left. */
static double middle_of(const bb_search *s, const bb_threshold *t)
{
    double middle;
    return t->found && !t->from_start && bb_axis_middle(s->axis, t->below, t->at, &middle) ? middle
                                                                                           : NAN;
}

/* Measures one step of all bisections together. *more is false when all are done. */
static bb_status halve(state *st, bool *more)
{
    bb_search *s = st->search;
    double values[BB_WISHES_MAX];
    bb_status status = BB_OK;
    for (uint32_t m = 0; m < s->method_count && status == BB_OK; m++)
        for (uint32_t f = 0; f < BB_MANNERS && status == BB_OK; f++) {
            const double middle = middle_of(s, &s->thresholds[m][f]);
            bb_wish *wish = NULL;
            if (isnan(middle))
                continue;
            status = wish_for(st, middle, &wish);
            if (status == BB_OK)
                wish->wanted[m] = true;
        }
    const uint32_t count = st->wish_count;
    *more = count > 0;
    for (uint32_t i = 0; i < count; i++)
        values[i] = st->wishes[i].x;
    if (status == BB_OK)
        status = grant(st);
    drop_wishes(st);
    if (status == BB_OK && !bb_interrupted())
        status = look_again(st, values, count);
    if (status == BB_OK)
        settle_all(st);
    return status;
}

bb_status bb_search_run(bb_search *s)
{
    double values[BB_AXIS_POINTS_MAX + 4];
    uint32_t count = bb_axis_values(s->axis, s->intervals, values);
    state st = {.search = s,
                .wishes = calloc(BB_WISHES_MAX, sizeof(bb_wish)),
                .looks = calloc(BB_PROBES_MAX, sizeof(second_look))};
    bb_status status = st.looks == NULL || st.wishes == NULL
                           ? bb_fail(BB_FAILED, "axis %s: no memory", s->axis->name)
                           : look_end_to_end(&st, values, count);
    if (status == BB_OK)
        settle_all(&st);
    bool more = true;
    for (uint32_t i = 0; i < s->bisections && more && status == BB_OK && !bb_interrupted(); i++)
        status = halve(&st, &more);
    for (uint32_t i = 0; i < st.look_count; i++) {
        free(st.looks[i].here);
        free(st.looks[i].normal);
    }
    free(st.looks);
    free(st.wishes);
    return status;
}

void bb_search_free(bb_search *s)
{
    for (uint32_t i = 0; i < s->probe_count; i++)
        free(s->probes[i].figures);
    s->probe_count = 0;
}
