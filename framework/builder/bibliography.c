#include "framework/builder/bibliography.h"
#include "framework/builder/registry.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { INCLUDES_MAX = 8 }; /* files that include each other */

static const char *skip_blanks(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

/* ---- one entry ---- */

/* Returns what follows the brace that closes the one at `at`; NULL: the text ends before. */
static const char *skip_braces(const char *at)
{
    for (int depth = 0; *at != '\0'; at++) {
        depth += *at == '{' ? 1 : *at == '}' ? -1 : 0;
        if (depth == 0)
            return at + 1;
    }
    return NULL;
}

typedef struct span {
    const char *text;
    size_t length;
} span;

#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

/* Returns the quote that ends the string at `at`, beyond those in braces; NULL: the text ends
 * before. */
static const char *end_of_quoted(const char *at)
{
    for (at++; *at != '\0' && *at != '"';) {
        at = *at == '{' ? skip_braces(at) : at + 1;
        if (at == NULL)
            return NULL;
    }
    return *at == '"' ? at : NULL;
}

/* Reads NAME = {VALUE}, "VALUE", NUMBER or WORD, such as a month, and a comma, if any. Returns what
 * follows; NULL: it is none of these. */
static const char *read_field(const char *at, span *name, span *value)
{
    at = skip_blanks(at);
    *name = (span){at, strspn(at, LETTERS "-_")};
    at = skip_blanks(at + name->length);
    if (name->length == 0 || *at != '=')
        return NULL;
    at = skip_blanks(at + 1);
    if (*at == '{') {
        const char *end = skip_braces(at);
        if (end == NULL)
            return NULL;
        *value = (span){at + 1, (size_t)(end - at) - 2};
        at = end;
    } else if (*at == '"') {
        const char *end = end_of_quoted(at);
        if (end == NULL)
            return NULL;
        *value = (span){at + 1, (size_t)(end - at) - 1};
        at = end + 1;
    } else {
        *value = (span){at, strspn(at, LETTERS "0123456789-_")};
        if (value->length == 0)
            return NULL;
        at += value->length;
    }
    at = skip_blanks(at);
    return *at == ',' ? skip_blanks(at + 1) : *at == '}' ? at : NULL;
}

static span key_of(const bb_citation *citation)
{
    const char *key = skip_blanks(strchr(citation->text, '{') + 1);
    return (span){key, strcspn(key, ", \t\r\n{}=")};
}

/* Returns the first field, after the key and its comma; NULL: there is no such comma. */
static const char *fields_of(const bb_citation *citation)
{
    const span key = key_of(citation);
    const char *at = skip_blanks(key.text + key.length);
    return key.length > 0 && *at == ',' ? skip_blanks(at + 1) : NULL;
}

static bool is_well_formed(const bb_citation *citation)
{
    const char *at = fields_of(citation);
    span name, value;
    while (at != NULL && *at != '}')
        at = read_field(at, &name, &value);
    return at != NULL && at + 1 == citation->text + citation->length;
}

static bool find_value(const bb_citation *citation, const char *wanted, span *value)
{
    span name;
    if (strcmp(wanted, "key") == 0) {
        *value = key_of(citation);
        return true;
    }
    for (const char *at = fields_of(citation); at != NULL && *at != '}';) {
        at = read_field(at, &name, value);
        if (at != NULL && strlen(wanted) == name.length &&
            strncasecmp(wanted, name.text, name.length) == 0)
            return true;
    }
    return false;
}

void bb_citation_value(const bb_citation *citation, const char *name, char value[BB_CITED_MAX])
{
    span found = {"", 0};
    size_t used = 0;
    if (!find_value(citation, name, &found))
        found.length = 0;
    for (size_t i = 0; i < found.length && used + 1 < BB_CITED_MAX; i++)
        if (found.text[i] != '{' && found.text[i] != '}')
            value[used++] = found.text[i];
    value[used] = '\0';
}

/* ---- files ---- */

static bb_status add_entry(bb_bibliography *bibliography, const char *file,
                           const bb_citation *citation)
{
    static const char *const required[] = {"author", "title", "year"};
    char key[BB_CITED_MAX], other[BB_CITED_MAX], value[BB_CITED_MAX];
    if (!is_well_formed(citation))
        return bb_fail(BB_INVALID, "%s: '%.40s' is no entry of BibTeX: @type{key, name = {value}}",
                       file, citation->text);
    bb_citation_value(citation, "key", key);
    for (size_t i = 0; i < sizeof required / sizeof *required; i++) {
        bb_citation_value(citation, required[i], value);
        if (value[0] == '\0')
            return bb_fail(BB_INVALID, "%s: the entry %s has no %s", file, key, required[i]);
    }
    for (uint32_t i = 0; i < bibliography->count; i++) {
        const bb_citation *there = &bibliography->entries[i];
        bb_citation_value(there, "key", other);
        if (strcmp(key, other) != 0)
            continue;
        return there->length == citation->length &&
                       memcmp(there->text, citation->text, citation->length) == 0
                   ? BB_OK
                   : bb_fail(BB_INVALID, "%s: there is another entry %s: give one another key",
                             file, key);
    }
    if (bibliography->count == BB_CITATIONS_MAX)
        return bb_fail(BB_INVALID, "%s: more than %d papers", file, BB_CITATIONS_MAX);
    bibliography->entries[bibliography->count++] = *citation;
    return BB_OK;
}

/* What begins like an entry and is none. */
static bool is_other_command(const char *type, size_t length)
{
    static const char *const others[] = {"comment", "preamble", "string"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strlen(others[i]) == length && strncasecmp(type, others[i], length) == 0)
            return true;
    return false;
}

static bb_status add_text(bb_bibliography *bibliography, const char *file, const char *text,
                          int depth)
{
    char name[BB_CITED_MAX];
    if (depth == INCLUDES_MAX)
        return bb_fail(BB_INVALID, "%s: it includes itself, or files %d deep", file, INCLUDES_MAX);
    for (const char *at = skip_blanks(text); *at != '\0'; at = skip_blanks(at)) {
        if (*at == '@') {
            const size_t type = strspn(at + 1, LETTERS);
            const char *open = skip_blanks(at + 1 + type);
            const char *end = *open == '{' ? skip_braces(open) : NULL;
            if (end == NULL)
                return bb_fail(BB_INVALID, "%s: braces do not match in '%.40s'", file, at);
            const bb_citation citation = {at, (size_t)(end - at)};
            if (!is_other_command(at + 1, type))
                BB_TRY(add_entry(bibliography, file, &citation));
            at = end;
            continue;
        }
        if (sscanf(at, "#include \"%255[^\"\n]\"", name) == 1) {
            const bb_source *included = bb_device_file_find(name);
            if (included == NULL)
                return bb_fail(BB_INVALID, "%s: it includes %s, which does not exist", file, name);
            BB_TRY(add_text(bibliography, included->name, included->text, depth + 1));
        }
        at += strcspn(at, "\n");
    }
    return BB_OK;
}

bb_status bb_bibliography_read(bb_bibliography *bibliography, const char *file, const char *text)
{
    return add_text(bibliography, file, text, 0);
}

bb_status bb_bibliography_add(bb_bibliography *bibliography, const char *file)
{
    const bb_source *source = bb_device_file_find(file);
    return source != NULL ? bb_bibliography_read(bibliography, file, source->text) : BB_OK;
}
