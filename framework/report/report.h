/* The report: tables on the terminal, one HTML file that works offline, and charts as pictures. */
#ifndef BB_REPORT_H
#define BB_REPORT_H

#include "framework/compare/compare.h"
#include "framework/record/record.h"
#include "framework/table/table.h"

#include <stdio.h>

/* One screen of at most 100 columns: builders by merit, what is best, what cannot be told apart. */
bb_status bb_report_verdict(const bb_results *results, FILE *out);

/* The same as Markdown; all traces as comma-separated values. */
bb_status bb_report_markdown(const bb_results *results, FILE *out);
bb_status bb_report_csv(const bb_results *results, FILE *out);

/* One line for each round of each time (bb_table_samples()). */
bb_status bb_report_samples(const bb_results *results, FILE *out);

/* All rounds of builds and traces that count, as Google Benchmark writes its results (JSON). */
bb_status bb_report_benchmark(const bb_results *results, FILE *out);

/* Text table of builds and traces, speeds beside wrong-answer rates, wrong cells marked. */
bb_status bb_report_table(const bb_results *results, FILE *out);

/* Writes one self-contained HTML file (charts, sortable tables, pictures embedded from below
 * `picture_folder`; if that is NULL, from below the folder of each, bb_results_locate_pictures()).
 */
bb_status bb_report_html(bb_results *results, const char *picture_folder, const char *path);

/* The same for a document merged of two runs, with what the comparison says of each cell. */
bb_status bb_report_html_against(bb_results *results, const bb_comparison_result *compared,
                                 const char *path);

/* Whether gnuplot, which draws the charts, is among the user's programs. */
bool bb_report_can_draw(void);
/* Where the charts of a page lie: "out/report-charts" for "out/report.html". */
bb_status bb_report_charts_folder(const char *page, char *folder, size_t capacity);
/* The charts of each scene and rays as SVG and PNG, and the script that drew them, into `folder`,
 * which is made if need be; *pictures is how many charts there are. BB_FAILED with gnuplot's own
 * words if it is missing or fails. */
bb_status bb_report_charts(bb_results *results, const char *folder, uint32_t *pictures);
/* One of them for print (bb_chart_print) into the file `path`, which ends with .pdf, .svg or .png,
 * and stays as it is if this fails. BB_INVALID with the names that there are: there is none of this
 * name. */
bb_status bb_report_figure(bb_results *results, const char *name, double width_mm,
                           const char *path);

/* The page of an atlas (a table of `stress`, framework/stress/) as one HTML file, with the pictures
 * that lie in `folder`. */
bb_status bb_report_atlas(const bb_table *atlas, const char *folder, const char *path);

#endif
