/* Keys of cells: there and back, whatever the names hold; one spelling for each cell. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "framework/base/random.h"
#include "framework/record/cell.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const uint64_t SEED = 11;

static const char plain[] =
    "scene=coffee/rays=primary/size=512x512/max-rays=1048576/seed=1/view=front/builder=lbvh/"
    "kernel=stack:leaf=4/intersector=exact";

static void parse(const char *key, bb_cell_parts *cell)
{
    if (bb_cell_key_parse(key, cell) != BB_OK)
        fail_msg("%s: %s", key, bb_message());
}

static void format(const bb_cell_parts *cell, char key[BB_CELL_KEY])
{
    if (bb_cell_key_format(cell, key) != BB_OK)
        fail_msg("%s", bb_message());
}

static void expect_canonical(const char *given, const char *expected)
{
    bb_cell_parts cell;
    char key[BB_CELL_KEY];
    parse(given, &cell);
    bb_cell_canonical(&cell);
    format(&cell, key);
    assert_string_equal(key, expected);
    bb_cell_canonical(&cell); /* once is enough */
    format(&cell, key);
    assert_string_equal(key, expected);
}

static void a_key_is_read_and_written(void **state)
{
    (void)state;
    bb_cell_parts cell;
    char key[BB_CELL_KEY];
    parse(plain, &cell);
    assert_string_equal(cell.scene, "coffee");
    assert_string_equal(cell.rays, "primary");
    assert_string_equal(cell.view, "front");
    assert_string_equal(cell.builder, "lbvh");
    assert_string_equal(cell.kernel, "stack:leaf=4");
    assert_string_equal(cell.intersector, "exact");
    assert_true(cell.width == 512 && cell.height == 512 && cell.max_rays == 1 << 20);
    assert_true(cell.seed == 1 && !cell.known_by_hash);
    format(&cell, key);
    assert_string_equal(key, plain);
    /* parts in another order, escapes that need not be, defaults left out */
    parse("builder=lbvh/kernel=stack:leaf%3d4/view=%66ront/scene=coffee/rays=primary", &cell);
    format(&cell, key);
    assert_string_equal(key, plain);
    /* a build alone; a reference; rays known by their hash */
    static const char *const others[] = {
        "scene=coffee/seed=18446744073709551615/builder=lbvh",
        "scene=coffee/rays=ao/size=1x65536/max-rays=7/seed=0/builder=embree-native:quality=high",
        "scene=coffee/rays=mine/rays-hash=00000000deadbeef/builder=other/kernel=outside/"
        "intersector=own"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        parse(others[i], &cell);
        format(&cell, key);
        assert_string_equal(key, others[i]);
    }
}

static void names_of_any_bytes_come_back(void **state)
{
    (void)state;
    static const char *const names[] = {
        "models/a b.glb", "100%",         "a=b,c:d+e", "a/builder=x",
        "\x01\x7f\xff",   "'\"$`\\;&|<>", "~",         "%2F"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        bb_cell_parts cell, back;
        char key[BB_CELL_KEY];
        parse(plain, &cell);
        memset(cell.scene, 0, sizeof cell.scene);
        memset(cell.view, 0, sizeof cell.view);
        strcpy(cell.scene, names[i]);
        strcpy(cell.view, names[i]);
        format(&cell, key);
        assert_int_equal(strspn(key,
                                "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
                                "._-:,=+%/"),
                         strlen(key));
        parse(key, &back);
        assert_memory_equal(&back, &cell, sizeof cell);
    }
}

static void random_text(bb_random *random, bool empty, char *text)
{
    static const char likely[] = "/=%:,+ 2Fa";
    uint32_t length = bb_random_below(random, 40) + !empty;
    memset(text, 0, BB_CELL_TEXT);
    for (uint32_t i = 0; i < length; i++)
        text[i] = bb_random_below(random, 2) == 0
                      ? likely[bb_random_below(random, sizeof likely - 1)]
                      : (char)(1 + bb_random_below(random, 255));
}

static void random_cells_come_back(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 20000; i++) {
        bb_random random = bb_random_make(SEED, i);
        bb_cell_parts cell = {.seed = bb_random_u64(&random)}, back;
        char key[BB_CELL_KEY], again[BB_CELL_KEY];
        random_text(&random, false, cell.scene);
        random_text(&random, false, cell.builder);
        if (bb_random_below(&random, 4) > 0) {
            random_text(&random, false, cell.rays);
            random_text(&random, true, cell.view);
            random_text(&random, false, cell.kernel);
            random_text(&random, false, cell.intersector);
            cell.width = 1 + bb_random_below(&random, 65536);
            cell.height = 1 + bb_random_below(&random, 65536);
            cell.max_rays = 1 + bb_random_below(&random, 1u << 30);
        }
        format(&cell, key);
        if (bb_cell_key_parse(key, &back) != BB_OK || memcmp(&cell, &back, sizeof cell) != 0)
            fail_msg("seed %llu, cell %u: %s: %s", (unsigned long long)SEED, i, key, bb_message());
        format(&back, again);
        assert_string_equal(key, again);
    }
}

/* Damaged keys are refused, or are keys of something; nothing reads beyond them. */
static void damaged_keys_do_no_harm(void **state)
{
    (void)state;
    uint32_t refused = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        bb_random random = bb_random_make(SEED + 1, i);
        bb_cell_parts cell, back;
        char text[sizeof plain], key[BB_CELL_KEY];
        memcpy(text, plain, sizeof plain);
        for (uint32_t k = 1 + bb_random_below(&random, 3); k > 0; k--)
            text[bb_random_below(&random, sizeof plain - 1)] =
                "/=%\n2zF\0x-"[bb_random_below(&random, 10)];
        if (bb_cell_key_parse(text, &cell) != BB_OK) {
            refused++;
            continue;
        }
        format(&cell, key);
        parse(key, &back);
        assert_memory_equal(&back, &cell, sizeof cell);
    }
    assert_in_range(refused, 5000, 19999);
}

/* Each stage is spelled out by itself. */
static void pipelines_have_one_spelling(void **state)
{
    (void)state;
    bb_cell_parts a, b;
    char key[2][BB_CELL_KEY];
    parse("scene=cube/builder=presplit+lbvh:bits=63+rotate", &a);
    parse("scene=cube/builder=presplit+lbvh:code=mc32,bits=63+rotate", &b);
    bb_cell_canonical(&a);
    format(&a, key[0]);
    bb_cell_canonical(&b);
    format(&b, key[1]);
    bb_cell_canonical(&b);
    assert_string_equal(a.builder, b.builder);
    assert_non_null(strstr(a.builder, "+lbvh:"));
    assert_non_null(strstr(a.builder, "bits=63"));
    assert_non_null(strstr(a.builder, "+rotate:"));
    assert_string_equal(key[0], key[1]);
    bb_cell_short(&b);
    assert_string_equal(b.builder, "presplit+lbvh:bits=63+rotate");
}

static void what_is_no_key_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *key, *words;
    } cases[] = {
        {"", "its parts are scene="},
        {"coffee", "its parts are scene="},
        {"scene=coffee", "no scene, or no builder"},
        {"builder=lbvh", "no scene, or no builder"},
        {"scene=/builder=lbvh", "is empty"},
        {"scene=a/scene=b/builder=lbvh", "given twice"},
        {"scene=a/builder=lbvh/device=0", "its parts are scene="},
        {"scene=a/builder=lbvh/", "its parts are scene="},
        {"scene=a%/builder=lbvh", "two hexadecimal digits"},
        {"scene=a%4/builder=lbvh", "two hexadecimal digits"},
        {"scene=a%00/builder=lbvh", "two hexadecimal digits"},
        {"scene=a b/builder=lbvh", "a character that must be written"},
        {"scene=a/builder=lbvh/rays=ao", "no kernel"},
        {"scene=a/builder=lbvh/kernel=stack", "no rays"},
        {"scene=a/builder=lbvh/view=front", "no rays"},
        {"scene=a/builder=embree-native/rays=ao/kernel=stack", "traces by itself"},
        {"scene=a/builder=lbvh/rays=ao/kernel=stack/size=512", "WIDTHxHEIGHT"},
        {"scene=a/builder=lbvh/rays=ao/kernel=stack/size=0x5", "a number of it"},
        {"scene=a/builder=lbvh/rays=ao/kernel=stack/seed=-1", "a number of it"},
        {"scene=a/builder=lbvh/rays=ao/kernel=stack/seed=18446744073709551616", "a number of it"},
        {"scene=a/builder=lbvh/rays=ao/kernel=stack/max-rays=0", "a number of it"},
        {"scene=a/builder=lbvh/rays=ao/kernel=stack/rays-hash=12", "16 hexadecimal digits"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_cell_parts cell;
        assert_int_equal(bb_cell_key_parse(cases[i].key, &cell), BB_INVALID);
        if (strstr(bb_message(), cases[i].words) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("%s: %s", cases[i].key, bb_message());
    }
    bb_cell_parts cell = {.scene = "a", .builder = "b", .rays = "c"};
    char key[BB_CELL_KEY];
    memset(cell.kernel, ' ', BB_CELL_TEXT - 1);
    memset(cell.view, ' ', BB_CELL_TEXT - 1);
    assert_int_equal(bb_cell_key_format(&cell, key), BB_INVALID);
}

/* However the options are spelled: order, defaults, names of the same rules. */
static void a_cell_has_one_key(void **state)
{
    (void)state;
    static const char same[] =
        "scene=random:n=50,ratio=1,seed=3/rays=ao:per_hit=2,length=0.1,offset=1e-5,tmin=0/"
        "size=512x512/max-rays=1048576/seed=1/builder=sah:method=binned,bins=8,leaf=1/"
        "kernel=stack:leaf=4,group=64,persistent=no/"
        "intersector=exact:triangle=exact,slab=padded,contract=no";
    static const char *const spellings[] = {
        "scene=random:seed=3,n=50/rays=ao:per_hit=2/builder=sah:bins=8/kernel=stack:leaf=4",
        "scene=random:n=50,seed=3/rays=ao:tmin=0,per_hit=2/builder=sah:leaf=1,bins=8/"
        "kernel=stack:group=64,leaf=4/intersector=exact",
        "scene=random:n=50,seed=3/rays=ao:per_hit=2/builder=sah:bins=8/kernel=stack:leaf=4/"
        "intersector=watertight:triangle=exact",
        same};
    for (size_t i = 0; i < sizeof spellings / sizeof spellings[0]; i++)
        expect_canonical(spellings[i], same);
    /* rules without a name; a preset that equals another; what differs stays apart */
    expect_canonical(
        "scene=cube/rays=ao:per_hit=1/builder=null/kernel=short/intersector=fast:slab=naive",
        "scene=cube/rays=ao:per_hit=1,length=0.1,offset=1e-5,tmin=0/size=512x512/"
        "max-rays=1048576/seed=1/builder=null/kernel=short:leaf=1,group=64,persistent=no,"
        "entries=4/"
        "intersector=careless:triangle=moeller,slab=naive,contract=yes");
    /* whole numbers, where the option takes some; a default as it is declared */
    static const char *const counts[] = {"100000", "1e5", "100k", "0.1M", "100_000", "0100000"};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        char given[600], wanted[600];
        snprintf(given, sizeof given,
                 "scene=awkward:n=%s,far=100M/rays=random:count=%s/max-rays=2M/seed=1k/"
                 "size=1kx512/builder=lbvh:view=007/kernel=stack",
                 counts[i], counts[i]);
        snprintf(wanted, sizeof wanted, "scene=awkward:kind=outlier,n=100000,far=1e8,seed=1/");
        bb_cell_parts cell;
        char key[BB_CELL_KEY];
        parse(given, &cell);
        bb_cell_canonical(&cell);
        format(&cell, key);
        if (strncmp(key, wanted, strlen(wanted)) != 0 || strstr(key, "count=100000") == NULL ||
            strstr(key, "/size=1000x512/max-rays=2000000/seed=1000/") == NULL ||
            strstr(key, ",view=007,") == NULL)
            fail_msg("%s: %s", given, key);
    }
    /* what is not known stays as it is */
    expect_canonical("scene=a%2Fb.glb/seed=1/builder=lbvh+later:x=1",
                     "scene=a%2Fb.glb/seed=1/builder=lbvh+later:x=1");
    expect_canonical("scene=cube:oops=1/seed=1/builder=sah:bins=8,oops=2",
                     "scene=cube:oops=1/seed=1/builder=sah:bins=8,oops=2");
}

/* Suffixes of compared cells stay, whatever a key's program did not know yet. */
static void a_compared_key_keeps_its_suffixes(void **state)
{
    (void)state;
    static const char *const suffixes[] = {"", "/layout=wide8:leaf=4", "/run=2",
                                           "/layout=pair/run=12"};
    char key[BB_CELL_KEY], given[200], wanted[200];
    for (size_t i = 0; i < sizeof suffixes / sizeof suffixes[0]; i++) {
        snprintf(given, sizeof given, "scene=cube/seed=1/builder=sah:bins=8%s", suffixes[i]);
        snprintf(wanted, sizeof wanted,
                 "scene=cube/seed=1/builder=sah:method=binned,bins=8,leaf=1%s", suffixes[i]);
        bb_cell_key_canonical(given, key);
        assert_string_equal(key, wanted);
        bb_cell_key_short(wanted, key);
        assert_string_equal(key, given);
        snprintf(given, sizeof given, "no key%s", suffixes[i]);
        bb_cell_key_canonical(given, key);
        assert_string_equal(key, given);
    }
    /* defaults may make a key too long: it stays */
    char longest[BB_CELL_KEY] = "scene=cube/seed=1/builder=sah/layout=";
    memset(longest + strlen(longest), 'x', BB_CELL_KEY - 1 - strlen(longest));
    bb_cell_key_canonical(longest, key);
    assert_string_equal(key, longest);
}

/* A file that is called as a generator is the file. */
static void a_file_keeps_its_path(void **state)
{
    (void)state;
    char folder[] = "/tmp/bvhbench-cell-XXXXXX", before[4096];
    assert_non_null(getcwd(before, sizeof before));
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    FILE *file = fopen("random:n=50", "w");
    assert_non_null(file);
    fclose(file);
    expect_canonical("scene=random:n=50/seed=1/builder=null",
                     "scene=random:n=50/seed=1/builder=null");
    unlink("random:n=50");
    file = fopen("cube", "w"); /* without parameters, only the file's being there tells */
    assert_non_null(file);
    fclose(file);
    expect_canonical("scene=cube/seed=1/builder=null", "scene=cube/seed=1/builder=null");
    file = fopen("random", "w");
    assert_non_null(file);
    fclose(file);
    expect_canonical("scene=random/seed=1/builder=null", "scene=random/seed=1/builder=null");
    unlink("cube");
    unlink("random");
    expect_canonical("scene=random:n=50/seed=1/builder=null",
                     "scene=random:n=50,ratio=1,seed=1/seed=1/builder=null");
    assert_int_equal(chdir(before), 0);
    rmdir(folder);
}

static void short_names_mean_the_same(void **state)
{
    (void)state;
    bb_cell_parts cell, brief;
    char key[BB_CELL_KEY], again[BB_CELL_KEY];
    parse("scene=random:seed=3,n=50/rays=ao:per_hit=2/builder=sah:bins=8/kernel=stack:leaf=4/"
          "intersector=exact:slab=sign",
          &cell);
    bb_cell_canonical(&cell);
    format(&cell, key);
    brief = cell;
    bb_cell_short(&brief);
    assert_string_equal(brief.scene, "random:n=50,seed=3");
    assert_string_equal(brief.rays, "ao:per_hit=2");
    assert_string_equal(brief.builder, "sah:bins=8");
    assert_string_equal(brief.kernel, "stack:leaf=4");
    assert_string_equal(brief.intersector, "exact:slab=sign");
    bb_cell_canonical(&brief);
    format(&brief, again);
    assert_string_equal(key, again);
}

static void parts_are_found(void **state)
{
    (void)state;
    assert_int_equal(bb_cell_key_set(plain), strlen("scene=coffee/rays=primary"));
    assert_string_equal(plain + bb_cell_key_rays(plain),
                        "/builder=lbvh/kernel=stack:leaf=4/intersector=exact");
    assert_int_equal(bb_cell_key_rays(""), 0);
    assert_int_equal(bb_cell_key_set(""), 0);
    assert_true(bb_cell_key_same("ab", 1, "ac", 1));
    assert_false(bb_cell_key_same("ab", 2, "ac", 2));
    assert_false(bb_cell_key_same("ab", 2, "ab", 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_key_is_read_and_written),
        cmocka_unit_test(names_of_any_bytes_come_back),
        cmocka_unit_test(random_cells_come_back),
        cmocka_unit_test(damaged_keys_do_no_harm),
        cmocka_unit_test(pipelines_have_one_spelling),
        cmocka_unit_test(what_is_no_key_is_refused),
        cmocka_unit_test(a_cell_has_one_key),
        cmocka_unit_test(a_compared_key_keeps_its_suffixes),
        cmocka_unit_test(a_file_keeps_its_path),
        cmocka_unit_test(short_names_mean_the_same),
        cmocka_unit_test(parts_are_found),
    };
    return cmocka_run_group_tests_name("cell", tests, NULL, NULL);
}
