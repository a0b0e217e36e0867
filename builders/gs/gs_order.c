/* The order in which objects are inserted. The first objects determine the upper levels, which
 * later insertions do not repair; with a file's order, in which neighbours follow each other, these
 * levels are poor.
 *
 *   shuffled: a random permutation, all equally likely
 *   rounds:   a random half of the objects comes in the last round, a random half of the others in
 *             the round before, and so on; within a round they keep their order
 *
 * Rounds (Amenta, Choi, Rote 2003: Incremental Constructions con BRIO) are random where it matters,
 * and still insert most objects right after a neighbour, whose nodes are in the cache.
 */
#include "framework/base/random.h"
#include "gs.h"

#include <string.h>

enum { ROUNDS = 32 };

static void shuffle(uint32_t *objects, uint32_t count, bb_random *random)
{
    for (uint32_t i = count; i > 1; i--) {
        uint32_t k = bb_random_below(random, i), object = objects[i - 1];
        objects[i - 1] = objects[k];
        objects[k] = object;
    }
}

/* Returns 0 for half of the objects, 1 for a quarter, ... */
static uint32_t draw_round(bb_random *random)
{
    uint32_t round = 0;
    for (uint64_t bits = bb_random_u64(random); round < ROUNDS - 1 && (bits & 1) == 0; bits >>= 1)
        round++;
    return round;
}

static void sort_into_rounds(uint32_t *objects, uint32_t count, bb_random *random, uint32_t *spare)
{
    uint32_t from[ROUNDS] = {0}, at = 0;
    bb_random again = *random;
    for (uint32_t i = 0; i < count; i++)
        from[draw_round(random)]++;
    for (uint32_t round = ROUNDS; round-- > 0;) {
        uint32_t size = from[round];
        from[round] = at;
        at += size;
    }
    for (uint32_t i = 0; i < count; i++)
        spare[from[draw_round(&again)]++] = objects[i];
    memcpy(objects, spare, count * sizeof *objects);
}

void bb_gs_put_in_order(bb_gs_tree *tree, bb_gs_order order, uint32_t count, uint64_t seed,
                        uint64_t stream)
{
    bb_random random = bb_random_make(seed, stream);
    if (order == BB_GS_SHUFFLED)
        shuffle(tree->scratch, count, &random);
    else if (order == BB_GS_ROUNDS)
        sort_into_rounds(tree->scratch, count, &random, tree->scratch + count);
}
