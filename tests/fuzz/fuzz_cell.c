/* Keys of cells: there and back; the canonical key is one. */
#include "framework/record/cell.h"
#include "tests/fuzz/fuzz.h"

/* The key of a cell that is known to fit into one. */
static void check_canonical(const bb_cell_parts *cell, void (*make)(bb_cell_parts *cell))
{
    static bb_cell_parts once, twice;
    static char key[BB_CELL_KEY], again[BB_CELL_KEY];
    once = *cell;
    make(&once);
    if (bb_cell_key_format(&once, key) != BB_OK) {
        fuzz_refused(BB_INVALID); /* spelled out it has no room */
        return;
    }
    FUZZ_CHECK(bb_cell_key_parse(key, &twice) == BB_OK);
    make(&twice);
    FUZZ_CHECK(bb_cell_key_format(&twice, again) == BB_OK && strcmp(key, again) == 0);
}

static void check_parts(const char *key)
{
    size_t set = bb_cell_key_set(key), rays = bb_cell_key_rays(key), length = strlen(key);
    FUZZ_CHECK(set <= rays && rays <= length);
    FUZZ_CHECK(bb_cell_key_same(key, rays, key, rays));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static bb_cell_parts cell, back;
    static char key[BB_CELL_KEY], again[BB_CELL_KEY];
    char *text = fuzz_text(data, size);
    bb_status status = bb_cell_key_parse(text, &cell);
    free(text);
    if (status != BB_OK) {
        fuzz_refused(status);
        return 0;
    }
    if (bb_cell_key_format(&cell, key) != BB_OK) {
        fuzz_refused(BB_INVALID);
        return 0;
    }
    FUZZ_CHECK(strlen(key) < BB_CELL_KEY);
    FUZZ_CHECK(bb_cell_key_parse(key, &back) == BB_OK);
    FUZZ_CHECK(bb_cell_key_format(&back, again) == BB_OK && strcmp(key, again) == 0);
    check_parts(key);
    check_canonical(&cell, bb_cell_canonical);
    check_canonical(&cell, bb_cell_short);
    return 0;
}
