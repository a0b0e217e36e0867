/* Claims of papers, judged by figures. */
#include "framework/papers/reproduce.h"

#include <assert.h>
#include <math.h>

/* A claim at work: what it is said of, and what its tests say. */
typedef struct trial {
    const bb_paper_claim *claim;
    bb_paper_place at;
    bb_claim_verdict verdict;
    bb_words *claimed; /* beside what was measured */
} trial;

static bool is_meant(const bb_paper_claim *claim, uint32_t row)
{
    return claim->which == 0 || (claim->which >> row & 1) != 0;
}

static void add_element(bb_paper_series *s, bb_paper_place at, const bb_figure *figure)
{
    bool timed;
    assert(s->count < BB_SERIES_MAX);
    s->places[s->count] = at;
    s->each[s->count++] = bb_figure_at(at, figure, &timed);
    s->timed = s->timed || timed;
}

/* What stands for scenes: those of a figure, or the rows of a claim on all of them together. */
static bb_paper_series elements_of(const trial *t, const bb_figure *figure)
{
    const bb_paper_claim *claim = t->claim;
    const bb_findings *f = &t->at.all[figure->of];
    bb_paper_series s = {.count = 0, .mean = bb_not_measured};
    bb_paper_place at = t->at;
    if (!claim->together)
        return bb_figure_series(at, figure);
    for (uint32_t i = 0; claim->rows[i].name != NULL; i++) {
        at.row = &claim->rows[i];
        if (is_meant(claim, i) && !claim->of_scenes)
            add_element(&s, at, figure);
        for (size_t k = 0; k < f->scene_count && is_meant(claim, i) && claim->of_scenes; k++) {
            at.scene = f->scenes[k];
            add_element(&s, at, figure);
        }
    }
    return s;
}

/* ---- tests ---- */

static double bound_of(const trial *t, const bb_test *test, bb_paper_place at)
{
    at.scene = NULL;
    return test->than == 0 ? test->bound : bb_value_at(at, t->claim->figures[test->than - 1]);
}

/* What is claimed of element i; 0: no size. */
static double claimed_of(const bb_test *test, size_t i)
{
    return test->paper != NULL ? test->paper[i].numbers[test->number] : test->claimed;
}

static bb_claim_verdict test_at(const trial *t, const bb_test *test, bb_paper_place at, size_t i,
                                bb_estimate e, bool timed)
{
    return bb_verdict_at(e, timed && !test->untimed, test->side, bound_of(t, test, at),
                         claimed_of(test, i));
}

/* The same, and says what was claimed. */
static bb_claim_verdict judge_at(const trial *t, const bb_test *test, bb_paper_place at, size_t i,
                                 bb_estimate e, bool timed)
{
    const char *where = t->claim->together && at.row != NULL && !t->claim->of_scenes ? at.row->name
                        : at.scene != NULL                                           ? at.scene
                                                                                     : "";
    if (claimed_of(test, i) != 0)
        bb_say_claimed(t->claimed, where, claimed_of(test, i), e);
    return test_at(t, test, at, i, e, timed);
}

static bb_claim_verdict test_each(const trial *t, const bb_test *test, const bb_paper_series *s)
{
    bb_claim_verdict each[BB_SERIES_MAX];
    for (size_t i = 0; i < s->count; i++)
        each[i] = judge_at(t, test, s->places[i], i, s->each[i], s->timed);
    return test->over == BB_EACH ? bb_all(each, s->count) : bb_most(each, s->count);
}

static bb_claim_verdict test_more(const bb_test *test, const bb_paper_series *s)
{
    uint32_t lower = 0, higher = 0;
    for (size_t i = 0; i < s->count; i++) {
        lower += s->each[i].value < test->bound;
        higher += s->each[i].value > 2 - test->bound;
    }
    return isnan(bb_series_mean(s)) ? BB_NOT_TESTED : lower > higher ? BB_HELD : BB_NOT_HELD;
}

static bb_claim_verdict run_test(const trial *t, const bb_test *test)
{
    const bb_paper_series s = elements_of(t, t->claim->figures[test->figure]);
    if (test->over == BB_EACH || test->over == BB_MOST_OF)
        return test_each(t, test, &s);
    if (test->over == BB_MORE)
        return test_more(test, &s);
    return judge_at(t, test, t->at, 0, s.mean, s.timed);
}

static uint32_t count_of(const bb_paper_claim *claim)
{
    uint32_t count = 0;
    while (count < BB_CLAIM_TESTS && claim->tests[count].side != BB_NO_SIDE)
        count++;
    return count;
}

static bb_claim_verdict run_tests(const trial *t)
{
    bb_claim_verdict each[BB_CLAIM_TESTS];
    const uint32_t count = count_of(t->claim);
    if (t->at.all[t->claim->figures[0]->of].scene_count < t->claim->scenes)
        return BB_NOT_TESTED;
    for (uint32_t i = 0; i < count; i++)
        each[i] = run_test(t, &t->claim->tests[i]);
    return bb_all(each, count);
}

/* ---- words ---- */

/* Whether the test holds there; a claim's own figure if `at` has no scene. */
static bool holds_at(const trial *t, const bb_test *test, bb_paper_place at, size_t i)
{
    bool timed;
    const bb_estimate e = bb_figure_at(at, t->claim->figures[test->figure], &timed);
    return test_at(t, test, at, i, e, timed) == BB_HELD;
}

/* Nothing, or what is asked of the place. */
static bool is_to_say(const trial *t, const bb_saying *saying, bb_paper_place at, size_t i)
{
    const bb_test *tests = t->claim->tests;
    bool all = true;
    for (uint32_t k = 0; saying->unless && k < count_of(t->claim); k++)
        all = all && holds_at(t, &tests[k], at, i);
    if ((saying->unless && all) ||
        (saying->unless_test > 0 && holds_at(t, &tests[saying->unless_test - 1], at, i)))
        return false;
    return saying->when == NULL || holds_at(t, saying->when, at, i);
}

static void say_one(const trial *t, const bb_saying *saying, bb_paper_place at, size_t i,
                    bb_words *words)
{
    if (!is_to_say(t, saying, at, i))
        return;
    const char *before = saying->before != NULL ? saying->before : "; ";
    const char *first = saying->first != NULL ? saying->first : "";
    bb_say(words, "%s", words->length > 0 ? before : first);
    bb_say_text(words, saying->text, at, t->claim->figures);
    if (saying->also != NULL && holds_at(t, saying->also_when, at, i))
        bb_say_text(words, saying->also, at, t->claim->figures);
}

static void say(const trial *t, const bb_saying *sayings, bool why, bb_words *words)
{
    for (const bb_saying *s = sayings; s->text != NULL; s++) {
        if (why && !s->always && t->verdict == BB_HELD)
            continue;
        if (!s->each) {
            say_one(t, s, t->at, 0, words);
            continue;
        }
        const bb_paper_series elements = elements_of(t, t->claim->figures[s->of]);
        for (size_t i = 0; i < elements.count; i++)
            say_one(t, s, elements.places[i], i, words);
    }
}

/* ---- claims ---- */

/* Whether a test of the claim is on a time that can be simulated. */
static bool can_be_simulated(const bb_paper_claim *claim)
{
    char columns[256];
    bool can = false;
    for (uint32_t i = 0; i < count_of(claim); i++) {
        const bb_figure *figure = claim->figures[claim->tests[i].figure];
        can = can || bb_simulated_columns(figure->what, 0, columns) ||
              (figure->per != NULL && bb_simulated_columns(figure->per, 0, columns));
    }
    return can;
}

/* Judges the claim by what was measured, or by a simulation, if it has what the claim is about. */
static void add_claim(const bb_paper_claim *claim, bb_paper_place at, bb_reproduction *r)
{
    bb_words text = {0};
    bb_said said = {.verdict = BB_NOT_TESTED};
    trial t = {claim, at, BB_NOT_TESTED, &said.claimed};
    if (claim->figures[0] != NULL)
        said.verdict = t.verdict = run_tests(&t);
    if (at.simulated > 0 && said.verdict == BB_NOT_TESTED)
        return;
    if (at.row == NULL || !bb_say_missing(at.row->builder, &said.why)) {
        say(&t, claim->ours, false, &said.ours);
        say(&t, claim->why, true, &said.why);
    }
    if (claim->judge != NULL && at.simulated == 0)
        claim->judge(at, &said);
    bb_say_text(&text, claim->text, at, claim->figures);
    bb_claim(r, text.text, claim->paper, at.simulated, &said);
}

void bb_paper_add_claims(const bb_paper_claim *claims, const bb_findings *all, uint32_t simulated,
                         bb_reproduction *r)
{
    for (const bb_paper_claim *claim = claims; claim != NULL && claim->text != NULL; claim++) {
        bb_paper_place at = {.all = &all[claim->of], .view = -1, .simulated = simulated};
        if (simulated > 0 && !can_be_simulated(claim))
            continue;
        if (claim->rows == NULL || claim->together)
            add_claim(claim, at, r);
        for (uint32_t i = 0; claim->rows != NULL && !claim->together; i++) {
            at.row = &claim->rows[i];
            if (at.row->name == NULL)
                break;
            if (is_meant(claim, i))
                add_claim(claim, at, r);
        }
    }
}
