/* Builds of a scene that no builder and no tracer has seen: whoever builds it in the time of its
 * other builds, and right, builds each time. Who remembers trees is slower, or wrong.
 *
 * The scene is disguised in place, as nobody can foresee: the system's random numbers say how, and
 * before which round. */
#include "framework/bench/bench_private.h"

#include "framework/base/clock.h"
#include "framework/scene/disguise.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

enum { AGAIN = 3 }; /* further disguises, if the first took suspiciously long */

/* Whether a build took suspiciously long beside another: half as long again, and longer than what
 * caches that the disguise has filled may cost. */
static bool took_long(double ms, double other_ms)
{
    const double times = 1.5, caches_ms = 0.05;
    return ms > times * other_ms + caches_ms;
}

uint32_t bb_bench_draw_unseen(bb_bench *bench, uint32_t rounds)
{
    uint64_t seed = 0;
    if (getrandom(&seed, sizeof seed, 0) != (ssize_t)sizeof seed)
        seed = (uint64_t)(bb_wall_ms() * 1e6);
    bench->unseen = bb_random_make(seed, 0);
    return rounds > 1 ? 1 + bb_random_below(&bench->unseen, rounds - 1) : BB_NONE;
}

/* Says how the scene is disguised, for whoever wants to see the same input. */
static const char *looks_like(const bb_bench *bench, char text[128])
{
    const bb_disguise *disguise = &bench->disguise;
    size_t used = (size_t)snprintf(text, 128, "mirrored along");
    for (int axis = 0; axis < 3; axis++)
        if ((disguise->mirrored >> axis & 1) != 0)
            used += (size_t)snprintf(text + used, 128 - used, " %c", "xyz"[axis]);
    snprintf(text + used, 128 - used, "%s", disguise->mirrored == 0 ? " no axis" : "");
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (bench->scene->prims[kind].count > 1) {
            used = strlen(text);
            snprintf(text + used, 128 - used, ", numbered from %u on", disguise->shift[kind]);
        }
    return text;
}

static bb_status check_tree(bb_instance *instance, const bb_scene *scene)
{
    BB_TRY(bb_tree_download(&instance->tree, NULL));
    return bb_tree_check(&instance->tree, scene);
}

/* Disguises the scene, if it can be. */
static bb_status put_on(bb_bench *bench, bool *disguised)
{
    const bb_status status = bb_disguise_put_on(&bench->disguise, &bench->unseen, bench->scene);
    *disguised = status == BB_OK;
    if (status != BB_UNSUPPORTED && status != BB_REFUSED)
        return status;
    bb_progress_note(bench->progress, "%s: no builder is tried on an input it has not seen: %s",
                     bench->scene->name, bb_message());
    return bb_disguise_take_off(&bench->disguise, bench->scene);
}

/* Builds the tree, and checks it at once or, for lack of room, a copy of it after the builder has
 * gone. */
static bb_status build_and_check(bb_bench *bench, bb_resident *resident, bool at_once,
                                 bb_build_timing *timing)
{
    bb_instance *instance = &resident->instance;
    bb_tree copy;
    instance->check_at_once = at_once;
    const bb_status status = bb_resident_build_once(resident, timing);
    instance->check_at_once = false;
    BB_TRY(status);
    if (at_once && !bb_is_splitter(instance->stages[0].builder))
        return BB_OK;
    if (at_once || instance->tree.place != BB_ON_DEVICE)
        return check_tree(instance, bench->scene);
    BB_TRY(bb_tree_download(&instance->tree, NULL));
    bb_tree_take_copy(&instance->tree, &copy);
    (void)bb_resident_free_tree(resident);
    const bb_status checked = bb_tree_check(&copy, bench->scene);
    bb_tree_release(&copy);
    return checked;
}

/* Another disguise, of which the builder knows nothing, while its memory is warm. */
static bb_status disguise_anew(bb_bench *bench, bb_entrant *entrant)
{
    bool disguised;
    BB_TRY(bb_disguise_take_off(&bench->disguise, bench->scene));
    BB_TRY(bb_bench_tree(bench, entrant));
    BB_TRY(put_on(bench, &disguised));
    return disguised ? BB_OK : bb_fail(BB_REFUSED, "%s", bb_message());
}

/* Whoever is refused memory gets more, and an input that it has not seen, since it has seen this
 * one. */
static bb_status build_tree(bb_bench *bench, bb_entrant *entrant, bb_build_timing *timing)
{
    bb_resident *resident = entrant->resident;
    bool at_once = true;
    bb_status status = build_and_check(bench, resident, at_once, timing);
    while (status == BB_REFUSED && at_once) {
        at_once = bb_residency_make_room(&bench->residency, resident);
        BB_TRY(disguise_anew(bench, entrant));
        status = build_and_check(bench, resident, at_once, timing);
    }
    return status;
}

/* Builds the tree of the disguised scene, which must hold for it: a tracer's next build tells. */
static bb_status build_disguised(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_timing timing;
    char looks[128];
    const bb_status status =
        entrant->tracer != NULL
            ? bb_tracing_build_disguised(entrant->tracing, bench->disguise.mirrored, &timing)
            : build_tree(bench, entrant, &timing);
    if (status == BB_OK)
        bb_samples_add(&entrant->record.unseen_ms, timing.timing.ms);
    if (status != BB_FAILED)
        return status;
    return bb_fail(BB_FAILED, "its build of the scene %s, which it had not seen: %s",
                   looks_like(bench, looks), bb_message());
}

/* Builds an entrant's tree of a disguised scene. A tree that was evicted is built before,
 * undisguised: its memory must be warm. After a failure, whoever comes next gets a new disguise,
 * since this one may have been written into. */
static bb_status take_turn(bb_bench *bench, bb_entrant *entrant, bool *can_be)
{
    bb_status status = BB_OK;
    const bool ready = entrant->tracer != NULL || entrant->resident->built;
    if (!bench->disguise.worn || !ready) {
        BB_TRY(bb_disguise_take_off(&bench->disguise, bench->scene));
        if (!ready)
            status = bb_bench_tree(bench, entrant);
        if (status == BB_OK)
            BB_TRY(put_on(bench, can_be));
    }
    if (status == BB_OK && *can_be)
        status = build_disguised(bench, entrant);
    if (status == BB_OK)
        return BB_OK;
    bb_bench_note_failure(entrant, status);
    return bb_disguise_take_off(&bench->disguise, bench->scene);
}

static bool is_tried(const bb_entrant *entrant)
{
    const bool can_be =
        entrant->tracer == NULL || (entrant->tracing != NULL && entrant->tree_of == NULL);
    return can_be && entrant->record.status == BB_OK;
}

bb_status bb_bench_unseen_round(bb_bench *bench)
{
    uint32_t order[BB_ENTRANTS_MAX];
    bool can_be = true;
    bb_step step = bb_bench_begin(bench);
    bb_random_order(&bench->unseen, order, bench->entrant_count);
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < bench->entrant_count && status == BB_OK && can_be; i++)
        if (is_tried(&bench->entrants[order[i]]) && !bb_interrupted())
            status = take_turn(bench, &bench->entrants[order[i]], &can_be);
    const bb_status off = bb_disguise_take_off(&bench->disguise, bench->scene);
    return bb_bench_end(bench, step, "unseen inputs", status != BB_OK ? status : off);
}

/* ---- who took long ---- */

/* Builds once more as seen, so that a machine that is slow just now slows this build too. */
static bb_status build_seen(bb_bench *bench, bb_entrant *entrant, double *ms)
{
    bb_build_timing timing;
    bb_phases unused;
    BB_TRY(entrant->tracer != NULL
               ? bb_tracing_build(entrant->tracing, &timing, &unused)
               : bb_resident_build(&bench->residency, entrant->resident, false, &timing));
    *ms = timing.timing.ms;
    return BB_OK;
}

/* Tries three more disguises, each beside a build of what it has seen, and judges. */
static bb_status try_again(bb_bench *bench, bb_entrant *entrant)
{
    bb_build_record *record = &entrant->record;
    double slowest = 0, fastest = record->unseen_ms.values[0];
    for (uint32_t i = 0; i < record->build_ms.count; i++)
        slowest = fmax(slowest, record->build_ms.values[i]);
    const double of_rounds = slowest;
    /* Each took long beside the build before it, or both beside all rounds: who builds as it should
     * only now that it is asked. */
    bool remembers = true;
    for (int i = 0; i < AGAIN; i++) {
        double seen;
        bool disguised;
        BB_TRY(build_seen(bench, entrant, &seen));
        slowest = fmax(slowest, seen);
        BB_TRY(put_on(bench, &disguised));
        bb_status status = disguised ? build_disguised(bench, entrant) : BB_OK;
        BB_TRY(bb_disguise_take_off(&bench->disguise, bench->scene));
        if (!disguised)
            return build_seen(bench, entrant, &seen);
        BB_TRY(status);
        const double unseen = record->unseen_ms.values[record->unseen_ms.count - 1];
        fastest = fmin(fastest, unseen);
        remembers =
            remembers && (took_long(unseen, seen) || took_long(fmin(unseen, seen), of_rounds));
    }
    double unused;
    BB_TRY(build_seen(bench, entrant, &unused)); /* the tree is traced */
    record->remembers = remembers;
    if (!took_long(fastest, slowest))
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "it remembers inputs: of %u that it had not seen, it built the fastest in %.3g "
                   "ms, and the slowest of its other builds took %.3g ms",
                   record->unseen_ms.count, fastest, slowest);
}

bb_status bb_bench_judge_unseen(bb_bench *bench)
{
    for (uint32_t i = 0; i < bench->entrant_count && !bb_interrupted(); i++) {
        bb_entrant *entrant = &bench->entrants[i];
        const bb_build_record *record = &entrant->record;
        if (!is_tried(entrant) || record->unseen_ms.count == 0 ||
            !took_long(record->unseen_ms.values[0], bb_samples_median(&record->build_ms)))
            continue;
        bb_step step = bb_bench_begin(bench);
        const bb_status status = try_again(bench, entrant);
        BB_TRY(bb_bench_end(bench, step, "unseen inputs", BB_OK));
        if (bench->disguise.worn)
            return status;
        if (status != BB_OK)
            bb_bench_note_failure(entrant, status);
    }
    return BB_OK;
}
