#include "framework/report/report_papers.h"
#include "framework/base/json.h"
#include "framework/builder/bibliography.h"

#include <stdio.h>
#include <string.h>

enum { NAME_BYTES = 64 };

static void add_papers(bb_json *json, const char *name)
{
    bb_bibliography papers = {.count = 0};
    char file[NAME_BYTES + 4], title[BB_CITED_MAX], doi[BB_CITED_MAX];
    snprintf(file, sizeof file, "%s.bib", name);
    bb_json_array(json, name);
    if (bb_bibliography_add(&papers, file) != BB_OK)
        papers.count = 0; /* `list --bibtex` says why */
    for (uint32_t i = 0; i < papers.count; i++) {
        bb_citation_value(&papers.entries[i], "title", title);
        bb_citation_value(&papers.entries[i], "doi", doi);
        if (doi[0] == '\0')
            continue;
        bb_json_object(json, NULL);
        bb_json_add_text(json, "title", title);
        bb_json_add_text(json, "doi", doi);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
}

/* Copies the next name of a specification, such as "lbvh" and "rotate" of "lbvh:bits=63+rotate",
 * and returns what follows; NULL: there is none. */
static const char *next_name(const char *at, char name[NAME_BYTES])
{
    if (*at == '\0')
        return NULL;
    snprintf(name, NAME_BYTES, "%.*s", (int)strcspn(at, ":+"), at);
    at += strcspn(at, "+");
    return *at == '+' ? at + 1 : at;
}

/* Whether a build before `until` names it. */
static bool was_named(const bb_results *results, const bb_entry *until, const char *wanted)
{
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        char name[NAME_BYTES];
        if (build == until)
            break;
        for (const char *at = bb_get_text(build, BB_F_BUILD_BUILDER);
             (at = next_name(at, name)) != NULL;)
            if (strcmp(name, wanted) == 0)
                return true;
    }
    return false;
}

char *bb_papers_json(const bb_results *results)
{
    bb_json json = {0};
    bb_json_object(&json, NULL);
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        char name[NAME_BYTES];
        for (const char *at = bb_get_text(build, BB_F_BUILD_BUILDER);
             (at = next_name(at, name)) != NULL;)
            if (!was_named(results, build, name))
                add_papers(&json, name);
    }
    bb_json_end_object(&json);
    return bb_json_take(&json);
}
