/* Prints the verdict as Markdown. */
#include "framework/report/report.h"
#include "framework/summary/summary.h"

#include <math.h>
#include <string.h>

/* Escapes '|', which would end a column, and other markup. */
static void print_text(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        if (strchr("|\\`*_<>[]#", *text) != NULL)
            fputc('\\', out);
        fputc((unsigned char)*text < 32 ? ' ' : *text, out);
    }
}

static void print_standing(FILE *out, const bb_standing *standing)
{
    if (!isfinite(standing->value))
        fputs(" - |", out);
    else
        fprintf(out,
                standing->best   ? " **%.3g** |"
                : standing->tied ? " %.3g ~ |"
                                 : " %.3g |",
                standing->value);
}

static void print_row(FILE *out, const bb_summary_row *row)
{
    fputs("| ", out);
    print_text(out, row->builder);
    if (row->run > 0)
        fprintf(out, " (run %.0f)", row->run + 1);
    if (row->partial)
        fprintf(out, " (%u ray sets only)", row->sets);
    fputs(" |", out);
    print_standing(out, &row->trace);
    print_standing(out, &row->build);
    print_standing(out, &row->ready);
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        print_standing(out, &row->image[k]);
    print_standing(out, &row->quality);
    print_standing(out, &row->overlap);
    print_standing(out, &row->work);
    print_standing(out, &(bb_standing){.value = row->peak / (1 << 20)});
    if (row->checked > 0)
        fprintf(out, " %.0f of %.0f |\n", row->wrong, row->checked);
    else
        fputs(" - |\n", out);
}

bb_status bb_report_markdown(const bb_results *results, FILE *out)
{
    bb_summary summary;
    char busy[256], implausible[BB_IMPLAUSIBLE];
    BB_TRY(bb_summary_make(results, &(bb_summary_choice){NULL, NULL}, &summary));
    const bb_entry *context = bb_results_context(results);
    if (bb_summary_busy(results, busy))
        fprintf(out, "**Warning:** %s\n\n", busy);
    if (bb_summary_implausible(results, implausible)) {
        fputs("**Warning:** ", out);
        print_text(out, implausible);
        fputs("\n\n", out);
    }
    fputs("bvhbench ", out);
    print_text(out, bb_get_text(context, BB_F_CONTEXT_REVISION));
    fputs(" on ", out);
    print_text(out, bb_get_text(context, BB_F_CONTEXT_DEVICE));
    fprintf(out, ": %u scenes, %u ray sets, %u rounds\n\n", summary.scenes, summary.sets,
            summary.rounds);
    fprintf(out,
            "| builder | trace / %s | build Mprims/s | + layout | 0.1 M rays | 1 M | 10 M | 100 M "
            "| 1 G | 10 G | SAH / best | EPO / best | work / best | peak MiB | wrong rays |\n",
            summary.reference != NULL ? summary.reference : "best");
    fputs("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n", out);
    for (uint32_t i = 0; i < summary.row_count; i++)
        print_row(out, &summary.rows[i]);
    fputs("\nGeometric means; **best**, ~ not told from it; columns of rays: time to image by the "
          "best.\n\n",
          out);
    for (uint32_t i = 0; i < summary.sentence_count; i++) {
        fprintf(out, "- %s: ", summary.sentences[i].label);
        print_text(out, summary.sentences[i].text);
        fputc('\n', out);
    }
    bb_summary_free(&summary);
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the table") : BB_OK;
}
