#include "framework/cli/time_option.h"

#include "framework/base/number.h"
#include "framework/builder/guard.h"

#include <stddef.h>

bb_status bb_time_option(const char *text, double *ends_ms)
{
    double seconds;
    *ends_ms = 0;
    if (text == NULL)
        return BB_OK;
    if (!bb_read_time(text, &seconds))
        return bb_fail(BB_INVALID, "--time is '%s', must be a time such as 90s, 5min or 1.5h",
                       text);
    *ends_ms = bb_guard_started() + 1e3 * seconds;
    return BB_OK;
}
