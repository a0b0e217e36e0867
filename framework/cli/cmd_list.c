/* bvhbench list: lists names that options take. */
#include "framework/base/suggest.h"
#include "framework/builder/metric.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"
#include "framework/cli/choice.h"
#include "framework/cli/list_entry.h"
#include "framework/device/device_private.h"
#include "framework/papers/reproduce.h"
#include "framework/scene/scene.h"
#include "framework/simulate/simulate.h"
#include "framework/stress/axis.h"
#include "framework/workload/workload.h"
#include "traversal/traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct wanted {
    bool json, bibtex, isa;
    bb_device_choice device; /* only its plug-ins are used */
} wanted;

static const bb_cli_option options[] = {
    {"json", NULL, "print JSON", BB_INTO(wanted, json)},
    {"bibtex", NULL, "print the papers that methods implement, as BibTeX", BB_INTO(wanted, bibtex),
     .apart = "json"},
    {"isa", NULL, "with `kernels`: registers, memory and loads of their code for GPUs",
     BB_INTO(wanted, isa), .apart = "json|bibtex"},
    BB_GROUP(bb_plugin_options, wanted, device),
    {.name = NULL},
};

/* The BibTeX file of a method: PREFIX NAME.bib. */
typedef struct bib_name {
    char text[96];
} bib_name;

static bib_name bib_of(const char *prefix, const char *name)
{
    bib_name bib;
    snprintf(bib.text, sizeof bib.text, "%s%s.bib", prefix, name);
    return bib;
}

static bb_status list_builders(bb_list *list)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *b = bb_builder_at(i);
        BB_TRY(bb_list_add_method(list, b->name, b->summary, b->paper, b->options,
                                  bib_of("", b->name).text));
    }
    return BB_OK;
}

static bb_status list_tracers(bb_list *list)
{
    for (uint32_t i = 0; i < bb_tracer_count(); i++) {
        const bb_tracer *t = bb_tracer_at(i);
        BB_TRY(bb_list_add_method(list, t->name, t->summary, t->paper, t->options,
                                  bib_of("", t->name).text));
    }
    return BB_OK;
}

static bb_status list_kernels(bb_list *list)
{
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
        bb_option all[BB_PARAMS_MAX + 1];
        uint32_t count = 0;
        for (const bb_option *o = bb_kernel_common_options; o->name != NULL; o++)
            all[count++] = *o;
        for (const bb_option *o = (*k)->options; o != NULL && o->name != NULL; o++)
            all[count++] = *o;
        all[count] = (bb_option){.name = NULL};
        BB_TRY(bb_list_add_method(list, (*k)->name, (*k)->summary, (*k)->paper, all,
                                  bib_of("kernel_", (*k)->name).text));
    }
    return BB_OK;
}

static bb_status list_layouts(bb_list *list)
{
    for (const bb_layout *const *l = bb_layouts; *l != NULL; l++)
        bb_list_add(list, (*l)->name, (*l)->summary, NULL);
    return BB_OK;
}

static bb_status list_intersectors(bb_list *list)
{
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++) {
        const char *const own[] = {i->triangle, i->slab, i->contract};
        bb_option options[sizeof own / sizeof own[0] + 1] = {{.name = NULL}};
        for (size_t k = 0; bb_intersector_options[k].name != NULL; k++) {
            options[k] = bb_intersector_options[k];
            options[k].default_value = own[k];
        }
        BB_TRY(bb_list_add_method(list, i->name, i->summary, NULL, options,
                                  bib_of("triangle_", i->triangle).text));
    }
    return BB_OK;
}

/* Makes the name of a file of the format from its first ending. */
static void add_format(bb_list *list, const bb_scene_format *format)
{
    char name[64], summary[256];
    size_t used = (size_t)snprintf(summary, sizeof summary, "a file, %s", format->name);
    snprintf(name, sizeof name, "FILE%s", format->endings[0]);
    for (size_t i = 1; format->endings[i] != NULL && used < sizeof summary; i++)
        used += (size_t)snprintf(summary + used, sizeof summary - used, "%s%s",
                                 i == 1 ? "; also " : ", ", format->endings[i]);
    bb_list_add(list, name, summary, format->options);
}

static bb_status list_scenes(bb_list *list)
{
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++)
        bb_list_add(list, *name, "shipped with bvhbench", NULL);
    for (const bb_generator *const *g = bb_generators; *g != NULL; g++)
        bb_list_add(list, (*g)->name, (*g)->summary, (*g)->options);
    for (const bb_scene_format *const *f = bb_scene_formats; *f != NULL; f++)
        add_format(list, *f);
    return BB_OK;
}

static bb_status list_rays(bb_list *list)
{
    for (const bb_workload *const *w = bb_workloads; *w != NULL; w++)
        bb_list_add(list, (*w)->name, (*w)->summary, (*w)->options);
    return BB_OK;
}

static bb_status list_metrics(bb_list *list)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        const bb_metric *m = bb_metrics[i];
        char summary[512];
        snprintf(summary, sizeof summary, "%s%s", m->full_title,
                 m->on_request ? ": `run --metrics` measures it" : ": always measured");
        BB_TRY(bb_list_add_method(list, m->name, summary, NULL, NULL,
                                  bib_of("metric_", m->name).text));
    }
    char devices[256];
    bb_option options[BB_PARAMS_MAX + 1];
    uint32_t count = 0;
    bb_description_names("|", devices, sizeof devices);
    do {
        options[count] = bb_simt_options[count];
        if (options[count].name != NULL && strcmp(options[count].name, "device") == 0)
            options[count].values = devices;
    } while (options[count++].name != NULL);
    return bb_list_add_method(
        list, BB_SIMT, "each trace and each build, simulated on a GPU on paper: `run --metrics`",
        NULL, options, bib_of("metric_", BB_SIMT).text);
}

static bb_status list_papers(bb_list *list)
{
    for (const bb_paper *const *p = bb_papers; *p != NULL; p++)
        bb_list_add(list, (*p)->name, (*p)->title, NULL);
    return BB_OK;
}

static bb_status list_axes(bb_list *list)
{
    for (const bb_axis_source *s = bb_axis_sources; s->name != NULL; s++) {
        bb_axis axis;
        char text[2 * BB_AXIS_TEXT + 64];
        BB_TRY(bb_axis_load(s->name, &axis));
        snprintf(text, sizeof text, "%s: %s, %g to %g", axis.title, axis.parameter, axis.from,
                 axis.to);
        bb_list_add(list, axis.name, text, NULL);
        bb_axis_free(&axis);
    }
    return BB_OK;
}

static bb_status list_devices(bb_list *list)
{
    uint32_t count;
    BB_TRY(bb_device_count(&count));
    if (count == 0 && list->json == NULL) {
        char reason[320];
        bb_device_say_none(reason, sizeof reason);
        fprintf(list->text, "  none: %s\n", reason);
    }
    for (uint32_t i = 0; i < count; i++) {
        char number[16], text[512];
        snprintf(number, sizeof number, "%u", i);
        BB_TRY(bb_device_describe(i, text, sizeof text));
        if (i == 0)
            strncat(text, " (the default)", sizeof text - strlen(text) - 1);
        bb_list_add(list, number, text, NULL);
    }
    return BB_OK;
}

static bb_status list_transfers(bb_list *list)
{
    for (const bb_transfer_preset *p = bb_transfer_presets; p->name != NULL; p++)
        bb_list_add(list, p->name, p->summary, NULL);
    return BB_OK;
}

/* What `run` compares if nothing is chosen. */
static bb_status add_compared(bb_list *list, const char *what, bb_status status, bb_names *names)
{
    for (size_t i = 0; i < names->count && status == BB_OK; i++)
        bb_list_add(list, names->items[i],
                    strcmp(what, "builder") == 0 && bb_is_reference(names->items[i]) ? "reference"
                                                                                     : what,
                    NULL);
    bb_names_free(names);
    return status;
}

static bb_status list_compared(bb_list *list)
{
    bb_names names = {0};
    BB_TRY(add_compared(list, "scene", bb_add_shipped_scenes(&names), &names));
    BB_TRY(add_compared(list, "builder", bb_choose_entrants(&names, NULL), &names));
    BB_TRY(add_compared(list, "kernel", bb_choose_kernels(&names, NULL), &names));
    BB_TRY(add_compared(list, "rays", bb_names_add(&names, BB_COMPARED_RAYS), &names));
    return add_compared(list, "intersector", bb_names_add(&names, BB_COMPARED_INTERSECTORS),
                        &names);
}

static const struct {
    const char *name;
    bb_status (*fill)(bb_list *list);
    bool cites; /* they implement papers */
} kinds[] = {
    {"builders", list_builders, true},
    {"tracers", list_tracers, true},
    {"kernels", list_kernels, true},
    {"layouts", list_layouts, false},
    {"intersectors", list_intersectors, true},
    {"scenes", list_scenes, false},
    {"rays", list_rays, false},
    {"metrics", list_metrics, true},
    {"papers", list_papers, false},
    {"axes", list_axes, false},
    {"transfers", list_transfers, false},
    {"compared", list_compared, false},
    {"devices", list_devices, false},
};

enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

/* Prints kernels/isa.tsv in columns: the first pass measures widths, the second prints. */
static void print_isa(void)
{
    enum { COLUMNS_MAX = 48 };
    int widths[COLUMNS_MAX] = {0};
    for (int pass = 0; pass < 2; pass++) {
        const char *line = bb_source_find("isa.tsv")->text;
        for (; *line != '\0'; line += strcspn(line, "\n") + 1) {
            if (*line == '#') {
                if (pass == 1)
                    printf("%.*s\n", (int)strcspn(line, "\n"), line);
                continue;
            }
            for (int column = 0; column < COLUMNS_MAX; column++) {
                int length = (int)strcspn(line, "\t\n");
                if (pass == 0 && widths[column] < length)
                    widths[column] = length;
                if (pass == 1)
                    printf("%*.*s%s", column < 3 ? -widths[column] : widths[column], length, line,
                           line[length] == '\t' ? "  " : "\n");
                line += length;
                if (*line != '\t')
                    break;
                line++;
            }
        }
    }
}

static bb_status unknown_kind(const char *kind)
{
    bb_suggestion meant = {.word = kind};
    for (uint32_t i = 0; i < KIND_COUNT; i++)
        bb_suggest(&meant, kinds[i].name);
    return bb_fail(BB_INVALID, "there is no list '%s'%s: see `bvhbench list --help`", kind,
                   bb_suggested(&meant));
}

/* Prints all lists, or the given one. */
static bb_status fill(const char *wanted, bb_list *list)
{
    bool found = false;
    for (uint32_t i = 0; i < KIND_COUNT; i++) {
        if (wanted != NULL && strcmp(wanted, kinds[i].name) != 0)
            continue;
        found = true;
        if (list->json != NULL)
            bb_json_array(list->json, kinds[i].name);
        else
            fprintf(list->text, "%s\n", kinds[i].name);
        BB_TRY(kinds[i].fill(list));
        if (list->json != NULL)
            bb_json_end_array(list->json);
        else
            fprintf(list->text, "\n");
    }
    return found ? BB_OK : unknown_kind(wanted);
}

/* Prints the papers of all methods, or of those of the given kind, each of them once. */
static bb_status print_bibtex(const char *wanted)
{
    bb_bibliography papers = {.count = 0};
    bb_list list = {.papers = &papers};
    bool found = wanted == NULL;
    for (uint32_t i = 0; i < KIND_COUNT; i++) {
        if (wanted != NULL && strcmp(wanted, kinds[i].name) != 0)
            continue;
        found = true;
        if (wanted != NULL && !kinds[i].cites)
            return bb_fail(BB_INVALID,
                           "%s implement no papers: list builders --bibtex, or tracers, kernels, "
                           "intersectors, metrics",
                           wanted);
        if (kinds[i].cites)
            BB_TRY(kinds[i].fill(&list));
    }
    for (uint32_t i = 0; i < papers.count; i++)
        printf("%.*s\n\n", (int)papers.entries[i].length, papers.entries[i].text);
    return found ? BB_OK : unknown_kind(wanted);
}

static bb_status print(const char *wanted, bool as_json)
{
    bb_json json = {.formatted = true};
    char *text = NULL;
    size_t size;
    bb_list list = {.text = open_memstream(&text, &size), .json = as_json ? &json : NULL};
    if (list.text == NULL)
        return bb_fail(BB_REFUSED, "no memory for the list");
    if (as_json)
        bb_json_object(&json, NULL);
    bb_status status = fill(wanted, &list);
    if (as_json)
        bb_json_end_object(&json);
    char *document = as_json ? bb_json_take(&json) : NULL;
    const bool whole = ferror(list.text) == 0 && (!as_json || document != NULL);
    if (fclose(list.text) != 0 || !whole)
        status = status != BB_OK ? status : bb_fail(BB_REFUSED, "no memory for the list");
    if (status == BB_OK)
        printf(as_json ? "%s\n" : "%s", as_json ? document : text);
    free(document);
    free(text);
    return status;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    (void)exit_status;
    const wanted *w = values;
    BB_TRY(bb_load_plugins(&w->device.plugins));
    const char *kind = cli->positional_count > 0 ? cli->positional[0] : NULL;
    if (cli->positional_count > 1)
        return bb_fail(BB_INVALID, "list takes one kind: drop '%s'", cli->positional[1]);
    if (!w->isa)
        return w->bibtex ? print_bibtex(kind) : print(kind, w->json);
    if (kind == NULL || strcmp(kind, "kernels") != 0)
        return bb_fail(BB_INVALID, "--isa is of kernels: list kernels --isa");
    print_isa();
    return BB_OK;
}

extern const bb_command bb_command_list;
const bb_command bb_command_list = {
    .name = "list",
    .summary = "list what there is to choose from: builders, scenes, devices and so on",
    .arguments = "[builders|tracers|kernels|layouts|intersectors|scenes|rays|metrics|papers|axes|"
                 "transfers|compared|devices]",
    .options = options,
    .bytes = sizeof(wanted),
    .run = run,
};
