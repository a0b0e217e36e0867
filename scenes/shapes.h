/* Closed meshes that several generators are composed of. Vertices are shared within a shape, so
 * each is watertight by its indices alone. */
#ifndef BB_SHAPES_H
#define BB_SHAPES_H

#include "scenes/placement.h"

#include <stdint.h>

/* The place of the next shape. */
typedef struct bb_shape_cursor {
    float *vertices;
    uint32_t *indices;
    uint32_t vertex_count; /* written so far */
    uint32_t triangle_count;
    const bb_placement *placement; /* NULL: unchanged */
} bb_shape_cursor;

/* Starts at the first vertex and triangle of the scene. */
bb_shape_cursor bb_shape_start(bb_scene *scene, const bb_placement *placement);

/* Puts one vertex, rounded to float once, and returns its number; one triangle; and a quad, as the
 * triangles abc and acd. */
uint32_t bb_shape_vertex(bb_shape_cursor *cursor, const double p[3]);
void bb_shape_triangle(bb_shape_cursor *cursor, uint32_t a, uint32_t b, uint32_t c);
void bb_shape_quad(bb_shape_cursor *cursor, uint32_t a, uint32_t b, uint32_t c, uint32_t d);

enum { BB_SHAPE_BOX_VERTICES = 8, BB_SHAPE_BOX_TRIANGLES = 12 };

/* Puts a box, wound to be seen from outside. */
void bb_shape_box(bb_shape_cursor *cursor, const double lo[3], const double hi[3]);

/* Numbers of vertices and triangles of a sphere of tessellation n >= 1. */
uint64_t bb_shape_sphere_vertices(uint64_t n);
uint64_t bb_shape_sphere_triangles(uint64_t n);

/* Puts an octahedron whose faces are divided into n * n triangles each, pushed out onto the sphere.
 * Positions are computed in double and rounded once, only by + - * / and square roots, so that they
 * are the same on every machine. */
void bb_shape_sphere(bb_shape_cursor *cursor, const double centre[3], double radius, uint32_t n);

#endif
