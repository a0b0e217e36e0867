/* Tables and claims: into the results, and as text. */
#include "framework/papers/reproduce.h"
#include "framework/record/record.h"

#include <math.h>
#include <string.h>

struct bb_reproduction {
    bb_results *results;
    const char *paper;
    const char *const *simulations; /* their names */
    bb_words title;                 /* of the current table */
    uint32_t tables, rows, cells;   /* so far: of the paper, of the table, of the row */
    bb_status status;
};

/* ---- making ---- */

static void note(bb_reproduction *r, bb_status status)
{
    r->status = r->status != BB_OK ? r->status : status;
}

void bb_paper_table_begin(bb_reproduction *r, const char *title, const char *const *columns)
{
    r->title = (bb_words){0};
    bb_say(&r->title, "%s", title);
    r->tables++;
    r->rows = 0;
    for (uint32_t i = 0; columns[i] != NULL; i++)
        note(r, bb_results_print_heading(r->results, r->paper, title, r->tables, i, columns[i]));
}

void bb_paper_row(bb_reproduction *r)
{
    r->rows++;
    r->cells = 0;
}

static void put_cell(bb_reproduction *r, const char *text, double number)
{
    note(r, bb_results_print_cell(r->results, r->paper, r->title.text, r->tables, r->rows,
                                  r->cells++, text, number));
}

void bb_paper_text(bb_reproduction *r, const char *text)
{
    put_cell(r, text, (double)NAN);
}

void bb_paper_number(bb_reproduction *r, double value, int decimals)
{
    double scale = pow(10, decimals);
    put_cell(r, NULL, round(value * scale) / scale);
}

void bb_claim(bb_reproduction *r, const char *claim, const char *paper, uint32_t simulated,
              const bb_said *said)
{
    const bool decided = said->verdict == BB_HELD || said->verdict == BB_NOT_HELD;
    const char *by = simulated > 0 ? r->simulations[simulated - 1] : NULL;
    const bb_claim_record record = {.claim = claim,
                                    .simulated = by,
                                    .verdict = bb_verdict_words(said->verdict),
                                    .paper = paper,
                                    .claimed = said->claimed.text,
                                    .ours = said->ours.text,
                                    .why = said->why.text,
                                    .held = decided ? said->verdict == BB_HELD : -1};
    note(r, bb_results_add_claim(r->results, r->paper, &record));
}

bb_status bb_reproduction_add(const bb_paper *paper, const bb_findings *findings,
                              bb_results *results)
{
    bb_reproduction r = {
        .results = results, .paper = paper->name, .simulations = findings[0].simulations};
    note(&r, bb_results_add_paper(results, paper->name, paper->title));
    bb_paper_add_tables(paper->tables, findings, &r);
    for (uint32_t by = 0; by <= findings[0].simulation_count; by++)
        for (int i = 0; i < 2; i++)
            bb_paper_add_claims(paper->claims[i], findings, by, &r);
    return r.status;
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

/* The most decimals that a number of the column needs, in the rows of one table; texts need none.
 */
static int column_decimals(const bb_entry *row, uint32_t column)
{
    bb_printed cell;
    int most = 0;
    for (const bb_entry *of = row; of != NULL; of = bb_next_printed(of)) {
        const bool number = bb_get_printed(of, column, &cell) && isfinite(cell.number);
        const int own = number ? decimals_of(cell.number) : 0;
        most = own > most ? own : most;
    }
    return most;
}

static void show_row(const bb_entry *row, bb_page *page)
{
    bb_printed cell;
    for (uint32_t i = 0; i < BB_HEADS_MAX && bb_get_printed(row, i, &cell); i++) {
        bb_estimate figure = bb_not_measured;
        figure.value = cell.number;
        if (cell.text[0] != '\0')
            bb_page_put_text(page, cell.text);
        else
            bb_page_put_figure(page, figure, 0);
    }
}

/* Shows the table that begins at `row`. Returns the first row behind it. */
static const bb_entry *show_table(const bb_entry *row, bb_page *page)
{
    bb_printed cell;
    bb_page_grid(page, bb_get_text(row, BB_F_TABLE_TITLE));
    for (uint32_t i = 0; i < BB_HEADS_MAX && bb_get_printed(row, i, &cell); i++)
        bb_page_column(page, cell.heading, "", "", column_decimals(row, i));
    const bb_entry *last = row; /* of headings alone */
    while ((row = bb_next_printed(row)) != NULL)
        show_row(last = row, page);
    return bb_next_part(last, BB_F_TABLE_TITLE);
}

/* How a claim is counted. */
enum { HELD, DIRECTION, NOT_HELD, UNTOLD, KINDS };

static int kind_of(const bb_entry *claim)
{
    static const bb_claim_verdict verdicts[] = {
        [HELD] = BB_HELD, [DIRECTION] = BB_DIRECTION, [NOT_HELD] = BB_NOT_HELD};
    int kind = HELD;
    while (kind < UNTOLD &&
           strcmp(bb_get_text(claim, BB_F_CLAIM_VERDICT), bb_verdict_words(verdicts[kind])) != 0)
        kind++;
    return kind;
}

static void show_line(bb_page *page, const char *label, const char *text)
{
    if (text[0] != '\0')
        bb_page_say(page, "%s: %s", label, text);
}

static void show_claim(const bb_entry *claim, bb_page *page)
{
    const char *verdict = bb_get_text(claim, BB_F_CLAIM_VERDICT);
    const char *by = bb_get_text(claim, BB_F_CLAIM_SIMULATED);
    bb_page_heading(page, bb_get_text(claim, BB_F_CLAIM_CLAIM));
    bb_page_say(page, "%s%s", by[0] != '\0' ? "simulated: " : "",
                kind_of(claim) == NOT_HELD ? "DID NOT HOLD" : verdict);
    show_line(page, "paper", bb_get_text(claim, BB_F_CLAIM_PAPER));
    show_line(page, "figures", bb_get_text(claim, BB_F_CLAIM_CLAIMED));
    show_line(page, "here", bb_get_text(claim, BB_F_CLAIM_OURS));
    show_line(page, "why", bb_get_text(claim, BB_F_CLAIM_WHY));
}

static bool is_by(const bb_entry *claim, const char *simulation)
{
    return strcmp(bb_get_text(claim, BB_F_CLAIM_SIMULATED), simulation) == 0;
}

/* Those that were judged by this simulation; "": by what was measured. */
static void show_claims(const bb_entry *paper, const char *simulation, bb_page *page)
{
    int counts[KINDS] = {0};
    bb_each_part(claim, paper, BB_F_CLAIM_VERDICT) if (is_by(claim, simulation))
        counts[kind_of(claim)]++;
    if (simulation[0] != '\0')
        bb_page_heading(page, simulation);
    bb_page_say(
        page,
        "%s: %d held (at the paper's own figure or beyond, less %g %%), %d in direction "
        "only, %d did not hold, %d cannot be told here",
        simulation[0] == '\0' ? "claims"
                              : "claims on times, simulated, neither measured nor validated",
        counts[HELD], 100 * BB_CLAIM_MARGIN, counts[DIRECTION], counts[NOT_HELD], counts[UNTOLD]);
    bb_each_part(claim, paper, BB_F_CLAIM_VERDICT) if (is_by(claim, simulation))
        show_claim(claim, page);
}

/* Those of what was measured, then those of each simulation, which follow each other. */
static void show_all_claims(const bb_entry *paper, bb_page *page)
{
    const char *last = "";
    show_claims(paper, "", page);
    bb_each_part(claim, paper, BB_F_CLAIM_VERDICT)
    {
        const char *by = bb_get_text(claim, BB_F_CLAIM_SIMULATED);
        if (strcmp(by, last) != 0)
            show_claims(paper, by, page);
        last = by;
    }
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

void bb_reproduction_show(const bb_results *results, bb_page *page)
{
    bb_each(paper, bb_results_section(results, BB_PAPERS))
    {
        bb_page_heading(page, bb_get_text(paper, BB_F_PAPER_TITLE));
        show_here(results, page);
        for (const bb_entry *row = bb_first_part(paper, BB_F_TABLE_TITLE); row != NULL;)
            row = show_table(row, page);
        show_all_claims(paper, page);
    }
}

bb_status bb_reproduction_print(const bb_results *results, FILE *out)
{
    bb_page *page;
    BB_TRY(bb_page_create("reproduce", &page));
    bb_reproduction_show(results, page);
    const bb_status status = bb_page_status(page);
    bb_page_print(page, out);
    bb_page_free(page);
    return status == BB_OK && ferror(out) ? bb_fail(BB_FAILED, "cannot write the reproduction")
                                          : status;
}
