/* Classifies answers by the definitions in arbiter.h. */
#include "framework/judge/arbiter.h"

#include "framework/judge/open_way.h"
#include "framework/scene/passing.h"
#include "framework/scene/prim.h"

#include <float.h>
#include <math.h>

enum { NINE = 9, ALL_NINE = (1 << NINE) - 1, HALVINGS = 5, NEAR_MAX = 48, COVERS_MAX = 16 };

/* A corner is off by about 2^-52 of the coordinates it is computed from, which are up to 2^20
 * margins; the rest leaves room for a few roundings. */
static const double corner_error = 0x1p-29; /* in margins */
static const double clearly = 1e-6;         /* in units: is_open() rounds a point by less */
static const double inside = 0x1p-30; /* as a share of a distance: what rounding may add to it */

/* A ray being judged. */
typedef struct trial {
    const bb_scene *scene;
    const bb_ray *ray;
    bb_frame frame;
    double moves[NINE][3]; /* unit vectors perpendicular to d; the first is 0 */
} trial;

static double length_of(const bb_ray *ray)
{
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (double)ray->d[k] * (double)ray->d[k];
    return sqrt(square);
}

static const double eighth = 0.70710678118654752440;

static void begin_trial(trial *trial, const bb_scene *scene, const bb_ray *ray)
{
    const double steps[NINE][2] = {{0, 0},
                                   {1, 0},
                                   {eighth, eighth},
                                   {0, 1},
                                   {-eighth, eighth},
                                   {-1, 0},
                                   {-eighth, -eighth},
                                   {0, -1},
                                   {eighth, -eighth}};
    trial->scene = scene;
    trial->ray = ray;
    for (int k = 0; k < 3; k++) {
        trial->frame.o[k] = ray->o[k];
        trial->frame.d[k] = ray->d[k];
    }
    const double *d = trial->frame.d;
    trial->frame.length = length_of(ray);
    /* u = d cross (the axis in which d is smallest), w = d cross u. */
    int axis = fabs(d[0]) <= fabs(d[1]) && fabs(d[0]) <= fabs(d[2]) ? 0
               : fabs(d[1]) <= fabs(d[2])                           ? 1
                                                                    : 2;
    int j = (axis + 1) % 3, k = (axis + 2) % 3;
    double *u = trial->frame.across[0], *w = trial->frame.across[1];
    double flat = hypot(d[j], d[k]);
    u[axis] = 0.0;
    u[j] = d[k] / flat;
    u[k] = -d[j] / flat;
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        w[i] = (d[a] * u[b] - d[b] * u[a]) / trial->frame.length;
    }
    /* Rounded to multiples of 2^-30, so that moved origins have no bits too small for exact.c. */
    for (int n = 0; n < NINE; n++)
        for (int i = 0; i < 3; i++)
            trial->moves[n][i] = 0x1p-30 * rint(0x1p30 * (steps[n][0] * u[i] + steps[n][1] * w[i]));
}

static void moved_origin(const trial *trial, int copy, double eps, double o[3])
{
    for (int k = 0; k < 3; k++)
        o[k] = trial->frame.o[k] + eps * trial->moves[copy][k];
}

/* ---- primitives ---- */

static double margin(const bb_scene *scene, const double o[3], uint32_t prim)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return 16.0 * 0x1p-24 * kind->reach(scene, i, o);
}

double bb_margin(const bb_scene *scene, const bb_ray *ray, uint32_t prim)
{
    const double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
    return margin(scene, o, prim);
}

double bb_t_margin(const bb_scene *scene, const bb_ray *ray, uint32_t prim)
{
    return bb_margin(scene, ray, prim) / length_of(ray);
}

float bb_smallest_height(const bb_scene *scene, uint32_t prim)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return kind->height(scene, i);
}

int bb_exact_hits(const bb_scene *scene, const double o[3], const float d[3], uint32_t prim,
                  double t[2])
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return kind->hits(scene, i, o, d, t);
}

static int extended_hits(const bb_scene *scene, const double o[3], const float d[3], uint32_t prim,
                         double t[2])
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return kind->extended(scene, i, o, d, t);
}

static bb_passing pass(const trial *trial, uint32_t prim, double from, double to)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(trial->scene, prim, &i);
    return kind->pass(trial->scene, i, &trial->frame, from, to);
}

bool bb_exact_first(const bb_scene *scene, const bb_ray *ray, uint32_t prim, double *t)
{
    const double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
    double roots[2];
    int count = bb_exact_hits(scene, o, ray->d, prim, roots);
    for (int root = 0; root < count; root++) {
        double slack = 0x1p-28 * fabs(roots[root]);
        if (roots[root] < ray->tmin - slack)
            continue; /* the ray entered a sphere before tmin */
        *t = roots[root];
        return *t > ray->tmin + slack && *t < ray->tmax - slack;
    }
    return false;
}

bool bb_exact_t(const bb_scene *scene, const bb_ray *ray, uint32_t prim, double near, double *t)
{
    const double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
    double roots[2];
    int count = extended_hits(scene, o, ray->d, prim, roots);
    if (count == 0)
        return false;
    *t = count == 1 || fabs(roots[0] - near) <= fabs(roots[1] - near) ? roots[0] : roots[1];
    return true;
}

/* ---- a reported primitive: do the nine hit it, and where? ---- */

typedef struct spread {
    bool near_miss;         /* none of the nine hits, but the ray passes within eps */
    int hits;               /* how many of the nine hit within the interval grown by eps */
    double low[2], high[2]; /* ranges of the (two) values of t, not yet grown by eps */
} spread;

static void widen(spread *s, int root, double t)
{
    s->low[root] = fmin(s->low[root], t);
    s->high[root] = fmax(s->high[root], t);
}

static int nearby(const trial *trial, uint32_t prim, const double o[3], double eps, double t[2])
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(trial->scene, prim, &i);
    return kind->nearby(trial->scene, i, o, trial->ray->d, eps, t);
}

/* Adds t of the copies that pass the primitive: their nearest t if it is within eps, else the
 * primitive's whole extent. A farther copy adds nothing once both roots of another are known. */
static void widen_by_passing(const trial *trial, uint32_t prim, double eps, spread *s)
{
    bb_passing p = pass(trial, prim, -INFINITY, INFINITY);
    bool two = false;
    for (int copy = 0; copy < NINE; copy++) {
        double o[3], t[2];
        moved_origin(trial, copy, eps, o);
        int count = nearby(trial, prim, o, eps, t);
        if (count == 1)
            widen(s, 0, fmin(fmax(t[0], p.t_low), p.t_high));
        for (int root = 0; root < 2 && count == 2; root++)
            widen(s, root, t[root]);
        two = two || count == 2;
        for (int root = 0; root < 2 && count == 0 && !two; root++) {
            widen(s, root, p.t_low);
            widen(s, root, p.t_high);
        }
    }
}

static spread spread_over(const trial *trial, uint32_t prim, double eps)
{
    spread s = {.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
    double e = eps / trial->frame.length;
    double tmin = trial->ray->tmin - e, tmax = trial->ray->tmax + e;
    for (int copy = 0; copy < NINE; copy++) {
        double o[3], t[2];
        moved_origin(trial, copy, eps, o);
        int count = bb_exact_hits(trial->scene, o, trial->ray->d, prim, t);
        bool inside = false;
        for (int root = 0; root < count; root++)
            if (t[root] >= tmin && t[root] <= tmax) {
                widen(&s, root, t[root]);
                inside = true;
            }
        s.hits += inside;
    }
    if (s.hits == NINE)
        return s;
    if (s.hits == 0) {
        bb_passing p = pass(trial, prim, tmin, tmax);
        s.near_miss = p.distance <= eps;
    }
    if (s.hits > 0 || s.near_miss)
        widen_by_passing(trial, prim, eps, &s);
    return s;
}

/* ---- does every one of the nine hit something? ---- */

typedef struct search {
    const trial *trial;
    double limit;   /* a hit counts only below this t; INFINITY: any */
    uint32_t prim;  /* the reported primitive, whose hit does not count; BB_NONE: none */
    int root;       /* which of its hits that is: 0 or 1, the second one of a sphere */
    double common;  /* the distance by which all copies are moved; 0: each primitive's own eps */
    double most;    /* primitives with a larger eps of their own do not count */
    double radius;  /* the share of that distance which is used */
    bool literal;   /* without a margin at the ends of the ray's interval */
    int wanted;     /* bits of the copies that have not hit anything yet */
    double largest; /* largest eps of the primitives hit by a copy */
    uint32_t found; /* the last primitive hit */
} search;

static bool hits_well(const search *search, const double o[3], uint32_t prim, double eps)
{
    const bb_ray *ray = search->trial->ray;
    double length = search->trial->frame.length, t[2];
    double end = search->literal ? 0.0 : eps / length;
    double low = ray->tmin + end;
    double high = fmin(ray->tmax - end, search->limit - eps / length);
    int count = bb_exact_hits(search->trial->scene, o, ray->d, prim, t);
    for (int root = 0; root < count; root++)
        if (t[root] > low && t[root] < high && !(prim == search->prim && root == search->root))
            return true;
    return false;
}

static bool search_primitive(void *context, uint32_t prim)
{
    search *search = context;
    double eps = margin(search->trial->scene, search->trial->frame.o, prim);
    for (int copy = 0; copy < NINE && eps <= search->most; copy++) {
        if ((search->wanted >> copy & 1) == 0)
            continue;
        double o[3], distance = search->common > 0.0 ? search->common : eps;
        moved_origin(search->trial, copy, search->radius * distance, o);
        if (hits_well(search, o, prim, eps)) {
            search->wanted &= ~(1 << copy);
            search->largest = fmax(search->largest, eps);
            search->found = prim;
        }
    }
    return search->wanted == 0;
}

static bool all_found(const bb_arbiter *arbiter, search *search, int wanted, double common,
                      double radius)
{
    bb_probe probe;
    search->radius = radius;
    bb_probe_make(search->trial->ray, &probe);
    probe.tmax = fmin(probe.tmax, search->limit);
    probe.grow = search->common = common;
    search->wanted = wanted;
    bb_box_tree_visit(arbiter->tree, &probe, search_primitive, search);
    return search->wanted == 0;
}

/* ---- what the nine leave open ---- */

/* Primitives near the ray. */
typedef struct gap {
    const bb_arbiter *arbiter;
    const search *search;
    double common;                 /* as in search */
    bb_outline outlines[NEAR_MAX]; /* the search is between their sides */
    uint32_t count;
    /* Where a primitive is certainly hit: the outlines, slightly shortened along the ray, and
     * others that may hide much. */
    bb_cover covers[NEAR_MAX + COVERS_MAX];
    uint32_t cover_count;
    bool scaled_alike; /* outlines scaled by the common eps, else by each primitive's own */
} gap;

/* Returns whether the outline may hide much of the unit disc. */
static bool is_large(const bb_outline *outline)
{
    double most = 0;
    for (uint32_t c = 0; c < outline->count; c++)
        most = fmax(most, hypot(outline->corners[c][0], outline->corners[c][1]));
    return most > 1;
}

/* Computes the primitive's flat parts between two distances, in units. */
static uint32_t see(const trial *trial, uint32_t prim, double from, double to, double unit,
                    bb_outline parts[BB_OUTLINES_MAX])
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(trial->scene, prim, &i);
    uint32_t count = kind->outlines(trial->scene, i, &trial->frame, from, to, parts);
    for (uint32_t part = 0; part < count; part++)
        for (uint32_t c = 0; c < parts[part].count; c++)
            for (int k = 0; k < 2; k++)
                parts[part].corners[c][k] /= unit;
    return count;
}

/* Adds the primitive's outlines, scaled so that the disc of the nine is the unit disc, and covers.
 * Covers only save time, so too few of them do no harm. */
static bool add_outline(void *context, uint32_t prim)
{
    gap *g = context;
    const trial *trial = g->search->trial;
    double eps = margin(trial->scene, trial->frame.o, prim), end = eps / trial->frame.length;
    double unit = g->scaled_alike ? g->common : eps;
    double from = trial->ray->tmin + end, to = fmin(trial->ray->tmax, g->search->limit) - end;
    if (prim == g->search->prim || eps > g->search->most ||
        pass(trial, prim, from, to).distance > unit)
        return false;
    bb_outline parts[BB_OUTLINES_MAX];
    uint32_t count = see(trial, prim, from, to, unit, parts);
    bool shown = g->count < NEAR_MAX;
    for (uint32_t part = 0; part < count && g->count < NEAR_MAX; part++)
        g->outlines[g->count++] = parts[part];
    const double clear = fmax(clearly, corner_error * eps / unit);
    const double last = isfinite(to) ? to - inside * fabs(to) : to;
    count = see(trial, prim, from + inside * fabs(from), last, unit, parts);
    for (uint32_t part = 0; part < count && g->cover_count < NEAR_MAX + COVERS_MAX; part++)
        if (shown || is_large(&parts[part]))
            g->covers[g->cover_count++] = (bb_cover){parts[part], clear};
    return g->cover_count == NEAR_MAX + COVERS_MAX;
}

static bool is_open(void *context, double x, double y)
{
    const gap *g = context;
    trial moved = *g->search->trial;
    search search = *g->search;
    for (int k = 0; k < 3; k++)
        moved.moves[1][k] =
            0x1p-30 * rint(0x1p30 * (x * moved.frame.across[0][k] + y * moved.frame.across[1][k]));
    search.trial = &moved;
    bool own = search.most == INFINITY && all_found(g->arbiter, &search, 1 << 1, 0.0, 1.0);
    return !own && !all_found(g->arbiter, &search, 1 << 1, g->common, 1.0);
}

/* The nine are a sample of the disc of radius eps: near a corner, the way between primitives may be
 * narrower than the angles between the eight. */
static bool has_gap(const bb_arbiter *arbiter, const search *search, double common)
{
    gap g = {.arbiter = arbiter, .search = search, .common = common};
    for (int alike = 0; alike < 2; alike++) {
        bb_probe probe;
        bb_probe_make(search->trial->ray, &probe);
        probe.grow = common;
        g.count = g.cover_count = 0;
        g.scaled_alike = alike;
        bb_box_tree_visit(arbiter->tree, &probe, add_outline, &g);
        /* Inside an outline the primitive is hit, by the common eps or by its own. */
        const bool closed = alike == 1 || search->most == INFINITY;
        if (bb_find_open_way(g.outlines, g.count, g.covers, closed ? g.cover_count : 0, is_open,
                             &g))
            return true;
    }
    return false;
}

/* Returns whether the whole disc is closed, tested at smaller and smaller distances and between
 * sides. Copies are moved by `common` or, if all primitives count, by each primitive's own eps. */
static bool is_closed(const bb_arbiter *arbiter, search search, double common)
{
    for (int halvings = 0; halvings <= HALVINGS; halvings++) {
        double radius = ldexp(1.0, -halvings);
        bool own = search.most == INFINITY && all_found(arbiter, &search, ALL_NINE, 0.0, radius);
        if (!own && !all_found(arbiter, &search, ALL_NINE, common, radius))
            return false;
    }
    return !has_gap(arbiter, &search, common);
}

/* The different eps of the primitives that the ray itself hits. */
typedef struct own_hits {
    const search *search;
    double eps[NEAR_MAX];
    uint32_t count;
} own_hits;

static bool add_own_hit(void *context, uint32_t prim)
{
    own_hits *own = context;
    const trial *trial = own->search->trial;
    double o[3], eps = margin(trial->scene, trial->frame.o, prim);
    moved_origin(trial, 0, 0.0, o);
    if (!hits_well(own->search, o, prim, eps))
        return false;
    for (uint32_t i = 0; i < own->count; i++)
        if (own->eps[i] == eps)
            return false;
    own->eps[own->count++] = eps;
    return own->count == NEAR_MAX;
}

/* Returns whether all of the nine hit something nearer than the search's limit by more than its
 * margin. The margin of the reported primitive does not matter: a kernel that finds both takes the
 * one it computes as nearer, and answers for the t it reports. The ray itself is tested first: in
 * most cases it hits nothing there, and the eight are not needed.
 *
 * Each of the nine may hit something and the way between them still be open: where primitives are
 * no larger than eps, or near a corner. A primitive of large eps that is hit as well must not open
 * a way that primitives of smaller eps close, so these are also tested alone. */
static bool nine_hit(const bb_arbiter *arbiter, search search)
{
    if (!all_found(arbiter, &search, 1, 0.0, 1.0))
        return false;
    search.wanted = ALL_NINE;
    if (search_primitive(&search, search.found))
        return true; /* primitives are convex: nothing between the nine is open */
    (void)all_found(arbiter, &search, ALL_NINE, 0.0, 1.0); /* finds the largest eps */
    double largest = search.largest;
    if (is_closed(arbiter, search, largest))
        return true;
    own_hits own = {.search = &search};
    bb_probe probe;
    bb_probe_make(search.trial->ray, &probe);
    probe.tmax = fmin(probe.tmax, search.limit);
    bb_box_tree_visit(arbiter->tree, &probe, add_own_hit, &own);
    for (uint32_t i = 0; i < own.count; i++) {
        search.most = own.eps[i];
        if (search.most < largest && is_closed(arbiter, search, search.most))
            return true;
    }
    return false;
}

static bool nine_hit_by_the_letter(const bb_arbiter *arbiter, const trial *trial, double limit)
{
    search search = {
        .trial = trial, .limit = limit, .prim = BB_NONE, .most = INFINITY, .literal = true};
    return all_found(arbiter, &search, 1, 0.0, 1.0) &&
           all_found(arbiter, &search, ALL_NINE, 0.0, 1.0);
}

/* ---- answers ---- */

static bool find_any(void *context, uint32_t prim)
{
    search *search = context;
    double eps = margin(search->trial->scene, search->trial->frame.o, prim);
    spread s = spread_over(search->trial, prim, eps);
    if (s.hits > 0 || s.near_miss)
        search->wanted = 0;
    return search->wanted == 0;
}

/* Judges an answer that says that something was hit, but not what. */
static bb_class judge_occluded(const bb_arbiter *arbiter, const trial *trial)
{
    search search = {.trial = trial, .prim = BB_NONE, .most = INFINITY, .wanted = 1};
    bb_probe probe;
    bb_probe_make(trial->ray, &probe);
    bb_box_tree_visit(arbiter->tree, &probe, find_any, &search);
    return search.wanted == 0 ? BB_RIGHT : BB_FALSE_HIT;
}

/* Returns the root, 0 or 1, at which the ray itself hits the primitive within eps of the reported
 * t, else -1. After such a hit the eight copies could only widen the allowed range, and are not
 * needed. */
static int root_hit(const trial *trial, const bb_hit *hit, double e)
{
    double t[2];
    int count = bb_exact_hits(trial->scene, trial->frame.o, trial->ray->d, hit->prim, t);
    for (int root = 0; root < count; root++)
        if (fabs((double)hit->t - t[root]) <= e && t[root] >= trial->ray->tmin &&
            t[root] <= trial->ray->tmax)
            return root;
    return -1;
}

static bb_class judge_hit(const bb_arbiter *arbiter, const trial *trial, const bb_hit *hit,
                          const bb_query *query)
{
    double eps = margin(trial->scene, trial->frame.o, hit->prim), e = eps / trial->frame.length;
    double t = hit->t;
    int root = root_hit(trial, hit, e);
    if (root < 0) {
        spread s = spread_over(trial, hit->prim, eps);
        if (s.hits == 0 && !s.near_miss)
            return BB_FALSE_HIT;
        bool inside = t >= trial->ray->tmin - e && t <= trial->ray->tmax + e;
        bool first = t >= s.low[0] - e && t <= s.high[0] + e;
        bool second = t >= s.low[1] - e && t <= s.high[1] + e;
        if (!inside || !(first || second))
            return BB_WRONG_T;
        root = first ? 0 : 1;
    }
    const search nearer = {
        .trial = trial, .limit = t, .prim = hit->prim, .root = root, .most = INFINITY};
    return !query->any && nine_hit(arbiter, nearer) ? BB_WRONG_T : BB_RIGHT;
}

bb_class bb_arbiter_judge(const bb_arbiter *arbiter, const bb_ray *ray, const bb_hit *hit,
                          const bb_query *query, bool must_hit)
{
    if (hit->prim == BB_NONE && must_hit)
        return BB_MISSED;
    trial trial;
    begin_trial(&trial, arbiter->scene, ray);
    const search any = {.trial = &trial, .limit = INFINITY, .prim = BB_NONE, .most = INFINITY};
    if (hit->prim == BB_NONE)
        return nine_hit(arbiter, any) ? BB_MISSED : BB_RIGHT;
    if (query->any && hit->prim == BB_UNNAMED)
        return judge_occluded(arbiter, &trial);
    return judge_hit(arbiter, &trial, hit, query);
}

bool bb_arbiter_forgives(const bb_arbiter *arbiter, const bb_ray *ray, const bb_hit *hit,
                         const bb_query *query)
{
    trial trial;
    begin_trial(&trial, arbiter->scene, ray);
    if (hit->prim == BB_NONE)
        return nine_hit_by_the_letter(arbiter, &trial, INFINITY);
    if (!query->any && nine_hit_by_the_letter(arbiter, &trial, hit->t))
        return true;
    double t[2];
    if ((query->any && hit->prim == BB_UNNAMED) ||
        bb_exact_hits(trial.scene, trial.frame.o, trial.ray->d, hit->prim, t) > 0)
        return false;
    return spread_over(&trial, hit->prim, margin(trial.scene, trial.frame.o, hit->prim)).hits == 0;
}

bb_status bb_arbiter_create(const bb_scene *scene, bb_arbiter *arbiter)
{
    arbiter->scene = scene;
    return bb_box_tree_create(scene->boxes, scene->prim_count, &arbiter->tree);
}

void bb_arbiter_destroy(bb_arbiter *arbiter)
{
    bb_box_tree_destroy(arbiter->tree);
    arbiter->tree = NULL;
}
