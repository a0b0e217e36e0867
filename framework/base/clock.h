/* Clocks, in milliseconds. */
#ifndef BB_CLOCK_H
#define BB_CLOCK_H

double bb_wall_ms(void); /* monotonic */
double bb_cpu_ms(void);  /* of all threads of the process, user and system time */

#endif
