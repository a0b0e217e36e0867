#include "framework/simulate/lockstep.h"

#include "framework/base/arithmetic.h"
#include "framework/device/device_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const bb_lockstep_case bb_lockstep_cases[] = {
    {"stack", "stack_lockstep.cl", "-DBB_STACK_SIZE=64", 4, 0},
    {"stack8", "stack8_lockstep.cl", "-DBB_STACK_SIZE=128 -DBB_WIDTH=8", 8, 0},
    {"stackless", "stackless_lockstep.cl", "", 1, 0},
    {"short:entries=4", "short_lockstep.cl", "-DBB_LEVELS=64 -DBB_ENTRIES=4", 1, 4},
    {"cwbvh", "cwbvh_lockstep.cl", "-DBB_STACK_SIZE=64", 3, 0},
    {"packet8:group=64", "packet8_lockstep.cl",
     "-DBB_STACK_SIZE=128 -DBB_WIDTH=8 -DBB_RAYS=8 -DBB_BATCH=64", 8, 0},
    {"packet:rays=16,few=2,group=256", "packet_lockstep.cl",
     "-DBB_STACK_SIZE=64 -DBB_WIDTH=2 -DBB_RAYS=16 -DBB_FEW=2 -DBB_BATCH=256", 4, 0},
    /* stacks that are too short, first of packets, then of rays */
    {"packet8:stack=8,few=0", "packet8_lockstep.cl",
     "-DBB_STACK_SIZE=8 -DBB_WIDTH=8 -DBB_RAYS=8 -DBB_FEW=0 -DBB_BATCH=64", 1, 0},
    {.kernel = NULL},
};

const char *const bb_issue_names[BB_ISSUE_KINDS] = {
    [BB_STEP_NODE] = "node",     [BB_STEP_PUSH] = "push",       [BB_STEP_PRIMS] = "primitives",
    [BB_STEP_POP] = "pop",       [BB_STEP_RESTART] = "restart", [BB_STEP_BOX] = "box",
    [BB_STEP_SAMPLE] = "sample", [BB_STEP_LOOKUP] = "lookup",   [BB_STEP_AGAIN] = "again",
    [BB_ISSUE_BEGIN] = "begin",  [BB_ISSUE_END] = "end"};

/* The sources of a reference: its own, those that it shares with others, and the kernel's own as
 * kernel.clh. */
enum { SHARED = 8, FILES = SHARED + 3 };

static void find_sources(const char *name, const bb_kernel *kernel, bb_source files[FILES])
{
    static const char *const shared[SHARED] = {
        "lockstep.clh",        "lockstep_stack.clh",  "lockstep_leaf.clh", "lockstep_trace.clh",
        "lockstep_kernel.clh", "lockstep_packet.clh", "stack_visit.clh",   "stack8_visit.clh"};
    memset(files, 0, FILES * sizeof *files);
    files[0] = (bb_source){name, bb_source_find(name)->text, files};
    for (uint32_t i = 0; i < SHARED; i++)
        files[i + 1] = (bb_source){shared[i], bb_source_find(shared[i])->text, files};
    files[SHARED + 1] = (bb_source){"kernel.clh", bb_source_find(kernel->source)->text, files};
}

static bb_status build(bb_device *device, const bb_lockstep_case *which,
                       const bb_traverser_request *request, const bb_layout_data *layout,
                       cl_program *program)
{
    bb_source files[FILES];
    char defines[512];
    find_sources(which->source, request->kernel, files);
    bb_intersector_defines(request->intersector, defines, sizeof defines);
    snprintf(defines + strlen(defines), sizeof defines - strlen(defines),
             "%s -DBB_KINDS=%u -D%s -DBB_LANES=%u %s",
             bb_device_divides_exactly(device) ? " -cl-fp32-correctly-rounded-divide-sqrt" : "",
             layout->kinds, request->query->define, layout->lanes, which->defines);
    return bb_program_build(device, &files[0], defines, program);
}

/* Of all groups: steps, active lanes, sectors and lines of each kind. */
typedef cl_uint group_sums[BB_ISSUE_KINDS][4];

typedef struct buffers {
    bb_buffer rays, sums;
} buffers;

static bb_status launch(bb_device *device, cl_kernel kernel, const bb_layout_data *layout,
                        uint32_t prim_bytes, const bb_ray *rays, uint32_t count, uint32_t width,
                        buffers *on_device, group_sums *of_group)
{
    const uint32_t groups = bb_divide_up(count, width);
    const size_t bytes = groups * sizeof *of_group;
    BB_TRY(bb_buffer_reserve(device, NULL, count * sizeof *rays, "rays", &on_device->rays));
    BB_TRY(bb_buffer_reserve(device, NULL, bytes, "sums", &on_device->sums));
    BB_TRY(bb_buffer_write(&on_device->rays, 0, count * sizeof *rays, rays));
    BB_TRY(bb_buffer_write(&on_device->sums, 0, bytes, of_group));
    BB_TRY(bb_launch(device, kernel, groups, 1, BB_MEM(layout->buffers[0]),
                     BB_MEM(layout->buffers[1]), BB_VALUE(layout->root), BB_VALUE(layout->ends),
                     BB_VALUE(layout->scale), BB_MEM(on_device->rays), BB_VALUE(count),
                     BB_VALUE(prim_bytes), BB_VALUE(width), BB_MEM(on_device->sums)));
    return bb_buffer_read(&on_device->sums, 0, bytes, of_group);
}

static void add_group(group_sums of_group, bb_issued sums[BB_ISSUE_KINDS])
{
    for (uint32_t k = 0; k < BB_ISSUE_KINDS; k++) {
        sums[k].count += of_group[k][0];
        sums[k].lanes += of_group[k][1];
        sums[k].sectors += of_group[k][2];
        sums[k].lines += of_group[k][3];
    }
}

bb_status bb_lockstep_run(bb_device *device, const bb_lockstep_case *which,
                          const bb_traverser_request *request, const bb_layout_data *layout,
                          const bb_ray *rays, uint32_t count, uint32_t width,
                          bb_issued sums[BB_ISSUE_KINDS])
{
    const uint32_t groups = bb_divide_up(count, width);
    const uint32_t prim_bytes = bb_footing_of(request, layout).prim_bytes;
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    buffers on_device = {.rays = {.mem = NULL}};
    group_sums *of_group = calloc(groups, sizeof *of_group);
    bb_status status = of_group != NULL ? build(device, which, request, layout, &program)
                                        : bb_fail(BB_REFUSED, "no memory for sums of groups");
    if (status == BB_OK)
        status = bb_kernel_get(program, "lockstep", &kernel);
    if (status == BB_OK)
        status =
            launch(device, kernel, layout, prim_bytes, rays, count, width, &on_device, of_group);
    memset(sums, 0, BB_ISSUE_KINDS * sizeof *sums);
    for (uint32_t g = 0; g < groups && status == BB_OK; g++)
        add_group(of_group[g], sums);
    bb_buffer_release(&on_device.rays);
    bb_buffer_release(&on_device.sums);
    bb_kernel_release(kernel);
    bb_program_release(program);
    free(of_group);
    return status;
}

uint32_t bb_lockstep_differs(const bb_issued *replayed, const bb_issued *reference)
{
    uint32_t k = 0;
    while (k < BB_ISSUE_KINDS && replayed[k].count == reference[k].count &&
           replayed[k].lanes == reference[k].lanes && replayed[k].sectors == reference[k].sectors &&
           replayed[k].lines == reference[k].lines)
        k++;
    return k;
}
