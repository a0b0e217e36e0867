/* Conformance of a builder on a scene, for `bvhbench check` and the tests. */
#ifndef BB_CONFORMANCE_H
#define BB_CONFORMANCE_H

#include "framework/instance.h"
#include "framework/judge.h"

typedef struct bb_conformance bb_conformance;

/* Uploads the scene, makes the oracle and two small ray sets (primary or random, and ao or random) with their answers. */
bb_status bb_conformance_create(bb_device *device, bb_scene *scene, uint64_t seed,
                                bb_conformance **out);
void bb_conformance_destroy(bb_conformance *conformance); /* NULL is allowed */

/* Builds twice with one object and once with another; checks each tree (bb_tree_check), that all have the same hash (unless the
 * builder says that it is not deterministic: then `note` says so), and that every kernel's answers with the `exact` intersector are right.
 * BB_FAILED with the first violation; BB_UNSUPPORTED where the builder does not take the scene. `note` gets a line of figures. */
bb_status bb_conformance_check(bb_conformance *conformance, const char *builder, char *note,
                               size_t capacity);

#endif
