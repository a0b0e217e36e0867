#include "framework/simulate/footing.h"

#include <stdlib.h>

bb_footing bb_footing_of(const bb_traverser_request *request, const bb_layout_data *layout)
{
    const bb_kernel *kernel = request->kernel;
    const char *entries = bb_spec_value(request->spec, kernel->options, "entries");
    const bb_u32 words = layout->lanes > 1 ? bb_block_words(layout->kinds, layout->format)
                                           : bb_leaf_prim_words(layout->kinds, layout->format);
    return (bb_footing){.control = kernel->control,
                        .ring = entries != NULL ? (uint32_t)strtoul(entries, NULL, 10) : 0,
                        .node_bytes = bb_layout_find(kernel->layout)->node_bytes,
                        .prim_bytes = words * (uint32_t)sizeof(bb_u32),
                        .result_bytes = (uint32_t)request->query->result_bytes};
}
