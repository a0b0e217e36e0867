/* JSON as text. */
#ifndef BB_JSON_H
#define BB_JSON_H

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>

/* A document of cJSON as text, always UTF-8: a byte of a string that is not UTF-8, such as one of a
 * file's name, becomes %XX. From malloc; NULL if memory runs out or `json` is NULL. */
char *bb_json_print(const cJSON *json, bool formatted);

/* The first byte of a byte order mark, or of a number that JSON does not have, such as 01 or 1.:
 * cJSON reads both. NULL: there is none. `text` is what cJSON has read. */
const char *bb_json_fault(const char *text);

/* Writes a document from front to back. All zero at first. If memory runs out, the writer remembers
 * it and bb_json_take() returns NULL, so callers check once. `name` is the member's name; NULL in
 * an array and for the document itself. */
typedef struct bb_json {
    bool formatted; /* one member a line, as bb_json_print() does it */
    bool lost;
    bool more; /* something stands in the present object or array */
    bool line; /* what follows begins a line */
    unsigned depth;
    char *text;
    size_t size, room;
} bb_json;

void bb_json_line(bb_json *json); /* the next member or element begins a line */
void bb_json_object(bb_json *json, const char *name);
void bb_json_end_object(bb_json *json);
void bb_json_array(bb_json *json, const char *name);
void bb_json_end_array(bb_json *json);

void bb_json_add_text(bb_json *json, const char *name, const char *value); /* NULL: null */
void bb_json_add_number(bb_json *json, const char *name, double value);    /* not finite: null */
void bb_json_add_bool(bb_json *json, const char *name, bool value);

/* The document, always UTF-8; the writer is empty afterwards. From malloc; NULL if memory ran out.
 */
char *bb_json_take(bb_json *json);

/* A finite number with 15 to 17 digits, as few as read back as the same double; cJSON's may not.
 * Returns `digits`. */
enum { BB_JSON_DIGITS = 40 };
const char *bb_json_digits(char digits[BB_JSON_DIGITS], double value);

#endif
