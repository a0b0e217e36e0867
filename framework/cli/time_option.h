/* --time: the time that a command may take. */
#ifndef BB_TIME_OPTION_H
#define BB_TIME_OPTION_H

#include "framework/base/status.h"

#define BB_TIME_OPTION(type, member, help)                                                         \
    {                                                                                              \
        "time", "T", help, BB_INTO(type, member)                                                   \
    }

/* Reads the option, NULL if it is not given. *ends_ms: bb_wall_ms() at which the command is to end,
 * however often it began again; 0: at any time. */
bb_status bb_time_option(const char *text, double *ends_ms);

#endif
