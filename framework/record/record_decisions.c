/* Puts decisions into the document: { "code bits": { "value": 24, "by": "scene", "figure": "..." },
 * ... }. */
#include "framework/record/record_private.h"

#include "framework/base/number.h"
#include "framework/scene/needs.h"

#include <cjson/cJSON.h>
#include <math.h>

static bool put_decision(cJSON *all, const bb_decision *d)
{
    cJSON *entry = cJSON_CreateObject();
    uint64_t number;
    bool ok = entry != NULL;
    if (ok && bb_read_whole(d->value, &number))
        ok = bb_put_number(entry, "value", (double)number);
    else if (ok)
        ok = bb_put_text(entry, "value", d->value);
    ok = ok && bb_put_text(entry, "by", bb_decider_word(d->by)) &&
         bb_put_text(entry, "figure", d->figure);
    if (ok)
        return bb_put(all, d->what, entry);
    cJSON_Delete(entry);
    return false;
}

/* Puts decisions, if there are any. */
static bool put_decisions(cJSON *object, const char *name, const bb_decisions *list)
{
    if (list->count == 0)
        return true;
    cJSON *all = cJSON_CreateObject();
    bool ok = all != NULL;
    for (uint32_t i = 0; ok && i < list->count; i++)
        ok = put_decision(all, &list->items[i]);
    if (ok)
        return bb_put(object, name, all);
    cJSON_Delete(all);
    return false;
}

/* Puts what the scene needs, if its profile was measured. */
bool bb_put_needs(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_scene *scene = record;
    bb_decisions needs = {0};
    if (scene->profile.measured)
        bb_scene_needs(scene, &needs);
    return put_decisions(object, name, &needs);
}

bool bb_put_build_decisions(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    return put_decisions(object, name, &((const bb_build_record *)record)->decisions);
}

bool bb_put_trace_decisions(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    return put_decisions(object, name, &((const bb_trace_record *)record)->decisions);
}

/* Puts null if 64 bits do not separate the centroids. */
bool bb_put_bits(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const uint32_t bits = ((const bb_scene *)record)->profile.bits_apart;
    return bb_put_number(object, name, bits < BB_BITS_NONE ? bits : (double)NAN);
}
