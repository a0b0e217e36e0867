/* Direct volume rendering, compared: builders and kernels against each other and against a march
 * without a tree, in time, in work, and pixel by pixel.
 *
 * The measure is Zellmann, Hellmann, Lang 2019, section 4: build and picture together, since a
 * transfer function that changes asks for another tree.
 */
#ifndef BB_DVR_H
#define BB_DVR_H

#include "framework/contest/contest.h"
#include "framework/march/march.h"
#include "framework/show/outline.h"

enum {
    BB_DVR_STEPS_MAX = 12,
    BB_DVR_PICTURES_MAX = 3 * 180,
};

typedef struct bb_dvr_request {
    bb_device *device;
    const char *const *builders; /* specifications */
    uint32_t builder_count;
    const char *const *kernels; /* the same; for volumes */
    uint32_t kernel_count;
    const char *const *searches; /* for tetrahedra: see bb_tet_search_parse() */
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
    bool quiet;           /* no progress */
    const char *pictures; /* the beginning of paths of PNG files; NULL: none */
} bb_dvr_request;

/* How far a picture is from one with samples so close that more of them change nothing. */
typedef struct bb_dvr_error {
    double step;      /* in voxels */
    double most, rms; /* over all channels and pictures */
    bb_samples march; /* ms, of the first builder and kernel */
    double samples;   /* per ray */
} bb_dvr_error;

/* One volume or mesh with one transfer function. */
typedef struct bb_dvr_result {
    char scene[352], transfer[64]; /* "SCENE, transfer function TRANSFER" */
    uint32_t dims[3], bytes;       /* of the voxels */
    uint32_t brick_side, bricks, seen;
    uint64_t volume_bytes; /* of the bricks */
    bb_samples copy;       /* ms, of all bricks from one buffer to another; empty: no room for it */
    uint32_t tets, vertices, boundary; /* of a mesh; else 0: tetrahedra, those on the boundary */
    char field[64];
    uint32_t pictures;
    uint64_t pixels;     /* of all */
    uint32_t view_count; /* of the scene, which were taken; 0: it was turned */
    char views[BB_VIEWS_MAX][48];
    bool by_others; /* the largest differences are OpenImageIO's, too */
    uint32_t way_count;
    bb_contest_way ways[BB_CONTEST_WAYS_MAX]; /* the first of a volume is without a tree; work:
                                                 samples per ray */
    uint32_t error_count;
    bb_dvr_error errors[BB_DVR_STEPS_MAX];
    double converged; /* difference of the reference from one of twice its step */
} bb_dvr_result;

/* Measures the scene with the transfer function that it has. What a builder or kernel cannot do is
 * said in its way. Interrupted after a round that counts, it ends with the rounds that there are,
 * and without accuracy; before that it fails. The scene is on the device. */
bb_status bb_dvr_run(const bb_dvr_request *request, bb_scene *scene, bb_dvr_result *result);

/* Briefly: without trees, phases and the note. */
extern const bb_page_outline bb_dvr_outline, bb_dvr_outline_briefly;

/* Adds the result to a table. `files`: what the names of its PNG files begin with, as in
 * request->pictures, but from the table's folder; NULL: there are none. */
void bb_dvr_fill(const bb_dvr_request *request, const bb_dvr_result *result, const char *files,
                 bb_table *table);

#endif
