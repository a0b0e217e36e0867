/* bvhbench render: one picture of a view, traced by a builder's tree and a kernel. */
#include "framework/builder/instance.h"
#include "framework/builder/pipeline.h"
#include "framework/cli/choice.h"
#include "framework/cli/out_option.h"
#include "framework/device/device_private.h"
#include "framework/judge/judge.h"
#include "framework/judge/queries.h"
#include "framework/picture/exr.h"
#include "framework/picture/image.h"
#include "framework/picture/picture.h"
#include "framework/simulate/divergence.h"
#include "framework/simulate/trace_steps.h"
#include "framework/simulate/warp.h"
#include "framework/workload/workload.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdio.h>

typedef struct rendering {
    bb_device_choice choice;
    const char *scene_name, *builder, *kernel_text, *intersector_text, *view, *out;
    uint32_t show; /* a word of --show */
    uint32_t lanes;
    uint32_t width, height;
    bb_device *device;
    bb_scene *scene;
    bb_oracle *oracle;
    bb_rays *rays;
    bb_instance instance;
    bb_account account;
    const bb_kernel *kernel;
    bb_spec kernel_spec;
    bb_intersector intersector;
    bb_layout_maker maker;
    bb_layout_data layout;
    bb_buffer d_hits, d_counts;
    bb_hit *hits;
    bb_count *counts;
    bb_canvas canvas;
    bb_answers answers; /* of diff */
    float *values;
} rendering;

enum { DEPTH, NORMAL, HEAT, DIVERGENCE, DIFF };

static const bb_cli_option options[] = {
    {"scene", "S", "file, shipped or procedural scene", BB_INTO(rendering, scene_name),
     .needed = true},
    {"builder", "B", "builder; default: the usual one, which takes all kinds of primitives",
     BB_INTO(rendering, builder)},
    {"kernel", "K",
     "kernel; default: the first in `list kernels` that does not limit leaf=, and that --show can "
     "show",
     BB_INTO(rendering, kernel_text)},
    {"intersector", "I", "intersection tests: see `list intersectors`",
     BB_INTO(rendering, intersector_text), .fallback = "exact"},
    {"show", NULL, "heat: tests per ray; divergence: steps that a ray waits; diff: wrong rays",
     BB_INTO(rendering, show), .words = "depth|normal|heat|divergence|diff", .fallback = "normal"},
    {"lanes", "N", "divergence: rays in lockstep, which follow each other in a row",
     BB_INTO(rendering, lanes), .low = 1, .high = BB_WARP_MOST, .fallback = "32"},
    {"view", "V", "view of the scene; default: the first", BB_INTO(rendering, view)},
    {"size", "WxH", "image size, to which heat, divergence and diff add a legend",
     BB_INTO_SIZE(rendering, width), .fallback = "512x512"},
    BB_GROUP(bb_device_options, rendering, choice),
    {"out", "FILE", "FILE.png: a picture; FILE.exr: the numbers behind it", BB_INTO(rendering, out),
     .needed = true},
    {.name = NULL},
};

static bb_status choose_builder(rendering *r)
{
    const bb_builder *usual = bb_usual_builder(BB_ALL_KINDS);
    if (r->builder != NULL)
        return bb_instance_check(r->builder);
    if (usual == NULL)
        return bb_fail(BB_INVALID, "`run` compares no builder by default: give --builder");
    r->builder = usual->name;
    return BB_OK;
}

static bb_status choose_kernel(rendering *r)
{
    const bb_kernel *usual = bb_kernel_for_any_leaf(r->show == DIVERGENCE);
    BB_TRY(bb_kernel_parse(r->kernel_text != NULL ? r->kernel_text : usual->name, &r->kernel_spec,
                           &r->kernel));
    return bb_intersector_parse(r->intersector_text, &r->intersector);
}

static bb_status make_rays(rendering *r)
{
    bb_spec spec;
    const bb_view *view = NULL;
    BB_TRY(bb_choose_view(r->scene, r->view, &view));
    BB_TRY(bb_spec_parse("primary", &spec));
    bb_rays_request request = {&spec, view, r->width, r->height, r->width * r->height, 1};
    BB_TRY(bb_rays_make(r->scene, r->oracle, &request, &r->rays));
    return bb_rays_upload(r->rays, r->device);
}

static bb_status make_layout(rendering *r)
{
    uint64_t leaf;
    BB_TRY(bb_instance_create(r->device, r->builder, r->scene, 1, &r->instance));
    BB_TRY(bb_instance_build(&r->instance, r->scene, false, NULL));
    BB_TRY(bb_tree_upload(&r->instance.tree, r->device, NULL));
    BB_TRY(bb_spec_u64(&r->kernel_spec, bb_kernel_common_options, "leaf", 1, 64, &leaf));
    BB_TRY(bb_layout_maker_create(bb_layout_find(r->kernel->layout), r->device, &r->maker));
    r->maker.wish = bb_kernel_wish(&r->kernel_spec);
    return bb_layout_maker_make(&r->maker, r->scene, &r->instance.tree, (uint32_t)leaf,
                                bb_intersector_format(&r->intersector), &r->layout);
}

static bb_status trace(rendering *r)
{
    uint32_t count = r->rays->count;
    bb_traverser *traverser;
    bb_traverser_request request = {
        .kernel = r->kernel,
        .spec = &r->kernel_spec,
        .intersector = &r->intersector,
        .query = &bb_query_closest,
        .counting = true,
    };
    BB_TRY(bb_traverser_get(r->device, &request, &r->layout, &traverser));
    BB_TRY(bb_buffer_reserve(r->device, &r->account, count * sizeof(bb_hit), "hits", &r->d_hits));
    BB_TRY(bb_buffer_reserve(r->device, &r->account, count * sizeof(bb_count), "counts",
                             &r->d_counts));
    BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_hit), "hits", &r->hits));
    BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_count), "counts", &r->counts));
    const bb_pass pass = {.query = &bb_query_closest,
                          .traverser = traverser,
                          .layout = &r->layout,
                          .rays = &r->rays->on_device,
                          .results = &r->d_hits,
                          .counts = &r->d_counts};
    return bb_pass_run(&pass, count, r->hits, r->counts);
}

static bb_status shade_heat(rendering *r)
{
    static const bb_heat_words words = {"tests per ray", "boxes", "primitives"};
    bb_heat_map heat;
    BB_TRY(bb_picture_heat(r->rays, r->counts, &words, &r->canvas, &heat));
    printf(
        "tests per ray: %.1f boxes and %.1f primitives on average, %.0f at most; colours from 0 to "
        "%.0f\n",
        heat.boxes, heat.prims, heat.most, heat.top);
    return BB_OK;
}

/* Puts what each ray waits for in the place of its tests. */
static bb_status find_divergence(rendering *r)
{
    const bb_traverser_request request = {.kernel = r->kernel,
                                          .spec = &r->kernel_spec,
                                          .intersector = &r->intersector,
                                          .query = &bb_query_closest};
    const bb_footing footing = bb_footing_of(&request, &r->layout);
    if (r->lanes % footing.packet != 0)
        return bb_fail(BB_INVALID, "--lanes must be a multiple of %u, the rays of a packet of %s",
                       footing.packet, r->kernel_spec.text);
    bb_steps steps;
    BB_TRY(bb_trace_steps(r->device, &request, &r->layout, r->rays->rays, r->rays->count,
                          BB_SAMPLE_ALL, &steps));
    bb_divergence(&steps, &footing, r->lanes, r->counts);
    bb_steps_release(&steps);
    return BB_OK;
}

static bb_status shade_divergence(rendering *r)
{
    static const bb_heat_words words = {"steps waited", "nodes", "primitives"};
    bb_heat_map heat;
    BB_TRY(bb_picture_heat(r->rays, r->counts, &words, &r->canvas, &heat));
    printf("steps that a ray waits, in lockstep with %u of its row: %.1f at nodes and %.1f at "
           "primitives on average, %.0f at most; colours from 0 to %.0f\n",
           r->lanes, heat.boxes, heat.prims, heat.most, heat.top);
    return BB_OK;
}

static bb_status shade_diff(rendering *r)
{
    bb_accuracy a;
    uint8_t *classes = NULL;
    bb_status status = bb_host_alloc(NULL, r->rays->count, "classes", &classes);
    if (status == BB_OK)
        status = bb_answers_make(r->oracle, r->rays, &r->answers);
    if (status == BB_OK)
        status = bb_judge(
            r->oracle, &r->answers,
            &(bb_verdict_request){.results = r->hits, .count = r->rays->count, .classes = classes},
            &a);
    if (status == BB_OK)
        status = bb_picture_diff(r->scene, r->rays, r->hits, classes, &a, &r->canvas);
    if (status == BB_OK)
        printf("%llu rays: %llu missed, %llu false, %llu wrong t, %llu ties\n",
               (unsigned long long)a.checked, (unsigned long long)a.missed,
               (unsigned long long)a.false_hits, (unsigned long long)a.wrong_t,
               (unsigned long long)a.ties);
    bb_host_free(classes);
    return status;
}

static bb_status shade(rendering *r)
{
    if (r->show == HEAT)
        return shade_heat(r);
    if (r->show == DIVERGENCE)
        return shade_divergence(r);
    if (r->show == DIFF)
        return shade_diff(r);
    BB_TRY(bb_canvas_create(r->rays->width, r->rays->height, &r->canvas));
    if (r->show == DEPTH)
        return bb_picture_depth(r->rays, r->hits, r->canvas.rgb);
    bb_picture_normals(r->scene, r->rays, r->hits, r->canvas.rgb);
    return BB_OK;
}

/* A miss has depth 0 here, so that it is a number that can be compared. */
static bb_status write_depth_differences(rendering *r)
{
    const size_t count = r->rays->count;
    const uint32_t width = r->rays->width, height = r->rays->height;
    float *depth = r->values, *expected = depth + count, *differences = expected + count;
    bb_values_depth(r->rays, r->hits, 0, depth);
    bb_values_depth(r->rays, r->answers.hits, 0, expected);
    for (size_t i = 0; i < count; i++)
        depth[i] = isfinite(depth[i]) ? depth[i] : 0; /* of a kernel that is quite wrong */
    bb_exr_difference found;
    BB_TRY(bb_exr_differences(depth, expected, 1, width, height, differences, &found));
    printf("depth beside the oracle's: %llu pixels differ, by %g on average, by %g at most, at "
           "%u,%u\n",
           (unsigned long long)found.pixels, found.mean, found.most, found.x, found.y);
    return bb_exr_write(r->out, differences, "Y", width, height);
}

/* EXR: not the picture, but what it was made of. */
static bb_status write_values(rendering *r)
{
    const uint32_t width = r->rays->width, height = r->rays->height;
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)r->rays->count * sizeof(float), "values", &r->values));
    if (r->show == DIFF)
        return write_depth_differences(r);
    if (r->show == DEPTH) {
        bb_values_depth(r->rays, r->hits, INFINITY, r->values);
        return bb_exr_write(r->out, r->values, "Z", width, height);
    }
    if (r->show == HEAT || r->show == DIVERGENCE) {
        bb_values_tests(r->rays, r->counts, r->values);
        return bb_exr_write(r->out, r->values, "Y", width, height);
    }
    bb_values_normals(r->scene, r->rays, r->hits, r->values);
    return bb_exr_write(r->out, r->values, "RGB", width, height);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    (void)cli;
    (void)exit_status;
    rendering *r = values;
    BB_TRY(bb_check_scene(r->scene_name));
    BB_TRY(bb_image_check(r->out));
    BB_TRY(bb_out_file(r->out, "picture"));
    BB_TRY(bb_load_plugins(&r->choice.plugins));
    BB_TRY(choose_builder(r));
    BB_TRY(choose_kernel(r));
    BB_TRY(bb_open_device(&r->choice, &r->device));
    BB_TRY(bb_scene_load(r->scene_name, &r->scene));
    BB_TRY(bb_scene_upload(r->scene, r->device));
    BB_TRY(bb_oracle_create(r->scene, bb_host_threads(r->device), &r->oracle));
    BB_TRY(make_rays(r));
    BB_TRY(make_layout(r));
    BB_TRY(trace(r));
    if (r->show == DIVERGENCE)
        BB_TRY(find_divergence(r));
    BB_TRY(shade(r));
    return bb_image_is_exr(r->out)
               ? write_values(r)
               : bb_image_write(r->out, r->canvas.rgb, r->canvas.width, r->canvas.height);
}

static void release(void *values)
{
    rendering *r = values;
    bb_layout_data_release(&r->layout);
    bb_layout_maker_destroy(&r->maker);
    bb_instance_destroy(&r->instance);
    bb_buffer_release(&r->d_hits);
    bb_buffer_release(&r->d_counts);
    bb_host_free(r->hits);
    bb_host_free(r->counts);
    bb_host_free(r->values);
    bb_answers_release(&r->answers);
    bb_canvas_free(&r->canvas);
    bb_rays_free(r->rays);
    bb_oracle_destroy(r->oracle);
    bb_scene_free(r->scene);
    if (r->device != NULL)
        bb_traversers_clear(r->device);
    bb_device_close(r->device);
}

extern const bb_command bb_command_render;
const bb_command bb_command_render = {
    .name = "render",
    .summary = "make a picture of a view: depth, normals, tests per ray, divergence, wrong rays",
    .details =
        "heat: box and primitive tests per ray, counted by a variant of the kernel, on a map of\n"
        "even lightness (OKLab) whose range covers 99.9 % of the rays.\n"
        "divergence: a GPU traces --lanes rays in lockstep, and a ray waits while others of them\n"
        "take a step at a node or a primitive; the same map of these steps, simulated.\n"
        "diff: the answers, judged as in `run`; try --intersector fast for wrong ones.\n"
        "EXR files hold 32-bit floats and no legend: distance t in Z (infinite for a miss), unit\n"
        "normals in R, G, B, number of tests or steps in Y, and for diff the depth error in Y\n"
        "(against the oracle's depth; a miss has depth 0).",
    .options = options,
    .bytes = sizeof(rendering),
    .run = run,
    .release = release,
};
