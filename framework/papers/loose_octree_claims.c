/* Claims of Gu, Jendersie, Grosch 2018, each with what was measured, and where it did not hold, the
 * figures that tell more. */
#include "framework/papers/loose_octree_figures.h"

#include <stdio.h>
#include <string.h>

/* ---- what is said of a pair ---- */

typedef struct pair {
    const char *builder, *kernel, *base, *base_kernel;
} pair;

static const pair llbvh_to_lbvh = {LLBVH30, STACK, LBVH30, STACK};

static bb_selection cell_of(pair p, const char *scene)
{
    return (bb_selection){scene, p.builder, p.kernel, NULL};
}

static bb_selection base_of(pair p, const char *scene)
{
    return (bb_selection){scene, p.base, p.base_kernel, NULL};
}

static bb_estimate ratio_of(const bb_findings *f, const char *scene, pair p, bb_times what)
{
    return bb_found_ratio(f, what, cell_of(p, scene), base_of(p, scene));
}

static double tests_ratio(const bb_findings *f, const char *scene, pair p, bb_field_id tests)
{
    return bb_found_tests(f, cell_of(p, scene), tests) /
           bb_found_tests(f, base_of(p, scene), tests);
}

/* The ratios of all scenes. */
typedef struct ratios {
    bb_paper_figures medians;
    bb_estimate each[BB_FIGURES_MAX];
    bb_estimate mean; /* taken in each round */
} ratios;

static ratios ratios_of(const bb_findings *f, pair p, bb_times what)
{
    ratios all = {.medians = {.f = f}};
    bb_ratio_mean mean = {0};
    for (size_t s = 0; s < f->scene_count; s++) {
        all.each[s] = ratio_of(f, f->scenes[s], p, what);
        all.medians.values[s] = all.each[s].value;
        bb_ratio_mean_add(&mean, f, what, cell_of(p, f->scenes[s]), base_of(p, f->scenes[s]));
    }
    all.mean = bb_ratio_mean_estimate(&mean);
    return all;
}

/* On all scenes, or on most of them: is the ratio above, or below, the bound? */
typedef bb_claim_verdict side_fn(bb_estimate e, double bound);
typedef bb_claim_verdict share_fn(const bb_claim_verdict *each, size_t count);

static bb_claim_verdict of_scenes(share_fn *share, const ratios *all, side_fn *side, double bound)
{
    bb_claim_verdict each[BB_FIGURES_MAX];
    size_t count = all->medians.f->scene_count;
    for (size_t s = 0; s < count; s++)
        each[s] = side(all->each[s], bound);
    return share(each, count);
}

static bb_claim_verdict both(bb_claim_verdict a, bb_claim_verdict b)
{
    return bb_all((const bb_claim_verdict[]){a, b}, 2);
}

/* "build 0.83 on average, 0.56 (city) to 1.02 (hairball), round by round 0.83 [95 %: ...]"
 */
static void say_ratios(bb_words *words, const char *what, const ratios *all)
{
    bb_say_range(words, what, &all->medians);
    bb_say(words, ", round by round ");
    bb_say_estimate(words, all->mean);
}

/* Where the time of a frame goes, and the tests per ray behind it. */
static void say_frame(const bb_findings *f, const char *scene, pair p, bb_words *why)
{
    bb_say(why, "%s%s: build %.2f times as long, trace %.2f times", why->length > 0 ? "; " : "",
           scene, ratio_of(f, scene, p, BB_BUILD_TIME).value,
           ratio_of(f, scene, p, BB_TRACE_TIME).value);
    double boxes = tests_ratio(f, scene, p, BB_F_TRACE_NODE_TESTS);
    double prims = tests_ratio(f, scene, p, BB_F_TRACE_PRIM_TESTS);
    bb_say(why, " with %+.0f %% box tests and %+.0f %% primitive tests per ray", 100 * (boxes - 1),
           100 * (prims - 1));
    if (bb_found_trace_ms(f, base_of(p, scene)) < 0.2 * bb_found_build_ms(f, scene, p.base))
        bb_say(why,
               " (the base traces this frame in less than a fifth of its build time: few rays for "
               "such a scene)");
}

/* ---- mixtures of spheres (section 4.1) ---- */

static void claim_shortest(const bb_findings *f, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict each[BB_FIGURES_MAX];
    for (size_t s = 0; s < f->scene_count; s++) {
        const char *scene = f->scenes[s], *best = best_lobvh(f, scene);
        pair to_lbvh = {best, STACKLESS, LBVH30, STACK},
             to_llbvh = {best, STACKLESS, LLBVH30, STACK};
        bb_estimate lbvh = ratio_of(f, scene, to_lbvh, BB_FRAME_TIME);
        bb_estimate llbvh = ratio_of(f, scene, to_llbvh, BB_FRAME_TIME);
        each[s] = both(bb_below(lbvh, 1), bb_below(llbvh, 1));
        bb_say(&ours, "%s%s: level %d, to LBVH ", s > 0 ? "; " : "", scene, level_of(best));
        bb_say_estimate(&ours, lbvh);
        bb_say(&ours, ", to LLBVH ");
        bb_say_estimate(&ours, llbvh);
        if (each[s] != BB_HELD)
            say_frame(f, scene, to_lbvh, &why);
    }
    bb_claim(r, bb_all(each, f->scene_count),
             "On mixtures of spheres LOBVH has the shortest build + trace (1, 4.1)",
             "shortest, both states", &ours, &why);
}

static void claim_seventh_level(const bb_findings *f, bb_reproduction *r)
{
    const pair p = {LOBVH7, STACKLESS, LOBVH6, STACKLESS};
    ratios build = ratios_of(f, p, BB_BUILD_TIME), trace = ratios_of(f, p, BB_TRACE_TIME);
    bb_words ours = {0}, why = {0};
    bb_claim_verdict similar =
        both(of_scenes(bb_all, &trace, bb_above, 0.85), of_scenes(bb_all, &trace, bb_below, 1.15));
    bb_claim_verdict verdict = both(of_scenes(bb_all, &build, bb_above, 1.1), similar);
    say_ratios(&ours, "build", &build);
    say_ratios(&ours, "trace", &trace);
    for (size_t s = 0; s < f->scene_count && verdict != BB_HELD; s++)
        bb_say(&why,
               "%s%s: %.0f nodes on level 6 and %.0f on level 7, %+.0f %% box tests and %+.0f %% "
               "primitive tests per ray",
               s > 0 ? "; " : "", f->scenes[s],
               bb_found_tree(f, f->scenes[s], LOBVH6, BB_F_TREE_NODES),
               bb_found_tree(f, f->scenes[s], LOBVH7, BB_F_TREE_NODES),
               100 * (tests_ratio(f, f->scenes[s], p, BB_F_TRACE_NODE_TESTS) - 1),
               100 * (tests_ratio(f, f->scenes[s], p, BB_F_TRACE_PRIM_TESTS) - 1));
    bb_claim(
        r, verdict,
        "A seventh level makes LOBVH's build longer (held above 10 %) and leaves its trace (within "
        "15 %) (4.1)",
        "build +70 %, similar tracing times", &ours, &why);
}

static void claim_dense_memory(const bb_findings *f, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    double growth = NAN;
    for (size_t s = 0; s < f->scene_count; s++) {
        double peak[LEVELS];
        for (int i = 0; i < LEVELS; i++)
            peak[i] =
                bb_found_tree(f, f->scenes[s], lobvh_levels[i], BB_F_TREE_BYTES_PEAK) / (1 << 20);
        double here = (peak[2] - peak[1]) / (peak[1] - peak[0]);
        bb_say(&ours, "%s%s: peaks of %.0f, %.0f and %.0f MiB, steps that grow %.1f times",
               s > 0 ? "; " : "", f->scenes[s], peak[0], peak[1], peak[2], here);
        growth = s == 0 ? here : fmin(growth, here);
    }
    if (growth < 6) {
        bb_say(&why,
               "the arrays of the whole octree are not the largest part of the peak here: sorting "
               "and the compacted tree need room by the number of primitives and of nodes that "
               "are not vacant");
        for (int i = 0; i < LEVELS; i++)
            bb_say(&why, "%s%s", i == 0 ? ". The builder says: " : "; ",
                   bb_found_about(f, f->scenes[0], lobvh_levels[i]));
    }
    bb_claim(r, bb_verdict_of(growth >= 6 && growth <= 10, growth, 0),
             "Each further level takes eight times the memory (4.1)",
             "8 times, about 400 MB at level 7", &ours, &why);
}

/* On spheres, LLBVH against LBVH. */
static void claim_llbvh_frame(const bb_findings *f, bb_reproduction *r)
{
    ratios frame = ratios_of(f, llbvh_to_lbvh, BB_FRAME_TIME);
    bb_words ours = {0}, why = {0};
    bb_claim_verdict verdict = of_scenes(bb_all, &frame, bb_above, 1);
    say_ratios(&ours, "build + trace", &frame);
    for (size_t s = 0; s < f->scene_count && verdict != BB_HELD; s++)
        say_frame(f, f->scenes[s], llbvh_to_lbvh, &why);
    bb_claim(r, verdict,
             "Against LBVH, LLBVH's build gets longer by more than its trace gets shorter (4.1)",
             "in both states", &ours, &why);
}

static void claim_llbvh_quality(const bb_findings *f, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    double ratio = NAN;
    for (size_t s = 0; s < f->scene_count; s++) {
        const char *scene = f->scenes[s];
        if (strstr(scene, "state=initial") == NULL)
            continue;
        ratio = bb_found_sah(f, scene, LLBVH30) / bb_found_sah(f, scene, LBVH30);
        bb_say(&ours, "cost %.3f, trace time ", ratio);
        bb_say_estimate(&ours, ratio_of(f, scene, llbvh_to_lbvh, BB_TRACE_TIME));
        if (ratio >= 1)
            say_frame(f, scene, llbvh_to_lbvh, &why);
    }
    bb_claim(r, bb_verdict_of(ratio < 1, ratio, 0),
             "In the initial state LLBVH's hierarchy is slightly better than LBVH's (4.1)",
             "slightly better", &ours, &why);
}

/* `builder`'s tree is smaller than `base`'s on more than half of the scenes. */
static void claim_memory(const bb_findings *f, bb_reproduction *r, const char *builder,
                         const char *base, const char *claim, const char *paper)
{
    bb_words ours = {0}, why = {0};
    uint32_t smaller = 0, known = 0;
    bb_paper_figures s = {.f = f};
    for (size_t i = 0; i < f->scene_count; i++) {
        const char *scene = f->scenes[i];
        s.values[i] = bb_found_tree(f, scene, builder, BB_F_TREE_BYTES) /
                      bb_found_tree(f, scene, base, BB_F_TREE_BYTES);
        smaller += s.values[i] < 1;
        known += !isnan(s.values[i]);
        if (s.values[i] >= 1)
            bb_say(&why, "%s%s: %.0f nodes against %.0f, %.0f leaves against %.0f",
                   why.length > 0 ? "; " : "", scene,
                   bb_found_tree(f, scene, builder, BB_F_TREE_NODES),
                   bb_found_tree(f, scene, base, BB_F_TREE_NODES),
                   bb_found_tree(f, scene, builder, BB_F_TREE_LEAVES),
                   bb_found_tree(f, scene, base, BB_F_TREE_LEAVES));
    }
    bb_say_range(&ours, "bytes of the tree", &s);
    bb_say(&ours, "; less on %u of %u scenes", smaller, known);
    bb_claim(r, bb_verdict_of(2 * smaller > known, bb_figures_mean(&s), 0), claim, paper, &ours,
             &why);
}

/* ---- triangles (section 4.2) ---- */

static void claim_llbvh_build(const bb_findings *f, bb_reproduction *r)
{
    ratios build = ratios_of(f, llbvh_to_lbvh, BB_BUILD_TIME);
    ratios trace = ratios_of(f, llbvh_to_lbvh, BB_TRACE_TIME);
    bb_words ours = {0}, why = {0};
    say_ratios(&ours, "build time to LBVH's", &build);
    bb_claim(r, of_scenes(bb_most, &build, bb_above, 1),
             "On triangles LLBVH's build is often slower than LBVH's (4.2)", "often", &ours, &why);
    ours = (bb_words){0};
    say_ratios(&ours, "trace time to LBVH's", &trace);
    bb_claim_verdict verdict = bb_above(trace.mean, 0.95);
    for (size_t s = 0; s < f->scene_count && verdict != BB_HELD; s++)
        if (trace.medians.values[s] < 1)
            say_frame(f, f->scenes[s], llbvh_to_lbvh, &why);
    bb_claim(
        r, verdict,
        "LLBVH traces triangles hardly faster than LBVH (held above 0.95 of its time on average), "
        "at times slower (4.2)",
        "minimal, if at all; 4 % on hairball", &ours, &why);
}

/* LOBVH's frames against LBVH's: on hairs, or on all but hairs. */
static void claim_lobvh_frame(const bb_findings *f, bb_reproduction *r, bool hairs,
                              const char *claim, const char *paper)
{
    bb_words ours = {0}, why = {0};
    bb_claim_verdict each[BB_FIGURES_MAX];
    size_t count = 0;
    for (size_t s = 0; s < f->scene_count; s++) {
        const char *scene = f->scenes[s];
        pair p = {best_lobvh(f, scene), STACKLESS, LBVH30, STACK};
        if ((strstr(scene, "hair") != NULL) != hairs)
            continue;
        bb_estimate ratio = ratio_of(f, scene, p, BB_FRAME_TIME);
        bb_say(&ours, "%s%s ", ours.length > 0 ? ", " : "", scene);
        bb_say_estimate(&ours, ratio);
        bb_say(&ours, " (level %d)", level_of(p.builder));
        each[count] = hairs ? bb_below(ratio, 1) : bb_above(ratio, 1.1);
        if (each[count++] != BB_HELD)
            say_frame(f, scene, p, &why);
    }
    bb_claim(r, bb_all(each, count), claim, paper, &ours, &why);
}

static void claim_eighth_level(const bb_findings *f, bb_reproduction *r)
{
    const pair p = {LOBVH8, STACKLESS, LOBVH7, STACKLESS};
    ratios build = ratios_of(f, p, BB_BUILD_TIME), trace = ratios_of(f, p, BB_TRACE_TIME);
    bb_words ours = {0}, why = {0};
    bb_claim_verdict verdict =
        both(of_scenes(bb_most, &trace, bb_below, 1), bb_above(build.mean, 1.5));
    say_ratios(&ours, "trace", &trace);
    say_ratios(&ours, "build", &build);
    for (size_t s = 0; s < f->scene_count && verdict != BB_HELD; s++)
        bb_say(&why,
               "%s%s: build %.2f, peak memory %.2f, box tests per ray %+.0f %%, primitive tests "
               "%+.0f %%",
               s > 0 ? "; " : "", f->scenes[s], build.medians.values[s],
               bb_found_tree(f, f->scenes[s], LOBVH8, BB_F_TREE_BYTES_PEAK) /
                   bb_found_tree(f, f->scenes[s], LOBVH7, BB_F_TREE_BYTES_PEAK),
               100 * (tests_ratio(f, f->scenes[s], p, BB_F_TRACE_NODE_TESTS) - 1),
               100 * (tests_ratio(f, f->scenes[s], p, BB_F_TRACE_PRIM_TESTS) - 1));
    bb_claim(r, verdict,
             "With 8 levels instead of 7 LOBVH often traces faster, but the build gets much longer "
             "(held above 1.5 times on average) (4.2)",
             "often; the build grows by a factor like that of the memory, about 8", &ours, &why);
}

/* ---- the size of a box (sections 2 and 3.1) ---- */

/* Why another size traces faster: tests per ray, and where the two put the primitives. */
static void say_other_size(const bb_findings *f, const char *scene, pair p, const char *what,
                           bb_words *why)
{
    bb_say(why, "%s%s on %s: trace %.3f, cost %.3f, box tests %+.0f %%, primitive tests %+.0f %%",
           why->length > 0 ? "; " : "", what, scene, ratio_of(f, scene, p, BB_TRACE_TIME).value,
           bb_found_sah(f, scene, p.builder) / bb_found_sah(f, scene, p.base),
           100 * (tests_ratio(f, scene, p, BB_F_TRACE_NODE_TESTS) - 1),
           100 * (tests_ratio(f, scene, p, BB_F_TRACE_PRIM_TESTS) - 1));
    if (bb_found_about(f, scene, p.builder)[0] != '\0')
        bb_say(why, " (%s; with the smallest side %s)", bb_found_about(f, scene, p.builder),
               bb_found_about(f, scene, p.base));
}

static void claim_smallest(const bb_findings *f, bb_reproduction *r)
{
    static const char *const others[] = {LARGEST, MEAN, VOLUME};
    static const char *const words[] = {"largest side", "mean side", "root of the volume"};
    bb_words ours = {0}, why = {0};
    bb_claim_verdict each[3];
    bb_say(&ours, "mean trace time with another size, to that with the smallest side: ");
    for (int i = 0; i < 3; i++) {
        pair p = {others[i], STACK, SMALLEST, STACK};
        ratios trace = ratios_of(f, p, BB_TRACE_TIME);
        each[i] = bb_above(trace.mean, 1);
        bb_say(&ours, "%s%s ", i > 0 ? ", " : "", words[i]);
        bb_say_estimate(&ours, trace.mean);
        for (size_t s = 0; s < f->scene_count; s++)
            if (trace.medians.values[s] < 0.98)
                say_other_size(f, f->scenes[s], p, words[i], &why);
    }
    bb_claim(
        r, bb_all(each, 3),
        "Levels from the smallest side of the box trace faster than from the largest, the mean "
        "side or the root of the volume (3.1)",
        "all others inferior", &ours, &why);
}

static void claim_size_bits(const bb_findings *f, bb_reproduction *r)
{
    const pair p = {EVEN, STACK, SMALLEST, STACK};
    ratios frame = ratios_of(f, p, BB_FRAME_TIME);
    bb_words ours = {0}, why = {0};
    say_ratios(&ours, "build + trace, with them to without", &frame);
    bb_claim_verdict verdict = bb_above(frame.mean, 0.99);
    for (size_t s = 0; s < f->scene_count && verdict != BB_HELD; s++)
        if (frame.medians.values[s] < 1)
            say_frame(f, f->scenes[s], p, &why);
    bb_claim(r, verdict,
             "Size told every two levels only does not improve build + trace on average (held "
             "above 0.99 of its time) (2)",
             "not improved", &ours, &why);
}

void bb_loose_octree_claims(const bb_findings *all, bb_reproduction *r)
{
    const bb_findings *spheres = &all[OF_SPHERES], *triangles = &all[OF_TRIANGLES];
    claim_shortest(spheres, r);
    claim_seventh_level(spheres, r);
    claim_dense_memory(spheres, r);
    claim_memory(spheres, r, LOBVH6, LBVH30,
                 "On spheres LOBVH of level 6 needs less memory than the binary trees (4.1)",
                 "they have more inner nodes");
    claim_llbvh_frame(spheres, r);
    claim_llbvh_quality(spheres, r);
    claim_llbvh_build(triangles, r);
    claim_lobvh_frame(
        triangles, r, false,
        "On triangles LOBVH is significantly slower than LBVH (held above 1.1 times), but "
        "for hairball (4.2)",
        "much slower in most cases");
    claim_lobvh_frame(triangles, r, true, "On hairball LOBVH is faster than LBVH (4.2)",
                      "faster than both others");
    claim_memory(triangles, r, LLBVH30, LBVH30,
                 "On triangles LLBVH often needs less memory than LBVH (4.2)", "often better");
    claim_eighth_level(triangles, r);
    claim_smallest(&all[OF_SIZES], r);
    claim_size_bits(&all[OF_SIZES], r);
    bb_loose_octree_order_claims(&all[OF_VIEWS], r);
}
