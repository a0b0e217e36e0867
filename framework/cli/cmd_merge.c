/* bvhbench merge: joins the shards of a run, or puts several runs of a command together. */
#include "framework/base/file.h"
#include "framework/cli/earlier.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/cli/output.h"
#include "framework/cli/report_table.h"
#include "framework/cli/shard_option.h"
#include "framework/compare/prediction.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PICTURE_BYTES_MAX = 64 << 20 };

/* A file and its shard. */
typedef struct part {
    const char *argument;
    bb_table_file file;
    bb_shard shard;  /* its count is 0 for a whole run */
    char prefix[16]; /* of its pictures' names in the merged folder */
} part;

typedef struct merging {
    const char *out, *history;
    part *parts;
    uint32_t count;
    bb_table_file all; /* the first part, to which the others are added */
} merging;

static const bb_cli_option options[] = {
    {"out", "DIR", "folder for results.json, report.html and pictures", BB_INTO(merging, out)},
    BB_HISTORY_OPTION(merging, history),
    {.name = NULL},
};

static bb_status read_part(const char *argument, part *p)
{
    char what[200];
    p->argument = argument;
    BB_TRY(bb_table_file_read(argument, &p->file));
    if (p->file.results == NULL) /* other commands have no shards */
        return BB_OK;
    const char *shard = bb_get_text(bb_results_context(p->file.results), BB_F_CONTEXT_SHARD);
    snprintf(what, sizeof what, "result file %.120s: \"shard\"", argument);
    return shard[0] != '\0' ? bb_shard_parse(shard, what, &p->shard) : BB_OK;
}

static bool any_shard(const part *parts, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (parts[i].shard.count > 0)
            return true;
    return false;
}

static int by_index(const void *a, const void *b)
{
    const part *x = a, *y = b;
    return (x->shard.index > y->shard.index) - (x->shard.index < y->shard.index);
}

/* Checks that all shards have the same count and none is given twice. */
static bb_status check_shards(part *parts, uint32_t count)
{
    qsort(parts, count, sizeof *parts, by_index);
    for (uint32_t i = 0; i < count && count > 1; i++) {
        if (parts[i].shard.count == 0)
            return bb_fail(BB_INVALID, "merge: %s is no shard: merge whole runs by themselves",
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

/* Refuses the folder of an input, whose results and pictures would be replaced. */
static bb_status check_out(const bb_cli *cli, const char *out)
{
    struct stat folder, other;
    for (uint32_t i = 0; i < cli->positional_count; i++) {
        char path[PATH_MAX];
        BB_TRY(bb_input_path(cli->positional[i], path));
        char *beside = bb_file_folder(path);
        if (beside == NULL)
            return bb_fail(BB_FAILED, "merge: no memory");
        const bool same = stat(out, &folder) == 0 && stat(beside, &other) == 0 &&
                          folder.st_dev == other.st_dev && folder.st_ino == other.st_ino;
        free(beside);
        if (same)
            return bb_fail(BB_INVALID,
                           "merge: %s lies in %s, where the merged run would go: name another "
                           "folder with --out",
                           path, out);
    }
    return BB_OK;
}

/* Whether it is the plain name of a picture, not of a file elsewhere or of results. */
static bool is_picture(const char *name)
{
    const char *end = strrchr(name, '.');
    return strchr(name, '/') == NULL && end != NULL && end > name && name[0] != '.' &&
           strcmp(end, ".png") == 0;
}

/* Copies a picture that lies beside the part's file. The page names those that are missing. */
static bb_status copy_picture(const part *p, const char *name, const char *folder, const char *as)
{
    char path[PATH_MAX], source[PATH_MAX], target[PATH_MAX], *data = NULL;
    size_t size;
    if (!is_picture(name))
        return BB_OK;
    BB_TRY(bb_input_path(p->argument, path));
    char *from = bb_file_folder(path);
    bb_status status =
        from != NULL ? bb_join_path(source, from, name) : bb_fail(BB_FAILED, "merge: no memory");
    if (status == BB_OK)
        status = bb_join_path(target, folder, as);
    if (status == BB_OK &&
        bb_file_read(source, PICTURE_BYTES_MAX, "picture", &data, &size) == BB_OK)
        status = bb_file_write(target, data, size, "picture");
    free(data);
    free(from);
    return status;
}

static bb_status copy_pictures(const part *p, const char *folder)
{
    const bb_results *results = p->file.results;
    for (uint32_t row = 0; results == NULL && row < bb_table_row_count(bb_table_of_file(&p->file));
         row++) {
        const char *as = bb_table_get_text(bb_table_of_file(&p->file), row, "picture");
        if (as[0] != '\0')
            BB_TRY(copy_picture(p, as + strlen(p->prefix), folder, as));
    }
    for (const bb_entry *picture =
             results != NULL ? bb_first(bb_results_section(results, BB_PICTURES)) : NULL;
         picture != NULL; picture = bb_next(picture)) {
        const char *name = bb_get_text(picture, BB_F_PICTURE_PATH);
        BB_TRY(copy_picture(p, name, folder, name));
    }
    return BB_OK;
}

static bb_status write_folder(const merging *m)
{
    char json[PATH_MAX], html[PATH_MAX], name[80];
    bb_results *results = m->all.results;
    const char *command = bb_table_command(bb_table_of_file(&m->all));
    snprintf(name, sizeof name, "%s.json", results != NULL ? "results" : command);
    BB_TRY(bb_join_path(json, m->out, name));
    snprintf(name, sizeof name, "%s.html", results != NULL ? "report" : command);
    BB_TRY(bb_join_path(html, m->out, name));
    BB_TRY(bb_keep_earlier(m->out, command, false));
    for (uint32_t i = m->count; i > 0; i--) /* of two with one name, that of the first run stays */
        BB_TRY(copy_pictures(&m->parts[i - 1], m->out));
    if (results != NULL)
        BB_TRY(bb_predictions_record(results));
    BB_TRY(bb_table_write(bb_table_of_file(&m->all), json));
    BB_TRY(results != NULL ? bb_report_html(results, m->out, html)
                           : bb_report_table_page(bb_table_of_file(&m->all), m->out, html));
    printf(" report   %s\n results  %s\n", html, json);
    return BB_OK;
}

/* ---- the command ---- */

/* Puts a number in front of the names of pictures: all runs of a command call theirs alike. Those
 * of results have the names of scenes. */
static void number_pictures(part *p, uint32_t run)
{
    bb_table *table = p->file.other;
    snprintf(p->prefix, sizeof p->prefix, "%u-", run);
    for (uint32_t row = 0; table != NULL && row < bb_table_row_count(table); row++) {
        char as[PATH_MAX];
        const char *name = bb_table_get_text(table, row, "picture");
        if (name[0] == '\0')
            continue;
        snprintf(as, sizeof as, "%s%s", p->prefix, name);
        bb_table_set_text(table, row, bb_table_column_named(table, "picture"), as);
    }
}

/* Adds a part to the first one: a shard, or a further run. */
static bb_status add_part(merging *m, part *p, bool shards)
{
    const bb_table_file *all = &m->all;
    if (strcmp(bb_table_command(bb_table_of_file(&p->file)),
               bb_table_command(bb_table_of_file(all))) != 0)
        return bb_fail(BB_INVALID, "it is a table of `%s`, %.200s one of `%s`",
                       bb_table_command(bb_table_of_file(&p->file)), m->parts[0].argument,
                       bb_table_command(bb_table_of_file(all)));
    number_pictures(p, bb_table_runs(bb_table_of_file(all)) + 1);
    return shards                 ? bb_results_join(all->results, p->file.results)
           : all->results != NULL ? bb_results_merge(all->results, p->file.results)
                                  : bb_table_merge(all->other, bb_table_of_file(&p->file));
}

/* Whole runs are appended each as one, all or none. */
static bb_status append(const merging *m, bool shards)
{
    if (shards || m->history == NULL)
        return bb_output_append(m->history, bb_table_of_file(&m->all));
    const bb_table **tables = calloc(m->count, sizeof *tables);
    if (tables == NULL)
        return bb_fail(BB_FAILED, "merge: no memory");
    for (uint32_t i = 0; i < m->count; i++)
        tables[i] = bb_table_of_file(&m->parts[i].file);
    bb_status status = bb_output_append_all(m->history, tables, m->count);
    free(tables);
    return status;
}

static bb_status merge(const bb_cli *cli, merging *m)
{
    part *parts = m->parts;
    for (uint32_t i = 0; i < m->count; i++)
        BB_TRY(read_part(cli->positional[i], &parts[i]));
    const bool shards = any_shard(parts, m->count);
    if (shards)
        BB_TRY(check_shards(parts, m->count));
    BB_TRY(bb_table_file_read(parts[0].argument, &m->all));
    for (uint32_t i = 1; i < m->count; i++) {
        bb_status status = add_part(m, &parts[i], shards);
        if (status != BB_OK)
            return bb_fail(status, "merge: %.200s: %s", parts[i].argument, bb_message());
    }
    if (shards && m->count > 1 && m->count == parts[0].shard.count)
        bb_results_end_join(m->all.results);
    if (m->all.results != NULL)
        BB_TRY(bb_report_verdict(m->all.results, stdout));
    if (m->out != NULL)
        BB_TRY(write_folder(m));
    return append(m, shards);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    merging *m = values;
    const uint32_t count = cli->positional_count;
    if (count == 0)
        return bb_fail(BB_INVALID, "merge: give the result files of shards, or their folders");
    if (m->out == NULL && m->history == NULL)
        return bb_fail(BB_INVALID, "merge: --out DIR says where the merged run goes");
    BB_TRY(bb_inputs_once(cli));
    m->parts = calloc(count, sizeof *m->parts);
    if (m->parts == NULL)
        return bb_fail(BB_FAILED, "merge: no memory");
    m->count = count;
    if (m->out != NULL) {
        BB_TRY(bb_out_folder(m->out));
        BB_TRY(check_out(cli, m->out));
    }
    BB_TRY(merge(cli, m));
    if (say_missing(m->parts, count))
        *exit_status = BB_EXIT_WRONG;
    return BB_OK;
}

static void release(void *values)
{
    merging *m = values;
    for (uint32_t i = 0; i < m->count; i++)
        bb_table_file_free(&m->parts[i].file);
    bb_table_file_free(&m->all);
    free(m->parts);
}

extern const bb_command bb_command_merge;
const bb_command bb_command_merge = {
    .name = "merge",
    .summary = "join the shards of a run (run --shard) into one, or put several runs together",
    .arguments = "FILE|DIR...",
    .details =
        "A folder stands for its results.json. The shards must be of one program, device and "
        "seed,\n"
        "and no cell may be in two of them. Exit status 1: shards are missing; what is there is\n"
        "merged. Whole runs of one command, also tables such as slice.json, become one file, in "
        "which the\n"
        "second and further ones are numbered; --history appends each of them, also one alone.\n"
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
