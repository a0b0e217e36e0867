/* Output of `animate`, `volume`, `slice` and `overlap`: a table that is printed scene by scene, and
 * written as a file and as a page. */
#ifndef BB_CONTEST_OUTPUT_H
#define BB_CONTEST_OUTPUT_H

#include "framework/bench/contest.h"
#include "framework/cli/contest_options.h"
#include "framework/table/outline.h"

#include <stdbool.h>

typedef struct bb_contest_output {
    const bb_page_outline *outline;
    const bb_page_outline *printed; /* outline for the terminal; NULL: the same */
    const bb_contest_choice *choice;
    const char *command_line;
    bb_table *table;
    bool begun; /* a scene was printed */
    bb_audit audit;
    bb_bystanders watch; /* since the beginning */
} bb_contest_output;

/* Makes the table with its first row, which describes the run, and begins to watch other
 * programs. */
bb_status bb_contest_output_begin(bb_contest_output *output, const bb_device *device,
                                  uint64_t seed);

/* Begins as above, and completes the request: builders and searches, which outlive it, and who
 * checks clocks and watches other programs. */
bb_status bb_contest_output_request(bb_contest_output *output, const bb_names *builders,
                                    const bb_names *searches, bb_contest_request *request);

/* Sets the request's builders and searches. */
void bb_contest_take_names(const bb_names *builders, const bb_names *searches,
                           bb_contest_request *request);

/* Makes a scene's name unique in the table: "cube (2)". */
void bb_contest_output_name(const bb_contest_output *output, char *name, size_t capacity);

/* Prints the scene of the table's last row, and the device before the first scene. Prints nothing
 * with --json. */
bb_status bb_contest_output_scene(bb_contest_output *output);

/* Prints JSON and writes NAME.json and NAME.html, which keep what was measured before `status`, a
 * failure; a whole run is appended to the history. *wrong: whether answers are, or clocks,
 * which is said; may be NULL. Frees the table. Returns the first failure, which says where the file
 * is. */
bb_status bb_contest_output_end(bb_contest_output *output, bb_status status, bool *wrong);

#endif
