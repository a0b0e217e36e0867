/* EMC-64-var inside other builders: cost, counted work and time per ray of each kind, and build
 * time, over those of the same builder with the plain code of 63 bits. Tables and claims.
 */
#include "framework/papers/emc_methods.h"

#include <math.h>

/* Scenes that a table has columns for. */
enum { SCENES_SHOWN = 20 };

/* Below this, two costs, or two works, are the same. */
static const double same = 0.0005;

static const bb_emc_figure cost = {EMC_COST, NULL}, build = {EMC_BUILD, NULL};

static bb_estimate mean_of(const bb_findings *all, bb_emc_figure figure, int method)
{
    const bb_emc_method *m = &bb_emc_methods[method];
    return bb_emc_mean(all, figure, m->var, m->plain);
}

/* ---- tables ---- */

/* "lower (4 of 7 scenes lower, 1 higher)": by intervals, where there are any. */
static void say_verdict(const bb_findings *all, bb_emc_figure figure, int method, bb_words *words)
{
    const bb_emc_method *m = &bb_emc_methods[method];
    const bb_findings *f = &all[EMC_INSIDE];
    bool exact = figure.what == EMC_COST || figure.what == EMC_WORK;
    double margin = exact ? same : 0;
    bb_estimate mean = mean_of(all, figure, method);
    uint32_t count = 0, lower = 0, higher = 0;
    if (isnan(mean.value)) {
        bb_say(words, "not measured");
        return;
    }
    for (size_t s = 0; s < f->scene_count; s++) {
        bb_estimate e = bb_emc_ratio(all, figure, f->scenes[s], m->var, m->plain);
        count += !isnan(e.value);
        lower += (exact ? e.value : e.high) < 1 - margin;
        higher += (exact ? e.value : e.low) > 1 + margin;
    }
    double low = exact ? mean.value : mean.low, high = exact ? mean.value : mean.high;
    bb_say(words, "%s",
           isnan(low)          ? bb_verdict_words(BB_TOO_FEW_ROUNDS)
           : high < 1 - margin ? "lower"
           : low > 1 + margin  ? "higher"
           : exact             ? "the same"
                               : "undecided");
    if (!isnan(low))
        bb_say(words, " (%u of %u scenes lower, %u higher)", lower, count, higher);
}

/* A figure of each builder and scene. */
static void add_figure(const bb_findings *all, bb_reproduction *r, bb_emc_figure figure,
                       const char *title)
{
    const bb_findings *f = &all[EMC_INSIDE];
    const char *columns[SCENES_SHOWN + 8] = {"builder"};
    bool is_time = figure.what == EMC_TIME || figure.what == EMC_BUILD;
    size_t shown = f->scene_count < SCENES_SHOWN ? f->scene_count : SCENES_SHOWN, count = 1;
    for (size_t s = 0; s < shown; s++)
        columns[count++] = f->scenes[s];
    columns[count++] = "mean";
    if (is_time) {
        columns[count++] = "95 % from";
        columns[count++] = "to";
    }
    columns[count++] = "EMC-64-var is";
    bb_paper_table(r, title, columns);
    for (int i = 0; i < EMC_METHOD_COUNT; i++) {
        const bb_emc_method *m = &bb_emc_methods[i];
        bb_paper_figures s = bb_emc_ratios(all, figure, m->var, m->plain);
        bb_estimate mean = mean_of(all, figure, i);
        bb_words verdict = {0};
        if (!bb_emc_missing(m->plain, &verdict))
            say_verdict(all, figure, i, &verdict);
        bb_paper_row(r);
        bb_paper_text(r, m->name);
        for (size_t k = 0; k < shown; k++)
            bb_paper_number(r, s.values[k], 3);
        bb_paper_number(r, mean.value, 3);
        if (is_time) {
            bb_paper_number(r, mean.low, 3);
            bb_paper_number(r, mean.high, 3);
        }
        bb_paper_text(r, verdict.text);
    }
}

/* Where the cells begin: what that alone does to costs. */
static void add_placement(const bb_findings *all, bb_reproduction *r)
{
    static const char *const columns[] = {
        "builder", "EMC/MC, scene", "EMC/MC, centroids", "MC, centroids/scene", "least", "most",
        NULL};
    bb_paper_table(
        r,
        "EMC-64-var inside builders: cost as a ratio to MC-64, with the scene's box divided "
        "and with that of the centroids; and what that choice alone does to MC-64: a smaller "
        "gain than that is not surely the code's",
        columns);
    for (int i = 0; i < EMC_METHOD_COUNT; i++) {
        bb_paper_figures centred = bb_emc_centred(all, i), placement = bb_emc_placement(all, i);
        bb_words name = {0};
        bb_say(&name, "%s", bb_emc_methods[i].name);
        bb_emc_missing(bb_emc_methods[i].plain, &name);
        bb_paper_row(r);
        bb_paper_text(r, name.text);
        bb_paper_number(r, mean_of(all, cost, i).value, 3);
        bb_paper_number(r, bb_figures_mean(&centred), 3);
        bb_paper_number(r, bb_figures_mean(&placement), 3);
        bb_paper_number(r, bb_figures_least(&placement), 3);
        bb_paper_number(r, bb_figures_most(&placement), 3);
    }
}

static void add_ray_figures(const bb_findings *all, bb_reproduction *r, bb_emc_what what,
                            const char *name)
{
    for (int k = 0; k < EMC_INSIDE_KINDS; k++) {
        bb_words title = {0};
        bb_say(&title, "EMC-64-var inside builders: %s per %s ray, as a ratio to MC-64%s", name,
               bb_emc_rays[k], what == EMC_TIME ? "; geometric mean" : "");
        add_figure(all, r, (bb_emc_figure){what, bb_emc_rays[k]}, title.text);
    }
}

void bb_emc_inside(const bb_findings *all, bb_reproduction *r)
{
    bb_emc_summary(all, r,
                   "EMC-64-var inside builders, as a ratio to the same builder with MC-64 (below "
                   "1: better), means of the scenes: cost (SAH), counted work (1.2 nodes + "
                   "primitives) and time per ray, build. Intervals and scenes: the tables that "
                   "follow",
                   false);
    add_figure(all, r, cost, "EMC-64-var inside builders: cost (SAH), as a ratio to MC-64");
    add_placement(all, r);
    add_ray_figures(all, r, EMC_WORK, "counted work (1.2 nodes + primitives)");
    add_ray_figures(all, r, EMC_TIME, "time");
    add_figure(all, r, build,
               "EMC-64-var inside builders: build time, as a ratio to MC-64; geometric mean");
}

/* ---- claims ---- */

/* For builders of which nobody has said it. */
static void claim_cost(const bb_findings *all, bb_reproduction *r, int method)
{
    const bb_emc_method *m = &bb_emc_methods[method];
    bb_paper_figures s = bb_emc_ratios(all, cost, m->var, m->plain),
                     other = bb_emc_centred(all, method);
    double mean = bb_figures_mean(&s), centred = bb_figures_mean(&other);
    bool holds = mean < 1 - same && centred < 1 - same;
    bb_words claim = {0}, ours = {0}, why = {0};
    bb_say(&claim,
           "EMC-64-var lowers the cost of %s on average, whether the box of the scene or of the "
           "centroids is divided",
           m->name);
    if (!bb_emc_missing(m->plain, &why)) {
        bb_say_range(&ours, "ratio to MC-64 in the scene's box", &s);
        bb_say_range(&ours, "in that of the centroids", &other);
        for (size_t i = 0; i < s.f->scene_count && !holds; i++)
            bb_say(&why, "%s%s %.3f, %.3f", why.length > 0 ? "; " : "per scene: ", s.f->scenes[i],
                   s.values[i], other.values[i]);
    }
    bb_claim(r, bb_verdict_of(holds, mean, centred), claim.text, "not published", &ours, &why);
}

/* By the mean over the scenes, for each kind of rays. */
static void claim_time(const bb_findings *all, bb_reproduction *r, int method)
{
    const bb_emc_method *m = &bb_emc_methods[method];
    bb_claim_verdict each[EMC_INSIDE_KINDS];
    bb_words claim = {0}, ours = {0}, why = {0};
    bool there = !bb_emc_missing(m->plain, &why);
    bb_say(&claim, "EMC-64-var makes rays of every kind faster with %s, on average", m->name);
    for (int k = 0; k < EMC_INSIDE_KINDS; k++) {
        bb_emc_figure figure = {EMC_TIME, bb_emc_rays[k]}, work = {EMC_WORK, bb_emc_rays[k]};
        bb_estimate mean = mean_of(all, figure, method);
        each[k] = bb_emc_below(figure, mean, 1);
        if (!there)
            continue;
        bb_say(&ours, "%s%s ", k > 0 ? ", " : "time, geometric mean of the scenes round by round: ",
               bb_emc_rays[k]);
        bb_say_estimate(&ours, mean);
        if (each[k] != BB_HELD && !isnan(mean.value))
            bb_say(&why, "%s%s: counted work %.3f", why.length > 0 ? "; " : "", bb_emc_rays[k],
                   mean_of(all, work, method).value);
    }
    bb_claim(r, bb_all(each, EMC_INSIDE_KINDS), claim.text, "not published", &ours, &why);
}

/* Does what is saved in cost show in what rays meet? */
static void claim_work_follows(const bb_findings *all, bb_reproduction *r)
{
    uint32_t pairs = 0, follow = 0;
    bb_words ours = {0}, why = {0};
    for (int i = 0; i < EMC_METHOD_COUNT; i++) {
        double costs = mean_of(all, cost, i).value;
        for (int k = 0; k < EMC_INSIDE_KINDS && costs < 1 - same; k++) {
            double work = mean_of(all, (bb_emc_figure){EMC_WORK, bb_emc_rays[k]}, i).value;
            if (isnan(work))
                continue;
            pairs++;
            if (work < 1 - same)
                follow++;
            else
                bb_say(&why, "%s%s: cost %.3f, work per %s ray %.3f", why.length > 0 ? "; " : "",
                       bb_emc_methods[i].name, costs, bb_emc_rays[k], work);
        }
    }
    bb_say(&ours, "lower in %u of %u pairs of builder and kind of rays, by the means of the scenes",
           follow, pairs);
    bb_claim(r, bb_verdict_of(follow == pairs, pairs > 0 ? follow : (double)NAN, 0),
             "Where EMC-64-var lowers a builder's mean cost, it lowers the counted work of rays of "
             "every kind",
             "not published", &ours, &why);
}

/* Codes are a small part of a slow builder's time. */
static void claim_build(const bb_findings *all, bb_reproduction *r)
{
    bb_claim_verdict each[EMC_METHOD_COUNT];
    size_t count = 0;
    bb_words ours = {0}, why = {0};
    for (int i = 0; i < EMC_METHOD_COUNT; i++) {
        const bb_emc_method *m = &bb_emc_methods[i];
        if (i == EMC_LBVH || i == EMC_ATRBVH) /* the paper's own claims */
            continue;
        bb_estimate e = bb_found_build_ratios(&all[EMC_INSIDE], m->var, m->plain);
        each[count] = bb_below(e, bb_emc_build_target);
        bb_say(&ours, "%s%s ",
               count > 0 ? ", " : "geometric mean of the scenes' paired ratios: ", m->name);
        bb_say_estimate(&ours, e);
        if (each[count++] == BB_NOT_TESTED)
            bb_emc_missing(m->plain, &why);
    }
    bb_claim(
        r, bb_all(each, count),
        "EMC-64-var does not increase the build time of other builders (held below 1.05 times)",
        "not published", &ours, &why);
}

void bb_emc_inside_claims(const bb_findings *all, bb_reproduction *r)
{
    static const int unpublished[] = {EMC_PLOC, EMC_HPLOC, EMC_TRBVH, EMC_REINSERTION};
    for (size_t i = 0; i < sizeof unpublished / sizeof unpublished[0]; i++)
        claim_cost(all, r, unpublished[i]);
    for (int i = 0; i < EMC_METHOD_COUNT; i++)
        if (i != EMC_LBVH)
            claim_time(all, r, i);
    claim_work_follows(all, r);
    claim_build(all, r);
}
