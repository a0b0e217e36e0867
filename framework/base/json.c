#include "framework/base/json.h"

#include "framework/base/steering.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *bb_json_print(const cJSON *json, bool formatted)
{
    /* cJSON copies the bytes of strings unchanged; everything else it writes is ASCII. */
    char *text = formatted ? cJSON_Print(json) : cJSON_PrintUnformatted(json);
    char *valid = text != NULL ? bb_utf8_text(text) : NULL;
    free(text);
    return valid;
}

/* ---- what cJSON lets pass ---- */

static const char *skip_digits(const char *at)
{
    return at + strspn(at, "0123456789");
}

/* Behind the number, which begins with a digit or with a minus; NULL: it is none. */
static const char *skip_number(const char *at)
{
    const char *whole = at + (*at == '-'), *end = skip_digits(whole);
    if (end == whole || (*whole == '0' && end > whole + 1))
        return NULL;
    if (*end == '.') {
        const char *part = end + 1;
        end = skip_digits(part);
        if (end == part)
            return NULL;
    }
    if (*end == 'e' || *end == 'E') {
        const char *power = end + 1 + (end[1] == '-' || end[1] == '+');
        end = skip_digits(power);
        if (end == power)
            return NULL;
    }
    return end;
}

static const char *skip_string(const char *at)
{
    for (at++; *at != '\0' && *at != '"'; at++)
        at += at[0] == '\\' && at[1] != '\0';
    return at + (*at == '"');
}

const char *bb_json_fault(const char *text)
{
    const char *at = text;
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0)
        return text;
    while (*at != '\0') {
        const char *begin = at;
        if (*at == '"')
            at = skip_string(at);
        else if (*at == '-' || (*at >= '0' && *at <= '9'))
            at = skip_number(at);
        else
            at++;
        if (at == NULL)
            return begin;
    }
    return NULL;
}

/* ---- the writer ---- */

static void append(bb_json *json, const char *text, size_t size)
{
    if (json->size + size + 1 > json->room) {
        size_t room = 2 * (json->size + size) + 256;
        char *grown = json->lost ? NULL : realloc(json->text, room);
        if (grown == NULL) {
            json->lost = true;
            return;
        }
        json->text = grown;
        json->room = room;
    }
    memcpy(json->text + json->size, text, size);
    json->size += size;
    json->text[json->size] = '\0';
}

static void put(bb_json *json, const char *text)
{
    append(json, text, strlen(text));
}

/* The code of a letter of up to three bytes. */
static unsigned code_of(const char *letter, int length)
{
    unsigned code = (unsigned char)letter[0] & (length == 1 ? 0xFFu : 0x7Fu >> length);
    for (int i = 1; i < length; i++)
        code = code << 6 | ((unsigned char)letter[i] & 0x3F);
    return code;
}

/* A terminal may show it: what steers one is escaped. */
static void put_string(bb_json *json, const char *text)
{
    static const char special[] = "\"\\\b\f\n\r\t", letters[] = "\"\\bfnrt";
    put(json, "\"");
    while (*text != '\0') {
        bool calm;
        const int length = bb_letter(text, &calm);
        const char *found = strchr(special, *text);
        const unsigned code = code_of(text, length);
        char escape[16] = {'\\', found != NULL ? letters[found - special] : '\0'};
        if (found == NULL)
            snprintf(escape, sizeof escape, "\\u%04x", code);
        if (found != NULL || (!calm && (length > 1 || code < 0x80)))
            put(json, escape);
        else
            append(json, text, (size_t)length); /* also what is not UTF-8 */
        text += length;
    }
    put(json, "\"");
}

static void put_line(bb_json *json)
{
    if (!json->formatted)
        return;
    put(json, "\n");
    for (unsigned i = 0; i < json->depth; i++)
        put(json, "\t");
}

/* What stands before a value: members are on lines of their own. */
static void start(bb_json *json, const char *name)
{
    if (json->more)
        put(json, name == NULL && json->formatted ? ", " : ",");
    json->more = true;
    put(json, json->line ? "\n" : "");
    json->line = false;
    if (name == NULL)
        return;
    put_line(json);
    put_string(json, name);
    put(json, json->formatted ? ":\t" : ":");
}

static void open(bb_json *json, const char *name, const char *bracket)
{
    start(json, name);
    put(json, bracket);
    json->more = false;
    json->depth++;
}

static void close(bb_json *json, const char *bracket)
{
    json->depth--;
    if (*bracket == '}')
        put_line(json);
    put(json, bracket);
    json->more = true;
}

void bb_json_line(bb_json *json)
{
    json->line = true;
}

void bb_json_object(bb_json *json, const char *name)
{
    open(json, name, "{");
}

void bb_json_end_object(bb_json *json)
{
    close(json, "}");
}

void bb_json_array(bb_json *json, const char *name)
{
    open(json, name, "[");
}

void bb_json_end_array(bb_json *json)
{
    close(json, "]");
}

void bb_json_add_text(bb_json *json, const char *name, const char *value)
{
    start(json, name);
    if (value != NULL)
        put_string(json, value);
    else
        put(json, "null");
}

const char *bb_json_digits(char digits[BB_JSON_DIGITS], double value)
{
    for (int precision = 15; precision <= 17; precision++) {
        snprintf(digits, BB_JSON_DIGITS, "%.*g", precision, value);
        if (strtod(digits, NULL) == value)
            break;
    }
    return digits;
}

void bb_json_add_number(bb_json *json, const char *name, double value)
{
    char digits[BB_JSON_DIGITS];
    start(json, name);
    put(json, isfinite(value) ? bb_json_digits(digits, value) : "null");
}

void bb_json_add_bool(bb_json *json, const char *name, bool value)
{
    start(json, name);
    put(json, value ? "true" : "false");
}

char *bb_json_take(bb_json *json)
{
    char *valid = json->lost || json->text == NULL ? NULL : bb_utf8_text(json->text);
    free(json->text);
    *json = (bb_json){.formatted = json->formatted};
    return valid;
}
