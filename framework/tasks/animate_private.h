/* What the parts of an animation share: animate.c, animate_frame.c, animate_strip.c,
 * animate_method.c, animate_simulate.c. */
#ifndef BB_ANIMATE_PRIVATE_H
#define BB_ANIMATE_PRIVATE_H

#include "framework/bench/count.h"
#include "framework/judge/judge.h"
#include "framework/picture/picture.h"
#include "framework/tasks/animate.h"
#include "framework/workload/workload.h"

/* The rays of a frame, which all rounds trace. */
typedef struct bb_animate_rays {
    bb_rays *sets[BB_ANIMATE_RAYS_MAX]; /* NULL: none */
} bb_animate_rays;

/* A method at work. It must not move: instance and makers have accounts in them. */
typedef struct bb_animate_runner {
    bb_animate_method *method;
    bb_instance instance;
    bb_layout_maker makers[BB_ANIMATE_KERNELS_MAX];
    bb_layout_data layouts[BB_ANIMATE_KERNELS_MAX];
    /* for simulations, in preorder */
    bb_layout_maker simulated_makers[BB_ANIMATE_KERNELS_MAX];
    bb_layout_data simulated_layouts[BB_ANIMATE_KERNELS_MAX];
    bb_traverser *traversers[BB_ANIMATE_KERNELS_MAX][BB_ANIMATE_RAYS_MAX]; /* the last */
    uint64_t *hashes; /* of answers in the first round: frames * kernels * sets */
} bb_animate_runner;

typedef struct bb_animate {
    const bb_animate_request *request;
    bb_device *device;
    bb_scene *scene;
    bb_animate_result *result;
    uint32_t frames;
    const bb_kernel *kernels[BB_ANIMATE_KERNELS_MAX];
    bb_spec kernel_specs[BB_ANIMATE_KERNELS_MAX];
    uint32_t leaves[BB_ANIMATE_KERNELS_MAX];
    bb_intersector intersector;
    bb_spec ray_specs[BB_ANIMATE_RAYS_MAX];
    const bb_workload *workloads[BB_ANIMATE_RAYS_MAX];
    const bb_view *view;
    bb_animate_rays *rays; /* of each frame */
    bb_animate_runner *runners;
    bb_instance yardsticks[BB_ANIMATE_YARDSTICKS_MAX];
    /* of the frame at hand, in the first round */
    bb_oracle *oracle;
    bb_answers answers[BB_ANIMATE_RAYS_MAX];
    bb_box *before; /* boxes of the frame before, in the first round */
    uint32_t before_count;
    bb_buffer d_rays, d_answers;
    bb_counter counter;
    uint32_t counted; /* rays that the counter has room for */
    char *results;
    size_t result_bytes;
} bb_animate;

/* ---- animate_frame.c ---- */

/* Oracle, rays, answers and SAHs to compare with, of the frame that the scene is at. */
bb_status bb_animate_judge_frame(bb_animate *a, uint32_t index);
/* Releases what only the first round needs. */
void bb_animate_leave_frame(bb_animate *a);
/* Puts rays of a frame on the device, with room for their answers. */
bb_status bb_animate_load_rays(bb_animate *a, const bb_rays *rays);

/* ---- animate_strip.c ---- */

/* Draws the frame into the strip, if it was asked for and the frame is one of those in it. */
bb_status bb_animate_draw_frame(bb_animate *a, uint32_t index);

/* ---- animate_method.c ---- */

bb_status bb_animate_runner_create(bb_animate *a, const char *builder, bb_animate_runner *runner);
void bb_animate_runner_destroy(bb_animate *a, bb_animate_runner *runner);

/* One method in one frame of round `round`, 0 being the one in which it is judged. What the method
 * cannot do, or does wrong, is noted in it; other failures are returned. */
bb_status bb_animate_step(bb_animate *a, bb_animate_runner *runner, uint32_t index, uint32_t round,
                          uint32_t changed);
bb_traverser_request bb_animate_traverser(const bb_animate *a, uint32_t kernel,
                                          const bb_rays *rays);

/* ---- animate_simulate.c ---- */

bb_status bb_animate_room_for_simulations(const bb_animate *a, bb_animate_method *method);
/* Simulates the traces of a method's tree, if that was asked for and the frame is the first or the
 * last. What cannot be simulated is noted in the method. */
bb_status bb_animate_simulate(bb_animate *a, bb_animate_runner *runner, uint32_t index);

#endif
