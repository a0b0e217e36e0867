#include "framework/builder/declared.h"

#include <ctype.h>
#include <string.h>

bool bb_is_name(const char *name)
{
    if (name == NULL || !islower((unsigned char)name[0]) || strlen(name) > 40)
        return false;
    for (const char *c = name; *c != '\0'; c++)
        if (!islower((unsigned char)*c) && !isdigit((unsigned char)*c) && *c != '-')
            return false;
    return true;
}

bool bb_is_line(const char *text)
{
    return text != NULL && text[0] != '\0' && strpbrk(text, "\n\r") == NULL;
}

/* Whether `value` is among "a|b|c". */
static bool is_among(const char *values, const char *value)
{
    size_t length = strlen(value);
    for (const char *item = values; item != NULL; item = strchr(item, '|')) {
        item += *item == '|';
        if (strcspn(item, "|") == length && strncmp(item, value, length) == 0)
            return true;
    }
    return false;
}

bb_status bb_options_check(const char *what, const bb_option *options)
{
    for (uint32_t i = 0; options != NULL && options[i].name != NULL; i++) {
        const bb_option *option = &options[i];
        if (i == BB_PARAMS_MAX)
            return bb_fail(BB_INVALID, "%s: more than %d options, or no end of the table", what,
                           BB_PARAMS_MAX);
        if (option->name[0] == '\0' || strpbrk(option->name, ":=,|+ \t\n") != NULL)
            return bb_fail(BB_INVALID, "%s: option %u has the bad name '%s'", what, i,
                           option->name);
        if (!bb_is_line(option->help))
            return bb_fail(BB_INVALID, "%s: option %s has no help of one line", what, option->name);
        if (option->values != NULL && option->default_value != NULL &&
            !is_among(option->values, option->default_value))
            return bb_fail(BB_INVALID, "%s: default '%s' of option %s is not among %s", what,
                           option->default_value, option->name, option->values);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(options[k].name, option->name) == 0)
                return bb_fail(BB_INVALID, "%s: option %s is declared twice", what, option->name);
    }
    return BB_OK;
}
