/* What the record's own files share: the document, and look-ups in it. */
#ifndef BB_RECORD_PRIVATE_H
#define BB_RECORD_PRIVATE_H

#include "framework/record/record.h"

#define BB_RESULTS_SCHEMA "bvhbench-results/1"

struct bb_results {
    cJSON *root;
};

/* The document as text, each number with the digits that give it back exactly; for cJSON_free().
 * NULL if there is no memory. */
char *bb_results_print(const bb_results *results, bool formatted);

/* The array of reproductions of papers, made if there is none yet; NULL if there is no memory. */
cJSON *bb_results_reproductions(bb_results *results);

/* Members by name: "" / NAN / false where there is none of that type. */
const char *bb_json_text(const cJSON *object, const char *name);
double bb_json_number(const cJSON *object, const char *name);
bool bb_json_true(const cJSON *object, const char *name);

/* The samples of a member; false if it is no array of 1 to BB_SAMPLES_MAX numbers. */
bool bb_json_samples(const cJSON *entry, const char *name, bb_samples *samples);

/* Intervals and ranges of `ms` into a build, as times, and into a trace, whose "count" is there, as
 * rates. False if there is no memory. */
bool bb_put_build_spread(cJSON *build, const bb_samples *ms);
bool bb_put_rate_spread(cJSON *trace, const bb_samples *ms);
/* The same for all builds and traces that have samples. */
bool bb_results_put_spreads(bb_results *results);

/* Entries by name and by id; NULL if there is none. */
cJSON *bb_results_scene(const bb_results *results, const char *name);
cJSON *bb_results_build(const bb_results *results, uint32_t id);

#endif
