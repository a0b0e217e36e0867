/* bvhbench compare: what moved from one run, revision or program to another. */
#include "framework/base/interrupt.h"
#include "framework/base/steering.h"
#include "framework/cli/cli.h"
#include "framework/cli/inputs.h"
#include "framework/cli/interleave.h"
#include "framework/cli/out_option.h"
#include "framework/cli/time_option.h"
#include "framework/compare/compare.h"
#include "framework/compare/family.h"
#include "framework/compare/history.h"
#include "framework/report/report_compare.h"
#include "framework/report/report_junit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What is compared, of whatever origin. */
typedef struct inputs {
    bool programs, quiet;
    uint32_t rounds, format;
    uint64_t seed;
    const char *out, *database, *time;
    double percent, detect;
    bb_cell_set *sets[2];
    uint32_t counts[2];
    uint32_t measured; /* of them */
    bb_history *history;
    double threshold; /* a share; NAN: not given */
} inputs;

static const bb_cli_option options[] = {
    {"run", NULL, "OLD and NEW are programs: run both in turns, in pairs, and compare",
     BB_INTO(inputs, programs)},
    {"rounds", "N", "with --run: pairs that count, after a discarded one", BB_INTO(inputs, rounds),
     .high = BB_SAMPLES_MAX - 1, .fallback = "10", .with = "run"},
    {"time", "T",
     "with --run: take at most about this long, such as 5min, with fewer pairs if need be",
     BB_INTO(inputs, time), .with = "run"},
    {"seed", "N", "with --run: random seed that decides which program begins a pair",
     BB_INTO(inputs, seed), .fallback = "1", .with = "run"},
    {"out", "DIR", "with --run: keep all result files there; default: they are removed",
     BB_INTO(inputs, out), .with = "run"},
    {"history", "DB", "OLD and NEW may be revisions in this database; floors are kept there",
     BB_INTO(inputs, database)},
    {"threshold", "PERCENT", "least change of a time that counts; default: measured by A/A",
     BB_INTO(inputs, percent), .high = 1000},
    {"detect", "PERCENT",
     "exit status 2, unless a slowing by this much, of wall and processor time alike, would have "
     "been found in each cell",
     BB_INTO(inputs, detect), .high = 1000},
    {"format", NULL, "github, markdown: for a comment; junit: XML for CI, a test for each cell",
     BB_INTO(inputs, format), .words = "text|github|markdown|junit", .fallback = "text"},
    {"quiet", NULL, "with --run: do not show progress", BB_INTO(inputs, quiet), .with = "run"},
    {.name = NULL},
};

static bb_status allocate(inputs *in, uint32_t count)
{
    for (int k = 0; k < 2; k++) {
        in->sets[k] = calloc(count, sizeof *in->sets[k]);
        if (in->sets[k] == NULL)
            return bb_fail(BB_FAILED, "compare: no memory");
        in->counts[k] = count;
    }
    in->measured = count;
    return BB_OK;
}

/* Whoever asked for a comparison must not take none for one in which nothing is worse. */
static bb_status check_compared(const bb_comparison_result *r)
{
    if (r->unlike + r->faulty < r->common || r->move_count > 0)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "compare: nothing can be compared: of the %u cells that %s and %s have in "
                   "common, %u are of another scene or of other rays, and %u failed",
                   r->common, r->before.sets[0].origin.what, r->after.sets[0].origin.what,
                   r->unlike, r->faulty);
}

/* With --detect, a comparison that could not have seen such a slowing is none. */
static bb_status check_sights(const inputs *in, const bb_comparison_result *r)
{
    const uint32_t blind = bb_compare_blind(r, in->detect / 100);
    if (!(in->detect > 0) || (blind == 0 && r->sight_count > 0))
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "compare: blind: %u of %u times could not have shown %g %%: take more %s, or a "
                   "quieter machine",
                   r->sight_count > 0 ? blind : r->common,
                   r->sight_count > 0 ? r->sight_count : r->common, in->detect,
                   in->programs ? "--rounds" : "--repeats of run");
}

static bb_status print(const inputs *in, const bb_comparison_result *result)
{
    enum { TEXT, GITHUB, MARKDOWN, JUNIT }; /* the words of --format */
    return in->format == JUNIT ? bb_report_junit(result, stdout)
                               : bb_report_compare(result, in->format != TEXT, stdout);
}

static bb_status report(inputs *in, const bb_floor *floor, int *exit_status)
{
    bb_comparison_result result;
    const bb_side before = {in->sets[0], in->measured}, after = {in->sets[1], in->measured};
    bb_status status = bb_compare(&before, &after, in->threshold, floor, &result);
    if (status == BB_OK)
        status = check_compared(&result);
    if (status == BB_OK)
        status = print(in, &result);
    const bool worse = result.worse + result.missing > 0;
    *exit_status = worse ? BB_EXIT_WRONG : BB_EXIT_OK;
    if (status == BB_OK && !worse)
        status = check_sights(in, &result);
    bb_compare_free(&result);
    return status;
}

/* ---- files and revisions ---- */

static bb_status read_file(const char *argument, bb_cell_set *set)
{
    bb_table_file file;
    bb_status status = bb_table_file_read(argument, &file);
    if (status == BB_OK)
        status = bb_cell_set_of_table(bb_table_of_file(&file), argument, set);
    bb_table_file_free(&file);
    return status;
}

/* An argument: a file or folder if there is one of that name, else a revision. */
typedef struct side {
    const char *argument;
    bool revision;
    bb_history_entry entry;
    uint32_t others;
} side;

static bb_status find_side(const inputs *in, const bb_origin *like, side *s)
{
    struct stat info;
    s->revision = in->history != NULL && stat(s->argument, &info) != 0;
    return s->revision ? bb_history_find(in->history, s->argument, like, &s->entry, &s->others)
                       : BB_OK;
}

static bb_status read_side(const inputs *in, const side *s, bb_cell_set *set)
{
    if (!s->revision)
        return read_file(s->argument, set);
    if (s->others > 0) {
        const bb_origin *o = &s->entry.origin;
        char note[sizeof o->revision + sizeof o->host + sizeof o->device + 100];
        snprintf(note, sizeof note,
                 "%s was measured on %u other machines or devices too: here it is that of %s, %s",
                 o->revision, s->others, o->host, o->device);
        bb_calm_text(note);
        fprintf(stderr, "%s\n", note);
    }
    return bb_history_set(in->history, &s->entry, set);
}

/* Of revisions that several machines measured, those of one machine, if there is one. */
static bb_status read_sides(const bb_cli *cli, inputs *in)
{
    side before = {.argument = cli->positional[0]}, after = {.argument = cli->positional[1]};
    BB_TRY(find_side(in, NULL, &after));
    if (!after.revision)
        BB_TRY(read_side(in, &after, in->sets[1]));
    const bb_origin *like = after.revision ? &after.entry.origin : &in->sets[1]->origin;
    BB_TRY(find_side(in, like, &before));
    if (!before.revision)
        BB_TRY(read_side(in, &before, in->sets[0]));
    like = before.revision ? &before.entry.origin : &in->sets[0]->origin;
    if (after.revision) {
        BB_TRY(find_side(in, like, &after));
        BB_TRY(read_side(in, &after, in->sets[1]));
    }
    return before.revision ? read_side(in, &before, in->sets[0]) : BB_OK;
}

static bb_status compare_files(const bb_cli *cli, inputs *in, int *exit_status)
{
    bb_floor floor = BB_NO_FLOOR;
    if (cli->positional_count != 2)
        return bb_fail(BB_INVALID, "compare: give two: result files, folders of runs%s",
                       in->history != NULL ? ", or revisions" : "; revisions need --history");
    BB_TRY(allocate(in, 1));
    BB_TRY(read_sides(cli, in));
    bb_status status =
        in->history != NULL ? bb_history_floor(in->history, &in->sets[1]->origin, &floor) : BB_OK;
    if (status == BB_OK)
        status = report(in, isfinite(floor.share) ? &floor : NULL, exit_status);
    bb_floor_free(&floor);
    return status;
}

/* ---- programs ---- */

static bb_status check_arguments(char *const *arguments, uint32_t count)
{
    static const char *const ours[] = {"--out",    "--history",     "--quiet",
                                       "--charts", "--no-pictures", "--time"};
    for (uint32_t i = 0; i < count; i++)
        for (size_t k = 0; k < sizeof ours / sizeof ours[0]; k++)
            if (strncmp(arguments[i], ours[k], strlen(ours[k])) == 0)
                return bb_fail(BB_INVALID, "compare --run: leave %s out of the arguments of run",
                               ours[k]);
    return BB_OK;
}

/* What was measured of this machine serves for comparing runs by themselves later. */
static bb_status keep_floor(inputs *in)
{
    bb_floor floor = BB_NO_FLOOR;
    bb_status status = BB_OK;
    for (int k = 0; k < 2 && status == BB_OK; k++)
        status = bb_floor_take_runs(&floor, &(bb_side){in->sets[k], in->measured}, 1);
    bb_floor_finish_runs(&floor);
    if (status == BB_OK && isfinite(floor.share)) {
        if (in->history != NULL)
            status = bb_history_append_floor(in->history, &in->sets[1]->origin, &floor);
        fprintf(stderr,
                "between two runs of one program by themselves, up to %.2f %% in 90 %% of the "
                "cells%s\n",
                100 * floor.share,
                in->history != NULL ? ": kept in the history" : ": --history DB would keep that");
    }
    bb_floor_free(&floor);
    return status;
}

static bb_status compare_programs(const bb_cli *cli, inputs *in, int *exit_status)
{
    const uint32_t least = bb_family_pairs_needed(BB_COMPARE_LEVEL);
    uint32_t pairs;
    if (cli->positional_count < 2)
        return bb_fail(BB_INVALID, "compare --run: give two programs, and the arguments of run "
                                   "after --");
    bb_interleaving wanted = {.programs = {cli->positional[0], cli->positional[1]},
                              .arguments = cli->positional + 2,
                              .argument_count = cli->positional_count - 2,
                              .rounds = in->rounds,
                              .least = least,
                              .seed = in->seed,
                              .folder = in->out,
                              .quiet = in->quiet};
    if (in->rounds < least)
        return bb_fail(BB_INVALID, "--rounds is '%u', must be a whole number from %u to %d",
                       in->rounds, least, BB_SAMPLES_MAX - 1);
    BB_TRY(bb_time_option(in->time, &wanted.ends_ms));
    BB_TRY(check_arguments(wanted.arguments, wanted.argument_count));
    if (wanted.folder != NULL)
        BB_TRY(bb_out_folder(wanted.folder));
    BB_TRY(allocate(in, wanted.rounds + 1));
    BB_TRY(bb_interleave(&wanted, in->sets, &pairs));
    if (bb_interrupted() && pairs < least) {
        *exit_status = BB_EXIT_INTERRUPTED;
        fprintf(stderr, "bvhbench: interrupted before enough pairs were measured: %u of %u\n",
                pairs, least);
        return BB_OK;
    }
    in->measured = pairs + 1;
    BB_TRY(report(in, NULL, exit_status));
    if (bb_interrupted())
        *exit_status = BB_EXIT_INTERRUPTED;
    return keep_floor(in);
}

/* ---- the command ---- */

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    inputs *in = values;
    in->threshold = bb_cli_given(cli, &in->percent) ? in->percent / 100 : (double)NAN;
    if (in->database != NULL)
        BB_TRY(bb_history_open(in->database, in->programs, &in->history));
    return in->programs ? compare_programs(cli, in, exit_status)
                        : compare_files(cli, in, exit_status);
}

static void release(void *values)
{
    inputs *in = values;
    for (int k = 0; k < 2; k++) {
        for (uint32_t i = 0; in->sets[k] != NULL && i < in->counts[k]; i++)
            bb_cell_set_free(&in->sets[k][i]);
        free(in->sets[k]);
    }
    bb_history_close(in->history);
}

extern const bb_command bb_command_compare;
const bb_command bb_command_compare = {
    .name = "compare",
    .summary = "compare two runs, revisions or programs; exit status 1 if something is worse",
    .arguments = "OLD NEW | --run BINARY_A BINARY_B [-- ARGUMENTS OF RUN]",
    .details =
        "OLD and NEW are result files, folders of runs, or, with --history, revisions or their "
        "first\n"
        "letters. Cells are matched by their keys.\n"
        "A time has moved if the 95 % interval of the ratio of medians excludes 1, the ratio is "
        "beyond\n"
        "what the same program shows against itself on that machine (A/A), and its p-value, "
        "adjusted for\n"
        "all cells, is small: if equal programs are compared, one comparison in 100 raises an "
        "alarm.\n"
        "Pairs (--run) compare the least wall times of each run and the medians of its processor "
        "time,\n"
        "and measure their own A/A. Two separate runs are weaker evidence. Their A/A is what 90 % "
        "of "
        "the\n"
        "cells do not exceed in the history, which `compare --run A A --history DB` and two runs "
        "of "
        "one\n"
        "revision provide; if there is none, 10 % is assumed, and the output says so. If other "
        "programs\n"
        "kept the machine busy during either, a time that is less is undecided.\n"
        "SAH and bytes of trees and layouts, nodes, tests per ray, simulated figures, wrong rays\n"
        "and status are compared exactly; simulations of other numbers of rays are only said to "
        "differ.\n"
        "An option that OLD or NEW did not have yet counts with the default that it has here: let "
        "the\n"
        "newer program compare.\n"
        "The least slowing that would have been found is printed over all and for the blindest "
        "cells.\n"
        "Exit status 1: a time, SAH, tests, bytes, wrong rays or what is simulated are worse, a "
        "cell fails\n"
        "now or is missing, or its answers are not judged any more.",
    .options = options,
    .bytes = sizeof(inputs),
    .run = run,
    .release = release,
};
