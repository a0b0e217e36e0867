/* Conformance of a builder on a scene, for `bvhbench check` and the tests. */
#ifndef BB_CONFORMANCE_H
#define BB_CONFORMANCE_H

#include "framework/builder/instance.h"
#include "framework/judge/judge.h"

typedef struct bb_conformance bb_conformance;

/* Uploads the scene, makes the oracle and small ray sets (primary, ambient occlusion, random, and
 * at and close to edges) of side x side rays each, with their answers. Fails if the scene has no
 * rays at all. */
bb_status bb_conformance_create(bb_device *device, bb_scene *scene, uint32_t side, uint64_t seed,
                                bb_conformance **out);
void bb_conformance_destroy(bb_conformance *conformance); /* NULL is allowed */

/* The ray sets that this scene does not have, and why: "primary (...), ..."; "" if it has all of
 * them. */
const char *bb_conformance_left_out(const bb_conformance *conformance);

/* As many answers as there is time for without any tree, by the kernel that comes first. They are
 * judged (BB_FAILED if one is wrong), and then those that every tree's answers must equal: call it
 * first. */
bb_status bb_conformance_brute_force(bb_conformance *conformance);

/* What was found of a builder that holds its promises. */
typedef struct bb_conformed {
    char note[512];     /* a line of figures, and which kernels refuse */
    uint64_t hash;      /* of its tree */
    bool deterministic; /* its builder says that it is always the same, and it was */
    double build_ms;    /* of a second build by the same object */
} bb_conformed;

/* Holds a builder to what all builders promise:
 *
 *   - its tree is valid (bb_tree_check), and the same, bit for bit, built twice by one object and
 *     once by another; unless the builder says that it is not deterministic: then the note says so;
 *   - the same object, given the same primitives in another order, builds a valid tree of those;
 *   - every kernel that takes the tree answers rightly with the `exact` intersector, and as brute
 *     force and all other kernels and trees do, bit for bit.
 *
 * BB_FAILED with the first violation, or if no kernel takes the tree; BB_UNSUPPORTED where the
 * builder does not take the scene. A tree on which rays are dear is traced by fewer. */
bb_status bb_conformance_check(bb_conformance *conformance, const char *builder,
                               bb_conformed *found);

#endif
