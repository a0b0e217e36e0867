/* References: their memory and their copies, on host and device. */
#include "framework/builder/references.h"
#include "framework/base/clock.h"

#include <string.h>

void bb_references_init(bb_references *references, bb_account *account)
{
    memset(references, 0, sizeof *references);
    references->account = account;
}

void bb_references_release(bb_references *references)
{
    bb_host_free(references->boxes);
    bb_host_free(references->prims);
    bb_buffer_release(&references->d_boxes);
    bb_buffer_release(&references->d_prims);
    bb_references_init(references, references->account);
}

static bb_status reserve_host(bb_references *references, size_t count)
{
    bb_account *account = references->account;
    if (references->boxes != NULL && references->capacity >= count)
        return BB_OK;
    references->capacity = 0;
    BB_TRY(
        bb_host_alloc(account, count * sizeof(bb_box), "boxes of references", &references->boxes));
    BB_TRY(bb_host_alloc(account, count * sizeof(uint32_t), "primitives of references",
                         &references->prims));
    references->capacity = count;
    return BB_OK;
}

static bb_status reserve_device(bb_references *references, bb_device *device, size_t count)
{
    bb_account *account = references->account;
    BB_TRY(bb_buffer_reserve(device, account, count * sizeof(bb_box), "boxes of references",
                             &references->d_boxes));
    return bb_buffer_reserve(device, account, count * sizeof(uint32_t), "primitives of references",
                             &references->d_prims);
}

bb_status bb_references_reserve(bb_references *references, bb_device *device, bb_place place,
                                size_t capacity)
{
    if (capacity > BB_INDEX_MASK)
        return bb_fail(BB_REFUSED, "%zu references: a tree can hold %u", capacity, BB_INDEX_MASK);
    if (place != references->place)
        bb_references_release(references);
    references->place = place;
    references->copied = false;
    references->count = 0;
    return place == BB_ON_HOST ? reserve_host(references, capacity)
                               : reserve_device(references, device, capacity);
}

bb_status bb_references_download(bb_references *references, double *ms)
{
    if (ms != NULL)
        *ms = 0.0;
    if (references->place == BB_ON_HOST || references->copied)
        return BB_OK;
    size_t count = references->count;
    BB_TRY(reserve_host(references, count));
    double start = bb_wall_ms();
    BB_TRY(bb_buffer_read(&references->d_boxes, 0, count * sizeof(bb_box), references->boxes));
    BB_TRY(bb_buffer_read(&references->d_prims, 0, count * sizeof(uint32_t), references->prims));
    if (ms != NULL)
        *ms = bb_wall_ms() - start;
    references->copied = true;
    return BB_OK;
}

bb_status bb_references_upload(bb_references *references, bb_device *device, double *ms)
{
    if (ms != NULL)
        *ms = 0.0;
    if (references->place == BB_ON_DEVICE || references->copied)
        return BB_OK;
    size_t count = references->count;
    BB_TRY(reserve_device(references, device, count));
    double start = bb_wall_ms();
    BB_TRY(bb_buffer_write(&references->d_boxes, 0, count * sizeof(bb_box), references->boxes));
    BB_TRY(bb_buffer_write(&references->d_prims, 0, count * sizeof(uint32_t), references->prims));
    if (ms != NULL)
        *ms = bb_wall_ms() - start;
    references->copied = true;
    return BB_OK;
}
