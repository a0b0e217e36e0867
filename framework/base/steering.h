/* What may come from a file, or be its name, must not steer the terminal that it is shown on. */
#ifndef BB_STEERING_H
#define BB_STEERING_H

/* Bytes of a letter in UTF-8 that would steer the terminal: control characters, and what turns the
 * direction of writing; 0 if it is none of these. `text` is not empty. */
int bb_steering_bytes(const char *text);

/* Puts a '?' in the place of each such letter. */
void bb_calm_text(char *text);

#endif
