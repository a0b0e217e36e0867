/* "Did you mean": the known word that a misspelt one was most likely meant to be. */
#ifndef BB_SUGGEST_H
#define BB_SUGGEST_H

#include <stddef.h>

/* Zeroed but for `word`, and `prefix` if the words have one that neither shows, then offered all
 * known words. */
typedef struct bb_suggestion {
    const char *word, *prefix;
    const char *nearest; /* NULL: none is near enough */
    size_t distance;
    char text[96];
} bb_suggestion;

/* Takes `known`, which must stay where it is, if it is nearer than those before: a few letters off,
 * or `word` is its beginning. */
void bb_suggest(bb_suggestion *suggestion, const char *known);

/* " (did you mean 'stack'?)", or "" if nothing is near. */
const char *bb_suggested(bb_suggestion *suggestion);

#endif
