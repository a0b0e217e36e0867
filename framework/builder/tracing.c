#include "framework/builder/tracing.h"

#include "framework/base/clock.h"
#include "framework/base/threads.h"
#include "framework/builder/hook.h"
#include "framework/device/device_private.h"

#include <malloc.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHUNK = 2048,            /* rays of a call: a multiple of packets and streams */
    UNSAID_LEAST = 32 << 20, /* bytes of the heap beside those that it says it holds */
};

struct bb_tracing {
    const bb_tracer *tracer;
    bb_device *device;
    bb_spec spec;
    bb_scene part; /* what the tracer gets of: */
    const bb_scene *scene;
    bb_tracer_context context;
    char text[512]; /* its row */
    bb_footprint footprint;
    int64_t heap; /* bytes that its create() and build() have added */
    bb_pool *pool;
    void *self;
};

/* The bytes of the heap that are in use; always 0 under sanitizers, which have one of their own. */
static int64_t heap_bytes(void)
{
    const struct mallinfo2 info = mallinfo2();
    return (int64_t)(info.uordblks + info.hblkhd);
}

static void begin(bb_tracing *t, bb_guarded whose, const char *name, bb_hook *hook)
{
    bb_hook_begin(hook, whose, t->tracer->name, name, t->scene, &t->footprint);
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
    const int64_t heap = heap_bytes();
    const bb_status status = t->tracer->create(&t->context, &t->self);
    t->heap += heap_bytes() - heap;
    return bb_hook_end(&hook, status);
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
    if (status == BB_OK)
        status = bb_pool_create(t->context.threads, &t->pool);
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
        bb_hook_put_back(&hook); /* no row is left to fail */
    }
    bb_pool_destroy(t->pool);
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

bb_status bb_tracing_build(bb_tracing *t, bb_build_timing *timing, bb_phases *phases)
{
    bb_stopwatch watch;
    bb_hook hook;
    *timing = (bb_build_timing){.restore_ms = 0};
    *phases = (bb_phases){.current = -1};
    begin(t, row_of(t), "build", &hook);
    const int64_t heap = heap_bytes();
    bb_status status = bb_stopwatch_start(t->device, &watch);
    if (status == BB_OK) {
        status = t->tracer->build(t->self, phases);
        if (status == BB_OK)
            status = bb_phase(phases, NULL);
        status = bb_stopwatch_stop(&watch, status, &timing->timing);
    }
    t->heap += heap_bytes() - heap;
    BB_TRY(bb_hook_end(&hook, status));
    BB_TRY(check_threads(t, &timing->timing, "build"));
    timing->outside_ms = phases->outside_ms;
    timing->timing.ms -= phases->outside_ms;
    timing->timing.event_ms = -phases->outside_ms;
    for (uint32_t i = 0; i < phases->count; i++)
        timing->timing.event_ms += phases->ms[i];
    return BB_OK;
}

bb_status bb_tracing_pass(bb_tracing *t, const bb_spec *spec)
{
    bb_hook hook;
    if (t->tracer->pass == NULL)
        return BB_OK;
    begin(t, row_of(t), "pass", &hook);
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

static void trace_chunk(void *context, size_t begin, size_t end, uint32_t thread)
{
    trace_job *job = context;
    const bb_tracing *t = job->tracing;
    (void)thread;
    const bb_status status = t->tracer->trace(t->self, job->rays + begin, (uint32_t)(end - begin),
                                              job->any, job->hits + begin);
    if (status == BB_OK || atomic_flag_test_and_set(&job->failed))
        return;
    job->status = status;
    snprintf(job->message, sizeof job->message, "%s", bb_message());
}

bb_status bb_tracing_trace(bb_tracing *t, bb_guarded whose, const bb_ray *rays, uint32_t count,
                           bool any, bb_hit *hits, bb_timing *timing)
{
    trace_job job = {.tracing = t,
                     .rays = rays,
                     .hits = hits,
                     .any = any,
                     .failed = ATOMIC_FLAG_INIT,
                     .status = BB_OK};
    bb_hook hook;
    begin(t, whose, "trace", &hook);
    const double cpu = bb_cpu_ms(), start = bb_wall_ms();
    bb_parallel_for(t->pool, count, CHUNK, trace_chunk, &job);
    *timing = (bb_timing){.ms = bb_wall_ms() - start,
                          .cpu_ms = bb_cpu_ms() - cpu,
                          .event_ms = bb_pool_span_ms(t->pool)};
    if (job.status != BB_OK)
        job.status = bb_fail(job.status, "%s", job.message);
    BB_TRY(bb_hook_end(&hook, job.status));
    return check_threads(t, timing, "trace");
}

/* ---- what is said of it ---- */

uint64_t bb_tracing_bytes(const bb_tracing *t)
{
    const uint64_t said = t->tracer->bytes != NULL ? t->tracer->bytes(t->self) : 0;
    const uint64_t heap = t->heap > 0 ? (uint64_t)t->heap : 0;
    return t->tracer->bytes == NULL || heap > said + UNSAID_LEAST ? heap : said;
}

bb_status bb_tracing_describe(bb_tracing *t, char *text, size_t capacity)
{
    bb_hook hook;
    text[0] = '\0';
    if (t->tracer->describe == NULL)
        return BB_OK;
    begin(t, row_of(t), "describe", &hook);
    return bb_hook_end(&hook, t->tracer->describe(t->self, text, capacity));
}
