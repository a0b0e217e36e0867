/* bvhbench merge: joins the shards of a run. */
#include "framework/base/file.h"
#include "framework/cli/earlier.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/cli/output.h"
#include "framework/cli/shard_option.h"
#include "framework/report/report.h"
#include "framework/summary/prediction.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURE_BYTES_MAX = 64 << 20 };

/* A result file and its shard. */
typedef struct part {
    const char *argument;
    bb_results *results;
    bb_shard shard; /* its count is 0 for a whole run */
} part;

typedef struct merging {
    const char *out, *history;
    part *parts;
    uint32_t count;
} merging;

static const bb_cli_option options[] = {
    {"out", "DIR", "folder for results.json, report.html and pictures; needed with several files",
     BB_INTO(merging, out)},
    BB_HISTORY_OPTION(merging, history),
    {.name = NULL},
};

static bb_status read_part(const char *argument, part *p)
{
    char path[PATH_MAX], what[200];
    p->argument = argument;
    BB_TRY(bb_input_path(argument, path));
    BB_TRY(bb_results_read(path, &p->results));
    const char *shard = bb_get_text(bb_results_context(p->results), BB_F_CONTEXT_SHARD);
    snprintf(what, sizeof what, "result file %.120s: \"shard\"", path);
    return shard[0] != '\0' ? bb_shard_parse(shard, what, &p->shard) : BB_OK;
}

static int by_index(const void *a, const void *b)
{
    const part *x = a, *y = b;
    return (x->shard.index > y->shard.index) - (x->shard.index < y->shard.index);
}

/* Checks that all shards have the same count and none is given twice. */
static bb_status check_parts(part *parts, uint32_t count)
{
    qsort(parts, count, sizeof *parts, by_index);
    for (uint32_t i = 0; i < count && count > 1; i++) {
        if (parts[i].shard.count == 0)
            return bb_fail(BB_INVALID,
                           "merge: %s is no shard: bvhbench report makes one report of several "
                           "runs",
                           parts[i].argument);
        if (parts[i].shard.count != parts[0].shard.count)
            return bb_fail(BB_INVALID, "merge: %s is one of %u shards, %s one of %u",
                           parts[0].argument, parts[0].shard.count, parts[i].argument,
                           parts[i].shard.count);
        if (i > 0 && parts[i].shard.index == parts[i - 1].shard.index)
            return bb_fail(BB_INVALID, "merge: %s and %s are both shard %u: leave one out",
                           parts[i - 1].argument, parts[i].argument, parts[i].shard.index);
    }
    return BB_OK;
}

/* Reports missing shards. Returns whether any is missing. */
static bool say_missing(const part *parts, uint32_t count)
{
    uint32_t wanted = parts[0].shard.count, at = 0, missing = 0;
    for (uint32_t index = 1; index <= wanted; index++) {
        while (at < count && parts[at].shard.index < index)
            at++;
        if (at < count && parts[at].shard.index == index)
            continue;
        if (missing++ < 20)
            fprintf(stderr, "bvhbench: shard %u of %u is missing\n", index, wanted);
    }
    if (missing > 20)
        fprintf(stderr, "bvhbench: %u shards are missing\n", missing);
    return missing > 0;
}

/* ---- the folder ---- */

/* Copies pictures that lie beside their results, under a plain file name. The page names those that
 * are missing. */
static bb_status copy_pictures(const part *p, const char *folder)
{
    char path[PATH_MAX];
    BB_TRY(bb_input_path(p->argument, path));
    char *from = bb_file_folder(path);
    bb_status status = from != NULL ? BB_OK : bb_fail(BB_FAILED, "merge: no memory");
    bb_each(picture, bb_results_section(p->results, BB_PICTURES))
    {
        const char *name = bb_get_text(picture, BB_F_PICTURE_PATH);
        char source[PATH_MAX], target[PATH_MAX], *data = NULL;
        size_t size;
        if (status != BB_OK || strchr(name, '/') != NULL || name[0] == '.' || name[0] == '\0')
            continue;
        status = bb_join_path(source, from, name);
        if (status == BB_OK)
            status = bb_join_path(target, folder, name);
        if (status == BB_OK &&
            bb_file_read(source, PICTURE_BYTES_MAX, "picture", &data, &size) == BB_OK)
            status = bb_file_write(target, data, size, "picture");
        free(data);
    }
    free(from);
    return status;
}

static bb_status write_folder(part *parts, uint32_t count, const char *folder)
{
    char json[PATH_MAX], html[PATH_MAX];
    BB_TRY(bb_join_path(json, folder, "results.json"));
    BB_TRY(bb_join_path(html, folder, "report.html"));
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(copy_pictures(&parts[i], folder));
    BB_TRY(bb_keep_earlier(folder, false));
    BB_TRY(bb_predictions_record(parts[0].results));
    BB_TRY(bb_results_write(parts[0].results, json));
    BB_TRY(bb_report_html(parts[0].results, folder, html));
    printf("\n report   %s\n results  %s\n", html, json);
    return BB_OK;
}

/* ---- the command ---- */

/* Joins all parts into the first one, and copies the pictures of each part. */
static bb_status merge(const bb_cli *cli, merging *m)
{
    part *parts = m->parts;
    for (uint32_t i = 0; i < m->count; i++)
        BB_TRY(read_part(cli->positional[i], &parts[i]));
    BB_TRY(check_parts(parts, m->count));
    for (uint32_t i = 1; i < m->count; i++) {
        bb_status status = bb_results_join(parts[0].results, parts[i].results);
        if (status != BB_OK)
            return bb_fail(status, "merge: %.200s: %s", parts[i].argument, bb_message());
    }
    if (m->count > 1 && m->count == parts[0].shard.count)
        bb_results_end_join(parts[0].results);
    BB_TRY(bb_report_verdict(parts[0].results, stdout));
    if (m->out != NULL)
        BB_TRY(write_folder(parts, m->count, m->out));
    return bb_output_append(m->history, bb_results_table(parts[0].results));
}

/* A table has no shards, so it can only be appended to a history. */
static bb_status append_table(const merging *m, const char *path)
{
    bb_table *table;
    if (m->out != NULL || m->history == NULL)
        return bb_fail(BB_INVALID,
                       "merge: %.200s is a table, which has no shards: give --history alone", path);
    BB_TRY(bb_table_read(path, &table));
    bb_status status = bb_output_append(m->history, table);
    bb_table_free(table);
    return status;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    merging *m = values;
    char path[PATH_MAX];
    const uint32_t count = cli->positional_count;
    if (count == 0)
        return bb_fail(BB_INVALID, "merge: give the result files of shards, or their folders");
    BB_TRY(bb_input_path(cli->positional[0], path));
    if (count == 1 && bb_table_is_other(path, "run"))
        return append_table(m, path);
    if (m->out == NULL && (count > 1 || m->history == NULL))
        return bb_fail(BB_INVALID, "merge: --out DIR says where the merged run goes");
    BB_TRY(bb_inputs_once(cli));
    m->parts = calloc(count, sizeof *m->parts);
    if (m->parts == NULL)
        return bb_fail(BB_FAILED, "merge: no memory");
    m->count = count;
    if (m->out != NULL)
        BB_TRY(bb_out_folder(m->out));
    BB_TRY(merge(cli, m));
    if (say_missing(m->parts, count))
        *exit_status = BB_EXIT_WRONG;
    return BB_OK;
}

static void release(void *values)
{
    merging *m = values;
    for (uint32_t i = 0; i < m->count; i++)
        bb_results_destroy(m->parts[i].results);
    free(m->parts);
}

extern const bb_command bb_command_merge;
const bb_command bb_command_merge = {
    .name = "merge",
    .summary = "join the shards of a run (run --shard) into one run",
    .arguments = "FILE|DIR...",
    .details =
        "A folder stands for its results.json. The shards must be of one program, device and "
        "seed,\n"
        "and no cell may be in two of them. Exit status 1: shards are missing; what is there is\n"
        "merged. With one file and --history, appends a run that is there already, or a table: "
        "the\n"
        "file of animate, slice, overlap, volume, stress or advise.\n"
        "\n"
        "GNU parallel, on this machine one at a time (times need an idle machine), or on several:\n"
        "  parallel -j 1 bvhbench run --shard {}/4 --out out/shard-{} ::: 1 2 3 4\n"
        "  parallel -S node1,node2 --wd . -j 1 bvhbench run --shard {}/8 --out out/shard-{} ::: "
        "{1..8}\n"
        "A Slurm array, on nodes of one kind:\n"
        "  sbatch --array=1-8 --exclusive --wrap \\\n"
        "    'bvhbench run --shard $SLURM_ARRAY_TASK_ID/8 --out out/shard-$SLURM_ARRAY_TASK_ID'\n"
        "Then:\n"
        "  bvhbench merge out/shard-* --out out/merged --history bench.db",
    .options = options,
    .bytes = sizeof(merging),
    .run = run,
    .release = release,
};
