/* The registry of builders: the built-in table that CMake made from the folders, and loaded
 * plug-ins. */
#include "framework/builder/registry.h"

#include "framework/builder/declared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOADED_MAX = 64 };

static const bb_registration *loaded[LOADED_MAX];
static uint32_t loaded_count;

static uint32_t builtin_count(void)
{
    uint32_t count = 0;
    while (bb_builtin_builders[count].builder != NULL)
        count++;
    return count;
}

uint32_t bb_builder_count(void)
{
    return builtin_count() + loaded_count;
}

static const bb_registration *registration_at(uint32_t index)
{
    uint32_t builtin = builtin_count();
    if (index < builtin)
        return &bb_builtin_builders[index];
    return index - builtin < loaded_count ? loaded[index - builtin] : NULL;
}

const bb_builder *bb_builder_at(uint32_t index)
{
    const bb_registration *found = registration_at(index);
    return found != NULL ? found->builder : NULL;
}

const bb_builder *bb_builder_find(const char *name)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++)
        if (strcmp(bb_builder_at(i)->name, name) == 0)
            return bb_builder_at(i);
    return NULL;
}

const bb_source *bb_device_file_find(const char *name)
{
    const bb_source *found = bb_source_find(name);
    for (uint32_t i = 0; i < bb_builder_count() && found == NULL; i++)
        for (const bb_source *file = registration_at(i)->files;
             file != NULL && file->name != NULL && found == NULL; file++)
            if (strcmp(file->name, name) == 0)
                found = file;
    return found;
}

/* ---- validation ---- */

/* One of the stages must be this builder, with parameters that it takes; the builders of the other
 * stages need not exist yet. */
static bb_status validate_variant(const bb_builder *builder, const char *item, const char *member)
{
    bb_spec stages[BB_STAGES_MAX];
    uint32_t count;
    bool found = false;
    BB_TRY(bb_spec_stages(item, stages, BB_STAGES_MAX, &count));
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(stages[i].name, builder->name) != 0)
            continue;
        found = true;
        BB_TRY(bb_spec_validate(&stages[i], builder->options, member));
    }
    return found ? BB_OK
                 : bb_fail(BB_INVALID, "%s holds '%s', which is another builder", member, item);
}

/* Default variants must be specifications of this builder. */
static bb_status validate_variants(const bb_builder *builder, const char *list, const char *member)
{
    char *items[64] = {NULL};
    size_t count = 0;
    bb_status status = bb_spec_list(list, items, 64, &count);
    for (size_t i = 0; i < count; i++) {
        if (status == BB_OK)
            status = validate_variant(builder, items[i], member);
        free(items[i]);
    }
    return status == BB_OK ? BB_OK : bb_fail(status, "builder %s: %s", builder->name, bb_message());
}

/* Roles whose value is one variant, not a list. */
static const char *const of_one_variant[] = {BB_ROLE_GENEROUS, BB_ROLE_YARDSTICK, BB_ROLE_USUAL,
                                             BB_ROLE_COST_REFERENCE};

static bool has_word(const char *const *words, size_t count, const char *word)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(words[i], word) == 0)
            return true;
    return false;
}

/* A misspelt role, or a second row for a role, would have no effect. */
static bb_status validate_role(const bb_builder *builder, const bb_variants *row)
{
    static const char *const roles[] = {BB_BUILDER_ROLES};
    if (!has_word(roles, sizeof roles / sizeof *roles, row->role))
        return bb_fail(BB_INVALID, "builder %s: its variants have the unknown role '%.40s'",
                       builder->name, row->role);
    if (bb_variants_of(builder->variants, row->role, BB_FOR_ALL) != row)
        return bb_fail(BB_INVALID, "builder %s: its variants have the role %s twice", builder->name,
                       row->role);
    if (row->devices != BB_FOR_ALL)
        return bb_fail(BB_INVALID, "builder %s: its variants of role %s are not for all devices",
                       builder->name, row->role);
    return BB_OK;
}

static bb_status validate_row(const bb_builder *builder, const bb_variants *row)
{
    bb_spec spec;
    if (row->role == NULL || row->specs == NULL)
        return bb_fail(BB_INVALID, "builder %s: a row of its variants has no %s", builder->name,
                       row->role == NULL ? "role" : "variants");
    BB_TRY(validate_role(builder, row));
    BB_TRY(validate_variants(builder, row->specs, row->role));
    const size_t count = sizeof of_one_variant / sizeof *of_one_variant;
    return !has_word(of_one_variant, count, row->role) ||
                   (bb_spec_parse(row->specs, &spec) == BB_OK &&
                    strcmp(spec.name, builder->name) == 0 &&
                    bb_spec_validate(&spec, builder->options, row->role) == BB_OK)
               ? BB_OK
               : bb_fail(BB_INVALID, "builder %s: %s holds '%s', must be one variant of it",
                         builder->name, row->role, row->specs);
}

const char *bb_builder_variants(const bb_builder *builder, const char *role)
{
    const bb_variants *row = bb_variants_of(builder->variants, role, BB_FOR_ALL);
    return row != NULL ? row->specs : NULL;
}

bool bb_builder_is_compared(const bb_builder *builder)
{
    return builder->variants == NULL || bb_builder_variants(builder, BB_ROLE_COMPARED) != NULL;
}

/* Whether it builds trees from boxes of any kind. */
static bool is_for_all(const bb_builder *builder)
{
    return builder->split == NULL && !bb_is_optimiser(builder) && bb_builder_is_compared(builder) &&
           builder->kinds == BB_ALL_KINDS && (builder->inputs & BB_INPUTS_OF_PRIMITIVES) == 0;
}

bb_status bb_builder_validate(const bb_builder *builder)
{
    if (builder->abi_version != BB_ABI_VERSION)
        return bb_fail(BB_INVALID,
                       "builder made for ABI version %u, this bvhbench has %d: build it again with "
                       "this one's headers",
                       builder->abi_version, BB_ABI_VERSION);
    if (!bb_is_name(builder->name) || strcmp(builder->name, "all") == 0)
        return bb_fail(BB_INVALID,
                       "builder with the bad name '%.40s': a letter, then a-z, 0-9 and '-', and "
                       "not \"all\"",
                       builder->name == NULL ? "" : builder->name);
    const uint32_t inputs = BB_INPUT_BOXES | BB_INPUT_TREE | BB_INPUT_PROFILE | BB_INPUT_OBJECTS |
                            BB_INPUTS_OF_PRIMITIVES;
    const struct {
        bool good;
        const char *problem;
    } rules[] = {
        {bb_is_line(builder->summary), "summary is missing or has more than one line"},
        {bb_is_line(builder->paper), "paper is missing (\"none\" for none)"},
        {builder->kinds != 0 && !(builder->kinds & ~(uint32_t)BB_ALL_KINDS),
         "kinds is 0 or has unknown bits"},
        {builder->inputs != 0 && !(builder->inputs & ~inputs), "inputs is 0 or has unknown bits"},
        {builder->place == BB_ON_HOST || builder->place == BB_ON_DEVICE, "place is no bb_place"},
        {builder->create != NULL, "create() is missing"},
        {builder->build != NULL || builder->split != NULL, "build() is missing"},
        {builder->build == NULL || builder->split == NULL,
         "both build() and split(): it is a builder or a splitter"},
        {builder->split == NULL || !bb_is_optimiser(builder),
         "split() of a tree: a splitter comes before the first tree"},
        {builder->destroy != NULL, "destroy() is missing"},
        {bb_builder_variants(builder, BB_ROLE_USUAL) == NULL || is_for_all(builder),
         "usual, but no builder of all kinds, from boxes, that is compared by default"},
        {bb_builder_variants(builder, BB_ROLE_YARDSTICK) == NULL ||
             (builder->split == NULL && !bb_is_optimiser(builder)),
         "yardstick, but it makes no tree by itself"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (!rules[i].good)
            return bb_fail(BB_INVALID, "builder %s: %s", builder->name, rules[i].problem);
    char what[80];
    snprintf(what, sizeof what, "builder %s", builder->name);
    BB_TRY(bb_options_check(what, builder->options));
    for (const bb_variants *row = builder->variants; row != NULL && row->devices != 0; row++)
        BB_TRY(validate_row(builder, row));
    return BB_OK;
}

/* ---- adding one ---- */

/* Names of files are unique across builders: --kernels-from finds files by name alone. */
static bb_status check_files(const char *builder, const bb_source *files)
{
    for (const bb_source *file = files; file != NULL && file->name != NULL; file++)
        if (bb_device_file_find(file->name) != NULL)
            return bb_fail(BB_INVALID,
                           "builder %s: there is a device file %s already: give it another name",
                           builder, file->name);
    return BB_OK;
}

/* Roles that only one builder may have. */
static const char *const of_one_builder[] = {BB_ROLE_USUAL, BB_ROLE_COST_REFERENCE};

static bb_status check_sole(const bb_builder *builder)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *other = bb_builder_at(i);
        for (size_t r = 0; r < sizeof of_one_builder / sizeof *of_one_builder; r++)
            if (bb_builder_variants(builder, of_one_builder[r]) != NULL &&
                bb_builder_variants(other, of_one_builder[r]) != NULL)
                return bb_fail(BB_INVALID, "builder %s: `%s` is %s already: drop that role",
                               builder->name, of_one_builder[r],
                               bb_builder_variants(other, of_one_builder[r]));
    }
    return BB_OK;
}

bb_status bb_builder_add(const bb_registration *registration)
{
    const bb_builder *builder = registration->builder;
    BB_TRY(bb_builder_validate(builder));
    if (bb_builder_find(builder->name) != NULL)
        return bb_fail(BB_INVALID, "there is a builder %s already", builder->name);
    BB_TRY(check_sole(builder));
    BB_TRY(check_files(builder->name, registration->files));
    if (loaded_count == LOADED_MAX)
        return bb_fail(BB_INVALID, "more than %d plug-ins", LOADED_MAX);
    loaded[loaded_count++] = registration;
    return BB_OK;
}

/* ---- inputs ---- */

void bb_input_words(uint32_t inputs, char *text, size_t capacity)
{
    static const struct {
        uint32_t input;
        const char *word;
    } words[] = {{BB_INPUT_BOXES, "boxes"},
                 {BB_INPUT_GEOMETRY, "geometry"},
                 {BB_INPUT_PROFILE, "profile"},
                 {BB_INPUT_OBJECTS, "objects"}};
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < sizeof words / sizeof words[0] && used < capacity; i++)
        if ((inputs & words[i].input) != 0)
            used += (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? " " : "",
                                     words[i].word);
}
