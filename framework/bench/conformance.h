/* Checks a builder on a scene, for `bvhbench check` and the tests. */
#ifndef BB_CONFORMANCE_H
#define BB_CONFORMANCE_H

#include "framework/builder/instance.h"
#include "framework/judge/judge.h"

typedef struct bb_conformance bb_conformance;

/* Uploads the scene, and makes the oracle and small ray sets of side x side rays with their
 * answers: primary, ambient occlusion, random, at edges and close to edges. Fails if no ray set can
 * be made. */
bb_status bb_conformance_create(bb_device *device, bb_scene *scene, uint32_t side, uint64_t seed,
                                bb_conformance **out);
void bb_conformance_destroy(bb_conformance *conformance); /* NULL is allowed */

/* Returns which ray sets cannot be made on this scene, and why: "primary (...), ..."; "" if all
 * were made. */
const char *bb_conformance_left_out(const bb_conformance *conformance);

/* Traces as many rays as there is time for without a tree, by the first kernel, and judges the
 * answers (BB_FAILED if one is wrong). All later answers must equal these: call it first. */
bb_status bb_conformance_brute_force(bb_conformance *conformance);

/* Findings on a builder that keeps its promises. */
typedef struct bb_conformed {
    char note[512];     /* a line of figures, and which kernels refuse */
    uint64_t hash;      /* hash of its tree */
    bool deterministic; /* the builder declares that equal input gives equal trees, and it did */
    double build_ms;    /* time of the second build by the same object */
} bb_conformed;

/* Checks what all builders promise:
 *
 *   - its tree is valid (bb_tree_check), and the same, bit for bit, built twice by one object and
 *     once by another; unless the builder says that it is not deterministic: then the note says so;
 *   - the same object, given the same primitives in another order, builds a valid tree of those;
 *   - every kernel that takes the tree answers rightly with the `exact` intersector, and as brute
 *     force and all other kernels and trees do, bit for bit.
 *
 * BB_FAILED names the first violation, or says that no kernel takes the tree. BB_UNSUPPORTED: the
 * builder does not take the scene. Trees on which rays cost much are traced with fewer rays. */
bb_status bb_conformance_check(bb_conformance *conformance, const char *builder,
                               bb_conformed *found);

#endif
