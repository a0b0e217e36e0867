/* What may come from a file, or be its name, must not steer the terminal that it is shown on, nor
 * spoil JSON. */
#ifndef BB_STEERING_H
#define BB_STEERING_H

#include <stdbool.h>

/* Bytes of the first letter of `text`, which is not empty, in UTF-8; 1 of what is no UTF-8. *calm:
 * whether it is a letter that steers nothing: no control character, none that turns the direction
 * of writing. */
int bb_letter(const char *text, bool *calm);

/* Whether all letters are calm. */
bool bb_is_calm(const char *text);

/* A copy from malloc, with %XX, its code, in the place of each byte that is no UTF-8, so that
 * unlike texts stay so. NULL: no memory. */
char *bb_utf8_text(const char *text);

/* Puts a '?' in the place of each letter that is not. */
void bb_calm_text(char *text);

#endif
