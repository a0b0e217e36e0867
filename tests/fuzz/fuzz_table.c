/* Tables: whatever is read is written, read again and written the same; as CSV too. */
#include "framework/table/table.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_text(data, size);
    bb_table *table, *again;
    const bb_status status = bb_table_parse(text, "input", &table);
    free(text);
    if (status != BB_OK) {
        fuzz_refused(status);
        FUZZ_CHECK(table == NULL);
        return 0;
    }
    char *once = bb_table_json(table), *csv = bb_table_csv(table);
    FUZZ_CHECK(once != NULL && csv != NULL);
    FUZZ_CHECK(bb_table_parse(once, "again", &again) == BB_OK);
    char *twice = bb_table_json(again);
    FUZZ_CHECK(twice != NULL && strcmp(once, twice) == 0);
    FUZZ_CHECK(bb_table_row_count(table) == bb_table_row_count(again));
    bb_table_free(table);
    bb_table_free(again);
    free(once);
    free(twice);
    free(csv);
    return 0;
}
