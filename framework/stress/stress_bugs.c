/* Tells bugs from weak spots. */
#include "framework/stress/stress.h"

static bool is_bug(const bb_stress_axis *a, const bb_method *method, bb_manner manner,
                   const bb_point_figures *f)
{
    switch (manner) {
    case BB_MANNER_CRASHED:
    case BB_MANNER_HUNG:
    case BB_MANNER_MEMORY:
    case BB_MANNER_FAILED:
        return true;
    case BB_MANNER_WRONG: /* an overflow is reported, so it is no bug */
        return method->exact && a->axis.known[0] == '\0' && !(f->overflowed > 0);
    default:
        return false;
    }
}

static void tell(FILE *out, const bb_stress_axis *a, const bb_method *method, double x,
                 const char *what, const char *reason)
{
    if (out != NULL)
        fprintf(out, "bvhbench: %s %s %s on %s at %.9g%s%s\n", bb_method_part_word(method->part),
                method->text, what, a->axis.name, x, reason[0] != '\0' ? ": " : "", reason);
}

/* Reports answers that differ from those of another exact cell though none is judged wrong. If an
 * exact answer is wrong, it explains the difference. */
static uint32_t blame_unlike(const bb_stress *s, const bb_stress_axis *a, FILE *out)
{
    for (uint32_t p = 0; p < a->search.probe_count; p++) {
        const bb_point_figures *f = a->search.probes[p].figures;
        uint32_t unlike = 0, wrong = 0, last = 0;
        for (uint32_t m = 0; m < s->request->method_count; m++) {
            if (!s->request->methods[m].exact)
                continue;
            wrong += f[m].wrong > 0 || f[m].overflowed > 0;
            unlike += f[m].unlike > 0;
            last = f[m].unlike > 0 ? m : last;
        }
        if (unlike > 0 && wrong == 0) {
            tell(out, a, &s->request->methods[last], a->search.probes[p].x,
                 "answers unlike another method that must be exact", "");
            return 1;
        }
    }
    return 0;
}

uint32_t bb_stress_blame(const bb_stress *s, FILE *out)
{
    uint32_t bugs = 0;
    for (uint32_t i = 0; i < s->axis_count; i++) {
        const char *mishap = s->axes[i].mishap;
        bugs += (mishap[0] != '\0') + blame_unlike(s, &s->axes[i], out);
        if (mishap[0] != '\0' && out != NULL)
            fprintf(out, "bvhbench: %s; none does so by itself\n", mishap);
    }
    for (uint32_t i = 0; i < s->axis_count; i++)
        for (uint32_t m = 0; m < s->request->method_count; m++) {
            const bb_stress_axis *a = &s->axes[i];
            const bb_method *method = &s->request->methods[m];
            uint32_t verdicts = 0;
            bool told[BB_MANNERS] = {false};
            for (uint32_t p = 0; p < a->search.probe_count; p++) {
                const bb_point_figures *f = &a->search.probes[p].figures[m];
                verdicts += f->outcome != BB_NOT_MEASURED;
                for (uint32_t k = 0; k < BB_MANNERS; k++)
                    if (!told[k] && !bb_manners[k].relative &&
                        bb_manner_shows((bb_manner)k, f, f) && is_bug(a, method, (bb_manner)k, f)) {
                        told[k] = true;
                        bugs++;
                        tell(out, a, method, a->search.probes[p].x, bb_manners[k].word, f->reason);
                    }
            }
            if (verdicts == 0 && a->complete) {
                bugs++;
                tell(out, a, method, a->axis.from, "has no verdict", "");
            }
        }
    return bugs;
}
