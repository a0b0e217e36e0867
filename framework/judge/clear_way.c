/* Traversal of the arbiter's boxes, four at a time, in doubles.
 *
 *   make nodes of up to four children by opening the binary nodes of largest area
 *   until the stack is empty: take a node; for each of its four boxes that the ray meets:
 *       box of a node: push it
 *       box of a leaf: test its primitives with exact.c
 *
 * Planes and the ray's numbers are floats: their differences are off by at most 2^-53, distances by
 * three times that, which reciprocals padded by 2^-50 cover, as in kernels/slab.clh. A ray parallel
 * to a slab is compared with it. Boxes need no other padding: what the ray itself hits lies in them
 * exactly.
 */
#include "framework/judge/clear_way.h"

#include "framework/base/memory.h"
#include "framework/judge/arbiter.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 4, STACK = 256 };

typedef struct way_node {
    float planes[3][2][WIDTH]; /* lo and hi per axis; empty boxes for missing children */
    uint32_t first[WIDTH];     /* child node, or first reference */
    uint32_t count[WIDTH];     /* references; 0: a node */
} way_node;

struct bb_way {
    const bb_scene *scene;
    const uint32_t *refs;
    way_node *nodes;
};

/* ---- building ---- */

static double half_area(const bb_box_node *node)
{
    double x = (double)node->hi[0] - node->lo[0], y = (double)node->hi[1] - node->lo[1],
           z = (double)node->hi[2] - node->lo[2];
    return x * y + y * z + z * x;
}

/* Gathers up to four binary nodes as the children of a wide one. */
static uint32_t open_node(const bb_box_node *nodes, uint32_t root, uint32_t children[WIDTH])
{
    uint32_t count = 1;
    children[0] = root;
    while (count < WIDTH) {
        uint32_t best = WIDTH;
        double most = -1.0;
        for (uint32_t c = 0; c < count; c++) {
            const bb_box_node *child = &nodes[children[c]];
            if (child->count == 0 && half_area(child) > most) {
                most = half_area(child);
                best = c;
            }
        }
        if (best == WIDTH)
            break;
        uint32_t pair = nodes[children[best]].first;
        children[best] = pair;
        children[count++] = pair + 1;
    }
    return count;
}

/* Makes wide nodes in the order in which their binary roots are found; roots[i] is that of node i.
 * Returns their number. */
static uint32_t collapse(bb_way *way, const bb_box_node *nodes, uint32_t *roots)
{
    uint32_t made = 1;
    roots[0] = 0;
    for (uint32_t n = 0; n < made; n++) {
        uint32_t children[WIDTH], count = open_node(nodes, roots[n], children);
        way_node *node = &way->nodes[n];
        for (uint32_t c = 0; c < WIDTH; c++) {
            const bb_box_node *child = c < count ? &nodes[children[c]] : NULL;
            for (int k = 0; k < 3; k++) {
                node->planes[k][0][c] = child != NULL ? child->lo[k] : INFINITY;
                node->planes[k][1][c] = child != NULL ? child->hi[k] : -INFINITY;
            }
            node->count[c] = child != NULL ? child->count : 0;
            node->first[c] = child != NULL ? child->first : 0;
            if (child != NULL && child->count == 0) {
                node->first[c] = made;
                roots[made++] = children[c];
            }
        }
    }
    return made;
}

bb_status bb_way_create(const bb_scene *scene, const bb_box_tree *tree, bb_way **out)
{
    *out = NULL;
    uint32_t count;
    const bb_box_node *nodes = bb_box_tree_nodes(tree, &count);
    bb_way *way = calloc(1, sizeof *way);
    if (way == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of the arbiter's hierarchy");
    way->scene = scene;
    way->refs = bb_box_tree_refs(tree);
    uint32_t *roots = NULL;
    /* at most one per inner node, and one for the root */
    size_t most = count / 2 + 1;
    bb_status status =
        bb_host_alloc(NULL, most * sizeof *way->nodes, "the arbiter's wide hierarchy", &way->nodes);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, most * sizeof *roots, "the arbiter's numbering", &roots);
    if (status == BB_OK)
        bb_host_shrink(&way->nodes, collapse(way, nodes, roots) * sizeof *way->nodes);
    bb_host_free(roots);
    if (status == BB_OK)
        *out = way;
    else
        bb_way_destroy(way);
    return status;
}

void bb_way_destroy(bb_way *way)
{
    if (way == NULL)
        return;
    bb_host_free(way->nodes);
    free(way);
}

/* ---- asking ---- */

typedef struct question {
    const bb_ray *ray;
    double tmin, limit;
    double from, to;              /* slightly wider, to find hits too near to an end */
    double o[3], near[3], far[3]; /* reciprocals, padded */
    int down[3];                  /* 1: the direction is negative */
    bool parallel[3];
} question;

static void begin(question *q)
{
    q->tmin = q->ray->tmin;
    q->from = q->tmin * (1.0 - 0x1p-27);
    q->to = q->limit * (1.0 + 0x1p-27);
    for (int k = 0; k < 3; k++) {
        double d = q->ray->d[k], r = 1.0 / d;
        q->o[k] = q->ray->o[k];
        q->parallel[k] = d == 0.0;
        q->down[k] = d < 0.0;
        q->near[k] = r * (1.0 - 0x1p-50);
        q->far[k] = r * (1.0 + 0x1p-50);
    }
}

/* Returns bit c if the ray meets box c between the ends. The compiler can vectorise the inner
 * loops. */
static unsigned meet_boxes(const question *q, const way_node *node)
{
    double begin[WIDTH], end[WIDTH];
    unsigned met = 0, out = 0;
    for (int c = 0; c < WIDTH; c++) {
        begin[c] = q->from;
        end[c] = q->to;
    }
    for (int k = 0; k < 3; k++) {
        const float *entry = node->planes[k][q->down[k]], *exit = node->planes[k][1 - q->down[k]];
        double o = q->o[k], near = q->near[k], far = q->far[k];
        if (q->parallel[k]) {
            for (int c = 0; c < WIDTH; c++)
                out |= (unsigned)((double)entry[c] > o || (double)exit[c] < o) << c;
            continue;
        }
        for (int c = 0; c < WIDTH; c++) {
            double n = ((double)entry[c] - o) * near, f = ((double)exit[c] - o) * far;
            begin[c] = n > begin[c] ? n : begin[c];
            end[c] = f < end[c] ? f : end[c];
        }
    }
    for (int c = 0; c < WIDTH; c++)
        met |= (unsigned)(begin[c] <= end[c]) << c;
    return met & ~out;
}

static bb_way_state ask_primitive(const bb_way *way, const question *q, uint32_t prim)
{
    double t[2];
    int count = bb_exact_hits(way->scene, q->o, q->ray->d, prim, t);
    for (int root = 0; root < count; root++) {
        double slack = 0x1p-28 * fabs(t[root]);
        if (t[root] > q->tmin + slack && t[root] < q->limit - slack)
            return BB_WAY_BLOCKED;
        if (t[root] >= q->tmin - slack && t[root] <= q->limit + slack)
            return BB_WAY_UNSURE;
    }
    return BB_WAY_CLEAR;
}

bb_way_state bb_way_ask(const bb_way *way, const bb_ray *ray, double limit, uint32_t except)
{
    question q = {.ray = ray, .limit = limit};
    begin(&q);
    uint32_t stack[STACK], height = 0;
    bool unsure = false;
    stack[height++] = 0;
    while (height > 0) {
        const way_node *node = &way->nodes[stack[--height]];
        for (unsigned met = meet_boxes(&q, node); met != 0; met &= met - 1) {
            int c = __builtin_ctz(met);
            if (node->count[c] == 0) {
                stack[height++] = node->first[c];
                continue;
            }
            for (uint32_t i = node->first[c]; i < node->first[c] + node->count[c]; i++) {
                if (way->refs[i] == except)
                    continue;
                bb_way_state state = ask_primitive(way, &q, way->refs[i]);
                if (state == BB_WAY_BLOCKED)
                    return BB_WAY_BLOCKED;
                unsure |= state == BB_WAY_UNSURE;
            }
        }
    }
    return unsure ? BB_WAY_UNSURE : BB_WAY_CLEAR;
}
