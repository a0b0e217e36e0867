/* Types and constants that host and device share for splits by priority. Include bb_shared.h
 * first. */
#ifndef BB_PRESPLIT_SHARED_H
#define BB_PRESPLIT_SHARED_H

/* Values of D per pass; most splits of a primitive. */
#define PS_TRIES 16
#define PS_MOST 31u

/* Cells of the Morton grid along an axis, as a power of two. */
#define PS_GRID_BITS 16

/* The grid over the scene's box. Cells begin at lo + k step; per_unit = 1 / step, 0 where the scene
 * is flat. Lengths times `unit`, a power of two, are at most 1. */
typedef struct ps_grid {
    float lo[3];
    float step[3];
    float per_unit[3];
    float unit;
} ps_grid;

typedef struct ps_tries {
    float d[PS_TRIES];
} ps_tries;

#ifdef BB_STATIC_ASSERT
BB_STATIC_ASSERT(sizeof(ps_grid) == 40, "ps_grid");
BB_STATIC_ASSERT(sizeof(ps_tries) == 64, "ps_tries");
#endif

#endif
