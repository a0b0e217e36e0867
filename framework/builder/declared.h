/* Checks of what plug-ins declare: names, lines, options. */
#ifndef BB_DECLARED_H
#define BB_DECLARED_H

#include "framework/base/options.h"

/* Lower case, digits, '-', beginning with a letter: valid in a specification and as a folder's
 * name. */
bool bb_is_name(const char *name);

/* A text of one line, which is not empty. */
bool bb_is_line(const char *text);

/* `what` is "builder NAME" or "tracer NAME". BB_INVALID says what is wrong with which option. */
bb_status bb_options_check(const char *what, const bb_option *options);

#endif
