/* Claims of Gu, Jendersie, Grosch 2018 on the order by the view's direction (section 3.4). */
#include "framework/papers/loose_octree_figures.h"

/* Factors of the order over scenes and views. */
typedef struct factors {
    double mean, least, most;
    uint32_t apart; /* whose interval lies outside of 0.95 to 1.05 */
    uint32_t count;
} factors;

static factors factors_of(const bb_findings *f, const char *builder, const char *kernel)
{
    double sum = 0;
    factors all = {.mean = NAN, .least = NAN, .most = NAN};
    for (size_t s = 0; s < f->scene_count; s++)
        for (int v = 0; v < VIEWS; v++) {
            bb_estimate e = view_factor(f, f->scenes[s], builder, kernel, v, v);
            if (isnan(e.value))
                continue;
            sum += e.value;
            all.count++;
            all.least = fmin(all.least, e.value);
            all.most = fmax(all.most, e.value);
            all.apart += e.low > 1.05 || e.high < 0.95;
        }
    all.mean = all.count > 0 ? sum / all.count : (double)NAN;
    return all;
}

static void claim_order(const bb_findings *f, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    factors all = factors_of(f, LOBVH_VIEWLESS, STACKLESS);
    bb_say(&ours, "LOBVH %.2f on average, %.2f to %.2f", all.mean, all.least, all.most);
    for (int i = 0; i < 2; i++) {
        factors other = factors_of(f, ordered[i], STACKLESS);
        bb_say(&ours, "; %s %.2f, %.2f to %.2f", ordered[i], other.mean, other.least, other.most);
    }
    for (size_t s = 0; s < f->scene_count && !(all.mean >= 5); s++) {
        const char *view = bb_found_view(f, f->scenes[s], 0);
        bb_cell plain = {f->scenes[s], LOBVH_VIEWLESS, STACKLESS, view};
        bb_cell with = {f->scenes[s], LOBVH_VIEWLESS ",view=0", STACKLESS, view};
        bb_cell stack = {f->scenes[s], LOBVH_VIEWLESS, STACK, view};
        bb_say(&why,
               "%s%s, view %s: %.0f box tests per ray without an order, %.0f with it, where the "
               "stack kernel, which goes to the nearer child first on each ray, needs %.0f",
               s > 0 ? "; " : "", f->scenes[s], view,
               bb_found_tests(f, plain, "node_tests_per_ray"),
               bb_found_tests(f, with, "node_tests_per_ray"),
               bb_found_tests(f, stack, "node_tests_per_ray"));
    }
    bb_claim(r, bb_verdict_of(all.mean >= 5, all.mean, 0),
             "The order by the view makes the stackless traversal of LOBVH faster by an order of "
             "magnitude (held from 5 times) (3.4)",
             "an order of magnitude", &ours, &why);
}

/* How far an order changes a ray's box tests on the stack kernel, at most over scenes and views. */
static double stack_tests_change(const bb_findings *f, const char *builder)
{
    double most = NAN;
    for (size_t s = 0; s < f->scene_count; s++)
        for (int v = 0; v < VIEWS; v++) {
            char with[128];
            const char *view = bb_found_view(f, f->scenes[s], v);
            snprintf(with, sizeof with, "%s,view=%d", builder, v);
            double ratio = bb_found_tests(f, (bb_cell){f->scenes[s], with, STACK, view},
                                          "node_tests_per_ray") /
                           bb_found_tests(f, (bb_cell){f->scenes[s], builder, STACK, view},
                                          "node_tests_per_ray");
            most = fmax(most, fabs(ratio - 1));
        }
    return most;
}

/* Not held only where an interval shows a difference; a mean that is off by noise alone decides nothing. */
static void claim_order_with_stack(const bb_findings *f, bb_reproduction *r)
{
    bb_words ours = {0}, why = {0};
    double farthest = 0;
    uint32_t apart = 0, count = 0;
    for (int i = 0; i < 2; i++) {
        factors all = factors_of(f, ordered[i], STACK);
        bb_say(&ours, "%s%s %.3f on average, %.3f to %.3f", i > 0 ? "; " : "", ordered[i], all.mean,
               all.least, all.most);
        farthest = isnan(all.mean) ? (double)NAN : fmax(farthest, fabs(all.mean - 1));
        apart += all.apart;
        count += all.count;
        bb_say(&why, "%s%s: box tests per ray change by %.1f %% at most", i > 0 ? "; " : "",
               ordered[i], 100 * stack_tests_change(f, ordered[i]));
    }
    bb_say(&ours, "; %u of %u intervals lie outside of 0.95 to 1.05", apart, count);
    bool holds = farthest < 0.05 && 4 * apart <= count;
    if (!holds)
        bb_say(&why,
               ": the order also deals out the bits of a triple by the direction, so that it is "
               "another tree");
    bb_claim(r, holds || apart > 0 ? bb_verdict_of(holds, farthest, 0) : BB_NOT_TESTED,
             "On the binary trees, traced with a stack, the order by the view does almost nothing "
             "(held within 5 % on average) (3.4)",
             "almost non-existent", &ours, holds ? &(bb_words){0} : &why);
}

void bb_loose_octree_order_claims(const bb_findings *f, bb_reproduction *r)
{
    claim_order(f, r);
    claim_order_with_stack(f, r);
}
