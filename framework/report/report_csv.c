/* All traces as comma-separated values (RFC 4180): one line each, with what its build took. */
#include "framework/base/json.h"
#include "framework/report/report.h"

#include "framework/report/columns.h"

#include <math.h>
#include <string.h>

/* Of a trace's build. */
static const bb_field_id of_build[] = {BB_F_BUILD_MS_MEDIAN, BB_F_BUILD_RATE, BB_F_BUILD_HANDOVER,
                                       BB_F_TREE_NODES,      BB_F_TREE_DEPTH, BB_F_TREE_BYTES,
                                       BB_F_TREE_BYTES_PEAK};
enum { OF_BUILD = sizeof of_build / sizeof of_build[0] };

static bool is_column(const bb_field *field)
{
    const bool trace = field->part == BB_IN_TRACE || field->part == BB_IN_ACCURACY;
    const bool all_rounds = (field->kind & BB_FIELD_ROUNDS) != 0 && field->heading == NULL;
    return trace && !all_rounds && (field->kind & BB_FIELD_PARTS) == 0;
}

static void print_text(FILE *out, const char *text)
{
    bool quoted = strpbrk(text, ",\"\r\n") != NULL;
    if (quoted)
        fputc('"', out);
    while (*text != '\0') {
        if (*text == '"')
            fputc('"', out);
        text += bb_print_letter(out, text);
    }
    if (quoted)
        fputc('"', out);
}

static void print_number(FILE *out, double value)
{
    char digits[BB_JSON_DIGITS];
    if (isfinite(value))
        fputs(bb_json_digits(digits, value), out);
}

/* Nothing for what was not measured. */
static void print_field(FILE *out, const bb_entry *entry, bb_field_id field)
{
    print_text(out, bb_get_text(entry, field));
    print_number(out, bb_get_number(entry, field));
}

static void print_head(FILE *out)
{
    const char *before = "";
    for (size_t i = 0; i < BB_FIELDS; i++)
        if (is_column(&bb_fields[i])) {
            fprintf(out, "%s%s", before, bb_fields[i].name);
            before = ",";
        }
    for (size_t i = 0; i < OF_BUILD; i++)
        fprintf(out, ",%s%s", bb_fields[of_build[i]].part == BB_IN_TREE ? "tree_" : "",
                bb_fields[of_build[i]].name);
    fputs(",layout_ms,first_ray_ms", out);
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        fprintf(out, ",tree_%s", bb_metrics[i]->name);
    fputs("\r\n", out);
}

static void print_trace(FILE *out, const bb_entry *trace, const bb_entry *build)
{
    bool first = true;
    for (size_t i = 0; i < BB_FIELDS; i++) {
        if (!is_column(&bb_fields[i]))
            continue;
        fputs(first ? "" : ",", out);
        first = false;
        print_field(out, trace, (bb_field_id)i);
    }
    for (size_t i = 0; i < OF_BUILD; i++) {
        fputc(',', out);
        print_field(out, build, of_build[i]);
    }
    fputc(',', out);
    print_number(out,
                 bb_get_named(build, BB_F_BUILD_LAYOUTS_MS, bb_get_text(trace, BB_F_TRACE_LAYOUT)));
    fputc(',', out);
    print_number(out, bb_first_ray_ms(build, bb_get_text(trace, BB_F_TRACE_LAYOUT)));
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        fputc(',', out);
        print_number(out, bb_get_metric(build, bb_metrics[i]));
    }
    fputs("\r\n", out);
}

bb_status bb_report_csv(const bb_results *results, FILE *out)
{
    print_head(out);
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        print_trace(out, trace, bb_build_of(trace));
    }
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the table") : BB_OK;
}
