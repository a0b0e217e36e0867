/* Builders beside each other, with the plain code of 63 bits: what the ratios of extended codes are
 * ratios to. Not of the paper, but for ATRBVH over LBVH (table 2). Table and claims.
 *
 * That cost (SAH) and what rays meet do not go together for all kinds of builders: Aila, Karras,
 * Laine 2013, On Quality Metrics of Bounding Volume Hierarchies.
 */
#include "framework/papers/emc_methods.h"

#include <math.h>

static const bb_emc_figure cost = {EMC_COST, NULL}, build = {EMC_BUILD, NULL},
                           work = {EMC_WORK, "random"};

void bb_emc_summary(const bb_findings *all, bb_reproduction *r, const char *title, bool beside)
{
    static const char *const columns[] = {"builder",      "cost",         "work primary",
                                          "work diffuse", "work shadow",  "work random",
                                          "time primary", "time diffuse", "time shadow",
                                          "time random",  "build",        NULL};
    bb_paper_table(r, title, columns);
    for (int i = 0; i < EMC_METHOD_COUNT; i++) {
        const bb_emc_method *m = &bb_emc_methods[i];
        const char *builder = beside ? m->plain : m->var;
        const char *base = beside ? bb_emc_methods[EMC_LBVH].plain : m->plain;
        bb_words name = {0};
        bb_say(&name, "%s", m->name);
        bb_emc_missing(m->plain, &name);
        bb_paper_row(r);
        bb_paper_text(r, name.text);
        bb_paper_number(r, bb_emc_mean(all, cost, builder, base).value, 3);
        for (bb_emc_what what = EMC_WORK; what <= EMC_TIME; what++)
            for (int k = 0; k < EMC_INSIDE_KINDS; k++) {
                bb_emc_figure figure = {what, bb_emc_rays[k]};
                bb_paper_number(r, bb_emc_mean(all, figure, builder, base).value, 3);
            }
        bb_paper_number(r, bb_emc_mean(all, build, builder, base).value, 3);
    }
}

void bb_emc_builders(const bb_findings *all, bb_reproduction *r)
{
    bb_emc_summary(all, r,
                   "Builders with MC-64, as a ratio to LBVH with MC-64 (below 1: better), means of "
                   "the scenes",
                   true);
}

/* ---- claims ---- */

static double over_lbvh(const bb_findings *all, bb_emc_figure figure, int method)
{
    return bb_emc_mean(all, figure, bb_emc_methods[method].plain, bb_emc_methods[EMC_LBVH].plain)
        .value;
}

static const int agglomerative[] = {EMC_AAC_HQ, EMC_AAC_FAST, EMC_PLOC, EMC_HPLOC};
enum { AGGLOMERATIVE = sizeof agglomerative / sizeof agglomerative[0] };

static void claim_flattered(const bb_findings *all, bb_reproduction *r)
{
    bb_claim_verdict each[AGGLOMERATIVE];
    bb_words ours = {0}, why = {0};
    for (int i = 0; i < AGGLOMERATIVE; i++) {
        const char *name = bb_emc_methods[agglomerative[i]].name;
        double costs_less = over_lbvh(all, cost, agglomerative[i]),
               works_less = over_lbvh(all, work, agglomerative[i]);
        each[i] = bb_verdict_of(works_less > costs_less, works_less, costs_less);
        if (each[i] == BB_NOT_TESTED)
            continue;
        bb_say(&ours, "%s%s: cost %.3f, work %.3f", ours.length > 0 ? "; " : "", name, costs_less,
               works_less);
        if (each[i] != BB_HELD)
            bb_say(&why, "%s%s saves no less work than cost", why.length > 0 ? "; " : "", name);
    }
    bb_claim(
        r, bb_all(each, AGGLOMERATIVE),
        "Cost (SAH) flatters agglomerative builders: over LBVH, they save less counted work of "
        "random rays than cost",
        "not of this paper", &ours, &why);
}

static void claim_hlbvh(const bb_findings *all, bb_reproduction *r)
{
    bb_claim_verdict each[AGGLOMERATIVE];
    bb_words ours = {0}, why = {0};
    double least = over_lbvh(all, work, EMC_HLBVH);
    if (!isnan(least))
        bb_say(&ours, "over LBVH: HLBVH %.3f", least);
    for (int i = 0; i < AGGLOMERATIVE; i++) {
        const char *name = bb_emc_methods[agglomerative[i]].name;
        double other = over_lbvh(all, work, agglomerative[i]);
        each[i] = bb_verdict_of(least < other, least, other);
        if (each[i] == BB_NOT_TESTED)
            continue;
        bb_say(&ours, ", %s %.3f", name, other);
        if (each[i] != BB_HELD)
            bb_say(&why, "%s%s works no more", why.length > 0 ? "; " : "", name);
    }
    bb_claim(r, bb_all(each, AGGLOMERATIVE),
             "HLBVH asks for less counted work of random rays than AAC, PLOC (radius 8) and H-PLOC",
             "not of this paper", &ours, &why);
}

static void claim_radius(const bb_findings *all, bb_reproduction *r)
{
    static const double margin = 0.02;
    static const struct {
        const char *radius, *builder;
    } wider[] = {{"16", EMC_PLOC_RADIUS("16")}, {"32", EMC_PLOC_RADIUS("32")}};
    enum { WIDER = sizeof wider / sizeof wider[0] };
    bb_claim_verdict each[WIDER];
    bb_words ours = {0}, why = {0};
    for (int i = 0; i < WIDER; i++) {
        bb_paper_figures s = {.f = &all[EMC_CENTRED]};
        bb_words what = {0};
        for (size_t k = 0; k < s.f->scene_count; k++)
            s.values[k] = bb_found_sah(s.f, s.f->scenes[k], wider[i].builder) /
                          bb_found_sah(s.f, s.f->scenes[k], bb_emc_methods[EMC_PLOC].centred_plain);
        double mean = bb_figures_mean(&s);
        each[i] = bb_verdict_of(fabs(mean - 1) < margin, mean, 0);
        bb_say(&what, "radius %s", wider[i].radius);
        bb_say_range(&ours, what.text, &s);
        if (each[i] == BB_NOT_HELD)
            bb_say(&why, "%sradius %s: %+.1f %%", why.length > 0 ? "; " : "", wider[i].radius,
                   100 * (mean - 1));
    }
    bb_claim(r, bb_all(each, WIDER),
             "PLOC's cost hardly changes (held below 2 % on average) with a radius beyond 8",
             "not of this paper", &ours, &why);
}

void bb_emc_builder_claims(const bb_findings *all, bb_reproduction *r)
{
    claim_flattered(all, r);
    claim_hlbvh(all, r);
    claim_radius(all, r);
}
