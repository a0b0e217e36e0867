/* Reads texts as values of options: numbers, words, sizes and lists. */
#include "framework/base/number.h"
#include "framework/base/options.h"
#include "framework/cli/cli.h"
#include "framework/scene/camera.h"

#include <stdlib.h>
#include <string.h>

void bb_names_free(bb_names *names)
{
    for (size_t i = 0; i < names->count; i++)
        free(names->items[i]);
    names->count = 0;
}

static bb_status store_whole(const bb_cli_row *row, const char *text)
{
    const bb_cli_option *o = row->option;
    const bool wide = o->kind == BB_CLI_U64;
    const uint64_t most = wide ? UINT64_MAX : UINT32_MAX, low = (uint64_t)o->low,
                   high = o->high > 0 ? (uint64_t)o->high : most;
    uint64_t number;
    char range[BB_RANGE_TEXT];
    if (!bb_read_whole(text, &number) || number < low || number > high)
        return bb_fail(BB_INVALID, "--%s is '%s', must be %s", o->name, text,
                       bb_range_of_whole(low, high, range));
    if (wide)
        *(uint64_t *)(void *)row->place = number;
    else
        *(uint32_t *)(void *)row->place = (uint32_t)number;
    return BB_OK;
}

static bb_status store_double(const bb_cli_row *row, const char *text)
{
    const bb_cli_option *o = row->option;
    double number;
    if (!bb_read_real(text, &number) || number < o->low || number > o->high)
        return bb_fail(BB_INVALID, "--%s is '%s', must be a number from %g to %g", o->name, text,
                       o->low, o->high);
    *(double *)(void *)row->place = number;
    return BB_OK;
}

static bb_status store_word(const bb_cli_row *row, const char *text)
{
    const bb_cli_option *o = row->option;
    char known[256] = "";
    const char *word = o->words;
    for (uint32_t i = 0;; i++) {
        const size_t length = strcspn(word, "|"), used = strlen(known);
        const bool last = word[length] == '\0';
        if (strlen(text) == length && strncmp(text, word, length) == 0) {
            *(uint32_t *)(void *)row->place = i;
            return BB_OK;
        }
        snprintf(known + used, sizeof known - used, "%s%.*s", i == 0 ? "" : (last ? " or " : ", "),
                 (int)length, word);
        if (last)
            return bb_fail(BB_INVALID, "--%s is '%s', must be %s", o->name, text, known);
        word += length + 1;
    }
}

static bb_status store_size(const bb_cli_row *row, const char *text)
{
    enum { SIDE_MAX = 65536 };
    const char *name = row->option->name;
    uint32_t *sides = (uint32_t *)(void *)row->place;
    char first[32] = "";
    size_t length = strcspn(text, "x");
    uint64_t w, h;
    if (length < sizeof first)
        memcpy(first, text, length);
    if (text[length] != 'x' || !bb_read_whole(first, &w) || !bb_read_whole(text + length + 1, &h))
        return bb_fail(BB_INVALID, "--%s is '%s', must be WIDTHxHEIGHT, such as 512x512", name,
                       text);
    if (w < 1 || h < 1 || w > SIDE_MAX || h > SIDE_MAX || w * h > BB_PIXELS_MAX)
        return bb_fail(BB_INVALID,
                       "--%s is '%s': width and height must be from 1 to %d, and %u pixels at most "
                       "together",
                       name, text, SIDE_MAX, (unsigned)BB_PIXELS_MAX);
    sides[0] = (uint32_t)w;
    sides[1] = (uint32_t)h;
    return BB_OK;
}

static bb_status store_items(const bb_cli_row *row, const char *text)
{
    bb_names *names = (bb_names *)(void *)row->place;
    const char *name = row->option->name;
    if (row->option->kind == BB_CLI_LIST) {
        bb_status status = bb_spec_list(text, names->items, BB_NAMES_MAX, &names->count);
        return status == BB_OK ? BB_OK : bb_fail(status, "--%s: %s", name, bb_message());
    }
    char *item = strdup(text);
    if (item == NULL)
        return bb_fail(BB_FAILED, "--%s: no memory", name);
    names->items[names->count++] = item;
    return BB_OK;
}

bb_status bb_cli_store(const bb_cli_row *row, const char *text)
{
    switch (row->option->kind) {
    case BB_CLI_FLAG:
        *(bool *)row->place = true;
        return BB_OK;
    case BB_CLI_TEXT:
        *(const char **)(void *)row->place = text;
        return BB_OK;
    case BB_CLI_SIZE:
        return store_size(row, text);
    case BB_CLI_DOUBLE:
        return store_double(row, text);
    case BB_CLI_LIST:
    case BB_CLI_EACH:
        return store_items(row, text);
    case BB_CLI_U32:
    case BB_CLI_U64:
        return row->option->words != NULL ? store_word(row, text) : store_whole(row, text);
    case BB_CLI_GROUP:
    case BB_CLI_END:
        break;
    }
    return BB_OK;
}
