/* What the parts of conformance share: conformance.c, conformance_frames.c. */
#ifndef BB_CONFORMANCE_PRIVATE_H
#define BB_CONFORMANCE_PRIVATE_H

#include "framework/bench/conformance.h"

/* Kinds of rays; frames beside frame 0 that a tree is brought to. */
enum { BB_CONFORMANCE_SETS = 6, BB_FRAMES_MAX = 3 };

/* A ray set, the oracle's answers, and the first full answer by a kernel, which all others must
 * equal. */
typedef struct bb_ray_set {
    bb_rays *rays;
    bb_answers answers;
    char *results; /* of the first `count` rays */
    uint32_t count;
    uint32_t affordable; /* rays on the tree at hand */
    char whose[128];
} bb_ray_set;

struct bb_conformance {
    bb_device *device;
    bb_scene *scene;
    bb_scene *reversed; /* the same primitives, the last first; NULL of another frame */
    bb_oracle *oracle;
    uint64_t seed;
    uint32_t side; /* of the pictures: a set has its square of rays */
    uint32_t set_count;
    bb_ray_set sets[BB_CONFORMANCE_SETS];
    char left_out[1024];
    bb_account account;
    bb_buffer d_results;
    char *results;                         /* of the last trace */
    bb_conformance *frames[BB_FRAMES_MAX]; /* of other frames of the scene; NULL: none */
};

/* Makes the oracle, the ray sets and their answers, of the scene as it is now. */
bb_status bb_conformance_prepare_rays(bb_conformance *c);

/* As many rays of each set as there is time for on this tree, which is then on the device. */
bb_status bb_conformance_choose_counts(bb_conformance *c, bb_tree *tree);

/* The answers of `most` kernels that take the tree, the first in the table's order; those before
 * them that refuse it are named in `refusing`, which may be NULL. `builder` is whose tree it is.
 * BB_FAILED with the first wrong answer, or if no kernel takes it. */
bb_status bb_conformance_check_kernels(bb_conformance *c, bb_tree *tree, const char *builder,
                                       uint32_t most, char *refusing, size_t capacity);

/* What is right in the frames that trees are brought to: rays and answers of each. The scene is at
 * frame 0, and is there again afterwards. A failure names the frame. */
bb_status bb_conformance_prepare_frames(bb_conformance *c);

/* Brings an instance that was built at frame 0 to other frames and back: each of its trees is
 * valid, and traced rightly. The scene is at frame 0 again afterwards, whatever happens. `note`
 * gets how many frames and how, such as "; 4 frames: updated"; "" for a scene that stays still. */
bb_status bb_conformance_check_frames(bb_conformance *c, bb_instance *instance, char *note,
                                      size_t capacity);

#endif
