/* Text and tables of transfer functions. */
#include "framework/scene/transfer.h"

#include "framework/base/file.h"
#include "framework/base/number.h"
#include "framework/base/suggest.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 20, LINE_MAX_LENGTH = 256 };

const bb_transfer_preset bb_transfer_presets[] = {
    {"ramp", "fog: from nothing at a tenth to half at the top",
     "0.1 0 0.2 0.4 1\n"
     "0.5 0.1 0.3 0.8 0.6\n"
     "1 0.5 1 0.7 0.3\n"},
    {"bone", "what is dense, as a surface; what is around it, faintly",
     "0.2 0 0.8 0.5 0.4\n"
     "0.3 0.02\n"
     "0.4 0.02\n"
     "0.55 0.7 1 0.95 0.85\n"
     "1 0.9 1 1 1\n"},
    {"sparse", "the uppermost fifth alone",
     "0.8 0 1 0.8 0.3\n"
     "1 0.9 1 0.4 0.2\n"},
    {"shells", "three thin layers",
     "0.2 0 0.3 0.5 1\n0.23 0.3\n0.26 0\n"
     "0.45 0 0.4 0.9 0.5\n0.48 0.3\n0.51 0\n"
     "0.7 0 1 0.6 0.3\n0.73 0.5\n0.76 0\n"},
    {"full", "all of it: nothing can be skipped",
     "0 0.005 0.3 0.5 0.9\n"
     "1 0.05 1 0.8 0.5\n"},
    {"empty", "nothing", "0 0\n"},
    {NULL, NULL, NULL},
};

/* ---- text ---- */

static bool is_share(double number)
{
    return number >= 0 && number <= 1;
}

static bb_status parse_line(const char *what, uint32_t line, char *words, bb_transfer *transfer)
{
    double numbers[5];
    uint32_t count = 0;
    char *rest = NULL;
    for (char *word = strtok_r(words, " \t\r", &rest); word != NULL;
         word = strtok_r(NULL, " \t\r", &rest)) {
        if (count == 5)
            return bb_fail(BB_INVALID, "%s: line %u: '%s' is too much: VALUE ALPHA R G B is all",
                           what, line, word);
        if (!bb_read_real(word, &numbers[count]) || !is_share(numbers[count]))
            return bb_fail(BB_INVALID, "%s: line %u: '%s' is no number from 0 to 1", what, line,
                           word);
        count++;
    }
    if (count == 0)
        return BB_OK;
    if (count != 2 && count != 5)
        return bb_fail(BB_INVALID,
                       "%s: line %u: has %u numbers: it must be VALUE ALPHA or VALUE ALPHA R G B",
                       what, line, count);
    if (transfer->count == BB_TRANSFER_POINTS_MAX)
        return bb_fail(BB_INVALID, "%s: line %u: more than %d points", what, line,
                       BB_TRANSFER_POINTS_MAX);
    bb_transfer_point *point = &transfer->points[transfer->count];
    const bb_transfer_point *before = transfer->count > 0 ? point - 1 : NULL;
    *point = (bb_transfer_point){numbers[0], numbers[1], {1, 1, 1}};
    if (before != NULL && before->value > point->value)
        return bb_fail(BB_INVALID, "%s: line %u: value %g comes after %g: they must ascend", what,
                       line, point->value, before->value);
    for (int k = 0; k < 3; k++)
        point->rgb[k] = count == 5 ? numbers[2 + k] : before != NULL ? before->rgb[k] : 1;
    transfer->count++;
    return BB_OK;
}

bb_status bb_transfer_parse(const char *what, const char *text, bb_transfer *transfer)
{
    uint32_t line = 0;
    transfer->count = 0;
    while (*text != '\0') {
        char words[LINE_MAX_LENGTH];
        size_t length = strcspn(text, "\n"), end = strcspn(text, "#\n");
        line++;
        if (end >= sizeof words)
            return bb_fail(BB_INVALID, "%s: line %u: is longer than %d characters", what, line,
                           LINE_MAX_LENGTH - 1);
        memcpy(words, text, end);
        words[end] = '\0';
        BB_TRY(parse_line(what, line, words, transfer));
        text += length + (text[length] == '\n');
    }
    return transfer->count > 0 ? BB_OK : bb_fail(BB_INVALID, "%s: has no line VALUE ALPHA", what);
}

static bb_status load_file(const char *path, bb_transfer *transfer)
{
    char *text;
    size_t size;
    BB_TRY(bb_file_read(path, FILE_LIMIT, "transfer function", &text, &size));
    bb_status status = strlen(text) == size
                           ? bb_transfer_parse(path, text, transfer)
                           : bb_fail(BB_INVALID, "%s: is no text: it has a zero byte", path);
    free(text);
    const char *name = strrchr(path, '/');
    snprintf(transfer->name, sizeof transfer->name, "%s", name != NULL ? name + 1 : path);
    return status;
}

static bb_status unknown(const char *text)
{
    bb_suggestion meant = {.word = text};
    char names[128] = "";
    for (const bb_transfer_preset *p = bb_transfer_presets; p->name != NULL; p++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "", p->name);
        bb_suggest(&meant, p->name);
    }
    return bb_fail(BB_INVALID, "unknown transfer function '%s'%s: take one of %s, or a file", text,
                   bb_suggested(&meant), names);
}

bb_status bb_transfer_load(const char *text, bb_transfer *transfer)
{
    for (const bb_transfer_preset *p = bb_transfer_presets; p->name != NULL; p++)
        if (strcmp(p->name, text) == 0) {
            snprintf(transfer->name, sizeof transfer->name, "%s", p->name);
            return bb_transfer_parse(p->name, p->text, transfer);
        }
    if (strpbrk(text, "/.") == NULL)
        return unknown(text);
    return load_file(text, transfer);
}

/* ---- table ---- */

/* Interpolates at `value`. Of two points there, the second counts. */
static bb_transfer_point at(const bb_transfer *transfer, double value)
{
    const bb_transfer_point *points = transfer->points;
    uint32_t after = 0;
    while (after < transfer->count && points[after].value <= value)
        after++;
    if (after == 0)
        return points[0];
    if (after == transfer->count)
        return points[after - 1];
    const bb_transfer_point *a = &points[after - 1], *b = &points[after];
    double w = (value - a->value) / (b->value - a->value);
    bb_transfer_point point = {value, a->alpha + w * (b->alpha - a->alpha), {0}};
    for (int k = 0; k < 3; k++)
        point.rgb[k] = a->rgb[k] + w * (b->rgb[k] - a->rgb[k]);
    return point;
}

void bb_transfer_table(const bb_transfer *transfer, double voxel, bb_transfer_entry *table)
{
    for (uint32_t i = 0; i < BB_TRANSFER_STEPS; i++) {
        bb_transfer_point point = at(transfer, (double)i / (BB_TRANSFER_STEPS - 1));
        double left = fmax(1 - point.alpha, BB_TRANSFER_LEAST_LEFT);
        double extinction = -log(left) / voxel;
        table[i] = (bb_transfer_entry){{0}, 0};
        if (extinction < FLT_MIN) /* devices may flush denormals */
            continue;
        table[i].extinction = extinction < FLT_MAX ? (float)extinction : FLT_MAX;
        for (int k = 0; k < 3; k++)
            table[i].rgb[k] = (float)point.rgb[k];
    }
}
