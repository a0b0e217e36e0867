/* Chooses from a whole race, or from the measurements before an interrupt. */
#include "framework/advise/advice.h"

void bb_choose_least(const bb_entered *field, uint32_t *best, uint32_t *least, uint32_t *within)
{
    *best = bb_race_fastest(field->racers, field->count);
    *least = *best == BB_NO_RACER ? BB_NONE_CHOSEN : *best;
    *best = *least;
    *within = 0;
    for (uint32_t i = 0; i < field->count && *best != BB_NONE_CHOSEN; i++) {
        if (field->racers[i].state != BB_RACING)
            continue;
        double ratio = bb_race_ratio(&field->racers[i], &field->racers[*best]).value;
        if (!(ratio <= BB_ADVISE_SLACK) && i != *best)
            continue;
        ++*within;
        if (bb_extent_compare(&field->figures[i].extent, &field->figures[*least].extent) < 0)
            *least = i;
    }
}

void bb_choose(bb_advice *advice)
{
    bb_choose_least(&advice->field, &advice->best, &advice->choice, &advice->within);
}

static bool is_measured(const bb_entered *field)
{
    for (uint32_t i = 0; i < field->count; i++)
        if (field->racers[i].state == BB_RACING && field->racers[i].cost.count > 0)
            return true;
    return false;
}

/* Scouts take the place of an unmeasured field. Contenders without a cost are out. */
void bb_choose_preliminary(bb_advice *advice)
{
    bb_entered *const fields[] = {&advice->field, &advice->builders, &advice->scouts};
    static const char *const names[] = {"the race", "the builders on a sample",
                                        "the kernels on a sample"};
    size_t from = 0;
    while (from < 3 && !is_measured(fields[from]))
        from++;
    if (from == 3)
        return;
    const bb_entered chosen = *fields[from];
    *fields[from] = advice->field;
    advice->field = chosen;
    advice->preliminary = names[from];
    for (uint32_t i = 0; i < chosen.count; i++)
        if (chosen.racers[i].state == BB_RACING && chosen.racers[i].cost.count == 0)
            chosen.racers[i].state = BB_NOT_RUN;
    bb_choose(advice);
}
