#include "framework/device/bystanders.h"

#include "framework/base/clock.h"

#include <math.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

/* Returns the busy time of all processors since the machine started, from proc(5). */
static double all_ms(void)
{
    enum { USER, NICE, SYSTEM, IDLE, IO_WAIT, IRQ, SOFT_IRQ, STEAL, COUNTS };
    double ticks[COUNTS];
    FILE *file = fopen("/proc/stat", "r");
    if (file == NULL)
        return NAN;
    int read = fscanf(file, "cpu %lf %lf %lf %lf %lf %lf %lf %lf", &ticks[USER], &ticks[NICE],
                      &ticks[SYSTEM], &ticks[IDLE], &ticks[IO_WAIT], &ticks[IRQ], &ticks[SOFT_IRQ],
                      &ticks[STEAL]);
    fclose(file);
    if (read != COUNTS)
        return NAN;
    double busy =
        ticks[USER] + ticks[NICE] + ticks[SYSTEM] + ticks[IRQ] + ticks[SOFT_IRQ] + ticks[STEAL];
    return busy * 1e3 / (double)sysconf(_SC_CLK_TCK);
}

/* Returns the CPU time of this process and of the children it has waited for. */
static double own_ms(void)
{
    struct rusage children;
    double ms = bb_cpu_ms();
    if (getrusage(RUSAGE_CHILDREN, &children) == 0)
        ms += 1e3 * (double)(children.ru_utime.tv_sec + children.ru_stime.tv_sec) +
              1e-3 * (double)(children.ru_utime.tv_usec + children.ru_stime.tv_usec);
    return ms;
}

void bb_bystanders_start(bb_bystanders *watch)
{
    *watch = (bb_bystanders){bb_wall_ms(), all_ms(), own_ms(), false};
}

double bb_bystanders_share(const bb_bystanders *watch)
{
    double wall = bb_wall_ms() - watch->wall_ms;
    double others = all_ms() - watch->all_ms - (own_ms() - watch->own_ms);
    return wall > 0 && isfinite(others) ? fmax(0, others) / wall : (double)NAN;
}
