/* Measures the choice with generous settings: one at a time, then all together. */
#include "framework/advise/savings.h"

#include "framework/base/interrupt.h"
#include "traversal/traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char generous_stack[] = "1024"; /* the largest there is */

/* Adds a parameter to a specification. Returns false if it has the parameter. */
static bool with_parameter(const char *text, const char *key, const char *value, char *out,
                           size_t capacity)
{
    bb_spec spec;
    if (bb_spec_parse(text, &spec) != BB_OK || bb_spec_value(&spec, NULL, key) != NULL)
        return false;
    int length =
        snprintf(out, capacity, "%s%c%s=%s", text, spec.param_count > 0 ? ',' : ':', key, value);
    return length > 0 && (size_t)length < capacity;
}

static bb_saving *add(bb_advice *advice, const char *what)
{
    const bb_contender *choice = &advice->field.who[advice->choice];
    bb_saving *s = &advice->savings[advice->saving_count++];
    *s = (bb_saving){.what = what};
    snprintf(s->builder, sizeof s->builder, "%s", choice->builder);
    snprintf(s->kernel, sizeof s->kernel, "%s", choice->kernel);
    snprintf(s->intersector, sizeof s->intersector, "%s", choice->intersector);
    return s;
}

static void add_builder(bb_advice *advice)
{
    const char *own = advice->field.who[advice->choice].builder;
    char other[sizeof advice->savings[0].builder];
    if (!bb_generous_builder(own, other, sizeof other))
        return;
    bb_saving *s = add(advice, "builder");
    snprintf(s->builder, sizeof s->builder, "%s", other);
}

static void add_kernel(bb_advice *advice, const char *what, const char *key, const char *value)
{
    char text[sizeof advice->savings[0].kernel];
    const char *own = advice->field.who[advice->choice].kernel;
    bb_spec spec;
    const bb_kernel *kernel;
    if (!with_parameter(own, key, value, text, sizeof text) ||
        bb_kernel_parse(text, &spec, &kernel) != BB_OK)
        return; /* the value is given, or the kernel has no stack */
    bb_saving *s = add(advice, what);
    snprintf(s->kernel, sizeof s->kernel, "%s", text);
}

/* Adds all savings together. */
static void add_all(bb_advice *advice)
{
    if (advice->saving_count < 2)
        return;
    const uint32_t count = advice->saving_count;
    bb_saving *all = add(advice, "all of these");
    for (uint32_t i = 0; i < count; i++) {
        const bb_saving *one = &advice->savings[i];
        char text[sizeof all->kernel];
        if (strcmp(one->what, "builder") == 0)
            snprintf(all->builder, sizeof all->builder, "%s", one->builder);
        else if (with_parameter(all->kernel, strcmp(one->what, "stack") == 0 ? "stack" : "kinds",
                                strcmp(one->what, "stack") == 0 ? generous_stack : "all", text,
                                sizeof text))
            snprintf(all->kernel, sizeof all->kernel, "%s", text);
    }
}

/* Adds the reverse: the cost of an exact choice compared with the most careless intersector. */
static void add_exactness(bb_advice *advice)
{
    const char *own = advice->field.who[advice->choice].intersector, *careless = NULL;
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        careless = i->name;
    if (strcmp(own, "exact") != 0 || careless == NULL)
        return;
    bb_saving *s = add(advice, BB_EXACTNESS);
    snprintf(s->intersector, sizeof s->intersector, "%s", careless);
}

/* Returns the difference to the choice in ms, round by round. */
static bb_samples more_ms(const bb_racer *a, const bb_racer *choice)
{
    bb_samples more = {0};
    for (uint32_t i = 0; i < a->cost.count && a->cost.count == choice->cost.count; i++)
        bb_samples_add(&more, a->cost.values[i] - choice->cost.values[i]);
    return more;
}

static void say_setting(const char *what, const bb_tried_figures *f, char *text, size_t capacity)
{
    if (strcmp(what, "builder") == 0)
        snprintf(text, capacity, "%s", bb_get_text(f->build, BB_F_BUILD_BUILDER));
    else if (strcmp(what, "stack") == 0)
        snprintf(text, capacity, "%u", f->extent.stack);
    else if (strcmp(what, "kinds") == 0)
        snprintf(text, capacity, "%u", f->extent.kinds);
}

/* Entry 0 of the field is the choice, the others are the savings in order. Savings that an
 * interrupt left unmeasured are removed. */
static void read(bb_advice *advice, const bb_entered *field)
{
    const bb_tried_figures *choice = &field->figures[0];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < advice->saving_count; i++) {
        bb_saving *s = &advice->savings[i];
        const bb_tried_figures *f = &field->figures[i + 1];
        s->measured = choice->measured && f->measured;
        if (!s->measured && bb_interrupted())
            continue;
        advice->savings[kept] = *s;
        s = &advice->savings[kept++];
        if (!s->measured) {
            snprintf(s->reason, sizeof s->reason, "%s",
                     choice->measured ? f->reason : choice->reason);
            continue;
        }
        const bool other_way = strcmp(s->what, BB_EXACTNESS) == 0;
        s->wrong = f->wrong;
        s->checked = f->checked;
        s->bytes = other_way ? choice->extent.bytes - f->extent.bytes
                             : f->extent.bytes - choice->extent.bytes;
        s->ms = other_way ? more_ms(&field->racers[0], &field->racers[i + 1])
                          : more_ms(&field->racers[i + 1], &field->racers[0]);
        say_setting(s->what, choice, s->was, sizeof s->was);
        say_setting(s->what, f, s->kept, sizeof s->kept);
    }
    advice->saving_count = kept;
}

bb_status bb_savings_measure(bb_advice *advice, const bb_heat *heat, bb_results *results,
                             bb_bench_outcome *outcome)
{
    bb_entered field;
    bb_bench_outcome more = {0};
    add_builder(advice);
    add_kernel(advice, "stack", "stack", generous_stack);
    add_kernel(advice, "kinds", "kinds", "all");
    add_all(advice);
    add_exactness(advice);
    bb_contender *who = calloc(advice->saving_count + 1, sizeof *who);
    const bb_contender *choice = &advice->field.who[advice->choice];
    if (who != NULL)
        who[0] = *choice;
    for (uint32_t i = 0; who != NULL && i < advice->saving_count; i++)
        who[i + 1] = (bb_contender){advice->savings[i].builder, advice->savings[i].kernel,
                                    advice->savings[i].intersector};
    BB_TRY(bb_entered_make(who, advice->saving_count + 1, &field));
    bb_status status = bb_heat_run(advice->request, heat, &field, results, &more);
    bb_audit_add(&outcome->audit, &more.audit);
    outcome->bytes_held = more.bytes_held;
    if (status == BB_OK)
        read(advice, &field);
    bb_entered_free(&field);
    return status;
}
