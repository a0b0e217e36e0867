#include "framework/base/json.h"

#include "framework/base/steering.h"

#include <stdlib.h>

char *bb_json_print(const cJSON *json, bool formatted)
{
    /* cJSON copies the bytes of strings unchanged; everything else it writes is ASCII. */
    char *text = formatted ? cJSON_Print(json) : cJSON_PrintUnformatted(json);
    char *valid = text != NULL ? bb_utf8_text(text) : NULL;
    free(text);
    return valid;
}
