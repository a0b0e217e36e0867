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
#include "framework/workload/workload.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S", "file, shipped or procedural scene", false},
    {"builder", "B", "default: the usual one, which takes all kinds of primitives", false},
    {"kernel", "K", "default: the first in `list kernels` without a limit of leaf=", false},
    {"intersector", "I", "default: exact", false},
    {"show", "P", "depth, normal, heat (tests per ray) or diff (wrong rays); default: normal",
     false},
    {"view", "V", "view of the scene; default: the first", false},
    {"camera", "V", NULL, false},
    {"size", "WxH", "image size, to which heat and diff add a legend; default: 512x512", false},
    BB_DEVICE_OPTION,
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first", false},
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"out", "FILE", "FILE.png: a picture; FILE.exr: the numbers behind it", false},
    {.name = NULL},
};

typedef struct rendering {
    const char *show, *view; /* which picture; NULL: the scene's first view */
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

/* `whole` has room for a specification. */
static bb_status choose_builder(const bb_cli *cli, char *whole, size_t capacity)
{
    const char *given = bb_cli_value(cli, "builder");
    if (given != NULL) {
        snprintf(whole, capacity, "%s", given);
        return bb_instance_check(given);
    }
    const bb_builder *usual = bb_usual_builder(BB_ALL_KINDS);
    if (usual == NULL)
        return bb_fail(BB_INVALID, "`run` compares no builder by default: give --builder");
    snprintf(whole, capacity, "%s", usual->name);
    return BB_OK;
}

static bb_status choose_kernel(const bb_cli *cli, rendering *r)
{
    const char *kernel = bb_cli_value(cli, "kernel");
    BB_TRY(bb_kernel_parse(kernel != NULL ? kernel : bb_kernel_for_any_leaf()->name,
                           &r->kernel_spec, &r->kernel));
    const char *intersector = bb_cli_value(cli, "intersector");
    return bb_intersector_parse(intersector != NULL ? intersector : bb_intersectors[0].name,
                                &r->intersector);
}

static bool is_picture(const char *word)
{
    return strcmp(word, "depth") == 0 || strcmp(word, "normal") == 0 || strcmp(word, "heat") == 0 ||
           strcmp(word, "diff") == 0;
}

/* What is shown, and from where. Once --view said what, and --camera from where. */
static bb_status choose_picture(const bb_cli *cli, rendering *r)
{
    r->show = bb_cli_value(cli, "show");
    r->view = bb_cli_value(cli, "view");
    if (r->show == NULL && r->view != NULL && is_picture(r->view)) {
        r->show = r->view;
        r->view = NULL;
    }
    if (r->view == NULL)
        r->view = bb_cli_value(cli, "camera");
    if (r->show == NULL)
        r->show = "normal";
    if (!is_picture(r->show))
        return bb_fail(BB_INVALID, "--show is '%s', must be depth, normal, heat or diff", r->show);
    return BB_OK;
}

static bb_status make_rays(rendering *r, const bb_cli *cli)
{
    uint32_t width = 512, height = 512;
    bb_spec spec;
    const bb_view *view = NULL;
    BB_TRY(bb_cli_size(cli, "size", &width, &height));
    BB_TRY(bb_choose_view(r->scene, r->view, &view));
    BB_TRY(bb_spec_parse("primary", &spec));
    bb_rays_request request = {&spec, view, width, height, width * height, 1};
    BB_TRY(bb_rays_make(r->scene, r->oracle, &request, &r->rays));
    return bb_rays_upload(r->rays, r->device);
}

static bb_status make_layout(rendering *r, const char *builder)
{
    uint64_t leaf;
    BB_TRY(bb_instance_create(r->device, builder, r->scene, 1, &r->instance));
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
    bb_tracer *tracer;
    bb_tracer_request request = {
        .kernel = r->kernel,
        .spec = &r->kernel_spec,
        .intersector = &r->intersector,
        .query = &bb_query_closest,
        .counting = true,
    };
    BB_TRY(bb_tracer_get(r->device, &request, &r->layout, &tracer));
    BB_TRY(bb_buffer_reserve(r->device, &r->account, count * sizeof(bb_hit), "hits", &r->d_hits));
    BB_TRY(bb_buffer_reserve(r->device, &r->account, count * sizeof(bb_count), "counts",
                             &r->d_counts));
    BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_hit), "hits", &r->hits));
    BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_count), "counts", &r->counts));
    const bb_pass pass = {.query = &bb_query_closest,
                          .tracer = tracer,
                          .layout = &r->layout,
                          .rays = &r->rays->on_device,
                          .results = &r->d_hits,
                          .counts = &r->d_counts};
    return bb_pass_run(&pass, count, r->hits, r->counts);
}

static bb_status shade_heat(rendering *r)
{
    bb_heat_map heat;
    BB_TRY(bb_picture_heat(r->rays, r->counts, &r->canvas, &heat));
    printf(
        "tests per ray: %.1f boxes and %.1f primitives on average, %.0f at most; colours from 0 to "
        "%.0f\n",
        heat.boxes, heat.prims, heat.most, heat.top);
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
    if (strcmp(r->show, "heat") == 0)
        return shade_heat(r);
    if (strcmp(r->show, "diff") == 0)
        return shade_diff(r);
    BB_TRY(bb_canvas_create(r->rays->width, r->rays->height, &r->canvas));
    if (strcmp(r->show, "depth") == 0)
        return bb_picture_depth(r->rays, r->hits, r->canvas.rgb);
    bb_picture_normals(r->scene, r->rays, r->hits, r->canvas.rgb);
    return BB_OK;
}

/* A miss has depth 0 here, so that it is a number that can be compared. */
static bb_status write_depth_differences(rendering *r, const char *out)
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
    return bb_exr_write(out, differences, "Y", width, height);
}

/* EXR: not the picture, but what it was made of. */
static bb_status write_values(rendering *r, const char *out)
{
    const uint32_t width = r->rays->width, height = r->rays->height;
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)r->rays->count * sizeof(float), "values", &r->values));
    if (strcmp(r->show, "diff") == 0)
        return write_depth_differences(r, out);
    if (strcmp(r->show, "depth") == 0) {
        bb_values_depth(r->rays, r->hits, INFINITY, r->values);
        return bb_exr_write(out, r->values, "Z", width, height);
    }
    if (strcmp(r->show, "heat") == 0) {
        bb_values_tests(r->rays, r->counts, r->values);
        return bb_exr_write(out, r->values, "Y", width, height);
    }
    bb_values_normals(r->scene, r->rays, r->hits, r->values);
    return bb_exr_write(out, r->values, "RGB", width, height);
}

static bb_status write_out(rendering *r, const char *out)
{
    if (bb_image_is_exr(out))
        return write_values(r, out);
    return bb_image_write(out, r->canvas.rgb, r->canvas.width, r->canvas.height);
}

static void release(rendering *r)
{
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
        bb_tracers_clear(r->device);
    bb_device_close(r->device);
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    (void)exit_status;
    static rendering r; /* an instance must not move */
    memset(&r, 0, sizeof r);
    char builder[sizeof r.instance.pipeline.text];
    const char *scene = bb_cli_value(cli, "scene"), *out = bb_cli_value(cli, "out");
    if (scene == NULL || out == NULL)
        return bb_fail(BB_INVALID, "render needs --scene and --out: see `bvhbench render --help`");
    BB_TRY(choose_picture(cli, &r));
    BB_TRY(bb_check_scene(scene));
    BB_TRY(bb_image_check(out));
    BB_TRY(bb_out_file(out, "picture"));
    BB_TRY(bb_load_plugins(cli));
    BB_TRY(choose_builder(cli, builder, sizeof builder));
    BB_TRY(choose_kernel(cli, &r));
    bb_status status = bb_open_device(cli, &r.device);
    if (status == BB_OK)
        status = bb_scene_load(scene, &r.scene);
    if (status == BB_OK)
        status = bb_scene_upload(r.scene, r.device);
    if (status == BB_OK)
        status = bb_oracle_create(r.scene, bb_host_threads(r.device), &r.oracle);
    if (status == BB_OK)
        status = make_rays(&r, cli);
    if (status == BB_OK)
        status = make_layout(&r, builder);
    if (status == BB_OK)
        status = trace(&r);
    if (status == BB_OK)
        status = shade(&r);
    if (status == BB_OK)
        status = write_out(&r, out);
    release(&r);
    return status;
}

extern const bb_command bb_command_render;
const bb_command bb_command_render = {
    .name = "render",
    .summary = "make a picture of a view: depth, normals, tests per ray, or wrong rays",
    .details =
        "heat: box and primitive tests per ray, counted by a variant of the kernel, on a map of\n"
        "even lightness (OKLab) whose range covers 99.9 % of the rays.\n"
        "diff: the answers, judged as in `run`; try --intersector fast for wrong ones.\n"
        "EXR files hold 32-bit floats and no legend: distance t in Z (infinite for a miss), unit\n"
        "normals in R, G, B, number of tests in Y, and for diff the depth error in Y (against\n"
        "the oracle's depth; a miss has depth 0).",
    .options = options,
    .run = run,
};
