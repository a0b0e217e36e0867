#include "framework/stress/point_private.h"

#include "framework/base/identity.h"
#include "framework/base/interrupt.h"
#include "framework/base/steering.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- files ---- */

/* Hashes the contents of a scene file. */
static void add_scene(bb_identity *identity, const bb_points *p, double x)
{
    char text[2 * BB_AXIS_TEXT];
    if (bb_axis_fill(p->axis->scene, x, p->n, text, sizeof text) == BB_OK)
        bb_identity_add_file(identity, text);
}

/* Hashes everything that the figures depend on. */
static bb_status hash_of(const bb_point_work *work, uint64_t *hash)
{
    const bb_points *p = work->points;
    const uint64_t numbers[] = {p->identity,         p->n,       p->max_rays,
                                p->repeats,          p->seed,    (uint64_t)p->limits.seconds,
                                p->limits.megabytes, work->again};
    bb_identity *identity = bb_identity_begin();
    bb_identity_add(identity, numbers, sizeof numbers);
    bb_identity_add_text(identity, p->axis->text);
    for (uint32_t i = 0; i < p->simt_count; i++) {
        bb_identity_add_text(identity, p->simts[i].name);
        bb_identity_add(identity, &p->simts[i].device, sizeof p->simts[i].device);
    }
    for (uint32_t i = 0; i < work->count; i++) {
        const bb_wish *wish = &work->wishes[i];
        bb_identity_add(identity, &wish->x, sizeof wish->x);
        add_scene(identity, p, wish->x);
        for (uint32_t m = 0; m < p->method_count; m++)
            if (wish->wanted[m]) {
                bb_identity_add_text(identity, bb_method_part_word(p->methods[m].part));
                bb_identity_add_text(identity, p->methods[m].text);
            }
    }
    return bb_identity_end(identity, p->axis->name, hash);
}

/* ---- one process ---- */

static void set_all(const bb_point_work *work, bb_outcome outcome, const char *words)
{
    for (uint32_t i = 0; i < work->count; i++)
        for (uint32_t m = 0; m < work->points->method_count; m++) {
            bb_point_figures *f = &work->wishes[i].figures[m];
            if (!work->wishes[i].wanted[m])
                continue;
            *f = bb_no_figures(outcome);
            snprintf(f->reason, sizeof f->reason, "%.255s", words);
            bb_calm_text(f->reason); /* the last letter may be cut off */
        }
}

static bb_outcome outcome_of(bb_child_end end)
{
    return end == BB_CHILD_HUNG      ? BB_OUT_HUNG
           : end == BB_CHILD_FLOODED ? BB_OUT_MEMORY
           : end == BB_CHILD_CRASHED ? BB_OUT_CRASHED
                                     : BB_OUT_FAILED;
}

/* Measures in one child. *died: the process ended before it wrote its file. */
static bb_status run_once(bb_point_work *work, char path[1200], bool *died)
{
    bb_points *p = work->points;
    bb_child_report report;
    char words[520];
    uint64_t hash = 0;
    *died = false;
    BB_TRY(hash_of(work, &hash));
    snprintf(path, 1200, "%s/%s-%016llx.json", p->folder, p->axis->name, (unsigned long long)hash);
    work->path = path;
    if (access(path, F_OK) == 0 && bb_point_read(work) == BB_OK) {
        p->taken_over += work->count;
        return BB_OK;
    }
    BB_TRY(bb_child_run(bb_point_child, work, &p->limits, &report));
    if (report.end == BB_CHILD_INTERRUPTED)
        return BB_OK;
    if (report.end == BB_CHILD_STOPPED)
        return bb_fail(BB_FAILED, "%s; what was measured before is kept: the same command goes on",
                       report.said);
    if (report.end == BB_CHILD_DONE && bb_point_read(work) == BB_OK) {
        p->measured += work->count;
        return BB_OK;
    }
    if (report.end == BB_CHILD_DONE)
        snprintf(report.words, sizeof report.words, "%s", bb_message());
    snprintf(words, sizeof words, "%s%s%s", report.words, report.said[0] != '\0' ? ": " : "",
             report.said);
    set_all(work, outcome_of(report.end), words);
    *died = true;
    return BB_OK;
}

/* Counts the wanted methods with this outcome. */
static uint32_t count_outcome(const bb_points *points, const bb_wish *wishes, uint32_t count,
                              bb_outcome outcome)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t m = 0; m < points->method_count; m++)
            found += wishes[i].wanted[m] && wishes[i].figures[m].outcome == outcome;
    return found;
}

static bb_status run_wishes(bb_points *points, bb_wish *wishes, uint32_t count, bool again);

/* Measures values one by one if there are several, else methods. */
static bb_status run_apart(bb_points *points, bb_wish *wishes, uint32_t count, bool again)
{
    for (uint32_t i = 0; count > 1 && i < count && !bb_interrupted(); i++)
        BB_TRY(run_wishes(points, &wishes[i], 1, again));
    for (uint32_t m = 0; count == 1 && m < points->method_count && !bb_interrupted(); m++) {
        bb_wish one = {.x = wishes[0].x, .figures = wishes[0].figures};
        if (!wishes[0].wanted[m])
            continue;
        one.wanted[m] = true;
        BB_TRY(run_wishes(points, &one, 1, again));
    }
    return BB_OK;
}

/* A method that dies alone gets a verdict, which is kept. A process that dies only with several
 * methods is a mishap, which is a bug too. */
static bb_status run_wishes(bb_points *points, bb_wish *wishes, uint32_t count, bool again)
{
    char path[1200], reason[256];
    bb_point_work work = {.points = points, .wishes = wishes, .count = count, .again = again};
    uint32_t methods = 0, first = 0;
    bool died;
    BB_TRY(run_once(&work, path, &died));
    if (!died || bb_interrupted())
        return BB_OK;
    for (uint32_t m = points->method_count; m-- > 0;)
        if (wishes[0].wanted[m]) {
            methods++;
            first = m;
        }
    const bb_outcome end = wishes[0].figures[first].outcome;
    if (count == 1 && methods == 1) {
        points->measured++;
        return bb_point_write(&work, NULL);
    }
    snprintf(reason, sizeof reason, "%s", wishes[0].figures[first].reason);
    set_all(&work, BB_NOT_MEASURED, "");
    BB_TRY(run_apart(points, wishes, count, again));
    /* the first is told: times that are in doubt are measured again, and may end like it */
    if (points->mishap[0] == '\0' && !bb_interrupted() &&
        count_outcome(points, wishes, count, end) == 0)
        snprintf(points->mishap, sizeof points->mishap,
                 "%s: a process with several measurements %s, from %.9g on: %s", points->axis->name,
                 bb_outcome_word(end), wishes[0].x, reason);
    return BB_OK;
}

bb_status bb_point_measure(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    return run_wishes(user, wishes, count, again);
}

/* ---- in the child ---- */

int bb_point_child(void *user)
{
    const bb_point_work *work = user;
    const bb_points *p = work->points;
    bb_device *device = NULL;
    bb_status status = p->open_device(p->user, &device);
    for (uint32_t i = 0; i < work->count && status == BB_OK; i++) {
        bb_child_alive();
        (p->axis->frames > 0 ? bb_point_frames : bb_point_bench)(p, device, &work->wishes[i]);
    }
    /* a lost device is no fault of the methods */
    const bool lost = status == BB_OK && bb_device_check(device) != BB_OK;
    if (status == BB_OK && !lost)
        status = bb_point_write(work, device);
    if (lost)
        fprintf(stderr, "%s\n", bb_message());
    else if (status != BB_OK)
        fprintf(stderr, "bvhbench: %s\n", bb_message());
    /* the device stays open until the process ends, since closing it is not tested */
    return lost ? BB_STOP_ALL : status == BB_OK ? 0 : 1;
}
