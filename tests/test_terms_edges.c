/* Terms at their edges: what is nobody's fault, what can be put back in part, and what looking at
 * them must not do. Cases that change the process for good run in a child. */
#include "framework/builder/terms.h"
#include "tests/fixture.h"

#include <sys/syscall.h>
#include <unistd.h>

/* ---- umask ---- */

static mode_t loosest; /* of the masks that were set: what all of them hid */

mode_t umask(mode_t mask)
{
    loosest &= mask;
    return (mode_t)syscall(SYS_umask, mask);
}

/* Another thread could make a file at any moment. */
static void the_umask_is_never_loosened(void **state)
{
    (void)state;
    bb_terms terms;
    const mode_t before = umask(027);
    loosest = 0777;
    bb_terms_take(&terms);
    ASSERT_OK(bb_terms_check(&terms, "it", "build", BB_OK));
    assert_int_equal(loosest & 027, 027);
    assert_int_equal(umask(before), 027);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_umask_is_never_loosened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
