/* Words for a shell. */
#include "framework/base/shell_word.h"

#include <string.h>

void bb_put_shell_word(FILE *out, const char *text)
{
    static const char safe[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                               "_@%+=:,./-";
    if (text[0] != '\0' && text[strspn(text, safe)] == '\0') {
        fputs(text, out);
        return;
    }
    fputc('\'', out);
    for (; *text != '\0'; text++) {
        if (*text == '\'')
            fputs("'\\''", out); /* ends the quotes, adds a quote, opens them again */
        else
            fputc(*text, out);
    }
    fputc('\'', out);
}
