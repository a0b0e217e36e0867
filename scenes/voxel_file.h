/* Files of plain voxels: reads their bytes, compressed or not, as values. */
#ifndef BB_VOXEL_FILE_H
#define BB_VOXEL_FILE_H

#include "framework/scene/volume.h"

#include <stdbool.h>

/* Reads exactly as many bytes as `voxels` has room for. BB_INVALID if the file has fewer or more.
 */
bb_status bb_voxel_file_read(const char *path, const bb_voxels *voxels);

/* The same for a file compressed by zstd. */
bb_status bb_voxel_file_read_zst(const char *path, const bb_voxels *voxels);

/* Converts values of two bytes from big-endian. */
void bb_voxels_swap(const bb_voxels *voxels);

/* Parses "WxHxD", whole numbers from 1 on; returns false for anything else. */
bool bb_read_dims(const char *text, uint32_t dims[3]);

#endif
