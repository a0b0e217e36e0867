/* Hashes a buffer: each work-item a share of its lines of 16 words, into a word of its own. Each
 * step is a bijection of what was hashed before, so one word that changes always changes the
 * hash.
 *
 * Limits: fewer than 2^32 lines.
 */
#include "bb_device.h"

#define BB_SEAL_PRIME 0x9E3779B1u

/* A bijection of either argument. The rotation takes high bits, such as signs, to low ones. */
static uint4 bb_seal(uint4 hash, uint4 words)
{
    return rotate((hash ^ words) * BB_SEAL_PRIME, (uint4)(13u));
}

kernel void seal_lines(global const uint4 *words, uint lines, uint stride, uint tail,
                       global uint *hashes)
{
    uint first = get_global_id(0), items = get_global_size(0);
    uint4 a = (uint4)(first), b = a + 1u, c = a + 2u, d = a + 3u;
    for (ulong line = first; line * stride < lines; line += items) {
        size_t at = (size_t)(line * stride) * 4;
        a = bb_seal(a, words[at]);
        b = bb_seal(b, words[at + 1]);
        c = bb_seal(c, words[at + 2]);
        d = bb_seal(d, words[at + 3]);
    }
    global const uint *rest = (global const uint *)(words + (size_t)lines * 4);
    for (uint i = 0; first == 0 && i < tail; i++)
        a = bb_seal(a, (uint4)(rest[i], i, 0u, 0u));
    a = bb_seal(bb_seal(bb_seal(a, b), c), d);
    a = bb_seal(a, a.zwxy);
    hashes[first] = bb_seal(a, a.yxwz).x;
}
