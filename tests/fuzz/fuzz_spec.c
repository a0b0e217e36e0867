/* Specifications, their stages, and lists of them: what was parsed, put together again, is parsed
 * to the same. */
#include "framework/base/options.h"
#include "tests/fuzz/fuzz.h"

enum { STAGES = 6, ITEMS = 16 };

static bool is_same(const bb_spec *a, const bb_spec *b)
{
    if (strcmp(a->name, b->name) != 0 || a->param_count != b->param_count)
        return false;
    for (uint32_t i = 0; i < a->param_count; i++)
        if (strcmp(a->keys[i], b->keys[i]) != 0 || strcmp(a->values[i], b->values[i]) != 0)
            return false;
    return true;
}

static void write_spec(const bb_spec *spec, char *text, size_t room)
{
    size_t used = (size_t)snprintf(text, room, "%s", spec->name);
    for (uint32_t i = 0; i < spec->param_count; i++)
        used += (size_t)snprintf(text + used, room - used, "%c%s=%s", i == 0 ? ':' : ',',
                                 spec->keys[i], spec->values[i]);
    FUZZ_CHECK(used < room);
}

/* Each typed value is in its range, or refused. */
static void check_values(const bb_spec *spec)
{
    for (uint32_t i = 0; i < spec->param_count; i++) {
        uint64_t whole = 0;
        double real = 0;
        bb_status status = bb_spec_u64(spec, NULL, spec->keys[i], 3, 1000, &whole);
        if (status != BB_OK)
            fuzz_refused(status);
        FUZZ_CHECK(status != BB_OK || (whole >= 3 && whole <= 1000));
        status = bb_spec_double(spec, NULL, spec->keys[i], -1, 1, &real);
        if (status != BB_OK)
            fuzz_refused(status);
        FUZZ_CHECK(status != BB_OK || (real >= -1 && real <= 1));
        FUZZ_CHECK(bb_spec_is(spec, NULL, spec->keys[i], spec->values[i]));
    }
}

static void check_spec(const char *text)
{
    static const bb_option options[] = {
        {"bits", "30", "30|63", "bits"}, {"n", NULL, NULL, "number"}, {.name = NULL}};
    char written[1024];
    bb_spec spec, again;
    bb_status status = bb_spec_parse(text, &spec);
    if (status != BB_OK) {
        fuzz_refused(status);
        return;
    }
    FUZZ_CHECK(strcmp(spec.text, text) == 0);
    FUZZ_CHECK(spec.name[0] != '\0' && spec.param_count <= BB_PARAMS_MAX);
    write_spec(&spec, written, sizeof written);
    FUZZ_CHECK(bb_spec_parse(written, &again) == BB_OK && is_same(&spec, &again));
    check_values(&spec);
    status = bb_spec_validate(&spec, options, "builder x");
    if (status != BB_OK)
        fuzz_refused(status);
}

static void check_stages(const char *text)
{
    bb_spec stages[STAGES], again;
    uint32_t count = 0;
    bb_status status = bb_spec_stages(text, stages, STAGES, &count);
    if (status != BB_OK) {
        fuzz_refused(status);
        return;
    }
    FUZZ_CHECK(count > 0 && count <= STAGES);
    for (uint32_t i = 0; i < count; i++)
        FUZZ_CHECK(bb_spec_parse(stages[i].text, &again) == BB_OK && is_same(&stages[i], &again));
}

/* A list is as long as its items are. */
static void check_list(const char *text)
{
    char *items[ITEMS];
    size_t count = 0, length = 0;
    bb_status status = bb_spec_list(text, items, ITEMS, &count);
    if (status != BB_OK)
        fuzz_refused(status);
    FUZZ_CHECK(count <= ITEMS);
    for (size_t i = 0; i < count; i++) {
        FUZZ_CHECK(items[i][0] != '\0');
        length += strlen(items[i]) + (i > 0);
        free(items[i]);
    }
    FUZZ_CHECK(status != BB_OK || length == strlen(text));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_text(data, size);
    check_spec(text);
    check_stages(text);
    check_list(text);
    free(text);
    return 0;
}
