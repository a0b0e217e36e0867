/* The report: tables on the terminal and one HTML file that works offline. */
#ifndef BB_REPORT_H
#define BB_REPORT_H

#include "framework/record.h"

#include <stdio.h>

/* Text table of builds and traces, speeds beside wrong-answer rates, wrong cells marked. */
bb_status bb_report_table(bb_results *results, FILE *out);

/* Writes one self-contained HTML file (charts, sortable tables, pictures embedded from
 * `picture_folder`). */
bb_status bb_report_html(bb_results *results, const char *picture_folder, const char *path);

#endif
