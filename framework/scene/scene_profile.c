/* Measures the properties of a scene once, so that no more is used than it needs (code length,
 * octree depth, kinds).
 *
 * Linear passes over the boxes, two hash tables, one radix sort, and for the overlap a kd-tree over
 * sampled points; ten million primitives take seconds. Everything is deterministic; the seeds are
 * fixed.
 *
 * Definitions that the header leaves open:
 * - a centroid is 0.5f * lo + 0.5f * hi, as the builders compute it; -0 equals +0;
 * - size_median is the lower median;
 * - closed: every edge, told by the exact positions of its ends, belongs to an even number of
 *   triangle sides, so that the surface has no boundary (a cycle modulo 2; winding does not
 *   matter). An edge whose ends coincide counts for nothing;
 * - code_bits: the centroids' box is cut into 2^b cells per axis (zero extent: one cell), and the
 *   code of n bits is the first n bits of the interleaved cell numbers, longest axis first, so 32
 *   bits are 11 + 11 + 10. The least n for which there are as many codes as distinct centroids;
 * - octree_depth: likewise the least number of levels of 3 bits, 21 if that is not enough;
 * - bits_apart: the same without rounding, of codes;
 * - bits_useful: the least n such that longer codes save at most 2 % of the cost of a radix tree,
 *   by this bound. A node that splits at bit m has about the half area a(m) of a cell that m bits
 *   leave, enlarged by the median primitive. Codes of n bits leave groups of primitives with equal
 *   codes, whose g - 1 nodes are split at random: at worst, all have the area of the first of them.
 *   The sum of these excesses, over the sum of all areas, is the loss. It is a bound: measured SAH
 *   is 0.0 to 0.5 % above that of 63 bits in nine scenes (framework/advise/README.md).
 */
#include "framework/base/random.h"
#include "framework/base/statistics.h"
#include "framework/scene/prim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

enum {
    OVERLAP_POINTS = 1024,     /* centroids for which the overlap is counted */
    OVERLAP_BOXES = 1 << 20,   /* boxes compared with them */
    KD_LEAF = 8,               /* points in a leaf of the kd-tree */
    KD_NODES = OVERLAP_POINTS, /* enough: a node splits only above KD_LEAF points */
    LEVELS = 21,
};

static void centroid(const bb_box *box, float out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = 0.5f * box->lo[axis] + 0.5f * box->hi[axis] + 0.0f; /* + 0 turns -0 into 0 */
}

/* ---- sizes ---- */

static float diagonal(const bb_box *box)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double side = (double)box->hi[axis] - (double)box->lo[axis];
        square += side * side;
    }
    return (float)sqrt(square);
}

static bb_status measure_sizes(bb_scene *scene)
{
    float *sizes = NULL;
    BB_TRY(bb_host_alloc(NULL, scene->prim_count * sizeof *sizes, "the profile's sizes", &sizes));
    float least = INFINITY, most = 0;
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        sizes[i] = diagonal(&scene->boxes[i]);
        least = sizes[i] < least ? sizes[i] : least;
        most = sizes[i] > most ? sizes[i] : most;
    }
    scene->profile.size_min = (double)least;
    scene->profile.size_max = (double)most;
    const uint32_t last = scene->prim_count - 1;
    scene->profile.size_median = (double)bb_select(sizes, scene->prim_count, last / 2);
    scene->profile.size_low = (double)bb_select(sizes, scene->prim_count, last / 100);
    scene->profile.size_high = (double)bb_select(sizes, scene->prim_count, last - last / 100);
    bb_host_free(sizes);

    double shortest = INFINITY, longest = 0;
    for (int axis = 0; axis < 3; axis++) {
        double side = (double)scene->bounds.hi[axis] - (double)scene->bounds.lo[axis];
        shortest = side < shortest ? side : shortest;
        longest = side > longest ? side : longest;
    }
    scene->profile.flatness = longest > 0 ? shortest / longest : 0;
    return BB_OK;
}

/* ---- zero area ---- */

static void count_zero_area(bb_scene *scene)
{
    uint32_t count = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        for (uint32_t i = 0; i < scene->prims[kind].count; i++)
            count += bb_prim_kinds[kind]->is_flat(scene, i);
    scene->profile.zero_area = count;
}

/* ---- duplicates ---- */

typedef struct key {
    float value[6];
} key;

/* An open-addressing hash table of primitives, at most half full. */
typedef struct table {
    uint32_t *slots; /* BB_NONE: free */
    uint64_t mask;
} table;

static bb_status table_make(uint32_t count, table *table)
{
    uint64_t size = 16;
    while (size < 2 * (uint64_t)count)
        size *= 2;
    table->mask = size - 1;
    BB_TRY(bb_host_alloc(NULL, size * sizeof *table->slots, "the profile's table", &table->slots));
    memset(table->slots, 0xFF, size * sizeof *table->slots);
    return BB_OK;
}

/* Inserts primitive `prim`, unless one with an equal key is there; returns that one, else BB_NONE.
 * Keys contain no -0, so that equal values have equal bytes. */
static uint32_t table_insert(table *table, const bb_scene *scene, uint32_t prim,
                             key (*make_key)(const bb_box *))
{
    key mine = make_key(&scene->boxes[prim]);
    uint64_t slot = XXH3_64bits(&mine, sizeof mine) & table->mask;
    for (; table->slots[slot] != BB_NONE; slot = (slot + 1) & table->mask) {
        key other = make_key(&scene->boxes[table->slots[slot]]);
        if (memcmp(&mine, &other, sizeof mine) == 0)
            return table->slots[slot];
    }
    table->slots[slot] = prim;
    return BB_NONE;
}

static key centroid_key(const bb_box *box)
{
    key out = {{0}};
    centroid(box, out.value);
    return out;
}

static key box_key(const bb_box *box)
{
    key out;
    for (int axis = 0; axis < 3; axis++) {
        out.value[axis] = box->lo[axis] + 0.0f;
        out.value[axis + 3] = box->hi[axis] + 0.0f;
    }
    return out;
}

/* Equal boxes have equal centroids, so only primitives that share a centroid are compared by box:
 * one bit per primitive marks that a later one has the same box. */
static bb_status count_duplicates(bb_scene *scene)
{
    table centroids = {0}, boxes = {0};
    uint32_t *twins = NULL; /* pairs: primitive, first primitive with its centroid */
    uint32_t count = 0, capacity = 0;
    bb_status status = table_make(scene->prim_count, &centroids);
    for (uint32_t i = 0; i < scene->prim_count && status == BB_OK; i++) {
        uint32_t first = table_insert(&centroids, scene, i, centroid_key);
        if (first == BB_NONE)
            continue;
        if (count == capacity) {
            capacity = capacity > 0 ? 2 * capacity : 1024;
            uint32_t *grown = realloc(twins, 2 * sizeof *twins * (size_t)capacity);
            if (grown == NULL) {
                status =
                    bb_fail(BB_REFUSED, "%s: no memory for %u duplicates", scene->name, capacity);
                break;
            }
            twins = grown;
        }
        twins[2 * (size_t)count] = i;
        twins[2 * (size_t)count++ + 1] = first;
    }
    bb_host_free(centroids.slots);
    if (status == BB_OK)
        status = table_make(2 * count, &boxes);
    uint32_t equal = 0;
    for (uint32_t i = 0; i < count && status == BB_OK; i++) {
        table_insert(&boxes, scene, twins[2 * (size_t)i + 1], box_key);
        equal += table_insert(&boxes, scene, twins[2 * (size_t)i], box_key) != BB_NONE;
    }
    scene->profile.duplicate_centroids = count;
    scene->profile.duplicate_boxes = equal;
    bb_host_free(boxes.slots);
    free(twins);
    return status;
}

/* ---- codes ---- */

/* The centroids' box, and the axes by decreasing extent. */
typedef struct frame {
    float lo[3];
    double extent[3];
    int axis[3];
} frame;

static frame make_frame(const bb_scene *scene)
{
    frame out = {.axis = {0, 1, 2}};
    float hi[3] = {0};
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        float c[3];
        centroid(&scene->boxes[i], c);
        for (int axis = 0; axis < 3; axis++) {
            out.lo[axis] = i == 0 || c[axis] < out.lo[axis] ? c[axis] : out.lo[axis];
            hi[axis] = i == 0 || c[axis] > hi[axis] ? c[axis] : hi[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++)
        out.extent[axis] = (double)hi[axis] - (double)out.lo[axis];
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < 2; i++)
            if (out.extent[out.axis[i]] < out.extent[out.axis[i + 1]]) {
                int swap = out.axis[i];
                out.axis[i] = out.axis[i + 1];
                out.axis[i + 1] = swap;
            }
    return out;
}

/* Inserts two zero bits between each of the lowest 22 bits. */
static uint64_t spread(uint64_t v)
{
    v &= 0x3FFFFF;
    v = (v | v << 32) & 0x003F00000000FFFFu;
    v = (v | v << 16) & 0x003F0000FF0000FFu;
    v = (v | v << 8) & 0x300F00F00F00F00Fu;
    v = (v | v << 4) & 0x30C30C30C30C30C3u;
    return (v | v << 2) & 0x9249249249249249u;
}

/* Returns a code of 64 bits: 22 of the longest axis, 21 of the others, interleaved; every shorter
 * code is a prefix.
 */
static uint64_t code_of(const frame *frame, const bb_box *box)
{
    float c[3];
    centroid(box, c);
    uint64_t cell[3];
    for (int i = 0; i < 3; i++) {
        int axis = frame->axis[i];
        double scale = i == 0 ? 0x1p22 : 0x1p21;
        double position = (double)c[axis] - (double)frame->lo[axis];
        double number = frame->extent[axis] > 0 ? position / frame->extent[axis] * scale : 0;
        cell[i] = number < scale ? (uint64_t)number : (uint64_t)scale - 1;
    }
    return spread(cell[0]) | spread(cell[1]) << 2 | spread(cell[2]) << 1;
}

/* Sorts by the least significant digit first, 11 bits at a time; returns which array has the
 * result. */
static uint64_t *radix_sort(uint64_t *keys, uint64_t *other, size_t count)
{
    for (unsigned shift = 0; shift < 64; shift += 11) {
        size_t place[2048] = {0};
        for (size_t i = 0; i < count; i++)
            place[keys[i] >> shift & 2047]++;
        size_t sum = 0;
        for (size_t digit = 0; digit < 2048; digit++) {
            size_t here = place[digit];
            place[digit] = sum;
            sum += here;
        }
        for (size_t i = 0; i < count; i++)
            other[place[keys[i] >> shift & 2047]++] = keys[i];
        uint64_t *swap = keys;
        keys = other;
        other = swap;
    }
    return keys;
}

/* Returns the first bit in which two neighbours differ; 64: none. */
static int split_bit(const uint64_t *sorted, uint32_t i)
{
    uint64_t difference = sorted[i] ^ sorted[i - 1];
    return difference != 0 ? __builtin_clzll(difference) : 64;
}

/* Computes a(m) of the definition. */
static void cell_areas(const bb_scene *scene, const frame *frame, double area[65])
{
    const double more = scene->profile.size_median / sqrt(3); /* side of a cube of that size */
    double side[3];
    for (int k = 0; k < 3; k++)
        side[k] = frame->extent[frame->axis[k]];
    for (int m = 0; m <= 64; m++) {
        double x = side[0] + more, y = side[1] + more, z = side[2] + more;
        area[m] = x * y + y * z + z * x;
        side[m % 3] *= 0.5;
    }
}

/* Returns the excess of groups that the first `bits` bits do not separate. */
static double excess(const uint64_t *sorted, uint32_t count, int bits, const double area[65])
{
    double all = 0;
    for (uint32_t i = 1; i < count; i++) {
        int top = 64;
        double sum = 0;
        uint32_t first = i;
        for (int m; i < count && (m = split_bit(sorted, i)) >= bits; i++) {
            top = m < top ? m : top;
            sum += area[m];
        }
        all += (double)(i - first) * area[top] - sum;
    }
    return all;
}

/* The loss falls with the number of bits, so the least number is found by bisection. */
static uint32_t useful_bits(const bb_scene *scene, const frame *frame, const uint64_t *sorted,
                            const uint32_t first_bit[65])
{
    const double inner = 1.2, tolerated = 0.02; /* Ct, with Ci = 1; share of the cost */
    double area[65], nodes = 0;
    cell_areas(scene, frame, area);
    for (int m = 0; m <= 64; m++)
        nodes += first_bit[m] * area[m];
    const double limit = tolerated * (nodes + (double)scene->prim_count * area[64] / inner);
    int low = 0, high = 64;
    while (low < high) {
        int middle = (low + high) / 2;
        if (excess(sorted, scene->prim_count, middle, area) <= limit)
            high = middle;
        else
            low = middle + 1;
    }
    return (uint32_t)high;
}

static void choose_bits(bb_profile *profile, const uint32_t first_bit[65], uint32_t distinct)
{
    static const uint32_t lengths[] = {30, 32, 63, 64};
    uint32_t codes[65]; /* codes[n]: number of distinct prefixes of n bits */
    codes[0] = 1;
    for (uint32_t n = 0; n < 64; n++)
        codes[n + 1] = codes[n] + first_bit[n];
    profile->code_bits = 0;
    for (size_t i = 0; i < 4 && profile->code_bits == 0; i++)
        if (codes[lengths[i]] == distinct)
            profile->code_bits = lengths[i];
    profile->octree_depth = 0;
    while (profile->octree_depth < LEVELS && codes[3 * profile->octree_depth] < distinct)
        profile->octree_depth++;
    while (profile->bits_apart < BB_BITS_NONE &&
           (profile->bits_apart > 64 || codes[profile->bits_apart] < distinct))
        profile->bits_apart++;
}

static bb_status measure_codes(bb_scene *scene)
{
    uint64_t *keys = NULL, *other = NULL;
    size_t bytes = scene->prim_count * sizeof *keys;
    bb_status status = bb_host_alloc(NULL, bytes, "the profile's codes", &keys);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, bytes, "the profile's codes", &other);
    if (status == BB_OK) {
        frame frame = make_frame(scene);
        for (uint32_t i = 0; i < scene->prim_count; i++)
            keys[i] = code_of(&frame, &scene->boxes[i]);
        const uint64_t *sorted = radix_sort(keys, other, scene->prim_count);
        uint32_t first_bit[65] = {0}; /* first bit in which neighbours differ; 64: none */
        for (uint32_t i = 1; i < scene->prim_count; i++) {
            first_bit[split_bit(sorted, i)]++;
        }
        choose_bits(&scene->profile, first_bit,
                    scene->prim_count - scene->profile.duplicate_centroids);
        scene->profile.bits_useful = useful_bits(scene, &frame, sorted, first_bit);
    }
    bb_host_free(keys);
    bb_host_free(other);
    return status;
}

/* ---- closed or open ---- */

static void position(const bb_scene *scene, uint32_t triangle, uint32_t corner, float out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = bb_scene_vertex(scene, triangle, corner)[axis] + 0.0f;
}

/* Edges that occur an even number of times cancel in an exclusive or of their 128-bit hashes; the
 * remainder is zero by chance once in 2^128. This needs no table, and treats vertices at the same
 * position as one. */
static void measure_closed(bb_scene *scene)
{
    if (scene->prims[BB_TRIANGLE].count == 0) {
        scene->profile.closed = -1;
        return;
    }
    XXH128_hash_t sum = {0, 0};
    uint64_t edges = 0;
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i++) {
        float p[3][3];
        for (uint32_t k = 0; k < 3; k++)
            position(scene, i, k, p[k]);
        for (int k = 0; k < 3; k++) {
            const float *a = p[k], *b = p[(k + 1) % 3];
            int order = memcmp(a, b, sizeof p[0]);
            if (order == 0)
                continue;
            key edge;
            memcpy(edge.value, order < 0 ? a : b, sizeof p[0]);
            memcpy(edge.value + 3, order < 0 ? b : a, sizeof p[0]);
            XXH128_hash_t hash = XXH3_128bits(&edge, sizeof edge);
            sum.low64 ^= hash.low64;
            sum.high64 ^= hash.high64;
            edges++;
        }
    }
    scene->profile.closed = edges > 0 && sum.low64 == 0 && sum.high64 == 0;
}

/* ---- overlap ---- */

/* A node of the kd-tree over the sampled centroids: points first .. first + count - 1, and their
 * box. */
typedef struct kd_node {
    float lo[3];
    float hi[3];
    uint32_t first;
    uint32_t count;
    uint32_t left; /* left child; the right one is left + 1; 0: a leaf */
} kd_node;

typedef struct kd_tree {
    float (*points)[3];
    kd_node *nodes;
    uint32_t node_count;
} kd_tree;

static int compare_axis(const void *a, const void *b, int axis)
{
    float x = ((const float *)a)[axis], y = ((const float *)b)[axis];
    return (x > y) - (x < y);
}

static int compare_x(const void *a, const void *b)
{
    return compare_axis(a, b, 0);
}

static int compare_y(const void *a, const void *b)
{
    return compare_axis(a, b, 1);
}

static int compare_z(const void *a, const void *b)
{
    return compare_axis(a, b, 2);
}

static void kd_split(kd_tree *tree, uint32_t number)
{
    kd_node *node = &tree->nodes[number];
    for (uint32_t i = 0; i < node->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float value = tree->points[node->first + i][axis];
            node->lo[axis] = i == 0 || value < node->lo[axis] ? value : node->lo[axis];
            node->hi[axis] = i == 0 || value > node->hi[axis] ? value : node->hi[axis];
        }
    node->left = 0;
    if (node->count <= KD_LEAF)
        return;
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (node->hi[axis] - node->lo[axis] > node->hi[longest] - node->lo[longest])
            longest = axis;
    int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
    qsort(tree->points + node->first, node->count, sizeof tree->points[0], compare[longest]);
    uint32_t half = node->count / 2;
    node->left = tree->node_count;
    tree->nodes[node->left].first = node->first;
    tree->nodes[node->left].count = half;
    tree->nodes[node->left + 1].first = node->first + half;
    tree->nodes[node->left + 1].count = node->count - half;
    tree->node_count += 2;
    uint32_t left = node->left;
    kd_split(tree, left); /* at most log2(OVERLAP_POINTS) deep */
    kd_split(tree, left + 1);
}

static bool inside(const bb_box *box, const float point[3])
{
    return point[0] >= box->lo[0] && point[0] <= box->hi[0] && point[1] >= box->lo[1] &&
           point[1] <= box->hi[1] && point[2] >= box->lo[2] && point[2] <= box->hi[2];
}

/* Counts the points in the box; nodes entirely inside are counted without descending. */
static uint32_t kd_count(const kd_tree *tree, uint32_t number, const bb_box *box)
{
    const kd_node *node = &tree->nodes[number];
    for (int axis = 0; axis < 3; axis++)
        if (node->lo[axis] > box->hi[axis] || node->hi[axis] < box->lo[axis])
            return 0;
    if (inside(box, node->lo) && inside(box, node->hi))
        return node->count;
    if (node->left != 0)
        return kd_count(tree, node->left, box) + kd_count(tree, node->left + 1, box);
    uint32_t count = 0;
    for (uint32_t i = 0; i < node->count; i++)
        count += inside(box, tree->points[node->first + i]);
    return count;
}

/* Estimates, for sampled centroids, how many of (a sample of) the other boxes contain them. Exact
 * up to 1024 primitives. */
static double estimate_overlap(const bb_scene *scene, kd_tree *tree)
{
    bb_random random = bb_random_make(10, 0);
    uint32_t n = scene->prim_count;
    uint32_t points = n < OVERLAP_POINTS ? n : OVERLAP_POINTS;
    uint32_t boxes = n < OVERLAP_BOXES ? n : OVERLAP_BOXES;
    uint64_t own = 0;
    uint64_t inside_count = 0;
    for (uint32_t i = 0; i < points; i++) {
        uint32_t prim = points == n ? i : bb_random_below(&random, n);
        centroid(&scene->boxes[prim], tree->points[i]);
        own += inside(&scene->boxes[prim], tree->points[i]);
    }
    tree->nodes[0].first = 0;
    tree->nodes[0].count = points;
    tree->node_count = 1;
    kd_split(tree, 0);
    for (uint32_t i = 0; i < boxes; i++) {
        uint32_t prim = boxes == n ? i : bb_random_below(&random, n);
        inside_count += kd_count(tree, 0, &scene->boxes[prim]);
    }
    /* Each point's own box is in a sample of the boxes with probability boxes / n. */
    double all = (double)inside_count * ((double)n / (double)boxes) - (double)own;
    return all > 0 ? all / (double)points : 0;
}

static bb_status measure_overlap(bb_scene *scene)
{
    kd_tree tree = {0};
    bb_status status = bb_host_alloc(NULL, OVERLAP_POINTS * sizeof *tree.points,
                                     "the profile's points", &tree.points);
    if (status == BB_OK)
        status =
            bb_host_alloc(NULL, KD_NODES * sizeof *tree.nodes, "the profile's points", &tree.nodes);
    if (status == BB_OK)
        scene->profile.overlap = estimate_overlap(scene, &tree);
    bb_host_free(tree.points);
    bb_host_free(tree.nodes);
    return status;
}

bb_status bb_scene_profile(bb_scene *scene)
{
    memset(&scene->profile, 0, sizeof scene->profile);
    BB_TRY(measure_sizes(scene));
    count_zero_area(scene);
    BB_TRY(count_duplicates(scene));
    BB_TRY(measure_codes(scene));
    measure_closed(scene);
    scene->profile.measured = true;
    return measure_overlap(scene);
}
