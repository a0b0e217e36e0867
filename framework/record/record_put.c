/* Puts values into rows: those that the table of fields describes, and helpers for the others.
 *
 * A figure that was not measured has no value, never 0. Hashes are texts of 16 hexadecimal digits,
 * since a JSON number does not hold 64 bits.
 */
#include "framework/record/record_private.h"

#include <math.h>
#include <stdio.h>

void bb_put_number(bb_entry *entry, bb_field_id field, double value)
{
    if (entry != NULL)
        bb_table_set_number(entry->table, entry->row, bb_field_column(field), value);
}

void bb_put_text(bb_entry *entry, bb_field_id field, const char *value)
{
    if (entry != NULL)
        bb_table_set_text(entry->table, entry->row, bb_field_column(field), value);
}

void bb_put_rounds(bb_entry *entry, bb_field_id field, const bb_samples *samples)
{
    if (entry != NULL)
        bb_table_set_rounds(entry->table, entry->row, bb_field_column(field), samples);
}

void bb_put_flag(bb_entry *entry, bb_field_id field, bool value)
{
    bb_put_text(entry, field, value ? "yes" : "no");
}

static void put_hash(bb_entry *entry, bb_field_id field, uint64_t hash)
{
    char text[17];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    bb_put_text(entry, field, text);
}

/* 0: not known. */
static void put_size(bb_entry *entry, bb_field_id field, uint64_t value)
{
    bb_put_number(entry, field, value > 0 ? (double)value : (double)NAN);
}

/* ---- by the table ---- */

typedef enum kind {
    NOTHING, /* another field's function, or a later step, puts it */
    FUNCTION,
    CHARS, /* char[] */
    DOUBLE,
    MEASURED, /* double; absent figures of what was refused or failed */
    FLOAT,
    U32,
    U64,
    SIZE,   /* uint32_t; 0: nobody filled it in */
    SIZE64, /* uint64_t, likewise */
    FLAG,
    HASH,   /* uint64_t */
    STATUS, /* bb_status, as a word */
    SAMPLES,
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
#define FIELD(id, part, name, unit, kind, writer, format, heading, help) [BB_F_##id] = writer,
#include "framework/record/fields.h"
};

static bb_status status_of(bb_field_part part, const void *record)
{
    return part == BB_IN_BUILD ? ((const bb_build_record *)record)->status
                               : ((const bb_trace_record *)record)->status;
}

static void put_field(const bb_put *p, bb_field_id id)
{
    bb_entry *entry = p->entry;
    const void *at = (const char *)p->record + writers[id].offset;
    switch (writers[id].kind) {
    case NOTHING:
        return;
    case FUNCTION:
        writers[id].function(p);
        return;
    case CHARS:
        bb_put_text(entry, id, at);
        return;
    case DOUBLE:
        bb_put_number(entry, id, *(const double *)at);
        return;
    case MEASURED:
        if (status_of(bb_fields[id].part, p->record) == BB_OK)
            bb_put_number(entry, id, *(const double *)at);
        return;
    case FLOAT:
        bb_put_number(entry, id, (double)*(const float *)at);
        return;
    case U32:
        bb_put_number(entry, id, *(const uint32_t *)at);
        return;
    case U64:
        if (*(const uint64_t *)at != BB_UNCOUNTED)
            bb_put_number(entry, id, (double)*(const uint64_t *)at);
        return;
    case SIZE:
        put_size(entry, id, *(const uint32_t *)at);
        return;
    case SIZE64:
        put_size(entry, id, *(const uint64_t *)at);
        return;
    case FLAG:
        if (*(const bool *)at)
            bb_put_flag(entry, id, true);
        return;
    case HASH:
        put_hash(entry, id, *(const uint64_t *)at);
        return;
    case STATUS:
        bb_put_text(entry, id, bb_status_word(*(const bb_status *)at));
        return;
    case SAMPLES:
        bb_put_rounds(entry, id, at);
        return;
    }
}

void bb_put_part(const bb_put *p, bb_field_part part)
{
    for (size_t id = 0; id < BB_FIELDS; id++)
        if (bb_fields[id].part == part)
            put_field(p, (bb_field_id)id);
}
