/* Prints how well measures of trees predict times of rays. */
#include "framework/report/report_prediction.h"
#include "framework/report/columns.h"
#include "framework/summary/prediction.h"

#include <math.h>

/* Writes "4.1 %  0.93". */
static void print_fit(FILE *out, double error, double correlation)
{
    if (isfinite(error))
        fprintf(out, "  %5.1f %%", 100 * error);
    else
        fprintf(out, "  %7s", "-");
    if (isfinite(correlation))
        fprintf(out, " %5.2f", correlation);
    else
        fprintf(out, " %5s", "-");
}

static void print_kind(FILE *out, const bb_prediction_record *r)
{
    char alpha[BB_ENTRY] = "-", unseen[BB_ENTRY] = "-";
    if (isfinite(r->alpha_least))
        snprintf(alpha, sizeof alpha, "%.2f [%.2f, %.2f]", r->alpha, r->alpha_least, r->alpha_most);
    else if (isfinite(r->alpha))
        snprintf(alpha, sizeof alpha, "%.2f", r->alpha);
    if (isfinite(r->unseen_error))
        snprintf(unseen, sizeof unseen, "%.1f %%", 100 * r->unseen_error);
    fputs("  ", out);
    bb_print_text(out, r->rays, 24);
    fprintf(out, "  %5u %5u %6u  %-17s", r->cells, r->trees, r->scenes, alpha);
    print_fit(out, r->mix_error, r->mix_correlation);
    fprintf(out, "  %7s", unseen);
    print_fit(out, r->sah_error, r->sah_correlation);
    print_fit(out, r->epo_error, r->epo_correlation);
    print_fit(out, r->work_error, r->work_correlation);
    fputc('\n', out);
}

bb_status bb_report_predictions(const bb_results *results, FILE *out)
{
    bb_predictions made;
    BB_TRY(bb_predictions_make(results, &made));
    if (made.count > 0) {
        fputs(
            "\nwhat trees cost, against the time per ray: (1 - alpha) SAH + alpha EPO, each alone, "
            "and the counted work\n",
            out);
        fprintf(out, "  %-24s  %5s %5s %6s  %-17s  %13s  %7s  %13s  %13s  %13s\n", "Rays", "Cells",
                "Trees", "Scenes", "alpha [range]", "mix        r", "unseen", "SAH        r",
                "EPO        r", "work        r");
    }
    for (uint32_t i = 0; i < made.count; i++)
        print_kind(out, &made.kinds[i].record);
    if (made.count > 0)
        fputs("  In %: typical deviation of the time; r: correlation of logarithms; both with a "
              "factor of its own for each ray\n  set and kernel. Range: of alpha with one scene "
              "left out; unseen: deviation on the scene that was.\n",
              out);
    bb_predictions_free(&made);
    return BB_OK;
}
