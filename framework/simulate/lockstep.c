#include "framework/simulate/lockstep.h"

#include "framework/base/arithmetic.h"
#include "framework/base/random.h"
#include "framework/device/device_private.h"

#include <math.h>
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
    [BB_STEP_LEAF] = "leaf",     [BB_STEP_EXACT] = "exact",     [BB_STEP_FURTHER] = "further",
    [BB_ISSUE_BEGIN] = "begin",  [BB_ISSUE_END] = "end"};

void bb_lockstep_rays(const bb_scene *scene, uint64_t seed, bb_ray *rays, uint32_t count)
{
    bb_random random = bb_random_make(seed, scene->prim_count);
    const bb_box *box = &scene->bounds;
    for (uint32_t i = 0; i < count; i++) {
        rays[i] = (bb_ray){.tmax = i % 7 == 3 ? 0.5f : INFINITY};
        for (int k = 0; k < 3; k++) {
            const float size = box->hi[k] - box->lo[k];
            float from = box->lo[k] + 0.3f * size;
            float at = k == 0   ? box->lo[k] + size * (float)(i % 16) / 16
                       : k == 1 ? box->lo[k] + size * (float)(i / 16) / 16
                                : box->hi[k];
            if (i >= count / 2) {
                from = (float)bb_random_range(&random, box->lo[k], box->hi[k]);
                at = (float)bb_random_range(&random, box->lo[k], box->hi[k]);
            }
            rays[i].o[k] = from;
            rays[i].d[k] = at - from;
        }
        if (i == 41)
            rays[i].o[1] = INFINITY; /* packets leave it out */
    }
}

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

/* Of a group: steps, active lanes, sectors and lines of each kind. */
typedef cl_uint group_sums[BB_ISSUE_KINDS][4];

/* A reference at work. */
typedef struct reference {
    bb_device *device;
    cl_program program;
    cl_kernel kernel;
    bb_buffer rays, sums;
    group_sums *of_group; /* of the most groups */
    uint32_t count;       /* of rays */
} reference;

static bb_status prepare(reference *r, const bb_lockstep_case *which,
                         const bb_traverser_request *request, const bb_layout_data *layout,
                         const bb_ray *rays)
{
    const size_t bytes = r->count * sizeof *rays;
    BB_TRY(build(r->device, which, request, layout, &r->program));
    BB_TRY(bb_kernel_get(r->program, "lockstep", &r->kernel));
    BB_TRY(bb_buffer_reserve(r->device, NULL, bytes, "rays", &r->rays));
    BB_TRY(bb_buffer_write(&r->rays, 0, bytes, rays));
    return bb_buffer_reserve(r->device, NULL, r->count * sizeof *r->of_group, "sums", &r->sums);
}

static bb_status run_width(reference *r, const bb_layout_data *layout, uint32_t prim_bytes,
                           uint32_t width, bb_issued sums[BB_ISSUE_KINDS])
{
    const uint32_t groups = bb_divide_up(r->count, width);
    const size_t bytes = groups * sizeof *r->of_group;
    BB_TRY(bb_buffer_fill(&r->sums, bytes, 0));
    BB_TRY(bb_launch(r->device, r->kernel, groups, 1, BB_MEM(layout->buffers[0]),
                     BB_MEM(layout->buffers[1]), BB_VALUE(layout->root), BB_VALUE(layout->ends),
                     BB_VALUE(layout->scale), BB_MEM(r->rays), BB_VALUE(r->count),
                     BB_VALUE(prim_bytes), BB_VALUE(width), BB_MEM(r->sums)));
    BB_TRY(bb_buffer_read(&r->sums, 0, bytes, r->of_group));
    memset(sums, 0, BB_ISSUE_KINDS * sizeof *sums);
    for (uint32_t g = 0; g < groups; g++)
        for (uint32_t k = 0; k < BB_ISSUE_KINDS; k++) {
            sums[k].count += r->of_group[g][k][0];
            sums[k].lanes += r->of_group[g][k][1];
            sums[k].sectors += r->of_group[g][k][2];
            sums[k].lines += r->of_group[g][k][3];
        }
    return BB_OK;
}

bb_status bb_lockstep_run(bb_device *device, const bb_lockstep_case *which,
                          const bb_traverser_request *request, const bb_layout_data *layout,
                          const bb_ray *rays, uint32_t count,
                          bb_issued sums[BB_LOCKSTEP_WIDTHS][BB_ISSUE_KINDS])
{
    const uint32_t prim_bytes = bb_footing_of(request, layout).prim_bytes;
    reference r = {.device = device, .count = count};
    bb_status status = BB_OK;
    r.of_group = calloc(count, sizeof *r.of_group);
    if (r.of_group == NULL)
        status = bb_fail(BB_REFUSED, "no memory for sums of groups");
    if (status == BB_OK)
        status = prepare(&r, which, request, layout, rays);
    for (uint32_t w = 0; w < BB_LOCKSTEP_WIDTHS && status == BB_OK; w++)
        status = run_width(&r, layout, prim_bytes, 32u << w, sums[w]);
    bb_buffer_release(&r.rays);
    bb_buffer_release(&r.sums);
    bb_kernel_release(r.kernel);
    bb_program_release(r.program);
    free(r.of_group);
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
