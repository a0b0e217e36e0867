/* The variables of the process's environment, to be put back exactly as they were: values, order,
 * and the pointers, since who has called putenv() may still write what they point to. */
#ifndef BB_ENVIRONMENT_H
#define BB_ENVIRONMENT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct bb_environment {
    char **array; /* what `environ` was */
    size_t count;
    char **strings; /* its entries; NULL: no memory */
    char *texts;    /* what they pointed to, one after the other */
} bb_environment;

void bb_environment_take(bb_environment *taken);
void bb_environment_free(bb_environment *taken);

/* Whether other variables, other values or another order are there now. */
bool bb_environment_changed(const bb_environment *taken);

/* Puts back what was taken. False: no memory. Other threads must not read the environment. */
bool bb_environment_put_back(const bb_environment *taken);

#endif
