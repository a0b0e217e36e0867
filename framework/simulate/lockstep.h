/* The reference of replays: work-groups that run a kernel's traversal in lockstep on the device
 * (framework/simulate/lockstep/lockstep.clh), without recorded steps. It shares nothing with the
 * replay but the kernel's own tests of boxes and primitives. */
#ifndef BB_LOCKSTEP_H
#define BB_LOCKSTEP_H

#include "framework/simulate/machine.h"

/* A kernel that has a reference. */
typedef struct bb_lockstep_case {
    const char *kernel;  /* a specification; NULL: the last */
    const char *source;  /* the reference */
    const char *defines; /* that say there what the specification does */
    uint32_t leaf;       /* references of its layout's leaves, at most */
    uint32_t ring;       /* entries of its short stack; 0: it has none */
} bb_lockstep_case;

extern const bb_lockstep_case bb_lockstep_cases[];

/* The names of what is issued, in the order of sums: "node", "push" ... */
extern const char *const bb_issue_names[BB_ISSUE_KINDS];

/* Makes rays for comparisons: of a camera beside the scene, then at random, some of them short, one
 * from infinity. */
void bb_lockstep_rays(const bb_scene *scene, uint64_t seed, bb_ray *rays, uint32_t count);

enum { BB_LOCKSTEP_WIDTHS = 2 }; /* groups of 32, and of 64 */

/* Runs rays[0..count) in groups of each width for the request's query, in a layout that was made
 * with the case's leaves. */
bb_status bb_lockstep_run(bb_device *device, const bb_lockstep_case *which,
                          const bb_traverser_request *request, const bb_layout_data *layout,
                          const bb_ray *rays, uint32_t count,
                          bb_issued sums[BB_LOCKSTEP_WIDTHS][BB_ISSUE_KINDS]);

/* Returns the first kind whose sums differ; BB_ISSUE_KINDS: none. */
uint32_t bb_lockstep_differs(const bb_issued *replayed, const bb_issued *reference);

#endif
