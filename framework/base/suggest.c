#include "framework/base/suggest.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { LETTERS_MAX = 40 };

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Returns the least number of letters to insert, drop, change or swap with the next (optimal string
 * alignment). */
static size_t edits(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t rows[3][LETTERS_MAX + 1], *before = rows[0], *last = rows[1], *row = rows[2];
    for (size_t k = 0; k <= b_length; k++)
        last[k] = k;
    for (size_t i = 1; i <= a_length; i++) {
        row[0] = i;
        for (size_t k = 1; k <= b_length; k++) {
            row[k] = least(last[k - 1] + (a[i - 1] != b[k - 1]), least(last[k], row[k - 1]) + 1);
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                row[k] = least(row[k], before[k - 2] + 1);
        }
        size_t *free_row = before;
        before = last;
        last = row;
        row = free_row;
    }
    return last[b_length];
}

void bb_suggest(bb_suggestion *s, const char *known)
{
    size_t length = strlen(s->word), known_length = strlen(known);
    if (length < 2 || length > LETTERS_MAX || known_length > LETTERS_MAX)
        return;
    bool begins = length < known_length && memcmp(s->word, known, length) == 0;
    size_t distance = edits(s->word, length, known, known_length);
    size_t most = length < 4 ? 1 : least(length / 3, 3);
    if ((!begins && distance > most) || (s->nearest != NULL && distance >= s->distance))
        return;
    s->nearest = known;
    s->distance = distance;
}

const char *bb_suggested(bb_suggestion *s)
{
    if (s->nearest != NULL)
        snprintf(s->text, sizeof s->text, " (did you mean '%s%s'?)",
                 s->prefix != NULL ? s->prefix : "", s->nearest);
    return s->text;
}
