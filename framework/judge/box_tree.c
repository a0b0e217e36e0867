/* Binned SAH on the longest axis of the centroids (Wald, On fast Construction of SAH-based Bounding
 * Volume Hierarchies, 2007), with a median split where binning does not separate or the tree gets
 * deep; at most four primitives per leaf.
 *
 * The traversal must never skip a box that the arbiter's definition needs. Boxes are grown by 1.001
 * times the margin; the excess, at least 2^-30 of the largest |v - o|, is far above the rounding of
 * the doubles in the slab test. */
#include "framework/judge/box_tree.h"

#include "framework/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF_MAX = 4, BINS = 16, BINNED_DEPTH = 48, STACK = 96 };

struct bb_box_tree {
    const bb_box *boxes;
    bb_box_node *nodes;
    uint32_t *refs;
    uint32_t node_count;
};

typedef struct bounds {
    float lo[3], hi[3];
} bounds;

typedef struct range {
    uint32_t node, begin, end, depth;
} range;

/* ---- building ---- */

static bounds empty_bounds(void)
{
    return (bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void extend(bounds *b, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++) {
        b->lo[k] = lo[k] < b->lo[k] ? lo[k] : b->lo[k];
        b->hi[k] = hi[k] > b->hi[k] ? hi[k] : b->hi[k];
    }
}

static double half_area(const bounds *b)
{
    double x = (double)b->hi[0] - b->lo[0], y = (double)b->hi[1] - b->lo[1],
           z = (double)b->hi[2] - b->lo[2];
    return x * y + y * z + z * x;
}

static float centroid(const bb_box *box, int axis)
{
    return 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
}

static uint32_t bin_of(const bb_box *box, int axis, float lo, double scale)
{
    double bin = ((double)centroid(box, axis) - lo) * scale;
    return bin < BINS - 1 ? (uint32_t)bin : BINS - 1;
}

/* Returns the last bin on the left of the cheapest split, or BINS without any. */
static uint32_t best_split(const bb_box_tree *tree, range r, int axis, float lo, double scale)
{
    bounds boxes[BINS], side = empty_bounds();
    uint32_t counts[BINS] = {0};
    double right[BINS];
    for (int b = 0; b < BINS; b++)
        boxes[b] = empty_bounds();
    for (uint32_t i = r.begin; i < r.end; i++) {
        const bb_box *box = &tree->boxes[tree->refs[i]];
        uint32_t b = bin_of(box, axis, lo, scale);
        counts[b]++;
        extend(&boxes[b], box->lo, box->hi);
    }
    uint32_t count = 0;
    for (int b = BINS - 1; b > 0; b--) {
        count += counts[b];
        extend(&side, boxes[b].lo, boxes[b].hi);
        right[b] = count > 0 ? count * half_area(&side) : INFINITY;
    }
    uint32_t best = BINS;
    double least = INFINITY;
    side = empty_bounds();
    count = 0;
    for (int b = 0; b < BINS - 1; b++) {
        count += counts[b];
        extend(&side, boxes[b].lo, boxes[b].hi);
        double cost = count > 0 ? count * half_area(&side) + right[b + 1] : INFINITY;
        if (cost < least) {
            least = cost;
            best = (uint32_t)b;
        }
    }
    return best;
}

static void swap_refs(uint32_t *refs, uint32_t i, uint32_t j)
{
    uint32_t ref = refs[i];
    refs[i] = refs[j];
    refs[j] = ref;
}

/* Splits at the median of the centroids by Hoare's quickselect. */
static uint32_t split_at_median(bb_box_tree *tree, range r, int axis)
{
    uint32_t middle = r.begin + (r.end - r.begin) / 2;
    int64_t low = r.begin, high = (int64_t)r.end - 1;
    while (low < high) {
        float pivot = centroid(&tree->boxes[tree->refs[low + (high - low) / 2]], axis);
        int64_t i = low, j = high;
        while (i <= j) {
            while (centroid(&tree->boxes[tree->refs[i]], axis) < pivot)
                i++;
            while (pivot < centroid(&tree->boxes[tree->refs[j]], axis))
                j--;
            if (i <= j)
                swap_refs(tree->refs, (uint32_t)i++, (uint32_t)j--);
        }
        if ((int64_t)middle <= j)
            high = j;
        else if ((int64_t)middle >= i)
            low = i;
        else
            break;
    }
    return middle;
}

/* Partitions the references of `r`; returns the first one on the right. */
static uint32_t split(bb_box_tree *tree, range r)
{
    bounds centres = empty_bounds();
    for (uint32_t i = r.begin; i < r.end; i++) {
        const bb_box *box = &tree->boxes[tree->refs[i]];
        const float c[3] = {centroid(box, 0), centroid(box, 1), centroid(box, 2)};
        extend(&centres, c, c);
    }
    int axis = 0;
    double extent = 0.0;
    for (int k = 0; k < 3; k++)
        if ((double)centres.hi[k] - centres.lo[k] > extent) {
            extent = (double)centres.hi[k] - centres.lo[k];
            axis = k;
        }
    if (extent == 0.0 || r.depth >= BINNED_DEPTH)
        return split_at_median(tree, r, axis);
    double scale = BINS / extent;
    float lo = centres.lo[axis];
    uint32_t best = best_split(tree, r, axis, lo, scale);
    if (best >= BINS)
        return split_at_median(tree, r, axis);
    uint32_t i = r.begin, j = r.end;
    while (i < j) {
        if (bin_of(&tree->boxes[tree->refs[i]], axis, lo, scale) <= best)
            i++;
        else
            swap_refs(tree->refs, i, --j);
    }
    return i;
}

static void build(bb_box_tree *tree, uint32_t count)
{
    range stack[STACK];
    uint32_t height = 0;
    stack[height++] = (range){0, 0, count, 0};
    tree->node_count = 1;
    while (height > 0) {
        range r = stack[--height];
        bounds all = empty_bounds();
        for (uint32_t i = r.begin; i < r.end; i++)
            extend(&all, tree->boxes[tree->refs[i]].lo, tree->boxes[tree->refs[i]].hi);
        bb_box_node *node = &tree->nodes[r.node];
        memcpy(node->lo, all.lo, sizeof node->lo);
        memcpy(node->hi, all.hi, sizeof node->hi);
        if (r.end - r.begin <= LEAF_MAX) {
            node->first = r.begin;
            node->count = r.end - r.begin;
            continue;
        }
        uint32_t middle = split(tree, r), child = tree->node_count;
        tree->node_count += 2;
        node->first = child;
        node->count = 0;
        stack[height++] = (range){child + 1, middle, r.end, r.depth + 1};
        stack[height++] = (range){child, r.begin, middle, r.depth + 1};
    }
}

bb_status bb_box_tree_create(const bb_box *boxes, uint32_t count, bb_box_tree **out)
{
    *out = NULL;
    bb_box_tree *tree = calloc(1, sizeof *tree);
    if (tree == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of the arbiter's hierarchy");
    tree->boxes = boxes;
    bb_status status = bb_host_alloc(NULL, 2 * (size_t)count * sizeof *tree->nodes,
                                     "the arbiter's hierarchy", &tree->nodes);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, count * sizeof *tree->refs, "the arbiter's references",
                               &tree->refs);
    if (status != BB_OK) {
        bb_box_tree_destroy(tree);
        return status;
    }
    for (uint32_t i = 0; i < count; i++)
        tree->refs[i] = i;
    build(tree, count);
    bb_host_shrink(&tree->nodes, tree->node_count * sizeof *tree->nodes);
    *out = tree;
    return BB_OK;
}

void bb_box_tree_destroy(bb_box_tree *tree)
{
    if (tree == NULL)
        return;
    bb_host_free(tree->nodes);
    bb_host_free(tree->refs);
    free(tree);
}

const bb_box_node *bb_box_tree_nodes(const bb_box_tree *tree, uint32_t *count)
{
    *count = tree->node_count;
    return tree->nodes;
}

const uint32_t *bb_box_tree_refs(const bb_box_tree *tree)
{
    return tree->refs;
}

/* ---- visiting ---- */

void bb_probe_make(const bb_ray *ray, bb_probe *probe)
{
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        probe->o[k] = ray->o[k];
        probe->d[k] = ray->d[k];
        probe->inverse[k] = 1.0 / probe->d[k];
        square += probe->d[k] * probe->d[k];
    }
    probe->length = sqrt(square);
    probe->tmin = ray->tmin;
    probe->tmax = ray->tmax;
    probe->grow = 0.0;
}

/* Returns 16 * 2^-24 * max |v - o| over the coordinates of the box. */
static double box_eps(const double o[3], const float lo[3], const float hi[3])
{
    double largest = 0.0;
    for (int k = 0; k < 3; k++) {
        double low = fabs((double)lo[k] - o[k]), high = fabs((double)hi[k] - o[k]);
        largest = low > largest ? low : largest;
        largest = high > largest ? high : largest;
    }
    return 16.0 * 0x1p-24 * largest;
}

static bool meets(const bb_probe *probe, const float lo[3], const float hi[3])
{
    double eps = box_eps(probe->o, lo, hi);
    double grow = 1.001 * (eps > probe->grow ? eps : probe->grow);
    double begin = probe->tmin - grow / probe->length, end = probe->tmax + grow / probe->length;
    for (int k = 0; k < 3; k++) {
        double low = (double)lo[k] - probe->o[k] - grow, high = (double)hi[k] - probe->o[k] + grow;
        if (probe->d[k] == 0.0) {
            if (low > 0.0 || high < 0.0)
                return false;
            continue;
        }
        double near = (probe->d[k] > 0.0 ? low : high) * probe->inverse[k];
        double far = (probe->d[k] > 0.0 ? high : low) * probe->inverse[k];
        begin = near > begin ? near : begin;
        end = far < end ? far : end;
    }
    return begin <= end;
}

void bb_box_tree_visit(const bb_box_tree *tree, const bb_probe *probe,
                       bool (*visit)(void *context, uint32_t prim), void *context)
{
    uint32_t stack[STACK], height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const bb_box_node *node = &tree->nodes[stack[--height]];
        if (!meets(probe, node->lo, node->hi))
            continue;
        if (node->count == 0) {
            stack[height++] = node->first + 1;
            stack[height++] = node->first;
            continue;
        }
        for (uint32_t i = node->first; i < node->first + node->count; i++) {
            uint32_t prim = tree->refs[i];
            if (meets(probe, tree->boxes[prim].lo, tree->boxes[prim].hi) && visit(context, prim))
                return;
        }
    }
}
