/* The advice as the member "advice" of a document: framework/advise/README.md has its schema. */
#include "framework/advise/advice.h"
#include "framework/base/shell_word.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A place to put members; remembers that memory ran out. */
typedef struct writer {
    bool failed;
} writer;

static void put(writer *w, cJSON *object, const char *name, cJSON *item)
{
    if (item != NULL && (name != NULL ? cJSON_AddItemToObject(object, name, item)
                                      : cJSON_AddItemToArray(object, item)))
        return;
    cJSON_Delete(item);
    w->failed = true;
}

static void put_number(writer *w, cJSON *object, const char *name, double value)
{
    put(w, object, name, isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull());
}

static void put_text(writer *w, cJSON *object, const char *name, const char *text)
{
    put(w, object, name, text[0] != '\0' ? cJSON_CreateString(text) : cJSON_CreateNull());
}

/* An object, or an array, that is there already when it is filled. */
static cJSON *open_object(writer *w, cJSON *parent, const char *name)
{
    cJSON *object = cJSON_CreateObject();
    put(w, parent, name, object);
    return w->failed ? NULL : object;
}

static cJSON *open_array(writer *w, cJSON *parent, const char *name)
{
    cJSON *array = cJSON_CreateArray();
    put(w, parent, name, array);
    return w->failed ? NULL : array;
}

static void put_estimate(writer *w, cJSON *object, const char *name, bb_estimate e)
{
    char text[64];
    put_number(w, object, name, e.value);
    snprintf(text, sizeof text, "%s_lo", name);
    put_number(w, object, text, e.low);
    snprintf(text, sizeof text, "%s_hi", name);
    put_number(w, object, text, e.high);
}

/* ---- contenders ---- */

static void put_who(writer *w, cJSON *object, const bb_contender *who)
{
    put_text(w, object, "builder", who->builder);
    put_text(w, object, "kernel", who->kernel);
    put_text(w, object, "intersector", who->intersector);
}

static void put_figures(writer *w, cJSON *object, const bb_tried_figures *f)
{
    const bb_wrong_rate rate = bb_wrong_rate_of(f->wrong, f->checked);
    put_number(w, object, "image_ms", f->extent.ms);
    put_number(w, object, "build_ms", f->build_ms);
    put_number(w, object, "layout_ms", f->layout_ms);
    put_number(w, object, "trace_ms", f->trace_ms);
    put_number(w, object, "bytes", f->extent.bytes);
    put_number(w, object, "bytes_build", f->bytes_build);
    put_number(w, object, "bytes_layout", f->bytes_layout);
    put_number(w, object, "code_bits", f->extent.code_bits > 0 ? f->extent.code_bits : (double)NAN);
    put_number(w, object, "stack_entries", f->extent.stack);
    put_number(w, object, "kinds", f->extent.kinds);
    put_number(w, object, "wrong", f->wrong);
    put_number(w, object, "checked", f->checked);
    put_number(w, object, "wrong_ppm_at_most", rate.high);
}

/* Why it is not the choice. */
static void put_state(writer *w, cJSON *object, const bb_entered *field, uint32_t i, uint32_t best,
                      uint32_t choice)
{
    static const char *const words[] = {"raced to the end", "too slow", "too wrong",
                                        "not measured"};
    const bb_racer *racer = &field->racers[i];
    bool raced = racer->state == BB_RACING && best != BB_NONE_CHOSEN;
    uint32_t whom = raced ? best : racer->behind;
    bb_estimate ratio = raced ? bb_race_ratio(racer, &field->racers[best]) : racer->ratio;
    const char *state = words[racer->state], *reason = field->figures[i].reason;
    if (i == choice)
        state = "chosen";
    else if (raced && ratio.value <= BB_ADVISE_SLACK) {
        state = "more than needed";
        reason = bb_extent_reason(&field->figures[choice].extent, &field->figures[i].extent);
    } else if (raced) {
        state = "slower";
    }
    put_text(w, object, "state", state);
    put_text(w, object, "reason", reason);
    put_number(w, object, "heats", racer->heats);
    put_estimate(w, object, "ratio", ratio);
    put_number(w, object, "ratio_least", ratio.least);
    cJSON *against = whom < field->count ? open_object(w, object, "against") : NULL;
    if (against != NULL)
        put_who(w, against, &field->who[whom]);
}

static void put_field(writer *w, cJSON *parent, const char *name, const bb_entered *field,
                      uint32_t best, uint32_t choice)
{
    cJSON *array = open_array(w, parent, name);
    for (uint32_t i = 0; i < field->count && array != NULL; i++) {
        cJSON *entry = open_object(w, array, NULL);
        if (entry == NULL)
            return;
        put_who(w, entry, &field->who[i]);
        put_state(w, entry, field, i, best, choice);
        put_figures(w, entry, &field->figures[i]);
    }
}

/* ---- the choice ---- */

static void put_command(writer *w, cJSON *root, const bb_advise_request *r, const bb_contender *who)
{
    const char *const words[][2] = {{"--scene", r->scene},
                                    {"--builder", who->builder},
                                    {"--kernel", who->kernel},
                                    {"--intersector", who->intersector}};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        w->failed = true;
        return;
    }
    fputs("bvhbench run", out);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        fprintf(out, " %s ", words[i][0]);
        bb_put_shell_word(out, words[i][1]);
    }
    for (uint32_t i = 0; i < r->ray_count; i++) {
        fputs(i > 0 ? "," : " --rays ", out);
        bb_put_shell_word(out, r->rays[i]);
    }
    fputs(r->further, out);
    if (fclose(out) == 0)
        put_text(w, root, "command", text);
    else
        w->failed = true;
    free(text);
}

/* What builder and kernel decided, each with its figure. */
static void put_decisions(writer *w, cJSON *object, const bb_tried_figures *f)
{
    const cJSON *const entries[] = {f->build, f->trace};
    cJSON *all = open_object(w, object, "decisions");
    for (size_t i = 0; i < 2 && all != NULL; i++) {
        const cJSON *one;
        cJSON_ArrayForEach(one, cJSON_GetObjectItemCaseSensitive(entries[i], "decisions"))
            put(w, all, one->string, cJSON_Duplicate(one, true));
    }
}

static void put_choice(writer *w, cJSON *root, const bb_advice *a)
{
    const bb_entered *field = &a->field;
    if (a->choice == BB_NONE_CHOSEN) {
        put(w, root, "choice", cJSON_CreateNull());
        return;
    }
    cJSON *choice = open_object(w, root, "choice");
    if (choice == NULL)
        return;
    put_who(w, choice, &field->who[a->choice]);
    put_figures(w, choice, &field->figures[a->choice]);
    const bb_tried_figures *f = &field->figures[a->choice];
    const double at_most = bb_wrong_rate_of(f->wrong, f->checked).high;
    put(w, choice, "limit_shown", cJSON_CreateBool(at_most <= a->request->max_wrong_ppm));
    put_estimate(w, choice, "ratio", a->choice_ratio);
    put_decisions(w, choice, &field->figures[a->choice]);
    cJSON *best = open_object(w, root, "fastest");
    if (best != NULL) {
        put_who(w, best, &field->who[a->best]);
        put_figures(w, best, &field->figures[a->best]);
    }
    put_number(w, root, "within_slack", a->within);
    put_command(w, root, a->request, &field->who[a->choice]);
}

static void put_savings(writer *w, cJSON *root, const bb_advice *a)
{
    cJSON *array = open_array(w, root, "savings");
    for (uint32_t i = 0; i < a->saving_count && array != NULL; i++) {
        const bb_saving *s = &a->savings[i];
        cJSON *entry = open_object(w, array, NULL);
        if (entry == NULL)
            return;
        put_text(w, entry, "what", s->what);
        put_text(w, entry, "chosen", s->was);
        put_text(w, entry, "generous", s->kept);
        put_text(w, entry, "builder", s->builder);
        put_text(w, entry, "kernel", s->kernel);
        put_text(w, entry, "intersector", s->intersector);
        put_number(w, entry, "wrong", s->measured ? s->wrong : (double)NAN);
        put_number(w, entry, "checked", s->measured ? s->checked : (double)NAN);
        put_number(w, entry, "bytes", s->measured ? s->bytes : (double)NAN);
        put_estimate(w, entry, "ms", s->ms);
        put_text(w, entry, "reason", s->reason);
    }
}

static void put_takings(writer *w, cJSON *root, const char *name, const bb_takings *t)
{
    cJSON *object = open_object(w, root, name);
    if (object == NULL)
        return;
    put_number(w, object, "seconds", t->seconds);
    put_number(w, object, "host_bytes", t->host_bytes);
    put_number(w, object, "device_bytes", t->device_bytes);
    put_number(w, object, "held_bytes", t->held_bytes);
}

static void put_search(writer *w, cJSON *root, const bb_advice *a)
{
    if (a->all.count == 0)
        return;
    cJSON *all = open_object(w, root, "exhaustive");
    if (all == NULL)
        return;
    put_number(w, all, "configurations", a->all.count);
    put_estimate(w, all, "ratio", a->all_ratio);
    const struct {
        const char *name;
        uint32_t which;
    } parts[] = {{"fastest", a->all_best}, {"least", a->all_least}};
    for (size_t i = 0; i < 2; i++) {
        if (parts[i].which == BB_NONE_CHOSEN)
            continue;
        cJSON *entry = open_object(w, all, parts[i].name);
        if (entry == NULL)
            return;
        put_who(w, entry, &a->all.who[parts[i].which]);
        put_figures(w, entry, &a->all.figures[parts[i].which]);
    }
    put_field(w, all, "contenders", &a->all, a->all_best, a->all_choice);
}

bb_status bb_advice_add(const bb_advice *a, bb_results *results)
{
    const bb_advise_request *r = a->request;
    const cJSON *needs = bb_get(a->scene, BB_F_SCENE_DECISIONS);
    const double prims = a->whole.scene->prim_count;
    writer w = {false};
    cJSON *root = open_object(&w, bb_results_json(results), "advice");
    if (root == NULL)
        return bb_fail(BB_FAILED, "advise: no memory");
    put_text(&w, root, "schema", "bvhbench-advice/1");
    put_text(&w, root, "scene", r->scene);
    put_number(&w, root, "prims", prims);
    put_number(&w, root, "image_rays", r->image_rays);
    cJSON *rays = open_array(&w, root, "rays");
    for (uint32_t i = 0; i < r->ray_count && rays != NULL; i++)
        put_text(&w, rays, NULL, r->rays[i]);
    put_number(&w, root, "max_wrong_ppm", r->max_wrong_ppm);
    put_number(&w, root, "slack", BB_ADVISE_SLACK);
    put_number(&w, root, "scout_slack", a->scout_slack);
    put_number(&w, root, "unlikely", a->unlikely);
    put_number(&w, root, "heats", a->heats);
    put_text(&w, root, "preliminary", a->preliminary != NULL ? a->preliminary : "");
    put_number(&w, root, "sample_prims", round(prims / a->sample.factor));
    put_takings(&w, root, "foretold", &a->foretold);
    put_takings(&w, root, "taken", &a->taken);
    if (needs != NULL)
        put(&w, root, "needs", cJSON_Duplicate(needs, true));
    put_choice(&w, root, a);
    put_savings(&w, root, a);
    put_search(&w, root, a);
    put_field(&w, root, "scouts", &a->scouts, BB_NONE_CHOSEN, BB_NONE_CHOSEN);
    put_field(&w, root, "builders", &a->builders, BB_NONE_CHOSEN, BB_NONE_CHOSEN);
    put_field(&w, root, "contenders", &a->field, a->best, a->choice);
    return w.failed ? bb_fail(BB_FAILED, "advise: no memory") : BB_OK;
}
