/* Transfer functions give each value a colour and an opacity.
 *
 * Their text has lines `VALUE ALPHA` or `VALUE ALPHA R G B`, with numbers from 0 to 1 and VALUE
 * ascending. The function is linear between lines and constant beyond the first and the last. Two
 * lines of one VALUE make a step. ALPHA is the opacity of one voxel's width. A line without a
 * colour has the colour of the line before; the first one is white.
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

/* ALPHA 1 would mean infinite extinction. This transmittance of one voxel is used instead. */
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

/* Loads the preset or file that `text` names. BB_INVALID names the faulty line. */
bb_status bb_transfer_load(const char *text, bb_transfer *transfer);

/* Messages start with `what`, such as the file's path. */
bb_status bb_transfer_parse(const char *what, const char *text, bb_transfer *transfer);

/* Fills the table for voxels of this width: BB_TRANSFER_STEPS entries, which are interpolated.
 * Entries are 0 where ALPHA is 0. */
void bb_transfer_table(const bb_transfer *transfer, double voxel, bb_transfer_entry *table);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
