/* The variants of a plug-in that are used where none is named: a constant table of {devices, role,
 * variants}, which every plug-in declares. A role is a word, so a new one changes no struct. */
#ifndef BB_VARIANTS_H
#define BB_VARIANTS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Kinds of devices. */
enum { BB_FOR_CPU = 1u << 0, BB_FOR_GPU = 1u << 1, BB_FOR_ALL = BB_FOR_CPU | BB_FOR_GPU };

/* Roles of builders and kernels. */
#define BB_ROLE_COMPARED "compared" /* The variants are measured against others. */
#define BB_ROLE_TRIED "tried"       /* `advise` tries the variants besides those. */

/* Role of kernels. */
#define BB_ROLE_SIMULATED "simulated" /* `run --metrics simt` compares the variants. */

/* Roles of builders. */
#define BB_ROLE_LEAST "least"             /* The variants take no more than the scene needs. */
#define BB_ROLE_GENEROUS "generous"       /* One variant is enough for any scene. */
#define BB_ROLE_MOVING "moving"           /* The methods are worth it on scenes that move. */
#define BB_ROLE_STRESSED "stressed"       /* The variants show a weak spot. */
#define BB_ROLE_VOLUMES "volumes"         /* The variants are compared on volumes. */
#define BB_ROLE_MESHES "meshes"           /* The variants are compared on tetrahedra. */
#define BB_ROLE_MESHES_LONG "meshes_long" /* The same, but they take long. */
/* The cost of trees on moving scenes is compared with the trees of one variant, which is no
 * stage. */
#define BB_ROLE_YARDSTICK "yardstick"
/* One builder is used where one is needed and none is named: with a splitter or an optimiser given
 * alone, and for a picture. It takes all kinds and is compared (pipeline.h). */
#define BB_ROLE_USUAL "usual"
/* The SAH of all other trees is compared with that of one variant of one builder: several times as
 * much is taken for a bug, or for a scene that defeats the method. */
#define BB_ROLE_COST_REFERENCE "cost_reference"

/* All roles that a builder may have. */
#define BB_BUILDER_ROLES                                                                           \
    BB_ROLE_COMPARED, BB_ROLE_TRIED, BB_ROLE_LEAST, BB_ROLE_GENEROUS, BB_ROLE_MOVING,              \
        BB_ROLE_STRESSED, BB_ROLE_VOLUMES, BB_ROLE_MESHES, BB_ROLE_MESHES_LONG, BB_ROLE_YARDSTICK, \
        BB_ROLE_USUAL, BB_ROLE_COST_REFERENCE

typedef struct bb_variants {
    uint32_t devices; /* on which they are used; 0 ends the table */
    const char *role;
    const char *specs; /* a list: "stack,stack:leaf=4" */
} bb_variants;

/* The table of a plug-in that is used only where it is named. */
#define BB_NO_VARIANTS ((const bb_variants[]){{0, NULL, NULL}})

/* Returns the first row, from `row` on, with this role on such a device; NULL after the last, or if
 * the table is NULL. */
static inline const bb_variants *bb_variants_of(const bb_variants *row, const char *role,
                                                uint32_t device)
{
    while (row != NULL && row->devices != 0 &&
           ((row->devices & device) == 0 || row->role == NULL || strcmp(row->role, role) != 0))
        row++;
    return row != NULL && row->devices != 0 ? row : NULL;
}

#endif
