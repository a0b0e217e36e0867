/* What `bvhbench list` prints of a name. */
#ifndef BB_LIST_ENTRY_H
#define BB_LIST_ENTRY_H

#include "framework/base/json.h"
#include "framework/base/options.h"
#include "framework/builder/bibliography.h"

#include <stdio.h>

/* A list as text; as JSON if `json` is not NULL; as BibTeX if `papers` is not NULL. It is printed
 * when it is complete. */
typedef struct bb_list {
    FILE *text;
    bb_json *json;
    bb_bibliography *papers;
} bb_list;

/* `declared` may be NULL. */
void bb_list_add(bb_list *list, const char *name, const char *summary, const bb_option *declared);

/* Likewise a method that implements papers. `paper` are authors and years; NULL, "" and "none" are
 * none. Its references are the entries of `file` (builder/bibliography.h), if there is one. */
bb_status bb_list_add_method(bb_list *list, const char *name, const char *summary,
                             const char *paper, const bb_option *declared, const char *file);

#endif
