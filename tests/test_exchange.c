/* Rays files and hits files: there and back, and fuzzing: each truncation and each damaged byte of
 * a small file is refused or changes nothing. With right checksums: test_exchange_forged.c. */
#include "tests/exchange_fixture.h"

/* ---- there and back ---- */

static void rays_come_back(void **state)
{
    (void)state;
    bb_rays *got = NULL;
    assert_int_equal(read_rays(rays_bytes, rays_size, &got), BB_OK);
    assert_string_equal(got->name, rays->name);
    assert_string_equal(got->view, rays->view);
    assert_ptr_equal(got->options, rays->options);
    assert_string_equal(got->spec.text, rays->spec.text);
    assert_int_equal(got->query, rays->query);
    assert_int_equal(got->count, rays->count);
    assert_int_equal(got->hash, rays->hash);
    assert_int_equal(got->must_hit, rays->must_hit);
    assert_int_equal(got->seed, rays->seed);
    assert_int_equal(got->primary_width, rays->primary_width);
    assert_int_equal(got->primary_height, rays->primary_height);
    assert_int_equal(got->max_rays, rays->max_rays);
    assert_memory_equal(got->rays, rays->rays, rays->count * sizeof(bb_ray));
    bb_rays_free(got);
}

/* By offsets, as one would read it in another language. */
static void the_file_is_what_the_header_says(void **state)
{
    (void)state;
    uint32_t words[6];
    uint64_t counts[4], hashes[3];
    memcpy(words, rays_bytes + 8, sizeof words);
    memcpy(counts, rays_bytes + 32, sizeof counts);
    memcpy(hashes, rays_bytes + 64, sizeof hashes);
    const uint32_t expected_words[] = {4, 0x01020304, 1024, 0, 1, 0};
    const uint64_t expected_counts[] = {RAYS, scene->vertex_count, 2, 2};
    assert_memory_equal(rays_bytes, "BVHBRAYS", 8);
    assert_memory_equal(words, expected_words, sizeof words);
    assert_memory_equal(counts, expected_counts, sizeof counts);
    uint64_t seed;
    uint32_t made_by[6]; /* picture, primary rays, the most rays, reserved */
    memcpy(&seed, rays_bytes + 88, sizeof seed);
    memcpy(made_by, rays_bytes + 96, sizeof made_by);
    const uint32_t expected_made_by[] = {0, 0, 4, 4, RAYS, 0};
    assert_int_equal(seed, SEED);
    assert_memory_equal(made_by, expected_made_by, sizeof made_by);
    assert_string_equal(rays_bytes + 120, scene->name);
    assert_string_equal(rays_bytes + 376, "random");
    assert_string_equal(rays_bytes + 504, "");
    assert_string_equal(rays_bytes + 552, "a test");
    const char *part = rays_bytes + 1024;
    assert_memory_equal(part, rays->rays, RAYS * sizeof(bb_ray));
    assert_int_equal(XXH3_64bits(part, RAYS * sizeof(bb_ray)), hashes[1]);
    part += RAYS * sizeof(bb_ray);
    assert_memory_equal(part, scene->vertices, scene->vertex_count * 12);
    part += scene->vertex_count * 12;
    assert_memory_equal(part, bb_scene_indices(scene), 2 * 12);
    part += 2 * 12;
    assert_memory_equal(part, bb_scene_floats(scene, BB_SPHERE), 2 * 16);
    part += 2 * 16;
    assert_int_equal(part - rays_bytes, rays_size);
    /* the scene's hash: three counts, then the three arrays */
    static char geometry[FILE_MAX];
    uint32_t few[3] = {scene->vertex_count, 2, 2};
    const char *begin = rays_bytes + 1024 + RAYS * sizeof(bb_ray);
    memcpy(geometry, few, sizeof few);
    memcpy(geometry + sizeof few, begin, (size_t)(part - begin));
    assert_int_equal(XXH3_64bits(geometry, sizeof few + (size_t)(part - begin)), hashes[0]);
    seal(rays_bytes, rays_size, 80);
    uint64_t sealed;
    memcpy(&sealed, rays_bytes + 80, 8);
    assert_int_equal(sealed, hashes[2]);
}

static void hits_come_back(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    for (int checksum = 0; checksum < 2; checksum++)
        for (uint32_t count = 1; count <= RAYS; count++) {
            bb_outside_hits got;
            size_t size = make_hits(bytes, count, checksum != 0);
            if (read_hits(bytes, size, &got) != BB_OK)
                fail_msg("%s", bb_message());
            assert_int_equal(got.count, count);
            assert_string_equal(got.tracer, "test");
            assert_memory_equal(got.hits, bytes + 128, count * sizeof(bb_hit));
            bb_outside_hits_release(&got);
        }
}

/* ---- fuzzing ---- */

static void every_truncation_is_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    for (size_t size = 0; size < rays_size; size++)
        refuses_rays(rays_bytes, size, "bytes");
    for (size_t size = 0; size < hits_size; size++)
        refuses_hits(hits_bytes, size, "bytes");
    memcpy(bytes, rays_bytes, rays_size);
    refuses_rays(bytes, rays_size + 1, "too long");
    memcpy(bytes, hits_bytes, hits_size);
    refuses_hits(bytes, hits_size + 8, "too long");
}

static const unsigned char masks[] = {0x01, 0x10, 0x80, 0xFF};

static void every_damaged_byte_is_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    for (size_t m = 0; m < sizeof masks; m++) {
        memcpy(bytes, rays_bytes, rays_size);
        for (size_t i = 0; i < rays_size; i++) {
            bytes[i] = (char)(bytes[i] ^ masks[m]);
            refuses_rays(bytes, rays_size, "rays file");
            bytes[i] = rays_bytes[i];
        }
        memcpy(bytes, hits_bytes, hits_size);
        for (size_t i = 0; i < hits_size; i++) {
            bytes[i] = (char)(bytes[i] ^ masks[m]);
            refuses_hits(bytes, hits_size, "hits file");
            bytes[i] = hits_bytes[i];
        }
    }
}

/* Without a checksum a damaged header is refused all the same, its text apart; a damaged hit is
 * that one hit, or refused. */
static void damage_without_a_checksum_stays_where_it_is(void **state)
{
    (void)state;
    static char whole[FILE_MAX], bytes[FILE_MAX];
    size_t size = make_hits(whole, RAYS, false);
    uint32_t read = 0;
    for (size_t m = 0; m < sizeof masks; m++)
        for (size_t i = 0; i < size; i++) {
            memcpy(bytes, whole, size);
            bytes[i] = (char)(bytes[i] ^ masks[m]);
            bb_outside_hits got;
            if (read_hits(bytes, size, &got) != BB_OK) {
                expect_message(hits_path, "hits file");
                continue;
            }
            if (i < offsetof(bb_hits_header, tracer))
                fail_msg("byte %zu of the header can be damaged", i);
            assert_int_equal(got.count, RAYS);
            for (size_t k = 0; k < RAYS; k++)
                if (128 + 8 * k > i || 128 + 8 * k + 8 <= i)
                    assert_memory_equal(&got.hits[k], whole + 128 + 8 * k, 8);
            bb_outside_hits_release(&got);
            read++;
        }
    assert_true(read > 0);
}

static void noise_is_refused(void **state)
{
    (void)state;
    static char bytes[4096];
    bb_random random = bb_random_make(11, 0);
    for (int round = 0; round < 200; round++) {
        for (size_t i = 0; i < sizeof bytes; i++)
            bytes[i] = (char)bb_random_u64(&random);
        if (round % 2 == 1) { /* what is right at the front lets the reader go on */
            memcpy(bytes, round % 4 == 1 ? rays_bytes : hits_bytes, 20);
            refuses_rays(bytes, sizeof bytes, "rays file");
        }
        refuses_hits(bytes, sizeof bytes, "hits file");
    }
}

/* ---- files ---- */

static void odd_files_are_refused(void **state)
{
    (void)state;
    bb_rays *got = NULL;
    bb_outside_hits hits = {0};
    const char *fifo = test_path("exchange", "fifo");
    unlink(fifo);
    assert_int_equal(mkfifo(fifo, 0600), 0);
    const char *const paths[] = {test_path("exchange", "missing"), "/", "/dev/zero", fifo};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        assert_int_equal(bb_exchange_read_rays(paths[i], scene, false, &got), BB_INVALID);
        expect_message(paths[i], "rays file");
        assert_int_equal(bb_exchange_read_hits(paths[i], scene, rays, &hits), BB_INVALID);
        expect_message(paths[i], "hits file");
    }
    /* a giant without content is refused before any memory is taken for it */
    const char *giant = test_path("exchange", "giant");
    write_bytes(giant, rays_bytes, rays_size);
    assert_int_equal(truncate(giant, (off_t)1 << 40), 0);
    assert_int_equal(bb_exchange_read_rays(giant, scene, false, &got), BB_INVALID);
    expect_message(giant, "too long");
    unlink(giant);
    assert_int_equal(bb_exchange_write_rays("/dev/null", scene, rays, "test"), BB_INVALID);
    assert_int_equal(bb_exchange_write_rays("/no/such/folder/x", scene, rays, "test"), BB_INVALID);
}

static void long_generators_are_cut(void **state)
{
    (void)state;
    char text[2000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    bb_rays *got = NULL;
    assert_int_equal(bb_exchange_write_rays(rays_path, scene, rays, text), BB_OK);
    if (bb_exchange_read_rays(rays_path, scene, false, &got) != BB_OK)
        fail_msg("%s", bb_message());
    bb_rays_free(got);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_come_back),
        cmocka_unit_test(the_file_is_what_the_header_says),
        cmocka_unit_test(hits_come_back),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(every_damaged_byte_is_refused),
        cmocka_unit_test(damage_without_a_checksum_stays_where_it_is),
        cmocka_unit_test(noise_is_refused),
        cmocka_unit_test(odd_files_are_refused),
        cmocka_unit_test(long_generators_are_cut),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
