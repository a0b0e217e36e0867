/* Shared by the kernels of kernels/stack_wide.cl, each of which is declared in its own
 * kernel_NAME.c. */
#ifndef BB_STACK_WIDE_H
#define BB_STACK_WIDE_H

#include "traversal/traversal.h"

#define BB_STACK_WIDE_KERNEL                                                                       \
    .source = "stack_wide.cl", .queries = BB_ALONG_RAYS, .ordered = true, .control = BB_WHILE_WHILE

/* Option of kernels with 8 children, also of other files. */
#define BB_ORDER_OPTION                                                                            \
    {                                                                                              \
        "order", "sorted", "sorted|octant",                                                        \
            "children by distance, or by the octant of the direction"                              \
    }

#endif
