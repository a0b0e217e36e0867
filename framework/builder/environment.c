#include "framework/builder/environment.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static size_t count_of(char *const *array)
{
    size_t count = 0;
    while (array != NULL && array[count] != NULL)
        count++;
    return count;
}

void bb_environment_take(bb_environment *taken)
{
    const size_t count = count_of(environ), pointers = (count + 1) * sizeof(char *);
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += strlen(environ[i]) + 1;
    *taken = (bb_environment){.array = environ, .count = count};
    taken->strings = malloc(pointers + bytes);
    if (taken->strings == NULL)
        return;
    char *to = taken->texts = (char *)taken->strings + pointers;
    for (size_t i = 0; i < count; i++) {
        taken->strings[i] = environ[i];
        to = stpcpy(to, environ[i]) + 1;
    }
    taken->strings[count] = NULL;
}

void bb_environment_free(bb_environment *taken)
{
    free(taken->strings);
    taken->strings = NULL;
}

bool bb_environment_changed(const bb_environment *taken)
{
    const char *text = taken->texts;
    if (taken->strings == NULL)
        return false;
    if (count_of(environ) != taken->count)
        return true;
    for (size_t i = 0; i < taken->count; i++) {
        if (strcmp(environ[i], text) != 0)
            return true;
        text += strlen(text) + 1;
    }
    return false;
}

/* Whether the same pointers are there, in the same array. */
static bool is_the_same(const bb_environment *taken)
{
    if (environ != taken->array || count_of(environ) != taken->count)
        return false;
    for (size_t i = 0; i < taken->count; i++)
        if (environ[i] != taken->strings[i])
            return false;
    return true;
}

bool bb_environment_put_back(const bb_environment *taken)
{
    /* The old array may be gone: setenv() and clearenv() free what they have made themselves. */
    static char **own;
    if (taken->strings == NULL)
        return false;
    if (!is_the_same(taken)) {
        const size_t bytes = (taken->count + 1) * sizeof(char *);
        char **array = malloc(bytes);
        if (array == NULL)
            return false;
        environ = memcpy(array, taken->strings, bytes);
        free(own);
        own = array;
    }
    const char *text = taken->texts;
    for (size_t i = 0; i < taken->count; i++) {
        if (strcmp(environ[i], text) != 0) /* it was written to where it stands */
            strcpy(environ[i], text);
        text += strlen(text) + 1;
    }
    return true;
}
