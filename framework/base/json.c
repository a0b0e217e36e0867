#include "framework/base/json.h"

#include "framework/base/steering.h"

#include <stdlib.h>

char *bb_json_print(const cJSON *json, bool formatted)
{
    /* cJSON passes on what is in strings; all else that it writes is ASCII. */
    char *text = formatted ? cJSON_Print(json) : cJSON_PrintUnformatted(json);
    char *valid = text != NULL ? bb_utf8_text(text) : NULL;
    free(text);
    return valid;
}
