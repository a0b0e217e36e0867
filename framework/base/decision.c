/* Lists of decisions. */
#include "framework/base/decision.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

const char *bb_decider_word(bb_decider by)
{
    static const char *const words[] = {"default", "scene", "tree", "given", "device"};
    return words[by];
}

static void decide(bb_decisions *list, const char *what, const char *value, bb_decider by,
                   const char *figure, va_list arguments)
{
    if (list->count == BB_DECISIONS_MAX)
        return;
    bb_decision *d = &list->items[list->count++];
    *d = (bb_decision){.what = what, .by = by};
    snprintf(d->value, sizeof d->value, "%s", value);
    vsnprintf(d->figure, sizeof d->figure, figure, arguments);
}

void bb_decide_number(bb_decisions *list, const char *what, uint64_t value, bb_decider by,
                      const char *figure, ...)
{
    char digits[24];
    va_list arguments;
    snprintf(digits, sizeof digits, "%" PRIu64, value);
    va_start(arguments, figure);
    decide(list, what, digits, by, figure, arguments);
    va_end(arguments);
}

void bb_decide_word(bb_decisions *list, const char *what, const char *value, bb_decider by,
                    const char *figure, ...)
{
    va_list arguments;
    va_start(arguments, figure);
    decide(list, what, value, by, figure, arguments);
    va_end(arguments);
}
