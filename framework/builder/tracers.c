#include "framework/builder/tracers.h"

#include "framework/builder/declared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOADED_MAX = 64 };

static const bb_tracer *loaded[LOADED_MAX];
static uint32_t loaded_count;

static uint32_t builtin_count(void)
{
    uint32_t count = 0;
    while (bb_builtin_tracers[count] != NULL)
        count++;
    return count;
}

uint32_t bb_tracer_count(void)
{
    return builtin_count() + loaded_count;
}

const bb_tracer *bb_tracer_at(uint32_t index)
{
    const uint32_t builtin = builtin_count();
    if (index < builtin)
        return bb_builtin_tracers[index];
    return index - builtin < loaded_count ? loaded[index - builtin] : NULL;
}

const bb_tracer *bb_tracer_find(const char *name)
{
    for (uint32_t i = 0; i < bb_tracer_count(); i++)
        if (strcmp(bb_tracer_at(i)->name, name) == 0)
            return bb_tracer_at(i);
    return NULL;
}

bool bb_tracer_is_builtin(const bb_tracer *tracer)
{
    for (uint32_t i = 0; i < builtin_count(); i++)
        if (bb_builtin_tracers[i] == tracer)
            return true;
    return false;
}

const bb_tracer *bb_tracer_of(const char *text)
{
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":"), text);
    return bb_tracer_find(name);
}

bool bb_is_reference(const char *text)
{
    const size_t length = sizeof BB_REFERENCE_NAME - 1;
    return strncmp(text, BB_REFERENCE_NAME, length) == 0 &&
           (text[length] == '\0' || text[length] == ':');
}

static bb_status check_spec(const bb_tracer *tracer, const bb_spec *spec)
{
    char what[80];
    snprintf(what, sizeof what, "tracer %s", tracer->name);
    return bb_spec_validate(spec, tracer->options, what);
}

bb_status bb_tracer_parse(const char *text, const bb_tracer **tracer, bb_spec *spec)
{
    BB_TRY(bb_spec_parse(text, spec));
    *tracer = bb_tracer_find(spec->name);
    if (*tracer == NULL)
        return bb_fail(BB_INVALID, "unknown tracer '%s': `bvhbench list tracers` shows them",
                       spec->name);
    return check_spec(*tracer, spec);
}

/* Whether the option is among those of the list. */
static bool is_listed(const char *list, const char *option)
{
    const size_t length = strlen(option);
    for (const char *at = list; at != NULL && *at != '\0'; at += *at == ',') {
        if (strncmp(at, option, length) == 0 && (at[length] == ',' || at[length] == '\0'))
            return true;
        at += strcspn(at, ",");
    }
    return false;
}

static bool same_value(const char *a, const char *b)
{
    return a == b || (a != NULL && b != NULL && strcmp(a, b) == 0);
}

bool bb_tracer_same_tree(const bb_tracer *a, const bb_spec *a_spec, const bb_tracer *b,
                         const bb_spec *b_spec)
{
    if (a != b)
        return false;
    for (const bb_option *o = a->options; o != NULL && o->name != NULL; o++)
        if (!is_listed(a->passing, o->name) &&
            !same_value(bb_spec_value(a_spec, a->options, o->name),
                        bb_spec_value(b_spec, a->options, o->name)))
            return false;
    return true;
}

const char *bb_tracer_compared(const bb_tracer *tracer)
{
    const bb_variants *row = bb_variants_of(tracer->variants, BB_ROLE_COMPARED, BB_FOR_ALL);
    return row != NULL ? row->specs : tracer->name;
}

/* ---- adding one ---- */

static bool has_option(const bb_tracer *tracer, const char *name, size_t length)
{
    for (const bb_option *o = tracer->options; o != NULL && o->name != NULL; o++)
        if (strlen(o->name) == length && strncmp(o->name, name, length) == 0)
            return true;
    return false;
}

static bool has_default(const bb_tracer *tracer, const char *name)
{
    for (const bb_option *o = tracer->options; o != NULL && o->name != NULL; o++)
        if (strcmp(o->name, name) == 0)
            return o->default_value != NULL;
    return false;
}

static bool has_all(const bb_tracer *tracer, const char *list)
{
    for (const char *at = list; at != NULL && *at != '\0'; at += *at == ',') {
        const size_t length = strcspn(at, ",");
        if (!has_option(tracer, at, length))
            return false;
        at += length;
    }
    return true;
}

static bb_status check_variant(const bb_tracer *tracer, const char *item)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse(item, &spec));
    if (strcmp(spec.name, tracer->name) != 0)
        return bb_fail(BB_INVALID, "tracer %s: its variants hold '%s', which is another's",
                       tracer->name, item);
    return check_spec(tracer, &spec);
}

static bb_status check_variants(const bb_tracer *tracer)
{
    for (const bb_variants *row = tracer->variants; row != NULL && row->devices != 0; row++) {
        char *items[64] = {NULL};
        size_t count = 0;
        if (row->role == NULL || row->specs == NULL || strcmp(row->role, BB_ROLE_COMPARED) != 0 ||
            row->devices != BB_FOR_ALL)
            return bb_fail(BB_INVALID,
                           "tracer %s: its variants may have the role %s alone, for "
                           "all devices",
                           tracer->name, BB_ROLE_COMPARED);
        bb_status status = bb_spec_list(row->specs, items, 64, &count);
        for (size_t i = 0; i < count; i++) {
            if (status == BB_OK)
                status = check_variant(tracer, items[i]);
            free(items[i]);
        }
        BB_TRY(status);
    }
    return BB_OK;
}

static bb_status check(const bb_tracer *tracer)
{
    char what[80];
    if (tracer->abi_version != BB_TRACER_ABI_VERSION)
        return bb_fail(BB_INVALID,
                       "tracer made for ABI version %u, this bvhbench has %d: build it again with "
                       "this one's headers",
                       tracer->abi_version, BB_TRACER_ABI_VERSION);
    if (!bb_is_name(tracer->name) || strcmp(tracer->name, "all") == 0)
        return bb_fail(BB_INVALID,
                       "tracer with the bad name '%.40s': a letter, then a-z, 0-9 and '-', and not "
                       "\"all\"",
                       tracer->name == NULL ? "" : tracer->name);
    const struct {
        bool good;
        const char *problem;
    } rules[] = {
        {bb_is_line(tracer->summary), "summary is missing or has more than one line"},
        {bb_is_line(tracer->paper), "paper is missing (\"none\" for none)"},
        {tracer->kinds != 0 && !(tracer->kinds & ~(uint32_t)BB_ALL_KINDS),
         "kinds is 0 or has unknown bits"},
        {tracer->create != NULL, "create() is missing"},
        {tracer->build != NULL, "build() is missing"},
        {tracer->trace != NULL, "trace() is missing"},
        {tracer->destroy != NULL, "destroy() is missing"},
        {has_all(tracer, tracer->passing), "passing names an option that it does not have"},
        {tracer->exactness == NULL || has_default(tracer, tracer->exactness),
         "exactness names no option that it has, with a default"},
        {tracer->passing == NULL || tracer->passing[0] == '\0' || tracer->pass != NULL,
         "pass() is missing, and passing names options"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (!rules[i].good)
            return bb_fail(BB_INVALID, "tracer %s: %s", tracer->name, rules[i].problem);
    snprintf(what, sizeof what, "tracer %s", tracer->name);
    BB_TRY(bb_options_check(what, tracer->options));
    return check_variants(tracer);
}

bb_status bb_tracer_add(const bb_tracer *tracer)
{
    BB_TRY(check(tracer));
    if (bb_tracer_find(tracer->name) != NULL)
        return bb_fail(BB_INVALID, "there is a tracer %s already", tracer->name);
    if (loaded_count == LOADED_MAX)
        return bb_fail(BB_INVALID, "more than %d plug-ins", LOADED_MAX);
    loaded[loaded_count++] = tracer;
    return BB_OK;
}
