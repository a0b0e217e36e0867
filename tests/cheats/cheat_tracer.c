/* A tracer that is exact, and one that cheats on purpose: what the judge is tested with.
 *
 *     cheat_tracer RAYS HITS [--cheat KIND]
 *
 * finds the exact nearest hits of a rays file by brute force and answers them, or, by KIND:
 *
 *   all-miss       every ray misses
 *   something      any hit: "something" for every ray
 *   unnamed        "something" for every hit, where the primitive is asked for
 *   every-N        every N-th ray misses
 *   stale          the answer of the ray before
 *   behind         the second hit
 *   small-S        primitives smaller than S of the scene are not there
 *   detail-S       the second hit, if the first one's primitive is smaller than S of the second's
 *   margin         the farthest hit that is within the judge's margin of those before it
 *   neighbour      another primitive at the same edge, with the same t
 *   number+1       the next primitive, with the same t
 *   t-E            t times 1 + E for even rays, 1 - E for odd ones
 *   beyond         where no hit counts, one that lies outside of (tmin, tmax)
 *   self           the last hit before tmin as if it came right after it: where the ray starts
 *
 * Prints one line: rays, hits of the exact tracer, answers that the cheat altered, and how many of
 * these are plainly wrong, by more than the margin. (The judge lets a few of them pass: where one
 * of the ray's eight copies goes by a silhouette.)
 */
#include "tests/cheats/exact_trace.h"
#include "tests/cheats/margin.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct job {
    scene scene;
    workspace work;
    const char *kind;
    double amount;    /* the number in the name of the cheat */
    bool *dropped;    /* per primitive */
    exact_hit *exact; /* per ray */
    bb_hit *hits;
} job;

static const bb_hit miss = {INFINITY, BB_NONE};

/* ---- hits ---- */

/* What counts of a ray as it is asked. */
static exact_hit first_hit(job *j, uint32_t ray, const bool *dropped)
{
    const bb_ray *r = &j->scene.rays[ray];
    query q = {.high = (double)r->tmax, .dropped = dropped};
    mpq_init(q.low);
    mpq_set_d(q.low, (double)r->tmin);
    exact_hit hit = trace_exactly(&j->work, r, &q);
    mpq_clear(q.low);
    return hit;
}

/* The nearest hit behind another one, up to t = high. */
static exact_hit next_hit(job *j, uint32_t ray, const exact_hit *hit, double high)
{
    const bb_ray *r = &j->scene.rays[ray];
    query q = {.high = high};
    mpq_init(q.low);
    exact_t(&j->scene, r, hit, q.low);
    exact_hit next = trace_exactly(&j->work, r, &q);
    mpq_clear(q.low);
    return next;
}

/* The nearest hit between two t, whatever the ray's own are. */
static exact_hit hit_between(job *j, uint32_t ray, double low, double high)
{
    query q = {.high = high};
    mpq_init(q.low);
    mpq_set_d(q.low, low);
    exact_hit hit = trace_exactly(&j->work, &j->scene.rays[ray], &q);
    mpq_clear(q.low);
    return hit;
}

static bb_hit answer(const exact_hit *hit)
{
    return (bb_hit){hit->t, hit->prim};
}

/* ---- the cheats: the answer to a ray; those that hide hits get at least one ---- */

static bb_hit be_honest(job *j, uint32_t i)
{
    return answer(&j->exact[i]);
}

static bb_hit miss_all(job *j, uint32_t i)
{
    (void)j;
    (void)i;
    return miss;
}

static bb_hit say_something(job *j, uint32_t i)
{
    (void)j;
    (void)i;
    return (bb_hit){0, BB_UNNAMED};
}

static bb_hit leave_unnamed(job *j, uint32_t i)
{
    return j->exact[i].prim == BB_NONE ? miss : (bb_hit){j->exact[i].t, BB_UNNAMED};
}

static bb_hit miss_every(job *j, uint32_t i)
{
    return (i + 1) % (uint32_t)j->amount == 0 ? miss : be_honest(j, i);
}

static bb_hit repeat_last(job *j, uint32_t i)
{
    return be_honest(j, i > 0 ? i - 1 : 0);
}

static bb_hit take_second(job *j, uint32_t i)
{
    exact_hit next = next_hit(j, i, &j->exact[i], (double)j->scene.rays[i].tmax);
    return next.prim == BB_NONE ? be_honest(j, i) : answer(&next);
}

static bb_hit drop_small(job *j, uint32_t i)
{
    exact_hit hit = j->exact[i];
    if (j->dropped[hit.prim])
        hit = first_hit(j, i, j->dropped);
    return answer(&hit);
}

static bool is_detail(const job *j, uint32_t i, const exact_hit *hit, const exact_hit *behind)
{
    (void)i;
    return size_of(&j->scene, hit->prim) < j->amount * size_of(&j->scene, behind->prim);
}

static bool is_in_margin(const job *j, uint32_t i, const exact_hit *hit, const exact_hit *behind)
{
    (void)hit;
    return (double)behind->t - (double)j->exact[i].t <
           0.99 * eps_of(&j->scene, &j->scene.rays[i], behind->prim);
}

/* Goes through all hits of the ray, and takes those that may replace the one taken before. */
static bb_hit take_behind(job *j, uint32_t i,
                          bool (*replaces)(const job *j, uint32_t i, const exact_hit *hit,
                                           const exact_hit *behind))
{
    exact_hit taken = j->exact[i], hit = taken;
    while ((hit = next_hit(j, i, &hit, (double)j->scene.rays[i].tmax)).prim != BB_NONE)
        if (replaces(j, i, &taken, &hit))
            taken = hit;
    return answer(&taken);
}

static bb_hit drop_detail(job *j, uint32_t i)
{
    return take_behind(j, i, is_detail);
}

static bb_hit use_margin(job *j, uint32_t i)
{
    return take_behind(j, i, is_in_margin);
}

/* Whether the triangles have two corners in common, by place, and not all three. */
static bool share_an_edge(const scene *s, uint32_t a, uint32_t b)
{
    int common = 0;
    for (int i = 0; i < 3; i++) {
        const float *v = s->vertices[s->indices[a][i]];
        bool found = false;
        for (int k = 0; k < 3; k++)
            found |= memcmp(v, s->vertices[s->indices[b][k]], 3 * sizeof *v) == 0;
        common += found;
    }
    return common == 2;
}

static bb_hit name_neighbour(job *j, uint32_t i)
{
    bb_hit hit = be_honest(j, i);
    for (uint32_t b = 0; hit.prim < j->scene.triangles && b < j->scene.triangles; b++)
        if (share_an_edge(&j->scene, hit.prim, b))
            return (bb_hit){hit.t, b};
    return hit;
}

static bb_hit name_next(job *j, uint32_t i)
{
    bb_hit hit = be_honest(j, i);
    hit.prim = (hit.prim + 1) % j->scene.prims;
    return hit;
}

static bb_hit shift_t(job *j, uint32_t i)
{
    bb_hit hit = be_honest(j, i);
    hit.t = (float)((double)hit.t * (i % 2 == 0 ? 1 + j->amount : 1 - j->amount));
    return hit;
}

static bb_hit look_beyond(job *j, uint32_t i)
{
    const bb_ray *ray = &j->scene.rays[i];
    if (j->exact[i].prim != BB_NONE)
        return be_honest(j, i);
    exact_hit hit = {BB_NONE, 0, INFINITY};
    if (isfinite(ray->tmax))
        hit = hit_between(j, i, (double)ray->tmax, INFINITY);
    if (hit.prim == BB_NONE)
        hit = hit_between(j, i, -0x1p200, (double)ray->tmin);
    return answer(&hit);
}

static bb_hit hit_itself(job *j, uint32_t i)
{
    double tmin = (double)j->scene.rays[i].tmin;
    exact_hit hit = hit_between(j, i, -0x1p200, tmin);
    if (hit.prim == BB_NONE)
        return be_honest(j, i);
    for (exact_hit next; (next = next_hit(j, i, &hit, tmin)).prim != BB_NONE;)
        hit = next;
    return (bb_hit){nextafterf((float)tmin, INFINITY), hit.prim};
}

typedef struct cheat {
    const char *name;
    bool counts; /* a number follows the name */
    bool all;    /* also asked about rays that miss */
    bb_hit (*ask)(job *j, uint32_t ray);
} cheat;

static const cheat cheats[] = {
    {"none", false, true, be_honest},
    {"all-miss", false, true, miss_all},
    {"something", false, true, say_something},
    {"unnamed", false, true, leave_unnamed},
    {"every-", true, false, miss_every},
    {"stale", false, true, repeat_last},
    {"behind", false, false, take_second},
    {"small-", true, false, drop_small},
    {"detail-", true, false, drop_detail},
    {"margin", false, false, use_margin},
    {"neighbour", false, false, name_neighbour},
    {"number+1", false, false, name_next},
    {"t-", true, false, shift_t},
    {"beyond", false, true, look_beyond},
    {"self", false, true, hit_itself},
};

/* NULL if there is none of that name. */
static const cheat *find_cheat(const char *kind, double *amount)
{
    for (size_t i = 0; i < sizeof cheats / sizeof cheats[0]; i++) {
        size_t length = strlen(cheats[i].name);
        char *end = NULL;
        if (!cheats[i].counts && strcmp(kind, cheats[i].name) == 0)
            return &cheats[i];
        if (!cheats[i].counts || strncmp(kind, cheats[i].name, length) != 0)
            continue;
        *amount = strtod(kind + length, &end);
        if (end != kind + length && *end == '\0' && *amount > 0 && *amount < 1e9)
            return &cheats[i];
    }
    return NULL;
}

/* ---- what the cheat comes to ---- */

/* Whether the line meets the primitive at t and within the ray's limits, but for the margin. */
static bool is_on(const job *j, const bb_ray *ray, const bb_hit *hit)
{
    bool on = false;
    double margin = margin_of(&j->scene, ray, hit->prim);
    mpq_t t;
    mpq_init(t);
    for (int root = 0; root < 2; root++) {
        exact_hit at = {hit->prim, root, 0};
        on |= exact_t(&j->scene, ray, &at, t) && fabs(mpq_get_d(t) - (double)hit->t) <= margin;
    }
    mpq_clear(t);
    return on && (double)hit->t >= (double)ray->tmin - margin &&
           (double)hit->t <= (double)ray->tmax + margin;
}

static bool is_plainly_wrong(const job *j, uint32_t i)
{
    const bb_ray *ray = &j->scene.rays[i];
    const exact_hit *exact = &j->exact[i];
    const bb_hit *hit = &j->hits[i];
    bool nothing = exact->prim == BB_NONE;
    double margin = nothing ? 0 : margin_of(&j->scene, ray, exact->prim), t = (double)exact->t;
    if (hit->prim == BB_NONE)
        return !nothing && t > (double)ray->tmin + margin && t < (double)ray->tmax - margin;
    if (hit->prim == BB_UNNAMED)
        return nothing;
    if (!is_on(j, ray, hit))
        return true;
    return j->scene.header.query == BB_EXCHANGE_CLOSEST && !nothing && (double)hit->t - t > margin;
}

static void print_summary(const job *j)
{
    uint32_t rays = (uint32_t)j->scene.header.ray_count, hits = 0, altered = 0, plain = 0;
    for (uint32_t i = 0; i < rays; i++) {
        bb_hit honest = answer(&j->exact[i]);
        hits += honest.prim != BB_NONE;
        if (memcmp(&honest, &j->hits[i], sizeof honest) == 0)
            continue;
        altered++;
        plain += is_plainly_wrong(j, i);
    }
    printf("rays %u hits %u altered %u plain %u\n", rays, hits, altered, plain);
}

/* ---- */

static bool reserve(const char *path, job *j)
{
    size_t rays = (size_t)j->scene.header.ray_count;
    j->dropped = calloc(j->scene.prims + 1, sizeof *j->dropped);
    j->exact = calloc(rays + 1, sizeof *j->exact);
    j->hits = calloc(rays + 1, sizeof *j->hits);
    if (workspace_init(&j->work, &j->scene) && j->dropped && j->exact && j->hits)
        return true;
    return complain(path, "more than the memory holds");
}

static void trace(job *j, const cheat *cheat)
{
    double smallest = j->amount * size_of_scene(&j->scene);
    for (uint32_t prim = 0; prim < j->scene.prims; prim++)
        j->dropped[prim] = size_of(&j->scene, prim) < smallest;
    for (uint32_t i = 0; i < j->scene.header.ray_count; i++) {
        j->exact[i] = first_hit(j, i, NULL);
        bool asked = cheat->all || j->exact[i].prim != BB_NONE;
        j->hits[i] = asked ? cheat->ask(j, i) : miss;
    }
}

int main(int argc, char **argv)
{
    job j = {.kind = argc == 5 ? argv[4] : "none"};
    bool usable = argc == 3 || (argc == 5 && strcmp(argv[3], "--cheat") == 0);
    const cheat *cheat = usable ? find_cheat(j.kind, &j.amount) : NULL;
    if (cheat == NULL) {
        fprintf(stderr, "usage: cheat_tracer RAYS HITS [--cheat KIND]\n");
        return 2;
    }
    bool ok = scene_read(argv[1], &j.scene) && reserve(argv[1], &j);
    if (ok) {
        trace(&j, cheat);
        print_summary(&j);
        ok = hits_write(argv[2], &j.scene, j.hits, j.kind);
    }
    workspace_clear(&j.work);
    free(j.dropped);
    free(j.exact);
    free(j.hits);
    scene_free(&j.scene);
    return ok ? 0 : 2;
}
