#include "framework/base/status.h"

#include "framework/base/steering.h"

#include <stdarg.h>
#include <stdio.h>

static _Thread_local char last_message[BB_MESSAGE_MAX];

bb_status bb_fail(bb_status status, const char *format, ...)
{
    /* The new message may quote the last one, so it is formatted aside. */
    char message[sizeof last_message];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    for (size_t i = 0; i < sizeof message && message[i] != '\0'; i++)
        if (message[i] == '\n' || message[i] == '\r' || message[i] == '\t')
            message[i] = ' ';
    bb_calm_text(message);
    snprintf(last_message, sizeof last_message, "%s", message);
    return status;
}

const char *bb_message(void)
{
    return last_message;
}

const char *bb_status_word(bb_status status)
{
    switch (status) {
    case BB_OK:
        return "ok";
    case BB_REFUSED:
        return "refused";
    case BB_UNSUPPORTED:
        return "unsupported";
    case BB_INVALID:
    case BB_FAILED:
        break;
    }
    return "failed";
}
