#include "framework/cli/against.h"

#include "framework/base/file.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/compare/prediction.h"
#include "framework/report/report.h"
#include "framework/report/report_compare.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct run {
    bb_results *results;
    bb_cell_set set;
    char *folder;
} run;

static bb_status read_run(const char *argument, run *r)
{
    char path[PATH_MAX];
    BB_TRY(bb_input_path(argument, path));
    BB_TRY(bb_results_read(path, &r->results));
    r->folder = bb_file_folder(path);
    if (r->folder == NULL)
        return bb_fail(BB_FAILED, "report: no memory");
    BB_TRY(bb_results_locate_pictures(r->results, r->folder));
    BB_TRY(bb_cell_set_of_table(bb_results_table(r->results), argument, &r->set));
    bb_cell_set_sort(&r->set);
    return BB_OK;
}

/* The page has both runs as one merged document, beside what the comparison says. */
static bb_status write_page(run runs[2], const bb_comparison_result *compared, const char *out)
{
    char beside[PATH_MAX];
    BB_TRY(bb_results_merge(runs[0].results, runs[1].results));
    BB_TRY(bb_predictions_record(runs[0].results));
    if (out == NULL)
        BB_TRY(bb_join_path(beside, runs[1].folder, "against.html"));
    else
        BB_TRY(bb_out_file(out, "report"));
    BB_TRY(bb_report_html_against(runs[0].results, compared, out != NULL ? out : beside));
    BB_TRY(bb_report_compare(compared, false, stdout));
    printf(" report  %s\n", out != NULL ? out : beside);
    return BB_OK;
}

static bb_status compare(const bb_cli *cli, run runs[2], const char *out)
{
    bb_comparison_result compared = {.floor = BB_NO_FLOOR};
    BB_TRY(read_run(cli->positional[0], &runs[0]));
    BB_TRY(read_run(cli->positional[1], &runs[1]));
    const bb_side before = {&runs[0].set, 1}, after = {&runs[1].set, 1};
    bb_status status = bb_compare(&before, &after, (double)NAN, NULL, &compared);
    if (status == BB_OK)
        status = write_page(runs, &compared, out);
    bb_compare_free(&compared);
    return status;
}

bb_status bb_report_against(const bb_cli *cli, const char *out)
{
    run runs[2] = {{NULL}, {NULL}};
    if (cli->positional_count != 2)
        return bb_fail(BB_INVALID, "report: --against compares two runs, not %u: give OLD and NEW",
                       cli->positional_count);
    BB_TRY(bb_inputs_once(cli));
    const bb_status status = compare(cli, runs, out);
    for (int i = 0; i < 2; i++) {
        bb_results_destroy(runs[i].results);
        bb_cell_set_free(&runs[i].set);
        free(runs[i].folder);
    }
    return status;
}
