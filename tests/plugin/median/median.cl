/* Object median, the device's part: the centroids of the primitives' boxes.
 *
 *   for each primitive, in parallel: centroid = lo/2 + hi/2
 */
#include "bb_device.h"

kernel void median_centroids(global const bb_box *boxes, uint count, global float *centroids)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    for (uint axis = 0; axis < 3; axis++)
        centroids[3 * i + axis] = 0.5f * boxes[i].lo[axis] + 0.5f * boxes[i].hi[axis];
}
