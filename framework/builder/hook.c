#include "framework/builder/hook.h"

#include "framework/scene/seal.h"

#include <stdio.h>

void bb_hook_begin(bb_hook *hook, bb_guarded whose, const char *who, const char *name,
                   const bb_scene *scene, bb_footprint *footprint)
{
    hook->whose = whose;
    hook->who = who;
    hook->name = name;
    hook->owner = whose.row;
    hook->on_host = false;
    hook->scene = scene;
    hook->footprint = footprint;
    bb_guard_enter(whose, who, name);
    bb_idle_take(&hook->idle);
    bb_terms_take(&hook->terms);
    bb_host_mark_peak();
    hook->resident = (int64_t)bb_host_resident();
}

static void count_resident(const bb_hook *hook)
{
    bb_footprint *footprint = hook->footprint;
    const int64_t peak = (int64_t)bb_host_peak_since_mark() - hook->resident;
    if (footprint->now + peak > footprint->peak)
        footprint->peak = footprint->now + peak;
    footprint->now += (int64_t)bb_host_resident() - hook->resident;
}

static bb_status check_idle(const bb_hook *hook)
{
    const char *left = bb_idle_left(&hook->idle, hook->owner);
    if (left == NULL)
        return BB_OK;
    return bb_fail(BB_FAILED, "%s left %s behind in %s(): all work ends before a hook returns",
                   hook->who, left, hook->name);
}

static bb_status check_scene(const bb_hook *hook)
{
    const char *changed = NULL;
    if (hook->scene == NULL)
        return BB_OK;
    const bb_status status = hook->on_host ? bb_scene_check_seal_on_host(hook->scene, &changed)
                                           : bb_scene_check_seal(hook->scene, &changed);
    if (changed == NULL)
        return status;
    const bool lost = status != BB_OK;
    return bb_fail(BB_FAILED,
                   "%s wrote into the scene's %s in %s(): all builders read them%s%.300s",
                   hook->who, changed, hook->name, lost ? "; " : "", lost ? bb_message() : "");
}

/* Returns `status`, unless `more` is a failure: then both are one. `message` is that of `status`.
 */
static bb_status add_failure(bb_status status, const char *message, bb_status more)
{
    if (more == BB_OK)
        return status;
    return status == BB_OK ? BB_FAILED
                           : bb_fail(BB_FAILED, "%.400s; and %.400s", message, bb_message());
}

bb_status bb_hook_end(bb_hook *hook, bb_status status)
{
    bb_status (*const checks[])(const bb_hook *) = {check_idle, check_scene};
    count_resident(hook);
    status = bb_terms_check(&hook->terms, hook->who, hook->name, status);
    for (size_t i = 0; i < sizeof checks / sizeof checks[0]; i++) {
        char message[BB_MESSAGE_MAX];
        snprintf(message, sizeof message, "%s", bb_message());
        status = add_failure(status, message, checks[i](hook));
    }
    return status;
}

void bb_hook_put_back(bb_hook *hook)
{
    bb_terms_put_back(&hook->terms);
}
