/* "Did you mean": the known word that a misspelt one was most likely meant to be. */
#ifndef BB_SUGGEST_H
#define BB_SUGGEST_H

#include <stddef.h>

/* Set `word`, zero the rest, then offer each known word. `prefix` is a beginning that the known
 * words have and that neither the message nor `word` shows. */
typedef struct bb_suggestion {
    const char *word, *prefix;
    const char *nearest; /* NULL: no word is near enough */
    size_t distance;
    char text[96];
} bb_suggestion;

/* Takes `known`, which must stay valid, if it is nearer than the earlier words: a few letters off,
 * or `word` is its beginning. */
void bb_suggest(bb_suggestion *suggestion, const char *known);

/* Returns " (did you mean 'stack'?)", or "" if no word is near. */
const char *bb_suggested(bb_suggestion *suggestion);

#endif
