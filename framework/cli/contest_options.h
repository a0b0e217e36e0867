/* What the commands share that compare searches: `volume`, `slice`, `overlap`. */
#ifndef BB_CONTEST_OPTIONS_H
#define BB_CONTEST_OPTIONS_H

#include "framework/cli/choice.h"

#include <cjson/cJSON.h>

/* Builders and searches of meshes by default. */
#define BB_USUAL_TET_BUILDERS "lbvh,olbvh,olbvh:alpha=1,olbvh:alpha=2"

/* --search; "skip,octree" if there is none. */
bb_status bb_choose_searches(const bb_cli *cli, bb_names *searches);

/* --builder; `usual` if there is none. */
bb_status bb_choose_tree_builders(const bb_cli *cli, const char *usual, bb_names *builders);

/* A document of this schema with revision and device, and its list of results, which is in it.
 * False: no memory, and there is no document. */
bool bb_contest_document(const char *schema, const bb_device *device, cJSON **document,
                         cJSON **results);

/* Adds a result (NULL: no memory) to the list, with the names of its pictures; takes both over. */
bb_status bb_contest_add(cJSON *results, cJSON *result, cJSON *files);

/* Prints the document if --json was given, and writes NAME.json and the page NAME.html into the
 * folder --out. */
bb_status bb_contest_write(const bb_cli *cli, const cJSON *document, const char *name);

/* Those that commands end with: of the status of the work, whether answers differ, and whether it
 * was interrupted. */
bb_status bb_contest_end(bb_status status, bool wrong, int *exit_status);

#endif
