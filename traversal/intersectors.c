/* The named intersectors: rounding rules of the ray-box and ray-primitive tests, as -D for kernels/intersect.clh. */
#include "traversal/traversal.h"

#include <string.h>

const bb_intersector bb_intersectors[] = {
    {"exact", "Woop-Benthin-Wald watertight, exact edge signs, padded slabs, no contraction",
     "-DBB_TRIANGLE_TEST=0 -DBB_PAD=1", true},
    {"fast", "Moeller-Trumbore, unpadded slabs, contraction allowed: what careless code does",
     "-DBB_TRIANGLE_TEST=1 -DBB_PAD=0 -DBB_CONTRACT", false},
    {NULL, NULL, NULL, false},
};

const bb_intersector *bb_intersector_find(const char *name)
{
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        if (strcmp(i->name, name) == 0)
            return i;
    return NULL;
}
