#include "framework/builder/tracing.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/random.h"
#include "framework/base/steering.h"
#include "framework/base/threads.h"
#include "framework/builder/hook.h"
#include "framework/device/device_private.h"
#include "framework/scene/prim.h"
#include "framework/scene/seal.h"

#include <malloc.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <xxhash.h>

enum {
    CHUNK_LEAST = 256, /* rays of a call: a multiple of packets and streams */
    CHUNK_MOST = 2048,
    CHUNKS_EACH = 8,         /* for each thread, if there are enough rays */
    FIRST_RAYS = 16,         /* traced within the clock of a build */
    PROBES = 512,            /* traced after it: at least half as many, and at most these */
    LATE_MOST = 3,           /* builds in a row that seem to go on after their clock */
    UNSAID_HEAP = 1 << 20,   /* bytes of the heap beside those that it says it holds */
    UNSAID_LEAST = 32 << 20, /* bytes of the process beside them */
};

/* The threads that call all tracers. */
static bb_pool *pool;
static uint32_t pool_users;

/* Bytes of the heap that are in use, and those that are free but may still be resident. Always 0
 * under sanitizers, which have a heap of their own. */
typedef struct heap_bytes {
    int64_t used, free;
} heap_bytes;

struct bb_tracing {
    const bb_tracer *tracer;
    bb_device *device;
    bb_spec spec;
    bb_scene part; /* what the tracer gets of: */
    const bb_scene *scene;
    bb_tracer_context context;
    char text[512]; /* its row */
    bb_footprint footprint;
    heap_bytes heap; /* that its create() and build() have added */
    uint64_t bytes;  /* that it held after its last build */
    double create_ms;
    bool uses_pool;
    bb_random random; /* of rays; nobody can foresee it */
    uint32_t late;    /* the last so many builds seemed to go on after their clock */
    /* Of a build of the disguised scene: rays, mirrored with it, and their answers, until the next
     * build, which must give the same distances. */
    uint32_t disguised; /* 0: there is none */
    bb_ray mirrored[PROBES];
    bb_hit seen[PROBES];
    void *self;
};

static heap_bytes look_at_heap(void)
{
    const struct mallinfo2 info = mallinfo2();
    return (heap_bytes){(int64_t)(info.uordblks + info.hblkhd), (int64_t)info.fordblks};
}

static void add_to_heap(heap_bytes *sum, heap_bytes before)
{
    const heap_bytes now = look_at_heap();
    sum->used += now.used - before.used;
    sum->free += now.free - before.free;
}

static void begin(bb_tracing *t, bb_guarded whose, const char *name, bb_hook *hook)
{
    bb_hook_begin(hook, whose, t->tracer->name, name, t->scene, &t->footprint);
    hook->owner = t->text;
    hook->on_host = true;
}

static bb_guarded row_of(const bb_tracing *t)
{
    return (bb_guarded){t->scene->name, t->text};
}

/* The scene without what would tell of rays. */
static bb_scene part_of(const bb_scene *scene)
{
    bb_scene part = *scene;
    part.view_count = 0;
    memset(part.views, 0, sizeof part.views);
    memset(&part.profile, 0, sizeof part.profile);
    memset(&part.on_device, 0, sizeof part.on_device);
    memset(part.inside_point, 0, sizeof part.inside_point);
    part.closed_from_inside = false;
    part.motion = NULL;
    part.seal = NULL;
    return part;
}

static bb_status create(bb_tracing *t)
{
    bb_hook hook;
    const char *death = bb_guard_death(row_of(t));
    if (death != NULL)
        return bb_fail(BB_FAILED, "%s", death);
    begin(t, row_of(t), "create", &hook);
    const heap_bytes heap = look_at_heap();
    const double start = bb_wall_ms();
    const bb_status status = t->tracer->create(&t->context, &t->self);
    t->create_ms = bb_wall_ms() - start;
    add_to_heap(&t->heap, heap);
    return bb_hook_end(&hook, status);
}

static bb_status take_pool(bb_tracing *t)
{
    if (pool_users == 0 || bb_pool_threads(pool) != t->context.threads) {
        if (pool_users > 0)
            return bb_fail(BB_FAILED, "tracer %s: others run on %u threads, not %u", t->text,
                           bb_pool_threads(pool), t->context.threads);
        BB_TRY(bb_pool_create(t->context.threads, &pool));
    }
    pool_users++;
    t->uses_pool = true;
    return BB_OK;
}

static void leave_pool(const bb_tracing *t)
{
    if (!t->uses_pool || --pool_users > 0)
        return;
    bb_pool_destroy(pool);
    pool = NULL;
}

bb_status bb_tracing_create(bb_device *device, const char *text, const bb_scene *scene,
                            bb_tracing **out)
{
    const bb_tracer *tracer;
    bb_spec spec;
    *out = NULL;
    BB_TRY(bb_tracer_parse(text, &tracer, &spec));
    if ((scene->kinds & ~tracer->kinds) != 0)
        return bb_fail(BB_UNSUPPORTED, "tracer %s does not take the primitives of scene %s",
                       tracer->name, scene->name);
    bb_tracing *t = calloc(1, sizeof *t);
    if (t == NULL)
        return bb_fail(BB_REFUSED, "tracer %s: no memory", tracer->name);
    t->tracer = tracer;
    t->device = device;
    t->scene = scene;
    t->part = part_of(scene);
    snprintf(t->text, sizeof t->text, "%s", text);
    bb_status status = bb_spec_parse(text, &t->spec); /* a spec must not move */
    t->context = (bb_tracer_context){&t->part, &t->spec, tracer->options, bb_host_threads(device)};
    uint64_t seed = 0;
    if (getrandom(&seed, sizeof seed, 0) != (ssize_t)sizeof seed)
        seed = (uint64_t)(bb_wall_ms() * 1e6);
    t->random = bb_random_make(seed, 0);
    if (status == BB_OK)
        status = take_pool(t);
    if (status == BB_OK)
        status = create(t);
    if (status == BB_OK)
        *out = t;
    else
        bb_tracing_destroy(t);
    return status;
}

void bb_tracing_destroy(bb_tracing *t)
{
    bb_hook hook;
    if (t == NULL)
        return;
    if (t->self != NULL) {
        begin(t, row_of(t), "destroy", &hook);
        t->tracer->destroy(t->self);
        bb_hook_put_back(&hook);                 /* no row is left to fail */
        (void)bb_idle_left(&hook.idle, t->text); /* nobody else is told of its threads */
        bb_scene_put_back(t->scene);
    }
    leave_pool(t);
    free(t);
}

/* Who has threads of its own beside those that call it takes more time of processors than these
 * can. Clocks and the driver's threads are allowed a fifth. */
static bb_status check_threads(const bb_tracing *t, const bb_timing *timing, const char *hook)
{
    const double most = 1.2 * t->context.threads * timing->ms + 5;
    if (timing->cpu_ms <= most)
        return BB_OK;
    return bb_fail(
        BB_FAILED,
        "%s took %.0f ms of processors in %s(), which %u threads cannot take in %.0f ms: "
        "it has more",
        t->tracer->name, timing->cpu_ms, hook, t->context.threads, timing->ms);
}

/* Rays from random points of the scene's box towards random primitives. */
static void make_rays(bb_tracing *t, bb_ray *rays, uint32_t count)
{
    const bb_box *all = &t->scene->bounds;
    for (uint32_t i = 0; i < count; i++) {
        const bb_box *to = &t->scene->boxes[bb_random_below(&t->random, t->scene->prim_count)];
        bb_ray *ray = &rays[i];
        *ray = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            ray->o[k] = (float)bb_random_range(&t->random, all->lo[k], all->hi[k]);
            /* half of the way: all of it may be more than a float can be */
            ray->d[k] = (float)(((double)to->lo[k] + to->hi[k]) / 4 - 0.5 * ray->o[k]);
        }
        if (ray->d[0] == 0 && ray->d[1] == 0 && ray->d[2] == 0)
            ray->d[0] = 1;
    }
}

/* Asks for the bytes that it holds; those of the heap or of the process count if they are more. */
static bb_status weigh(bb_tracing *t)
{
    bb_hook hook;
    uint64_t said = 0;
    const int64_t freed = t->heap.free > 0 ? t->heap.free : 0;
    const int64_t resident = t->footprint.now - freed;
    const uint64_t heap = t->heap.used > 0 ? (uint64_t)t->heap.used : 0;
    if (t->tracer->bytes != NULL) {
        begin(t, row_of(t), "bytes", &hook);
        said = t->tracer->bytes(t->self);
        BB_TRY(bb_hook_end(&hook, BB_OK));
    }
    t->bytes = t->tracer->bytes == NULL || heap > said + said / 10 + UNSAID_HEAP ? heap : said;
    if (resident > (int64_t)t->bytes + UNSAID_LEAST)
        t->bytes = (uint64_t)resident;
    return BB_OK;
}

/* Builds and traces the first rays within the clock. */
static bb_status build_and_answer(bb_tracing *t, bb_build_timing *timing, bb_phases *phases,
                                  const bb_ray *rays, bb_hit *hits, double *first_ms)
{
    bb_stopwatch watch;
    bb_hook hook;
    begin(t, row_of(t), "build", &hook);
    const heap_bytes heap = look_at_heap();
    bb_status status = bb_stopwatch_start(t->device, &watch);
    if (status == BB_OK) {
        status = t->tracer->build(t->self, phases);
        if (status == BB_OK)
            status = bb_phase(phases, NULL);
        const double built = bb_wall_ms();
        if (status == BB_OK && !bb_interrupted()) /* else it may not be built */
            status = t->tracer->trace(t->self, rays, FIRST_RAYS, false, hits);
        *first_ms = bb_wall_ms() - built;
        status = bb_stopwatch_stop(&watch, status, &timing->timing);
    }
    add_to_heap(&t->heap, heap);
    return bb_hook_end(&hook, status);
}

/* Traces in one call; *cpu_ms: what the process took. */
static bb_status trace_probes(bb_tracing *t, const bb_ray *rays, uint32_t count, bb_hit *hits,
                              double *cpu_ms)
{
    bb_hook hook;
    memset(hits, 0xEE, count * sizeof *hits);
    begin(t, row_of(t), "trace", &hook);
    const double start = bb_cpu_ms();
    const bb_status status = t->tracer->trace(t->self, rays, count, false, hits);
    *cpu_ms = bb_cpu_ms() - start;
    return bb_hook_end(&hook, status);
}

/* Whether two answers have the same distance, but for `share` of it. Which of several primitives at
 * one place is named may differ. */
static bool are_alike(bb_hit a, bb_hit b, double share)
{
    const bool near = isfinite(a.t) && fabs((double)a.t - b.t) <= share * fabs((double)a.t);
    return memcmp(&a.t, &b.t, sizeof a.t) == 0 || near;
}

/* What was built must answer the first rays as it will later. Who waits with building until more
 * rays come is found by their time: again, the same rays take less, by half of a build or more. One
 * such build may be a chance, three in a row are none. */
static bb_status check_built(bb_tracing *t, const bb_build_timing *timing, const bb_ray *rays,
                             uint32_t count, const bb_hit *first)
{
    const double share = 0.5, least_ms = 1;
    bb_hit hits[2][PROBES];
    double ms[2];
    for (int i = 0; i < 2; i++)
        BB_TRY(trace_probes(t, rays, count, hits[i], &ms[i]));
    for (uint32_t i = 0; i < FIRST_RAYS; i++)
        if (!are_alike(first[i], hits[1][i], 0))
            return bb_fail(BB_FAILED,
                           "%s answers otherwise later than right after build(), by when all must "
                           "be built",
                           t->tracer->name);
    const bool late = ms[0] - ms[1] > share * timing->timing.cpu_ms && ms[0] - ms[1] > least_ms;
    t->late = late ? t->late + 1 : 0;
    if (t->late < LATE_MOST)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "%s goes on building after build(): %u rays took %.3g ms after it, and %.3g ms "
                   "again",
                   t->tracer->name, count, ms[0], ms[1]);
}

/* The mirrored scene's answers, now that it is itself again. */
static bb_status check_disguised(bb_tracing *t)
{
    const uint32_t count = t->disguised;
    bb_hit hits[PROBES];
    double unused;
    uint32_t met = 0, alike = 0;
    t->disguised = 0;
    if (count == 0 || bb_interrupted())
        return BB_OK;
    BB_TRY(trace_probes(t, t->mirrored, count, hits, &unused));
    for (uint32_t i = 0; i < count; i++) {
        if (!isfinite(hits[i].t) && !isfinite(t->seen[i].t))
            continue;
        met++;
        alike += are_alike(t->seen[i], hits[i], 1e-3);
    }
    if (4 * alike >= 3 * met)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "%s does not build anew: of %u rays that meet the mirrored scene, it answers %u "
                   "as their images in the scene itself",
                   t->tracer->name, met, alike);
}

static bb_status build(bb_tracing *t, bb_build_timing *timing, bb_phases *phases)
{
    bb_ray rays[PROBES];
    bb_hit first[FIRST_RAYS];
    double first_ms = 0;
    const uint32_t count = PROBES / 2 + bb_random_below(&t->random, PROBES / 2 + 1);
    *timing = (bb_build_timing){.restore_ms = 0};
    *phases = (bb_phases){.current = -1};
    make_rays(t, rays, count);
    memset(first, 0xEE, sizeof first);
    BB_TRY(build_and_answer(t, timing, phases, rays, first, &first_ms));
    BB_TRY(check_threads(t, &timing->timing, "build"));
    if (!bb_interrupted())
        BB_TRY(check_built(t, timing, rays, count, first));
    BB_TRY(weigh(t));
    timing->outside_ms = phases->outside_ms;
    timing->timing.ms -= phases->outside_ms;
    timing->timing.event_ms = first_ms - phases->outside_ms;
    for (uint32_t i = 0; i < phases->count; i++)
        timing->timing.event_ms += phases->ms[i];
    return BB_OK;
}

bb_status bb_tracing_build(bb_tracing *t, bb_build_timing *timing, bb_phases *phases)
{
    BB_TRY(build(t, timing, phases));
    return check_disguised(t);
}

bb_status bb_tracing_build_disguised(bb_tracing *t, uint32_t mirrored, bb_build_timing *timing)
{
    const bb_box *box = &t->scene->bounds;
    bb_ray rays[PROBES];
    bb_phases unused;
    double unused_ms;
    t->disguised = 0;
    BB_TRY(build(t, timing, &unused));
    if (bb_interrupted())
        return BB_OK;
    make_rays(t, rays, PROBES);
    BB_TRY(trace_probes(t, rays, PROBES, t->seen, &unused_ms));
    for (uint32_t i = 0; i < PROBES; i++) {
        t->mirrored[i] = rays[i];
        for (int k = 0; k < 3; k++) {
            if ((mirrored >> k & 1) == 0)
                continue;
            t->mirrored[i].o[k] = bb_mirrored(rays[i].o[k], box->lo[k], box->hi[k]);
            t->mirrored[i].d[k] = -rays[i].d[k];
        }
    }
    t->disguised = PROBES;
    return BB_OK;
}

bb_status bb_tracing_pass(bb_tracing *t, bb_guarded whose, const bb_spec *spec)
{
    bb_hook hook;
    if (t->tracer->pass == NULL)
        return BB_OK;
    begin(t, whose, "pass", &hook);
    return bb_hook_end(&hook, t->tracer->pass(t->self, spec));
}

/* ---- traces ---- */

typedef struct trace_job {
    const bb_tracing *tracing;
    const bb_ray *rays;
    bb_hit *hits;
    bool any;
    atomic_flag failed; /* the first failure is kept: */
    bb_status status;
    char message[BB_MESSAGE_MAX];
} trace_job;

static bb_status trace_some(const trace_job *job, size_t begin, size_t end)
{
    const bb_tracing *t = job->tracing;
    bb_float_terms floats;
    bb_float_terms_take(&floats);
    const bb_status status = t->tracer->trace(t->self, job->rays + begin, (uint32_t)(end - begin),
                                              job->any, job->hits + begin);
    const char *changed = bb_float_terms_put_back(&floats);
    return changed == NULL
               ? status
               : bb_fail(BB_FAILED, "%s changed %s in trace()", t->tracer->name, changed);
}

static void trace_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    trace_job *job = context;
    (void)thread;
    const bb_status status = trace_some(job, begin, end);
    if (status == BB_OK || atomic_flag_test_and_set(&job->failed))
        return;
    job->status = status;
    snprintf(job->message, sizeof job->message, "%s", bb_message());
}

/* As large as packets and streams like them, if that leaves some for each thread. */
static uint32_t chunk_of(const bb_tracing *t, uint32_t count)
{
    const uint32_t even = count / (CHUNKS_EACH * t->context.threads) / CHUNK_LEAST * CHUNK_LEAST;
    return even < CHUNK_LEAST ? CHUNK_LEAST : even > CHUNK_MOST ? CHUNK_MOST : even;
}

static bb_status trace_all(bb_tracing *t, trace_job *job, const bb_spec *pass, uint32_t count,
                           bb_timing *timing)
{
    const double cpu = bb_cpu_ms(), start = bb_wall_ms();
    if (pass != NULL && t->tracer->pass != NULL)
        job->status = t->tracer->pass(t->self, pass);
    const double passed = bb_wall_ms();
    if (job->status == BB_OK)
        bb_parallel_for(pool, count, chunk_of(t, count), trace_chunk, job);
    else
        snprintf(job->message, sizeof job->message, "%s", bb_message());
    *timing = (bb_timing){.ms = bb_wall_ms() - start,
                          .cpu_ms = bb_cpu_ms() - cpu,
                          .event_ms = bb_pool_span_ms(pool) + (passed - start)};
    return job->status == BB_OK ? BB_OK : bb_fail(job->status, "%s", job->message);
}

bb_status bb_tracing_trace(bb_tracing *t, bb_guarded whose, const bb_spec *pass, const bb_ray *rays,
                           uint32_t count, bool any, bb_hit *hits, bb_timing *timing)
{
    trace_job job = {.tracing = t,
                     .rays = rays,
                     .hits = hits,
                     .any = any,
                     .failed = ATOMIC_FLAG_INIT,
                     .status = BB_OK};
    bb_hook hook;
    begin(t, whose, "trace", &hook);
    bb_status status = trace_all(t, &job, pass, count, timing);
    const uint64_t answers = XXH3_64bits(hits, count * sizeof *hits);
    BB_TRY(bb_hook_end(&hook, status));
    BB_TRY(check_threads(t, timing, "trace"));
    if (bb_pool_put_back(pool))
        return bb_fail(BB_FAILED, "%s changed in trace() where a thread may run", t->tracer->name);
    if (XXH3_64bits(hits, count * sizeof *hits) == answers)
        return BB_OK;
    return bb_fail(BB_FAILED, "%s wrote answers after trace() had returned", t->tracer->name);
}

/* ---- what is said of it ---- */

double bb_tracing_create_ms(const bb_tracing *t)
{
    return t->create_ms;
}

uint64_t bb_tracing_bytes(const bb_tracing *t)
{
    return t->bytes;
}

bb_status bb_tracing_describe(bb_tracing *t, char *text, size_t capacity)
{
    bb_hook hook;
    char words[512] = "";
    text[0] = '\0';
    if (t->tracer->describe == NULL)
        return BB_OK;
    begin(t, row_of(t), "describe", &hook);
    const bb_status status = t->tracer->describe(t->self, words, sizeof words);
    BB_TRY(bb_hook_end(&hook, status));
    words[sizeof words - 1] = '\0';
    bb_calm_text(words);
    snprintf(text, capacity, "%s", words);
    return BB_OK;
}
