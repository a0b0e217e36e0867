/* Scenes that tests fill by hand: room for triangles and spheres, then boxes and bounds. */
#ifndef HAND_SCENE_H
#define HAND_SCENE_H

#include "framework/base/random.h"
#include "framework/scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_scene *hand_scene(uint32_t triangles, uint32_t spheres)
{
    bb_scene *scene = calloc(1, sizeof *scene);
    snprintf(scene->name, sizeof scene->name, "hand-made");
    scene->prims[BB_TRIANGLE].count = triangles;
    scene->prims[BB_SPHERE].count = spheres;
    scene->prims[BB_SPHERE].first = triangles;
    scene->prim_count = triangles + spheres;
    scene->vertex_count = 3 * triangles;
    scene->scale = 1.0f;
    scene->kinds =
        (triangles > 0 ? (uint32_t)BB_TRIANGLES : 0) | (spheres > 0 ? (uint32_t)BB_SPHERES : 0);
    bb_status status = bb_host_alloc(NULL, 9 * triangles * sizeof(float), "test", &scene->vertices);
    status |= bb_host_alloc(NULL, 3 * triangles * sizeof(uint32_t), "test",
                            &scene->prims[BB_TRIANGLE].data);
    status |=
        bb_host_alloc(NULL, 4 * spheres * sizeof(float), "test", &scene->prims[BB_SPHERE].data);
    status |= bb_host_alloc(NULL, scene->prim_count * sizeof(bb_box), "test", &scene->boxes);
    if (status != BB_OK)
        abort();
    for (uint32_t i = 0; i < 3 * triangles; i++)
        bb_scene_indices(scene)[i] = i;
    return scene;
}

static inline void hand_grow(bb_box *box, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = fminf(box->lo[k], lo[k]);
        box->hi[k] = fmaxf(box->hi[k], hi[k]);
    }
}

static inline void hand_finish(bb_scene *scene)
{
    const bb_box empty = {{INFINITY, INFINITY, INFINITY}, 0, {-INFINITY, -INFINITY, -INFINITY}, 0};
    scene->bounds = empty;
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        bb_box *box = &scene->boxes[i];
        *box = empty;
        if (i < scene->prims[BB_TRIANGLE].count) {
            for (uint32_t corner = 0; corner < 3; corner++)
                hand_grow(box, bb_scene_vertex(scene, i, corner),
                          bb_scene_vertex(scene, i, corner));
        } else {
            const float *s = bb_scene_floats(scene, BB_SPHERE) +
                             4 * (size_t)(i - scene->prims[BB_TRIANGLE].count);
            for (int k = 0; k < 3; k++) {
                box->lo[k] = nextafterf(s[k] - s[3], -INFINITY);
                box->hi[k] = nextafterf(s[k] + s[3], INFINITY);
            }
        }
        hand_grow(&scene->bounds, box->lo, box->hi);
    }
}

static inline void hand_free(bb_scene *scene)
{
    bb_host_free(scene->vertices);
    bb_host_free(bb_scene_indices(scene));
    bb_host_free(bb_scene_floats(scene, BB_SPHERE));
    bb_host_free(scene->boxes);
    free(scene);
}

/* A closed cube [-1, 1]^3 * size + offset of twelve triangles, seen from inside. */
static inline void hand_cube(bb_scene *scene, uint32_t first, float size, const float offset[3])
{
    static const uint8_t quads[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                        {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    static const uint8_t corners[6] = {0, 1, 2, 0, 2, 3};
    for (uint32_t q = 0; q < 6; q++)
        for (uint32_t c = 0; c < 6; c++) {
            uint32_t v = quads[q][corners[c]];
            for (uint32_t k = 0; k < 3; k++)
                scene->vertices[9 * first + 18 * q + 3 * c + k] =
                    offset[k] + ((v >> k & 1) != 0 ? size : -size);
        }
}

/* Random triangles and spheres in [-1, 1]^3 of sizes from 0.001 to 0.5. */
static inline void hand_random(bb_scene *scene, bb_random *random)
{
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++) {
        double centre[3], size = 0.5 * pow(0.002, bb_random_unit(random));
        for (int k = 0; k < 3; k++)
            centre[k] = bb_random_range(random, -1, 1);
        for (uint32_t c = 0; c < 9; c++)
            scene->vertices[9 * i + c] =
                (float)(centre[c % 3] + size * bb_random_range(random, -1, 1));
    }
    for (uint32_t i = 0; i < scene->prims[BB_SPHERE].count; i++) {
        for (int k = 0; k < 3; k++)
            bb_scene_floats(scene, BB_SPHERE)[4 * i + k] = (float)bb_random_range(random, -1, 1);
        bb_scene_floats(scene, BB_SPHERE)[4 * i + 3] =
            (float)(0.3 * pow(0.002, bb_random_unit(random)));
    }
}

#endif
