/* References that trace one tree of Embree by different queries: what they have of the one that
 * builds it, if Embree lacks a query, a build fails or the run is interrupted (tests/embree). */
#include "tests/program_fixture.h"

#define LACKING(variables) variables " LD_PRELOAD=" BB_TEST_LACKING
#define REFERENCE(quality) "embree-native:mode=fast,quality=" quality
#define REFERENCES(quality)                                                                        \
    REFERENCE(quality) ",query=packet8," REFERENCE(quality) ",query=packet4," REFERENCE(quality)

enum { QUERIES = 3 };

static const char *const suffixes[QUERIES] = {",query=packet8", ",query=packet4", ""};

/* The build of the reference with one of the queries; NULL: there is none. */
static const cJSON *reference(const cJSON *results, const char *suffix)
{
    const cJSON *build;
    cJSON_ArrayForEach(build, cJSON_GetObjectItem(results, "builds"))
    {
        const char *builder = cJSON_GetStringValue(cJSON_GetObjectItem(build, "builder"));
        const char *query = strstr(builder, ",query=");
        if (strncmp(builder, "embree-native", 13) == 0 &&
            strcmp(query != NULL ? query : "", suffix) == 0)
            return build;
    }
    return NULL;
}

static const char *text(const cJSON *build, const char *name)
{
    const char *value = cJSON_GetStringValue(cJSON_GetObjectItem(build, name));
    return value != NULL ? value : "";
}

static cJSON *results_of(const char *before, const char *references, int exit_status)
{
    char command[512];
    snprintf(command, sizeof command,
             "run --scene cube --builder lbvh,%s --kernel stack --rays primary --size 16x16 "
             "--repeats 3 --seed 1 --no-pictures --charts no --out out",
             references);
    const outcome *o = run_with(before, command);
    if (o->exit_status != exit_status)
        fail_msg("%s: exit %d: %s", before, o->exit_status, o->err);
    return read_results("out/results.json");
}

/* All have the times of the one that builds. */
static void expect_same_times(const cJSON *results, int first)
{
    const cJSON *times = cJSON_GetObjectItem(reference(results, suffixes[first]), "build_ms");
    assert_true(times != NULL && !cJSON_IsNull(times));
    for (int i = first + 1; i < QUERIES; i++)
        assert_true(cJSON_Compare(
            times, cJSON_GetObjectItem(reference(results, suffixes[i]), "build_ms"), true));
}

static void a_query_that_is_lacking_is_lacking_alone(void **state)
{
    (void)state;
    cJSON *results = results_of(LACKING("LACKING_RAY8=1"), REFERENCES("low"), 0);
    assert_string_equal(text(reference(results, suffixes[0]), "status"), "unsupported");
    for (int i = 1; i < QUERIES; i++)
        assert_string_equal(text(reference(results, suffixes[i]), "status"), "ok");
    expect_same_times(results, 1);
    cJSON_Delete(results);
}

static void a_failed_build_is_that_of_all_who_share(void **state)
{
    (void)state;
    static const char *const failures[] = {LACKING("LACKING_FAILS=1"), LACKING("LACKING_FAILS=3"),
                                           LACKING("LACKING_FAILS=2 LACKING_RAY8=1")};
    for (size_t f = 0; f < sizeof failures / sizeof failures[0]; f++) {
        cJSON *results = results_of(failures[f], REFERENCES("low"), 1);
        for (int i = 0; i < QUERIES; i++) {
            const cJSON *build = reference(results, suffixes[i]);
            assert_string_equal(text(build, "status"), "failed");
            assert_non_null(strstr(text(build, "reason"), "made to fail"));
        }
        cJSON_Delete(results);
    }
}

static void expect_interrupted(const char *references)
{
    cJSON *results = results_of(LACKING("LACKING_INTERRUPTS=3"), references, 130);
    assert_true(
        cJSON_IsTrue(cJSON_GetObjectItem(cJSON_GetObjectItem(results, "context"), "interrupted")));
    for (int i = 0; i < QUERIES; i++)
        assert_string_equal(text(reference(results, suffixes[i]), "status"), "ok");
    expect_same_times(results, 0);
    cJSON_Delete(results);
}

static void an_interrupted_build_is_that_of_all_who_share(void **state)
{
    (void)state;
    expect_interrupted(REFERENCES("medium"));
}

/* Embree's builder for quality low crashed in one of three builds that were ended. */
static void a_build_that_embree_cannot_end_is_not_ended(void **state)
{
    (void)state;
    for (int run = 0; run < 8; run++)
        expect_interrupted(REFERENCES("low"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_query_that_is_lacking_is_lacking_alone),
        cmocka_unit_test(a_failed_build_is_that_of_all_who_share),
        cmocka_unit_test(an_interrupted_build_is_that_of_all_who_share),
        cmocka_unit_test(a_build_that_embree_cannot_end_is_not_ended),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
