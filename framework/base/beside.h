/* Files that belong to the library: modules and helpers that are used only when asked for. */
#ifndef BB_BESIDE_H
#define BB_BESIDE_H

#include <stdbool.h>
#include <stddef.h>

/* The path of file `name` beside the library that this function lives in, wherever that was moved,
 * or where it was to be installed. False if it is in neither place. */
bool bb_find_beside(const char *name, char *path, size_t capacity);

#endif
