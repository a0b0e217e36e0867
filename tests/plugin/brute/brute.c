/* A tracer without a tree, for tests: brute force in doubles; or one that breaks a promise. */
#include "framework/builder/tracer.h"

#include <fenv.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const bb_option options[] = {
    {"kind", "right",
     "right|blind|crashes|crashes-early|hangs|fewer|rays|scene|scene-last|threads|greedy|fails|"
     "fails-late|lacks|lacks-late|late|lazy|floats|remembers|remembers-well|stale|late-build|pins",
     "what it does"},
    {"pace", "one", "one|two", "says how rays are passed, which changes nothing"},
    {NULL, NULL, NULL, NULL},
};

enum { FIRST = 16 }; /* rays that the harness traces within the clock of a build */

typedef struct brute {
    const bb_tracer_context *c;
    float *copy; /* of the vertices */
    uint64_t bytes;
    bool worker;
    struct memory *memories;
    atomic_bool built;
    bool passed; /* ray sets are traced: what breaks a promise in trace() waits for it */
} brute;

static bool is(const brute *b, const char *kind)
{
    return bb_spec_is(b->c->spec, options, "kind", kind);
}

static void *work(void *nothing)
{
    (void)nothing;
    for (volatile uint64_t i = 0; i < UINT64_MAX; i++)
        if (i % 1000000 == 0)
            pthread_testcancel();
    return NULL;
}

static double seconds(clockid_t which)
{
    struct timespec now;
    clock_gettime(which, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void toil_for(double time)
{
    const double start = seconds(CLOCK_MONOTONIC);
    while (seconds(CLOCK_MONOTONIC) - start < time) {
    }
}

/* Works until the process has taken clearly more than one processor, or, on a busy machine, until
 * twenty seconds are over since the first call. */
static void *toil(void *nothing)
{
    static _Atomic double first;
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), start = seconds(CLOCK_MONOTONIC);
    double wall = 0, taken = 0, none = 0;
    atomic_compare_exchange_strong(&first, &none, start);
    while (start + wall - first < 20 && (wall < 0.05 || taken < 1.5 * wall)) {
        wall = seconds(CLOCK_MONOTONIC) - start;
        taken = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    }
    return nothing;
}

/* By many threads, which get most of two processors beside another program's. */
static void be_greedy(void)
{
    enum { THREADS = 16 };
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&threads[i], NULL, toil, NULL) != 0)
            abort();
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
}

static bb_status create(const bb_tracer_context *c, void **self)
{
    brute *b = calloc(1, sizeof *b);
    if (b == NULL)
        return bb_fail(BB_REFUSED, "brute: no memory");
    b->c = c;
    *self = b;
    if (is(b, "lacks"))
        return bb_fail(BB_UNSUPPORTED, "brute: this library lacks it");
    if (is(b, "crashes-early"))
        abort();
    return c->scene->view_count == 0 ? BB_OK : bb_fail(BB_FAILED, "brute: it sees views");
}

static bb_status build(void *self, bb_phases *phases)
{
    brute *b = self;
    const size_t bytes = 3 * sizeof(float) * b->c->scene->vertex_count;
    BB_TRY(bb_phase(phases, "copy"));
    if (is(b, "stale") && b->copy != NULL)
        return bb_phase(phases, NULL);
    free(b->copy);
    b->copy = malloc(bytes);
    if (b->copy == NULL)
        return bb_fail(BB_REFUSED, "brute: no memory");
    memcpy(b->copy, b->c->scene->vertices, bytes);
    b->bytes = bytes;
    b->built = !is(b, "lazy") && !is(b, "late-build");
    if (is(b, "fails") || is(b, "scene-last"))
        return bb_fail(BB_FAILED, "brute: cannot build");
    if (is(b, "scene"))
        b->c->scene->vertices[0] += 1;
    if (is(b, "threads") && !b->worker) {
        pthread_t thread;
        b->worker = pthread_create(&thread, NULL, work, NULL) == 0;
    }
    const struct timespec nap = {0, 200000}; /* a build takes some time */
    nanosleep(&nap, NULL);
    return bb_phase(phases, NULL);
}

static bb_status pass(void *self, const bb_spec *spec)
{
    (void)spec;
    ((brute *)self)->passed = true;
    return is(self, "lacks-late") ? bb_fail(BB_UNSUPPORTED, "brute: it lacks that") : BB_OK;
}

static double triple(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Signed volumes: the ray passes the triangle if all edges are on one side. */
static double meet(const brute *b, const bb_ray *ray, uint32_t triangle)
{
    double v[3][3], d[3], volume[3], sum = 0, t = 0;
    for (int k = 0; k < 3; k++) {
        const uint32_t vertex = bb_scene_indices(b->c->scene)[3 * triangle + (uint32_t)k];
        for (int x = 0; x < 3; x++)
            v[k][x] = (double)b->copy[3 * vertex + (uint32_t)x] - ray->o[x];
    }
    for (int x = 0; x < 3; x++)
        d[x] = ray->d[x];
    for (int k = 0; k < 3; k++)
        sum += volume[k] = triple(d, v[(k + 1) % 3], v[(k + 2) % 3]);
    const bool inside = (volume[0] >= 0 && volume[1] >= 0 && volume[2] >= 0) ||
                        (volume[0] <= 0 && volume[1] <= 0 && volume[2] <= 0);
    if (!inside || sum == 0)
        return INFINITY;
    for (int x = 0, most = 0; x < 3; x++) {
        most = fabs(d[x]) > fabs(d[most]) ? x : most;
        if (x == 2)
            t = (volume[0] * v[0][most] + volume[1] * v[1][most] + volume[2] * v[2][most]) / sum /
                d[most];
    }
    return t > ray->tmin && t < ray->tmax ? t : INFINITY;
}

static void answer(const brute *b, const bb_ray *rays, uint32_t count, bb_hit *hits)
{
    for (uint32_t i = 0; i < count; i++) {
        hits[i] = (bb_hit){INFINITY, BB_NONE};
        for (uint32_t p = 0; p < b->c->scene->prim_count && !is(b, "blind"); p++) {
            const double t = meet(b, &rays[i], p);
            if (t < hits[i].t)
                hits[i] = (bb_hit){(float)t, p};
        }
    }
}

typedef struct later {
    const brute *brute;
    const bb_ray *rays;
    uint32_t count;
    bb_hit *hits;
} later;

static void *answer_later(void *what)
{
    later *l = what;
    toil_for(0.02);
    answer(l->brute, l->rays, l->count, l->hits);
    free(l);
    return NULL;
}

static bb_status answer_behind(const brute *b, const bb_ray *rays, uint32_t count, bb_hit *hits)
{
    pthread_t thread;
    later *l = malloc(sizeof *l);
    if (l == NULL)
        return bb_fail(BB_REFUSED, "brute: no memory");
    *l = (later){b, rays, count, hits};
    for (uint32_t i = 0; i < count; i++)
        hits[i] = (bb_hit){INFINITY, BB_NONE};
    if (pthread_create(&thread, NULL, answer_later, l) != 0)
        abort();
    pthread_detach(thread);
    return BB_OK;
}

/* What it was asked, and how it answered. */
typedef struct memory {
    struct memory *next;
    const bb_ray *at; /* where the rays were */
    bb_ray first;
    uint32_t count;
    bool any;
    bb_hit hits[];
} memory;

static memory *remember(const brute *b, const bb_ray *rays, uint32_t count, bool any)
{
    for (memory *m = b->memories; m != NULL; m = m->next)
        if (m->at == rays && m->count == count && m->any == any &&
            (is(b, "remembers") || memcmp(&m->first, rays, sizeof m->first) == 0))
            return m;
    return NULL;
}

/* Takes its time for what it does not remember. */
static bb_status answer_by_memory(brute *b, const bb_ray *rays, uint32_t count, bool any,
                                  bb_hit *hits)
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&lock);
    memory *m = remember(b, rays, count, any);
    if (m == NULL) {
        m = malloc(sizeof *m + count * sizeof *hits);
        if (m == NULL)
            abort();
        *m = (memory){b->memories, rays, rays[0], count, any};
        toil_for(0.005);
        answer(b, rays, count, m->hits);
        b->memories = m;
    }
    memcpy(hits, m->hits, count * sizeof *hits);
    pthread_mutex_unlock(&lock);
    return BB_OK;
}

/* Keeps any thread but the first on one processor; that one leaves work to the others. */
static void pin_thread(void)
{
    cpu_set_t one;
    if (gettid() == getpid()) {
        toil_for(0.005);
        return;
    }
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);
}

static bb_status trace(void *self, const bb_ray *rays, uint32_t count, bool any, bb_hit *hits)
{
    brute *b = self;
    const bool passed = b->passed;
    (void)any; /* the closest is one of them */
    if (passed && is(b, "crashes"))
        abort();
    while (passed && is(b, "hangs"))
        pause();
    if (passed && is(b, "greedy"))
        be_greedy();
    if (passed && is(b, "fails-late"))
        return bb_fail(BB_FAILED, "brute: cannot trace");
    if (passed && is(b, "late"))
        return answer_behind(b, rays, count, hits);
    if (passed && (is(b, "remembers") || is(b, "remembers-well")))
        return answer_by_memory(b, rays, count, any, hits);
    if (passed && is(b, "rays"))
        ((bb_ray *)rays)[0].o[0] += 1;
    if (passed && is(b, "floats"))
        fesetround(FE_UPWARD);
    if (is(b, "late-build") && count > FIRST && !atomic_exchange(&b->built, true))
        toil_for(0.02);
    if (passed && is(b, "pins"))
        pin_thread();
    if (is(b, "lazy") && !atomic_exchange(&b->built, true)) { /* as long as it has no tree */
        for (uint32_t i = 0; i < count; i++)
            hits[i] = (bb_hit){INFINITY, BB_NONE};
        return BB_OK;
    }
    answer(b, rays, passed && is(b, "fewer") ? count - 1 : count, hits);
    return BB_OK;
}

static uint64_t bytes(void *self)
{
    return ((brute *)self)->bytes;
}

static bb_status describe(void *self, char *text, size_t capacity)
{
    (void)self;
    strncpy(text, "brute 1.0", capacity);
    return BB_OK;
}

static void destroy(void *self)
{
    brute *b = self;
    if (is(b, "scene-last"))
        b->c->scene->vertices[0] += 1;
    for (memory *m = b->memories, *next; m != NULL; m = next) {
        next = m->next;
        free(m);
    }
    free(b->copy);
    free(b);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "brute,brute:pace=two"},
    {.devices = 0},
};

extern const bb_tracer bb_tracer_brute;
const bb_tracer bb_tracer_brute = {
    .abi_version = BB_TRACER_ABI_VERSION,
    .name = "brute",
    .summary = "brute force, for tests",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .options = options,
    .passing = "pace",
    .exactness = "kind",
    .variants = variants,
    .create = create,
    .build = build,
    .pass = pass,
    .trace = trace,
    .bytes = bytes,
    .describe = describe,
    .destroy = destroy,
};
