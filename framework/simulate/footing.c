#include "framework/simulate/footing.h"

#include "framework/base/arithmetic.h"

#include <stdlib.h>

uint32_t bb_footing_lanes(const bb_footing *footing, uint32_t width, uint32_t rays, uint64_t i,
                          uint32_t *first)
{
    const uint32_t of_group = bb_divide_up(footing->group, width);
    const uint64_t group = i / of_group, before = i % of_group * width;
    const uint64_t at = group * footing->group + before;
    if (at >= rays)
        return 0;
    *first = (uint32_t)at;
    return bb_min_u32(bb_min_u32(width, footing->group - (uint32_t)before), rays - *first);
}

bb_footing bb_footing_of(const bb_traverser_request *request, const bb_layout_data *layout)
{
    const bb_kernel *kernel = request->kernel;
    const char *entries = bb_spec_value(request->spec, kernel->options, "entries");
    const bb_u32 words = layout->lanes > 1 ? bb_block_words(layout->kinds, layout->format)
                                           : bb_leaf_prim_words(layout->kinds, layout->format);
    const char *group = bb_spec_value(request->spec, bb_kernel_common_options, "group");
    return (bb_footing){.control = kernel->control,
                        .group = (uint32_t)strtoul(group, NULL, 10),
                        .packet = bb_kernel_recorded_packet(kernel, request->spec),
                        .ring = entries != NULL ? (uint32_t)strtoul(entries, NULL, 10) : 0,
                        .node_bytes = bb_layout_find(kernel->layout)->node_bytes,
                        .prim_bytes = words * (uint32_t)sizeof(bb_u32),
                        .item_bytes = sizeof(bb_ray),
                        .result_bytes = (uint32_t)request->query->result_bytes,
                        .nodes_bytes = layout->bytes - layout->prims_bytes,
                        .prims_bytes = layout->prims_bytes};
}
