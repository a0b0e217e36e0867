/* Results that are in a folder already are kept. */
#ifndef BB_EARLIER_H
#define BB_EARLIER_H

#include "framework/base/status.h"

#include <stddef.h>

/* Moves what an earlier run left in `folder` (its results, page, tables and charts; its pictures
 * stay) into FOLDER/earlier/DATE, a new folder named by when it was written. Into `kept` that
 * folder's path; "" if there was nothing to move. */
bb_status bb_keep_earlier(const char *folder, char *kept, size_t capacity);

#endif
