/* The file formats in which external tracers, which are not plug-ins, get rays and return hits.
 *
 * `bvhbench rays` writes a rays file: a scene's primitives and a ray set. A tracer answers it with
 * a hits file, which `bvhbench judge` judges. This header is the format; a tracer needs nothing
 * else (examples/outside-tracer is one). Numbers are little-endian, floats IEEE 754 binary32. The
 * parts follow each other without padding:
 *
 *   rays file   bb_rays_header
 *               bb_ray   rays[ray_count]              o, tmin, d, tmax: 32 bytes each
 *               float    vertices[vertex_count][3]
 *               uint32_t indices[triangle_count][3]   into vertices
 *               float    spheres[sphere_count][4]     centre, radius
 *               float    boxes[more_counts[0]][6]     lower corner, upper corner
 *   hits file   bb_hits_header
 *               bb_hit   hits[hit_count]              t, primitive: 8 bytes each, hits[i] of
 *                        rays[i]
 *
 * Primitives are numbered consecutively: the triangles first, then the spheres, then the boxes, of
 * which rays hit the surface. t is in units of |d|, which need not be 1. A hit counts if tmin < t <
 * tmax; tmax may be +inf. Triangles are hit from both sides. A ray that starts inside a sphere or a
 * box hits its far side. There are no defaults: a tracer that cannot do what a header asks for
 * (another version, another interval, boxes) must say so and stop.
 *
 *   closest hit   the nearest hit, and which primitive that is
 *   any hit       some hit; BB_UNNAMED for the primitive says "one of them"; t is ignored
 *   no hit        t = +inf, prim = BB_NONE
 *
 * A file may have fewer hits than rays: they belong to the first rays. `bvhbench judge` refuses a
 * file that has more hits than rays, a closest hit whose t is not a number, a primitive that the
 * scene does not have, or a miss whose t is not +inf; the message names the first such ray. A t
 * outside the interval is an answer like any other and is judged.
 *
 * The header names the workload and everything else that determines the rays: `bvhbench judge`
 * generates the rays again and refuses a file with other rays. Rays made by hand need a name that
 * no workload has, and 0 for seed, primary_width, primary_height, max_rays and must_hit. `bvhbench
 * judge --verify no` accepts such rays, and its record says so.
 *
 * Hashes are XXH3 of 64 bits, seed 0 (https://xxhash.com). The checksum is the hash of the whole
 * file with the checksum's own eight bytes taken as 0. A tracer may copy the hashes from the rays
 * file, and may write the checksum 0, which means "none": damage is not found then.
 */
#ifndef BB_EXCHANGE_H
#define BB_EXCHANGE_H

#include "kernels/bb_shared.h" /* bb_ray, bb_hit, BB_NONE, BB_UNNAMED */

#include <stdint.h>

#define BB_RAYS_MAGIC "BVHBRAYS" /* the first eight bytes, without a terminating 0 */
#define BB_HITS_MAGIC "BVHBHITS"

enum {
    BB_EXCHANGE_VERSION = 4,
    BB_EXCHANGE_MORE_KINDS = 6,
    BB_EXCHANGE_ORDER = 0x01020304, /* what a reader of the wrong byte order sees as 0x04030201 */
    BB_EXCHANGE_CLOSEST = 0,
    BB_EXCHANGE_ANY = 1,
    BB_EXCHANGE_OPEN = 1, /* hits count where tmin < t < tmax */
};

/* 1024 bytes. Texts end with a 0 and are padded with 0. */
typedef struct bb_rays_header {
    char magic[8];
    uint32_t version;
    uint32_t byte_order;   /* BB_EXCHANGE_ORDER */
    uint32_t header_bytes; /* 1024: where the rays start */
    uint32_t query;        /* BB_EXCHANGE_CLOSEST or BB_EXCHANGE_ANY */
    uint32_t interval;     /* BB_EXCHANGE_OPEN */
    uint32_t must_hit;     /* 1: the workload `edges`, where each ray must hit; else 0 */
    uint64_t ray_count;
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t sphere_count;
    /* hash of the last three counts and the more_counts that are not 0, each as uint32_t, then
     * vertices, indices, spheres, boxes */
    uint64_t scene_hash;
    uint64_t rays_hash; /* hash of the rays */
    uint64_t checksum;
    uint64_t seed; /* the rays follow from scene, workload, view, seed and the last three numbers */
    uint32_t width; /* of the picture that the rays make, row by row; 0: none */
    uint32_t height;
    uint32_t primary_width; /* of the primary rays: these rays, or those at whose hits they start */
    uint32_t primary_height;
    uint32_t max_rays;
    uint32_t reserved;   /* 0 */
    char scene[256];     /* the text that `bvhbench rays` got */
    char rays[128];      /* the workload, with its parameters */
    char view[48];       /* "": the rays are of all views, or of none */
    char generator[424]; /* version and command line of the program that wrote the file */
    uint64_t more_counts[BB_EXCHANGE_MORE_KINDS]; /* number of boxes, then 0 for kinds to come */
} bb_rays_header;

/* 128 bytes. */
typedef struct bb_hits_header {
    char magic[8];
    uint32_t version;
    uint32_t byte_order;
    uint32_t header_bytes; /* 128: where the hits start */
    uint32_t reserved;     /* 0 */
    uint64_t hit_count;
    uint64_t scene_hash; /* scene_hash and rays_hash are copied from the rays file */
    uint64_t rays_hash;
    uint64_t checksum; /* 0: none */
    char tracer[72];   /* name of the tracer, for the report; may be "" */
} bb_hits_header;

BB_STATIC_ASSERT(sizeof(bb_rays_header) == 1024, "bb_rays_header");
BB_STATIC_ASSERT(sizeof(bb_hits_header) == 128, "bb_hits_header");

#endif
