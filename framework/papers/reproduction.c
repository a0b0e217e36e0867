/* Tables and claims: into the result document, and as text. */
#include "framework/papers/reproduce.h"
#include "framework/record/record.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 110, COLUMNS_MAX = 32 };

struct bb_reproduction {
    cJSON *root, *tables, *claims;
    cJSON *rows; /* of the current table */
    cJSON *row;
    bool no_memory;
};

/* ---- making ---- */

static void append(bb_reproduction *r, cJSON *array, cJSON *item)
{
    if (item != NULL && array != NULL && cJSON_AddItemToArray(array, item))
        return;
    cJSON_Delete(item);
    r->no_memory = true;
}

void bb_paper_table_begin(bb_reproduction *r, const char *title, const char *const *columns)
{
    cJSON *table = cJSON_CreateObject();
    append(r, r->tables, table);
    r->no_memory = r->no_memory || cJSON_AddStringToObject(table, "title", title) == NULL;
    cJSON *names = cJSON_AddArrayToObject(table, "columns");
    for (const char *const *column = columns; *column != NULL; column++)
        append(r, names, cJSON_CreateString(*column));
    r->rows = cJSON_AddArrayToObject(table, "rows");
    r->row = NULL;
}

void bb_paper_row(bb_reproduction *r)
{
    r->row = cJSON_CreateArray();
    append(r, r->rows, r->row);
}

void bb_paper_text(bb_reproduction *r, const char *text)
{
    append(r, r->row, cJSON_CreateString(text));
}

void bb_paper_number(bb_reproduction *r, double value, int decimals)
{
    double scale = pow(10, decimals);
    append(r, r->row,
           isfinite(value) ? cJSON_CreateNumber(round(value * scale) / scale) : cJSON_CreateNull());
}

void bb_claim(bb_reproduction *r, bb_claim_verdict verdict, const char *claim, const char *paper,
              const bb_words *ours, const bb_words *why)
{
    cJSON *entry = cJSON_CreateObject();
    append(r, r->claims, entry);
    bool decided = verdict == BB_HELD || verdict == BB_NOT_HELD;
    cJSON *held = decided ? cJSON_CreateBool(verdict == BB_HELD) : cJSON_CreateNull();
    bool ok = cJSON_AddStringToObject(entry, bb_fields[BB_F_CLAIM_CLAIM].name, claim) != NULL &&
              cJSON_AddItemToObject(entry, bb_fields[BB_F_CLAIM_HELD].name, held) &&
              cJSON_AddStringToObject(entry, bb_fields[BB_F_CLAIM_VERDICT].name,
                                      bb_verdict_words(verdict)) != NULL &&
              cJSON_AddStringToObject(entry, bb_fields[BB_F_CLAIM_PAPER].name, paper) != NULL &&
              cJSON_AddStringToObject(entry, bb_fields[BB_F_CLAIM_OURS].name, ours->text) != NULL &&
              cJSON_AddStringToObject(entry, bb_fields[BB_F_CLAIM_WHY].name, why->text) != NULL;
    r->no_memory = r->no_memory || !ok;
}

bb_status bb_reproduction_add(const bb_paper *paper, const bb_findings *findings,
                              bb_results *results)
{
    bb_reproduction r = {.root = cJSON_CreateObject()};
    append(&r, bb_results_reproductions(results), r.root);
    if (!r.no_memory) {
        r.no_memory = cJSON_AddStringToObject(r.root, "name", paper->name) == NULL ||
                      cJSON_AddStringToObject(r.root, "title", paper->title) == NULL;
        r.tables = cJSON_AddArrayToObject(r.root, "tables");
        r.claims = cJSON_AddArrayToObject(r.root, "claims");
        bb_paper_add_tables(paper->tables, findings, &r);
        for (int i = 0; i < 2; i++)
            bb_paper_add_claims(paper->claims[i], findings, &r);
    }
    return r.no_memory ? bb_fail(BB_FAILED, "reproduce %s: no memory", paper->name) : BB_OK;
}

/* ---- as text ---- */

/* Decimals that show a number, which was rounded when it was put in. */
static int decimals_of(double value)
{
    for (int decimals = 0; decimals < 6; decimals++) {
        double scaled = value * pow(10, decimals);
        if (fabs(scaled - round(scaled)) < 1e-6 * fmax(1, fabs(scaled)))
            return decimals;
    }
    return 6;
}

/* A cell as text; numbers of a column have the same decimals. */
static void print_cell(const cJSON *cell, int decimals, char *text, size_t capacity)
{
    if (cJSON_IsString(cell))
        snprintf(text, capacity, "%s", cell->valuestring);
    else if (cJSON_IsNumber(cell))
        snprintf(text, capacity, "%.*f", decimals, cell->valuedouble);
    else
        snprintf(text, capacity, "-");
}

typedef struct column {
    int width, decimals;
    bool text; /* to the left */
} column;

static void widen(column *c, const char *text)
{
    int length = (int)strlen(text);
    c->width = length > c->width ? length : c->width;
}

static uint32_t measure_columns(const cJSON *names, const cJSON *rows, column *columns)
{
    const cJSON *item, *row;
    uint32_t count = 0, i;
    char text[256];
    cJSON_ArrayForEach(item, names)
    {
        if (count == COLUMNS_MAX)
            break;
        columns[count] = (column){0};
        widen(&columns[count++], item->valuestring);
    }
    for (int pass = 0; pass < 2; pass++)
        cJSON_ArrayForEach(row, rows)
        {
            for (i = 0, item = row->child; item != NULL && i < count; item = item->next, i++) {
                int decimals = cJSON_IsNumber(item) ? decimals_of(item->valuedouble) : 0;
                columns[i].text = columns[i].text || cJSON_IsString(item);
                if (pass == 0 && decimals > columns[i].decimals)
                    columns[i].decimals = decimals;
                print_cell(item, columns[i].decimals, text, sizeof text);
                if (pass == 1)
                    widen(&columns[i], text);
            }
        }
    return count;
}

static void print_table(const cJSON *table, FILE *out)
{
    const cJSON *names = cJSON_GetObjectItemCaseSensitive(table, "columns");
    const cJSON *rows = cJSON_GetObjectItemCaseSensitive(table, "rows"), *row, *item;
    column columns[COLUMNS_MAX];
    uint32_t count = measure_columns(names, rows, columns), i;
    char text[256];
    fprintf(out, "\n%s\n\n", bb_get_text(table, BB_F_TABLE_TITLE));
    for (i = 0, item = names->child; i < count; item = item->next, i++)
        fprintf(out, columns[i].text ? "  %-*s" : "  %*s", columns[i].width, item->valuestring);
    fprintf(out, "\n");
    cJSON_ArrayForEach(row, rows)
    {
        for (i = 0, item = row->child; item != NULL && i < count; item = item->next, i++) {
            print_cell(item, columns[i].decimals, text, sizeof text);
            fprintf(out, columns[i].text ? "  %-*s" : "  %*s", columns[i].width, text);
        }
        fprintf(out, "\n");
    }
}

/* "label: text", broken between words into lines. */
static void print_paragraph(const char *label, const char *text, FILE *out)
{
    if (text[0] == '\0')
        return;
    int at = fprintf(out, "    %s: ", label);
    while (*text != '\0') {
        int length = (int)strcspn(text, " ");
        if (at + length > LINE)
            at = fprintf(out, "\n      ") - 1;
        at += fprintf(out, "%.*s ", length, text);
        text += length;
        text += strspn(text, " ");
    }
    fprintf(out, "\n");
}

/* How a claim is counted. */
enum { HELD, NOT_HELD, UNDECIDED, UNTESTED, KINDS };

static int kind_of(const cJSON *claim)
{
    const cJSON *held = cJSON_GetObjectItemCaseSensitive(claim, "held");
    return cJSON_IsTrue(held)                                                     ? HELD
           : cJSON_IsFalse(held)                                                  ? NOT_HELD
           : strncmp(bb_get_text(claim, BB_F_CLAIM_VERDICT), "undecided", 9) == 0 ? UNDECIDED
                                                                                  : UNTESTED;
}

static void print_claim(const cJSON *claim, FILE *out)
{
    const char *const verdicts[KINDS] = {"held", "DID NOT HOLD",
                                         bb_get_text(claim, BB_F_CLAIM_VERDICT),
                                         bb_verdict_words(BB_NOT_TESTED)};
    fprintf(out, "\n  %s\n    %s\n", bb_get_text(claim, BB_F_CLAIM_CLAIM),
            verdicts[kind_of(claim)]);
    print_paragraph("paper", bb_get_text(claim, BB_F_CLAIM_PAPER), out);
    print_paragraph("here", bb_get_text(claim, BB_F_CLAIM_OURS), out);
    print_paragraph("why", bb_get_text(claim, BB_F_CLAIM_WHY), out);
}

bb_status bb_reproduction_print(const bb_results *results, FILE *out)
{
    const cJSON *item, *part;
    const cJSON *context = bb_results_context(results);
    const cJSON *load = cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(context, "load"), 0);
    double units = bb_get_number(context, BB_F_CONTEXT_UNITS);
    cJSON_ArrayForEach(item, bb_results_member(results, "reproductions"))
    {
        fprintf(out, "%s\nhere: bvhbench %s on %s", bb_get_text(item, BB_F_PAPER_TITLE),
                bb_get_text(context, BB_F_CONTEXT_REVISION),
                bb_get_text(context, BB_F_CONTEXT_DEVICE));
        if (cJSON_IsNumber(load))
            fprintf(out, ", %g compute units, load %.1f at the start%s", units, load->valuedouble,
                    load->valuedouble > 0.5 * units ? ": times are noisy, tests and costs are not"
                                                    : "");
        fprintf(out, "\n");
        cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(item, "tables"))
            print_table(part, out);
        int counts[KINDS] = {0};
        cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(item, "claims"))
            counts[kind_of(part)]++;
        fprintf(out, "\nclaims: %d held, %d did not hold, %d undecided, %d cannot be tested here\n",
                counts[HELD], counts[NOT_HELD], counts[UNDECIDED], counts[UNTESTED]);
        cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(item, "claims"))
            print_claim(part, out);
        fprintf(out, "\n");
    }
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the reproduction") : BB_OK;
}
