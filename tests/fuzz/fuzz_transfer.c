/* Transfer functions: what is read has points that ascend, and a table of finite numbers. */
#include "framework/scene/transfer.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static bb_transfer transfer;
    static bb_transfer_entry table[BB_TRANSFER_STEPS];
    char *text = fuzz_text(data, size);
    bb_status status = bb_transfer_parse("transfer", text, &transfer);
    free(text);
    if (status != BB_OK) {
        fuzz_refused(status);
        return 0;
    }
    FUZZ_CHECK(transfer.count > 0 && transfer.count <= BB_TRANSFER_POINTS_MAX);
    for (uint32_t i = 1; i < transfer.count; i++)
        FUZZ_CHECK(transfer.points[i - 1].value <= transfer.points[i].value);
    bb_transfer_table(&transfer, 1, table);
    for (uint32_t i = 0; i < BB_TRANSFER_STEPS; i++) {
        FUZZ_CHECK(table[i].extinction >= 0 && isfinite(table[i].extinction));
        for (int k = 0; k < 3; k++)
            FUZZ_CHECK(table[i].rgb[k] >= 0 && table[i].rgb[k] <= 1);
    }
    return 0;
}
