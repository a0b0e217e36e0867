/* The terms that all builders share: a plug-in changes each of them, in each hook. The hook fails
 * by name, and everything is as it was before. */
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/builder/terms.h"
#include "tests/device_fixture.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

typedef struct term {
    const char *name, *words;
} term;

static const term terms[] = {
    {"rounding", "the rounding mode"},
#if defined(__SSE__)
    {"denormals", "how floats are computed (denormals, traps or precision)"},
    {"sse-rounding", "the rounding mode"},
    {"x87-rounding", "the rounding mode"},
    {"x87-precision", "how floats are computed (denormals, traps or precision)"},
#endif
    {"locale", "the locale"},
    {"thread-locale", "the thread's locale"},
    {"handler", "a signal's handler"},
    {"handler-restart", "a signal's handler"},
    {"handler-stack", "a signal's handler"},
    {"handler-children", "a signal's handler"},
    {"mask", "the signal mask"},
    {"limit", "a resource limit"},
    {"processors", "the processors to run on"},
    {"folder", "the working folder"},
    {"umask", "the umask"},
    {"alarm", "a timer"},
    {"virtual-timer", "a timer"},
    {"profile-timer", "a timer"},
    {"own-timers", "a timer"},
    {"no-input", "standard input, output or error"},
    {"error", "standard input, output or error"},
    {"environment", "the environment's variables"},
    {"variable", "the environment's variables"},
    {"variable-text", "the environment's variables"},
    {"variable-order", "the environment's variables"},
    {"no-variable", "the environment's variables"},
    {"no-variables", "the environment's variables"},
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

/* One processor alone cannot be chosen of one; not every kernel shows timers. */
static bool can_change(const term *t)
{
    if (strcmp(t->name, "own-timers") == 0)
        return access("/proc/self/timers", R_OK) == 0;
    cpu_set_t all;
    sched_getaffinity(0, sizeof all, &all);
    return strcmp(t->name, "processors") != 0 || CPU_COUNT(&all) > 1;
}

/* Entries of the environment, which are kept as they were before anything changed them: a variable
 * that someone put there is still the one that he can write to. */
static char *entries[4096];
static char put[] = "BVHBENCH_PUT=by the test";

static void note_entries(void)
{
    size_t i = 0;
    for (; environ[i] != NULL; i++)
        entries[i] = environ[i];
    assert_true(i > 1 && i < sizeof entries / sizeof entries[0]);
    entries[i] = NULL;
}

static void expect_entries(const char *after)
{
    for (size_t i = 0; entries[i] != NULL || environ[i] != NULL; i++)
        if (environ[i] != entries[i])
            fail_msg("%s: entry %zu of the environment is another one", after, i);
    if (strcmp(put, "BVHBENCH_PUT=by the test") != 0)
        fail_msg("%s: '%s'", after, put);
}

static void a_change_fails_its_hook_and_is_put_back(void **state)
{
    (void)state;
    ASSERT_OK(go_through("rogue"));
    for (size_t t = 0; t < sizeof terms / sizeof terms[0]; t++)
        for (size_t h = 0; h < sizeof hooks / sizeof hooks[0]; h++) {
            char text[128], words[128];
            bb_terms before;
            if (!can_change(&terms[t]))
                continue;
            snprintf(text, sizeof text, "rogue:term=%s,at=%s", terms[t].name, hooks[h]);
            snprintf(words, sizeof words, "rogue changed %s in %s()", terms[t].words, hooks[h]);
            bb_terms_take(&before);
            if (go_through(text) != BB_FAILED)
                fail_msg("%s: nothing was found", text);
            if (strncmp(bb_message(), words, strlen(words)) != 0)
                fail_msg("%s: %s", text, bb_message());
            if (bb_terms_check(&before, text, hooks[h], BB_OK) != BB_OK)
                fail_msg("not put back: %s", bb_message());
            expect_entries(text);
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
        expect_entries(text);
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

/* ---- a builder whose build() fails, and whose destroy() does not leave it at that ---- */

static struct {
    uint32_t now, taken, read; /* calls that are counted: when terms and the input were looked at */
    bool right;                /* in that order, when build() was called */
} calls;

mode_t umask(mode_t mask)
{
    calls.taken = ++calls.now;
    return (mode_t)syscall(SYS_umask, mask);
}

void *clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                         cl_map_flags flags, size_t offset, size_t size, cl_uint count,
                         const cl_event *waits, cl_event *event, cl_int *error)
{
    __typeof__(&clEnqueueMapBuffer) real;
    *(void **)&real = dlsym(RTLD_NEXT, "clEnqueueMapBuffer");
    calls.read = ++calls.now;
    return real(queue, buffer, blocking, flags, offset, size, count, waits, event, error);
}

static bb_status create_late(const bb_builder_context *context, void **self)
{
    (void)context;
    *self = &calls;
    return BB_OK;
}

static bb_status build_late(void *self, const bb_scene *part, const bb_tree *input, bb_tree *tree,
                            bb_phases *phases)
{
    (void)self, (void)part, (void)input, (void)tree, (void)phases;
    calls.right = calls.taken < calls.read;
    return bb_fail(BB_REFUSED, "late: no room for nodes");
}

static void destroy_late(void *self)
{
    (void)self;
    umask(0);
    (void)bb_fail(BB_FAILED, "late: nothing is to be destroyed");
}

static const bb_builder late = {.abi_version = BB_ABI_VERSION,
                                .name = "late",
                                .summary = "fails in build()",
                                .paper = "none",
                                .kinds = BB_ALL_KINDS,
                                .inputs = BB_INPUT_BOXES,
                                .create = create_late,
                                .build = build_late,
                                .destroy = destroy_late};

static void destroy_leaves_the_message(void **state)
{
    (void)state;
    const mode_t before = umask(027);
    assert_int_equal(go_through("late"), BB_REFUSED);
    assert_string_equal(bb_message(), "late: no room for nodes");
    assert_int_equal(umask(before), 027);
}

/* To take the terms is to read and write memory, which the input then would have to share the
 * caches with. Only a CPU's buffers are read. */
static void the_input_is_read_after_the_terms_were_taken(void **state)
{
    (void)state;
    if (!device->is_cpu)
        skip();
    ASSERT_OK(bb_scene_upload(scene, device));
    calls.read = calls.taken = 0;
    assert_int_equal(go_through("late"), BB_REFUSED);
    assert_true(calls.read > 0 && calls.taken > 0);
    assert_true(calls.right);
}

static void handle(int signal_number)
{
    (void)signal_number;
}

static int begin(void **state)
{
    signal(SIGUSR1, handle);        /* whose flags are changed */
    setenv("LC_ALL", "C.UTF-8", 1); /* what setlocale(LC_ALL, "") sets */
    if (open_device(state) != 0 || bb_plugin_load(BB_TEST_PLUGIN_DIR "/rogue.so") != BB_OK)
        return -1;
    static const bb_registration registration = {BB_PLUGIN_MAGIC, BB_ABI_VERSION,
                                                 sizeof registration, &late, NULL};
    ASSERT_OK(bb_builder_add(&registration));
    ASSERT_OK(bb_scene_load("cube", &scene));
    assert_int_equal(putenv(put), 0);
    note_entries();
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
        cmocka_unit_test(destroy_leaves_the_message),
        cmocka_unit_test(the_input_is_read_after_the_terms_were_taken),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
