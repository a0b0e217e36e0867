#include "lobvh_dense.h"

#include "framework/base/arithmetic.h"

BB_DEVICE_SOURCE(lobvh_dense);

enum {
    GROUP_SIZE = 64,
    CHUNK_CPU = 512,
    CHUNK_GPU = 8,
    BOX_BYTES = 6 * sizeof(float),
    WORD = sizeof(uint32_t)
};

bb_status bb_lobvh_dense_create(bb_device *device, bb_account *account, bb_lobvh_dense *dense)
{
    dense->device = device;
    dense->account = account;
    BB_TRY(bb_program_build(device, &bb_source_lobvh_dense, "", &dense->program));
    BB_TRY(bb_kernel_get(dense->program, "dense_pointers", &dense->pointers));
    BB_TRY(bb_kernel_get(dense->program, "dense_setup", &dense->setup));
    BB_TRY(bb_kernel_get(dense->program, "dense_adjust", &dense->adjust));
    BB_TRY(bb_kernel_get(dense->program, "dense_next", &dense->next));
    return bb_kernel_get(dense->program, "dense_write", &dense->write);
}

void bb_lobvh_dense_release(bb_lobvh_dense *dense)
{
    bb_buffer *const buffers[] = {&dense->boxes, &dense->children, &dense->nexts,
                                  &dense->prims, &dense->offsets,  &dense->total};
    cl_kernel const kernels[] = {dense->pointers, dense->setup, dense->adjust, dense->next,
                                 dense->write};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(dense->program);
}

/* Returns the number of nodes above `level`. */
static uint64_t nodes_above(uint32_t level)
{
    return (((uint64_t)1 << 3 * level) - 1) / 7;
}

uint64_t bb_lobvh_dense_largest(uint32_t levels)
{
    return nodes_above(levels + 1) * BOX_BYTES;
}

uint64_t bb_lobvh_dense_bytes(uint32_t levels)
{
    return nodes_above(levels + 1) * (BOX_BYTES + 4 * WORD) + nodes_above(levels) * WORD;
}

uint64_t bb_lobvh_dense_held(const bb_lobvh_dense *dense)
{
    return dense->boxes.bytes + dense->children.bytes + dense->nexts.bytes + dense->prims.bytes +
           dense->offsets.bytes;
}

bb_status bb_lobvh_dense_reserve(bb_lobvh_dense *dense, uint32_t levels)
{
    const size_t nodes = nodes_above(levels + 1), inner = nodes_above(levels);
    const struct {
        size_t bytes;
        const char *what;
        bb_buffer *buffer;
    } needed[] = {
        {nodes * BOX_BYTES, "lobvh: boxes of the octree", &dense->boxes},
        {nodes * WORD, "lobvh: first children", &dense->children},
        {nodes * WORD, "lobvh: next nodes", &dense->nexts},
        {nodes * 2 * WORD, "lobvh: primitives of nodes", &dense->prims},
        {inner * WORD, "lobvh: places", &dense->offsets},
        {WORD, "lobvh: total", &dense->total},
    };
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++)
        BB_TRY(bb_buffer_reserve(dense->device, dense->account, needed[i].bytes, needed[i].what,
                                 needed[i].buffer));
    return BB_OK;
}

/* ---- build ---- */

static bb_status set_pointers(bb_lobvh_dense *d, const bb_buffer *keys, const bb_buffer *values,
                              uint32_t count, uint32_t levels, bb_tree *tree)
{
    const uint32_t nodes = (uint32_t)nodes_above(levels + 1), inner = (uint32_t)nodes_above(levels);
    BB_TRY(bb_buffer_fill(&d->prims, (size_t)nodes * 2 * WORD, BB_NONE));
    BB_TRY(bb_launch(d->device, d->pointers, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(*values),
                     BB_VALUE(count), BB_MEM(d->prims), BB_MEM(tree->d_refs)));
    return bb_launch(d->device, d->setup, nodes, GROUP_SIZE, BB_VALUE(nodes), BB_VALUE(inner),
                     BB_MEM(d->children), BB_MEM(d->nexts));
}

static bb_status adjust(bb_lobvh_dense *d, const bb_buffer *values, const bb_buffer *boxes,
                        uint32_t levels, bb_tree *tree)
{
    const uint32_t all = (uint32_t)nodes_above(levels + 1), inner = (uint32_t)nodes_above(levels);
    const bool cpu = bb_cpu_form(d->device);
    const uint32_t chunk = cpu ? CHUNK_CPU : CHUNK_GPU;
    BB_TRY(bb_buffer_fill(&tree->d_info, sizeof(bb_tree_info), 0));
    for (uint32_t level = levels + 1; level-- > 0;) {
        const uint32_t first = (uint32_t)nodes_above(level);
        const uint32_t nodes = (uint32_t)nodes_above(level + 1) - first;
        BB_TRY(bb_launch(d->device, d->adjust, bb_divide_up(nodes, chunk), cpu ? 1 : GROUP_SIZE,
                         BB_MEM(*values), BB_MEM(*boxes), BB_MEM(d->prims), BB_VALUE(first),
                         BB_VALUE(nodes), BB_VALUE(chunk), BB_VALUE(level), BB_VALUE(inner),
                         BB_MEM(d->children), BB_MEM(d->boxes), BB_MEM(d->offsets),
                         BB_MEM(tree->d_info)));
    }
    return bb_launch(d->device, d->next, all, GROUP_SIZE, BB_VALUE(all), BB_MEM(d->children),
                     BB_MEM(d->prims), BB_MEM(d->nexts));
}

bb_status bb_lobvh_dense_link(bb_lobvh_dense *d, bb_primitives *primitives, const bb_buffer *keys,
                              const bb_buffer *values, const bb_buffer *boxes, uint32_t count,
                              uint32_t levels, bb_tree *tree, bb_phases *phases)
{
    const uint32_t nodes = (uint32_t)nodes_above(levels + 1), inner = (uint32_t)nodes_above(levels);
    BB_TRY(bb_phase(phases, "pointer setup"));
    BB_TRY(set_pointers(d, keys, values, count, levels, tree));
    BB_TRY(bb_phase(phases, "vacancy"));
    BB_TRY(adjust(d, values, boxes, levels, tree));
    BB_TRY(bb_phase(phases, "compaction"));
    BB_TRY(bb_scan_u32(primitives, &d->offsets, &d->offsets, inner, &d->total));
    BB_TRY(bb_phase(phases, "link"));
    return bb_launch(d->device, d->write, nodes, GROUP_SIZE, BB_MEM(*values), BB_MEM(*boxes),
                     BB_MEM(d->prims), BB_VALUE(count), BB_VALUE(nodes), BB_MEM(d->children),
                     BB_MEM(d->nexts), BB_MEM(d->boxes), BB_MEM(d->offsets), BB_MEM(d->total),
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_info));
}
