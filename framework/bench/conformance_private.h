/* Shared by conformance.c and conformance_frames.c. */
#ifndef BB_CONFORMANCE_PRIVATE_H
#define BB_CONFORMANCE_PRIVATE_H

#include "framework/bench/conformance.h"

/* Kinds of rays, and most frames besides frame 0. */
enum { BB_CONFORMANCE_SETS = 6, BB_FRAMES_MAX = 3 };

/* A ray set, the oracle's answers, and the first full answer by a kernel, which all others must
 * equal. */
typedef struct bb_ray_set {
    bb_rays *rays;
    bb_answers answers;
    char *results; /* that answer, for the first `count` rays */
    uint32_t count;
    uint32_t affordable; /* rays that are traced on the current tree */
    char whose[128];
} bb_ray_set;

struct bb_conformance {
    bb_device *device;
    bb_scene *scene;
    bb_scene *reversed; /* the same primitives in reverse order; NULL for other frames */
    bb_oracle *oracle;
    uint64_t seed;
    uint32_t side; /* side of the pictures; a set has side * side rays */
    uint32_t set_count;
    bb_ray_set sets[BB_CONFORMANCE_SETS];
    char left_out[1024];
    bb_account account;
    bb_buffer d_results;
    char *results;                         /* answers of the last trace */
    bb_conformance *frames[BB_FRAMES_MAX]; /* one for each other frame of the scene; NULL: none */
};

/* Makes the oracle, the ray sets and their answers for the scene's current frame. */
bb_status bb_conformance_prepare_rays(bb_conformance *c);

/* Uploads the tree, and chooses as many rays of each set as there is time for on it. */
bb_status bb_conformance_choose_counts(bb_conformance *c, bb_tree *tree);

/* Checks the answers of the first `most` kernels that take the tree. `refusing`, which may be NULL,
 * gets the names of kernels before them that refuse it. `builder` is the tree's builder. BB_FAILED
 * names the first wrong answer, or says that no kernel takes the tree. */
bb_status bb_conformance_check_kernels(bb_conformance *c, bb_tree *tree, const char *builder,
                                       uint32_t most, char *refusing, size_t capacity);

/* Makes rays and answers for the frames that trees are updated to. The scene must be at frame 0,
 * and is there again afterwards. A failure names the frame. */
bb_status bb_conformance_prepare_frames(bb_conformance *c);

/* Brings an instance that was built at frame 0 to other frames and back, and checks each tree and
 * its answers. The scene is at frame 0 again afterwards, also after a failure. `note` gets the
 * number of frames and how they were reached, such as "; 4 frames: updated"; "" for a scene without
 * frames. */
bb_status bb_conformance_check_frames(bb_conformance *c, bb_instance *instance, char *note,
                                      size_t capacity);

#endif
