/* Direct volume rendering, compared: builders and kernels against each other and against a march
 * without a tree, in time, in work, and pixel by pixel.
 *
 * The measure is Zellmann, Hellmann, Lang 2019, section 4: build and picture together, since a
 * transfer function that changes asks for another tree.
 */
#ifndef BB_DVR_H
#define BB_DVR_H

#include "framework/base/statistics.h"
#include "framework/builder/instance.h"
#include "framework/march/march.h"

enum {
    BB_DVR_WAYS_MAX = 64,
    BB_DVR_STEPS_MAX = 12,
    BB_DVR_PICTURES_MAX = 3 * 180,
};

typedef struct bb_dvr_request {
    bb_device *device;
    const char *const *builders; /* specifications */
    uint32_t builder_count;
    const char *const *kernels; /* the same; for volumes */
    uint32_t kernel_count;
    const char *const *searches; /* for tetrahedra: see bb_dvr_search_parse() */
    uint32_t search_count;
    const bb_transfer *transfer; /* for tetrahedra; a volume has its own */
    const char *view;            /* NULL: all of the scene's */
    uint32_t turns; /* 0: these. Else pictures of the paper: in parallel, all of the volume in
                         sight, which is turned about each axis by so many times 2 degrees */
    uint32_t width, height;
    double step;      /* distance of samples, in voxels; of tetrahedra, bb_tet_march_width() */
    double cutoff;    /* see bb_march_settings */
    uint32_t repeats; /* rounds that count, after one that does not */
    uint32_t step_count;
    double steps[BB_DVR_STEPS_MAX]; /* for the accuracy, in voxels; descending */
    uint64_t seed;
    const char *pictures; /* the beginning of paths of PNG files; NULL: none */
} bb_dvr_request;

/* A phase of a build. */
typedef struct bb_dvr_phase {
    char name[48];
    bb_samples ms;
} bb_dvr_phase;

/* A tree and a kernel or search, or no tree. Times in ms; of pictures the mean over all, in each
 * round. */
typedef struct bb_dvr_way {
    char builder[128], kernel[96]; /* "": no tree */
    char refused[320];             /* why there are no figures; "": there are */
    /* layout: with the transfer of a tree that was made on the host */
    bb_samples build, layout, march, march_cpu;
    uint32_t phase_count;
    bb_dvr_phase phases[BB_PHASES_MAX];
    uint32_t nodes, leaves;
    uint32_t references;
    uint64_t tree_bytes;
    uint64_t bytes;     /* of tree and scratch at most, and of the layout */
    double samples;     /* per ray */
    double most;        /* largest difference of a channel from the picture of the first way */
    uint32_t most_8;    /* the same in 8 bits */
    uint64_t differ;    /* pixels that differ at all */
    uint64_t overflown; /* rays for which a stack was too small */
} bb_dvr_way;

/* How far a picture is from one with samples so close that more of them change nothing. */
typedef struct bb_dvr_error {
    double step;      /* in voxels */
    double most, rms; /* over all channels and pictures */
    bb_samples march; /* ms, of the first builder and kernel */
    double samples;   /* per ray */
} bb_dvr_error;

/* One volume or mesh with one transfer function. */
typedef struct bb_dvr_result {
    char scene[256], transfer[64];
    uint32_t dims[3], bytes; /* of the voxels */
    uint32_t brick_side, bricks, seen;
    uint64_t volume_bytes; /* of the bricks */
    bb_samples copy;       /* ms, of all bricks from one buffer to another; empty: no room for it */
    uint32_t tets, vertices, boundary; /* of a mesh; else 0: tetrahedra, those on the boundary */
    char field[64];
    uint32_t pictures;
    uint64_t pixels; /* of all */
    uint32_t way_count;
    bb_dvr_way ways[BB_DVR_WAYS_MAX]; /* the first is without a tree, for a volume */
    uint32_t error_count;
    bb_dvr_error errors[BB_DVR_STEPS_MAX];
    double converged; /* difference of the reference from one of twice its step */
} bb_dvr_result;

/* Measures the scene with the transfer function that it has. What a builder or kernel cannot do is
 * said in its way. Interrupted after a round that counts, it ends with the rounds that there are,
 * and without accuracy; before that it fails. The scene is on the device. */
bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_dvr_result *result);

/* Of the pictures, with build and layout or without, the ratio to the first way. For a volume, that
 * is the march without a tree: below 1 the tree pays. */
bb_estimate bb_dvr_ratio(const bb_dvr_result *result, const bb_dvr_way *way, bool with_build);

/* How tetrahedra are searched: `skip` on any tree; `octree` on one with cells, `interval=no`
 * without intervals by its boundary. BB_INVALID for anything else. */
extern const bb_option bb_dvr_search_options[];
bb_status bb_dvr_search_parse(const char *text, bb_spec *spec);

/* As text on standard output. */
void bb_dvr_print(const bb_dvr_result *result);

/* As JSON: framework/dvr/README.md has the schema. NULL: no memory. The caller's to delete. */
struct cJSON *bb_dvr_json(const bb_dvr_result *result);

#endif
