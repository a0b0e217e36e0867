/* Frames of a moving scene: the same primitives at other positions. */
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"

/* ---- how a scene moves ---- */

bb_status bb_scene_take_motion(bb_scene *scene, uint32_t frame_count, bb_scene_pose pose,
                               void (*release)(void *data), void *data)
{
    bb_status status =
        bb_host_alloc(NULL, sizeof *scene->motion, "how the scene moves", &scene->motion);
    if (status != BB_OK) {
        release(data);
        return status;
    }
    *scene->motion = (bb_scene_motion){pose, release, data};
    scene->frame_count = frame_count;
    return BB_OK;
}

void bb_scene_free_motion(bb_scene *scene)
{
    if (scene->motion != NULL)
        scene->motion->release(scene->motion->data);
    bb_host_free(scene->motion);
}

/* The generator of a scene, and its specification. */
typedef struct generated {
    const bb_generator *generator;
    bb_spec spec; /* contains its strings, so it must not move in memory */
} generated;

static bb_status pose_generated(void *data, bb_scene *scene, uint32_t frame)
{
    const generated *g = data;
    return g->generator->set_frame(&g->spec, g->generator->options, scene, frame);
}

bb_status bb_scene_remember_motion(const bb_generator *generator, const char *text, bb_scene *scene)
{
    generated *g = NULL;
    if (scene->frame_count <= 1)
        return BB_OK;
    if (generator->set_frame == NULL)
        return bb_fail(BB_FAILED, "scene %s claims %u frames, and has no set_frame()",
                       generator->name, scene->frame_count);
    BB_TRY(bb_host_alloc(NULL, sizeof *g, "how the scene moves", &g));
    g->generator = generator;
    bb_status status = bb_spec_parse(text, &g->spec);
    if (status == BB_OK)
        return bb_scene_take_motion(scene, scene->frame_count, pose_generated, bb_host_free, g);
    bb_host_free(g);
    return status;
}

/* ---- frames ---- */

static bb_status check_frame(const bb_scene *scene, uint32_t frame)
{
    if (frame < scene->frame_count)
        return BB_OK;
    if (scene->frame_count == 1)
        return bb_fail(BB_INVALID, "%s: has no frame %u: it does not move, frame 0 is all there is",
                       scene->name, frame);
    return bb_fail(BB_INVALID, "%s: has no frame %u: they are 0 to %u", scene->name, frame,
                   scene->frame_count - 1);
}

/* Takes the counts that the current frame has. */
static bb_status take_counts(bb_scene *scene)
{
    bool fits = scene->vertex_count <= scene->vertex_room;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        fits = fits && scene->prims[kind].count <= scene->prims[kind].room;
    if (!fits)
        return bb_fail(BB_FAILED, "%s: this frame has more primitives than were reserved",
                       scene->name);
    bb_scene_number_kinds(scene);
    return BB_OK;
}

bb_status bb_scene_set_frame(bb_scene *scene, uint32_t frame, uint32_t *changed)
{
    uint32_t unused;
    changed = changed != NULL ? changed : &unused;
    *changed = 0;
    BB_TRY(check_frame(scene, frame));
    if (frame == scene->frame)
        return BB_OK;
    uint64_t before = scene->hash;
    uint32_t prims = scene->prim_count, vertices = scene->vertex_count;
    bool known = scene->frame != BB_NONE;
    scene->frame = BB_NONE;
    BB_TRY(scene->motion->pose(scene->motion->data, scene, frame));
    BB_TRY(take_counts(scene));
    BB_TRY(bb_scene_finish_frame(scene));
    if (!known || scene->hash != before) {
        BB_TRY(bb_scene_upload_again(scene));
        *changed = BB_CHANGED_POSITIONS;
        /* after a failure the counts of the last valid frame are unknown */
        if (!known || scene->prim_count != prims || scene->vertex_count != vertices)
            *changed |= BB_CHANGED_TOPOLOGY;
    }
    scene->frame = frame;
    return BB_OK;
}
