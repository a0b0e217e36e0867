/* Thread pool: workers wait on a condition variable between jobs, so that an idle pool costs
 * nothing while others are timed. Within a job every thread takes chunks from one atomic
 * counter. */
#include "framework/base/threads.h"

#include "framework/base/clock.h"
#include "framework/base/limits.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct worker {
    bb_pool *pool;
    pthread_t thread;
    uint32_t index;
    pid_t id;            /* as Linux calls it; 0: not known yet */
    double began, ended; /* wall clock, for its part of the last job */
} worker;

struct bb_pool {
    uint32_t threads; /* including the caller's */
    uint32_t started; /* running workers */
    worker *workers;
    pthread_mutex_t lock;
    pthread_cond_t work, done;
    uint64_t job; /* number of the current job */
    uint32_t busy;
    int stop;

    void (*function)(void *context, size_t begin, size_t end, uint32_t thread);
    void *context;
    size_t count, chunk;
    _Atomic size_t next;
};

static void take_chunks(bb_pool *pool, uint32_t thread)
{
    worker *self = &pool->workers[thread];
    self->began = bb_wall_ms();
    for (;;) {
        size_t begin = atomic_fetch_add_explicit(&pool->next, pool->chunk, memory_order_relaxed);
        if (begin >= pool->count)
            break;
        size_t end = pool->count - begin < pool->chunk ? pool->count : begin + pool->chunk;
        pool->function(pool->context, begin, end, thread);
    }
    self->ended = bb_wall_ms();
}

double bb_pool_span_ms(const bb_pool *pool)
{
    double began = pool->workers[0].began, ended = pool->workers[0].ended;
    for (uint32_t i = 1; i <= pool->started; i++) {
        began = pool->workers[i].began < began ? pool->workers[i].began : began;
        ended = pool->workers[i].ended > ended ? pool->workers[i].ended : ended;
    }
    return ended - began;
}

bool bb_pool_put_back(bb_pool *pool)
{
    cpu_set_t now, own;
    bool changed = false;
    if (sched_getaffinity(0, sizeof own, &own) != 0)
        return false;
    pthread_mutex_lock(&pool->lock);
    for (uint32_t i = 1; i <= pool->started; i++) {
        const pid_t id = pool->workers[i].id;
        if (id == 0 || sched_getaffinity(id, sizeof now, &now) != 0 || CPU_EQUAL(&now, &own))
            continue;
        changed = true;
        sched_setaffinity(id, sizeof own, &own);
    }
    pthread_mutex_unlock(&pool->lock);
    return changed;
}

static void *work(void *argument)
{
    worker *self = argument;
    bb_pool *pool = self->pool;
    uint64_t last = 0;
    pthread_mutex_lock(&pool->lock);
    self->id = gettid();
    for (;;) {
        while (pool->job == last && !pool->stop)
            pthread_cond_wait(&pool->work, &pool->lock);
        if (pool->stop)
            break;
        last = pool->job;
        pthread_mutex_unlock(&pool->lock);
        take_chunks(pool, self->index);
        pthread_mutex_lock(&pool->lock);
        if (--pool->busy == 0)
            pthread_cond_signal(&pool->done);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

bb_status bb_pool_create(uint32_t threads, bb_pool **out)
{
    *out = NULL;
    if (threads == 0)
        threads = bb_core_count();
    bb_pool *pool = calloc(1, sizeof *pool);
    worker *workers = calloc(threads, sizeof *workers);
    if (pool == NULL || workers == NULL) {
        free(pool);
        free(workers);
        return bb_fail(BB_REFUSED, "the host refused the memory of a pool of %u threads", threads);
    }
    pool->threads = threads;
    pool->workers = workers;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->work, NULL);
    pthread_cond_init(&pool->done, NULL);
    for (uint32_t i = 1; i < threads; i++) {
        workers[i] = (worker){.pool = pool, .index = i};
        int error = pthread_create(&workers[i].thread, NULL, work, &workers[i]);
        if (error != 0) {
            bb_pool_destroy(pool);
            return bb_fail(BB_FAILED, "cannot start thread %u of %u: %s", i, threads,
                           strerror(error));
        }
        pool->started = i;
    }
    *out = pool;
    return BB_OK;
}

void bb_pool_destroy(bb_pool *pool)
{
    if (pool == NULL)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->stop = 1;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);
    for (uint32_t i = 1; i <= pool->started; i++)
        pthread_join(pool->workers[i].thread, NULL);
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->lock);
    free(pool->workers);
    free(pool);
}

uint32_t bb_pool_threads(const bb_pool *pool)
{
    return pool->threads;
}

void bb_parallel_for(bb_pool *pool, size_t count, size_t chunk,
                     void (*function)(void *context, size_t begin, size_t end, uint32_t thread),
                     void *context)
{
    if (count == 0)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->function = function;
    pool->context = context;
    pool->count = count;
    pool->chunk = chunk > 0 ? chunk : 1;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->busy = pool->started;
    pool->job++;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);

    take_chunks(pool, 0);

    pthread_mutex_lock(&pool->lock);
    while (pool->busy > 0)
        pthread_cond_wait(&pool->done, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}
