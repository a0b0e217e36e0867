/* Puts members into the document: those that the table of fields describes, and helpers for the
 * others.
 *
 * A figure that was not measured is null, never 0. Hashes are strings of 16 hexadecimal digits,
 * since a JSON number does not hold 64 bits.
 */
#include "framework/record/record_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

bool bb_put(cJSON *object, const char *name, cJSON *item)
{
    if (item != NULL && cJSON_AddItemToObject(object, name, item))
        return true;
    cJSON_Delete(item);
    return false;
}

bool bb_put_text(cJSON *object, const char *name, const char *text)
{
    return bb_put(object, name,
                  text != NULL && text[0] != '\0' ? cJSON_CreateString(text) : cJSON_CreateNull());
}

static cJSON *number(double value)
{
    return isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull();
}

bool bb_put_number(cJSON *object, const char *name, double value)
{
    return bb_put(object, name, number(value));
}

bool bb_put_size(cJSON *object, const char *name, uint64_t value)
{
    return bb_put_number(object, name, value == 0 ? (double)NAN : (double)value);
}

static bool put_hash(cJSON *object, const char *name, uint64_t hash)
{
    char text[17];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    return bb_put_text(object, name, text);
}

bool bb_put_numbers(cJSON *object, const char *name, const double *values, uint32_t count)
{
    cJSON *array = cJSON_CreateArray();
    for (uint32_t i = 0; array != NULL && i < count; i++) {
        cJSON *item = number(values[i]);
        if (item == NULL || !cJSON_AddItemToArray(array, item)) {
            cJSON_Delete(item);
            cJSON_Delete(array);
            return false;
        }
    }
    return bb_put(object, name, array);
}

bool bb_put_samples(cJSON *object, const char *name, const bb_samples *samples)
{
    return samples->count == 0 ? bb_put(object, name, cJSON_CreateNull())
                               : bb_put_numbers(object, name, samples->values, samples->count);
}

bool bb_put_named(cJSON *object, const char *name, const bb_named_ms *entries, uint32_t count)
{
    cJSON *inner = cJSON_CreateObject();
    bool ok = inner != NULL;
    for (uint32_t i = 0; ok && i < count; i++)
        ok = bb_put_number(inner, entries[i].name, entries[i].ms);
    if (!ok) {
        cJSON_Delete(inner);
        return false;
    }
    return bb_put(object, name, inner);
}

/* ---- by the table ---- */

typedef enum kind {
    NOTHING, /* another field's function, or a later step, puts it */
    FUNCTION,
    CHARS,        /* char[] */
    CHARS_IF_ANY, /* absent if empty */
    STRING,       /* const char *, may be NULL */
    DOUBLE,
    MEASURED, /* double; absent figures of what was refused or failed */
    FLOAT,
    U32,
    U64,
    SIZE,   /* uint32_t; 0: nobody filled it in */
    SIZE64, /* uint64_t, likewise */
    BOOL,
    TRUE_IF, /* bool; absent if false */
    HASH,    /* uint64_t */
    STATUS,  /* bb_status, as a word */
    SAMPLES, /* bb_samples: all */
    MEDIAN,  /* bb_samples: their median */
} kind;

typedef struct writer {
    kind kind;
    size_t offset; /* offset in the record */
    bb_put_fn *function;
} writer;

#define AT(type, kind, member)                                                                     \
    {                                                                                              \
        kind, offsetof(type, member), NULL                                                         \
    }
#define S(kind, member) AT(bb_scene, kind, member)
#define P(kind, member) AT(bb_scene, kind, profile.member)
#define B(kind, member) AT(bb_build_record, kind, member)
#define T(kind, member) AT(bb_trace_record, kind, member)
#define A(kind, member) AT(bb_trace_record, kind, accuracy.member)
#define N(kind, member) AT(bb_note_record, kind, member)
#define F(kind, member) AT(bb_prediction_record, kind, member)
#define BY(function)                                                                               \
    {                                                                                              \
        FUNCTION, 0, function                                                                      \
    }
#define LATER                                                                                      \
    {                                                                                              \
        NOTHING, 0, NULL                                                                           \
    }

static const writer writers[BB_FIELDS] = {
#define FIELD(id, part, name, unit, types, writer, format, heading, help) [BB_F_##id] = writer,
#include "framework/record/fields.h"
};

static bb_status status_of(bb_field_part part, const void *record)
{
    return part == BB_IN_BUILD ? ((const bb_build_record *)record)->status
                               : ((const bb_trace_record *)record)->status;
}

static bool put_field(cJSON *object, bb_field_id id, const void *record, const void *extra)
{
    const char *name = bb_fields[id].name;
    const void *at = (const char *)record + writers[id].offset;
    switch (writers[id].kind) {
    case NOTHING:
        return true;
    case FUNCTION:
        return writers[id].function(object, name, record, extra);
    case CHARS:
        return bb_put_text(object, name, at);
    case CHARS_IF_ANY:
        return *(const char *)at == '\0' || bb_put_text(object, name, at);
    case STRING:
        return bb_put_text(object, name, *(const char *const *)at);
    case DOUBLE:
        return bb_put_number(object, name, *(const double *)at);
    case MEASURED:
        return bb_put_number(object, name,
                             status_of(bb_fields[id].part, record) == BB_OK ? *(const double *)at
                                                                            : (double)NAN);
    case FLOAT:
        return bb_put_number(object, name, (double)*(const float *)at);
    case U32:
        return bb_put_number(object, name, *(const uint32_t *)at);
    case U64:
        return bb_put_number(object, name,
                             *(const uint64_t *)at == BB_UNCOUNTED ? (double)NAN
                                                                   : (double)*(const uint64_t *)at);
    case SIZE:
        return bb_put_size(object, name, *(const uint32_t *)at);
    case SIZE64:
        return bb_put_size(object, name, *(const uint64_t *)at);
    case BOOL:
        return bb_put(object, name, cJSON_CreateBool(*(const bool *)at));
    case TRUE_IF:
        return !*(const bool *)at || bb_put(object, name, cJSON_CreateTrue());
    case HASH:
        return put_hash(object, name, *(const uint64_t *)at);
    case STATUS:
        return bb_put_text(object, name, bb_status_word(*(const bb_status *)at));
    case SAMPLES:
        return bb_put_samples(object, name, at);
    case MEDIAN:
        return bb_put_number(object, name, bb_samples_median(at));
    }
    return false;
}

bool bb_put_part(cJSON *object, bb_field_part part, const void *record, const void *extra)
{
    for (size_t id = 0; id < BB_FIELDS; id++)
        if (bb_fields[id].part == part && !put_field(object, (bb_field_id)id, record, extra))
            return false;
    return true;
}

bool bb_put_inner(cJSON *entry, const char *name, bb_field_part part, const void *record)
{
    cJSON *inner = cJSON_CreateObject();
    if (inner != NULL && bb_put_part(inner, part, record, NULL))
        return bb_put(entry, name, inner);
    cJSON_Delete(inner);
    return false;
}
