/* What `volume`, `slice` and `overlap` do with their results: a table, which is printed scene by
 * scene, and written as a file and as a page. */
#ifndef BB_CONTEST_OUTPUT_H
#define BB_CONTEST_OUTPUT_H

#include "framework/cli/contest_options.h"
#include "framework/device/device.h"
#include "framework/show/outline.h"

#include <stdbool.h>

typedef struct bb_contest_output {
    const bb_page_outline *outline;
    const bb_page_outline *printed; /* instead, on the terminal; NULL: the same */
    const bb_contest_choice *choice;
    const char *command_line;
    bb_table *table;
    bool begun; /* a scene was printed */
} bb_contest_output;

/* Makes the table, with what belongs to the whole run: its first row. */
bb_status bb_contest_output_begin(bb_contest_output *output, const bb_device *device,
                                  uint64_t seed);

/* Makes a scene's name one that the table does not have: "cube (2)". */
void bb_contest_output_name(const bb_contest_output *output, char *name, size_t capacity);

/* Prints the scene of the table's last row, and before the first one the device, unless JSON is to
 * be printed. */
bb_status bb_contest_output_scene(bb_contest_output *output);

/* Prints JSON and writes NAME.json and NAME.html, which keep what was measured before `status`, a
 * failure; a whole run is appended to the history. *wrong: whether answers are. Frees the table.
 * Returns the first failure. */
bb_status bb_contest_output_end(bb_contest_output *output, bb_status status, bool *wrong);

#endif
