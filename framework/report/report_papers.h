/* Links from methods to their papers. */
#ifndef BB_REPORT_PAPERS_H
#define BB_REPORT_PAPERS_H

#include "framework/record/record.h"

/* Returns {"lbvh": [{"title": ..., "doi": ...}], ...}: the papers, which have a DOI, of each
 * builder and tracer that the results name and this program knows. Free it with free(). NULL
 * without memory. */
char *bb_papers_json(const bb_results *results);

#endif
