/* JSON as text. */
#ifndef BB_JSON_H
#define BB_JSON_H

#include <cjson/cJSON.h>
#include <stdbool.h>

/* Prints JSON; all JSON is printed here. The text is always UTF-8: invalid bytes in strings, such
 * as file names, become %XX. The text is from malloc; NULL without memory, or if there is nothing
 * to print. */
char *bb_json_print(const cJSON *json, bool formatted);

#endif
