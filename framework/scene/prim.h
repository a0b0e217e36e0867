/* Kinds of primitives. Everything that the harness knows of a kind is in one constant struct,
 * bb_prim_NAME in prim_NAME.c, and in kernels/prim_NAME.clh; BB_PRIM_KINDS in kernels/bb_shared.h
 * lists the kinds. In all functions `i` counts within the kind, from 0, and o + t d is a line with
 * numbers as framework/scene/exact.h requires.
 */
#ifndef BB_PRIM_H
#define BB_PRIM_H

#include "framework/base/random.h"
#include "framework/scene/passing.h"
#include "framework/scene/scene.h"

enum { BB_OUTLINES_MAX = 6 }; /* most flat parts of one primitive */

typedef struct bb_prim_kind {
    const char *name;   /* "triangle" */
    const char *plural; /* "triangles": in records and messages */
    bool is_mesh;       /* the data are indices of vertices; otherwise floats */

    /* The tight box, rounded outwards; the caller sets its pads. BB_INVALID for numbers that form
     * no primitive, or if no box of floats contains it. */
    bb_status (*bounds)(const bb_scene *scene, uint32_t i, bb_box *box);
    /* Mirrors it along an axis, so that lo becomes hi. NULL for a mesh. */
    void (*mirror)(bb_scene *scene, uint32_t i, int axis, float lo, float hi);
    /* The least magnitude, in scene units squared, that determines the sign of the device's test:
     * see bb_scene_choose_scale(). 0: none, or nothing can be hit. */
    double (*product)(const bb_scene *scene, uint32_t i);
    /* Whether its area is exactly 0. */
    bool (*is_flat)(const bb_scene *scene, uint32_t i);
    double (*area)(const bb_scene *scene, uint32_t i);
    /* A point, uniform on the surface, and the unit normal there (0 if there is none). */
    void (*sample)(const bb_scene *scene, uint32_t i, bb_random *random, double point[3],
                   double normal[3]);
    /* The normal at a point on the surface, of any length; 0 if there is none. */
    void (*normal)(const bb_scene *scene, uint32_t i, const double point[3], double normal[3]);
    /* Returns whether part of the surface is in the box lo..hi, and shrinks the box towards that
     * part. */
    bool (*shrink)(const bb_scene *scene, uint32_t i, double lo[3], double hi[3]);
    /* max |v - o| over the coordinates of its vertices, as in the margin (arbiter.h). */
    double (*reach)(const bb_scene *scene, uint32_t i, const double o[3]);
    /* Its smallest height; 0 if it has no area. */
    float (*height)(const bb_scene *scene, uint32_t i);
    /* The t at which the line meets it, in order, to 2^-32; returns their number, 0 to 2. Closed:
     * edges belong to the primitive. */
    int (*hits)(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                double t[2]);
    /* The same for the surface that it is a part of: a triangle's plane. */
    int (*extended)(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                    double t[2]);
    /* Where a line that may pass within `eps` is near it, in order. Returns 1: on its plane, to be
     * limited to the extent from pass(); 2: where the line enters and leaves the region within eps;
     * 0: at that extent. */
    int (*nearby)(const bb_scene *scene, uint32_t i, const double o[3], const float d[3],
                  double eps, double t[2]);
    /* How far the line passes from it, and its flat parts as seen from the line (their number; none
     * for a curved primitive). */
    bb_passing (*pass)(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                       double to);
    uint32_t (*outlines)(const bb_scene *scene, uint32_t i, const bb_frame *frame, double from,
                         double to, bb_outline outlines[BB_OUTLINES_MAX]);
} bb_prim_kind;

/* All functions except mirror(), and extended(), which may be hits() itself, for files that name
 * each function as here. */
#define BB_PRIM_FUNCTIONS                                                                          \
    .bounds = bounds, .product = product, .is_flat = is_flat, .area = area, .sample = sample,      \
    .normal = normal, .shrink = shrink, .reach = reach, .height = height, .hits = hits,            \
    .nearby = nearby, .pass = pass, .outlines = outlines

/* Where mirroring moves a coordinate; one from lo to hi stays within them. */
static inline float bb_mirrored(float x, float lo, float hi)
{
    return (float)((double)hi - (double)x + (double)lo);
}

/* Indexed by BB_TRIANGLE, BB_SPHERE, ... */
extern const bb_prim_kind *const bb_prim_kinds[BB_KIND_COUNT];

/* Returns the kind of primitive `prim`, which must exist; *i: its number within the kind. */
static inline const bb_prim_kind *bb_prim_of(const bb_scene *scene, uint32_t prim, uint32_t *i)
{
    uint32_t kind = 0;
    while (prim - scene->prims[kind].first >= scene->prims[kind].count)
        kind++;
    *i = prim - scene->prims[kind].first;
    return bb_prim_kinds[kind];
}

/* Numbers the primitives consecutively from the counts of their kinds: sets first, prim_count and
 * kinds. */
void bb_scene_number_kinds(bb_scene *scene);

/* Returns the bytes of one primitive's data. */
size_t bb_prim_bytes(uint32_t kind);

/* Writes the plural names of the kinds in the bits `kinds`: "triangles+spheres". */
void bb_prim_kind_names(uint32_t kinds, char *text, size_t capacity);

#endif
