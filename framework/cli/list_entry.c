#include "framework/cli/list_entry.h"

#include <string.h>

static void print_entry(FILE *out, const char *name, const char *summary, const char *paper,
                        const bb_option *declared)
{
    fprintf(out, "  %-14s %s", name, summary);
    if (paper != NULL && paper[0] != '\0' && strcmp(paper, "none") != 0)
        fprintf(out, " (%s)", paper);
    fprintf(out, "\n");
    for (const bb_option *o = declared; o != NULL && o->name != NULL; o++) {
        const char *values = o->values != NULL ? o->values : "";
        fprintf(out, "      %s=%s  %s%s%s\n", o->name,
                o->default_value != NULL ? o->default_value : "", o->help,
                values[0] != '\0' ? ": " : "", values);
    }
}

static void add_options(bb_json *json, const bb_option *declared)
{
    bb_json_array(json, "options");
    for (const bb_option *o = declared; o != NULL && o->name != NULL; o++) {
        bb_json_object(json, NULL);
        bb_json_add_text(json, "name", o->name);
        if (o->default_value != NULL)
            bb_json_add_text(json, "default", o->default_value);
        if (o->values != NULL)
            bb_json_add_text(json, "values", o->values);
        bb_json_add_text(json, "help", o->help);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
}

static void add_references(bb_json *json, const bb_bibliography *papers)
{
    static const char *const names[] = {"key", "title", "year", "doi"};
    bb_json_array(json, "references");
    for (uint32_t i = 0; i < papers->count; i++) {
        bb_json_object(json, NULL);
        for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
            char value[BB_CITED_MAX];
            bb_citation_value(&papers->entries[i], names[n], value);
            if (value[0] != '\0')
                bb_json_add_text(json, names[n], value);
        }
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
}

/* `papers` is NULL for a name that is no method. */
static void add(bb_list *list, const char *name, const char *summary, const char *paper,
                const bb_option *declared, const bb_bibliography *papers)
{
    bb_json *json = list->json;
    if (list->papers != NULL)
        return;
    if (json == NULL) {
        print_entry(list->text, name, summary, paper, declared);
        return;
    }
    bb_json_object(json, NULL);
    bb_json_add_text(json, "name", name);
    bb_json_add_text(json, "summary", summary);
    if (paper != NULL)
        bb_json_add_text(json, "paper", paper);
    add_options(json, declared);
    if (papers != NULL)
        add_references(json, papers);
    bb_json_end_object(json);
}

void bb_list_add(bb_list *list, const char *name, const char *summary, const bb_option *declared)
{
    add(list, name, summary, NULL, declared, NULL);
}

bb_status bb_list_add_method(bb_list *list, const char *name, const char *summary,
                             const char *paper, const bb_option *declared, const char *file)
{
    bb_bibliography own = {.count = 0};
    if (list->papers != NULL || list->json != NULL)
        BB_TRY(bb_bibliography_add(list->papers != NULL ? list->papers : &own, file));
    add(list, name, summary, paper, declared, &own);
    return BB_OK;
}
