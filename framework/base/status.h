/* The one status type and the one message of the project.
 *
 * The place that knows what went wrong formats the message once, with bb_fail(); everybody above
 * passes the status up untouched. Nothing below main() prints or exits.
 */
#ifndef BB_STATUS_H
#define BB_STATUS_H

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef enum bb_status {
    BB_OK = 0,
    BB_INVALID,     /* bad option, bad file, bad data: the caller's input */
    BB_REFUSED,     /* more memory, tests or levels than allowed; nothing was done */
    BB_UNSUPPORTED, /* a combination that is not implemented, said beforehand */
    BB_FAILED,      /* device, driver, library or system call failed */
} bb_status;

enum { BB_MESSAGE_MAX = 1024 };

/* Records the message of the calling thread (what, where, what to do: one line, no newline) and
 * returns `status`. */
bb_status bb_fail(bb_status status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The last message of the calling thread; "" if there was none. Valid until the next bb_fail(). */
const char *bb_message(void);

/* "ok", "refused", "unsupported" or "failed": the word in the result file. */
const char *bb_status_word(bb_status status);

/* Returns the status of `expression` from the calling function unless it is BB_OK. For functions
 * that own nothing yet; others use `goto out`. */
#define BB_TRY(expression)                                                                         \
    do {                                                                                           \
        bb_status bb_try_status_ = (expression);                                                   \
        if (bb_try_status_ != BB_OK)                                                               \
            return bb_try_status_;                                                                 \
    } while (0)

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
