/* Checks builders on moving scenes. The tree of frame 0 is brought to other frames and back, and
 * checked there: each frame has an oracle, rays and answers of its own. */
#include "framework/bench/conformance_private.h"

#include <stdio.h>
#include <stdlib.h>

/* Kernels that are checked in a frame. The tree has the shape of frame 0 or of an ordinary build,
 * which all kernels are checked on. */
enum { KERNELS = 2 };

/* Chooses frames that are spread evenly and include the last; fewer if the scene has fewer. */
static uint32_t choose_frames(const bb_scene *scene, uint32_t frames[BB_FRAMES_MAX])
{
    uint32_t count = 0, last = scene->frame_count - 1;
    for (uint64_t i = 1; i <= BB_FRAMES_MAX; i++) {
        uint32_t frame = (uint32_t)(i * last / BB_FRAMES_MAX);
        if (frame > 0 && (count == 0 || frames[count - 1] != frame))
            frames[count++] = frame;
    }
    return count;
}

/* Makes rays and answers for the scene's current frame, first the answers without a tree. */
static bb_status make_judge(bb_conformance *c, bb_conformance **out)
{
    bb_conformance *judge = calloc(1, sizeof *judge);
    if (judge == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    judge->device = c->device;
    judge->scene = c->scene;
    judge->seed = c->seed;
    judge->side = c->side < 32 ? c->side : 32;
    bb_status status = bb_conformance_prepare_rays(judge);
    if (status == BB_OK)
        status = bb_conformance_brute_force(judge);
    if (status != BB_OK) {
        bb_conformance_destroy(judge);
        return status;
    }
    *out = judge;
    return BB_OK;
}

/* Updates and checks the tree. `judge` belongs to the scene's current frame. */
static bb_status check_update(bb_conformance *judge, bb_instance *instance, uint32_t changed,
                              bb_update_way *way)
{
    bb_tree *tree = &instance->tree;
    BB_TRY(bb_instance_update(instance, judge->scene, changed, false, way, NULL));
    BB_TRY(bb_tree_download(tree, NULL));
    BB_TRY(bb_tree_check(tree, judge->scene));
    BB_TRY(bb_conformance_choose_counts(judge, tree));
    return bb_conformance_check_kernels(judge, tree, instance->pipeline.text, KERNELS, NULL, 0);
}

/* Adds the frame to the message of a failure. */
static bb_status at_frame(bb_status status, uint32_t frame, bb_update_way way)
{
    char reason[512];
    if (status == BB_OK)
        return BB_OK;
    snprintf(reason, sizeof reason, "%s", bb_message());
    return bb_fail(BB_FAILED, "frame %u, %s: %s", frame, bb_update_word(way), reason);
}

bb_status bb_conformance_prepare_frames(bb_conformance *c)
{
    uint32_t frames[BB_FRAMES_MAX];
    bb_status status = BB_OK;
    if (c->scene->frame_count <= 1)
        return BB_OK;
    uint32_t count = choose_frames(c->scene, frames);
    for (uint32_t i = 0; i < count && status == BB_OK; i++) {
        char reason[512];
        status = bb_scene_set_frame(c->scene, frames[i], NULL);
        if (status == BB_OK)
            status = make_judge(c, &c->frames[i]);
        snprintf(reason, sizeof reason, "%s", status != BB_OK ? bb_message() : "");
        if (status != BB_OK)
            bb_fail(status, "%s: frame %u: %s", c->scene->name, frames[i], reason);
    }
    return status == BB_OK ? bb_scene_set_frame(c->scene, 0, NULL) : status;
}

static bb_status walk(bb_conformance *c, bb_instance *instance, const uint32_t *frames,
                      uint32_t count, bool ways[BB_REBUILT + 1])
{
    for (uint32_t i = 0; i <= count; i++) {
        bool back = i == count;
        uint32_t frame = back ? 0 : frames[i], changed;
        bb_update_way way = BB_KEPT;
        bb_conformance *judge = c;
        BB_TRY(bb_scene_set_frame(c->scene, frame, &changed));
        if (!back)
            judge = c->frames[i];
        bb_status status = check_update(judge, instance, changed, &way);
        BB_TRY(at_frame(status, frame, way));
        ways[way] = true;
    }
    return BB_OK;
}

bb_status bb_conformance_check_frames(bb_conformance *c, bb_instance *instance, char *note,
                                      size_t capacity)
{
    uint32_t frames[BB_FRAMES_MAX];
    bool ways[BB_REBUILT + 1] = {false};
    note[0] = '\0';
    if (c->scene->frame_count <= 1)
        return BB_OK;
    uint32_t count = choose_frames(c->scene, frames);
    bb_status status = walk(c, instance, frames, count, ways), back = BB_OK;
    if (c->scene->frame != 0)
        back = bb_scene_set_frame(c->scene, 0, NULL);
    BB_TRY(status);
    BB_TRY(back);
    size_t used = (size_t)snprintf(note, capacity, "; %u frames:", count + 1);
    for (int way = BB_KEPT, first = 1; way <= BB_REBUILT; way++)
        if (ways[way] && used < capacity) {
            used += (size_t)snprintf(note + used, capacity - used, "%s %s", first ? "" : ",",
                                     bb_update_word((bb_update_way)way));
            first = 0;
        }
    return BB_OK;
}
