/* Shared by the kernels of kernels/short.cl, each of which is declared in its own kernel_NAME.c. */
#ifndef BB_SHORT_H
#define BB_SHORT_H

#include "traversal/traversal.h"

/* The file, and the properties that the trail implies. */
#define BB_SHORT_KERNEL                                                                            \
    .source = "short.cl", .queries = BB_ALONG_RAYS, .ordered = true, .stackless = true,            \
    .trail_max = BB_TRAIL_MAX, .control = BB_WHILE_WHILE

/* Option of kernels with a stack. */
#define BB_ENTRIES_OPTION(preset)                                                                  \
    {                                                                                              \
        "entries", preset, "1|2|4|8|16",                                                           \
            "entries of the stack; dropped entries are found again by the trail"                   \
    }

#endif
