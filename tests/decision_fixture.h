/* What tests of decisions share. */
#ifndef BB_DECISION_FIXTURE_H
#define BB_DECISION_FIXTURE_H

#include "framework/base/decision.h"

#include <string.h>

/* The decision of that name; NULL if there is none. */
static inline const bb_decision *find_decision(const bb_decisions *list, const char *what)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (strcmp(list->items[i].what, what) == 0)
            return &list->items[i];
    return NULL;
}

#endif
