/* What all tests share: cmocka with what it needs, statuses that must be BB_OK, the seed. */
#ifndef BB_TEST_FIXTURE_H
#define BB_TEST_FIXTURE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "framework/base/status.h"

/* A program all of whose cases skip counts as skipped: it exits with the status that ctest takes
 * for that. */
enum { BB_TEST_SKIPPED = 77 };

static size_t bb_skipped_cases;

#undef skip
#define skip() (bb_skipped_cases++, _skip(__FILE__, __LINE__))

static inline int bb_run_group(const char *name, const struct CMUnitTest *tests, size_t count,
                               CMFixtureFunction setup, CMFixtureFunction teardown)
{
    size_t before = bb_skipped_cases;
    if (_cmocka_run_group_tests(name, tests, count, setup, teardown) != 0)
        return 1;
    return bb_skipped_cases - before == count ? BB_TEST_SKIPPED : 0;
}

#undef cmocka_run_group_tests_name
#define cmocka_run_group_tests_name(name, tests, setup, teardown)                                  \
    bb_run_group(name, tests, sizeof(tests) / sizeof((tests)[0]), setup, teardown)
#undef cmocka_run_group_tests
#define cmocka_run_group_tests(tests, setup, teardown)                                             \
    cmocka_run_group_tests_name(#tests, tests, setup, teardown)

#define ASSERT_OK(expression)                                                                      \
    do {                                                                                           \
        if ((expression) != BB_OK)                                                                 \
            fail_msg("%s: %s", #expression, bb_message());                                         \
    } while (0)

#define ASSERT_NEAR(value, expected, slack)                                                        \
    do {                                                                                           \
        double value_ = (value), expected_ = (expected);                                           \
        if (!(fabs(value_ - expected_) <= (slack)))                                                \
            fail_msg("%s is %.17g, expected %.17g", #value, value_, expected_);                    \
    } while (0)

/* BVHBENCH_TEST_SEED, else the test's own. */
static inline uint64_t seed_or(uint64_t fallback)
{
    const char *given = getenv("BVHBENCH_TEST_SEED");
    return given != NULL ? strtoull(given, NULL, 0) : fallback;
}

#endif
