/* LBVH with any code: codes, sort, radix tree; one primitive per leaf, on the device. Or, if asked
 * for, a wide tree straight from the codes (wide_tree.h).
 *
 * Lauterbach et al. 2009 (the idea), Karras 2012 (the tree; the index breaks ties between equal
 * codes), Apetrei 2014 (linking and boxes in one bottom-up pass). Builders that differ only in
 * their code declare options and defaults, and use these hooks.
 */
#ifndef BB_LINEAR_BVH_H
#define BB_LINEAR_BVH_H

#include "builders/common/codes.h"
#include "builders/common/refit.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* An option for the builder's table. */
#define BB_LINK_OPTION                                                                             \
    {                                                                                              \
        "link", "apetrei", "apetrei|karras", "how nodes are linked; the tree is the same"          \
    }

/* Options for the builder's table; without them its trees are binary. They have no defaults, so
 * that cells keep their keys. */
#define BB_ARITY_OPTIONS                                                                           \
    {"arity", NULL, "2|8",                                                                         \
     "most children of a node; 8: made straight from the codes, for plan=native; default: 2"},     \
    {                                                                                              \
        "leaf", NULL, NULL, "with arity=8: most primitives of a leaf, 1 to 64; default: 4"         \
    }

/* Hooks of a builder whose options have BB_CODE_OPTIONS, BB_LINK_OPTION and BB_UPDATE_OPTION, and
 * possibly BB_ARITY_OPTIONS. */
bb_status bb_linear_create(const bb_builder_context *context, void **self);
bb_status bb_linear_prepare(void *self, const bb_scene *scene, bb_tree *tree);
bb_status bb_linear_build(void *self, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                          bb_phases *phases);
void bb_linear_decide(void *self, const bb_scene *scene, bb_decisions *decisions);
/* BB_UNSUPPORTED with update=rebuild; the harness then builds again. */
bb_status bb_linear_update(void *self, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                           bb_phases *phases);
bb_status bb_linear_describe(void *self, const bb_scene *scene, char *text, size_t capacity);
void bb_linear_destroy(void *self);

/* Members of such a builder's struct, besides its names and options. */
#define BB_LINEAR_BUILDER                                                                          \
    .kinds = BB_ALL_KINDS, .inputs = BB_INPUT_BOXES | BB_INPUT_PROFILE, .place = BB_ON_DEVICE,     \
    .deterministic = true, .decide = bb_linear_decide, .create = bb_linear_create,                 \
    .prepare = bb_linear_prepare, .build = bb_linear_build, .update = bb_linear_update,            \
    .describe = bb_linear_describe, .destroy = bb_linear_destroy

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
