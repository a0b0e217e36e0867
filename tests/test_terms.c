/* The terms that all builders share: a plug-in changes each of them, in each hook. The hook fails
 * by name, and everything is as it was before. */
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/builder/terms.h"
#include "tests/device_fixture.h"

#include <stdio.h>
#include <string.h>

typedef struct term {
    const char *name, *words;
} term;

static const term terms[] = {
    {"rounding", "the rounding mode"},
#if defined(__SSE__)
    {"denormals", "how floats are computed"},
#endif
    {"locale", "the locale"},
    {"handler", "a signal's handler"},
    {"mask", "the signal mask"},
    {"limit", "a resource limit"},
    {"processors", "the processors to run on"},
    {"folder", "the working folder"},
    {"umask", "the umask"},
    {"environment", "the environment's variables"},
};

static const char *const hooks[] = {"create", "prepare", "restore", "build", "describe", "decide"};

static bb_scene *scene;

/* Creates, builds, describes, says what it decided. */
static bb_status go_through(const char *text)
{
    bb_instance instance;
    bb_decisions decisions;
    char words[512];
    bb_status status = bb_instance_create(device, text, scene, seed, &instance);
    if (status == BB_OK)
        status = bb_instance_build(&instance, scene, false, NULL);
    if (status == BB_OK)
        status = bb_instance_describe(&instance, scene, words, sizeof words);
    if (status == BB_OK)
        status = bb_instance_decisions(&instance, scene, &decisions);
    bb_instance_destroy(&instance);
    return status;
}

/* One processor alone cannot be chosen of one. */
static bool can_change(const term *t)
{
    cpu_set_t all;
    sched_getaffinity(0, sizeof all, &all);
    return strcmp(t->name, "processors") != 0 || CPU_COUNT(&all) > 1;
}

static void a_change_fails_its_hook_and_is_put_back(void **state)
{
    (void)state;
    ASSERT_OK(go_through("rogue"));
    for (size_t t = 0; t < sizeof terms / sizeof terms[0]; t++)
        for (size_t h = 0; h < sizeof hooks / sizeof hooks[0]; h++) {
            char text[128], hook[32];
            bb_terms before;
            if (!can_change(&terms[t]))
                continue;
            snprintf(text, sizeof text, "rogue:term=%s,at=%s", terms[t].name, hooks[h]);
            snprintf(hook, sizeof hook, " in %s()", hooks[h]);
            bb_terms_take(&before);
            if (go_through(text) != BB_FAILED)
                fail_msg("%s: nothing was found", text);
            if (strncmp(bb_message(), "rogue changed ", 14) != 0 ||
                strstr(bb_message(), terms[t].words) == NULL || strstr(bb_message(), hook) == NULL)
                fail_msg("%s: %s", text, bb_message());
            if (bb_terms_check(&before, text, hooks[h], BB_OK) != BB_OK)
                fail_msg("not put back: %s", bb_message());
        }
}

static void what_destroy_changes_is_put_back(void **state)
{
    (void)state;
    for (size_t t = 0; t < sizeof terms / sizeof terms[0]; t++) {
        char text[128];
        bb_terms before;
        snprintf(text, sizeof text, "rogue:term=%s,at=destroy", terms[t].name);
        bb_terms_take(&before);
        ASSERT_OK(go_through(text));
        ASSERT_OK(bb_terms_check(&before, text, "destroy", BB_OK));
    }
}

/* The message of a hook that failed stays, and what it changed is added. */
static void a_failure_is_not_hidden(void **state)
{
    (void)state;
    bb_terms before;
    bb_terms_take(&before);
    fesetround(FE_DOWNWARD);
    assert_int_equal(bb_terms_check(&before, "it", "build", bb_fail(BB_REFUSED, "no memory")),
                     BB_FAILED);
    assert_non_null(strstr(bb_message(), "no memory; and it changed the rounding mode in build()"));
    assert_int_equal(fegetround(), FE_TONEAREST);
}

static int begin(void **state)
{
    setenv("LC_ALL", "C.UTF-8", 1); /* what setlocale(LC_ALL, "") sets */
    if (open_device(state) != 0 || bb_plugin_load(BB_TEST_PLUGIN_DIR "/rogue.so") != BB_OK)
        return -1;
    ASSERT_OK(bb_scene_load("cube", &scene));
    return 0;
}

static int end(void **state)
{
    bb_scene_free(scene);
    return close_device(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_change_fails_its_hook_and_is_put_back),
        cmocka_unit_test(what_destroy_changes_is_put_back),
        cmocka_unit_test(a_failure_is_not_hidden),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
