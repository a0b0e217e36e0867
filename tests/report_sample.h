/* A result document with plausible figures and everything that a report must cope with: wrong
 * cells, rows without a result, figures that were not measured, text that looks like markup. Made
 * through the record's own functions.
 */
#ifndef BB_TEST_REPORT_SAMPLE_H
#define BB_TEST_REPORT_SAMPLE_H

#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/picture/image.h"
#include "framework/record/record.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A folder for this test's files; the tests run in parallel, hence one each. */
static inline const char *sample_folder(const char *test)
{
    static char folder[512];
    const char *base = getenv("BVHBENCH_TEST_DIR");
    snprintf(folder, sizeof folder, "%s", base != NULL ? base : "/tmp/bvhbench-tests");
    mkdir(folder, 0777);
    snprintf(folder, sizeof folder, "%s/%s", base != NULL ? base : "/tmp/bvhbench-tests", test);
    mkdir(folder, 0777);
    return folder;
}

static const bb_option sample_options[] = {
    {"bits", "30", "30|63", "length of a Morton code"},
    {"quality", "medium", "low|medium|high", "quality"},
    {"mode", "robust", "fast|robust", "mode"},
    {"seedless", NULL, NULL, "has no default"},
    {.name = NULL},
};

typedef struct sample_scene {
    const char *name;
    double prims, speed;
    int rounds; /* that count: enough for intervals, for a range, for neither */
} sample_scene;

static const sample_scene sample_scenes[] = {
    {"coffee", 1247000, 1.0, 6},
    {"interior:n=200000,seed=7", 200000, 1.6, 3},
    {"spheres:n=1000000,state=settled", 1000000, 0.7, 1},
};

typedef struct sample_builder {
    const char *spec;
    double mprims_s, rate, sah; /* rate: Mrays/s of primary rays, in proportion */
    bool reference;
} sample_builder;

static const sample_builder sample_builders[] = {
    {"sah", 1.1, 4.6, 61.2, false},
    {"embree:quality=low", 12.4, 3.2, 84.9, false},
    {"embree:quality=high", 2.1, 4.9, 58.0, false},
    {"lbvh:bits=30", 33.7, 2.7, 97.3, false},
    {"lbvh:bits=63", 21.2, 2.9, 92.8, false},
    {"embree-native:quality=medium,mode=robust", 3.9, 7.9, NAN, true},
    {"embree-native:quality=medium,mode=fast", 4.0, 8.6, NAN, true},
};

enum {
    SAMPLE_SCENES = sizeof sample_scenes / sizeof sample_scenes[0],
    SAMPLE_BUILDERS = sizeof sample_builders / sizeof sample_builders[0],
    SAMPLE_PER_SCENE = SAMPLE_BUILDERS + 1, /* one is refused */
};

typedef struct sample_rays {
    const char *name, *view;
    uint32_t count;
    double factor;
    const bb_query *query;
} sample_rays;

static const sample_rays sample_ray_sets[] = {
    {"primary", "front", 262144, 1.0, &bb_query_closest},
    {"primary", "corner", 262144, 0.9, &bb_query_closest},
    {"diffuse", "", 1048576, 0.45, &bb_query_closest},
    {"ao", "", 1048576, 1.3, &bb_query_any},
};

static inline bb_results *sample_check(bb_results *results, bb_status status)
{
    if (status != BB_OK) {
        fprintf(stderr, "sample: %s\n", bb_message());
        abort();
    }
    return results;
}

static inline void sample_add_scene(bb_results *results, const sample_scene *from, uint32_t index)
{
    bb_scene *scene = calloc(1, sizeof *scene);
    snprintf(scene->name, sizeof scene->name, "%s", from->name);
    snprintf(scene->source, sizeof scene->source, "generator");
    scene->kinds = index == 2 ? BB_SPHERES : BB_TRIANGLES;
    scene->prim_count = (uint32_t)from->prims;
    scene->prims[BB_TRIANGLE].count = index == 2 ? 0 : scene->prim_count;
    scene->prims[BB_SPHERE].count = index == 2 ? scene->prim_count : 0;
    for (int k = 0; k < 3; k++) {
        scene->bounds.lo[k] = -1.1f * (float)(k + 1);
        scene->bounds.hi[k] = 2.3f;
    }
    scene->hash = 0xF00DFACE12345678u + index;
    scene->view_count = 2;
    snprintf(scene->views[0].name, sizeof scene->views[0].name, "front");
    snprintf(scene->views[1].name, sizeof scene->views[1].name, "corner");
    scene->profile = (bb_profile){.flatness = 0.31,
                                  .size_min = 1e-5,
                                  .size_median = 0.0123,
                                  .size_max = 3.5,
                                  .overlap = 1.7,
                                  .closed = index == 2 ? -1 : 0,
                                  .code_bits = 63,
                                  .octree_depth = 17};
    scene->load_ms = 431.7;
    sample_check(results, bb_results_add_scene(results, scene, NULL));
    free(scene);
}

static inline void sample_fill(bb_samples *samples, double median, int rounds, bb_random *random)
{
    bb_samples_add(samples, median * 2.5);
    for (int i = 0; i < rounds; i++)
        bb_samples_add(samples, median * bb_random_range(random, 0.97, 1.04));
}

/* As if the builder were a pipeline. */
static inline void sample_add_stages(bb_build_record *build)
{
    static const char *const names[] = {"presplit", "embree", "map", "rotate"};
    build->step_count = 4;
    for (uint32_t i = 0; i < 4; i++) {
        snprintf(build->steps[i].name, sizeof build->steps[i].name, "%s", names[i]);
        bb_samples_add(&build->steps[i].ms, 1.5 + i);
        build->steps[i].sah = i % 2 == 1 ? 60 - i : (double)NAN;
        build->steps[i].bytes = i == 2 ? 0 : (i + 1) << 20;
        build->steps[i].bytes_peak = i == 2 ? 0 : (i + 3) << 20;
    }
}

static inline void sample_add_build(bb_results *results, const sample_scene *scene,
                                    const sample_builder *builder, uint32_t id, bb_random *random)
{
    bb_build_record build;
    bb_spec spec;
    bb_build_record_init(&build);
    sample_check(results, bb_spec_parse(builder->spec, &spec));
    snprintf(build.scene, sizeof build.scene, "%s", scene->name);
    build.spec = &spec;
    build.options = sample_options;
    build.reference = builder->reference;
    sample_fill(&build.build_ms, scene->prims / builder->mprims_s / 1e3, scene->rounds, random);
    if (builder->reference) {
        build.bytes_native = scene->prims * 121;
    } else {
        build.cold_ms = build.build_ms.values[0];
        strcpy(build.inputs, "boxes");
        build.boxes_ms = scene->prims * 1e-6;
        build.prepare_ms = 0.6;
        bb_samples_add(&build.restore_ms, 0.0);
        bb_samples_add(&build.transfer_ms, scene->prims * 2e-6);
        build.phase_count = 2;
        build.phases[0] = (bb_named_ms){"morton", 5.1};
        build.phases[1] = (bb_named_ms){"link", 22.9};
        build.layout_count = 2;
        strcpy(build.layouts[0].name, "pair");
        strcpy(build.layouts[1].name, "pair:leaf=4");
        for (int i = 0; i <= scene->rounds; i++) {
            bb_samples_add(&build.layouts[0].ms, scene->prims * 9e-6);
            bb_samples_add(&build.layouts[1].ms, scene->prims * 3e-5);
        }
        build.layouts[0].bytes = build.layouts[1].bytes = (uint64_t)scene->prims * 44;
        build.layouts[0].sah = builder->sah;
        build.layouts[1].sah = builder->sah * 0.93;
        if (strcmp(builder->spec, "embree:quality=high") == 0)
            sample_add_stages(&build);
        build.has_tree = true;
        build.tree = (bb_tree_info){
            0, (uint32_t)scene->prims * 2 - 1, (uint32_t)scene->prims, (uint32_t)scene->prims, 2,
            37};
        build.bytes_tree = (uint64_t)scene->prims * 68;
        build.bytes_peak = (uint64_t)scene->prims * 117;
        build.metrics[bb_metric_find("sah")].value = builder->sah;
        build.metrics[bb_metric_find("epo_quick")] =
            (bb_metric_value){builder->sah * (0.05 + 0.003 * (id % 8)), 0.02};
        if (id == 3)
            strcpy(build.about, "code: 30 bits, 10 per axis");
        if (id % 3 == 0)
            build.metrics[bb_metric_find("epo")].value = builder->sah * 0.06;
    }
    sample_check(results, bb_results_add_build(results, &build));
}

static inline void sample_add_refusal(bb_results *results, const sample_scene *scene)
{
    bb_build_record build;
    bb_spec spec;
    bb_build_record_init(&build);
    sample_check(results, bb_spec_parse("null", &spec));
    snprintf(build.scene, sizeof build.scene, "%s", scene->name);
    build.spec = &spec;
    build.status = BB_REFUSED;
    snprintf(
        build.reason, sizeof build.reason,
        "brute force would take 326 \"thousand million\" tests </script><b>, the limit is 10^9");
    sample_check(results, bb_results_add_build(results, &build));
}

/* Figures of a trace that only depend on whether the cell is exact, careless or a reference. */
static inline void sample_judge(bb_trace_record *trace, bool careless, bb_random *random)
{
    bb_accuracy *accuracy = &trace->accuracy;
    trace->has_accuracy = true;
    accuracy->checked = trace->count;
    if (careless) {
        accuracy->missed = 20 + bb_random_below(random, 400);
        accuracy->false_hits = bb_random_below(random, 9);
        accuracy->wrong_t = bb_random_below(random, 30);
        accuracy->first_wrong = 4711;
    }
    uint64_t wrong = accuracy->missed + accuracy->false_hits + accuracy->wrong_t;
    accuracy->right = accuracy->checked - wrong;
    accuracy->ties = 212;
    accuracy->wrong_ppm = (double)wrong * 1e6 / (double)accuracy->checked;
    accuracy->t_ulp_max = 3.5;
    accuracy->t_ulp_p99 = 1.5;
}

/* Rays as given keep the key that they get without this: another program made them. */
static inline void sample_name_cell(bb_trace_record *trace)
{
    bb_cell_parts cell = {.width = 256, .height = 256, .max_rays = 65536, .seed = 7};
    snprintf(cell.scene, sizeof cell.scene, "%s", trace->scene);
    snprintf(cell.rays, sizeof cell.rays, "%s", trace->rays);
    snprintf(cell.view, sizeof cell.view, "%s", trace->view);
    snprintf(cell.builder, sizeof cell.builder, "%s", trace->builder);
    if (!trace->reference) {
        snprintf(cell.kernel, sizeof cell.kernel, "%s", trace->kernel);
        snprintf(cell.intersector, sizeof cell.intersector, "%s", trace->intersector);
    }
    bb_cell_canonical(&cell);
    sample_check(NULL, bb_cell_key_format(&cell, trace->cell));
}

static inline void sample_add_trace(bb_results *results, const sample_scene *scene,
                                    const sample_builder *builder, uint32_t id,
                                    const sample_rays *rays, uint32_t variant, bb_random *random)
{
    bb_trace_record trace;
    bb_trace_record_init(&trace);
    trace.query = &bb_query_closest;
    bool careless = variant == 2 || (builder->reference && strstr(builder->spec, "fast") != NULL);
    snprintf(trace.scene, sizeof trace.scene, "%s", scene->name);
    snprintf(trace.view, sizeof trace.view, "%s", rays->view);
    snprintf(trace.builder, sizeof trace.builder, "%s", builder->spec);
    snprintf(trace.rays, sizeof trace.rays, "%s", rays->name);
    trace.rays_as_given = id / SAMPLE_PER_SCENE == 0 && strcmp(rays->name, "diffuse") == 0;
    trace.query = rays->query;
    trace.count = rays->count;
    trace.rays_hash = 0xABCDEF0123456789u + rays->count;
    trace.reference = builder->reference;
    if (builder->reference) {
        snprintf(trace.kernel, sizeof trace.kernel, "embree");
    } else {
        snprintf(trace.kernel, sizeof trace.kernel, variant == 1 ? "stack:leaf=4" : "stack");
        snprintf(trace.layout, sizeof trace.layout, variant == 1 ? "pair:leaf=4" : "pair");
        trace.native = variant != 1;
        snprintf(trace.intersector, sizeof trace.intersector, variant == 2 ? "moller" : "exact");
        trace.node_tests_per_ray = builder->sah * 0.55;
        trace.prim_tests_per_ray = builder->sah * (variant == 1 ? 0.12 : 0.07);
        trace.counted = 65536;
        trace.group_size = 64;
        trace.stack_size = 64;
        trace.counts_for_exit = variant != 2;
    }
    double rate = builder->rate * scene->speed * rays->factor * (variant == 1 ? 1.08 : 1.0) *
                  (variant == 2 ? 1.12 : 1.0) * bb_random_range(random, 0.95, 1.05);
    sample_fill(&trace.ms, rays->count / rate / 1e3, scene->rounds, random);
    sample_fill(&trace.event_ms, rays->count / rate / 1.01e3, scene->rounds, random);
    sample_fill(&trace.cpu_ms, rays->count / rate / 0.51e3, scene->rounds, random);
    sample_judge(&trace, careless, random);
    if (!trace.rays_as_given)
        sample_name_cell(&trace);
    trace.wrong = careless; /* above a limit of 0, as expected of these */
    if (variant == 0 && id == 1 && rays->query == &bb_query_any) {
        trace.accuracy.wrong_t = 3;
        trace.accuracy.wrong_ppm = 3e6 / rays->count;
        trace.wrong = true;
        trace.overflowed = 2;
    }
    sample_check(results, bb_results_add_trace(results, &trace));
}

static inline void sample_add_paper(bb_results *results)
{
    static const char *const headings[] = {"scene", "paper ms", "here ms"};
    static const bb_claim_record claims[] = {
        {"fewer steps", "held", "52 %", "claimed 0.52, here 0.310", "31 %", NULL, 1, NULL},
        {"builds as fast", "not held", NULL, NULL, NULL, "a 64-bit sort", 0, NULL},
        {"traces faster", "cannot be told: too few rounds", NULL, NULL, NULL, NULL, -1, NULL},
        {"on GPUs too", "direction only", NULL, NULL, NULL, NULL, -1, NULL},
    };
    static const struct {
        const char *scene;
        double numbers[2];
    } rows[] = {{"coffee", {1.25, 4.5}}, {"Sponza", {0.75, (double)NAN}}};
    const char *title = "Extended Morton codes </script><b>";
    sample_check(results, bb_results_add_paper(results, "emc", title));
    for (uint32_t i = 0; i < 3; i++)
        sample_check(results,
                     bb_results_print_heading(results, "emc", "Table 2", 1, i, headings[i]));
    for (uint32_t r = 0; r < 2; r++) {
        sample_check(results, bb_results_print_cell(results, "emc", "Table 2", 1, r, 0,
                                                    rows[r].scene, (double)NAN));
        for (uint32_t i = 0; i < 2; i++)
            sample_check(results, bb_results_print_cell(results, "emc", "Table 2", 1, r, i + 1,
                                                        NULL, rows[r].numbers[i]));
    }
    for (size_t i = 0; i < sizeof claims / sizeof claims[0]; i++)
        sample_check(results, bb_results_add_claim(results, "emc", &claims[i]));
}

/* The whole document; `folder` gets the pictures unless it is NULL. */
static inline bb_results *sample_results(const char *folder)
{
    static bb_device device; /* only its descriptions are read */
    snprintf(device.name, sizeof device.name, "pthread-sample CPU");
    snprintf(device.driver, sizeof device.driver, "3.1");
    snprintf(device.version, sizeof device.version, "OpenCL 3.0 PoCL HSTR: sample");
    snprintf(device.sources, sizeof device.sources, "embedded");
    device.litmus_pairs = 1000;
    device.compute_units = 2;
    device.float_config = CL_FP_INF_NAN | CL_FP_ROUND_TO_NEAREST | CL_FP_FMA;
    bb_results *results = NULL;
    bb_context context = {&device, 1234567890123456789u, "bvhbench run --scene coffee <&\"'>"};
    sample_check(NULL, bb_results_create(&context, &results));
    bb_random random = bb_random_make(5, 0);
    for (uint32_t s = 0; s < SAMPLE_SCENES; s++) {
        sample_add_scene(results, &sample_scenes[s], s);
        for (uint32_t b = 0; b < SAMPLE_BUILDERS; b++)
            sample_add_build(results, &sample_scenes[s], &sample_builders[b],
                             s * SAMPLE_PER_SCENE + b, &random);
        sample_add_refusal(results, &sample_scenes[s]);
        for (size_t r = 0; r < sizeof sample_ray_sets / sizeof sample_ray_sets[0]; r++)
            for (uint32_t b = 0; b < SAMPLE_BUILDERS; b++)
                for (uint32_t v = 0; v < (sample_builders[b].reference ? 1u : 3u); v++)
                    sample_add_trace(results, &sample_scenes[s], &sample_builders[b],
                                     s * SAMPLE_PER_SCENE + b, &sample_ray_sets[r], v, &random);
    }
    static const char *const steps[] = {"load", "rays", "oracle", "judge", "compile", "report"};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        sample_check(results, bb_results_add_step(results, steps[i], 320.5 * (double)(i + 1)));
    sample_check(results, bb_results_add_step(results, "oracle", 100));
    sample_check(results, bb_results_set_total(results, 2500, 21000.25, 31000));
    sample_check(results, bb_results_add_skipped(results, "coffee", "edges", "front",
                                                 "the mesh is not closed </script><b>"));
    sample_check(results, bb_results_add_skipped(results, "spheres:n=1000000,state=settled",
                                                 "edges", NULL, "spheres have no edges"));

    sample_add_paper(results);

    enum { SIDE = 160 };
    float *rgb = malloc(3 * SIDE * SIDE * sizeof *rgb);
    char path[600];
    for (int i = 0; i < SIDE * SIDE; i++)
        bb_colour_map(hypotf((float)(i % SIDE) / SIDE - 0.5f, (float)(i / SIDE) / SIDE - 0.4f) *
                          1.3f,
                      rgb + 3 * i);
    snprintf(path, sizeof path, "%s/heat.png", folder != NULL ? folder : ".");
    if (folder != NULL)
        sample_check(results, bb_image_write(path, rgb, SIDE, SIDE));
    free(rgb);
    sample_check(results, bb_results_add_picture(results, "coffee", "front", "box tests per ray",
                                                 "heat.png"));
    sample_check(results, bb_results_add_picture(results, "coffee", "corner", "box tests per ray",
                                                 "missing.png"));
    return results;
}

#endif
