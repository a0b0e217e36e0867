/* gnuplot, which draws the charts: a program of the user's, not a library. */
#ifndef BB_GNUPLOT_H
#define BB_GNUPLOT_H

#include "framework/base/status.h"

#include <stdbool.h>

/* The name of the script in its folder. */
extern const char bb_gnuplot_script[];

/* Runs the script in `folder`, without the user's settings. BB_FAILED with gnuplot's own words if
 * it is missing or fails. */
bb_status bb_gnuplot_draw(const char *folder);

/* Checks the end of a picture, since gnuplot does not report a full disk. True of other files. */
bool bb_gnuplot_whole(const char *path);

#endif
