/* Host side of splits by priority: grid, search for D, launches. presplit.cl describes the method.
 *
 * The search first tries D = 1, 4, 16 ... 4^15. It then refines three times by sixteenths of the
 * interval between the last D within the budget and the next one (0 and 1, if 1 exceeds it).
 * Published code bisects an interval six times.
 */
#include "presplit_priority.h"
#include "builders/common/scene_unit.h"
#include "framework/base/arithmetic.h"
#include "presplit_shared.h"

#include <math.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(presplit);

enum { GROUP_SIZE = 64, CHUNKS = 1024, CHUNK_LEAST = 256, ROUNDS = 3 };

struct ps_priority {
    bb_device *device;
    bb_account *account;
    double beta;
    float keeps;
    bb_primitives *primitives;
    cl_program program;
    cl_kernel priorities_kernel, sums_kernel, counts_kernel, split_kernel;
    bb_buffer bounds;     /* two bb_box */
    bb_buffer priorities; /* float per primitive */
    bb_buffer places;     /* u32 per primitive */
    bb_buffer sums;       /* u32[PS_TRIES] per chunk */
};

void ps_priority_destroy(ps_priority *self)
{
    if (self == NULL)
        return;
    bb_buffer_release(&self->bounds);
    bb_buffer_release(&self->priorities);
    bb_buffer_release(&self->places);
    bb_buffer_release(&self->sums);
    bb_kernel_release(self->priorities_kernel);
    bb_kernel_release(self->sums_kernel);
    bb_kernel_release(self->counts_kernel);
    bb_kernel_release(self->split_kernel);
    bb_program_release(self->program);
    bb_primitives_destroy(self->primitives);
    free(self);
}

bb_status ps_priority_create(const bb_builder_context *context, double beta, double saves,
                             ps_priority **out)
{
    ps_priority *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->beta = beta;
    self->keeps = (float)(1 - saves);
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    BB_TRY(bb_program_build(
        self->device, &bb_source_presplit,
        bb_device_divides_exactly(self->device) ? "-cl-fp32-correctly-rounded-divide-sqrt" : "",
        &self->program));
    BB_TRY(bb_kernel_get(self->program, "ps_priorities", &self->priorities_kernel));
    BB_TRY(bb_kernel_get(self->program, "ps_sums", &self->sums_kernel));
    BB_TRY(bb_kernel_get(self->program, "ps_counts", &self->counts_kernel));
    return bb_kernel_get(self->program, "ps_split", &self->split_kernel);
}

bb_status ps_priority_prepare(ps_priority *self, const bb_scene *scene)
{
    size_t count = scene->prim_count;
    BB_TRY(bb_buffer_reserve(self->device, self->account, 2 * sizeof(bb_box), "presplit: bounds",
                             &self->bounds));
    BB_TRY(bb_buffer_reserve(self->device, self->account, count * sizeof(float),
                             "presplit: priorities", &self->priorities));
    BB_TRY(bb_buffer_reserve(self->device, self->account, count * sizeof(uint32_t),
                             "presplit: places", &self->places));
    return bb_buffer_reserve(self->device, self->account, CHUNKS * sizeof(uint32_t[PS_TRIES]),
                             "presplit: sums", &self->sums);
}

static ps_grid grid_over(const bb_box *bounds)
{
    ps_grid grid = {.unit = bb_scene_unit(bounds)};
    for (int k = 0; k < 3; k++) {
        double extent = (double)bounds->hi[k] - bounds->lo[k];
        grid.lo[k] = bounds->lo[k];
        grid.step[k] = (float)ldexp(extent, -PS_GRID_BITS);
        grid.per_unit[k] = isnormal(grid.step[k]) ? 1.0f / grid.step[k] : 0.0f;
        grid.per_unit[k] = isnormal(grid.per_unit[k]) ? grid.per_unit[k] : 0.0f;
    }
    return grid;
}

/* totals[k]: number of splits with D = tries->d[k]. */
static bb_status count_splits(ps_priority *self, uint32_t count, const ps_tries *tries,
                              uint64_t totals[PS_TRIES])
{
    const uint32_t least = count / CHUNKS + 1, chunk = least > CHUNK_LEAST ? least : CHUNK_LEAST;
    const uint32_t chunks = bb_divide_up(count, chunk);
    void *mapped;
    BB_TRY(bb_launch(self->device, self->sums_kernel, chunks, 1, BB_MEM(self->priorities),
                     BB_VALUE(count), BB_VALUE(chunk), BB_VALUE(*tries), BB_MEM(self->sums)));
    BB_TRY(bb_buffer_map(&self->sums, false, &mapped));
    for (uint32_t k = 0; k < PS_TRIES; k++)
        totals[k] = 0;
    for (uint32_t i = 0; i < chunks * PS_TRIES; i++)
        totals[i % PS_TRIES] += ((const uint32_t *)mapped)[i];
    return bb_buffer_unmap(&self->sums, mapped);
}

/* Finds the largest tried D that makes at most `most` splits, and their number. */
static bb_status search(ps_priority *self, uint32_t count, uint64_t most, float *d,
                        uint64_t *splits)
{
    uint64_t totals[PS_TRIES];
    double low = 0, high = 1;
    *splits = 0;
    for (int round = 0; round <= ROUNDS; round++) {
        const double step = (high - low) / PS_TRIES, from = low;
        ps_tries tries;
        for (int k = 0; k < PS_TRIES; k++)
            tries.d[k] = (float)(round == 0 ? ldexp(1, 2 * k) : from + k * step);
        BB_TRY(count_splits(self, count, &tries, totals));
        for (int k = 0; k < PS_TRIES && totals[k] <= most; k++) {
            low = tries.d[k];
            high = round == 0 ? 4 * low : low + step;
            *splits = totals[k];
        }
    }
    *d = (float)low;
    return BB_OK;
}

bb_status ps_priority_split(ps_priority *self, const bb_scene *scene, bb_references *references,
                            bb_phases *phases)
{
    bb_device *device = self->device;
    const bb_scene_device *there = &scene->on_device;
    const uint32_t count = scene->prim_count, triangles = scene->prims[BB_TRIANGLE].count;
    const uint64_t most = (uint64_t)(self->beta * count);
    uint64_t splits;
    bb_box bounds[2];
    float d;
    BB_TRY(bb_references_reserve(references, device, BB_ON_DEVICE, (size_t)(count + most)));
    BB_TRY(bb_phase(phases, "priorities"));
    BB_TRY(bb_reduce_boxes(self->primitives, &there->boxes, count, &self->bounds));
    BB_TRY(bb_buffer_read(&self->bounds, 0, sizeof bounds, bounds));
    const ps_grid grid = grid_over(&bounds[0]);
    BB_TRY(bb_launch(device, self->priorities_kernel, count, GROUP_SIZE, BB_MEM(there->boxes),
                     BB_MEM(there->prims), BB_MEM(there->vertices), BB_VALUE(triangles),
                     BB_VALUE(count), BB_VALUE(grid), BB_VALUE(self->keeps),
                     BB_MEM(self->priorities)));
    BB_TRY(bb_phase(phases, "counts"));
    BB_TRY(search(self, count, most, &d, &splits));
    BB_TRY(bb_launch(device, self->counts_kernel, count, GROUP_SIZE, BB_MEM(self->priorities),
                     BB_VALUE(count), BB_VALUE(d), BB_MEM(self->places)));
    BB_TRY(bb_scan_u32(self->primitives, &self->places, &self->places, count, NULL));
    BB_TRY(bb_phase(phases, "split"));
    BB_TRY(bb_launch(device, self->split_kernel, count, GROUP_SIZE, BB_MEM(there->boxes),
                     BB_MEM(there->prims), BB_MEM(there->vertices), BB_VALUE(count), BB_VALUE(grid),
                     BB_MEM(self->priorities), BB_VALUE(d), BB_MEM(self->places),
                     BB_MEM(references->d_boxes), BB_MEM(references->d_prims)));
    references->count = (uint32_t)(count + splits);
    return bb_phase(phases, NULL);
}
