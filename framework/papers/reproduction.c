/* Tables and claims: into the result document, and as text. */
#include "framework/papers/reproduce.h"
#include "framework/record/record.h"
#include "framework/show/page.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* The most decimals that a number of column i needs; texts need none. */
static int column_decimals(const cJSON *rows, uint32_t i)
{
    const cJSON *row;
    int most = 0;
    cJSON_ArrayForEach(row, rows)
    {
        const cJSON *item = cJSON_GetArrayItem(row, (int)i);
        const int own = cJSON_IsNumber(item) ? decimals_of(item->valuedouble) : 0;
        most = own > most ? own : most;
    }
    return most;
}

static void show_table(const cJSON *table, bb_page *page)
{
    const cJSON *rows = cJSON_GetObjectItemCaseSensitive(table, "rows");
    const cJSON *name = cJSON_GetObjectItemCaseSensitive(table, "columns")->child, *row;
    bb_page_grid(page, bb_get_text(table, BB_F_TABLE_TITLE));
    for (uint32_t i = 0; name != NULL && i < BB_HEADS_MAX; i++, name = name->next)
        bb_page_column(page, name->valuestring, "", "", column_decimals(rows, i));
    cJSON_ArrayForEach(row, rows)
    {
        const cJSON *item = row->child;
        for (uint32_t i = 0; item != NULL && i < BB_HEADS_MAX; i++, item = item->next) {
            bb_estimate figure = bb_not_measured;
            figure.value = cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
            if (cJSON_IsString(item))
                bb_page_put_text(page, item->valuestring);
            else
                bb_page_put_figure(page, figure, false);
        }
    }
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

static void show_line(bb_page *page, const char *label, const char *text)
{
    if (text[0] != '\0')
        bb_page_say(page, "%s: %s", label, text);
}

static void show_claim(const cJSON *claim, bb_page *page)
{
    const char *const verdicts[KINDS] = {"held", "DID NOT HOLD",
                                         bb_get_text(claim, BB_F_CLAIM_VERDICT),
                                         bb_verdict_words(BB_NOT_TESTED)};
    bb_page_heading(page, bb_get_text(claim, BB_F_CLAIM_CLAIM));
    bb_page_say(page, "%s", verdicts[kind_of(claim)]);
    show_line(page, "paper", bb_get_text(claim, BB_F_CLAIM_PAPER));
    show_line(page, "here", bb_get_text(claim, BB_F_CLAIM_OURS));
    show_line(page, "why", bb_get_text(claim, BB_F_CLAIM_WHY));
}

static void show_claims(const cJSON *claims, bb_page *page)
{
    const cJSON *claim;
    int counts[KINDS] = {0};
    cJSON_ArrayForEach(claim, claims) counts[kind_of(claim)]++;
    bb_page_say(page, "claims: %d held, %d did not hold, %d undecided, %d cannot be tested here",
                counts[HELD], counts[NOT_HELD], counts[UNDECIDED], counts[UNTESTED]);
    cJSON_ArrayForEach(claim, claims) show_claim(claim, page);
}

/* Where it was measured. */
static void show_here(const bb_results *results, bb_page *page)
{
    const bb_entry *context = bb_results_context(results);
    const double load = bb_get_number(context, BB_F_CONTEXT_LOAD_1);
    const double units = bb_get_number(context, BB_F_CONTEXT_UNITS);
    bb_words words = {0};
    bb_say(&words, "here: bvhbench %s on %s", bb_get_text(context, BB_F_CONTEXT_REVISION),
           bb_get_text(context, BB_F_CONTEXT_DEVICE));
    if (isfinite(load))
        bb_say(&words, ", %g compute units, load %.1f at the start%s", units, load,
               load > 0.5 * units ? ": times are noisy, tests and costs are not" : "");
    bb_page_say(page, "%s", words.text);
}

bb_status bb_reproduction_print(const bb_results *results, FILE *out)
{
    const cJSON *item, *table;
    bb_page *page;
    BB_TRY(bb_page_create("reproduce", &page));
    cJSON_ArrayForEach(item, bb_results_member(results, "reproductions"))
    {
        bb_page_heading(page, bb_get_text(item, BB_F_PAPER_TITLE));
        show_here(results, page);
        cJSON_ArrayForEach(table, cJSON_GetObjectItemCaseSensitive(item, "tables"))
            show_table(table, page);
        show_claims(cJSON_GetObjectItemCaseSensitive(item, "claims"), page);
    }
    const bb_status status = bb_page_status(page);
    bb_page_print(page, out);
    bb_page_free(page);
    return status == BB_OK && ferror(out) ? bb_fail(BB_FAILED, "cannot write the reproduction")
                                          : status;
}
