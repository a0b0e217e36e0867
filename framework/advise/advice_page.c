/* Shows the table of an advice as a page. */
#include "framework/advise/advice.h"
#include "framework/table/figure.h"

#include <math.h>
#include <string.h>

#define OF_CONTENDERS (BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR))
#define LIST(name, by, title)                                                                      \
    {                                                                                              \
        .caption = title, .question = name, .rows = OF_CONTENDERS, .order = by, .columns = {       \
            {{"state"}, NULL, false},                                                              \
            {{"ratio"}, NULL, false},                                                              \
            {{"bytes"}, NULL, false},                                                              \
            {{"image_ms"}, NULL, false},                                                           \
            {{"reason"}, NULL, false}                                                              \
        }                                                                                          \
    }
#define SIMULATED(name, by, title)                                                                 \
    {                                                                                              \
        .caption = title ", neither measured nor validated", .question = name,                     \
        .with = BB_SET(BB_MAKER), .rows = OF_CONTENDERS, .each = BB_SET(BB_MAKER), .order = by,    \
        .columns = {                                                                               \
            {{"state"}, NULL, false},                                                              \
            {{"simt_ratio"}, NULL, false},                                                         \
            {{"bytes"}, NULL, false},                                                              \
            {{"simt_image_ms"}, NULL, false},                                                      \
            {{"simt_mrays_s"}, "bound", false},                                                    \
            {{"simt_binds"}, "by", false},                                                         \
            {{"simt_efficiency"}, "SIMT efficiency", false},                                       \
            {{"reason"}, NULL, false}                                                              \
        }                                                                                          \
    }
#define DECISIONS                                                                                  \
    .having = "value", .rows = BB_SET(BB_QUESTION),                                                \
    .columns = {{{"value"}, NULL, false}, {{"by"}, NULL, false}, {{"figure"}, NULL, false}}
#define PICKED(name, title)                                                                        \
    {                                                                                              \
        .caption = title, .question = name, .having = "pick", .rows = OF_CONTENDERS, .columns = {  \
            {{"pick"}, NULL, false},                                                               \
            {{"ratio"}, NULL, false},                                                              \
            {{"image_ms"}, NULL, false},                                                           \
            {{"build_ms"}, NULL, false},                                                           \
            {{"layout_ms"}, NULL, false},                                                          \
            {{"trace_ms"}, NULL, false},                                                           \
            {{"bytes"}, NULL, false},                                                              \
            {{"bytes_build"}, NULL, false},                                                        \
            {{"bytes_layout"}, NULL, false},                                                       \
            {{"wrong"}, NULL, false},                                                              \
            {{"checked"}, NULL, false},                                                            \
            {{"wrong_ppm_at_most"}, NULL, false}                                                   \
        }                                                                                          \
    }

static const bb_table_view views[] = {
    {.caption = "What the scene asks for", .without = OF_CONTENDERS, DECISIONS},
    PICKED("race", "The choice, and the fastest"),
    {.caption = "What the choice decided", .with = OF_CONTENDERS, DECISIONS},
    {.caption = "Left out, and what it would have cost to keep it",
     .question = "savings",
     .rows = OF_CONTENDERS,
     .columns = {{{"left_out"}, NULL, false},
                 {{"chosen"}, NULL, false},
                 {{"generous"}, NULL, false},
                 {{"bytes_more"}, NULL, false},
                 {{"ray_bytes_more"}, NULL, false},
                 {{"ms_more"}, NULL, false}}},
    {.caption = "What exactness costs, beside the most careless intersector",
     .question = BB_EXACTNESS,
     .rows = OF_CONTENDERS,
     .columns = {{{"wrong"}, NULL, false},
                 {{"checked"}, NULL, false},
                 {{"bytes_more"}, NULL, false},
                 {{"ms_more"}, NULL, false}}},
    PICKED("exhaustive search", "Of all that was ever tried, with all rays"),
    LIST("race", "ratio", "The race"),
    LIST("kernels, intersectors", "image_ms", "Scouts: kernels and intersectors, on a tree"),
    LIST("builders", "image_ms", "Scouts: builders, by one kernel"),
    LIST("exhaustive search", "ratio", "The exhaustive search"),
    {.caption = "Wrong too often, or not measured",
     .having = "unfit",
     .rows = BB_SET(BB_QUESTION) | OF_CONTENDERS,
     .columns = {{{"wrong"}, NULL, false}, {{"checked"}, NULL, false}, {{"unfit"}, NULL, false}}},
    {.caption = "What the advice takes",
     .with = BB_SET(BB_QUESTION),
     .without = OF_CONTENDERS,
     .rows = BB_SET(BB_QUESTION),
     .columns = {{{"seconds"}, NULL, false},
                 {{"host_bytes"}, NULL, false},
                 {{"device_bytes"}, NULL, false},
                 {{"held_bytes"}, NULL, false}}},
    {.caption = "",
     .question = "again",
     .without = BB_SET(BB_MAKER),
     .columns = {{{"again"}, NULL, false}}},
    SIMULATED(BB_BY_SIMULATION, "simt_ratio", "The least by simulation"),
    SIMULATED("kernels, simulated", "simt_image_ms", "Scouts: kernels on a tree, simulated"),
    SIMULATED("builders, simulated", "simt_image_ms", "Scouts: builders by one kernel, simulated"),
    {.caption = "Simulated again by",
     .question = "again",
     .with = BB_SET(BB_MAKER),
     .each = BB_SET(BB_MAKER),
     .columns = {{{"again"}, "", false}}},
};

/* ---- sentences ---- */

static bool is(const bb_table *table, uint32_t row, const char *scene, const char *question)
{
    return strcmp(bb_table_name(table, row, BB_SCENE), scene) == 0 &&
           strcmp(bb_table_name(table, row, BB_QUESTION), question) == 0;
}

static bool has_fate(const bb_table *table, uint32_t row, uint32_t fate)
{
    return strcmp(bb_table_get_text(table, row, "state"), bb_fates[fate]) == 0;
}

/* Says how many rays are wrong, and whether the judged rays are enough to show the limit. No number
 * of rays shows a limit of 0. */
static void say_wrong(const bb_table *table, uint32_t choice, double limit, bb_page *page)
{
    char count[BB_FIGURE_MAX], judged[BB_FIGURE_MAX], most[BB_FIGURE_MAX];
    const double wrong = bb_table_get_number(table, choice, "wrong");
    bb_page_say(page, "%s wrong of %s judged rays, %s %s per million (95 %%).",
                wrong > 0 ? bb_figure(count, wrong, 0) : "none",
                bb_figure(judged, bb_table_get_number(table, choice, "checked"), 0),
                wrong > 0 ? "at most" : "below",
                bb_figure(most, bb_table_get_number(table, choice, "wrong_ppm_at_most"), -1));
    if (limit > 0 && strcmp(bb_table_get_text(table, choice, "limit_shown"), "no") == 0)
        bb_page_say(page,
                    "These rays do not show that it is within %s per million: that takes %s judged "
                    "rays if none is wrong, more if some are (--max-rays).",
                    bb_figure(most, limit, -1), bb_figure(judged, ceil(3e6 / limit), 0));
}

static void say_choice(const bb_table *table, const char *scene, uint32_t choice, bb_page *page)
{
    const uint32_t row = bb_table_find(table, (bb_cell){{[BB_SCENE] = scene}});
    const char *by = bb_table_get_text(table, row, "preliminary");
    if (choice == BB_NO_ROW) {
        bb_page_verdict(page, false, "Nothing that was tried is right often enough.");
        return;
    }
    bb_page_verdict(page, by[0] == '\0', "%s%s: %s, %s",
                    by[0] == '\0' ? "The least that does it in the time of the fastest, or 5 % more"
                                  : "PRELIMINARY: interrupted; the best so far, by ",
                    by, bb_table_name(table, choice, BB_BUILDER),
                    bb_table_name(table, choice, BB_INTERSECTOR));
    say_wrong(table, choice, bb_table_get_number(table, row, "max_wrong_ppm"), page);
}

/* Says "race: 6 configurations: 1 chosen, 5 too slow." */
static void say_list(const bb_table *table, const char *scene, const char *question, bb_page *page)
{
    char text[400] = "";
    uint32_t all = 0;
    for (uint32_t fate = 0; fate < BB_FATES; fate++) {
        uint32_t count = 0;
        for (uint32_t row = 0; row < bb_table_row_count(table); row++)
            count += is(table, row, scene, question) && has_fate(table, row, fate);
        if (count > 0)
            snprintf(text + strlen(text), sizeof text - strlen(text), "%s %u %s",
                     all > 0 ? "," : "", count, bb_fates[fate]);
        all += count;
    }
    if (all > 0)
        bb_page_say(page, "%s: %u configurations:%s.", question, all, text);
}

/* Says the least by each simulation. */
static void say_simulated(const bb_table *table, const char *scene, bb_page *page)
{
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        if (is(table, row, scene, BB_BY_SIMULATION) && has_fate(table, row, BB_CHOSEN))
            bb_page_say(page,
                        "Simulated: neither measured nor validated, %s: the least is %s, %s, "
                        "bound by %s.",
                        bb_table_name(table, row, BB_MAKER), bb_table_name(table, row, BB_BUILDER),
                        bb_table_name(table, row, BB_INTERSECTOR),
                        bb_table_get_text(table, row, "simt_binds"));
}

static void say(const bb_table *table, const char *scene, bb_page *page)
{
    uint32_t choice = BB_NO_ROW;
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        if (is(table, row, scene, "race") && has_fate(table, row, BB_CHOSEN))
            choice = row;
    say_choice(table, scene, choice, page);
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++)
        if (views[i].order != NULL && views[i].each == 0)
            say_list(table, scene, views[i].question, page);
    say_simulated(table, scene, page);
}

#define OUTLINE                                                                                    \
    .command = "advise", .title = "bvhbench: the least that a scene needs", .views = views,        \
    .view_count = sizeof views / sizeof views[0], .say = say

const bb_page_outline bb_advise_outline = {
    OUTLINE,
    .note =
        "image: boxes, build, transfer, layout and all rays, medians of the rounds. ratio: to the "
        "time of the fastest, or of who dropped it, paired round by round (95 %). more than "
        "needed: as fast as that, and not the least. slower: by more than 5 % in the last heat. "
        "too slow: dropped on the way, for it was slower by more than the slack. Bytes are those "
        "of tree, scratch and layout. Figures of scouts on a sample are as many times more as the "
        "scene has primitives. What exactness costs is what the choice takes more.",
};

const bb_page_outline bb_advise_outline_briefly = {OUTLINE, .most = 8};
