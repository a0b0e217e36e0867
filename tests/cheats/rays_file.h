/* The files of both directions, as framework/workload/exchange.h describes them. */
#ifndef CHEATS_RAYS_FILE_H
#define CHEATS_RAYS_FILE_H

#include "framework/workload/exchange.h"

#include <stdbool.h>

/* A rays file in memory. */
typedef struct scene {
    bb_rays_header header;
    bb_ray *rays;
    float (*vertices)[3];
    uint32_t (*indices)[3];
    float (*spheres)[4];
    uint32_t triangles, prims;
} scene;

/* Each says on stderr why it returned false. A scene read in part is to be freed as well. */
bool scene_read(const char *path, scene *s);
void scene_free(scene *s);
/* One hit per ray. */
bool hits_write(const char *path, const scene *s, const bb_hit *hits, const char *tracer);
bool complain(const char *path, const char *what);

#endif
