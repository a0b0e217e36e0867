/* Texts with figures in them. */
#include "framework/papers/reproduce.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bb_say(bb_words *words, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    size_t room = sizeof words->text - words->length;
    int length = vsnprintf(words->text + words->length, room, format, arguments);
    va_end(arguments);
    if (length > 0)
        words->length += (size_t)length < room ? (size_t)length : room - 1;
    if (length >= (int)room)
        memcpy(words->text + words->length - 3, "...", 3);
}

void bb_say_claimed(bb_words *words, const char *where, double claimed, bb_estimate here)
{
    bb_say(words, "%s%s%sclaimed %.4g, here ", words->length > 0 ? "; " : "", where,
           where[0] != '\0' ? ": " : "", claimed);
    bb_say_estimate(words, here);
}

void bb_say_estimate(bb_words *words, bb_estimate e)
{
    if (isnan(e.value))
        bb_say(words, "not measured");
    else if (!isnan(e.low))
        bb_say(words, "%.3f [95 %%: %.3f to %.3f]", e.value, e.low, e.high);
    else if (!isnan(e.least))
        bb_say(words, "%.3f [range: %.3f to %.3f]", e.value, e.least, e.most);
    else
        bb_say(words, "%.3f", e.value);
}

bool bb_say_missing(const char *builder, bb_words *words)
{
    char name[64];
    if (!bb_missing_stage(builder, name, sizeof name))
        return false;
    bb_say(words, "%sno such builder: %s", words->length > 0 ? "; " : "", name);
    return true;
}

/* ---- figures of all scenes ---- */

/* The first scene with this figure. */
static const char *scene_with(const bb_paper_series *s, double value)
{
    for (size_t i = 0; i < s->count; i++)
        if (s->each[i].value == value)
            return s->places[i].scene;
    return "none";
}

static void say_range(bb_words *words, const bb_paper_series *s)
{
    const double low = bb_series_least(s), high = bb_series_most(s);
    if (isnan(low))
        bb_say(words, "not measured");
    else
        bb_say(words, "%.3g on average, %.3g (%s) to %.3g (%s)", bb_series_mean(s), low,
               scene_with(s, low), high, scene_with(s, high));
}

static void say_count(bb_words *words, const bb_paper_series *s, char kind, double bound)
{
    unsigned count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += kind == '#'   ? !isnan(s->each[i].value)
                 : kind == '<' ? s->each[i].value < bound
                               : s->each[i].value > bound;
    bb_say(words, "%u", count);
}

static void say_spread(bb_words *words, const bb_paper_series *s)
{
    const double low = bb_series_least(s), high = bb_series_most(s);
    bb_say_estimate(words, s->mean);
    if (!isnan(low))
        bb_say(words, " on average, %.2f to %.2f", low, high);
}

static void say_series(bb_words *words, const bb_paper_series *s, char kind, const char *rest)
{
    const double low = bb_series_least(s), high = bb_series_most(s);
    if (kind == '~')
        say_range(words, s);
    else if (kind == '!')
        bb_say(words, "%.1f %%", 100 * fmax(fabs(low - 1), fabs(high - 1)));
    else if (kind == '/')
        say_spread(words, s);
    else
        say_count(words, s, kind, atof(rest));
}

/* ---- what stands in braces ---- */

static void say_figure(bb_words *words, const char *format, bb_paper_place at,
                       const bb_figure *figure)
{
    bool timed;
    if (format[0] != '\0' && strchr("~!/#<>", format[0]) != NULL) {
        at.scene = NULL;
        const bb_paper_series s = bb_figure_series(at, figure);
        say_series(words, &s, format[0], format + 1);
    } else if (format[0] == '=') {
        char builder[256], chosen[32];
        bb_figure_builder(&at, figure, figure->builder, NULL, builder, chosen);
        bb_say(words, "%s", chosen);
    } else if (format[0] == '.') {
        bb_say(words, "%.*f", atoi(format + 1), bb_value_at(at, figure));
    } else if (format[0] == '%') {
        bb_say(words, "%+.*f %%", atoi(format + 1), 100 * (bb_value_at(at, figure) - 1));
    } else {
        bb_say_estimate(words, bb_figure_at(at, figure, &timed));
    }
}

static void say_place(bb_words *words, const char *name, bb_paper_place at)
{
    if (strcmp(name, "scene") == 0 && at.scene != NULL)
        bb_say(words, "%s", at.scene);
    else if (strcmp(name, "view") == 0)
        bb_say(words, "%s", bb_view_name(at.all, at.scene, at.view));
    else if (at.row != NULL)
        bb_say(words, "%s", at.row->name);
}

void bb_say_text(bb_words *words, const char *text, bb_paper_place at,
                 const bb_figure *const *figures)
{
    while (*text != '\0') {
        const size_t plain = strcspn(text, "{");
        char inside[32];
        bb_say(words, "%.*s", (int)plain, text);
        text += plain;
        if (*text == '\0')
            return;
        const size_t length = strcspn(text, "}");
        snprintf(inside, sizeof inside, "%.*s", (int)length - 1, text + 1);
        if (isdigit((unsigned char)inside[0]))
            say_figure(words, inside + 1, at, figures[inside[0] - '0']);
        else
            say_place(words, inside, at);
        text += length + (text[length] == '}');
    }
}
