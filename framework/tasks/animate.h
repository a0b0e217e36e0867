/* Moving scenes: methods, which keep a tree up to date in their own ways, frame by frame.
 *
 * All methods go through the frames together, in a random order within each frame, so that noise
 * is theirs in common; the whole sequence is repeated. In the first round, which is not measured,
 * every tree is checked and every answer judged against an oracle of that frame; in the others each
 * answer must be the same again.
 */
#ifndef BB_ANIMATE_H
#define BB_ANIMATE_H

#include "framework/base/statistics.h"
#include "framework/bench/audit.h"
#include "framework/builder/instance.h"
#include "framework/judge/accuracy.h"
#include "framework/picture/canvas.h"
#include "framework/simulate/simulate.h"
#include "framework/table/outline.h"
#include "traversal/traversal.h"

enum {
    BB_ANIMATE_METHODS_MAX = 24,
    BB_ANIMATE_KERNELS_MAX = 4,
    BB_ANIMATE_RAYS_MAX = 4,
    BB_ANIMATE_ROUNDS_MAX = 32,
    /* per pair of kernels of two methods: rounds, medians, and a pair of each one's own */
    BB_ANIMATE_INTERVALS_MAX =
        BB_ANIMATE_KERNELS_MAX * BB_ANIMATE_KERNELS_MAX * (BB_ANIMATE_ROUNDS_MAX + 2) + 1,
    BB_ANIMATE_YARDSTICKS_MAX = 4, /* builders that say they are (bb_builder.yardstick) */
};

typedef struct bb_animate_request {
    bb_device *device;
    const char *const *builders; /* specifications: the methods */
    uint32_t builder_count;
    const char *const *kernels;
    uint32_t kernel_count;
    const char *const *rays;
    uint32_t ray_count;
    const char *intersector;
    const char *view; /* NULL: the scene's first */
    uint32_t width, height, max_rays;
    uint32_t first, last; /* frames; last may be beyond the scene's */
    uint32_t repeats;     /* rounds that count */
    double ends_ms; /* bb_wall_ms() at which they are to end: then there are fewer; 0: any time */
    uint64_t seed;
    bool counting;        /* counts tests of each ray in the first round */
    bool quiet;           /* no progress */
    bool strip;           /* draw some of the frames */
    bb_audit *audit;      /* gets all timings; NULL: none is asked for */
    bb_bystanders *watch; /* of other programs; NULL: nobody is warned */
    const bb_simt *simts; /* simulations of the traces of the first and the last frame */
    uint32_t simt_count;
} bb_animate_request;

/* Of one round. NAN: not measured. */
typedef double bb_rounds[BB_ANIMATE_ROUNDS_MAX];

/* A kernel on a method's tree in one frame. Times in ms. */
typedef struct bb_animate_trace {
    bb_rounds layout;
    bool in_place; /* the layout followed without being numbered anew */
    bb_rounds rays[BB_ANIMATE_RAYS_MAX];
    uint64_t checked, wrong; /* answers */
    /* of all rays, if they are counted: tests of boxes and primitives; rays that needed more stack
     * than there is */
    uint64_t tests, overflowed;
} bb_animate_trace;

/* A method in one frame. */
typedef struct bb_animate_frame {
    bb_update_way way; /* of the first frame BB_REBUILT: it is built */
    bb_rounds update, update_cpu, transfer;
    uint32_t phase_count;
    char phases[BB_PHASES_MAX][48];
    bb_rounds phase_ms[BB_PHASES_MAX];
    uint32_t event_count;
    char events[BB_EVENTS_MAX][32];
    uint64_t event_numbers[BB_EVENTS_MAX];
    double sah;
    bb_tree_info tree;
    uint64_t tree_bytes;
    bb_animate_trace traces[BB_ANIMATE_KERNELS_MAX];
} bb_animate_frame;

typedef struct bb_animate_method {
    char builder[128];
    char refused[320]; /* why it has no figures from frame `done` on; "": it has all */
    bb_status refusal; /* its status; BB_OK: it has all */
    bool failed;       /* that is a fault: a tree that does not hold, answers that change */
    uint32_t done;     /* frames */
    uint64_t most_bytes;
    bb_animate_frame *frames;
    bb_simulation *simulations; /* bb_animate_simulation() finds them; NULL: none */
    char unsimulated[BB_ANIMATE_KERNELS_MAX][320]; /* why there are none of a kernel; "": there are,
                                                    * or none was asked for */
} bb_animate_method;

/* What all methods share in a frame. */
typedef struct bb_animate_state {
    uint32_t frame, prims;
    uint32_t rays[BB_ANIMATE_RAYS_MAX]; /* 0: the scene has none there */
    /* of trees that the yardsticks make for this frame; NAN: not known; and the least of them */
    double fresh[BB_ANIMATE_YARDSTICKS_MAX], fresh_best;
    double oracle_ms, judge_ms;
    /* since the frame before: the share of primitives whose boxes are others, and how far the
     * middles of these have gone, in diagonals of the scene: the median, 0 if there are none. NAN
     * of the first frame, and where there are more or fewer primitives than before */
    double moved, moved_by;
} bb_animate_state;

typedef struct bb_animate_result {
    char scene[256], view[48];
    uint32_t ignored;     /* parts of the scene's file, see bb_scene */
    uint32_t frame_count; /* of those asked for, that were gone through and judged */
    bb_animate_state *states;
    uint32_t yardstick_count;
    char yardsticks[BB_ANIMATE_YARDSTICKS_MAX][64];
    uint32_t method_count;
    bb_animate_method methods[BB_ANIMATE_METHODS_MAX];
    uint32_t kernel_count, ray_count;
    char kernels[BB_ANIMATE_KERNELS_MAX][96], rays[BB_ANIMATE_RAYS_MAX][96];
    char intersector[96];
    uint32_t simulation_count;
    char simulations[BB_SIMT_MAX][80]; /* their names */
    uint32_t rounds;                   /* that count and are complete */
    double ms;                         /* all together */
    bb_canvas strip;                   /* up to eight frames side by side, if it was asked for */
} bb_animate_result;

/* The scene is on the device. BB_INVALID for frames that there are not. Interrupted after a round
 * that counts, it ends with the rounds that there are; before that it fails. After a failure the
 * result has what was judged and the rounds that were complete. Afterwards the scene is at any
 * frame. */
bb_status bb_animate_run(const bb_animate_request *request, bb_scene *scene,
                         bb_animate_result *result);
void bb_animate_release(bb_animate_result *result);

/* Returns the simulation of a method's trace in a frame: of the first and the last there are some.
 * NULL: there is none. */
const bb_simulation *bb_animate_simulation(const bb_animate_result *result,
                                           const bb_animate_method *method, uint32_t frame,
                                           uint32_t kernel, uint32_t rays, uint32_t simulation);

/* Wrong answers of all methods. */
uint64_t bb_animate_wrong(const bb_animate_result *result);
/* Methods that ended with a fault: a tree that does not hold, answers that change. */
uint32_t bb_animate_failed(const bb_animate_result *result);

/* ---- sums ---- */

/* Median over the rounds that count and in which it was measured; NAN if there is none. */
double bb_animate_median(const bb_animate_result *result, const bb_rounds rounds);

/* Of a method over all frames but the first, which is a build for all. Rounds are means, in ms; NAN
 * where it lacks a frame. */
typedef struct bb_animate_sums {
    uint32_t frames;
    uint32_t ways[BB_REBUILT + 1];
    bb_rounds update, update_cpu, transfer;
    double worst_update;  /* maximum */
    uint32_t worst_frame; /* whose update that was */
    bb_rounds layout[BB_ANIMATE_KERNELS_MAX];
    uint32_t in_place[BB_ANIMATE_KERNELS_MAX]; /* frames */
    /* of frames with such rays */
    bb_rounds traces[BB_ANIMATE_KERNELS_MAX][BB_ANIMATE_RAYS_MAX];
    double rays[BB_ANIMATE_RAYS_MAX]; /* mean counts */
    /* over the least of a tree made for the frame, of frames whose scene has an area; NAN: none */
    double sah_mean, sah_most, sah_last;
    double fresh_most[BB_ANIMATE_YARDSTICKS_MAX]; /* over that of each yardstick */
    double drift;                                 /* of the ratio to the least, per frame */
    uint64_t kernel_wrong[BB_ANIMATE_KERNELS_MAX], wrong, checked; /* in all frames */
} bb_animate_sums;

bb_animate_sums bb_animate_sum(const bb_animate_result *result, const bb_animate_method *method);

/* What a frame's time is made of. */
enum {
    BB_ANIMATE_UPDATE = 1u << 0,
    BB_ANIMATE_TRANSFER = 1u << 1,
    BB_ANIMATE_LAYOUT = 1u << 2, /* of one kernel, as is tracing */
    BB_ANIMATE_TRACE = 1u << 3,
};

/* Sums of those parts over all frames but the first, ms: one sample per round, the judged one being
 * the first, which counts for nothing. Rounds of two methods pair. Empty if it lacks frames. */
bb_samples bb_animate_samples(const bb_animate_result *result, const bb_animate_method *method,
                              uint32_t kernel, uint32_t parts);

/* ---- who is fastest (animate_winner.c) ---- */

/* Times that differ by less count as equal; `advise` takes the same share. */
#define BB_ANIMATE_TIE 0.05

/* Mean time of a frame with `count` rays of kind `rays`: update, transfer, layout, and tracing by
 * the kernel that makes it shortest, of those whose answers are all right. NAN if there is none, or
 * nothing was measured. */
double bb_animate_frame_ms(const bb_animate_result *result, const bb_animate_method *method,
                           uint32_t rays, double count, uint32_t *kernel);

/* Whether the method takes less time than method `with`, each by its best kernel: in the medians by
 * more than BB_ANIMATE_TIE, and in each round. */
bool bb_animate_is_faster(const bb_animate_result *result, const bb_animate_method *method,
                          const bb_animate_method *with, uint32_t rays, double count);

/* Numbers of rays per frame. */
typedef struct bb_animate_interval {
    double from, to; /* to: INFINITY if it has no end */
} bb_animate_interval;

/* For how many rays of kind `rays` per frame the method is faster than method `with`: intervals, in
 * order, and how many (0: for none, or nothing was measured). */
uint32_t bb_animate_faster(const bb_animate_result *result, const bb_animate_method *method,
                           const bb_animate_method *with, uint32_t rays,
                           bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX]);

/* The first method that built anew each frame in which anything moved, with which others are
 * compared; NULL if there is none. */
const bb_animate_method *bb_animate_rebuilder(const bb_animate_result *result);

/* The method of the least time then; BB_NONE if there is none. Others may be as fast, for all that
 * can be told: those that it is not faster than. */
uint32_t bb_animate_winner(const bb_animate_result *result, uint32_t rays, double count);

/* Whether method `m` is another that is as fast as the winner. */
bool bb_animate_ties(const bb_animate_result *result, uint32_t winner, uint32_t m, uint32_t rays,
                     double count);

/* ---- output ---- */

/* Briefly: without charts and frames. */
extern const bb_page_outline bb_animate_outline, bb_animate_outline_briefly;

/* Adds the result, which has a frame, to a table. `strip`: the path of its picture of frames from
 * the table's folder; NULL: there is none. */
void bb_animate_fill(const bb_animate_result *result, const char *strip, bb_table *table);

#endif
