/* Commands that are printed to be given to a shell. */
#ifndef BB_SHELL_WORD_H
#define BB_SHELL_WORD_H

#include <stdio.h>

/* The text as one word of a POSIX shell: as it is where that is safe, else in single quotes, in
 * which a shell expands nothing. */
void bb_put_shell_word(FILE *out, const char *text);

#endif
