/* Plug-ins: what bb_plugin_load() takes, and what it says of what it does not take. The example of
 * tests/plugin/median is loaded and builds; the shared objects of tests/plugin/broken are refused,
 * each with one clear line. */
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "tests/device_fixture.h"
#include "tests/tree_fixture.h"

#include <elf.h>
#include <stddef.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *path_of(const char *name)
{
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", BB_TEST_PLUGIN_DIR, name);
    return path;
}

static void expect_refusal(const char *path, const char *part)
{
    uint32_t before = bb_builder_count();
    assert_int_equal(bb_plugin_load(path), BB_INVALID);
    if (strstr(bb_message(), part) == NULL || strstr(bb_message(), path) == NULL)
        fail_msg("expected '%s' in '%s'", part, bb_message());
    assert_null(strchr(bb_message(), '\n'));
    assert_int_equal(bb_builder_count(), before);
}

static void test_refusals(void **state)
{
    (void)state;
    expect_refusal(path_of("absent.so"), "No such file");
    expect_refusal(BB_TEST_PLUGIN_DIR, "is no file");
    expect_refusal(BB_TEST_SOURCE_DIR "/CMakeLists.txt", "not a shared object");
    expect_refusal(path_of("none.so"), "is not a bvhbench builder");
    expect_refusal(path_of("foreign.so"), "its bb_plugin is no builder or tracer of this bvhbench");
    char words[64];
    snprintf(words, sizeof words, "ABI version 999, this bvhbench has %d", BB_ABI_VERSION);
    expect_refusal(path_of("abi.so"), words);
    expect_refusal(path_of("size.so"), "has 8 bytes, this bvhbench's 32");
    expect_refusal(path_of("empty.so"), "has no builder");
    expect_refusal(path_of("invalid.so"), "builder invalid: build() is missing");
    expect_refusal(path_of("taken.so"), "there is a builder sah already");
    expect_refusal(path_of("file.so"), "there is a device file lanes.clh already");
}

static void test_constructor(void **state)
{
    (void)state;
    const mode_t before = umask(027);
    expect_refusal(path_of("constructor.so"), "changed the umask in dlopen()");
    assert_non_null(strstr(bb_message(), "its constructors do so"));
    assert_null(bb_builder_find("constructor"));
    assert_int_equal(umask(before), 027);
}

/* A truncated shared object is refused before the loader maps what is not there. */
static void test_truncated(void **state)
{
    (void)state;
    FILE *file = fopen(path_of("median.so"), "rb");
    assert_non_null(file);
    static char bytes[1 << 22];
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_in_range(size, 1000, sizeof bytes - 1);
    const size_t lengths[] = {0, 1, 16, 63, 64, 65, 300, 1000, size / 4, size / 2};
    char path[4096];
    snprintf(path, sizeof path, "%s", path_of("truncated.so"));
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(bytes, 1, lengths[i], file), lengths[i]);
        fclose(file);
        expect_refusal(path, "is truncated");
    }
    /* whole, but for another machine: its bits, its order of bytes, its kind */
    for (size_t i = 0; i < 3; i++) {
        const size_t places[] = {EI_CLASS, EI_DATA, offsetof(Elf64_Ehdr, e_machine)};
        bytes[places[i]] ^= 3;
        file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(bytes, 1, size, file), size);
        fclose(file);
        expect_refusal(path, "is for another machine (ELF class ");
        bytes[places[i]] ^= 3;
    }
    /* Headers that claim nonsense. */
    bb_random random = bb_random_make(5, 0);
    for (uint32_t run = 0; run < 300; run++) {
        char header[64];
        memcpy(header, bytes, sizeof header);
        header[16 + bb_random_below(&random, 48)] = (char)bb_random_u64(&random);
        file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(header, 1, sizeof header, file), sizeof header);
        fclose(file);
        assert_int_equal(bb_plugin_load(path), BB_INVALID);
    }
    unlink(path);
}

static void test_median_builds(void **state)
{
    (void)state;
    uint32_t before = bb_builder_count();
    assert_null(bb_builder_find("median"));
    ASSERT_OK(bb_plugin_load(path_of("median.so")));
    assert_int_equal(bb_builder_count(), before + 1);
    const bb_builder *median = bb_builder_find("median");
    assert_non_null(median);
    assert_ptr_equal(bb_builder_at(before), median);
    assert_null(bb_builder_at(before + 1));
    expect_refusal(path_of("median.so"), "there is a builder median already");
    assert_int_equal(chdir(BB_TEST_PLUGIN_DIR), 0); /* a name without a slash is a file too */
    expect_refusal("median.so", "there is a builder median already");

    ASSERT_OK(open_test_device(BB_FORM_AUTO, NULL, &device));
    bb_random random = bb_random_make(6, 0);
    for (uint32_t count = 1; count < 3000; count = count * 3 + 1) {
        bb_scene *scene = make_random_scene(count, &random);
        bb_account account = {0};
        size_t bytes = count * sizeof(bb_box);
        ASSERT_OK(bb_buffer_reserve(device, NULL, bytes, "boxes", &scene->on_device.boxes));
        ASSERT_OK(bb_buffer_write(&scene->on_device.boxes, 0, bytes, scene->boxes));
        bb_spec spec;
        ASSERT_OK(bb_spec_parse("median", &spec));
        bb_builder_context context = {.device = device, .account = &account, .spec = &spec};
        bb_phases phases = {.device = device, .exact = true, .current = -1};
        bb_tree tree;
        void *self = NULL;
        bb_tree_init(&tree, &account);
        ASSERT_OK(median->create(&context, &self));
        ASSERT_OK(median->prepare(self, scene, &tree));
        for (uint32_t run = 0; run < 2; run++) {
            ASSERT_OK(median->build(self, scene, NULL, &tree, &phases));
            ASSERT_OK(bb_tree_check(&tree, scene));
        }
        assert_int_equal(phases.count, 2);
        assert_true(phases.used_device);
        bb_tree_release(&tree);
        median->destroy(self);
        assert_int_equal(account.bytes, 0);
        bb_buffer_release(&scene->on_device.boxes);
        free_scene(scene);
    }
    bb_device_close(device);
}

/* ---- validation ---- */

static void expect_invalid(bb_builder builder, const char *part)
{
    assert_int_equal(bb_builder_validate(&builder), BB_INVALID);
    if (strstr(bb_message(), part) == NULL)
        fail_msg("expected '%s' in '%s'", part, bb_message());
}

static void expect_invalid_row(const char *role, const char *specs, const char *part)
{
    const bb_variants rows[] = {{BB_FOR_ALL, role, specs}, {0, NULL, NULL}};
    bb_builder changed = *bb_builder_find("sah");
    changed.variants = rows;
    expect_invalid(changed, part);
}

#define EXPECT_INVALID(member, value, part)                                                        \
    do {                                                                                           \
        bb_builder changed_ = *bb_builder_find("sah");                                             \
        changed_.member = (value);                                                                 \
        expect_invalid(changed_, (part));                                                          \
    } while (0)

static void test_validation(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < bb_builder_count(); i++)
        ASSERT_OK(bb_builder_validate(bb_builder_at(i)));
    EXPECT_INVALID(abi_version, 0, "ABI version 0");
    EXPECT_INVALID(name, NULL, "bad name");
    EXPECT_INVALID(name, "", "bad name");
    EXPECT_INVALID(name, "all", "bad name 'all'");
    EXPECT_INVALID(name, "Sah", "bad name 'Sah'");
    EXPECT_INVALID(name, "a:b", "bad name");
    EXPECT_INVALID(name, "../x", "bad name");
    EXPECT_INVALID(summary, NULL, "summary");
    EXPECT_INVALID(summary, "two\nlines", "summary");
    EXPECT_INVALID(paper, NULL, "paper");
    EXPECT_INVALID(kinds, 0, "kinds");
    EXPECT_INVALID(kinds, 1u << 30, "kinds");
    EXPECT_INVALID(inputs, 0, "inputs");
    EXPECT_INVALID(inputs, 1u << 30, "inputs");
    EXPECT_INVALID(place, (bb_place)7, "place");
    EXPECT_INVALID(create, NULL, "create()");
    EXPECT_INVALID(build, NULL, "build()");
    EXPECT_INVALID(destroy, NULL, "destroy()");

    expect_invalid_row(BB_ROLE_COMPARED, "sah,other", "another builder");
    expect_invalid_row(BB_ROLE_COMPARED, "sah:colour=red", "colour");
    expect_invalid_row(BB_ROLE_COMPARED, "sah:bins=", "builder sah:");
    expect_invalid_row(BB_ROLE_COST_REFERENCE, "other", "cost_reference holds 'other'");
    expect_invalid_row(BB_ROLE_COST_REFERENCE, "sah,sah:bins=8", "must be one variant");
    expect_invalid_row(BB_ROLE_COST_REFERENCE, "", "empty item");
    expect_invalid_row(BB_ROLE_GENEROUS, "sah,sah:bins=8", "must be one variant");
    expect_invalid_row(BB_ROLE_GENEROUS, "sah+rotate", "must be one variant");
    expect_invalid_row(BB_ROLE_MOVING, "gs,lbvh+refit", "moving holds 'gs'");
    expect_invalid_row(BB_ROLE_MOVING, ",,", "empty item");
    expect_invalid_row(BB_ROLE_STRESSED, "sah:colour=red", "colour");
    expect_invalid_row(BB_ROLE_VOLUMES, "sah,other", "volumes holds 'other'");
    expect_invalid_row(BB_ROLE_MESHES, "sah:colour=red", "colour");
    expect_invalid_row(BB_ROLE_MESHES_LONG, "other", "meshes_long holds 'other'");

    bb_builder usual = *bb_builder_find("lbvh");
    usual.inputs |= BB_INPUT_TREE;
    expect_invalid(usual, "usual, but no builder of all kinds");
    usual.inputs = BB_INPUT_GEOMETRY;
    expect_invalid(usual, "usual, but no builder of all kinds");
    usual.inputs = BB_INPUT_BOXES;
    usual.kinds = BB_TRIANGLES;
    expect_invalid(usual, "usual, but no builder of all kinds");
    usual.kinds = BB_ALL_KINDS;
    static const bb_variants usual_alone[] = {{BB_FOR_ALL, BB_ROLE_USUAL, "lbvh"}, {0, NULL, NULL}};
    usual.variants = usual_alone;
    expect_invalid(usual, "usual, but no builder of all kinds");
    expect_invalid_row(NULL, "sah", "has no role");
    expect_invalid_row(BB_ROLE_COMPARED, NULL, "has no variants");
    expect_invalid_row("compare", "sah", "unknown role 'compare'");
    static const bb_variants again[] = {{BB_FOR_ALL, BB_ROLE_COMPARED, "lbvh"},
                                        {BB_FOR_ALL, BB_ROLE_COMPARED, "lbvh:bits=63"},
                                        {0, NULL, NULL}};
    static const bb_variants gpus[] = {{BB_FOR_GPU, BB_ROLE_COMPARED, "lbvh"}, {0, NULL, NULL}};
    usual.variants = again;
    expect_invalid(usual, "the role compared twice");
    usual.variants = gpus;
    expect_invalid(usual, "not for all devices");
    expect_invalid_row(BB_ROLE_COMPARED, "", "empty item");
    EXPECT_INVALID(inputs, BB_INPUT_TREE, "yardstick, but it makes no tree by itself");

    static const bb_option no_help[] = {{"a", "1", NULL, NULL}, {.name = NULL}};
    static const bb_option twice[] = {{"a", "1", NULL, "x"}, {"a", "1", NULL, "x"}, {.name = NULL}};
    static const bb_option outside[] = {{"a", "ab", "abc|b", "x"}, {.name = NULL}};
    static const bb_option bad_name[] = {{"a=b", "1", NULL, "x"}, {.name = NULL}};
    EXPECT_INVALID(options, no_help, "option a has no help");
    EXPECT_INVALID(options, twice, "option a is declared twice");
    EXPECT_INVALID(options, outside, "default 'ab' of option a is not among abc|b");
    EXPECT_INVALID(options, bad_name, "bad name 'a=b'");
}

static void test_phases(void **state)
{
    (void)state;
    bb_phases phases = {.current = -1};
    const char *const names[] = {"a", "b", "a", "c", NULL, "b", NULL, NULL};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        ASSERT_OK(bb_phase(&phases, names[i]));
        usleep(1000);
    }
    assert_int_equal(phases.count, 3);
    assert_int_equal(phases.current, -1);
    assert_false(phases.used_device);
    assert_string_equal(phases.names[0], "a");
    assert_string_equal(phases.names[2], "c");
    assert_true(phases.ms[0] >= 2 && phases.ms[1] >= 2 && phases.ms[2] >= 1);
    assert_true(phases.ms[0] + phases.ms[1] + phases.ms[2] < 1000);
    static const char *const many[] = {"0", "1",  "2",  "3",  "4",  "5",  "6",  "7", "8",
                                       "9", "10", "11", "12", "13", "14", "15", "16"};
    phases = (bb_phases){.current = -1};
    for (size_t i = 0; i < BB_PHASES_MAX; i++)
        ASSERT_OK(bb_phase(&phases, many[i]));
    assert_int_equal(bb_phase(&phases, many[BB_PHASES_MAX]), BB_FAILED);
}

/* ---- a create() that fails half-way ---- */

static struct {
    uint32_t destroyed;
    bool set; /* create() sets *self before it fails */
} half;

static bb_status half_create(const bb_builder_context *context, void **self)
{
    (void)context;
    assert_null(*self);
    if (half.set)
        *self = &half;
    return bb_fail(BB_FAILED, "half-way");
}

static void half_destroy(void *self)
{
    assert_ptr_equal(self, &half);
    half.destroyed++;
}

static bb_status half_build(void *self, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                            bb_phases *phases)
{
    (void)self, (void)scene, (void)input, (void)tree, (void)phases;
    fail_msg("an object that was never made is asked to build");
    return BB_FAILED;
}

static void test_failed_create(void **state)
{
    (void)state;
    static const bb_builder builder = {.abi_version = BB_ABI_VERSION,
                                       .name = "half-made",
                                       .summary = "fails in create()",
                                       .paper = "none",
                                       .kinds = BB_ALL_KINDS,
                                       .inputs = BB_INPUT_BOXES,
                                       .create = half_create,
                                       .build = half_build,
                                       .destroy = half_destroy};
    static const bb_registration registration = {BB_PLUGIN_MAGIC, BB_ABI_VERSION,
                                                 sizeof registration, &builder, NULL};
    bb_instance instance;
    bb_random random = bb_random_make(7, 0);
    bb_scene *scene = make_random_scene(10, &random);
    ASSERT_OK(open_test_device(BB_FORM_AUTO, NULL, &device));
    ASSERT_OK(bb_builder_add(&registration));
    for (uint32_t set = 0; set < 2; set++) {
        half.set = set == 1;
        assert_int_equal(bb_instance_create(device, "half-made", scene, 1, &instance), BB_FAILED);
        assert_non_null(strstr(bb_message(), "half-way"));
        assert_int_equal(half.destroyed, set);
    }
    free_scene(scene);
    bb_device_close(device);
}

/* ---- what only one builder may be ---- */

static void expect_refused(const bb_builder *builder, const char *words)
{
    const bb_registration registration = {BB_PLUGIN_MAGIC, BB_ABI_VERSION, sizeof registration,
                                          builder, NULL};
    uint32_t before = bb_builder_count();
    assert_int_equal(bb_builder_add(&registration), BB_INVALID);
    if (strstr(bb_message(), words) == NULL)
        fail_msg("expected '%s' in '%s'", words, bb_message());
    assert_int_equal(bb_builder_count(), before);
}

static void test_sole(void **state)
{
    (void)state;
    bb_builder second = *bb_builder_find("lbvh");
    second.name = "second";
    static const bb_variants usual[] = {{BB_FOR_ALL, BB_ROLE_USUAL, "second"},
                                        {BB_FOR_ALL, BB_ROLE_COMPARED, "second"},
                                        {0, NULL, NULL}};
    static const bb_variants reference[] = {{BB_FOR_ALL, BB_ROLE_COST_REFERENCE, "second:bits=63"},
                                            {0, NULL, NULL}};
    second.variants = usual;
    expect_refused(&second, "builder second: `usual` is lbvh already");
    second.variants = reference;
    expect_refused(&second, "builder second: `cost_reference` is sah:method=sweep already");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refusals),      cmocka_unit_test(test_constructor),
        cmocka_unit_test(test_truncated),     cmocka_unit_test(test_median_builds),
        cmocka_unit_test(test_validation),    cmocka_unit_test(test_phases),
        cmocka_unit_test(test_failed_create), cmocka_unit_test(test_sole),
    };
    return cmocka_run_group_tests_name("plugin", tests, NULL, NULL);
}
