/* Drops slow racers. */
#include "framework/advise/race.h"

#include <math.h>

bb_estimate bb_race_ratio(const bb_racer *a, const bb_racer *b)
{
    bb_samples ratios = bb_samples_ratio(&a->cost, &b->cost);
    return bb_samples_estimate(&ratios);
}

uint32_t bb_race_best(const bb_racer *racers, uint32_t count)
{
    uint32_t best = BB_NO_RACER;
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        double cost = bb_samples_median(&racers[i].cost);
        if (racers[i].state == BB_RACING && cost < least) {
            best = i;
            least = cost;
        }
    }
    return best;
}

static uint32_t beaten_by(const bb_racer *racers, uint32_t count, uint32_t who)
{
    uint32_t beaten = 0;
    for (uint32_t i = 0; i < count; i++)
        beaten += i != who && racers[i].state == BB_RACING &&
                  bb_race_ratio(&racers[who], &racers[i]).value < 1;
    return beaten;
}

uint32_t bb_race_fastest(const bb_racer *racers, uint32_t count)
{
    uint32_t fastest = bb_race_best(racers, count);
    uint32_t most = fastest != BB_NO_RACER ? beaten_by(racers, count, fastest) : 0;
    double least = fastest != BB_NO_RACER ? bb_samples_median(&racers[fastest].cost) : 0;
    for (uint32_t i = 0; i < count && fastest != BB_NO_RACER; i++) {
        if (racers[i].state != BB_RACING || i == fastest)
            continue;
        const uint32_t beaten = beaten_by(racers, count, i);
        const double cost = bb_samples_median(&racers[i].cost);
        if (beaten > most || (beaten == most && cost < least)) {
            fastest = i;
            most = beaten;
            least = cost;
        }
    }
    return fastest;
}

static void drop(bb_racer *racer, const bb_racer *racers, uint32_t best)
{
    racer->state = BB_TOO_SLOW;
    racer->behind = best;
    racer->ratio = bb_samples_ratio(&racer->cost, &racers[best].cost);
}

uint32_t bb_race_drop(bb_racer *racers, uint32_t count, double slack)
{
    uint32_t best = bb_race_best(racers, count), left = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (racers[i].state != BB_RACING)
            continue;
        bb_estimate ratio = bb_not_measured;
        if (best != BB_NO_RACER && i != best)
            ratio = bb_race_ratio(&racers[i], &racers[best]);
        /* ratio.low is NAN for too few rounds */
        if (isfinite(ratio.low) && ratio.least > slack) {
            drop(&racers[i], racers, best);
            continue;
        }
        left++;
    }
    return left;
}

static double least_of(const bb_racer *racer)
{
    return bb_samples_least(&racer->cost);
}

uint32_t bb_race_drop_least(bb_racer *racers, uint32_t count, double slack)
{
    uint32_t best = BB_NO_RACER, left = 0;
    for (uint32_t i = 0; i < count; i++)
        if (racers[i].state == BB_RACING && isfinite(least_of(&racers[i])) &&
            (best == BB_NO_RACER || least_of(&racers[i]) < least_of(&racers[best])))
            best = i;
    for (uint32_t i = 0; i < count; i++) {
        if (racers[i].state != BB_RACING)
            continue;
        if (best != BB_NO_RACER && least_of(&racers[i]) > slack * least_of(&racers[best])) {
            drop(&racers[i], racers, best);
            continue;
        }
        left++;
    }
    return left;
}

bb_status bb_race_run(bb_racer *racers, uint32_t count, uint32_t heats, double slack,
                      bb_heat_fn *measure, void *user)
{
    for (uint32_t i = 0; i < count; i++)
        racers[i] = (bb_racer){.behind = BB_NO_RACER};
    for (uint32_t heat = 0; heat < heats; heat++) {
        BB_TRY(measure(user, heat, racers, count));
        uint32_t left = 0;
        for (uint32_t i = 0; i < count; i++)
            if (racers[i].state == BB_RACING) {
                racers[i].heats++;
                left++;
            }
        if (heat + 1 < heats && left > 0)
            bb_race_drop(racers, count, slack);
    }
    return BB_OK;
}
