/* Characters that steer a terminal. */
#include "framework/base/steering.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns the length that the first byte announces; 0 if it cannot begin a character (RFC 3629,
 * section 4). */
static int length_of(unsigned char first)
{
    return first < 0x80    ? 1
           : first < 0xC2  ? 0
           : first < 0xE0  ? 2
           : first < 0xF0  ? 3
           : first <= 0xF4 ? 4
                           : 0;
}

/* Decodes a character of `length` bytes; returns false if it is not well-formed. */
static bool decode(const unsigned char *bytes, int length, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    *code = length == 1 ? bytes[0] : bytes[0] & (0x7Fu >> length);
    for (int i = 1; i < length; i++) {
        if ((bytes[i] & 0xC0) != 0x80)
            return false;
        *code = *code << 6 | (bytes[i] & 0x3F);
    }
    return *code >= least[length] && *code <= 0x10FFFF && (*code < 0xD800 || *code > 0xDFFF);
}

/* Returns the length of the first character and its code; 0 if it is not UTF-8. */
static int letter(const char *text, uint32_t *code)
{
    const unsigned char *bytes = (const unsigned char *)text;
    const int length = length_of(bytes[0]);
    return length > 0 && decode(bytes, length, code) ? length : 0;
}

int bb_letter(const char *text, bool *calm)
{
    uint32_t code;
    const int length = letter(text, &code);
    *calm = false;
    if (length == 0)
        return 1;
    const bool controls = code < 0x20 || (code >= 0x7F && code < 0xA0);
    const bool turns = code == 0x061C || code == 0x200E || code == 0x200F ||
                       (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
    *calm = !controls && !turns;
    return length;
}

bool bb_is_calm(const char *text)
{
    bool calm = true;
    while (*text != '\0' && calm)
        text += bb_letter(text, &calm);
    return calm;
}

char *bb_utf8_text(const char *text)
{
    enum { CODE = 3 }; /* characters of "%FC" */
    uint32_t code;
    size_t size = 1, bad = 0;
    for (const char *at = text; *at != '\0';) {
        const int length = letter(at, &code);
        bad += length == 0;
        size += length > 0 ? (size_t)length : 1;
        at += length > 0 ? length : 1;
    }
    char *valid = malloc(size + bad * (CODE - 1)), *to = valid;
    if (valid == NULL)
        return NULL;
    while (*text != '\0') {
        const int length = letter(text, &code);
        if (length > 0)
            memcpy(to, text, (size_t)length);
        else
            sprintf(to, "%%%02X", (unsigned char)*text); /* the next character or the end overwrites
                                                          * the 0 */
        to += length > 0 ? length : CODE;
        text += length > 0 ? length : 1;
    }
    *to = '\0';
    return valid;
}

void bb_calm_text(char *text)
{
    char *to = text;
    while (*text != '\0') {
        bool calm;
        const int length = bb_letter(text, &calm);
        if (calm)
            memmove(to, text, (size_t)length);
        else
            *to = '?';
        to += calm ? length : 1;
        text += length;
    }
    *to = '\0';
}

void bb_print_calm_lines(const char *text, FILE *out)
{
    while (*text != '\0') {
        bool calm = true;
        const bool ends = strncmp(text, "\r\n", 2) == 0;
        const int length = ends ? 2 : bb_letter(text, &calm);
        fwrite(calm ? text : "?", 1, calm ? (size_t)length : 1, out);
        text += length;
    }
}
