/* Parsing of specifications and of lists of them. */
#include "framework/base/options.h"

#include "framework/base/number.h"
#include "framework/base/suggest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool is_file(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

bb_status bb_spec_parse(const char *text, bb_spec *spec)
{
    memset(spec, 0, sizeof *spec);
    if (strlen(text) >= sizeof spec->text)
        return bb_fail(BB_INVALID, "'%.40s...' is longer than %zu characters", text,
                       sizeof spec->text - 1);
    strcpy(spec->text, text);
    strcpy(spec->buffer, text);
    spec->name = spec->buffer;
    if (is_file(text))
        return BB_OK;

    char *rest = strchr(spec->buffer, ':');
    if (rest != NULL)
        *rest++ = '\0';
    if (spec->name[0] == '\0')
        return bb_fail(BB_INVALID, "'%s' has no name: write name:key=value,key=value", text);
    while (rest != NULL) {
        char *next = strchr(rest, ',');
        if (next != NULL)
            *next++ = '\0';
        char *value = strchr(rest, '=');
        if (value == NULL || value == rest || value[1] == '\0')
            return bb_fail(BB_INVALID, "'%s' in '%s' is not key=value", rest, text);
        *value++ = '\0';
        for (uint32_t i = 0; i < spec->param_count; i++)
            if (strcmp(spec->keys[i], rest) == 0)
                return bb_fail(BB_INVALID, "'%s' is given twice in '%s'", rest, text);
        if (spec->param_count == BB_PARAMS_MAX)
            return bb_fail(BB_INVALID, "'%s' has more than %d parameters", text, BB_PARAMS_MAX);
        spec->keys[spec->param_count] = rest;
        spec->values[spec->param_count++] = value;
        rest = next;
    }
    return BB_OK;
}

/* Copies the stage that begins at `text`, without its backslashes; returns its end. */
static const char *copy_stage(const char *text, char *stage)
{
    for (; *text != '\0'; text++) {
        bool escaped = text[0] == '\\' && text[1] == '+';
        if (*text == '+' && (text[1] < '0' || text[1] > '9'))
            break;
        text += escaped;
        *stage++ = *text;
    }
    *stage = '\0';
    return text;
}

bb_status bb_spec_stages(const char *text, bb_spec *stages, uint32_t capacity, uint32_t *count)
{
    char stage[sizeof stages->text];
    *count = 0;
    if (strlen(text) >= sizeof stage)
        return bb_fail(BB_INVALID, "'%.40s...' is longer than %zu characters", text,
                       sizeof stage - 1);
    for (const char *start = text;; start++) {
        start = copy_stage(start, stage);
        if (stage[0] == '\0' && (*count > 0 || *start == '+'))
            return bb_fail(BB_INVALID,
                           "stage %u of '%s' is empty: write A+B; a plus in a value is \\+",
                           *count + 1, text);
        if (*count == capacity)
            return bb_fail(BB_INVALID, "'%s' has more than %u stages", text, capacity);
        BB_TRY(bb_spec_parse(stage, &stages[(*count)++]));
        if (*start == '\0')
            return BB_OK;
    }
}

static const bb_option *find_option(const bb_option *options, const char *key)
{
    for (const bb_option *option = options; option != NULL && option->name != NULL; option++)
        if (strcmp(option->name, key) == 0)
            return option;
    return NULL;
}

/* Returns whether `value` is one of the words of "a|b|c". */
static bool is_one_of(const char *words, const char *value)
{
    size_t length = strlen(value);
    for (const char *word = words; word != NULL;) {
        const char *end = strchr(word, '|');
        size_t size = end != NULL ? (size_t)(end - word) : strlen(word);
        if (size == length && memcmp(word, value, size) == 0)
            return true;
        word = end != NULL ? end + 1 : NULL;
    }
    return false;
}

static void list_options(const bb_option *options, char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = '\0';
    for (const bb_option *option = options;
         option != NULL && option->name != NULL && used < capacity; option++)
        used += (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? ", " : "",
                                 option->name);
}

bb_status bb_spec_validate(const bb_spec *spec, const bb_option *options, const char *what)
{
    for (uint32_t i = 0; i < spec->param_count; i++) {
        const bb_option *option = find_option(options, spec->keys[i]);
        if (option == NULL) {
            char known[256];
            bb_suggestion meant = {.word = spec->keys[i]};
            for (option = options; option != NULL && option->name != NULL; option++)
                bb_suggest(&meant, option->name);
            list_options(options, known, sizeof known);
            return bb_fail(BB_INVALID, "%s has no option '%s'%s: %s%s", what, spec->keys[i],
                           bb_suggested(&meant), known[0] != '\0' ? "it has " : "it has none",
                           known);
        }
        if (option->values != NULL && !is_one_of(option->values, spec->values[i]))
            return bb_fail(BB_INVALID, "%s: option '%s' is '%s', must be one of %s", what,
                           option->name, spec->values[i], option->values);
    }
    return BB_OK;
}

static const char *given_value(const bb_spec *spec, const char *key)
{
    for (uint32_t i = 0; spec != NULL && i < spec->param_count; i++)
        if (strcmp(spec->keys[i], key) == 0)
            return spec->values[i];
    return NULL;
}

bool bb_spec_gives(const bb_spec *spec, const char *key)
{
    return given_value(spec, key) != NULL;
}

const char *bb_spec_value(const bb_spec *spec, const bb_option *options, const char *key)
{
    const char *given = given_value(spec, key);
    if (given != NULL)
        return given;
    const bb_option *option = find_option(options, key);
    return option != NULL ? option->default_value : NULL;
}

bb_status bb_spec_u64(const bb_spec *spec, const bb_option *options, const char *key, uint64_t low,
                      uint64_t high, uint64_t *out)
{
    const char *value = bb_spec_value(spec, options, key);
    uint64_t number = 0;
    char range[BB_RANGE_TEXT];
    if (value == NULL || !bb_read_whole(value, &number) || number < low || number > high)
        return bb_fail(BB_INVALID, "%s: option '%s' is '%s', must be %s", spec->text, key,
                       value != NULL ? value : "", bb_range_of_whole(low, high, range));
    *out = number;
    return BB_OK;
}

bb_status bb_spec_double(const bb_spec *spec, const bb_option *options, const char *key, double low,
                         double high, double *out)
{
    const char *value = bb_spec_value(spec, options, key);
    double number = 0;
    if (value == NULL || !bb_read_real(value, &number) || number < low || number > high)
        return bb_fail(BB_INVALID, "%s: option '%s' is '%s', must be a number from %g to %g",
                       spec->text, key, value != NULL ? value : "", low, high);
    *out = number;
    return BB_OK;
}

bool bb_spec_is(const bb_spec *spec, const bb_option *options, const char *key, const char *word)
{
    const char *value = bb_spec_value(spec, options, key);
    return value != NULL && strcmp(value, word) == 0;
}

/* Returns whether the item that starts at `text` continues the previous one: it is `key=value`
 * without a ':' before the '='. */
static bool continues(const char *text)
{
    size_t stop = strcspn(text, "=:,");
    return stop > 0 && text[stop] == '=';
}

bb_status bb_spec_list(const char *text, char **items, size_t capacity, size_t *count)
{
    const char *start = text;
    bool whole = is_file(text);
    for (;;) {
        const char *end = start + (whole ? strlen(start) : strcspn(start, ","));
        while (!whole && *end == ',' && continues(end + 1))
            end = end + 1 + strcspn(end + 1, ",");
        if (end == start)
            return bb_fail(BB_INVALID, "empty item in the list '%s'", text);
        if (*count == capacity)
            return bb_fail(BB_INVALID, "more than %zu items in '%.80s'", capacity, text);
        char *item = strndup(start, (size_t)(end - start));
        if (item == NULL)
            return bb_fail(BB_FAILED, "out of memory");
        items[(*count)++] = item;
        if (*end == '\0')
            return BB_OK;
        start = end + 1;
    }
}
