/* The context of a run: the members of the first row of tables (framework/device/run_row.h), and
 * Embree's version. */
#include "framework/embree/embree.h"
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>

bb_status bb_put_context(cJSON *root, const bb_context *about, const char *embree_version)
{
    bb_table *table;
    cJSON *context = cJSON_AddObjectToObject(root, "context");
    BB_TRY(bb_table_create("run", &table));
    const uint32_t row = bb_run_row(table, about->device, about->seed, about->command);
    bool ok = context != NULL && bb_table_status(table) == BB_OK;
    for (uint32_t i = 0; ok && i < bb_table_column_count(table); i++) {
        const bb_column *column = bb_table_column(table, i);
        ok = column->kind == BB_COLUMN_TEXT
                 ? bb_put_text(context, column->name, bb_table_get_text(table, row, column->name))
                 : bb_put_number(context, column->name,
                                 bb_table_get_number(table, row, column->name));
    }
    ok = ok && bb_put_text(context, bb_fields[BB_F_CONTEXT_EMBREE].name, embree_version) &&
         bb_put_text(context, bb_fields[BB_F_CONTEXT_EMBREE_API].name, BB_EMBREE_API);
    bb_table_free(table);
    return ok ? BB_OK : bb_fail(BB_FAILED, "result document: no memory");
}
