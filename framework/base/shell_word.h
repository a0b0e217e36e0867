/* Words of commands that are printed for a shell. */
#ifndef BB_SHELL_WORD_H
#define BB_SHELL_WORD_H

#include <stdio.h>

/* Prints the text as one word of a POSIX shell: unchanged where that is safe, else in single
 * quotes, in which a shell expands nothing. */
void bb_put_shell_word(FILE *out, const char *text);

#endif
