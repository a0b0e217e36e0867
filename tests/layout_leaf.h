/* For walks over layouts: leaves of up to `leaf` references, or as many as the layout has room
 * for. */
#ifndef BB_TEST_LAYOUT_LEAF_H
#define BB_TEST_LAYOUT_LEAF_H

#include "traversal/traversal.h"

static inline uint32_t leaf_for(const bb_layout *layout, uint32_t leaf)
{
    const uint32_t most = bb_layout_leaf_max(layout);
    return leaf < most ? leaf : most;
}

#endif
