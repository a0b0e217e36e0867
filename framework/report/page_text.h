/* A page that is put together: a text that grows, and a template with marks. */
#ifndef BB_PAGE_TEXT_H
#define BB_PAGE_TEXT_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* A zeroed one is empty; `data` is from malloc, without a 0 behind it. */
typedef struct bb_text {
    char *data;
    size_t size, capacity;
    bool failed; /* no memory; later calls do nothing */
} bb_text;

void bb_text_append(bb_text *out, const char *data, size_t size);
void bb_text_string(bb_text *out, const char *string);
/* JSON as it may stand inside <script>. */
void bb_text_json(bb_text *out, const char *json);
void bb_text_base64(bb_text *out, const unsigned char *data, size_t size);

typedef struct bb_page_part {
    const char *mark; /* in the template */
    const char *content;
    bool json;
} bb_page_part;

/* Copies the template `html` and puts each part in the place of its mark. The parts stand in the
 * order of the template, so that no part's content is searched for marks. */
bb_status bb_page_fill(bb_text *page, const char *html, const bb_page_part *parts, size_t count);

#endif
