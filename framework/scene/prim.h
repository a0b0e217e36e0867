/* Kinds of primitives. All that the harness has to know of a kind is one constant struct,
 * bb_prim_NAME in prim_NAME.c, and beside it kernels/prim_NAME.clh; the list of kinds is
 * BB_PRIM_KINDS in kernels/bb_shared.h. In all functions `i` counts within the kind, from 0, and o
 * + t d is a line whose numbers are as framework/exact/exact.h wants them.
 */
#ifndef BB_PRIM_H
#define BB_PRIM_H

#include "framework/base/random.h"
#include "framework/exact/passing.h"
#include "framework/scene/scene.h"

enum { BB_OUTLINES_MAX = 6 }; /* flat parts of one primitive */

typedef struct bb_prim_kind {
    const char *name;   /* "triangle" */
    const char *plural; /* "triangles": in records and messages */
    bool is_mesh;       /* the data are indices of vertices; else they are floats */

    /* The tight box, rounded outwards; its pads are the caller's. BB_INVALID for numbers that are
     * none of a primitive, or no box of floats holds. */
    bb_status (*bounds)(const bb_scene *scene, uint32_t i, bb_box *box);
    /* The least magnitude, in scene units squared, on which the sign of the device's test hangs:
     * see bb_scene_choose_scale(). 0: none, or nothing can be hit. */
    double (*product)(const bb_scene *scene, uint32_t i);
    /* Whether its area is exactly 0. */
    bool (*is_flat)(const bb_scene *scene, uint32_t i);
    double (*area)(const bb_scene *scene, uint32_t i);
    /* A point, uniform on the surface, and the unit normal there (0 where there is none). */
    void (*sample)(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double normal[3]);
    /* The normal at a point on the surface, of any length; 0 if there is none. */
    void (*normal)(const bb_scene *scene, uint32_t i, const double point[3], double normal[3]);
    /* Whether part of the surface is in the box lo..hi, which is shrunk towards that part's. */
    bool (*shrink)(const bb_scene *scene, uint32_t i, double lo[3], double hi[3]);
    /* max |v - o| over the coordinates of its vertices, as in the margin (arbiter.h). */
    double (*reach)(const bb_scene *scene, uint32_t i, const double o[3]);
    /* Its smallest height; 0 if it has no area. */
    float (*height)(const bb_scene *scene, uint32_t i);
    /* t at which the line meets it, in order, to 2^-32: 0, 1 or 2 of them. Closed: edges belong to
     * it. */
    int (*hits)(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                double t[2]);
    /* The same of the surface that it is a part of: a triangle's plane. */
    int (*extended)(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                    double t[2]);
    /* Where a line that may pass it by at up to `eps` is near it, in order: 1 on its plane, to be
     * kept within the extent that pass() says; 2 where it enters and leaves what is within eps; 0:
     * at that extent. */
    int (*nearby)(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2]);
    /* How far the line passes it, and its flat parts as the line sees them (how many; none of a
     * curved one). */
    bb_passing (*pass)(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to);
    uint32_t (*outlines)(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline outlines[BB_OUTLINES_MAX]);
} bb_prim_kind;

/* All functions but extended(), which may be hits() itself, where the file calls each by the name
 * that it has here. */
#define BB_PRIM_FUNCTIONS                                                                          \
    .bounds = bounds, .product = product, .is_flat = is_flat, .area = area, .sample = sample,      \
    .normal = normal, .shrink = shrink, .reach = reach, .height = height, .hits = hits,            \
    .nearby = nearby, .pass = pass, .outlines = outlines

/* By their numbers, BB_TRIANGLE, BB_SPHERE, ... */
extern const bb_prim_kind *const bb_prim_kinds[BB_KIND_COUNT];

/* The kind of primitive `prim` of the scene, which has it; *i: its number within the kind. */
static inline const bb_prim_kind *bb_prim_of(const bb_scene *scene, uint32_t prim, uint32_t *i)
{
    uint32_t kind = 0;
    while (prim - scene->prims[kind].first >= scene->prims[kind].count)
        kind++;
    *i = prim - scene->prims[kind].first;
    return bb_prim_kinds[kind];
}

/* Numbers the primitives through, from the counts of their kinds: sets first, prim_count and
 * kinds. */
void bb_scene_number_kinds(bb_scene *scene);

/* Bytes of the data of one. */
size_t bb_prim_bytes(uint32_t kind);

/* Names of the kinds of the bits `kinds`, in the plural: "triangles+spheres". */
void bb_prim_kind_names(uint32_t kinds, char *text, size_t capacity);

#endif
