#include "framework/scene/prim.h"

#include <stdio.h>
#include <string.h>

#define BB_DECLARE(NAME, name, words, kept) extern const bb_prim_kind bb_prim_##name;
BB_PRIM_KINDS(BB_DECLARE)

#define BB_ENTRY(NAME, name, words, kept) [BB_##NAME] = &bb_prim_##name,
const bb_prim_kind *const bb_prim_kinds[BB_KIND_COUNT] = {BB_PRIM_KINDS(BB_ENTRY)};

size_t bb_prim_bytes(uint32_t kind)
{
#define BB_WORDS(NAME, name, words, kept) [BB_##NAME] = 4 * (words),
    static const size_t bytes[BB_KIND_COUNT] = {BB_PRIM_KINDS(BB_WORDS)};
    return bytes[kind];
}

void bb_prim_kind_names(uint32_t kinds, char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = '\0';
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if ((kinds & 1u << kind) != 0 && used < capacity)
            used += (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? "+" : "",
                                     bb_prim_kinds[kind]->plural);
}

void bb_scene_number_kinds(bb_scene *scene)
{
    scene->kinds = scene->prim_count = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        bb_prims *prims = &scene->prims[kind];
        prims->first = scene->prim_count;
        scene->prim_count += prims->count;
        scene->kinds |= prims->count > 0 ? 1u << kind : 0;
    }
}
