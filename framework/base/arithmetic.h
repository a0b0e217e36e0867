/* Whole numbers, as the sizes of launches and buffers need them. */
#ifndef BB_ARITHMETIC_H
#define BB_ARITHMETIC_H

#include <stdint.h>

/* Returns count / size, rounded up; never overflows. `size` is not 0. */
static inline uint32_t bb_divide_up(uint32_t count, uint32_t size)
{
    return count / size + (count % size != 0);
}

static inline uint32_t bb_min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static inline uint32_t bb_max_u32(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

#endif
