#include "framework/simulate/costs.h"

#include "framework/device/device_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MOST = 48, CELL_MOST = 64 };

/* A table of tab-separated columns: comments, a line of headings, rows. */
typedef struct row {
    char cells[COLUMNS_MOST][CELL_MOST];
    uint32_t count;
} row;

/* Reads the line at *text, and moves on; returns false at the end. Comments are left out. */
static bool read_row(const char **text, row *r)
{
    while (**text == '#') {
        *text = strchr(*text, '\n');
        if (*text == NULL)
            return false;
        ++*text;
    }
    if (**text == '\0')
        return false;
    r->count = 0;
    for (bool more = true; more;) {
        const size_t length = strcspn(*text, "\t\n");
        if (r->count < COLUMNS_MOST)
            snprintf(r->cells[r->count++], CELL_MOST, "%.*s", (int)length, *text);
        *text += length;
        more = **text == '\t';
        *text += **text != '\0';
    }
    return true;
}

static const char *cell_of(const row *headings, const row *r, const char *name)
{
    for (uint32_t i = 0; i < headings->count && i < r->count; i++)
        if (strcmp(headings->cells[i], name) == 0)
            return r->cells[i];
    return "";
}

/* Returns whether the list `options`, by commas, has this one. */
static bool has_option(const char *options, const char *option, size_t length)
{
    while (*options != '\0') {
        const size_t own = strcspn(options, ",");
        if (own == length && strncmp(options, option, length) == 0)
            return true;
        options += own + (options[own] == ',');
    }
    return false;
}

/* Returns how many options a row's program has, if they are all those of `program` of the same name
 * or some of them; -1: it is of another. */
static int fit(const char *of_row, const char *program)
{
    const size_t name = strcspn(program, ":"), own = strcspn(of_row, ":");
    int count = 0;
    if (name != own || strncmp(program, of_row, name) != 0)
        return -1;
    const char *options = program + name + (program[name] == ':');
    for (const char *at = of_row + own + (of_row[own] == ':'); *at != '\0'; count++) {
        const size_t length = strcspn(at, ",");
        if (!has_option(options, at, length))
            return -1;
        at += length + (at[length] == ',');
    }
    return count;
}

/* Finds the row of Debian 12's clang for this kernel of the program that fits best: other options
 * leave the code of its steps as it is. */
static bool find_row(const char *program, const char *kernel, row *headings, row *found)
{
    const char *text = bb_source_find("isa.tsv")->text;
    bool is_headings = true;
    int best = -1;
    row r;
    while (read_row(&text, &r)) {
        if (is_headings) {
            *headings = r;
            is_headings = false;
            continue;
        }
        const int own = fit(cell_of(headings, &r, "program"), program);
        if (own > best && strcmp(cell_of(headings, &r, "clang"), "15") == 0 &&
            strcmp(cell_of(headings, &r, "kernel"), kernel) == 0) {
            *found = r;
            best = own;
        }
    }
    return best >= 0;
}

static bool find_program(const char *program, const char *kernel, const char *code, bb_costs *costs)
{
    static const char *const kinds[BB_ISSUE_KINDS] = {
        [BB_STEP_NODE] = "node",   [BB_STEP_PUSH] = "push",       [BB_STEP_PRIMS] = "prims",
        [BB_STEP_POP] = "pop",     [BB_STEP_RESTART] = "restart", [BB_STEP_SAMPLE] = "sample",
        [BB_STEP_AGAIN] = "again", [BB_STEP_BOX] = "box",         [BB_STEP_LEAF] = "leaf",
        [BB_STEP_EXACT] = "exact", [BB_STEP_FURTHER] = "further", [BB_ISSUE_BEGIN] = "begin"};
    row headings, r;
    char column[32];
    if (!find_row(program, kernel, &headings, &r))
        return false;
    for (uint32_t k = 0; k < BB_ISSUE_KINDS; k++) {
        costs->instructions[k] = costs->in_regions[k] = 0;
        if (kinds[k] == NULL)
            continue;
        snprintf(column, sizeof column, "step_%s", kinds[k]);
        costs->instructions[k] = strtod(cell_of(&headings, &r, column), NULL);
        snprintf(column, sizeof column, "region_%s", kinds[k]);
        costs->in_regions[k] = strtod(cell_of(&headings, &r, column), NULL);
    }
    costs->in_regions[BB_ISSUE_BEGIN] = costs->instructions[BB_ISSUE_BEGIN];
    snprintf(column, sizeof column, strcmp(code, "sm_90") == 0 ? "%s_registers" : "%s_vgprs", code);
    costs->registers = (uint32_t)strtoul(cell_of(&headings, &r, column), NULL, 10);
    costs->counted = costs->instructions[BB_ISSUE_BEGIN] > 0;
    return costs->registers > 0;
}

bb_status bb_costs_find(const char *program, const char *kernel, const char *code, bb_costs *costs)
{
    if (find_program(program, kernel, code, costs))
        return BB_OK;
    return bb_fail(BB_UNSUPPORTED, "kernels/isa.tsv has no row of kernel %.*s for %s",
                   (int)strcspn(program, ":"), program, code);
}
