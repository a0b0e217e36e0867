/* Structs and constants that host (C11) and device (OpenCL C 1.2) share.
 *
 * Scalars and arrays only: no float3, bool, size_t, enum or pointer, so that every compiler lays
 * them out alike. tests/test_device.c compares the sizes on the device with those asserted here.
 */
#ifndef BB_SHARED_H
#define BB_SHARED_H

#ifdef __OPENCL_VERSION__
typedef uint bb_u32;
typedef uchar bb_u8;
#else
#include <stdint.h>
typedef uint32_t bb_u32;
typedef uint8_t bb_u8;
#endif

/* "No node", "no primitive": the skip of the last node, the primitive of a miss. */
#define BB_NONE 0xFFFFFFFFu

/* Primitive of an any-hit answer that does not name it (Embree's). */
#define BB_UNNAMED 0x7FFFFFFFu

/* Set in bb_node.first of a leaf; the other bits are an index into refs[]. */
#define BB_LEAF_BIT 0x80000000u
/* Set in the last refs[] entry of a leaf; the other 31 bits are the primitive. */
#define BB_LAST_BIT 0x80000000u
#define BB_INDEX_MASK 0x7FFFFFFFu

/* Hit buffers are filled with this before each launch. A miss is (BB_NONE, +inf), so a value that
 * is still poison after a launch was never written. */
#define BB_POISON 0xDEADBEEFu

/* Kinds of primitives, in the order in which a scene numbers them, each with two numbers of 32-bit
 * words per primitive: of its data in the scene, and of its copy in a layout (for meshes: of
 * vertices). A kind is a row here, framework/scene/prim_NAME.c and, named in prims.clh,
 * kernels/prim_NAME.clh. */
#define BB_PRIM_KINDS(X)                                                                           \
    X(TRIANGLE, triangle, 3, 9)                                                                    \
    X(SPHERE, sphere, 4, 4)                                                                        \
    X(AABB, aabb, 6, 6)                                                                            \
    X(TETRAHEDRON, tetrahedron, 4, 12)

enum {
#define BB_KIND_NUMBER(NAME, name, words, kept) BB_##NAME,
    BB_PRIM_KINDS(BB_KIND_NUMBER) BB_KIND_COUNT
#undef BB_KIND_NUMBER
};

/* Primitives are numbered consecutively: those of kind k end before end[k] and begin where the
 * previous kind ends. */
typedef struct bb_prim_ends {
    bb_u32 end[BB_KIND_COUNT];
} bb_prim_ends;

/* Axis-aligned box of a primitive; an input of the builders. Finite, lo <= hi. 32 bytes. */
typedef struct bb_box {
    float lo[3];
    bb_u32 pad0;
    float hi[3];
    bb_u32 pad1;
} bb_box;

/* Node of the common tree. The children of inner node n are first(n), skip(first(n)), ... up to but
 * not including skip(n); a leaf's `first` is BB_LEAF_BIT | index of its first reference. The root's
 * skip is BB_NONE. 32 bytes. */
typedef struct bb_node {
    float lo[3];
    bb_u32 first;
    float hi[3];
    bb_u32 skip;
} bb_node;

/* Properties of a tree. A builder on the device writes them there; the harness reads them back
 * outside the clock, and the checker verifies them. */
typedef struct bb_tree_info {
    bb_u32 root;
    bb_u32 node_count; /* all of them must be reachable from the root */
    bb_u32 leaf_count;
    bb_u32 ref_count;
    bb_u32 arity; /* largest number of children of a node; 0 for a single leaf */
    bb_u32 depth; /* edges from the root to the deepest leaf */
} bb_tree_info;

/* Most references that leaf collapse puts in a leaf. */
#define BB_LEAF_MAX 64

/* The result of leaf collapse for the subtree below a node. 24 bytes. */
typedef struct bb_subtree {
    float cost;    /* least possible, times area */
    bb_u32 refs;   /* saturates at BB_LEAF_MAX + 1, except for a leaf of the input tree */
    bb_u32 leaves; /* of the result, like the members below */
    bb_u32 height;
    bb_u32 arity;
    bb_u32 leaf; /* 1: the node is a leaf */
} bb_subtree;

/* Ray: origin, direction (any non-zero length), and the open interval (tmin, tmax) in which hits
 * count, in units of |d|. 32 bytes. */
typedef struct bb_ray {
    float o[3];
    float tmin;
    float d[3];
    float tmax;
} bb_ray;

/* Hit: distance in units of |d| and primitive. A miss is t = +inf, prim = BB_NONE. For any-hit
 * queries prim is one primitive that was hit and t its distance. 8 bytes. */
typedef struct bb_hit {
    float t;
    bb_u32 prim;
} bb_hit;

/* First and last hit: distances as in bb_hit, and primitives. A miss has t = (+inf, -inf) and both
 * primitives BB_NONE. 16 bytes. */
typedef struct bb_interval {
    float t[2];
    bb_u32 prims[2];
} bb_interval;

/* Node of the `pair` layout: the boxes of both children, with each plane of both as a pair, so that
 * the planes for either sign of a direction are two words apart. Axis a: lo at planes[4a], hi at
 * planes[4a + 2], child 0, then child 1. A link is a pair node or BB_LEAF_BIT | first leaf
 * primitive. 64 bytes. */
typedef struct bb_pair {
    float planes[12];
    bb_u32 links[2];
    float area; /* half area of the box around both, before padding: for plans of wide nodes */
    bb_u32 pad;
} bb_pair;

/* Format of triangles in layouts, as the intersector needs it: vertices, or the affine map from the
 * scene to the space in which the triangle is (0, 0), (1, 0), (0, 1) in the plane z = 0. The map is
 * three rows of four, the row for z first. */
#define BB_FORMAT_VERTICES 0u
#define BB_FORMAT_AFFINE 1u
#define BB_FORMAT_COUNT 2

/* Words of a leaf primitive before its number, enough for the largest of these kinds (bits). The
 * number follows, with BB_LAST_BIT if it is the last of its leaf. */
static inline bb_u32 bb_leaf_prim_payload(bb_u32 kinds, bb_u32 format)
{
    bb_u32 most = 0;
#define BB_MOST_WORDS(NAME, name, words, kept)                                                     \
    if ((kinds & 1u << BB_##NAME) != 0 && most < (kept))                                           \
        most = (kept);
    BB_PRIM_KINDS(BB_MOST_WORDS)
#undef BB_MOST_WORDS
    return format == BB_FORMAT_AFFINE && (kinds & 1u << BB_TRIANGLE) != 0 ? 12 : most;
}

/* Words of a leaf primitive: whole vectors of four. */
static inline bb_u32 bb_leaf_prim_words(bb_u32 kinds, bb_u32 format)
{
    return bb_leaf_prim_payload(kinds, format) / 4 * 4 + 4;
}

/* Block of the wide layouts: BB_BLOCK_LANES primitives of one kind, with each word of the record
 * above for all of them side by side, then their numbers. Lanes without a primitive come last; they
 * have the number BB_NONE, and nothing can hit them. BB_LAST_BIT on the first number closes the
 * leaf. */
#define BB_BLOCK_LANES 4

static inline bb_u32 bb_block_words(bb_u32 kinds, bb_u32 format)
{
    return (bb_leaf_prim_payload(kinds, format) + 1) * BB_BLOCK_LANES;
}

/* Nodes of the wide layouts: the boxes of up to 4 or 8 children side by side. Axis a: lo from
 * planes[2aW] on, hi from planes[(2a + 1)W] on, for children 0 to W - 1. A link is a node or
 * BB_LEAF_BIT | first block. A place without a child has an empty box and, since a ray of NaNs
 * meets even that, a link to a block without primitives. 128 and 256 bytes. */
typedef struct bb_wide4 {
    float planes[24];
    bb_u32 links[4];
    bb_u32 count; /* number of children */
    bb_u32 pad[3];
} bb_wide4;

typedef struct bb_wide8 {
    float planes[48];
    bb_u32 links[8];
    bb_u32 count;
    bb_u32 pad[7];
} bb_wide8;

/* The same with 8 bits per plane: plane p of axis a is base[a] + p * scale[a], where scale is a
 * power of two. The boxes contain the exact ones. Since distances are padded, rays from far away
 * may meet even an inverted box, so a bit marks the places that have a child. 128 bytes. */
typedef struct bb_quant8 {
    bb_u8 planes[48];
    float base[3];
    float scale[3];
    bb_u32 links[8];
    bb_u32 count;
    bb_u32 places; /* bit c: place c has a child */
    bb_u32 pad[4];
} bb_quant8;

/* Compressed node of up to 8 children: plane q of axis a is origin[a] + q * 2^(exponents[a] - 127).
 * Children that are nodes lie one after the other from `nodes` on, in the order of their places;
 * primitives, at most 3 per child, from `prims` on. meta[s] describes the child at place s:
 *
 *   0                      no child
 *   32 | 24 + s            a node
 *   2^k - 1 << 5 | first   a leaf of k primitives, the first of which is prims + first
 *
 * Size: five vectors of 16 bytes. */
typedef struct bb_cwbvh {
    float origin[3];
    bb_u8 exponents[3];
    bb_u8 inner; /* bit s: the child at place s is a node */
    bb_u32 nodes;
    bb_u32 prims;
    bb_u8 meta[8];
    bb_u8 planes[48]; /* lo from 16a on, hi from 16a + 8 on, for places 0 to 7 */
} bb_cwbvh;

/* Most primitives of a leaf in a compressed node. */
#define BB_CWBVH_LEAF_MAX 3

/* The best way to merge a pair into wide nodes: its cost as up to 1, 2, ... children, times area,
 * and, in 4 bits each, how many of these its left side gets; 0: one child fewer is as good. 32
 * bytes. */
typedef struct bb_wide_plan {
    float cost[7];
    bb_u32 splits;
} bb_wide_plan;

/* Counts of a kernel's counting variant, per ray. */
typedef struct bb_count {
    bb_u32 nodes;    /* boxes tested */
    bb_u32 prims;    /* primitives tested */
    bb_u32 overflow; /* 1: the stack was too small, so the hit is not valid */
    bb_u32
        restarts; /* walks from the root after a short stack ran empty; searches for tetrahedra */
} bb_count;

#ifndef __OPENCL_VERSION__
#ifdef __cplusplus
#define BB_STATIC_ASSERT static_assert
#else
#define BB_STATIC_ASSERT _Static_assert
#endif
BB_STATIC_ASSERT(sizeof(bb_box) == 32, "bb_box");
BB_STATIC_ASSERT(sizeof(bb_prim_ends) == 4 * BB_KIND_COUNT, "bb_prim_ends");
BB_STATIC_ASSERT(sizeof(bb_node) == 32, "bb_node");
BB_STATIC_ASSERT(sizeof(bb_tree_info) == 24, "bb_tree_info");
BB_STATIC_ASSERT(sizeof(bb_subtree) == 24, "bb_subtree");
BB_STATIC_ASSERT(sizeof(bb_ray) == 32, "bb_ray");
BB_STATIC_ASSERT(sizeof(bb_hit) == 8, "bb_hit");
BB_STATIC_ASSERT(sizeof(bb_interval) == 16, "bb_interval");
BB_STATIC_ASSERT(sizeof(bb_pair) == 64, "bb_pair");
BB_STATIC_ASSERT(sizeof(bb_wide4) == 128, "bb_wide4");
BB_STATIC_ASSERT(sizeof(bb_wide8) == 256, "bb_wide8");
BB_STATIC_ASSERT(sizeof(bb_quant8) == 128, "bb_quant8");
BB_STATIC_ASSERT(sizeof(bb_cwbvh) == 80, "bb_cwbvh");
BB_STATIC_ASSERT(sizeof(bb_wide_plan) == 32, "bb_wide_plan");
BB_STATIC_ASSERT(sizeof(bb_count) == 16, "bb_count");
#endif

#endif
