/* Pages: a template in which marks are replaced by parts, so that one file is all there is. */
#ifndef BB_TEMPLATE_H
#define BB_TEMPLATE_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* A text that grows; all zero at first, `data` is for free(). */
typedef struct bb_page_text {
    char *data;
    size_t size, capacity;
    bool failed; /* no memory; later calls do nothing */
} bb_page_text;

void bb_page_append(bb_page_text *out, const char *data, size_t size);
void bb_page_append_string(bb_page_text *out, const char *string);

void bb_page_append_base64(bb_page_text *out, const unsigned char *data, size_t size);

/* The PNG file `name` in a folder as a data URI, for free(); NULL if there is no such picture.
 * False if there is no memory. */
bool bb_page_source(const char *folder, const char *name, char **source);

typedef struct bb_page_part {
    const char *mark; /* in the template */
    const char *content;
    bool json; /* for a <script>: nothing in it can end that */
} bb_page_part;

/* Copies the template and puts each part in the place of its mark. The parts stand in the order of
 * the template, so that no part's content is searched for marks. */
bb_status bb_page_fill(bb_page_text *page, const char *from, const bb_page_part *parts,
                       size_t count);

#endif
