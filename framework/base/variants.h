/* What is taken of a plug-in where nothing is named: a constant table of {devices, role, variants},
 * which every plug-in declares of itself. */
#ifndef BB_VARIANTS_H
#define BB_VARIANTS_H

#include <stddef.h>
#include <stdint.h>

/* Kinds of devices. */
enum { BB_FOR_CPU = 1u << 0, BB_FOR_GPU = 1u << 1, BB_FOR_ALL = BB_FOR_CPU | BB_FOR_GPU };

typedef enum bb_role {
    BB_ROLE_COMPARED, /* measured against others */
    BB_ROLE_TRIED,    /* worth a trial besides, where the least that is enough is looked for */
} bb_role;

typedef struct bb_variants {
    uint32_t devices; /* on which they are taken; 0 ends the table */
    bb_role role;
    const char *specs; /* as a list: "stack,stack:leaf=4" */
} bb_variants;

/* The first row, from `row` on, of this role on such a device; NULL after the last, and of a table
 * that is NULL. */
static inline const bb_variants *bb_variants_of(const bb_variants *row, bb_role role,
                                                uint32_t device)
{
    while (row != NULL && row->devices != 0 && (row->role != role || (row->devices & device) == 0))
        row++;
    return row != NULL && row->devices != 0 ? row : NULL;
}

#endif
