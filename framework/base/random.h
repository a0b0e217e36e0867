/* Random numbers for everything seeded on the host: SplitMix64 (Steele, Lea, Flood: Fast Splittable
 * Pseudorandom Number Generators, OOPSLA 2014). It uses integers only, so a seed gives the same
 * numbers on every machine. */
#ifndef BB_RANDOM_H
#define BB_RANDOM_H

#include <math.h>
#include <stdint.h>

typedef struct bb_random {
    uint64_t state;
} bb_random;

/* The finaliser: a bijection of 64 bits in which each input bit reaches each output bit. */
static inline uint64_t bb_random_mix(uint64_t value)
{
    value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9u;
    value = (value ^ (value >> 27)) * 0x94D049BB133111EBu;
    return value ^ (value >> 31);
}

/* Streams of one seed are independent of each other. */
static inline bb_random bb_random_make(uint64_t seed, uint64_t stream)
{
    bb_random random;
    random.state =
        bb_random_mix(seed + 0x9E3779B97F4A7C15u) ^ bb_random_mix(stream * 0xD1342543DE82EF95u + 1);
    return random;
}

static inline uint64_t bb_random_u64(bb_random *random)
{
    random->state += 0x9E3779B97F4A7C15u;
    return bb_random_mix(random->state);
}

/* Returns a number in 0 .. limit - 1; limit >= 1. The bias is below limit / 2^32. */
static inline uint32_t bb_random_below(bb_random *random, uint32_t limit)
{
    return (uint32_t)(((bb_random_u64(random) >> 32) * limit) >> 32);
}

/* order[0..count) = a random permutation of 0 .. count - 1. */
static inline void bb_random_order(bb_random *random, uint32_t *order, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t k = bb_random_below(random, i + 1);
        order[i] = order[k];
        order[k] = i;
    }
}

/* Returns a number in [0, 1) with 53 bits. */
static inline double bb_random_unit(bb_random *random)
{
    return (double)(bb_random_u64(random) >> 11) * 0x1p-53;
}

/* Returns a number in [low, high). */
static inline double bb_random_range(bb_random *random, double low, double high)
{
    return low + (high - low) * bb_random_unit(random);
}

/* Returns a direction of length 1, uniform on the sphere, by rejection: sines and cosines would
 * differ in their last bit between machines. */
static inline void bb_random_direction(bb_random *random, double out[3])
{
    double square;
    do {
        square = 0;
        for (int axis = 0; axis < 3; axis++) {
            out[axis] = bb_random_range(random, -1, 1);
            square += out[axis] * out[axis];
        }
    } while (square > 1 || square < 0x1p-20);
    double length = sqrt(square);
    for (int axis = 0; axis < 3; axis++)
        out[axis] /= length;
}

#endif
