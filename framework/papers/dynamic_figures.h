/* What the tables and the claims of `dynamic` share: its scenes and methods, what was measured of
 * them, and the ratios that the paper has. */
#ifndef BB_DYNAMIC_FIGURES_H
#define BB_DYNAMIC_FIGURES_H

#include "framework/animate/animate.h"
#include "framework/papers/reproduce.h"

/* The paper's methods, as it describes them; then what they are compared with today. */
typedef enum bb_dynamic_method {
    BB_DYNAMIC_REBUILT,          /* Goldsmith and Salmon in each frame, in the file's order */
    BB_DYNAMIC_REBUILT_SHUFFLED, /* the same, shuffled in each frame */
    BB_DYNAMIC_UPDATED,          /* Dynamic Goldsmith and Salmon */
    BB_DYNAMIC_UPDATED_SHUFFLED, /* the same, from a shuffled first tree, as in the paper */
    BB_DYNAMIC_LOOSE,            /* Loose BVH, depth 18, in the scene's box */
    BB_DYNAMIC_LOOSE_CUBE,       /* the same in a cube */
    BB_DYNAMIC_LOOSE_NOW,        /* as the builder is by default */
    BB_DYNAMIC_LBVH,
    BB_DYNAMIC_METHODS,
    BB_DYNAMIC_REFIT = BB_DYNAMIC_METHODS /* an LBVH that keeps its links, in pictures of its own */
} bb_dynamic_method;

typedef enum bb_dynamic_scene {
    BB_DYNAMIC_KITCHEN,
    BB_DYNAMIC_MUSEUM, /* particles in a flow: motion without structure, in a random order */
    BB_DYNAMIC_TWIST,  /* the same again, as a bar that is twisted, whose file is in order */
    BB_DYNAMIC_FALL,
    BB_DYNAMIC_SCENES
} bb_dynamic_scene;

/* Ratios of the paper's table 1, of which more than 1 is faster than its rebuild. */
typedef struct bb_dynamic_factors {
    double update, trace, total;
} bb_dynamic_factors;

typedef struct bb_dynamic_about {
    const char *name;  /* of the paper's scene */
    const char *scene; /* what is in its place; NULL: things that drive in a room */
    uint32_t prims, width, height;
    bb_dynamic_factors updated, loose; /* Dynamic Goldsmith and Salmon; Loose BVH */
} bb_dynamic_about;

extern const bb_dynamic_about bb_dynamic_scenes[BB_DYNAMIC_SCENES];

/* Refitted trees may take a hundred times as long to trace: they are compared with LBVHs rebuilt in
 * pictures of an eighth of the side, and as many fewer of the other rays. */
enum { BB_DYNAMIC_SMALL_REBUILT, BB_DYNAMIC_SMALL_REFITTED, BB_DYNAMIC_SMALL_METHODS };

typedef struct bb_dynamic {
    bb_animate_result scenes[BB_DYNAMIC_SCENES], small[BB_DYNAMIC_SCENES];
    uint32_t width[BB_DYNAMIC_SCENES], height[BB_DYNAMIC_SCENES]; /* of the pictures here */
} bb_dynamic;

/* How many times as fast `method` is as `base` over the sequence, paired by rounds; that of a refit
 * is to LBVHs rebuilt, whatever `base`. */
bb_estimate bb_dynamic_ratio(const bb_dynamic *d, bb_dynamic_scene scene, uint32_t parts,
                             bb_dynamic_method method, bb_dynamic_method base);

/* Mean of an event per frame, of those after the first; 0 if the builder counts no such. */
double bb_dynamic_events(const bb_dynamic *d, bb_dynamic_scene scene, bb_dynamic_method method,
                         const char *event);

void bb_dynamic_claims(const bb_dynamic *d, bb_reproduction *r);

#endif
