/* JSON as text. */
#ifndef BB_JSON_H
#define BB_JSON_H

#include <cjson/cJSON.h>
#include <stdbool.h>

/* Always UTF-8: bytes of strings that are none, such as of a file's name, become %XX. From
 * malloc; NULL if there is no memory, or nothing to print. Nothing else prints JSON. */
char *bb_json_print(const cJSON *json, bool formatted);

#endif
