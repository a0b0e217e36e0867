/* Keeps results of an earlier run. */
#ifndef BB_EARLIER_H
#define BB_EARLIER_H

#include "framework/base/status.h"

#include <stdbool.h>

/* Moves what an earlier `command` left in `folder` (its results and page; of "run" also its tables
 * and charts; its pictures stay) into FOLDER/earlier/DATE, a new folder named by the time of those
 * results. Reports this on standard error unless `quiet`. */
bb_status bb_keep_earlier(const char *folder, const char *command, bool quiet);

#endif
