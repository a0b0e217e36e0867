/* Steps of rays that are made by hand, for tests of what replays them (framework/simulate/). */
#ifndef BB_TEST_MADE_STEPS_H
#define BB_TEST_MADE_STEPS_H

#include "framework/simulate/machine.h"
#include "tests/fixture.h"

#include <ctype.h>
#include <string.h>

enum { RAYS_MOST = 256, WORDS_MOST = 1 << 14 };

static uint32_t ends[RAYS_MOST], words[WORDS_MOST];
static bb_steps made;

static inline void no_rays(void)
{
    made = (bb_steps){.rays = 0, .ends = ends, .words = words};
}

/* Kinds of steps by their letters, then of a ray's beginning and end. */
static const char letters[] = "N+P-RBSLAFXYbe";

/* Adds a ray: N7 a node, P7 a primitive, + a push, - a pop, R a restart, B7 a box, S7 a sample, L7
 * what it looks up, A another search (A1: in a region), F7 a leaf, X an exact test, Y the rest of
 * it; J1 joins its packet, J leaves it; a number is 0 if it is left out. */
static inline void add_ray(const char *steps)
{
    uint32_t end = made.rays > 0 ? ends[made.rays - 1] : 0;
    for (const char *c = steps; *c != '\0';) {
        const char kind = *c++;
        const unsigned index = isdigit(*c) ? (unsigned)strtoul(c, (char **)&c, 10) : 0;
        const uint32_t number =
            kind == 'J' ? BB_STEP_MARK : (uint32_t)(strchr(letters, kind) - letters);
        assert_true(end < WORDS_MOST && number <= BB_STEP_MARK);
        words[end++] = number << BB_STEP_INDEX_BITS | index;
    }
    ends[made.rays++] = end;
    made.set_rays = made.rays;
}

static inline void add_rays(uint32_t count, const char *steps)
{
    for (uint32_t i = 0; i < count; i++)
        add_ray(steps);
}

/* Packets of 8. */
static const bb_footing in_packets = {.control = BB_PACKETS,
                                      .group = 32,
                                      .packet = 8,
                                      .node_bytes = 256,
                                      .prim_bytes = 192,
                                      .result_bytes = 8};

#endif
