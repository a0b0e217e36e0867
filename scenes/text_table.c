#include "scenes/text_table.h"

#include "framework/base/file.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zstd.h>

static bb_status expand(const char *path, const char *packed, size_t size, uint64_t room,
                        char **text, size_t *length)
{
    unsigned long long whole = ZSTD_getFrameContentSize(packed, size);
    if (whole == ZSTD_CONTENTSIZE_ERROR)
        return bb_fail(BB_INVALID, "%s: is no zstd file", path);
    if (whole == ZSTD_CONTENTSIZE_UNKNOWN)
        return bb_fail(BB_INVALID, "%s: does not say how long it is: pack it from a file", path);
    if (whole >= room)
        return bb_fail(BB_REFUSED, "%s: expands to %llu bytes, more than there is memory for", path,
                       whole);
    *text = malloc((size_t)whole + 1);
    if (*text == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory to expand it to %llu bytes", path, whole);
    *length = ZSTD_decompress(*text, (size_t)whole, packed, size);
    if (ZSTD_isError(*length))
        return bb_fail(BB_INVALID, "%s: is damaged, or of several frames: %s", path,
                       ZSTD_getErrorName(*length));
    (*text)[*length] = '\0';
    return BB_OK;
}

bb_status bb_text_table_open(const char *path, uint64_t *room, bb_text_table *table)
{
    size_t size, length = strlen(path);
    *table = (bb_text_table){.path = path};
    BB_TRY(bb_file_read(path, (size_t)*room, "scene", &table->text, &size));
    bb_status status = BB_OK;
    if (length > 4 && strcasecmp(path + length - 4, ".zst") == 0) {
        char *packed = table->text;
        table->text = NULL;
        status = expand(path, packed, size, *room - size, &table->text, &size);
        free(packed);
    }
    if (status != BB_OK) {
        bb_text_table_close(table);
        return status;
    }
    *room -= size;
    table->at = table->text;
    table->end = table->text + size;
    return BB_OK;
}

void bb_text_table_close(bb_text_table *table)
{
    free(table->text);
    table->text = NULL;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Reports a word that is not a number. */
static bb_status no_number(const bb_text_table *table, const char *word, const char *end)
{
    char quoted[41];
    size_t length = (size_t)(end - word) < 40 ? (size_t)(end - word) : 40;
    for (size_t i = 0; i < length; i++)
        quoted[i] = (char)(isprint((unsigned char)word[i]) ? word[i] : '?');
    quoted[length] = '\0';
    return bb_fail(BB_INVALID, "%s: line %" PRIu64 ": '%s' is no number", table->path, table->line,
                   quoted);
}

/* Reads the numbers of one line, which ends at a comment. */
static bb_status read_line(bb_text_table *table, uint32_t most, double *numbers, uint32_t *count)
{
    *count = 0;
    table->line++;
    while (table->at < table->end && *table->at != '\n' && *table->at != '#') {
        if (is_blank(*table->at)) {
            table->at++;
            continue;
        }
        const char *word = table->at;
        while (table->at < table->end && !is_blank(*table->at) && *table->at != '\n' &&
               *table->at != '#')
            table->at++;
        char *end;
        double number = strtod(word, &end);
        bool good = end == table->at;
        for (const char *c = word; good && c < table->at; c++)
            good = tolower((unsigned char)*c) != 'x'; /* strtod() accepts hexadecimal */
        if (!good)
            return no_number(table, word, table->at);
        if (*count < most)
            numbers[(*count)++] = number;
    }
    while (table->at < table->end && *table->at != '\n')
        table->at++;
    table->at += table->at < table->end;
    return BB_OK;
}

bb_status bb_text_table_next(bb_text_table *table, const char *what, uint32_t least, uint32_t most,
                             double *numbers, uint32_t *count)
{
    do {
        if (table->at == table->end)
            return bb_fail(BB_INVALID, "%s: ends before %s", table->path, what);
        BB_TRY(read_line(table, most, numbers, count));
    } while (*count == 0);
    if (*count < least)
        return bb_fail(BB_INVALID, "%s: line %" PRIu64 ": %s needs %u numbers, it has %u",
                       table->path, table->line, what, least, *count);
    return BB_OK;
}

bb_status bb_text_table_whole(const bb_text_table *table, double number, const char *name,
                              uint64_t low, uint64_t high, uint64_t *out)
{
    if (!(number >= (double)low && number <= (double)high) || number != floor(number))
        return bb_fail(BB_INVALID,
                       "%s: line %" PRIu64 ": %s is %g, it must be a whole number from %" PRIu64
                       " to %" PRIu64,
                       table->path, table->line, name, number, low, high);
    *out = (uint64_t)number;
    return BB_OK;
}
