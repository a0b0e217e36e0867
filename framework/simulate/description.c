#include "framework/simulate/description.h"

#include "framework/base/file.h"
#include "framework/base/identity.h"
#include "framework/base/steering.h"
#include "framework/base/suggest.h"
#include "framework/device/device_private.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 20, NAME_MOST = 22 };

static const char ENDING[] = ".json";

static const struct {
    const char *name;
    size_t at;
    double least, most;
    bool whole;
} numbers[] = {
#define NUMBER(name, least, most, whole)                                                           \
    {                                                                                              \
#name, offsetof(bb_description, name), least, most, whole                                  \
    }
    NUMBER(units, 1, 1024, true),
    NUMBER(lanes, 1, 64, true),
    NUMBER(clock_ghz, 0.01, 100, false),
    NUMBER(issues_per_clock, 0.01, 64, false),
    NUMBER(groups, 1, 1024, true),
    NUMBER(registers, 1024, 1 << 24, true),
    NUMBER(register_step, 1, 256, true),
    NUMBER(first_bytes, 1024, 1 << 24, true),
    NUMBER(first_ways, 1, 1024, true),
    NUMBER(first_bytes_per_clock, 1, 65536, false),
    NUMBER(second_bytes, 1024, 1 << 30, true),
    NUMBER(second_ways, 1, 1024, true),
    NUMBER(second_bytes_per_clock, 1, 1 << 20, false),
    NUMBER(memory_gb_s, 0.1, 1e6, false),
#undef NUMBER
};

static bb_status read_text(const cJSON *document, const char *what, const char *name, char *text,
                           size_t capacity)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(document, name);
    if (!cJSON_IsString(item) || item->valuestring[0] == '\0' ||
        strlen(item->valuestring) >= capacity || !bb_is_calm(item->valuestring))
        return bb_fail(
            BB_INVALID,
            "%s: member '%s' must be a text of 1 to %zu bytes without control characters", what,
            name, capacity - 1);
    snprintf(text, capacity, "%s", item->valuestring);
    return BB_OK;
}

static bb_status refuse_twins(const cJSON *document, const char *what)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, document)
    {
        if (cJSON_GetObjectItemCaseSensitive(document, item->string) != item)
            return bb_fail(BB_INVALID, "%s: member '%.40s' is there twice", what, item->string);
    }
    return BB_OK;
}

static bb_status read_members(const cJSON *document, const char *what, bb_description *d)
{
    static const char *const codes[] = {"sm_90", "gfx1030", "gfx90a"};
    BB_TRY(refuse_twins(document, what));
    BB_TRY(read_text(document, what, "name", d->name, NAME_MOST + 1));
    BB_TRY(read_text(document, what, "title", d->title, sizeof d->title));
    BB_TRY(read_text(document, what, "code", d->code, sizeof d->code));
    bool known = false;
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        known = known || strcmp(codes[i], d->code) == 0;
    if (!known)
        return bb_fail(BB_INVALID, "%s: member 'code' is '%s', must be sm_90, gfx1030 or gfx90a",
                       what, d->code);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(document, numbers[i].name);
        const double value = cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
        if (!(value >= numbers[i].least && value <= numbers[i].most) ||
            (numbers[i].whole && value != floor(value)))
            return bb_fail(BB_INVALID, "%s: member '%s' must be a %snumber from %g to %g", what,
                           numbers[i].name, numbers[i].whole ? "whole " : "", numbers[i].least,
                           numbers[i].most);
        memcpy((char *)d + numbers[i].at, &value, sizeof value);
    }
    return BB_OK;
}

static bb_status parse(const char *text, const char *what, bb_description *d)
{
    cJSON *document = cJSON_ParseWithOpts(text, NULL, true);
    if (!cJSON_IsObject(document)) {
        cJSON_Delete(document);
        return bb_fail(BB_INVALID, "%s: is no JSON object", what);
    }
    bb_status status = read_members(document, what, d);
    cJSON_Delete(document);
    return status;
}

/* Names go into those of results. */
static bb_status check_name(const char *what, const char *name)
{
    static const char taken[] = "abcdefghijklmnopqrstuvwxyz0123456789-_.";
    return name[strspn(name, taken)] == '\0'
               ? BB_OK
               : bb_fail(BB_INVALID,
                         "%s: member 'name' may have lower-case letters, digits, '-', '_' and '.' "
                         "alone",
                         what);
}

/* The embedded description; NULL if there is none. */
static const bb_source *find(const char *name)
{
    char file[80];
    snprintf(file, sizeof file, "%s%s", name, ENDING);
    return bb_source_find(file);
}

/* Returns the length of the name in that of a description's file; 0 if it is none. */
static int stem_of(const char *file)
{
    const size_t length = strlen(file), ending = sizeof ENDING - 1;
    return length > ending && strcmp(file + length - ending, ENDING) == 0 ? (int)(length - ending)
                                                                          : 0;
}

void bb_description_names(const char *separator, char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = '\0';
    for (const bb_source *s = bb_embedded_sources; s->name != NULL && used < capacity; s++)
        if (stem_of(s->name) > 0)
            used += (size_t)snprintf(text + used, capacity - used, "%s%.*s",
                                     used > 0 ? separator : "", stem_of(s->name), s->name);
}

static bb_status unknown(const char *name)
{
    bb_suggestion meant = {.word = name};
    char names[256], stems[16][64];
    uint32_t count = 0;
    for (const bb_source *s = bb_embedded_sources; s->name != NULL && count < 16; s++)
        if (stem_of(s->name) > 0) {
            snprintf(stems[count], sizeof stems[0], "%.*s", stem_of(s->name), s->name);
            bb_suggest(&meant, stems[count++]);
        }
    bb_description_names(", ", names, sizeof names);
    return bb_fail(BB_INVALID,
                   "unknown device '%s'%s: there are %s, or give a file that ends in .json", name,
                   bb_suggested(&meant), names);
}

/* Another file may have the same name: what has other figures is another device. */
static bb_status add_hash(bb_description *d)
{
    uint64_t hash;
    char name[sizeof d->name];
    bb_identity *identity = bb_identity_begin();
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        bb_identity_add(identity, (const char *)d + numbers[i].at, sizeof(double));
    bb_identity_add_text(identity, d->code);
    BB_TRY(bb_identity_end(identity, "device", &hash));
    snprintf(name, sizeof name, "%.*s-%08x", NAME_MOST, d->name, (uint32_t)hash);
    memcpy(d->name, name, sizeof name);
    return BB_OK;
}

bb_status bb_description_read(const char *text, bb_description *description)
{
    *description = (bb_description){.units = 0};
    if (stem_of(text) == 0) {
        const bb_source *source = find(text);
        return source != NULL ? parse(source->text, text, description) : unknown(text);
    }
    char *data;
    size_t size;
    BB_TRY(bb_file_read(text, FILE_LIMIT, "device", &data, &size));
    bb_status status = strlen(data) == size
                           ? parse(data, text, description)
                           : bb_fail(BB_INVALID, "%s: is no text: it has a byte of value 0", text);
    free(data);
    BB_TRY(status);
    BB_TRY(check_name(text, description->name));
    if (find(description->name) != NULL)
        return bb_fail(BB_INVALID,
                       "%s: member 'name' is '%s', a device that there is already: give it another",
                       text, description->name);
    return add_hash(description);
}

uint32_t bb_description_in_flight(const bb_description *d, uint32_t registers, uint32_t width)
{
    const double taken = ceil(registers / d->register_step) * d->register_step * width;
    const double room = taken > 0 ? floor(d->registers / taken) : d->groups;
    return room < 1 ? 1 : room < d->groups ? (uint32_t)room : (uint32_t)d->groups;
}
