/* Members into a JSON object; each returns false when there is no memory. */
#ifndef BB_PUT_H
#define BB_PUT_H

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdint.h>

/* Takes `item` over, also when it fails; NULL fails. */
bool bb_put(cJSON *object, const char *name, cJSON *item);
bool bb_put_text(cJSON *object, const char *name, const char *text); /* null if empty */
bool bb_put_number(cJSON *object, const char *name, double value);   /* null if not finite */
bool bb_put_numbers(cJSON *object, const char *name, const double *values, uint32_t count);

#endif
