/* Files that belong to the library: modules and helpers, looked for only when they are needed. */
#ifndef BB_BESIDE_H
#define BB_BESIDE_H

#include <stdbool.h>
#include <stddef.h>

/* Finds file `name` beside the library that contains this function, even if that was moved, or else
 * where it was to be installed. Returns false if it is in neither place. */
bool bb_find_beside(const char *name, char *path, size_t capacity);

#endif
