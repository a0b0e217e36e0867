#include "framework/stress/axis.h"

#include "framework/base/file.h"
#include "framework/base/steering.h"
#include "framework/builder/pipeline.h"
#include "framework/tasks/animate.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_BYTES_MAX = 1 << 16 };

/* ---- reading ---- */

typedef struct reader {
    const cJSON *root;
    const char *name; /* of the file */
    uint32_t seen;    /* number of members read */
} reader;

static const cJSON *member(reader *r, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(r->root, name);
    r->seen += item != NULL;
    return item;
}

/* `fallback`: the value of an absent member; NULL: the member is needed. */
static bb_status read_text(reader *r, const char *name, const char *fallback, char *out,
                           size_t capacity)
{
    const cJSON *item = member(r, name);
    const char *text = item == NULL ? fallback : cJSON_GetStringValue(item);
    if (text == NULL || (item != NULL && text[0] == '\0') || strlen(text) >= capacity)
        return bb_fail(BB_INVALID, "axis %s: \"%s\" must be a text of 1 to %zu characters", r->name,
                       name, capacity - 1);
    if (!bb_is_calm(text))
        return bb_fail(BB_INVALID, "axis %s: \"%s\" must be of printable characters", r->name,
                       name);
    snprintf(out, capacity, "%s", text);
    return BB_OK;
}

static bb_status read_number(reader *r, const char *name, double fallback, double low, double high,
                             double *out)
{
    const cJSON *item = member(r, name);
    *out = item == NULL ? fallback : cJSON_IsNumber(item) ? item->valuedouble : NAN;
    if (!(*out >= low && *out <= high))
        return bb_fail(BB_INVALID, "axis %s: \"%s\" must be a number from %g to %g", r->name, name,
                       low, high);
    return BB_OK;
}

static bb_status read_rays(reader *r, bb_axis *axis)
{
    const cJSON *list = member(r, "rays"), *item;
    int count = cJSON_IsArray(list) ? cJSON_GetArraySize(list) : 0;
    if (count < 1 || count > BB_AXIS_RAYS_MAX)
        return bb_fail(BB_INVALID, "axis %s: \"rays\" must be a list of 1 to %d texts", r->name,
                       BB_AXIS_RAYS_MAX);
    cJSON_ArrayForEach(item, list)
    {
        const char *text = cJSON_GetStringValue(item);
        if (text == NULL || text[0] == '\0' || strlen(text) >= sizeof axis->rays[0] ||
            !bb_is_calm(text))
            return bb_fail(BB_INVALID,
                           "axis %s: \"rays\" must be texts of 1 to %zu printable characters",
                           r->name, sizeof axis->rays[0] - 1);
        snprintf(axis->rays[axis->ray_count++], sizeof axis->rays[0], "%s", text);
    }
    return BB_OK;
}

static bb_status read_also(reader *r, bb_axis *axis)
{
    const cJSON *list = member(r, "also"), *item;
    if (list == NULL)
        return BB_OK;
    if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) > 4)
        return bb_fail(BB_INVALID, "axis %s: \"also\" must be a list of up to 4 numbers", r->name);
    cJSON_ArrayForEach(item, list)
    {
        if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
            return bb_fail(BB_INVALID, "axis %s: \"also\" must be numbers", r->name);
        axis->also[axis->also_count++] = item->valuedouble;
    }
    return BB_OK;
}

static bool by_differences(const bb_axis *axis)
{
    return axis->steps == BB_STEPS_LINEAR || axis->steps == BB_STEPS_COUNT;
}

static bb_status read_range(reader *r, bb_axis *axis)
{
    static const char *const words[] = {"log", "linear", "whole", "count"};
    char steps[16];
    double intervals, n, quick_n, frames;
    BB_TRY(read_number(r, "from", NAN, -1e300, 1e300, &axis->from));
    BB_TRY(read_number(r, "to", NAN, -1e300, 1e300, &axis->to));
    BB_TRY(read_text(r, "steps", "log", steps, sizeof steps));
    BB_TRY(read_number(r, "intervals", 4, 1, BB_AXIS_POINTS_MAX - 5, &intervals));
    BB_TRY(read_number(r, "n", 20000, 1, 1e9, &n));
    BB_TRY(read_number(r, "quick_n", n < 4000 ? n : 4000, 1, 1e9, &quick_n));
    BB_TRY(read_number(r, "frames", 0, 0, BB_AXIS_FRAMES_MAX, &frames));
    BB_TRY(read_also(r, axis));
    uint32_t word = 0;
    while (word < 4 && strcmp(steps, words[word]) != 0)
        word++;
    if (word == 4)
        return bb_fail(BB_INVALID, "axis %s: \"steps\" must be log, linear, whole or count",
                       r->name);
    axis->steps = (bb_axis_steps)word;
    axis->intervals = (uint32_t)intervals;
    axis->n = (uint64_t)n;
    axis->quick_n = (uint64_t)quick_n;
    axis->frames = (uint32_t)frames;
    if (frames == 1 || frames != axis->frames)
        return bb_fail(BB_INVALID,
                       "axis %s: \"frames\" must be a whole number from 2 on, or 0 for none",
                       r->name);
    if (axis->frames > 0 && axis->ray_count > BB_ANIMATE_RAYS_MAX)
        return bb_fail(BB_INVALID, "axis %s: \"rays\" of one with \"frames\" are at most %d",
                       r->name, BB_ANIMATE_RAYS_MAX);
    if (axis->from == axis->to)
        return bb_fail(BB_INVALID, "axis %s: \"from\" and \"to\" must differ", r->name);
    if (!by_differences(axis) && !(axis->from > 0 && axis->to > 0))
        return bb_fail(BB_INVALID,
                       "axis %s: \"from\" and \"to\" must be above 0, since its steps are ratios",
                       r->name);
    return BB_OK;
}

static bool mentions_x(const bb_axis *axis)
{
    bool found = strstr(axis->scene, "{x}") != NULL;
    for (uint32_t i = 0; i < axis->ray_count; i++)
        found = found || strstr(axis->rays[i], "{x}") != NULL;
    return found;
}

static bool is_name(const char *text)
{
    return text[strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789-")] == '\0' && text[0] != '\0' &&
           text[0] != '-';
}

static bb_status read_axis(reader *r, bb_axis *axis)
{
    const bb_builder *usual = bb_usual_builder(BB_ALL_KINDS);
    BB_TRY(read_text(r, "name", NULL, axis->name, sizeof axis->name));
    BB_TRY(read_text(r, "title", NULL, axis->title, sizeof axis->title));
    BB_TRY(read_text(r, "parameter", NULL, axis->parameter, sizeof axis->parameter));
    BB_TRY(read_text(r, "why", NULL, axis->why, sizeof axis->why));
    BB_TRY(read_text(r, "known", "", axis->known, sizeof axis->known));
    BB_TRY(read_text(r, "scene", NULL, axis->scene, sizeof axis->scene));
    BB_TRY(read_text(r, "builder", usual != NULL ? usual->name : NULL, axis->builder,
                     sizeof axis->builder));
    BB_TRY(read_text(r, "kernel", NULL, axis->kernel, sizeof axis->kernel));
    BB_TRY(read_rays(r, axis));
    BB_TRY(read_range(r, axis));
    if (r->seen < (uint32_t)cJSON_GetArraySize(r->root))
        return bb_fail(BB_INVALID,
                       "axis %s: it has a member that no axis has, or one twice: see "
                       "framework/stress/README.md",
                       r->name);
    if (!is_name(axis->name))
        return bb_fail(BB_INVALID,
                       "axis %s: \"name\" must be of lower-case letters, digits and '-'", r->name);
    if (!mentions_x(axis))
        return bb_fail(BB_INVALID, "axis %s: neither \"scene\" nor \"rays\" has {x} in it",
                       r->name);
    return BB_OK;
}

bb_status bb_axis_parse(const char *text, const char *name, bb_axis *axis)
{
    memset(axis, 0, sizeof *axis);
    cJSON *root = cJSON_ParseWithOpts(text, NULL, true);
    reader r = {.root = root, .name = name};
    bb_status status = cJSON_IsObject(root)
                           ? read_axis(&r, axis)
                           : bb_fail(BB_INVALID, "axis %s: the file is no JSON object", name);
    cJSON_Delete(root);
    if (status == BB_OK && (axis->text = strdup(text)) == NULL)
        status = bb_fail(BB_FAILED, "axis %s: no memory", name);
    return status;
}

static bb_status unknown(const char *name)
{
    char names[2048] = "";
    size_t used = 0;
    for (const bb_axis_source *s = bb_axis_sources; s->name != NULL && used < sizeof names; s++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "",
                                 s->name);
    return bb_fail(BB_INVALID, "'%s' is no axis and no file: take a file, or one of %s", name,
                   names);
}

bb_status bb_axis_load(const char *name_or_path, bb_axis *axis)
{
    memset(axis, 0, sizeof *axis);
    for (const bb_axis_source *s = bb_axis_sources; s->name != NULL; s++)
        if (strcmp(s->name, name_or_path) == 0)
            return bb_axis_parse(s->text, s->name, axis);
    if (access(name_or_path, F_OK) != 0)
        return unknown(name_or_path);
    char *text;
    size_t size;
    BB_TRY(bb_file_read(name_or_path, FILE_BYTES_MAX, "axis", &text, &size));
    bb_status status = strlen(text) == size
                           ? bb_axis_parse(text, name_or_path, axis)
                           : bb_fail(BB_INVALID, "axis %s: the file is no text", name_or_path);
    free(text);
    return status;
}

void bb_axis_free(bb_axis *axis)
{
    free(axis->text);
    memset(axis, 0, sizeof *axis);
}

/* ---- values ---- */

/* Rounds to three digits, which are enough for thresholds and keep names of scenes short. */
static double rounded(const bb_axis *axis, double x)
{
    char digits[32];
    if (axis->steps == BB_STEPS_WHOLE || axis->steps == BB_STEPS_COUNT)
        return round(x);
    snprintf(digits, sizeof digits, "%.2e", x);
    return strtod(digits, NULL);
}

static double between(const bb_axis *axis, double a, double b, double share)
{
    return by_differences(axis) ? a + (b - a) * share : exp(log(a) + (log(b) - log(a)) * share);
}

uint32_t bb_axis_values(const bb_axis *axis, uint32_t intervals, double *values)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i <= intervals; i++) {
        double x = i == 0 ? axis->from
                   : i == intervals
                       ? axis->to
                       : rounded(axis, between(axis, axis->from, axis->to, (double)i / intervals));
        if (count == 0 || x != values[count - 1])
            values[count++] = x;
    }
    for (uint32_t i = 0; i < axis->also_count; i++)
        values[count++] = axis->also[i];
    return count;
}

bool bb_axis_middle(const bb_axis *axis, double a, double b, double *middle)
{
    if (!by_differences(axis) && !(a > 0 && b > 0))
        return false;
    *middle = rounded(axis, between(axis, a, b, 0.5));
    return *middle > fmin(a, b) && *middle < fmax(a, b);
}

void bb_axis_value(double x, char out[BB_AXIS_VALUE])
{
    snprintf(out, BB_AXIS_VALUE, "%.9g", x);
}

bb_status bb_axis_fill(const char *text, double x, uint64_t n, char *out, size_t capacity)
{
    size_t used = 0;
    while (*text != '\0' && used < capacity) {
        if (strncmp(text, "{x}", 3) == 0)
            used += (size_t)snprintf(out + used, capacity - used, "%.9g", x);
        else if (strncmp(text, "{n}", 3) == 0)
            used += (size_t)snprintf(out + used, capacity - used, "%llu", (unsigned long long)n);
        else
            out[used++] = *text;
        text += text[0] == '{' && text[1] != '\0' && text[2] == '}' &&
                        (text[1] == 'x' || text[1] == 'n')
                    ? 3
                    : 1;
    }
    if (used >= capacity)
        return bb_fail(BB_INVALID, "axis: '%.60s...' is too long", text);
    out[used] = '\0';
    return BB_OK;
}
