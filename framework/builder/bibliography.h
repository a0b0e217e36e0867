/* The papers of methods, as BibTeX beside their sources: NAME.bib in the folder of a builder or of
 * a tracer, kernel_NAME.bib, metric_NAME.bib, triangle_NAME.bib. They are embedded and found by
 * name like device files, those of builders that are plug-ins too.
 *
 * Methods that share a paper share its entry: a line `#include "OTHER.bib"` stands for the entries
 * of that file. BibTeX takes it for a comment, as everything outside entries. */
#ifndef BB_BIBLIOGRAPHY_H
#define BB_BIBLIOGRAPHY_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { BB_CITATIONS_MAX = 256, BB_CITED_MAX = 256 };

/* An entry, from its '@' to its last brace; not terminated. It lives as long as the process. */
typedef struct bb_citation {
    const char *text;
    size_t length;
} bb_citation;

typedef struct bb_bibliography {
    bb_citation entries[BB_CITATIONS_MAX]; /* no two have one key */
    uint32_t count;
} bb_bibliography;

/* Adds the entries of the text, which lives as long as the process. BB_INVALID names file and
 * entry: braces that do not match, no author, title or year, a key that another entry has, an
 * included file that does not exist. */
bb_status bb_bibliography_read(bb_bibliography *bibliography, const char *file, const char *text);

/* Likewise those of an embedded file; none, if there is no such file. */
bb_status bb_bibliography_add(bb_bibliography *bibliography, const char *file);

/* The value of "key", or of a field such as "doi", without braces; "" if there is none. */
void bb_citation_value(const bb_citation *citation, const char *name, char value[BB_CITED_MAX]);

#endif
