/* Keys of cells. A cell is one measurement: a scene, rays from a view, a builder, a kernel and an
 * intersector, each with all parameters. Its key is a text that says all of this and repeats it
 * (`bvhbench run --cell KEY`). The device is not in it, so that one key can be measured on several:
 * two cells are the same if their keys are, and their runs' devices (framework/compare/cell_set.h).
 *
 *   key   = part *( "/" part )
 *   part  = name "=" value
 *   value = 1*( letter / digit / "." / "_" / "-" / ":" / "," / "=" / "+" / "%" hex hex )
 *
 * The names, in this order: scene, rays, size (WIDTHxHEIGHT), max-rays, seed, view, rays-hash,
 * builder, kernel, intersector. What else a value holds is percent-encoded, so that no separator
 * stands in a value and no shell takes anything of a key for its own.
 *
 *   scene=coffee/rays=primary/size=512x512/max-rays=1048576/seed=1/view=front/builder=lbvh:...
 *
 * Left out: `view` of rays that are made once per scene; `kernel` and `intersector` of a reference
 * row, which traces by itself; all of the rays, and of a kernel, where only a build was measured.
 * Layout and query follow from kernel, intersector and rays. size, max-rays and seed always stand
 * with rays: they also decide how rays are batched. `rays-hash` names rays that cannot be made
 * again by name, from another program.
 *
 * Canonical: parameters in the order in which they are declared, all that have a value spelled out,
 * defaults too, so that a key keeps its meaning when a default changes; an intersector by the first
 * name that has its rules. A whole number stands in plain digits (1000000 for 1e6, 1M or 1_000_000)
 * where the option's default is a number, or it has none; one that equals the default as that is
 * spelled. Other values stand as given: 0.5 and 0.50 are two. A scene file is its path as given.
 * What names no builder, kernel, workload or scene that is known stays as it is.
 */
#ifndef BB_CELL_H
#define BB_CELL_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BB_CELL_TEXT = 1024, BB_CELL_KEY = 4096 };

/* "" and 0: not given. */
typedef struct bb_cell_parts {
    char scene[BB_CELL_TEXT], rays[BB_CELL_TEXT], view[BB_CELL_TEXT];
    char builder[BB_CELL_TEXT], kernel[BB_CELL_TEXT], intersector[BB_CELL_TEXT];
    uint32_t width, height, max_rays;
    uint64_t seed;
    bool known_by_hash; /* rays_hash stands for how the rays are made */
    uint64_t rays_hash;
} bb_cell_parts;

enum { BB_CELL_WIDTH = 512, BB_CELL_HEIGHT = 512, BB_CELL_MAX_RAYS = 1 << 20, BB_CELL_SEED = 1 };

/* Reads a key whose parts may come in any order. What may have a default and is not there gets it:
 * size, max-rays and seed those above, the intersector `exact`. BB_INVALID, with the key's start
 * and what is wrong with it, for what is no key: an unknown, repeated, missing or empty part, a bad
 * escape or number. Whether there are such a scene, builder ... is not looked at. */
bb_status bb_cell_key_parse(const char *key, bb_cell_parts *cell);

/* The key of `cell` as it stands; 0-terminated. BB_INVALID if it is longer than there is room. */
bb_status bb_cell_key_format(const bb_cell_parts *cell, char key[BB_CELL_KEY]);

/* The same part by part: "/name=value", with what is no plain letter as %XX; nothing for "". The
 * caller ends the key with a 0 at key[length]; `full`: it is longer than there is room. */
typedef struct bb_key_writer {
    char *key; /* BB_CELL_KEY */
    size_t length;
    bool full;
} bb_key_writer;
void bb_key_put(bb_key_writer *writer, const char *name, const char *value);

/* Makes equal cells equal in every letter. */
void bb_cell_canonical(bb_cell_parts *cell);
/* The same without parameters that have their defaults: short names for tables. */
void bb_cell_short(bb_cell_parts *cell);

/* Is this builder a reference row (Embree with its own trees)? */
bool bb_is_reference(const char *builder);

/* ---- parts of a key; a key names its rays first, then its builder and what traces ---- */

/* Length of the beginning that cells on one scene and rays share, from whatever view. */
size_t bb_cell_key_set(const char *key);
/* Length of the beginning that cells on the same rays share. */
size_t bb_cell_key_rays(const char *key);
/* Whether both beginnings, of these lengths, are the same. */
bool bb_cell_key_same(const char *a, size_t a_length, const char *b, size_t b_length);

#endif
