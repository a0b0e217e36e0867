/* Zellmann, Hellmann, Lang: A Linear Time BVH Construction Algorithm for Sparse Volumes.
 * PacificVis 2019.
 *
 * Phases of the build (figure 3), and build with picture against a march without a tree (table 1,
 * figure 4), by the size of the volume. Of table 1 there are no numbers in the text that we have:
 * of the paper there are its words. As there, an n-body density, seen in parallel projection, the
 * volume turned about each axis; here fewer turns, smaller pictures, and sizes from 64 on.
 */
#include "framework/dvr/dvr.h"
#include "framework/papers/reproduce.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZES_MAX = 8, BRICK = 8 };

/* Some sizes, and the largest of them with nothing to skip. */
typedef struct measured {
    uint32_t count; /* of sizes */
    uint32_t sides[SIZES_MAX];
    bb_dvr_result results[SIZES_MAX], full;
} measured;

static const bb_experiment experiments[] = {{.name = NULL}};

/* ---- measuring ---- */

static bb_status picture(const bb_reproduce_request *request, uint32_t side, const char *transfer,
                         bb_dvr_result *result, bool *wrong)
{
    static const char *const builders[] = {"vlbvh"}, *const kernels[] = {"stack", "stack8"};
    char name[64];
    bb_scene *scene;
    const bb_dvr_request dvr = {
        .device = request->device,
        .builders = builders,
        .builder_count = 1,
        .kernels = kernels,
        .kernel_count = 2,
        .turns = request->quick ? 1 : 4,
        .width = request->quick ? 16 : 192,
        .height = request->quick ? 16 : 192,
        .step = 0.5,
        .repeats = request->quick         ? 2
                   : request->repeats > 0 ? request->repeats
                                          : 7,
        .seed = request->seed,
        .quiet = request->quiet,
    };
    snprintf(name, sizeof name, "nbody:n=%u%s%s", side, transfer[0] != '\0' ? ",transfer=" : "",
             transfer);
    BB_TRY(bb_scene_load_any(name, &scene));
    bb_status status = bb_scene_upload(scene, request->device);
    if (status == BB_OK)
        status = bb_dvr_run(&dvr, scene, result);
    for (uint32_t w = 0; w < result->way_count && status == BB_OK; w++)
        *wrong = *wrong || result->ways[w].differ > 0;
    bb_tracers_clear(request->device);
    bb_scene_free(scene);
    return status;
}

static bb_status measure(const bb_reproduce_request *request, void **out, bool *wrong)
{
    measured *m = calloc(1, sizeof *m);
    *out = m;
    if (m == NULL)
        return bb_fail(BB_REFUSED, "reproduce: no memory");
    const uint32_t first = request->quick ? 24 : 64;
    for (uint64_t side = first; m->count < SIZES_MAX; side *= 2) {
        const uint64_t bricks = side / BRICK * (side / BRICK) * (side / BRICK);
        if (bricks > request->max_prims || (request->quick && m->count == 2))
            break;
        m->sides[m->count] = (uint32_t)side;
        BB_TRY(picture(request, (uint32_t)side, "", &m->results[m->count], wrong));
        m->count++;
    }
    const uint32_t last = m->count < 3 ? m->count - 1 : 2; /* a full volume takes long */
    return picture(request, m->sides[last], "full", &m->full, wrong);
}

/* ---- tables ---- */

/* By stack; the first way is without a tree. */
static const bb_contest_way *way_of(const bb_dvr_result *r)
{
    return &r->ways[1];
}

static double phase_ms(const bb_contest_way *way, const char *name)
{
    for (uint32_t p = 0; p < way->phase_count; p++)
        if (strcmp(way->phases[p].name, name) == 0)
            return bb_samples_median(&way->phases[p].ms);
    return NAN;
}

static double vote_share(const bb_contest_way *way)
{
    double sum = 0;
    for (uint32_t p = 0; p < way->phase_count; p++)
        sum += bb_samples_median(&way->phases[p].ms);
    return phase_ms(way, "vote") / sum;
}

static double frame_ms(const bb_contest_way *way)
{
    return bb_samples_median(&way->build) + bb_samples_median(&way->layout) +
           bb_samples_median(&way->answer);
}

static void add_phases(const measured *m, bb_reproduction *r)
{
    static const char *const columns[] = {"volume",      "build ms", "vote", "compact",
                                          "codes",       "boxes",    "sort", "link",
                                          "vote, share", "ns/voxel", NULL};
    static const char *const phases[] = {"vote", "compact", "codes", "boxes", "sort", "link"};
    bb_paper_table_begin(r, "Phases of the build, ms (figure 3)", columns);
    for (uint32_t i = 0; i < m->count; i++) {
        const bb_contest_way *way = way_of(&m->results[i]);
        const double voxels = pow(m->sides[i], 3), build = bb_samples_median(&way->build);
        bb_paper_row(r);
        bb_paper_text(r, m->results[i].scene);
        bb_paper_number(r, build, 3);
        for (size_t p = 0; p < sizeof phases / sizeof phases[0]; p++)
            bb_paper_number(r, phase_ms(way, phases[p]), 3);
        bb_paper_number(r, vote_share(way), 3);
        bb_paper_number(r, 1e6 * build / voxels, 3);
    }
}

static void add_frame(const bb_dvr_result *result, bb_reproduction *r)
{
    for (uint32_t w = 0; w < result->way_count; w++) {
        const bb_contest_way *way = &result->ways[w];
        const bb_estimate all = bb_contest_ratio(&result->ways[0], way, true);
        const bool tree = way->builder[0] != '\0';
        bb_paper_row(r);
        bb_paper_text(r, result->scene);
        bb_paper_text(r, tree ? way->search : "no tree");
        bb_paper_number(r, tree ? bb_samples_median(&way->build) : (double)NAN, 2);
        bb_paper_number(r, bb_samples_median(&way->answer), 2);
        bb_paper_number(r, tree ? frame_ms(way) : bb_samples_median(&way->answer), 2);
        bb_paper_number(r, bb_contest_ratio(&result->ways[0], way, false).value, 3);
        bb_paper_number(r, all.value, 3);
        bb_paper_number(r, all.low, 3);
        bb_paper_number(r, all.high, 3);
        bb_paper_number(r, way->work, 1);
        bb_paper_number(r, (double)way->differ, 0);
    }
}

static void add_frames(const measured *m, bb_reproduction *r)
{
    static const char *const columns[] = {"volume",  "kernel",  "build ms",     "picture ms",
                                          "both ms", "picture", "both",         "95 % from",
                                          "to",      "samples", "wrong pixels", NULL};
    bb_paper_table_begin(
        r,
        "Build and picture against a march without a tree, ratios (table 1, figure 4); the "
        "last volume has nothing to skip",
        columns);
    for (uint32_t i = 0; i < m->count; i++)
        add_frame(&m->results[i], r);
    add_frame(&m->full, r);
}

/* ---- claims ---- */

static const bb_dvr_result *largest(const measured *m)
{
    return &m->results[m->count - 1];
}

/* Round by round: of one phase over the whole build; of pictures over those without a tree. */
static bb_samples vote_shares(const bb_contest_way *way)
{
    bb_samples shares = {.count = 0};
    for (uint32_t p = 0; p < way->phase_count; p++)
        if (strcmp(way->phases[p].name, "vote") == 0)
            shares = bb_samples_ratio(&way->phases[p].ms, &way->build);
    return shares;
}

static bb_samples picture_ratios(const bb_dvr_result *result)
{
    return bb_samples_ratio(&way_of(result)->answer, &result->ways[0].answer);
}

static bb_estimate estimate_of(const bb_samples *samples, const bb_samples *over, double divisor)
{
    const bb_samples ratio = bb_samples_ratio(samples, over);
    bb_estimate e = bb_samples_estimate(&ratio);
    double *const figures[] = {&e.value, &e.low, &e.high, &e.least, &e.most};
    for (size_t i = 0; i < sizeof figures / sizeof figures[0]; i++)
        *figures[i] /= divisor;
    return e;
}

static void claim_voting(const measured *m, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict each[SIZES_MAX];
    bb_samples before = {.count = 0};
    for (uint32_t i = 0; i < m->count; i++) {
        const bb_samples shares = vote_shares(way_of(&m->results[i]));
        bb_say(&ours, "%s%u: ", i > 0 ? "; " : "share of the vote at ", m->sides[i]);
        bb_say_estimate(&ours, bb_samples_estimate(&shares));
        each[i] = i == 0 ? bb_above(bb_samples_estimate(&shares), 0)
                         : bb_above(estimate_of(&shares, &before, 1), 1);
        if (i + 1 == m->count)
            each[0] = bb_above(bb_samples_estimate(&shares), 0.5);
        before = shares;
    }
    bb_say(&why, "bricks that are seen become fewer, relative to voxels, the finer the grid");
    bb_claim(
        r, m->count < 3 ? BB_NOT_TESTED : bb_all(each, m->count),
        "Voting dominates the build more and more, the larger the volume (here: its share grows "
        "with each size, and is above a half at the largest)",
        "section 4, figure 3", &ours, &why);
}

static void claim_linear(const measured *m, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict verdict = BB_NOT_TESTED;
    if (m->count >= 3) {
        const bb_estimate e =
            estimate_of(&way_of(largest(m))->build, &way_of(&m->results[m->count - 2])->build, 8);
        verdict = bb_below(e, 1.5);
        bb_say(&ours, "a voxel at %u over one at %u: ", m->sides[m->count - 1],
               m->sides[m->count - 2]);
        bb_say_estimate(&ours, e);
    }
    bb_claim(r, verdict,
             "The build takes linear time (here: per voxel at most 1.5 times as much at twice the "
             "side)",
             "section 3", &ours, &why);
}

static void claim_frame(const measured *m, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    const bb_dvr_result *result = largest(m);
    const bb_estimate both = bb_contest_ratio(&result->ways[0], way_of(result), true);
    bb_say(&ours, "at %u: ", m->sides[m->count - 1]);
    bb_say_estimate(&ours, both);
    bb_say(&why, "%.1f of %.1f samples are left, %.1f %% of the bricks are seen",
           way_of(result)->work, result->ways[0].work,
           100.0 * result->seen / fmax(result->bricks, 1));
    bb_claim(r, bb_below(both, 0.5),
             "Build and picture together are two to three times as fast as a march without a tree "
             "(here: less than half of its time, at the largest volume)",
             "2 to 3 times at 1024^3", &ours, &why);
}

static void claim_gain(const measured *m, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict each[SIZES_MAX];
    bb_samples before = {.count = 0};
    for (uint32_t i = 0; i < m->count; i++) {
        const bb_samples ratios = picture_ratios(&m->results[i]);
        bb_say(&ours, "%s%u: ", i > 0 ? "; " : "picture, ratio at ", m->sides[i]);
        bb_say_estimate(&ours, bb_samples_estimate(&ratios));
        if (i > 0)
            each[i - 1] = bb_below(estimate_of(&ratios, &before, 1), 1);
        before = ratios;
    }
    bb_claim(r, m->count < 3 ? BB_NOT_TESTED : bb_all(each, m->count - 1),
             "Of the picture alone, the gain by the tree increases with the size of the volume",
             "section 4", &ours, &why);
}

static void claim_full(const measured *m, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    const bb_estimate picture = bb_contest_ratio(&m->full.ways[0], way_of(&m->full), false);
    bb_say(&ours, "%s: ", m->full.scene);
    bb_say_estimate(&ours, picture);
    bb_say(&why, "all samples are left, and the tree's nodes come on top");
    bb_claim(r, bb_above(picture, 1),
             "With no empty space at all, the picture by the tree is slower than without one",
             "section 4", &ours, &why);
}

static void evaluate(const bb_findings *findings, const void *opaque, bb_reproduction *r)
{
    const measured *m = opaque;
    (void)findings;
    if (m == NULL)
        return;
    add_phases(m, r);
    add_frames(m, r);
    claim_voting(m, r);
    claim_linear(m, r);
    claim_frame(m, r);
    claim_gain(m, r);
    claim_full(m, r);
}

extern const bb_paper bb_paper_volume;
const bb_paper bb_paper_volume = {
    .name = "volume",
    .title = "Zellmann, Hellmann, Lang 2019: A Linear Time BVH Construction Algorithm for Sparse "
             "Volumes",
    .experiments = experiments,
    .builders = "vlbvh",
    .measure = measure,
    .release = free,
    .evaluate = evaluate,
};
