/* Puts members into a JSON object. Each function returns false without memory. */
#ifndef BB_PUT_H
#define BB_PUT_H

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdint.h>

/* Takes ownership of `item`, also on failure. Fails if `item` is NULL. */
bool bb_put(cJSON *object, const char *name, cJSON *item);
bool bb_put_text(cJSON *object, const char *name, const char *text); /* null if empty */
bool bb_put_number(cJSON *object, const char *name, double value);   /* null if not finite */
bool bb_put_numbers(cJSON *object, const char *name, const double *values, uint32_t count);

#endif
