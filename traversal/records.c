/* Primitive records in the order of the leaves: host side of kernels/records.cl. */
#include "traversal/records.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_records {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel kernel;
};

bb_status bb_records_create(bb_device *device, bb_account *account, bb_records **out)
{
    bb_records *records = calloc(1, sizeof *records);
    if (records == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    records->device = device;
    records->account = account;
    bb_status status =
        bb_program_build(device, bb_source_find("records.cl"), "", &records->program);
    if (status == BB_OK)
        status = bb_kernel_get(records->program, "make_records", &records->kernel);
    if (status != BB_OK) {
        bb_records_destroy(records);
        return status;
    }
    *out = records;
    return BB_OK;
}

void bb_records_destroy(bb_records *records)
{
    if (records == NULL)
        return;
    bb_kernel_release(records->kernel);
    bb_program_release(records->program);
    free(records);
}

bb_status bb_records_make(bb_records *records, const bb_layout_source *source, uint32_t form,
                          bb_buffer *out, uint64_t *bytes)
{
    const bb_scene *scene = source->scene;
    const bb_tree *tree = source->tree;
    const bb_scene_device *geometry = &scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(scene);
    uint32_t words = bb_record_words(scene->kinds, form);
    uint32_t id_word = bb_record_payload(scene->kinds, form);
    uint32_t count = tree->info.ref_count;
    size_t size = (size_t)count * words * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(records->device, records->account, size, "primitive records", out));
    *bytes += size;
    return bb_launch(records->device, records->kernel, count, GROUP_SIZE, BB_MEM(tree->d_refs),
                     BB_VALUE(count), BB_MEM(geometry->vertices), BB_MEM(geometry->prims),
                     BB_VALUE(ends), BB_VALUE(scene->scale), BB_VALUE(form), BB_VALUE(words),
                     BB_VALUE(id_word), BB_MEM(*out));
}
