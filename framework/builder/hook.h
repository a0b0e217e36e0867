/* A call of a builder's hook: what is noted before it and looked at after it, so that no hook
 * changes what all builders share. */
#ifndef BB_HOOK_H
#define BB_HOOK_H

#include "framework/base/memory.h"
#include "framework/builder/guard.h"
#include "framework/builder/idle.h"
#include "framework/builder/terms.h"
#include "framework/scene/scene.h"

typedef struct bb_hook {
    bb_guarded whose;
    const char *who, *name;
    const char *owner; /* the threads that begin in it belong to this row; whose row, at first */
    const bb_scene *scene;
    bool on_host; /* it gets no buffers; false at first */
    bb_footprint *footprint;
    bb_terms terms;
    bb_idle idle;
    int64_t resident; /* bytes of the process */
} bb_hook;

/* The hook `name` of `who` is about to be called, for the row `whose`. `scene` is whole, not as
 * the hook sees it; NULL: it gets none. `footprint` is added to. To be ended by one of the
 * following. */
void bb_hook_begin(bb_hook *hook, bb_guarded whose, const char *who, const char *name,
                   const bb_scene *scene, bb_footprint *footprint);

/* The hook has returned `status`, and the queue is finished. Puts back what it changed of the
 * process and of the scene. Returns `status`, or BB_FAILED, "WHO changed the rounding mode in
 * HOOK()". */
bb_status bb_hook_end(bb_hook *hook, bb_status status);

/* The same for a hook that cannot fail: says nothing, and bb_message() is what it was before. */
void bb_hook_put_back(bb_hook *hook);

#endif
