#include "framework/conformance.h"

#include "traversal/traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETS_MAX = 3, BUILDS = 3 };

struct bb_conformance {
    bb_device *device;
    bb_scene *scene;
    bb_oracle *oracle;
    uint64_t seed;
    uint32_t set_count;
    bb_rays *rays[SETS_MAX];
    bb_answers answers[SETS_MAX];
    bb_account account;
    bb_buffer hits;
    bb_hit *host_hits;
};

/* Rays per set; a brute-force tree of a shipped scene gets fewer. */
static const uint32_t rays_per_set = 16384;
static const double brute_force_tests = 2e8;

static bb_status add_set(bb_conformance *c, const char *workload)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse(workload, &spec));
    const bb_workload *found = bb_workload_find(spec.name);
    bb_rays_request request = {
        .spec = &spec,
        .view = found->per_view ? &c->scene->views[0] : NULL,
        .width = 128,
        .height = 128,
        .max_rays = rays_per_set,
        .seed = c->seed,
    };
    bb_status status = bb_rays_make(c->scene, c->oracle, &request, &c->rays[c->set_count]);
    if (status == BB_UNSUPPORTED)
        return BB_OK; /* a scene that the views don't see: the other sets remain */
    BB_TRY(status);
    uint32_t i = c->set_count++;
    BB_TRY(bb_rays_upload(c->rays[i], c->device));
    return bb_answers_make(c->oracle, c->rays[i], &c->answers[i]);
}

bb_status bb_conformance_create(bb_device *device, bb_scene *scene, uint64_t seed,
                                bb_conformance **out)
{
    bb_conformance *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    c->device = device;
    c->scene = scene;
    c->seed = seed;
    bb_status status = bb_scene_upload(scene, device);
    if (status == BB_OK)
        status = bb_oracle_create(scene, bb_host_threads(device), &c->oracle);
    if (status == BB_OK)
        status = add_set(c, "primary");
    if (status == BB_OK)
        status = add_set(c, "ao");
    if (status == BB_OK)
        status = add_set(c, "random:near=0.5");
    if (status == BB_OK)
        status =
            bb_buffer_reserve(device, &c->account, rays_per_set * sizeof(bb_hit), "hits", &c->hits);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, rays_per_set * sizeof(bb_hit), "hits", &c->host_hits);
    if (status != BB_OK) {
        bb_conformance_destroy(c);
        return status;
    }
    *out = c;
    return BB_OK;
}

void bb_conformance_destroy(bb_conformance *c)
{
    if (c == NULL)
        return;
    for (uint32_t i = 0; i < c->set_count; i++) {
        bb_answers_release(&c->answers[i]);
        bb_rays_free(c->rays[i]);
    }
    bb_buffer_release(&c->hits);
    bb_host_free(c->host_hits);
    bb_oracle_destroy(c->oracle);
    bb_tracers_clear(c->device);
    free(c);
}

/* ---- the tree ---- */

static bb_status check_tree(bb_conformance *c, bb_instance *instance, uint64_t *hash)
{
    BB_TRY(bb_instance_build(instance, c->scene, false, NULL, NULL));
    BB_TRY(bb_tree_download(&instance->tree, NULL));
    BB_TRY(bb_tree_check(&instance->tree, c->scene));
    return bb_tree_hash(&instance->tree, hash);
}

/* ---- the answers ---- */

static bb_status check_set(bb_conformance *c, uint32_t set, const bb_kernel *kernel,
                           const bb_layout_data *layout, const bb_tree_info *tree)
{
    bb_rays *rays = c->rays[set];
    bb_spec spec;
    BB_TRY(bb_spec_parse(kernel->name, &spec));
    bb_tracer_request request = {
        .kernel = kernel,
        .spec = &spec,
        .intersector = &bb_intersectors[0],
        .query = rays->query,
        .kinds = c->scene->kinds,
        .stack_need = layout->stack_need,
        .levels = layout->levels,
    };
    if ((kernel->queries & 1u << rays->query) == 0)
        return BB_OK;
    uint32_t count = rays->count;
    if (tree->node_count == 1 && (double)tree->ref_count * count > brute_force_tests)
        count = 1 + (uint32_t)(brute_force_tests / tree->ref_count);
    bb_tracer *tracer;
    bb_accuracy accuracy;
    BB_TRY(bb_tracer_get(c->device, &request, &tracer));
    BB_TRY(bb_buffer_fill(&c->hits, count * sizeof(bb_hit), BB_POISON));
    BB_TRY(bb_tracer_launch(tracer, layout, &rays->on_device, count, &c->hits, NULL));
    BB_TRY(bb_buffer_read(&c->hits, 0, count * sizeof(bb_hit), c->host_hits));
    const bb_verdict_request wanted = {.hits = c->host_hits, .count = count};
    BB_TRY(bb_judge(c->oracle, &c->answers[set], &wanted, &accuracy));
    if (accuracy.wrong_ppm > 0)
        return bb_fail(BB_FAILED,
                       "kernel %s, %s rays: of %u rays %llu missed, %llu false, %llu wrong t; the "
                       "first is ray %u",
                       kernel->name, rays->name, count, (unsigned long long)accuracy.missed,
                       (unsigned long long)accuracy.false_hits,
                       (unsigned long long)accuracy.wrong_t, accuracy.first_wrong);
    return BB_OK;
}

static bb_status check_kernel(bb_conformance *c, bb_instance *instance, const bb_kernel *kernel)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bb_status status = bb_layout_maker_create(bb_layout_find(kernel->layout), c->device, &maker);
    if (status == BB_OK)
        status = bb_tree_upload(&instance->tree, c->device, NULL);
    if (status == BB_OK)
        status =
            bb_layout_maker_make(&maker, c->scene, &instance->tree, 1, BB_RECORD_VERTICES, &data);
    for (uint32_t set = 0; set < c->set_count && status == BB_OK; set++)
        status = check_set(c, set, kernel, &data, &instance->tree.info);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return status;
}

bb_status bb_conformance_check(bb_conformance *c, const char *builder, char *note, size_t capacity)
{
    uint64_t hashes[BUILDS] = {0};
    bb_instance instance = {0}, fresh = {0};
    bb_status status = bb_instance_create(c->device, builder, c->scene, c->seed, &instance);
    if (status == BB_OK)
        status = check_tree(c, &instance, &hashes[0]);
    if (status == BB_OK)
        status = check_tree(c, &instance, &hashes[1]);
    if (status == BB_OK)
        status = bb_instance_create(c->device, builder, c->scene, c->seed, &fresh);
    if (status == BB_OK)
        status = check_tree(c, &fresh, &hashes[2]);
    bool same = hashes[0] == hashes[1] && hashes[1] == hashes[2];
    if (status == BB_OK && !same && instance.builder->deterministic)
        status = bb_fail(BB_FAILED, "the same input gave another tree: %016llx, %016llx, %016llx",
                         (unsigned long long)hashes[0], (unsigned long long)hashes[1],
                         (unsigned long long)hashes[2]);
    for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL && status == BB_OK; kernel++)
        status = check_kernel(c, &instance, *kernel);
    char about[256];
    if (status == BB_OK)
        status = bb_instance_describe(&instance, c->scene, about, sizeof about);
    if (status == BB_OK)
        snprintf(note, capacity, "%u nodes, depth %u, tree %016llx%s%s%s",
                 instance.tree.info.node_count, instance.tree.info.depth,
                 (unsigned long long)hashes[0],
                 same ? "" : " (differs between builds, as its builder says)",
                 about[0] != '\0' ? "; " : "", about);
    bb_instance_destroy(&fresh);
    bb_instance_destroy(&instance);
    return status;
}
