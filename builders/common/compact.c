/* Host side of compact.cl. */
#include "builders/common/compact.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_compaction {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    cl_program program;
    cl_kernel kernel;
    bb_buffer places;
};

bb_status bb_compaction_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                               bb_compaction **out)
{
    bb_compaction *compaction = calloc(1, sizeof *compaction);
    if (compaction == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *compaction = (bb_compaction){.device = device, .account = account, .primitives = primitives};
    bb_status status =
        bb_program_build(device, bb_source_find("compact.cl"), "", &compaction->program);
    if (status == BB_OK)
        status = bb_kernel_get(compaction->program, "compact", &compaction->kernel);
    if (status != BB_OK) {
        bb_compaction_destroy(compaction);
        return status;
    }
    *out = compaction;
    return BB_OK;
}

void bb_compaction_destroy(bb_compaction *compaction)
{
    if (compaction == NULL)
        return;
    bb_buffer_release(&compaction->places);
    bb_kernel_release(compaction->kernel);
    bb_program_release(compaction->program);
    free(compaction);
}

bb_status bb_compaction_reserve(bb_compaction *compaction, uint32_t count)
{
    size_t bytes = ((size_t)count + 1) * sizeof(uint32_t);
    return bb_buffer_reserve(compaction->device, compaction->account, bytes, "compaction: places",
                             &compaction->places);
}

bb_status bb_compact_u32(bb_compaction *compaction, const bb_buffer *marks, const bb_buffer *values,
                         uint32_t count, bb_buffer *out, bb_buffer *kept)
{
    size_t bytes = count * sizeof(uint32_t);
    const uint32_t numbers = values == NULL;
    if (marks->bytes < bytes || (values != NULL && values->bytes < bytes))
        return bb_fail(BB_INVALID, "compaction of %u values: marks or values have room for fewer",
                       count);
    BB_TRY(bb_compaction_reserve(compaction, count));
    BB_TRY(bb_scan_u32(compaction->primitives, marks, &compaction->places, count, kept));
    if (count == 0)
        return BB_OK;
    return bb_launch(compaction->device, compaction->kernel, count, GROUP_SIZE, BB_MEM(*marks),
                     BB_MEM(compaction->places), BB_MEM(*(numbers != 0 ? marks : values)),
                     BB_VALUE(numbers), BB_VALUE(count), BB_MEM(*out));
}
