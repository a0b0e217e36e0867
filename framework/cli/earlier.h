/* Keeps results of an earlier run. */
#ifndef BB_EARLIER_H
#define BB_EARLIER_H

#include "framework/base/status.h"

#include <stdbool.h>

/* Moves what an earlier run left in `folder` (its results, page, tables and charts; its pictures
 * stay) into FOLDER/earlier/DATE, a new folder named by the time of that run. Reports this on
 * standard error unless `quiet`. */
bb_status bb_keep_earlier(const char *folder, bool quiet);

#endif
