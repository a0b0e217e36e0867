/* Traces of the first and the last frame on GPUs on paper: of a tree that was built, and of what
 * all updates have made of it. */
#include "framework/simulate/trace_steps.h"
#include "framework/tasks/animate_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t place_of(const bb_animate_result *r, uint32_t frame, uint32_t kernel, uint32_t rays,
                       uint32_t simulation)
{
    const size_t last = frame > 0;
    return ((last * r->kernel_count + kernel) * r->ray_count + rays) * r->simulation_count +
           simulation;
}

const bb_simulation *bb_animate_simulation(const bb_animate_result *r,
                                           const bb_animate_method *method, uint32_t frame,
                                           uint32_t kernel, uint32_t rays, uint32_t simulation)
{
    if (method->simulations == NULL || (frame > 0 && frame + 1 < r->frame_count))
        return NULL;
    const bb_simulation *s = &method->simulations[place_of(r, frame, kernel, rays, simulation)];
    return s->traffic.rays > 0 ? s : NULL;
}

bb_status bb_animate_room_for_simulations(const bb_animate *a, bb_animate_method *method)
{
    const bb_animate_result *r = a->result;
    const size_t bytes = place_of(r, 1, r->kernel_count, 0, 0) * sizeof *method->simulations;
    if (bytes == 0)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, bytes, "simulations", &method->simulations));
    memset(method->simulations, 0, bytes);
    return BB_OK;
}

/* Simulates a set of rays in a layout in preorder, whose addresses are the same on all machines. */
static bb_status simulate_set(const bb_animate *a, const bb_traverser_request *request,
                              const bb_layout_data *layout, const bb_rays *rays,
                              bb_simulation *simulations)
{
    const bb_animate_request *r = a->request;
    bb_steps steps;
    BB_TRY(bb_trace_steps(a->device, request, layout, rays->rays, rays->count, BB_SIMT_SAMPLE,
                          &steps));
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < r->simt_count && status == BB_OK; i++)
        status = bb_simulate(&r->simts[i], request, layout, &steps, &simulations[i]);
    bb_steps_release(&steps);
    return status;
}

/* Makes the kernel's layout for simulations. It does not follow from frame to frame, as those do
 * that are timed: an update may number its tree by which thread came first. */
static bb_status make_layout(const bb_animate *a, bb_animate_runner *runner, uint32_t k)
{
    bb_layout_maker *maker = &runner->simulated_makers[k];
    if (maker->layout == NULL) {
        BB_TRY(bb_layout_maker_create(bb_layout_find(a->kernels[k]->layout), a->device, maker));
        maker->wish = bb_kernel_wish(&a->kernel_specs[k]);
        maker->wish.preorder = true;
    }
    return bb_layout_maker_make(maker, a->scene, &runner->instance.tree, a->leaves[k],
                                bb_intersector_format(&a->intersector),
                                &runner->simulated_layouts[k]);
}

static bb_status simulate_kernel(bb_animate *a, bb_animate_runner *runner, uint32_t index,
                                 uint32_t k)
{
    if (a->kernels[k]->control == BB_CONTROL_UNKNOWN)
        return bb_fail(BB_UNSUPPORTED, "the steps of kernel %s are not recorded",
                       a->result->kernels[k]);
    BB_TRY(make_layout(a, runner, k));
    for (uint32_t set = 0; set < a->request->ray_count; set++) {
        const bb_rays *rays = a->rays[index].sets[set];
        if (rays == NULL)
            continue;
        const bb_traverser_request request = bb_animate_traverser(a, k, rays);
        BB_TRY(simulate_set(a, &request, &runner->simulated_layouts[k], rays,
                            &runner->method->simulations[place_of(a->result, index, k, set, 0)]));
    }
    return BB_OK;
}

bb_status bb_animate_simulate(bb_animate *a, bb_animate_runner *runner, uint32_t index)
{
    bb_animate_method *method = runner->method;
    if (a->request->simt_count == 0 || (index > 0 && index + 1 < a->frames) ||
        runner->instance.tree.info.node_count == 1)
        return BB_OK;
    for (uint32_t k = 0; k < a->request->kernel_count; k++) {
        if (method->unsimulated[k][0] != '\0')
            continue;
        if (simulate_kernel(a, runner, index, k) != BB_OK)
            snprintf(method->unsimulated[k], sizeof method->unsimulated[k], "%s", bb_message());
    }
    return BB_OK;
}
