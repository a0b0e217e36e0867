/* End-point overlap (Aila, Karras, Laine: On Quality Metrics of Bounding Volume Hierarchies, 2013):
 *
 *   EPO = sum over nodes n of C(n) area(S in the box of n, less the primitives below n) / area(S)
 *
 * with S the surface of the scene and C(n) the cost of a node, as in the surface area heuristic.
 * Measured as the mean over points p, uniform on S, of the cost of the nodes that contain p but
 * not, in their subtree, p's primitive.
 */
#include "framework/builder/metric_epo.h"
#include "framework/base/random.h"
#include "framework/base/threads.h"
#include "framework/builder/tree_walk.h"
#include "framework/scene/prim.h"

#include <math.h>
#include <string.h>

/* Points whose costs are added up together, so that the sum does not depend on the number of
 * threads.
 */
enum { BLOCK = 4096 };

/* Points that determine how many nodes one visits. */
enum { PILOT = 256 };

typedef struct epo {
    const bb_scene *scene;
    bb_tree tree;    /* preorder: the subtree of n is [n, skip(n)) */
    uint32_t *start; /* leaves[start[p] .. start[p + 1]) contain primitive p, in ascending order */
    uint32_t *leaves;
    double *node_cost;
    double *area; /* inclusive prefix sums over the primitives */
    double *sum;  /* per block: sums of the costs, of their squares */
    double *square;
    uint64_t samples, seed;
} epo;

/* Returns the first primitive whose prefix sum exceeds `area`. */
static uint32_t pick(const epo *e, double area)
{
    uint32_t low = 0, high = e->scene->prim_count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (e->area[middle] > area)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Returns whether a leaf of primitive `prim` is among the nodes [begin, end). */
static bool holds_prim(const epo *e, uint32_t prim, uint32_t begin, uint32_t end)
{
    uint32_t low = e->start[prim], high = e->start[prim + 1], last = high;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (e->leaves[middle] >= begin)
            high = middle;
        else
            low = middle + 1;
    }
    return low < last && e->leaves[low] < end;
}

static double point_cost(const epo *e, uint32_t prim, const double p[3], uint64_t *visits)
{
    uint32_t count = e->tree.info.node_count;
    double cost = 0.0;
    for (uint32_t i = 0; i < count; (*visits)++) {
        const bb_node *node = &e->tree.nodes[i];
        uint32_t end = node->skip == BB_NONE ? count : node->skip;
        bool inside = node->lo[0] <= p[0] && p[0] <= node->hi[0] && node->lo[1] <= p[1] &&
                      p[1] <= node->hi[1] && node->lo[2] <= p[2] && p[2] <= node->hi[2];
        if (inside && !holds_prim(e, prim, i, end))
            cost += e->node_cost[i];
        i = inside ? i + 1 : end;
    }
    return cost;
}

/* Returns the cost of point `sample`; adds the number of nodes that it visits. */
static double sample_cost(const epo *e, uint64_t sample, uint64_t *visits)
{
    double total = e->area[e->scene->prim_count - 1], p[3], normal[3];
    bb_random random = bb_random_make(e->seed, sample);
    uint32_t i, prim = pick(e, bb_random_unit(&random) * total);
    const bb_prim_kind *kind = bb_prim_of(e->scene, prim, &i);
    kind->sample(e->scene, i, &random, p, normal);
    return point_cost(e, prim, p, visits);
}

static void run_blocks(void *context, size_t begin, size_t end, uint32_t thread)
{
    (void)thread;
    epo *e = context;
    uint64_t visits = 0;
    for (size_t block = begin; block < end; block++) {
        uint64_t first = (uint64_t)block * BLOCK, rest = e->samples - first;
        uint64_t last = first + (rest < BLOCK ? rest : BLOCK);
        e->sum[block] = e->square[block] = 0.0;
        for (uint64_t sample = first; sample < last; sample++) {
            double cost = sample_cost(e, sample, &visits);
            e->sum[block] += cost;
            e->square[block] += cost * cost;
        }
    }
}

/* Fills leaves[] and start[]: counts, prefix sums, and positions from the last to the first. */
static bb_status index_leaves(epo *e)
{
    uint32_t prims = e->scene->prim_count, end = 0;
    const bb_tree_info *info = &e->tree.info;
    memset(e->start, 0, ((size_t)prims + 1) * sizeof *e->start);
    for (uint32_t i = 0; i < info->ref_count; i++) {
        uint32_t prim = e->tree.refs[i] & BB_INDEX_MASK;
        if (prim >= prims)
            return bb_fail(BB_FAILED, "reference %u refers to primitive %u of %u", i, prim, prims);
        e->start[prim]++;
    }
    for (uint32_t prim = 0; prim < prims; prim++)
        e->start[prim] = end += e->start[prim];
    e->start[prims] = end;
    uint32_t node = info->node_count, ref = info->ref_count;
    while (node-- > 0) {
        if (!bb_node_is_leaf(&e->tree.nodes[node]))
            continue;
        for (uint32_t first = e->tree.nodes[node].first & BB_INDEX_MASK; ref > first;)
            e->leaves[--e->start[e->tree.refs[--ref] & BB_INDEX_MASK]] = node;
    }
    return BB_OK;
}

static uint32_t node_width(const bb_tree *tree, uint32_t index)
{
    const bb_node *node = &tree->nodes[index];
    uint32_t width = 1;
    if (bb_node_is_leaf(node))
        for (uint32_t ref = node->first & BB_INDEX_MASK; !(tree->refs[ref] & BB_LAST_BIT); ref++)
            width++;
    else
        for (uint32_t child = node->first; tree->nodes[child].skip != node->skip; width++)
            child = tree->nodes[child].skip;
    return width;
}

static bb_status prepare(epo *e, const bb_tree *tree, size_t blocks)
{
    const char *what = "end-point overlap";
    size_t prims = e->scene->prim_count;
    BB_TRY(bb_tree_preorder(tree, &e->tree));
    BB_TRY(bb_host_alloc(NULL, (prims + 1) * sizeof *e->start, what, &e->start));
    BB_TRY(bb_host_alloc(NULL, e->tree.info.ref_count * sizeof *e->leaves, what, &e->leaves));
    BB_TRY(
        bb_host_alloc(NULL, e->tree.info.node_count * sizeof *e->node_cost, what, &e->node_cost));
    BB_TRY(bb_host_alloc(NULL, prims * sizeof *e->area, what, &e->area));
    BB_TRY(bb_host_alloc(NULL, blocks * sizeof *e->sum, what, &e->sum));
    BB_TRY(bb_host_alloc(NULL, blocks * sizeof *e->square, what, &e->square));
    BB_TRY(index_leaves(e));
    for (uint32_t i = 0; i < e->tree.info.node_count; i++)
        e->node_cost[i] = bb_node_cost(&e->tree.nodes[i], node_width(&e->tree, i));
    double area = 0.0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const bb_prims *those = &e->scene->prims[kind];
        for (uint32_t i = 0; i < those->count; i++)
            e->area[those->first + i] = area += bb_prim_kinds[kind]->area(e->scene, i);
    }
    return BB_OK;
}

static void summarise(const epo *e, size_t blocks, double *mean, double *half)
{
    double sum = 0.0, square = 0.0, n = (double)e->samples;
    for (size_t block = 0; block < blocks; block++) {
        sum += e->sum[block];
        square += e->square[block];
    }
    *mean = sum / n;
    double variance = n > 1.0 ? fmax(0.0, (square - sum * *mean) / (n - 1.0)) : (double)INFINITY;
    *half = 1.959963985 * sqrt(variance / n);
}

/* Reduces the number of points so that they visit about `visits` nodes, judged by the first
 * points. */
static void limit_samples(epo *e, uint64_t visits)
{
    uint64_t pilot = e->samples < PILOT ? e->samples : PILOT, seen = 0;
    for (uint64_t sample = 0; sample < pilot; sample++)
        (void)sample_cost(e, sample, &seen);
    uint64_t most = visits / (seen / pilot + 1);
    if (e->samples > most)
        e->samples = most > pilot ? most : pilot;
}

bb_status bb_epo(const bb_tree *tree, const bb_scene *scene, const bb_epo_effort *effort,
                 uint64_t seed, double *mean, double *half)
{
    epo e = {.scene = scene, .samples = effort->samples, .seed = seed};
    bb_tree_init(&e.tree, NULL);
    bb_pool *pool = NULL;
    bb_status status = prepare(&e, tree, (size_t)((e.samples - 1) / BLOCK + 1));
    if (status == BB_OK && scene->prim_count > 0 && e.area[scene->prim_count - 1] > 0.0) {
        if (effort->visits > 0)
            limit_samples(&e, effort->visits);
        size_t blocks = (size_t)((e.samples - 1) / BLOCK + 1);
        status = bb_pool_create(0, &pool);
        if (status == BB_OK) {
            bb_parallel_for(pool, blocks, 1, run_blocks, &e);
            summarise(&e, blocks, mean, half);
        }
    }
    bb_pool_destroy(pool);
    bb_tree_release(&e.tree);
    bb_host_free(e.start);
    bb_host_free(e.leaves);
    bb_host_free(e.node_cost);
    bb_host_free(e.area);
    bb_host_free(e.sum);
    bb_host_free(e.square);
    return status;
}

static bb_status compute(const bb_tree *tree, const bb_scene *scene, uint64_t samples,
                         uint64_t seed, double *mean, double *half)
{
    return bb_epo(tree, scene, &(bb_epo_effort){samples, 0}, seed, mean, half);
}

extern const bb_metric bb_metric_epo;
const bb_metric bb_metric_epo = {
    .name = "epo",
    .title = "EPO",
    .full_title = "end-point overlap",
    .unit = "",
    .summary = "The mean cost of the nodes that contain a random point of the surface, but not the "
               "point's primitive. Measured on request.",
    .on_request = true,
    .mixed = 2,
    .sampled = true,
    .compute = compute,
};
