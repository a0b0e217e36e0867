/* Keys of cells. A cell is one measurement: a scene, rays from a view, a builder, a kernel and an
 * intersector, each with all parameters. Its key is a text that names all of these, and `bvhbench
 * run --cell KEY` measures it again. The key does not name the device, so that one key can be
 * measured on several devices. Two cells are the same if their keys and the devices of their runs
 * are (framework/compare/cell_set.h).
 *
 *   key   = part *( "/" part )
 *   part  = name "=" value
 *   value = 1*( letter / digit / "." / "_" / "-" / ":" / "," / "=" / "+" / "%" hex hex )
 *
 * The names, in this order: scene, rays, size (WIDTHxHEIGHT), max-rays, seed, view, rays-hash,
 * builder, kernel, intersector. Other characters of a value are percent-encoded, so that values
 * contain no separator and nothing that a shell interprets.
 *
 *   scene=coffee/rays=primary/size=512x512/max-rays=1048576/seed=1/view=front/builder=lbvh:...
 *
 * A key has no `view` for rays that are made once per scene. It has no `kernel` and no
 * `intersector` for a reference row, which traces by itself. The key of a build names no rays and
 * nothing that traces. Layout and query follow from kernel, intersector and rays. size, max-rays
 * and seed always stand with rays, since they also decide how rays are batched. `rays-hash` stands
 * for rays of another program, which cannot be generated again.
 *
 * A canonical key has all parameters in the order of their declaration, defaults included, so that
 * it keeps its meaning when a default changes. An intersector has the first name with its rules.
 * Whole numbers are written in plain digits (1000000 for 1e6, 1M or 1_000_000) if the option's
 * default is a number or absent; a value that equals the default is spelled like the default. Other
 * values stay as given: 0.5 and 0.50 differ. A scene file is its path as given. Names of builders,
 * kernels, workloads or scenes that are not known stay as they are.
 */
#ifndef BB_CELL_H
#define BB_CELL_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BB_CELL_TEXT = 1024, BB_CELL_KEY = 4096 };

/* Suffixes of keys where cells are compared. They are no parts of the grammar, since no run
 * measures such a cell by itself. A layout, whose name follows the key of its build, is made when
 * something traces it. Behind the key of a build or trace, a clock other than the wall's. The
 * number of a run tells cells of merged runs apart. */
#define BB_KEY_OF_LAYOUT "/layout="
#define BB_KEY_OF_CLOCK "/clock="
#define BB_KEY_OF_RUN "/run="

/* Parts of a key. "" and 0 stand for parts that are not given. */
typedef struct bb_cell_parts {
    char scene[BB_CELL_TEXT], rays[BB_CELL_TEXT], view[BB_CELL_TEXT];
    char builder[BB_CELL_TEXT], kernel[BB_CELL_TEXT], intersector[BB_CELL_TEXT];
    uint32_t width, height, max_rays;
    uint64_t seed;
    bool known_by_hash; /* rays_hash identifies the rays, which cannot be generated */
    uint64_t rays_hash;
} bb_cell_parts;

enum { BB_CELL_WIDTH = 512, BB_CELL_HEIGHT = 512, BB_CELL_MAX_RAYS = 1 << 20, BB_CELL_SEED = 1 };

/* Reads a key whose parts may come in any order. Missing size, max-rays and seed get the defaults
 * above, a missing intersector is `exact`. BB_INVALID if a part is unknown, repeated, missing or
 * empty, or has a bad escape or number; the message quotes the start of the key. Whether the scene,
 * the builder and so on exist is not checked. */
bb_status bb_cell_key_parse(const char *key, bb_cell_parts *cell);

/* Writes the key of `cell` as it is, 0-terminated. BB_INVALID if it is too long. */
bb_status bb_cell_key_format(const bb_cell_parts *cell, char key[BB_CELL_KEY]);

/* Writes a key part by part: bb_key_put() appends "/name=value" with percent-encoding, or nothing
 * if the value is "". The caller ends the key with a 0 at key[length]. `full`: the key is too long.
 */
typedef struct bb_key_writer {
    char *key; /* BB_CELL_KEY */
    size_t length;
    bool full;
} bb_key_writer;
void bb_key_put(bb_key_writer *writer, const char *name, const char *value);

/* Makes a cell canonical: equal cells then have equal texts. */
void bb_cell_canonical(bb_cell_parts *cell);
/* Makes a cell canonical, but leaves out parameters that have their defaults: short names for
 * tables. */
void bb_cell_short(bb_cell_parts *cell);
/* Both for a key, whose suffixes stay. A text that is none is copied. The canonical key's scene
 * stays, too: it may be a file, which need not be there. */
void bb_cell_key_canonical(const char *key, char canonical[BB_CELL_KEY]);
void bb_cell_key_short(const char *key, char brief[BB_CELL_KEY]);

/* ---- parts of a key; a key names its rays first, then its builder and what traces ---- */

/* Returns the length of the beginning that cells on one scene and rays share, for any view. */
size_t bb_cell_key_set(const char *key);
/* Returns the length of the beginning that cells on the same rays share. */
size_t bb_cell_key_rays(const char *key);
/* Returns whether both beginnings, of these lengths, are the same. */
bool bb_cell_key_same(const char *a, size_t a_length, const char *b, size_t b_length);

#endif
