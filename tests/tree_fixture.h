/* What the tests of trees share: scenes filled by hand, and random trees of random arity. */
#ifndef BB_TREE_FIXTURE_H
#define BB_TREE_FIXTURE_H

#include "framework/base/random.h"
#include "framework/builder/tree.h"
#include "tests/fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A scene of `count` empty boxes, for tests that look at nothing else. */
static inline bb_scene *make_box_scene(uint32_t count)
{
    bb_scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    scene->kinds = BB_TRIANGLES;
    scene->prim_count = scene->prims[BB_TRIANGLE].count = count;
    scene->scale = 1.0f;
    scene->boxes = calloc(count, sizeof *scene->boxes);
    assert_non_null(scene->boxes);
    return scene;
}

static inline void free_scene(bb_scene *scene)
{
    bb_buffer_release(&scene->on_device.boxes);
    bb_buffer_release(&scene->on_device.vertices);
    bb_buffer_release(&scene->on_device.prims);
    bb_host_free(scene->seal);
    free(scene->boxes);
    free(scene->vertices);
    free(bb_scene_indices(scene));
    free(bb_scene_floats(scene, BB_SPHERE));
    free(scene);
}

/* Triangles (9 floats each), then spheres (4 floats each), with their boxes. */
static inline bb_scene *make_scene(const float *triangles, uint32_t triangle_count,
                                   const float *spheres, uint32_t sphere_count)
{
    bb_scene *scene = make_box_scene(triangle_count + sphere_count);
    scene->kinds = (triangle_count > 0 ? BB_TRIANGLES : 0u) | (sphere_count > 0 ? BB_SPHERES : 0u);
    scene->prims[BB_TRIANGLE].count = triangle_count;
    scene->prims[BB_SPHERE].count = sphere_count;
    scene->prims[BB_SPHERE].first = triangle_count;
    scene->vertex_count = 3 * triangle_count;
    scene->vertices = calloc(9 * (size_t)triangle_count + 1, sizeof(float));
    scene->prims[BB_TRIANGLE].data = calloc(3 * (size_t)triangle_count + 1, sizeof(uint32_t));
    scene->prims[BB_SPHERE].data = calloc(4 * (size_t)sphere_count + 1, sizeof(float));
    for (uint32_t i = 0; i < 3 * triangle_count; i++)
        bb_scene_indices(scene)[i] = i;
    if (triangle_count > 0)
        memcpy(scene->vertices, triangles, 9 * (size_t)triangle_count * sizeof(float));
    if (sphere_count > 0)
        memcpy(bb_scene_floats(scene, BB_SPHERE), spheres,
               4 * (size_t)sphere_count * sizeof(float));
    for (uint32_t i = 0; i < triangle_count; i++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            const float *v = scene->vertices + 9 * (size_t)i + axis;
            scene->boxes[i].lo[axis] = fminf(v[0], fminf(v[3], v[6]));
            scene->boxes[i].hi[axis] = fmaxf(v[0], fmaxf(v[3], v[6]));
        }
    for (uint32_t i = 0; i < sphere_count; i++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            const float *s = bb_scene_floats(scene, BB_SPHERE) + 4 * (size_t)i;
            bb_box *box = &scene->boxes[triangle_count + i];
            box->lo[axis] = nextafterf(s[axis] - s[3], -INFINITY);
            box->hi[axis] = nextafterf(s[axis] + s[3], INFINITY);
        }
    return scene;
}

static inline bb_scene *make_random_scene(uint32_t count, bb_random *random)
{
    bb_scene *scene = make_box_scene(count);
    for (uint32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            scene->boxes[i].lo[axis] = (float)bb_random_range(random, -100, 100);
            scene->boxes[i].hi[axis] =
                scene->boxes[i].lo[axis] + (float)(10 * pow(bb_random_unit(random), 4));
        }
    return scene;
}

#define V(...) ((const float[3]){__VA_ARGS__})

static inline bb_node make_node(const float lo[3], const float hi[3], uint32_t first, uint32_t skip)
{
    bb_node node = {.first = first, .skip = skip};
    memcpy(node.lo, lo, sizeof node.lo);
    memcpy(node.hi, hi, sizeof node.hi);
    return node;
}

/* A tree on the host from literal nodes and references; arity and depth as given. */
static inline void make_tree(bb_tree *tree, const bb_node *nodes, uint32_t node_count,
                             const uint32_t *refs, uint32_t ref_count, uint32_t arity,
                             uint32_t depth)
{
    bb_tree_init(tree, NULL);
    ASSERT_OK(bb_tree_reserve(tree, NULL, BB_ON_HOST, node_count, ref_count));
    memcpy(tree->nodes, nodes, node_count * sizeof *nodes);
    memcpy(tree->refs, refs, ref_count * sizeof *refs);
    tree->info = (bb_tree_info){0, node_count, 0, ref_count, arity, depth};
    for (uint32_t i = 0; i < node_count; i++)
        tree->info.leaf_count += bb_node_is_leaf(&nodes[i]);
}

/* Root [0,4] x [0,1] x [0,1] with four unit cubes as children, each a leaf of one reference. */
static inline void make_row(bb_tree *tree)
{
    bb_node nodes[5] = {make_node(V(0, 0, 0), V(4, 1, 1), 1, BB_NONE)};
    uint32_t refs[4];
    for (uint32_t i = 0; i < 4; i++) {
        float x = (float)i;
        nodes[i + 1] =
            make_node(V(x, 0, 0), V(x + 1, 1, 1), BB_LEAF_BIT | i, i < 3 ? i + 2 : BB_NONE);
        refs[i] = i | BB_LAST_BIT;
    }
    make_tree(tree, nodes, 5, refs, 4, 4, 1);
}

static inline void shuffle(uint32_t *items, uint32_t count, bb_random *random)
{
    for (uint32_t i = count; i > 1; i--) {
        uint32_t k = bb_random_below(random, i), item = items[i - 1];
        items[i - 1] = items[k];
        items[k] = item;
    }
}

typedef struct random_node {
    uint32_t begin, end, parent, depth, subtree_end;
    bool leaf;
} random_node;

/* Cuts [0, count) into a tree, in preorder; returns the number of nodes (at most 4 count). */
static inline uint32_t cut_randomly(uint32_t count, uint32_t arity, uint32_t max_leaf,
                                    bb_random *random, random_node *nodes, bb_tree_info *info)
{
    random_node *stack = malloc((4 * (size_t)count + arity) * sizeof *stack);
    uint32_t stack_count = 0, node_count = 0;
    stack[stack_count++] = (random_node){0, count, BB_NONE, 0, 0, false};
    while (stack_count > 0) {
        random_node node = stack[--stack_count];
        uint32_t size = node.end - node.begin, index = node_count++;
        node.leaf = size == 1 || (size <= max_leaf && bb_random_below(random, 2) == 0);
        nodes[index] = node;
        if (node.leaf) {
            info->leaf_count++;
            info->depth = node.depth > info->depth ? node.depth : info->depth;
            continue;
        }
        uint32_t want = 2 + bb_random_below(random, arity - 1), end = node.end, children = 0;
        while (end > node.begin) {
            uint32_t begin = children + 1 < want
                                 ? node.begin + bb_random_below(random, end - node.begin)
                                 : node.begin;
            if (begin == node.begin && children == 0)
                begin++; /* at least two children */
            stack[stack_count++] = (random_node){begin, end, index, node.depth + 1, 0, false};
            end = begin;
            children++;
        }
        info->arity = children > info->arity ? children : info->arity;
    }
    free(stack);
    for (uint32_t i = node_count; i-- > 0;) {
        nodes[i].subtree_end = nodes[i].subtree_end > i ? nodes[i].subtree_end : i + 1;
        if (i > 0 && nodes[nodes[i].parent].subtree_end < nodes[i].subtree_end)
            nodes[nodes[i].parent].subtree_end = nodes[i].subtree_end;
    }
    info->node_count = node_count;
    return node_count;
}

/* A valid tree over the scene's boxes of random shape; nodes and the leaves' references lie in
 * random order. */
static inline void make_random_tree(const bb_scene *scene, uint32_t arity, uint32_t max_leaf,
                                    bb_random *random, bb_tree *tree)
{
    uint32_t count = scene->prim_count;
    random_node *cut = calloc(4 * (size_t)count, sizeof *cut);
    uint32_t *place = malloc(4 * (size_t)count * sizeof *place);
    uint32_t *prims = malloc(count * sizeof *prims);
    uint32_t *order = malloc(4 * (size_t)count * sizeof *order);
    bb_tree_info info = {.ref_count = count};
    uint32_t node_count = cut_randomly(count, arity, max_leaf, random, cut, &info);
    for (uint32_t i = 0; i < node_count; i++)
        place[i] = order[i] = i;
    for (uint32_t i = 0; i < count; i++)
        prims[i] = i;
    shuffle(place, node_count, random);
    shuffle(order, node_count, random);
    shuffle(prims, count, random);

    bb_tree_init(tree, NULL);
    ASSERT_OK(bb_tree_reserve(tree, NULL, BB_ON_HOST, node_count, count));
    for (uint32_t i = 0; i < node_count; i++) {
        bb_node *node = &tree->nodes[place[i]];
        *node = (bb_node){.lo = {INFINITY, INFINITY, INFINITY},
                          .hi = {-INFINITY, -INFINITY, -INFINITY}};
        for (uint32_t k = cut[i].begin; k < cut[i].end; k++)
            for (int axis = 0; axis < 3; axis++) {
                node->lo[axis] = fminf(node->lo[axis], scene->boxes[prims[k]].lo[axis]);
                node->hi[axis] = fmaxf(node->hi[axis], scene->boxes[prims[k]].hi[axis]);
            }
        node->first = cut[i].leaf ? 0 : place[i + 1];
        node->skip = cut[i].subtree_end < node_count ? place[cut[i].subtree_end] : BB_NONE;
    }
    uint32_t ref = 0;
    for (uint32_t i = 0; i < node_count; i++) {
        const random_node *leaf = &cut[order[i]];
        if (!leaf->leaf)
            continue;
        tree->nodes[place[order[i]]].first = BB_LEAF_BIT | ref;
        for (uint32_t k = leaf->begin; k < leaf->end; k++)
            tree->refs[ref++] = prims[k];
        tree->refs[ref - 1] |= BB_LAST_BIT;
    }
    info.root = place[0];
    tree->info = info;
    free(cut);
    free(place);
    free(prims);
    free(order);
}

static inline void copy_tree(const bb_tree *from, bb_tree *to)
{
    bb_tree_init(to, NULL);
    ASSERT_OK(bb_tree_reserve(to, NULL, BB_ON_HOST, from->info.node_count, from->info.ref_count));
    memcpy(to->nodes, from->nodes, from->info.node_count * sizeof *to->nodes);
    memcpy(to->refs, from->refs, from->info.ref_count * sizeof *to->refs);
    to->info = from->info;
    to->duplicated = from->duplicated;
    to->disjoint = from->disjoint;
    to->keep_nodes = from->keep_nodes;
}

#endif
