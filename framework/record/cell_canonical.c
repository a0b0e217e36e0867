/* Gives each cell one spelling: parameters in the order of their declaration, with or without those
 * that have their defaults. */
#include "framework/base/number.h"
#include "framework/builder/pipeline.h"
#include "framework/builder/tracers.h"
#include "framework/record/cell.h"
#include "framework/scene/scene.h"
#include "framework/workload/workload.h"
#include "traversal/traversal.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { OPTIONS_MAX = 3 * BB_PARAMS_MAX };

/* A text to which pieces are appended. `full`: a piece did not fit. */
typedef struct text {
    char text[BB_CELL_TEXT];
    size_t length;
    bool full;
} text;

static void append(text *t, const char *a, const char *b, const char *c, const char *d)
{
    int length = snprintf(t->text + t->length, sizeof t->text - t->length, "%s%s%s%s", a, b, c, d);
    t->full = t->full || (size_t)length >= sizeof t->text - t->length;
    t->length += t->full ? 0 : (size_t)length;
}

/* Spells whole numbers in plain digits, so that 1e6 and 1000000 are the same; a value that equals
 * the default is spelled like it. Options do not declare their types: if the default is a word, a
 * value that looks like a number may be a word too (view=007). */
static const char *respell_value(const bb_option *option, const char *value, char digits[32])
{
    uint64_t number, by_default;
    const char *fallback = option->default_value;
    double any;
    if (option->values != NULL || !bb_read_whole(value, &number) ||
        (fallback != NULL && !bb_read_real(fallback, &any)))
        return value;
    if (fallback != NULL && bb_read_whole(fallback, &by_default) && number == by_default)
        return fallback;
    snprintf(digits, 32, "%" PRIu64, number);
    return digits;
}

/* Overwrites `out` with the canonical `spec`. If a parameter is not declared, `out` stays as it is.
 */
static void respell(const bb_spec *spec, const bb_option *options, bool defaults,
                    char out[BB_CELL_TEXT])
{
    text t = {.length = 0};
    const char *separator = ":";
    if (bb_spec_validate(spec, options, "cell") != BB_OK)
        return;
    append(&t, spec->name, "", "", "");
    for (const bb_option *o = options; o != NULL && o->name != NULL; o++) {
        char digits[32];
        const char *value = bb_spec_value(spec, options, o->name);
        if (value == NULL || value[0] == '\0')
            continue;
        value = respell_value(o, value, digits);
        if (o->default_value != NULL && strcmp(value, o->default_value) == 0 && !defaults)
            continue;
        append(&t, separator, o->name, "=", value);
        separator = ",";
    }
    if (!t.full)
        strcpy(out, t.text);
}

/* Appends a stage of a pipeline. A `+` within a value is told from one between stages as in
 * bb_spec_stages(). */
static void append_stage(text *t, const char *stage)
{
    append(t, t->length > 0 ? "+" : "", "", "", "");
    for (const char *c = stage; *c != '\0'; c++) {
        const char one[2] = {*c, '\0'};
        bool bare = *c == '+' && !(c[1] >= '0' && c[1] <= '9');
        append(t, bare ? "\\" : "", one, "", "");
    }
}

static void respell_builder(char builder[BB_CELL_TEXT], bool defaults)
{
    bb_spec spec;
    bb_pipeline pipeline;
    const bb_tracer *tracer = bb_tracer_of(builder);
    if (tracer != NULL) {
        if (bb_spec_parse(builder, &spec) == BB_OK)
            respell(&spec, tracer->options, defaults, builder);
        return;
    }
    if (bb_pipeline_parse(builder, &pipeline) != BB_OK)
        return;
    text t = {.length = 0};
    for (uint32_t i = 0; i < pipeline.count; i++) {
        const bb_pipeline_stage *stage = &pipeline.stages[i];
        char one[BB_CELL_TEXT];
        snprintf(one, sizeof one, "%s", stage->spec.text);
        respell(&stage->spec, stage->builder->options, defaults, one);
        append_stage(&t, one);
    }
    if (!t.full)
        strcpy(builder, t.text);
}

static void respell_kernel(char kernel[BB_CELL_TEXT], bool defaults)
{
    bb_spec spec;
    bb_option all[OPTIONS_MAX + 1];
    uint32_t count = 0;
    const bb_kernel *found =
        bb_spec_parse(kernel, &spec) == BB_OK ? bb_kernel_find(spec.name) : NULL;
    if (found == NULL)
        return;
    const bb_option *const lists[] = {bb_kernel_common_options, found->options};
    for (size_t i = 0; i < 2; i++)
        for (const bb_option *o = lists[i]; o != NULL && o->name != NULL; o++)
            if (count < OPTIONS_MAX)
                all[count++] = *o;
    all[count] = (bb_option){.name = NULL};
    respell(&spec, all, defaults, kernel);
}

static bool same_rules(const bb_intersector *a, const bb_intersector *b)
{
    return strcmp(a->triangle, b->triangle) == 0 && strcmp(a->slab, b->slab) == 0 &&
           strcmp(a->contract, b->contract) == 0;
}

/* Replaces an intersector by the first name with its rules; if there is none, by the default with
 * the parameters that differ. */
static void respell_intersector(char intersector[BB_CELL_TEXT], bool defaults)
{
    bb_intersector rules;
    bb_spec spec;
    if (bb_intersector_parse(intersector, &rules) != BB_OK)
        return;
    const bb_intersector *named = bb_intersectors;
    while (named->name != NULL && !same_rules(named, &rules))
        named++;
    named = named->name != NULL ? named : bb_intersectors;
    char full[BB_CELL_TEXT];
    snprintf(full, sizeof full, "%s:triangle=%s,slab=%s,contract=%s", named->name, rules.triangle,
             rules.slab, rules.contract);
    const char *const own[] = {named->triangle, named->slab, named->contract};
    bb_option options[4] = {{.name = NULL}};
    for (size_t i = 0; i < 3 && bb_intersector_options[i].name != NULL; i++) {
        options[i] = bb_intersector_options[i];
        options[i].default_value = own[i];
    }
    if (bb_spec_parse(full, &spec) == BB_OK)
        respell(&spec, options, defaults, intersector);
}

static void respell_rays(char rays[BB_CELL_TEXT], bool defaults)
{
    bb_spec spec;
    const bb_workload *found =
        bb_spec_parse(rays, &spec) == BB_OK ? bb_workload_find(spec.name) : NULL;
    if (found != NULL)
        respell(&spec, found->options, defaults, rays);
}

/* Makes a scene canonical. A file keeps its path, even if it is called like a generator. */
static void respell_scene(char scene[BB_CELL_TEXT], bool defaults)
{
    bb_spec spec;
    if (access(scene, F_OK) == 0 || bb_spec_parse(scene, &spec) != BB_OK)
        return;
    for (size_t i = 0; bb_generators[i] != NULL; i++)
        if (strcmp(bb_generators[i]->name, spec.name) == 0)
            respell(&spec, bb_generators[i]->options, defaults, scene);
}

/* Makes canonical what does not depend on the working folder. */
static void respell_all(bb_cell_parts *cell, bool defaults)
{
    respell_builder(cell->builder, defaults);
    if (cell->kernel[0] != '\0')
        respell_kernel(cell->kernel, defaults);
    if (cell->intersector[0] != '\0')
        respell_intersector(cell->intersector, defaults);
    if (cell->rays[0] != '\0')
        respell_rays(cell->rays, defaults);
}

void bb_cell_canonical(bb_cell_parts *cell)
{
    respell_scene(cell->scene, true);
    respell_all(cell, true);
}

void bb_cell_short(bb_cell_parts *cell)
{
    respell_scene(cell->scene, false);
    respell_all(cell, false);
}

static void respell_key(const char *key, bool defaults, char out[BB_CELL_KEY])
{
    bb_cell_parts cell;
    static const char *const suffixes[] = {BB_KEY_OF_LAYOUT, BB_KEY_OF_CLOCK, BB_KEY_OF_RUN};
    const char *suffix = key + strlen(key);
    for (size_t i = 0; i < sizeof suffixes / sizeof suffixes[0]; i++) {
        const char *found = strstr(key, suffixes[i]);
        suffix = found != NULL && found < suffix ? found : suffix;
    }
    snprintf(out, BB_CELL_KEY, "%.*s", (int)(suffix - key), key);
    if (bb_cell_key_parse(out, &cell) == BB_OK) {
        if (!defaults)
            respell_scene(cell.scene, false);
        respell_all(&cell, defaults);
        if (bb_cell_key_format(&cell, out) == BB_OK && strlen(out) + strlen(suffix) < BB_CELL_KEY) {
            strcat(out, suffix);
            return;
        }
    }
    snprintf(out, BB_CELL_KEY, "%s", key);
}

void bb_cell_key_canonical(const char *key, char canonical[BB_CELL_KEY])
{
    respell_key(key, true, canonical);
}

void bb_cell_key_short(const char *key, char brief[BB_CELL_KEY])
{
    respell_key(key, false, brief);
}
