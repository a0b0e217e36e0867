/* Makes codes on the device (codes.cl). */
#include "builders/common/codes.h"

#include "framework/base/arithmetic.h"
#include "framework/scene/needs.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP_SIZE = 64, VALUES = 1 << BB_CODE_CHUNK_BITS };

struct bb_codes {
    bb_device *device;
    bb_account *account;
    const char *builder;
    bb_code_choice asked; /* as given, `auto` included */
    bb_code_choice choice;
    bb_code_pattern layout;
    bb_box found[2];   /* the last scene's bounds */
    uint32_t lanes;    /* boxes per work-item */
    bool leave_bounds; /* keep the bounds on the device if possible */
    cl_program program;
    cl_kernel keys;
    cl_kernel place;  /* NULL if the host reads the bounds */
    bb_buffer bounds; /* two bb_box */
    bb_buffer plan;
    bb_buffer tables; /* [chunk][lane][value]: places of a chunk's bits */
};

/* Releases everything that depends on the number of bits. */
static void release(bb_codes *codes)
{
    bb_buffer_release(&codes->bounds);
    bb_buffer_release(&codes->plan);
    bb_buffer_release(&codes->tables);
    bb_kernel_release(codes->keys);
    bb_kernel_release(codes->place);
    bb_program_release(codes->program);
    codes->keys = codes->place = NULL;
    codes->program = NULL;
}

static bool has_doubles(const bb_device *device)
{
    cl_device_fp_config config = 0;
    return clGetDeviceInfo(device->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof config, &config, NULL) ==
               CL_SUCCESS &&
           config != 0;
}

static bb_status compile(bb_codes *codes)
{
    const bb_code_choice *choice = &codes->choice;
    uint32_t sizes = choice->size_bits == 0             ? 0
                     : choice->sizes == BB_SIZES_LINEAR ? 1
                     : choice->sizes == BB_SIZES_ROOT   ? 2
                                                        : 3;
    char defines[128];
    snprintf(defines, sizeof defines,
             "%s -DBB_CODE_LANES=%u -DBB_SIZES=%u -DBB_MEASURE=%d -DBB_TABLES=%d",
             bb_codes_key_bytes(codes) == 8 ? "-DBB_KEY64" : "", codes->lanes, sizes,
             choice->measure, choice->tables);
    BB_TRY(bb_program_build(codes->device, bb_source_find("codes.cl"), defines, &codes->program));
    BB_TRY(bb_kernel_get(codes->program, "code_keys", &codes->keys));
    if (codes->leave_bounds && bb_code_is_fixed(choice) && has_doubles(codes->device))
        BB_TRY(bb_kernel_get(codes->program, "code_place", &codes->place));
    BB_TRY(bb_buffer_reserve(codes->device, codes->account, 2 * sizeof(bb_box), "codes: bounds",
                             &codes->bounds));
    BB_TRY(bb_buffer_reserve(codes->device, codes->account, sizeof(bb_code_plan), "codes: plan",
                             &codes->plan));
    size_t tables = choice->tables ? BB_CODE_CHUNKS * 4 * VALUES : 1;
    return bb_buffer_reserve(codes->device, codes->account, tables * sizeof(uint64_t),
                             "codes: tables", &codes->tables);
}

bb_status bb_codes_create(const bb_builder_context *context, bool leave_bounds, bb_codes **out)
{
    bb_codes *codes = calloc(1, sizeof *codes);
    if (codes == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = codes;
    codes->device = context->device;
    codes->account = context->account;
    codes->builder = context->spec->name;
    codes->leave_bounds = leave_bounds;
    BB_TRY(bb_code_choose(context->spec, context->options, &codes->asked));
    codes->choice = codes->asked;
    codes->lanes = bb_cpu_form(codes->device) ? 8 : 1;
    const bool open =
        codes->asked.bits_by == BB_BY_SCENE || codes->asked.size_bits_by == BB_BY_SCENE;
    return open ? BB_OK : compile(codes);
}

bool bb_codes_ready(const bb_codes *codes)
{
    return codes->keys != NULL;
}

bb_status bb_codes_prepare(bb_codes *codes, const bb_scene *scene, uint32_t multiple)
{
    bb_code_choice choice = codes->asked;
    BB_TRY(bb_code_resolve(&choice, scene, multiple, codes->builder));
    if (codes->keys != NULL && choice.bits == codes->choice.bits &&
        choice.size_bits == codes->choice.size_bits)
        return BB_OK;
    codes->choice = choice;
    release(codes);
    return compile(codes);
}

void bb_codes_destroy(bb_codes *codes)
{
    if (codes == NULL)
        return;
    if (codes->place != NULL)
        clFinish(codes->device->queue); /* the plan may be in transfer; failures have a message */
    release(codes);
    free(codes);
}

uint32_t bb_codes_bits(const bb_codes *codes)
{
    return codes->choice.bits;
}

uint32_t bb_codes_key_bytes(const bb_codes *codes)
{
    return codes->choice.bits > 32 ? 8 : 4;
}

bool bb_codes_key_changed(const bb_codes *codes, uint32_t compiled)
{
    return bb_codes_ready(codes) && bb_codes_key_bytes(codes) != compiled;
}

const bb_code_pattern *bb_codes_pattern(const bb_codes *codes)
{
    return &codes->layout;
}

const bb_box *bb_codes_bounds(const bb_codes *codes)
{
    assert(!codes->leave_bounds);
    return codes->found;
}

/* Writes tables of each lane's bits, as in section 4.5 of the paper, in chunks that fit into the
 * first-level cache. */
static bb_status write_tables(bb_codes *codes)
{
    const bb_code_pattern *layout = &codes->layout;
    uint64_t places[4][BB_CODE_CHUNKS * BB_CODE_CHUNK_BITS] = {{0}};
    uint64_t tables[BB_CODE_CHUNKS][4][VALUES];
    uint32_t rank[4];
    memcpy(rank, layout->count, sizeof rank);
    for (uint32_t i = 0; i < layout->bits; i++) {
        uint32_t lane = layout->axes[i];
        places[lane][--rank[lane]] = UINT64_C(1) << (layout->bits - 1 - i);
    }
    for (uint32_t chunk = 0; chunk < BB_CODE_CHUNKS; chunk++)
        for (uint32_t lane = 0; lane < 4; lane++) {
            uint64_t *table = tables[chunk][lane];
            const uint64_t *bits = &places[lane][chunk * BB_CODE_CHUNK_BITS];
            table[0] = 0;
            for (uint32_t value = 1; value < VALUES; value++)
                table[value] = table[value & (value - 1)] | bits[__builtin_ctz(value)];
        }
    return bb_buffer_write(&codes->tables, 0, sizeof tables, tables);
}

static bb_status write_plan(bb_codes *codes, const double direction[3])
{
    bb_code_lay_out(&codes->choice, codes->found, direction, &codes->layout);
    return bb_buffer_write(&codes->plan, 0, sizeof(bb_code_plan), &codes->layout.plan);
}

/* Sends a plan without bounds, which the device then completes. */
static bb_status send_plan(bb_codes *codes, const double direction[3])
{
    const bb_box unknown[2] = {{{0}, 0, {0}, 0}, {{0}, 0, {0}, 0}};
    const cl_uint centroids = codes->choice.by_centroids, cube = codes->choice.cube;
    bb_code_pattern layout;
    bb_code_lay_out(&codes->choice, unknown, direction, &layout);
    if (memcmp(&layout.plan, &codes->layout.plan, sizeof layout.plan) != 0) {
        BB_TRY(bb_finish(codes->device)); /* it may be in transfer for an earlier scene */
        codes->layout = layout;
    }
    BB_TRY(bb_buffer_send(&codes->plan, sizeof(bb_code_plan), &codes->layout.plan));
    return bb_launch(codes->device, codes->place, 1, 1, BB_MEM(codes->bounds), BB_VALUE(centroids),
                     BB_VALUE(cube), BB_MEM(codes->plan));
}

bb_status bb_codes_make(bb_codes *codes, bb_primitives *primitives, const bb_scene *scene,
                        bb_buffer *keys, bb_buffer *values, bb_phases *phases)
{
    const bb_buffer *boxes = &scene->on_device.boxes;
    uint32_t count = scene->prim_count;
    double direction[3];
    char what[96];
    if (!bb_codes_ready(codes))
        return bb_fail(BB_FAILED, "builder %s: bb_codes_prepare() was not called", codes->builder);
    snprintf(what, sizeof what, "builder %s", codes->builder);
    BB_TRY(bb_view_order(scene, codes->choice.view, what, direction));
    BB_TRY(bb_phase(phases, "bounds"));
    BB_TRY(bb_reduce_boxes(primitives, boxes, count, &codes->bounds));
    if (codes->place == NULL)
        BB_TRY(bb_buffer_read(&codes->bounds, 0, sizeof codes->found, codes->found));
    BB_TRY(bb_phase(phases, "codes"));
    BB_TRY(codes->place == NULL ? write_plan(codes, direction) : send_plan(codes, direction));
    if (codes->choice.tables)
        BB_TRY(write_tables(codes));
    uint32_t items = bb_divide_up(count, codes->lanes);
    return bb_launch(codes->device, codes->keys, items, GROUP_SIZE, BB_MEM(*boxes), BB_VALUE(count),
                     BB_MEM(codes->plan), BB_MEM(codes->tables), BB_MEM(*keys), BB_MEM(*values));
}

void bb_codes_describe(const bb_codes *codes, char *text, size_t capacity)
{
    char letters[BB_CODE_BITS_MAX + 1];
    bb_code_letters(&codes->layout, letters, sizeof letters);
    snprintf(text, capacity, "code of %u bits: %s", codes->layout.bits, letters);
}

void bb_codes_decide(const bb_codes *codes, const bb_scene *scene, bb_decisions *decisions)
{
    const bb_code_choice *choice = &codes->choice;
    const bb_code_pattern *layout = &codes->layout;
    if (scene->profile.measured)
        bb_decide_number(decisions, BB_DECIDED_CODE_BITS, layout->bits, choice->bits_by,
                         "%u for sizes; more than %u for places hardly lower the cost",
                         layout->count[BB_CODE_SIZE_AXIS], bb_need_code_bits(scene));
    else
        bb_decide_number(decisions, BB_DECIDED_CODE_BITS, layout->bits, choice->bits_by,
                         "no profile was asked for");
    if (choice->size_bits == 0 && choice->size_bits_by == BB_BY_DEFAULT)
        return; /* a code without size bits */
    if (scene->profile.measured)
        bb_decide_number(decisions, BB_DECIDED_SIZE_BITS, layout->count[BB_CODE_SIZE_AXIS],
                         choice->size_bits_by, "%u octaves from the scene to the median size",
                         bb_need_size_octaves(scene));
    else
        bb_decide_number(decisions, BB_DECIDED_SIZE_BITS, layout->count[BB_CODE_SIZE_AXIS],
                         choice->size_bits_by, "no profile was asked for");
}
