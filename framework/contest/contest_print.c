/* Ways as text and as JSON. */
#include "framework/contest/contest.h"
#include "framework/record/put.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

uint32_t bb_contest_rounds(const bb_contest_way *ways, uint32_t count)
{
    const uint32_t rounds = bb_contest_base(ways, count)->answer.count;
    return rounds > 1 ? rounds - 1 : 1;
}

bool bb_contest_print_name(const bb_contest_way *way)
{
    char name[240];
    const bool without = way->builder[0] == '\0';
    snprintf(name, sizeof name, "%s, %s", way->builder, way->search);
    printf(" %-38s", without ? "no tree" : name);
    if (way->refused[0] != '\0')
        printf(" %s\n", way->refused);
    else if (without)
        printf("%8s %8s", "", "");
    else
        printf("%8.2f %8.2f", bb_samples_median(&way->build), bb_samples_median(&way->layout));
    return way->refused[0] == '\0';
}

void bb_contest_print_interval(bb_estimate e)
{
    char text[64];
    if (isnan(e.low))
        snprintf(text, sizeof text, "[too few rounds]");
    else
        snprintf(text, sizeof text, "[%.3f, %.3f]", e.low, e.high);
    printf(" %-16s", text);
}

/* Ways of a builder follow each other, and have the same trees. */
void bb_contest_print_trees(const bb_contest_way *ways, uint32_t count, uint64_t prims)
{
    const char *last = "";
    for (uint32_t w = 0; w < count; w++) {
        if (ways[w].nodes == 0 || strcmp(ways[w].builder, last) == 0)
            continue;
        last = ways[w].builder;
        printf(" %-24s tree: %.2f MiB, %u nodes, %.2f references per tetrahedron\n", last,
               (double)ways[w].tree_bytes / (1 << 20), ways[w].nodes,
               (double)ways[w].references / (double)prims);
    }
}

void bb_contest_print_phases(const bb_contest_way *ways, uint32_t count)
{
    const char *last = "";
    for (uint32_t w = 0; w < count; w++) {
        const bb_contest_way *way = &ways[w];
        if (way->phase_count == 0 || strcmp(way->builder, last) == 0)
            continue;
        last = way->builder;
        printf(" %-24s ms: ", last);
        for (uint32_t p = 0; p < way->phase_count; p++)
            printf("%s%s %.3f", p > 0 ? ", " : "", way->phases[p].name,
                   bb_samples_median(&way->phases[p].ms));
        printf("\n");
    }
}

bb_status bb_contest_add_file(cJSON *files, const char *path)
{
    const char *slash = strrchr(path, '/');
    cJSON *name = cJSON_CreateString(slash != NULL ? slash + 1 : path);
    if (name != NULL && cJSON_AddItemToArray(files, name))
        return BB_OK;
    cJSON_Delete(name);
    return bb_fail(BB_REFUSED, "no memory for the names of pictures");
}

bool bb_contest_put_samples(cJSON *object, const char *name, const bb_samples *samples)
{
    bb_estimate e = bb_samples_estimate(samples);
    cJSON *figure = cJSON_CreateObject();
    return bb_put(object, name, figure) && bb_put_number(figure, "median", e.value) &&
           bb_put_number(figure, "lo", e.low) && bb_put_number(figure, "hi", e.high) &&
           bb_put_numbers(figure, "samples", samples->values, samples->count);
}

bool bb_contest_put_ratio(cJSON *object, const char *name, bb_estimate e)
{
    cJSON *figure = cJSON_CreateObject();
    return bb_put(object, name, figure) && bb_put_number(figure, "median", e.value) &&
           bb_put_number(figure, "lo", e.low) && bb_put_number(figure, "hi", e.high);
}

static bool put_phases(cJSON *object, const bb_contest_way *way)
{
    cJSON *phases = cJSON_CreateObject();
    bool put = bb_put(object, "phases_ms", phases);
    for (uint32_t p = 0; p < way->phase_count && put; p++)
        put = bb_contest_put_samples(phases, way->phases[p].name, &way->phases[p].ms);
    return put;
}

/* "picture" and "_cpu_ms" */
static const char *name_of(char name[64], const char *answer, const char *ending)
{
    snprintf(name, 64, "%s%s", answer, ending);
    return name;
}

bool bb_contest_put_way(cJSON *list, const bb_contest_way *first, const bb_contest_way *way,
                        const char *answer, cJSON **out)
{
    char name[64];
    cJSON *entry = cJSON_CreateObject();
    *out = NULL;
    if (entry == NULL || !cJSON_AddItemToArray(list, entry)) {
        cJSON_Delete(entry);
        return false;
    }
    if (!bb_put_text(entry, "builder", way->builder) || !bb_put_text(entry, "kernel", way->search))
        return false;
    if (way->refused[0] != '\0')
        return bb_put_text(entry, "refused", way->refused);
    *out = entry;
    bool put = bb_contest_put_samples(entry, name_of(name, answer, "_ms"), &way->answer) &&
               bb_contest_put_samples(entry, name_of(name, answer, "_cpu_ms"), &way->answer_cpu);
    if (way->builder[0] == '\0' || !put)
        return put;
    return bb_contest_put_samples(entry, "build_ms", &way->build) &&
           bb_contest_put_samples(entry, "layout_ms", &way->layout) && put_phases(entry, way) &&
           bb_contest_put_ratio(entry, name_of(name, answer, "_ratio"),
                                bb_contest_ratio(first, way, false)) &&
           bb_contest_put_ratio(entry, "all_ratio", bb_contest_ratio(first, way, true)) &&
           bb_put_number(entry, "references", way->references) &&
           bb_put_number(entry, "tree_bytes", (double)way->tree_bytes) &&
           bb_put_number(entry, "nodes", way->nodes) &&
           bb_put_number(entry, "leaves", way->leaves) &&
           bb_put_number(entry, "bytes", (double)way->bytes);
}
