/* The advice as text: what the scene needs, the choice, what it saves, what else was tried. */
#include "framework/advise/advice.h"
#include "framework/base/steering.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OTHERS = 4 }; /* that are named of those that do the same */

static double number(const cJSON *object, const char *name)
{
    return bb_json_number(object, name);
}

static const char *text(const cJSON *object, const char *name)
{
    return bb_json_text(object, name);
}

static const cJSON *part(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* Digits in groups of three. */
static const char *grouped(double value, char out[32])
{
    char digits[32];
    size_t length = (size_t)snprintf(digits, sizeof digits, "%.0f", value), used = 0;
    for (size_t i = 0; i < length && used + 2 < 32; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            out[used++] = ',';
        out[used++] = digits[i];
    }
    out[used] = '\0';
    return out;
}

static const char *megabytes(double bytes, char out[32])
{
    snprintf(out, 32, "%.*f MB", fabs(bytes) < 1e7 ? 2 : 1, bytes / 1e6);
    return out;
}

/* Of a long time seconds. */
static const char *time_of(double ms, char out[32])
{
    snprintf(out, 32, ms < 1e4 ? "%.1f ms" : "%.1f s", ms < 1e4 ? ms : ms / 1e3);
    return out;
}

/* "1.02 [0.99 to 1.05]"; without brackets where there is no interval. */
static void print_interval(FILE *out, const cJSON *object, const char *name, const char *format)
{
    char low[64], high[64];
    snprintf(low, sizeof low, "%s_lo", name);
    snprintf(high, sizeof high, "%s_hi", name);
    fprintf(out, format, number(object, name));
    if (!isfinite(number(object, low)))
        return;
    fputs(" [", out);
    fprintf(out, format, number(object, low));
    fputs(" to ", out);
    fprintf(out, format, number(object, high));
    fputs("]", out);
}

static void print_value(const cJSON *value, char *out, size_t capacity)
{
    if (cJSON_IsNumber(value))
        snprintf(out, capacity, "%.0f", value->valuedouble);
    else
        snprintf(out, capacity, "%s", cJSON_IsString(value) ? value->valuestring : "-");
}

static void print_decisions(const cJSON *all, FILE *out)
{
    const cJSON *one;
    cJSON_ArrayForEach(one, all)
    {
        char value[64];
        print_value(part(one, "value"), value, sizeof value);
        fprintf(out, "   %-19s %-10s %-8s %s\n", one->string, value, text(one, "by"),
                text(one, "figure"));
    }
}

/* ---- the choice ---- */

/* A limit of 0 cannot be shown by any number of rays: the bound says how far they go. */
static void print_limit(const cJSON *a, FILE *out)
{
    char rays[32];
    const double limit = number(a, "max_wrong_ppm");
    if (limit > 0 && cJSON_IsFalse(part(part(a, "choice"), "limit_shown")))
        fprintf(
            out,
            "                These rays do not show that it is within %g per million: that takes\n"
            "                %s judged rays if none is wrong, more if some are (--max-rays)\n",
            limit, grouped(ceil(3e6 / limit), rays));
}

static void print_choice(const cJSON *a, FILE *out)
{
    const cJSON *c = part(a, "choice"), *best = part(a, "fastest");
    char all[32], build[32], layout[32], checked[32];
    if (text(a, "preliminary")[0] != '\0')
        fprintf(out, "\n PRELIMINARY: interrupted; the best so far, by %s\n",
                text(a, "preliminary"));
    else
        fprintf(out, "\n The least that does it in the time of the fastest, or 5 %% more\n");
    fprintf(out, "   builder      %s\n   kernel       %s\n   intersector  %s: ", text(c, "builder"),
            text(c, "kernel"), text(c, "intersector"));
    fprintf(out, "%s wrong of %s judged, %s %.3g per million (95 %%)\n",
            number(c, "wrong") > 0 ? grouped(number(c, "wrong"), all) : "none",
            grouped(number(c, "checked"), checked), number(c, "wrong") > 0 ? "at most" : "below",
            number(c, "wrong_ppm_at_most"));
    print_limit(a, out);
    fprintf(out, "   memory       %s: %s for tree and scratch, %s for the layout\n",
            megabytes(number(c, "bytes"), all), megabytes(number(c, "bytes_build"), build),
            megabytes(number(c, "bytes_layout"), layout));
    char rays[32];
    fprintf(out, "   time         %s: %s build, %s layout, %s rays (medians)\n   to fastest   ",
            time_of(number(c, "image_ms"), all), time_of(number(c, "build_ms"), build),
            time_of(number(c, "layout_ms"), layout), time_of(number(c, "trace_ms"), rays));
    print_interval(out, c, "ratio", "%.3f");
    fprintf(out, " times its time, paired round by round\n   fastest      %s, %s, %s: %s, %s\n",
            text(best, "builder"), text(best, "kernel"), text(best, "intersector"),
            megabytes(number(best, "bytes"), all), time_of(number(best, "image_ms"), rays));
    print_decisions(part(c, "decisions"), out);
}

static void print_saving(const cJSON *s, FILE *out)
{
    char what[160], bytes[32];
    const char *name = text(s, "what");
    if (strcmp(name, "builder") == 0)
        snprintf(what, sizeof what, "%s", text(s, "generous"));
    else if (strcmp(name, "stack") == 0)
        snprintf(what, sizeof what, "a stack of %s, not %s", text(s, "generous"),
                 text(s, "chosen"));
    else if (strcmp(name, "kinds") == 0)
        snprintf(what, sizeof what, "%s kinds compiled in, not %s", text(s, "generous"),
                 text(s, "chosen"));
    else
        snprintf(what, sizeof what, "%s", name);
    if (!isfinite(number(s, "bytes"))) {
        fprintf(out, "   %-38s not measured: %s\n", what, text(s, "reason"));
        return;
    }
    fprintf(out, "   %-38s ", what);
    fprintf(out, "%s%s, ", number(s, "bytes") > 0 ? "+" : "", megabytes(number(s, "bytes"), bytes));
    if (strcmp(name, "stack") == 0)
        fprintf(out, "%+.0f bytes per ray in flight, ",
                8 * (atof(text(s, "generous")) - atof(text(s, "chosen"))));
    print_interval(out, s, "ms", "%+.1f");
    fputs(" ms\n", out);
}

static bool is_exactness(const cJSON *saving)
{
    return strcmp(text(saving, "what"), "exactness") == 0;
}

static void print_savings(const cJSON *a, FILE *out)
{
    const cJSON *s;
    if (cJSON_GetArraySize(part(a, "savings")) == 0)
        return;
    fprintf(out, "\n Left out, and what it would have cost to keep it\n");
    cJSON_ArrayForEach(s, part(a, "savings")) if (!is_exactness(s)) print_saving(s, out);
}

/* Beside the most careless intersector. */
static void print_exactness(const cJSON *a, FILE *out)
{
    const cJSON *s;
    char wrong[32], checked[32];
    cJSON_ArrayForEach(s, part(a, "savings"))
    {
        if (!is_exactness(s) || !isfinite(number(s, "bytes")))
            continue;
        fprintf(out, "\n What exactness costs\n   beside %s, ", text(s, "intersector"));
        fprintf(out, "%s wrong of %s: ", grouped(number(s, "wrong"), wrong),
                grouped(number(s, "checked"), checked));
        print_interval(out, s, "ms", "%+.1f");
        fputs(" ms\n", out);
    }
}

/* ---- the others ---- */

static int by_ratio(const void *a, const void *b)
{
    double x = number(*(const cJSON *const *)a, "ratio"),
           y = number(*(const cJSON *const *)b, "ratio");
    return (x > y) - (x < y);
}

static void print_one(const cJSON *one, FILE *out)
{
    char bytes[32];
    fprintf(out, "   %s, %s, %s: %s, ", text(one, "builder"), text(one, "kernel"),
            text(one, "intersector"), megabytes(number(one, "bytes"), bytes));
    print_interval(out, one, "ratio", "%.3f");
    fputc('\n', out);
}

/* Those with a state, the fastest first. */
static void print_state(const cJSON *contenders, const char *state, const char *title, FILE *out)
{
    const cJSON *one, **found = calloc((size_t)cJSON_GetArraySize(contenders) + 1, sizeof *found);
    size_t count = 0;
    cJSON_ArrayForEach(one, contenders)
    {
        if (found != NULL && strcmp(text(one, "state"), state) == 0)
            found[count++] = one;
    }
    if (count > 0) {
        qsort(found, count, sizeof *found, by_ratio);
        fprintf(out, "\n %s: %zu\n", title, count);
        for (size_t i = 0; i < count && i < OTHERS; i++)
            print_one(found[i], out);
        if (count > OTHERS)
            fprintf(out, "   and %zu more\n", count - OTHERS);
    }
    free(found);
}

static void print_unmeasured(const cJSON *contenders, FILE *out)
{
    const cJSON *one;
    cJSON_ArrayForEach(one, contenders)
    {
        char checked[32], wrong[32];
        const char *state = text(one, "state");
        if (strcmp(state, "too wrong") == 0)
            fprintf(out, "   %s, %s, %s: %s wrong of %s\n", text(one, "builder"),
                    text(one, "kernel"), text(one, "intersector"),
                    grouped(number(one, "wrong"), wrong), grouped(number(one, "checked"), checked));
        else if (strcmp(state, "not measured") == 0)
            fprintf(out, "   %s, %s, %s: %s\n", text(one, "builder"), text(one, "kernel"),
                    text(one, "intersector"), text(one, "reason"));
    }
}

static uint32_t count_states(const cJSON *contenders, const char *state)
{
    const cJSON *one;
    uint32_t count = 0;
    cJSON_ArrayForEach(one, contenders) count += strcmp(text(one, "state"), state) == 0;
    return count;
}

static void print_others(const cJSON *a, FILE *out)
{
    const cJSON *scouts = part(a, "scouts"), *field = part(a, "contenders");
    print_state(field, "more than needed",
                "As fast, and more than is needed; paired ratios to the fastest", out);
    print_state(field, "slower", "Slower than that in the last heat; paired ratios to the fastest",
                out);
    print_state(field, "too slow", "Dropped on the way, slower by more than 5 % in each round",
                out);
    print_state(scouts, "too slow", "Kernels and intersectors that the scouts dropped", out);
    print_state(part(a, "builders"), "too slow", "Builders that the scouts dropped", out);
    if (number(a, "unlikely") > 0)
        fprintf(out, "\n By the scouts' figures too slow by far, and left out: %.0f more\n",
                number(a, "unlikely"));
    const cJSON *const lists[] = {scouts, field};
    for (size_t i = 0; i < 2; i++) {
        uint32_t count =
            count_states(lists[i], "too wrong") + count_states(lists[i], "not measured");
        if (count == 0)
            continue;
        fprintf(out, "\n Wrong too often, or not measured%s: %u\n",
                i == 0 ? ", among the scouts" : "", count);
        print_unmeasured(lists[i], out);
    }
}

static void print_search(const cJSON *a, FILE *out)
{
    const cJSON *all = part(a, "exhaustive"), *least = part(all, "least"),
                *best = part(all, "fastest");
    char bytes[32];
    if (all == NULL || best == NULL)
        return;
    fprintf(out, "\n Exhaustive search: %.0f configurations, %u of them right and measured\n",
            number(all, "configurations"),
            (unsigned)number(all, "configurations") -
                count_states(part(all, "contenders"), "too wrong") -
                count_states(part(all, "contenders"), "not measured"));
    fprintf(out, "   fastest      %s, %s, %s\n   the choice takes ", text(best, "builder"),
            text(best, "kernel"), text(best, "intersector"));
    print_interval(out, all, "ratio", "%.3f");
    fprintf(out, " of its time, paired round by round\n   least        %s, %s, %s: %s\n",
            text(least, "builder"), text(least, "kernel"), text(least, "intersector"),
            megabytes(number(least, "bytes"), bytes));
}

static void print_all(const cJSON *a, FILE *out)
{
    const cJSON *rays;
    char prims[32], count[32];
    fprintf(out, "%s, %s primitives; for %s rays:", text(a, "scene"),
            grouped(number(a, "prims"), prims), grouped(number(a, "image_rays"), count));
    cJSON_ArrayForEach(rays, part(a, "rays"))
        fprintf(out, "%s %s", rays->prev->next != NULL ? "," : "", rays->valuestring);
    fprintf(out, "; at most %g wrong per million\n\n What the scene asks for\n",
            number(a, "max_wrong_ppm"));
    print_decisions(part(a, "needs"), out);
    if (cJSON_IsObject(part(a, "choice")))
        print_choice(a, out);
    else
        fprintf(out, "\n Nothing that was tried is right often enough\n");
    print_savings(a, out);
    print_exactness(a, out);
    print_others(a, out);
    print_search(a, out);
    if (text(a, "command")[0] != '\0')
        fprintf(out, "\n To measure the choice again:\n %s\n", text(a, "command"));
}

/* Names are a file's, and reasons may have them. */
static void calm(cJSON *item)
{
    for (; item != NULL; item = item->next) {
        if (cJSON_IsString(item))
            bb_calm_text(item->valuestring);
        if (item->string != NULL)
            bb_calm_text(item->string);
        calm(item->child);
    }
}

bb_status bb_advice_print(const bb_results *results, FILE *out)
{
    const cJSON *advice = bb_results_member(results, "advice");
    if (advice == NULL)
        return bb_fail(BB_FAILED, "advise: the document has no advice");
    cJSON *a = cJSON_Duplicate(advice, true);
    if (a == NULL)
        return bb_fail(BB_FAILED, "advise: no memory");
    calm(a);
    print_all(a, out);
    cJSON_Delete(a);
    return ferror(out) ? bb_fail(BB_FAILED, "cannot write the advice") : BB_OK;
}
