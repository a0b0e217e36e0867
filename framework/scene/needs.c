/* Derives a scene's needs from its profile. */
#include "framework/scene/needs.h"

#include "framework/scene/prim.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEAST_BITS = 3, MOST_OCTAVES = 24 };

bb_status bb_needs_check(const bb_scene *scene, const char *what)
{
    if (scene->profile.measured)
        return BB_OK;
    return bb_fail(BB_FAILED, "%s needs the scene's profile, which this builder does not declare",
                   what);
}

uint32_t bb_need_code_bits(const bb_scene *scene)
{
    uint32_t bits = scene->profile.bits_useful;
    return bits > LEAST_BITS ? bits : LEAST_BITS;
}

static double diagonal(const bb_box *box)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double side = (double)box->hi[k] - (double)box->lo[k];
        square += side * side;
    }
    return sqrt(square);
}

/* Returns whether sizes differ by at least an octave, the unit in which codes count them. */
static bool sizes_differ(const bb_profile *p)
{
    return p->size_high > 2 * p->size_low;
}

uint32_t bb_need_size_octaves(const bb_scene *scene)
{
    const bb_profile *p = &scene->profile;
    if (!sizes_differ(p))
        return 0;
    double whole = diagonal(&scene->bounds);
    uint32_t octaves = 0;
    while (octaves < MOST_OCTAVES && p->size_median < ldexp(whole, -(int)octaves))
        octaves++;
    return octaves;
}

/* ---- in words ---- */

static void need_code(const bb_scene *scene, bb_decisions *needs)
{
    uint32_t all = scene->profile.bits_apart;
    char apart[48];
    if (all == BB_BITS_NONE)
        snprintf(apart, sizeof apart, "64 do not tell");
    else
        snprintf(apart, sizeof apart, "%u tell", all);
    bb_decide_number(needs, BB_DECIDED_CODE_BITS, bb_need_code_bits(scene), BB_BY_SCENE,
                     "longer codes save less than 2 %% of a tree's cost; %s all centroids apart",
                     apart);
}

static void need_sizes(const bb_scene *scene, bb_decisions *needs)
{
    const bb_profile *p = &scene->profile;
    if (!sizes_differ(p))
        bb_decide_number(needs, BB_DECIDED_SIZE_BITS, 0, BB_BY_SCENE,
                         "98 %% of the sizes lie within one octave, %.3g to %.3g", p->size_low,
                         p->size_high);
    else
        bb_decide_number(needs, BB_DECIDED_SIZE_BITS, bb_need_size_octaves(scene), BB_BY_SCENE,
                         "octaves from the scene, %.3g, to its median primitive, %.3g",
                         diagonal(&scene->bounds), p->size_median);
}

static void need_kinds(const bb_scene *scene, bb_decisions *needs)
{
    char kinds[64], figure[96] = "";
    bb_prim_kind_names(scene->kinds, kinds, sizeof kinds);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        size_t used = strlen(figure);
        snprintf(figure + used, sizeof figure - used, "%s%u %s", used > 0 ? ", " : "",
                 scene->prims[kind].count, bb_prim_kinds[kind]->plural);
    }
    bb_decide_word(needs, BB_DECIDED_KINDS, kinds, BB_BY_SCENE, "%s", figure);
}

/* The index has 32 bits for every scene: framework/advise/README.md has the measurement. */
static void need_index(const bb_scene *scene, bb_decisions *needs)
{
    const bool fits = scene->prim_count <= UINT16_MAX;
    bb_decide_number(needs, "index bits", 32, BB_BY_DEFAULT,
                     fits ? "%u primitives would fit into 16: too little is saved"
                          : "%u primitives do not fit into 16",
                     scene->prim_count);
}

/* All decisions above only need the first frame. */
static void need_frames(const bb_scene *scene, bb_decisions *needs)
{
    if (scene->frame_count > 1)
        bb_decide_number(needs, "frames", 1, BB_BY_DEFAULT,
                         "the first of %u: which method follows the others best, "
                         "`bvhbench animate` finds out",
                         scene->frame_count);
}

void bb_scene_needs(const bb_scene *scene, bb_decisions *needs)
{
    needs->count = 0;
    need_code(scene, needs);
    need_sizes(scene, needs);
    need_kinds(scene, needs);
    need_index(scene, needs);
    need_frames(scene, needs);
}
