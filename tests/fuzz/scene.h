/* What the targets of the scene formats share: a file of theirs is loaded, or refused. */
#ifndef BB_FUZZ_SCENE_H
#define BB_FUZZ_SCENE_H

#include "framework/scene/prim.h"
#include "framework/scene/scene.h"
#include "framework/scene/tets.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>

/* Views are sought with thousands of rays, which takes longer than all else: for a few files. */
static bool fuzz_derive;

void __real_bb_scene_add_derived_views(bb_scene *scene);
void __wrap_bb_scene_add_derived_views(bb_scene *scene);
void __wrap_bb_scene_add_derived_views(bb_scene *scene)
{
    if (fuzz_derive)
        __real_bb_scene_add_derived_views(scene);
}

static inline void fuzz_check_triangles(const bb_scene *scene)
{
    const bb_prims *triangles = &scene->prims[BB_TRIANGLE];
    for (uint32_t i = 0; i < 3 * triangles->count; i++)
        FUZZ_CHECK(bb_scene_indices(scene)[i] < scene->vertex_count);
    for (uint32_t i = 0; i < 3 * scene->vertex_count && scene->tets == NULL; i++)
        FUZZ_CHECK(isfinite(scene->vertices[i]));
}

static inline void fuzz_check_tets(const bb_scene *scene)
{
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++)
        for (int c = 0; c < 4; c++) {
            FUZZ_CHECK(bb_scene_tet(scene, i)[c] < scene->vertex_count);
            FUZZ_CHECK(isfinite(scene->tets->field[bb_scene_tet(scene, i)[c]]));
        }
}

/* What everything after the loader relies on. */
static inline void fuzz_check_scene(const bb_scene *scene)
{
    uint32_t kind = scene->volume != NULL ? BB_AABB
                    : scene->tets != NULL ? BB_TETRAHEDRON
                                          : BB_TRIANGLE;
    FUZZ_CHECK(scene->prim_count > 0 && scene->prim_count == scene->prims[kind].count);
    fuzz_check_triangles(scene);
    fuzz_check_tets(scene);
    for (uint32_t i = 0; i < scene->prim_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const bb_box *box = &scene->boxes[i];
            FUZZ_CHECK(box->lo[axis] <= box->hi[axis]);
            FUZZ_CHECK(box->lo[axis] >= scene->bounds.lo[axis]);
            FUZZ_CHECK(box->hi[axis] <= scene->bounds.hi[axis]);
            FUZZ_CHECK(!signbit(box->lo[axis]) || box->lo[axis] != 0);
        }
    FUZZ_CHECK(scene->scale > 0 && isfinite(scene->scale));
    FUZZ_CHECK((scene->view_count > 0 || !fuzz_derive) && scene->view_count <= BB_VIEWS_MAX);
    for (uint32_t i = 0; i < scene->view_count; i++) {
        const bb_view *view = &scene->views[i];
        FUZZ_CHECK(view->name[0] != '\0' && strlen(view->name) < sizeof view->name);
        FUZZ_CHECK(view->fov_y > 0 && isfinite(view->fov_y));
        for (int axis = 0; axis < 3; axis++)
            FUZZ_CHECK(isfinite(view->eye[axis]) && isfinite(view->target[axis]));
    }
}

/* The same file twice is the same scene, or the same refusal. */
static inline void fuzz_scene(const char *name, const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(name, data, size);
    bb_scene *scene = NULL, *again = NULL;
    fuzz_derive = size % 64 == 0;
    bb_status status = bb_scene_load(path, &scene);
    if (status != BB_OK) {
        fuzz_refused(status);
        FUZZ_CHECK(scene == NULL);
        /* or a file of the same name beside it */
        char stem[128];
        snprintf(stem, sizeof stem, "%.*s", (int)(strrchr(path, '.') - path), path);
        FUZZ_CHECK(strstr(bb_message(), stem) != NULL);
        return;
    }
    fuzz_check_scene(scene);
    FUZZ_CHECK(bb_scene_load(path, &again) == BB_OK);
    FUZZ_CHECK(again->hash == scene->hash && again->view_count == scene->view_count);
    bb_scene_free(scene);
    bb_scene_free(again);
}

#endif
