/* Exact nearest hits by brute force: rational arithmetic over all primitives.
 *
 * Shares no code with what it checks but the format of the files. Triangles are closed (edges and
 * vertices belong to them) and have two sides; one that has zero area, or lies in a plane with the
 * ray, is never hit. A ray that starts in a sphere hits its far side. Hits count in an open
 * interval; of equal distances the lowest primitive wins.
 */
#ifndef CHEATS_EXACT_TRACE_H
#define CHEATS_EXACT_TRACE_H

#include "tests/cheats/rays_file.h"

#include <gmp.h>
#include <stdbool.h>

/* Which hits of a ray count. */
typedef struct query {
    mpq_t low;           /* t > low */
    double high;         /* t < high; may be INFINITY */
    const bool *dropped; /* per primitive: as if it were not there; NULL: all are */
} query;

/* A hit, or, with BB_NONE for the primitive, none. */
typedef struct exact_hit {
    uint32_t prim;
    int root; /* of a sphere's two: 0 is the near one */
    float t;  /* nearest float, FLT_MAX for what is larger */
} exact_hit;

/* What one trace after the other uses again. */
typedef struct candidate candidate;
typedef struct workspace {
    const scene *scene;
    candidate *candidates; /* two per primitive */
    uint64_t exact;        /* decisions that doubles could not take */
} workspace;

bool workspace_init(workspace *work, const scene *scene);
void workspace_clear(workspace *work);

/* The nearest hit of `ray` that counts. */
exact_hit trace_exactly(workspace *work, const bb_ray *ray, const query *query);

/* t at which the line of the ray meets the primitive (of a sphere: by hit->root); hit->t is not
 * looked at. Exact for triangles, of spheres to 250 bits. False if it does not meet it. */
bool exact_t(const scene *scene, const bb_ray *ray, const exact_hit *hit, mpq_t t);

#endif
