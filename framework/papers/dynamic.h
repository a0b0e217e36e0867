/* What the tables and the claims of `dynamic` share: its scenes and methods, and what was measured
 * of them. */
#ifndef BB_DYNAMIC_H
#define BB_DYNAMIC_H

#include "framework/papers/reproduce.h"
#include "framework/tasks/animate.h"

/* The paper's methods, as it describes them; then what they are compared with today. Refitted trees
 * may take a hundred times as long to trace: they are compared with LBVHs rebuilt in pictures of an
 * eighth of the side, and as many fewer of the other rays. */
#define REBUILT "G&S rebuilt" /* Goldsmith and Salmon in each frame, in the file's order */
#define REBUILT_SHUFFLED "G&S rebuilt, shuffled" /* in each frame */
#define UPDATED "Dynamic G&S"
#define UPDATED_SHUFFLED "Dynamic G&S, shuffled" /* the first tree, as in the paper */
/* Things that move are objects with trees of their own, where the scene says which (the kitchen):
 * found by comparing boxes, or listed by the scene. */
#define COLLECTIONS "Dynamic G&S, collections"
#define LISTED "Dynamic G&S, collections, listed"
#define LOOSE "Loose BVH"                /* depth 18, in the scene's box, in an array */
#define LOOSE_SORTED "Loose BVH, sorted" /* the same tree, by keys, on the device */
#define LOOSE_CUBE "Loose BVH, cubic root"
#define LOOSE_NOW "Loose BVH, this builder's"
#define LBVH "LBVH rebuilt"
#define SMALL_REBUILT "LBVH rebuilt, small"
#define SMALL_REFITTED "LBVH refitted, small"
enum { BB_DYNAMIC_FRAMES = 11 }; /* the paper's, where it says */
enum { BB_DYNAMIC_METHODS = 11, BB_DYNAMIC_SMALL_METHODS = 2 };

extern const bb_paper_entrant bb_dynamic_methods[]; /* note: how it builds; the small ones last */

typedef enum bb_dynamic_scene {
    BB_DYNAMIC_KITCHEN,
    BB_DYNAMIC_MUSEUM, /* particles in a flow: motion without structure, in a random order */
    BB_DYNAMIC_TWIST,  /* the same again, as a bar that is twisted, whose file is in order */
    BB_DYNAMIC_FALL,
    BB_DYNAMIC_SCENES
} bb_dynamic_scene;

typedef struct bb_dynamic_about {
    const char *name;  /* of the paper's scene */
    const char *scene; /* what is in its place; NULL: things that drive in a room */
    uint32_t prims, width, height;
} bb_dynamic_about;
extern const bb_dynamic_about bb_dynamic_scenes[BB_DYNAMIC_SCENES];

/* Adds a sequence to the paper's table, as scene and method (as builder); `first`: number of its
 * first method. */
void bb_dynamic_add(bb_table *table, bb_dynamic_scene at, const bb_animate_result *result,
                    uint32_t first, uint32_t width, uint32_t height);

extern const bb_paper_table bb_dynamic_tables[];
extern const bb_paper_claim bb_dynamic_claims[];

#endif
