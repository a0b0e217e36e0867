/* What is drawn from the samples of a build or a trace: for a time or rate NAME the members NAME_lo
 * and NAME_hi, the 95 % interval of the median, and NAME_least and NAME_most, the range of the
 * rounds that count. Where there are too few rounds for one of them, it is null.
 */
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

bool bb_json_samples(const cJSON *entry, const char *name, bb_samples *samples)
{
    const cJSON *array = cJSON_GetObjectItemCaseSensitive(entry, name), *item;
    int count = cJSON_GetArraySize(array);
    *samples = (bb_samples){0};
    if (count < 1 || count > BB_SAMPLES_MAX)
        return false;
    cJSON_ArrayForEach(item, array)
    {
        if (!cJSON_IsNumber(item))
            return false;
        bb_samples_add(samples, item->valuedouble);
    }
    return true;
}

/* In the place of the member, if there is one; false if there is no memory. */
static bool set_number(cJSON *object, const char *name, double value)
{
    cJSON *item = isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull();
    bool known = cJSON_GetObjectItemCaseSensitive(object, name) != NULL;
    if (item != NULL && (known ? cJSON_ReplaceItemInObjectCaseSensitive(object, name, item)
                               : cJSON_AddItemToObject(object, name, item)))
        return true;
    cJSON_Delete(item);
    return false;
}

static bool put_spread(cJSON *entry, const char *name, bb_estimate e)
{
    const struct {
        const char *ending;
        double value;
    } ends[] = {{"lo", e.low}, {"hi", e.high}, {"least", e.least}, {"most", e.most}};
    char label[64];
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        snprintf(label, sizeof label, "%s_%s", name, ends[i].ending);
        if (!set_number(entry, label, ends[i].value))
            return false;
    }
    return true;
}

bool bb_put_build_spread(cJSON *build, const bb_samples *ms)
{
    return put_spread(build, "build_ms", bb_samples_estimate(ms));
}

/* The longest time is the lowest rate. */
bool bb_put_rate_spread(cJSON *trace, const bb_samples *ms)
{
    bb_estimate e = bb_samples_estimate(ms);
    double rays = bb_json_number(trace, "count") / 1e3;
    return put_spread(trace, "mrays_s",
                      (bb_estimate){.value = rays / e.value,
                                    .low = rays / e.high,
                                    .high = rays / e.low,
                                    .least = rays / e.most,
                                    .most = rays / e.least});
}

bool bb_results_put_spreads(bb_results *results)
{
    bool ok = true;
    bb_samples ms;
    cJSON *entry;
    cJSON_ArrayForEach(entry, cJSON_GetObjectItemCaseSensitive(results->root, "builds"))
    {
        if (bb_json_samples(entry, "build_ms", &ms))
            ok = ok && bb_put_build_spread(entry, &ms);
    }
    cJSON_ArrayForEach(entry, cJSON_GetObjectItemCaseSensitive(results->root, "traces"))
    {
        if (bb_json_samples(entry, "ms", &ms))
            ok = ok && bb_put_rate_spread(entry, &ms);
    }
    return ok;
}
