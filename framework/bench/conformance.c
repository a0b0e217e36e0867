#include "framework/bench/conformance_private.h"
#include "framework/scene/prim.h"
#include "framework/workload/workload.h"

#include "framework/bench/cost.h"
#include "framework/device/device_private.h"
#include "framework/scene/tets.h"
#include "traversal/pass.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BUILDS = 3 };

/* Workloads that a scene does not support are left out. */
static const char *const workloads[] = {"primary",
                                        "ao",
                                        "random:near=0.5",
                                        "edges:jitter=64",
                                        "edges:jitter=64,from=around",
                                        "lines:query=interval"};
_Static_assert(sizeof workloads / sizeof workloads[0] == BB_CONFORMANCE_SETS, "sets");

/* Most tests of boxes and primitives for a set: by each of the many kernels, and once without a
 * tree. A kernel that restarts from the root visits all levels of a chain again and again, and the
 * kernel that counts tests does not. */
static const double most_tests = 1.5e6, most_brute_tests = 1.5e7, most_levels = 1e8;

bb_status bb_conformance_choose_counts(bb_conformance *c, bb_tree *tree)
{
    const bb_rays *rays[BB_CONFORMANCE_SETS] = {NULL};
    double tests[BB_CONFORMANCE_SETS] = {0}, depth = tree->info.depth;
    double budget = tree->info.node_count == 1 ? most_brute_tests : most_tests;
    for (uint32_t i = 0; i < c->set_count; i++)
        rays[i] = c->sets[i].rays;
    BB_TRY(bb_tree_upload(tree, c->device, NULL));
    BB_TRY(bb_tests_per_ray(c->device, c->scene, tree, rays, c->set_count, tests));
    for (uint32_t i = 0; i < c->set_count; i++) {
        double most = budget / fmax(1, tests[i]);
        most = fmin(most, most_levels / fmax(1, depth * depth));
        c->sets[i].affordable = rays[i]->count <= most ? rays[i]->count : 1 + (uint32_t)most;
    }
    return BB_OK;
}

/* ---- the answers ---- */

/* Traces a set. `overflows`: the kernel's stack may be too small for the tree. */
static bb_status trace(bb_conformance *c, const bb_ray_set *set, const bb_kernel *kernel,
                       const bb_layout_data *layout, uint32_t count, bool *overflows)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse(kernel->name, &spec));
    bb_traverser_request request = {
        .kernel = kernel,
        .spec = &spec,
        .intersector = &bb_intersectors[0],
        .query = set->rays->query,
    };
    bb_traverser *traverser;
    BB_TRY(bb_traverser_get(c->device, &request, layout, &traverser));
    *overflows = !kernel->stackless && layout->stack_need > bb_traverser_stack_size(traverser);
    const bb_pass pass = {.query = set->rays->query,
                          .traverser = traverser,
                          .layout = layout,
                          .rays = &set->rays->on_device,
                          .results = &c->d_results};
    return bb_pass_run(&pass, count, c->results, NULL);
}

/* Judges the answers. A kernel whose stack overflowed left its answer unwritten, which counts as
 * refusing the tree. */
static bb_status judge(bb_conformance *c, bb_ray_set *set, const char *kernel, uint32_t count,
                       bool overflows)
{
    bb_accuracy accuracy;
    const bb_verdict_request wanted = {.results = c->results, .count = count};
    BB_TRY(bb_judge(c->oracle, &set->answers, &wanted, &accuracy));
    if (accuracy.wrong_ppm == 0)
        return BB_OK;
    uint64_t wrong = accuracy.missed + accuracy.false_hits + accuracy.wrong_t;
    if (overflows && accuracy.unwritten == wrong)
        return bb_fail(BB_UNSUPPORTED, "the stack of kernel %s overflowed for %llu of %u rays",
                       kernel, (unsigned long long)wrong, count);
    return bb_fail(
        BB_FAILED,
        "kernel %s, %s rays: of %u rays %llu missed, %llu false, %llu wrong t; the first "
        "is ray %u",
        kernel, set->rays->name, count, (unsigned long long)accuracy.missed,
        (unsigned long long)accuracy.false_hits, (unsigned long long)accuracy.wrong_t,
        accuracy.first_wrong);
}

static bb_status compare(bb_conformance *c, bb_ray_set *set, const char *builder,
                         const char *kernel, uint32_t count)
{
    const bb_query *query = set->rays->query;
    size_t bytes = query->result_bytes;
    for (uint32_t i = 0; i < count && i < set->count; i++) {
        const char *here = c->results + i * bytes, *there = set->results + i * bytes;
        char texts[2][128];
        if (query->same(here, there))
            continue;
        query->say(here, texts[0], sizeof texts[0]);
        query->say(there, texts[1], sizeof texts[1]);
        return bb_fail(BB_FAILED,
                       "kernel %s, %s rays: ray %u is answered by %s, and by %s with %s: a box "
                       "around a hit was missed",
                       kernel, set->rays->name, i, texts[0], set->whose, texts[1]);
    }
    if (count <= set->count || !bb_device_divides_exactly(c->device))
        return BB_OK;
    memcpy(set->results + set->count * bytes, c->results + set->count * bytes,
           (count - set->count) * bytes);
    set->count = count;
    snprintf(set->whose, sizeof set->whose, "%.60s on %.60s", kernel, builder);
    return BB_OK;
}

static bb_status check_set(bb_conformance *c, bb_ray_set *set, const char *builder,
                           const bb_kernel *kernel, const bb_layout_data *layout)
{
    uint32_t count = set->affordable;
    bool overflows;
    BB_TRY(trace(c, set, kernel, layout, count, &overflows));
    BB_TRY(judge(c, set, kernel->name, count, overflows));
    return compare(c, set, builder, kernel->name, count);
}

/* Checks a kernel. BB_UNSUPPORTED if it does not take the tree or answers none of the queries. */
static bb_status check_kernel(bb_conformance *c, bb_tree *tree, const char *builder,
                              const bb_kernel *kernel)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    uint32_t traced = 0;
    bb_status status = bb_layout_maker_create(bb_layout_find(kernel->layout), c->device, &maker);
    if (status == BB_OK)
        status = bb_tree_upload(tree, c->device, NULL);
    if (status == BB_OK)
        status = bb_layout_maker_make(&maker, c->scene, tree, 1, BB_FORMAT_VERTICES, &data);
    for (uint32_t i = 0; i < c->set_count && status == BB_OK; i++)
        if ((kernel->queries & c->sets[i].rays->query->way) != 0) {
            status = check_set(c, &c->sets[i], builder, kernel, &data);
            traced++;
        }
    if (status == BB_OK && traced == 0)
        status = bb_fail(BB_UNSUPPORTED, "kernel %s answers none of the rays", kernel->name);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return status;
}

/* ---- brute force ---- */

/* Makes a tree of one leaf with all primitives. */
static bb_status make_one_leaf(const bb_scene *scene, bb_tree *tree)
{
    bb_tree_init(tree, NULL);
    BB_TRY(bb_tree_reserve(tree, NULL, BB_ON_HOST, 1, scene->prim_count));
    bb_node *root = tree->nodes;
    memcpy(root->lo, scene->bounds.lo, sizeof root->lo);
    memcpy(root->hi, scene->bounds.hi, sizeof root->hi);
    root->first = BB_LEAF_BIT;
    root->skip = BB_NONE;
    for (uint32_t i = 0; i < scene->prim_count; i++)
        tree->refs[i] = i;
    tree->refs[scene->prim_count - 1] |= BB_LAST_BIT;
    tree->info = (bb_tree_info){0, 1, 1, scene->prim_count, 0, 0};
    return BB_OK;
}

/* Tests all primitives with each ray, so that no box can hide one. */
bb_status bb_conformance_brute_force(bb_conformance *c)
{
    bb_tree tree;
    bb_status status = make_one_leaf(c->scene, &tree);
    if (status == BB_OK)
        status = bb_conformance_choose_counts(c, &tree);
    if (status == BB_OK)
        status = check_kernel(c, &tree, "brute force", bb_kernel_for_any_leaf(false));
    bb_tree_release(&tree);
    return status;
}

/* ---- preparation ---- */

static bb_status add_set(bb_conformance *c, const char *workload)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse(workload, &spec));
    const bb_workload *found = bb_workload_find(spec.name);
    bb_ray_set *set = &c->sets[c->set_count];
    bb_rays_request request = {
        .spec = &spec,
        .view = found->per_view ? &c->scene->views[0] : NULL,
        .width = c->side,
        .height = c->side,
        .max_rays = c->side * c->side,
        .seed = c->seed,
    };
    bb_status status = bb_rays_make(c->scene, c->oracle, &request, &set->rays);
    if (status == BB_UNSUPPORTED) { /* the views do not see the scene: other sets remain */
        size_t used = strlen(c->left_out);
        snprintf(c->left_out + used, sizeof c->left_out - used, "%s%s (%s)", used > 0 ? ", " : "",
                 workload, bb_message());
        return BB_OK;
    }
    BB_TRY(status);
    c->set_count++;
    BB_TRY(bb_rays_upload(set->rays, c->device));
    BB_TRY(bb_host_alloc(NULL, (size_t)c->side * c->side * set->rays->query->result_bytes,
                         "answers", &set->results));
    return bb_answers_make(c->oracle, set->rays, &set->answers);
}

/* Returns the index in reverse order. The first and the last stay if others can change places, so
 * that a builder that compares only a few primitives takes the scene for the same. */
static uint32_t opposite(uint32_t i, uint32_t count)
{
    bool stays = count > 3 && (i == 0 || i == count - 1);
    return stays ? i : count - 1 - i;
}

static bb_status reverse_prims(const bb_scene *scene, bb_scene *reversed)
{
    bb_prim_counts counts;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        counts.of[kind] = scene->prims[kind].count;
    BB_TRY(bb_scene_reserve(reversed, scene->vertex_count, &counts));
    memcpy(reversed->vertices, scene->vertices, 3 * sizeof(float) * (size_t)scene->vertex_count);
    if (scene->tets != NULL) {
        float *field;
        BB_TRY(bb_scene_reserve_field(reversed, scene->tets->field_name, &field));
        memcpy(field, scene->tets->field, sizeof *field * (size_t)scene->vertex_count);
    }
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const bb_prims *prims = &scene->prims[kind];
        size_t bytes = bb_prim_bytes(kind);
        for (uint32_t i = 0; i < prims->count; i++)
            memcpy((char *)reversed->prims[kind].data + i * bytes,
                   (const char *)prims->data + opposite(i, prims->count) * bytes, bytes);
    }
    return BB_OK;
}

/* Reverses a volume's voxels, since the boxes of bricks follow from them. */
static bb_status reverse_volume(const bb_scene *scene, bb_scene *reversed)
{
    bb_volume *turned;
    BB_TRY(bb_volume_turn(scene->volume, scene->name, &turned));
    return bb_scene_take_volume(reversed, turned, &scene->volume->transfer);
}

static bb_status reverse(const bb_scene *scene, bb_scene **out)
{
    bb_scene *reversed = calloc(1, sizeof *reversed);
    if (reversed == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = reversed;
    snprintf(reversed->name, sizeof reversed->name, "%s", scene->name);
    BB_TRY(scene->volume != NULL ? reverse_volume(scene, reversed)
                                 : reverse_prims(scene, reversed));
    reversed->profile = scene->profile;
    reversed->view_count = scene->view_count;
    memcpy(reversed->views, scene->views, sizeof reversed->views);
    return bb_scene_finish(reversed);
}

bb_status bb_conformance_prepare_rays(bb_conformance *c)
{
    bb_scene *scene = c->scene;
    BB_TRY(bb_oracle_create(scene, bb_host_threads(c->device), &c->oracle));
    for (int i = 0; i < BB_CONFORMANCE_SETS; i++)
        BB_TRY(add_set(c, workloads[i]));
    if (c->set_count == 0)
        return bb_fail(BB_FAILED, "scene %s: there are no rays to check anything with",
                       scene->name);
    size_t bytes = (size_t)c->side * c->side * BB_RESULT_BYTES_MAX;
    BB_TRY(bb_buffer_reserve(c->device, &c->account, bytes, "answers", &c->d_results));
    BB_TRY(bb_host_alloc(NULL, bytes, "answers", &c->results));
    return BB_OK;
}

static bb_status prepare(bb_conformance *c)
{
    BB_TRY(bb_scene_upload(c->scene, c->device));
    BB_TRY(reverse(c->scene, &c->reversed));
    BB_TRY(bb_scene_upload(c->reversed, c->device));
    BB_TRY(bb_conformance_prepare_rays(c));
    return bb_conformance_prepare_frames(c);
}

bb_status bb_conformance_create(bb_device *device, bb_scene *scene, uint32_t side, uint64_t seed,
                                bb_conformance **out)
{
    bb_conformance *c = calloc(1, sizeof *c);
    if (c == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    c->device = device;
    c->scene = scene;
    c->seed = seed;
    c->side = side;
    bb_status status = prepare(c);
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
    for (uint32_t i = 0; i < BB_FRAMES_MAX; i++)
        bb_conformance_destroy(c->frames[i]);
    for (uint32_t i = 0; i < c->set_count; i++) {
        bb_answers_release(&c->sets[i].answers);
        bb_rays_free(c->sets[i].rays);
        bb_host_free(c->sets[i].results);
    }
    bb_buffer_release(&c->d_results);
    bb_host_free(c->results);
    bb_oracle_destroy(c->oracle);
    bb_scene_free(c->reversed);
    bb_traversers_clear(c->device);
    free(c);
}

const char *bb_conformance_left_out(const bb_conformance *c)
{
    return c->left_out;
}

/* ---- a builder ---- */

/* Builds and checks a tree. `ms` gets the build's time; may be NULL. */
static bb_status check_tree(bb_instance *instance, const bb_scene *scene, uint64_t *hash,
                            double *ms)
{
    bb_build_timing timing;
    BB_TRY(bb_instance_build(instance, scene, false, &timing));
    if (ms != NULL)
        *ms = timing.timing.ms;
    BB_TRY(bb_tree_download(&instance->tree, NULL));
    BB_TRY(bb_tree_check(&instance->tree, scene));
    return bb_tree_hash(&instance->tree, hash);
}

/* Checks builds of the scene, of its reverse and of the scene again, whose tree stays. A builder
 * that keeps what it made before would give the wrong tree. */
static bb_status check_trees(bb_conformance *c, bb_instance *instance, uint64_t hashes[BUILDS],
                             double *ms)
{
    bb_instance fresh = {0};
    uint64_t other;
    BB_TRY(check_tree(instance, c->scene, &hashes[0], NULL));
    bb_status status = check_tree(instance, c->reversed, &other, NULL);
    if (status != BB_OK) {
        char reason[512];
        snprintf(reason, sizeof reason, "%s", bb_message());
        return bb_fail(status, "built with the primitives in reverse order: %s", reason);
    }
    BB_TRY(check_tree(instance, c->scene, &hashes[1], ms));
    status = bb_instance_create(c->device, instance->pipeline.text, c->scene, c->seed, &fresh);
    if (status == BB_OK)
        status = check_tree(&fresh, c->scene, &hashes[2], NULL);
    bb_instance_destroy(&fresh);
    BB_TRY(status);
    bool same = hashes[0] == hashes[1] && hashes[1] == hashes[2];
    if (!same && bb_instance_is_deterministic(instance))
        return bb_fail(BB_FAILED, "the same input gave another tree: %016llx, %016llx, %016llx",
                       (unsigned long long)hashes[0], (unsigned long long)hashes[1],
                       (unsigned long long)hashes[2]);
    return BB_OK;
}

bb_status bb_conformance_check_kernels(bb_conformance *c, bb_tree *tree, const char *builder,
                                       uint32_t most, char *refusing, size_t capacity)
{
    uint32_t traced = 0;
    char reason[512] = "";
    for (uint32_t i = 0; bb_kernels[i] != NULL && traced < most; i++) {
        bb_status status = check_kernel(c, tree, builder, bb_kernels[i]);
        if (status != BB_OK && status != BB_UNSUPPORTED)
            return status;
        traced += status == BB_OK;
        if (status == BB_OK)
            continue;
        snprintf(reason, sizeof reason, "%s", bb_message());
        size_t used = refusing != NULL ? strlen(refusing) : 0;
        if (refusing != NULL)
            snprintf(refusing + used, capacity - used, "%s%s", used > 0 ? ", " : "; not taken by ",
                     bb_kernels[i]->name);
    }
    return traced > 0 ? BB_OK : bb_fail(BB_FAILED, "no kernel takes the tree: %s", reason);
}

bb_status bb_conformance_check(bb_conformance *c, const char *builder, bb_conformed *found)
{
    uint64_t hashes[BUILDS] = {0};
    bb_instance instance = {0};
    char about[256] = "", refusing[160] = "", frames[64] = "";
    memset(found, 0, sizeof *found);
    BB_TRY(bb_instance_create(c->device, builder, c->scene, c->seed, &instance));
    bb_status status = check_trees(c, &instance, hashes, &found->build_ms);
    if (status == BB_OK)
        status = bb_conformance_choose_counts(c, &instance.tree);
    if (status == BB_OK)
        status = bb_conformance_check_kernels(c, &instance.tree, instance.pipeline.text, UINT32_MAX,
                                              refusing, sizeof refusing);
    if (status == BB_OK)
        status = bb_instance_describe(&instance, c->scene, about, sizeof about);
    found->hash = hashes[0];
    found->deterministic = bb_instance_is_deterministic(&instance);
    bool repeats = hashes[0] == hashes[1] && hashes[1] == hashes[2];
    bb_tree_info info = instance.tree.info; /* that of frame 0, as is the hash */
    if (status == BB_OK)
        status = bb_conformance_check_frames(c, &instance, frames, sizeof frames);
    if (status == BB_OK)
        snprintf(found->note, sizeof found->note, "%u nodes, depth %u, tree %016llx%s%s%s%s%s",
                 info.node_count, info.depth, (unsigned long long)hashes[0],
                 repeats ? "" : " (differs between builds, as its builder says)",
                 about[0] != '\0' ? "; " : "", about, frames, refusing);
    bb_instance_destroy(&instance);
    return status;
}
