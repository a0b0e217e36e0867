/* Reproduced papers: their claims, and the tables that they print, whose columns are theirs alone.
 */
#include "framework/record/record_private.h"

#include <stdio.h>

/* The cell of the paper in the present run. */
static bb_cell paper_of(const bb_results *results, const char *paper, char run[16])
{
    return (bb_cell){{[BB_RUN] = bb_run_name(results->run, run), [BB_QUESTION] = paper}};
}

bb_status bb_results_add_paper(bb_results *results, const char *name, const char *title)
{
    char run[16];
    const bb_cell cell = paper_of(results, name, run);
    if (bb_results_find(results, cell) != NULL)
        return bb_fail(BB_INVALID, "paper %.40s is in the results already", name);
    bb_table_set_text(results->table, bb_table_row(results->table, cell),
                      bb_field_column(BB_F_PAPER_TITLE), title[0] != '\0' ? title : name);
    BB_TRY(bb_table_status(results->table));
    return bb_results_entry(results, cell) != NULL ? BB_OK : results->status;
}

bb_status bb_results_add_claim(bb_results *results, const char *paper, const bb_claim_record *claim)
{
    char run[16];
    bb_cell cell = paper_of(results, paper, run);
    char name[4200];
    snprintf(name, sizeof name, "%s%s%s", claim->simulated != NULL ? claim->simulated : "",
             claim->simulated != NULL ? ": " : "", claim->claim);
    cell.names[BB_MAKER] = name;
    bb_entry *entry = bb_results_entry(results, cell);
    if (claim->held >= 0)
        bb_put_flag(entry, BB_F_CLAIM_HELD, claim->held == 1);
    bb_put_text(entry, BB_F_CLAIM_VERDICT, claim->verdict);
    bb_put_text(entry, BB_F_CLAIM_SIMULATED, claim->simulated != NULL ? claim->simulated : "");
    bb_put_text(entry, BB_F_CLAIM_PAPER, claim->paper);
    bb_put_text(entry, BB_F_CLAIM_CLAIMED, claim->claimed);
    bb_put_text(entry, BB_F_CLAIM_OURS, claim->ours);
    bb_put_text(entry, BB_F_CLAIM_WHY, claim->why);
    return entry != NULL ? bb_table_status(results->table) : results->status;
}

static const bb_column *printed_column(bb_results *results, const char *paper, uint32_t table,
                                       uint32_t column, bool text)
{
    char name[BB_PRINTED_NAME];
    bb_printed_name(paper, table, column, text, name);
    bb_table_add_column(results->table,
                        (bb_column){.name = name,
                                    .heading = name,
                                    .unit = "",
                                    .help = "",
                                    .kind = text ? BB_COLUMN_TEXT : BB_COLUMN_NUMBER,
                                    .decimals = -1});
    return bb_table_column_named(results->table, name);
}

static bb_entry *printed_row(bb_results *results, const char *paper, const char *title,
                             const char *number)
{
    char run[16];
    bb_cell cell = paper_of(results, paper, run);
    cell.names[BB_FRAME] = title;
    cell.names[BB_MAKER] = number;
    return bb_results_entry(results, cell);
}

bb_status bb_results_print_heading(bb_results *results, const char *paper, const char *title,
                                   uint32_t table, uint32_t column, const char *heading)
{
    char number[16];
    snprintf(number, sizeof number, "%u", table);
    const bb_entry *entry = printed_row(results, paper, title, number);
    const bb_column *of = printed_column(results, paper, table, column, true);
    if (entry == NULL)
        return results->status;
    if (of != NULL)
        bb_table_set_text(results->table, entry->row, of, heading);
    return bb_table_status(results->table);
}

bb_status bb_results_print_cell(bb_results *results, const char *paper, const char *title,
                                uint32_t table, uint32_t row, uint32_t column, const char *text,
                                double number)
{
    char numbers[32];
    snprintf(numbers, sizeof numbers, "%u.%u", table, row);
    const bb_entry *entry = printed_row(results, paper, title, numbers);
    const bb_column *of = printed_column(results, paper, table, column, text != NULL);
    if (entry == NULL)
        return results->status;
    if (of == NULL)
        return bb_table_status(results->table);
    if (text != NULL)
        bb_table_set_text(results->table, entry->row, of, text);
    else
        bb_table_set_number(results->table, entry->row, of, number);
    return bb_table_status(results->table);
}
