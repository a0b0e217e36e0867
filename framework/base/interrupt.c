#include "framework/base/interrupt.h"

#include "framework/base/clock.h"

#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

static atomic_bool noted; /* threads of libraries read it */
_Static_assert(ATOMIC_BOOL_LOCK_FREE == 2, "a signal handler may write it");
static volatile sig_atomic_t noted_signals[NSIG];
static double ends_ms; /* 0: never */

static void note(int signal_number)
{
    static const char words[] = "\ninterrupted: ending with what was measured; once more ends it "
                                "at once\n";
    noted = true;
    noted_signals[signal_number] = 1;
    signal(signal_number, SIG_DFL);
    ssize_t written = write(STDERR_FILENO, words, sizeof words - 1);
    (void)written;
}

void bb_interrupt_catch(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action;
    if (noted)
        return; /* the next one ends the program */
    memset(&action, 0, sizeof action);
    action.sa_handler = note;
    action.sa_flags = SA_RESTART;
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        struct sigaction before;
        /* A program started with nohup keeps ignoring the signal. */
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(signals[i], &action, NULL);
    }
}

void bb_interrupt_at(double ms)
{
    ends_ms = ms;
}

bool bb_interrupted_by_time(void)
{
    return !noted && ends_ms > 0 && bb_wall_ms() >= ends_ms;
}

bool bb_interrupted(void)
{
    return noted || bb_interrupted_by_time();
}

bool bb_interrupt_changed(int signal_number, const struct sigaction *then,
                          const struct sigaction *now)
{
    return noted_signals[signal_number] != 0 && then->sa_handler == note &&
           now->sa_handler == SIG_DFL;
}

/* ---- pipes ---- */

static volatile sig_atomic_t unread;

static void note_pipe(int signal_number)
{
    (void)signal_number;
    unread = 1;
}

void bb_pipe_catch(void)
{
    /* A handler rather than SIG_IGN, which started programs would inherit. */
    struct sigaction before, action = {.sa_handler = note_pipe, .sa_flags = SA_RESTART};
    if (sigaction(SIGPIPE, NULL, &before) == 0 && before.sa_handler == SIG_DFL)
        sigaction(SIGPIPE, &action, NULL);
}

void bb_pipe_end(void)
{
    if (unread == 0)
        return;
    signal(SIGPIPE, SIG_DFL);
    raise(SIGPIPE);
}
