/* Opening, reading and summing up of rays files and hits files; checks of their headers. */
#include "framework/workload/exchange_intake.h"

#include "framework/workload/exchange.h"

#include <inttypes.h>
#include <stdbool.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "these files are little-endian: swap bytes here, on a machine that is not");

enum { COUNT_MAX = INT32_MAX };

bb_status bb_intake_open(const char *path, const char *what, bb_intake *in)
{
    BB_TRY(bb_input_open(path, what, &in->input));
    in->sum = XXH3_createState();
    if (in->sum == NULL) {
        bb_input_close(&in->input);
        return bb_fail(BB_REFUSED, "%s %s: no memory for a checksum", what, path);
    }
    XXH3_64bits_reset(in->sum);
    return BB_OK;
}

void bb_intake_close(bb_intake *in)
{
    XXH3_freeState(in->sum);
    bb_input_close(&in->input);
}

bb_status bb_intake_read(bb_intake *in, void *data, size_t size)
{
    BB_TRY(bb_input_read(&in->input, data, size));
    XXH3_64bits_update(in->sum, data, size);
    return BB_OK;
}

/* The first members of both headers. */
typedef struct preamble {
    char magic[8];
    uint32_t version, byte_order, header_bytes;
} preamble;

bb_status bb_intake_header(bb_intake *in, const char *magic, void *header, size_t size,
                           size_t sum_at)
{
    const char *path = in->input.path, *what = in->input.what;
    if (in->input.size < size)
        return bb_fail(BB_INVALID, "%s %s has %" PRIu64 " bytes, its header alone has %zu", what,
                       path, in->input.size, size);
    BB_TRY(bb_input_read(&in->input, header, size));
    preamble p;
    memcpy(&p, header, sizeof p);
    if (memcmp(p.magic, magic, sizeof p.magic) != 0)
        return bb_fail(BB_INVALID, "%s %s does not begin with %s: it is something else", what, path,
                       magic);
    if (p.byte_order != BB_EXCHANGE_ORDER)
        return bb_fail(BB_INVALID,
                       "%s %s has byte order %08" PRIx32 ", not %08x: write it little-endian", what,
                       path, p.byte_order, (unsigned)BB_EXCHANGE_ORDER);
    if (p.version != BB_EXCHANGE_VERSION)
        return bb_fail(BB_INVALID,
                       "%s %s is of version %" PRIu32 ", this program reads %d: make rays and hits "
                       "anew, the rays by `bvhbench rays`",
                       what, path, p.version, BB_EXCHANGE_VERSION);
    if (p.header_bytes != size)
        return bb_fail(BB_INVALID, "%s %s has a header of %" PRIu32 " bytes, not of %zu", what,
                       path, p.header_bytes, size);
    static const char nothing[sizeof(uint64_t)];
    const char *bytes = header;
    XXH3_64bits_update(in->sum, bytes, sum_at);
    XXH3_64bits_update(in->sum, nothing, sizeof nothing);
    XXH3_64bits_update(in->sum, bytes + sum_at + sizeof nothing, size - sum_at - sizeof nothing);
    return BB_OK;
}

bb_status bb_intake_check_count(const bb_intake *in, const char *name, uint64_t count)
{
    if (count <= COUNT_MAX)
        return BB_OK;
    return bb_fail(BB_INVALID, "%s %s: %s is %" PRIu64 ", at most %d can be handled",
                   in->input.what, in->input.path, name, count, COUNT_MAX);
}

bb_status bb_intake_check_size(const bb_intake *in, uint64_t expected)
{
    if (in->input.size == expected)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "%s %s has %" PRIu64 " bytes, by its header it has %" PRIu64 ": it is %s",
                   in->input.what, in->input.path, in->input.size, expected,
                   in->input.size < expected ? "truncated" : "too long");
}

bb_status bb_intake_check_sum(const bb_intake *in, uint64_t checksum)
{
    uint64_t sum = XXH3_64bits_digest(in->sum);
    if (sum == checksum)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "%s %s is damaged: its checksum is %016" PRIx64 ", its header says %016" PRIx64,
                   in->input.what, in->input.path, sum, checksum);
}

/* Returns whether the text ends with a 0, has only 0 after it and no control characters. */
static bool is_text(const char *text, size_t capacity)
{
    size_t length = strnlen(text, capacity);
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)text[i] < ' ' || text[i] == 0x7F)
            return false;
    for (size_t i = length; i < capacity; i++)
        if (text[i] != '\0')
            return false;
    return length < capacity;
}

bb_status bb_intake_check_text(const bb_intake *in, const char *name, const char *text,
                               size_t capacity)
{
    if (is_text(text, capacity))
        return BB_OK;
    return bb_fail(BB_INVALID, "%s %s: %s is no text that ends with a 0 and is filled up with 0",
                   in->input.what, in->input.path, name);
}
