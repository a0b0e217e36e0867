/* The named intersectors, and their options as -D for kernels/intersect.clh. */
#include "traversal/traversal.h"

#include "framework/base/suggest.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

const bb_intersector bb_intersectors[] = {
    {"exact",
     "Woop-Benthin-Wald watertight test with exact edge signs, padded slabs, no contraction",
     "exact", "padded", "no"},
    {"watertight",
     "Woop-Benthin-Wald watertight test in plain floats, padded slabs, no contraction",
     "watertight", "padded", "no"},
    {"pluecker", "Pluecker coordinates, padded slabs, no contraction", "pluecker", "padded", "no"},
    {"moeller", "Moeller-Trumbore test, padded slabs, no contraction", "moeller", "padded", "no"},
    {"woop", "Woop's affine test on precomputed maps, padded slabs, no contraction", "woop",
     "padded", "no"},
    {"fast", "Moeller-Trumbore test, sign-ordered slabs, contraction", "moeller", "sign", "yes"},
    {"careless", "Moeller-Trumbore test, naive slabs, contraction: a first attempt", "moeller",
     "naive", "yes"},
    {.name = NULL},
};

/* Named like BB_TRIANGLE_..., BB_SLAB_... */
const bb_option bb_intersector_options[] = {
    {"triangle", NULL, "exact|watertight|pluecker|moeller|woop",
     "triangle test: see kernels/triangle_*.clh"},
    {"slab", NULL, "padded|sign|naive", "box test: see kernels/slab.clh"},
    {"contract", NULL, "no|yes", "whether the compiler may fuse a * b + c"},
    {.name = NULL},
};

const bb_intersector *bb_intersector_find(const char *name)
{
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        if (strcmp(i->name, name) == 0)
            return i;
    return NULL;
}

/* Overrides `value` by the specification's `key`, if it has one; the specification has been
 * validated. */
static void change(const bb_spec *spec, const char *key, char *value, size_t capacity)
{
    const char *given = bb_spec_value(spec, NULL, key);
    if (given != NULL)
        snprintf(value, capacity, "%s", given);
}

bb_status bb_intersector_parse(const char *text, bb_intersector *intersector)
{
    bb_spec spec;
    char what[96];
    BB_TRY(bb_spec_parse(text, &spec));
    const bb_intersector *point = bb_intersector_find(spec.name);
    if (point == NULL) {
        bb_suggestion meant = {.word = spec.name};
        for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
            bb_suggest(&meant, i->name);
        return bb_fail(BB_INVALID,
                       "unknown intersector '%s'%s: `bvhbench list intersectors` shows them",
                       spec.name, bb_suggested(&meant));
    }
    snprintf(what, sizeof what, "intersector %s", point->name);
    BB_TRY(bb_spec_validate(&spec, bb_intersector_options, what));
    *intersector = *point;
    change(&spec, "triangle", intersector->triangle, sizeof intersector->triangle);
    change(&spec, "slab", intersector->slab, sizeof intersector->slab);
    change(&spec, "contract", intersector->contract, sizeof intersector->contract);
    return BB_OK;
}

bb_u32 bb_intersector_format(const bb_intersector *intersector)
{
    return strcmp(intersector->triangle, "woop") == 0 ? BB_FORMAT_AFFINE : BB_FORMAT_VERTICES;
}

bool bb_intersector_is_exact(const bb_intersector *intersector)
{
    return strcmp(intersector->triangle, "exact") == 0 &&
           strcmp(intersector->slab, "padded") == 0 && strcmp(intersector->contract, "no") == 0;
}

void bb_intersector_defines(const bb_intersector *intersector, char *text, size_t capacity)
{
    snprintf(text, capacity, "-DBB_TRIANGLE_TEST=BB_TRIANGLE_%s -DBB_SLAB_TEST=BB_SLAB_%s%s",
             intersector->triangle, intersector->slab,
             strcmp(intersector->contract, "yes") == 0 ? " -DBB_CONTRACT" : "");
    bool value = false; /* the macros are in capitals */
    for (char *c = text; *c != '\0'; c++) {
        value = *c == ' ' ? false : value || *c == '=';
        *c = value ? (char)toupper((unsigned char)*c) : *c;
    }
}
