/* A comparison as JUnit's XML, which CI systems show test by test: each cell is a test, what is
 * worse of it is its failure. */
#include "framework/report/report_junit.h"

#include "framework/base/steering.h"
#include "framework/report/report_compare.h"

#include <math.h>
#include <string.h>

/* Prints text for an attribute or an element: XML has no other control characters. */
static void print_text(const char *text, FILE *out)
{
    char calm[1024];
    snprintf(calm, sizeof calm, "%s", text);
    bb_calm_text(calm);
    for (const char *c = calm; *c != '\0'; c++) {
        switch (*c) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc(*c, out);
        }
    }
}

static void print_attribute(const char *name, const char *value, FILE *out)
{
    fprintf(out, " %s=\"", name);
    print_text(value, out);
    fputc('"', out);
}

/* Describes a move in one line. */
static void describe(const bb_change *move, char *text, size_t capacity)
{
    char texts[2][40];
    if (strcmp(move->what, "status") == 0) {
        snprintf(text, capacity, "status: %s, then %s", move->before->status, move->after->status);
        return;
    }
    bb_compare_figures(move->from, move->to, texts);
    size_t used =
        (size_t)snprintf(text, capacity, "%s: %s, then %s", move->what, texts[0], texts[1]);
    if (isfinite(move->effect.ratio) && used < capacity)
        used += (size_t)snprintf(text + used, capacity - used, ", ratio %.3f", move->effect.ratio);
    if (move->timed && isfinite(move->effect.low) && used < capacity)
        snprintf(text + used, capacity - used, " [%.3f, %.3f]", move->effect.low,
                 move->effect.high);
}

static bool is_of(const bb_change *move, const char *key)
{
    char wall[BB_CELL_KEY];
    bb_wall_key(move->before->key, wall);
    return strcmp(wall, key) == 0;
}

static void print_element(const char *name, const char *message, FILE *out)
{
    fprintf(out, "      <%s", name);
    print_attribute("message", message, out);
    fprintf(out, "/>\n");
}

/* Prints what is worse of a cell, as one failure: the first in its message, all in its text.
 * Returns whether anything is. */
static bool print_failure(const bb_comparison_result *r, const char *key, FILE *out)
{
    char text[512];
    bool any = false;
    for (uint32_t i = 0; i < r->move_count; i++) {
        const bb_change *move = &r->moves[i];
        if (move->verdict != BB_WORSE || !move->counts || !is_of(move, key))
            continue;
        describe(move, text, sizeof text);
        if (!any) {
            fprintf(out, "      <failure");
            print_attribute("message", text, out);
            fputc('>', out);
        }
        any = true;
        print_text(text, out);
        fputc('\n', out);
    }
    if (any)
        fprintf(out, "</failure>\n");
    return any;
}

/* Returns why a cell that is not worse says nothing; NULL: it does. */
static const char *why_skipped(const bb_measured *before, const bb_measured *after)
{
    if (after == NULL)
        return "the cell is missing, which does not count";
    if (before->reference)
        return "a reference does not count";
    if (strcmp(before->status, "ok") != 0 || strcmp(after->status, "ok") != 0)
        return "not compared: it failed, or was refused";
    return bb_same_input(before, after) ? NULL : "not compared: another scene, or other rays";
}

static void print_case(const bb_comparison_result *r, const char *key, FILE *out)
{
    const bb_measured *before = bb_side_find(&r->before, key);
    const bb_measured *after = bb_side_find(&r->after, key);
    char brief[BB_CELL_KEY];
    bb_cell_key_short(key, brief);
    fprintf(out, "    <testcase");
    print_attribute("classname", "bvhbench", out);
    print_attribute("name", brief, out);
    fprintf(out, ">\n");
    const char *skipped = why_skipped(before, after);
    if (after == NULL && bb_counts_as_missing(before))
        print_element("failure", "the cell is missing", out);
    else if (!print_failure(r, key, out) && skipped != NULL)
        print_element("skipped", skipped, out);
    fprintf(out, "    </testcase>\n");
}

/* Whether something is worse of the cell. */
static bool is_worse(const bb_comparison_result *r, const char *key)
{
    for (uint32_t i = 0; i < r->move_count; i++)
        if (r->moves[i].verdict == BB_WORSE && r->moves[i].counts && is_of(&r->moves[i], key))
            return true;
    return false;
}

bb_status bb_report_junit(const bb_comparison_result *r, FILE *out)
{
    bb_side_place place = {0, 0};
    uint32_t cells = 0, worse = 0;
    for (const char *key; (key = bb_side_next(&r->before, &place)) != NULL;) {
        cells += !bb_is_clock(key);
        worse += !bb_is_clock(key) && is_worse(r, key);
    }
    fprintf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite");
    print_attribute("name", "bvhbench compare", out);
    fprintf(out, " tests=\"%u\" failures=\"%u\"", cells, worse + r->missing);
    print_attribute("hostname", r->after.sets[0].origin.host, out);
    fprintf(out, ">\n    <properties>\n");
    const struct {
        const char *name, *value;
    } properties[] = {{"before", r->before.sets[0].origin.revision},
                      {"after", r->after.sets[0].origin.revision},
                      {"device", r->after.sets[0].origin.device},
                      {"floor", r->floor.from}};
    for (size_t i = 0; i < sizeof properties / sizeof properties[0]; i++) {
        fprintf(out, "      <property");
        print_attribute("name", properties[i].name, out);
        print_attribute("value", properties[i].value, out);
        fprintf(out, "/>\n");
    }
    fprintf(out, "    </properties>\n");
    place = (bb_side_place){0, 0};
    for (const char *key; (key = bb_side_next(&r->before, &place)) != NULL;)
        if (!bb_is_clock(key))
            print_case(r, key, out);
    fprintf(out, "  </testsuite>\n</testsuites>\n");
    return ferror(out) ? bb_fail(BB_FAILED, "compare: cannot write the XML") : BB_OK;
}
