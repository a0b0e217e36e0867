#include "framework/table/template.h"

#include "framework/base/file.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURE_BYTES_MAX = 4 << 20 };

void bb_page_append(bb_page_text *out, const char *data, size_t size)
{
    if (out->failed)
        return;
    if (out->size + size > out->capacity) {
        size_t capacity = 2 * (out->size + size) + 4096;
        char *grown = realloc(out->data, capacity);
        if (grown == NULL) {
            out->failed = true;
            return;
        }
        out->data = grown;
        out->capacity = capacity;
    }
    memcpy(out->data + out->size, data, size);
    out->size += size;
}

void bb_page_append_string(bb_page_text *out, const char *string)
{
    bb_page_append(out, string, strlen(string));
}

/* JSON inside <script>: a '<' can only stand in a string, where it is escaped, so that no text ends
 * the script. */
static void append_json(bb_page_text *out, const char *json)
{
    for (;;) {
        size_t plain = strcspn(json, "<");
        bb_page_append(out, json, plain);
        if (json[plain] == '\0')
            return;
        bb_page_append_string(out, "\\u003c");
        json += plain + 1;
    }
}

/* RFC 4648, section 4. */
void bb_page_append_base64(bb_page_text *out, const unsigned char *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        uint32_t bits = (uint32_t)data[i] << 16 | (left > 1 ? (uint32_t)data[i + 1] << 8 : 0) |
                        (left > 2 ? data[i + 2] : 0);
        char four[4] = {digits[bits >> 18], digits[bits >> 12 & 63],
                        left > 1 ? digits[bits >> 6 & 63] : '=',
                        left > 2 ? digits[bits & 63] : '='};
        bb_page_append(out, four, 4);
    }
}

bool bb_page_source(const char *folder, const char *name, char **source)
{
    char path[1400], *data = NULL;
    size_t size;
    *source = NULL;
    if (name == NULL || name[0] == '\0' || strchr(name, '/') != NULL)
        return true;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (bb_file_read(path, PICTURE_BYTES_MAX, "picture", &data, &size) != BB_OK)
        return true;
    bb_page_text text = {0};
    bb_page_append_string(&text, "data:image/png;base64,");
    bb_page_append_base64(&text, (const unsigned char *)data, size);
    bb_page_append(&text, "", 1);
    free(data);
    if (text.failed)
        free(text.data);
    else
        *source = text.data;
    return !text.failed;
}

bb_status bb_page_fill(bb_page_text *page, const char *from, const bb_page_part *parts,
                       size_t count)
{
    const char *rest = from;
    for (size_t i = 0; i < count; i++) {
        const char *at = strstr(rest, parts[i].mark);
        if (at == NULL)
            return bb_fail(BB_FAILED, "the report's template lacks %s", parts[i].mark);
        bb_page_append(page, rest, (size_t)(at - rest));
        if (parts[i].json)
            append_json(page, parts[i].content);
        else
            bb_page_append_string(page, parts[i].content);
        rest = at + strlen(parts[i].mark);
    }
    bb_page_append_string(page, rest);
    return page->failed ? bb_fail(BB_FAILED, "report: no memory for the page") : BB_OK;
}
