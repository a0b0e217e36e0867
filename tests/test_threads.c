/* The pool of host threads: each index once, the results there when it returns, jobs back to back.
 * What a data race would spoil is written without atomics, for ThreadSanitizer to see (preset
 * tsan). Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/clock.h"
#include "framework/base/limits.h"
#include "framework/base/random.h"
#include "framework/base/threads.h"
#include "framework/device/bystanders.h"
#include "tests/fixture.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint64_t seed = 20261121;

enum { COUNT_MAX = 5000, THREADS_MAX = 16 };

typedef struct job {
    size_t count, chunk;
    uint32_t threads;
    uint32_t visits[COUNT_MAX]; /* of each index */
    uint64_t sums[THREADS_MAX]; /* each thread's own */
    uint32_t bad_chunks[THREADS_MAX];
} job;

static void visit(void *context, size_t begin, size_t end, uint32_t thread)
{
    job *j = context;
    if (thread >= j->threads)
        abort(); /* there is no place to note it */
    j->bad_chunks[thread] += begin >= end || end > j->count || end - begin > j->chunk;
    for (size_t i = begin; i < end && i < j->count; i++) {
        j->visits[i]++;
        j->sums[thread] += i;
    }
}

/* Prints what is wrong; asserts are for the main thread only. */
static bool run(bb_pool *pool, job *j, size_t count, size_t chunk)
{
    memset(j, 0, sizeof *j);
    j->count = count;
    j->chunk = chunk > 0 ? chunk : 1;
    j->threads = bb_pool_threads(pool);
    bb_parallel_for(pool, count, chunk, visit, j);
    uint64_t sum = 0, bad = 0, twice = 0;
    for (uint32_t t = 0; t < j->threads; t++) {
        sum += j->sums[t];
        bad += j->bad_chunks[t];
    }
    for (size_t i = 0; i < count; i++)
        twice += j->visits[i] != 1;
    if (bad == 0 && twice == 0 && sum == (count == 0 ? 0 : (uint64_t)count * (count - 1) / 2))
        return true;
    print_error("%u threads, %zu by %zu: %llu bad chunks, %llu indices not taken once\n",
                j->threads, count, chunk, (unsigned long long)bad, (unsigned long long)twice);
    return false;
}

static bb_pool *pool_of(uint32_t threads)
{
    bb_pool *pool = NULL;
    if (bb_pool_create(threads, &pool) != BB_OK)
        fail_msg("%s", bb_message());
    return pool;
}

static void each_index_is_taken_once(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 0);
    job *j = malloc(sizeof *j);
    for (uint32_t threads = 1; threads <= THREADS_MAX; threads++) {
        bb_pool *pool = pool_of(threads);
        assert_int_equal(bb_pool_threads(pool), threads);
        static const size_t edges[][2] = {
            {0, 1}, {1, 1}, {1, 0},    {2, 1},         {7, 100},
            {8, 8}, {9, 8}, {100, 99}, {COUNT_MAX, 1}, {COUNT_MAX, SIZE_MAX / 64}};
        for (size_t e = 0; e < sizeof edges / sizeof edges[0]; e++)
            assert_true(run(pool, j, edges[e][0], edges[e][1]));
        for (int i = 0; i < 20; i++)
            assert_true(run(pool, j, bb_random_below(&random, COUNT_MAX + 1),
                            1 + bb_random_below(&random, 200)));
        bb_pool_destroy(pool);
    }
    free(j);
}

/* The next job starts while workers are still on their way back to sleep. */
static void jobs_follow_each_other(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 1);
    job *j = malloc(sizeof *j);
    bb_pool *pool = pool_of(4);
    for (int i = 0; i < 3000; i++)
        assert_true(run(pool, j, bb_random_below(&random, 9), 1));
    bb_pool_destroy(pool);
    free(j);
}

static void nothing_to_do_is_allowed(void **state)
{
    (void)state;
    bb_pool_destroy(NULL);
    for (int i = 0; i < 200; i++) /* destroyed before its threads have come to wait */
        bb_pool_destroy(pool_of(1 + i % 8));
    bb_pool *pool = pool_of(0);
    assert_int_equal(bb_pool_threads(pool), bb_core_count());
    assert_true(bb_core_count() >= 1);
    bb_pool_destroy(pool);
}

typedef struct user {
    bb_pool *pool;
    uint64_t stream;
    bool right;
} user;

static void *use_pool(void *argument)
{
    user *u = argument;
    bb_random random = bb_random_make(seed, u->stream);
    job *j = malloc(sizeof *j);
    u->right = true;
    for (int i = 0; i < 300 && u->right; i++)
        u->right = run(u->pool, j, bb_random_below(&random, 300), 1 + bb_random_below(&random, 10));
    free(j);
    return NULL;
}

static void pools_do_not_meet(void **state)
{
    (void)state;
    user users[2] = {{pool_of(3), 2, false}, {pool_of(2), 3, false}};
    pthread_t other;
    assert_int_equal(pthread_create(&other, NULL, use_pool, &users[0]), 0);
    use_pool(&users[1]);
    assert_int_equal(pthread_join(other, NULL), 0);
    for (int i = 0; i < 2; i++) {
        assert_true(users[i].right);
        bb_pool_destroy(users[i].pool);
    }
}

/* Keeps its thread busy until 400 ms after *context. */
static void burn(void *context, size_t begin, size_t end, uint32_t thread)
{
    const double *start = context;
    (void)begin;
    (void)end;
    (void)thread;
    while (bb_wall_ms() - *start < 400)
        continue;
}

/* What this program does itself is no other's work: on all processors, it and the others cannot
 * have taken more than there are. */
static void own_work_is_no_bystanders(void **state)
{
    (void)state;
    bb_bystanders watch;
    bb_pool *pool = pool_of(0);
    double own = bb_cpu_ms(), start = bb_wall_ms();
    bb_bystanders_start(&watch);
    bb_parallel_for(pool, 64, 1, burn, &start);
    double share = bb_bystanders_share(&watch);
    own = (bb_cpu_ms() - own) / (bb_wall_ms() - start);
    bb_pool_destroy(pool);
    if (isnan(share))
        skip(); /* no /proc/stat */
    if (share + own > sysconf(_SC_NPROCESSORS_ONLN) + 0.3)
        fail_msg("others took %g processors and this program %g", share, own);
}

int main(void)
{
    seed = seed_or(seed);
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_index_is_taken_once),  cmocka_unit_test(jobs_follow_each_other),
        cmocka_unit_test(nothing_to_do_is_allowed),  cmocka_unit_test(pools_do_not_meet),
        cmocka_unit_test(own_work_is_no_bystanders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
