/* A stack is private memory. A GPU keeps the private memory of all work-items in flight in its
 * global memory, and drivers without room for it abort the launch or the process. OpenCL does not
 * say how many work-items are in flight; on current GPUs there are up to 2048 per compute unit
 * (NVIDIA since Kepler 1024 to 2048, AMD's GCN 2560, RDNA 1024 to 2048). A quarter of the memory is
 * used for stacks, the rest is left to scenes and trees.
 */
#include "traversal/stack_room.h"

#include "traversal/packet.h"

enum { ITEMS_PER_UNIT = 2048, SHARE = 4 };

uint32_t bb_stacks_of_item(const bb_kernel *kernel, const bb_spec *spec)
{
    uint64_t rays = 1;
    if (bb_spec_is(spec, kernel->options, "rays", "auto"))
        return BB_PACKET_MOST;
    if (kernel->batched &&
        bb_spec_u64(spec, kernel->options, "rays", 1, UINT32_MAX, &rays) != BB_OK)
        rays = 1; /* the kernel has no such option */
    return (uint32_t)rays;
}

uint32_t bb_stack_room(const bb_device *device, uint32_t stacks)
{
    if (device->is_cpu)
        return UINT32_MAX;
    const uint64_t items = (uint64_t)device->compute_units * ITEMS_PER_UNIT;
    const uint64_t most = device->global_bytes / SHARE / items / BB_STACK_ENTRY_BYTES / stacks;
    uint32_t entries = BB_STACK_LEAST;
    while (2 * (uint64_t)entries <= most && entries < 1u << 30)
        entries *= 2;
    return entries;
}
