/* Another input of the same kind in the same memory: a scene as no builder has seen it. */
#ifndef BB_DISGUISE_H
#define BB_DISGUISE_H

#include "framework/base/random.h"
#include "framework/scene/scene.h"

/* Copies of what the scene really is, and what it looks like. Zeroed: it is not disguised. */
typedef struct bb_disguise {
    float *vertices;
    void *data[BB_KIND_COUNT];
    uint64_t hash;
    uint32_t mirrored; /* axes, as bits */
    uint32_t shift[BB_KIND_COUNT];
    uint32_t first; /* drawn once: no two of the first seven disguises mirror the same axes */
    uint32_t count; /* disguises so far */
    bool worn;
} bb_disguise;

/* Mirrors the scene in its box, along axes where floats can hold it, and renumbers the primitives
 * of each kind: primitive 0 becomes one drawn at random, the others follow. A scene that says which
 * primitives belong together keeps its numbers. Box, sizes and duplicates stay as they are, but for
 * rounding; profile and views stay. The device's copy follows. The first call copies the geometry;
 * later calls make another disguise of it. BB_UNSUPPORTED if the scene looks like itself, or has a
 * volume or tetrahedra, whose side arrays are numbered like the primitives. Whatever it returns,
 * bb_disguise_take_off() comes before any other use. */
bb_status bb_disguise_put_on(bb_disguise *disguise, bb_random *random, bb_scene *scene);

/* Gives the scene its own primitives back, bit for bit. */
bb_status bb_disguise_take_off(bb_disguise *disguise, bb_scene *scene);

/* Frees the copies. */
void bb_disguise_end(bb_disguise *disguise);

#endif
