#include "framework/cli/watchdog.h"

#include "framework/base/clock.h"
#include "framework/builder/guard.h"
#include "framework/cli/cli.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static char words[2048];
static size_t length;
static double end_ms; /* when the time is over, by counted_ms() */

/* Returns a clock that stands still during time that does not count. */
static double counted_ms(void)
{
    return bb_wall_ms() - bb_uncounted_ms();
}

/* Prints the last words and ends the program. It may interrupt any thread, so it only calls what is
 * safe in a signal handler. */
static void give_up(int signal_number)
{
    (void)signal_number;
    double left = end_ms - counted_ms();
    if (left > 0) {
        alarm(1 + (unsigned)(left / 1e3));
        return;
    }
    bb_guard_end(BB_EXIT_WRONG);
    for (size_t at = 0; at < length;) {
        ssize_t written = write(STDOUT_FILENO, words + at, length - at);
        if (written <= 0)
            break;
        at += (size_t)written;
    }
    _exit(BB_EXIT_WRONG);
}

void bb_watchdog_start(uint32_t seconds, const char *last_words)
{
    struct sigaction action;
    bb_watchdog_stop();
    snprintf(words, sizeof words, "%s", last_words);
    length = strlen(words);
    end_ms = counted_ms() + 1e3 * seconds;
    memset(&action, 0, sizeof action);
    action.sa_handler = give_up;
    action.sa_flags = SA_RESTART;
    sigaction(SIGALRM, &action, NULL);
    alarm(seconds);
}

void bb_watchdog_stop(void)
{
    alarm(0);
}
