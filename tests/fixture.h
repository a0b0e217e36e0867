/* What all tests share: cmocka with what it needs, statuses that must be BB_OK, the seed. */
#ifndef BB_TEST_FIXTURE_H
#define BB_TEST_FIXTURE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "framework/base/status.h"

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
