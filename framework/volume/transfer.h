/* Transfer functions: what is seen of a value.
 *
 * A text of lines `VALUE ALPHA` or `VALUE ALPHA R G B`, all from 0 to 1, VALUE ascending; linear
 * between them, constant before the first and after the last. Two lines of one VALUE make a step.
 * ALPHA is what one voxel's width absorbs. Lines without a colour take the one of the line before;
 * the first is white.
 */
#ifndef BB_TRANSFER_H
#define BB_TRANSFER_H

#include "framework/base/status.h"
#include "kernels/volume_shared.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

enum { BB_TRANSFER_POINTS_MAX = 256 };

/* 1 of a text's ALPHA would absorb all in no length at all: this much is left of the light behind
 * one voxel. */
#define BB_TRANSFER_LEAST_LEFT 0x1p-24

typedef struct bb_transfer_point {
    double value, alpha, rgb[3];
} bb_transfer_point;

typedef struct bb_transfer {
    char name[64]; /* a preset, or the file's name */
    uint32_t count;
    bb_transfer_point points[BB_TRANSFER_POINTS_MAX];
} bb_transfer;

typedef struct bb_transfer_preset {
    const char *name;
    const char *summary; /* one line */
    const char *text;
} bb_transfer_preset;

extern const bb_transfer_preset bb_transfer_presets[]; /* ends with name NULL; the first is the
                                                          default */

/* The preset or file that `text` names. BB_INVALID, with the line, for a bad one. */
bb_status bb_transfer_load(const char *text, bb_transfer *transfer);

/* `what`, such as the file's path, starts messages. */
bb_status bb_transfer_parse(const char *what, const char *text, bb_transfer *transfer);

/* Its table for voxels of this width, BB_TRANSFER_STEPS entries: what is between two of them is
 * interpolated. Entries are 0 where alpha is. */
void bb_transfer_table(const bb_transfer *transfer, double voxel, bb_transfer_entry *table);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
