/* The registry of builders: the built-in table that CMake made from the folders, and what was
 * loaded from shared objects; and the clock of a build's phases. */
#include "framework/builder/builder.h"
#include "framework/base/clock.h"

#include <ctype.h>
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { LOADED_MAX = 64 };

static const bb_builder *loaded[LOADED_MAX];
static uint32_t loaded_count;

static uint32_t builtin_count(void)
{
    uint32_t count = 0;
    while (bb_builtin_builders[count] != NULL)
        count++;
    return count;
}

uint32_t bb_builder_count(void)
{
    return builtin_count() + loaded_count;
}

const bb_builder *bb_builder_at(uint32_t index)
{
    uint32_t builtin = builtin_count();
    if (index < builtin)
        return bb_builtin_builders[index];
    return index - builtin < loaded_count ? loaded[index - builtin] : NULL;
}

const bb_builder *bb_builder_find(const char *name)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++)
        if (strcmp(bb_builder_at(i)->name, name) == 0)
            return bb_builder_at(i);
    return NULL;
}

/* ---- validation ---- */

/* Lower case, digits, '-', beginning with a letter: what a specification and a folder can carry. */
static bool is_name(const char *name)
{
    if (name == NULL || !islower((unsigned char)name[0]) || strlen(name) > 40)
        return false;
    for (const char *c = name; *c != '\0'; c++)
        if (!islower((unsigned char)*c) && !isdigit((unsigned char)*c) && *c != '-')
            return false;
    return true;
}

static bool is_line(const char *text)
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

static bb_status validate_options(const char *builder, const bb_option *options)
{
    for (uint32_t i = 0; options != NULL && options[i].name != NULL; i++) {
        const bb_option *option = &options[i];
        if (i == BB_PARAMS_MAX)
            return bb_fail(BB_INVALID, "builder %s: more than %d options, or no end of the table",
                           builder, BB_PARAMS_MAX);
        if (option->name[0] == '\0' || strpbrk(option->name, ":=,|+ \t\n") != NULL)
            return bb_fail(BB_INVALID, "builder %s: option %u has the bad name '%s'", builder, i,
                           option->name);
        if (!is_line(option->help))
            return bb_fail(BB_INVALID, "builder %s: option %s has no help of one line", builder,
                           option->name);
        if (option->values != NULL && option->default_value != NULL &&
            !is_among(option->values, option->default_value))
            return bb_fail(BB_INVALID, "builder %s: default '%s' of option %s is not among %s",
                           builder, option->default_value, option->name, option->values);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(options[k].name, option->name) == 0)
                return bb_fail(BB_INVALID, "builder %s: option %s is declared twice", builder,
                               option->name);
    }
    return BB_OK;
}

/* One of the stages is this builder, with parameters that it takes; the others need not be there
 * yet. */
static bb_status validate_compared_item(const bb_builder *builder, const char *item)
{
    bb_spec stages[BB_STAGES_MAX];
    uint32_t count;
    bool found = false;
    BB_TRY(bb_spec_stages(item, stages, BB_STAGES_MAX, &count));
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(stages[i].name, builder->name) != 0)
            continue;
        found = true;
        BB_TRY(bb_spec_validate(&stages[i], builder->options, "compared"));
    }
    return found ? BB_OK
                 : bb_fail(BB_INVALID, "compared holds '%s', which is another builder", item);
}

/* What `run` compares by default must be specifications of this builder. */
static bb_status validate_compared(const bb_builder *builder)
{
    char *items[64] = {NULL};
    size_t count = 0;
    if (builder->compared == NULL || builder->compared[0] == '\0')
        return BB_OK;
    bb_status status = bb_spec_list(builder->compared, items, 64, &count);
    for (size_t i = 0; i < count; i++) {
        if (status == BB_OK)
            status = validate_compared_item(builder, items[i]);
        free(items[i]);
    }
    return status == BB_OK ? BB_OK : bb_fail(status, "builder %s: %s", builder->name, bb_message());
}

bb_status bb_builder_validate(const bb_builder *builder)
{
    if (builder->abi_version != BB_ABI_VERSION)
        return bb_fail(BB_INVALID,
                       "builder made for ABI version %u, this bvhbench has %d: build it again with "
                       "this one's headers",
                       builder->abi_version, BB_ABI_VERSION);
    if (!is_name(builder->name) || strcmp(builder->name, "all") == 0 ||
        strcmp(builder->name, BB_REFERENCE_NAME) == 0)
        return bb_fail(BB_INVALID,
                       "builder with the bad name '%.40s': a letter, then a-z, 0-9 and '-', and "
                       "neither \"all\" nor \"" BB_REFERENCE_NAME "\"",
                       builder->name == NULL ? "" : builder->name);
    const uint32_t inputs = BB_INPUT_BOXES | BB_INPUT_GEOMETRY | BB_INPUT_TREE | BB_INPUT_PROFILE;
    const struct {
        bool good;
        const char *problem;
    } rules[] = {
        {is_line(builder->summary), "summary is missing or has more than one line"},
        {is_line(builder->paper), "paper is missing (\"none\" for none)"},
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
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (!rules[i].good)
            return bb_fail(BB_INVALID, "builder %s: %s", builder->name, rules[i].problem);
    BB_TRY(validate_options(builder->name, builder->options));
    return validate_compared(builder);
}

/* ---- shared objects ---- */

/* Whether the file holds all that its program headers ask to be mapped: the loader maps past the
 * end of a truncated file, and the process dies at the first access. */
static bool is_whole_elf(FILE *file, uint64_t size)
{
    ElfW(Ehdr) header;
    if (fread(&header, sizeof header, 1, file) != 1 || memcmp(header.e_ident, ELFMAG, SELFMAG) != 0)
        return false;
    if (header.e_type != ET_DYN || header.e_phentsize != sizeof(ElfW(Phdr)) ||
        fseek(file, (long)header.e_phoff, SEEK_SET) != 0)
        return false;
    for (uint32_t i = 0; i < header.e_phnum; i++) {
        ElfW(Phdr) program;
        if (fread(&program, sizeof program, 1, file) != 1)
            return false;
        if (program.p_type == PT_LOAD &&
            (program.p_offset > size || program.p_filesz > size - program.p_offset))
            return false;
    }
    return header.e_phnum > 0;
}

static bb_status check_file(const char *path)
{
    struct stat info;
    FILE *file = stat(path, &info) == 0 && S_ISREG(info.st_mode) ? fopen(path, "rb") : NULL;
    if (file == NULL)
        return bb_fail(BB_INVALID, "plug-in %s: %s", path,
                       errno != 0 ? strerror(errno) : "is no file");
    bool whole = is_whole_elf(file, (uint64_t)info.st_size);
    fclose(file);
    if (!whole)
        return bb_fail(BB_INVALID,
                       "plug-in %s: is not a shared object of this machine, or is truncated", path);
    return BB_OK;
}

static bb_status take(const char *path, void *object)
{
    const bb_builder *const *symbol = (const bb_builder *const *)dlsym(object, "bb_plugin");
    if (symbol == NULL || *symbol == NULL)
        return bb_fail(BB_INVALID,
                       "plug-in %s: exports no bb_plugin: build it with bvhbench_add_builder()",
                       path);
    const bb_builder *builder = *symbol;
    /* The version comes first in the struct, whatever follows: nothing else is read before it
     * agrees. */
    bb_status status = bb_builder_validate(builder);
    if (status != BB_OK)
        return bb_fail(status, "plug-in %s: %s", path, bb_message());
    if (bb_builder_find(builder->name) != NULL)
        return bb_fail(BB_INVALID, "plug-in %s: there is a builder %s already", path,
                       builder->name);
    if (loaded_count == LOADED_MAX)
        return bb_fail(BB_INVALID, "plug-in %s: more than %d plug-ins", path, LOADED_MAX);
    loaded[loaded_count++] = builder;
    return BB_OK;
}

bb_status bb_plugin_load(const char *path)
{
    errno = 0;
    BB_TRY(check_file(path));
    /* Without a slash dlopen() would search the library path. */
    char here[4096];
    int length = snprintf(here, sizeof here, "%s%s", strchr(path, '/') != NULL ? "" : "./", path);
    if (length < 0 || (size_t)length >= sizeof here)
        return bb_fail(BB_INVALID, "plug-in %.60s...: the path is too long", path);
    void *object = dlopen(here, RTLD_NOW | RTLD_LOCAL);
    if (object == NULL)
        return bb_fail(BB_INVALID, "plug-in %s: cannot be loaded: %s", path, dlerror());
    bb_status status = take(path, object);
    if (status != BB_OK)
        dlclose(object);
    return status; /* a loaded builder stays for the life of the process */
}

/* ---- inputs ---- */

void bb_input_words(uint32_t inputs, char *text, size_t capacity)
{
    static const struct {
        uint32_t input;
        const char *word;
    } words[] = {
        {BB_INPUT_BOXES, "boxes"}, {BB_INPUT_GEOMETRY, "geometry"}, {BB_INPUT_PROFILE, "profile"}};
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < sizeof words / sizeof words[0] && used < capacity; i++)
        if ((inputs & words[i].input) != 0)
            used += (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? " " : "",
                                     words[i].word);
}

/* ---- phases ---- */

bb_status bb_phase(bb_phases *phases, const char *name)
{
    if (phases->device != NULL) {
        phases->used_device = true;
        if (phases->exact)
            BB_TRY(bb_finish(phases->device));
    }
    double now = bb_wall_ms();
    if (phases->current >= 0) {
        phases->ms[phases->current] += now - phases->started;
        if (phases->outside)
            phases->outside_ms += now - phases->started;
    }
    phases->current = -1;
    phases->outside = false;
    if (name == NULL)
        return BB_OK;
    uint32_t index = 0;
    while (index < phases->count && strcmp(phases->names[index], name) != 0)
        index++;
    if (index == BB_PHASES_MAX)
        return bb_fail(BB_FAILED, "phase '%s': a build has at most %d phases", name, BB_PHASES_MAX);
    if (index == phases->count) {
        phases->names[phases->count++] = name;
        phases->ms[index] = 0.0;
    }
    phases->current = (int32_t)index;
    phases->started = now;
    return BB_OK;
}

bb_status bb_phase_outside(bb_phases *phases, const char *name)
{
    if (phases->device != NULL)
        return bb_fail(BB_FAILED,
                       "phase '%s': a builder on the device has no phases outside its time", name);
    BB_TRY(bb_phase(phases, name));
    phases->outside = true;
    return BB_OK;
}
